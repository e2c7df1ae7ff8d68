//! The datapaths of a unit that walks by bounds, recorded from the functions the golden model
//! evaluates, and cut into stages.

use crate::datapath::{
    BuiltDatapath, OperatorLatencies, Recorder, Recording, build, schedule_in_stages,
};
use rtl_model::float::FloatFormat;
use rtl_model::units::bounded_datapaths::BoundedDatapath;
use rtl_model::units::bounded_shape::BoundedShape;
use rtl_model::units::step::{RegisterKind, Signal};

/// A datapath of integers alone: there are no operators with cycles of their own.
const LATENCIES: OperatorLatencies = OperatorLatencies::PAPER;

/// Records a datapath. A step's heights arrive in stage `height_stage`, its address leaves as soon as it is there.
pub fn record_bounded(
    datapath: BoundedDatapath,
    shape: BoundedShape,
    height_stage: u32,
) -> Recording {
    // Nothing is computed in the format.
    let mut recorder = Recorder::new(FloatFormat::E7F16);
    let inputs: Vec<_> = datapath
        .inputs(shape)
        .into_iter()
        .map(|(name, kind)| match kind {
            RegisterKind::Integer(bits) => Signal::Integer(recorder.int_input(name, bits, 0)),
            RegisterKind::Bit => Signal::Bit(recorder.bit_input(name, 0)),
            RegisterKind::Number => unreachable!("a walk by bounds has no numbers"),
        })
        .collect();
    let heights: Vec<_> = datapath
        .heights(shape)
        .into_iter()
        .map(|(name, bits)| recorder.height_input(name, bits, height_stage))
        .collect();
    let outputs = datapath.evaluate(&mut recorder, shape, &inputs, &heights);
    for (name, signal) in outputs {
        let id = match signal {
            Signal::Integer(integer) => integer.into(),
            Signal::Bit(bit) => bit.into(),
            Signal::Number(number) => crate::datapath::SignalId::from(number),
        };
        match name {
            "line_address" => recorder.early_output(name, id),
            _ => recorder.output(name, id),
        }
    }
    recorder.finish()
}

/// The module of a datapath in so many stages. Behind the last there is no rank of registers: in a
/// loop that is the one in front of the first.
///
/// # Panics
/// If the heights arrive after the last stage.
pub fn build_bounded(
    datapath: BoundedDatapath,
    shape: BoundedShape,
    height_stage: u32,
    stages: u32,
) -> BuiltDatapath {
    assert!(height_stage < stages, "heights after the last stage");
    let recording = record_bounded(datapath, shape, height_stage);
    let schedule = schedule_in_stages(&recording, &LATENCIES, stages);
    let mut description = vec![format!(
        "Of a walk by bounds through lines of {side} x {side} nodes over a {size} x {size} map of \
         {bits} bit heights",
        side = shape.lines().side(),
        size = shape.lines().size(),
        bits = shape.words.height_bits
    )];
    description.push(format!(
        "(rtl_model::units::bounded_datapaths); bounds have {} fraction bits, of which {} count.",
        shape.fraction_bits(),
        shape.order_fraction_bits()
    ));
    if !datapath.heights(shape).is_empty() {
        description.push(format!(
            "Heights are read {height_stage} cycle(s) after the other inputs."
        ));
    }
    let name = datapath.name(shape);
    build(&recording, &schedule, &LATENCIES, &name, &description)
}
