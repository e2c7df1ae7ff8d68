//! A slice of the small worlds, by every method, and faults that it catches.

use campaigns::small_worlds::{MapSet, RaySet, World};
use rtl_model::float::FloatFormat;
use rtl_model::hard::Promise;
use rtl_model::scene::{Method, WalkFormat};
use rtl_model::units::traverse::Status;

const GRID: RaySet = RaySet::FourBits { entry_bits: 2 };

fn safe_methods() -> Vec<Method> {
    let levels = [1, 3, 4].map(Method::MultiLevelDown);
    let all = Method::ALL.into_iter().chain(levels);
    all.filter(|method| method.is_safe()).collect()
}

/// All promises are kept in a world by every method: so many rays were walked.
fn kept(format: &str, maps: MapSet, rays: RaySet) -> u64 {
    kept_by(&safe_methods(), format, maps, rays)
}

fn kept_by(methods: &[Method], format: &str, maps: MapSet, rays: RaySet) -> u64 {
    let world = World { maps, rays };
    let format: WalkFormat = format.parse().unwrap();
    let outcomes = world
        .judge(format, methods, &|_| {}, &|_, _, hit| hit)
        .unwrap();
    let place = format!("{format} in {}", world.name());
    for outcome in &outcomes {
        assert_eq!(outcome.unsupported, None, "{} {place}", outcome.method);
        assert_eq!(outcome.first, [""; 0], "{place}");
        assert_eq!(outcome.defects, 0, "{place}");
        assert_eq!(outcome.verdict.guards, 0, "{} {place}", outcome.method);
        assert_ne!(
            outcome.promise,
            Promise::Nothing,
            "{} {place}",
            outcome.method
        );
    }
    outcomes.iter().map(|outcome| outcome.verdict.rays).sum()
}

#[test]
fn floats_are_never_late() {
    let some = MapSet::every(399, 1);
    for format in ["e5f4", "e7f16"] {
        assert!(kept(format, MapSet::all(0), GRID) > 0);
        assert!(kept(format, some, GRID) >= 11 * 4096);
        assert!(kept(format, MapSet::sample(6, 1, 2), GRID) > 0);
    }
    // Every ray of a format is over a million: a node and a line a step stand for the others here.
    let (small, methods) = (FloatFormat::new(4, 2), [Method::Oh, Method::Block]);
    let rays = RaySet::AllOf(small);
    assert!(kept_by(&methods, "e4f2", MapSet::every(8, 0), rays) > 2_000_000);
}

#[test]
fn exact_formats_hit_the_very_texel() {
    assert!(kept("exact", MapSet::every(1999, 1), GRID) > 0);
    for (format, rays) in [("fixed", GRID), ("q4.10", RaySet::FixedPoint)] {
        kept(format, MapSet::all(0), rays);
        kept(format, MapSet::every(399, 1), rays);
        kept(format, MapSet::sample(6, 1, 2), rays);
    }
}

#[test]
fn f64_ends() {
    assert!(kept("f64", MapSet::every(399, 1), GRID) >= 11 * 4096);
}

/// A single ray's answer changed, in each way: another texel, a depth a unit too late, a guard.
#[test]
fn a_planted_fault_is_caught() {
    let world = World {
        maps: MapSet::every(1000, 1),
        rays: GRID,
    };
    let count = |format: &str, alter: campaigns::small_worlds::Alter<'_>| {
        let outcomes = world.judge(format.parse().unwrap(), &[Method::Oh], &|_| {}, alter);
        let outcome = &outcomes.unwrap()[0];
        assert_eq!(outcome.first.len() as u64, outcome.defects.min(8));
        outcome.defects
    };
    let is_chosen =
        |ray: &rtl_model::ray::Ray<f64>| (ray.u, ray.v, ray.du, ray.dv) == (0.25, 0.5, -0.25, 0.75);
    let maps = world.maps.count();
    for format in ["exact", "e7f16"] {
        assert_eq!(count(format, &|_, _, hit| hit), 0);
        let guard = count(format, &|_, ray, mut hit| {
            if is_chosen(ray) {
                hit.status = Status::Guard;
            }
            hit
        });
        assert_eq!(guard, maps);
        let late = count(format, &|_, ray, mut hit| {
            if is_chosen(ray) {
                hit.t = hit.t * (1.0 + 1e-3) + 1e-9;
            }
            hit
        });
        assert!(late > 0);
    }
    let elsewhere = |_: Method,
                     ray: &rtl_model::ray::Ray<f64>,
                     mut hit: rtl_model::units::traverse::Hit<f64>| {
        if is_chosen(ray) {
            hit.i ^= 1;
        }
        hit
    };
    assert_eq!(count("exact", &elsewhere), maps);
    assert_eq!(
        count("e7f16", &elsewhere),
        0,
        "early is no defect of a float"
    );
}
