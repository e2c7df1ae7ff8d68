//! The scenes that traversals are timed on: the seven maps of the paper from its three cameras, at
//! 1024 x 768.

use rtl_model::calibration::{CAMERAS, CalibratedSurface, SURFACES, real_maps};
use rtl_model::camera::View;
use rtl_model::maps::{Channel, HeightMap, MapSource, Pyramid};
use rtl_model::ray::{self, Ray};
use std::path::Path;

/// Calls `scene` with the name of each scene, its map, its rays and whether it is the main one: rocks,
/// oblique. The answer is what all calls gave.
pub fn for_each<T>(mut scene: impl FnMut(&str, &Pyramid, &[Ray<f64>], bool) -> Vec<T>) -> Vec<T> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = real_maps(&root).unwrap_or_else(|missing| panic!("{missing}"));
    if folder.is_none() {
        println!("no real height maps: procedural ones stand in (set STEPWELL_MAPS)");
    }
    let mut all = Vec::new();
    for surface in SURFACES {
        let map = match &folder {
            Some(folder) => HeightMap::load(&folder.join(surface.file), Channel::Alpha, false),
            None => stand_in(&surface).load(Channel::Grey, false),
        };
        let pyramid = Pyramid::new(&map.expect("a height map"));
        for (camera, view) in CAMERAS {
            let view = View::new(&view, &surface.surface, 1024, 768);
            let rays = view.rays(pyramid.size()).expect("rays within reach");
            let rays: Vec<Ray<f64>> = rays
                .into_iter()
                .flatten()
                .map(|ray| ray::check(ray, pyramid.size()).expect("a ray within reach"))
                .collect();
            let name = format!("{}, {camera}", surface.name);
            let is_main = surface.name == "rocks" && camera == "oblique";
            all.extend(scene(&name, &pyramid, &rays, is_main));
        }
    }
    all
}

fn stand_in(surface: &CalibratedSurface) -> MapSource {
    let recipe = match surface.name {
        "rocks" | "stones" => "rocks",
        "wall" => "bricks",
        "four" | "saint" => "spikes",
        _ => "mountain",
    };
    let source = format!("procedural:{recipe}:{}:1", surface.size);
    MapSource::parse(&source).expect("a procedural map")
}
