//! Rays as they enter a packet: quantised, mirrored where they travel backwards, and what each axis
//! needs worked out, for a block of rays at a time.
//!
//! Quantising is [`crate::ray_format::RayFormat::quantise`], done in `f64` without a branch; a test
//! holds it to that.

use super::MOST_PRODUCT;
use crate::packet::number::{larger, select, smaller};
use crate::ray::Ray;
use crate::units::fixed_shape::FixedShape;

/// Rays of a block.
pub(super) const BLOCK: usize = 64;

/// Stands for a slope of zero.
pub(super) const NO_SLOPE: f64 = power_of_two(-200);

/// Half a unit in the last place of 1.
const U: f64 = f64::EPSILON / 2.0;

/// By what factors numbers are moved so that ties are broken as defined; the module's head says why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Factors {
    /// Of reciprocals of slopes on u.
    pub(super) raised_on_u: f64,
    /// Of reciprocals of slopes on v.
    pub(super) raised_on_v: f64,
    /// Of slopes for what has been travelled.
    pub(super) lowered: f64,
}

impl Factors {
    pub(super) const DEFINED: Factors = Factors {
        raised_on_u: 1.0 + 4.0 * U,
        raised_on_v: 1.0 + 12.0 * U,
        lowered: 1.0 - 20.0 * U,
    };
}

const fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// What a ray has on one axis, and does not change from step to step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AxisEntry {
    /// Entry coordinate in texels, mirrored.
    pub(super) entry: f64,
    /// Texels per height step, above zero.
    pub(super) slope: f64,
    /// Just below the slope.
    pub(super) lowered_slope: f64,
    /// Just above one over the slope.
    pub(super) reciprocal: f64,
    /// All ones where the axis is mirrored, else zero.
    pub(super) mirror: u64,
}

/// One axis of a block of rays.
struct AxisEntries {
    /// Of the rays as they come.
    coordinate: [f64; BLOCK],
    direction: [f64; BLOCK],
    /// As in [`AxisEntry`].
    entry: [f64; BLOCK],
    slope: [f64; BLOCK],
    lowered_slope: [f64; BLOCK],
    reciprocal: [f64; BLOCK],
    mirror: [u64; BLOCK],
}

/// What quantising depends on.
#[derive(Clone, Copy)]
struct Scales {
    size: f64,
    /// Units of an entry in a texel.
    entry_units: f64,
    /// Texels of one such unit.
    entry_unit: f64,
    /// Units of a slope in a texel.
    slope_units: f64,
    /// Texels of one such unit.
    slope_unit: f64,
    full_height: f64,
    /// The largest magnitude of a slope, in its units.
    steepest: f64,
}

impl Scales {
    fn new(shape: FixedShape) -> Scales {
        Scales {
            size: shape.size().into(),
            entry_units: power_of_two(shape.entry_fraction_bits as i32),
            entry_unit: power_of_two(-(shape.entry_fraction_bits as i32)),
            slope_units: power_of_two(shape.fraction_bits() as i32),
            slope_unit: power_of_two(-(shape.fraction_bits() as i32)),
            full_height: shape.full_height() as f64,
            steepest: ((1_u64 << shape.slope_bits) - 1) as f64,
        }
    }
}

/// The nearest integer, of a number from 0 to 2^51; of two as near, either.
#[inline(always)]
pub(super) fn nearest_integer(value: f64) -> f64 {
    const SHIFTER: f64 = power_of_two(52);
    value + SHIFTER - SHIFTER
}

impl AxisEntries {
    const EMPTY: AxisEntries = AxisEntries {
        coordinate: [0.0; BLOCK],
        direction: [0.0; BLOCK],
        entry: [0.0; BLOCK],
        slope: [0.0; BLOCK],
        lowered_slope: [0.0; BLOCK],
        reciprocal: [0.0; BLOCK],
        mirror: [0; BLOCK],
    };

    /// Works out the axis from what `coordinate` and `direction` hold.
    #[inline(always)]
    fn set_up(&mut self, scales: Scales, raised: f64, lowered: f64) {
        for lane in 0..BLOCK {
            let (coordinate, direction) = (self.coordinate[lane], self.direction[lane]);
            // Scaling by powers of two is exact.
            let scaled = coordinate * (scales.size * scales.entry_units);
            let nearest = nearest_integer(scaled);
            let truncated = nearest - select(nearest > scaled, 1.0, 0.0);
            let entry = truncated * scales.entry_unit;

            let texels = direction.abs() * (scales.size * scales.slope_units);
            let quotient = nearest_integer(texels / scales.full_height);
            // Exact: as the definition's. The quotient was rounded twice, so it may be one off.
            let remainder = texels - quotient * scales.full_height;
            let more = select(2.0 * remainder >= scales.full_height, 1.0, 0.0);
            let less = select(-2.0 * remainder > scales.full_height, 1.0, 0.0);
            let units = smaller(quotient + more - less, scales.steepest);
            let mirrored = (direction < 0.0) & (units > 0.0);
            let slope = larger(units * scales.slope_unit, NO_SLOPE);

            self.entry[lane] = select(mirrored, -entry, entry);
            self.slope[lane] = slope;
            self.lowered_slope[lane] = slope * lowered;
            self.reciprocal[lane] = 1.0 / slope * raised;
            self.mirror[lane] = select(mirrored, u64::MAX, 0);
        }
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> AxisEntry {
        AxisEntry {
            entry: self.entry[lane],
            slope: self.slope[lane],
            lowered_slope: self.lowered_slope[lane],
            reciprocal: self.reciprocal[lane],
            mirror: self.mirror[lane],
        }
    }
}

/// The rays still to be walked, a block of them set up.
pub(super) struct Entrance<'a> {
    rays: &'a [Ray<f64>],
    scales: Scales,
    factors: Factors,
    /// The first ray of the block.
    first: usize,
    /// A one for each ray of the block that waits.
    waiting: u64,
    u: AxisEntries,
    v: AxisEntries,
    /// Rays that no packet can walk, by their place among all.
    left_over: Vec<usize>,
}

impl<'a> Entrance<'a> {
    #[inline(always)]
    pub(super) fn new(shape: FixedShape, factors: Factors, rays: &'a [Ray<f64>]) -> Entrance<'a> {
        let mut entrance = Entrance {
            rays,
            scales: Scales::new(shape),
            factors,
            first: 0,
            waiting: 0,
            u: AxisEntries::EMPTY,
            v: AxisEntries::EMPTY,
            left_over: Vec::new(),
        };
        entrance.set_up_block();
        entrance
    }

    /// The next ray: its place among all, its axes. None where all have entered.
    #[inline(always)]
    pub(super) fn next(&mut self) -> Option<(usize, AxisEntry, AxisEntry)> {
        while self.waiting == 0 {
            if self.rays.len() - self.first <= BLOCK {
                return None;
            }
            self.first += BLOCK;
            self.set_up_block();
        }
        let lane = self.waiting.trailing_zeros() as usize;
        self.waiting &= self.waiting - 1;
        let lane = lane % BLOCK;
        Some((self.first + lane, self.u.get(lane), self.v.get(lane)))
    }

    /// Keeps a ray for the definition.
    pub(super) fn leave_over(&mut self, ray: usize) {
        self.left_over.push(ray);
    }

    /// The rays that no packet has walked.
    pub(super) fn into_left_over(self) -> Vec<usize> {
        self.left_over
    }

    #[inline(always)]
    fn set_up_block(&mut self) {
        let rays = &self.rays[self.first..];
        let count = rays.len().min(BLOCK);
        for (lane, ray) in rays[..count].iter().enumerate() {
            self.u.coordinate[lane] = ray.u;
            self.v.coordinate[lane] = ray.v;
            self.u.direction[lane] = ray.du;
            self.v.direction[lane] = ray.dv;
        }
        let factors = self.factors;
        self.u
            .set_up(self.scales, factors.raised_on_u, factors.lowered);
        self.v
            .set_up(self.scales, factors.raised_on_v, factors.lowered);
        let mut walkable = 0;
        for lane in 0..BLOCK {
            let slope = larger(self.u.slope[lane], self.v.slope[lane]);
            let way = slope * self.scales.full_height + self.scales.size;
            let product = (way * self.scales.entry_units) * (slope * self.scales.slope_units);
            walkable |= select(product < MOST_PRODUCT, 1 << lane, 0);
        }
        let present = if count == 0 {
            0
        } else {
            u64::MAX >> (BLOCK - count)
        };
        self.waiting = walkable & present;
        let mut others = present & !self.waiting;
        while others != 0 {
            self.left_over
                .push(self.first + others.trailing_zeros() as usize);
            others &= others - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixed::FixedFormat;
    use crate::maps::{HeightMap, Pyramid};
    use crate::ray_format::RayFormat;
    use proptest::prelude::*;

    proptest! {
        /// Entries, slopes and signs are those of the definition's quantiser, saturated or not.
        #[test]
        fn rays_enter_as_they_are_quantised(
            rays in proptest::collection::vec(
                (0.0..1.0_f64, 0.0..1.0_f64, -64.0..64.0_f64, -64.0..64.0_f64, 0_i32..40, 0_u32..4),
                1..130,
            ),
            bits in prop_oneof![Just(8_u32), Just(16)],
            integer_bits in prop_oneof![Just(1_u32), Just(8)],
            entry_bits in 0_u32..13,
        ) {
            let map = HeightMap::new("flat", 256, bits, vec![0; 256 * 256]).unwrap();
            let pyramid = Pyramid::new(&map);
            let format = FixedFormat::q(integer_bits, bits + entry_bits);
            let format = RayFormat::told(format, &pyramid).unwrap();
            let rays: Vec<Ray<f64>> = rays
                .into_iter()
                .map(|(u, v, du, dv, shift, zero)| Ray {
                    u,
                    v: (v * 256.0).floor() / 256.0,
                    du: if zero == 0 { 0.0 } else { du * 2.0_f64.powi(-shift) },
                    dv: if zero == 1 { -0.0 } else { dv },
                })
                .collect();
            let mut entrance = Entrance::new(format.shape(), Factors::DEFINED, &rays);
            let mut seen = 0;
            while let Some((place, u, v)) = entrance.next() {
                let ray = format.quantise(rays[place]);
                let axis = |entry: i64, slope: i64| {
                    let sign = if slope < 0 { -1.0 } else { 1.0 };
                    let units = slope.abs() as f64 * power_of_two(-(format.shape().fraction_bits() as i32));
                    let texels = entry as f64 * power_of_two(-(entry_bits as i32));
                    (sign * texels, if slope == 0 { NO_SLOPE } else { units }, slope < 0)
                };
                prop_assert_eq!((u.entry, u.slope, u.mirror != 0), axis(ray.u, ray.du));
                prop_assert_eq!((v.entry, v.slope, v.mirror != 0), axis(ray.v, ray.dv));
                seen += 1;
            }
            prop_assert_eq!(seen + entrance.into_left_over().len(), rays.len());
        }
    }
}
