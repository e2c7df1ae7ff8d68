//! Floating point in any width, by integer arithmetic on its bits.
//!
//! A value is the low `1 + E + F` bits of a `u64`: sign, exponent, fraction.

mod format;

pub use format::{FloatFormat, Rounding};
