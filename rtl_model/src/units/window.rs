//! A whole window walk in software, by numbers that may round and in exact fixed point.

use super::fixed_traverse::FixedHit;
use super::traverse::{Hit, Status};
use super::window_fixed_step::{WindowFixedShape, window_fixed_setup, window_fixed_step};
use super::window_step::{window_setup, window_step};
use super::window_walk::{WindowShape, WindowWalk};
use crate::arith::Concrete;
use crate::maps::{Pyramid, WINDOW_SIDE, window};
use crate::ray::Ray;
use crate::ray_format::QuantisedRay;
use crate::readings::{F64Reading, NumberFormat};

/// The shape of a window traverse unit for a map.
pub fn window_shape_for(pyramid: &Pyramid) -> WindowShape {
    WindowShape {
        root_level: pyramid.levels(),
        height_bits: pyramid.bits(),
    }
}

/// Walks a ray to its hit; a step is a window read. The ray's numbers are the reading's, u and v in
/// [0, 1), its reach at most [`crate::ray::REACH_TEXELS`].
pub fn window_walk<R: NumberFormat>(
    reading: &mut R,
    pyramid: &Pyramid,
    ray: Ray<R::Num>,
) -> Hit<R::Num> {
    let shape = window_shape_for(pyramid);
    let (ray, mut walk) = window_setup(reading, shape, ray);
    let mut t = reading.zero();
    loop {
        let heights = heights_of(pyramid, ray.ray.mirror_u, ray.ray.mirror_v, &walk);
        let result = window_step(reading, shape, &ray, &walk, t, &heights);
        walk = result.walk;
        t = result.t;
        if walk.hit || walk.guard {
            return Hit {
                i: result.texel_i as u32,
                j: result.texel_j as u32,
                t,
                u: result.position_u,
                v: result.position_v,
                steps: walk.steps as u32,
                crossings: walk.crossings as u32,
                status: status(&walk),
            };
        }
    }
}

/// Walks a quantised ray to its hit.
pub fn window_fixed_walk(
    shape: WindowFixedShape,
    pyramid: &Pyramid,
    ray: &QuantisedRay,
) -> FixedHit {
    // Of the reading only its integers are used, which mean the same in every one.
    let a = &mut F64Reading;
    let (ray, mut walk) = window_fixed_setup(a, shape, ray.u, ray.v, ray.du, ray.dv);
    loop {
        let heights = heights_of(pyramid, ray.ray.mirror_u, ray.ray.mirror_v, &walk.walk);
        let (next, answer) = window_fixed_step(a, shape, &ray, &walk, &heights);
        walk = next;
        if walk.walk.hit || walk.walk.guard {
            return FixedHit {
                i: answer.texel_i as u32,
                j: answer.texel_j as u32,
                side: answer.side,
                depth_numerator: answer.depth_numerator,
                depth_denominator: answer.depth_denominator,
                steps: walk.walk.steps as u32,
                crossings: walk.walk.crossings as u32,
                status: status(&walk.walk),
            };
        }
    }
}

/// The heights of the walk's window, as [`super::window_walk`] addresses it.
fn heights_of<A: Concrete>(
    pyramid: &Pyramid,
    mirror_u: bool,
    mirror_v: bool,
    walk: &WindowWalk<A>,
) -> [i64; 16] {
    let lowest = |mirror, index| {
        if mirror { -WINDOW_SIDE - index } else { index }
    };
    let (i, j) = (lowest(mirror_u, walk.i), lowest(mirror_v, walk.j));
    window(pyramid, walk.level as u32, i, j).map(i64::from)
}

fn status<A: Concrete>(walk: &WindowWalk<A>) -> Status {
    if walk.hit { Status::Hit } else { Status::Guard }
}
