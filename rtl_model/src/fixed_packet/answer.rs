//! The hits: which texel, and exact quotients, divided once and rounded down.
//!
//! Walks that have ended are kept until there is a batch of them. Of most a branch could not be
//! foretold, and each takes three divisions; side by side they take vector instructions.

use super::entry::{NO_SLOPE, nearest_integer};
use super::lanes::AT_TOP;
use crate::packet::number::select;
use crate::units::fixed_shape::FixedShape;
use crate::units::traverse::{Hit, Status};

/// Walks of a batch.
const BATCH: usize = 32;

/// A walk that has ended in a texel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ended {
    /// The ray's place in the list.
    pub(super) ray: usize,
    pub(super) steps: u32,
    pub(super) crossings: u32,
    /// The texel, by its place in the order of the walk.
    pub(super) texel: u64,
    /// Depth reached, as the packet holds it.
    pub(super) t: f64,
    /// Was the last border crossed one of v?
    pub(super) crossed_v: bool,
    pub(super) u: EndedAxis,
    pub(super) v: EndedAxis,
}

/// The same on one axis, mirrored.
#[derive(Clone, Copy, Debug)]
pub(super) struct EndedAxis {
    pub(super) entry: f64,
    pub(super) slope: f64,
    /// From the entry to the texel's near border; needed of the axis crossed.
    pub(super) way: f64,
    pub(super) mirrored: bool,
}

/// Walks that have ended, and whose hits are still to be worked out.
pub(super) struct Answers<T> {
    /// Which texel a place is, on u and on v.
    texel_of: T,
    full_height: f64,
    size: u32,
    count: usize,
    ray: [usize; BATCH],
    steps: [u32; BATCH],
    crossings: [u32; BATCH],
    texel: [u64; BATCH],
    t: [f64; BATCH],
    /// All ones where the last border crossed was one of v.
    crossed_v: [u64; BATCH],
    u: AxisAnswers,
    v: AxisAnswers,
}

struct AxisAnswers {
    entry: [f64; BATCH],
    slope: [f64; BATCH],
    way: [f64; BATCH],
    /// The part of the map that a texel is, with the sign of the direction.
    texel: [f64; BATCH],
}

impl AxisAnswers {
    const EMPTY: AxisAnswers = AxisAnswers {
        entry: [0.0; BATCH],
        slope: [1.0; BATCH],
        way: [1.0; BATCH],
        texel: [0.0; BATCH],
    };

    #[inline(always)]
    fn set(&mut self, place: usize, axis: &EndedAxis, size: u32) {
        let texel = 1.0 / f64::from(size);
        self.entry[place] = axis.entry;
        self.slope[place] = axis.slope;
        self.way[place] = axis.way;
        self.texel[place] = select(axis.mirrored, -texel, texel);
    }

    /// The position in texture coordinates; rounded against the direction of travel.
    #[inline(always)]
    fn position(&self, place: usize, numerator: f64, denominator: f64) -> f64 {
        let slope = self.slope[place];
        let slope = select(slope == NO_SLOPE, 0.0, slope);
        // Integers below 2^53 but for a power of two, as is their sum.
        let position = self.entry[place] * denominator + numerator * slope;
        // Zero has no sign.
        quotient_down(position, denominator) * self.texel[place] + 0.0
    }
}

impl<T: Fn(u64, u32) -> (u32, u32)> Answers<T> {
    #[inline(always)]
    pub(super) fn new(shape: FixedShape, texel_of: T) -> Answers<T> {
        Answers {
            texel_of,
            full_height: shape.full_height() as f64,
            size: shape.size(),
            count: 0,
            ray: [0; BATCH],
            steps: [0; BATCH],
            crossings: [0; BATCH],
            texel: [0; BATCH],
            t: [AT_TOP; BATCH],
            crossed_v: [0; BATCH],
            u: AxisAnswers::EMPTY,
            v: AxisAnswers::EMPTY,
        }
    }

    /// Takes a walk that has ended. Its hit is written now or later.
    #[inline(always)]
    pub(super) fn add(&mut self, ended: &Ended, hits: &mut [Hit<f64>]) {
        let place = self.count % BATCH;
        self.ray[place] = ended.ray;
        self.steps[place] = ended.steps;
        self.crossings[place] = ended.crossings;
        self.texel[place] = ended.texel;
        self.t[place] = ended.t;
        self.crossed_v[place] = u64::from(ended.crossed_v).wrapping_neg();
        self.u.set(place, &ended.u, self.size);
        self.v.set(place, &ended.v, self.size);
        self.count += 1;
        if self.count == BATCH {
            self.give(hits);
        }
    }

    /// Writes all hits, rounded as `units::fixed_traverse` does.
    #[inline(always)]
    pub(super) fn give(&mut self, hits: &mut [Hit<f64>]) {
        let mut numbers = [[0.0; BATCH]; 3];
        let mut texels = [[0; BATCH]; 2];
        let [t, u, v] = &mut numbers;
        let [i, j] = &mut texels;
        for place in 0..BATCH {
            let depth = self.t[place];
            // A raised exit is never an integer.
            let on_top = (depth == AT_TOP) | (depth == nearest_integer(depth));
            let crossed_v = self.crossed_v[place];
            let way = blend(crossed_v, self.v.way[place], self.u.way[place]);
            let slope = blend(crossed_v, self.v.slope[place], self.u.slope[place]);
            let numerator = select(on_top, nearest_integer(depth), way);
            let denominator = select(on_top, 1.0, slope);
            t[place] = quotient_down(numerator, denominator * self.full_height);
            u[place] = self.u.position(place, numerator, denominator);
            v[place] = self.v.position(place, numerator, denominator);
        }
        for place in 0..BATCH {
            (i[place], j[place]) = (self.texel_of)(self.texel[place], self.size);
        }
        for (place, &ray) in self.ray[..self.count.min(BATCH)].iter().enumerate() {
            hits[ray] = Hit {
                i: i[place],
                j: j[place],
                t: t[place],
                u: u[place],
                v: v[place],
                steps: self.steps[place],
                crossings: self.crossings[place],
                status: Status::Hit,
            };
        }
        self.count = 0;
    }
}

/// One of two numbers by a mask of all ones or none: a choice between two that have just been read
/// becomes one between their addresses.
#[inline(always)]
fn blend(mask: u64, when_ones: f64, when_zeros: f64) -> f64 {
    f64::from_bits((when_ones.to_bits() & mask) | (when_zeros.to_bits() & !mask))
}

/// The largest `f64` not above `numerator / denominator`.
#[inline(always)]
fn quotient_down(numerator: f64, denominator: f64) -> f64 {
    let quotient = numerator / denominator;
    // The product of quotient and denominator, and what rounding takes from it (Dekker 1971).
    let (high, low) = split(quotient);
    let (high_below, low_below) = split(denominator);
    let product = quotient * denominator;
    let error =
        ((high * high_below - product) + high * low_below + low * high_below) + low * low_below;
    // The product is the numerator or a neighbour, so that the difference is exact.
    let too_large = numerator - product < error;
    // The next number below: the next pattern, or of a negative one the one before. It is not zero.
    let bits = quotient.to_bits();
    let below = select(quotient < 0.0, bits.wrapping_add(1), bits.wrapping_sub(1));
    f64::from_bits(select(too_large, below, bits))
}

/// A number as the sum of two of 26 bits (Veltkamp 1968).
#[inline(always)]
fn split(value: f64) -> (f64, f64) {
    let scaled = value * 134_217_729.0;
    let high = scaled - (scaled - value);
    (high, value - high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_quotient_is_the_largest_number_not_above(
            numerator in -(1_i64 << 52)..1_i64 << 52, cut in 0_u32..52,
            denominator in 1_i64..1 << 44, cut_below in 0_u32..44,
        ) {
            let (numerator, denominator) = (numerator >> cut, (denominator >> cut_below).max(1));
            let quotient = quotient_down(numerator as f64, denominator as f64);
            let exact = BigRational::new(numerator.into(), denominator.into());
            let rational = |value| BigRational::from_float(value).unwrap();
            prop_assert!(rational(quotient) <= exact);
            prop_assert!(rational(quotient.next_up()) > exact);
        }
    }
}
