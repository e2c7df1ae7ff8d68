//! No surface is stepped past: on every procedural map, for rays of any direction and length within
//! reach, in several float formats, by every method that looks at a node a step, no hit is later
//! than the exact one of the same ray, and every walk ends.

use rayon::prelude::*;
use rtl_model::exact::exact_hit;
use rtl_model::float::FloatFormat;
use rtl_model::maps::{Channel, MapSource, Pyramid};
use rtl_model::ray::{Ray, reach_in};
use rtl_model::readings::{FloatReading, NumberFormat, enter};
use rtl_model::scene::{Family, Method};
use rtl_model::units::search_policy::SearchPolicy;
use rtl_model::units::traverse::{Status, walk};
use std::cmp::Ordering;

/// Seeded numbers from 0 to 1.
struct Fractions(u64);

impl Fractions {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A ray of any direction; its length is as often a hundredth of the reach as all of it. One in
/// eight runs along an axis, one in eight close to the diagonal, where corners are near.
fn ray(fractions: &mut Fractions, reach: f64) -> Ray<f64> {
    let length = reach * 100_f64.powf(-fractions.next());
    let (mut du, mut dv) = (2.0 * fractions.next() - 1.0, 2.0 * fractions.next() - 1.0);
    match (8.0 * fractions.next()) as u32 {
        0 => dv = 0.0,
        1 => dv = du * (1.0 + 1e-3 * (fractions.next() - 0.5)),
        _ => {}
    }
    du *= length;
    dv *= length;
    Ray {
        u: fractions.next(),
        v: fractions.next(),
        du,
        dv,
    }
}

/// Every traversal that looks at a node a step, with its name.
fn policies() -> Vec<(Method, SearchPolicy)> {
    let levels = [1, 3, 4].map(Method::MultiLevelDown);
    let methods = Method::ALL.into_iter().chain(levels);
    let policies: Vec<_> = methods
        .filter_map(|method| match method.family() {
            Family::Nodes(policy) => Some((method, policy)),
            _ => None,
        })
        .collect();
    assert_eq!(policies.len(), 13);
    policies
}

#[test]
fn no_hit_is_later_than_the_exact_one() {
    const RAYS: u64 = 3_000;
    let formats = [
        (FloatFormat::E7F16, 16),
        (FloatFormat::E7F16, 256),
        (FloatFormat::new(8, 23), 64),
        (FloatFormat::new(7, 12), 32),
        // Its exponents suffice for no larger map (docs/architecture.md).
        (FloatFormat::new(5, 10), 8),
    ];
    let maps = ["bricks", "rocks", "spikes", "mountain", "checkerboard"];
    let subjects: Vec<(&str, FloatFormat, u64)> = maps
        .into_iter()
        .flat_map(|map| formats.map(|(format, size)| (map, format, size)))
        .collect();
    let policies = policies();
    let walks: u64 = subjects
        .par_iter()
        .map(|&(name, format, size)| {
            let source =
                MapSource::parse(&format!("procedural:{name}:{size}:5")).expect("a recipe");
            let map = source.load(Channel::Grey, false).expect("a procedural map");
            let pyramid = Pyramid::new(&map);
            // A long walk in small texels takes the exact reference long: a few repeats will do.
            let reach = (reach_in(format.fraction_bits) / size as f64).min(24.0);
            let mut fractions = Fractions(0x9e37_79b9_7f4a_7c15 ^ size);
            let mut reading = FloatReading(format);
            let mut walks = 0;
            for number in 0..RAYS {
                let ray = enter(&mut reading, ray(&mut fractions, reach));
                let entered = ray.map(|value| reading.to_f64(value));
                let truth = exact_hit(&map, entered).expect("a ray within reach");
                for &(method, policy) in &policies {
                    let hit = walk(&mut reading, policy, &pyramid, pyramid.memory(), ray);
                    let place = format!("{method} {name} {size} {format}, {number}: {entered:?}");
                    assert_eq!(hit.status, Status::Hit, "{place}");
                    let order = truth.t.compare_with(reading.to_f64(hit.t));
                    assert_ne!(
                        order,
                        Ordering::Less,
                        "{place}: {hit:?}, in truth {truth:?}"
                    );
                    walks += 1;
                }
            }
            walks
        })
        .sum();
    assert_eq!(walks, 25 * 13 * RAYS);
}
