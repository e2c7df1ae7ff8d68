//! A scene from its file to its pictures, with the simplest marcher there is in place of a unit.

use std::path::Path;

use rtl_model::maps::{HeightMap, Pyramid};
use rtl_model::picture::{Frame, PixelHit, depth_picture, save_png, shaded_picture, steps_picture};
use rtl_model::ray::Ray;
use rtl_model::scene::Scene;

/// The first of `steps` evenly spaced points on the ray that is inside a texel's box. The last point
/// is on the bottom, which is always a hit.
fn march(map: &HeightMap, ray: Ray<f64>, steps: u32) -> PixelHit {
    let size = f64::from(map.size());
    let point = |step: u32| {
        let t = f64::from(step) / f64::from(steps);
        (t, ray.u + t * ray.du, ray.v + t * ray.dv)
    };
    let texel = |position: f64| (position * size).floor() as i64;
    let inside = |&step: &u32| {
        let (t, u, v) = point(step);
        map.depth(texel(u), texel(v)) <= t
    };
    let step = (0..=steps).find(inside).unwrap_or(steps);
    let (t, u, v) = point(step);
    let wrapped = |position: f64| texel(position).rem_euclid(i64::from(map.size())) as u32;
    PixelHit {
        i: wrapped(u),
        j: wrapped(v),
        t,
        u,
        v,
        steps: step,
        crossings: 0,
    }
}

#[test]
fn a_scene_becomes_three_pictures() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/small.toml");
    let scene = Scene::load(&path).unwrap();
    let map = scene.load_map().unwrap();
    assert_eq!(Pyramid::new(&map).size(), map.size());
    let hits: Vec<Option<PixelHit>> = scene
        .view()
        .rays(map.size())
        .unwrap()
        .into_iter()
        .map(|ray| ray.map(|ray| march(&map, ray, 500)))
        .collect();
    let rays = hits.iter().flatten().count();
    let frame = Frame::new(scene.frame.width, scene.frame.height, hits).unwrap();
    assert_eq!(rays, frame.hits().iter().flatten().count());

    let shaded = shaded_picture(&frame, &map, &scene.surface, &scene.light);
    assert_eq!(shaded.dimensions(), (32, 24));
    let folder = tempfile::tempdir().unwrap();
    for (name, picture) in [
        ("shaded.png", shaded),
        ("steps.png", steps_picture(&frame, &scene.name, None)),
        ("depth.png", depth_picture(&frame, &scene.name, None)),
    ] {
        let file = folder.path().join(name);
        save_png(&picture, &file).unwrap();
        assert_eq!(image::open(&file).unwrap().into_rgb8(), picture);
        // Something is to be seen on it.
        let mut colours: Vec<_> = picture.pixels().map(|pixel| pixel.0).collect();
        colours.sort_unstable();
        colours.dedup();
        assert!(colours.len() > 20, "{name}: {}", colours.len());
    }
}
