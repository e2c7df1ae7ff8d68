//! The datapaths of the paper's traverse unit, recorded from the functions the golden machine
//! evaluates.

use std::sync::Arc;

use super::traverse_datapaths::{FreshValue, id, input, paired};
use crate::datapath::{
    BuiltDatapath, OperatorLatencies, RecordedOperation, Recorder, Recording, SignalId, build,
    schedule,
};
use crate::netlist::Module;
use rtl_model::float::FloatFormat;
use rtl_model::units::paper_step::PaperStep;
use rtl_model::units::step::RegisterKind;

/// The name of a step's module.
pub const PAPER_STEP: &str = "paper_step";

/// The name of the module that sets a ray up.
pub const PAPER_SETUP: &str = "paper_setup";

/// A pass of the loop with heights that arrive in this stage. The address is the first output.
pub fn record_paper_step(step: &PaperStep, format: FloatFormat, height_stage: u32) -> Recording {
    let mut recorder = Recorder::new(format);
    let mut registers = step.ray_registers();
    registers.extend(step.walk_registers());
    let signals: Vec<_> = registers
        .iter()
        .map(|&port| input(&mut recorder, port))
        .collect();
    let height = recorder.height_input("height", step.shape.height_bits, height_stage);
    let missed = recorder.bit_input("missed", height_stage);
    let address = step.address(&mut recorder, &signals);
    let (walk, answers) = step.step(&mut recorder, &signals, height, missed);

    recorder.early_output("node_address", address);
    for (&(name, _), &signal) in step.ray_registers().iter().zip(&signals) {
        recorder.output(name, id(signal));
    }
    let mut recording = recorder.finish();
    for (name, signal) in paired(PAPER_STEP, &recording, &step.walk_registers(), &walk) {
        recording.add_output(name, signal);
    }
    for (name, signal) in answers {
        recording.add_output(name, id(signal));
    }
    recording
}

/// Stages of the loop with operators of these latencies: those of a pass, and the one in which a
/// ray enters again.
pub fn paper_stages(
    step: &PaperStep,
    format: FloatFormat,
    latencies: &OperatorLatencies,
    height_stage: u32,
) -> u32 {
    let recording = record_paper_step(step, format, height_stage);
    schedule(&recording, latencies).last_stage + 1
}

/// A pass of the loop as a module: pipelined, a ray's registers in, those after the pass out, and
/// the address as soon as it is there; the height and whether the cache missed come in
/// `height_stage`.
pub fn build_paper_step(
    step: &PaperStep,
    format: FloatFormat,
    latencies: &OperatorLatencies,
    height_stage: u32,
) -> BuiltDatapath {
    let recording = record_paper_step(step, format, height_stage);
    let schedule = schedule(&recording, latencies);
    let description = [
        "One pass of a ray through the 2013 hardware paper's traverse unit: the start level, or a"
            .to_owned(),
        "step of mixed-selective.".to_owned(),
        format!(
            "map: {0} x {0} texels, heights of {1} bits; format: {format}",
            step.shape.size(),
            step.shape.height_bits
        ),
        format!(
            "cycles: adder {}, multiplier {}, divider {}, comparator {}, conversion {}; {} in all",
            latencies.adder,
            latencies.multiplier,
            latencies.divider,
            latencies.comparator,
            latencies.conversion,
            schedule.last_stage,
        ),
        format!("height_i and missed_i are read {height_stage} cycle(s) after the other inputs"),
        "golden: rtl_model::units::paper_step".to_owned(),
    ];
    build(&recording, &schedule, latencies, PAPER_STEP, &description)
}

/// A ray as it enters the loop, as hardware.
#[derive(Clone, Debug)]
pub struct BuiltPaperSetup {
    /// The module `paper_setup`: wires and gates, no registers.
    pub module: Arc<Module>,
    /// For every register in front of a pass, in order.
    pub fresh: Vec<FreshValue>,
}

/// The value of a signal that is the same for every ray.
fn constant(recording: &Recording, signal: SignalId, kind: RegisterKind) -> Option<u64> {
    let value = |id: SignalId| match recording.signal(id).operation {
        RecordedOperation::Constant(value) => Some(value),
        _ => None,
    };
    let bits = match kind {
        RegisterKind::Integer(bits) => bits,
        RegisterKind::Bit => 1,
        RegisterKind::Number => 64,
    };
    match recording.signal(signal).operation {
        RecordedOperation::Zero => Some(0),
        RecordedOperation::Constant(value) => {
            Some(value.cast_unsigned() & (u64::MAX >> (64 - bits)))
        }
        RecordedOperation::FromInteger(rounding, integer, exponent) => {
            let format = recording.format;
            Some(format.from_integer(rounding, value(integer)?, value(exponent)?))
        }
        _ => None,
    }
}

/// What is done to a ray on its way from FIFO 0 into the loop: it is mirrored.
pub fn build_paper_setup(step: &PaperStep, format: FloatFormat) -> BuiltPaperSetup {
    let mut recorder = Recorder::new(format);
    let ports = step.ray_ports();
    let ray: Vec<_> = ports
        .iter()
        .map(|&port| input(&mut recorder, port))
        .collect();
    let signals = step.set_up(&mut recorder, &ray);
    let mut recording = recorder.finish();
    let mut registers = step.ray_registers();
    registers.extend(step.walk_registers());
    let mut fresh = Vec::new();
    for (&(name, kind), (_, signal)) in
        registers
            .iter()
            .zip(paired(PAPER_SETUP, &recording, &registers, &signals))
    {
        fresh.push(match constant(&recording, signal, kind) {
            Some(value) => FreshValue::Constant(value),
            None => {
                recording.add_output(name, signal);
                FreshValue::Port(format!("{name}_o"))
            }
        });
    }
    let latencies = OperatorLatencies::PAPER;
    let schedule = schedule(&recording, &latencies);
    assert_eq!(schedule.last_stage, 0, "mirroring takes no cycle");
    let description = [
        "A ray on its way into the loop: mirrored so that it travels toward larger u and v."
            .to_owned(),
        format!("format: {format}"),
        "golden: rtl_model::units::paper_step::PaperStep::set_up".to_owned(),
    ];
    let built = build(&recording, &schedule, &latencies, PAPER_SETUP, &description);
    BuiltPaperSetup {
        module: built.module,
        fresh,
    }
}
