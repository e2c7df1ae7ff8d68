//! The two datapaths of a traverse unit, recorded from the functions the golden model evaluates.

use super::configuration::UnitConfiguration;
use crate::datapath::{
    BuiltDatapath, Kind, RecordedOperation, Recorder, Recording, SignalId, build, schedule,
};
use rtl_model::units::step::{Register, RegisterKind, Signal, Step};

/// Where the loop takes what a fresh ray has in a register.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FreshValue {
    /// From this port of the setup.
    Port(String),
    /// It is the same for every ray.
    Constant(u64),
}

/// The setup as hardware.
#[derive(Clone, Debug)]
pub struct BuiltSetup {
    /// The module `traverse_setup`: a ray's ports in, its registers out. It is pipelined where an
    /// operation of it needs cycles, else combinational.
    pub datapath: BuiltDatapath,
    /// For every register in front of the step, in order.
    pub fresh: Vec<FreshValue>,
}

/// A signal from outside.
pub(super) fn input(recorder: &mut Recorder, (name, kind): Register) -> Signal<Recorder> {
    match kind {
        RegisterKind::Number => Signal::Number(recorder.num_input(name, 0)),
        RegisterKind::Integer(bits) => Signal::Integer(recorder.int_input(name, bits, 0)),
        RegisterKind::Bit => Signal::Bit(recorder.bit_input(name, 0)),
    }
}

pub(super) fn id(signal: Signal<Recorder>) -> SignalId {
    match signal {
        Signal::Number(number) => number.into(),
        Signal::Integer(integer) => integer.into(),
        Signal::Bit(bit) => bit.into(),
    }
}

/// The declared registers beside the signals that a datapath gives for them.
///
/// # Panics
/// If they are not of one kind and number: a mistake in the step's own declarations.
pub(super) fn paired(
    name: &str,
    recording: &Recording,
    registers: &[Register],
    signals: &[Signal<Recorder>],
) -> Vec<(&'static str, SignalId)> {
    assert_eq!(registers.len(), signals.len(), "{name}");
    let pairs = registers
        .iter()
        .zip(signals)
        .map(|(&(register, kind), &signal)| {
            let (signal_id, of_kind) = (id(signal), recording.signal(id(signal)).kind);
            let fits = match (kind, of_kind) {
                (RegisterKind::Number, Kind::Num) | (RegisterKind::Bit, Kind::Bit) => true,
                // Of a value's bits a register keeps those that it has.
                (RegisterKind::Integer(_), Kind::Int(_)) => true,
                _ => false,
            };
            assert!(fits, "{name}: {register} is {kind:?}, not {of_kind:?}");
            (register, signal_id)
        });
    pairs.collect()
}

/// The registers in front of a step: what a ray keeps, then what its walk changes.
pub fn step_registers(step: &impl Step) -> Vec<Register> {
    let mut registers = step.ray_registers();
    registers.extend(step.walk_registers());
    registers
}

/// The setup of a configuration's step.
pub fn build_setup(configuration: &UnitConfiguration) -> BuiltSetup {
    let step = configuration.step;
    let mut recorder = Recorder::new(configuration.format);
    let ports = step.ray_ports();
    let ray: Vec<_> = ports
        .iter()
        .map(|&port| input(&mut recorder, port))
        .collect();
    let signals = step.set_up(&mut recorder, &ray);
    let mut recording = recorder.finish();
    let registers = step_registers(&step);
    let mut fresh = Vec::new();
    for (&(name, kind), (_, signal)) in
        registers
            .iter()
            .zip(paired(step.name(), &recording, &registers, &signals))
    {
        let recorded = recording.signal(signal);
        fresh.push(match (recorded.operation, kind) {
            (RecordedOperation::Zero, _) => FreshValue::Constant(0),
            (RecordedOperation::Constant(value), RegisterKind::Integer(bits)) => {
                FreshValue::Constant(value.cast_unsigned() & (u64::MAX >> (64 - bits)))
            }
            (RecordedOperation::Constant(value), _) => FreshValue::Constant(value.cast_unsigned()),
            _ => {
                // What is narrower than its register leaves under its own name.
                let is_narrower = kind != RegisterKind::Number
                    && kind != RegisterKind::Bit
                    && kind != RegisterKind::Integer(recording.width(signal));
                let own = recorded.name.filter(|_| is_narrower);
                let port = own.unwrap_or(name);
                recording.add_output(port, signal);
                FreshValue::Port(format!("{port}_o"))
            }
        });
    }
    let schedule = schedule(&recording, &configuration.latencies);
    let mut description =
        vec!["What is done to a ray once, before its first step, which is:".to_owned()];
    description.extend(configuration.description());
    if schedule.last_stage > 0 {
        description.push(configuration.cycles_line(schedule.last_stage));
    }
    let datapath = build(
        &recording,
        &schedule,
        &configuration.latencies,
        "traverse_setup",
        &description,
    );
    BuiltSetup { datapath, fresh }
}

/// The module of a step: pipelined, a ray's registers in, a step later out.
///
/// Inputs are the registers in stage 0, and the heights when the memory has answered; outputs are
/// the same registers after the step and what the hit would be; the address leaves as soon as it
/// is there.
pub fn build_step(configuration: &UnitConfiguration) -> BuiltDatapath {
    let step = configuration.step;
    let latencies = configuration.latencies;
    // The stage of the address does not depend on when its answer comes.
    let asked = record_step(configuration, 0);
    let asked_in = schedule(&asked, &latencies).stage_of(&asked.outputs[0]);
    let answered_in = asked_in + configuration.memory_latency();
    let recording = record_step(configuration, answered_in);
    let schedule = schedule(&recording, &latencies);

    let mut description = configuration.description();
    let bound = step.step_bound();
    description.push(format!(
        "a walk without a hit ends with guard at step {bound}, which is hexadecimal {bound:x}"
    ));
    description.push(format!("golden: {}", configuration.golden()));
    description.push(configuration.cycles_line(schedule.last_stage));
    let height_ports: Vec<String> = step
        .height_ports()
        .iter()
        .map(|(name, _)| format!("{name}_i"))
        .collect();
    let read = match &height_ports[..] {
        [only] => format!("{only} is"),
        [first, .., last] => format!("{first} to {last} are"),
        [] => unreachable!("a step reads the memory"),
    };
    description.push(format!(
        "{read} read {answered_in} cycle(s) after the other inputs"
    ));
    build(&recording, &schedule, &latencies, step.name(), &description)
}

/// A step with heights that arrive in this stage. The address is the first output.
fn record_step(configuration: &UnitConfiguration, height_stage: u32) -> Recording {
    let step = configuration.step;
    let mut recorder = Recorder::new(configuration.format);
    let registers = step_registers(&step);
    let signals: Vec<_> = registers
        .iter()
        .map(|&port| input(&mut recorder, port))
        .collect();
    let heights: Vec<_> = step
        .height_ports()
        .iter()
        .map(|&(name, bits)| recorder.height_input(name, bits, height_stage))
        .collect();
    // In the order in which the golden model evaluates them.
    let address = step.address(&mut recorder, &signals);
    let (walk, named) = step.step(&mut recorder, &signals, &heights);

    recorder.early_output(step.address_port(), address);
    for (&(name, _), &signal) in step.ray_registers().iter().zip(&signals) {
        recorder.output(name, id(signal));
    }
    let mut recording = recorder.finish();
    for (name, signal) in paired(step.name(), &recording, &step.walk_registers(), &walk) {
        recording.add_output(name, signal);
    }
    for (name, signal) in named {
        recording.add_output(name, id(signal));
    }
    recording
}
