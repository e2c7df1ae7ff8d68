//! The golden reading: numbers are the bits of a float.

use super::NumberFormat;
use super::integer::plain_integers_and_bits;
use crate::arith::Arith;
use crate::float::{FloatFormat, IntegerFormat, Policy, Rounding};

/// Says which float format to compute in: a type that means one format, so that its arithmetic is
/// compiled for it, or a [`FloatFormat`] chosen at run time.
pub trait HasFormat: Copy {
    /// The format.
    fn format(self) -> FloatFormat;
}

/// The format e7f16, known when the code is compiled.
#[derive(Clone, Copy, Debug, Default)]
pub struct E7F16;

impl HasFormat for E7F16 {
    #[inline(always)]
    fn format(self) -> FloatFormat {
        FloatFormat::E7F16
    }
}

impl HasFormat for FloatFormat {
    #[inline(always)]
    fn format(self) -> FloatFormat {
        self
    }
}

/// Numbers are float bits in the low bits of a `u64`; every operator is the golden one.
#[derive(Clone, Copy, Debug, Default)]
pub struct FloatReading<H>(pub H);

impl<H: HasFormat> FloatReading<H> {
    /// The format computed in.
    #[inline(always)]
    pub fn format(&self) -> FloatFormat {
        self.0.format()
    }
}

impl<H: HasFormat> Arith for FloatReading<H> {
    type Num = u64;
    plain_integers_and_bits!();

    #[inline(always)]
    fn zero(&mut self) -> u64 {
        0
    }
    #[inline(always)]
    fn add(&mut self, rounding: Rounding, a: u64, b: u64) -> u64 {
        self.format().add(rounding, a, b)
    }
    #[inline(always)]
    fn sub(&mut self, rounding: Rounding, a: u64, b: u64) -> u64 {
        self.format().sub(rounding, a, b)
    }
    #[inline(always)]
    fn mul(&mut self, rounding: Rounding, a: u64, b: u64) -> u64 {
        self.format().mul(rounding, a, b)
    }
    #[inline(always)]
    fn div(&mut self, rounding: Rounding, a: u64, b: u64) -> u64 {
        self.format().div(rounding, a, b)
    }
    #[inline(always)]
    fn ulps_up(&mut self, a: u64, ulps: u32) -> u64 {
        self.format().ulps_up(a, ulps)
    }
    #[inline(always)]
    fn exact_below(&mut self, a: u64) -> u64 {
        self.format().exact_below(a)
    }
    #[inline(always)]
    fn negate_if(&mut self, condition: bool, a: u64) -> u64 {
        if condition {
            a ^ self.format().sign_bit()
        } else {
            a
        }
    }
    #[inline(always)]
    fn magnitude(&mut self, a: u64) -> u64 {
        a & !self.format().sign_bit()
    }
    #[inline(always)]
    fn is_negative(&mut self, a: u64) -> bool {
        self.format().is_negative(a)
    }
    #[inline(always)]
    fn is_zero(&mut self, a: u64) -> bool {
        self.format().is_zero(a)
    }
    #[inline(always)]
    fn less_than(&mut self, a: u64, b: u64) -> bool {
        self.format().less_than(a, b)
    }
    #[inline(always)]
    fn less_equal(&mut self, a: u64, b: u64) -> bool {
        self.format().less_equal(a, b)
    }
    #[inline(always)]
    fn select(&mut self, condition: bool, when_one: u64, when_zero: u64) -> u64 {
        if condition { when_one } else { when_zero }
    }
    #[inline(always)]
    fn number_from_integer(&mut self, rounding: Rounding, value: i64, exponent: i64) -> u64 {
        self.format().from_integer(rounding, value, exponent)
    }
    #[inline(always)]
    fn scale(&mut self, a: u64, exponent: i32) -> u64 {
        self.format().scale(a, exponent)
    }
    #[inline(always)]
    fn floor(&mut self, a: u64, bits: u32) -> i64 {
        let arithmetic = self.format().arithmetic(Policy::Flush, Rounding::Down);
        let floor = arithmetic.to_integer(IntegerFormat::signed(bits), a).bits;
        (floor << (64 - bits)).cast_signed() >> (64 - bits)
    }
    #[inline(always)]
    fn depth_from_height(&mut self, height: i64, bits: u32) -> u64 {
        self.format().depth_from_height(height as u64, bits)
    }
}

impl<H: HasFormat> NumberFormat for FloatReading<H> {
    fn coordinate(&mut self, value: f64) -> u64 {
        self.format().from_f64(Rounding::TowardZero, value)
    }
    fn direction(&mut self, value: f64) -> u64 {
        self.format().from_f64(Rounding::NearestEven, value)
    }
    fn to_f64(&self, value: u64) -> f64 {
        self.format().to_f64(value)
    }
}
