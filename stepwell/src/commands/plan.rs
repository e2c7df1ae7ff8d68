//! `stepwell plan`: what a scene elaborates, and why.

use clap::Args;
use serde::Serialize;

use rtl_model::frame::{Fit, fit_scene};
use rtl_model::maps::Pyramid;
use rtl_model::scene::{Effects, Family, Scene, WalkFormat};
use rtl_model::units::fixed_ranges::fixed_ranges;
use rtl_model::units::search_policy::SearchPolicy;
use rtl_model::units::traverse::shape_for;
use rtl_model::units::traverse_step::{COUNTER_BITS, INDEX_BITS};

use super::Outcome;
use crate::options::{AnswerOptions, SceneOptions};
use crate::summary::json;
use crate::terminal;

/// Which units, passes and effects a scene elaborates, and why
///
/// A scene pays only for what it asks for: a unit that is not listed is not in its Verilog, is not
/// simulated and takes no area.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  stepwell plan scenes/first.toml")]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneOptions,

    #[command(flatten)]
    answer: AnswerOptions,
}

/// The plan, as JSON has it.
#[derive(Serialize)]
struct Plan {
    schema: &'static str,
    scene: String,
    map: String,
    method: String,
    format: String,
    /// Bits of a number; none where no hardware has the format.
    number_bits: Option<u32>,
    /// Texels on a side of the map.
    size: u32,
    /// Bits of a height.
    height_bits: u32,
    /// Level of the pyramid's root.
    root_level: u32,
    /// Words of the pyramid's memory.
    pyramid_words: usize,
    width: u32,
    height: u32,
    /// Pixels that have a view ray.
    rays: u64,
    /// In fixed point, the formats of the rays and why.
    #[serde(skip_serializing_if = "Option::is_none")]
    ray_format: Option<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    reasons: Vec<String>,
    /// In fixed point, what each signal of a step at a node can be with these rays.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    signals: Vec<SignalRange>,
    units: Vec<Part>,
    passes: Vec<Part>,
    effects: Vec<Part>,
}

/// A signal of the fixed-point step, by the interval reading. The ends are text: not every reader
/// of JSON holds integers of so many bits.
#[derive(Serialize)]
struct SignalRange {
    name: &'static str,
    /// Of a two's complement word.
    bits: u32,
    low: String,
    high: String,
}

/// Something that is elaborated.
#[derive(Serialize)]
struct Part {
    name: &'static str,
    why: String,
}

/// Plans the scene.
pub fn run(arguments: Arguments) -> anyhow::Result<Outcome> {
    let scene = arguments.scene.load()?;
    let map = scene.load_map()?;
    let plan = Plan::of(&scene, &Pyramid::new(&map))?;
    let text = if arguments.answer.json {
        json(&plan)?
    } else {
        plan.text()
    };
    terminal::answer(|output| output.write_all(text.as_bytes()))?;
    Ok(Outcome::Agreed)
}

impl Plan {
    fn of(scene: &Scene, pyramid: &Pyramid) -> anyhow::Result<Plan> {
        // Taken apart, so that no effect can be added without a line here.
        let Effects { .. } = scene.effects;
        let number_bits = match scene.walk.format {
            WalkFormat::Float(format) => Some(format.width()),
            WalkFormat::F64 | WalkFormat::Exact | WalkFormat::Fixed(_) => None,
        };
        let fit = fit_scene(scene, pyramid)?;
        Ok(Plan {
            schema: "stepwell-plan-1",
            scene: scene.name.clone(),
            map: scene.map.source.to_string(),
            method: scene.walk.method.to_string(),
            format: fit.walk.format.to_string(),
            number_bits,
            size: pyramid.size(),
            height_bits: pyramid.bits(),
            root_level: pyramid.levels(),
            pyramid_words: pyramid.memory().len(),
            width: scene.frame.width,
            height: scene.frame.height,
            rays: fit.rays,
            ray_format: fit.ray_format.map(|format| format.to_string()),
            reasons: fit
                .ray_format
                .map_or(Vec::new(), |format| format.reasons().to_vec()),
            signals: signals(&fit),
            units: number_bits.map_or(Vec::new(), |bits| units(bits, pyramid)),
            passes: vec![Part {
                name: "view rays",
                why: "one walk for each pixel with a ray, to its hit".to_owned(),
            }],
            effects: Vec::new(),
        })
    }

    fn text(&self) -> String {
        let mut text = format!(
            "scene   {}\n\
             map     {}: {size} x {size} texels of {} bits, a pyramid of {} words with its root at \
             level {}\n\
             frame   {} x {} pixels, {} with a ray\n\
             walk    {} in {}\n",
            self.scene,
            self.map,
            self.height_bits,
            self.pyramid_words,
            self.root_level,
            self.width,
            self.height,
            self.rays,
            self.method,
            self.format,
            size = self.size,
        );
        if let Some(format) = &self.ray_format {
            text += &format!("rays    {format}\n");
            for reason in &self.reasons {
                text += &format!("        {reason}\n");
            }
        }
        if !self.signals.is_empty() {
            text += "\nsignals of a step with these rays, bits\n";
            for line in self.signals.chunks(4) {
                let columns = line
                    .iter()
                    .map(|signal| format!("{:<22}{:>2}", signal.name, signal.bits));
                text += &format!("  {}\n", columns.collect::<Vec<_>>().join("  "));
            }
        }
        let no_hardware = format!(
            "none: {} is for comparison, no hardware has it",
            self.format
        );
        for (heading, parts, none) in [
            ("units", &self.units, no_hardware.as_str()),
            ("passes", &self.passes, "none"),
            ("effects", &self.effects, "none: the scene asks for none"),
        ] {
            text += &format!("\n{heading}\n");
            if parts.is_empty() {
                text += &format!("  {none}\n");
            }
            let width = parts.iter().map(|part| part.name.len()).max().unwrap_or(0);
            for Part { name, why } in parts {
                text += &format!("  {name:width$}  {why}\n");
            }
        }
        text
    }
}

/// The range of each signal of a fixed-point step at a node, where the walk has such steps.
fn signals(fit: &Fit) -> Vec<SignalRange> {
    let (Some(format), Some(range), Family::Nodes(policy)) =
        (fit.ray_format, fit.range, fit.walk.method.family())
    else {
        return Vec::new();
    };
    fixed_ranges(&format, policy, &range)
        .into_iter()
        .map(|(name, range)| SignalRange {
            name,
            bits: range.signed_bits(),
            low: range.low.to_string(),
            high: range.high.to_string(),
        })
        .collect()
}

/// The hardware of the walk of the one method there is, for numbers of so many bits.
fn units(number_bits: u32, pyramid: &Pyramid) -> Vec<Part> {
    let shape = shape_for(pyramid);
    vec![
        Part {
            name: "traverse_setup",
            why: format!(
                "once a ray: mirrors it to travel towards larger u and v ({number_bits}-bit numbers)"
            ),
        },
        Part {
            name: "traverse_step",
            why: format!(
                "once a step: down a level or across a border ({number_bits}-bit numbers, \
                 {INDEX_BITS}-bit node indices, {COUNTER_BITS}-bit counters)"
            ),
        },
        Part {
            name: "traverse",
            why: format!(
                "around both: sends each ray through the step until its hit, at most {} steps, and \
                 reads the pyramid ({}-bit addresses, {}-bit heights)",
                shape.step_bound(SearchPolicy::OH),
                shape.address_bits(),
                shape.height_bits
            ),
        },
    ]
}
