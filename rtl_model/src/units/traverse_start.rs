//! Where a walk starts: at the root, at the lowest node that holds the whole ray, or at a texel.
//!
//! # Why no surface is stepped past
//!
//! A walk may start at any node that holds the ray's entry: what lies before it, the ray does not
//! meet, and where the ray leaves it the walk crosses into the neighbour as it does anywhere. The
//! entry's texel is the floor of the mirrored coordinate in texels, and exact: a power of two
//! scales it, and within [-size, size] the floor has no more bits than the coordinate had. On a
//! border it is the texel above, into which a mirrored ray travels. So only the number of steps
//! depends on where the ray is thought to end, and a rounded end will do.

use super::search_policy::{SearchPolicy, Start};
use super::traverse_setup::RayRegisters;
use super::traverse_shape::{INDEX_BITS, SHIFT_BITS, TraverseShape};
use crate::arith::Arith;
use crate::float::Rounding::NearestEven;

/// The node a walk starts at.
pub(super) struct StartNode<A: Arith> {
    pub(super) level: A::Int,
    pub(super) i: A::Int,
    pub(super) j: A::Int,
}

struct AxisNames {
    entry_in_texels: &'static str,
    entry_texel: &'static str,
    exit_coordinate: &'static str,
    exit_in_texels: &'static str,
    exit_texel: &'static str,
    differing_bits: &'static str,
    start_index: &'static str,
}

const AXIS_U: AxisNames = AxisNames {
    entry_in_texels: "entry_in_texels_u",
    entry_texel: "entry_texel_i",
    exit_coordinate: "exit_coordinate_u",
    exit_in_texels: "exit_in_texels_u",
    exit_texel: "exit_texel_i",
    differing_bits: "differing_bits_i",
    start_index: "start_i",
};
const AXIS_V: AxisNames = AxisNames {
    entry_in_texels: "entry_in_texels_v",
    entry_texel: "entry_texel_j",
    exit_coordinate: "exit_coordinate_v",
    exit_in_texels: "exit_in_texels_v",
    exit_texel: "exit_texel_j",
    differing_bits: "differing_bits_j",
    start_index: "start_j",
};

/// The node that a walk of a mirrored ray starts at; `root` is that on either axis for a start at
/// the root.
pub(super) fn start_node<A: Arith>(
    a: &mut A,
    shape: TraverseShape,
    policy: SearchPolicy,
    ray: &RayRegisters<A>,
    root: (A::Int, A::Int),
) -> StartNode<A> {
    let root_level = a.int_constant(i64::from(shape.root_level));
    // The root of a map of one texel is that texel.
    if policy.start == Start::Root || shape.root_level == 0 {
        return StartNode {
            level: root_level,
            i: root.0,
            j: root.1,
        };
    }
    let i = entry_texel(a, shape, &AXIS_U, ray.u);
    let j = entry_texel(a, shape, &AXIS_V, ray.v);
    if policy.start == Start::Texel {
        return StartNode {
            level: a.int_constant(0),
            i,
            j,
        };
    }
    let exit_u = a.add(NearestEven, ray.u, ray.du);
    a.name_num(AXIS_U.exit_coordinate, exit_u);
    let different_i = differing_bits(a, shape, &AXIS_U, exit_u, i);
    let exit_v = a.add(NearestEven, ray.v, ray.dv);
    a.name_num(AXIS_V.exit_coordinate, exit_v);
    let different_j = differing_bits(a, shape, &AXIS_V, exit_v, j);
    lowest_common_node(a, shape, root_level, (i, j), (different_i, different_j))
}

/// The lowest node that holds the whole ray, whose end has been computed elsewhere.
pub(super) fn node_of_whole_ray<A: Arith>(
    a: &mut A,
    shape: TraverseShape,
    ray: &RayRegisters<A>,
    (end_u, end_v): (A::Num, A::Num),
) -> StartNode<A> {
    let i = entry_texel(a, shape, &AXIS_U, ray.u);
    let j = entry_texel(a, shape, &AXIS_V, ray.v);
    if shape.root_level == 0 {
        let level = a.int_constant(0);
        return StartNode { level, i, j };
    }
    let different_i = differing_bits(a, shape, &AXIS_U, end_u, i);
    let different_j = differing_bits(a, shape, &AXIS_V, end_v, j);
    let root_level = a.int_constant(i64::from(shape.root_level));
    lowest_common_node(a, shape, root_level, (i, j), (different_i, different_j))
}

/// The lowest node that holds both texels of a ray, from the one it enters and the bits in which
/// the other differs; the root where they lie in different repeats of the map.
fn lowest_common_node<A: Arith>(
    a: &mut A,
    shape: TraverseShape,
    root_level: A::Int,
    (i, j): (A::Int, A::Int),
    (different_i, different_j): (A::Int, A::Int),
) -> StartNode<A> {
    // The bit length of the larger one is that of both together, and either's sign is seen in it.
    let different = a.int_or(different_i, different_j);
    a.name_int("differing_bits", different);
    // Any of its upper bits, the sign among them, says that the ray leaves the tile.
    let size_exponent = a.int_constant(i64::from(shape.root_level));
    let beyond_tile = a.int_shift_right(different, size_exponent, SHIFT_BITS);
    a.name_int("differing_tile_bits", beyond_tile);
    let zero = a.int_constant(0);
    let stays_in_tile = a.int_equal(beyond_tile, zero);
    a.name_bit("stays_in_tile", stays_in_tile);
    let texel_bits = a.int_low_bits(different, shape.root_level);
    let level_in_tile = a.int_bit_length(texel_bits);
    a.name_int("level_in_tile", level_in_tile);
    let level = a.int_select(stays_in_tile, level_in_tile, root_level);
    let level = a.int_low_bits(level, SHIFT_BITS);
    a.name_int("start_level", level);
    let mut start_index = |names: &AxisNames, texel| {
        let index = a.int_shift_right(texel, level, SHIFT_BITS);
        a.name_int(names.start_index, index);
        index
    };
    StartNode {
        level,
        i: start_index(&AXIS_U, i),
        j: start_index(&AXIS_V, j),
    }
}

fn entry_texel<A: Arith>(
    a: &mut A,
    shape: TraverseShape,
    names: &AxisNames,
    coordinate: A::Num,
) -> A::Int {
    let in_texels = a.scale(coordinate, shape.root_level as i32);
    a.name_num(names.entry_in_texels, in_texels);
    let texel = a.floor(in_texels, INDEX_BITS);
    a.name_int(names.entry_texel, texel);
    texel
}

/// The bits in which the texels of entry and exit differ on an axis.
fn differing_bits<A: Arith>(
    a: &mut A,
    shape: TraverseShape,
    names: &AxisNames,
    exit: A::Num,
    entry_texel: A::Int,
) -> A::Int {
    let exit = a.scale(exit, shape.root_level as i32);
    a.name_num(names.exit_in_texels, exit);
    let exit_texel = a.floor(exit, INDEX_BITS);
    a.name_int(names.exit_texel, exit_texel);
    let different = a.int_xor(entry_texel, exit_texel);
    a.name_int(names.differing_bits, different);
    different
}
