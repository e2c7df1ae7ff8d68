//! The maps that walks are judged on: the seven real ones, on the surfaces they are seen on.

use rtl_model::calibration::{CAMERAS, SURFACES, real_maps};
use rtl_model::camera::{Surface, View};
use rtl_model::maps::{Channel, HeightMap, MapSource};
use rtl_model::ray::Ray;

use crate::command_line::workspace;

/// A map with the surface it is seen on.
pub struct Subject {
    /// The name that tables use.
    pub name: String,
    /// The map.
    pub map: HeightMap,
    /// How it is laid.
    pub surface: Surface,
    /// Is it one of the real ones, and not what stands in for them?
    pub is_real: bool,
}

/// The real maps in the order of [`SURFACES`]; where there are none, a procedural one, which is
/// said.
///
/// # Panics
/// Where the real maps are missing in CI.
pub fn subjects() -> Vec<Subject> {
    let found = real_maps(workspace()).expect("in CI the real maps are there");
    let Some(folder) = found else {
        println!("no real height maps: a procedural one stands in (set STEPWELL_MAPS)");
        let source = MapSource::parse("procedural:rocks:256:1").expect("a procedural map");
        return vec![Subject {
            name: source.to_string(),
            map: source.load(Channel::Grey, false).expect("a procedural map"),
            surface: SURFACES[0].surface,
            is_real: false,
        }];
    };
    SURFACES
        .iter()
        .map(|calibrated| Subject {
            name: calibrated.name.to_owned(),
            map: HeightMap::load(&folder.join(calibrated.file), Channel::Alpha, false)
                .expect("a height map of the paper"),
            surface: calibrated.surface,
            is_real: true,
        })
        .collect()
}

/// The rays of a subject's frame by one of [`CAMERAS`].
///
/// # Panics
/// If a ray is beyond reach, which none of these cameras' is.
pub fn frame(subject: &Subject, camera: usize, width: u32, height: u32) -> Vec<Ray<f64>> {
    let view = View::new(&CAMERAS[camera].1, &subject.surface, width, height);
    let rays = view.rays(subject.map.size()).expect("rays within reach");
    rays.into_iter().flatten().collect()
}
