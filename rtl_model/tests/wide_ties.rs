//! Wide and window walks where ties are: rays on a coarse grid that start on borders and run through corners and along
//! borders, over maps of equal heights, of every size from one texel on, and every ray of a small
//! set over every map of a small set.

use rtl_model::exact::exact_hit;
use rtl_model::maps::{HeightMap, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::readings::{E7F16, ExactReading, F64Reading, FloatReading, NumberFormat, enter};
use rtl_model::units::traverse::Status;
use rtl_model::units::wide::{wide_shape_for, wide_walk};
use rtl_model::units::window::window_walk;
use std::cmp::Ordering;

/// What is read in a step.
#[derive(Clone, Copy, Debug)]
enum Read {
    Line { log2_side: u32 },
    Window,
}

const READS: [Read; 3] = [
    Read::Line { log2_side: 1 },
    Read::Line { log2_side: 2 },
    Read::Window,
];

/// Seeded numbers.
struct Numbers(u64);

impl Numbers {
    /// From 0 to below `count`.
    fn below(&mut self, count: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 8) % count
    }
}

/// A map of heights of which many are equal: sixteenths of the way, so that depths meet crossings.
fn map(numbers: &mut Numbers, level: u32) -> HeightMap {
    let size = 1_u32 << level;
    // One map in two is low but for a few towers, so that walks get far.
    let sparse = numbers.below(2) == 0;
    let heights = (0..size * size).map(|_| {
        let sixteenths = numbers.below(16) as u16;
        if sparse && numbers.below(8) > 0 {
            sixteenths / 8
        } else {
            sixteenths
        }
    });
    let heights = heights.map(|sixteenths| sixteenths * 17).collect();
    HeightMap::new("ties", size, 8, heights).expect("a square map")
}

/// Rays in 4ths of a texel; some stand still on an axis or both.
fn ray(numbers: &mut Numbers, size: u32) -> Ray<f64> {
    let grid = f64::from(4 * size);
    let mut direction = || match numbers.below(8) {
        0 => 0.0,
        _ => (numbers.below(257) as f64 - 128.0) / grid,
    };
    let (du, dv) = (direction(), direction());
    let mut entry = || numbers.below(u64::from(4 * size)) as f64 / grid;
    Ray {
        u: entry(),
        v: entry(),
        du,
        dv,
    }
}

#[derive(Debug, Default, PartialEq)]
struct Verdict {
    rays: u64,
    wrong: u64,
    late: u64,
    guards: u64,
}

fn judge<R: NumberFormat>(
    reading: &mut R,
    read: Read,
    map: &HeightMap,
    rays: impl IntoIterator<Item = Ray<f64>>,
    verdict: &mut Verdict,
) {
    let pyramid = Pyramid::new(map);
    for ray in rays {
        reading.forget();
        let entered = enter(reading, ray);
        let hit = match read {
            Read::Line { log2_side } => {
                let shape = wide_shape_for(&pyramid, log2_side);
                wide_walk(reading, shape, pyramid.lines(log2_side), entered)
            }
            Read::Window => window_walk(reading, &pyramid, entered),
        };
        let truth = exact_hit(map, entered.map(|number| reading.to_f64(number)))
            .expect("a ray of the grid");
        let is_wrong = (hit.i, hit.j) != (truth.i, truth.j);
        verdict.rays += 1;
        verdict.wrong += u64::from(is_wrong);
        let is_late = truth.t.compare_with(reading.to_f64(hit.t)) == Ordering::Less;
        verdict.late += u64::from(is_late);
        verdict.guards += u64::from(hit.status == Status::Guard);
    }
}

/// The verdict over maps of every level to 6 and random rays of the grid.
fn judge_grid<R: NumberFormat>(reading: &mut R, read: Read, maps: u64, rays: u64) -> Verdict {
    let mut verdict = Verdict::default();
    for seed in 1..=maps {
        let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15 ^ (seed << 20));
        let map = map(&mut numbers, (seed % 7) as u32);
        let rays: Vec<_> = (0..rays).map(|_| ray(&mut numbers, map.size())).collect();
        judge(reading, read, &map, rays, &mut verdict);
    }
    verdict
}

#[test]
fn an_exact_wide_walk_knows_every_tie() {
    for read in READS {
        let verdict = judge_grid(&mut ExactReading::default(), read, 28, 200);
        assert_eq!(
            (verdict.wrong, verdict.guards),
            (0, 0),
            "{read:?}: {verdict:?}"
        );
        assert_eq!(verdict.rays, 28 * 200);
    }
}

#[test]
fn a_wide_walk_in_f64_is_right_on_the_grid() {
    for read in READS {
        let verdict = judge_grid(&mut F64Reading, read, 70, 4_000);
        assert_eq!(verdict.guards, 0, "{verdict:?}");
        // Quotients of grid numbers are rounded, and ties between them with it.
        assert!(verdict.wrong * 100 < verdict.rays, "{verdict:?}");
    }
}

#[test]
fn a_wide_walk_in_e7f16_is_never_late_at_a_tie() {
    for read in READS {
        let verdict = judge_grid(&mut FloatReading(E7F16), read, 70, 2_000);
        assert_eq!(
            (verdict.late, verdict.guards),
            (0, 0),
            "{read:?}: {verdict:?}"
        );
        assert!(verdict.wrong < verdict.rays / 10, "{verdict:?}");
    }
}

/// Every map of 2 x 2 texels with three heights, and every ray of a grid of half texels.
#[test]
fn every_ray_of_a_small_set_is_right_over_every_small_map() {
    let heights = [0_u16, 85, 255];
    for read in READS {
        let mut verdict = Verdict::default();
        for code in 0..81_u32 {
            let texels = (0..4).map(|n| heights[(code / 3_u32.pow(n) % 3) as usize]);
            let map = HeightMap::new("small", 2, 8, texels.collect()).expect("a map");
            let rays = (0..16).flat_map(|entry| {
                (0..49).map(move |direction| Ray {
                    u: f64::from(entry % 4) / 4.0,
                    v: f64::from(entry / 4) / 4.0,
                    du: f64::from(direction % 7 - 3) / 2.0,
                    dv: f64::from(direction / 7 - 3) / 2.0,
                })
            });
            judge(
                &mut FloatReading(E7F16),
                read,
                &map,
                rays.clone(),
                &mut verdict,
            );
            assert_eq!((verdict.late, verdict.guards), (0, 0), "map {code}");
            if code % 9 == 0 {
                let mut exact = Verdict::default();
                judge(&mut ExactReading::default(), read, &map, rays, &mut exact);
                assert_eq!((exact.wrong, exact.guards), (0, 0), "map {code}");
            }
        }
        assert_eq!(verdict.rays, 81 * 16 * 49);
    }
}
