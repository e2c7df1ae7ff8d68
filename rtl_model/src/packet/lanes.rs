//! A packet: the registers of many walks side by side, and one step of all of them.

use super::entry::AxisEntry;
use super::node::{BITS_U, BITS_V, backward, onward, step_by};
use super::number::{ULP, larger, raise, select, smaller, truncate};
use crate::units::traverse_step::{EXACT_EXIT_ULPS, ROUNDED_EXIT_ULPS};

/// Rays of a packet: eight vectors of four numbers.
pub(super) const LANES: usize = 32;

/// How far above an exit depth its upper bound lies, in steps of an `f64` pattern.
#[derive(Clone, Copy, Debug)]
pub(super) struct ExitBounds {
    /// Where the distance is exact.
    pub(super) exact: u64,
    /// Where it may have been truncated.
    pub(super) rounded: u64,
}

impl ExitBounds {
    /// The definition's.
    pub(super) const DEFINED: ExitBounds = ExitBounds {
        exact: EXACT_EXIT_ULPS as u64 * ULP,
        rounded: ROUNDED_EXIT_ULPS as u64 * ULP,
    };
}

/// A one for each lane.
const LANE_BITS: [u64; LANES] = {
    let mut bits = [0; LANES];
    let mut lane = 0;
    while lane < LANES {
        bits[lane] = 1 << lane;
        lane += 1;
    }
    bits
};

/// What the lanes have on one axis.
pub(super) struct AxisLanes {
    pub(super) direction: [f64; LANES],
    pub(super) reciprocal: [f64; LANES],
    pub(super) exact_below: [f64; LANES],
    /// From the entry coordinate to the node's far border. It stands for the node's index: going to
    /// the next node adds the node's size to it, taking the near child takes half of that away.
    pub(super) border_distance: [f64; LANES],
    /// What [`step_by`] adds for the next node.
    pub(super) next_node: [u64; LANES],
    pub(super) coordinate: [f64; LANES],
}

impl AxisLanes {
    const IDLE: AxisLanes = AxisLanes {
        direction: [0.0; LANES],
        reciprocal: [1.0; LANES],
        exact_below: [1.0; LANES],
        border_distance: [1.0; LANES],
        next_node: [0; LANES],
        coordinate: [0.0; LANES],
    };

    #[inline(always)]
    fn enter(&mut self, lane: usize, axis: &AxisEntry, bits: u64) {
        let coordinate = axis.coordinate;
        self.direction[lane] = axis.direction;
        self.reciprocal[lane] = axis.reciprocal;
        self.exact_below[lane] = axis.exact_below;
        // Root node 0, or -1 where a mirrored coordinate lies below zero: its far border is 0 then.
        self.border_distance[lane] = select(coordinate < 0.0, -coordinate, 1.0 - coordinate);
        self.next_node[lane] = select(axis.mirror == 0, onward(bits), backward(bits));
        self.coordinate[lane] = coordinate;
    }

    #[inline(always)]
    pub(super) fn is_mirrored(&self, lane: usize, bits: u64) -> bool {
        self.next_node[lane] == backward(bits)
    }
}

/// The walks of a packet. What a lane holds that has no ray is of no account.
#[repr(align(64))]
pub(super) struct Packet {
    pub(super) u: AxisLanes,
    pub(super) v: AxisLanes,
    /// The node looked at, in Z order; its index is mirrored back to the map's.
    pub(super) node: [u64; LANES],
    /// Ones from the node's leading one upwards: minus 4 to the power of the levels below the root.
    pub(super) above: [u64; LANES],
    /// In a near child, its index on the map ends in these bits: ones where an axis is mirrored.
    pub(super) near_child: [u64; LANES],
    /// Side of the node.
    pub(super) size: [f64; LANES],
    /// Depth reached.
    pub(super) t: [f64; LANES],
    /// What is taken off the distance travelled on u before it is held against the midline's: one
    /// unit in the last place, or nothing where t is that of a crossing of v.
    pub(super) tie_margin: [u64; LANES],
    /// The node's depth.
    pub(super) depth: [f32; LANES],
    /// The ray's place in the list.
    pub(super) ray: [usize; LANES],
    /// The packet's step count when the ray entered.
    pub(super) entered: [u32; LANES],
}

/// What became of the lanes in a step: a one for each lane.
pub(super) struct Events {
    /// The walk has ended in a hit: at level 0, in the node one level up of what `node` says.
    pub(super) hits: u64,
    /// A border was crossed beside a corner that is in doubt.
    pub(super) corners: u64,
}

impl Packet {
    /// A packet without rays.
    pub(super) const IDLE: Packet = Packet {
        u: AxisLanes::IDLE,
        v: AxisLanes::IDLE,
        node: [1; LANES],
        above: [u64::MAX; LANES],
        near_child: [0; LANES],
        size: [1.0; LANES],
        t: [0.0; LANES],
        tie_margin: [ULP; LANES],
        depth: [0.0; LANES],
        ray: [0; LANES],
        entered: [0; LANES],
    };

    /// Puts a ray into a lane, at the root.
    #[inline(always)]
    pub(super) fn enter(
        &mut self,
        lane: usize,
        (ray, u, v): (usize, AxisEntry, AxisEntry),
        now: u32,
    ) {
        self.u.enter(lane, &u, BITS_U);
        self.v.enter(lane, &v, BITS_V);
        self.node[lane] = 1;
        self.above[lane] = u64::MAX;
        self.near_child[lane] = (u.mirror & 1) | (v.mirror & 2);
        self.size[lane] = 1.0;
        self.t[lane] = 0.0;
        self.tie_margin[lane] = ULP;
        self.ray[lane] = ray;
        self.entered[lane] = now;
    }

    /// Looks up the depth of every lane's node.
    #[inline(always)]
    pub(super) fn fetch(&mut self, depths: &[f32]) {
        // No lane with a ray reaches beyond the memory; the mask spares a lane without one.
        let mask = depths.len() - 1;
        for lane in 0..LANES {
            self.depth[lane] = depths[self.node[lane] as usize & mask];
        }
    }

    /// One step of every lane. `bottom` is what `above` is at level 0.
    ///
    /// A loop without a branch: both answers of every decision are computed. Whatever is chosen
    /// from is read from the registers first, and no register is written with a choice between its
    /// old value and another; else the compiler chooses between addresses, or stores under a mask,
    /// and either is slower than the whole rest.
    #[inline(always)]
    pub(super) fn step(&mut self, bottom: u64, bounds: ExitBounds) -> Events {
        let mut hits = 0;
        let mut corners = 0;
        for (lane, lane_bit) in LANE_BITS.into_iter().enumerate() {
            let (size, t) = (self.size[lane], self.t[lane]);
            let (node, above) = (self.node[lane], self.above[lane]);
            let (border_u, border_v) = (self.u.border_distance[lane], self.v.border_distance[lane]);
            let (exact_below_u, exact_below_v) =
                (self.u.exact_below[lane], self.v.exact_below[lane]);
            let (next_u, next_v) = (self.u.next_node[lane], self.v.next_node[lane]);
            let tie_margin = self.tie_margin[lane];
            let depth = f64::from(self.depth[lane]);

            // Where the ray leaves the node, and by which border.
            let (distance_u, distance_v) = (truncate(border_u), truncate(border_v));
            let exit_u = truncate(distance_u * self.u.reciprocal[lane]);
            let exit_v = truncate(distance_v * self.v.reciprocal[lane]);
            let u_first = exit_u <= exit_v;
            let exit_depth = select(u_first, exit_u, exit_v);
            let later_exit = select(u_first, exit_v, exit_u);
            let is_exact = select(u_first, distance_u, distance_v)
                < select(u_first, exact_below_u, exact_below_v);
            let exit_bound = raise(exit_depth, select(is_exact, bounds.exact, bounds.rounded));
            let corner_in_doubt = later_exit < exit_bound;

            // Down, or across? And how far.
            let down = depth <= larger(t, exit_bound);
            let reached = smaller(larger(exit_depth, t), larger(depth, t));
            self.t[lane] = reached;
            let tie_margin = select(t < reached, ULP, tie_margin);

            // Which child the ray is in.
            let travelled_u = truncate(reached * self.u.direction[lane]);
            let travelled_v = truncate(reached * self.v.direction[lane]);
            let before_u = f64::from_bits(travelled_u.to_bits().wrapping_sub(tie_margin));
            let before_v = f64::from_bits(travelled_v.to_bits().wrapping_sub(ULP));
            let half = 0.5 * size;
            let (midline_u, midline_v) = (border_u - half, border_v - half);
            let far_u = midline_u <= larger(before_u, 0.0);
            let far_v = midline_v <= larger(before_v, 0.0);

            self.u.border_distance[lane] = select(
                down,
                select(far_u, border_u, midline_u),
                select(u_first, border_u + size, border_u),
            );
            self.v.border_distance[lane] = select(
                down,
                select(far_v, border_v, midline_v),
                select(u_first, border_v, border_v + size),
            );
            // Halved by the exponent.
            self.size[lane] = f64::from_bits(size.to_bits().wrapping_sub(select(down, 1 << 52, 0)));
            self.tie_margin[lane] = select(down, tie_margin, select(u_first, ULP, 0));

            let far = select(far_u, 1, 0) ^ select(far_v, 2, 0);
            let child = (node << 2) ^ far ^ self.near_child[lane];
            let kept = above | select(u_first, BITS_V, BITS_U);
            let neighbour = step_by(node, kept, select(u_first, next_u, next_v));
            self.node[lane] = select(down, child, neighbour);
            self.above[lane] = above << select(down, 2, 0);

            hits |= select(down & (above == bottom), lane_bit, 0);
            corners |= select(!down & corner_in_doubt, lane_bit, 0);
        }
        Events { hits, corners }
    }
}
