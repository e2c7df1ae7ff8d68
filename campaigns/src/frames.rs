//! Whole frames of the real maps, by every method that promises not to miss, judged by the exact
//! reference.
//!
//! The truth of a frame is worked out once for a format and judges all methods. Maps are taken as
//! they are, tiled, and enlarged: a tiled map has the same texels under more levels, an enlarged one
//! (bilinear) has so many more texels on the way of each ray, and they are so much narrower.

use std::fmt;
use std::path::Path;
use std::str::FromStr;
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use rtl_model::calibration::{CAMERAS, CalibratedSurface, MAPS_VARIABLE, SURFACES, real_maps};
use rtl_model::camera::{Surface, View};
use rtl_model::judge::{Truth, Verdict};
use rtl_model::maps::{Channel, Enlargement, HeightMap, MapSource, Pyramid, enlarged, tiled};
use rtl_model::ray::Ray;
use rtl_model::scene::{Crossing, FrameSize, Method, WalkFormat};
use serde::Serialize;

/// What is made of the maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Nothing: 256 texels a side, 128 of two.
    Own,
    /// Repeated to so many texels a side.
    Tiled(u32),
    /// Drawn larger, to so many.
    Enlarged(u32),
}

impl Variant {
    /// Those of the targets.
    pub const ALL: [Variant; 5] = [
        Variant::Own,
        Variant::Tiled(1024),
        Variant::Tiled(4096),
        Variant::Enlarged(1024),
        Variant::Enlarged(4096),
    ];
}

impl fmt::Display for Variant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Variant::Own => f.write_str("own"),
            Variant::Tiled(size) => write!(f, "tiled:{size}"),
            Variant::Enlarged(size) => write!(f, "enlarged:{size}"),
        }
    }
}

impl FromStr for Variant {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let known = Variant::ALL
            .into_iter()
            .find(|variant| variant.to_string() == text);
        known.ok_or_else(|| {
            let names = Variant::ALL.map(|variant| variant.to_string());
            format!("unknown variant `{text}`: there is {}", names.join(", "))
        })
    }
}

/// A height map, its pyramid, and how it lies on the plane.
pub struct Subject {
    /// As in the paper's tables; `procedural:...` where it stands in for a real one.
    pub name: String,
    map: HeightMap,
    pyramid: Pyramid,
    surface: Surface,
}

impl Subject {
    /// The map of one of the calibrated surfaces as `variant` has it. Where there are no real maps
    /// a procedural one stands in, and is said to.
    ///
    /// # Errors
    /// A map that cannot be read, or that is not there in CI.
    pub fn load(
        workspace: &Path,
        calibrated: &CalibratedSurface,
        variant: Variant,
    ) -> anyhow::Result<Subject> {
        let (name, map) = match real_maps(workspace)? {
            Some(folder) => {
                let path = folder.join(calibrated.file);
                let map = HeightMap::load(&path, Channel::Alpha, false)?;
                (calibrated.name.to_owned(), map)
            }
            None => {
                let recipe = format!("procedural:rocks:{}:1", calibrated.size);
                let map = MapSource::parse(&recipe)?.load(Channel::Grey, false)?;
                (format!("{recipe} (set {MAPS_VARIABLE})"), map)
            }
        };
        let surface = calibrated.surface;
        let (map, surface) = match variant {
            Variant::Own => (map, surface),
            Variant::Tiled(size) => {
                let copies = size / map.size();
                (tiled(&map, size)?, surface.with_tiled_map(copies))
            }
            Variant::Enlarged(size) => (enlarged(&map, size, Enlargement::Bilinear)?, surface),
        };
        Ok(Subject {
            name,
            pyramid: Pyramid::new(&map),
            map,
            surface,
        })
    }

    /// The map and its pyramid alone.
    pub fn into_map_and_pyramid(self) -> (HeightMap, Pyramid) {
        (self.map, self.pyramid)
    }

    fn rays(&self, camera: usize, screen: FrameSize) -> Vec<Ray<f64>> {
        let view = View::new(
            &CAMERAS[camera].1,
            &self.surface,
            screen.width,
            screen.height,
        );
        (0..screen.height)
            .flat_map(|y| (0..screen.width).map(move |x| (x, y)))
            .filter_map(|(x, y)| view.ray(x, y))
            .map(|ray| ray.reduced())
            .collect()
    }
}

/// What a method came to, over all maps and cameras.
#[derive(Clone, Debug, Serialize)]
pub struct FrameRow {
    /// The traversal.
    pub method: String,
    /// The number format.
    pub format: String,
    /// What was made of the maps.
    pub variant: String,
    /// Pixels of a frame.
    pub screen: String,
    /// Rays walked and judged.
    pub rays: u64,
    /// Rays beyond the reach of the unit or of the format: not walked.
    pub refused: u64,
    /// Hits in another texel than the exact one.
    pub wrong: u64,
    /// Hits beyond the exact one.
    pub late: u64,
    /// Walks that ended at the step bound.
    pub guards: u64,
    /// How much earlier than the exact hit the earliest is, in depth.
    pub most_early: f64,
    /// Steps of a ray in the mean.
    pub mean_steps: f64,
    /// Wall-clock seconds of walking.
    pub seconds: f64,
    /// The most wrong texels that may be, as a share of the rays.
    pub most_wrong_share: f64,
    /// No guard, nothing late, no more wrong than may be, and something was walked.
    pub agreed: bool,
}

impl FrameRow {
    fn new(
        method: Method,
        format: WalkFormat,
        variant: Variant,
        screen: FrameSize,
        verdict: Verdict,
        refused: u64,
        time: Duration,
    ) -> FrameRow {
        let most_wrong_share = most_wrong_share(format, variant);
        let share = verdict.wrong_share();
        FrameRow {
            method: method.to_string(),
            format: format.to_string(),
            variant: variant.to_string(),
            screen: format!("{}x{}", screen.width, screen.height),
            rays: verdict.rays,
            refused,
            wrong: verdict.wrong,
            late: verdict.late,
            guards: verdict.guards,
            most_early: verdict.most_early,
            mean_steps: verdict.mean_steps().unwrap_or(f64::NAN),
            seconds: time.as_secs_f64(),
            most_wrong_share,
            agreed: verdict.guards + verdict.late == 0
                && share.is_some_and(|share| share <= most_wrong_share),
        }
    }

    /// One line for a terminal.
    pub fn line(&self) -> String {
        format!(
            "{:<16} {:<6} {:<13} {:>9} {:>10} rays {:>7} refused {:>6} wrong ({:.4} %) {:>3} late \
             {:>3} guards {:>6.2} steps {:>7.1} s{}",
            self.method,
            self.format,
            self.variant,
            self.screen,
            self.rays,
            self.refused,
            self.wrong,
            100.0 * self.wrong as f64 / self.rays.max(1) as f64,
            self.late,
            self.guards,
            self.mean_steps,
            self.seconds,
            if self.agreed { "" } else { "  MISSED" }
        )
    }
}

/// The targets: none wrong where nothing is rounded into a texel; of the 24-bit float 0.05 % on the
/// maps' own sizes and 0.5 % on larger ones.
fn most_wrong_share(format: WalkFormat, variant: Variant) -> f64 {
    match (format, variant) {
        (WalkFormat::F64 | WalkFormat::Exact | WalkFormat::Fixed(_), _) => 0.0,
        (WalkFormat::Float(_), Variant::Own) => 0.0005,
        (WalkFormat::Float(_), _) => 0.005,
    }
}

/// What is walked.
#[derive(Clone, Debug)]
pub struct FrameRun {
    /// What is made of the maps.
    pub variant: Variant,
    /// The number format.
    pub format: WalkFormat,
    /// The traversals.
    pub methods: Vec<Method>,
    /// Pixels of each frame.
    pub screen: FrameSize,
}

impl FrameRun {
    /// Frames that [`FrameRun::walk`] tells of, one at a time: a truth, or a method on a frame.
    pub fn frames(&self) -> u64 {
        (SURFACES.len() * CAMERAS.len() * (self.methods.len() + 1)) as u64
    }

    /// Walks seven maps from three cameras by every method, and judges each hit. `frame_done` is
    /// called after each frame.
    ///
    /// # Errors
    /// A map that is not there, or a method that does not go with the format.
    pub fn walk(&self, workspace: &Path, frame_done: &dyn Fn()) -> anyhow::Result<Vec<FrameRow>> {
        if self.methods.is_empty() {
            bail!("frames: no method is named so, and nothing would be walked");
        }
        let mut sums = vec![(Verdict::default(), Duration::ZERO); self.methods.len()];
        let mut refused = 0;
        for calibrated in &SURFACES {
            let subject = Subject::load(workspace, calibrated, self.variant)?;
            for (camera, (camera_name, _)) in CAMERAS.iter().enumerate() {
                let rays = subject.rays(camera, self.screen);
                let name = || format!("{} {camera_name}, {}", subject.name, self.variant);
                let (map, pyramid) = (&subject.map, &subject.pyramid);
                let truth = Truth::of(self.format, map, pyramid, &rays, &|_| ());
                let truth = truth.with_context(name)?;
                refused += truth.refused();
                frame_done();
                for (method, (sum, time)) in self.methods.iter().zip(&mut sums) {
                    let start = Instant::now();
                    let verdict = truth
                        .judge_walk(*method, Crossing::Index, pyramid, &|_| ())
                        .with_context(name)?;
                    *sum = sum.plus(verdict);
                    *time += start.elapsed();
                    frame_done();
                }
            }
        }
        let rows = self.methods.iter().zip(sums).map(|(&method, (sum, time))| {
            let (format, variant) = (self.format, self.variant);
            FrameRow::new(method, format, variant, self.screen, sum, refused, time)
        });
        Ok(rows.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variants_read_back_from_their_names() {
        for variant in Variant::ALL {
            assert_eq!(variant.to_string().parse(), Ok(variant));
        }
        let message = "tiled:3".parse::<Variant>().unwrap_err();
        assert!(message.contains("tiled:1024"), "{message}");
    }

    #[test]
    fn a_row_is_missed_by_any_defect() {
        let sound = Verdict {
            rays: 1000,
            right: 1000,
            ..Verdict::default()
        };
        let agreed = |format: &str, verdict: Verdict| {
            let screen = FrameSize {
                width: 1,
                height: 1,
            };
            let (method, format) = (Method::Oh, format.parse().unwrap());
            FrameRow::new(
                method,
                format,
                Variant::Tiled(4096),
                screen,
                verdict,
                0,
                Duration::ZERO,
            )
            .agreed
        };
        assert!(agreed("f64", sound) && agreed("e7f16", sound));
        let wrong = Verdict { wrong: 1, ..sound };
        assert!(!agreed("f64", wrong) && !agreed("exact", wrong) && agreed("e7f16", wrong));
        assert!(!agreed("e7f16", Verdict { wrong: 6, ..sound }));
        assert!(!agreed("e7f16", Verdict { late: 1, ..sound }));
        assert!(!agreed("e7f16", Verdict { guards: 1, ..sound }));
        assert!(!agreed("f64", Verdict::default()), "nothing was walked");
    }
}
