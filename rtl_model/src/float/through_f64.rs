//! The second route: an operation in the machine's `f64`, then one rounding to the format.
//!
//! It serves every format of at most 25 significant bits (F <= 24), gives results without flags, and is
//! several times faster than integer arithmetic; written without branches, so that a loop over it
//! turns into vector instructions ([`super::slices`]). It shares nothing with the first route but
//! the format's widths, and the two are held against each other in the tests.
//!
//! # Why it is right
//!
//! Let p = F + 1 <= 25 be the significant bits of the format. A result of the format is the exact
//! result x moved to a neighbour among the numbers of p bits (of fewer, where it is subnormal). All
//! that any rounding asks is where x lies among the numbers of p + 1 bits: the neighbours, and the
//! midpoints between them. So an `f64` v serves as well as x if it lies on the same side of every
//! number of p + 1 bits, and is one of them only if it equals x.
//!
//! * **Product.** 2 p <= 50 bits: v is x.
//! * **Quotient.** Of x = A / B with significands of p bits, and g of p + 1 bits, not equal to it, x - g
//!   is a nonzero multiple of 2^-p / B for x in \[1, 2), where B < 2^p in units of its last place:
//!   more than 2^-2p, and relative to x more than 2^-(2p+1) >= 2^-51. Rounding to 53 bits moves x by no
//!   more than 2^-53 of it. It cannot reach g, let alone pass it.
//! * **Square root.** For x in \[1, 2), x^2 and g^2 are multiples of 2^-2p, so unequal ones are at least
//!   2^-2p apart, and x - g = (x^2 - g^2) / (x + g) is more than 2^-(2p+2) >= 2^-52. Rounding to 53 bits
//!   moves x by no more than 2^-53.
//! * **Sum.** Here `f64`'s own rounding can hide that x is not v: 1 + 2^-60 is 1. To nearest that does
//!   no harm, since 53 >= 2 p + 2 (Figueroa 1995): rounding twice is rounding once. For the other
//!   roundings the error e = x - v, which is an `f64` itself and found by six more operations (Knuth's
//!   TwoSum), tells the side: v is *rounded to odd* (Boldo and Melquiond 2008), to the neighbour on the side of
//!   zero of x with its last bit set. It then is no number of p + 1 bits, and lies between the same two.
//!
//! None of these may leave the range of `f64`. Up to 9 exponent bits nothing does: numbers are
//! below 2^256 and not below 2^-278, so products and quotients lie between 2^-556 and 2^534. With 10 or 11,
//! factors, dividends and divisors are taken apart into a number in \[1, 2) and an exponent, which is
//! added when the result is put together. Sums that overflow `f64` overflow the format; those
//! that are subnormal in `f64` are exact.

use super::{FloatArithmetic, Policy, Rounding};

/// Fraction bits of an `f64`.
const F64_FRACTION: u32 = 52;
/// The pattern of infinity in an `f64`.
const F64_INFINITY: u64 = 0x7ff << F64_FRACTION;
/// What the exponent field of an `f64` is above the exponent.
const F64_BIAS: i32 = 1023;

/// The arithmetic of a format by way of `f64`. Its results are those of [`FloatArithmetic`], without
/// the flags:
///
/// ```
/// use rtl_model::float::{FloatFormat, Policy, Rounding};
///
/// let arithmetic = FloatFormat::E7F16.arithmetic(Policy::Flush, Rounding::Up);
/// let through_f64 = arithmetic.through_f64().expect("17 significant bits");
/// assert_eq!(through_f64.div(0x3f0000, 0x408000), 0x3d5556);
/// assert_eq!(through_f64.div(0x3f0000, 0x408000), arithmetic.div(0x3f0000, 0x408000).bits);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ThroughF64(FloatArithmetic);

impl FloatArithmetic {
    /// The same by way of `f64`; none where the format has more than 25 significant bits.
    #[inline(always)]
    pub const fn through_f64(self) -> Option<ThroughF64> {
        if self.format.fraction_bits <= ThroughF64::MOST_FRACTION_BITS {
            Some(ThroughF64(self))
        } else {
            None
        }
    }
}

impl ThroughF64 {
    /// The most fraction bits of a format that this route serves.
    pub const MOST_FRACTION_BITS: u32 = 24;

    /// `a + b`.
    #[inline(always)]
    pub fn add(self, a: u64, b: u64) -> u64 {
        let format = self.0.format;
        let (x, y) = (self.value(a), self.value(b));
        let sum = x + y;
        let sum = match self.0.rounding {
            Rounding::NearestEven => sum,
            _ => to_odd(sum, error_of_sum(x, y, sum)),
        };
        // A difference of nothing is +0 in f64; rounding down it is -0. Two zeros of one sign keep it.
        let sum = match self.0.rounding {
            Rounding::Down => {
                let either = (a | b) & format.sign_bit() != 0;
                select(sum == 0.0, select(either, -0.0, 0.0), sum)
            }
            _ => sum,
        };
        let result = self.rounded(sum, 0);
        if format.exponent_bits == 11 && sum.is_infinite() && x.is_finite() && y.is_finite() {
            return self.overflow(sum < 0.0) | self.sign(sum < 0.0);
        }
        result
    }

    /// `a - b`: `a + (-b)` in every case.
    #[inline(always)]
    pub fn sub(self, a: u64, b: u64) -> u64 {
        self.add(a, b ^ self.0.format.sign_bit())
    }

    /// `a * b`.
    #[inline(always)]
    pub fn mul(self, a: u64, b: u64) -> u64 {
        let ((x, exponent_x), (y, exponent_y)) = (self.factor(a), self.factor(b));
        self.rounded(x * y, exponent_x + exponent_y)
    }

    /// `a / b`.
    #[inline(always)]
    pub fn div(self, a: u64, b: u64) -> u64 {
        let ((x, exponent_x), (y, exponent_y)) = (self.factor(a), self.factor(b));
        self.rounded(x / y, exponent_x - exponent_y)
    }

    /// The square root of `a`; -0 of -0, and the canonical NaN of anything else below zero.
    #[inline(always)]
    pub fn sqrt(self, a: u64) -> u64 {
        self.rounded(self.value(a).sqrt(), 0)
    }

    /// The value of a pattern, as the policy reads it; exact.
    #[inline(always)]
    fn value(self, a: u64) -> f64 {
        let format = self.0.format;
        let to_f64 = F64_FRACTION - format.fraction_bits;
        let magnitude = a & (format.sign_bit() - 1);
        let rebias = ((F64_BIAS - format.exponent_bias()) as u64) << F64_FRACTION;
        let normal = (magnitude << to_f64) + rebias;
        let low = match self.0.policy {
            Policy::Flush => 0,
            // The format's subnormal numbers are those of f64.
            Policy::Full if rebias == 0 => normal,
            Policy::Full => (magnitude as f64 * power_of_two(self.least_exponent())).to_bits(),
        };
        let finite = select(magnitude < format.min_normal(), low, normal);
        let bits = select(
            magnitude < format.infinity(),
            finite,
            (magnitude << to_f64) | F64_INFINITY,
        );
        f64::from_bits(bits | ((a & format.sign_bit()) << (64 - format.width())))
    }

    /// The exponent of the smallest subnormal number.
    #[inline(always)]
    const fn least_exponent(self) -> i32 {
        let format = self.0.format;
        1 - format.exponent_bias() - format.fraction_bits as i32
    }

    /// The value of a pattern as an `f64` and a power of two that multiplies it: 1 where products
    /// and quotients are within the range of `f64` anyway.
    #[inline(always)]
    fn factor(self, a: u64) -> (f64, i32) {
        let value = self.value(a);
        if self.0.format.exponent_bits <= 9 || value == 0.0 || !value.is_finite() {
            return (value, 0);
        }
        let is_subnormal = value.abs() < f64::MIN_POSITIVE;
        let (value, below) = if is_subnormal {
            (value * power_of_two(64), 64)
        } else {
            (value, 0)
        };
        let bits = value.to_bits();
        let exponent = (bits >> F64_FRACTION & 0x7ff) as i32 - F64_BIAS;
        let one_to_two = (bits & !F64_INFINITY) | ((F64_BIAS as u64) << F64_FRACTION);
        (f64::from_bits(one_to_two), exponent - below)
    }

    /// `value * 2^exponent` rounded to the format. The value stands for an exact result as the head
    /// of this module says; infinite or NaN, it is the result itself.
    #[inline(always)]
    fn rounded(self, value: f64, exponent: i32) -> u64 {
        let format = self.0.format;
        let bits = value.to_bits();
        let negative = bits >> 63 != 0;
        let absolute = bits & (u64::MAX >> 1);
        let magnitude = match self.0.policy {
            Policy::Flush => self.round_and_flush(absolute, negative, exponent),
            Policy::Full => self.round_fully(absolute, negative, exponent),
        };
        // A zero has no exponent that another could be added to.
        let magnitude = if format.exponent_bits <= 9 {
            magnitude
        } else {
            select(absolute == 0, 0, magnitude)
        };
        let magnitude = select(absolute == F64_INFINITY, format.infinity(), magnitude);
        select(
            absolute > F64_INFINITY,
            format.quiet_nan(),
            magnitude | self.sign(negative),
        )
    }

    /// Rounds the pattern of a magnitude in place, as if the exponent had no ends, then looks at them.
    #[inline(always)]
    fn round_and_flush(self, absolute: u64, negative: bool, exponent: i32) -> u64 {
        let format = self.0.format;
        let dropped = F64_FRACTION - format.fraction_bits;
        let all = (1_u64 << dropped) - 1;
        let increment = match self.0.rounding {
            Rounding::NearestEven => (all >> 1) + (absolute >> dropped & 1),
            Rounding::TowardZero => 0,
            Rounding::Up => select(negative, 0, all),
            Rounding::Down => select(negative, all, 0),
        };
        // The carry out of the fraction runs on into the exponent, as it must.
        let kept = (absolute.wrapping_add(increment) >> dropped) as i64;
        let rebias = i64::from(format.exponent_bias() - F64_BIAS + exponent);
        let pattern = kept + (rebias << format.fraction_bits);
        let finite = select(pattern < format.min_normal() as i64, 0, pattern as u64);
        select(
            pattern < format.infinity() as i64,
            finite,
            self.overflow(negative),
        )
    }

    /// Rounds to the last place that the format has at this magnitude, normal or subnormal.
    #[inline(always)]
    fn round_fully(self, absolute: u64, negative: bool, exponent: i32) -> u64 {
        let format = self.0.format;
        let fraction = absolute & ((1 << F64_FRACTION) - 1);
        let field = (absolute >> F64_FRACTION) as i32;
        let (significand, field) = if field == 0 {
            (fraction, 1)
        } else {
            (fraction | 1 << F64_FRACTION, field)
        };
        // The weight of the significand's last bit, and of the result's.
        let last = field - F64_BIAS - F64_FRACTION as i32 + exponent;
        let unit = self
            .least_exponent()
            .max(last + (F64_FRACTION - format.fraction_bits) as i32);
        // 55 bits drop the significand and the bit above it: all the rest is less than half.
        let dropped = (unit - last).min(F64_FRACTION as i32 + 3) as u32;
        let kept = significand >> dropped;
        let rest = significand & ((1 << dropped) - 1);
        let half = 1_u64 << (dropped - 1);
        let away = match self.0.rounding {
            Rounding::NearestEven => rest > half || (rest == half && kept & 1 == 1),
            Rounding::TowardZero => false,
            Rounding::Up => !negative && rest != 0,
            Rounding::Down => negative && rest != 0,
        };
        // With the leading one in it a normal significand counts one into the exponent field.
        let field_below = i64::from(unit - self.least_exponent());
        let pattern = (field_below << format.fraction_bits) + kept as i64 + i64::from(away);
        if pattern < format.infinity() as i64 {
            pattern as u64
        } else {
            self.overflow(negative)
        }
    }

    /// The magnitude of a result beyond the largest finite number.
    #[inline(always)]
    fn overflow(self, negative: bool) -> u64 {
        let format = self.0.format;
        let to_infinity = match self.0.rounding {
            Rounding::NearestEven => true,
            Rounding::TowardZero => false,
            Rounding::Up => !negative,
            Rounding::Down => negative,
        };
        select(to_infinity, format.infinity(), format.max_finite())
    }

    #[inline(always)]
    fn sign(self, negative: bool) -> u64 {
        u64::from(negative) << (self.0.format.width() - 1)
    }
}

/// What is missing from `sum`, the `f64` nearest to `x + y`: exact (Knuth, TwoSum). NaN where the sum
/// is not finite.
#[inline(always)]
pub(super) fn error_of_sum(x: f64, y: f64, sum: f64) -> f64 {
    let y_in_sum = sum - x;
    let x_in_sum = sum - y_in_sum;
    (x - x_in_sum) + (y - y_in_sum)
}

/// `value + error` rounded to odd: `value` where the error is zero; else the neighbour of the exact
/// sum on zero's side, with its last bit set.
#[inline(always)]
pub(super) fn to_odd(value: f64, error: f64) -> f64 {
    let bits = value.to_bits();
    let is_inexact = (error > 0.0) | (error < 0.0);
    let toward_zero = (bits ^ error.to_bits()) >> 63;
    let odd = bits.wrapping_sub(toward_zero) | 1;
    f64::from_bits(select(is_inexact, odd, bits))
}

/// `2^exponent`, of a normal `f64`.
#[inline(always)]
const fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + F64_BIAS) as u64) << F64_FRACTION)
}

/// One of two values that have both been computed.
#[inline(always)]
fn select<T>(condition: bool, when_true: T, when_false: T) -> T {
    if condition { when_true } else { when_false }
}
