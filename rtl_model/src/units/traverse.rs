//! A whole walk in software: the traverse unit with nobody waiting behind.

use super::search_policy::SearchPolicy;
use super::traverse_setup::traverse_setup;
use super::traverse_step::{TraverseShape, node_address, traverse_step, walk_start};
use crate::maps::Pyramid;
use crate::ray::Ray;
use crate::readings::NumberFormat;
use std::fmt;

/// How a walk ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Status {
    /// At the surface.
    Hit,
    /// At the step bound: a defect, unless a test provoked it.
    Guard,
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Status::Hit => "hit",
            Status::Guard => "guard",
        })
    }
}

/// What a traverse unit answers for a ray; numbers are the reading's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hit<N> {
    /// Texel on u, 0 to size - 1.
    pub i: u32,
    /// Texel on v, 0 to size - 1.
    pub j: u32,
    /// Depth, 0 (top) to 1 (bottom).
    pub t: N,
    /// Position on u, on the ray as it entered: not wrapped to the map.
    pub u: N,
    /// Position on v.
    pub v: N,
    /// Steps taken.
    pub steps: u32,
    /// Node crossings among them.
    pub crossings: u32,
    /// How the walk ended.
    pub status: Status,
}

/// The traverse unit's shape for a map.
pub fn shape_for(pyramid: &Pyramid) -> TraverseShape {
    TraverseShape {
        root_level: pyramid.levels(),
        height_bits: pyramid.bits(),
    }
}

/// Walks a ray to its hit, as the policy says. The ray's numbers are the reading's, u and v in
/// [0, 1), its reach at most [`crate::ray::REACH_TEXELS`].
pub fn walk<R: NumberFormat>(
    reading: &mut R,
    policy: SearchPolicy,
    pyramid: &Pyramid,
    memory: &[u16],
    ray: Ray<R::Num>,
) -> Hit<R::Num> {
    let shape = shape_for(pyramid);
    let setup = traverse_setup(reading, shape, policy, ray.u, ray.v, ray.du, ray.dv);
    let mut walk = walk_start(reading, policy, &setup);
    loop {
        let address = node_address(reading, shape, policy, &setup.ray, &walk);
        let height = i64::from(memory[address as usize]);
        let result = traverse_step(reading, shape, policy, &setup.ray, &walk, height);
        walk = result.walk;
        if walk.hit || walk.guard {
            return Hit {
                i: result.texel_i as u32,
                j: result.texel_j as u32,
                t: walk.t,
                u: result.position_u,
                v: result.position_v,
                steps: walk.steps as u32,
                crossings: walk.crossings as u32,
                status: if walk.hit { Status::Hit } else { Status::Guard },
            };
        }
    }
}
