//! `stepwell render`: pictures and counts of a scene from the golden model.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use serde::Serialize;

use rtl_model::frame::{Frame, walk_scene};
use rtl_model::maps::{HeightMap, Pyramid};
use rtl_model::picture::{
    Plot, PlotAxis, Series, depth_picture, save_png, shaded_picture, steps_picture,
};
use rtl_model::scene::Scene;

use super::Outcome;
use crate::machine::{MachineReport, MachineScene, machine_of};
use crate::options::{AnswerOptions, SceneOptions, ThreadOptions};
use crate::output::OutputFolder;
use crate::summary::{WalkSummary, json, table};
use crate::{progress, terminal};

/// Pictures (shaded, steps, depth) and counts of a scene, from the golden model
///
/// Walks the view ray of every pixel in the scene's number format, bit for bit as the hardware
/// does, and writes shaded.png, steps.png and depth.png: all three or none. Exit code 1 says that
/// some ray found no hit within the step bound.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  stepwell render scenes/first.toml -o out/first")]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneOptions,

    /// Folder for the pictures, made if missing; out/NAME of the scene unless told
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    /// Run the scene's machine too, clock by clock: prints what it counts, and draws how full its
    /// loop is over time, into occupancy.png
    #[arg(long)]
    machine: bool,

    #[command(flatten)]
    threads: ThreadOptions,

    #[command(flatten)]
    answer: AnswerOptions,
}

const PICTURES: [&str; 3] = ["shaded.png", "steps.png", "depth.png"];
const OCCUPANCY: &str = "occupancy.png";

/// The JSON of a render: that of the walk, and what it was a walk of.
#[derive(Serialize)]
struct Summary {
    #[serde(flatten)]
    walk: WalkSummary,
    scene: String,
    width: u32,
    height: u32,
    pictures: Vec<PathBuf>,
    /// Of a machine, what its run came to.
    #[serde(flatten)]
    machine: Option<MachineReport>,
}

/// Renders the scene.
pub fn run(arguments: Arguments) -> anyhow::Result<Outcome> {
    let scene = arguments.scene.load()?;
    let map = scene.load_map()?;
    let path = match arguments.output {
        Some(path) => path,
        None => Path::new("out").join(&scene.name),
    };
    let folder = OutputFolder::prepare(&path)?;

    let pyramid = Pyramid::new(&map);
    let pixels = u64::from(scene.frame.width) * u64::from(scene.frame.height);
    let bar = progress::bar(pixels, "pixels");
    let start = Instant::now();
    let walked = arguments
        .threads
        .run(|| walk_scene(&scene, &pyramid, &|pixels| bar.inc(pixels)))?;
    let time = start.elapsed();
    bar.finish_and_clear();
    let frame = walked?;

    let machine = match arguments.machine {
        true => Some(run_machine(&scene)?),
        false => None,
    };
    folder.publish(|folder| {
        save_pictures(folder, &scene, &map, &frame)?;
        match &machine {
            Some(report) => save_occupancy(folder, &scene, report),
            None => Ok(()),
        }
    })?;
    let mut pictures: Vec<PathBuf> = PICTURES.iter().map(|name| path.join(name)).collect();
    pictures.extend(machine.iter().map(|_| path.join(OCCUPANCY)));
    let summary = Summary {
        walk: WalkSummary::new(
            "stepwell-render-1",
            &scene.map.source,
            frame.fit.walk,
            &frame.counts,
            time,
        )
        .fitted(&frame.fit),
        scene: scene.name,
        width: frame.width,
        height: frame.height,
        pictures,
        machine,
    };
    let text = if arguments.answer.json {
        json(&summary)?
    } else {
        summary.table(&scene.map.source.to_string(), frame.counts.rays)
    };
    terminal::answer(|output| output.write_all(text.as_bytes()))?;
    let agrees = summary.machine.as_ref().is_none_or(MachineReport::agrees);
    Ok(match agrees {
        true => summary.walk.outcome(),
        false => Outcome::Disagreed,
    })
}

/// Runs the golden machine of the scene.
fn run_machine(scene: &Scene) -> anyhow::Result<MachineReport> {
    let machine = machine_of(scene)?;
    Ok(MachineScene::of(scene, &machine)?.golden_run(None))
}

fn save_occupancy(folder: &Path, scene: &Scene, report: &MachineReport) -> anyhow::Result<()> {
    let axis = |label: &str| PlotAxis {
        label: label.to_owned(),
        logarithmic: false,
    };
    let plot = Plot {
        title: format!(
            "{}: how full the loop of machine {} is",
            scene.name, report.machine
        ),
        x: axis("cycle"),
        y: axis("trips begun a cycle"),
        diagonal: false,
        series: vec![Series {
            name: "trips".to_owned(),
            points: report.occupancy_points(),
            joined: true,
        }],
    };
    Ok(save_png(&plot.draw(), &folder.join(OCCUPANCY))?)
}

fn save_pictures(
    folder: &Path,
    scene: &Scene,
    map: &HeightMap,
    frame: &Frame,
) -> anyhow::Result<()> {
    let drawn = frame.to_picture()?;
    let title = format!(
        "{}, {} in {}",
        scene.name, scene.walk.method, scene.walk.format
    );
    let pictures = [
        shaded_picture(&drawn, map, &scene.surface, &scene.light),
        steps_picture(&drawn, &title, None),
        depth_picture(&drawn, &title, None),
    ];
    for (name, picture) in PICTURES.iter().zip(&pictures) {
        save_png(picture, &folder.join(name))?;
    }
    Ok(())
}

impl Summary {
    fn table(&self, map: &str, rays: u64) -> String {
        let pixels = u64::from(self.width) * u64::from(self.height);
        let mut rows = vec![
            ("scene", self.scene.clone()),
            ("map", map.to_owned()),
            (
                "frame",
                format!(
                    "{} x {} pixels, {rays} of {pixels} with a ray",
                    self.width, self.height
                ),
            ),
        ];
        rows.extend(self.walk.rows());
        rows.extend(self.machine.iter().flat_map(MachineReport::rows));
        let names = std::iter::once("pictures").chain(std::iter::repeat(""));
        let paths = self.pictures.iter().map(|path| path.display().to_string());
        rows.extend(names.zip(paths));
        table(&rows)
    }
}
