//! Floating point in any width, by integer arithmetic on its bits.
//!
//! A value is the low `1 + E + F` bits of a `u64`: sign, exponent, fraction. Bits above the width
//! are not read, and are zero in every result. The operators are methods of [`FloatFormat`]; they
//! are inlined, so that with a constant format (`FloatFormat::E7F16.add(...)`) every width folds
//! into the code, and with one chosen at run time they work just as well:
//!
//! ```
//! use rtl_model::float::{FloatFormat, Rounding};
//!
//! let format = FloatFormat::E7F16;
//! let third = format.div(Rounding::NearestEven, format.one(), format.from_f64(Rounding::NearestEven, 3.0));
//! assert_eq!(third, 0x3d5555);
//! assert_eq!(format.to_f64(third), 0.333_332_061_767_578_1);
//! ```
//!
//! These follow the policy `flush`: a subnormal operand reads as a zero of its sign, and a result
//! that is below the smallest normal number after rounding becomes a zero of its sign. The whole
//! arithmetic, with subnormal numbers as IEEE 754-2019 has them as another policy, with flags, and
//! with more operators, is [`FloatArithmetic`]: the shorthands above are its operators under
//! `flush`, without the flags. `docs/numerics.md` has every corner case in tables.
//!
//! Each inexact operator works in three steps: take the operands apart, find the exact result (or
//! enough leading bits of it, and whether anything follows), hand that to the one rounder in
//! `rounder.rs`. No host float takes part in a result. [`ThroughF64`] is the other route to the same
//! results, by host floats, and [`slices`] takes it for many numbers at once.

mod arithmetic;
mod conversion;
mod depth;
mod flags;
mod format;
mod fused;
mod grain;
mod integer;
mod integer_format;
mod operation;
mod order;
mod pattern;
mod policy;
mod product;
mod root;
mod rounder;
mod scale;
mod shorthand;
pub mod slices;
mod sum;
mod supported;
mod through_f64;

pub use arithmetic::{Answer, FloatArithmetic};
pub use flags::Flags;
pub use format::{FloatFormat, Rounding, UnknownFloatFormat};
pub use integer_format::{IntegerFormat, UnknownIntegerFormat};
pub use operation::{Operation, UnknownOperation, Word};
pub use order::{Comparison, Relation};
pub use policy::Policy;
pub use shorthand::ToIntegerError;
pub use supported::{SUPPORTED_FORMATS, SupportedFormat};
pub use through_f64::ThroughF64;
