//! The exact fixed-point walk is exact: on its quantised ray every policy finds the texel, the side
//! or top, and the very depth of the exact reference, and never ends at the step bound.

mod faulty;
mod judge;

use judge::{Draw, Scene, policies};
use proptest::prelude::*;
use rtl_model::fixed::FixedFormat;
use rtl_model::maps::{Channel, HeightMap, MapSource, Pyramid};
use rtl_model::ray::{REACH_TEXELS, Ray};
use rtl_model::ray_format::{QuantisedRay, RayFormat, RayRange};
use rtl_model::scene::{Crossing, Walk, WalkFormat};
use rtl_model::units::fixed_ranges::fixed_ranges;
use rtl_model::units::fixed_traverse::fixed_walk_in;
use rtl_model::walker::Walker;

/// Slopes with so many integer bits, entries with so many fraction bits.
fn told(integer_bits: u32, entry_bits: u32) -> impl Fn(&Pyramid) -> RayFormat {
    move |pyramid| {
        let format = FixedFormat::q(integer_bits, entry_bits + pyramid.bits());
        RayFormat::told(format, pyramid).expect("a format with a walk")
    }
}

fn quantised(u: i64, v: i64, du: i64, dv: i64) -> QuantisedRay {
    QuantisedRay {
        u,
        v,
        du,
        dv,
        saturated: false,
    }
}

/// Depths in sixteenths: 0 to 240, and the bottom.
fn sixteenths(draw: &mut Draw, size: u32, bits: u32) -> HeightMap {
    let heights = (0..size * size).map(|_| {
        let full = (1_u32 << bits) - 1;
        let depth = (draw.below(17) as u32) << (bits - 4);
        (full - depth.min(full)) as u16
    });
    HeightMap::new("sixteenths", size, bits, heights.collect()).unwrap()
}

/// Every ray of a small format, over every map of 2 x 2 texels whose depths are among three.
#[test]
fn every_ray_of_a_small_format_over_every_small_map() {
    let policies = policies();
    let depths = [0, 128, 255];
    let mut walks = 0;
    for code in 0..81_usize {
        let heights = (0..4).map(|texel| 255 - depths[code / 3_usize.pow(texel) % 3]);
        let map = HeightMap::new(&format!("map {code}"), 2, 8, heights.collect()).unwrap();
        // Entries in half texels, slopes of up to 7 / 512 texel a step: up to 4 texels.
        let scene = Scene::new(map, told(1, 1));
        for entry in 0..16 {
            let (u, v) = (entry % 4, entry / 4);
            for slopes in 0..9 * 9 {
                // Some that meet borders at the depths, and some that do not.
                let [du, dv] =
                    [slopes % 9, slopes / 9].map(|slope| [0, 1, 2, 4, 7, -1, -2, -4, -7][slope]);
                scene.check(&policies, &quantised(u, v, du, dv));
                walks += policies.len();
            }
        }
    }
    assert_eq!(walks, 81 * 16 * 81 * 14);
}

/// Rays on a grid, of slopes that meet borders at the depths of nodes: every tie there is.
#[test]
fn ties_are_those_of_the_definition() {
    let policies = policies();
    let mut draw = Draw(1);
    for seed in 0..40 {
        let (size, bits) = (
            [1, 2, 4, 8, 16][seed % 5],
            if seed % 3 == 0 { 16 } else { 8 },
        );
        let scene = Scene::new(sixteenths(&mut draw, size, bits), RayFormat::within_reach);
        let fraction_bits = scene.format.slope.fraction_bits;
        for _ in 0..1000 {
            // A sixteenth of the depth takes the ray so many quarters of a texel.
            let quarter_a_step = fraction_bits - bits + 4 - 2;
            let [du, dv] = [(); 2].map(|()| draw.around(12) << quarter_a_step);
            let entries = u64::from(size) * 4;
            let quarter = scene.format.entry_fraction_bits() - 2;
            let [u, v] = [(); 2].map(|()| draw.below(entries) << quarter);
            scene.check(&policies, &quantised(u, v, du, dv));
        }
    }
}

/// The same with diagonals, and with one axis that does not move.
#[test]
fn corners_and_borders_are_walked_along() {
    let policies = policies();
    let mut draw = Draw(2);
    for bits in [8, 16] {
        for seed in 0..20 {
            let size = [2, 4, 8, 32][seed % 4];
            let scene = Scene::new(sixteenths(&mut draw, size, bits), RayFormat::within_reach);
            let unit = 1 << scene.format.entry_fraction_bits();
            let slope = 1 + draw.below(scene.format.steepest() as u64 / 300);
            for n in 0..200 {
                let [u, v] = [(); 2].map(|()| draw.below(u64::from(size)) * unit);
                let off = draw.around(1);
                let (du, dv) = match n % 5 {
                    0 => (slope, slope),
                    1 => (-slope, slope + off),
                    2 => (0, draw.around(1) * slope),
                    3 => (draw.around(1) * slope, 0),
                    _ => (slope, -(slope >> 1)),
                };
                let (u, v) = (u, (v + off).rem_euclid(i64::from(size) * unit));
                scene.check(&policies, &quantised(u, v, du, dv));
            }
        }
    }
}

/// A map of 4096 x 4096, the ends of the reach, heights of both widths: the longest words.
#[test]
fn the_ends_of_the_reach_fit_the_words() {
    let policies = policies();
    let mut draw = Draw(3);
    for bits in [8, 16] {
        let size = 4096;
        // Nearly flat and deep, so that rays go far.
        let full = (1_u32 << bits) - 1;
        let heights = (0..size * size).map(|n: u32| {
            let noise = n.wrapping_mul(0x9e37_79b9) >> 16;
            if noise.is_multiple_of(4099) {
                full as u16
            } else {
                (noise & full) as u16 / 64
            }
        });
        let map = HeightMap::new("deep", size, bits, heights.collect()).unwrap();
        let scene = Scene::new(map, RayFormat::within_reach);
        let largest = (i64::from(size) << scene.format.entry_fraction_bits()) - 1;
        let reach = REACH_TEXELS / f64::from(size);
        let steepest = scene
            .format
            .quantise(Ray {
                u: 0.0,
                v: 0.0,
                du: reach,
                dv: 0.0,
            })
            .du;
        let entries = [0, largest, largest / 2 + 1];
        let slopes = [steepest, -steepest, steepest - 1, 1, -1, 0, steepest / 3];
        for n in 0..80 {
            let mut pick = |count: usize| draw.below(count as u64) as usize;
            let (u, v) = (entries[pick(3)], entries[pick(3)]);
            let (du, dv) = (slopes[pick(7)], slopes[pick(7)]);
            let few = if n < 20 {
                &policies[..]
            } else {
                &policies[1..4]
            };
            scene.check(few, &quantised(u, v, du, dv));
        }
    }
}

/// The most fraction bits that a format may have.
#[test]
fn the_finest_formats_fit_the_words() {
    let policies = policies();
    let mut draw = Draw(4);
    for (size, bits) in [(4, 8), (256, 8), (4096, 8), (16, 16), (4096, 16)] {
        let heights =
            (0..size * size).map(|n: u32| (n.wrapping_mul(0x9e37_79b9) >> (32 - bits)) as u16);
        let pyramid_map = HeightMap::new("noise", size, bits, heights.collect()).unwrap();
        let scene = Scene::new(pyramid_map, |pyramid| {
            let formats = (bits..50)
                .rev()
                .map(|fraction| FixedFormat::q(64 - fraction, fraction));
            let mut formats = formats.filter_map(|format| RayFormat::told(format, pyramid).ok());
            formats.next().expect("a finest format")
        });
        let entries = u64::from(size) << scene.format.entry_fraction_bits();
        let reach = REACH_TEXELS / f64::from(size);
        let steepest = scene
            .format
            .quantise(Ray {
                u: 0.0,
                v: 0.0,
                du: reach,
                dv: 0.0,
            })
            .du;
        for _ in 0..60 {
            let cut = draw.below(20);
            let ray = quantised(
                draw.below(entries),
                draw.below(entries),
                draw.around(steepest),
                draw.around(steepest >> cut),
            );
            scene.check(&policies, &ray);
        }
    }
}

/// The walk is the one that the float datapath takes where nothing is rounded: step by step.
#[test]
fn steps_are_those_of_the_exact_reading() {
    let mut draw = Draw(7);
    let mut ascents = 0;
    for (size, bits) in [(1, 8), (4, 8), (32, 8), (64, 16)] {
        let scene = Scene::new(sixteenths(&mut draw, size, bits), RayFormat::within_reach);
        let quarter = 1_i64 << (scene.format.entry_fraction_bits() - 2);
        for n in 0..60 {
            let step = if n % 2 == 0 { quarter } else { 1 };
            let entries = (u64::from(size) << scene.format.entry_fraction_bits()) / step as u64;
            let [u, v] = [(); 2].map(|()| draw.below(entries) * step);
            // Up to 24 texels.
            let quarter_a_step = scene.format.slope.fraction_bits - bits + 2;
            let [du, dv] = [(); 2].map(|()| match n % 3 {
                0 => draw.around(24) << quarter_a_step,
                _ => draw.around(24 << quarter_a_step),
            });
            let ray = quantised(u, v, du, dv);
            for (method, policy) in policies() {
                let walk = Walk {
                    method,
                    format: WalkFormat::Exact,
                    crossing: Crossing::Index,
                };
                let mut exact = Walker::new(walk, &scene.pyramid).expect("an exact walk");
                let expected = exact.walk(scene.format.entered(&ray));
                let hit = scene.walk(policy, &ray);
                assert_eq!(
                    (hit.i, hit.j, hit.steps, hit.crossings),
                    (expected.i, expected.j, expected.steps, expected.crossings),
                    "{method} over {size} x {size} texels: {ray:?}"
                );
                ascents += hit
                    .steps
                    .saturating_sub(scene.format.shape().root_level + 1 + hit.crossings);
            }
        }
    }
    assert!(ascents > 100, "{ascents} steps gone down again");
}

/// What a unit for some rays needs: every signal of every walk stays within its range.
#[test]
fn signals_stay_within_their_ranges() {
    let source: MapSource = "procedural:rocks:64:2".parse().unwrap();
    let map = source.load(Channel::Grey, false).unwrap();
    let pyramid = Pyramid::new(&map);
    let mut draw = Draw(6);
    let rays: Vec<Ray<f64>> = (0..60)
        .map(|_| {
            let mut part = || draw.below(1 << 30) as f64 / 2_f64.powi(30);
            let (u, v, du) = (part(), part(), 0.7 * part());
            Ray {
                u,
                v,
                du,
                dv: -0.2 * part(),
            }
        })
        .collect();
    let range = rays
        .iter()
        .copied()
        .map(RayRange::of)
        .reduce(RayRange::and)
        .unwrap();
    let format = RayFormat::for_rays(&range, &pyramid);
    let mut seen = 0;
    for (method, policy) in policies() {
        let ranges = fixed_ranges(&format, policy, &range);
        let mut watched = faulty::Watched(|name, value: i64| {
            let range = ranges[name];
            let value = i128::from(value);
            assert!(
                range.low <= value && value <= range.high,
                "{method}: {name} is {value}, not in {range:?}"
            );
            seen += 1;
        });
        for &ray in &rays {
            let ray = format.quantise(ray);
            fixed_walk_in(&mut watched, format.shape(), policy, pyramid.memory(), &ray);
        }
        // Rays that travel toward smaller v alone, over less than a map: narrower than any ray.
        assert_eq!(ranges["mirrored_v"].high.max(0), 0, "{method}");
        let widest = RayFormat::within_reach(&pyramid).shape().error_bits();
        assert!(ranges["next_error"].signed_bits() < widest);
    }
    assert!(seen > 100_000, "{seen} signals seen");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn a_hit_is_the_hit(
        source in "(rocks|spikes|checkerboard|bricks|mountain)", level in 4_u32..8, seed in 0_u64..99,
        u in 0.0..1.0_f64, v in 0.0..1.0_f64, du in -4.0..4.0_f64, dv in -4.0..4.0_f64,
        entry_bits in 0_u32..15, shallow: bool,
    ) {
        let source = format!("procedural:{source}:{}:{seed}", 1 << level);
        let source: MapSource = source.parse().expect("a recipe");
        let map = source.load(Channel::Grey, false).expect("a map");
        let scene = Scene::new(map, told(8, entry_bits));
        let part = if shallow { 1.0 } else { 0.03 };
        let ray = scene.format.quantise(Ray { u, v, du: du * part, dv: dv * part });
        prop_assert!(!ray.saturated);
        for (method, policy) in policies() {
            let hit = scene.walk(policy, &ray);
            let fault = scene.fault(policy, &ray, &hit);
            prop_assert_eq!(&fault, &None, "{}", method);
        }
    }

    #[test]
    fn a_hit_in_sixteen_bits_is_the_hit(
        seed: u64, level in 0_u32..6,
        u in 0.0..1.0_f64, v in 0.0..1.0_f64, du in -4.0..4.0_f64, dv in -4.0..4.0_f64,
        steep in 0_u32..12,
    ) {
        let mut draw = Draw(seed);
        let size = 1_u32 << level;
        let heights = (0..size * size).map(|_| (draw.below(65536) >> draw.below(8)) as u16);
        let map = HeightMap::new("sixteen bits", size, 16, heights.collect()).unwrap();
        let scene = Scene::new(map, RayFormat::within_reach);
        let part = 0.5_f64.powi(steep as i32);
        let ray = scene.format.quantise(Ray { u, v, du: du * part, dv: dv * part });
        for (method, policy) in policies() {
            let hit = scene.walk(policy, &ray);
            let fault = scene.fault(policy, &ray, &hit);
            prop_assert_eq!(&fault, &None, "{}", method);
        }
    }
}
