//! The `f64` reading: what everyone compares with.

use super::NumberFormat;
use super::integer::plain_integers_and_bits;
use crate::arith::Arith;
use crate::float::Rounding;

/// Numbers are `f64`, rounded to nearest whatever the datapath asks for.
#[derive(Clone, Copy, Debug, Default)]
pub struct F64Reading;

impl Arith for F64Reading {
    type Num = f64;
    plain_integers_and_bits!();

    #[inline(always)]
    fn zero(&mut self) -> f64 {
        0.0
    }
    #[inline(always)]
    fn add(&mut self, _: Rounding, a: f64, b: f64) -> f64 {
        a + b
    }
    #[inline(always)]
    fn sub(&mut self, _: Rounding, a: f64, b: f64) -> f64 {
        a - b
    }
    #[inline(always)]
    fn mul(&mut self, _: Rounding, a: f64, b: f64) -> f64 {
        a * b
    }
    #[inline(always)]
    fn div(&mut self, _: Rounding, a: f64, b: f64) -> f64 {
        a / b
    }
    #[inline(always)]
    fn ulps_up(&mut self, a: f64, _: u32) -> f64 {
        a
    }
    #[inline(always)]
    fn exact_below(&mut self, _: f64) -> f64 {
        f64::INFINITY
    }
    #[inline(always)]
    fn negate_if(&mut self, condition: bool, a: f64) -> f64 {
        if condition { -a } else { a }
    }
    #[inline(always)]
    fn magnitude(&mut self, a: f64) -> f64 {
        a.abs()
    }
    #[inline(always)]
    fn is_negative(&mut self, a: f64) -> bool {
        a < 0.0
    }
    #[inline(always)]
    fn is_zero(&mut self, a: f64) -> bool {
        a == 0.0
    }
    #[inline(always)]
    fn less_than(&mut self, a: f64, b: f64) -> bool {
        a < b
    }
    #[inline(always)]
    fn less_equal(&mut self, a: f64, b: f64) -> bool {
        a <= b
    }
    #[inline(always)]
    fn select(&mut self, condition: bool, when_one: f64, when_zero: f64) -> f64 {
        if condition { when_one } else { when_zero }
    }
    #[inline(always)]
    fn number_from_integer(&mut self, _: Rounding, value: i64, exponent: i64) -> f64 {
        // The exponents of a walk are node sizes, 2^-13 to 1: the power is exact.
        value as f64 * f64::from_bits(((1023 + exponent) as u64) << 52)
    }
    #[inline(always)]
    fn scale(&mut self, a: f64, exponent: i32) -> f64 {
        self.mul(
            Rounding::NearestEven,
            a,
            f64::from_bits(((1023 + exponent) as u64) << 52),
        )
    }
    #[inline(always)]
    fn floor(&mut self, a: f64, bits: u32) -> i64 {
        // The conversion saturates, and takes NaN for 0.
        let most = (1_i64 << (bits - 1)) - 1;
        (a.floor() as i64).clamp(-1 - most, most)
    }
    #[inline(always)]
    fn depth_from_height(&mut self, height: i64, bits: u32) -> f64 {
        let full = (1_i64 << bits) - 1;
        (full - height) as f64 / full as f64
    }
}

impl NumberFormat for F64Reading {
    fn coordinate(&mut self, value: f64) -> f64 {
        value
    }
    fn direction(&mut self, value: f64) -> f64 {
        value
    }
    fn to_f64(&self, value: f64) -> f64 {
        value
    }
}
