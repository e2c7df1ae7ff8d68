//! What is measured: an operator, a step of the traverse unit, or a unit of a machine.

use std::sync::Arc;

use hdl_gen::netlist::Module;
use hdl_gen::operators::stream_unit;
use hdl_gen::units::{UnitConfiguration, build_step, build_step_unit};
use rtl_model::maps::Pyramid;
use rtl_model::scene::{Crossing, Method, Walk};

use crate::commands::verify::unit_map::unit_map;
use crate::commands::verify::unit_walk::chosen_walk;
use crate::operator_options::ChosenOperator;
use crate::options::{MapOptions, NumberFormat};

/// What is measured.
#[derive(Clone, Debug)]
pub enum Subject {
    /// An operator.
    Operator(ChosenOperator),
    /// A step of the traverse unit.
    Step(Box<StepSubject>),
    /// A unit of a machine, or all of it.
    Unit(MachineUnit),
}

/// A step that is measured.
#[derive(Clone, Debug)]
pub struct StepSubject {
    configuration: UnitConfiguration,
    /// The walk it is a step of.
    pub walk: Walk,
    /// The map it is built for.
    pub map: String,
}

/// A unit of a machine.
#[derive(Clone, Debug)]
pub struct MachineUnit {
    /// Its instance's path below the machine, or `machine` for all of it.
    pub name: String,
    /// Its module, as it is verified.
    pub module: Arc<Module>,
    /// The format of the machine's numbers.
    pub format: String,
}

impl Subject {
    /// The steps of these methods, `oh` where none is named.
    ///
    /// # Errors
    /// If there is no such map, or no hardware of a method in the format.
    pub fn steps(
        methods: &[Method],
        format: Option<NumberFormat>,
        crossing: Option<Crossing>,
        map: &MapOptions,
    ) -> anyhow::Result<Vec<Subject>> {
        let source = unit_map(map)?;
        let pyramid = Pyramid::new(&source.source.load(source.channel, source.white_is_low)?);
        let methods = if methods.is_empty() {
            &[Method::Oh]
        } else {
            methods
        };
        let step = |&method: &Method| {
            let walk = chosen_walk(method, format, crossing)?;
            Ok(Subject::Step(Box::new(StepSubject {
                configuration: UnitConfiguration::of(walk, &pyramid)?,
                walk,
                map: source.source.to_string(),
            })))
        };
        methods.iter().map(step).collect()
    }

    /// The module that is measured.
    pub fn core(&self) -> Arc<Module> {
        match self {
            Subject::Operator(chosen) => chosen.configuration.build(chosen.latency),
            Subject::Step(step) => build_step(&step.configuration).module,
            Subject::Unit(unit) => unit.module.clone(),
        }
    }

    /// The same behind handshakes, as it is verified.
    pub fn unit(&self, core: &Arc<Module>) -> Arc<Module> {
        match self {
            Subject::Operator(_) => stream_unit(core),
            Subject::Step(step) => build_step_unit(&step.configuration),
            Subject::Unit(unit) => unit.module.clone(),
        }
    }
}
