//! What is done to a ray of integers once, before its first step: it is mirrored, and put into the
//! node that it starts in.
//!
//! Mirroring is that of [`super::traverse_setup`]: a ray that travels toward smaller coordinates
//! on an axis is mirrored there, so that no slope of the walk is negative, and a node index i becomes
//! -1 - i. The texel that a mirrored ray enters is always the floor of its entry, a ray on a border
//! being in the texel it travels into.
//!
//! # The error term
//!
//! Which border of a node a ray leaves by is the order of two quotients, (border - entry) / slope
//! on either axis. Their cross products differ by
//!
//! `error = (corner_u - entry_u) * slope_v - (corner_v - entry_v) * slope_u`,
//!
//! taken at the node's far corner: not above zero, u is left first. At the near corner, it is a
//! register of the walk. To another node it changes by a slope times a power of two for each axis,
//! so that the two products of the setup are the only ones: no step multiplies slopes, or divides.

use super::fixed_shape::FixedShape;
use super::search_policy::{SearchPolicy, Start};
use super::traverse_step::{INDEX_BITS, LEVEL_BITS};
use crate::arith::Arith;

/// The registers a ray carries unchanged from step to step.
#[derive(Debug)]
pub struct FixedRayRegisters<A: Arith> {
    /// Entry coordinate, mirrored: texels times `2^entry_fraction_bits`, of
    /// [`FixedShape::entry_bits`] bits.
    pub u: A::Int,
    /// Entry coordinate on the other axis.
    pub v: A::Int,
    /// Magnitude of the slope on u: texels per height step times `2^fraction_bits`.
    pub slope_u: A::Int,
    /// Magnitude of the slope on v.
    pub slope_v: A::Int,
    /// Was u mirrored?
    pub mirror_u: A::Bit,
    /// Was v mirrored?
    pub mirror_v: A::Bit,
}

impl<A: Arith> Clone for FixedRayRegisters<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for FixedRayRegisters<A> {}

/// A ray as its registers hold it, and the node it starts in.
#[derive(Debug)]
pub struct FixedSetUpRay<A: Arith> {
    /// What stays.
    pub ray: FixedRayRegisters<A>,
    /// Level of the first node.
    pub level: A::Int,
    /// Its index on u, mirrored where the ray is.
    pub i: A::Int,
    /// Its index on v.
    pub j: A::Int,
    /// The error term at its near corner.
    pub error: A::Int,
}

/// A ray mirrored: its registers, without regard to where its walk starts.
pub fn fixed_mirror<A: Arith>(
    a: &mut A,
    shape: FixedShape,
    u: A::Int,
    v: A::Int,
    du: A::Int,
    dv: A::Int,
) -> FixedRayRegisters<A> {
    let (mirror_u, u, slope_u) = mirror_axis(a, shape, &MIRROR_U, u, du);
    let (mirror_v, v, slope_v) = mirror_axis(a, shape, &MIRROR_V, v, dv);
    FixedRayRegisters {
        u,
        v,
        slope_u,
        slope_v,
        mirror_u,
        mirror_v,
    }
}

/// Sets up a quantised ray: `u` and `v` from zero to below the size of the map, `du` and `dv` its
/// slopes with their signs, all as [`crate::ray_format::RayFormat::quantise`] makes them.
pub fn fixed_setup<A: Arith>(
    a: &mut A,
    shape: FixedShape,
    start: Start,
    u: A::Int,
    v: A::Int,
    du: A::Int,
    dv: A::Int,
) -> FixedSetUpRay<A> {
    let ray = fixed_mirror(a, shape, u, v, du, dv);
    let entry_i = texel_below(a, shape, ray.u);
    a.name_int("entry_i", entry_i);
    let entry_j = texel_below(a, shape, ray.v);
    a.name_int("entry_j", entry_j);
    let level = match start {
        Start::Root => a.int_constant(i64::from(shape.root_level)),
        Start::Texel => a.int_constant(0),
        Start::WholeRay => level_of_whole_ray(a, shape, &ray, entry_i, entry_j),
    };
    let shift = a.int_low_bits(level, 4);
    let i = a.int_shift_right(entry_i, shift, 4);
    a.name_int("start_i", i);
    let j = a.int_shift_right(entry_j, shift, 4);
    a.name_int("start_j", j);
    let behind_u = near_corner(a, shape, ray.u, i, shift);
    a.name_int("behind_u", behind_u);
    let behind_v = near_corner(a, shape, ray.v, j, shift);
    a.name_int("behind_v", behind_v);
    let product_u = a.int_mul(behind_u, ray.slope_v);
    a.name_int("start_product_u", product_u);
    let product_v = a.int_mul(behind_v, ray.slope_u);
    a.name_int("start_product_v", product_v);
    let error = a.int_sub(product_u, product_v);
    let error = a.int_wrap(error, shape.error_bits());
    a.name_int("start_error", error);
    FixedSetUpRay {
        ray,
        level,
        i,
        j,
        error,
    }
}

/// The level at which a walk by this policy starts at the latest.
pub const fn start_level(policy: SearchPolicy, shape: FixedShape) -> u32 {
    match policy.start {
        Start::Texel => 0,
        Start::Root | Start::WholeRay => shape.root_level,
    }
}

struct MirrorNames {
    mirror: &'static str,
    coordinate: &'static str,
    slope: &'static str,
}

const MIRROR_U: MirrorNames = MirrorNames {
    mirror: "mirror_u",
    coordinate: "mirrored_u",
    slope: "slope_u",
};
const MIRROR_V: MirrorNames = MirrorNames {
    mirror: "mirror_v",
    coordinate: "mirrored_v",
    slope: "slope_v",
};

fn mirror_axis<A: Arith>(
    a: &mut A,
    shape: FixedShape,
    names: &MirrorNames,
    coordinate: A::Int,
    slope: A::Int,
) -> (A::Bit, A::Int, A::Int) {
    let zero = a.int_constant(0);
    let mirror = a.int_less_than(slope, zero);
    a.name_bit(names.mirror, mirror);
    let opposite = a.int_sub(zero, coordinate);
    let mirrored = a.int_select(mirror, opposite, coordinate);
    // Coordinates lie in the first repeat: above -1 map, mirrored or not.
    let mirrored = a.int_wrap(mirrored, shape.entry_bits());
    a.name_int(names.coordinate, mirrored);
    let opposite = a.int_sub(zero, slope);
    let magnitude = a.int_select(mirror, opposite, slope);
    // The quantiser saturates either way at the same magnitude.
    let magnitude = a.int_wrap(magnitude, shape.slope_bits + 1);
    a.name_int(names.slope, magnitude);
    (mirror, mirrored, magnitude)
}

/// The texel that an entry is in.
fn texel_below<A: Arith>(a: &mut A, shape: FixedShape, entry: A::Int) -> A::Int {
    let texel = shift_right_by(a, entry, shape.entry_fraction_bits);
    // The entry is within a map of zero.
    a.int_wrap(texel, shape.root_level + 1)
}

/// From the entry back to the near border of its node, on one axis: zero or below.
fn near_corner<A: Arith>(
    a: &mut A,
    shape: FixedShape,
    entry: A::Int,
    index: A::Int,
    level: A::Int,
) -> A::Int {
    let near = a.int_shift_left(index, level, 4);
    let near = a.int_wrap(near, shape.root_level + 1);
    let near = shift_left_by(a, near, shape.root_level + 1, shape.entry_fraction_bits);
    let behind = a.int_sub(near, entry);
    // The entry lies in the node, which is at most the map.
    a.int_wrap(behind, shape.entry_bits())
}

/// The level of the lowest node that holds the whole ray: the bit length of the larger exclusive or
/// of entry and exit texel; the root where the ray leaves the tile.
fn level_of_whole_ray<A: Arith>(
    a: &mut A,
    shape: FixedShape,
    ray: &FixedRayRegisters<A>,
    entry_i: A::Int,
    entry_j: A::Int,
) -> A::Int {
    let exit_i = exit_texel(a, shape, ray.u, ray.slope_u);
    a.name_int("exit_i", exit_i);
    let exit_j = exit_texel(a, shape, ray.v, ray.slope_v);
    a.name_int("exit_j", exit_j);
    let differing_i = a.int_xor(entry_i, exit_i);
    let differing_j = a.int_xor(entry_j, exit_j);
    let differing = a.int_or(differing_i, differing_j);
    // Read without its sign: a ray from a negative texel to a positive one leaves the tile.
    let differing = a.int_low_bits(differing, INDEX_BITS);
    a.name_int("differing_bits", differing);
    let level = a.int_bit_length(differing);
    a.name_int("level_of_whole_ray", level);
    let root_level = a.int_constant(i64::from(shape.root_level));
    let leaves = a.int_less_than(root_level, level);
    a.name_bit("leaves_tile", leaves);
    let level = a.int_select(leaves, root_level, level);
    let level = a.int_wrap(level, LEVEL_BITS);
    a.name_int("start_level", level);
    level
}

/// The texel in which a ray gets to the bottom, on one axis.
fn exit_texel<A: Arith>(a: &mut A, shape: FixedShape, entry: A::Int, slope: A::Int) -> A::Int {
    // Times the full height, which is all ones.
    let slope_times = shift_left_by(a, slope, shape.slope_bits + 1, shape.height_bits);
    let travelled = a.int_sub(slope_times, slope);
    let entry = shift_left_by(a, entry, shape.entry_bits(), shape.height_bits);
    let exit = a.int_add(entry, travelled);
    // A ray within reach stays within the index's bits.
    let exit = a.int_wrap(exit, shape.position_bits());
    let texel = shift_right_by(a, exit, shape.fraction_bits());
    a.int_wrap(texel, INDEX_BITS)
}

/// `a * 2^amount`, of an integer of `bits` bits; `amount` is known. Wires, in hardware.
///
/// A recorded shift is made as wide as the largest amount that its bits can say: where that is more
/// than 64 bits it goes by pieces that are the largest amounts of their bits.
pub(crate) fn shift_left_by<A: Arith>(a: &mut A, value: A::Int, bits: u32, amount: u32) -> A::Int {
    let (mut shifted, mut left, mut width) = (value, amount, bits);
    while left > 0 {
        let wanted = left.min(15);
        let wanted_bits = 32 - wanted.leading_zeros();
        let (piece, piece_bits) = if width + (1 << wanted_bits) - 1 <= 64 {
            (wanted, wanted_bits)
        } else {
            let whole_bits = (wanted + 1).ilog2();
            ((1 << whole_bits) - 1, whole_bits)
        };
        let by = a.int_constant(i64::from(piece));
        shifted = a.int_shift_left(shifted, by, piece_bits);
        left -= piece;
        width += piece;
        // Nothing is cut but room for larger amounts.
        shifted = a.int_wrap(shifted, width);
    }
    shifted
}

/// `a / 2^amount`, rounded down; `amount` is known. Wires, in hardware.
pub(crate) fn shift_right_by<A: Arith>(a: &mut A, value: A::Int, amount: u32) -> A::Int {
    if amount == 0 {
        return value;
    }
    let by = a.int_constant(i64::from(amount));
    a.int_shift_right(value, by, 32 - amount.leading_zeros())
}
