//! Rays on a coarse grid: they start on texel borders, run through corners and along borders, and
//! reach depths exactly at crossings, so that every rule for ties is asked for.

use proptest::prelude::*;
use rtl_model::exact::exact_hit;
use rtl_model::maps::{HeightMap, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::readings::{E7F16, ExactReading, FloatReading, NumberFormat, enter};
use rtl_model::units::search_policy::SearchPolicy;
use rtl_model::units::traverse::{Hit, Status, walk};
use std::cmp::Ordering;

/// Texels on a side of the maps.
const SIZE: u32 = 8;

/// Heights of which many are equal: 16 different ones, so that depths meet crossings.
fn map(seed: u64) -> HeightMap {
    let mut state = seed;
    let heights = (0..SIZE * SIZE).map(|_| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        // 255 is 15 * 17: the heights are sixteenths of the way in 255ths.
        (state >> 60) as u16 * 17
    });
    HeightMap::new("ties", SIZE, 8, heights.collect()).expect("a square map")
}

/// Rays in 32nds of the map, 4ths of a texel.
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

struct Verdict {
    wrong: u32,
    late: u32,
    guards: u32,
}

fn judge<R: NumberFormat>(reading: &mut R, map: &HeightMap, rays: u32, seed: u64) -> Verdict {
    let pyramid = Pyramid::new(map);
    let mut state = seed;
    let mut verdict = Verdict {
        wrong: 0,
        late: 0,
        guards: 0,
    };
    for _ in 0..rays {
        reading.forget();
        let ray = ray(&mut state);
        let entered = enter(reading, ray);
        let hit: Hit<R::Num> = walk(
            reading,
            SearchPolicy::OH,
            &pyramid,
            pyramid.memory(),
            entered,
        );
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
    for seed in 1..=8 {
        let verdict = judge(&mut ExactReading::default(), &map(seed), 2_000, seed);
        assert_eq!(
            (verdict.wrong, verdict.guards),
            (0, 0),
            "map and rays of seed {seed}"
        );
    }
}

#[test]
fn e7f16_is_never_late_at_a_tie() {
    for seed in 1..=20 {
        let verdict = judge(&mut FloatReading(E7F16), &map(seed), 20_000, seed);
        assert_eq!(
            (verdict.late, verdict.guards),
            (0, 0),
            "map and rays of seed {seed}"
        );
    }
}

proptest! {
    #[test]
    fn an_exact_hit_is_the_hit(seed in 1_u64..1 << 40, map_seed in 0_u64..1 << 40) {
        let verdict = judge(&mut ExactReading::default(), &map(map_seed), 16, seed);
        prop_assert_eq!((verdict.wrong, verdict.guards), (0, 0));
    }
}
