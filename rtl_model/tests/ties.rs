//! Rays on a coarse grid: they start on texel borders, run through corners and along borders, and
//! reach depths exactly at crossings, so that every rule for ties is asked for; by every method that
//! looks at a node a step.

use proptest::prelude::*;
use rtl_model::exact::exact_hit;
use rtl_model::float::FloatFormat;
use rtl_model::maps::{HeightMap, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::readings::{E7F16, ExactReading, F64Reading, FloatReading, NumberFormat, enter};
use rtl_model::scene::{Family, Method};
use rtl_model::units::search_policy::{Ascent, SearchPolicy, Start};
use rtl_model::units::traverse::{Status, walk};
use std::cmp::Ordering;

/// Texels on a side of the maps, most of the time.
const SIZE: u32 = 8;

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

/// Heights of which many are equal: 16 different ones, so that depths meet crossings. Every second
/// map is low but for a few towers, so that walks get far and go up.
fn map(seed: u64, size: u32) -> HeightMap {
    let mut state = seed;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 56) as u16
    };
    let sparse = next() < 128;
    let heights = (0..size * size).map(|_| {
        let random = next();
        let low = sparse && random & 15 > 1;
        // 255 is 15 * 17: the heights are sixteenths of the way in 255ths.
        (random >> 4) / if low { 8 } else { 1 } * 17
    });
    HeightMap::new("ties", size, 8, heights.collect()).expect("a square map")
}

/// Rays in 4ths of a texel of an 8 x 8 map.
fn ray(state: &mut u64) -> Ray<f64> {
    let mut next = |count: u64| {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        (*state % count) as f64
    };
    Ray {
        u: next(32) / 32.0,
        v: next(32) / 32.0,
        du: (next(129) - 64.0) / 32.0,
        dv: (next(129) - 64.0) / 32.0,
    }
}

#[derive(Debug, Default, PartialEq)]
struct Verdict {
    wrong: u32,
    late: u32,
    guards: u32,
}

fn judge<R: NumberFormat>(
    reading: &mut R,
    policy: SearchPolicy,
    map: &HeightMap,
    rays: u32,
    seed: u64,
) -> Verdict {
    let pyramid = Pyramid::new(map);
    let mut state = seed;
    let mut verdict = Verdict::default();
    for _ in 0..rays {
        reading.forget();
        let ray = ray(&mut state);
        let entered = enter(reading, ray);
        let hit = walk(reading, policy, &pyramid, pyramid.memory(), entered);
        let truth = exact_hit(map, ray).expect("a ray of the grid");
        let is_wrong = (hit.i, hit.j) != (truth.i, truth.j);
        let is_late = truth.t.compare_with(reading.to_f64(hit.t)) == Ordering::Less;
        verdict.wrong += u32::from(is_wrong);
        verdict.late += u32::from(is_late);
        verdict.guards += u32::from(hit.status == Status::Guard);
    }
    verdict
}

#[test]
fn the_exact_walk_knows_every_tie() {
    for (method, policy) in policies() {
        for seed in 1..=6 {
            let reading = &mut ExactReading::default();
            let verdict = judge(reading, policy, &map(seed, SIZE), 400, seed);
            assert_eq!(
                (verdict.wrong, verdict.guards),
                (0, 0),
                "{method}, map and rays of seed {seed}"
            );
        }
    }
}

#[test]
fn the_exact_walk_knows_every_tie_on_maps_of_any_size() {
    for (method, policy) in policies() {
        for level in 0..=5 {
            let reading = &mut ExactReading::default();
            let verdict = judge(reading, policy, &map(9, 1 << level), 200, 7);
            assert_eq!(
                (verdict.wrong, verdict.guards),
                (0, 0),
                "{method}, level {level}"
            );
        }
    }
}

#[test]
fn no_float_is_late_at_a_tie() {
    // e5f10 holds the bounds for maps of up to 8 x 8 texels (docs/architecture.md).
    let others = [FloatFormat::new(8, 23), FloatFormat::new(5, 10)];
    for (method, policy) in policies() {
        for seed in 1..=10 {
            let map = map(seed, SIZE);
            let place = format!("{method}, map and rays of seed {seed}");
            let verdict = judge(&mut FloatReading(E7F16), policy, &map, 5_000, seed);
            assert_eq!((verdict.late, verdict.guards), (0, 0), "e7f16: {place}");
            for format in others {
                let verdict = judge(&mut FloatReading(format), policy, &map, 1_000, seed);
                assert_eq!((verdict.late, verdict.guards), (0, 0), "{format}: {place}");
            }
        }
    }
}

/// Rounding to nearest loses ties, which is seen; no walk may hang for it.
#[test]
fn f64_ends_at_every_tie() {
    let mut wrong = 0;
    for (method, policy) in policies() {
        for seed in 1..=10 {
            let verdict = judge(&mut F64Reading, policy, &map(seed, SIZE), 5_000, seed);
            assert_eq!(verdict.guards, 0, "{method}, seed {seed}");
            wrong += verdict.wrong;
        }
    }
    println!("f64: {wrong} of 650 000 walks end in a wrong texel");
    assert!(wrong < 6_500, "{wrong} wrong texels");
}

/// Over a flat bottom a walk goes down from its start node and crosses, nothing else: so its steps tell
/// where it started. Held against the rule in plain integers, not mirrored.
#[test]
fn a_walk_starts_at_the_lowest_node_that_holds_the_ray() {
    const LEVEL: u32 = 6;
    let size = f64::from(1_u32 << LEVEL);
    let map = HeightMap::new("flat", 1 << LEVEL, 8, vec![0; 1 << (2 * LEVEL)]).expect("a map");
    let pyramid = Pyramid::new(&map);
    let Family::Nodes(policy) = Method::StartLevel.family() else {
        panic!("a method that looks at nodes");
    };
    let mut seen = [0; LEVEL as usize + 1];
    for n in 0..2_000 {
        let n = f64::from(n);
        let length = 2_f64.powf(-4.0 + 4.0 * (n * 0.37).sin());
        let ray = Ray {
            u: (n * 0.618_034).fract(),
            v: (n * 0.414_214).fract(),
            du: length * (n * 0.7).sin(),
            dv: length * (n * 1.3).cos(),
        };
        let texels = |entry: f64, offset: f64| {
            let exit = ((entry + offset) * size).floor() as i64;
            ((entry * size).floor() as i64, exit)
        };
        let (i, j) = (texels(ray.u, ray.du), texels(ray.v, ray.dv));
        let stays = [i.1, j.1].iter().all(|exit| (0..1 << LEVEL).contains(exit));
        let different = (i.0 ^ i.1).max(j.0 ^ j.1);
        let level = if stays {
            64 - different.leading_zeros()
        } else {
            LEVEL
        };
        let hit = walk(&mut F64Reading, policy, &pyramid, pyramid.memory(), ray);
        assert_eq!(hit.steps - hit.crossings - 1, level, "{ray:?}");
        assert!(hit.crossings == 0 || !stays, "{ray:?}");
        seen[level as usize] += 1;
    }
    assert!(seen.iter().all(|&rays| rays > 20), "{seen:?}");
}

/// What of the steps is no crossing went down: from the root, and once more for each ascent.
#[test]
fn ascents_are_paid_by_crossings() {
    let map = map(2, 32);
    let pyramid = Pyramid::new(&map);
    for (method, policy) in policies() {
        let mut state = 5;
        let mut ascents = 0;
        for _ in 0..500 {
            let ray = ray(&mut state);
            let hit = walk(&mut F64Reading, policy, &pyramid, pyramid.memory(), ray);
            let down = hit.steps - hit.crossings;
            match (policy.start, policy.ascent, policy.levels_down) {
                (Start::Texel, ..) => assert_eq!(down, 1),
                (Start::Root, Ascent::Never, 1) => assert_eq!(down, 6),
                (Start::Root, Ascent::Never, levels) => assert!(down <= 6 && levels > 1),
                _ => {
                    assert!(down <= 6 + hit.crossings, "{method}");
                    ascents += down.saturating_sub(6);
                }
            }
        }
        let goes_up = policy.ascent != Ascent::Never;
        assert_eq!(ascents > 0, goes_up, "{method}: {ascents} ascents");
    }
}

/// The judge would see it: the highest of the children is not what an inner node says.
#[test]
fn a_pyramid_that_is_too_low_is_late() {
    let map = map(1, SIZE);
    let pyramid = Pyramid::new(&map);
    let mut too_low = pyramid.memory().to_vec();
    let texels = too_low.len() / 2;
    for height in &mut too_low[1..texels] {
        *height /= 2;
    }
    for (method, policy) in policies() {
        let mut state = 1;
        let reading = &mut FloatReading(E7F16);
        let late = (0..1_000).filter(|_| {
            let ray = ray(&mut state);
            let entered = enter(reading, ray);
            let hit = walk(reading, policy, &pyramid, &too_low, entered);
            let truth = exact_hit(&map, ray).expect("a ray of the grid");
            truth.t.compare_with(reading.to_f64(hit.t)) == Ordering::Less
        });
        let late = late.count();
        match method {
            Method::Texel => assert_eq!(late, 0, "texel reads no inner node"),
            _ => assert!(late > 10, "{method}: {late} late"),
        }
    }
}

proptest! {
    #[test]
    fn an_exact_hit_is_the_hit(
        seed in 1_u64..1 << 40,
        map_seed in 0_u64..1 << 40,
        level in 0_u32..5,
        method in 0_usize..13,
    ) {
        let (_, policy) = policies()[method];
        let reading = &mut ExactReading::default();
        let verdict = judge(reading, policy, &map(map_seed, 1 << level), 16, seed);
        prop_assert_eq!((verdict.wrong, verdict.guards), (0, 0));
    }
}
