//! A slice of the comparison of exact walks with the texels one by one, faults that it catches, and
//! its judge against the exact reference.

use std::path::Path;

use campaigns::walks::{
    RaySource, Variant, WalkScene, compare, departures, height_maps, texel_walk,
};
use rtl_model::exact::exact_hit;
use rtl_model::scene::{Family, Method};
use rtl_model::units::fixed_traverse::FixedHit;

fn scenes(variants: &[Variant], most_maps: usize) -> Vec<WalkScene> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let (maps, _) = height_maps(&workspace).unwrap();
    let mut scenes = Vec::new();
    for &variant in variants {
        for (map, surface) in maps.iter().take(most_maps) {
            scenes.push(WalkScene::new(map, *surface, variant).unwrap());
        }
    }
    scenes
}

fn methods() -> Vec<Method> {
    let safe = |method: &Method| !matches!(method.family(), Family::Linear(_));
    Method::ALL.into_iter().filter(safe).collect()
}

#[test]
fn exact_walks_agree() {
    for scene in scenes(&Variant::ALL, 2) {
        let rays = RaySource::new(&scene, 3);
        let outcome = compare(&scene, &rays, &methods(), 3_000, &|_| {}, |hit, _| hit);
        assert_eq!(outcome.first, [], "{}", scene.map.name());
        assert_eq!((outcome.cases, outcome.differences), (3_000, 0));
    }
}

#[test]
fn a_wrong_hit_is_caught() {
    let scene = &scenes(&[Variant::Own], 1)[0];
    let rays = RaySource::new(scene, 3);
    let faults: [fn(FixedHit) -> FixedHit; 4] = [
        |hit| FixedHit {
            i: hit.i ^ 1,
            ..hit
        },
        |hit| FixedHit {
            side: !hit.side,
            ..hit
        },
        |hit| FixedHit {
            depth_numerator: hit.depth_numerator + 1,
            ..hit
        },
        |hit| FixedHit {
            status: rtl_model::units::traverse::Status::Guard,
            ..hit
        },
    ];
    for fault in faults {
        let alter = |hit, number| if number == 777 { fault(hit) } else { hit };
        let outcome = compare(scene, &rays, &methods(), 1_000, &|_| {}, alter);
        assert_eq!((outcome.differences, outcome.first[0].index), (1, 777));
    }
}

/// The quick judge says what the exact reference says.
#[test]
fn the_judge_is_the_exact_reference() {
    let mut sides = 0;
    for scene in scenes(&Variant::ALL, 3) {
        let rays = RaySource::new(&scene, 5);
        for number in 0..2_000 {
            let (ray, _) = rays.ray(number);
            let hit = texel_walk(&scene.map, rays.format(), &ray);
            let truth = exact_hit(&scene.map, rays.format().entered(&ray)).unwrap();
            assert_eq!(
                (hit.i, hit.j, hit.side),
                (truth.i, truth.j, truth.side),
                "{ray:?}"
            );
            let full_height = i128::from(scene.map.max_height());
            let (numerator, denominator) = (
                i128::from(hit.depth_numerator),
                i128::from(hit.depth_denominator) * full_height,
            );
            // Lowest terms of either, since the cross products would be too long.
            assert_eq!(
                lowest(numerator, denominator),
                lowest(truth.t.numerator, truth.t.denominator),
                "{ray:?}"
            );
            sides += u32::from(hit.side);
        }
    }
    assert!(sides > 1_000, "{sides} hits on a side");
}

fn lowest(numerator: i128, denominator: i128) -> (i128, i128) {
    let (mut a, mut b) = (numerator, denominator);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    (numerator / a, denominator / a)
}

/// Quantising changes few texels, and some: the rays are quantised.
#[test]
fn quantising_changes_few_texels() {
    let (mut all, mut changed) = (0, 0);
    for scene in scenes(&[Variant::Own], 7) {
        let rays = RaySource::new(&scene, 7);
        let departure = departures(&scene, &rays, 10_000, &|_| {});
        assert_eq!(departure.rays, 10_000);
        all += departure.rays;
        changed += departure.texels;
    }
    assert!(changed > 0 && changed * 1_000 < all, "{changed} of {all}");
}
