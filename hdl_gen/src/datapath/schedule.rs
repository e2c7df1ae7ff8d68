//! In which pipeline stage each operation of a datapath stands.

use super::delay::{Delay, delay};
use super::record::{Output, Recording};
use super::signal::{RecordedOperation, SignalId};
use crate::operators::{FixedOperator, FloatOperator};
use rtl_model::scene::MachineLatencies;
use serde::{Deserialize, Serialize};

/// Cycles of each pipelined operator. Everything else (selection, integer and bit logic, sign
/// changes, the step up by units in the last place) is combinational within its stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct OperatorLatencies {
    /// Float adder and subtractor.
    pub adder: u32,
    /// Float multiplier.
    pub multiplier: u32,
    /// Float divider and square root.
    pub divider: u32,
    /// Float comparator, minimum and maximum.
    pub comparator: u32,
    /// Between integers and floats, between float formats, height to depth.
    pub conversion: u32,
}

impl From<MachineLatencies> for OperatorLatencies {
    fn from(cycles: MachineLatencies) -> OperatorLatencies {
        OperatorLatencies {
            adder: cycles.adder,
            multiplier: cycles.multiplier,
            divider: cycles.divider,
            comparator: cycles.comparator,
            conversion: cycles.conversion,
        }
    }
}

impl OperatorLatencies {
    /// The budget of the 2013 hardware paper (section 4.2): adder and divider two cycles,
    /// multiplier and comparator one; conversions, of which it does not speak, one.
    pub const PAPER: OperatorLatencies = OperatorLatencies {
        adder: 2,
        multiplier: 1,
        divider: 2,
        comparator: 1,
        conversion: 1,
    };

    /// Cycles of an operator on its own, behind handshakes: at least one.
    pub fn of_operator(&self, operator: FloatOperator) -> u32 {
        let cycles = match operator {
            FloatOperator::Add | FloatOperator::Subtract => self.adder,
            FloatOperator::Multiply => self.multiplier,
            FloatOperator::Divide | FloatOperator::SquareRoot => self.divider,
            FloatOperator::Compare
            | FloatOperator::CompareSignalling
            | FloatOperator::LessThan
            | FloatOperator::LessEqual
            | FloatOperator::Minimum
            | FloatOperator::Maximum => self.comparator,
            _ => self.conversion,
        };
        cycles.max(1)
    }

    /// Cycles of a fixed-point operator on its own: those of the float operator of its kind.
    pub fn of_fixed_operator(&self, operator: FixedOperator) -> u32 {
        let cycles = match operator {
            FixedOperator::Add | FixedOperator::Subtract => self.adder,
            FixedOperator::Multiply => self.multiplier,
            FixedOperator::Divide | FixedOperator::Reciprocal => self.divider,
            FixedOperator::Compare => self.comparator,
            _ => self.conversion,
        };
        cycles.max(1)
    }

    /// Cycles of an operation.
    pub fn of(&self, operation: &RecordedOperation) -> u32 {
        use RecordedOperation::*;
        match operation {
            Add(..) | Sub(..) => self.adder,
            Mul(..) | IntMul(..) => self.multiplier,
            Div(..) => self.divider,
            LessThan(..) | LessEqual(..) => self.comparator,
            FromInteger(..) | Floor(..) | DepthFromHeight(..) => self.conversion,
            _ => 0,
        }
    }
}

/// Where everything stands in time. Stage s is the logic behind the s-th rank of registers.
#[derive(Clone, Debug)]
pub struct Schedule {
    /// The stage in which each operation reads its operands; for an input, in which it arrives.
    pub start: Vec<u32>,
    /// The stage in which each signal is there; constants are there in every stage: `None`.
    pub available: Vec<Option<u32>>,
    /// The last stage in which each signal is read, by an operation or an output; `None` for a
    /// signal that no output depends on: it is not built.
    pub last_read: Vec<Option<u32>>,
    /// The stage in which the outputs appear: the datapath's latency in cycles.
    pub last_stage: u32,
}

impl Schedule {
    /// The stage in which an output leaves.
    pub fn stage_of(&self, output: &Output) -> u32 {
        match output.early {
            true => self.available[output.signal.index()].unwrap_or(0),
            false => self.last_stage,
        }
    }
}

/// The shortest schedule, with few registers, whatever the logic between two ranks of registers.
pub fn schedule(recording: &Recording, latencies: &OperatorLatencies) -> Schedule {
    schedule_within(recording, latencies, Delay::MAX)
        .expect("every operation is done within any time")
}

/// The schedule of at most `stages` stages, the first the logic behind the inputs, whose longest stage is as
/// short as can be by the estimates. Combinational operations are cut between stages, each whole.
///
/// # Panics
/// If the operations with cycles of their own need more stages, or there is no stage.
pub fn schedule_in_stages(
    recording: &Recording,
    latencies: &OperatorLatencies,
    stages: u32,
) -> Schedule {
    let period = shortest_period(recording, latencies, stages);
    schedule_within(recording, latencies, period).expect("a period found by this very test")
}

/// The shortest time of a stage by which so many stages suffice.
///
/// # Panics
/// As [`schedule_in_stages`].
pub fn shortest_period(recording: &Recording, latencies: &OperatorLatencies, stages: u32) -> Delay {
    let suffices = |period| {
        schedule_within(recording, latencies, period)
            .is_some_and(|schedule| schedule.last_stage < stages)
    };
    // All operations one after the other.
    let all = (0..recording.signals.len()).map(|index| delay(recording, SignalId(index)));
    let (mut too_short, mut enough) = (0, all.sum::<Delay>() + 1);
    assert!(
        suffices(enough),
        "{stages} stages are fewer than the operators' own cycles"
    );
    while enough - too_short > 1 {
        let middle = too_short.midpoint(enough);
        if suffices(middle) {
            enough = middle;
        } else {
            too_short = middle;
        }
    }
    enough
}

/// The shortest schedule, with few registers, no stage of which takes longer than `period`; none
/// where an operation alone does.
///
/// The length is that of every operation starting as soon as its operands are there. Within it
/// each operation, from the last to the first, moves to the stage that costs the fewest register
/// bits: those that carry its result on to where it is read, and those that carry an operand
/// further than others carry it anyway. So what is made of long-lived inputs (a midline of a node
/// index, a count) is made where it is needed, and a comparison's one bit is made at once. An operation
/// may move to a stage if what comes before it there at the soonest, itself and what is placed behind it
/// there take no longer than the period.
pub fn schedule_within(
    recording: &Recording,
    latencies: &OperatorLatencies,
    period: Delay,
) -> Option<Schedule> {
    let count = recording.signals.len();
    let delays: Vec<Delay> = (0..count)
        .map(
            |index| match latencies.of(&recording.signals[index].operation) {
                0 => delay(recording, SignalId(index)),
                _ => 0,
            },
        )
        .collect();
    // When, in its soonest stage, an operation starts, and when its result is there.
    let mut starts_at = vec![0; count];
    let mut there_at = vec![0; count];
    let mut schedule = Schedule {
        start: vec![0; count],
        available: vec![None; count],
        last_read: vec![None; count],
        last_stage: 0,
    };
    for (index, signal) in recording.signals.iter().enumerate() {
        let there = |id: &SignalId| Some((schedule.available[id.index()]?, there_at[id.index()]));
        let (mut stage, mut time) = match signal.operation {
            RecordedOperation::Input { stage } => (stage, 0),
            ref operation => operation
                .operands()
                .iter()
                .filter_map(there)
                .max()
                .unwrap_or((0, 0)),
        };
        if delays[index] > period {
            return None;
        }
        if delays[index] > period - time {
            (stage, time) = (stage + 1, 0);
        }
        (schedule.start[index], starts_at[index]) = (stage, time);
        if !signal.operation.is_constant() {
            let latency = latencies.of(&signal.operation);
            schedule.available[index] = Some(stage + latency);
            // An operator's result comes out of its register.
            there_at[index] = if latency == 0 {
                time + delays[index]
            } else {
                0
            };
        }
    }
    let available = |id: SignalId| schedule.available[id.index()].unwrap_or(0);
    let together = recording.outputs.iter().filter(|output| !output.early);
    schedule.last_stage = together
        .map(|output| available(output.signal))
        .max()
        .unwrap_or(0);

    // First and last stage in which a signal is read, as far as its readers are placed.
    let mut first_read: Vec<Option<u32>> = vec![None; count];
    let read = |schedule: &mut Schedule, first_read: &mut Vec<Option<u32>>, id: SignalId, stage| {
        let first = &mut first_read[id.index()];
        *first = Some(first.map_or(stage, |first: u32| first.min(stage)));
        let last = &mut schedule.last_read[id.index()];
        *last = (*last).max(Some(stage));
    };
    for output in &recording.outputs {
        let stage = schedule.stage_of(output);
        read(&mut schedule, &mut first_read, output.signal, stage);
    }
    // How long what is placed behind a signal takes, in the first stage in which it is read.
    let mut behind: Vec<Delay> = vec![0; count];
    for index in (0..count).rev() {
        let operation = &recording.signals[index].operation;
        let (Some(first), Some(last)) = (first_read[index], schedule.last_read[index]) else {
            continue;
        };
        if operation.is_constant() || matches!(operation, RecordedOperation::Input { .. }) {
            continue;
        }
        let latency = latencies.of(operation);
        let width = recording.width(SignalId(index));
        let operands = operation.operands();
        let register_bits = |start: u32| {
            let carried_on = width * (last - (start + latency));
            let carried_to = |id: &SignalId| {
                let available = schedule.available[id.index()]?;
                let carried_anyway = schedule.last_read[id.index()].unwrap_or(0).max(available);
                Some(recording.width(*id) * start.saturating_sub(carried_anyway))
            };
            carried_on + operands.iter().filter_map(carried_to).sum::<u32>()
        };
        let soonest = schedule.start[index];
        // The time that is taken in a stage from here on: readers in a later stage take none of it.
        let takes = |start: u32| match latency {
            0 if start == first => delays[index] + behind[index],
            0 => delays[index],
            _ => 0,
        };
        let fits = |&start: &u32| {
            let before = if start == soonest {
                starts_at[index]
            } else {
                0
            };
            before <= period && takes(start) <= period - before
        };
        let start = (soonest..=first - latency)
            .filter(fits)
            .min_by_key(|&start| register_bits(start))
            .unwrap_or(soonest);
        schedule.start[index] = start;
        schedule.available[index] = Some(start + latency);
        let taken = takes(start);
        for operand in operands {
            let earlier = first_read[operand.index()];
            let behind = &mut behind[operand.index()];
            *behind = match earlier {
                Some(stage) if stage < start => *behind,
                Some(stage) if stage == start => taken.max(*behind),
                _ => taken,
            };
            read(&mut schedule, &mut first_read, operand, start);
        }
    }
    Some(schedule)
}
