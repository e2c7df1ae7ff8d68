//! What rays meet, worked out once.

use std::cmp::Ordering;

use rayon::prelude::*;
use thiserror::Error;

use crate::exact::{ExactDepth, ExactError, ExactHit, exact_hit};
use crate::frame::{Progress, WalkRaysError, fit_rays, walk_rays};
use crate::maps::{HeightMap, Pyramid};
use crate::ray::Ray;
use crate::scene::{Crossing, Method, Walk, WalkFormat};
use crate::units::traverse::Hit;
use crate::walker::{Walker, WalkerError};

use super::Verdict;

/// Rays that a thread takes at once.
const CHUNK: usize = 256;

/// *The* hit of a ray, its depth between two neighbouring `f64`.
///
/// A depth that is an `f64` is later than the true one if and only if it is above `t_below`: so
/// lateness is told exactly, though no rational is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrueHit {
    /// Texel on u, 0 to size - 1.
    pub i: u32,
    /// Texel on v, 0 to size - 1.
    pub j: u32,
    /// The largest `f64` that is not above the depth.
    pub t_below: f64,
    /// The smallest `f64` that is not below the depth; the same where an `f64` holds it.
    pub t_above: f64,
    /// Is it a hit on the texel's side? Else on its top.
    pub side: bool,
}

impl TrueHit {
    /// The greatest depth of an answer in this format that is not later than the hit.
    ///
    /// Floats of the hardware and fixed point promise not to be later by anything: it is `t_below`.
    /// In exact numbers the answer is the nearest `f64` of the true depth: `t_above`. In `f64`
    /// everything is rounded to nearest, as programs do, and a depth is a quotient of a difference:
    /// each loses up to half a unit in the last place of a significand, together less than two of
    /// the depth. What is later by no more is that rounding, and no surface is missed by it.
    pub fn latest_in(&self, format: WalkFormat) -> f64 {
        match format {
            WalkFormat::Float(_) | WalkFormat::Fixed(_) => self.t_below,
            WalkFormat::Exact => self.t_above,
            WalkFormat::F64 => self.t_above.next_up().next_up(),
        }
    }
}

impl From<ExactHit> for TrueHit {
    fn from(hit: ExactHit) -> TrueHit {
        let (t_below, t_above) = bracket(hit.t);
        TrueHit {
            i: hit.i,
            j: hit.j,
            t_below,
            t_above,
            side: hit.side,
        }
    }
}

/// The neighbouring `f64` that a depth lies between, or the one that it is.
fn bracket(depth: ExactDepth) -> (f64, f64) {
    // Two conversions and a division, each rounded: off by two units in the last place at most.
    let mut below = depth.to_f64();
    while depth.compare_with(below) == Ordering::Less {
        below = below.next_down();
    }
    loop {
        let above = below.next_up();
        match depth.compare_with(above) {
            Ordering::Less => break,
            Ordering::Equal | Ordering::Greater => below = above,
        }
    }
    match depth.compare_with(below) {
        Ordering::Equal => (below, below),
        _ => (below, below.next_up()),
    }
}

/// What a list of rays meets in a map, each ray as a number format holds it.
#[derive(Clone, Debug)]
pub struct Truth {
    format: WalkFormat,
    rays: Vec<Ray<f64>>,
    hits: Vec<TrueHit>,
    refused: u64,
}

/// Why rays cannot be judged.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum JudgeError {
    /// Method, format and crossing do not go together.
    #[error(transparent)]
    Walk(#[from] WalkerError),
    /// A ray that cannot be walked.
    #[error(transparent)]
    Rays(#[from] WalkRaysError),
    /// A ray beyond the exact reference.
    #[error("ray {index} (the first is 0), as {format} holds it: {problem}")]
    Exact {
        /// Its place in the list, from 0.
        index: usize,
        /// The format.
        format: WalkFormat,
        /// What is wrong with it.
        problem: ExactError,
    },
}

impl Truth {
    /// Works out what `rays` meet in `map`, whose pyramid is `pyramid`, as `format` holds them.
    /// Rays that the format or the unit refuses on this map are left out and counted. Progress is
    /// told in rays; time is that of walking texel by texel.
    ///
    /// # Errors
    /// A format that nothing is walked in, or a ray that the exact reference does not take.
    pub fn of(
        format: WalkFormat,
        map: &HeightMap,
        pyramid: &Pyramid,
        rays: &[Ray<f64>],
        progress: Progress<'_>,
    ) -> Result<Truth, JudgeError> {
        // How a ray enters depends on the format alone: any method tells.
        let mut any = Walk {
            method: Method::Oh,
            format,
            crossing: Crossing::Index,
        };
        if format == WalkFormat::Fixed(None) {
            // The format that all methods will choose from these rays, less those refused.
            let walker = Walker::new(any, pyramid)?;
            let admitted = rays.iter().filter_map(|&ray| walker.admit(ray).ok());
            any = fit_rays(any, pyramid, &admitted.collect::<Vec<_>>())?.walk;
        }
        let format = any.format;
        let chunks = rays.par_chunks(CHUNK).enumerate();
        let chunks: Vec<Vec<_>> = chunks
            .map(|(number, rays)| {
                let mut walker = Walker::new(any, pyramid)?;
                let mut answers = Vec::with_capacity(rays.len());
                for (offset, &ray) in rays.iter().enumerate() {
                    let Ok(ray) = walker.admit(ray) else {
                        continue;
                    };
                    let hit = exact_hit(map, walker.entered(ray)).map_err(|problem| {
                        let index = number * CHUNK + offset;
                        JudgeError::Exact {
                            index,
                            format,
                            problem,
                        }
                    })?;
                    answers.push((ray, TrueHit::from(hit)));
                }
                progress(rays.len() as u64);
                Ok(answers)
            })
            .collect::<Result<_, JudgeError>>()?;
        let (admitted, hits): (Vec<_>, Vec<_>) = chunks.into_iter().flatten().unzip();
        Ok(Truth {
            format,
            refused: (rays.len() - admitted.len()) as u64,
            rays: admitted,
            hits,
        })
    }

    /// The format that holds the rays; of fixed point the one that was chosen from them.
    pub fn format(&self) -> WalkFormat {
        self.format
    }

    /// The rays that are walked, as admitted, in the order they came in.
    pub fn rays(&self) -> &[Ray<f64>] {
        &self.rays
    }

    /// What each of [`Truth::rays`] meets.
    pub fn hits(&self) -> &[TrueHit] {
        &self.hits
    }

    /// Rays that the unit or the format refuses: they are not among [`Truth::rays`].
    pub fn refused(&self) -> u64 {
        self.refused
    }

    /// Judges the hits of [`Truth::rays`], in the same order: all of them, or of the first rays.
    pub fn judge<'a>(&self, hits: impl IntoIterator<Item = &'a Hit<f64>>) -> Verdict {
        let mut verdict = Verdict::default();
        for (hit, truth) in hits.into_iter().zip(&self.hits) {
            verdict.add(hit, truth, self.format);
        }
        verdict
    }

    /// Walks the rays by a method and a crossing, in the format of this truth, and judges the hits.
    /// Progress is told in rays.
    ///
    /// # Errors
    /// A method that does not go with the format or the crossing.
    pub fn judge_walk(
        &self,
        method: Method,
        crossing: Crossing,
        pyramid: &Pyramid,
        progress: Progress<'_>,
    ) -> Result<Verdict, JudgeError> {
        let walk = Walk {
            method,
            format: self.format,
            crossing,
        };
        Ok(self.judge(&walk_rays(walk, pyramid, &self.rays, progress)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::{Channel, MapSource};
    use crate::units::traverse::Status;

    fn subject() -> (HeightMap, Pyramid, Vec<Ray<f64>>) {
        let source = MapSource::parse("procedural:rocks:64:1").unwrap();
        let map = source.load(Channel::Grey, false).unwrap();
        let pyramid = Pyramid::new(&map);
        let rays = (0..1500).map(f64::from).map(|n| Ray {
            u: n * 0.013,
            v: n * 0.029,
            du: (n * 0.7).sin() * 0.5,
            dv: (n * 1.3).cos() * 0.5,
        });
        let rays = rays.collect();
        (map, pyramid, rays)
    }

    fn truth(format: &str, map: &HeightMap, pyramid: &Pyramid, rays: &[Ray<f64>]) -> Truth {
        Truth::of(format.parse().unwrap(), map, pyramid, rays, &|_| ()).unwrap()
    }

    #[test]
    fn a_depth_lies_between_its_neighbours() {
        for (numerator, denominator) in [
            (0, 1),
            (1, 3),
            (2, 3),
            (1, 2),
            (254, 255),
            ((1 << 100) - 1, 1 << 100),
            ((1 << 100) + 1, (1 << 100) + 2),
            ((1 << 53) - 1, 1 << 53),
        ] {
            let depth = ExactDepth {
                numerator,
                denominator,
            };
            let (below, above) = bracket(depth);
            assert_ne!(depth.compare_with(below), Ordering::Less);
            assert_ne!(depth.compare_with(above), Ordering::Greater);
            assert!(above == below || above == below.next_up(), "{depth:?}");
            assert_eq!(
                above == below,
                depth.compare_with(below) == Ordering::Equal,
                "{depth:?}"
            );
        }
    }

    #[test]
    fn sound_walks_are_right_and_counted_in_full() {
        let (map, pyramid, rays) = subject();
        for format in ["f64", "exact", "e7f16", "e8f23", "fixed", "q5.24"] {
            let truth = truth(format, &map, &pyramid, &rays);
            let verdict = truth
                .judge_walk(Method::Oh, Crossing::Index, &pyramid, &|_| ())
                .unwrap();
            assert_eq!(
                (verdict.rays, truth.refused()),
                (1500, 0),
                "{format}: {verdict:?}"
            );
            assert_eq!((verdict.late, verdict.guards), (0, 0), "{format}");
            assert_eq!(verdict.right + verdict.early, 1500, "{format}");
            assert_eq!(verdict.wrong, verdict.early, "{format}");
            if format != "e7f16" {
                assert_eq!(verdict.wrong, 0, "{format}");
            }
            assert!((0.0..0.01).contains(&verdict.most_early), "{format}");
        }
    }

    #[test]
    fn every_kind_of_wrong_hit_is_told() {
        let (map, pyramid, rays) = subject();
        let truth = truth("f64", &map, &pyramid, &rays[..1]);
        let walk = Walk {
            method: Method::Oh,
            format: WalkFormat::F64,
            crossing: Crossing::Index,
        };
        let hit = walk_rays(walk, &pyramid, truth.rays(), &|_| ()).unwrap()[0];
        let of = |hit: Hit<f64>| truth.judge([&hit]);
        assert_eq!(of(hit).right, 1);
        let late = of(Hit {
            t: truth.hits()[0].latest_in(WalkFormat::F64).next_up(),
            ..hit
        });
        assert_eq!((late.late, late.wrong, late.right), (1, 0, 0));
        let elsewhere = of(Hit {
            i: (hit.i + 1) % 64,
            ..hit
        });
        assert_eq!((elsewhere.early, elsewhere.wrong), (1, 1));
        let both = of(Hit {
            j: (hit.j + 1) % 64,
            t: 1.5,
            ..hit
        });
        assert_eq!((both.late, both.wrong, both.early), (1, 1, 0));
        let no_number = of(Hit { t: f64::NAN, ..hit });
        assert_eq!(no_number.late, 1);
        let guard = of(Hit {
            status: Status::Guard,
            ..hit
        });
        assert_eq!((guard.guards, guard.right, guard.wrong), (1, 0, 0));
        let early = of(Hit {
            t: hit.t - 0.25,
            ..hit
        });
        assert!((early.most_early - 0.25).abs() < 1e-9, "{early:?}");
    }

    #[test]
    fn only_what_rounds_to_nearest_may_round_up() {
        let depth = ExactDepth {
            numerator: 1,
            denominator: 3,
        };
        let (t_below, t_above) = bracket(depth);
        let truth = TrueHit {
            i: 0,
            j: 0,
            t_below,
            t_above,
            side: false,
        };
        let ulps = |format: &str| {
            let latest = truth.latest_in(format.parse().unwrap());
            latest.to_bits() - t_below.to_bits()
        };
        assert_eq!(["e7f16", "q8.20", "exact", "f64"].map(ulps), [0, 0, 1, 3]);
    }

    #[test]
    fn a_map_shifted_by_a_texel_is_seen() {
        let (map, pyramid, rays) = subject();
        let heights = (0..64 * 64).map(|texel| map.height((texel % 64) + 1, texel / 64));
        let shifted = HeightMap::new("shifted", 64, 8, heights.collect()).unwrap();
        let truth = truth("f64", &shifted, &pyramid, &rays);
        let verdict = truth
            .judge_walk(Method::Oh, Crossing::Index, &pyramid, &|_| ())
            .unwrap();
        assert!(verdict.wrong > 700 && verdict.late > 300, "{verdict:?}");
    }

    #[test]
    fn refused_rays_are_counted_and_left_out() {
        let (map, pyramid, mut rays) = subject();
        rays[7].du = 1e6;
        rays[9].dv = f64::NAN;
        let truth = truth("e7f16", &map, &pyramid, &rays);
        assert_eq!((truth.refused(), truth.rays().len()), (2, 1498));
    }

    #[test]
    fn a_verdict_does_not_depend_on_the_threads() {
        let (map, pyramid, rays) = subject();
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.unwrap().install(|| {
                let truth = truth("e7f16", &map, &pyramid, &rays);
                let verdict = truth
                    .judge_walk(Method::Oh, Crossing::Index, &pyramid, &|_| ())
                    .unwrap();
                (truth.hits, verdict)
            })
        });
        assert_eq!(one, three);
    }
}
