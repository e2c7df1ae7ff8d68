//! The step of a walk by bounds with its registers in a row.
//!
//! Here the bounds of the blocks of all lines are registers. A unit may keep them in a memory
//! by ray and line number instead, and put [`super::bounded_step::bounded_step`] in front of it: it reads one
//! entry and writes one.

use std::borrow::Cow;

use super::bounded_datapaths::{bounded_walk_of, bounded_walk_registers, bounded_walk_row, no_ray};
use super::bounded_setup::{BoundedRay, bounded_setup, by_line};
use super::bounded_shape::{BoundedShape, LINE_BITS, MOST_BOUNDED_LINES};
use super::bounded_step::{
    BoundedWalk, base_line, bounded_address, bounded_step, bounded_walk_start,
};
use super::step::{Named, Register, RegisterKind, Signal, Step};
use super::wide_unit::{Row, height_ports};
use super::wide_walk::wide_texel;
use crate::arith::Arith;
use crate::maps::Pyramid;
use crate::ray::Ray;
use crate::ray_format::RayFormat;
use crate::readings::NumberFormat;
use RegisterKind::{Bit, Integer};

/// The datapath of a walk by bounds. Its `hit` says that the walk has come to a texel which the leaf
/// check ([`super::bounded_leaf::leaf_check`]) is to decide.
#[derive(Clone, Copy, Debug)]
pub struct BoundedStep {
    format: RayFormat,
    log2_side: u32,
}

impl BoundedStep {
    /// The walk of rays in this format by lines of `2^log2_side` nodes on a side.
    pub fn new(format: RayFormat, log2_side: u32) -> BoundedStep {
        BoundedStep { format, log2_side }
    }

    /// Its lines and words.
    pub fn shape(&self) -> BoundedShape {
        BoundedShape::new(self.format.shape(), self.log2_side)
    }
}

impl Step for BoundedStep {
    fn name(&self) -> &'static str {
        match self.log2_side {
            1 => "bounded_quad_step",
            _ => "bounded_block_step",
        }
    }

    fn description(&self) -> Vec<String> {
        let shape = self.shape();
        let lines = shape.lines();
        let mut text = vec![
            format!(
                "One step of a walk by bounds through lines of {side} x {side} nodes over a {size} x \
                 {size} map of {bits} bit heights:",
                side = lines.side(),
                size = lines.size(),
                bits = lines.height_bits
            ),
            "of the line's cells those that the ray may hit are kept, and the first is gone down into."
                .to_owned(),
            format!(
                "Depths of borders are known to within 2^-{} height steps, late, in words of {} \
                 fraction bits; a texel is decided by the leaf check.",
                shape.order_fraction_bits(),
                shape.fraction_bits()
            ),
        ];
        text.extend(self.format.reasons());
        text
    }

    fn ray_ports(&self) -> Vec<Register> {
        let words = self.shape().words;
        vec![
            ("u", Integer(words.entry_bits())),
            ("v", Integer(words.entry_bits())),
            ("du", Integer(words.slope_bits + 1)),
            ("dv", Integer(words.slope_bits + 1)),
        ]
    }

    /// What a step reads; the mirrored ray itself goes to the leaf check.
    fn ray_registers(&self) -> Vec<Register> {
        let shape = self.shape();
        vec![
            ("t_delta_u", Integer(shape.delta_bits() + 1)),
            ("t_delta_v", Integer(shape.delta_bits() + 1)),
            ("mirror_u", Bit),
            ("mirror_v", Bit),
            ("start_line", Integer(LINE_BITS)),
        ]
    }

    fn walk_registers(&self) -> Vec<Register> {
        let shape = self.shape();
        let mut registers = bounded_walk_registers(shape);
        let bound = Integer(shape.bound_bits());
        for names in [T_NEAR_U, T_NEAR_V] {
            let names = names[..shape.line_levels()].iter();
            registers.extend(names.map(|&name| (name, bound)));
        }
        registers
    }

    fn height_ports(&self) -> Vec<(&'static str, u32)> {
        height_ports(self.shape().lines())
    }

    fn address_port(&self) -> &'static str {
        "line_address"
    }

    fn address_bits(&self) -> u32 {
        self.shape().address_bits()
    }

    fn step_bound(&self) -> u32 {
        self.shape().step_bound()
    }

    fn memory<'a>(&self, pyramid: &'a Pyramid) -> Cow<'a, [u16]> {
        Cow::Borrowed(pyramid.lines(self.log2_side).memory())
    }

    /// The quantised ray: whatever the reading, integers.
    fn enter<R: NumberFormat>(&self, _: &mut R, ray: Ray<f64>) -> Vec<Signal<R>> {
        let ray = self.format.quantise(ray);
        [ray.u, ray.v, ray.du, ray.dv].map(Signal::Integer).to_vec()
    }

    fn set_up_into<A: Arith>(&self, a: &mut A, ray: &[Signal<A>], row: &mut Vec<Signal<A>>) {
        let &[u, v, du, dv] = ray else {
            panic!("{} ray ports", ray.len());
        };
        let shape = self.shape();
        let setup = bounded_setup(a, shape, [u, v, du, dv].map(Signal::integer));
        let ray = &setup.ray;
        row.extend([ray.t_delta_u, ray.t_delta_v].map(Signal::Integer));
        row.extend([ray.fixed.mirror_u, ray.fixed.mirror_v].map(Signal::Bit));
        row.push(Signal::Integer(ray.start_line));
        let walk = bounded_walk_start(a, ray.start_line, setup.i, setup.j);
        // Of all lines the bounds of the start line are read first; the others are written before.
        let u = [setup.t_near_u; MOST_BOUNDED_LINES];
        let v = [setup.t_near_v; MOST_BOUNDED_LINES];
        self.walk_row(&walk, &u, &v, row);
    }

    fn address<A: Arith>(&self, a: &mut A, registers: &[Signal<A>]) -> A::Int {
        let registers = self.registers(a, registers);
        let mirrors = (registers.ray.fixed.mirror_u, registers.ray.fixed.mirror_v);
        bounded_address(a, self.shape(), mirrors, &registers.walk)
    }

    fn step_into<A: Arith>(
        &self,
        a: &mut A,
        registers: &[Signal<A>],
        heights: &[A::Int],
        next_walk: &mut Vec<Signal<A>>,
        answer: &mut Vec<Named<A>>,
    ) {
        let shape = self.shape();
        let Registers {
            ray,
            walk,
            mut t_near_u,
            mut t_near_v,
        } = self.registers(a, registers);
        let base = base_line(a, &walk);
        let base_u = by_line(a, shape, base, |_, n| t_near_u[n]);
        let base_v = by_line(a, shape, base, |_, n| t_near_v[n]);
        let result = bounded_step(a, shape, &ray, &walk, (base_u, base_v), heights);
        let ended = a.or(walk.hit, walk.guard);
        let running = a.not(ended);
        for n in 0..shape.line_levels() {
            let number = a.int_constant(n as i64);
            let is_this = a.int_equal(walk.line, number);
            let writes = a.and(is_this, running);
            t_near_u[n] = a.int_select(writes, result.t_near.0, t_near_u[n]);
            t_near_v[n] = a.int_select(writes, result.t_near.1, t_near_v[n]);
        }
        let after = result.walk;
        self.walk_row(&after, &t_near_u, &t_near_v, next_walk);
        let texel_i = wide_texel(a, shape.lines(), ray.fixed.mirror_u, after.i);
        let texel_j = wide_texel(a, shape.lines(), ray.fixed.mirror_v, after.j);
        answer.extend([
            ("texel_i", Signal::Integer(texel_i)),
            ("texel_j", Signal::Integer(texel_j)),
        ]);
    }
}

struct Registers<A: Arith> {
    ray: BoundedRay<A>,
    walk: BoundedWalk<A>,
    t_near_u: [A::Int; MOST_BOUNDED_LINES],
    t_near_v: [A::Int; MOST_BOUNDED_LINES],
}

impl BoundedStep {
    fn walk_row<A: Arith>(
        &self,
        walk: &BoundedWalk<A>,
        t_near_u: &[A::Int],
        t_near_v: &[A::Int],
        row: &mut Vec<Signal<A>>,
    ) {
        let count = self.shape().line_levels();
        bounded_walk_row(self.shape(), walk, row);
        for words in [t_near_u, t_near_v] {
            row.extend(words[..count].iter().copied().map(Signal::Integer));
        }
    }

    fn registers<A: Arith>(&self, a: &mut A, registers: &[Signal<A>]) -> Registers<A> {
        let shape = self.shape();
        let mut row = Row(registers);
        // A step does not read the ray itself.
        let mut fixed = no_ray(a);
        let (t_delta_u, t_delta_v) = (row.integer(), row.integer());
        (fixed.mirror_u, fixed.mirror_v) = (row.next().bit(), row.next().bit());
        let ray = BoundedRay {
            fixed,
            t_delta_u,
            t_delta_v,
            start_line: row.integer(),
        };
        let walk = bounded_walk_of(a, shape, &mut row);
        let none = a.int_constant(0);
        let [mut t_near_u, mut t_near_v] = [[none; MOST_BOUNDED_LINES]; 2];
        for words in [&mut t_near_u, &mut t_near_v] {
            for word in &mut words[..shape.line_levels()] {
                *word = row.integer();
            }
        }
        Registers {
            ray,
            walk,
            t_near_u,
            t_near_v,
        }
    }
}

const T_NEAR_U: [&str; MOST_BOUNDED_LINES] = [
    "t_near_u_0",
    "t_near_u_1",
    "t_near_u_2",
    "t_near_u_3",
    "t_near_u_4",
    "t_near_u_5",
];
const T_NEAR_V: [&str; MOST_BOUNDED_LINES] = [
    "t_near_v_0",
    "t_near_v_1",
    "t_near_v_2",
    "t_near_v_3",
    "t_near_v_4",
    "t_near_v_5",
];
