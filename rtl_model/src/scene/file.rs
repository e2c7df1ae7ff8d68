//! The text of a scene file, table by table. Every value is checked where it is read, so that the
//! TOML reader can add the line to the message.

use serde::de::{self, Deserializer, MapAccess, Visitor};
use serde::{Deserialize, de::IgnoredAny};
use std::fmt;

use super::{Effects, FrameSize, Light, MAX_FRAME_SIDE, Machine, Scene, SceneMap, Walk};
use crate::calibration;
use crate::camera::{Camera, Surface};
use crate::maps::{Channel, MapSource};

/// The scene in `text`, its paths as they stand there.
pub(super) fn read(text: &str) -> Result<Scene, String> {
    toml::from_str::<SceneFile>(text)
        .map(SceneFile::into_scene)
        // Its message has several lines and ends in a line break.
        .map_err(|error| error.to_string().trim_end().to_owned())
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFile {
    name: Name,
    map: MapTable,
    surface: SurfaceTable,
    camera: CameraTable,
    #[serde(default)]
    light: LightTable,
    frame: FrameTable,
    walk: Walk,
    machine: Option<Machine>,
    #[serde(default)]
    effects: EffectsTable,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MapTable {
    source: MapSource,
    #[serde(default)]
    channel: Channel,
    #[serde(default)]
    white_is_low: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SurfaceTable {
    side: Positive,
    depth_scale: Positive,
    repeat: Positive,
}

/// The four values, or a preset that stands for them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraFields {
    preset: Option<Preset>,
    eye: Option<Eye>,
    elevation_deg: Option<Elevation>,
    azimuth_deg: Option<Finite>,
    fov_y_deg: Option<FieldOfView>,
}

#[derive(Deserialize)]
#[serde(try_from = "CameraFields")]
struct CameraTable(Camera);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LightFields {
    direction: Direction,
}

#[derive(Deserialize)]
#[serde(from = "LightFields")]
#[derive(Default)]
struct LightTable(Light);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FrameTable {
    width: Pixels,
    height: Pixels,
}

#[derive(Default)]
struct EffectsTable;

impl SceneFile {
    fn into_scene(self) -> Scene {
        let EffectsTable = self.effects;
        Scene {
            name: self.name.0,
            map: SceneMap {
                source: self.map.source,
                channel: self.map.channel,
                white_is_low: self.map.white_is_low,
            },
            surface: Surface {
                side: self.surface.side.0,
                depth_scale: self.surface.depth_scale.0,
                repeat: self.surface.repeat.0,
            },
            camera: self.camera.0,
            light: self.light.0,
            frame: FrameSize {
                width: self.frame.width.0,
                height: self.frame.height.0,
            },
            walk: self.walk,
            machine: self.machine,
            effects: Effects {},
        }
    }
}

impl TryFrom<CameraFields> for CameraTable {
    type Error = String;

    fn try_from(fields: CameraFields) -> Result<Self, Self::Error> {
        let CameraFields {
            preset,
            eye,
            elevation_deg,
            azimuth_deg,
            fov_y_deg,
        } = fields;
        let given = [
            ("eye", eye.is_some()),
            ("elevation_deg", elevation_deg.is_some()),
            ("azimuth_deg", azimuth_deg.is_some()),
            ("fov_y_deg", fov_y_deg.is_some()),
        ];
        if let Some(Preset(camera)) = preset {
            return match given.iter().find(|(_, given)| *given) {
                None => Ok(CameraTable(camera)),
                Some((name, _)) => Err(format!(
                    "camera: `preset` stands for all values; remove `{name}`, or remove `preset`"
                )),
            };
        }
        let (Some(eye), Some(elevation), Some(azimuth), Some(fov)) =
            (eye, elevation_deg, azimuth_deg, fov_y_deg)
        else {
            let missing: Vec<&str> = given
                .iter()
                .filter(|(_, given)| !given)
                .map(|(name, _)| *name)
                .collect();
            return Err(format!(
                "camera: missing {}; give all of eye, elevation_deg, azimuth_deg and fov_y_deg, or \
                 a preset alone",
                missing.join(", ")
            ));
        };
        Ok(CameraTable(Camera {
            eye: eye.0,
            elevation_deg: elevation.0,
            azimuth_deg: azimuth.0,
            fov_y_deg: fov.0,
        }))
    }
}

impl From<LightFields> for LightTable {
    fn from(fields: LightFields) -> Self {
        LightTable(Light {
            direction: fields.direction.0,
        })
    }
}

impl<'de> Deserialize<'de> for EffectsTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NoEffects;
        impl<'de> Visitor<'de> for NoEffects {
            type Value = EffectsTable;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table of effects")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                match map.next_entry::<String, IgnoredAny>()? {
                    None => Ok(EffectsTable),
                    Some((key, _)) => Err(de::Error::custom(format!(
                        "unknown effect `{key}`: there are no effects yet; remove it"
                    ))),
                }
            }
        }
        deserializer.deserialize_map(NoEffects)
    }
}

/// A value read as `$raw`, which `$check` turns into the checked one or refuses.
macro_rules! checked {
    ($(#[$doc:meta])* $name:ident($value:ty), from $raw:literal as $raw_type:ty, $check:expr) => {
        $(#[$doc])*
        #[derive(Deserialize)]
        #[serde(try_from = $raw)]
        struct $name($value);

        impl TryFrom<$raw_type> for $name {
            type Error = String;

            fn try_from(raw: $raw_type) -> Result<Self, Self::Error> {
                let check: fn($raw_type) -> Result<$value, String> = $check;
                check(raw).map($name)
            }
        }
    };
}

checked! {
    /// A name that every file system takes.
    Name(String), from "String" as String, |name| {
        let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if !name.is_empty() && name.chars().all(allowed) {
            Ok(name)
        } else {
            Err(format!("`{name}` is not a name: use letters, digits, `-` and `_`"))
        }
    }
}

checked! {
    /// Any number but NaN and the infinities.
    Finite(f64), from "f64" as f64, |number| {
        if number.is_finite() {
            Ok(number)
        } else {
            Err(format!("{number} is not a finite number"))
        }
    }
}

checked! {
    /// A finite number above 0.
    Positive(f64), from "f64" as f64, |number| {
        if number.is_finite() && number > 0.0 {
            Ok(number)
        } else {
            Err(format!("{number} is not a finite number above 0"))
        }
    }
}

checked! {
    /// An angle from straight up to straight down.
    Elevation(f64), from "f64" as f64, |degrees| {
        if (-90.0..=90.0).contains(&degrees) {
            Ok(degrees)
        } else {
            Err(format!("{degrees} is not an elevation: -90 (up) to 90 degrees (down)"))
        }
    }
}

checked! {
    /// An angle a pinhole camera can see.
    FieldOfView(f64), from "f64" as f64, |degrees| {
        if degrees > 0.0 && degrees < 180.0 {
            Ok(degrees)
        } else {
            Err(format!("{degrees} is not a field of view: above 0, below 180 degrees"))
        }
    }
}

checked! {
    /// A point above the plane.
    Eye([f64; 3]), from "[f64; 3]" as [f64; 3], |eye| {
        if !eye.iter().all(|number| number.is_finite()) {
            Err(format!("{eye:?} is not an eye: three finite numbers"))
        } else if eye[1] > 0.0 {
            Ok(eye)
        } else {
            Err(format!("{eye:?} is not above the surface: its second number, y, is above 0"))
        }
    }
}

checked! {
    /// A direction out of the surface.
    Direction([f64; 3]), from "[f64; 3]" as [f64; 3], |direction| {
        if !direction.iter().all(|number| number.is_finite()) {
            Err(format!("{direction:?} is not a direction: three finite numbers"))
        } else if direction[2] > 0.0 {
            Ok(direction)
        } else {
            Err(format!("{direction:?} is a light below the surface: its third number is above 0"))
        }
    }
}

checked! {
    /// The side of a frame.
    Pixels(u32), from "i64" as i64, |pixels| {
        u32::try_from(pixels)
            .ok()
            .filter(|pixels| (1..=MAX_FRAME_SIDE).contains(pixels))
            .ok_or_else(|| format!("{pixels} pixels: 1 to {MAX_FRAME_SIDE} are supported"))
    }
}

checked! {
    /// One of the calibrated cameras.
    Preset(Camera), from "String" as String, |name| {
        let cameras = calibration::CAMERAS;
        cameras
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, camera)| *camera)
            .ok_or_else(|| {
                let known = cameras.map(|(name, _)| name).join(", ");
                format!("unknown preset `{name}`: it is one of {known}")
            })
    }
}
