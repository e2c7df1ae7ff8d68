//! One unit behind its handshakes: an operator, or a step of the traverse unit.

use std::sync::Arc;
use std::time::Instant;

use hdl_gen::emit::write_design;
use hdl_gen::fault::plant;
use hdl_gen::netlist::Module;
use hdl_gen::operators::stream_unit;
use hdl_gen::units::{UnitConfiguration, build_step_unit};
use hdl_gen::vectors::{Role, idle_step_results, step_vectors};
use hdl_gen::verify::{FoundSimulator, OperandSets, StreamRun, VectorSource};
use rtl_model::machine::StallPattern;
use rtl_model::maps::Pyramid;

use super::summary::{Finished, SignalFacts, Summary};
use super::unit_map::unit_map;
use super::unit_walk::{unit_rays, unit_walk};
use super::{Arguments, Outcome};
use crate::operator_options::ChosenOperator;
use crate::output::OutputFolder;
use crate::progress;

/// Operand sets sent where nothing is said: what runs in a few seconds.
const DEFAULT_VECTORS: u64 = 1_000_000;
const DEFAULT_VECTORS_EMBEDDED: u64 = 50_000;
/// Random rays out of whose walks the steps are taken.
const RAYS_OF_STEPS: u64 = 2_000;
/// Of their steps, every so manyeth is sent besides those of every kind.
const KEPT_EVERY: u64 = 7;
const DEFAULT_VECTORS_ICARUS: u64 = 5_000;

/// A unit with what is sent through it.
struct Subject {
    unit: Arc<Module>,
    format: String,
    method: Option<String>,
    count: u64,
    exhaustive: bool,
    idle_results: Vec<u64>,
    vectors: Box<VectorSource<'static>>,
    map: Option<String>,
}

/// Verifies the unit of this name.
pub fn verify(arguments: &Arguments, name: &str) -> anyhow::Result<Outcome> {
    let simulator = arguments.sim.find()?;
    let mut subject = match name {
        "traverse_step" => {
            arguments.operator.none_for(name)?;
            step(arguments)?
        }
        _ => operator(arguments, name, &simulator)?,
    };
    let folder = arguments
        .output
        .as_deref()
        .map(OutputFolder::prepare)
        .transpose()?;
    if let Some(fault) = &arguments.plant_fault {
        subject.unit = plant(&subject.unit, &fault.signal, fault.bit)?;
    }
    let unit = &subject.unit;
    let run = StreamRun {
        unit,
        count: subject.count,
        vectors: &*subject.vectors,
        idle_results: &subject.idle_results,
        gaps: StallPattern::one_in_eight(arguments.seed as u16 ^ 0x5a5a),
        stalls: StallPattern::one_in_eight(arguments.seed as u16),
    };
    let start = Instant::now();
    if let FoundSimulator::Verilator(verilator) = &simulator {
        verilator.build(unit, &run.plan(), false)?;
    }
    let build_seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let comparison = match &simulator {
        FoundSimulator::Embedded => run.embedded(|_, _, _| {})?,
        FoundSimulator::Icarus(icarus) => run.icarus(icarus)?,
        FoundSimulator::Verilator(verilator) => {
            let bar = progress::bar(subject.count, "operand sets");
            let comparison = run.verilator(verilator, None, |sent| bar.set_position(sent));
            bar.finish_and_clear();
            comparison?
        }
    };
    let mut files = Vec::new();
    if let Some(folder) = folder {
        folder.publish(|folder| Ok(write_design(unit, folder).map(|_| ())?))?;
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
    let finished = Finished {
        unit,
        simulator: &simulator,
        format: subject.format,
        method: subject.method,
        map: subject.map,
        comparison,
        signals,
        sent: subject.count,
        exhaustive: subject.exhaustive,
        seconds: start.elapsed().as_secs_f64(),
        build_seconds,
        files,
    };
    Summary::new(arguments, finished).answer(arguments.answer.json)
}

/// An operator, on hard and random operands.
fn operator(
    arguments: &Arguments,
    name: &str,
    simulator: &FoundSimulator,
) -> anyhow::Result<Subject> {
    let ChosenOperator {
        configuration,
        latency,
    } = arguments
        .operator
        .choose(name, arguments.replacements.format)?;
    let default_vectors = match simulator {
        FoundSimulator::Verilator(_) => DEFAULT_VECTORS,
        FoundSimulator::Icarus(_) => DEFAULT_VECTORS_ICARUS,
        FoundSimulator::Embedded => DEFAULT_VECTORS_EMBEDDED,
    };
    let count = arguments.vectors.unwrap_or(default_vectors);
    let sets = OperandSets::of_operator(configuration, count, arguments.seed);
    let mut idle_results = Vec::new();
    configuration.golden_results(&vec![0; sets.width()], &mut idle_results);
    Ok(Subject {
        unit: stream_unit(&configuration.build(latency)),
        format: configuration.formats(),
        method: None,
        count: sets.count(),
        exhaustive: sets.is_exhaustive(),
        idle_results,
        vectors: Box::new(move |k, operands, results| {
            sets.set(k, operands);
            configuration.golden_results(operands, results);
        }),
        map: None,
    })
}

/// A step of the traverse unit, on steps of every kind out of the walks of random rays.
fn step(arguments: &Arguments) -> anyhow::Result<Subject> {
    let source = unit_map(&arguments.replacements.map)?;
    let pyramid = Pyramid::new(&source.source.load(source.channel, source.white_is_low)?);
    let walk = unit_walk(&arguments.replacements)?;
    let configuration = UnitConfiguration::of(walk, &pyramid)?;
    let unit = build_step_unit(&configuration);
    let count = arguments.vectors.unwrap_or(RAYS_OF_STEPS);
    let rays = unit_rays(walk, &pyramid, count, arguments.seed)?;
    let set = step_vectors(&unit, &configuration, &pyramid, &rays, KEPT_EVERY);
    let inputs = set
        .fields
        .iter()
        .take_while(|field| field.role == Role::Input)
        .count();
    let idle = idle_step_results(&unit, &configuration, &pyramid);
    let count = set.vectors.len() as u64;
    Ok(Subject {
        unit,
        format: walk.format.to_string(),
        method: Some(walk.method.to_string()),
        count,
        exhaustive: false,
        idle_results: idle,
        vectors: Box::new(move |k, operands, results| {
            let vector = &set.vectors[k as usize];
            operands.extend_from_slice(&vector[..inputs]);
            results.extend_from_slice(&vector[inputs..]);
        }),
        map: Some(source.source.to_string()),
    })
}
