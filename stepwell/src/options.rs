//! Options that several commands share, and what they do to a scene.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::{Context, bail};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use rtl_model::calibration::CAMERAS;
use rtl_model::camera::Camera;
use rtl_model::fixed::{FixedFormat, FixedFormatError};
use rtl_model::maps::{Channel, MapSource};
use rtl_model::scene::{
    Crossing, FrameSize, MAX_FRAME_SIDE, MachineKind, MachineLatencies, Method, Scene, SceneMap,
    WalkError, WalkFormat,
};

/// Which height map.
#[derive(Args, Clone, Debug)]
pub struct MapOptions {
    /// Height map, in place of the scene's where there is one: a PNG, TGA or PGM file, or
    /// procedural:NAME:SIZE:SEED such as procedural:rocks:256:1
    #[arg(long, value_name = "MAP")]
    pub map: Option<MapSource>,

    /// Part of the image that is the height: alpha, red, or grey, which is the default
    #[arg(long, value_name = "CHANNEL", requires = "map")]
    pub channel: Option<Channel>,

    /// Take black as high
    #[arg(long, requires = "map")]
    pub white_is_low: bool,
}

impl MapOptions {
    /// The map asked for, if there is one.
    pub fn chosen(&self) -> Option<SceneMap> {
        Some(SceneMap {
            source: self.map.clone()?,
            channel: self.channel.unwrap_or_default(),
            white_is_low: self.white_is_low,
        })
    }
}

/// A scene file, and what is replaced in it.
#[derive(Args, Clone, Debug)]
pub struct SceneOptions {
    /// Scene file (TOML)
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    #[command(flatten)]
    pub replacements: Replacements,
}

impl SceneOptions {
    /// Reads the scene and replaces in it what the options say.
    pub fn load(&self) -> anyhow::Result<Scene> {
        self.replacements.load(&self.scene)
    }
}

/// The format of a scene's numbers, or of an operator's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberFormat {
    /// One that a traversal computes in.
    Walk(WalkFormat),
    /// Fixed point, which only operators have.
    Fixed(FixedFormat),
}

impl NumberFormat {
    /// The format, of a traversal.
    ///
    /// # Errors
    /// If it is fixed point.
    pub fn of_walk(self) -> anyhow::Result<WalkFormat> {
        match self {
            NumberFormat::Walk(format) => Ok(format),
            NumberFormat::Fixed(format) if format.signed => Ok(WalkFormat::Fixed(Some(format))),
            NumberFormat::Fixed(format) => bail!(
                "--format {format}: of a traversal it is the format of slopes, which have a sign; \
                 take qI.F, such as q8.20, or fixed"
            ),
        }
    }
}

impl FromStr for NumberFormat {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text.starts_with('q') || text.starts_with("uq") {
            let format = text.parse().map(NumberFormat::Fixed);
            format.map_err(|problem: FixedFormatError| problem.to_string())
        } else {
            let format = text.parse().map(NumberFormat::Walk);
            format.map_err(|problem: WalkError| problem.to_string())
        }
    }
}

/// What is replaced in a scene.
#[derive(Args, Clone, Debug)]
pub struct Replacements {
    #[command(flatten)]
    pub map: MapOptions,

    /// Replace the scene's number format: eXfY with X exponent and Y fraction bits, such as e7f16,
    /// or f64, or exact, or fixed point: fixed, or qI.F with the slopes' bits, such as q8.20; of a
    /// fixed-point operator qI.F or uqI.F, such as q4.12
    #[arg(long, value_name = "FORMAT")]
    pub format: Option<NumberFormat>,

    /// Replace the scene's traversal, such as oh, mixed-selective or block
    #[arg(long, value_name = "METHOD")]
    pub method: Option<Method>,

    /// Replace the way borders are crossed: index, or offset:X with X texels beyond the border
    /// (published, for comparison)
    #[arg(long, value_name = "CROSSING")]
    pub crossing: Option<Crossing>,

    /// Replace the scene's camera by a calibrated one
    #[arg(long, value_name = "CAMERA", value_parser = camera_parser())]
    pub camera: Option<Camera>,

    /// Replace the scene's frame, in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    pub size: Option<Size>,

    /// Replace the cycles of the operators of a scene's machine of kind paper: adder, multiplier,
    /// divider, comparator and conversion, such as 2,1,2,1,1, which are the paper's
    #[arg(long, value_name = "CYCLES")]
    pub latencies: Option<Latencies>,
}

impl Replacements {
    /// Reads a scene and replaces in it what the options say.
    pub fn load(&self, path: &Path) -> anyhow::Result<Scene> {
        let mut scene = Scene::load(path)?;
        if let Some(map) = self.map.chosen() {
            scene.map = map;
        }
        if let Some(format) = self.format {
            scene.walk.format = format.of_walk()?;
        }
        if let Some(method) = self.method {
            scene.walk.method = method;
        }
        if let Some(crossing) = self.crossing {
            scene.walk.crossing = crossing;
        }
        if let Some(camera) = self.camera {
            scene.camera = camera;
        }
        if let Some(Size(size)) = self.size {
            scene.frame = size;
        }
        self.replace_latencies(&mut scene)?;
        Ok(scene)
    }

    /// Refuses, for a unit without a scene, what only a scene's machine has.
    pub fn none_of_machines(&self) -> anyhow::Result<()> {
        match self.latencies {
            None => Ok(()),
            Some(_) => {
                bail!("--latencies: they are of a scene's machine; of an operator give --latency")
            }
        }
    }

    fn replace_latencies(&self, scene: &mut Scene) -> anyhow::Result<()> {
        let name = &scene.name;
        let is_paper = |kind| kind == MachineKind::Paper;
        match (&mut scene.machine, self.latencies) {
            (Some(machine), Some(Latencies(latencies))) if is_paper(machine.kind) => {
                // The FIFOs that the scene says are those of its own latencies.
                machine.latencies = Some(latencies);
                machine.fifo = None;
            }
            (_, Some(_)) => bail!(
                "scene {name}: --latencies are of a machine of kind paper, and it has none; leave \
                 them out"
            ),
            (Some(machine), None) if machine.latencies.is_some() && !is_paper(machine.kind) => {
                bail!(
                    "scene {name}: latencies are of a machine of kind paper, and it is of kind {}; \
                     remove them",
                    machine.kind.name()
                )
            }
            _ => {}
        }
        Ok(())
    }
}

fn camera_parser() -> impl TypedValueParser<Value = Camera> {
    PossibleValuesParser::new(CAMERAS.map(|(name, _)| name)).try_map(|name| {
        let camera = CAMERAS.iter().find(|(known, _)| *known == name);
        camera.map(|(_, camera)| *camera).ok_or("no such camera")
    })
}

/// Cycles of the operators of the paper's machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Latencies(pub MachineLatencies);

impl FromStr for Latencies {
    type Err = String;

    fn from_str(text: &str) -> Result<Latencies, String> {
        const LONGEST: u32 = MachineLatencies::LONGEST;
        let cycles = text.split(',').map(|word| {
            let cycles = word.trim().parse().ok();
            cycles.filter(|cycles| (1..=LONGEST).contains(cycles))
        });
        let cycles: Option<Vec<u32>> = cycles.collect();
        match cycles.as_deref() {
            Some(&[adder, multiplier, divider, comparator, conversion]) => {
                Ok(Latencies(MachineLatencies {
                    adder,
                    multiplier,
                    divider,
                    comparator,
                    conversion,
                }))
            }
            _ => Err(format!(
                "five numbers of cycles, 1 to {LONGEST}, of adder, multiplier, divider, \
                 comparator and conversion, such as 2,1,8,1,1"
            )),
        }
    }
}

/// A frame's size as `WIDTHxHEIGHT`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub FrameSize);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let side = |text: &str| {
            let pixels = text.parse().ok()?;
            (1..=MAX_FRAME_SIDE).contains(&pixels).then_some(pixels)
        };
        text.split_once('x')
            .and_then(|(width, height)| {
                Some(Size(FrameSize {
                    width: side(width)?,
                    height: side(height)?,
                }))
            })
            .ok_or_else(|| {
                format!(
                    "`{text}` is not a size: it is written WIDTHxHEIGHT, such as 320x240, with 1 to \
                     {MAX_FRAME_SIDE} pixels a side"
                )
            })
    }
}

/// The most threads that can be asked for.
const MOST_THREADS: usize = 1024;

fn parse_threads(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|threads| (1..=MOST_THREADS).contains(threads))
        .ok_or_else(|| format!("`{text}` is not a number of threads, 1 to {MOST_THREADS}"))
}

/// How many processors to use.
#[derive(Args, Clone, Debug)]
pub struct ThreadOptions {
    /// Threads to compute with; all processors unless told. Results do not depend on it
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub threads: Option<usize>,
}

impl ThreadOptions {
    /// Does `work` with so many threads.
    pub fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> anyhow::Result<T> {
        // Zero is rayon's word for all processors.
        let threads = self.threads.unwrap_or(0);
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map(|pool| pool.install(work))
            .with_context(|| format!("--threads {threads}: cannot start them; ask for fewer"))
    }
}

/// How the command answers.
#[derive(Args, Clone, Debug)]
pub struct AnswerOptions {
    /// Print the summary as JSON, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn latencies_are_five_numbers() {
        let Latencies(read) = "2,2,8,1,2".parse().unwrap();
        assert_eq!((read.adder, read.divider, read.conversion), (2, 8, 2));
        for text in [
            "",
            "2,2,8,1",
            "2,2,8,1,2,1",
            "2,2,8,0,2",
            "2,2,33,1,2",
            "2,2,x,1,2",
        ] {
            let message = text.parse::<Latencies>().unwrap_err();
            assert!(message.contains("such as 2,1,8,1,1"), "{text}: {message}");
        }
    }

    #[test]
    fn sizes_are_read_within_their_range() {
        let size = |width, height| Ok(Size(FrameSize { width, height }));
        assert_eq!("320x240".parse(), size(320, 240));
        assert_eq!("1x8192".parse(), size(1, 8192));
        for text in [
            "", "320", "320x", "x240", "0x5", "8193x1", "-3x4", "3X4", "3x4x5",
        ] {
            let message = text.parse::<Size>().unwrap_err();
            assert!(message.contains("such as 320x240"), "{text}: {message}");
        }
    }
}
