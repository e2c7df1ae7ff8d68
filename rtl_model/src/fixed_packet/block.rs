//! Method `block`, a cell at a time: packets of walks through lines of 4 x 4 nodes.
//!
//! The definition looks at all cells of a line in one step and keeps the candidates it does not
//! take. What comes of it can be had from the cells alone, in path order: a cell that is a
//! candidate is gone into, and where a ray leaves a block it goes on in the next cell of the lowest
//! level at which that is still in the same block. So no mask is kept, and the cells that are looked
//! at are the few that the ray meets before its first candidate. Those that it has left before the depth of
//! the block are passed over; they can be no candidates, since no cell is higher than its block.
//!
//! A step looks at a cell and goes down or across. Leaving a block takes more, and is done by the
//! lane alone: one step in five or six. Lines read are counted there: the walk has gone down once for
//! each level from its start, and once more for each that it has come up; a crossing from a block of
//! the start level to the next is a line too.

use super::answer::{Ended, EndedAxis};
use super::entry::AxisEntry;
use super::lanes::{AT_TOP, LANE_BITS, LANES};
use super::walk::Walks;
use crate::maps::Pyramid;
use crate::packet::node::{onward, step_by};
use crate::packet::number::{larger, select, smaller};
use crate::units::wide_shape::WideShape;

/// log2 of the cells on a side of a line.
pub(super) const LOG2_SIDE: u32 = 2;

/// The bits of a cell's place that index u: two of every four.
const BITS_U: u64 = 0x3333_3333;
/// Those that index v.
const BITS_V: u64 = 0xcccc_cccc;

/// The lines of a map: `line_levels` levels of cells, over a tile of a power of 16 texels that may
/// hold the map more than once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blocks {
    line_levels: u32,
    /// How many levels above the lowest a walk starts, by log2 of its travel from top to bottom in
    /// texels, rounded down.
    start_of_reach: [u32; REACHES],
    full_height: f64,
}

/// Powers of two of a travel that are told apart; at the last or above every walk starts alike.
const REACHES: usize = 32;

impl Blocks {
    pub(super) fn new(root_level: u32, height_bits: u32) -> Blocks {
        let shape = WideShape {
            root_level,
            height_bits,
            log2_side: LOG2_SIDE,
        };
        let mut start_of_reach = [0; REACHES];
        for (reach, start) in start_of_reach.iter_mut().enumerate() {
            let starts = |n: &usize| shape.start_reach_log2(shape.line_level(*n)) as usize <= reach;
            *start = (1..shape.line_levels()).filter(starts).count() as u32;
        }
        Blocks {
            line_levels: shape.line_levels() as u32,
            start_of_reach,
            full_height: ((1_u32 << height_bits) - 1).into(),
        }
    }

    /// Levels from the texels of the tile to the tile itself.
    fn tile_level(&self) -> u32 {
        LOG2_SIDE * self.line_levels
    }

    /// A word for each cell, at its place: a one, then for each level from above four bits, v's
    /// two before u's.
    pub(super) fn in_order(&self, pyramid: &Pyramid, word_of: impl Fn(u16) -> u16) -> Vec<u16> {
        let mut words = vec![0; 2 << (2 * self.tile_level())];
        for n in 0..self.line_levels {
            let level = LOG2_SIDE * n;
            let side = 1_u32 << (self.tile_level() - level);
            for j in 0..side {
                for i in 0..side {
                    let place = u64::from(side * side) | spread(i) | (spread(j) << 2);
                    words[place as usize] = word_of(pyramid.height(level, i.into(), j.into()));
                }
            }
        }
        words
    }

    /// How many levels above the lowest a walk starts.
    #[inline(always)]
    fn start(&self, slope: f64) -> u32 {
        // Exact: a slope has at most 32 bits.
        let reach = slope * self.full_height;
        // Below one texel a walk starts at the lowest level, as below two.
        let log2 = (reach.to_bits() >> 52).saturating_sub(1023) as usize;
        self.start_of_reach[log2.min(REACHES - 1)]
    }
}

/// The pairs of bits of an index below 2^16, each followed by room for another pair.
#[inline(always)]
fn spread(index: u32) -> u64 {
    let mut bits = u64::from(index) & 0xffff;
    bits = (bits | (bits << 8)) & 0x00ff_00ff;
    bits = (bits | (bits << 4)) & 0x0f0f_0f0f;
    (bits | (bits << 2)) & BITS_U
}

/// Index on u of a texel by its place; shift the place right by two for v.
#[inline(always)]
fn index_of_place(place: u64, size: u32) -> u32 {
    let mut bits = place & BITS_U;
    bits = (bits | (bits >> 2)) & 0x0f0f_0f0f;
    bits = (bits | (bits >> 4)) & 0x00ff_00ff;
    bits = (bits | (bits >> 8)) & 0xffff;
    bits as u32 & (size - 1)
}

/// What the lanes have on one axis.
struct AxisCells {
    entry: [f64; LANES],
    slope: [f64; LANES],
    lowered_slope: [f64; LANES],
    reciprocal: [f64; LANES],
}

impl AxisCells {
    const IDLE: AxisCells = AxisCells {
        entry: [0.0; LANES],
        slope: [1.0; LANES],
        lowered_slope: [1.0; LANES],
        reciprocal: [1.0; LANES],
    };

    #[inline(always)]
    fn enter(&mut self, lane: usize, axis: &AxisEntry) {
        self.entry[lane] = axis.entry;
        self.slope[lane] = axis.slope;
        self.lowered_slope[lane] = axis.lowered_slope;
        self.reciprocal[lane] = axis.reciprocal;
    }

    /// The index of the texel that a ray enters, mirrored.
    #[inline(always)]
    fn texel(axis: &AxisEntry) -> i32 {
        let texel = axis.entry as i32;
        texel - i32::from(f64::from(texel) > axis.entry)
    }
}

/// The walks of a packet. What a lane holds that has no ray is of no account.
#[repr(align(64))]
pub(super) struct BlockPacket {
    axes: [AxisCells; 2],
    /// From the entry to the cell's far border, in texels, on u and on v.
    way: [[f64; LANES]; 2],
    /// What makes a cell the next one in its block, on u and on v.
    next: [[u64; LANES]; 2],
    /// The slope on u for what has been travelled: lowered, or not after a crossing of v.
    travel_slope_u: [f64; LANES],
    /// The cell looked at, by its place; its index is mirrored back to the map's.
    cell: [u64; LANES],
    /// Ones where the index of a mirrored axis is.
    mirror: [u64; LANES],
    /// Side of the cell, in texels.
    size: [f64; LANES],
    /// Side of a cell of the level that the walk starts at.
    start_size: [f64; LANES],
    /// Depth reached, in height steps.
    t: [f64; LANES],
    /// The cell's depth.
    depth: [i32; LANES],
    /// Lines read, those down to the surface included.
    lines: [u32; LANES],
    /// Crossings from a block of the start level to the next.
    crossings: [u32; LANES],
    /// The ray's place in the list.
    ray: [usize; LANES],
    /// The packet's step count when the ray entered.
    entered: [u32; LANES],
}

/// What became of the lanes in a step: a one for each lane.
struct Events {
    /// The walk has ended in a hit.
    hits: u64,
    /// The ray has left its block: `leave_block` is due.
    leaving: u64,
}

impl BlockPacket {
    /// A packet without rays.
    pub(super) const IDLE: BlockPacket = BlockPacket {
        axes: [AxisCells::IDLE; 2],
        way: [[1.0; LANES]; 2],
        next: [[0; LANES]; 2],
        travel_slope_u: [1.0; LANES],
        cell: [1; LANES],
        mirror: [0; LANES],
        size: [1.0; LANES],
        start_size: [1.0; LANES],
        t: [AT_TOP; LANES],
        depth: [0; LANES],
        lines: [0; LANES],
        crossings: [0; LANES],
        ray: [0; LANES],
        entered: [0; LANES],
    };

    /// Puts a ray into a lane, in the cell of its start level.
    #[inline(always)]
    fn enter(
        &mut self,
        lane: usize,
        (ray, u, v): (usize, AxisEntry, AxisEntry),
        blocks: &Blocks,
        now: u32,
    ) {
        let start = blocks.start(larger(u.slope, v.slope));
        let level = LOG2_SIDE * start;
        let side = 1_i32 << level;
        let size = f64::from(side);
        let mut indices = [0; 2];
        for (number, (axis, bits)) in [(&u, BITS_U), (&v, BITS_V)].into_iter().enumerate() {
            self.axes[number].enter(lane, axis);
            let texel = AxisCells::texel(axis);
            // Its cell, in whole texels.
            self.way[number][lane] = f64::from((texel & -side) + side) - axis.entry;
            let one = onward(bits);
            self.next[number][lane] = (one ^ axis.mirror).wrapping_sub(axis.mirror);
            indices[number] = (texel ^ axis.mirror as i32) as u32;
        }
        let [i, j] = indices;
        let tile_level = blocks.tile_level();
        let tile_mask = (1_u64 << (2 * tile_level)) - 1;
        let texel = (spread(i) | (spread(j) << 2)) & tile_mask | (tile_mask + 1);
        self.travel_slope_u[lane] = u.lowered_slope;
        self.cell[lane] = texel >> (2 * level);
        self.mirror[lane] = (u.mirror & BITS_U) | (v.mirror & BITS_V);
        self.size[lane] = size;
        self.start_size[lane] = size;
        self.t[lane] = AT_TOP;
        self.lines[lane] = start + 1;
        self.crossings[lane] = 0;
        self.ray[lane] = ray;
        self.entered[lane] = now;
    }

    /// Looks up the depth of every lane's cell.
    #[inline(always)]
    fn fetch<D: Copy + Into<i32>>(&mut self, depths: &[D]) {
        // No lane with a ray reaches beyond the memory; the mask spares a lane without one.
        let mask = depths.len() - 1;
        for lane in 0..LANES {
            self.depth[lane] = depths[self.cell[lane] as usize & mask].into();
        }
    }

    /// One step of every lane: written as `super::lanes::Packet::step` is, for the same reasons.
    #[inline(always)]
    fn step(&mut self) -> Events {
        let mut hits = 0;
        let mut leaving = 0;
        for (lane, &lane_bit) in LANE_BITS.iter().enumerate() {
            let (size, t) = (self.size[lane], self.t[lane]);
            let (cell, mirror) = (self.cell[lane], self.mirror[lane]);
            let (way_u, way_v) = (self.way[0][lane], self.way[1][lane]);
            let (next_u, next_v) = (self.next[0][lane], self.next[1][lane]);
            let [u, v] = &self.axes;
            let (slope_u, lowered_u) = (u.slope[lane], u.lowered_slope[lane]);
            let travel_slope_u = self.travel_slope_u[lane];
            let depth = f64::from(self.depth[lane]);

            // Where the ray leaves the cell, and by which border.
            let exit_u = way_u * u.reciprocal[lane];
            let exit_v = way_v * v.reciprocal[lane];
            let u_first = exit_u <= exit_v;
            let exit = larger(select(u_first, exit_u, exit_v), t);

            // Down, or across? And how far.
            let down = depth <= exit;
            let reached = smaller(exit, larger(depth, t));
            self.t[lane] = reached;
            let travel_slope_u = select(t < reached, lowered_u, travel_slope_u);

            // Which of the sixteen cells the ray is in: by halves.
            let (half, quarter) = (0.5 * size, 0.25 * size);
            let travelled_u = reached * travel_slope_u;
            let travelled_v = reached * v.lowered_slope[lane];
            let (midline_u, midline_v) = (way_u - half, way_v - half);
            let (far_u, far_v) = (midline_u <= travelled_u, midline_v <= travelled_v);
            let half_u = select(far_u, way_u, midline_u);
            let half_v = select(far_v, way_v, midline_v);
            let (line_u, line_v) = (half_u - quarter, half_v - quarter);
            let (farther_u, farther_v) = (line_u <= travelled_u, line_v <= travelled_v);
            self.way[0][lane] = select(
                down,
                select(farther_u, half_u, line_u),
                select(u_first, way_u + size, way_u),
            );
            self.way[1][lane] = select(
                down,
                select(farther_v, half_v, line_v),
                select(u_first, way_v, way_v + size),
            );
            // A quarter by the exponent.
            self.size[lane] = f64::from_bits(size.to_bits().wrapping_sub(select(down, 2 << 52, 0)));
            self.travel_slope_u[lane] =
                select(down, travel_slope_u, select(u_first, lowered_u, slope_u));

            let column = select(far_u, 2, 0) | select(farther_u, 1, 0);
            let row = select(far_v, 8, 0) | select(farther_v, 4, 0);
            let child = (cell << 4) | ((column | row) ^ (mirror & 15));
            let across = cell.wrapping_add(select(u_first, next_u, next_v));
            self.cell[lane] = select(down, child, across);

            // The last cell of its block on the axis crossed.
            let last = select(u_first, 3, 12);
            let is_last = (cell ^ mirror) & last == last;
            hits |= select(down & (size == 1.0), lane_bit, 0);
            leaving |= select(!down & is_last, lane_bit, 0);
        }
        Events { hits, leaving }
    }

    /// Takes a lane that has gone across the border of its block into the cell that is next on the
    /// lowest level at which the two are in one block, or of the start level.
    #[inline(always)]
    fn leave_block(&mut self, lane: usize) {
        // No branch on what the ray does: it could not be foretold.
        let crossed = usize::from(self.crossed_v(lane));
        let other = 1 - crossed;
        let bits = [BITS_U, BITS_V][crossed];
        let next = self.next[crossed][lane];
        let size = self.size[lane];
        let cell = self.cell[lane].wrapping_sub(next);
        let levels_to_start =
            (self.start_size[lane].to_bits().wrapping_sub(size.to_bits()) >> 53) as u32;
        // Levels of which the cell is the last of its block.
        let not_last = !(cell ^ self.mirror[lane]) & bits | (16 << (4 * levels_to_start));
        let levels = not_last.trailing_zeros() / 4;
        let crosses = u32::from(levels > levels_to_start);
        let up = levels - crosses;
        let cell = cell >> (4 * up);
        let index_bits = bits & ((1 << (63 - cell.leading_zeros())) - 1);
        let amount = select((next as i64) < 0, index_bits, next);
        self.cell[lane] = step_by(cell, !index_bits, amount);
        self.lines[lane] += levels;
        self.crossings[lane] += crosses;
        let size_above = f64::from_bits(size.to_bits() + (u64::from(up) << 53));
        self.size[lane] = size_above;
        self.way[crossed][lane] += size_above - size;
        // The far border of the larger cell: the next multiple of its side.
        let entry = self.axes[other].entry[lane];
        let far = (self.way[other][lane] + entry) as i32;
        let side = size_above as i32;
        self.way[other][lane] = f64::from((far + side - 1) & -side) - entry;
    }

    /// Was the last border crossed one of v?
    #[inline(always)]
    fn crossed_v(&self, lane: usize) -> bool {
        self.travel_slope_u[lane] == self.axes[0].slope[lane]
    }

    #[inline(always)]
    fn ended_axis(&self, number: usize, lane: usize) -> EndedAxis {
        EndedAxis {
            entry: self.axes[number].entry[lane],
            slope: self.axes[number].slope[lane],
            // The step has gone to the near quarter of the texel on the axis crossed.
            way: self.way[number][lane] - 0.25,
            mirrored: (self.next[number][lane] as i64) < 0,
        }
    }
}

/// A packet over the lines of a map.
pub(super) struct BlockWalks {
    pub(super) packet: BlockPacket,
    pub(super) blocks: Blocks,
}

impl Walks for BlockWalks {
    #[inline(always)]
    fn enter(&mut self, lane: usize, ray: (usize, AxisEntry, AxisEntry), now: u32) {
        self.packet.enter(lane, ray, &self.blocks, now);
    }

    #[inline(always)]
    fn step<D: Copy + Into<i32>>(&mut self, depths: &[D], live: u64) -> u64 {
        self.packet.fetch(depths);
        let events = self.packet.step();
        let mut leaving = events.leaving & live;
        while leaving != 0 {
            let lane = leaving.trailing_zeros() as usize % LANES;
            leaving &= leaving - 1;
            self.packet.leave_block(lane);
        }
        events.hits & live
    }

    #[inline(always)]
    fn ray(&self, lane: usize) -> usize {
        self.packet.ray[lane]
    }

    #[inline(always)]
    fn entered(&self, lane: usize) -> u32 {
        self.packet.entered[lane]
    }

    #[inline(always)]
    fn ended(&self, lane: usize, _now: u32) -> Ended {
        let packet = &self.packet;
        Ended {
            ray: packet.ray[lane],
            steps: packet.lines[lane],
            crossings: packet.crossings[lane],
            texel: packet.cell[lane] >> 4,
            t: packet.t[lane],
            crossed_v: packet.crossed_v(lane),
            u: packet.ended_axis(0, lane),
            v: packet.ended_axis(1, lane),
        }
    }

    #[inline(always)]
    fn texel(place: u64, size: u32) -> (u32, u32) {
        (
            index_of_place(place, size),
            index_of_place(place >> 2, size),
        )
    }
}
