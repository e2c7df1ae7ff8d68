//! Walks of the cases, and what is said of them.

use super::HardCase;
use crate::frame::{WalkRaysError, walk_rays};
use crate::judge::{JudgeError, Judgement, Truth};
use crate::maps::Pyramid;
use crate::scene::{Crossing, Method, Walk, WalkFormat};
use crate::units::traverse::Hit;
use crate::walker::Walker;

/// What a walk promises of every ray that it lets in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Promise {
    /// The very texel of the exact hit of the ray as the format holds it.
    VeryTexel,
    /// No hit later than the exact one; another texel only where the ray just misses it.
    NeverLate,
    /// That it ends at a hit. A tie may be lost by rounding: `f64` has no bounds of its errors.
    Ends,
    /// Nothing: methods that sample, crossings by an offset, and floats whose exponents do not
    /// reach down to the depths that a map of this size needs.
    Nothing,
}

impl Promise {
    /// Of a walk on a map of `2^levels` texels a side.
    pub fn of(walk: Walk, levels: u32) -> Promise {
        if !walk.method.is_safe() || walk.crossing != Crossing::Index {
            return Promise::Nothing;
        }
        match walk.format {
            WalkFormat::Exact | WalkFormat::Fixed(_) => Promise::VeryTexel,
            WalkFormat::F64 => Promise::Ends,
            WalkFormat::Float(format) => {
                // The argument of docs/architecture.md: no depth other than zero may flush to zero.
                let bias = (1_u32 << (format.exponent_bits - 1)) - 1;
                if bias >= levels + format.fraction_bits + 2 {
                    Promise::NeverLate
                } else {
                    Promise::Nothing
                }
            }
        }
    }

    /// Does a hit of this kind break the promise?
    pub fn is_broken_by(self, judgement: Judgement) -> bool {
        match self {
            Promise::VeryTexel => judgement != Judgement::Right,
            Promise::NeverLate => matches!(judgement, Judgement::Late | Judgement::Guard),
            Promise::Ends => judgement == Judgement::Guard,
            Promise::Nothing => false,
        }
    }

    /// In a word or two.
    pub const fn name(self) -> &'static str {
        match self {
            Promise::VeryTexel => "very texel",
            Promise::NeverLate => "never late",
            Promise::Ends => "ends",
            Promise::Nothing => "nothing",
        }
    }
}

/// A case with what does not depend on the method: its pyramid, and what its rays meet as a format
/// holds them.
#[derive(Debug)]
pub struct PreparedCase<'a> {
    /// The case.
    pub case: &'a HardCase,
    pyramid: Pyramid,
    truth: Truth,
    /// The place in the case of each ray that the format lets in.
    admitted: Vec<usize>,
}

/// What came of a walk over a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Assessment {
    /// What is promised.
    pub promise: Promise,
    /// What is said of each ray of the case; none where the format or the unit refuses it.
    pub judgements: Vec<Option<Judgement>>,
    /// What the walk answered for each; none where it was refused.
    pub hits: Vec<Option<Hit<f64>>>,
}

impl Assessment {
    /// How many rays are so judged.
    pub fn count(&self, judgement: Judgement) -> u64 {
        let all = self.judgements.iter();
        all.filter(|&&own| own == Some(judgement)).count() as u64
    }

    /// How many rays are refused.
    pub fn refused(&self) -> u64 {
        self.judgements.iter().filter(|own| own.is_none()).count() as u64
    }

    /// Rays that were walked.
    pub fn walked(&self) -> u64 {
        self.judgements.len() as u64 - self.refused()
    }

    /// Steps of all rays.
    pub fn steps(&self) -> u64 {
        self.hits
            .iter()
            .flatten()
            .map(|hit| u64::from(hit.steps))
            .sum()
    }

    /// Is every ray that was walked right, and was there one?
    pub fn has_passed(&self) -> bool {
        self.walked() > 0 && self.count(Judgement::Right) == self.walked()
    }

    /// The rays that break the promise, by their place in the case.
    pub fn defects(&self) -> impl Iterator<Item = (usize, Judgement)> {
        let judged = self.judgements.iter().enumerate();
        judged.filter_map(|(at, &own)| {
            Some((at, own?)).filter(|&(_, own)| self.promise.is_broken_by(own))
        })
    }
}

impl<'a> PreparedCase<'a> {
    /// Works out what the rays meet as `format` holds them.
    ///
    /// # Errors
    /// A format that nothing is walked in; a ray that the exact reference does not take.
    pub fn new(case: &'a HardCase, format: WalkFormat) -> Result<PreparedCase<'a>, JudgeError> {
        let pyramid = Pyramid::new(&case.map);
        let rays: Vec<_> = case.rays.iter().map(|ray| ray.ray).collect();
        let truth = Truth::of(format, &case.map, &pyramid, &rays, &|_| ())?;
        // The truth leaves refused rays out, in order: the same question tells which.
        let any = Walk {
            method: Method::Oh,
            format,
            crossing: Crossing::Index,
        };
        let walker = Walker::new(any, &pyramid)?;
        let admitted = rays
            .iter()
            .enumerate()
            .filter(|&(_, &ray)| walker.admit(ray).is_ok());
        let admitted = admitted.map(|(at, _)| at).collect();
        Ok(PreparedCase {
            case,
            pyramid,
            truth,
            admitted,
        })
    }

    /// Walks the rays and judges each.
    ///
    /// # Errors
    /// [`JudgeError::Walk`]: a method that does not go with the format or the crossing, or not with
    /// a list of rays.
    pub fn assess(&self, method: Method, crossing: Crossing) -> Result<Assessment, JudgeError> {
        let walk = Walk {
            method,
            format: self.truth.format(),
            crossing,
        };
        let hits = walk_rays(walk, &self.pyramid, self.truth.rays(), &|_| ());
        let hits = hits.map_err(|problem| match problem {
            WalkRaysError::Walk(problem) => JudgeError::Walk(problem),
            rays => JudgeError::Rays(rays),
        })?;
        let rays = self.case.rays.len();
        let (mut judgements, mut answers) = (vec![None; rays], vec![None; rays]);
        let judged = hits.iter().zip(self.truth.hits());
        for (&at, (hit, truth)) in self.admitted.iter().zip(judged) {
            judgements[at] = Some(Judgement::of(hit, truth, walk.format));
            answers[at] = Some(*hit);
        }
        Ok(Assessment {
            promise: Promise::of(walk, self.pyramid.levels()),
            judgements,
            hits: answers,
        })
    }
}
