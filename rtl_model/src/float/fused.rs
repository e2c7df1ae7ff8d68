//! Multiplication and addition, rounded once for both.

use super::rounder::Unrounded;
use super::{Answer, FloatArithmetic};

/// A nonzero finite term of a sum: `significand / 2^125 * 2^field`, with its leading one at bit
/// 125 or 124: two bits above for the carry, at least 20 zeros below.
#[derive(Clone, Copy)]
struct Term {
    negative: bool,
    field: i32,
    significand: u128,
}

impl FloatArithmetic {
    /// `a * b + c`, rounded once: no bit of the product is lost, and under no policy is the product
    /// itself flushed.
    ///
    /// Zero times infinity is invalid whatever `c` is, a quiet NaN too. A sum of exactly zero has
    /// the sign that [`FloatArithmetic::add`] would give it.
    #[inline]
    pub const fn fused_multiply_add(self, a: u64, b: u64, c: u64) -> Answer {
        let format = self.format;
        let product_negative = format.has_sign(a ^ b);
        let magnitude_a = self.read_magnitude(a);
        let magnitude_b = self.read_magnitude(b);
        let magnitude_c = self.read_magnitude(c);
        let infinity = format.infinity();
        if magnitude_a >= infinity || magnitude_b >= infinity || magnitude_c >= infinity {
            return self.fused_beyond_finite(a, b, c);
        }

        let addend_negative = format.has_sign(c);
        let product_is_zero = magnitude_a == 0 || magnitude_b == 0;
        if product_is_zero && magnitude_c == 0 {
            return if product_negative == addend_negative {
                self.zero(product_negative)
            } else {
                self.cancelled()
            };
        }
        let addend = Term {
            negative: addend_negative,
            ..self.addend(magnitude_c)
        };
        if product_is_zero {
            return self.round_term(addend);
        }
        let to_top = 63 - format.fraction_bits;
        let (field_a, significand_a) = self.normalised(magnitude_a);
        let (field_b, significand_b) = self.normalised(magnitude_b);
        // The leading ones at bit 63 give one at bit 127 or 126, with 22 zeros at the end at least.
        let significand =
            ((significand_a << to_top) as u128 * (significand_b << to_top) as u128) >> 2;
        let product = Term {
            negative: product_negative,
            field: field_a + field_b - format.exponent_bias() + 1,
            significand,
        };
        if magnitude_c == 0 {
            return self.round_term(product);
        }
        self.add_terms(product, addend)
    }

    /// The sum of two nonzero terms.
    #[inline]
    const fn add_terms(self, product: Term, addend: Term) -> Answer {
        let (high, low) = if product.field >= addend.field {
            (product, addend)
        } else {
            (addend, product)
        };
        // A shift by up to 20 places loses nothing. One by more leaves the high term so much larger
        // that it cancels two leading bits at most, and the sticky bit stays far below the rounding.
        let distance = (high.field - low.field) as u32;
        let distance = if distance > 127 { 127 } else { distance };
        let shifted = low.significand >> distance;
        let aligned = shifted | (shifted << distance != low.significand) as u128;
        let same_sign = high.negative == low.negative;
        if !same_sign && high.significand == aligned {
            return self.cancelled();
        }
        let (negative, significand) = if same_sign {
            (high.negative, high.significand + aligned)
        } else if high.significand > aligned {
            (high.negative, high.significand - aligned)
        } else {
            (low.negative, aligned - high.significand)
        };
        self.round_term(Term {
            negative,
            field: high.field,
            significand,
        })
    }

    /// A finite magnitude as a term; one of zero has the significand 0.
    #[inline]
    const fn addend(self, magnitude: u64) -> Term {
        let (field, significand) = if magnitude == 0 {
            (1, 0)
        } else {
            self.normalised(magnitude)
        };
        Term {
            negative: false,
            field,
            significand: (significand as u128) << (125 - self.format.fraction_bits),
        }
    }

    /// Rounds a nonzero term, wherever its leading one is.
    #[inline]
    const fn round_term(self, term: Term) -> Answer {
        let leading_zeros = term.significand.leading_zeros();
        let normalised = term.significand << leading_zeros;
        self.round(Unrounded {
            negative: term.negative,
            exponent: term.field - self.format.exponent_bias() + 2 - leading_zeros as i32,
            significand: (normalised >> 64) as u64 | (normalised as u64 != 0) as u64,
        })
    }

    /// A result with an operand that is infinite or NaN.
    #[cold]
    const fn fused_beyond_finite(self, a: u64, b: u64, c: u64) -> Answer {
        let format = self.format;
        let factor_is_nan = format.is_nan(a) || format.is_nan(b);
        let product_is_infinite = format.is_infinite(a) || format.is_infinite(b);
        let factor_is_zero = self.read_magnitude(a) == 0 || self.read_magnitude(b) == 0;
        if !factor_is_nan && product_is_infinite && factor_is_zero {
            return self.not_a_number(true);
        }
        if factor_is_nan || format.is_nan(c) {
            let signalling = format.is_signalling_nan(a)
                || format.is_signalling_nan(b)
                || format.is_signalling_nan(c);
            return self.not_a_number(signalling);
        }
        let product_negative = format.has_sign(a ^ b);
        if !product_is_infinite {
            self.infinite(format.has_sign(c))
        } else if format.is_infinite(c) && format.has_sign(c) != product_negative {
            self.not_a_number(true)
        } else {
            self.infinite(product_negative)
        }
    }
}
