//! Emits the loop of the 2013 hardware paper's traverse unit for a map of 256 x 256 texels into a
//! folder, with so many cycles for adder, multiplier, divider, comparator and conversion, and
//! prints its element counts.

use hdl_gen::datapath::{ElementCounts, OperatorLatencies};
use hdl_gen::emit::write_design;
use hdl_gen::units::{PaperLoop, record_paper_step};
use rtl_model::float::FloatFormat;
use rtl_model::machine::PaperShape;
use rtl_model::scene::{Machine, MachineKind};
use rtl_model::units::paper_step::{HeightLayout, PaperStep};
use rtl_model::units::traverse_step::TraverseShape;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, cycles @ ..] = &arguments[..] else {
        return Err(
            "usage: emit_paper FOLDER [ADDER MULTIPLIER DIVIDER COMPARATOR CONVERSION]".into(),
        );
    };
    let cycles: Vec<u32> = cycles
        .iter()
        .map(|text| text.parse())
        .collect::<Result<_, _>>()?;
    let latencies = match cycles[..] {
        [adder, multiplier, divider, comparator, conversion] => OperatorLatencies {
            adder,
            multiplier,
            divider,
            comparator,
            conversion,
        },
        _ => OperatorLatencies::PAPER,
    };
    let step = PaperStep {
        shape: TraverseShape {
            root_level: 8,
            height_bits: 8,
        },
        layout: HeightLayout::Tiles,
    };
    let shape = PaperShape::new(step, 24, &Machine::of_kind(MachineKind::Paper));
    let paper = PaperLoop::build(&shape, FloatFormat::E7F16, &latencies);
    for file in write_design(&paper.design, folder.as_ref())? {
        println!("{}", file.display());
    }
    let recording = record_paper_step(&step, FloatFormat::E7F16, shape.height_stage());
    let counts = ElementCounts::of(&recording);
    println!("stages: {}, elements: {counts:?}", paper.step.latency + 1);
    Ok(())
}
