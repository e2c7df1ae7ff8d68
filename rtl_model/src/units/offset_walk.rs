//! A whole walk by offsets in software.

use super::offset_step::{OffsetShape, OffsetWalk, offset_address, offset_setup, offset_step};
use super::search_policy::SearchPolicy;
use super::traverse::{Hit, Status};
use crate::arith::Concrete;
use crate::maps::Pyramid;
use crate::ray::Ray;

/// The unit's shape for a map.
pub fn offset_shape_for(pyramid: &Pyramid, policy: SearchPolicy, texels: f64) -> OffsetShape {
    OffsetShape {
        root_level: pyramid.levels(),
        height_bits: pyramid.bits(),
        policy,
        texels,
    }
}

/// Walks a ray to its hit, or to the step bound. The ray's numbers are the reading's, u and v in
/// [0, 1).
///
/// A step that leaves a walk as it was leaves it so for ever: such a walk is not followed to the
/// bound, but answered as if it had been.
pub fn walk_by_offset<R: Concrete>(
    reading: &mut R,
    shape: OffsetShape,
    memory: &[u16],
    ray: Ray<R::Num>,
) -> Hit<R::Num> {
    let Ray { u, v, du, dv } = ray;
    let (ray, mut walk) = offset_setup(reading, shape, [u, v, du, dv]);
    loop {
        let address = offset_address(reading, shape, &walk);
        let height = i64::from(memory[address as usize]);
        let result = offset_step(reading, shape, &ray, &walk, height);
        let before = std::mem::replace(&mut walk, result.walk);
        let ended = walk.hit || walk.guard;
        if !ended && !is_stuck(reading, &before, &walk) {
            continue;
        }
        // Each step that is left crosses once more.
        let steps_left = match ended {
            true => 0,
            false => i64::from(shape.step_bound()) - walk.steps,
        };
        return Hit {
            i: result.texel_i as u32,
            j: result.texel_j as u32,
            t: walk.t,
            u: result.position_u,
            v: result.position_v,
            steps: (walk.steps + steps_left) as u32,
            crossings: (walk.crossings + steps_left) as u32,
            status: if walk.hit { Status::Hit } else { Status::Guard },
        };
    }
}

/// Has a step left all that decides the next one as it was? The crossings decide whether there was
/// one before, so not the first one.
fn is_stuck<R: Concrete>(reading: &mut R, before: &OffsetWalk<R>, after: &OffsetWalk<R>) -> bool {
    before.crossings > 0
        && (before.level, before.i, before.j, before.crossed)
            == (after.level, after.i, after.j, after.crossed)
        && reading.less_equal(before.t, after.t)
        && reading.less_equal(after.t, before.t)
}
