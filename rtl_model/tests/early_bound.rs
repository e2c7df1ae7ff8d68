//! No answer is earlier than its bound, and the bounds are not idle.

use rtl_model::early::{EarlyBound, MISSED_TEXEL_ULPS, SAME_TEXEL_ULPS};
use rtl_model::exact::{ExactHit, exact_hit};
use rtl_model::float::FloatFormat;
use rtl_model::maps::{Channel, HeightMap, MapSource, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::scene::{Crossing, Family, Method, Walk, WalkFormat};
use rtl_model::units::traverse::{Hit, Status};
use rtl_model::walker::Walker;
use std::cmp::Ordering;

/// Numbers that look random, 0 to below 1, in parts of a power of two.
struct Draw(u64);

impl Draw {
    fn part(&mut self, parts: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let fraction = ((mixed ^ (mixed >> 31)) >> 11) as f64 / 2_f64.powi(53);
        (fraction * parts).floor() / parts
    }

    /// Some at random, some on a grid that starts on borders and runs through corners, some nearly
    /// along a diagonal.
    fn ray(&mut self, number: u32, size: f64, most_texels: f64) -> Ray<f64> {
        let parts = if number % 3 == 1 {
            size * 4.0
        } else {
            2_f64.powi(40)
        };
        let (u, v) = (self.part(parts), self.part(parts));
        let mut direction = || {
            let texels = (self.part(parts * 4.0) * 2.0 - 1.0) * most_texels;
            let texels = if number % 3 == 1 {
                texels.round()
            } else {
                texels
            };
            texels / size
        };
        let (du, dv) = (direction(), direction());
        let dv = if number % 3 == 2 {
            du * (1.0 + dv / 4096.0)
        } else {
            dv
        };
        Ray { u, v, du, dv }
    }
}

/// The bounds of a format's answers, and what was found.
#[derive(Debug, Default)]
struct Found {
    /// Units in the last place of t, on the same texel.
    same: f64,
    /// Texels by which another texel was missed, in units of depth times the ray's travel.
    missed: f64,
    wrong: u32,
}

fn unit(format: FloatFormat, t: f64) -> f64 {
    let t = t.max(0.5_f64.powi(format.fraction_bits as i32));
    2_f64.powi(t.log2().floor() as i32 - format.fraction_bits as i32)
}

/// How far from the texel of a hit its ray is at the depth answered or where the surface begins,
/// whichever is further: on the axis further off, in texels.
fn missed(map: &HeightMap, ray: Ray<f64>, hit: &Hit<f64>) -> f64 {
    let size = f64::from(map.size());
    let depth = map.depth(hit.i.into(), hit.j.into()).max(hit.t);
    let off = |entry: f64, direction: f64, texel: u32| {
        let position = (entry + depth * direction) * size - f64::from(texel);
        // The copy of the texel that is nearest.
        let position = (position + size / 2.0).rem_euclid(size) - size / 2.0;
        (-position).max(position - 1.0).max(0.0)
    };
    off(ray.u, ray.du, hit.i).max(off(ray.v, ray.dv, hit.j))
}

fn look(format: FloatFormat, method: Method, map: &HeightMap, most_texels: f64) -> Option<Found> {
    let pyramid = Pyramid::new(map);
    let walk = Walk {
        method,
        format: WalkFormat::Float(format),
        crossing: Crossing::Index,
    };
    let mut walker = Walker::new(walk, &pyramid).ok()?;
    let mut draw = Draw(map.size().into());
    let mut found = Found::default();
    for number in 0..3000 {
        let ray = draw.ray(number, map.size().into(), most_texels);
        let ray = walker.admit(ray).expect("a ray within reach");
        let entered = walker.entered(ray);
        let hit = walker.walk(ray);
        assert_eq!(hit.status, Status::Hit);
        let truth: ExactHit = exact_hit(map, entered).expect("a ray of the format");
        let late = truth.t.compare_with(hit.t) == Ordering::Less;
        assert!(!late, "{method} in {format}: {entered:?}");
        let unit = unit(format, hit.t);
        if (hit.i, hit.j) == (truth.i, truth.j) {
            found.same = found.same.max((truth.t.to_f64() - hit.t) / unit);
        } else {
            let texels = entered.du.abs().max(entered.dv.abs()) * f64::from(map.size());
            found.missed = found
                .missed
                .max(missed(map, entered, &hit) / (unit * texels));
            found.wrong += 1;
        }
    }
    Some(found)
}

#[test]
fn no_float_answer_is_earlier_than_its_bound() {
    let mut all = Found::default();
    let mut looked_at = 0;
    for source in [
        "rocks:64:1",
        "spikes:64:2",
        "checkerboard:16:0",
        "bricks:256:3",
    ] {
        let source: MapSource = format!("procedural:{source}").parse().unwrap();
        let map = source.load(Channel::Grey, false).unwrap();
        for format in [
            FloatFormat::E7F16,
            FloatFormat::new(8, 12),
            FloatFormat::new(8, 23),
        ] {
            // Up to the reach of the coarser ones.
            let most_texels = [16.0, 200.0, 1000.0][looked_at % 3];
            for method in Method::ALL {
                if matches!(method.family(), Family::Linear(_)) {
                    continue;
                }
                let Some(found) = look(format, method, &map, most_texels) else {
                    continue;
                };
                assert!(
                    found.same <= SAME_TEXEL_ULPS.into()
                        && found.missed <= MISSED_TEXEL_ULPS.into(),
                    "{method} in {format} over {}: {found:?}",
                    map.name()
                );
                all.same = all.same.max(found.same);
                all.missed = all.missed.max(found.missed);
                all.wrong += found.wrong;
                looked_at += 1;
            }
        }
    }
    println!("{all:?} over {looked_at} walks of maps");
    // The bounds are met to within a few units, so a smaller one would be false.
    assert!(looked_at >= 12 && all.wrong > 20);
    assert!(all.same > 1.0 && all.missed > 1.0, "{all:?}");
}

#[test]
fn a_bound_says_what_it_promises() {
    let walk = |method: &str, format: &str, crossing: &str| Walk {
        method: method.parse().unwrap(),
        format: format.parse().unwrap(),
        crossing: crossing.parse().unwrap(),
    };
    for (method, format, crossing, part) in [
        ("oh", "exact", "index", "the very texel, t to the nearest"),
        ("oh", "fixed", "index", "the very texel, t rounded down"),
        ("oh", "f64", "index", "not promised in f64"),
        ("pom", "f64", "index", "this way of walking may miss"),
        ("oh", "e7f16", "offset:0.5", "this way of walking may miss"),
        (
            "oh",
            "e7f16",
            "index",
            "6 units in the last place of t (4.6e-5)",
        ),
        ("oh", "e7f16", "index", "missed by at most 6.1e-3 texels"),
    ] {
        let bound = EarlyBound::of(walk(method, format, crossing), 100.0).to_string();
        assert!(
            bound.contains(part),
            "{method} {format} {crossing}: {bound}"
        );
    }
}
