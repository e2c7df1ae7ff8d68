//! A whole exact fixed-point walk in software, and its one division.

use super::fixed_setup::fixed_setup;
use super::fixed_shape::FixedShape;
use super::fixed_step::{fixed_node_address, fixed_step, fixed_walk_start};
use super::search_policy::SearchPolicy;
use super::traverse::{Hit, Status};
use crate::arith::Concrete;
use crate::ray_format::QuantisedRay;
use crate::readings::F64Reading;

/// What an exact fixed-point walk answers for a ray, with nothing rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FixedHit {
    /// Texel on u, 0 to size - 1.
    pub i: u32,
    /// Texel on v, 0 to size - 1.
    pub j: u32,
    /// Is it a hit on the texel's side? Else on its top.
    pub side: bool,
    /// Depth in height steps, times the denominator.
    pub depth_numerator: i64,
    /// At least 1.
    pub depth_denominator: i64,
    /// Steps taken.
    pub steps: u32,
    /// Node crossings among them.
    pub crossings: u32,
    /// How the walk ended.
    pub status: Status,
}

/// Walks a quantised ray to its hit through a pyramid whose memory this is.
pub fn fixed_walk(
    shape: FixedShape,
    policy: SearchPolicy,
    memory: &[u16],
    ray: &QuantisedRay,
) -> FixedHit {
    // Of the reading only its integers are used, which mean the same in every one.
    fixed_walk_in(&mut F64Reading, shape, policy, memory, ray)
}

/// The same in a reading of the caller's.
pub fn fixed_walk_in<A: Concrete>(
    a: &mut A,
    shape: FixedShape,
    policy: SearchPolicy,
    memory: &[u16],
    ray: &QuantisedRay,
) -> FixedHit {
    let setup = fixed_setup(a, shape, policy.start, ray.u, ray.v, ray.du, ray.dv);
    let mut walk = fixed_walk_start(a, policy, &setup);
    loop {
        let address = fixed_node_address(a, shape, &setup.ray, &walk);
        let height = i64::from(memory[address as usize]);
        let (next, answer) = fixed_step(a, shape, policy, &setup.ray, &walk, height);
        walk = next;
        if walk.hit || walk.guard {
            return FixedHit {
                i: answer.texel_i as u32,
                j: answer.texel_j as u32,
                side: answer.side,
                depth_numerator: answer.depth_numerator,
                depth_denominator: answer.depth_denominator,
                steps: walk.steps as u32,
                crossings: walk.crossings as u32,
                status: if walk.hit { Status::Hit } else { Status::Guard },
            };
        }
    }
}

impl FixedHit {
    /// The hit as numbers: the one division of a walk.
    ///
    /// The depth is rounded down, to the largest `f64` not beyond it: never later than the hit, and
    /// earlier by less than one unit in the last place. Either coordinate is rounded against the
    /// direction of travel likewise; on a top and on the border crossed it is exact.
    pub fn to_hit(&self, shape: FixedShape, ray: &QuantisedRay) -> Hit<f64> {
        let numerator = i128::from(self.depth_numerator);
        let denominator = i128::from(self.depth_denominator);
        let size = 1_i128 << shape.root_level;
        let coordinate = |entry: i64, slope: i64| {
            let sign = if slope < 0 { -1 } else { 1 };
            let entry = i128::from(sign * entry) << shape.height_bits;
            let position = entry * denominator + numerator * i128::from(slope.abs());
            let unit = size << shape.fraction_bits();
            // A zero has no sign, whichever way the ray travels.
            sign as f64 * quotient_down(position, denominator * unit) + 0.0
        };
        Hit {
            i: self.i,
            j: self.j,
            t: quotient_down(numerator, denominator * i128::from(shape.full_height())),
            u: coordinate(ray.u, ray.du),
            v: coordinate(ray.v, ray.dv),
            steps: self.steps,
            crossings: self.crossings,
            status: self.status,
        }
    }
}

/// The largest `f64` not above `numerator / denominator`: the denominator is above zero, and both
/// are below `2^120` in magnitude.
pub fn quotient_down(numerator: i128, denominator: i128) -> f64 {
    let magnitude = numerator.unsigned_abs();
    let divisor = denominator.unsigned_abs();
    // Scaled so that the quotient has at least 54 bits, of which the first 53 count.
    let shift = 55 + magnitude.leading_zeros().abs_diff(divisor.leading_zeros());
    let (mut quotient, mut rest) = (magnitude / divisor, magnitude % divisor);
    let mut exponent = 0;
    // By pieces, since the scaled numerator may be longer than the integers here.
    while exponent < shift && quotient < 1 << 64 {
        rest <<= 1;
        let bit = u128::from(rest >= divisor);
        rest -= bit * divisor;
        quotient = (quotient << 1) | bit;
        exponent += 1;
    }
    let excess = (128 - quotient.leading_zeros()).saturating_sub(53);
    let kept = quotient >> excess;
    let is_exact = rest == 0 && kept << excess == quotient;
    // At most 53 bits times a power of two: exact.
    let value = kept as f64 * 2_f64.powi(excess as i32 - exponent as i32);
    match numerator < 0 {
        false => value,
        true if is_exact => -value,
        true => -value.next_up(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_quotient_is_the_largest_number_not_above(
            numerator in -(1_i128 << 80)..1_i128 << 80, cut in 0_u32..80,
            denominator in 1_i128..1 << 80, cut_below in 0_u32..80,
        ) {
            let (numerator, denominator) = (numerator >> cut, (denominator >> cut_below).max(1));
            let quotient = quotient_down(numerator, denominator);
            let exact = BigRational::new(numerator.into(), denominator.into());
            let rational = |value| BigRational::from_float(value).unwrap();
            prop_assert!(rational(quotient) <= exact);
            prop_assert!(rational(quotient.next_up()) > exact);
        }
    }

    #[test]
    fn quotients_that_are_numbers_are_exact() {
        assert_eq!(quotient_down(0, 255), 0.0);
        assert_eq!(quotient_down(255, 255), 1.0);
        assert_eq!(quotient_down(-3, 4), -0.75);
        assert_eq!(quotient_down(1 << 100, 1 << 20), 2_f64.powi(80));
    }
}
