//! The exceptions of an operation, as flags beside its result.

use std::fmt;
use std::ops::{BitOr, BitOrAssign};

/// The five exceptions of IEEE 754-2019, section 7, in the bit order of Berkeley SoftFloat and
/// TestFloat, which is also that of the hardware's `flags_o`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Flags(u8);

impl Flags {
    /// None raised.
    pub const NONE: Flags = Flags(0);
    /// The result is not the exact one.
    pub const INEXACT: Flags = Flags(1);
    /// The result is inexact and below the smallest normal number: under the policy `full`, before
    /// it was rounded to a subnormal number but after rounding with no lower end to the exponent
    /// (tininess after rounding); under `flush`, a nonzero result became a zero.
    pub const UNDERFLOW: Flags = Flags(2);
    /// The result, rounded with no upper end to the exponent, is beyond the largest finite number.
    pub const OVERFLOW: Flags = Flags(4);
    /// An infinite result of finite operands that is exact: a nonzero number divided by zero.
    pub const DIVIDE_BY_ZERO: Flags = Flags(8);
    /// No result makes sense, or an operand is a signalling NaN.
    pub const INVALID: Flags = Flags(16);

    /// Flags in the port `flags_o`.
    pub const WIDTH: u32 = 5;

    /// Each flag with its name, the least significant bit first.
    pub const ALL: [(Flags, &'static str); 5] = [
        (Flags::INEXACT, "inexact"),
        (Flags::UNDERFLOW, "underflow"),
        (Flags::OVERFLOW, "overflow"),
        (Flags::DIVIDE_BY_ZERO, "divide_by_zero"),
        (Flags::INVALID, "invalid"),
    ];

    /// The flags of these bits; those above the fifth are not read.
    #[inline]
    pub const fn from_bits(bits: u8) -> Flags {
        Flags(bits & 0x1f)
    }

    /// The bits, inexact the least significant.
    #[inline]
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// Those of either.
    #[inline]
    pub const fn union(self, other: Flags) -> Flags {
        Flags(self.0 | other.0)
    }

    /// These but for those of `other`.
    #[inline]
    pub const fn without(self, other: Flags) -> Flags {
        Flags(self.0 & !other.0)
    }

    /// Are all of `other` raised?
    #[inline]
    pub const fn contains(self, other: Flags) -> bool {
        self.0 & other.0 == other.0
    }

    /// These flags where `condition` holds, else none.
    #[inline]
    pub const fn when(self, condition: bool) -> Flags {
        Flags(if condition { self.0 } else { 0 })
    }
}

impl BitOr for Flags {
    type Output = Flags;

    fn bitor(self, other: Flags) -> Flags {
        self.union(other)
    }
}

impl BitOrAssign for Flags {
    fn bitor_assign(&mut self, other: Flags) {
        *self = self.union(other);
    }
}

impl fmt::Display for Flags {
    /// The names of the flags raised, or `none`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Flags::NONE {
            return f.write_str("none");
        }
        let mut separator = "";
        for (flag, name) in Flags::ALL {
            if self.contains(flag) {
                write!(f, "{separator}{name}")?;
                separator = " ";
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_stand_in_the_order_of_softfloat() {
        let places: Vec<u8> = Flags::ALL.iter().map(|(flag, _)| flag.bits()).collect();
        assert_eq!(places, [1, 2, 4, 8, 16]);
        let both = Flags::OVERFLOW | Flags::INEXACT;
        assert_eq!(both.to_string(), "inexact overflow");
        assert_eq!(Flags::from_bits(0xe0).to_string(), "none");
    }
}
