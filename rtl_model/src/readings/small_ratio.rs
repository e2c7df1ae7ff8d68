//! Exact ratios of integers that a machine computes with: what intervals leave undecided is mostly
//! decided by these.

use std::cmp::Ordering;

/// The number `above / below * 2^exponent`, exactly.
///
/// Every operation answers nothing where a part would not fit. Both integers are kept odd, or zero
/// over one, so that floats and borders, which are multiples of small powers of two, stay short. They
/// are not reduced otherwise: a division takes longer than all that is done with the ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SmallRatio {
    above: i128,
    /// Above zero.
    below: i128,
    exponent: i32,
}

/// Bits of an integer but for its sign.
const MOST_BITS: u32 = 127;

impl SmallRatio {
    /// `above / below * 2^exponent`; `below` is above zero.
    pub(super) fn new(above: i128, below: i128, exponent: i32) -> Option<SmallRatio> {
        debug_assert!(below > 0);
        if above == 0 {
            return Some(SmallRatio {
                above,
                below: 1,
                exponent: 0,
            });
        }
        let (zeros_above, zeros_below) = (above.trailing_zeros(), below.trailing_zeros());
        let change = zeros_above as i32 - zeros_below as i32;
        Some(SmallRatio {
            above: above >> zeros_above,
            below: below >> zeros_below,
            exponent: exponent.checked_add(change)?,
        })
    }

    /// An `f64`, which is finite.
    pub(super) fn float(value: f64) -> Option<SmallRatio> {
        let bits = value.to_bits();
        let field = (bits >> 52 & 0x7ff) as i32;
        let fraction = i128::from(bits & ((1 << 52) - 1));
        let (significand, exponent) = match field {
            0 => (fraction, -1074),
            _ => (fraction | 1 << 52, field - 1075),
        };
        let signed = match value.is_sign_negative() {
            true => -significand,
            false => significand,
        };
        SmallRatio::new(signed, 1, exponent)
    }

    pub(super) fn plus(self, other: SmallRatio) -> Option<SmallRatio> {
        let (left, right, below) = match self.below == other.below {
            true => (self.above, other.above, self.below),
            false => (
                self.above.checked_mul(other.below)?,
                other.above.checked_mul(self.below)?,
                self.below.checked_mul(other.below)?,
            ),
        };
        if left == 0 || right == 0 {
            let is_left = right == 0;
            let exponent = if is_left { self } else { other }.exponent;
            return SmallRatio::new(left + right, below, exponent);
        }
        let exponent = self.exponent.min(other.exponent);
        let left = shifted(left, self.exponent.checked_sub(exponent)?)?;
        let right = shifted(right, other.exponent.checked_sub(exponent)?)?;
        SmallRatio::new(left.checked_add(right)?, below, exponent)
    }

    pub(super) fn times(self, other: SmallRatio) -> Option<SmallRatio> {
        SmallRatio::new(
            self.above.checked_mul(other.above)?,
            self.below.checked_mul(other.below)?,
            self.exponent.checked_add(other.exponent)?,
        )
    }

    /// The quotient by a number that is not zero.
    pub(super) fn over(self, other: SmallRatio) -> Option<SmallRatio> {
        let above = self.above.checked_mul(other.below)?;
        let below = self.below.checked_mul(other.above.checked_abs()?)?;
        let signed = match other.above < 0 {
            true => above.checked_neg()?,
            false => above,
        };
        SmallRatio::new(signed, below, self.exponent.checked_sub(other.exponent)?)
    }

    pub(super) fn negated(self) -> Option<SmallRatio> {
        let above = self.above.checked_neg()?;
        Some(SmallRatio { above, ..self })
    }

    pub(super) fn magnitude(self) -> Option<SmallRatio> {
        let above = self.above.checked_abs()?;
        Some(SmallRatio { above, ..self })
    }

    pub(super) fn scaled(self, exponent: i32) -> Option<SmallRatio> {
        SmallRatio::new(self.above, self.below, self.exponent.checked_add(exponent)?)
    }

    /// How this number compares with zero.
    pub(super) fn sign(self) -> Ordering {
        self.above.cmp(&0)
    }

    /// How this number compares with another.
    pub(super) fn compare(self, other: SmallRatio) -> Option<Ordering> {
        let signs = self.sign().cmp(&other.sign());
        if signs != Ordering::Equal || self.above == 0 {
            return Some(signs);
        }
        // Both by the product of the denominators.
        let left = self.above.checked_mul(other.below)?;
        let right = other.above.checked_mul(self.below)?;
        let (left_size, right_size) = (left.unsigned_abs(), right.unsigned_abs());
        let top = |size: u128, exponent: i32| i64::from(exponent) - i64::from(size.leading_zeros());
        let sizes = top(left_size, self.exponent).cmp(&top(right_size, other.exponent));
        let sizes = sizes.then_with(|| {
            // The leading ones stand in the same place, so both are compared from there on.
            let aligned = |size: u128| size << size.leading_zeros();
            aligned(left_size).cmp(&aligned(right_size))
        });
        Some(match self.above < 0 {
            true => sizes.reverse(),
            false => sizes,
        })
    }

    /// The largest integer not above.
    pub(super) fn floor(self) -> Option<i128> {
        let (above, below) = match self.exponent < 0 {
            true => (
                self.above,
                shifted(self.below, self.exponent.checked_neg()?)?,
            ),
            false => (shifted(self.above, self.exponent)?, self.below),
        };
        Some(above.div_euclid(below))
    }

    /// The nearest `f64`, of two as near the even one; none where it is not a normal number or the
    /// denominator leaves too few bits for the quotient.
    pub(super) fn to_f64(self) -> Option<f64> {
        if self.above == 0 {
            return Some(0.0);
        }
        let size = self.above.unsigned_abs();
        let zeros = size.leading_zeros();
        let (size, below) = (size << zeros, self.below.unsigned_abs());
        // The quotient has more bits than a significand and the one that rounds it.
        if below.leading_zeros() < 60 {
            return None;
        }
        let (quotient, rest) = match below {
            1 => (size, 0),
            _ => (size / below, size % below),
        };
        // What is cut off counts only as being there, and does so in the last bit.
        let nearest = (quotient | u128::from(rest != 0)) as f64;
        let exponent = self.exponent.checked_sub(zeros as i32)?;
        // Exact, since both are normal numbers and so is the result.
        if !(-1000..=800).contains(&exponent) {
            return None;
        }
        let value = nearest * power_of_two(exponent);
        Some(match self.above < 0 {
            true => -value,
            false => value,
        })
    }
}

/// `value * 2^amount`; `amount` is not below zero.
fn shifted(value: i128, amount: i32) -> Option<i128> {
    let room = value.unsigned_abs().leading_zeros() as i32 - (128 - MOST_BITS as i32);
    (amount <= room).then(|| value << amount)
}

/// `2^exponent`, which is a normal number: -1022 to 1023.
pub(super) fn power_of_two(exponent: i32) -> f64 {
    debug_assert!((-1022..=1023).contains(&exponent));
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigInt;
    use num_rational::BigRational;
    use num_traits::{Signed, ToPrimitive};
    use proptest::prelude::*;

    fn exactly(ratio: SmallRatio) -> BigRational {
        let integers = BigRational::new(BigInt::from(ratio.above), BigInt::from(ratio.below));
        integers * BigRational::from(BigInt::from(2)).pow(ratio.exponent)
    }

    /// Ratios of all sizes, up to those that leave no bit free.
    fn ratio() -> impl Strategy<Value = SmallRatio> {
        let integer = || (any::<i128>(), 0..128_u32).prop_map(|(bits, amount)| bits >> amount);
        let any = (integer(), integer(), -90..90_i32).prop_map(|(above, below, exponent)| {
            let below = below.checked_abs().unwrap_or(1).max(1);
            SmallRatio::new(above, below, exponent).expect("a small exponent")
        });
        let float = prop_oneof![
            -2.0..2.0_f64,
            (-16..16_i32).prop_map(|n| f64::from(n) / 8.0)
        ];
        prop_oneof![
            any,
            float.prop_map(|value| SmallRatio::float(value).expect("a small exponent"))
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn what_is_answered_is_exact(a in ratio(), b in ratio(), exponent in -90..90_i32) {
            let (x, y) = (exactly(a), exactly(b));
            let same = |small: Option<SmallRatio>, big: BigRational| {
                small.is_none_or(|small| exactly(small) == big)
            };
            prop_assert!(same(a.plus(b), &x + &y));
            prop_assert!(same(a.times(b), &x * &y));
            if b.sign() != Ordering::Equal {
                prop_assert!(same(a.over(b), &x / &y));
            }
            prop_assert!(same(a.negated(), -&x));
            prop_assert!(same(a.magnitude(), x.abs()));
            let power = BigRational::from(BigInt::from(2)).pow(exponent);
            prop_assert!(same(a.scaled(exponent), &x * power));
            prop_assert_eq!(a.sign(), x.cmp(&BigRational::from(BigInt::from(0))));
            prop_assert!(a.compare(b).is_none_or(|order| order == x.cmp(&y)));
            prop_assert!(a.compare(a).is_none_or(Ordering::is_eq));
            let floor = x.floor().to_integer();
            prop_assert!(a.floor().is_none_or(|own| BigInt::from(own) == floor));
            prop_assert!(a.to_f64().is_none_or(|value| Some(value) == x.to_f64()), "{a:?}");
        }

        #[test]
        fn floats_are_taken_and_given_back(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            let ratio = SmallRatio::float(value).expect("a finite number");
            prop_assert_eq!(exactly(ratio), BigRational::from_float(value).expect("finite"));
            prop_assert!(ratio.to_f64().is_none_or(|back| back == value));
        }
    }

    #[test]
    fn numbers_of_a_walk_fit() {
        // A border at a third of a texel's width from the entry, reached by a slope of 53 bits.
        let float = |value: f64| SmallRatio::float(value).unwrap();
        let distance = float(0.75).plus(float(-0.1)).unwrap();
        let depth = distance.over(float(0.7)).unwrap();
        let travelled = depth.times(float(0.7)).unwrap();
        assert_eq!(travelled.compare(distance), Some(Ordering::Equal));
        let nearest = depth.to_f64().unwrap();
        assert!((nearest - 0.65 / 0.7).abs() < 1e-15, "{nearest}");
        let neighbours = [nearest.next_down(), nearest.next_up()];
        let orders = neighbours.map(|value| depth.compare(float(value)));
        assert_eq!(orders, [Some(Ordering::Greater), Some(Ordering::Less)]);
        let too_long = SmallRatio::new(i128::MAX, 1, 0).unwrap();
        assert_eq!(too_long.times(float(3.0)), None);
        assert_eq!(too_long.plus(too_long), None);
    }
}
