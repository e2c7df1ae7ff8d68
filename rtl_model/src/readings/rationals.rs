//! The last stage of the exact reading: rationals of big integers, which hold every number.

use std::sync::Arc;

use super::exact::Origin;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Signed;

/// The rationals that have been worked out, by their places.
#[derive(Clone, Debug, Default)]
pub(super) struct Rationals(Vec<Option<Arc<BigRational>>>);

impl Rationals {
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    pub(super) fn at(&self, place: u32) -> Option<&Arc<BigRational>> {
        self.0.get(place as usize)?.as_ref()
    }

    pub(super) fn put(&mut self, place: u32, value: Arc<BigRational>) {
        let place = place as usize;
        if self.0.len() <= place {
            self.0.resize(place + 1, None);
        }
        self.0[place] = Some(value);
    }

    /// The rational at a place of the store, worked out once, as are those it is made of.
    pub(super) fn work_out(&mut self, store: &[Origin], place: u32) -> Arc<BigRational> {
        if let Some(known) = self.at(place) {
            return known.clone();
        }
        // Infinities occur only as exits that are never reached, and those are compared and change
        // sign; they are not computed with, and stand at no place.
        let mut of = |place| self.work_out(store, place);
        let value = match store[place as usize] {
            Origin::Given => unreachable!("a number that is given has its value"),
            Origin::Float(value) => {
                BigRational::from_float(value).expect("rays are checked to be finite")
            }
            Origin::Depth { height, bits } => {
                let full = (1_i64 << bits) - 1;
                BigRational::new((full - height).into(), full.into())
            }
            Origin::Integer(value, exponent) => {
                BigRational::from(BigInt::from(value)) * power_of_two(exponent)
            }
            Origin::Sum(a, b) => sum(&of(a), &of(b)),
            Origin::Difference(a, b) => sum(&of(a), &-of(b).as_ref()),
            Origin::Product(a, b) => product(&of(a), &of(b)),
            Origin::Quotient(a, b) => quotient(&of(a), &of(b)),
            Origin::Negated(a) => -of(a).as_ref(),
            Origin::Magnitude(a) => of(a).abs(),
            Origin::Scaled(a, exponent) => product(&of(a), &power_of_two(exponent)),
        };
        let value = Arc::new(value);
        self.put(place, value.clone());
        value
    }
}

/// Denominators up to so many bits are left as they come. To reduce a ratio takes longer than all
/// that is done with it: most are compared or rounded once.
const REDUCED_BEYOND_BITS: u64 = 512;

/// A ratio whose denominator is positive, reduced where it has grown long.
fn ratio(above: BigInt, below: BigInt) -> BigRational {
    debug_assert!(below.is_positive());
    let ratio = BigRational::new_raw(above, below);
    match ratio.denom().bits() > REDUCED_BEYOND_BITS {
        true => ratio.reduced(),
        false => ratio,
    }
}

fn sum(a: &BigRational, b: &BigRational) -> BigRational {
    let above = a.numer() * b.denom() + b.numer() * a.denom();
    ratio(above, a.denom() * b.denom())
}

fn product(a: &BigRational, b: &BigRational) -> BigRational {
    ratio(a.numer() * b.numer(), a.denom() * b.denom())
}

fn quotient(a: &BigRational, b: &BigRational) -> BigRational {
    let (above, below) = (a.numer() * b.denom(), a.denom() * b.numer());
    match below.is_negative() {
        true => ratio(-above, -below),
        false => ratio(above, below),
    }
}

fn power_of_two(exponent: i32) -> BigRational {
    let power = BigInt::from(1) << exponent.unsigned_abs();
    match exponent < 0 {
        true => BigRational::new(1.into(), power),
        false => BigRational::from(power),
    }
}
