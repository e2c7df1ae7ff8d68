//! Multiplication by a power of two: the exponent alone changes.

use super::FloatFormat;

impl FloatFormat {
    /// `a * 2^exponent`, in the policy `flush`: exact, but for a result beyond the format's
    /// exponents, which is the infinity or the zero of its sign. NaN gives the canonical NaN.
    #[inline(always)]
    pub const fn scale(self, a: u64, exponent: i32) -> u64 {
        let signed = a & self.sign_bit();
        let magnitude = self.flushed_magnitude(a);
        if magnitude == 0 {
            return signed;
        }
        if magnitude > self.infinity() {
            return self.quiet_nan();
        }
        if magnitude == self.infinity() {
            return signed | magnitude;
        }
        let field = self.exponent_field(magnitude) + exponent;
        if field < 1 {
            signed
        } else if field as u64 >= self.exponent_all_ones() {
            signed | self.infinity()
        } else {
            let fraction = magnitude & (self.min_normal() - 1);
            signed | ((field as u64) << self.fraction_bits) | fraction
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::float::Rounding;

    #[test]
    fn it_is_the_product_with_the_power() {
        // Truncated overflow would be the largest number: to nearest it is infinite.
        let rounding = Rounding::NearestEven;
        for format in [FloatFormat::new(4, 3), FloatFormat::new(3, 4)] {
            for exponent in -5..=5 {
                let power = format.from_integer(rounding, 1, exponent.into());
                if format.is_infinite(power) || format.is_zero(power) {
                    continue;
                }
                for a in 0..1 << format.width() {
                    let product = format.mul(rounding, a, power);
                    // Only what lies just below the smallest number may round up into it.
                    if format.magnitude(product) != format.min_normal() {
                        assert_eq!(
                            format.scale(a, exponent),
                            product,
                            "{format} {a} {exponent}"
                        );
                    }
                }
            }
        }
    }
}
