//! The step of any walk that has one in hardware, chosen when the program runs.

use std::borrow::Cow;

use super::bounded_unit::BoundedStep;
use super::fixed_node_step::FixedStep;
use super::linear_step::LinearStep;
use super::linear_walk::linear_shape_for;
use super::node_step::NodeStep;
use super::offset_node_step::OffsetNodeStep;
use super::offset_walk::offset_shape_for;
use super::step::{Named, Register, Signal, Step};
use super::traverse::shape_for;
use super::wide::wide_shape_for;
use super::wide_unit::{WideFixedStep, WideStep};
use super::window::window_shape_for;
use super::window_unit::{WindowFixedStep, WindowStep};
use crate::arith::Arith;
use crate::maps::Pyramid;
use crate::ray::Ray;
use crate::ray_format::RayFormat;
use crate::readings::NumberFormat;
use crate::scene::{Crossing, Family, Walk, WalkFormat};
use crate::walker::WalkerError;

/// A step of any family.
#[derive(Clone, Copy, Debug)]
pub enum AnyStep {
    /// A node of the pyramid a step, in floats.
    Nodes(NodeStep),
    /// The same in exact fixed point.
    Fixed(FixedStep),
    /// A line of nodes a step, in floats.
    Wide(WideStep),
    /// The same in exact fixed point.
    WideFixed(WideFixedStep),
    /// A window of nodes that begins at the ray's own a step, in floats.
    Window(WindowStep),
    /// The same in exact fixed point.
    WindowFixed(WindowFixedStep),
    /// A line of nodes a step by bounds, in exact fixed point.
    Bounded(BoundedStep),
    /// A node a step, borders crossed by an offset.
    Offset(OffsetNodeStep),
    /// A sample a step.
    Linear(LinearStep),
}

impl AnyStep {
    /// The step of a walk on the map under `pyramid`.
    ///
    /// # Errors
    /// If the walk's method, format and crossing have no step together.
    pub fn of(walk: Walk, pyramid: &Pyramid) -> Result<AnyStep, WalkerError> {
        let unsupported = |why| Err(WalkerError::Unsupported { walk, why });
        let fixed = match walk.format {
            WalkFormat::Float(_) => None,
            WalkFormat::Fixed(None) => Some(RayFormat::within_reach(pyramid)),
            WalkFormat::Fixed(Some(format)) => Some(RayFormat::told(format, pyramid)?),
            WalkFormat::F64 | WalkFormat::Exact => {
                return unsupported(
                    "no hardware computes in it; take a float, such as e7f16, or fixed",
                );
            }
        };
        match (walk.method.family(), walk.crossing, fixed) {
            (Family::Nodes(policy), Crossing::Index, None) => Ok(AnyStep::Nodes(NodeStep {
                shape: shape_for(pyramid),
                policy,
            })),
            (Family::Nodes(policy), Crossing::Index, Some(format)) => {
                Ok(AnyStep::Fixed(FixedStep::new(format, policy)))
            }
            (Family::Wide { log2_side }, Crossing::Index, None) => Ok(AnyStep::Wide(WideStep {
                shape: wide_shape_for(pyramid, log2_side),
            })),
            (Family::Wide { log2_side }, Crossing::Index, Some(format)) => {
                Ok(AnyStep::WideFixed(WideFixedStep::new(format, log2_side)))
            }
            (Family::Bounded { log2_side }, Crossing::Index, Some(format)) => {
                Ok(AnyStep::Bounded(BoundedStep::new(format, log2_side)))
            }
            (Family::Bounded { .. }, _, _) => {
                unsupported("it walks in fixed point by the index; take fixed")
            }
            (Family::Window, Crossing::Index, None) => Ok(AnyStep::Window(WindowStep {
                shape: window_shape_for(pyramid),
            })),
            (Family::Window, Crossing::Index, Some(format)) => {
                Ok(AnyStep::WindowFixed(WindowFixedStep::new(format)))
            }
            (Family::Nodes(policy), Crossing::Offset(offset), None) => {
                Ok(AnyStep::Offset(OffsetNodeStep {
                    shape: offset_shape_for(pyramid, policy, offset.texels()),
                }))
            }
            (Family::Linear(search), Crossing::Index, None) => Ok(AnyStep::Linear(LinearStep {
                shape: linear_shape_for(pyramid),
                search,
            })),
            (Family::Linear(_), _, Some(_)) | (Family::Nodes(_), Crossing::Offset(_), Some(_)) => {
                unsupported("it has no step in fixed point; take a float, such as e7f16")
            }
            (Family::Wide { .. } | Family::Window | Family::Linear(_), Crossing::Offset(_), _) => {
                unsupported("it crosses no border of nodes by an offset; leave --crossing out")
            }
        }
    }
}

/// Calls a method of whichever step it is.
macro_rules! of_any {
    ($self:ident, $step:ident => $call:expr) => {
        match $self {
            AnyStep::Nodes($step) => $call,
            AnyStep::Fixed($step) => $call,
            AnyStep::Wide($step) => $call,
            AnyStep::WideFixed($step) => $call,
            AnyStep::Window($step) => $call,
            AnyStep::WindowFixed($step) => $call,
            AnyStep::Bounded($step) => $call,
            AnyStep::Offset($step) => $call,
            AnyStep::Linear($step) => $call,
        }
    };
}

impl Step for AnyStep {
    fn name(&self) -> &'static str {
        of_any!(self, step => step.name())
    }
    fn description(&self) -> Vec<String> {
        of_any!(self, step => step.description())
    }
    fn ray_ports(&self) -> Vec<Register> {
        of_any!(self, step => step.ray_ports())
    }
    fn ray_registers(&self) -> Vec<Register> {
        of_any!(self, step => step.ray_registers())
    }
    fn walk_registers(&self) -> Vec<Register> {
        of_any!(self, step => step.walk_registers())
    }
    fn height_ports(&self) -> Vec<(&'static str, u32)> {
        of_any!(self, step => step.height_ports())
    }
    fn address_port(&self) -> &'static str {
        of_any!(self, step => step.address_port())
    }
    fn address_bits(&self) -> u32 {
        of_any!(self, step => step.address_bits())
    }
    fn step_bound(&self) -> u32 {
        of_any!(self, step => step.step_bound())
    }
    fn memory<'a>(&self, pyramid: &'a Pyramid) -> Cow<'a, [u16]> {
        of_any!(self, step => step.memory(pyramid))
    }
    fn enter<R: NumberFormat>(&self, reading: &mut R, ray: Ray<f64>) -> Vec<Signal<R>> {
        of_any!(self, step => step.enter(reading, ray))
    }
    fn enter_over<R: NumberFormat>(
        &self,
        reading: &mut R,
        pyramid: &Pyramid,
        ray: Ray<f64>,
    ) -> Vec<Signal<R>> {
        of_any!(self, step => step.enter_over(reading, pyramid, ray))
    }
    fn set_up_into<A: Arith>(&self, a: &mut A, ray: &[Signal<A>], registers: &mut Vec<Signal<A>>) {
        of_any!(self, step => step.set_up_into(a, ray, registers));
    }
    fn address<A: Arith>(&self, a: &mut A, registers: &[Signal<A>]) -> A::Int {
        of_any!(self, step => step.address(a, registers))
    }
    fn step_into<A: Arith>(
        &self,
        a: &mut A,
        registers: &[Signal<A>],
        heights: &[A::Int],
        next_walk: &mut Vec<Signal<A>>,
        answer: &mut Vec<Named<A>>,
    ) {
        of_any!(self, step => step.step_into(a, registers, heights, next_walk, answer));
    }
}
