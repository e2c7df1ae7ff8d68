//! Every ray of a small format through every map of a family, by every method, judged by the exact
//! reference.
//!
//! A world is a set of maps and a set of rays. Worlds are small enough that all of it is walked, and
//! made so that ties are the rule: eight heights whose depths are thirds and fifths, entries on
//! borders, corners and between, slopes that cross borders at thirds and fifths of the depth.

mod family;
mod maps;
mod rays;

pub use family::{FAMILY_TABLE, FamilyRow};
pub use maps::MapSet;
pub use rays::RaySet;

use std::time::{Duration, Instant};

use rayon::prelude::*;
use rtl_model::frame::walk_rays;
use rtl_model::hard::Promise;
use rtl_model::judge::{JudgeError, Judgement, Truth, Verdict};
use rtl_model::maps::{HeightMap, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::scene::{Crossing, Method, Walk, WalkFormat};
use rtl_model::units::traverse::Hit;
use rtl_model::walker::WalkerError;

use crate::sweep::SHOWN;

/// Maps and rays, all of which are walked together.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    /// The maps.
    pub maps: MapSet,
    /// The rays.
    pub rays: RaySet,
}

/// What came of a method in a world.
#[derive(Clone, Debug)]
pub struct MethodOutcome {
    /// The method.
    pub method: Method,
    /// Why it does not walk; then there is nothing else.
    pub unsupported: Option<&'static str>,
    /// What it promises on these maps.
    pub promise: Promise,
    /// All rays.
    pub verdict: Verdict,
    /// Rays that the format or the unit refuses.
    pub refused: u64,
    /// Rays that break the promise.
    pub defects: u64,
    /// The first of them.
    pub first: Vec<String>,
    /// Time of walking and judging, over all threads.
    pub duration: Duration,
}

/// Changes an answer before it is judged: how a test plants a fault.
pub type Alter<'a> = &'a (dyn Fn(Method, &Ray<f64>, Hit<f64>) -> Hit<f64> + Sync);

impl World {
    /// The name in tables: `all 2x2, rays of 4 bits`.
    pub fn name(&self) -> String {
        format!("{}, {}", self.maps.name(), self.rays.name())
    }

    /// Walks all rays through all maps, by each of `methods` in one format. `progress` is told of
    /// the maps done.
    ///
    /// # Errors
    /// A ray that the exact reference does not take.
    pub fn judge(
        &self,
        format: WalkFormat,
        methods: &[Method],
        progress: &(dyn Fn(u64) + Sync),
        alter: Alter<'_>,
    ) -> Result<Vec<MethodOutcome>, JudgeError> {
        let size = self.maps.size();
        let rays = self.rays.rays(size);
        let levels = size.trailing_zeros();
        let none = |&method| {
            let walk = Walk {
                method,
                format,
                crossing: Crossing::Index,
            };
            MethodOutcome {
                method,
                unsupported: None,
                promise: Promise::of(walk, levels),
                verdict: Verdict::default(),
                refused: 0,
                defects: 0,
                first: Vec::new(),
                duration: Duration::ZERO,
            }
        };
        let none: Vec<MethodOutcome> = methods.iter().map(none).collect();
        (0..self.maps.count())
            .into_par_iter()
            .map(|index| {
                let map = self.maps.map(index);
                let mut outcomes = none.clone();
                judge_map(&map, &rays, format, &mut outcomes, alter)?;
                progress(1);
                Ok(outcomes)
            })
            // Rayon keeps the order of what it reduces.
            .try_reduce(|| none.clone(), |left, right| Ok(both(left, right)))
    }
}

/// Outcomes of maps and of those after them.
fn both(left: Vec<MethodOutcome>, right: Vec<MethodOutcome>) -> Vec<MethodOutcome> {
    let pairs = left.into_iter().zip(right);
    let sum = |(mut left, right): (MethodOutcome, MethodOutcome)| {
        left.unsupported = left.unsupported.or(right.unsupported);
        left.verdict = left.verdict.plus(right.verdict);
        left.refused += right.refused;
        left.defects += right.defects;
        left.first.extend(right.first);
        left.first.truncate(SHOWN);
        left.duration += right.duration;
        left
    };
    pairs.map(sum).collect()
}

/// All rays through one map.
fn judge_map(
    map: &HeightMap,
    rays: &[Ray<f64>],
    format: WalkFormat,
    outcomes: &mut [MethodOutcome],
    alter: Alter<'_>,
) -> Result<(), JudgeError> {
    let pyramid = Pyramid::new(map);
    let truth = match Truth::of(format, map, &pyramid, rays, &|_| {}) {
        Err(JudgeError::Walk(WalkerError::Unsupported { why, .. })) => {
            for outcome in outcomes {
                outcome.unsupported = Some(why);
            }
            return Ok(());
        }
        truth => truth?,
    };
    for outcome in outcomes {
        let begin = Instant::now();
        let walk = Walk {
            method: outcome.method,
            format,
            crossing: Crossing::Index,
        };
        let mut hits = match walk_rays(walk, &pyramid, truth.rays(), &|_| {}) {
            Err(rtl_model::frame::WalkRaysError::Walk(WalkerError::Unsupported {
                why, ..
            })) => {
                outcome.unsupported = Some(why);
                continue;
            }
            hits => hits?,
        };
        for (hit, ray) in hits.iter_mut().zip(truth.rays()) {
            *hit = alter(outcome.method, ray, *hit);
        }
        outcome.verdict = truth.judge(&hits);
        outcome.refused = truth.refused();
        for ((hit, ray), true_hit) in hits.iter().zip(truth.rays()).zip(truth.hits()) {
            let judgement = Judgement::of(hit, true_hit, format);
            if outcome.promise.is_broken_by(judgement) {
                outcome.defects += 1;
                if outcome.first.len() < SHOWN {
                    outcome.first.push(format!(
                        "{} in {format}: {judgement:?} by {:?} heights {:?}: ({}, {}) at {:?}; it is ({}, {}) at {:?}",
                        outcome.method, ray, map.heights(), hit.i, hit.j, hit.t, true_hit.i, true_hit.j,
                        true_hit.t_below
                    ));
                }
            }
        }
        outcome.duration = begin.elapsed();
    }
    Ok(())
}
