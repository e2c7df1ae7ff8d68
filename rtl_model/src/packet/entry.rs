//! Rays as they enter a packet: their numbers rounded to the format, mirrored where they travel
//! backwards, and what each axis needs worked out, for a block of rays at a time.

use super::number::{flush, round_to_nearest, select, truncate};
use crate::ray::{REACH_TEXELS, Ray};

/// Rays of a block.
pub(super) const BLOCK: usize = 64;

/// The least entry coordinate, other than zero, that is walked in a packet: below it, distances to
/// node borders no longer fit an `f64`. One ray in half a million enters that near to the border of the map.
pub(super) const LEAST_COORDINATE: f64 = 1.0 / (1 << 20) as f64;

/// What is put in the place of 1/0: the exits it gives lie beyond every depth, as they should, and
/// are finite, so that a unit in the last place can be added to them.
const FAR_AWAY: f64 = f64::from_bits((1023 + 100) << 52);

/// What raises a reciprocal above the true one: a factor of 1 + 2^-40. The module's head says why.
const RAISED: f64 = 1.0 + 1.0 / (1_u64 << 40) as f64;

/// What a ray has on one axis, and does not change from step to step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AxisEntry {
    /// Entry coordinate, mirrored.
    pub(super) coordinate: f64,
    /// Offset for one unit of depth, zero or above.
    pub(super) direction: f64,
    /// Just above one over the direction.
    pub(super) reciprocal: f64,
    /// Differences of a node border and the coordinate are exact below this.
    pub(super) exact_below: f64,
    /// All ones where the axis is mirrored, else zero.
    pub(super) mirror: u64,
}

/// One axis of a block of rays.
struct AxisEntries {
    coordinate: [f64; BLOCK],
    direction: [f64; BLOCK],
    reciprocal: [f64; BLOCK],
    exact_below: [f64; BLOCK],
    mirror: [u64; BLOCK],
}

impl AxisEntries {
    const EMPTY: AxisEntries = AxisEntries {
        coordinate: [0.0; BLOCK],
        direction: [0.0; BLOCK],
        reciprocal: [0.0; BLOCK],
        exact_below: [0.0; BLOCK],
        mirror: [0; BLOCK],
    };

    /// Works out the axis from what `coordinate` and `direction` hold; the answer has a one for each
    /// ray that can be walked in a packet as far as this axis is concerned.
    #[inline(always)]
    fn set_up(&mut self) -> u64 {
        let mut walkable = 0;
        for lane in 0..BLOCK {
            let (entered, travelled) = (self.coordinate[lane], self.direction[lane]);
            let in_range = ((entered == 0.0) | (entered >= LEAST_COORDINATE))
                & (entered < 1.0)
                & (travelled.abs() <= REACH_TEXELS);
            walkable |= select(in_range, 1 << lane, 0);
            let direction = flush(round_to_nearest(travelled.abs()));
            let mirrored = (travelled < 0.0) & (direction > 0.0);
            let magnitude = truncate(entered);
            let coordinate = select(mirrored, -magnitude, magnitude);
            let reciprocal = select(direction > 0.0, 1.0 / direction * RAISED, FAR_AWAY);
            // The last one bit of the fraction is what goes when it is cleared. Where there is none,
            // the number is a power of two, and itself that bit.
            let bits = magnitude.to_bits();
            let without_last = f64::from_bits(bits & bits.wrapping_sub(1));
            let is_power = bits << 12 == 0;
            let last_bit = magnitude - select(is_power, 0.0, without_last);
            let exact_below = select(magnitude == 0.0, f64::INFINITY, last_bit * (1 << 17) as f64);
            self.coordinate[lane] = coordinate;
            self.direction[lane] = direction;
            self.reciprocal[lane] = reciprocal;
            self.exact_below[lane] = exact_below;
            self.mirror[lane] = select(mirrored, u64::MAX, 0);
        }
        walkable
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> AxisEntry {
        AxisEntry {
            coordinate: self.coordinate[lane],
            direction: self.direction[lane],
            reciprocal: self.reciprocal[lane],
            exact_below: self.exact_below[lane],
            mirror: self.mirror[lane],
        }
    }
}

/// The rays still to be walked, a block of them set up.
pub(super) struct Entrance<'a> {
    rays: &'a [Ray<f64>],
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
    pub(super) fn new(rays: &'a [Ray<f64>]) -> Entrance<'a> {
        let mut entrance = Entrance {
            rays,
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

    /// Keeps a ray for the scalar walk.
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
        let present = if count == 0 {
            0
        } else {
            u64::MAX >> (BLOCK - count)
        };
        self.waiting = self.u.set_up() & self.v.set_up() & present;
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
    use crate::float::FloatFormat;
    use crate::readings::{E7F16, FloatReading, enter};
    use crate::units::search_policy::SearchPolicy;
    use crate::units::traverse_setup::traverse_setup;
    use crate::units::traverse_step::TraverseShape;

    /// Every register of the set-up ray is that of the datapath.
    #[test]
    fn a_ray_enters_as_the_datapath_sets_it_up() {
        let format = FloatFormat::E7F16;
        let mut state = 1_u64;
        let mut random = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state
        };
        let mut rays = Vec::new();
        for _ in 0..20_000 {
            let mut number = |least: u64, most: u64| {
                let exponent = 1023 - most + random() % (most - least);
                let grain = 52 - random() % 20;
                f64::from_bits((exponent << 52) | ((random() >> 12) >> grain << grain))
            };
            let (u, v) = (number(0, 22), number(0, 22));
            let (du, dv) = (number(0, 70) * 256.0, number(0, 70));
            let signs = random();
            rays.push(Ray {
                u: if signs & 15 == 0 {
                    0.0
                } else {
                    u.min(1.0_f64.next_down())
                },
                v: v.min(1.0_f64.next_down()),
                du: if signs & 32 == 0 { -du } else { du },
                dv: if signs & 192 == 0 {
                    0.0
                } else if signs & 256 == 0 {
                    -dv
                } else {
                    dv
                },
            });
        }
        let mut entrance = Entrance::new(&rays);
        let mut reading = FloatReading(E7F16);
        let shape = TraverseShape {
            root_level: 8,
            height_bits: 8,
        };
        let mut seen = 0;
        while let Some((place, u, v)) = entrance.next() {
            let ray = enter(&mut reading, rays[place]);
            let setup = traverse_setup(
                &mut reading,
                shape,
                SearchPolicy::OH,
                ray.u,
                ray.v,
                ray.du,
                ray.dv,
            )
            .ray;
            let bits = |value| format.to_f64(value).to_bits();
            let context = format!("{:?}", rays[place]);
            assert_eq!(u.coordinate.to_bits(), bits(setup.u), "{context}");
            assert_eq!(v.coordinate.to_bits(), bits(setup.v), "{context}");
            assert_eq!(u.direction.to_bits(), bits(setup.du), "{context}");
            assert_eq!(v.direction.to_bits(), bits(setup.dv), "{context}");
            assert_eq!(
                u.exact_below.to_bits(),
                bits(setup.exact_below_u),
                "{context}"
            );
            assert_eq!(
                v.exact_below.to_bits(),
                bits(setup.exact_below_v),
                "{context}"
            );
            assert_eq!(u.mirror != 0, setup.mirror_u, "{context}");
            assert_eq!(v.mirror != 0, setup.mirror_v, "{context}");
            seen += 1;
        }
        let left_over = entrance.into_left_over();
        assert_eq!(seen + left_over.len(), rays.len());
        assert!(!left_over.is_empty() && left_over.len() < rays.len() / 4);
        for place in left_over {
            let small = |value: f64| value != 0.0 && value < LEAST_COORDINATE;
            assert!(small(rays[place].u) || small(rays[place].v));
        }
    }
}
