//! Planted faults: a walk in which one comparison of a step takes ties the wrong way.

use crate::judge::{Draw, Scene, policies};
use crate::{quantised, sixteenths};
use rtl_model::arith::Arith;
use rtl_model::float::Rounding;
use rtl_model::ray_format::RayFormat;
use rtl_model::readings::F64Reading;
use rtl_model::units::fixed_traverse::fixed_walk_in;

/// Computes as [`F64Reading`] does, but for the comparison that gets a certain name: there a tie is
/// decided the other way. Names are given after the fact, so a first walk finds which comparison of
/// a step it is.
struct TieFlipped {
    name: &'static str,
    /// Comparisons since the step began, and that which has the name.
    comparison: usize,
    at: Option<usize>,
}

impl TieFlipped {
    fn new(name: &'static str) -> TieFlipped {
        TieFlipped {
            name,
            comparison: 0,
            at: None,
        }
    }
}

macro_rules! forward {
    ($($name:ident($($argument:ident: $type:ty),*) -> $result:ty;)*) => {
        $(fn $name(&mut self, $($argument: $type),*) -> $result {
            F64Reading.$name($($argument),*)
        })*
    };
}

/// Computes as [`F64Reading`] does, and tells every named integer.
pub struct Watched<W: FnMut(&'static str, i64)>(pub W);

/// All operators but the comparison of integers.
macro_rules! forward_all {
    () => {
        type Num = f64;
        type Int = i64;
        type Bit = bool;

        forward! {
            zero() -> f64;
            add(r: Rounding, a: f64, b: f64) -> f64;
            sub(r: Rounding, a: f64, b: f64) -> f64;
            mul(r: Rounding, a: f64, b: f64) -> f64;
            div(r: Rounding, a: f64, b: f64) -> f64;
            ulps_up(a: f64, ulps: u32) -> f64;
            exact_below(a: f64) -> f64;
            negate_if(condition: bool, a: f64) -> f64;
            magnitude(a: f64) -> f64;
            is_negative(a: f64) -> bool;
            is_zero(a: f64) -> bool;
            less_than(a: f64, b: f64) -> bool;
            less_equal(a: f64, b: f64) -> bool;
            select(condition: bool, one: f64, zero: f64) -> f64;
            number_from_integer(r: Rounding, value: i64, exponent: i64) -> f64;
            scale(a: f64, exponent: i32) -> f64;
            floor(a: f64, bits: u32) -> i64;
            depth_from_height(height: i64, bits: u32) -> f64;
            int_constant(value: i64) -> i64;
            int_add(a: i64, b: i64) -> i64;
            int_sub(a: i64, b: i64) -> i64;
            int_shift_left(a: i64, amount: i64, bits: u32) -> i64;
            int_shift_right(a: i64, amount: i64, bits: u32) -> i64;
            int_mul(a: i64, b: i64) -> i64;
            int_bit_length(a: i64) -> i64;
            int_wrap(a: i64, bits: u32) -> i64;
            int_low_bits(a: i64, bits: u32) -> i64;
            int_and(a: i64, b: i64) -> i64;
            int_or(a: i64, b: i64) -> i64;
            int_xor(a: i64, b: i64) -> i64;
            int_complement_if(condition: bool, a: i64) -> i64;
            int_equal(a: i64, b: i64) -> bool;
            int_select(condition: bool, one: i64, zero: i64) -> i64;
            int_from_bit(condition: bool) -> i64;
            bit_constant(value: bool) -> bool;
            and(a: bool, b: bool) -> bool;
            or(a: bool, b: bool) -> bool;
            not(a: bool) -> bool;
        }
    };
}

impl<W: FnMut(&'static str, i64)> Arith for Watched<W> {
    forward_all!();

    fn int_less_than(&mut self, a: i64, b: i64) -> bool {
        a < b
    }

    fn name_int(&mut self, name: &'static str, value: i64) {
        (self.0)(name, value);
    }
}

impl Arith for TieFlipped {
    forward_all!();

    fn int_less_than(&mut self, a: i64, b: i64) -> bool {
        let place = self.comparison;
        self.comparison += 1;
        if self.at == Some(place) {
            a <= b
        } else {
            a < b
        }
    }

    fn name_bit(&mut self, name: &'static str, _: bool) {
        if name == "ended" {
            self.comparison = 0;
        }
        if name == self.name && self.at.is_none() {
            self.at = Some(self.comparison - 1);
        }
    }
}

/// Faults found over the ties grid with ties of this comparison taken the wrong way.
fn faults_with(name: &'static str) -> usize {
    let mut draw = Draw(1);
    let mut faults = 0;
    for size in [2, 4, 8] {
        let scene = Scene::new(sixteenths(&mut draw, size, 8), RayFormat::within_reach);
        let quarter_a_step = scene.format.slope.fraction_bits - 8 + 4 - 2;
        for _ in 0..400 {
            let [du, dv] = [(); 2].map(|()| draw.around(12) << quarter_a_step);
            let quarter = scene.format.entry_fraction_bits() - 2;
            let [u, v] = [(); 2].map(|()| draw.below(u64::from(size) * 4) << quarter);
            let ray = quantised(u, v, du, dv);
            for (_, policy) in policies() {
                let mut reading = TieFlipped::new(name);
                // The first walk finds the place, and flips from its second step on.
                let shape = scene.format.shape();
                let memory = scene.pyramid.memory();
                fixed_walk_in(&mut reading, shape, policy, memory, &ray);
                if reading.at.is_none() {
                    continue;
                }
                let hit = fixed_walk_in(&mut reading, shape, policy, memory, &ray);
                faults += usize::from(scene.fault(policy, &ray, &hit).is_some());
            }
        }
    }
    faults
}

#[test]
fn a_tie_taken_the_wrong_way_is_seen() {
    assert_eq!(faults_with("no comparison has this name"), 0);
    for name in [
        "beyond_u",
        "beyond_v",
        "past_border",
        "past_midline_u",
        "past_midline_v",
        "v_first",
    ] {
        let faults = faults_with(name);
        assert!(faults > 0, "nothing saw `{name}` take ties the wrong way");
        println!("{name}: {faults} faults seen");
    }
}

#[test]
fn a_height_or_a_slope_one_off_is_seen() {
    let mut draw = Draw(5);
    let scene = Scene::new(sixteenths(&mut draw, 8, 8), RayFormat::within_reach);
    let (mut slopes, mut heights) = (0, 0);
    for _ in 0..200 {
        let [du, dv] = [(); 2].map(|()| draw.around(3 << 18));
        let [u, v] = [(); 2].map(|()| draw.below(8 << 12));
        let ray = quantised(u, v, du, dv);
        let off = quantised(u, v, du + 1, dv);
        let (_, policy) = policies()[1];
        let hit = scene.walk(policy, &off);
        slopes += usize::from(scene.fault(policy, &ray, &hit).is_some());
        let memory: Vec<u16> = scene.pyramid.memory().iter().map(|h| h ^ 1).collect();
        let hit = fixed_walk_in(&mut F64Reading, scene.format.shape(), policy, &memory, &ray);
        heights += usize::from(scene.fault(policy, &ray, &hit).is_some());
    }
    assert!(slopes > 50 && heights > 20, "{slopes} and {heights} of 200");
}
