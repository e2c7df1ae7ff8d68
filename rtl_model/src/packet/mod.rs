//! The `oh` walk of e7f16 for many rays at once: the same hits as the datapath's, bit for bit, faster
//! than a scalar walk in the machine's own `f32`.
//!
//! Rays are walked in packets of 32, each register of the walk an array with a place for each ray;
//! a step of the packet is one loop without a branch, which the compiler turns into vector
//! instructions ([`crate::instruction_set`]). A ray that has ended makes room for the next at once.
//! `units::traverse_step` remains the definition; tests hold every hit against it.
//!
//! # Why the bits are the same
//!
//! Numbers are `f64` with the value that e7f16 has. *Truncated* means rounded to 17 significant bits
//! toward zero, which is clearing 36 bits of the pattern. A ray enters a packet only if its entry
//! coordinates are zero or at least 2^-20 (others are left to the scalar walk), so that a
//! coordinate is a multiple of 2^-36; directions are below 2^15, and so are all borders.
//!
//! 1. **Distances are exact in `f64`.** A node's border is a multiple of a texel or half of one, at
//!    least 2^-13; border minus coordinate is a multiple of 2^-36 below 2^16: at most 52 bits. So the
//!    distance to the far border can be *carried*: going to the next node adds the node's size,
//!    taking the near child subtracts half of it, and neither rounds. The midline's distance is the
//!    far border's less half a node. The step's distance is this one, truncated.
//! 2. **An exit needs no division.** The step truncates the quotient Q = A / B of two numbers of 17
//!    bits. Here A is multiplied by a reciprocal that is raised by a factor 1 + 2^-40. With at most
//!    three roundings of 2^-53 each, the product lies between Q and Q (1 + 2^-39). It truncates as Q
//!    does unless a number of 17 bits g lies above Q and not above the product. But g B and A are
//!    multiples of a common power of two, and g B > A; with significands of 17 bits that makes g at
//!    least Q (1 + 2^-34). If Q itself has 17 bits, the product is not below it: so truncates to it.
//! 3. **Nor does a comparison of two rounded numbers.** A child is the far one if the truncated
//!    distance travelled x exceeds the midline's distance y rounded up: up(y) < trunc(x). Let p be
//!    the number of 17 bits just before trunc(x). The condition says up(y) <= p, and as p is
//!    representable, that is y <= p. So y stays as it is, and p is the pattern of trunc(x) less one
//!    unit. After a crossing of v, u asks up(y) <= trunc(x), which is y <= trunc(x): no unit is taken
//!    off. A y at or below zero means the far child whatever x is, so 0 is put below p (which for x = 0
//!    is not a number: the comparison that finds the larger then gives 0).
//! 4. **Nothing underflows or overflows unnoticed.** Distances are zero or at least 2^-36 and depths at
//!    least 2^-16; so exits are at least 2^-51. A distance travelled may fall below 2^-62 where the
//!    format has a zero: y is a multiple of 2^-36, so the comparison above does not see it, and in
//!    the answer it is flushed. An exit beyond the format's largest number, or infinite where a
//!    direction is zero, is some number above 2^26 here. It makes no difference: the depth of a node is
//!    at most 1, so that exits beyond 2 are never waited for, and of two exits that lie
//!    that far apart neither is in doubt.
//! 5. **The rest does not round**: the larger, the smaller, a comparison, a unit in the last place
//!    added to a pattern, indices. Positions are a sum of two numbers of 17 bits, rounded twice to
//!    nearest, to 53 bits and to 17: which is as good as once, since 53 >= 2 * 17 + 2.
//!
//! What the step does at a corner in doubt is done by the lane alone, out of line (`corner.rs`); the
//! registers `corner_owed` and `corner_paid` are zero in between. Steps are not counted in the loop:
//! the packet has its own count, and the lane the one at which its ray entered. Crossings are the steps
//! that did not go down, of which a hit has one for each level.

mod corner;
mod entry;
mod lanes;
pub(crate) mod node;
pub(crate) mod number;
mod walk;

use crate::instruction_set::InstructionSet;
use crate::maps::Pyramid;
use crate::ray::Ray;
use crate::readings::{E7F16, FloatReading};
use crate::units::traverse::{Hit, shape_for};
use crate::walker::{Way, walk_in};

/// Walks lists of rays through one map, in e7f16, by method `oh`. Threads can share it.
#[derive(Clone, Debug)]
pub struct PacketWalker<'a> {
    pyramid: &'a Pyramid,
    depths: node::NodeDepths,
    bounds: lanes::ExitBounds,
    instruction_set: InstructionSet,
}

impl<'a> PacketWalker<'a> {
    /// A walker through the map under `pyramid`. It takes a copy of the pyramid: twice its memory.
    pub fn new(pyramid: &'a Pyramid) -> PacketWalker<'a> {
        PacketWalker {
            pyramid,
            depths: node::NodeDepths::new(pyramid),
            bounds: lanes::ExitBounds::DEFINED,
            instruction_set: InstructionSet::default(),
        }
    }

    /// The same, compiled for these instructions. The hits are the same.
    pub fn with(self, instruction_set: InstructionSet) -> PacketWalker<'a> {
        PacketWalker {
            instruction_set,
            ..self
        }
    }

    /// Walks rays that [`crate::walker::Walker::admit`] has let pass; the hit of each is written to
    /// its place. Long lists are walked faster than short ones: at the end lanes run empty.
    ///
    /// # Panics
    /// If there are not as many hits as rays.
    pub fn walk(&self, admitted: &[Ray<f64>], hits: &mut [Hit<f64>]) {
        assert_eq!(admitted.len(), hits.len(), "a hit for each ray");
        let left_over = self.instruction_set.run(walk::WalkRays {
            shape: shape_for(self.pyramid),
            depths: self.depths.as_slice(),
            bounds: self.bounds,
            rays: admitted,
            hits,
        });
        let mut reading = FloatReading(E7F16);
        for ray in left_over {
            hits[ray] = walk_in(&mut reading, Way::OH, self.pyramid, admitted[ray]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::{Channel, MapSource};
    use crate::units::traverse::Status;

    /// The comparison of `tests/packet_walk.rs`, here where a fault can be planted.
    fn differences(plant: impl Fn(&mut PacketWalker<'_>)) -> usize {
        let source: MapSource = "procedural:spikes:256:3".parse().unwrap();
        let map = source.load(Channel::Grey, false).unwrap();
        let pyramid = Pyramid::new(&map);
        let mut walker = PacketWalker::new(&pyramid);
        plant(&mut walker);
        let ray = |number: u32| {
            let angle = f64::from(number) * 0.618;
            Ray {
                u: (f64::from(number) * 0.754_877).fract(),
                v: (f64::from(number) * 0.569_840).fract(),
                du: 2.0 * angle.sin(),
                dv: 2.0 * angle.cos(),
            }
        };
        let rays: Vec<Ray<f64>> = (0..20_000).map(ray).collect();
        let unwalked = Hit {
            i: 0,
            j: 0,
            t: 0.0,
            u: 0.0,
            v: 0.0,
            steps: 0,
            crossings: 0,
            status: Status::Guard,
        };
        let mut hits = vec![unwalked; rays.len()];
        walker.walk(&rays, &mut hits);
        let mut judge = FloatReading(E7F16);
        let is_different = |(ray, hit): (&Ray<f64>, &Hit<f64>)| {
            let judged = walk_in(&mut judge, Way::OH, &pyramid, *ray);
            format!("{judged:?}") != format!("{hit:?}")
        };
        rays.iter()
            .zip(&hits)
            .map(is_different)
            .filter(|&is| is)
            .count()
    }

    #[test]
    fn planted_faults_are_found() {
        assert_eq!(differences(|_| ()), 0);
        let ulp = number::ULP;
        let defined = lanes::ExitBounds::DEFINED;
        for (exact, rounded) in [(0, 3), (2, 3), (1, 2), (1, 4)] {
            let bounds = lanes::ExitBounds {
                exact: exact * ulp,
                rounded: rounded * ulp,
            };
            let found = differences(|walker| walker.bounds = bounds);
            assert!(found > 0, "{bounds:?} in place of {defined:?}");
        }
    }
}
