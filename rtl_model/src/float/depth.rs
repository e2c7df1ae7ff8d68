//! The two operators the traversal needs beyond arithmetic: a bound pushed up by units in the last
//! place, and the depth of a height sample.

use super::rounder::Unrounded;
use super::{FloatArithmetic, Rounding};

impl FloatArithmetic {
    /// The number `ulps` steps above `a`, which must not be negative: `ulps` added to the pattern,
    /// read as an integer. One adder in hardware: the carry from fraction to exponent is the step
    /// across a power of two. It raises no flag.
    ///
    /// - Under the policy `flush` a subnormal operand reads as zero first, and a sum that is a
    ///   subnormal pattern is +0.
    /// - A sum at or past the pattern of infinity is infinity; infinity stays infinity.
    /// - NaN gives the canonical NaN.
    /// - The sign bit of `a` is not read.
    #[inline(always)]
    pub const fn ulps_up(self, a: u64, ulps: u32) -> u64 {
        let format = self.format;
        let magnitude = self.read_magnitude(a);
        if magnitude > format.infinity() {
            return format.quiet_nan();
        }
        let sum = magnitude + ulps as u64;
        if sum >= format.infinity() {
            format.infinity()
        } else {
            self.read_magnitude(sum)
        }
    }

    /// The depth `1 - height / (2^bits - 1)` of an unsigned normalised height, rounded once, toward
    /// zero whatever this rounding: never below the surface. `bits` is 8 or 16 (any divisor of 64 up
    /// to 32 works); a height above `2^bits - 1` reads as that, depth 0. It raises no flag.
    ///
    /// Exact at the two ends, and nowhere else: `k / (2^n - 1)` in binary is the n-bit number `k`
    /// repeated for ever. So no divider is needed, only a copy of the bits side by side.
    #[inline(always)]
    pub const fn depth_from_height(self, height: u64, bits: u32) -> u64 {
        debug_assert!(
            bits <= 32 && 64 % bits == 0,
            "heights have 8 or 16 bits, or another divisor of 64"
        );
        let full = (1u64 << bits) - 1;
        let steps = full.saturating_sub(height);
        if steps == 0 {
            return 0;
        }
        if steps == full {
            return self.format.one();
        }
        // The 64 bits after the binary point. The pattern's period divides 64, so rotating it
        // brings in on the right just the bits that follow. They never end: the result is inexact.
        let repeated = steps * (u64::MAX / full);
        let leading_zeros = repeated.leading_zeros();
        let truncating = self.format.arithmetic(self.policy, Rounding::TowardZero);
        truncating
            .round(Unrounded {
                negative: false,
                exponent: -1 - leading_zeros as i32,
                significand: repeated.rotate_left(leading_zeros) | 1,
            })
            .bits
    }
}

#[cfg(test)]
mod tests {
    use crate::float::FloatFormat;

    #[test]
    fn ulps_up_steps_through_the_patterns() {
        let format = FloatFormat::E4F3;
        let infinity = format.infinity();
        for a in 0..0x80u64 {
            for ulps in 0..0x100u32 {
                let expected = if a > infinity {
                    format.quiet_nan()
                } else {
                    let from = if a < 8 { 0 } else { a };
                    match from + u64::from(ulps) {
                        sum if sum < 8 => 0,
                        sum => sum.min(infinity),
                    }
                };
                assert_eq!(format.ulps_up(a, ulps), expected, "{a:#x} + {ulps}");
            }
        }
        assert_eq!(format.ulps_up(0, u32::MAX), infinity);
        let widest = FloatFormat::new(11, 52);
        assert_eq!(
            widest.ulps_up(widest.one(), 3),
            (1.0 + 3.0 * f64::EPSILON).to_bits()
        );
    }

    #[test]
    fn depth_is_the_largest_float_not_beyond_the_surface() {
        // d <= k / full < the next float up, cross-multiplied in integers.
        for format in [
            FloatFormat::E7F16,
            FloatFormat::new(5, 10),
            FloatFormat::new(8, 40),
        ] {
            for bits in [8, 16] {
                let full = (1u64 << bits) - 1;
                for height in 0..=full {
                    let depth = format.depth_from_height(height, bits);
                    let fits = |d: u64| -> bool {
                        // d = significand * 2^-scale, with scale at most 16 + F here.
                        let exponent = format.exponent_field(d) - format.exponent_bias();
                        let scale = format.fraction_bits as i32 - exponent;
                        let significand = u128::from(format.significand(d));
                        significand * u128::from(full) <= u128::from(full - height) << scale
                    };
                    if height == full {
                        assert_eq!(depth, 0);
                    } else if depth == 0 {
                        assert!(!fits(format.min_normal()), "{format} {height}");
                    } else {
                        assert!(fits(depth), "{format} {height}/{full}");
                        assert!(!fits(depth + 1), "{format} {height}/{full}");
                    }
                }
                assert_eq!(format.depth_from_height(0, bits), format.one());
                assert_eq!(format.depth_from_height(full + 1, bits), 0);
            }
        }
    }
}
