//! Vectors through a unit behind handshakes in the embedded simulator: what the Verilog testbench
//! does, without a tool.

use std::sync::Arc;

use crate::netlist::Module;
use crate::simulate::{SimulateError, Simulator};
use crate::testbench::{FieldDifference, Verdict};
use crate::vectors::{Field, Role, VectorSet};
use rtl_model::machine::StallPattern;

/// The seeds of the pauses, those of the testbench.
const OFFER_SEED: u16 = 0xace1;
const READY_SEED: u16 = 0x7b1d;
/// Failing vectors whose fields are listed.
const SHOWN: u64 = 10;

/// Sends vectors through a unit with the handshakes of [`crate::operators::stream_unit`] and
/// compares every result. The fields of the vectors are ports of the unit.
///
/// # Errors
/// If the netlist cannot be simulated, or has no port of a field's name. A wrong result is none:
/// the verdict says so.
pub fn run_vectors_embedded(unit: &Arc<Module>, set: &VectorSet) -> Result<Verdict, SimulateError> {
    let mut simulator = Simulator::new(unit)?;
    let places = |wanted: fn(Role) -> bool| {
        let fields = set.fields.iter().enumerate();
        fields.filter(move |(_, field)| wanted(field.role))
    };
    let operands = places(|role| role != Role::Output)
        .map(|(place, field)| Ok((place, simulator.input(&field.name)?)))
        .collect::<Result<Vec<_>, SimulateError>>()?;
    let results = places(|role| role == Role::Output)
        .map(|(place, field)| Ok((place, field, simulator.signal(&field.name)?)))
        .collect::<Result<Vec<_>, SimulateError>>()?;
    let (valid_i, ready_i) = (simulator.input("valid_i")?, simulator.input("ready_i")?);
    let (valid_o, ready_o) = (simulator.signal("valid_o")?, simulator.signal("ready_o")?);
    simulator.set("rst_ni", 0)?;
    for _ in 0..unit.latency + 2 {
        simulator.settle();
        simulator.clock();
    }
    simulator.set("rst_ni", 1)?;

    let count = set.vectors.len() as u64;
    let (mut offers, mut readiness) = (
        StallPattern::one_in_eight(OFFER_SEED),
        StallPattern::one_in_eight(READY_SEED),
    );
    let mut differences = Vec::new();
    let (mut sent, mut received, mut agreed) = (0, 0, 0);
    let mut offered = false;
    let mut reason = "results differ";
    let watchdog = 8 * count + 64 * (u64::from(unit.latency) + 1);
    let mut idle_cycles = 0;
    while idle_cycles <= unit.latency {
        if simulator.cycles() > watchdog {
            reason = "the unit hangs";
            break;
        }
        if !offered && sent < count {
            offered = offers.next_ready();
        }
        let vector = set.vectors.get(sent as usize).filter(|_| offered);
        for &(place, input) in &operands {
            simulator.set_input(input, vector.map_or(0, |vector| vector[place]));
        }
        let ready = readiness.next_ready();
        simulator.set_input(valid_i, offered.into());
        simulator.set_input(ready_i, ready.into());
        simulator.settle();
        if ready && simulator.peek(valid_o) == 1 {
            let Some(vector) = set.vectors.get(received as usize) else {
                reason = "a result too many";
                break;
            };
            let differing: Vec<FieldDifference> = results
                .iter()
                .map(|&(place, field, signal)| (vector[place], field, simulator.peek(signal)))
                .filter(|(expected, _, found)| expected != found)
                .map(|(expected, field, found)| difference(received, field, expected, found))
                .collect();
            agreed += u64::from(differing.is_empty());
            received += 1;
            if received - agreed <= SHOWN {
                differences.extend(differing);
            }
        }
        if offered && simulator.peek(ready_o) == 1 {
            sent += 1;
            offered = false;
        }
        idle_cycles += u32::from(received == count);
        simulator.clock();
    }
    let passed = agreed == count && received == count && count > 0 && idle_cycles > unit.latency;
    let line = if passed {
        format!("PASS {agreed} of {count} vectors agree")
    } else {
        let reason = match count {
            0 => "nothing was compared",
            _ => reason,
        };
        format!("FAIL {agreed} of {count} vectors agree: {reason}")
    };
    Ok(Verdict {
        passed,
        agreed,
        vectors: count,
        line,
        differences,
    })
}

fn difference(vector: u64, field: &Field, expected: u64, found: u64) -> FieldDifference {
    let digits = field.width.div_ceil(4) as usize;
    FieldDifference {
        vector,
        field: field.name.clone(),
        expected: format!("{expected:0digits$x}"),
        found: format!("{found:0digits$x}"),
    }
}
