//! The float elements of the traverse unit beside the paper's.

use clap::Args;
use serde::Serialize;

use hdl_gen::datapath::ElementCounts;
use hdl_gen::units::record_paper_step;
use rtl_model::float::FloatFormat;
use rtl_model::published::{FloatElements, TRAVERSE_ELEMENTS};
use rtl_model::units::paper_step::{HeightLayout, PaperStep};
use rtl_model::units::traverse_step::TraverseShape;

use crate::commands::Outcome;
use crate::options::AnswerOptions;
use crate::terminal;

/// Of table 1.
#[derive(Args, Debug)]
pub struct ElementArguments {
    #[command(flatten)]
    answer: AnswerOptions,
}

#[derive(Serialize)]
struct Answer {
    ours: ElementCounts,
    paper: FloatElements,
}

/// Why ours differ.
const REASONS: &str = "\
adders       ours: the distances to the borders, to the midlines of one and of two levels down and
             to the border but one that the prediction asks for, and the position, on two axes each.
comparators  ours keep a lower and an upper bound of every exit, so that no surface is stepped past,
             and ask the midlines for a child where the paper converts a position to an address.
multipliers  ours: the position and the prediction, on two axes each; a node's index is
             carried along, so that no position is scaled back into one.
conversions  the paper counts none.
";

/// Shows the table.
pub fn run(arguments: &ElementArguments) -> anyhow::Result<Outcome> {
    // The counts depend on neither map nor stage.
    let step = PaperStep {
        shape: TraverseShape {
            root_level: 8,
            height_bits: 8,
        },
        layout: HeightLayout::Tiles,
    };
    let ours = ElementCounts::of(&record_paper_step(&step, FloatFormat::E7F16, 1));
    let paper = TRAVERSE_ELEMENTS;
    let text = if arguments.answer.json {
        format!(
            "{}\n",
            serde_json::to_string_pretty(&Answer { ours, paper })?
        )
    } else {
        let row = |name: &str, ours: u32, paper: Option<u32>| {
            let paper = paper.map_or("-".to_owned(), |count| count.to_string());
            format!("{name:12} {ours:5} {paper:>6}\n")
        };
        let rows = [
            row("adders", ours.adders, Some(paper.adders)),
            row("comparators", ours.comparators, Some(paper.comparators)),
            row("multipliers", ours.multipliers, Some(paper.multipliers)),
            row("dividers", ours.dividers, Some(paper.dividers)),
            row("conversions", ours.conversions, None),
        ];
        format!(
            "float elements of the traverse unit (2013 hardware paper, table 1)\n\
             element       ours  paper\n{}\n{REASONS}",
            rows.concat()
        )
    };
    terminal::answer(|output| output.write_all(text.as_bytes()))?;
    Ok(Outcome::Agreed)
}
