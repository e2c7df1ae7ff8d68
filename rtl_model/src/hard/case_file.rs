//! The text of a case, table by table. Every value is checked where it is read, so that the TOML
//! reader can add the line to the message.

use serde::Deserialize;

use super::number::{exact_number, ratio};
use super::{ExpectedHit, HardCase, HardFamily, HardRay};
use crate::maps::{HeightMap, MAX_SIZE};
use crate::ray::Ray;

/// The case in `text`, the content of `NAME.toml` with this name.
pub(super) fn read(text: &str, name: &str) -> Result<HardCase, String> {
    let file: CaseFile =
        toml::from_str(text).map_err(|error| error.to_string().trim_end().to_owned())?;
    if file.name != name {
        return Err(format!(
            "its name is `{}`; it must be the file's, `{name}`",
            file.name
        ));
    }
    for (key, value) in [("why", &file.why), ("source", &file.source)] {
        if value.trim().is_empty() {
            return Err(format!("`{key}` is empty: say it in a sentence"));
        }
    }
    let map = file.map.into_map(name)?;
    if file.rays.is_empty() {
        return Err("no [[rays]]".to_owned());
    }
    let size = map.size();
    let rays: Vec<HardRay> = file.rays.into_iter().map(RayTable::into_ray).collect();
    if let Some(at) = rays
        .iter()
        .position(|ray| ray.expected.i >= size || ray.expected.j >= size)
    {
        return Err(format!(
            "ray {} expects a texel beyond the {size} x {size} of the map",
            at + 1
        ));
    }
    Ok(HardCase {
        name: file.name,
        family: file.family,
        why: one_line(&file.why),
        source: one_line(&file.source),
        map,
        rays,
    })
}

/// Text of several lines as one.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CaseFile {
    name: String,
    family: HardFamily,
    why: String,
    source: String,
    map: MapTable,
    rays: Vec<RayTable>,
}

/// All heights, row by row, or a plain with some texels of their own.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MapTable {
    bits: u32,
    heights: Option<Vec<Vec<u16>>>,
    size: Option<u32>,
    ground: Option<u16>,
    texels: Option<Vec<(u32, u32, u16)>>,
}

impl MapTable {
    fn into_map(self, name: &str) -> Result<HeightMap, String> {
        let (size, heights) = match (self.heights, self.size, self.ground, self.texels) {
            (Some(rows), None, None, None) => {
                let size = rows.len();
                if rows.iter().any(|row| row.len() != size) {
                    return Err(format!(
                        "[map]: {size} rows, which do not all have {size} heights"
                    ));
                }
                // A map larger than a program's memory is not written down.
                (size as u32, rows.concat())
            }
            (None, Some(size), Some(ground), Some(texels)) => {
                if size > MAX_SIZE {
                    return Err(format!("[map]: size {size}; the largest is {MAX_SIZE}"));
                }
                let mut heights = vec![ground; size as usize * size as usize];
                for (i, j, height) in texels {
                    if i >= size || j >= size {
                        return Err(format!("[map]: no texel ({i}, {j}) is in {size} x {size}"));
                    }
                    heights[j as usize * size as usize + i as usize] = height;
                }
                (size, heights)
            }
            _ => {
                return Err(
                    "[map]: has either `heights`, or `size`, `ground` and `texels`".to_owned(),
                );
            }
        };
        HeightMap::new(name, size, self.bits, heights).map_err(|error| error.to_string())
    }
}

/// An exact number, as text.
#[derive(Deserialize)]
#[serde(try_from = "String")]
struct Number(f64);

impl TryFrom<String> for Number {
    type Error = String;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        exact_number(&text).map(Number)
    }
}

/// A ratio, as text.
#[derive(Deserialize)]
#[serde(try_from = "String")]
struct Depth((i128, i128));

impl TryFrom<String> for Depth {
    type Error = String;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        ratio(&text).map(Depth)
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Face {
    Side,
    Top,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RayTable {
    #[serde(default)]
    note: String,
    u: Number,
    v: Number,
    du: Number,
    dv: Number,
    i: u32,
    j: u32,
    depth: Depth,
    on: Face,
}

impl RayTable {
    fn into_ray(self) -> HardRay {
        HardRay {
            note: self.note,
            ray: Ray {
                u: self.u.0,
                v: self.v.0,
                du: self.du.0,
                dv: self.dv.0,
            },
            expected: ExpectedHit {
                i: self.i,
                j: self.j,
                depth: self.depth.0,
                side: matches!(self.on, Face::Side),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CASE: &str = r#"
name = "n"
family = "spike"
why = "w"
source = "s"

[map]
bits = 8
heights = [[0, 255], [1, 2]]

[[rays]]
u = "0.25"
v = "0x1p-2"
du = "1"
dv = "-0"
i = 1
j = 0
depth = "1/4"
on = "side"
"#;

    #[test]
    fn a_case_is_read() {
        let case = read(CASE, "n").unwrap();
        assert_eq!(
            (case.family, case.map.heights()),
            (HardFamily::Spike, &[0, 255, 1, 2][..])
        );
        let ray = &case.rays[0];
        assert_eq!((ray.expected.depth, ray.expected.side), ((1, 4), true));
        assert!(ray.ray.dv.is_sign_negative());
        assert_eq!(ray.met_in(&case.map).unwrap(), ray.expected);
    }

    #[test]
    fn a_large_map_is_a_plain_with_texels() {
        let plain = "size = 4\nground = 7\ntexels = [[3, 1, 9]]";
        let text = CASE.replace("heights = [[0, 255], [1, 2]]", plain);
        let map = read(&text, "n").unwrap().map;
        assert_eq!((map.size(), map.height(3, 1), map.height(1, 3)), (4, 9, 7));
    }

    #[test]
    fn what_is_no_case_is_refused_with_its_place() {
        for (from, to, expected) in [
            ("name = \"n\"", "name = \"m\"", "must be the file's"),
            ("why = \"w\"", "why = \" \"", "`why` is empty"),
            (
                "why = \"w\"",
                "why = \"w\"\nwhere = \"\"",
                "unknown field `where`",
            ),
            ("bits = 8", "bits = 8\nsize = 2", "either `heights`"),
            ("bits = 8", "bits = 9", "8 or 16"),
            (
                "bits = 8",
                "bits = 8\nchannel = 1",
                "unknown field `channel`",
            ),
            ("[1, 2]]", "[1]]", "do not all have 2 heights"),
            ("[[0, 255], [1, 2]]", "[[0, 256], [1, 2]]", "256"),
            ("dv = \"-0\"", "dv = \"-0\"\nt = \"1\"", "unknown field `t`"),
            ("\"0.25\"", "\"0.1\"", "not exact"),
            ("\"1/4\"", "\"2/8\"", "lowest terms"),
            ("\"side\"", "\"front\"", "unknown variant `front`"),
            ("\"spike\"", "\"spikes\"", "unknown variant `spikes`"),
            ("i = 1", "i = 2", "ray 1 expects a texel beyond"),
        ] {
            let text = CASE.replacen(from, to, 1);
            assert_ne!(text, CASE, "{from}");
            let message = read(&text, "n").unwrap_err();
            assert!(message.contains(expected), "{to}: {message}");
        }
    }
}
