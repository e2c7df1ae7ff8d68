//! Method `block`, a cell at a time: packets of walks through lines of 4 x 4 nodes.
//!
//! The definition looks at all cells of a line in one step and keeps the candidates it does not
//! take. What comes of it can be had from the cells alone, in path order: a cell that is a
//! candidate is gone into, and where a ray leaves a block it goes on in the next cell of the lowest
//! level at which that is still in the same block. So no mask is kept, and the cells that are looked
//! at are the few that the ray meets before its first candidate. Those that it has left before the depth of
//! the block are passed over; they can be no candidates, since no cell is higher than its block.
//!
//! A step looks at a cell and goes down or across. A cell is held by its side and, on either axis, by the last
//! unit before its far border, 2^-24 texel from the map's origin, which makes leaving a block no case of its
//! own. The side of the next cell is the largest power of four that divides the border crossed, but at most
//! that of the start level: below it, a border that divides by four sides is one of the block. In units that
//! side less one is the ones that the last unit before the border ends in, an even number of them; and the
//! next cell's last unit ends in all of them on both axes.
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

/// log2 of the units in a texel: as many fraction bits as an entry has at most.
const LOG2_UNITS: u32 = 24;

/// A unit, in texels.
const UNIT: f64 = 1.0 / (1_u64 << LOG2_UNITS) as f64;

/// Added to a number of texels, it leaves units in the low bits of the pattern, negative or not: 1.5 times
/// the power of two whose last place is a unit.
const SHIFTER: f64 = 1.5 * (1_u64 << (52 - LOG2_UNITS)) as f64;

/// A number's pattern with its units in the low bits, for numbers that are not negative; halved.
const HALF_SHIFTER: f64 = (1_u64 << (51 - LOG2_UNITS)) as f64;

/// The bits above each power of four.
const ABOVE_POWERS_OF_FOUR: u64 = 0xaaaa_aaaa_aaaa_aaaa;

/// The lines of a map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blocks {
    line_levels: u32,
    /// log2 of the map's side in texels.
    root_level: u32,
    /// The level that a walk starts at, by log2 of its travel from top to bottom in texels, rounded
    /// down.
    start_of_reach: [StartCell; REACHES],
    full_height: f64,
}

/// A cell of the level that a walk starts at.
#[derive(Clone, Copy, Debug)]
struct StartCell {
    /// Its side, in units, less one.
    units: u64,
    /// Half its side, in texels.
    half: f64,
}

impl StartCell {
    fn of_side(side: u32) -> StartCell {
        StartCell {
            units: (u64::from(side) << LOG2_UNITS) - 1,
            half: 0.5 * f64::from(side),
        }
    }
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
        let mut start_of_reach = [StartCell::of_side(1); REACHES];
        for (reach, cell) in start_of_reach.iter_mut().enumerate() {
            let starts = |n: &usize| shape.start_reach_log2(shape.line_level(*n)) as usize <= reach;
            let start = (1..shape.line_levels()).filter(starts).count() as u32;
            *cell = StartCell::of_side(1 << (LOG2_SIDE * start));
        }
        Blocks {
            line_levels: shape.line_levels() as u32,
            root_level,
            start_of_reach,
            full_height: ((1_u32 << height_bits) - 1).into(),
        }
    }

    /// A word for each cell, at its place: that of its centre, row by row. Rows are half a texel high:
    /// those of centres of texels are odd, those of centres of larger cells even; and a row has a word for
    /// each texel. A centre is an odd number of half sides from the origin, so no two levels share one.
    pub(super) fn in_order(&self, pyramid: &Pyramid, word_of: impl Fn(u16) -> u16) -> Vec<u16> {
        let mut words = vec![0; 2 << (2 * self.root_level)];
        for n in 0..self.line_levels {
            let level = LOG2_SIDE * n;
            let centre = |index: u32| (2 * index as usize + 1) << level;
            let side = 1_u32 << (self.root_level - level);
            for j in 0..side {
                for i in 0..side {
                    let place = (centre(j) << self.root_level) | (centre(i) / 2);
                    words[place] = word_of(pyramid.height(level, i.into(), j.into()));
                }
            }
        }
        words
    }

    /// The cell that a walk starts at has this side.
    #[inline(always)]
    fn start(&self, slope: f64) -> StartCell {
        // Exact: a slope has at most 32 bits.
        let reach = slope * self.full_height;
        // Below one texel a walk starts at the lowest level, as below two.
        let log2 = (reach.to_bits() >> 52).saturating_sub(1023) as usize;
        self.start_of_reach[log2.min(REACHES - 1)]
    }
}

/// What the lanes have on one axis.
struct AxisCells {
    /// One unit before the entry, plus [`SHIFTER`].
    before: [f64; LANES],
    slope: [f64; LANES],
    lowered_slope: [f64; LANES],
    reciprocal: [f64; LANES],
    /// The last unit before the cell's far border, mirrored, plus [`SHIFTER`].
    last: [f64; LANES],
}

impl AxisCells {
    const IDLE: AxisCells = AxisCells {
        before: [SHIFTER; LANES],
        slope: [1.0; LANES],
        lowered_slope: [1.0; LANES],
        reciprocal: [1.0; LANES],
        last: [SHIFTER; LANES],
    };

    /// Puts a ray into the cell of this side, whose units but one are given.
    #[inline(always)]
    fn enter(&mut self, lane: usize, axis: &AxisEntry, units: u64) {
        self.before[lane] = (axis.entry - UNIT) + SHIFTER;
        self.slope[lane] = axis.slope;
        self.lowered_slope[lane] = axis.lowered_slope;
        self.reciprocal[lane] = axis.reciprocal;
        self.last[lane] = f64::from_bits((axis.entry + SHIFTER).to_bits() | units);
    }

    #[inline(always)]
    fn ended(&self, lane: usize, mirrored: bool) -> EndedAxis {
        EndedAxis {
            entry: self.before[lane] - (SHIFTER - UNIT),
            slope: self.slope[lane],
            // The step has gone to the near quarter of the texel on the axis crossed.
            way: self.last[lane] - self.before[lane] - 0.25,
            mirrored,
        }
    }
}

/// The walks of a packet. What a lane holds that has no ray is of no account.
#[repr(align(64))]
pub(super) struct BlockPacket {
    u: AxisCells,
    v: AxisCells,
    /// The slope on u for what has been travelled: lowered, or not after a crossing of v.
    travel_slope_u: [f64; LANES],
    /// The cell looked at: where its depth lies, modulo the depths there are.
    place: [u64; LANES],
    /// Ones where an axis is mirrored, in the bits of a place and its units.
    mirror: [u64; LANES],
    /// What takes a place from before a cell's centre to it: on an axis that is not mirrored.
    to_centre: [u64; LANES],
    /// Half the side of the cell, in texels.
    half: [f64; LANES],
    /// Side of a cell of the level that the walk starts at, in units, less one.
    largest: [u64; LANES],
    /// Blocks of that level on both axes up to the first.
    first_block: [u64; LANES],
    /// Depth reached, in height steps.
    t: [f64; LANES],
    /// The cell's depth.
    depth: [i32; LANES],
    /// How often the walk has gone down.
    descents: [u64; LANES],
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
        mirror: [0; LANES],
        to_centre: [0; LANES],
        half: [0.5; LANES],
        largest: [(1 << LOG2_UNITS) - 1; LANES],
        first_block: [0; LANES],
        t: [AT_TOP; LANES],
        depth: [0; LANES],
        descents: [0; LANES],
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
        let StartCell { units, half } = blocks.start(larger(u.slope, v.slope));
        self.u.enter(lane, &u, units);
        self.v.enter(lane, &v, units);
        self.travel_slope_u[lane] = u.lowered_slope;
        let on_v = u64::MAX << (LOG2_UNITS + blocks.root_level);
        self.mirror[lane] = (u.mirror & !on_v) | (v.mirror & on_v);
        self.to_centre[lane] = (!u.mirror & 1) | (!v.mirror & on_v & on_v.wrapping_neg());
        let (last_u, last_v) = (self.u.last[lane], self.v.last[lane]);
        self.place[lane] = place(
            (last_u - half).to_bits(),
            (last_v - half).to_bits(),
            self.mirror[lane],
            self.to_centre[lane],
            blocks.root_level,
        );
        self.half[lane] = half;
        self.largest[lane] = units;
        self.first_block[lane] = self.block(lane);
        self.t[lane] = AT_TOP;
        self.descents[lane] = 0;
        self.ray[lane] = ray;
        self.entered[lane] = now;
    }

    /// Blocks of the start level up to where the ray is, on both axes; but for a constant.
    #[inline(always)]
    fn block(&self, lane: usize) -> u64 {
        let log2_block = self.largest[lane].trailing_ones() + LOG2_SIDE;
        let of = |last: f64| last.to_bits() >> log2_block;
        of(self.u.last[lane]) + of(self.v.last[lane])
    }

    /// How often the walk has crossed from a block of the start level to the next: blocks lie side by side on
    /// either axis.
    #[inline(always)]
    fn crossings(&self, lane: usize) -> u32 {
        self.block(lane).wrapping_sub(self.first_block[lane]) as u32
    }

    /// The texel's index on u, and on v above it, not wrapped to the map.
    #[inline(always)]
    fn texel(&self, lane: usize) -> u64 {
        let mirror = self.mirror[lane];
        let of = |last: f64, mirror: u64| (last.to_bits() >> LOG2_UNITS) ^ mirror;
        let u = of(self.u.last[lane], (mirror & 1).wrapping_neg());
        let v = of(self.v.last[lane], (mirror >> 63).wrapping_neg());
        (u & 0xffff_ffff) | (v << 32)
    }

    /// Looks up the depth of every lane's cell.
    #[inline(always)]
    fn fetch<D: Copy + Into<i32>>(&mut self, depths: &[D]) {
        let mask = depths.len() - 1;
        for lane in 0..LANES {
            self.depth[lane] = depths[self.place[lane] as usize & mask].into();
        }
    }

    /// One step of every lane: written as `super::lanes::Packet::step` is, for the same reasons. The
    /// answer has a one for each lane whose walk has ended.
    #[inline(always)]
    fn step(&mut self, root_level: u32) -> u64 {
        let mut hits = 0;
        for (lane, &lane_bit) in LANE_BITS.iter().enumerate() {
            let (half, t) = (self.half[lane], self.t[lane]);
            let (u, v) = (&self.u, &self.v);
            let (last_u, last_v) = (u.last[lane], v.last[lane]);
            let (slope_u, lowered_u) = (u.slope[lane], u.lowered_slope[lane]);
            let travel_slope_u = self.travel_slope_u[lane];
            let largest = self.largest[lane];
            let (mirror, to_centre) = (self.mirror[lane], self.to_centre[lane]);
            let descents = self.descents[lane];
            let depth = f64::from(self.depth[lane]);

            // Where the ray leaves the cell, and by which border.
            let (way_u, way_v) = (last_u - u.before[lane], last_v - v.before[lane]);
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
            let quarter = 0.5 * half;
            let travelled_u = reached * travel_slope_u;
            let travelled_v = reached * v.lowered_slope[lane];
            let down_by = |way: f64, last: f64, travelled: f64| {
                let midline = way - half;
                let is_far = midline <= travelled;
                let way = select(is_far, way, midline);
                let last = select(is_far, last, last - half);
                select(way - quarter <= travelled, last, last - quarter)
            };
            let down_u = down_by(way_u, last_u, travelled_u);
            let down_v = down_by(way_v, last_v, travelled_v);

            // Across: the side of the next cell, in units and less one, is the ones at the end of the last
            // unit before the border, an even number of them. The next cell's last unit has all of
            // them, whether the border was crossed into it or not.
            let crossed = select(u_first, last_u, last_v).to_bits();
            let ones = crossed & !crossed.wrapping_add(1) & largest;
            let side = ones & ((ones >> 1) | ABOVE_POWERS_OF_FOUR);
            let (last_u, last_v) = (last_u.to_bits(), last_v.to_bits());
            let across_u = select(u_first, last_u.wrapping_add(1), last_u) | side;
            let across_v = select(u_first, last_v, last_v.wrapping_add(1)) | side;
            let half_next =
                f64::from_bits(side | HALF_SHIFTER.to_bits()) - (HALF_SHIFTER - 0.5 * UNIT);

            let half = select(down, 0.5 * quarter, half_next);
            let last_u = select(down, down_u, f64::from_bits(across_u));
            let last_v = select(down, down_v, f64::from_bits(across_v));
            self.half[lane] = half;
            self.u.last[lane] = last_u;
            self.v.last[lane] = last_v;
            self.descents[lane] = descents + select(down, 1, 0);
            self.place[lane] = place(
                (last_u - half).to_bits(),
                (last_v - half).to_bits(),
                mirror,
                to_centre,
                root_level,
            );

            // Below the texels: the walk has ended.
            hits |= select(half < 0.5, lane_bit, 0);
        }
        hits
    }

    /// Was the last border crossed one of v?
    #[inline(always)]
    fn crossed_v(&self, lane: usize) -> bool {
        self.travel_slope_u[lane] == self.u.slope[lane]
    }
}

/// Where the depth of a cell lies, modulo the depths there are, by the last unit on either axis before its
/// centre.
#[inline(always)]
fn place(before_u: u64, before_v: u64, mirror: u64, to_centre: u64, root_level: u32) -> u64 {
    let on_u = (1 << (LOG2_UNITS + root_level)) - 1;
    let before = (before_u & on_u) | ((before_v << (root_level + 1)) & !on_u);
    ((before ^ mirror).wrapping_add(to_centre)) >> LOG2_UNITS
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
        self.packet.step(self.blocks.root_level) & live
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
        let crossings = packet.crossings(lane);
        Ended {
            ray: packet.ray[lane],
            steps: packet.descents[lane] as u32 + crossings,
            crossings,
            texel: packet.texel(lane),
            t: packet.t[lane],
            crossed_v: packet.crossed_v(lane),
            u: packet.u.ended(lane, packet.mirror[lane] & 1 != 0),
            v: packet.v.ended(lane, packet.mirror[lane] >> 63 != 0),
        }
    }

    #[inline(always)]
    fn texel(place: u64, size: u32) -> (u32, u32) {
        (place as u32 & (size - 1), (place >> 32) as u32 & (size - 1))
    }
}
