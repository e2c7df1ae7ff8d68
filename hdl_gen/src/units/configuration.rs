//! What a traverse unit is built for.

use crate::datapath::OperatorLatencies;
use crate::operators::{FloatOperator, UnsupportedOperator};
use rtl_model::float::FloatFormat;
use rtl_model::maps::Pyramid;
use rtl_model::ray::Ray;
use rtl_model::readings::FloatReading;
use rtl_model::scene::{LinearSearch, Method, Walk, WalkFormat};
use rtl_model::units::any_step::AnyStep;
use rtl_model::units::node_step::NodeStep;
use rtl_model::units::search_policy::SearchPolicy;
use rtl_model::units::step::{RegisterKind, Step};
use rtl_model::units::traverse::shape_for;
use rtl_model::units::traverse_step::TraverseShape;
use rtl_model::walker::WalkerError;
use thiserror::Error;

/// What a traverse unit, or a step alone, is built for.
#[derive(Clone, Copy, Debug)]
pub struct UnitConfiguration {
    /// The map's size and height bits.
    pub shape: TraverseShape,
    /// The traversal.
    pub method: Method,
    /// What a step of it does.
    pub step: AnyStep,
    /// The format of its numbers, if it has any.
    pub format: FloatFormat,
    /// Cycles of each operator.
    pub latencies: OperatorLatencies,
}

/// Why a walk has no hardware.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoHardware {
    /// It has no step.
    #[error(transparent)]
    Walk(#[from] WalkerError),
    /// Its step has more to it than the loop has.
    #[error(
        "method {method} in format {format}: the whole unit is built for steps that read one height \
         each and compute in floats; this step is checked on its own, by stepwell verify --unit \
         traverse_step --method {method} --format {format}"
    )]
    NoLoop {
        /// The method's name.
        method: String,
        /// The format's.
        format: String,
    },
    /// Its numbers are too wide.
    #[error(transparent)]
    Format(#[from] UnsupportedOperator),
}

impl UnitConfiguration {
    /// For the unit of method `oh`.
    pub fn oh(shape: TraverseShape, format: FloatFormat) -> UnitConfiguration {
        let policy = SearchPolicy::OH;
        UnitConfiguration {
            shape,
            method: Method::Oh,
            step: AnyStep::Nodes(NodeStep { shape, policy }),
            format,
            latencies: OperatorLatencies::PAPER,
        }
    }

    /// For a walk on a map.
    ///
    /// # Errors
    /// If there is no hardware of the walk's method, crossing and format together.
    pub fn of(walk: Walk, pyramid: &Pyramid) -> Result<UnitConfiguration, NoHardware> {
        let step = AnyStep::of(walk, pyramid)?;
        let format = match walk.format {
            WalkFormat::Float(format) => format,
            // Nothing is computed in it.
            _ => FloatFormat::E7F16,
        };
        let configuration = UnitConfiguration {
            shape: shape_for(pyramid),
            method: walk.method,
            step,
            format,
            latencies: OperatorLatencies::PAPER,
        };
        if configuration.has_numbers() {
            FloatOperator::Add.check(format)?;
        }
        Ok(configuration)
    }

    /// Can its step be closed to the loop of [`super::TraverseUnit`]?
    ///
    /// # Errors
    /// If it does not read one height a step, or has other ports or answers.
    pub fn check_loop(&self) -> Result<(), NoHardware> {
        match self.step {
            AnyStep::Nodes(_) | AnyStep::Offset(_) => Ok(()),
            AnyStep::Fixed(_)
            | AnyStep::Wide(_)
            | AnyStep::WideFixed(_)
            | AnyStep::Window(_)
            | AnyStep::WindowFixed(_)
            | AnyStep::Bounded(_)
            | AnyStep::Linear(_) => Err(NoHardware::NoLoop {
                method: self.method.to_string(),
                format: match self.has_numbers() {
                    true => self.format.to_string(),
                    false => "fixed".to_owned(),
                },
            }),
        }
    }

    /// What the ray ports of the loop carry for an admitted ray.
    pub fn port_words(&self, ray: Ray<f64>) -> Ray<u64> {
        let mut reading = FloatReading(self.format);
        let ports = self.step.enter(&mut reading, ray);
        let kinds = self.step.ray_ports().into_iter();
        let words = ports.into_iter().zip(kinds).map(|(signal, (_, kind))| {
            let word = signal.word(&reading);
            match kind {
                RegisterKind::Integer(bits) => word & (u64::MAX >> (64 - bits)),
                _ => word,
            }
        });
        let words: Vec<u64> = words.collect();
        let [u, v, du, dv] = words[..] else {
            panic!(
                "a ray of the loop has four ports, and this one {}",
                words.len()
            );
        };
        Ray { u, v, du, dv }
    }

    /// Cycles from an address to its height: the memory is synchronous.
    pub const fn memory_latency(&self) -> u32 {
        1
    }

    /// Does it compute with numbers, or with integers alone?
    pub fn has_numbers(&self) -> bool {
        let step = self.step;
        let registers = [
            step.ray_ports(),
            step.ray_registers(),
            step.walk_registers(),
        ];
        let mut registers = registers.iter().flatten();
        registers.any(|&(_, kind)| kind == RegisterKind::Number)
    }

    /// What a module's header says of the step: what it does, the method, the format.
    pub(super) fn description(&self) -> Vec<String> {
        let mut lines = self.step.description();
        lines.push(format!("method: {}", self.method));
        if self.has_numbers() {
            lines.push(format!("format: {}", self.format));
        }
        lines
    }

    /// The function that the golden model evaluates for a step.
    pub(super) fn golden(&self) -> &'static str {
        match self.step {
            AnyStep::Nodes(_) => "rtl_model::units::traverse_step::traverse_step",
            AnyStep::Fixed(_) => "rtl_model::units::fixed_step::fixed_step",
            AnyStep::Wide(_) => "rtl_model::units::wide_step::wide_step",
            AnyStep::WideFixed(_) => "rtl_model::units::wide_fixed_step::wide_fixed_step",
            AnyStep::Window(_) => "rtl_model::units::window_step::window_step",
            AnyStep::WindowFixed(_) => "rtl_model::units::window_fixed_step::window_fixed_step",
            AnyStep::Bounded(_) => "rtl_model::units::bounded_step::bounded_step",
            AnyStep::Offset(_) => "rtl_model::units::offset_step::offset_step",
            AnyStep::Linear(step) => match step.search {
                LinearSearch::Pom => "rtl_model::units::pom_step::pom_step",
                LinearSearch::Relief | LinearSearch::Dig => {
                    "rtl_model::units::relief_step::relief_step"
                }
            },
        }
    }

    /// The operators' cycles, as a module's header says them.
    pub(super) fn cycles_line(&self, all: u32) -> String {
        let latencies = self.latencies;
        match self.has_numbers() {
            true => format!(
                "cycles: adder {}, multiplier {}, divider {}, comparator {}, conversion {}; {all} in \
                 all",
                latencies.adder,
                latencies.multiplier,
                latencies.divider,
                latencies.comparator,
                latencies.conversion,
            ),
            false => format!("cycles: multiplier {}; {all} in all", latencies.multiplier),
        }
    }
}
