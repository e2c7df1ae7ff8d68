//! What the sampling methods share: how densely a ray is sampled, where a sample lies, and which
//! texel of the map it reads.
//!
//! Relief mapping, parallax occlusion mapping and depth-interval grids do not walk from texel to
//! texel: they look at the map at a number of depths, evenly spaced, and take what lies between two
//! of them for empty. So they can miss, and none of their roundings is chosen to prevent it: every
//! operation rounds to nearest, but for the depths of the samples, which never pass the bottom.
//!
//! The map is read by its nearest texel, the one that the position lies in.

use crate::arith::Arith;
use crate::float::Rounding::{NearestEven, TowardZero};
use crate::ray::Ray;
use crate::readings::{NumberFormat, enter};
use crate::scene::LinearSearch;

/// Linear samples of relief mapping, of the corner rays of depth-interval grids, and of an interval
/// as long as the whole ray: one every hundredth of the depth (Judnich and Ling compare so, 8.2).
pub const LINEAR_SAMPLES: u32 = 100;

/// Binary steps behind the linear ones (Policarpo, Oliveira and Comba 2005: five).
pub const BINARY_STEPS: u32 = 5;

/// Fewest samples of parallax occlusion mapping: looking straight down (Tatarchuk 2006, 4).
pub const FEWEST_SAMPLES: u32 = 8;

/// Most samples of parallax occlusion mapping: looking along the surface (the same).
pub const MOST_SAMPLES: u32 = 50;

/// Samples by which the interval of a pixel block is widened on both sides: Judnich and Ling's
/// epsilons, of a linear step each.
pub const INTERVAL_MARGIN: u32 = 1;

/// How deep depth 1 is, in repeats of the map, where nobody says: a list of rays has no surface.
/// The number of samples of parallax occlusion mapping depends on the angle in the world.
pub const NOMINAL_DEPTH: f64 = 0.125;

/// Bits of a sample's number, signed: 0 to [`LINEAR_SAMPLES`], and one more in passing.
pub const SAMPLE_BITS: u32 = 8;

/// Bits of a texel index before it is wrapped, signed: a ray starts in texels 0 to 4095 and reaches
/// 2^14 texels either way.
pub const INDEX_BITS: u32 = 16;

/// What a sampling unit is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LinearShape {
    /// log2 of the map's size, 0 to 12.
    pub root_level: u32,
    /// Bits of a height: 8 or 16.
    pub height_bits: u32,
}

impl LinearShape {
    /// Texels on a side of the map.
    pub const fn size(self) -> u32 {
        1 << self.root_level
    }

    /// Bits of a height's address in the pyramid's memory, of which the map is the upper half.
    pub const fn address_bits(self) -> u32 {
        2 * self.root_level + 1
    }
}

/// A ray before it is set up: what its ports carry.
#[derive(Debug)]
pub struct LinearRay<A: Arith> {
    /// Entry coordinate, 0 to 1.
    pub u: A::Num,
    /// Entry coordinate on the other axis.
    pub v: A::Num,
    /// Offset for one unit of depth.
    pub du: A::Num,
    /// Offset on the other axis.
    pub dv: A::Num,
    /// Depth from one linear sample to the next: sample n lies at n times this.
    pub spacing: A::Num,
    /// Number of the first linear sample, 1 or above.
    pub first_sample: A::Int,
    /// Number of the last linear sample, at most [`LINEAR_SAMPLES`]. What lies there counts as below
    /// the surface, whatever the map says.
    pub last_sample: A::Int,
}

impl<A: Arith> Clone for LinearRay<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for LinearRay<A> {}

/// Which samples a ray takes: one every `1 / samples_to_bottom` of the depth, from `first` to
/// `last`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleRange {
    /// Samples between top and bottom, the one at the bottom among them.
    pub samples_to_bottom: u32,
    /// Number of the first one taken, 1 or above.
    pub first: u32,
    /// Number of the last one, at most `samples_to_bottom`.
    pub last: u32,
}

impl SampleRange {
    /// All of so many.
    pub const fn whole(samples: u32) -> SampleRange {
        SampleRange {
            samples_to_bottom: samples,
            first: 1,
            last: samples,
        }
    }

    /// The samples of a method for a ray, which must be as a format holds it. `depth_in_repeats` is
    /// how deep depth 1 is in repeats of the map, which tells the ray's angle in the world.
    pub fn of(search: LinearSearch, ray: Ray<f64>, depth_in_repeats: f64) -> SampleRange {
        SampleRange::whole(match search {
            LinearSearch::Relief | LinearSearch::Dig => LINEAR_SAMPLES,
            LinearSearch::Pom => pom_samples(ray, depth_in_repeats),
        })
    }
}

/// How many samples parallax occlusion mapping takes: between [`MOST_SAMPLES`] and
/// [`FEWEST_SAMPLES`] by the cosine of the angle between ray and normal, rounded down.
///
/// The paper's formula (1) has the bounds the other way round, against its own text ("increase the
/// sampling rate along the steep viewing angles") and against the program it came with.
pub fn pom_samples(ray: Ray<f64>, depth_in_repeats: f64) -> u32 {
    let along = ray.du * ray.du + ray.dv * ray.dv;
    let cosine = depth_in_repeats / (depth_in_repeats * depth_in_repeats + along).sqrt();
    let most = f64::from(MOST_SAMPLES);
    let fewer = f64::from(MOST_SAMPLES - FEWEST_SAMPLES) * cosine;
    // From 8 to 50, whatever the ray: a NaN would be 0, and a ray is checked to be finite.
    ((most - fewer) as u32).clamp(FEWEST_SAMPLES, MOST_SAMPLES)
}

impl<R: NumberFormat> LinearRay<R> {
    /// A ray in a reading's numbers, with the samples it takes.
    pub fn enter(reading: &mut R, ray: Ray<f64>, samples: SampleRange) -> LinearRay<R> {
        let Ray { u, v, du, dv } = enter(reading, ray);
        let one = reading.number_from_integer(TowardZero, 1, 0);
        let count = i64::from(samples.samples_to_bottom);
        let count = reading.number_from_integer(TowardZero, count, 0);
        LinearRay {
            u,
            v,
            du,
            dv,
            // Rounded down, so that no sample lies below the bottom.
            spacing: reading.div(TowardZero, one, count),
            first_sample: i64::from(samples.first),
            last_sample: i64::from(samples.last),
        }
    }
}

/// A place on a ray, and the texel it lies in.
pub(super) struct Place<A: Arith> {
    /// Position on u, not wrapped.
    pub(super) position_u: A::Num,
    /// Position on v.
    pub(super) position_v: A::Num,
    /// Texel on u, wrapped to the map.
    pub(super) texel_i: A::Int,
    /// Texel on v.
    pub(super) texel_j: A::Int,
}

/// Where a ray is at depth `t`.
pub(super) fn place_at<A: Arith>(
    a: &mut A,
    shape: LinearShape,
    ray: &LinearRay<A>,
    t: A::Num,
) -> Place<A> {
    let travelled_u = a.mul(NearestEven, t, ray.du);
    a.name_num("travelled_u", travelled_u);
    let travelled_v = a.mul(NearestEven, t, ray.dv);
    a.name_num("travelled_v", travelled_v);
    let position_u = a.add(NearestEven, ray.u, travelled_u);
    a.name_num("position_u", position_u);
    let position_v = a.add(NearestEven, ray.v, travelled_v);
    a.name_num("position_v", position_v);
    let texel_i = texel(a, shape, position_u, ["texels_u", "index_i", "texel_i"]);
    let texel_j = texel(a, shape, position_v, ["texels_v", "index_j", "texel_j"]);
    Place {
        position_u,
        position_v,
        texel_i,
        texel_j,
    }
}

fn texel<A: Arith>(
    a: &mut A,
    shape: LinearShape,
    position: A::Num,
    [texels, index, wrapped]: [&'static str; 3],
) -> A::Int {
    let position = a.scale(position, shape.root_level as i32);
    a.name_num(texels, position);
    let position = a.floor(position, INDEX_BITS);
    a.name_int(index, position);
    if shape.root_level == 0 {
        return a.int_constant(0);
    }
    let position = a.int_low_bits(position, shape.root_level);
    a.name_int(wrapped, position);
    position
}

/// The depth of a linear sample; `name` is that of its number as a number of the format.
pub(super) fn depth_of_sample<A: Arith>(
    a: &mut A,
    name: &'static str,
    sample: A::Int,
    spacing: A::Num,
) -> A::Num {
    let zero = a.int_constant(0);
    let sample = a.number_from_integer(TowardZero, sample, zero);
    a.name_num(name, sample);
    a.mul(TowardZero, sample, spacing)
}

/// Where the height of a texel of the map lies in the pyramid's memory (the layout is
/// [`crate::maps::Pyramid`]'s): a one, then the index on v, then on u.
pub fn texel_address<A: Arith>(
    a: &mut A,
    shape: LinearShape,
    texel_i: A::Int,
    texel_j: A::Int,
) -> A::Int {
    let size = a.int_constant(i64::from(shape.size()));
    let row = a.int_or(texel_j, size);
    let by = a.int_constant(i64::from(shape.root_level));
    let row = a.int_shift_left(row, by, 4);
    let address = a.int_or(row, texel_i);
    // Marker, v and u take 2 * root_level + 1 bits, so nothing but zeros is cut.
    let address = a.int_low_bits(address, shape.address_bits());
    a.name_int("texel_address", address);
    address
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shallower_a_ray_the_more_samples_it_takes() {
        let along = |du| Ray {
            u: 0.0,
            v: 0.0,
            du,
            dv: 0.0,
        };
        assert_eq!(pom_samples(along(0.0), 0.125), FEWEST_SAMPLES);
        assert_eq!(pom_samples(along(1e6), 0.125), 49);
        // A slope of 4 in 3: a cosine of 3 in 5.
        assert_eq!(pom_samples(along(4.0), 3.0), 24);
        let counts = [0.0, 0.1, 0.2, 0.5, 1.0, 4.0, -9.0].map(|du| pom_samples(along(du), 0.2));
        assert!(counts.is_sorted(), "{counts:?}");
    }
}
