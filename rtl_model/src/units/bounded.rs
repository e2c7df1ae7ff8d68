//! A whole walk by bounds in software.

use super::bounded_leaf::leaf_check;
use super::bounded_setup::bounded_setup;
use super::bounded_shape::{BoundedShape, MOST_BOUNDED_LINES};
use super::bounded_step::{
    base_line, bounded_address, bounded_step, bounded_walk_after_leaf, bounded_walk_start,
};
use super::fixed_answer::fixed_answer;
use super::fixed_step::FixedWalkRegisters;
use super::fixed_traverse::FixedHit;
use super::traverse::Status;
use super::wide_shape::MOST_CELLS;
use crate::arith::Concrete;
use crate::maps::Lines;
use crate::ray_format::QuantisedRay;
use crate::readings::F64Reading;

/// Walks a quantised ray to its hit through the lines of a map; a step is a line read.
pub fn bounded_walk(shape: BoundedShape, lines: &Lines, ray: &QuantisedRay) -> FixedHit {
    bounded_walk_in(&mut F64Reading, shape, lines, ray).0
}

/// The same in a reading of the caller's; beside the hit, how many texels the leaf check refused.
pub fn bounded_walk_in<A: Concrete>(
    a: &mut A,
    shape: BoundedShape,
    lines: &Lines,
    ray: &QuantisedRay,
) -> (FixedHit, u32) {
    let setup = bounded_setup(a, shape, [ray.u, ray.v, ray.du, ray.dv]);
    let ray = setup.ray;
    let mut walk = bounded_walk_start(a, ray.start_line, setup.i, setup.j);
    let mut t_near = [(0, 0); MOST_BOUNDED_LINES];
    t_near[ray.start_line as usize] = (setup.t_near_u, setup.t_near_v);
    let cells = shape.lines().cells();
    let mut heights = [0; MOST_CELLS];
    let heights = &mut heights[..cells];
    let mut refusals = 0;
    loop {
        let mirrors = (ray.fixed.mirror_u, ray.fixed.mirror_v);
        let address = bounded_address(a, shape, mirrors, &walk);
        let line = &lines.memory()[address as usize * cells..][..cells];
        for (height, &word) in heights.iter_mut().zip(line) {
            *height = i64::from(word);
        }
        let base = t_near[base_line(a, &walk) as usize];
        let read = walk.line as usize;
        let result = bounded_step(a, shape, &ray, &walk, base, heights);
        t_near[read] = result.t_near;
        walk = result.walk;
        if !walk.hit && !walk.guard {
            continue;
        }
        let verdict = leaf_check(
            a,
            shape,
            &ray.fixed,
            (walk.i, walk.j),
            walk.depth,
            result.corner,
        );
        if walk.hit && verdict.refused {
            refusals += 1;
            walk = bounded_walk_after_leaf(a, &walk, true);
            continue;
        }
        let registers = FixedWalkRegisters {
            level: 0,
            i: walk.i,
            j: walk.j,
            error: 0,
            depth: walk.depth,
            at_border_u: verdict.at_border_u,
            at_border_v: verdict.at_border_v,
            at_midline: None,
            crossed_before: None,
            steps: walk.steps,
            crossings: walk.crossings,
            hit: walk.hit,
            guard: walk.guard,
        };
        let answer = fixed_answer(a, shape.words, &ray.fixed, &registers);
        let hit = FixedHit {
            i: answer.texel_i as u32,
            j: answer.texel_j as u32,
            side: answer.side,
            depth_numerator: answer.depth_numerator,
            depth_denominator: answer.depth_denominator,
            steps: walk.steps as u32,
            crossings: walk.crossings as u32,
            status: if walk.hit { Status::Hit } else { Status::Guard },
        };
        return (hit, refusals);
    }
}
