//! What the registers of an exact fixed-point walk say of the hit, should it have ended.

use super::fixed_setup::{FixedRayRegisters, shift_left_by};
use super::fixed_shape::FixedShape;
use super::fixed_step::FixedWalkRegisters;
use crate::arith::Arith;

/// The hit of a walk that has ended. Its depth is a ratio of integers, in height steps: whoever
/// needs it as a number divides, once a ray.
#[derive(Debug)]
pub struct FixedAnswer<A: Arith> {
    /// Texel on u, wrapped to the map.
    pub texel_i: A::Int,
    /// Texel on v.
    pub texel_j: A::Int,
    /// Is it a hit on the texel's side? Else on its top.
    pub side: A::Bit,
    /// The depth in height steps, times the denominator.
    pub depth_numerator: A::Int,
    /// 1 on a top; on a side, the slope on the axis crossed.
    pub depth_denominator: A::Int,
}

impl<A: Arith> Clone for FixedAnswer<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for FixedAnswer<A> {}

/// The answer that a walk at level 0 stands for.
pub(super) fn fixed_answer<A: Arith>(
    a: &mut A,
    shape: FixedShape,
    ray: &FixedRayRegisters<A>,
    walk: &FixedWalkRegisters<A>,
) -> FixedAnswer<A> {
    let texel_i = texel(a, shape, ray.mirror_u, walk.i);
    a.name_int("texel_i", texel_i);
    let texel_j = texel(a, shape, ray.mirror_v, walk.j);
    a.name_int("texel_j", texel_j);
    // The texel was entered by a crossing, or the ray began in it.
    let none = a.int_constant(0);
    let at_border = a.or(walk.at_border_u, walk.at_border_v);
    a.name_bit("ends_at_border", at_border);
    let at_top_plane = a.int_equal(walk.depth, none);
    let side = a.or(at_border, at_top_plane);
    a.name_bit("side", side);
    // At level 0 the border crossed is the texel's near one, of the texel's own index.
    let index = a.int_select(walk.at_border_v, walk.j, walk.i);
    let border = shift_left_by(
        a,
        index,
        super::traverse_step::INDEX_BITS,
        shape.entry_fraction_bits,
    );
    let entry = a.int_select(walk.at_border_v, ray.v, ray.u);
    let travelled = a.int_sub(border, entry);
    // No further than the position bits say.
    let travelled_bits = super::traverse_step::INDEX_BITS + shape.entry_fraction_bits;
    let travelled = a.int_wrap(travelled, travelled_bits);
    let travelled = shift_left_by(a, travelled, travelled_bits, shape.height_bits);
    let depth_numerator = a.int_select(at_border, travelled, walk.depth);
    a.name_int("depth_numerator", depth_numerator);
    let slope = a.int_select(walk.at_border_v, ray.slope_v, ray.slope_u);
    let one = a.int_constant(1);
    let depth_denominator = a.int_select(at_border, slope, one);
    a.name_int("depth_denominator", depth_denominator);
    FixedAnswer {
        texel_i,
        texel_j,
        side,
        depth_numerator,
        depth_denominator,
    }
}

fn texel<A: Arith>(a: &mut A, shape: FixedShape, mirror: A::Bit, index: A::Int) -> A::Int {
    let index = a.int_complement_if(mirror, index);
    let size_mask = a.int_constant(i64::from(shape.size()) - 1);
    a.int_and(index, size_mask)
}
