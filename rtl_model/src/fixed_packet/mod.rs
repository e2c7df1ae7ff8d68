//! Exact fixed-point walks of many rays at once: the same hits as the definition's, bit for bit,
//! several times as fast as a scalar walk in the machine's own `f32`.
//!
//! As in [`crate::packet`], rays are walked in packets, each register of the walk an array with a
//! place for each ray, and a step of the packet is one loop without a branch. The definition
//! (`units::fixed_step`) compares integers; here numbers are `f64`, in texels and height steps, and
//! what is compared are quotients and products that have been rounded. They never compare
//! differently, because two that differ do so by more than all the rounding.
//!
//! # Why every decision is exact
//!
//! Let u = 2^-53, half a unit in the last place of 1: rounding to nearest is off by u at most, in
//! proportion. Entries are multiples of 2^-P of a texel and slopes of 2^-F (P = F - height bits). A
//! *way* is how far a border of a node, or its midline, lies beyond the entry: a multiple of 2^-P,
//! and not above `reach + size` texels, since the node holds a point of the ray. A ray is walked here only
//! if the longest way times the larger slope, as integers, is below `MOST_PRODUCT` = 2^53 / 23; the
//! others are left to the definition.
//!
//! 1. **Ways are exact.** They have fewer than 53 bits, and are carried: going to the next node adds
//!    its side, taking the near child subtracts half of it.
//! 2. **Exits are quotients, raised.** The ray leaves a node on an axis at Q = way / slope height steps.
//!    It is computed as a product with a reciprocal that has been raised by 4u on u and by 12u on v.
//!    With three roundings that gives Q (1 + 1u .. 7u) on u, and Q (1 + 9u .. 15u) on v.
//! 3. **Which axis is left first.** Two exits that differ are a / b and c / d with a d and c b different
//!    integers below `MOST_PRODUCT`: they differ by 23u at least, in proportion, more than the 14u by which
//!    they can be raised apart. Two that are equal come out with that on u below that on v: u first, as
//!    the tie is defined.
//! 4. **A depth of n height steps against an exit.** n times the slope, and the way, are multiples of 2^-F
//!    below 2^15; F is at most `MOST_FRACTION_BITS`, so that n and Q differ by 32u or are equal. So
//!    "n is not above the raised exit" says "n is not above Q". The depth that a crossing leaves in the
//!    register is a raised exit, and compares likewise; it is never an integer.
//! 5. **The far child.** The ray is beyond a midline if the depth t, times the slope, is above the
//!    midline's way. Where t is n both sides are exact. Where it is a raised exit, way / slope of the
//!    crossing on one axis times the slope of the other, the two sides differ by 23u or are equal. The
//!    slope is lowered by 20u for that product, which makes it less than the true one by 3u to 22u: so
//!    a ray on the midline has not left the near child. After a crossing of v the slope on u is not
//!    lowered: so on u a ray on the midline is in the far child, through a corner u being crossed first.
//! 6. **The beginning.** t starts as 2^-100 for zero, and a slope of zero is made 2^-200. So a ray that
//!    starts on a midline is in the far child, whichever way it goes or does not; all exits on that axis
//!    are beyond every depth; and no other comparison sees the difference.
//!
//! The answer is exact too: a hit on a top has the depth n; one on a side has that of the last
//! crossing, whose way is the way to the texel's near border. Depth and coordinates are quotients of
//! integers below 2^53, divided once and rounded down by looking at the remainder (`answer.rs`).

mod answer;
mod block;
mod entry;
mod lanes;
mod walk;

use crate::instruction_set::InstructionSet;
use crate::maps::Pyramid;
use crate::packet::node::interleave;
use crate::ray::Ray;
use crate::ray_format::RayFormat;
use crate::scene::Method;
use crate::units::fixed_traverse::fixed_walk;
use crate::units::search_policy::SearchPolicy;
use crate::units::traverse::Hit;
use crate::units::wide_fixed::wide_fixed_walk;
use crate::units::wide_fixed_step::WideFixedShape;
use block::{BlockWalks, Blocks};
use entry::Factors;
use lanes::NodeWalks;
use walk::Walks;

/// The longest way times the larger slope, as integers, is below this.
const MOST_PRODUCT: f64 = (1_u64 << 53) as f64 / 23.0;

/// The most fraction bits of a slope.
const MOST_FRACTION_BITS: u32 = 32;

/// Walks lists of rays through one map in exact fixed point, by method `oh` or `block`. Threads can
/// share it.
#[derive(Clone, Debug)]
pub struct FixedPacketWalker<'a> {
    pyramid: &'a Pyramid,
    format: RayFormat,
    order: Order,
    depths: Depths,
    factors: Factors,
    instruction_set: InstructionSet,
}

/// Which nodes are walked through, and in which order their depths lie in memory.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "a walker has one of them")]
enum Order {
    /// All nodes in Z order: `oh`.
    Nodes,
    /// Cells of lines of 4 x 4: `block`.
    Blocks(Blocks),
}

/// The depth of every node in height steps, in the order of the walk.
#[derive(Clone, Debug)]
enum Depths {
    /// Of heights of 8 bits.
    Narrow(Vec<u8>),
    /// Of 16.
    Wide(Vec<u16>),
}

impl<'a> FixedPacketWalker<'a> {
    /// A walker by this method through the map under `pyramid`, by rays in this format of it. It
    /// takes a copy of the pyramid. None where it does not have the method, or slopes have more
    /// fraction bits than it can tell apart.
    pub fn new(
        method: Method,
        pyramid: &'a Pyramid,
        format: &RayFormat,
    ) -> Option<FixedPacketWalker<'a>> {
        let shape = format.shape();
        if shape.fraction_bits() > MOST_FRACTION_BITS {
            return None;
        }
        let order = match method {
            Method::Oh => Order::Nodes,
            Method::Block => Order::Blocks(Blocks::new(shape.root_level, shape.height_bits)),
            _ => return None,
        };
        let full_height = shape.full_height() as u16;
        let depth = |height| full_height - height;
        let depths = match order {
            Order::Nodes => in_z_order(pyramid, depth),
            Order::Blocks(blocks) => blocks.in_order(pyramid, depth),
        };
        Some(FixedPacketWalker {
            pyramid,
            format: *format,
            order,
            depths: match pyramid.bits() {
                8 => Depths::Narrow(depths.iter().map(|&depth| depth as u8).collect()),
                _ => Depths::Wide(depths),
            },
            factors: Factors::DEFINED,
            instruction_set: InstructionSet::default(),
        })
    }

    /// The same, compiled for these instructions. The hits are the same.
    pub fn with(self, instruction_set: InstructionSet) -> FixedPacketWalker<'a> {
        FixedPacketWalker {
            instruction_set,
            ..self
        }
    }

    /// Walks rays that have been admitted ([`crate::ray::check`]); the hit of each is written to its
    /// place. Long lists are walked faster than short ones: at the end lanes run empty.
    ///
    /// # Panics
    /// If there are not as many hits as rays.
    pub fn walk(&self, admitted: &[Ray<f64>], hits: &mut [Hit<f64>]) {
        assert_eq!(admitted.len(), hits.len(), "a hit for each ray");
        let left_over = match &self.depths {
            Depths::Narrow(depths) => self.walk_over(depths, admitted, hits),
            Depths::Wide(depths) => self.walk_over(depths, admitted, hits),
        };
        for place in left_over {
            hits[place] = self.defined(admitted[place]);
        }
    }

    /// The hit of a ray as it is defined.
    fn defined(&self, admitted: Ray<f64>) -> Hit<f64> {
        let words = self.format.shape();
        let ray = self.format.quantise(admitted);
        let hit = match self.order {
            Order::Nodes => fixed_walk(words, SearchPolicy::OH, self.pyramid.memory(), &ray),
            Order::Blocks(_) => {
                let shape = WideFixedShape {
                    words,
                    log2_side: block::LOG2_SIDE,
                };
                wide_fixed_walk(shape, self.pyramid.lines(block::LOG2_SIDE), &ray)
            }
        };
        hit.to_hit(words, &ray)
    }

    fn walk_over<D: Copy + Into<i32>>(
        &self,
        depths: &[D],
        rays: &[Ray<f64>],
        hits: &mut [Hit<f64>],
    ) -> Vec<usize> {
        match self.order {
            Order::Nodes => {
                let walks = NodeWalks {
                    packet: lanes::Packet::IDLE,
                    root_level: self.pyramid.levels(),
                };
                self.walk_by(walks, depths, rays, hits)
            }
            Order::Blocks(blocks) => {
                let walks = BlockWalks {
                    packet: block::BlockPacket::IDLE,
                    blocks,
                };
                self.walk_by(walks, depths, rays, hits)
            }
        }
    }

    fn walk_by<W: Walks, D: Copy + Into<i32>>(
        &self,
        walks: W,
        depths: &[D],
        rays: &[Ray<f64>],
        hits: &mut [Hit<f64>],
    ) -> Vec<usize> {
        let shape = self.format.shape();
        self.instruction_set.run(walk::WalkRays {
            shape,
            factors: self.factors,
            walks,
            depths,
            // A cell that is gone into on the way up has been counted with those that are crossed.
            step_bound: 2 * shape.step_bound(true),
            rays,
            hits,
        })
    }
}

/// A word for each node of the pyramid, at its place in Z order.
fn in_z_order(pyramid: &Pyramid, word_of: impl Fn(u16) -> u16) -> Vec<u16> {
    let mut words = vec![0; pyramid.memory().len()];
    for level in 0..=pyramid.levels() {
        let nodes = 1_u32 << (pyramid.levels() - level);
        for j in 0..nodes {
            for i in 0..nodes {
                let place = (nodes * nodes) | interleave(i) | (interleave(j) << 1);
                words[place as usize] = word_of(pyramid.height(level, i.into(), j.into()));
            }
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::HeightMap;
    use crate::units::traverse::Status;

    /// Rays and heights on a coarse grid: ties at every turn. The answer counts the hits that are
    /// not the definition's.
    fn differences(method: Method, plant: impl Fn(&mut FixedPacketWalker<'_>)) -> usize {
        let mut state = 1_u64;
        let mut below = |count: u64| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) % count
        };
        let heights = (0..64).map(|_| 255 - 16 * below(16) as u16).collect();
        let map = HeightMap::new("ties", 8, 8, heights).unwrap();
        let pyramid = Pyramid::new(&map);
        let mut grid = |count: u64, middle: f64| (below(count) as f64 - middle) / 32.0;
        let rays: Vec<Ray<f64>> = (0..20_000)
            .map(|_| Ray {
                u: grid(32, 0.0),
                v: grid(32, 0.0),
                // A multiple of full height, so that slopes are short.
                du: grid(129, 64.0) * 255.0 / 256.0,
                dv: grid(129, 64.0) * 255.0 / 256.0,
            })
            .collect();
        let format = RayFormat::within_reach(&pyramid);
        let mut walker = FixedPacketWalker::new(method, &pyramid, &format).unwrap();
        plant(&mut walker);
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
        let is_different = |(&ray, hit): (&Ray<f64>, &Hit<f64>)| walker.defined(ray) != *hit;
        rays.iter()
            .zip(&hits)
            .filter(|&pair| is_different(pair))
            .count()
    }

    #[test]
    fn planted_faults_are_found() {
        for method in [Method::Oh, Method::Block] {
            assert_eq!(differences(method, |_| ()), 0, "{method}");
        }
        let defined = Factors::DEFINED;
        for planted in [
            Factors {
                raised_on_u: 1.0 - f64::EPSILON,
                ..defined
            },
            Factors {
                raised_on_u: defined.raised_on_v,
                raised_on_v: defined.raised_on_u,
                ..defined
            },
            Factors {
                raised_on_v: 1.0 - f64::EPSILON,
                ..defined
            },
            Factors {
                lowered: 1.0,
                ..defined
            },
            Factors {
                lowered: 0.9,
                ..defined
            },
        ] {
            for method in [Method::Oh, Method::Block] {
                let found = differences(method, |walker| walker.factors = planted);
                assert!(found > 0, "{method}: {planted:?} in place of {defined:?}");
            }
        }
    }
}
