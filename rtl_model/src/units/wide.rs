//! A whole wide walk in software.

use super::traverse::{Hit, Status};
use super::wide_setup::wide_setup;
use super::wide_shape::WideShape;
use super::wide_step::wide_step;
use super::wide_walk::wide_address;
use crate::maps::{Lines, Pyramid};
use crate::ray::Ray;
use crate::readings::NumberFormat;

/// The shape of a wide traverse unit with these lines for a map.
pub fn wide_shape_for(pyramid: &Pyramid, log2_side: u32) -> WideShape {
    WideShape {
        root_level: pyramid.levels(),
        height_bits: pyramid.bits(),
        log2_side,
    }
}

/// Walks a ray to its hit; a step is a line read. The ray's numbers are the reading's, u and v in
/// [0, 1), its reach at most [`crate::ray::REACH_TEXELS`].
pub fn wide_walk<R: NumberFormat>(
    reading: &mut R,
    shape: WideShape,
    lines: &Lines,
    ray: Ray<R::Num>,
) -> Hit<R::Num> {
    let setup = wide_setup(reading, shape, ray);
    let (ray, start_level) = (setup.ray, setup.start_level);
    let mut walk = setup.walk;
    let mut t = reading.zero();
    let mut heights = [0; super::wide_shape::MOST_CELLS];
    let heights = &mut heights[..shape.cells()];
    loop {
        let address = wide_address(reading, shape, ray.mirror_u, ray.mirror_v, &walk);
        let line = &lines.memory()[address as usize * shape.cells()..][..shape.cells()];
        for (height, &word) in heights.iter_mut().zip(line) {
            *height = i64::from(word);
        }
        let result = wide_step(reading, shape, &ray, start_level, &walk, t, heights);
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
                status: if walk.hit { Status::Hit } else { Status::Guard },
            };
        }
    }
}
