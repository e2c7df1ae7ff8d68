//! A list of rays through one packet: a lane whose ray has ended takes the next one at once.

use super::entry::Entrance;
use super::lanes::{ExitBounds, LANES, Packet};
use super::node::{BITS_U, BITS_V, index_of};
use super::number::{flush, round_to_nearest, select, truncate};
use crate::instruction_set::Work;
use crate::ray::Ray;
use crate::units::search_policy::SearchPolicy;
use crate::units::traverse::{Hit, Status};
use crate::units::traverse_step::TraverseShape;

/// Steps between two looks for walks that do not end.
const STEPS_BETWEEN_CHECKS: u32 = 4096;

/// Walks the rays, and writes the hit of each into its place; the answer names those it has not
/// walked.
pub(super) struct WalkRays<'a> {
    pub(super) shape: TraverseShape,
    /// In Z order.
    pub(super) depths: &'a [f32],
    pub(super) bounds: ExitBounds,
    pub(super) rays: &'a [Ray<f64>],
    pub(super) hits: &'a mut [Hit<f64>],
}

impl Work for WalkRays<'_> {
    type Output = Vec<usize>;

    #[inline(always)]
    fn run(self) -> Vec<usize> {
        let bottom = (1_u64 << (2 * self.shape.root_level)).wrapping_neg();
        let mut entrance = Entrance::new(self.rays);
        let mut packet = Packet::IDLE;
        // A one for each lane with a ray.
        let mut live = 0_u64;
        let mut now = 0_u32;
        for lane in 0..LANES {
            if let Some(ray) = entrance.next() {
                packet.enter(lane, ray, now);
                live |= 1 << lane;
            }
        }
        while live != 0 {
            packet.fetch(self.depths);
            let events = packet.step(bottom, self.bounds);
            now = now.wrapping_add(1);
            let mut ended = events.hits & live;
            let mut corners = events.corners & live;
            while corners != 0 {
                let lane = corners.trailing_zeros() as usize % LANES;
                corners &= corners - 1;
                if packet.walk_corner(lane, self.depths, bottom, self.bounds) {
                    ended |= 1 << lane;
                }
            }
            if now.is_multiple_of(STEPS_BETWEEN_CHECKS) {
                ended |= packet.overdue(self.shape, now) & live;
            }
            while ended != 0 {
                let lane = ended.trailing_zeros() as usize % LANES;
                ended &= ended - 1;
                let ray = packet.ray[lane];
                let steps = now.wrapping_sub(packet.entered[lane]);
                if steps > self.shape.step_bound(SearchPolicy::OH) {
                    entrance.leave_over(ray);
                } else {
                    self.hits[ray] = packet.hit(lane, self.shape, steps);
                }
                if let Some(ray) = entrance.next() {
                    packet.enter(lane, ray, now);
                } else {
                    live &= !(1 << lane);
                }
            }
        }
        entrance.into_left_over()
    }
}

impl Packet {
    /// The lanes whose walks are past the step bound: a one for each. No ray within reach gets there.
    #[cold]
    fn overdue(&self, shape: TraverseShape, now: u32) -> u64 {
        (0..LANES)
            .filter(|&lane| {
                now.wrapping_sub(self.entered[lane]) > shape.step_bound(SearchPolicy::OH)
            })
            .fold(0, |lanes, lane| lanes | 1 << lane)
    }

    /// The hit of a lane that has just ended.
    #[inline(always)]
    fn hit(&self, lane: usize, shape: TraverseShape, steps: u32) -> Hit<f64> {
        let node = self.node[lane] >> 2;
        let t = self.t[lane];
        let position = |coordinate: f64, direction: f64, mirrored: bool| {
            // Two numbers of 17 bits: the sum in f64 is exact, or so near the larger of them that
            // it rounds as the true one does.
            let sum = coordinate + flush(truncate(t * direction));
            let sum = round_to_nearest(sum);
            select(mirrored, -sum, sum)
        };
        let (u, v) = (&self.u, &self.v);
        Hit {
            i: index_of(node, shape.size()),
            j: index_of(node >> 1, shape.size()),
            t,
            u: position(
                u.coordinate[lane],
                u.direction[lane],
                u.is_mirrored(lane, BITS_U),
            ),
            v: position(
                v.coordinate[lane],
                v.direction[lane],
                v.is_mirrored(lane, BITS_V),
            ),
            steps,
            // The others went down: to each level below the root, and to the surface.
            crossings: steps - (shape.root_level + 1),
            status: Status::Hit,
        }
    }
}
