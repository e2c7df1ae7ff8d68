//! A list of rays through one packet: a lane whose ray has ended takes the next one at once.

use super::answer::Answers;
use super::entry::{Entrance, Factors};
use super::lanes::{LANES, Packet};
use crate::instruction_set::Work;
use crate::ray::Ray;
use crate::units::fixed_shape::FixedShape;
use crate::units::traverse::Hit;

/// Steps between two looks for walks that do not end.
const STEPS_BETWEEN_CHECKS: u32 = 4096;

/// Walks the rays, and writes the hit of each into its place; the answer names those it has not
/// walked.
pub(super) struct WalkRays<'a, D> {
    pub(super) shape: FixedShape,
    pub(super) factors: Factors,
    /// In Z order.
    pub(super) depths: &'a [D],
    pub(super) rays: &'a [Ray<f64>],
    pub(super) hits: &'a mut [Hit<f64>],
}

impl<D: Copy + Into<i32>> Work for WalkRays<'_, D> {
    type Output = Vec<usize>;

    #[inline(always)]
    fn run(self) -> Vec<usize> {
        let bottom = (1_u64 << (2 * self.shape.root_level)).wrapping_neg();
        let size = f64::from(self.shape.size());
        let mut entrance = Entrance::new(self.shape, self.factors, self.rays);
        let mut packet = Packet::IDLE;
        let mut answers = Answers::new(self.shape);
        // A one for each lane with a ray.
        let mut live = 0_u64;
        let mut now = 0_u32;
        for lane in 0..LANES {
            if let Some(ray) = entrance.next() {
                packet.enter(lane, ray, size, now);
                live |= 1 << lane;
            }
        }
        while live != 0 {
            packet.fetch(self.depths);
            let mut ended = packet.step(bottom) & live;
            now = now.wrapping_add(1);
            if now.is_multiple_of(STEPS_BETWEEN_CHECKS) {
                ended |= packet.overdue(self.shape, now) & live;
            }
            while ended != 0 {
                let lane = ended.trailing_zeros() as usize % LANES;
                ended &= ended - 1;
                let ray = packet.ray[lane];
                let steps = now.wrapping_sub(packet.entered[lane]);
                if steps > self.shape.step_bound(false) {
                    entrance.leave_over(ray);
                } else {
                    let ended = packet.ended(lane, steps, self.shape.root_level);
                    answers.add(&ended, self.hits);
                }
                if let Some(ray) = entrance.next() {
                    packet.enter(lane, ray, size, now);
                } else {
                    live &= !(1 << lane);
                }
            }
        }
        answers.give(self.hits);
        entrance.into_left_over()
    }
}

impl Packet {
    /// The lanes whose walks are past the step bound: a one for each. No ray within reach gets there.
    #[cold]
    fn overdue(&self, shape: FixedShape, now: u32) -> u64 {
        (0..LANES)
            .filter(|&lane| now.wrapping_sub(self.entered[lane]) > shape.step_bound(false))
            .fold(0, |lanes, lane| lanes | 1 << lane)
    }
}
