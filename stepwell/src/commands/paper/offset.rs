//! What crossing a border by a small offset costs, beside the carried index.

mod report;

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, bail};
use clap::{Args, ValueEnum};

use rtl_model::calibration::{CAMERAS, SURFACES};
use rtl_model::judge::{Truth, Verdict};
use rtl_model::maps::{Enlargement, HeightMap, Pyramid, enlarged, tiled};
use rtl_model::scene::{BorderOffset, Crossing, Family, Method, Walk, WalkFormat};
use rtl_model::walker::Walker;

use self::report::{Case, OffsetReport};
use super::MapsOption;
use super::subject::frame_rays;
use crate::commands::Outcome;
use crate::options::{AnswerOptions, Size, ThreadOptions};
use crate::output::OutputFolder;
use crate::{progress, terminal};

/// Of the table of offsets.
#[derive(Args, Debug)]
pub struct OffsetArguments {
    /// Pixels of each of the 21 frames
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "96x72")]
    screen: Size,

    /// Number formats: repeat the option, or put commas between
    #[arg(
        long,
        value_name = "FORMAT",
        value_delimiter = ',',
        default_value = "f64,e7f16,e8f23"
    )]
    format: Vec<WalkFormat>,

    /// Offsets in texels along the ray, on the axis on which that is quickest
    #[arg(
        long,
        value_name = "TEXELS",
        value_delimiter = ',',
        value_parser = parse_offset,
        default_value = "0.5,0.0625,0.015625,0.001,0.0001"
    )]
    offset: Vec<BorderOffset>,

    /// Sides of the maps in texels, at least the maps' own 128 and 256
    #[arg(
        long,
        value_name = "TEXELS",
        value_delimiter = ',',
        default_value = "256,1024,4096"
    )]
    map_size: Vec<u32>,

    /// How maps are made larger
    #[arg(long, value_enum, default_value_t = Larger::Enlarged)]
    larger: Larger,

    /// The traversal, one that looks at a node a step
    #[arg(long, value_name = "METHOD", default_value = "oh")]
    method: Method,

    #[command(flatten)]
    maps: MapsOption,

    /// Folder for offset.csv, offset.json and offset.png, made if missing
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    #[command(flatten)]
    threads: ThreadOptions,

    #[command(flatten)]
    answer: AnswerOptions,
}

/// How a map is made larger.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Larger {
    /// Drawn larger, between the texels linearly: rays travel over more texels
    Enlarged,
    /// Repeated: rays travel over as many texels as before. All sizes look alike to a float once
    /// the scene lies within one repeat
    Tiled,
}

impl Larger {
    fn name(self) -> &'static str {
        match self {
            Larger::Tiled => "tiled",
            Larger::Enlarged => "enlarged",
        }
    }
}

fn parse_offset(text: &str) -> Result<BorderOffset, String> {
    let texels = text.parse().ok().and_then(BorderOffset::new);
    texels.ok_or_else(|| format!("`{text}` is no offset: texels above 0 and at most 1"))
}

/// The index, then the offsets, the largest first.
fn crossings(offsets: &[BorderOffset]) -> Vec<Crossing> {
    let mut offsets = offsets.to_vec();
    offsets.sort_by(|a, b| b.texels().total_cmp(&a.texels()));
    offsets.dedup();
    let offsets = offsets.into_iter().map(Crossing::Offset);
    std::iter::once(Crossing::Index).chain(offsets).collect()
}

/// Shows the table.
pub fn run(arguments: OffsetArguments) -> anyhow::Result<Outcome> {
    let start = Instant::now();
    let crossings = crossings(&arguments.offset);
    check_walks(&arguments, &crossings)?;
    let folder = arguments.output.as_deref().map(OutputFolder::prepare);
    let folder = folder.transpose()?;
    let maps = load(&arguments)?;
    let cases = arguments
        .threads
        .run(|| judge(&arguments, &crossings, &maps))??;
    let report = OffsetReport::new(
        arguments.method,
        arguments.larger.name(),
        arguments.screen.0,
        cases,
        start.elapsed(),
    );
    if let Some(folder) = folder {
        folder.publish(|folder| report.save(folder))?;
    }
    let text = match arguments.answer.json {
        true => crate::summary::json(&report)?,
        false => report.text(),
    };
    terminal::answer(|output| output.write_all(text.as_bytes()))?;
    Ok(report.outcome())
}

/// Refuses what cannot be walked, before anything takes long.
fn check_walks(arguments: &OffsetArguments, crossings: &[Crossing]) -> anyhow::Result<()> {
    if !matches!(arguments.method.family(), Family::Nodes(_)) {
        bail!(
            "--method {}: a position is moved beyond a border only by methods that look at a node \
             a step, such as oh or mixed-selective",
            arguments.method
        );
    }
    let flat = HeightMap::new("flat", 1, 8, vec![0])?;
    let pyramid = Pyramid::new(&flat);
    for &format in &arguments.format {
        for &crossing in crossings {
            let walk = Walk {
                method: arguments.method,
                format,
                crossing,
            };
            Walker::new(walk, &pyramid)
                .context("choose other formats with --format, or another --method")?;
        }
    }
    for &size in &arguments.map_size {
        tiled(&flat, size).with_context(|| format!("--map-size {size}"))?;
    }
    Ok(())
}

/// The seven maps at their own sizes, none larger than any that is asked for.
fn load(arguments: &OffsetArguments) -> anyhow::Result<Vec<HeightMap>> {
    let folder = arguments.maps.folder()?;
    let numbers = 0..SURFACES.len();
    let maps = numbers.map(|number| arguments.maps.load(&folder, number));
    let maps = maps.collect::<anyhow::Result<Vec<_>>>()?;
    for &size in &arguments.map_size {
        if let Some(map) = maps.iter().find(|map| map.size() > size) {
            tiled(map, size).with_context(|| format!("--map-size {size}"))?;
        }
    }
    Ok(maps)
}

/// Walks every frame in every format by every crossing. Crossings share the truth of a frame; one
/// map is held at a time.
fn judge(
    arguments: &OffsetArguments,
    crossings: &[Crossing],
    maps: &[HeightMap],
) -> anyhow::Result<Vec<Case>> {
    let screen = arguments.screen.0;
    let (formats, sizes) = (&arguments.format, &arguments.map_size);
    // A frame has as many rays whatever the size of its map.
    let frames = SURFACES.iter().flat_map(|calibrated| {
        let of_camera = |camera| frame_rays(&calibrated.surface, camera, screen).len();
        (0..CAMERAS.len()).map(of_camera)
    });
    let passes = formats.len() * sizes.len() * (1 + crossings.len());
    let bar = progress::bar(
        (frames.sum::<usize>() * passes) as u64,
        "rays of all frames",
    );

    // By format, then size: the verdicts of all crossings, and the rays refused.
    let none = (vec![Verdict::default(); crossings.len()], 0);
    let mut sums = vec![vec![none; sizes.len()]; formats.len()];
    for (column, &size) in sizes.iter().enumerate() {
        for (original, calibrated) in maps.iter().zip(&SURFACES) {
            let (map, surface) = match arguments.larger {
                Larger::Enlarged => (
                    enlarged(original, size, Enlargement::Bilinear)?,
                    calibrated.surface,
                ),
                Larger::Tiled => (
                    tiled(original, size)?,
                    calibrated.surface.with_tiled_map(size / original.size()),
                ),
            };
            let pyramid = Pyramid::new(&map);
            for camera in 0..CAMERAS.len() {
                let rays = frame_rays(&surface, camera, screen);
                for (&format, row) in formats.iter().zip(&mut sums) {
                    let (verdicts, refused) = &mut row[column];
                    let truth = Truth::of(format, &map, &pyramid, &rays, &|rays| bar.inc(rays))?;
                    *refused += truth.refused();
                    for (&crossing, sum) in crossings.iter().zip(verdicts) {
                        let method = arguments.method;
                        let verdict =
                            truth.judge_walk(method, crossing, &pyramid, &|rays| bar.inc(rays))?;
                        *sum = sum.plus(verdict);
                        bar.inc(truth.refused());
                    }
                }
            }
        }
    }
    bar.finish_and_clear();
    let mut cases = Vec::new();
    for (&format, row) in formats.iter().zip(sums) {
        for (&size, (verdicts, refused)) in sizes.iter().zip(row) {
            for (&crossing, verdict) in crossings.iter().zip(&verdicts) {
                cases.push(Case::new(format, size, crossing, refused, verdict));
            }
        }
    }
    Ok(cases)
}
