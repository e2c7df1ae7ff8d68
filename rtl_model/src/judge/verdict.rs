//! What is said of a hit, and of many.

use crate::frame::Counts;
use crate::scene::WalkFormat;
use crate::units::traverse::{Hit, Status};

use super::TrueHit;

/// What is said of one hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Judgement {
    /// The very texel, and not later than the exact hit.
    Right,
    /// Another texel, not later than the exact hit: one that the ray only just misses, if the walk
    /// is sound.
    Early,
    /// Later than the exact hit, in whatever texel: the walk went past the surface.
    Late,
    /// The walk ended at its step bound.
    Guard,
}

/// What is said of the hits of many rays.
///
/// `rays` is the sum of `right`, `early`, `late` and `guards`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Verdict {
    /// Rays judged.
    pub rays: u64,
    /// Hits that are [`Judgement::Right`].
    pub right: u64,
    /// Hits that are [`Judgement::Early`].
    pub early: u64,
    /// Hits that are [`Judgement::Late`]: false misses.
    pub late: u64,
    /// Walks that are [`Judgement::Guard`]: they hang.
    pub guards: u64,
    /// Hits in another texel than the exact one, early or late. Guards are no hits.
    pub wrong: u64,
    /// How much earlier than the exact hit the earliest hit is, in depth, 0 to 1: of the rays that
    /// are right or early.
    pub most_early: f64,
    /// Steps of all rays.
    pub steps: u64,
    /// Steps of the ray that took most.
    pub most_steps: u32,
    /// Node crossings of all rays.
    pub crossings: u64,
}

impl Judgement {
    /// Of a hit beside the true one of the same ray in the same format.
    pub fn of(hit: &Hit<f64>, truth: &TrueHit, format: WalkFormat) -> Judgement {
        if hit.status == Status::Guard {
            Judgement::Guard
        } else if hit.t.is_nan() || hit.t > truth.latest_in(format) {
            Judgement::Late
        } else if (hit.i, hit.j) == (truth.i, truth.j) {
            Judgement::Right
        } else {
            Judgement::Early
        }
    }
}

impl Verdict {
    /// Takes one more hit into account.
    pub(super) fn add(&mut self, hit: &Hit<f64>, truth: &TrueHit, format: WalkFormat) {
        let judgement = Judgement::of(hit, truth, format);
        match judgement {
            Judgement::Right => self.right += 1,
            Judgement::Early => self.early += 1,
            Judgement::Late => self.late += 1,
            Judgement::Guard => self.guards += 1,
        }
        self.rays += 1;
        if judgement != Judgement::Guard {
            self.wrong += u64::from((hit.i, hit.j) != (truth.i, truth.j));
        }
        if matches!(judgement, Judgement::Right | Judgement::Early) {
            self.most_early = self.most_early.max(truth.t_below - hit.t);
        }
        self.steps += u64::from(hit.steps);
        self.most_steps = self.most_steps.max(hit.steps);
        self.crossings += u64::from(hit.crossings);
    }

    /// Both together. All sums are of integers and the rest are maxima, so that the order of
    /// adding makes no difference.
    #[must_use]
    pub fn plus(self, other: Verdict) -> Verdict {
        Verdict {
            rays: self.rays + other.rays,
            right: self.right + other.right,
            early: self.early + other.early,
            late: self.late + other.late,
            guards: self.guards + other.guards,
            wrong: self.wrong + other.wrong,
            most_early: self.most_early.max(other.most_early),
            steps: self.steps + other.steps,
            most_steps: self.most_steps.max(other.most_steps),
            crossings: self.crossings + other.crossings,
        }
    }

    /// What walking cost.
    pub fn counts(&self) -> Counts {
        Counts {
            rays: self.rays,
            guards: self.guards,
            steps: self.steps,
            most_steps: self.most_steps,
            crossings: self.crossings,
        }
    }

    /// Steps of a ray in the mean; none where there are no rays.
    pub fn mean_steps(&self) -> Option<f64> {
        self.counts().mean_steps()
    }

    /// Node crossings of a ray in the mean; none where there are no rays.
    pub fn mean_crossings(&self) -> Option<f64> {
        self.counts().mean_crossings()
    }

    /// Crossings among the steps, 0 to 1: the crossing probability of the 2013 hardware paper's
    /// Table 2. None where there are no steps.
    pub fn crossing_share(&self) -> Option<f64> {
        (self.steps > 0).then(|| self.crossings as f64 / self.steps as f64)
    }

    /// Wrong texels among the rays, 0 to 1; none where there are no rays.
    pub fn wrong_share(&self) -> Option<f64> {
        (self.rays > 0).then(|| self.wrong as f64 / self.rays as f64)
    }
}
