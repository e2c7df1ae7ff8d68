//! What kinds of hard cases there are.

use std::fmt;
use std::str::FromStr;

use serde::Deserialize;

/// A kind of difficulty. `docs/formats.md` has the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HardFamily {
    /// The ray runs along a border between texels.
    AlongBorder,
    /// The ray runs through corners.
    AlongDiagonal,
    /// A component of the direction is zero, or hardly more.
    ZeroDirection,
    /// The smallest and the largest slopes that can be walked, and both in one ray.
    ExtremeSlope,
    /// The entry is on a border, or as little beside it as a format can tell.
    EntryOnBorder,
    /// The hit is exactly at a border.
    HitOnBorder,
    /// The hit is exactly at a corner.
    HitOnCorner,
    /// Hits at depths 0 and 1, and a step of height beside them.
    TopAndBottom,
    /// Single texels that stand out.
    Spike,
    /// Single texels that lie lower.
    Pit,
    /// Checkerboards: walls everywhere, and a pyramid that tells nothing.
    Checkerboard,
    /// Flat parts at the very depth the ray has there.
    Plateau,
    /// Neighbours of equal height that are met on their common border.
    EqualHeights,
    /// Over the edge of the tile.
    WrapAround,
    /// The smallest and the largest maps.
    MapSize,
    /// Rays down to a tenth of a degree.
    Grazing,
    /// Positions a rounding beside a border that has been crossed.
    ReEntry,
    /// Corners missed by less than a float can tell.
    NearCorner,
    /// Faults of other traversals that were published.
    Published,
}

impl HardFamily {
    /// All of them, in the order of the documentation.
    pub const ALL: [HardFamily; 19] = [
        HardFamily::AlongBorder,
        HardFamily::AlongDiagonal,
        HardFamily::ZeroDirection,
        HardFamily::ExtremeSlope,
        HardFamily::EntryOnBorder,
        HardFamily::HitOnBorder,
        HardFamily::HitOnCorner,
        HardFamily::TopAndBottom,
        HardFamily::Spike,
        HardFamily::Pit,
        HardFamily::Checkerboard,
        HardFamily::Plateau,
        HardFamily::EqualHeights,
        HardFamily::WrapAround,
        HardFamily::MapSize,
        HardFamily::Grazing,
        HardFamily::ReEntry,
        HardFamily::NearCorner,
        HardFamily::Published,
    ];

    /// The name in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            HardFamily::AlongBorder => "along-border",
            HardFamily::AlongDiagonal => "along-diagonal",
            HardFamily::ZeroDirection => "zero-direction",
            HardFamily::ExtremeSlope => "extreme-slope",
            HardFamily::EntryOnBorder => "entry-on-border",
            HardFamily::HitOnBorder => "hit-on-border",
            HardFamily::HitOnCorner => "hit-on-corner",
            HardFamily::TopAndBottom => "top-and-bottom",
            HardFamily::Spike => "spike",
            HardFamily::Pit => "pit",
            HardFamily::Checkerboard => "checkerboard",
            HardFamily::Plateau => "plateau",
            HardFamily::EqualHeights => "equal-heights",
            HardFamily::WrapAround => "wrap-around",
            HardFamily::MapSize => "map-size",
            HardFamily::Grazing => "grazing",
            HardFamily::ReEntry => "re-entry",
            HardFamily::NearCorner => "near-corner",
            HardFamily::Published => "published",
        }
    }
}

impl fmt::Display for HardFamily {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for HardFamily {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        HardFamily::ALL
            .into_iter()
            .find(|family| family.name() == text)
            .ok_or_else(|| {
                let names = HardFamily::ALL.map(HardFamily::name).join(", ");
                format!("unknown family `{text}`: there is {names}")
            })
    }
}
