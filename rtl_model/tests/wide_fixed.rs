//! The wide and the window walk in exact fixed point are the very hit of the quantised ray: texel, depth and side,
//! whatever ties there are; they read what the exact reading reads; and a fault is seen.

use rtl_model::exact::exact_hit;
use rtl_model::maps::{HeightMap, Pyramid};
use rtl_model::ray::{REACH_TEXELS, Ray};
use rtl_model::ray_format::{QuantisedRay, RayFormat, RayRange};
use rtl_model::readings::{ExactReading, F64Reading, NumberFormat, enter};
use rtl_model::units::fixed_traverse::FixedHit;
use rtl_model::units::traverse::{Hit, Status};
use rtl_model::units::wide::{wide_shape_for, wide_walk};
use rtl_model::units::wide_fixed::wide_fixed_walk;
use rtl_model::units::wide_fixed_step::WideFixedShape;
use rtl_model::units::window::{window_fixed_walk, window_shape_for, window_walk};
use rtl_model::units::window_fixed_step::WindowFixedShape;

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

impl Read {
    fn fixed(self, pyramid: &Pyramid, format: RayFormat, ray: &QuantisedRay) -> FixedHit {
        let words = format.shape();
        match self {
            Read::Line { log2_side } => {
                let shape = WideFixedShape { words, log2_side };
                wide_fixed_walk(shape, pyramid.lines(log2_side), ray)
            }
            Read::Window => window_fixed_walk(WindowFixedShape { words }, pyramid, ray),
        }
    }

    fn walk<R: NumberFormat>(
        self,
        reading: &mut R,
        pyramid: &Pyramid,
        ray: Ray<R::Num>,
    ) -> Hit<R::Num> {
        match self {
            Read::Line { log2_side } => {
                let shape = wide_shape_for(pyramid, log2_side);
                wide_walk(reading, shape, pyramid.lines(log2_side), ray)
            }
            Read::Window => window_walk(reading, pyramid, ray),
        }
    }
}

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

    /// From 0 to below 1.
    fn fraction(&mut self) -> f64 {
        self.below(1 << 53) as f64 / (1_u64 << 53) as f64
    }
}

/// A map, half of the time low but for a few towers, so that walks get far; many heights are equal.
fn map(numbers: &mut Numbers, level: u32, bits: u32) -> HeightMap {
    let size = 1_u32 << level;
    let full = (1_u64 << bits) - 1;
    let sparse = numbers.below(2) == 0;
    let heights = (0..size * size).map(|_| {
        let fifteenths = numbers.below(16);
        let fifteenths = if sparse && numbers.below(16) > 0 {
            fifteenths / 8
        } else {
            fifteenths
        };
        (fifteenths * (full / 15)) as u16
    });
    let heights = heights.collect();
    HeightMap::new("any", size, bits, heights).expect("a square map")
}

/// A ray of any direction; one in two on a grid of quarter texels, where ties are.
fn ray(numbers: &mut Numbers, size: u32) -> Ray<f64> {
    let size = f64::from(size);
    if numbers.below(2) == 0 {
        // Slopes in quarters of a texel a height step of 8 bits keep their ties when quantised.
        let mut direction = || match numbers.below(8) {
            0 => 0.0,
            _ => (numbers.below(65) as f64 - 32.0) * 255.0 / (64.0 * size),
        };
        let (du, dv) = (direction(), direction());
        let mut entry = || numbers.below(4 * size as u64) as f64 / (4.0 * size);
        return Ray {
            u: entry(),
            v: entry(),
            du,
            dv,
        };
    }
    let length = (REACH_TEXELS / size).min(60.0) * 1000_f64.powf(-numbers.fraction());
    Ray {
        u: numbers.fraction(),
        v: numbers.fraction(),
        du: length * (2.0 * numbers.fraction() - 1.0),
        dv: length * (2.0 * numbers.fraction() - 1.0),
    }
}

fn check(
    map: &HeightMap,
    pyramid: &Pyramid,
    format: RayFormat,
    read: Read,
    admitted: Ray<f64>,
) -> Result<FixedHit, String> {
    let ray = format.quantise(admitted);
    let hit = read.fixed(pyramid, format, &ray);
    let truth = exact_hit(map, format.entered(&ray)).expect("a quantised ray");
    let full = i128::from(format.shape().full_height());
    let same_depth = i128::from(hit.depth_numerator) * truth.t.denominator
        == truth.t.numerator * i128::from(hit.depth_denominator) * full;
    let right = (hit.i, hit.j, hit.side) == (truth.i, truth.j, truth.side)
        && same_depth
        && hit.status == Status::Hit;
    if right {
        Ok(hit)
    } else {
        Err(format!("{ray:?}: {hit:?}, in truth {truth:?}"))
    }
}

#[test]
fn every_hit_is_that_of_the_definition() {
    let mut checked = 0;
    for seed in 1..=140_u64 {
        let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15 ^ (seed << 20));
        let bits = if seed % 3 == 0 { 16 } else { 8 };
        let map = map(&mut numbers, (seed % 8) as u32, bits);
        let pyramid = Pyramid::new(&map);
        for _ in 0..1_000 {
            let ray = ray(&mut numbers, map.size());
            let narrow = RayFormat::for_rays(&RayRange::of(ray), &pyramid);
            for format in [RayFormat::within_reach(&pyramid), narrow] {
                for read in READS {
                    check(&map, &pyramid, format, read, ray)
                        .unwrap_or_else(|fault| panic!("map {seed}, {read:?}: {fault}"));
                    checked += 1;
                }
            }
        }
    }
    assert_eq!(checked, 140 * 6_000);
}

#[test]
fn lines_read_are_those_of_the_exact_reading() {
    for seed in 1..=14_u64 {
        let mut numbers = Numbers(0xd1b5_4a32_d192_ed03 ^ (seed << 20));
        let map = map(&mut numbers, (seed % 7) as u32, 8);
        let pyramid = Pyramid::new(&map);
        let format = RayFormat::within_reach(&pyramid);
        for _ in 0..100 {
            let admitted = ray(&mut numbers, map.size());
            let entered = format.entered(&format.quantise(admitted));
            for read in READS {
                let hit = check(&map, &pyramid, format, read, admitted).unwrap();
                let mut exact = ExactReading::default();
                let ray = enter(&mut exact, entered);
                let walk = read.walk(&mut exact, &pyramid, ray);
                assert_eq!((hit.i, hit.j), (walk.i, walk.j));
                assert_eq!((hit.steps, hit.crossings), (walk.steps, walk.crossings));
                let t = hit.to_hit(format.shape(), &format.quantise(admitted)).t;
                assert!((t - exact.to_f64(walk.t)).abs() < 1e-15);
            }
        }
    }
}

#[test]
fn the_longest_walks_end_before_the_bound() {
    // The bottom of an empty map but for one height step in one texel that is never in the way:
    // every line is read down to the last level where towers stand everywhere but are never met.
    for (level, bits) in [(3, 8), (8, 8), (12, 16)] {
        let size = 1_u32 << level;
        let mut heights = vec![0_u16; (size * size) as usize];
        heights[0] = 1;
        let map = HeightMap::new("bottom", size, bits, heights).expect("a map");
        let pyramid = Pyramid::new(&map);
        let reach = REACH_TEXELS / f64::from(size);
        for (du, dv) in [(reach, reach), (reach, 0.37 * reach), (-reach, 0.0)] {
            let ray = Ray {
                u: 0.51 / f64::from(size),
                v: 0.53,
                du,
                dv,
            };
            let format = RayFormat::within_reach(&pyramid);
            for read in READS {
                let bound = match read {
                    Read::Line { log2_side } => wide_shape_for(&pyramid, log2_side).step_bound(),
                    Read::Window => window_shape_for(&pyramid).step_bound(),
                };
                let fixed = check(&map, &pyramid, format, read, ray).expect("a hit");
                let hit = read.walk(&mut F64Reading, &pyramid, ray);
                assert_eq!(hit.status, Status::Hit);
                assert!(fixed.steps < bound && hit.steps < bound, "{read:?}");
            }
        }
    }
}

/// A map whose lines are not those of the map judged by: one height raised, then one lowered.
#[test]
fn the_check_sees_a_height_that_is_wrong_in_the_lines() {
    let mut numbers = Numbers(77);
    let map = map(&mut numbers, 4, 8);
    let mut seen = 0;
    for change in [255_u16, 0] {
        let mut heights = map.heights().to_vec();
        heights[37] = change;
        let other = HeightMap::new("other", map.size(), 8, heights).expect("a map");
        let pyramid = Pyramid::new(&other);
        let format = RayFormat::within_reach(&pyramid);
        let faults = (0..4_000).filter(|_| {
            let ray = ray(&mut numbers, map.size());
            READS
                .iter()
                .any(|&read| check(&map, &pyramid, format, read, ray).is_err())
        });
        seen += usize::from(faults.count() > 0);
    }
    assert!(seen > 0, "no fault was seen");
}
