//! A corner in doubt, walked by one lane alone: the two crossings around it, and what lies between.
//! It is rare, a ray in some hundreds, so the packet's step does without its registers.

use super::lanes::{ExitBounds, Packet};
use super::node::{BITS_U, BITS_V, backward, onward, step_by};
use super::number::{ULP, larger, raise, smaller, truncate};

impl Packet {
    /// Takes a lane that has just crossed a border beside a corner in doubt round that corner. Where
    /// it hits something on the way the answer is true, and the lane as [`Packet::step`] leaves one.
    #[cold]
    #[inline(never)]
    pub(super) fn walk_corner(
        &mut self,
        lane: usize,
        depths: &[f32],
        bottom: u64,
        bounds: ExitBounds,
    ) -> bool {
        let (u, v) = (&mut self.u, &mut self.v);
        let (next_u, next_v) = (u.next_node[lane], v.next_node[lane]);
        let (mut border_u, mut border_v) = (u.border_distance[lane], v.border_distance[lane]);
        let (mut node, mut above) = (self.node[lane], self.above[lane]);
        let (mut size, mut t) = (self.size[lane], self.t[lane]);
        // At a corner in doubt u is crossed first. The step's margin tells what it has crossed.
        let crossed_v = self.tie_margin[lane] == 0;
        if crossed_v {
            node = step_by(node, above | BITS_U, opposite(next_v, BITS_V));
            border_v -= size;
            node = step_by(node, above | BITS_V, next_u);
            border_u += size;
        }
        // First the node across the corner is owed a visit; then, while it is paid, the next
        // crossing goes behind the corner.
        let mut owed = true;
        let mut steps = 0_u32;
        let hit = loop {
            steps += 1;
            let depth = f64::from(depths[node as usize & (depths.len() - 1)]);
            let (distance_u, distance_v) = (truncate(border_u), truncate(border_v));
            let exit_u = truncate(distance_u * u.reciprocal[lane]);
            let exit_v = truncate(distance_v * v.reciprocal[lane]);
            let (exit_depth, is_exact) = if exit_u <= exit_v {
                (exit_u, distance_u < u.exact_below[lane])
            } else {
                (exit_v, distance_v < v.exact_below[lane])
            };
            let exit_bound = raise(
                exit_depth,
                if is_exact {
                    bounds.exact
                } else {
                    bounds.rounded
                },
            );
            let down = depth <= t || depth <= exit_bound;
            t = larger(smaller(exit_depth, depth), t);
            if down {
                let half = 0.5 * size;
                // The child at the corner: before it the near one on u and the far one on v, and across
                // it the other way round.
                let (far_u, far_v) = (!owed, owed);
                if !far_u {
                    border_u -= half;
                }
                if !far_v {
                    border_v -= half;
                }
                let far = u64::from(far_u) | (u64::from(far_v) << 1);
                node = (node << 2) ^ far ^ self.near_child[lane];
                if above == bottom {
                    break true;
                }
                above <<= 2;
                size = half;
            } else if owed {
                node = step_by(node, above | BITS_V, opposite(next_u, BITS_U));
                node = step_by(node, above | BITS_U, next_v);
                border_u -= size;
                border_v += size;
                owed = false;
            } else {
                node = step_by(node, above | BITS_V, next_u);
                border_u += size;
                break false;
            }
        };
        u.border_distance[lane] = border_u;
        v.border_distance[lane] = border_v;
        self.node[lane] = node;
        self.above[lane] = above;
        self.size[lane] = size;
        self.t[lane] = t;
        // The last crossing was one of u.
        self.tie_margin[lane] = ULP;
        // The packet has not counted these steps.
        self.entered[lane] = self.entered[lane].wrapping_sub(steps);
        hit
    }
}

/// What takes back a step of [`step_by`] on this axis.
fn opposite(amount: u64, axis: u64) -> u64 {
    if amount == onward(axis) {
        backward(axis)
    } else {
        onward(axis)
    }
}
