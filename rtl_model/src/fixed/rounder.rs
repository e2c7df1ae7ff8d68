//! The one way from an exact result to a word: round, then saturate or wrap.

use super::{Fixed, FixedArithmetic, Overflow};
use crate::float::{Flags, Rounding};

/// An exact result: `magnitude * 2^exponent`, negated where `negative`.
#[derive(Clone, Copy)]
pub(super) struct Exact {
    pub(super) negative: bool,
    pub(super) magnitude: u128,
    pub(super) exponent: i32,
}

/// What lies below the last place kept, in halves of that place's unit.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Dropped {
    Nothing,
    BelowHalf,
    Half,
    AboveHalf,
}

impl Dropped {
    /// By the order of what was dropped and half a unit, where something was.
    pub(super) fn beside_half(order: std::cmp::Ordering) -> Dropped {
        match order {
            std::cmp::Ordering::Less => Dropped::BelowHalf,
            std::cmp::Ordering::Equal => Dropped::Half,
            std::cmp::Ordering::Greater => Dropped::AboveHalf,
        }
    }
}

/// An exact result, cut at the last place of the result's format.
#[derive(Clone, Copy)]
pub(super) struct Cut {
    pub(super) negative: bool,
    /// The low 128 bits of the magnitude in units of that place.
    pub(super) units: u128,
    /// Does the magnitude have bits above those?
    pub(super) beyond: bool,
    /// What is below that place.
    pub(super) dropped: Dropped,
}

impl FixedArithmetic {
    /// The word of an exact result, and the flags.
    pub(super) fn round(self, exact: Exact) -> (Fixed, Flags) {
        self.fit(self.cut(exact))
    }

    fn cut(self, exact: Exact) -> Cut {
        let Exact {
            negative,
            magnitude,
            exponent,
        } = exact;
        let places = exponent + self.format.fraction_bits.cast_signed();
        let (units, beyond, dropped) = if magnitude == 0 {
            (0, false, Dropped::Nothing)
        } else if places >= 0 {
            let places = places.unsigned_abs();
            let units = magnitude.checked_shl(places).unwrap_or(0);
            (units, magnitude.leading_zeros() < places, Dropped::Nothing)
        } else {
            let places = places.unsigned_abs();
            let units = magnitude.checked_shr(places).unwrap_or(0);
            (units, false, dropped(magnitude, places))
        };
        Cut {
            negative,
            units,
            beyond,
            dropped,
        }
    }

    /// Rounds first, then looks at the range.
    pub(super) fn fit(self, cut: Cut) -> (Fixed, Flags) {
        let format = self.format;
        let increment = u128::from(self.moves_away(cut));
        let (rounded, carried) = cut.units.overflowing_add(increment);
        let farthest = if cut.negative {
            format.min()
        } else {
            format.max()
        };
        let in_range = !cut.beyond && !carried && rounded <= u128::from(farthest);
        let bits = if in_range || self.overflow == Overflow::Wrap {
            let low = rounded as u64;
            if cut.negative {
                low.wrapping_neg()
            } else {
                low
            }
        } else {
            farthest
        };
        let inexact = cut.dropped != Dropped::Nothing || !in_range;
        let flags = Flags::INEXACT.when(inexact) | Flags::OVERFLOW.when(!in_range);
        (Fixed::new(format, bits), flags)
    }

    /// Does rounding move to the next larger magnitude?
    fn moves_away(self, cut: Cut) -> bool {
        match self.rounding {
            Rounding::NearestEven => match cut.dropped {
                Dropped::Nothing | Dropped::BelowHalf => false,
                Dropped::Half => cut.units & 1 == 1,
                Dropped::AboveHalf => true,
            },
            Rounding::TowardZero => false,
            Rounding::Up => !cut.negative && cut.dropped != Dropped::Nothing,
            Rounding::Down => cut.negative && cut.dropped != Dropped::Nothing,
        }
    }
}

/// The lowest `places` bits of a magnitude that is not zero, 1 or more.
fn dropped(magnitude: u128, places: u32) -> Dropped {
    if places > 128 {
        return Dropped::BelowHalf;
    }
    let at_the_top = magnitude << (128 - places);
    if at_the_top == 0 {
        Dropped::Nothing
    } else {
        Dropped::beside_half(at_the_top.cmp(&(1 << 127)))
    }
}
