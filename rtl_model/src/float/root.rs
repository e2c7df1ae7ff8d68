//! The square root.

use super::rounder::Unrounded;
use super::{Answer, FloatArithmetic};

impl FloatArithmetic {
    /// The square root of `a`, rounded once. That of a zero is the zero itself, of its sign; that
    /// of a number below zero is the canonical NaN, and invalid.
    #[inline]
    pub const fn sqrt(self, a: u64) -> Answer {
        let format = self.format;
        let negative = format.has_sign(a);
        let magnitude = self.read_magnitude(a);
        if magnitude > format.infinity() {
            return self.nan_operand(a, a);
        }
        if magnitude == 0 {
            return self.zero(negative);
        }
        if negative {
            return self.not_a_number(true);
        }
        if magnitude == format.infinity() {
            return self.infinite(false);
        }

        // significand * 2^(exponent - F), with zeros appended until the exponent is even and the
        // root has at least two bits more than are kept: F + 3. What is left over is the sticky bit.
        let (field, significand) = self.normalised(magnitude);
        let scale = field - format.exponent_bias() - format.fraction_bits as i32;
        let appended = format.fraction_bits + 4;
        let appended = appended + ((scale - appended as i32) & 1) as u32;
        let radicand = (significand as u128) << appended;
        let (root, inexact) = if radicand >> 64 == 0 {
            let radicand = radicand as u64;
            let root = radicand.isqrt();
            (root, root * root != radicand)
        } else {
            let root = radicand.isqrt();
            (root as u64, root * root != radicand)
        };
        let leading_zeros = root.leading_zeros();
        self.round(Unrounded {
            negative: false,
            exponent: (scale - appended as i32) / 2 + 63 - leading_zeros as i32,
            significand: root << leading_zeros | inexact as u64,
        })
    }
}
