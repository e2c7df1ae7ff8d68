//! A whole wide walk in exact fixed point, in software.

use super::fixed_traverse::FixedHit;
use super::traverse::Status;
use super::wide_fixed_step::{WideFixedShape, wide_fixed_setup, wide_fixed_step};
use super::wide_shape::MOST_CELLS;
use super::wide_walk::wide_address;
use crate::arith::Concrete;
use crate::maps::Lines;
use crate::ray_format::QuantisedRay;
use crate::readings::F64Reading;

/// Walks a quantised ray to its hit through the lines of a map; a step is a line read.
pub fn wide_fixed_walk(shape: WideFixedShape, lines: &Lines, ray: &QuantisedRay) -> FixedHit {
    // Of the reading only its integers are used, which mean the same in every one.
    wide_fixed_walk_in(&mut F64Reading, shape, lines, ray)
}

/// The same in a reading of the caller's.
pub fn wide_fixed_walk_in<A: Concrete>(
    a: &mut A,
    shape: WideFixedShape,
    lines: &Lines,
    ray: &QuantisedRay,
) -> FixedHit {
    let setup = wide_fixed_setup(a, shape, ray.u, ray.v, ray.du, ray.dv);
    let ray = setup.ray;
    let mut walk = setup.walk;
    let cells = shape.lines().cells();
    let mut heights = [0; MOST_CELLS];
    let heights = &mut heights[..cells];
    loop {
        let address = wide_address(a, shape.lines(), ray.mirror_u, ray.mirror_v, &walk.walk);
        let line = &lines.memory()[address as usize * cells..][..cells];
        for (height, &word) in heights.iter_mut().zip(line) {
            *height = i64::from(word);
        }
        let (next, answer) = wide_fixed_step(a, shape, &ray, setup.start_level, &walk, heights);
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
                status: if walk.walk.hit {
                    Status::Hit
                } else {
                    Status::Guard
                },
            };
        }
    }
}
