//! One operator behind its handshakes.

use std::time::Instant;

use anyhow::bail;

use hdl_gen::datapath::OperatorLatencies;
use hdl_gen::digest::netlist_digest;
use hdl_gen::emit::write_design;
use hdl_gen::fault::plant;
use hdl_gen::operators::{FloatOperator, float_operator, stream_unit};
use hdl_gen::verify::{FoundSimulator, OperandSets, StreamRun};
use rtl_model::float::FloatFormat;
use rtl_model::machine::StallPattern;
use rtl_model::scene::WalkFormat;
use rtl_model::units::traverse_step::{EXACT_EXIT_ULPS, INDEX_BITS, LEVEL_BITS};

use super::summary::{SignalFacts, Summary, decode};
use super::{Arguments, Outcome};
use crate::output::OutputFolder;
use crate::progress;

/// Operand sets sent where nothing is said: what runs in a few seconds.
const DEFAULT_VECTORS: u64 = 1_000_000;
const DEFAULT_VECTORS_EMBEDDED: u64 = 50_000;

/// The operators by the names of their units, with the parameters the traverse unit has them with.
fn known_operators() -> Vec<FloatOperator> {
    vec![
        FloatOperator::Add,
        FloatOperator::Subtract,
        FloatOperator::Multiply,
        FloatOperator::Divide,
        FloatOperator::Compare,
        FloatOperator::LessThan,
        FloatOperator::LessEqual,
        FloatOperator::FromInteger {
            value_bits: INDEX_BITS + 1,
            exponent_bits: LEVEL_BITS + 1,
        },
        FloatOperator::ToInteger { bits: INDEX_BITS },
        FloatOperator::Floor,
        FloatOperator::UlpsUp {
            ulps: EXACT_EXIT_ULPS,
        },
        FloatOperator::ExactBelow,
        FloatOperator::DepthFromHeight { bits: 8 },
    ]
}

fn latency_of(operator: FloatOperator) -> u32 {
    let budget = OperatorLatencies::PAPER;
    match operator {
        FloatOperator::Add | FloatOperator::Subtract => budget.adder,
        FloatOperator::Multiply => budget.multiplier,
        FloatOperator::Divide => budget.divider,
        FloatOperator::Compare | FloatOperator::LessThan | FloatOperator::LessEqual => {
            budget.comparator
        }
        _ => budget.conversion,
    }
}

/// Verifies the operator of this name.
pub fn verify(arguments: &Arguments, name: &str) -> anyhow::Result<Outcome> {
    let known = known_operators();
    let Some(&operator) = known.iter().find(|operator| operator.name() == name) else {
        let names: Vec<_> = known.iter().map(|operator| operator.name()).collect();
        bail!("--unit {name}: unknown; the units are {}", names.join(", "));
    };
    let format = match arguments.replacements.format {
        None => FloatFormat::E7F16,
        Some(WalkFormat::Float(format)) => format,
        Some(other) => bail!("format {other} has no hardware: take a float eXfY, such as e7f16"),
    };
    operator.check(format)?;
    let rounding = arguments.rounding;
    let latency = arguments.latency.unwrap_or(latency_of(operator));
    let simulator = arguments.sim.find()?;
    let folder = arguments
        .output
        .as_deref()
        .map(OutputFolder::prepare)
        .transpose()?;
    let mut unit = stream_unit(&float_operator(operator, format, rounding, latency));
    if let Some(fault) = &arguments.plant_fault {
        unit = plant(&unit, &fault.signal, fault.bit)?;
    }
    let default_vectors = match simulator {
        FoundSimulator::Verilator(_) => DEFAULT_VECTORS,
        _ => DEFAULT_VECTORS_EMBEDDED,
    };
    let sets = OperandSets::new(
        operator,
        format,
        arguments.vectors.unwrap_or(default_vectors),
        arguments.seed,
    );
    let mut idle_results = Vec::new();
    operator.golden_results(format, rounding, &vec![0; sets.width()], &mut idle_results);
    let vectors = |k, operands: &mut Vec<u64>, results: &mut Vec<u64>| {
        sets.set(k, operands);
        operator.golden_results(format, rounding, operands, results);
    };
    let run = StreamRun {
        unit: &unit,
        count: sets.count(),
        vectors: &vectors,
        idle_results: &idle_results,
        gaps: StallPattern::one_in_eight(arguments.seed as u16 ^ 0x5a5a),
        stalls: StallPattern::one_in_eight(arguments.seed as u16),
    };
    let start = Instant::now();
    if let FoundSimulator::Verilator(verilator) = &simulator {
        verilator.build(&unit, &run.plan(), false)?;
    }
    let build_seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let comparison = match &simulator {
        FoundSimulator::Embedded => run.embedded(|_, _, _| {})?,
        FoundSimulator::Verilator(verilator) => {
            let bar = progress::bar(sets.count(), "operand sets");
            let comparison = run.verilator(verilator, None, |sent| bar.set_position(sent));
            bar.finish_and_clear();
            comparison?
        }
    };
    let mut files = Vec::new();
    if let Some(folder) = folder {
        folder.publish(|folder| Ok(write_design(&unit, folder).map(|_| ())?))?;
        let output = arguments.output.clone().unwrap_or_default();
        files.push(output.join(format!("{}.v", unit.name)));
    }
    let signals: Vec<SignalFacts> = unit
        .outputs
        .iter()
        .map(|(port, wire)| SignalFacts {
            path: format!("{}.{port}", unit.name),
            width: unit.width(*wire),
            meaning: unit.node(*wire).meaning,
            sources: Vec::new(),
        })
        .collect();
    Summary {
        schema: "stepwell-verify-1",
        unit: unit.name.clone(),
        simulator: simulator.name().to_owned(),
        simulator_version: simulator.version().to_owned(),
        format: format.to_string(),
        method: None,
        map: None,
        rays: comparison.rays,
        rays_sent: sets.count(),
        exhaustive: sets.is_exhaustive(),
        guards: 0,
        mismatches: comparison.mismatches,
        cycles: comparison.cycles,
        cycles_compared: comparison.cycles_compared,
        signals_compared: comparison.signals_compared,
        seconds: start.elapsed().as_secs_f64(),
        build_seconds,
        netlist_digest: netlist_digest(&unit),
        planted_fault: arguments
            .plant_fault
            .as_ref()
            .map(|fault| format!("{}:{}", fault.signal, fault.bit)),
        seed: arguments.seed,
        first_divergence: decode(&comparison, &signals),
        files,
    }
    .answer(arguments.answer.json)
}
