//! Method `block`, a cell at a time: packets of walks through lines of 4 x 4 nodes.
//!
//! The definition looks at all cells of a line in one step and keeps the candidates it does not
//! take. What comes of it can be had from the cells alone, in path order: a cell that is a
//! candidate is gone into, and where a ray leaves a block it goes on in the next cell of the lowest
//! level at which that is still in the same block. So no mask is kept, and the cells that are looked
//! at are the few that the ray meets before its first candidate. Those that it has left before the depth of
//! the block are passed over; they can be no candidates, since no cell is higher than its block.
//!
//! A step looks at a cell and goes down or across. A cell is held by its side and its far borders,
//! in texels from the map's origin, which makes leaving a block no case of its own. The side of the next cell is the
//! largest power of four that divides the border crossed, but at most that of the start level: below
//! it, a border that divides by four sides is one of the block. The next cell's far borders are the
//! multiples of its side next beyond the point where the ray is.
//!
//! Lines read are the times that the walk has gone down, each to a line or to the surface, but for the
//! first line, which makes up for the last; and the crossings from a block of the start level to the next.

use super::answer::{Ended, EndedAxis};
use super::entry::AxisEntry;
use super::lanes::{AT_TOP, LANE_BITS, LANES};
use super::walk::Walks;
use crate::maps::Pyramid;
use crate::packet::number::{larger, select, smaller};
use crate::units::wide_shape::WideShape;

/// log2 of the cells on a side of a line.
pub(super) const LOG2_SIDE: u32 = 2;

/// 1.5 * 2^52: added to a small integer, it leaves it in the low bits, negative or not; and added to a
/// number it rounds it to an integer.
const SHIFTER: f64 = 1.5 * (1_u64 << 52) as f64;

/// Every other bit: the powers of four.
const POWERS_OF_FOUR: u64 = 0x5555_5555_5555;

/// One crossing among the counts of a lane, above the times that it has gone down.
const CROSSING: u64 = 1 << 32;

/// The lines of a map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blocks {
    line_levels: u32,
    /// log2 of the map's side in half texels.
    log2_half_texels: u32,
    /// The bits of a place that index u, and those that index v, before the lowest is shifted out.
    place_masks: [u64; 2],
    /// Side of a cell of the level that a walk starts at, by log2 of its travel from top to bottom in
    /// texels, rounded down.
    start_side_of_reach: [i32; REACHES],
    /// What a texel on v adds to a place: two rows.
    row_of_texel: f64,
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
        let mut start_side_of_reach = [0; REACHES];
        for (reach, side) in start_side_of_reach.iter_mut().enumerate() {
            let starts = |n: &usize| shape.start_reach_log2(shape.line_level(*n)) as usize <= reach;
            let start = (1..shape.line_levels()).filter(starts).count() as u32;
            *side = 1 << (LOG2_SIDE * start);
        }
        let log2_half_texels = root_level + 1;
        let mask = (1 << log2_half_texels) - 1;
        Blocks {
            line_levels: shape.line_levels() as u32,
            log2_half_texels,
            place_masks: [mask, mask << log2_half_texels],
            start_side_of_reach,
            row_of_texel: (2_u64 << log2_half_texels) as f64,
            full_height: ((1_u32 << height_bits) - 1).into(),
        }
    }

    /// A word for each cell, at its place: that of its centre, row by row. Rows are half a texel high:
    /// those of centres of texels are odd, those of centres of larger cells even; and a row has a word for
    /// each texel. A centre is an odd number of half sides from the origin, so no two levels share one.
    pub(super) fn in_order(&self, pyramid: &Pyramid, word_of: impl Fn(u16) -> u16) -> Vec<u16> {
        let mut words = vec![0; 1 << (2 * self.log2_half_texels - 1)];
        for n in 0..self.line_levels {
            let level = LOG2_SIDE * n;
            let centre = |index: u32| (2 * index as usize + 1) << level;
            let side = 1_u32 << (self.log2_half_texels - 1 - level);
            for j in 0..side {
                for i in 0..side {
                    let place = (centre(j) << (self.log2_half_texels - 1)) | (centre(i) / 2);
                    words[place] = word_of(pyramid.height(level, i.into(), j.into()));
                }
            }
        }
        words
    }

    /// Side of a cell of the level that a walk starts at.
    #[inline(always)]
    fn start_side(&self, slope: f64) -> i32 {
        // Exact: a slope has at most 32 bits.
        let reach = slope * self.full_height;
        // Below one texel a walk starts at the lowest level, as below two.
        let log2 = (reach.to_bits() >> 52).saturating_sub(1023) as usize;
        self.start_side_of_reach[log2.min(REACHES - 1)]
    }
}

/// What the lanes have on one axis.
struct AxisCells {
    entry: [f64; LANES],
    slope: [f64; LANES],
    lowered_slope: [f64; LANES],
    reciprocal: [f64; LANES],
    /// What a texel adds to a place; below zero where the axis is mirrored.
    place_of_texel: [f64; LANES],
    /// The cell's far border, in texels, mirrored.
    far: [f64; LANES],
}

impl AxisCells {
    const IDLE: AxisCells = AxisCells {
        entry: [0.0; LANES],
        slope: [1.0; LANES],
        lowered_slope: [1.0; LANES],
        reciprocal: [1.0; LANES],
        place_of_texel: [0.0; LANES],
        far: [1.0; LANES],
    };

    /// Puts a ray into the cell of this side.
    #[inline(always)]
    fn enter(&mut self, lane: usize, axis: &AxisEntry, size: f64, place_of_texel: f64) {
        self.entry[lane] = axis.entry;
        self.slope[lane] = axis.slope;
        self.lowered_slope[lane] = axis.lowered_slope;
        self.reciprocal[lane] = axis.reciprocal;
        self.place_of_texel[lane] = select(axis.mirror == 0, place_of_texel, -place_of_texel);
        // The nearest multiple of the side, and the next one if that is not beyond the entry.
        let shifter = SHIFTER * size;
        let nearest = axis.entry + shifter - shifter;
        self.far[lane] = select(nearest > axis.entry, nearest, nearest + size);
    }

    #[inline(always)]
    fn ended(&self, lane: usize) -> EndedAxis {
        EndedAxis {
            entry: self.entry[lane],
            slope: self.slope[lane],
            // The step has gone to the near quarter of the texel on the axis crossed.
            way: self.far[lane] - self.entry[lane] - 0.25,
            mirrored: self.place_of_texel[lane] < 0.0,
        }
    }

    /// The texel's index, not wrapped to the map.
    #[inline(always)]
    fn texel(&self, lane: usize) -> u64 {
        // The step has gone to a quarter of the texel, whose centre an integer never is.
        let centre = self.far[lane] - 0.125;
        let centre = select(self.place_of_texel[lane] < 0.0, -centre, centre);
        // The nearest integer to half a texel below: the next one below.
        (centre - 0.5 + SHIFTER).to_bits() & 0xffff_ffff
    }
}

/// The walks of a packet. What a lane holds that has no ray is of no account.
#[repr(align(64))]
pub(super) struct BlockPacket {
    u: AxisCells,
    v: AxisCells,
    /// The slope on u for what has been travelled: lowered, or not after a crossing of v.
    travel_slope_u: [f64; LANES],
    /// The cell looked at: where its depth lies.
    place: [u64; LANES],
    /// Side of the cell, in texels.
    size: [f64; LANES],
    /// Side of a cell of the level that the walk starts at.
    start_size: [u64; LANES],
    /// The bits of a texel's index that tell where it is in its block of that level.
    in_block: [u64; LANES],
    /// Depth reached, in height steps.
    t: [f64; LANES],
    /// The cell's depth.
    depth: [i32; LANES],
    /// How often the walk has gone down, and in units of [`CROSSING`] from a block of the start level
    /// to the next.
    counts: [u64; LANES],
    /// The ray's place in the list.
    ray: [usize; LANES],
    /// The packet's step count when the ray entered.
    entered: [u32; LANES],
}

impl BlockPacket {
    /// A packet without rays.
    pub(super) const IDLE: BlockPacket = BlockPacket {
        u: AxisCells::IDLE,
        v: AxisCells::IDLE,
        travel_slope_u: [1.0; LANES],
        place: [0; LANES],
        size: [1.0; LANES],
        start_size: [1; LANES],
        in_block: [0; LANES],
        t: [AT_TOP; LANES],
        depth: [0; LANES],
        counts: [0; LANES],
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
        let side = blocks.start_side(larger(u.slope, v.slope));
        let size = f64::from(side);
        // Two half texels, or two rows of them.
        self.u.enter(lane, &u, size, 2.0);
        self.v.enter(lane, &v, size, blocks.row_of_texel);
        self.travel_slope_u[lane] = u.lowered_slope;
        self.place[lane] = self.place_of(lane, size, blocks.place_masks);
        self.size[lane] = size;
        self.start_size[lane] = side as u64;
        self.in_block[lane] = 4 * side as u64 - 1;
        self.t[lane] = AT_TOP;
        self.counts[lane] = 0;
        self.ray[lane] = ray;
        self.entered[lane] = now;
    }

    #[inline(always)]
    fn place_of(&self, lane: usize, size: f64, [mask_u, mask_v]: [u64; 2]) -> u64 {
        let half = 0.5 * size;
        let (u, v) = (&self.u, &self.v);
        let place_u = (u.far[lane] - half) * u.place_of_texel[lane] + SHIFTER;
        let place_v = (v.far[lane] - half) * v.place_of_texel[lane] + SHIFTER;
        ((place_u.to_bits() & mask_u) | (place_v.to_bits() & mask_v)) >> 1
    }

    /// Looks up the depth of every lane's cell.
    #[inline(always)]
    fn fetch<D: Copy + Into<i32>>(&mut self, depths: &[D]) {
        // No lane with a ray reaches beyond the memory; the mask spares a lane without one.
        let mask = depths.len() - 1;
        for lane in 0..LANES {
            self.depth[lane] = depths[self.place[lane] as usize & mask].into();
        }
    }

    /// One step of every lane: written as `super::lanes::Packet::step` is, for the same reasons. The
    /// answer has a one for each lane whose walk has ended.
    #[inline(always)]
    fn step(&mut self, [mask_u, mask_v]: [u64; 2]) -> u64 {
        let mut hits = 0;
        for (lane, &lane_bit) in LANE_BITS.iter().enumerate() {
            let (size, t) = (self.size[lane], self.t[lane]);
            let (u, v) = (&self.u, &self.v);
            let (entry_u, entry_v) = (u.entry[lane], v.entry[lane]);
            let (border_u, border_v) = (u.far[lane], v.far[lane]);
            let (slope_u, lowered_u) = (u.slope[lane], u.lowered_slope[lane]);
            let travel_slope_u = self.travel_slope_u[lane];
            let start_size = self.start_size[lane];
            let in_block = self.in_block[lane];
            let counts = self.counts[lane];
            let depth = f64::from(self.depth[lane]);

            // Where the ray leaves the cell, and by which border.
            let (way_u, way_v) = (border_u - entry_u, border_v - entry_v);
            let exit_u = way_u * u.reciprocal[lane];
            let exit_v = way_v * v.reciprocal[lane];
            let u_first = exit_u <= exit_v;
            let exit = larger(select(u_first, exit_u, exit_v), t);

            // Down, or across? And how far.
            let down = depth <= exit;
            let reached = smaller(exit, larger(depth, t));
            self.t[lane] = reached;
            let travel_slope_u = select(t < reached, lowered_u, travel_slope_u);
            self.travel_slope_u[lane] =
                select(down, travel_slope_u, select(u_first, lowered_u, slope_u));

            // Down: which of the sixteen cells the ray is in, by halves.
            let (half, quarter) = (0.5 * size, 0.25 * size);
            let travelled_u = reached * travel_slope_u;
            let travelled_v = reached * v.lowered_slope[lane];
            let (midline_u, midline_v) = (way_u - half, way_v - half);
            let half_u = select(midline_u <= travelled_u, way_u, midline_u);
            let half_v = select(midline_v <= travelled_v, way_v, midline_v);
            let (line_u, line_v) = (half_u - quarter, half_v - quarter);
            let down_u = select(line_u <= travelled_u, half_u, line_u) + entry_u;
            let down_v = select(line_v <= travelled_v, half_v, line_v) + entry_v;

            // Across: the side of the next cell, by the lowest one of the border crossed.
            let crossed = (select(u_first, border_u, border_v) + SHIFTER).to_bits();
            let divisors = crossed | start_size;
            let largest = divisors & divisors.wrapping_neg();
            let next_size = (largest | (largest >> 1)) & POWERS_OF_FOUR;
            let next_size = f64::from_bits(next_size | SHIFTER.to_bits()) - SHIFTER;
            let crosses = crossed & in_block == 0;
            // Its far borders: halfway into the next cell on the axis crossed, and back into the cell on the
            // other, then on to the next multiple. Never halfway between two, so that it is the nearest.
            let onward_u = select(u_first, half, -half);
            let half_next = 0.5 * next_size;
            let shifter = next_size * SHIFTER;
            let across_u = border_u + (half_next + onward_u) + shifter - shifter;
            let across_v = border_v + (half_next - onward_u) + shifter - shifter;

            let size_after = select(down, quarter, next_size);
            let far_u = select(down, down_u, across_u);
            let far_v = select(down, down_v, across_v);
            self.size[lane] = size_after;
            self.u.far[lane] = far_u;
            self.v.far[lane] = far_v;
            let half_after = 0.5 * size_after;
            let place_u = (far_u - half_after) * self.u.place_of_texel[lane] + SHIFTER;
            let place_v = (far_v - half_after) * self.v.place_of_texel[lane] + SHIFTER;
            self.place[lane] = ((place_u.to_bits() & mask_u) | (place_v.to_bits() & mask_v)) >> 1;
            self.counts[lane] = counts + select(down, 1, select(crosses, CROSSING, 0));

            // Below the texels: the walk has ended.
            hits |= select(size_after < 1.0, lane_bit, 0);
        }
        hits
    }

    /// Was the last border crossed one of v?
    #[inline(always)]
    fn crossed_v(&self, lane: usize) -> bool {
        self.travel_slope_u[lane] == self.u.slope[lane]
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
        self.packet.step(self.blocks.place_masks) & live
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
        let counts = packet.counts[lane];
        let crossings = (counts / CROSSING) as u32;
        Ended {
            ray: packet.ray[lane],
            steps: counts as u32 + crossings,
            crossings,
            texel: packet.u.texel(lane) | (packet.v.texel(lane) << 32),
            t: packet.t[lane],
            crossed_v: packet.crossed_v(lane),
            u: packet.u.ended(lane),
            v: packet.v.ended(lane),
        }
    }

    #[inline(always)]
    fn texel(place: u64, size: u32) -> (u32, u32) {
        (place as u32 & (size - 1), (place >> 32) as u32 & (size - 1))
    }
}
