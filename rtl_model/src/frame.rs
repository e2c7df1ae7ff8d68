//! Frames of rays: the golden model over a whole picture, or over any list of rays, on all cores.
//!
//! Every ray is walked on its own ([`crate::walker`] says how it enters the format), and its answer
//! stands in its own place: hits and counts are the same, bit for bit, whatever the number of
//! threads. Work is shared among the threads of the current `rayon` pool; a caller who wants fewer
//! installs its own. By `oh` in e7f16, and by `oh` and `block` in fixed point, the rays go in packets
//! ([`crate::packet`], [`crate::fixed_packet`]), which makes no difference but to the time.

mod places;
mod sampled;

use rayon::prelude::*;
use thiserror::Error;

use crate::camera::{PixelRayError, View};
use crate::maps::Pyramid;
use crate::picture::{self, PixelHit};
use crate::ray::Ray;
use crate::ray_format::{RayFormat, RayRange};
use crate::scene::{Family, Scene, Walk, WalkFormat};
use crate::units::traverse::{Hit, Status};
use crate::walker::{AdmissionError, Walker, WalkerError};
use places::{UNWALKED, walk_places};
use sampled::walk_sampled;

/// Called from any thread, now and then, with the pixels or rays done since the last call; all
/// calls together add up to all of them.
pub type Progress<'a> = &'a (dyn Fn(u64) + Sync);

/// What walking cost, over all rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Rays walked; of a frame, the pixels that have one.
    pub rays: u64,
    /// Rays that ended at the step bound.
    pub guards: u64,
    /// Steps of all rays.
    pub steps: u64,
    /// Steps of the ray that took most.
    pub most_steps: u32,
    /// Node crossings of all rays.
    pub crossings: u64,
}

impl Counts {
    /// The counts over `hits`.
    pub fn of<'a>(hits: impl IntoIterator<Item = &'a Hit<f64>>) -> Counts {
        let mut counts = Counts::default();
        for hit in hits {
            counts.rays += 1;
            counts.guards += u64::from(hit.status == Status::Guard);
            counts.steps += u64::from(hit.steps);
            counts.most_steps = counts.most_steps.max(hit.steps);
            counts.crossings += u64::from(hit.crossings);
        }
        counts
    }

    /// Steps of a ray in the mean; none where there are no rays.
    pub fn mean_steps(&self) -> Option<f64> {
        self.mean(self.steps)
    }

    /// Node crossings of a ray in the mean; none where there are no rays.
    pub fn mean_crossings(&self) -> Option<f64> {
        self.mean(self.crossings)
    }

    fn mean(&self, total: u64) -> Option<f64> {
        (self.rays > 0).then(|| total as f64 / self.rays as f64)
    }
}

/// What a scene's frame came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The hit of each pixel, row by row from the upper left; none where a pixel has no ray.
    pub hits: Vec<Option<Hit<f64>>>,
    /// What it cost.
    pub counts: Counts,
    /// How it was walked.
    pub fit: Fit,
}

/// How rays are walked that have all been looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The walk; in fixed point, with the format of slopes that the rays call for.
    pub walk: Walk,
    /// Rays looked at.
    pub rays: u64,
    /// Their range; none where there is none.
    pub range: Option<RayRange>,
    /// The most texels that one of them travels on an axis, from top to bottom.
    pub most_texels: f64,
    /// In fixed point, the formats of the rays and why.
    pub ray_format: Option<RayFormat>,
    /// Rays with a slope beyond the format: their slope is its largest.
    pub saturated: u64,
}

/// What is found by looking at rays.
#[derive(Clone, Copy, Debug, Default)]
struct Survey {
    rays: u64,
    saturated: u64,
    range: Option<RayRange>,
}

impl Survey {
    fn of(ray: Ray<f64>, format: Option<RayFormat>) -> Survey {
        Survey {
            rays: 1,
            saturated: format.map_or(0, |format| format.quantise(ray).saturated.into()),
            range: Some(RayRange::of(ray)),
        }
    }

    fn and(self, other: Survey) -> Survey {
        Survey {
            rays: self.rays + other.rays,
            saturated: self.saturated + other.saturated,
            range: match (self.range, other.range) {
                (Some(range), Some(other)) => Some(range.and(other)),
                (range, other) => range.or(other),
            },
        }
    }

    /// The walk that these rays call for. `told` is the format that they were looked at with.
    fn fit(self, walk: Walk, pyramid: &Pyramid, told: Option<RayFormat>) -> Fit {
        let chosen = match (walk.format, &self.range) {
            (WalkFormat::Fixed(None), Some(range)) => Some(RayFormat::for_rays(range, pyramid)),
            _ => told,
        };
        Fit {
            walk: Walk {
                format: chosen.map_or(walk.format, |format| WalkFormat::Fixed(Some(format.slope))),
                ..walk
            },
            rays: self.rays,
            range: self.range,
            most_texels: self
                .range
                .map_or(0.0, |range| range.most_texels(pyramid.size())),
            ray_format: chosen,
            saturated: self.saturated,
        }
    }
}

/// Why a frame cannot be walked. Nothing has been walked then.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum WalkFrameError {
    /// Method, format and crossing do not go together.
    #[error(transparent)]
    Walk(#[from] WalkerError),
    /// A pixel whose ray is beyond the unit, the first in reading order.
    #[error(transparent)]
    Pixel(#[from] PixelRayError),
    /// A pixel whose ray is beyond the format, the first in reading order.
    #[error("pixel ({x}, {y}): {problem}")]
    Format {
        /// Column of the pixel, 0 at the left.
        x: u32,
        /// Row of the pixel, 0 at the top.
        y: u32,
        /// What is wrong with its ray.
        problem: AdmissionError,
    },
}

/// Why a list of rays cannot be walked. Nothing has been walked then.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum WalkRaysError {
    /// Method, format and crossing do not go together.
    #[error(transparent)]
    Walk(#[from] WalkerError),
    /// A ray of the list, the first that cannot be walked.
    #[error("ray {index} (the first is 0): {problem}")]
    Ray {
        /// Its place in the list, from 0.
        index: usize,
        /// What is wrong with it.
        problem: AdmissionError,
    },
}

impl Frame {
    /// The frame as [`crate::picture`] draws it.
    ///
    /// # Errors
    /// A frame whose fields were changed so that its hits are no longer as many as its pixels.
    pub fn to_picture(&self) -> Result<picture::Frame, picture::FrameError> {
        let pixel = |hit: &Hit<f64>| PixelHit {
            i: hit.i,
            j: hit.j,
            t: hit.t,
            u: hit.u,
            v: hit.v,
            steps: hit.steps,
            crossings: hit.crossings,
        };
        let hits = self.hits.iter().map(|hit| hit.as_ref().map(pixel));
        picture::Frame::new(self.width, self.height, hits.collect())
    }
}

/// Walks the view rays of a scene's frame by the scene's method and format. `pyramid` is that of the
/// scene's map. Progress is told in pixels.
///
/// # Errors
/// A pixel whose ray cannot be walked: rays are checked before the first is walked.
pub fn walk_scene(
    scene: &Scene,
    pyramid: &Pyramid,
    progress: Progress<'_>,
) -> Result<Frame, WalkFrameError> {
    // Each ray is made twice, here and when it is walked: that is quicker than keeping them all.
    let fit = fit_scene(scene, pyramid)?;
    let (width, height) = (scene.frame.width, scene.frame.height);
    let hits = match scene.walk.method.family() {
        Family::Linear(search) => walk_sampled(scene, search, pyramid, progress)?,
        Family::Nodes(_) | Family::Wide { .. } | Family::Window | Family::Bounded { .. } => {
            let view = scene.view();
            let mut hits = vec![None; width as usize * height as usize];
            let ray_of = |walker: &Walker<'_>, pixel| {
                let (x, y) = place(pixel, width);
                admit(walker, &view, x, y)
            };
            walk_places(fit.walk, pyramid, progress, &mut hits, ray_of, Some)?;
            hits
        }
    };
    Ok(Frame {
        width,
        height,
        counts: Counts::of(hits.iter().flatten()),
        hits,
        fit,
    })
}

/// Checks the view rays of a scene's frame, and counts them.
///
/// # Errors
/// The first pixel, in reading order, whose ray cannot be walked.
pub fn check_scene(scene: &Scene, pyramid: &Pyramid) -> Result<u64, WalkFrameError> {
    Ok(fit_scene(scene, pyramid)?.rays)
}

/// Looks at the view rays of a scene's frame: how they are walked.
///
/// # Errors
/// The first pixel, in reading order, whose ray cannot be walked.
pub fn fit_scene(scene: &Scene, pyramid: &Pyramid) -> Result<Fit, WalkFrameError> {
    let view = scene.view();
    let width = scene.frame.width;
    let pixels = width as usize * scene.frame.height as usize;
    let checker = Walker::for_frame(scene.walk, pyramid, &scene.surface)?;
    let format = checker.ray_format();
    let looked_at = |pixel| {
        let (x, y) = place(pixel, width);
        let ray = admit(&checker, &view, x, y)?;
        Ok(ray.map_or(Survey::default(), |ray| Survey::of(ray, format)))
    };
    // Of two faults the one further left is kept, so the answer is that of reading in order.
    let both = |left: Result<Survey, WalkFrameError>, right: Result<Survey, WalkFrameError>| {
        Ok(left?.and(right?))
    };
    let survey = (0..pixels)
        .into_par_iter()
        .map(looked_at)
        .reduce(|| Ok(Survey::default()), both)?;
    Ok(survey.fit(scene.walk, pyramid, format))
}

/// Looks at a list of rays: how they are walked.
///
/// # Errors
/// The first ray that cannot be walked.
pub fn fit_rays(walk: Walk, pyramid: &Pyramid, rays: &[Ray<f64>]) -> Result<Fit, WalkRaysError> {
    let checker = Walker::new(walk, pyramid)?;
    let format = checker.ray_format();
    let looked_at = |(index, &ray)| match checker.admit(ray) {
        Ok(ray) => Ok(Survey::of(ray, format)),
        Err(problem) => Err(WalkRaysError::Ray { index, problem }),
    };
    let both = |left: Result<Survey, WalkRaysError>, right: Result<Survey, WalkRaysError>| {
        Ok(left?.and(right?))
    };
    let survey = rays
        .par_iter()
        .enumerate()
        .map(looked_at)
        .reduce(|| Ok(Survey::default()), both)?;
    Ok(survey.fit(walk, pyramid, format))
}

/// Column and row of a pixel in a frame of `width` columns.
fn place(pixel: usize, width: u32) -> (u32, u32) {
    (
        (pixel % width as usize) as u32,
        (pixel / width as usize) as u32,
    )
}

/// Walks a list of rays; the answer has the hit of each in its place. Progress is told in rays.
///
/// # Errors
/// A ray that cannot be walked: rays are checked before the first is walked.
pub fn walk_rays(
    walk: Walk,
    pyramid: &Pyramid,
    rays: &[Ray<f64>],
    progress: Progress<'_>,
) -> Result<Vec<Hit<f64>>, WalkRaysError> {
    let walk = fit_rays(walk, pyramid, rays)?.walk;
    let mut hits = vec![UNWALKED; rays.len()];
    let ray_of = |walker: &Walker<'_>, index: usize| {
        let ray = walker.admit(rays[index]).map(Some);
        ray.map_err(|problem| WalkRaysError::Ray { index, problem })
    };
    walk_places(walk, pyramid, progress, &mut hits, ray_of, |hit| hit)?;
    Ok(hits)
}

/// The ray of pixel `(x, y)`, if it has one, as it can be walked.
fn admit(
    walker: &Walker<'_>,
    view: &View,
    x: u32,
    y: u32,
) -> Result<Option<Ray<f64>>, WalkFrameError> {
    let Some(ray) = view.ray(x, y) else {
        return Ok(None);
    };
    match walker.admit(ray.reduced()) {
        Ok(ray) => Ok(Some(ray)),
        Err(AdmissionError::Ray(problem)) => Err(PixelRayError { x, y, problem }.into()),
        Err(problem) => Err(WalkFrameError::Format { x, y, problem }),
    }
}

#[cfg(test)]
mod tests {
    use super::places::packets_for;
    use super::*;
    use crate::exact::exact_hit;
    use crate::maps::HeightMap;
    use crate::scene::{Crossing, Method};
    use std::path::Path;
    use std::sync::atomic::{AtomicU64, Ordering};

    fn small_scene(format: &str) -> (Scene, HeightMap, Pyramid) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/small.toml");
        let mut scene = Scene::load(&path).unwrap();
        scene.walk.format = format.parse().unwrap();
        let map = scene.load_map().unwrap();
        let pyramid = Pyramid::new(&map);
        (scene, map, pyramid)
    }

    fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(work)
    }

    #[test]
    fn a_frame_does_not_depend_on_the_threads() {
        for format in ["e7f16", "e5f10", "f64", "exact", "fixed", "q6.20"] {
            let (scene, _, pyramid) = small_scene(format);
            let done = AtomicU64::new(0);
            let count = |pixels| {
                done.fetch_add(pixels, Ordering::Relaxed);
            };
            let [one, three] = [1, 3].map(|threads| {
                with_threads(threads, || walk_scene(&scene, &pyramid, &count)).unwrap()
            });
            assert_eq!(one, three, "{format}");
            assert_eq!(done.into_inner(), 2 * 32 * 24);
            assert_eq!(one.counts.guards, 0, "{format}");
            assert_eq!(one.counts.rays, one.hits.iter().flatten().count() as u64);
            assert!(one.counts.rays > 600, "{format}: {:?}", one.counts);
        }
    }

    #[test]
    fn a_frame_in_packets_is_that_of_the_rays_alone() {
        for (method, format) in [("oh", "e7f16"), ("oh", "fixed"), ("block", "fixed")] {
            let (mut scene, map, pyramid) = small_scene(format);
            scene.walk.method = method.parse().unwrap();
            let frame = walk_scene(&scene, &pyramid, &|_| ()).unwrap();
            assert!(packets_for(frame.fit.walk, &pyramid, 32 * 24).is_some());
            let mut walker = Walker::new(frame.fit.walk, &pyramid).unwrap();
            let rays = scene.view().rays(map.size()).unwrap();
            for (ray, hit) in rays.into_iter().zip(&frame.hits) {
                let alone = ray.map(|ray| walker.walk(walker.admit(ray).unwrap()));
                assert_eq!(alone, *hit, "{method} in {format}");
            }
        }
    }

    #[test]
    fn the_exact_frame_is_that_of_the_definition() {
        let (scene, map, pyramid) = small_scene("exact");
        let frame = walk_scene(&scene, &pyramid, &|_| ()).unwrap();
        let rays = scene.view().rays(map.size()).unwrap();
        for (ray, hit) in rays.into_iter().zip(&frame.hits) {
            let truth = ray.map(|ray| exact_hit(&map, ray).unwrap());
            assert_eq!(
                truth.map(|truth| (truth.i, truth.j)),
                hit.map(|hit| (hit.i, hit.j))
            );
        }
    }

    #[test]
    fn a_list_of_the_frames_rays_has_the_frames_hits() {
        let (scene, map, pyramid) = small_scene("e7f16");
        let frame = walk_scene(&scene, &pyramid, &|_| ()).unwrap();
        let rays = scene.view().rays(map.size()).unwrap();
        let rays: Vec<_> = rays.into_iter().flatten().collect();
        let hits = walk_rays(scene.walk, &pyramid, &rays, &|_| ()).unwrap();
        assert_eq!(
            hits,
            frame.hits.iter().flatten().copied().collect::<Vec<_>>()
        );
        assert_eq!(Counts::of(&hits), frame.counts);
        let total: u64 = hits.iter().map(|hit| u64::from(hit.steps)).sum();
        assert_eq!(
            frame.counts.mean_steps(),
            Some(total as f64 / hits.len() as f64)
        );
    }

    #[test]
    fn the_first_ray_at_fault_is_named() {
        let (scene, _, pyramid) = small_scene("e7f16");
        let sound = Ray {
            u: 0.1,
            v: 0.2,
            du: 0.3,
            dv: 0.4,
        };
        let mut rays = vec![sound; 5000];
        for index in [4000, 1234, 4999] {
            rays[index].dv = f64::NAN;
        }
        let error = walk_rays(scene.walk, &pyramid, &rays, &|_| ()).unwrap_err();
        assert!(matches!(error, WalkRaysError::Ray { index: 1234, .. }));
        assert!(error.to_string().contains("`dv` is NaN"), "{error}");
    }

    #[test]
    fn the_first_pixel_at_fault_is_named() {
        let (mut scene, _, pyramid) = small_scene("e2f4");
        scene.surface.depth_scale = 2000.0;
        let error = walk_scene(&scene, &pyramid, &|_| ()).unwrap_err();
        let WalkFrameError::Format { x, y, .. } = error else {
            panic!("{error}");
        };
        let (view, checker) = (scene.view(), Walker::new(scene.walk, &pyramid).unwrap());
        let first = (0..32 * 24)
            .map(|pixel| (pixel % 32, pixel / 32))
            .find(|&(x, y)| admit(&checker, &view, x, y).is_err());
        assert_eq!(Some((x, y)), first);
        assert!(
            error
                .to_string()
                .contains("more than the 4 that e2f4 tells apart"),
            "{error}"
        );
    }

    #[test]
    fn no_rays_have_no_mean() {
        let (_, _, pyramid) = small_scene("e7f16");
        let walk = Walk {
            method: Method::Oh,
            format: "f64".parse().unwrap(),
            crossing: Crossing::Index,
        };
        let hits = walk_rays(walk, &pyramid, &[], &|_| ()).unwrap();
        let counts = Counts::of(&hits);
        assert_eq!((counts.mean_steps(), counts.mean_crossings()), (None, None));
    }
}
