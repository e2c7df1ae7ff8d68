//! The exact fixed-point walk is exact: on its quantised ray every policy finds the texel, the side
//! or top, and the very depth of the exact reference, and never ends at the step bound.

mod faulty;
mod judge;

use judge::{Draw, Scene, policies};
use proptest::prelude::*;
use rtl_model::fixed::FixedFormat;
use rtl_model::maps::{Channel, HeightMap, MapSource, Pyramid};
use rtl_model::ray::{REACH_TEXELS, Ray};
use rtl_model::ray_format::{QuantisedRay, RayFormat};

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

/// Every ray of a small format, over every map of 2 x 2 texels whose depths are among four.
#[test]
fn every_ray_of_a_small_format_over_every_small_map() {
    let policies = policies();
    let depths = [0, 64, 128, 255];
    let mut walks = 0;
    for code in 0..256_u32 {
        let heights = (0..4).map(|texel| 255 - depths[(code >> (2 * texel)) as usize % 4]);
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
    assert_eq!(walks, 256 * 16 * 81 * 14);
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
