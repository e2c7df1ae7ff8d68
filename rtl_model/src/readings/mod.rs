//! What a datapath means: its operators evaluated in a number format.
//!
//! | reading | a number is | gives |
//! |---|---|---|
//! | [`FloatReading`] | the bits of an `eXfY` float | the golden values, bit for bit |
//! | [`F64Reading`] | an `f64` | the picture everyone compares with |
//! | [`ExactReading`] | an exact rational | the truth, for hard cases |
//! | [`IntervalReading`] | a range of `f64` | the ranges that size the fixed-point formats |
//!
//! The netlist reading, in which a number is a wire, lives in the crate that emits Verilog.
//! [`Traced`] wraps any of them and keeps the result of every operation, in order.

mod enclosure;
mod exact;
mod float;
mod integer;
mod interval;
mod native;
mod rationals;
mod small_ratio;
mod traced;

pub use exact::{ExactNum, ExactReading};
pub use float::{E7F16, FloatReading, HasFormat};
pub use interval::{IntegerInterval, Interval, IntervalReading, Maybe};
pub use native::F64Reading;
pub use traced::{Traced, Word};

use crate::arith::Concrete;
use crate::ray::Ray;

/// A reading that numbers of the outside world enter and leave.
pub trait NumberFormat: Concrete {
    /// A ray's entry coordinate, 0 to 1: rounded toward zero, so that it stays below 1.
    fn coordinate(&mut self, value: f64) -> Self::Num;
    /// A component of a ray's direction: rounded to nearest.
    fn direction(&mut self, value: f64) -> Self::Num;
    /// The value as an `f64`, exactly where an `f64` can hold it, else the nearest.
    fn to_f64(&self, value: Self::Num) -> f64;
    /// Forgets the values made so far, where the reading keeps them: call between rays.
    fn forget(&mut self) {}
}

/// A ray in a reading's numbers: each of its own rounded once, as [`NumberFormat`] says.
pub fn enter<R: NumberFormat>(reading: &mut R, ray: Ray<f64>) -> Ray<R::Num> {
    Ray {
        u: reading.coordinate(ray.u),
        v: reading.coordinate(ray.v),
        du: reading.direction(ray.du),
        dv: reading.direction(ray.dv),
    }
}
