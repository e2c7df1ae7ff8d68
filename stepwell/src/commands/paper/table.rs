//! A table of the 2013 hardware paper: walked, judged, set beside the paper's figures.

use std::collections::BTreeSet;
use std::time::Instant;

use anyhow::{Context, bail};

use rtl_model::calibration::{CAMERAS, SURFACES};
use rtl_model::judge::{Truth, Verdict};
use rtl_model::maps::Pyramid;
use rtl_model::published::{Cell, Table};
use rtl_model::scene::{Crossing, Method, Walk, WalkFormat};
use rtl_model::walker::Walker;

use super::report::{OurCell, Report};
use super::subject::frame_rays;
use super::{MapsOption, TableArguments};
use crate::commands::Outcome;
use crate::output::OutputFolder;
use crate::{progress, terminal};

/// Shows one table.
pub fn run(table: Table, arguments: TableArguments) -> anyhow::Result<Outcome> {
    let start = Instant::now();
    let format = arguments.format.of_walk()?;
    let cells = wanted(table, &arguments)?;
    let folder = arguments.output.as_deref().map(OutputFolder::prepare);
    let folder = folder.transpose()?;
    let verdicts = walk_all(&cells, format, &arguments)?;
    let ours = cells
        .into_iter()
        .zip(verdicts)
        .map(|(cell, verdict)| OurCell::new(table, cell, &verdict))
        .collect();
    let report = Report::new(table, format, arguments.screen(), ours, start.elapsed());
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

/// The cells of the table whose methods are wanted. Table 4 takes any method: of those that the
/// paper does not have, its cells are without a figure.
fn wanted(table: Table, arguments: &TableArguments) -> anyhow::Result<Vec<Cell>> {
    let cells = table.cells();
    if arguments.method.is_empty() {
        return Ok(cells);
    }
    let mut chosen = Vec::new();
    for (number, &method) in arguments.method.iter().enumerate() {
        if arguments.method[..number].contains(&method) {
            continue;
        }
        let own: Vec<Cell> = cells
            .iter()
            .copied()
            .filter(|cell| cell.method == method)
            .collect();
        if !own.is_empty() {
            chosen.extend(own);
        } else if table == Table::StepsPerPixel {
            chosen.extend(without_figures(method));
        } else {
            let mut known: Vec<String> = Vec::new();
            for cell in &cells {
                let name = cell.method.to_string();
                if !known.contains(&name) {
                    known.push(name);
                }
            }
            bail!(
                "--method {method}: table {} has {}",
                table.number(),
                known.join(", ")
            );
        }
    }
    Ok(chosen)
}

/// All frames of a method that the paper has no figures of.
fn without_figures(method: Method) -> impl Iterator<Item = Cell> {
    let frames = (0..SURFACES.len()).flat_map(|surface| {
        let cameras = 0..CAMERAS.len();
        cameras.map(move |camera| (surface, camera))
    });
    frames.map(move |(surface, camera)| Cell {
        method,
        surface,
        camera,
        figure: None,
    })
}

/// Walks every cell's frame and judges it. Cells of the same frame share its truth.
fn walk_all(
    cells: &[Cell],
    format: WalkFormat,
    arguments: &TableArguments,
) -> anyhow::Result<Vec<Verdict>> {
    let maps: &MapsOption = &arguments.maps;
    let folder = maps.folder()?;
    let frames: BTreeSet<(usize, usize)> = cells
        .iter()
        .map(|cell| (cell.surface, cell.camera))
        .collect();
    let surfaces: BTreeSet<usize> = cells.iter().map(|cell| cell.surface).collect();
    let mut verdicts = vec![None; cells.len()];

    // All that can be refused is refused before anything takes long.
    let mut loaded = Vec::new();
    for surface in surfaces {
        let map = maps.load(&folder, surface)?;
        let pyramid = Pyramid::new(&map);
        for cell in cells.iter().filter(|cell| cell.surface == surface) {
            let walk = Walk {
                method: cell.method,
                format,
                crossing: Crossing::Index,
            };
            Walker::new(walk, &pyramid)
                .context("choose other methods with --method, or another --format")?;
        }
        loaded.push((surface, map, pyramid));
    }
    // A frame is walked once for the truth, and once for each of its cells.
    let pixels = u64::from(arguments.screen().width) * u64::from(arguments.screen().height);
    let bar = progress::bar(
        pixels * (frames.len() + cells.len()) as u64,
        "pixels of all frames",
    );
    let result = arguments.threads.run(|| -> anyhow::Result<()> {
        for (surface, map, pyramid) in &loaded {
            for (camera, (camera_name, _)) in CAMERAS.iter().enumerate() {
                if !frames.contains(&(*surface, camera)) {
                    continue;
                }
                let calibrated = &SURFACES[*surface];
                let rays = frame_rays(&calibrated.surface, camera, arguments.screen());
                // Pixels without a ray take no time.
                let skipped = pixels - rays.len() as u64;
                let name = || format!("{} {camera_name}", calibrated.name);
                let truth = Truth::of(format, map, pyramid, &rays, &|rays| bar.inc(rays))
                    .with_context(name)?;
                bar.inc(skipped);
                for (cell, verdict) in cells.iter().zip(&mut verdicts) {
                    if (cell.surface, cell.camera) != (*surface, camera) {
                        continue;
                    }
                    let judged =
                        truth.judge_walk(cell.method, Crossing::Index, pyramid, &|n| bar.inc(n));
                    *verdict = Some((judged.with_context(name)?, truth.refused()));
                    bar.inc(skipped + truth.refused());
                }
            }
        }
        Ok(())
    });
    bar.finish_and_clear();
    result??;
    let mut judged = Vec::with_capacity(cells.len());
    for (cell, verdict) in cells.iter().zip(verdicts) {
        let (verdict, refused) = verdict.context("a cell that was not walked")?;
        let name = format!("{} {}", SURFACES[cell.surface].name, CAMERAS[cell.camera].0);
        if refused > 0 {
            bail!(
                "{name}: {refused} rays are beyond the reach of {format}; take a format with more \
                 fraction bits"
            );
        }
        if verdict.rays == 0 {
            bail!("{name}: no pixel has a ray; take a larger --screen");
        }
        judged.push(verdict);
    }
    Ok(judged)
}
