//! One ray after another through a map, in a number format chosen at run time.
//!
//! # How a ray enters a format
//!
//! A ray of the outside world is four `f64`. [`Walker::admit`] refuses what no unit can walk and
//! reduces the entry to the first repeat of the map, [0, 1). [`Walker::walk`] then rounds each
//! number once: `u` and `v` toward zero, so that an entry stays in the first repeat and in its
//! texel or before it; `du` and `dv` to nearest ([`NumberFormat`]). In `f64` and in exact numbers
//! nothing is lost. In fixed point the ray is quantised ([`RayFormat`]), and saturates where the
//! format was told and is too narrow. The walk that follows is the ray's so rounded, and so is its
//! hit.

use thiserror::Error;

use crate::camera::Surface;
use crate::float::{FloatFormat, Rounding};
use crate::maps::Pyramid;
use crate::ray::{self, Ray, RayError};
use crate::ray_format::{RayFormat, RayFormatError};
use crate::readings::{E7F16, ExactReading, F64Reading, FloatReading, NumberFormat, enter};
use crate::scene::{Crossing, Family, LinearSearch, Walk, WalkFormat};
use crate::units::bounded::bounded_walk;
use crate::units::bounded_leaf::corner_bits;
use crate::units::bounded_shape::BoundedShape;
use crate::units::fixed_shape::FixedShape;
use crate::units::fixed_traverse::fixed_walk;
use crate::units::linear_ray::{LINEAR_SAMPLES, LinearRay, NOMINAL_DEPTH, SampleRange};
use crate::units::linear_walk::{first_sample_below, pom_walk, relief_walk};
use crate::units::offset_walk::{offset_shape_for, walk_by_offset};
use crate::units::search_policy::SearchPolicy;
use crate::units::traverse::{self, Hit};
use crate::units::wide::{wide_shape_for, wide_walk};
use crate::units::wide_fixed::wide_fixed_walk;
use crate::units::wide_fixed_step::WideFixedShape;
use crate::units::window::{window_fixed_walk, window_walk};
use crate::units::window_fixed_step::WindowFixedShape;

/// Why a ray cannot be walked in a format.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum AdmissionError {
    /// No format can walk it.
    #[error(transparent)]
    Ray(#[from] RayError),
    /// The format is too coarse for so shallow a ray.
    #[error(
        "ray: `{component}` is {value}, which on a {size} x {size} map is {texels} texels from top \
         to bottom, more than the {reach} that {format} tells apart: take a format with more \
         fraction bits, a steeper ray or a smaller map"
    )]
    BeyondReach {
        /// The component's name: du or dv.
        component: &'static str,
        /// What it was.
        value: f64,
        /// The map's texels on a side.
        size: u32,
        /// Texels travelled on that axis.
        texels: f64,
        /// Texels that may be travelled.
        reach: f64,
        /// The format.
        format: FloatFormat,
    },
    /// This format cannot hold it.
    #[error(
        "ray: `{component}` is {value}, which {format} cannot hold (its largest number is {most}): \
         take a format with more exponent bits, or a steeper ray"
    )]
    BeyondFormat {
        /// The component's name: du or dv.
        component: &'static str,
        /// What it was.
        value: f64,
        /// The format.
        format: FloatFormat,
        /// The largest finite number of the format.
        most: f64,
    },
}

/// A walk that cannot be set up, whatever the ray.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum WalkerError {
    /// The three do not go together.
    #[error("method {} in format {} with crossing {}: {why}", walk.method, walk.format, walk.crossing)]
    Unsupported {
        /// What was asked for.
        walk: Walk,
        /// What is the matter, and the way out.
        why: &'static str,
    },
    /// No exact walk through this map has slopes in this format.
    #[error(transparent)]
    RayFormat(#[from] RayFormatError),
}

/// The readings that a walk can be computed in. Each is compiled on its own, so the choice costs
/// one branch a ray.
enum Reading {
    E7f16(FloatReading<E7F16>),
    Float(FloatReading<FloatFormat>),
    F64(F64Reading),
    Exact(ExactReading),
    /// Integers, which need no reading.
    Fixed(RayFormat),
}

/// Walks rays through one map. It keeps what its reading needs from ray to ray, so that walking
/// allocates nothing but the rationals of the exact format; each thread has its own.
pub struct Walker<'a> {
    pyramid: &'a Pyramid,
    way: Way,
    reading: Reading,
}

/// How a walk is walked: what of the method the loop is made for.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Way {
    /// A node of the pyramid a step.
    Nodes(SearchPolicy),
    /// A line of several nodes a step: `2^log2_side` on a side.
    Wide { log2_side: u32 },
    /// A window of nodes a step, from the ray's own on.
    Window,
    /// A line a step, compared with bounds.
    Bounded { log2_side: u32 },
    /// A node a step, found anew from a position this many texels beyond the border.
    Offset(SearchPolicy, f64),
    /// A sample a step.
    Linear {
        /// The method.
        search: LinearSearch,
        /// How deep depth 1 is, in repeats of the map.
        depth_in_repeats: f64,
    },
}

impl Way {
    /// Method `oh`.
    pub(crate) const OH: Way = Way::Nodes(SearchPolicy::OH);

    fn of(walk: Walk) -> Result<Way, WalkerError> {
        let is_fixed = matches!(walk.format, WalkFormat::Fixed(_));
        match (walk.method.family(), walk.crossing) {
            (Family::Linear(_), _) if is_fixed => Err(WalkerError::Unsupported {
                walk,
                why: "a method that samples is not exact in any format; take a float, such as e7f16",
            }),
            (_, Crossing::Offset(_)) if is_fixed => Err(WalkerError::Unsupported {
                walk,
                why: "in fixed point no position is rounded into a node; leave the crossing out",
            }),
            (Family::Bounded { log2_side }, Crossing::Index) if is_fixed => {
                Ok(Way::Bounded { log2_side })
            }
            (Family::Bounded { .. }, _) => Err(WalkerError::Unsupported {
                walk,
                why: "its bounds are those of a quantised ray, and it walks by the index: take format \
                      fixed, or method quad or block",
            }),
            (Family::Nodes(policy), Crossing::Index) => Ok(Way::Nodes(policy)),
            (Family::Wide { log2_side }, Crossing::Index) => Ok(Way::Wide { log2_side }),
            (Family::Window, Crossing::Index) => Ok(Way::Window),
            (Family::Nodes(policy), Crossing::Offset(offset)) => {
                Ok(Way::Offset(policy, offset.texels()))
            }
            (Family::Linear(search), Crossing::Index) => Ok(Way::Linear {
                search,
                depth_in_repeats: NOMINAL_DEPTH,
            }),
            (Family::Wide { .. } | Family::Window, Crossing::Offset(_)) => {
                Err(WalkerError::Unsupported {
                    walk,
                    why: "a method that reads several nodes at once is walked by the index; leave \
                          the crossing out",
                })
            }
            (Family::Linear(_), Crossing::Offset(_)) => Err(WalkerError::Unsupported {
                walk,
                why: "a method that samples crosses no border; leave the crossing out",
            }),
        }
    }
}

impl<'a> Walker<'a> {
    /// A walker of this method and format through the map under `pyramid`, for any rays. Fixed point
    /// without a format takes the one that holds every ray; the pixels that `dig` asks for are those
    /// of [`crate::units::pixel_block`].
    ///
    /// # Errors
    /// If method, format and crossing do not go together.
    pub fn new(walk: Walk, pyramid: &'a Pyramid) -> Result<Walker<'a>, WalkerError> {
        let way = Way::of(walk)?;
        Walker::by(way, walk, pyramid)
    }

    /// A walker for the rays of a frame on this surface.
    ///
    /// # Errors
    /// If method, format and crossing do not go together, or format and map.
    pub(crate) fn for_frame(
        walk: Walk,
        pyramid: &'a Pyramid,
        surface: &Surface,
    ) -> Result<Walker<'a>, WalkerError> {
        let way = match Way::of(walk)? {
            Way::Linear { search, .. } => Way::Linear {
                search,
                depth_in_repeats: surface.depth_in_repeats(),
            },
            way => way,
        };
        Walker::by(way, walk, pyramid)
    }

    fn by(way: Way, walk: Walk, pyramid: &'a Pyramid) -> Result<Walker<'a>, WalkerError> {
        let reading = match walk.format {
            WalkFormat::Float(FloatFormat::E7F16) => Reading::E7f16(FloatReading(E7F16)),
            WalkFormat::Float(format) => Reading::Float(FloatReading(format)),
            WalkFormat::F64 => Reading::F64(F64Reading),
            WalkFormat::Exact => Reading::Exact(ExactReading::default()),
            WalkFormat::Fixed(None) => Reading::Fixed(RayFormat::within_reach(pyramid)),
            WalkFormat::Fixed(Some(format)) => Reading::Fixed(RayFormat::told(format, pyramid)?),
        };
        if let Reading::Fixed(format) = &reading
            && longest_word(way, format.shape()) > MOST_WORD_BITS
        {
            return Err(WalkerError::Unsupported {
                walk,
                why: "words of its walk would have more than 63 bits: take fewer bits, or `fixed`",
            });
        }
        Ok(Walker {
            pyramid,
            way,
            reading,
        })
    }

    /// The ray as it can be walked: checked by [`ray::check`], its entry reduced to [0, 1).
    ///
    /// # Errors
    /// A component that is not finite, a direction beyond the unit's or the format's reach on this
    /// map or beyond the format's largest number.
    pub fn admit(&self, ray: Ray<f64>) -> Result<Ray<f64>, AdmissionError> {
        let ray = ray::check(ray, self.pyramid.size())?;
        let format = match &self.reading {
            Reading::E7f16(reading) => reading.format(),
            Reading::Float(reading) => reading.format(),
            Reading::F64(_) | Reading::Exact(_) | Reading::Fixed(_) => return Ok(ray),
        };
        let size = self.pyramid.size();
        let reach = ray::reach_in(format.fraction_bits);
        for (component, value) in [("du", ray.du), ("dv", ray.dv)] {
            let texels = value.abs() * f64::from(size);
            if texels > reach {
                return Err(AdmissionError::BeyondReach {
                    component,
                    value,
                    size,
                    texels,
                    reach,
                    format,
                });
            }
            if format.is_infinite(format.from_f64(Rounding::NearestEven, value)) {
                return Err(AdmissionError::BeyondFormat {
                    component,
                    value,
                    format,
                    most: format.to_f64(format.max_finite()),
                });
            }
        }
        Ok(ray)
    }

    /// The ray that is walked for an admitted one: its numbers as the format holds them. It is this
    /// ray that a hit is judged by.
    pub fn entered(&mut self, admitted: Ray<f64>) -> Ray<f64> {
        match &mut self.reading {
            Reading::E7f16(reading) => entered_in(reading, admitted),
            Reading::Float(reading) => entered_in(reading, admitted),
            Reading::F64(_) | Reading::Exact(_) => admitted,
            Reading::Fixed(format) => format.entered(&format.quantise(admitted)),
        }
    }

    /// The formats of its rays, in fixed point.
    pub fn ray_format(&self) -> Option<RayFormat> {
        match self.reading {
            Reading::Fixed(format) => Some(format),
            _ => None,
        }
    }

    /// Walks a ray that [`Walker::admit`] has let pass. `t`, `u` and `v` of the hit are those of
    /// the format, which an `f64` holds exactly; of the exact format, the nearest `f64`.
    pub fn walk(&mut self, admitted: Ray<f64>) -> Hit<f64> {
        match &mut self.reading {
            Reading::E7f16(reading) => walk_in(reading, self.way, self.pyramid, admitted),
            Reading::Float(reading) => walk_in(reading, self.way, self.pyramid, admitted),
            Reading::F64(reading) => walk_in(reading, self.way, self.pyramid, admitted),
            Reading::Exact(reading) => walk_in(reading, self.way, self.pyramid, admitted),
            Reading::Fixed(format) => walk_fixed(*format, self.way, self.pyramid, admitted),
        }
    }
}

impl Walker<'_> {
    /// The number of the first of a hundred samples of an admitted ray that lies below the surface:
    /// what a depth-interval grid asks of a corner ray. As many samples are looked at.
    pub(crate) fn first_sample_below(&mut self, admitted: Ray<f64>) -> u32 {
        fn first<R: NumberFormat>(reading: &mut R, pyramid: &Pyramid, ray: Ray<f64>) -> u32 {
            reading.forget();
            let ray = LinearRay::enter(reading, ray, SampleRange::whole(LINEAR_SAMPLES));
            first_sample_below(reading, pyramid, &ray)
        }
        match &mut self.reading {
            Reading::E7f16(reading) => first(reading, self.pyramid, admitted),
            Reading::Float(reading) => first(reading, self.pyramid, admitted),
            Reading::F64(reading) => first(reading, self.pyramid, admitted),
            Reading::Exact(reading) => first(reading, self.pyramid, admitted),
            Reading::Fixed(_) => unreachable!("sampling is refused in fixed point"),
        }
    }

    /// Searches an admitted ray within these samples, and refines what it finds.
    pub(crate) fn search_within(&mut self, admitted: Ray<f64>, samples: SampleRange) -> Hit<f64> {
        fn search<R: NumberFormat>(
            reading: &mut R,
            pyramid: &Pyramid,
            ray: Ray<f64>,
            samples: SampleRange,
        ) -> Hit<f64> {
            reading.forget();
            let ray = LinearRay::enter(reading, ray, samples);
            let hit = relief_walk(reading, pyramid, &ray);
            outside(reading, hit)
        }
        match &mut self.reading {
            Reading::E7f16(reading) => search(reading, self.pyramid, admitted, samples),
            Reading::Float(reading) => search(reading, self.pyramid, admitted, samples),
            Reading::F64(reading) => search(reading, self.pyramid, admitted, samples),
            Reading::Exact(reading) => search(reading, self.pyramid, admitted, samples),
            Reading::Fixed(_) => unreachable!("sampling is refused in fixed point"),
        }
    }
}

/// The most bits that a word of a fixed-point walk may have: sums of two of them are still made in 64.
const MOST_WORD_BITS: u32 = 63;

/// Bits of the longest word of a fixed-point walk, where it is longer than [`RayFormat`] checks.
fn longest_word(way: Way, words: FixedShape) -> u32 {
    match way {
        Way::Wide { log2_side } => WideFixedShape { words, log2_side }.line_error_bits(),
        Way::Window => WindowFixedShape { words }.window_error_bits(),
        Way::Bounded { log2_side } => {
            let shape = BoundedShape::new(words, log2_side);
            corner_bits(shape).max(shape.bound_bits())
        }
        Way::Nodes(_) | Way::Offset(..) | Way::Linear { .. } => 0,
    }
}

/// Walks an admitted ray in fixed point.
fn walk_fixed(format: RayFormat, way: Way, pyramid: &Pyramid, ray: Ray<f64>) -> Hit<f64> {
    let (words, ray) = (format.shape(), format.quantise(ray));
    let hit = match way {
        Way::Nodes(policy) => fixed_walk(words, policy, pyramid.memory(), &ray),
        Way::Wide { log2_side } => {
            let shape = WideFixedShape { words, log2_side };
            wide_fixed_walk(shape, pyramid.lines(log2_side), &ray)
        }
        Way::Window => window_fixed_walk(WindowFixedShape { words }, pyramid, &ray),
        Way::Bounded { log2_side } => {
            let shape = BoundedShape::new(words, log2_side);
            bounded_walk(shape, pyramid.lines(log2_side), &ray)
        }
        Way::Offset(..) | Way::Linear { .. } => {
            unreachable!("refused when the walker was made")
        }
    };
    hit.to_hit(words, &ray)
}

/// The ray as a reading holds it.
fn entered_in<R: NumberFormat>(reading: &mut R, admitted: Ray<f64>) -> Ray<f64> {
    let ray = enter(reading, admitted);
    ray.map(|number| reading.to_f64(number))
}

/// Walks an admitted ray in a reading.
pub(crate) fn walk_in<R: NumberFormat>(
    reading: &mut R,
    way: Way,
    pyramid: &Pyramid,
    ray: Ray<f64>,
) -> Hit<f64> {
    reading.forget();
    let entered = enter(reading, ray);
    let hit = match way {
        Way::Nodes(policy) => traverse::walk(reading, policy, pyramid, pyramid.memory(), entered),
        Way::Wide { log2_side } => {
            let shape = wide_shape_for(pyramid, log2_side);
            wide_walk(reading, shape, pyramid.lines(log2_side), entered)
        }
        Way::Window => window_walk(reading, pyramid, entered),
        Way::Bounded { .. } => unreachable!("refused outside fixed point"),
        Way::Offset(policy, texels) => {
            let shape = offset_shape_for(pyramid, policy, texels);
            walk_by_offset(reading, shape, pyramid.memory(), entered)
        }
        Way::Linear {
            search,
            depth_in_repeats,
        } => {
            let samples = match search {
                LinearSearch::Dig => SampleRange::of_listed_ray(reading, pyramid, ray),
                LinearSearch::Relief | LinearSearch::Pom => {
                    let entered = entered.map(|number| reading.to_f64(number));
                    SampleRange::of(search, entered, depth_in_repeats)
                }
            };
            let ray = LinearRay::enter(reading, ray, samples);
            match search {
                LinearSearch::Pom => pom_walk(reading, pyramid, &ray),
                LinearSearch::Relief | LinearSearch::Dig => relief_walk(reading, pyramid, &ray),
            }
        }
    };
    outside(reading, hit)
}

/// A hit in numbers of the outside world.
fn outside<R: NumberFormat>(reading: &R, hit: Hit<R::Num>) -> Hit<f64> {
    Hit {
        i: hit.i,
        j: hit.j,
        t: reading.to_f64(hit.t),
        u: reading.to_f64(hit.u),
        v: reading.to_f64(hit.v),
        steps: hit.steps,
        crossings: hit.crossings,
        status: hit.status,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::exact_hit;
    use crate::maps::{Channel, HeightMap, MapSource};
    use crate::scene::Method;
    use crate::units::traverse::Status;
    use proptest::prelude::*;

    fn map() -> HeightMap {
        let source: MapSource = "procedural:spikes:32:3".parse().unwrap();
        source.load(Channel::Grey, false).unwrap()
    }

    fn walk_of(format: &str) -> Walk {
        Walk {
            method: Method::Oh,
            format: format.parse().unwrap(),
            crossing: Crossing::Index,
        }
    }

    #[test]
    fn a_compiled_format_walks_as_the_one_chosen_at_run_time() {
        let map = map();
        let pyramid = Pyramid::new(&map);
        let mut compiled = Walker::new(walk_of("e7f16"), &pyramid).unwrap();
        assert!(matches!(compiled.reading, Reading::E7f16(_)));
        let mut chosen = Walker {
            pyramid: &pyramid,
            way: compiled.way,
            reading: Reading::Float(FloatReading(FloatFormat::E7F16)),
        };
        for n in 0..200 {
            let n = f64::from(n);
            let ray = Ray {
                u: n * 0.013,
                v: n * 0.029,
                du: (n * 0.7).sin() * 3.0,
                dv: (n * 1.3).cos(),
            };
            let ray = compiled.admit(ray).unwrap();
            assert_eq!(compiled.walk(ray), chosen.walk(ray));
        }
    }

    #[test]
    fn a_direction_the_format_cannot_hold_is_refused_with_its_range() {
        let map = map();
        let pyramid = Pyramid::new(&map);
        let ray = Ray {
            u: 0.5,
            v: 0.5,
            du: 1.0,
            dv: -7.0,
        };
        assert!(
            Walker::new(walk_of("e7f16"), &pyramid)
                .unwrap()
                .admit(ray)
                .is_ok()
        );
        let message = Walker::new(walk_of("e2f12"), &pyramid)
            .unwrap()
            .admit(ray)
            .unwrap_err()
            .to_string();
        assert!(message.contains("`dv` is -7"), "{message}");
        assert!(message.contains("largest number is 3.9995"), "{message}");
    }

    proptest! {
        #[test]
        fn the_exact_format_finds_the_hit_of_the_definition(
            u in 0.0..1.0f64, v in 0.0..1.0f64, du in -4.0..4.0f64, dv in -4.0..4.0f64,
        ) {
            let map = map();
            let pyramid = Pyramid::new(&map);
            let mut walker = Walker::new(walk_of("exact"), &pyramid).unwrap();
            let ray = walker.admit(Ray { u, v, du, dv }).unwrap();
            let hit = walker.walk(ray);
            let truth = exact_hit(&map, ray).unwrap();
            prop_assert_eq!((hit.i, hit.j), (truth.i, truth.j));
            prop_assert!((hit.t - truth.t.to_f64()).abs() < 1e-15);
            prop_assert_eq!(hit.status, Status::Hit);
        }

        /// A format too coarse for its map walks badly; it must not go astray in this program.
        #[test]
        fn every_format_ends_every_admitted_walk(
            exponent in 2u32..12, fraction in 2u32..53,
            u: f64, v: f64, du: f64, dv: f64,
        ) {
            let map = map();
            let pyramid = Pyramid::new(&map);
            let format = WalkFormat::Float(FloatFormat::new(exponent, fraction));
            let mut walker = Walker::new(Walk { format, ..walk_of("f64") }, &pyramid).unwrap();
            if let Ok(ray) = walker.admit(Ray { u, v, du, dv }) {
                let hit = walker.walk(ray);
                prop_assert!(hit.i < 32 && hit.j < 32);
            }
            let ray = Ray { u: u.sin(), v: v.sin(), du: 8.0 * du.sin(), dv: 8.0 * dv.sin() };
            if ray.u.is_finite() && ray.v.is_finite() && let Ok(ray) = walker.admit(ray) {
                let hit = walker.walk(ray);
                prop_assert!(hit.i < 32 && hit.j < 32);
            }
        }
    }
}
