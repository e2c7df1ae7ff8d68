//! Wide and window walks step past no surface: on every procedural map, for rays of any direction and length
//! within reach, in several float formats, no hit of `quad`, `block` or `window` is later than the exact
//! one of the same ray, and every walk ends. Without its bounds a walk is late, and that is seen.

use rayon::prelude::*;
use rtl_model::arith::Arith;
use rtl_model::float::{FloatFormat, Rounding};
use rtl_model::judge::{Truth, Verdict};
use rtl_model::maps::{Channel, HeightMap, MapSource, Pyramid};
use rtl_model::ray::{Ray, reach_in};
use rtl_model::readings::{FloatReading, NumberFormat};
use rtl_model::scene::{Crossing, Method, WalkFormat};
use rtl_model::units::traverse::{Hit, Status};
use rtl_model::units::wide::{wide_shape_for, wide_walk};
use rtl_model::units::window::window_walk;

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
/// eight runs along an axis, one in four close to a diagonal through the corners of texels.
fn ray(fractions: &mut Fractions, reach: f64, size: u32) -> Ray<f64> {
    let length = reach * 100_f64.powf(-fractions.next());
    let (du, mut dv) = (2.0 * fractions.next() - 1.0, 2.0 * fractions.next() - 1.0);
    let (mut u, v) = (fractions.next(), fractions.next());
    match (8.0 * fractions.next()) as u32 {
        0 => dv = 0.0,
        1 => dv = du * (1.0 + 1e-3 * (fractions.next() - 0.5)),
        2 => {
            dv = -du;
            let texels = f64::from(size);
            u = (1.0 - v + (texels * u).floor() / texels).fract();
        }
        _ => {}
    }
    Ray {
        u,
        v,
        du: du * length,
        dv: dv * length,
    }
}

fn map(name: &str, size: u32) -> HeightMap {
    let source = MapSource::parse(&format!("procedural:{name}:{size}:5")).expect("a recipe");
    source.load(Channel::Grey, false).expect("a procedural map")
}

#[test]
fn no_hit_is_later_than_the_exact_one() {
    const RAYS: usize = 10_000;
    let formats = [
        (7, 16, 16),
        (7, 16, 256),
        (8, 23, 64),
        (7, 12, 32),
        (6, 18, 128),
    ];
    let maps = ["bricks", "rocks", "spikes", "mountain", "checkerboard"];
    let subjects: Vec<_> = maps
        .into_iter()
        .flat_map(|map| formats.map(|format| (map, format)))
        .collect();
    let verdicts: Verdict = subjects
        .par_iter()
        .map(|&(name, (exponent, fraction, size))| {
            let format = FloatFormat::new(exponent, fraction);
            let map = map(name, size);
            let pyramid = Pyramid::new(&map);
            // A long walk in small texels takes the exact reference long: a few repeats will do.
            let reach = (reach_in(fraction) / f64::from(size)).min(24.0);
            let mut fractions = Fractions(0x9e37_79b9_7f4a_7c15 ^ u64::from(size));
            let rays: Vec<_> = (0..RAYS)
                .map(|_| ray(&mut fractions, reach, size))
                .collect();
            let format = WalkFormat::Float(format);
            let truth = Truth::of(format, &map, &pyramid, &rays, &|_| ()).expect("a truth");
            assert_eq!(truth.refused(), 0);
            [Method::Quad, Method::Block, Method::Window]
                .into_iter()
                .map(|method| {
                    let verdict = truth
                        .judge_walk(method, Crossing::Index, &pyramid, &|_| ())
                        .expect("a verdict");
                    assert_eq!(
                        (verdict.late, verdict.guards),
                        (0, 0),
                        "{name} {size} {format} {method}: {verdict:?}"
                    );
                    verdict
                })
                .reduce(Verdict::plus)
                .expect("three methods")
        })
        .reduce(Verdict::default, Verdict::plus);
    assert_eq!(verdicts.rays as usize, 3 * 25 * RAYS);
    let wrong = verdicts.wrong_share().expect("a share");
    println!(
        "{} rays, {:.4} % in another texel, 0 late",
        verdicts.rays,
        100.0 * wrong
    );
}

/// Floats whose upper bounds are their lower ones.
struct Careless(FloatReading<FloatFormat>);

macro_rules! forward {
    ($($name:ident($($argument:ident: $type:ty),*) -> $result:ty;)*) => {
        $(fn $name(&mut self, $($argument: $type),*) -> $result {
            self.0.$name($($argument),*)
        })*
    };
}

impl Arith for Careless {
    type Num = u64;
    type Int = i64;
    type Bit = bool;

    fn ulps_up(&mut self, a: u64, _: u32) -> u64 {
        a
    }

    forward! {
        zero() -> u64;
        add(r: Rounding, a: u64, b: u64) -> u64;
        sub(r: Rounding, a: u64, b: u64) -> u64;
        mul(r: Rounding, a: u64, b: u64) -> u64;
        div(r: Rounding, a: u64, b: u64) -> u64;
        exact_below(a: u64) -> u64;
        negate_if(condition: bool, a: u64) -> u64;
        magnitude(a: u64) -> u64;
        is_negative(a: u64) -> bool;
        is_zero(a: u64) -> bool;
        less_than(a: u64, b: u64) -> bool;
        less_equal(a: u64, b: u64) -> bool;
        select(condition: bool, one: u64, zero: u64) -> u64;
        number_from_integer(r: Rounding, value: i64, exponent: i64) -> u64;
        scale(a: u64, exponent: i32) -> u64;
        floor(a: u64, bits: u32) -> i64;
        depth_from_height(height: i64, bits: u32) -> u64;
        int_constant(value: i64) -> i64;
        int_add(a: i64, b: i64) -> i64;
        int_sub(a: i64, b: i64) -> i64;
        int_shift_left(a: i64, amount: i64, amount_bits: u32) -> i64;
        int_shift_right(a: i64, amount: i64, amount_bits: u32) -> i64;
        int_mul(a: i64, b: i64) -> i64;
        int_bit_length(a: i64) -> i64;
        int_wrap(a: i64, bits: u32) -> i64;
        int_low_bits(a: i64, bits: u32) -> i64;
        int_and(a: i64, b: i64) -> i64;
        int_or(a: i64, b: i64) -> i64;
        int_xor(a: i64, b: i64) -> i64;
        int_complement_if(condition: bool, a: i64) -> i64;
        int_equal(a: i64, b: i64) -> bool;
        int_less_than(a: i64, b: i64) -> bool;
        int_select(condition: bool, one: i64, zero: i64) -> i64;
        int_from_bit(condition: bool) -> i64;
        bit_constant(value: bool) -> bool;
        and(a: bool, b: bool) -> bool;
        or(a: bool, b: bool) -> bool;
        not(a: bool) -> bool;
    }
}

impl NumberFormat for Careless {
    fn coordinate(&mut self, value: f64) -> u64 {
        self.0.coordinate(value)
    }
    fn direction(&mut self, value: f64) -> u64 {
        self.0.direction(value)
    }
    fn to_f64(&self, value: u64) -> f64 {
        self.0.to_f64(value)
    }
}

#[test]
fn a_walk_without_bounds_is_late_and_seen() {
    let format = FloatFormat::new(7, 12);
    // Sides of lines, and a window.
    for log2_side in [Some(1), Some(2), None] {
        let map = map("spikes", 32);
        let pyramid = Pyramid::new(&map);
        let mut fractions = Fractions(5);
        let rays: Vec<_> = (0..20_000).map(|_| ray(&mut fractions, 16.0, 32)).collect();
        let walk_format = WalkFormat::Float(format);
        let truth = Truth::of(walk_format, &map, &pyramid, &rays, &|_| ()).expect("a truth");
        let mut careless = Careless(FloatReading(format));
        let hits: Vec<_> = truth
            .rays()
            .iter()
            .map(|ray| {
                let entered = rtl_model::readings::enter(&mut careless, *ray);
                let hit = match log2_side {
                    None => window_walk(&mut careless, &pyramid, entered),
                    Some(side) => {
                        let shape = wide_shape_for(&pyramid, side);
                        wide_walk(&mut careless, shape, pyramid.lines(side), entered)
                    }
                };
                Hit {
                    i: hit.i,
                    j: hit.j,
                    t: careless.to_f64(hit.t),
                    u: careless.to_f64(hit.u),
                    v: careless.to_f64(hit.v),
                    steps: hit.steps,
                    crossings: hit.crossings,
                    status: Status::Hit,
                }
            })
            .collect();
        let verdict = truth.judge(&hits);
        assert!(verdict.late > 0, "{log2_side:?}: {verdict:?}");
    }
}
