//! The parts of a bit pattern, what it stands for, and the operators that touch only its sign.

use super::FloatFormat;

impl FloatFormat {
    /// A mask of exponent and fraction: everything but the sign.
    #[inline(always)]
    pub(super) const fn magnitude_mask(self) -> u64 {
        self.sign_bit() - 1
    }

    /// Is the sign bit of `a` 1? True of minus zero, and of a NaN that has it.
    #[inline(always)]
    pub(super) const fn has_sign(self, a: u64) -> bool {
        a & self.sign_bit() != 0
    }

    /// The sign bit where `negative`, else 0; as a pattern, the zero of that sign.
    #[inline(always)]
    pub(super) const fn zero_of_sign(self, negative: bool) -> u64 {
        (negative as u64) << (self.width() - 1)
    }

    /// Exponent and fraction of `a`, 0 where its exponent field is 0. Magnitudes of numbers are
    /// ordered as the integers they are read as; those above [`FloatFormat::infinity`] are NaNs.
    #[inline(always)]
    pub(super) const fn flushed_magnitude(self, a: u64) -> u64 {
        let magnitude = a & self.magnitude_mask();
        if magnitude < self.min_normal() {
            0
        } else {
            magnitude
        }
    }

    /// The exponent field of a magnitude.
    #[inline(always)]
    pub(super) const fn exponent_field(self, magnitude: u64) -> i32 {
        (magnitude >> self.fraction_bits) as i32
    }

    /// The significand of a normal magnitude as an integer of `F + 1` bits: the leading one that
    /// the encoding leaves out, then the fraction.
    #[inline(always)]
    pub(super) const fn significand(self, magnitude: u64) -> u64 {
        (magnitude & self.fraction_mask()) | self.min_normal()
    }

    /// What the operators read for `a`: a subnormal pattern becomes the zero of its sign, every
    /// NaN the canonical one; anything else stays as it is.
    #[inline]
    pub const fn canonical(self, a: u64) -> u64 {
        let magnitude = self.flushed_magnitude(a);
        if magnitude > self.infinity() {
            self.quiet_nan()
        } else {
            (a & self.sign_bit()) | magnitude
        }
    }

    /// Is `a` a NaN, canonical or not?
    #[inline]
    pub const fn is_nan(self, a: u64) -> bool {
        a & self.magnitude_mask() > self.infinity()
    }

    /// Is `a` plus or minus infinity?
    #[inline]
    pub const fn is_infinite(self, a: u64) -> bool {
        a & self.magnitude_mask() == self.infinity()
    }

    /// Is `a` zero, of either sign? A subnormal pattern is.
    #[inline]
    pub const fn is_zero(self, a: u64) -> bool {
        self.flushed_magnitude(a) == 0
    }

    /// Is `a` below zero? Minus zero, negative subnormal patterns and NaNs are not; minus infinity
    /// is.
    #[inline]
    pub const fn is_negative(self, a: u64) -> bool {
        self.has_sign(a) && !self.is_zero(a) && !self.is_nan(a)
    }

    /// `-a`: the sign bit inverted and nothing else, whatever `a` is (IEEE 754-2019, 5.5.1). So a
    /// NaN stays a NaN but need not be canonical, and a subnormal pattern is not flushed: one
    /// inverter in hardware. Every operator that computes reads both as documented.
    #[inline]
    pub const fn negate(self, a: u64) -> u64 {
        (a ^ self.sign_bit()) & self.value_mask()
    }

    /// `|a|`: the sign bit cleared and nothing else, whatever `a` is; see [`FloatFormat::negate`].
    #[inline]
    pub const fn magnitude(self, a: u64) -> u64 {
        a & self.magnitude_mask()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const F: FloatFormat = FloatFormat::E4F3;

    #[test]
    fn every_pattern_is_of_one_class() {
        for a in 0..=0xffu64 {
            let exponent = a / 8 % 16;
            let fraction = a % 8;
            assert_eq!(F.is_nan(a), exponent == 15 && fraction != 0, "{a:#x}");
            assert_eq!(F.is_infinite(a), exponent == 15 && fraction == 0, "{a:#x}");
            assert_eq!(F.is_zero(a), exponent == 0, "{a:#x}");
            let below_zero = a >= 0x80 && exponent != 0 && (exponent, fraction) <= (15, 0);
            assert_eq!(F.is_negative(a), below_zero, "{a:#x}");
        }
    }

    #[test]
    fn sign_operators_touch_only_the_sign() {
        for a in 0..=0xffu64 {
            assert_eq!(F.negate(a), (a + 0x80) % 0x100);
            assert_eq!(F.magnitude(a), a % 0x80);
        }
    }

    #[test]
    fn bits_above_the_width_are_not_read() {
        let above = !F.value_mask();
        for a in 0..=0xffu64 {
            assert_eq!(F.canonical(a | above), F.canonical(a));
            assert_eq!(F.negate(a | above), F.negate(a));
            assert_eq!(F.magnitude(a | above), F.magnitude(a));
            assert_eq!(F.is_nan(a | above), F.is_nan(a));
            assert_eq!(F.is_zero(a | above), F.is_zero(a));
        }
    }

    #[test]
    fn canonical_flushes_and_replaces_nans() {
        assert_eq!(F.canonical(0x07), 0x00);
        assert_eq!(F.canonical(0x87), 0x80);
        assert_eq!(F.canonical(0xf9), F.quiet_nan());
        assert_eq!(F.canonical(0xf8), 0xf8);
        assert_eq!(F.canonical(0x88), 0x88);
    }
}
