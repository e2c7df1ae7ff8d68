//! A list of rays through one packet: a lane whose ray has ended takes the next one at once.

use super::answer::{Answers, Ended};
use super::entry::{AxisEntry, Entrance, Factors};
use super::lanes::LANES;
use crate::instruction_set::Work;
use crate::ray::Ray;
use crate::units::fixed_shape::FixedShape;
use crate::units::traverse::Hit;

/// Steps between two looks for walks that do not end.
const STEPS_BETWEEN_CHECKS: u32 = 4096;

/// Walks side by side, one to a lane.
pub(super) trait Walks {
    /// Puts a ray into a lane: its place in the list, its axes, and the count of steps so far.
    fn enter(&mut self, lane: usize, ray: (usize, AxisEntry, AxisEntry), now: u32);
    /// One step of every lane. The answer has a one for each live lane whose walk has ended in a hit.
    fn step<D: Copy + Into<i32>>(&mut self, depths: &[D], live: u64) -> u64;
    /// The place of the lane's ray in the list.
    fn ray(&self, lane: usize) -> usize;
    /// The count of steps when the lane's ray entered.
    fn entered(&self, lane: usize) -> u32;
    /// The walk of a lane that has just ended.
    fn ended(&self, lane: usize, now: u32) -> Ended;
    /// Which texel a place in their order is, on u and on v.
    fn texel(place: u64, size: u32) -> (u32, u32);
}

/// Walks the rays, and writes the hit of each into its place; the answer names those it has not
/// walked.
pub(super) struct WalkRays<'a, W, D> {
    pub(super) shape: FixedShape,
    pub(super) factors: Factors,
    /// Idle ones.
    pub(super) walks: W,
    /// In the order of the walks.
    pub(super) depths: &'a [D],
    /// More steps than a walk takes.
    pub(super) step_bound: u32,
    pub(super) rays: &'a [Ray<f64>],
    pub(super) hits: &'a mut [Hit<f64>],
}

impl<W: Walks, D: Copy + Into<i32>> Work for WalkRays<'_, W, D> {
    type Output = Vec<usize>;

    #[inline(always)]
    fn run(self) -> Vec<usize> {
        let mut entrance = Entrance::new(self.shape, self.factors, self.rays);
        let mut walks = self.walks;
        let mut answers = Answers::new(self.shape, W::texel);
        // A one for each lane with a ray.
        let mut live = 0_u64;
        let mut now = 0_u32;
        for lane in 0..LANES {
            if let Some(ray) = entrance.next() {
                walks.enter(lane, ray, now);
                live |= 1 << lane;
            }
        }
        while live != 0 {
            let mut ended = walks.step(self.depths, live);
            now = now.wrapping_add(1);
            if now.is_multiple_of(STEPS_BETWEEN_CHECKS) {
                ended |= overdue(&walks, self.step_bound, now) & live;
            }
            while ended != 0 {
                let lane = ended.trailing_zeros() as usize % LANES;
                ended &= ended - 1;
                if now.wrapping_sub(walks.entered(lane)) > self.step_bound {
                    entrance.leave_over(walks.ray(lane));
                } else {
                    answers.add(&walks.ended(lane, now), self.hits);
                }
                if let Some(ray) = entrance.next() {
                    walks.enter(lane, ray, now);
                } else {
                    live &= !(1 << lane);
                }
            }
        }
        answers.give(self.hits);
        entrance.into_left_over()
    }
}

/// The lanes whose walks are past the step bound: a one for each. No ray within reach gets there.
#[cold]
fn overdue<W: Walks>(walks: &W, step_bound: u32, now: u32) -> u64 {
    (0..LANES)
        .filter(|&lane| now.wrapping_sub(walks.entered(lane)) > step_bound)
        .fold(0, |lanes, lane| lanes | 1 << lane)
}
