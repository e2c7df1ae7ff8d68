//! The exact fixed-point walk by nodes, with its registers in a row.

use std::borrow::Cow;

use super::fixed_setup::{FixedRayRegisters, fixed_setup};
use super::fixed_shape::{FIXED_COUNTER_BITS, FixedShape};
use super::fixed_step::{
    FixedWalkRegisters, asks_for_crossings, fixed_node_address, fixed_step, fixed_walk_start,
    meets_midlines,
};
use super::search_policy::{Ascent, SearchPolicy};
use super::step::{Named, Register, RegisterKind, Signal, Step};
use super::traverse_step::{INDEX_BITS, LEVEL_BITS};
use crate::arith::Arith;
use crate::maps::Pyramid;
use crate::ray::Ray;
use crate::ray_format::RayFormat;
use crate::readings::NumberFormat;
use RegisterKind::{Bit, Integer};

/// The datapaths of the exact fixed-point walk by nodes.
#[derive(Clone, Copy, Debug)]
pub struct FixedStep {
    format: RayFormat,
    policy: SearchPolicy,
}

impl FixedStep {
    /// The walk by this policy, of rays in this format.
    pub fn new(format: RayFormat, policy: SearchPolicy) -> FixedStep {
        FixedStep { format, policy }
    }

    /// The format of its rays.
    pub fn format(&self) -> RayFormat {
        self.format
    }

    fn shape(&self) -> FixedShape {
        self.format.shape()
    }
}

impl Step for FixedStep {
    fn name(&self) -> &'static str {
        "fixed_step"
    }

    fn description(&self) -> Vec<String> {
        let shape = self.shape();
        let mut lines = vec![
            format!(
                "One step of the exact fixed-point walk over a {size} x {size} map of {bits} bit \
                 heights:",
                size = shape.size(),
                bits = shape.height_bits
            ),
            format!("{}. No decision is rounded.", self.format),
        ];
        lines.extend(self.format.reasons());
        lines
    }

    fn ray_ports(&self) -> Vec<Register> {
        let shape = self.shape();
        vec![
            ("u", Integer(shape.entry_bits())),
            ("v", Integer(shape.entry_bits())),
            ("du", Integer(shape.slope_bits + 1)),
            ("dv", Integer(shape.slope_bits + 1)),
        ]
    }

    fn ray_registers(&self) -> Vec<Register> {
        let shape = self.shape();
        vec![
            ("mirrored_u", Integer(shape.entry_bits())),
            ("mirrored_v", Integer(shape.entry_bits())),
            ("slope_u", Integer(shape.slope_bits + 1)),
            ("slope_v", Integer(shape.slope_bits + 1)),
            ("mirror_u", Bit),
            ("mirror_v", Bit),
        ]
    }

    fn walk_registers(&self) -> Vec<Register> {
        let shape = self.shape();
        let mut registers = vec![
            ("level", Integer(LEVEL_BITS)),
            ("i", Integer(INDEX_BITS)),
            ("j", Integer(INDEX_BITS)),
            ("error", Integer(shape.error_bits())),
            ("depth", Integer(shape.height_bits + 1)),
            ("at_border_u", Bit),
            ("at_border_v", Bit),
        ];
        if meets_midlines(self.policy) {
            registers.push(("at_midline", Bit));
        }
        if asks_for_crossings(self.policy) {
            registers.push(("crossed_before", Bit));
        }
        registers.extend([
            ("steps", Integer(FIXED_COUNTER_BITS)),
            ("crossings", Integer(FIXED_COUNTER_BITS)),
            ("hit", Bit),
            ("guard", Bit),
        ]);
        registers
    }

    fn height_ports(&self) -> Vec<(&'static str, u32)> {
        vec![("height", self.shape().height_bits)]
    }

    fn address_bits(&self) -> u32 {
        self.shape().address_bits()
    }

    fn step_bound(&self) -> u32 {
        self.shape().step_bound(self.policy.ascent != Ascent::Never)
    }

    fn memory<'a>(&self, pyramid: &'a Pyramid) -> Cow<'a, [u16]> {
        Cow::Borrowed(pyramid.memory())
    }

    /// The quantised ray: whatever the reading, integers.
    fn enter<R: NumberFormat>(&self, _: &mut R, ray: Ray<f64>) -> Vec<Signal<R>> {
        let ray = self.format.quantise(ray);
        [ray.u, ray.v, ray.du, ray.dv].map(Signal::Integer).to_vec()
    }

    fn set_up_into<A: Arith>(&self, a: &mut A, ray: &[Signal<A>], registers: &mut Vec<Signal<A>>) {
        let &[u, v, du, dv] = ray else {
            panic!("{} ray ports", ray.len());
        };
        let [u, v, du, dv] = [u, v, du, dv].map(Signal::integer);
        let setup = fixed_setup(a, self.shape(), self.policy.start, u, v, du, dv);
        let walk = fixed_walk_start(a, self.policy, &setup);
        registers.extend(ray_row(&setup.ray));
        walk_row(&walk, registers);
    }

    fn address<A: Arith>(&self, a: &mut A, registers: &[Signal<A>]) -> A::Int {
        let (ray, walk) = self.registers(registers);
        fixed_node_address(a, self.shape(), &ray, &walk)
    }

    fn step_into<A: Arith>(
        &self,
        a: &mut A,
        registers: &[Signal<A>],
        heights: &[A::Int],
        next_walk: &mut Vec<Signal<A>>,
        answer: &mut Vec<Named<A>>,
    ) {
        let (ray, walk) = self.registers(registers);
        let (walk, hit) = fixed_step(a, self.shape(), self.policy, &ray, &walk, heights[0]);
        answer.extend([
            ("texel_i", Signal::Integer(hit.texel_i)),
            ("texel_j", Signal::Integer(hit.texel_j)),
            ("side", Signal::Bit(hit.side)),
            ("depth_numerator", Signal::Integer(hit.depth_numerator)),
            ("depth_denominator", Signal::Integer(hit.depth_denominator)),
        ]);
        walk_row(&walk, next_walk);
    }
}

impl FixedStep {
    /// The registers from their row.
    fn registers<A: Arith>(
        &self,
        row: &[Signal<A>],
    ) -> (FixedRayRegisters<A>, FixedWalkRegisters<A>) {
        let mut row = row.iter().copied();
        let mut next = || row.next().expect("a signal a register");
        let ray = FixedRayRegisters {
            u: next().integer(),
            v: next().integer(),
            slope_u: next().integer(),
            slope_v: next().integer(),
            mirror_u: next().bit(),
            mirror_v: next().bit(),
        };
        let walk = FixedWalkRegisters {
            level: next().integer(),
            i: next().integer(),
            j: next().integer(),
            error: next().integer(),
            depth: next().integer(),
            at_border_u: next().bit(),
            at_border_v: next().bit(),
            at_midline: meets_midlines(self.policy).then(|| next().bit()),
            crossed_before: asks_for_crossings(self.policy).then(|| next().bit()),
            steps: next().integer(),
            crossings: next().integer(),
            hit: next().bit(),
            guard: next().bit(),
        };
        (ray, walk)
    }
}

fn ray_row<A: Arith>(ray: &FixedRayRegisters<A>) -> [Signal<A>; 6] {
    [
        Signal::Integer(ray.u),
        Signal::Integer(ray.v),
        Signal::Integer(ray.slope_u),
        Signal::Integer(ray.slope_v),
        Signal::Bit(ray.mirror_u),
        Signal::Bit(ray.mirror_v),
    ]
}

fn walk_row<A: Arith>(walk: &FixedWalkRegisters<A>, row: &mut Vec<Signal<A>>) {
    row.extend([
        Signal::Integer(walk.level),
        Signal::Integer(walk.i),
        Signal::Integer(walk.j),
        Signal::Integer(walk.error),
        Signal::Integer(walk.depth),
        Signal::Bit(walk.at_border_u),
        Signal::Bit(walk.at_border_v),
    ]);
    row.extend(walk.at_midline.map(Signal::Bit));
    row.extend(walk.crossed_before.map(Signal::Bit));
    row.extend([
        Signal::Integer(walk.steps),
        Signal::Integer(walk.crossings),
        Signal::Bit(walk.hit),
        Signal::Bit(walk.guard),
    ]);
}
