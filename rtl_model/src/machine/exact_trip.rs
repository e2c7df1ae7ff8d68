//! A trip of a walk round the loop of the exact machine: a step, or, where the line is not in the
//! cache, nothing.

use crate::arith::Arith;
use crate::units::bounded_leaf::SeenCorner;
use crate::units::bounded_setup::BoundedRay;
use crate::units::bounded_shape::BoundedShape;
use crate::units::bounded_step::{BoundedWalk, bounded_address, bounded_step};

/// What comes of a trip.
#[derive(Debug)]
pub struct ExactTrip<A: Arith> {
    /// The address of the line that the step reads.
    pub address: A::Int,
    /// The walk after it.
    pub walk: BoundedWalk<A>,
    /// The bounds of the near borders of the block.
    pub t_near: (A::Int, A::Int),
    /// Of a texel that the walk has come to: what bounds say of its near corner.
    pub corner: SeenCorner<A>,
    /// They are to be written.
    pub writes: A::Bit,
    /// The walk leaves the loop for the leaf check.
    pub ends: A::Bit,
}

/// A trip of a walk that has not ended.
///
/// `counts` says that steps and crossings are counted, and the walk guarded by its bound of steps.
///
/// `base` are the bounds that its block is found from; `fresh` says that it is a ray's first trip,
/// `missed` that the heights are of no use. A walk that misses is, to the step, one that has
/// ended: it stays as it is, and comes round again.
pub fn exact_trip<A: Arith>(
    a: &mut A,
    (shape, counts): (BoundedShape, bool),
    ray: &BoundedRay<A>,
    walk: &BoundedWalk<A>,
    base: (A::Int, A::Int),
    (fresh, missed): (A::Bit, A::Bit),
    heights: &[A::Int],
) -> ExactTrip<A> {
    let mirrors = (ray.fixed.mirror_u, ray.fixed.mirror_v);
    let address = bounded_address(a, shape, mirrors, walk);
    let zero = a.int_constant(0);
    let no = a.bit_constant(false);
    let entering = BoundedWalk {
        steps: if counts { walk.steps } else { zero },
        crossings: if counts { walk.crossings } else { zero },
        hit: no,
        guard: missed,
        depth: zero,
        ..*walk
    };
    let result = bounded_step(a, shape, ray, &entering, base, heights);
    let answered = a.not(missed);
    // The bounds of a first block stay what they are: they may be written twice.
    let writes = a.or(answered, fresh);
    let guard = match counts {
        true => a.and(result.walk.guard, answered),
        false => no,
    };
    let ends = a.or(result.walk.hit, guard);
    ExactTrip {
        address,
        walk: BoundedWalk {
            steps: if counts { result.walk.steps } else { zero },
            crossings: if counts { result.walk.crossings } else { zero },
            guard,
            resumes: a.and(walk.resumes, missed),
            ..result.walk
        },
        t_near: result.t_near,
        corner: result.corner,
        writes,
        ends,
    }
}
