//! A trip of a walk round the loop of the exact machine: a step, or, where the line is not in the
//! cache, nothing.

use crate::arith::Arith;
use crate::units::bounded_leaf::SeenCorner;
use crate::units::bounded_setup::{BoundedRay, by_line};
use crate::units::bounded_shape::BoundedShape;
use crate::units::bounded_step::{BoundedWalk, bounded_step};
use crate::units::fixed_setup::{shift_left_by, shift_right_by};

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
    let address = curve_address(a, shape, mirrors, walk);
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

/// Where the walk's line lies in the machine's memory: as in [`crate::maps::Lines`], but that the
/// lines of a level lie along a Z curve (Morton order).
///
/// The bits of row and column take turns, the column's the lowest, so that the lines of a cache
/// line, and the cache lines of a run of indices, are squares of the map. A line's place is that
/// of any of its texels without the low bits: the order costs wires only.
pub fn curve_address<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    mirrors: (A::Bit, A::Bit),
    walk: &BoundedWalk<A>,
) -> A::Int {
    let levels = shape.words.root_level;
    let i = a.int_complement_if(mirrors.0, walk.i);
    let j = a.int_complement_if(mirrors.1, walk.j);
    let [column, row] = [i, j].map(|texel| {
        let texel = a.int_low_bits(texel, levels);
        every_other_bit(a, texel, levels)
    });
    let row = shift_left_by(a, row, 2 * levels + 1, 1);
    let place = a.int_or(row, column);
    a.name_int("texel_place", place);
    let address = by_line(a, shape, walk.line, |a, n| {
        let index_bits = 2 * levels.saturating_sub(shape.block_level(n));
        let marker = a.int_constant(1 << index_bits);
        if index_bits == 0 {
            return marker;
        }
        let block = shift_right_by(a, place, 2 * shape.block_level(n));
        let block = a.int_low_bits(block, index_bits);
        a.int_or(block, marker)
    });
    let address = a.int_low_bits(address, shape.address_bits());
    a.name_int("line_address", address);
    address
}

/// The bits of a number of up to 16, each in twice its place.
fn every_other_bit<A: Arith>(a: &mut A, number: A::Int, bits: u32) -> A::Int {
    let mut spread = number;
    for (distance, mask) in [
        (8, 0x00ff_00ff),
        (4, 0x0f0f_0f0f),
        (2, 0x3333_3333),
        (1, 0x5555_5555),
    ] {
        if distance >= bits {
            continue;
        }
        let moved = shift_left_by(a, spread, 2 * bits + 1, distance);
        let both = a.int_or(spread, moved);
        let mask = a.int_constant(mask);
        spread = a.int_and(both, mask);
    }
    spread
}

/// The address on the curve of the line at an address of [`crate::maps::Lines`]; none where that
/// names no line.
pub(super) fn address_on_curve(address: u32) -> Option<u32> {
    let marker = address.checked_ilog2().filter(|bit| bit % 2 == 0)?;
    let index_bits = marker / 2;
    let bit = |place: u32| address >> place & 1;
    Some((0..index_bits).fold(1 << marker, |curve, place| {
        let (column, row) = (bit(place), bit(index_bits + place));
        curve | column << (2 * place) | row << (2 * place + 1)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_columns_take_turns() {
        assert_eq!(address_on_curve(0), None);
        assert_eq!(address_on_curve(1), Some(1));
        // Row 1, column 0 of 2 x 2 lines, then row 2 (10), column 1 (01) of 4 x 4.
        assert_eq!(address_on_curve(0b1_1_0), Some(0b1_10));
        assert_eq!(address_on_curve(0b1_10_01), Some(0b1_1001));
        assert_eq!(address_on_curve(0b10), None);
        let mut seen: Vec<u32> = (0..1 << 9).filter_map(address_on_curve).collect();
        let count = seen.len();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!((seen.len(), count), (1 + 4 + 16 + 64 + 256, 341));
    }
}
