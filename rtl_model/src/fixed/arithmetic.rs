//! What the results of operators are.

use super::{Fixed, FixedFormat, Overflow};
use crate::float::{Flags, Rounding};

/// The operators with results of one kind: their format, their rounding, and what happens beyond
/// the range. Each answers with the result and its flags:
///
/// * [`Flags::INEXACT`]: the result is not the exact one, be it rounded, saturated or wrapped;
/// * [`Flags::OVERFLOW`]: the exact result, rounded, is beyond the range (always with `INEXACT`);
/// * [`Flags::DIVIDE_BY_ZERO`], [`Flags::INVALID`]: there is no exact result, as each operator says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FixedArithmetic {
    /// The format of results.
    pub format: FixedFormat,
    /// Which neighbour an inexact result becomes.
    pub rounding: Rounding,
    /// What a result beyond the range becomes.
    pub overflow: Overflow,
}

impl FixedArithmetic {
    /// Operators with such results.
    pub const fn new(
        format: FixedFormat,
        rounding: Rounding,
        overflow: Overflow,
    ) -> FixedArithmetic {
        FixedArithmetic {
            format,
            rounding,
            overflow,
        }
    }

    /// The end of the range on this side of zero, as answer where there is no exact result.
    pub(super) fn end_of_range(self, negative: bool, flags: Flags) -> (Fixed, Flags) {
        let bits = if negative {
            self.format.min()
        } else {
            self.format.max()
        };
        (Fixed::new(self.format, bits), flags)
    }

    /// Zero, as answer where nothing makes sense.
    pub(super) fn invalid(self) -> (Fixed, Flags) {
        (Fixed::new(self.format, 0), Flags::INVALID)
    }
}
