//! Method `oh`: a packet, the registers of many walks side by side, and one step of all of them.

use super::answer::{Ended, EndedAxis};
use super::entry::AxisEntry;
use super::walk::Walks;
use crate::packet::node::{BITS_U, BITS_V, backward, index_of, onward, step_by};
use crate::packet::number::{larger, select, smaller};

/// Rays of a packet: sixteen vectors of four numbers.
pub(super) const LANES: usize = 64;

/// Stands for depth zero before a walk has got anywhere.
pub(super) const AT_TOP: f64 = f64::from_bits((1023 - 100) << 52);

/// A one for each lane.
pub(super) static LANE_BITS: [u64; LANES] = {
    let mut bits = [0; LANES];
    let mut lane = 0;
    while lane < LANES {
        bits[lane] = 1 << lane;
        lane += 1;
    }
    bits
};

/// What the lanes have on one axis.
struct AxisLanes {
    entry: [f64; LANES],
    slope: [f64; LANES],
    lowered_slope: [f64; LANES],
    reciprocal: [f64; LANES],
    /// From the entry to the node's far border, in texels. It stands for the node's index: going to
    /// the next node adds the node's side to it, taking the near child takes half of that away.
    way: [f64; LANES],
    /// What [`step_by`] adds for the next node.
    next_node: [u64; LANES],
}

impl AxisLanes {
    const IDLE: AxisLanes = AxisLanes {
        entry: [0.0; LANES],
        slope: [1.0; LANES],
        lowered_slope: [1.0; LANES],
        reciprocal: [1.0; LANES],
        way: [1.0; LANES],
        next_node: [0; LANES],
    };

    #[inline(always)]
    fn enter(&mut self, lane: usize, axis: &AxisEntry, size: f64, bits: u64) {
        self.entry[lane] = axis.entry;
        self.slope[lane] = axis.slope;
        self.lowered_slope[lane] = axis.lowered_slope;
        self.reciprocal[lane] = axis.reciprocal;
        // Root node 0, or -1 where a mirrored entry lies below zero: its far border is 0 then.
        self.way[lane] = select(axis.entry < 0.0, 0.0, size) - axis.entry;
        self.next_node[lane] = select(axis.mirror == 0, onward(bits), backward(bits));
    }

    #[inline(always)]
    fn ended(&self, lane: usize, bits: u64) -> EndedAxis {
        EndedAxis {
            entry: self.entry[lane],
            slope: self.slope[lane],
            // The step has gone to the near child of the texel on the axis crossed.
            way: self.way[lane] - 0.5,
            mirrored: self.next_node[lane] == backward(bits),
        }
    }
}

/// The walks of a packet. What a lane holds that has no ray is of no account.
#[repr(align(64))]
pub(super) struct Packet {
    u: AxisLanes,
    v: AxisLanes,
    /// The slope on u for what has been travelled: lowered, or not after a crossing of v.
    travel_slope_u: [f64; LANES],
    /// The node looked at, in Z order; its index is mirrored back to the map's.
    node: [u64; LANES],
    /// Ones from the node's leading one upwards: minus 4 to the power of the levels below the root.
    above: [u64; LANES],
    /// In a near child, its index on the map ends in these bits: ones where an axis is mirrored.
    near_child: [u64; LANES],
    /// Side of the node, in texels.
    size: [f64; LANES],
    /// Depth reached, in height steps.
    t: [f64; LANES],
    /// The node's depth.
    depth: [i32; LANES],
    /// The ray's place in the list.
    ray: [usize; LANES],
    /// The packet's step count when the ray entered.
    entered: [u32; LANES],
}

impl Packet {
    /// A packet without rays.
    pub(super) const IDLE: Packet = Packet {
        u: AxisLanes::IDLE,
        v: AxisLanes::IDLE,
        travel_slope_u: [1.0; LANES],
        node: [1; LANES],
        above: [u64::MAX; LANES],
        near_child: [0; LANES],
        size: [1.0; LANES],
        t: [AT_TOP; LANES],
        depth: [0; LANES],
        ray: [0; LANES],
        entered: [0; LANES],
    };

    /// Puts a ray into a lane, at the root, whose side is `size`.
    #[inline(always)]
    fn enter(
        &mut self,
        lane: usize,
        (ray, u, v): (usize, AxisEntry, AxisEntry),
        size: f64,
        now: u32,
    ) {
        self.u.enter(lane, &u, size, BITS_U);
        self.v.enter(lane, &v, size, BITS_V);
        self.travel_slope_u[lane] = u.lowered_slope;
        self.node[lane] = 1;
        self.above[lane] = u64::MAX;
        self.near_child[lane] = (u.mirror & 1) | (v.mirror & 2);
        self.size[lane] = size;
        self.t[lane] = AT_TOP;
        self.ray[lane] = ray;
        self.entered[lane] = now;
    }

    /// Looks up the depth of every lane's node.
    #[inline(always)]
    fn fetch<D: Copy + Into<i32>>(&mut self, depths: &[D]) {
        // No lane with a ray reaches beyond the memory; the mask spares a lane without one.
        let mask = depths.len() - 1;
        for lane in 0..LANES {
            self.depth[lane] = depths[self.node[lane] as usize & mask].into();
        }
    }

    /// One step of every lane. `bottom` is what `above` is at level 0. The answer has a one for
    /// each lane whose walk has ended: at level 0, in the node one level up of what `node` says.
    ///
    /// A loop without a branch: both answers of every decision are computed. Whatever is chosen
    /// from is read from the registers first, and no register is written with a choice between its
    /// old value and another; else the compiler chooses between addresses, or stores under a mask.
    #[inline(always)]
    fn step(&mut self, bottom: u64) -> u64 {
        let mut hits = 0;
        for (lane, &lane_bit) in LANE_BITS.iter().enumerate() {
            let (size, t) = (self.size[lane], self.t[lane]);
            let (node, above) = (self.node[lane], self.above[lane]);
            let (way_u, way_v) = (self.u.way[lane], self.v.way[lane]);
            let (next_u, next_v) = (self.u.next_node[lane], self.v.next_node[lane]);
            let (slope_u, lowered_u) = (self.u.slope[lane], self.u.lowered_slope[lane]);
            let travel_slope_u = self.travel_slope_u[lane];
            let depth = f64::from(self.depth[lane]);

            // Where the ray leaves the node, and by which border.
            let exit_u = way_u * self.u.reciprocal[lane];
            let exit_v = way_v * self.v.reciprocal[lane];
            let u_first = exit_u <= exit_v;
            let exit = larger(select(u_first, exit_u, exit_v), t);

            // Down, or across? And how far.
            let down = depth <= exit;
            let reached = smaller(exit, larger(depth, t));
            self.t[lane] = reached;
            let travel_slope_u = select(t < reached, lowered_u, travel_slope_u);

            // Which child the ray is in.
            let half = 0.5 * size;
            let (midline_u, midline_v) = (way_u - half, way_v - half);
            let far_u = midline_u <= reached * travel_slope_u;
            let far_v = midline_v <= reached * self.v.lowered_slope[lane];

            self.u.way[lane] = select(
                down,
                select(far_u, way_u, midline_u),
                select(u_first, way_u + size, way_u),
            );
            self.v.way[lane] = select(
                down,
                select(far_v, way_v, midline_v),
                select(u_first, way_v, way_v + size),
            );
            // Halved by the exponent.
            self.size[lane] = f64::from_bits(size.to_bits().wrapping_sub(select(down, 1 << 52, 0)));
            self.travel_slope_u[lane] =
                select(down, travel_slope_u, select(u_first, lowered_u, slope_u));

            let far = select(far_u, 1, 0) ^ select(far_v, 2, 0);
            let child = (node << 2) ^ far ^ self.near_child[lane];
            let kept = above | select(u_first, BITS_V, BITS_U);
            let neighbour = step_by(node, kept, select(u_first, next_u, next_v));
            self.node[lane] = select(down, child, neighbour);
            self.above[lane] = above << select(down, 2, 0);

            hits |= select(down & (above == bottom), lane_bit, 0);
        }
        hits
    }
}

/// A packet over a pyramid whose root is at this level.
pub(super) struct NodeWalks {
    pub(super) packet: Packet,
    pub(super) root_level: u32,
}

impl Walks for NodeWalks {
    #[inline(always)]
    fn enter(&mut self, lane: usize, ray: (usize, AxisEntry, AxisEntry), now: u32) {
        let size = f64::from(1_u32 << self.root_level);
        self.packet.enter(lane, ray, size, now);
    }

    #[inline(always)]
    fn step<D: Copy + Into<i32>>(&mut self, depths: &[D], live: u64) -> u64 {
        self.packet.fetch(depths);
        let bottom = (1_u64 << (2 * self.root_level)).wrapping_neg();
        self.packet.step(bottom) & live
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
    fn ended(&self, lane: usize, now: u32) -> Ended {
        let packet = &self.packet;
        let steps = now.wrapping_sub(packet.entered[lane]);
        Ended {
            ray: packet.ray[lane],
            steps,
            // The others went down: to each level below the root, and to the surface.
            crossings: steps - (self.root_level + 1),
            texel: packet.node[lane] >> 2,
            t: packet.t[lane],
            crossed_v: packet.travel_slope_u[lane] == packet.u.slope[lane],
            u: packet.u.ended(lane, BITS_U),
            v: packet.v.ended(lane, BITS_V),
        }
    }

    #[inline(always)]
    fn texel(place: u64, size: u32) -> (u32, u32) {
        (index_of(place, size), index_of(place >> 1, size))
    }
}
