//! Fixed point in any width up to 64 bits, by integer arithmetic.
//!
//! A [`Fixed`] is a word with its [`FixedFormat`]: `qI.F`, signed in two's complement, or `uqI.F`,
//! unsigned. Widths are values, not types, so they can be chosen at run time. The operators are
//! methods of [`FixedArithmetic`], which says what a result is: its format, how it is
//! rounded, and what happens beyond the range. Operands may have formats of their own, each its own:
//!
//! ```
//! use rtl_model::fixed::{Fixed, FixedArithmetic, FixedFormat, Overflow};
//! use rtl_model::float::{Flags, Rounding};
//!
//! let q4_12 = FixedFormat::q(4, 12);
//! let arithmetic = FixedArithmetic::new(q4_12, Rounding::NearestEven, Overflow::Saturate);
//! let three = Fixed::new(q4_12, 3 << 12);
//! let (third, flags) = arithmetic.reciprocal(three);
//! assert_eq!((third.bits, flags), (0x555, Flags::INEXACT));
//! let (nine, flags) = arithmetic.mul(three, three);
//! assert_eq!(nine.bits, 0x7fff, "the largest number of q4.12, just below 8");
//! assert!(flags.contains(Flags::OVERFLOW));
//! ```
//!
//! Every operator works in one order, which is also the hardware's: **the exact result, rounded to
//! the fraction bits of its format, then saturated or wrapped.** Nothing wraps unless
//! [`Overflow::Wrap`] was asked for. `docs/fixed_point.md` has every rule in tables.

mod arithmetic;
mod float;
mod format;
mod number;
mod operation;
mod order;
mod overflow;
mod product;
mod quotient;
mod rounder;
mod shift;
mod sum;

pub use arithmetic::FixedArithmetic;
pub use format::{FixedFormat, FixedFormatError};
pub use number::Fixed;
pub use operation::{FixedOperation, FixedRelation, UnknownFixedOperation};
pub use overflow::Overflow;
