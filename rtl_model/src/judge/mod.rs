//! Whole frames judged by the exact reference.
//!
//! [`Truth`] is what a list of rays meets, by [`crate::exact::exact_hit`], of each ray as a number
//! format holds it ([`crate::walker::Walker::entered`]). It depends on the map, the rays and the
//! format, not on the method: it is worked out once and judges any number of walks.
//!
//! ```no_run
//! # use rtl_model::{judge::Truth, maps::{HeightMap, Pyramid}, ray::Ray, scene::Walk};
//! # fn example(walk: Walk, map: HeightMap, rays: Vec<Ray<f64>>) -> Result<(), Box<dyn std::error::Error>> {
//! let pyramid = Pyramid::new(&map);
//! let truth = Truth::of(walk.format, &map, &pyramid, &rays, &|_| ())?;
//! let verdict = truth.judge_walk(walk.method, walk.crossing, &pyramid, &|_| ())?;
//! assert_eq!((verdict.wrong, verdict.late, verdict.guards), (0, 0, 0));
//! # Ok(())
//! # }
//! ```

mod truth;
mod verdict;

pub use truth::{JudgeError, TrueHit, Truth};
pub use verdict::{Judgement, Verdict};
