//! The methods that sample: what they find where it is known, and that they end.

use rtl_model::exact::exact_hit;
use rtl_model::frame::{walk_rays, walk_scene};
use rtl_model::maps::{HeightMap, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::readings::F64Reading;
use rtl_model::scene::{Scene, Walk};
use rtl_model::units::linear_ray::{
    BINARY_STEPS, LINEAR_SAMPLES, LinearRay, SampleRange, pom_samples,
};
use rtl_model::units::linear_walk::relief_walk;
use rtl_model::units::traverse::{Hit, Status};
use std::path::Path;

fn walk_of(method: &str, format: &str) -> Walk {
    Walk {
        method: method.parse().expect("a method"),
        format: format.parse().expect("a format"),
        crossing: Default::default(),
    }
}

fn walked(method: &str, format: &str, map: &HeightMap, rays: &[Ray<f64>]) -> Vec<Hit<f64>> {
    let walk = walk_of(method, format);
    walk_rays(walk, &Pyramid::new(map), rays, &|_| ()).expect("sound rays")
}

fn rays() -> Vec<Ray<f64>> {
    let ray = |n: f64| Ray {
        u: (n * 0.013).fract(),
        v: (n * 0.029).fract(),
        du: (n * 0.7).sin() * 2.0,
        dv: (n * 1.3).cos() * 2.0,
    };
    (0..400).map(f64::from).map(ray).collect()
}

fn rocks() -> HeightMap {
    let source = "procedural:rocks:32:3".parse::<rtl_model::maps::MapSource>();
    let map = source.expect("a recipe").load(Default::default(), false);
    map.expect("a procedural map")
}

fn flat(height: u16) -> HeightMap {
    HeightMap::new("flat", 4, 8, vec![height; 16]).expect("a map")
}

#[test]
fn every_search_ends_in_a_texel_whose_top_it_has_passed() {
    let (map, rays) = (rocks(), rays());
    for format in ["f64", "exact", "e7f16", "e8f23", "e5f10"] {
        let hits = walked("relief", format, &map, &rays);
        assert_eq!(hits.len(), 400);
        for hit in hits {
            let depth = f64::from(255 - map.height(hit.i.into(), hit.j.into())) / 255.0;
            // At the last sample, which a format may round upwards, there need not be a surface.
            let is_last = hit.t > 0.99;
            assert!(hit.t >= depth - 1e-3 || is_last, "{format} {hit:?} {depth}");
            let range = BINARY_STEPS + 1..=BINARY_STEPS + LINEAR_SAMPLES;
            assert!(range.contains(&hit.steps), "{format} {hit:?}");
            assert_eq!((hit.status, hit.crossings), (Status::Hit, 0), "{format}");
        }
        for (hit, &ray) in walked("pom", format, &map, &rays).iter().zip(&rays) {
            // The number of samples is that of the ray as the format has it.
            assert!(hit.steps <= pom_samples(ray, 0.125) + 1, "{format} {hit:?}");
            assert!((0.0..=1.0).contains(&hit.t) && hit.status == Status::Hit);
        }
    }
}

#[test]
fn a_flat_map_is_found_to_a_binary_step_and_by_the_secant_at_once() {
    let (map, depth) = (flat(128), 127.0 / 255.0);
    for format in ["f64", "exact", "e7f16"] {
        for hit in walked("relief", format, &map, &rays()) {
            let finest = 1.0 / f64::from(LINEAR_SAMPLES << BINARY_STEPS);
            assert!(
                hit.t >= depth - 1e-4 && hit.t <= depth + finest + 1e-4,
                "{format} {hit:?}"
            );
            assert_eq!(hit.steps, 50 + BINARY_STEPS);
        }
        for hit in walked("pom", format, &map, &rays()) {
            assert!((hit.t - depth).abs() < 1e-3, "{format} {hit:?}");
        }
    }
    // A surface above the first sample has no line but from the top.
    for hit in walked("pom", "exact", &flat(254), &rays()) {
        assert_eq!((hit.t, hit.steps), (0.0, 1));
    }
}

#[test]
fn the_bottom_is_a_hit_in_every_format() {
    for format in ["f64", "exact", "e7f16", "e4f3", "e2f2"] {
        for method in ["relief", "pom"] {
            let steep = rays().into_iter().map(|ray| Ray {
                du: ray.du / 256.0,
                dv: ray.dv / 256.0,
                ..ray
            });
            let steep: Vec<_> = steep.collect();
            let hits = walked(method, format, &flat(0), &steep);
            assert!(hits.iter().all(|hit| hit.status == Status::Hit), "{format}");
        }
    }
}

/// What is not promised does not hold: a thin tower between two samples is passed through.
#[test]
fn a_thin_tower_is_missed() {
    let mut heights = vec![0; 256 * 256];
    heights[100] = 255;
    let map = HeightMap::new("tower", 256, 8, heights).expect("a map");
    // A hundredth of the depth is 2.56 texels: texel 100 lies between samples 38 and 39.
    let ray = Ray {
        u: 1.5 / 256.0,
        v: 0.0,
        du: 1.0,
        dv: 0.0,
    };
    let truth = exact_hit(&map, ray).expect("a ray");
    assert_eq!((truth.i, truth.side), (100, true));
    let hits = ["relief", "pom", "oh"].map(|method| walked(method, "f64", &map, &[ray])[0]);
    assert!(hits[0].i != 100 && hits[1].i != 100, "{hits:?}");
    assert_eq!(hits[2].i, 100);
}

fn small_scene(method: &str, format: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/small.toml");
    let mut scene = Scene::load(&path).expect("a scene of the repository");
    scene.walk = walk_of(method, format);
    scene
}

#[test]
fn a_frame_does_not_depend_on_the_threads() {
    for method in ["relief", "pom", "dig"] {
        let scene = small_scene(method, "e7f16");
        let pyramid = Pyramid::new(&scene.load_map().expect("its map"));
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.expect("threads");
            pool.install(|| walk_scene(&scene, &pyramid, &|_| ()))
                .expect("sound rays")
        });
        assert_eq!(one, three, "{method}");
        assert!(one.counts.rays > 600 && one.counts.guards == 0, "{method}");
    }
}

/// The confined search saves steps, corner rays counted, and finds what the whole search finds
/// where its interval holds it: that of most pixels.
#[test]
fn a_depth_interval_grid_saves_steps() {
    let [dig, relief] = ["dig", "relief"].map(|method| {
        let mut scene = small_scene(method, "f64");
        (scene.frame.width, scene.frame.height) = (320, 240);
        let pyramid = Pyramid::new(&scene.load_map().expect("its map"));
        walk_scene(&scene, &pyramid, &|_| ()).expect("sound rays")
    });
    let pairs = dig.hits.iter().flatten().zip(relief.hits.iter().flatten());
    let same = pairs.filter(|(a, b)| (a.i, a.j) == (b.i, b.j)).count() as u64;
    assert!(
        same * 100 > dig.counts.rays * 90,
        "{same} of {}",
        dig.counts.rays
    );
    assert!(same < dig.counts.rays, "intervals that confine nothing");
    assert!(
        dig.counts.steps * 4 < relief.counts.steps * 3,
        "{} steps, {} without a grid",
        dig.counts.steps,
        relief.counts.steps
    );
}

/// The corner rays around a listed ray, two texels away, see the ground and not the tower that the
/// ray meets: it is searched too deep. Where they see the tower's top, the search is `relief`'s, in
/// fewer steps.
#[test]
fn a_listed_ray_is_confined_by_the_block_around_it() {
    let tower = |side: i32| {
        let is_tower = |texel: i32| (8 - side..=8 + side).contains(&texel);
        let heights = (0..256).map(|place| match is_tower(place % 16) && is_tower(place / 16) {
            true => 204,
            false => 51,
        });
        HeightMap::new("tower", 16, 8, heights.collect()).expect("a map")
    };
    let ray = Ray {
        u: 8.5 / 16.0,
        v: 8.5 / 16.0,
        du: 0.001,
        dv: -0.001,
    };
    for format in ["f64", "exact", "e7f16"] {
        let [relief, dig] =
            ["relief", "dig"].map(|method| walked(method, format, &tower(1), &[ray])[0]);
        assert!((0.199..0.21).contains(&relief.t), "{format} {relief:?}");
        assert!((0.78..0.8).contains(&dig.t), "{format} {dig:?}");
        let [relief, dig] =
            ["relief", "dig"].map(|method| walked(method, format, &tower(2), &[ray])[0]);
        assert_eq!((dig.i, dig.j, dig.t), (relief.i, relief.j, relief.t));
        assert!(dig.steps < BINARY_STEPS + 5 && relief.steps > 20, "{dig:?}");
    }
}

#[test]
fn what_does_not_go_together_is_refused_with_the_reason() {
    let pyramid = Pyramid::new(&flat(1));
    let refused = |walk| {
        walk_rays(walk, &pyramid, &[], &|_| ())
            .unwrap_err()
            .to_string()
    };
    let message = refused(Walk {
        crossing: "offset:0.5".parse().expect("a crossing"),
        ..walk_of("relief", "f64")
    });
    assert!(message.contains("crosses no border"), "{message}");
    let message = refused(walk_of("pom", "fixed"));
    assert!(message.contains("fixed"), "{message}");
}

/// The judge sees a search that is not the method's: one with half the samples, and one that starts
/// too low.
#[test]
fn another_search_is_seen_to_be_another() {
    let (map, rays) = (rocks(), rays());
    let pyramid = Pyramid::new(&map);
    let wrong = |samples: SampleRange| {
        let wrong = rays.iter().filter(|&&ray| {
            let truth = exact_hit(&map, ray).expect("a ray");
            let ray = LinearRay::enter(&mut F64Reading, ray, samples);
            let hit = relief_walk(&mut F64Reading, &pyramid, &ray);
            (hit.i, hit.j) != (truth.i, truth.j)
        });
        wrong.count()
    };
    let all = SampleRange::whole(LINEAR_SAMPLES);
    let sound = wrong(all);
    let walked = walked("relief", "f64", &map, &rays);
    let truths = rays.iter().map(|&ray| exact_hit(&map, ray).expect("a ray"));
    let of_method = walked
        .iter()
        .zip(truths)
        .filter(|(hit, truth)| (hit.i, hit.j) != (truth.i, truth.j));
    assert_eq!(of_method.count(), sound);
    let half = wrong(SampleRange::whole(LINEAR_SAMPLES / 2));
    let low = wrong(SampleRange { first: 50, ..all });
    assert!(
        sound < half && half < low,
        "{sound}, {half} and {low} of 400"
    );
}
