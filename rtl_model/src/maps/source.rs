//! Where a height map comes from.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::Deserialize;

use super::{Channel, HeightMap, MapError, Procedural};

/// The text that tells a recipe from a file.
const PROCEDURAL_PREFIX: &str = "procedural:";

/// A file, or a recipe: what `--map` and a scene's `[map] source` name.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub enum MapSource {
    /// A PNG, TGA or PGM file.
    File(PathBuf),
    /// `procedural:NAME:SIZE:SEED`.
    Procedural(Procedural),
}

impl MapSource {
    /// Reads `procedural:NAME:SIZE:SEED`, or else the path of a file, which is not opened yet.
    ///
    /// # Errors
    /// An empty text, and a recipe whose name, size or seed is wrong.
    pub fn parse(text: &str) -> Result<MapSource, MapError> {
        if text.is_empty() {
            Err(MapError::NoName)
        } else if let Some(recipe) = text.strip_prefix(PROCEDURAL_PREFIX) {
            Procedural::parse(text, recipe).map(MapSource::Procedural)
        } else {
            Ok(MapSource::File(PathBuf::from(text)))
        }
    }

    /// The same source with a relative path taken from `folder`.
    #[must_use]
    pub fn relative_to(self, folder: &Path) -> MapSource {
        match self {
            MapSource::File(path) => MapSource::File(folder.join(path)),
            recipe @ MapSource::Procedural(_) => recipe,
        }
    }

    /// Reads the file or follows the recipe. A recipe has one channel only, so `channel` is for
    /// files; `white_is_low` inverts either.
    ///
    /// # Errors
    /// As [`HeightMap::load`]; a recipe has none.
    pub fn load(&self, channel: Channel, white_is_low: bool) -> Result<HeightMap, MapError> {
        match self {
            MapSource::File(path) => HeightMap::load(path, channel, white_is_low),
            MapSource::Procedural(recipe) => {
                let map = recipe.generate();
                Ok(if white_is_low { map.inverted() } else { map })
            }
        }
    }
}

impl FromStr for MapSource {
    type Err = MapError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        MapSource::parse(text)
    }
}

impl TryFrom<String> for MapSource {
    type Error = MapError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        MapSource::parse(&text)
    }
}

impl fmt::Display for MapSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MapSource::File(path) => write!(f, "{}", path.display()),
            MapSource::Procedural(recipe) => write!(f, "{recipe}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::Pattern;

    #[test]
    fn sources_are_told_apart_and_read_back() {
        let recipe = MapSource::parse("procedural:bricks:64:7").unwrap();
        assert_eq!(
            recipe,
            MapSource::Procedural(Procedural::new(Pattern::Bricks, 64, 7).unwrap())
        );
        assert_eq!(recipe.to_string(), "procedural:bricks:64:7");
        let file = MapSource::parse("maps/a.png").unwrap();
        assert_eq!(file, MapSource::File("maps/a.png".into()));
        assert_eq!(
            file.relative_to(Path::new("scenes")),
            MapSource::File("scenes/maps/a.png".into())
        );
        assert_eq!(recipe.clone().relative_to(Path::new("scenes")), recipe);
    }

    #[test]
    fn wrong_recipes_say_what_would_be_right() {
        for (text, expected) in [
            ("", "no height map is named"),
            ("procedural:", "NAME:SIZE:SEED"),
            ("procedural:rocks", "NAME:SIZE:SEED"),
            ("procedural:rocks:256", "NAME:SIZE:SEED"),
            ("procedural:rocks:256:1:1", "NAME:SIZE:SEED"),
            (
                "procedural:pebbles:256:1",
                "bricks, rocks, spikes, mountain, flat, checkerboard",
            ),
            ("procedural:rocks:many:1", "`many` is not a size"),
            ("procedural:rocks:-4:1", "`-4` is not a size"),
            ("procedural:rocks:100:1", "64 x 64 or 128 x 128"),
            ("procedural:rocks:0:1", "1 to 4096"),
            ("procedural:rocks:8192:1", "1 to 4096"),
            ("procedural:rocks:256:x", "`x` is not a seed"),
            ("procedural:flat:16:256", "`256` is not a seed"),
        ] {
            let message = MapSource::parse(text).unwrap_err().to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }

    #[test]
    fn a_recipe_can_be_inverted() {
        let source = MapSource::parse("procedural:flat:1:5").unwrap();
        let map = source.load(Channel::Grey, false).unwrap();
        let inverted = source.load(Channel::Grey, true).unwrap();
        assert_eq!((map.height(0, 0), inverted.height(0, 0)), (5, 250));
    }
}
