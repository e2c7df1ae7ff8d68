//! `stepwell trace`: any rays against any map, the golden model as a filter.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::bail;
use clap::Args;
use serde::Serialize;

use rtl_model::frame::{Counts, fit_rays, walk_rays};
use rtl_model::maps::Pyramid;
use rtl_model::scene::{Crossing, Method, Walk, WalkFormat};
use rtl_model::walker::Walker;

use super::Outcome;
use crate::options::{AnswerOptions, MapOptions, ThreadOptions};
use crate::output::OutputFile;
use crate::rays::{RaySource, write_hits};
use crate::summary::{WalkSummary, json, table};
use crate::{progress, terminal};

/// Any rays of yours against any map: the golden model as a filter
///
/// Rays are CSV with the header u,v,du,dv, a ray a line, decimal or hex floats (-0.25, 1e-3,
/// -0x1p-2): where the ray enters the top plane and how far it goes for one unit of depth, 1.0 being
/// one repeat of the map. Entries are reduced to [0, 1), then rounded into the format, u and v
/// toward zero, du and dv to nearest.
///
/// Hits are CSV with the header i,j,t,u,v,steps,crossings,status, one line a ray in the same
/// order: the texel, the depth, the position on the ray (it goes on past 1 where the map repeats),
/// the cost, and hit or guard. t, u and v read back to the very bits of the format; of the format
/// exact, they are the nearest f64.
///
/// If any ray is bad nothing is written. Exit code 1 says that some ray found no hit within the
/// step bound.
#[derive(Args, Debug)]
#[command(
    mut_arg("map", |map| map.required(true)),
    after_help = "Example:\n  printf 'u,v,du,dv\\n0.5,0.25,0.1,-0x1p-2\\n' |\n    \
                  stepwell trace --map procedural:rocks:256:1 --rays -"
)]
pub struct Arguments {
    #[command(flatten)]
    map: MapOptions,

    /// Ray file; - reads standard input
    #[arg(long, value_name = "CSV")]
    rays: RaySource,

    /// Hit file, standard output unless told; it appears whole or not at all
    #[arg(short, long, value_name = "CSV")]
    output: Option<PathBuf>,

    /// Number format: eXfY with X exponent and Y fraction bits, or f64, or exact, or fixed
    /// point: fixed, or qI.F with I integer bits of the slope and F fraction bits
    #[arg(long, value_name = "FORMAT", default_value = "e7f16")]
    format: WalkFormat,

    /// Traversal, such as oh, mixed-selective or block
    #[arg(long, value_name = "METHOD", default_value = "oh")]
    method: Method,

    /// How borders are crossed: index, or offset:X with X texels beyond the border (published, for
    /// comparison)
    #[arg(long, value_name = "CROSSING", default_value = "index")]
    crossing: Crossing,

    #[command(flatten)]
    threads: ThreadOptions,

    #[command(flatten)]
    answer: AnswerOptions,
}

/// The JSON of a trace: that of the walk, and its files.
#[derive(Serialize)]
struct Summary {
    #[serde(flatten)]
    walk: WalkSummary,
    rays_file: String,
    hits_file: PathBuf,
}

/// Traces the rays.
pub fn run(arguments: Arguments) -> anyhow::Result<Outcome> {
    let output = arguments.output.filter(|path| path != Path::new("-"));
    if arguments.answer.json && output.is_none() {
        bail!("--json takes standard output for the summary: give the hits a file with -o");
    }
    let Some(source) = arguments.map.chosen() else {
        bail!("no height map is named: give one with --map");
    };
    let walk = Walk {
        method: arguments.method,
        format: arguments.format,
        crossing: arguments.crossing,
    };
    let map = source.source.load(source.channel, source.white_is_low)?;
    let pyramid = Pyramid::new(&map);
    let rays = arguments.rays.read(&Walker::new(walk, &pyramid)?)?;
    let fit = fit_rays(walk, &pyramid, &rays)?;
    let file = output.as_deref().map(OutputFile::prepare).transpose()?;

    let bar = progress::bar(rays.len() as u64, "rays");
    let start = Instant::now();
    let walked = arguments
        .threads
        .run(|| walk_rays(fit.walk, &pyramid, &rays, &|rays| bar.inc(rays)))?;
    let time = start.elapsed();
    bar.finish_and_clear();
    let hits = walked?;

    let counts = Counts::of(&hits);
    let walk =
        WalkSummary::new("stepwell-trace-1", &source.source, fit.walk, &counts, time).fitted(&fit);
    let (Some(file), Some(path)) = (file, output) else {
        terminal::answer(|output| write_hits(output, &hits))?;
        return Ok(walk.outcome());
    };
    file.publish(|output| write_hits(output, &hits))?;
    let summary = Summary {
        walk,
        rays_file: arguments.rays.to_string(),
        hits_file: path,
    };
    let text = if arguments.answer.json {
        json(&summary)?
    } else {
        summary.table(&source.source.to_string(), counts.rays)
    };
    terminal::answer(|output| output.write_all(text.as_bytes()))?;
    Ok(summary.walk.outcome())
}

impl Summary {
    fn table(&self, map: &str, rays: u64) -> String {
        let mut rows = vec![
            ("map", map.to_owned()),
            ("rays", format!("{rays} of {}", self.rays_file)),
        ];
        rows.extend(self.walk.rows());
        rows.push(("hits", self.hits_file.display().to_string()));
        table(&rows)
    }
}
