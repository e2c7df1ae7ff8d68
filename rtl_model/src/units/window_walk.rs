//! What a window walk does once it knows which cells of its window are candidates: integers and bits
//! alone, the same in every number format.
//!
//! A *window* is 4 x 4 nodes of a level from the ray's own node on, in the direction it travels, wherever that node
//! lies: a memory of sixteen banks, a node of every place modulo 4 in each, answers it in one read.
//! The walk goes down to the first candidate, two levels at once, into a window that begins where the
//! ray may meet it. A window without candidates sends it to the node in which the ray leaves it, at
//! the same level; it never goes up. It keeps nothing but the level and the node, since whatever lies before
//! that on the path has been ruled out.

use super::traverse_step::{INDEX_BITS, LEVEL_BITS};
use super::wide_shape::{MOST_CELLS, MOST_SIDE, WIDE_COUNTER_BITS, WideShape};
use super::wide_walk::{First, first_of, mask};
use crate::arith::Arith;
use crate::ray::REACH_TEXELS;

/// What a window traverse unit is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct WindowShape {
    /// Level of the pyramid's root: log2 of the map's size, 0 to 12.
    pub root_level: u32,
    /// Bits of a height: 8 or 16.
    pub height_bits: u32,
}

impl WindowShape {
    /// Cells and their path order: those of a line of 4 x 4.
    pub const fn cells(self) -> WideShape {
        WideShape {
            root_level: self.root_level,
            height_bits: self.height_bits,
            log2_side: 2,
        }
    }

    /// Texels on a side of the map.
    pub const fn size(self) -> u32 {
        1 << self.root_level
    }

    /// log2 of the reach from which on a walk starts at `level` or above (`docs/traversals.md`).
    pub const fn start_reach_log2(self, level: u32) -> u32 {
        (3 * level).div_ceil(2) + 1
    }

    /// More steps than any ray within reach can take; a walk that gets there answers `guard`.
    ///
    /// A step goes down, or leaves a window: across the fourth border on one axis, or, at a corner in
    /// doubt, across the third on both.
    pub const fn step_bound(self) -> u32 {
        self.root_level + 1 + 2 * (REACH_TEXELS as u32 / 3 + 2)
    }

    /// Bits of a window's address.
    pub const fn address_bits(self) -> u32 {
        2 * self.root_level + 1
    }
}

/// The registers of a window walk that change from step to step, but for what the hit's depth is.
#[derive(Debug)]
pub struct WindowWalk<A: Arith> {
    /// Level of the window's nodes; 0 is the map itself.
    pub level: A::Int,
    /// Index on u of its first node, mirrored where the ray is, not wrapped to the map. After a hit, the
    /// texel.
    pub i: A::Int,
    /// Index on v.
    pub j: A::Int,
    /// Steps taken: windows read.
    pub steps: A::Int,
    /// Windows left among them.
    pub crossings: A::Int,
    /// The walk has ended in a hit: level 0, texel (i, j).
    pub hit: A::Bit,
    /// The walk has ended at the step bound.
    pub guard: A::Bit,
}

impl<A: Arith> Clone for WindowWalk<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for WindowWalk<A> {}

/// The first candidate of a window, and what becomes of the walk.
pub(super) struct Taken<A: Arith> {
    /// No step is taken any more.
    pub(super) ended: A::Bit,
    /// There is a candidate: the walk goes down, or hits.
    pub(super) found: A::Bit,
    /// It is a texel: the hit.
    pub(super) hits: A::Bit,
    /// Its place in path order, its column and its row.
    pub(super) cell: (A::Int, A::Int, A::Int),
    /// Its index.
    pub(super) i: A::Int,
    pub(super) j: A::Int,
    /// The level that a walk goes down to.
    pub(super) level_below: A::Int,
}

/// The level that a walk starts at: by how many levels' reach the ray has.
pub(super) fn window_start_level<A: Arith>(
    a: &mut A,
    shape: WindowShape,
    mut reaches: impl FnMut(&mut A, u32) -> A::Bit,
) -> A::Int {
    let mut level = a.int_constant(0);
    for higher in 1..=shape.root_level {
        if 1 << shape.start_reach_log2(higher) > REACH_TEXELS as u32 {
            break;
        }
        let reaches = reaches(a, shape.start_reach_log2(higher));
        let higher = a.int_constant(higher.into());
        level = a.int_select(reaches, higher, level);
    }
    let level = a.int_wrap(level, LEVEL_BITS);
    a.name_int("start_level", level);
    level
}

/// The walk before its first step: at the node that holds this texel.
pub(super) fn window_walk_start<A: Arith>(
    a: &mut A,
    level: A::Int,
    texel_i: A::Int,
    texel_j: A::Int,
) -> WindowWalk<A> {
    let shift = a.int_low_bits(level, 4);
    let i = a.int_shift_right(texel_i, shift, 4);
    a.name_int("start_i", i);
    let j = a.int_shift_right(texel_j, shift, 4);
    a.name_int("start_j", j);
    let none = a.int_constant(0);
    let no = a.bit_constant(false);
    WindowWalk {
        level,
        i,
        j,
        steps: none,
        crossings: none,
        hit: no,
        guard: no,
    }
}

/// Where the walk's window lies in memory: the address in the pyramid's memory of the node of the window
/// with the smallest indices on the map, which a mirrored ray meets last.
pub(super) fn window_address<A: Arith>(
    a: &mut A,
    shape: WindowShape,
    mirror_u: A::Bit,
    mirror_v: A::Bit,
    walk: &WindowWalk<A>,
) -> A::Int {
    let root_level = a.int_constant(i64::from(shape.root_level));
    let below_root = a.int_sub(root_level, walk.level);
    let below_root = a.int_low_bits(below_root, 4);
    a.name_int("below_root", below_root);
    let one = a.int_constant(1);
    let nodes_on_a_side = a.int_shift_left(one, below_root, 4);
    let nodes_on_a_side = a.int_wrap(nodes_on_a_side, INDEX_BITS);
    a.name_int("nodes_on_a_side", nodes_on_a_side);
    let index_mask = a.int_sub(nodes_on_a_side, one);
    a.name_int("index_mask", index_mask);
    let i = lowest_index(a, mirror_u, walk.i);
    let i = a.int_and(i, index_mask);
    a.name_int("wrapped_i", i);
    let j = lowest_index(a, mirror_v, walk.j);
    let j = a.int_and(j, index_mask);
    a.name_int("wrapped_j", j);
    let j = a.int_or(j, nodes_on_a_side);
    let row = a.int_shift_left(j, below_root, 4);
    let address = a.int_or(row, i);
    // Marker, v and u take 2 * below_root + 1 bits, so nothing but zeros is cut.
    let address = a.int_low_bits(address, shape.address_bits());
    a.name_int("window_address", address);
    address
}

fn lowest_index<A: Arith>(a: &mut A, mirror: A::Bit, index: A::Int) -> A::Int {
    let three = a.int_constant(MOST_SIDE as i64 - 1);
    let last = a.int_add(index, three);
    let lowest = a.int_select(mirror, last, index);
    a.int_complement_if(mirror, lowest)
}

/// Finds the first candidate.
pub(super) fn take<A: Arith>(
    a: &mut A,
    shape: WindowShape,
    walk: &WindowWalk<A>,
    candidates: &[A::Bit; MOST_CELLS],
) -> Taken<A> {
    let ended = a.or(walk.hit, walk.guard);
    a.name_bit("ended", ended);
    let running = a.not(ended);
    let zero = a.int_constant(0);
    let mask = mask(a, candidates);
    a.name_int("candidates", mask);
    let none_found = a.int_equal(mask, zero);
    a.name_bit("none_found", none_found);
    let found = a.not(none_found);
    let First {
        place, column, row, ..
    } = first_of(a, shape.cells(), mask);
    let i = a.int_add(walk.i, column);
    a.name_int("taken_i", i);
    let j = a.int_add(walk.j, row);
    a.name_int("taken_j", j);
    let at_level_0 = a.int_equal(walk.level, zero);
    a.name_bit("at_level_0", at_level_0);
    let found_texel = a.and(found, at_level_0);
    let hits = a.and(found_texel, running);
    a.name_bit("hits", hits);
    // Two levels down, where there are two.
    let two = a.int_constant(2);
    let below = a.int_sub(walk.level, two);
    let is_below_map = a.int_less_than(below, zero);
    let level_below = a.int_select(is_below_map, zero, below);
    let level_below = a.int_wrap(level_below, LEVEL_BITS);
    a.name_int("level_below", level_below);
    Taken {
        ended,
        found,
        hits,
        cell: (place, column, row),
        i,
        j,
        level_below,
    }
}

/// How many of these borders of a window, the second to the last, the ray has crossed for sure: the
/// column or row to go on with.
pub(super) fn crossed<A: Arith>(
    a: &mut A,
    name: &'static str,
    crossed: [A::Bit; MOST_SIDE],
) -> A::Int {
    let mut count = a.int_constant(0);
    for (n, crossed) in crossed.into_iter().enumerate() {
        let n = a.int_constant(n as i64 + 1);
        count = a.int_select(crossed, n, count);
    }
    a.name_int(name, count);
    count
}

/// The walk after the step. `texels` are those to go down to, on u and v; `ways` the columns and rows
/// to go on by.
pub(super) fn window_advance<A: Arith>(
    a: &mut A,
    shape: WindowShape,
    walk: &WindowWalk<A>,
    taken: &Taken<A>,
    texels: (A::Int, A::Int),
    ways: (A::Int, A::Int),
) -> WindowWalk<A> {
    let running = a.not(taken.ended);
    a.name_bit("running", running);
    let not_found = a.not(taken.found);
    let crosses = a.and(not_found, running);
    a.name_bit("crosses", crosses);
    let hit = a.or(walk.hit, taken.hits);
    a.name_bit("next_hit", hit);
    let level = a.int_select(taken.found, taken.level_below, walk.level);
    let level = a.int_select(taken.ended, walk.level, level);
    let level = a.int_wrap(level, LEVEL_BITS);
    a.name_int("next_level", level);
    let [i, j] = [
        ("next_i", walk.i, taken.i, texels.0, ways.0),
        ("next_j", walk.j, taken.j, texels.1, ways.1),
    ]
    .map(|(name, index, taken_index, texel, way)| {
        let shift = a.int_low_bits(taken.level_below, 4);
        let below = a.int_shift_right(texel, shift, 4);
        let across = a.int_add(index, way);
        let next = a.int_select(taken.found, below, across);
        let next = a.int_select(taken.hits, taken_index, next);
        let next = a.int_select(taken.ended, index, next);
        // A ray within reach stays within the index's bits.
        let next = a.int_wrap(next, INDEX_BITS);
        a.name_int(name, next);
        next
    });
    let step = a.int_from_bit(running);
    let steps = a.int_add(walk.steps, step);
    // The guard ends a walk before its counters could overflow.
    let steps = a.int_wrap(steps, WIDE_COUNTER_BITS);
    a.name_int("next_steps", steps);
    let crossing = a.int_from_bit(crosses);
    let crossings = a.int_add(walk.crossings, crossing);
    let crossings = a.int_wrap(crossings, WIDE_COUNTER_BITS);
    a.name_int("next_crossings", crossings);
    let step_bound = a.int_constant(shape.step_bound().into());
    let at_bound = a.int_equal(steps, step_bound);
    a.name_bit("at_bound", at_bound);
    let no_hit = a.not(hit);
    let bound_reached = a.and(at_bound, no_hit);
    let guard = a.or(walk.guard, bound_reached);
    a.name_bit("next_guard", guard);
    WindowWalk {
        level,
        i,
        j,
        steps,
        crossings,
        hit,
        guard,
    }
}

/// A texel no earlier than `first` and the entry, and no later than the last of the cell.
pub(super) fn texel_within<A: Arith>(
    a: &mut A,
    name: &'static str,
    texel: A::Int,
    (cell, level): (A::Int, A::Int),
    first: A::Int,
    entry: A::Int,
) -> A::Int {
    let one = a.int_constant(1);
    let next_cell = a.int_add(cell, one);
    let after = first_texel(a, level, next_cell);
    let last = a.int_sub(after, one);
    let too_far = a.int_less_than(last, texel);
    let texel = a.int_select(too_far, last, texel);
    let too_near = a.int_less_than(texel, first);
    let texel = a.int_select(too_near, first, texel);
    let before_entry = a.int_less_than(texel, entry);
    let texel = a.int_select(before_entry, entry, texel);
    let texel = a.int_wrap(texel, INDEX_BITS);
    a.name_int(name, texel);
    texel
}

/// The first texel of a node, on one axis.
pub(super) fn first_texel<A: Arith>(a: &mut A, level: A::Int, index: A::Int) -> A::Int {
    let shift = a.int_low_bits(level, 4);
    let texel = a.int_shift_left(index, shift, 4);
    a.int_wrap(texel, INDEX_BITS)
}
