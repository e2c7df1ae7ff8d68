//! Wide steps with their registers in a row: by numbers that may round, and in exact fixed point.

use std::borrow::Cow;

use super::fixed_setup::FixedRayRegisters;
use super::step::{Named, Register, RegisterKind, Signal, Step};
use super::traverse_setup::RayRegisters;
use super::traverse_step::{INDEX_BITS, LEVEL_BITS};
use super::wide_fixed_step::{WideFixedShape, WideFixedWalk, wide_fixed_setup, wide_fixed_step};
use super::wide_setup::wide_setup;
use super::wide_shape::{MOST_LINE_LEVELS, WIDE_COUNTER_BITS, WideShape};
use super::wide_step::wide_step;
use super::wide_walk::{WideWalk, wide_address};
use crate::arith::Arith;
use crate::maps::Pyramid;
use crate::ray::Ray;
use crate::ray_format::RayFormat;
use crate::readings::NumberFormat;
use RegisterKind::{Bit, Integer, Number};

/// The datapaths of a wide walk in numbers that may round: methods `quad` and `block`.
#[derive(Clone, Copy, Debug)]
pub struct WideStep {
    /// The map and its lines.
    pub shape: WideShape,
}

/// The datapaths of a wide walk in exact fixed point.
#[derive(Clone, Copy, Debug)]
pub struct WideFixedStep {
    format: RayFormat,
    log2_side: u32,
}

impl WideFixedStep {
    /// The walk of rays in this format by lines of `2^log2_side` nodes on a side.
    pub fn new(format: RayFormat, log2_side: u32) -> WideFixedStep {
        WideFixedStep { format, log2_side }
    }

    /// The format of its rays.
    pub fn format(&self) -> RayFormat {
        self.format
    }

    /// Its lines and words.
    pub fn shape(&self) -> WideFixedShape {
        WideFixedShape {
            words: self.format.shape(),
            log2_side: self.log2_side,
        }
    }
}

impl Step for WideStep {
    fn name(&self) -> &'static str {
        module_name(self.shape)
    }

    fn description(&self) -> Vec<String> {
        description(self.shape)
    }

    fn ray_ports(&self) -> Vec<Register> {
        ["u", "v", "du", "dv"].map(|name| (name, Number)).to_vec()
    }

    fn ray_registers(&self) -> Vec<Register> {
        vec![
            ("mirrored_u", Number),
            ("mirrored_v", Number),
            ("magnitude_du", Number),
            ("magnitude_dv", Number),
            ("exact_below_u", Number),
            ("exact_below_v", Number),
            ("mirror_u", Bit),
            ("mirror_v", Bit),
            ("start_level", Integer(LEVEL_BITS)),
        ]
    }

    fn walk_registers(&self) -> Vec<Register> {
        let mut registers = walk_registers(self.shape);
        registers.push(("t", Number));
        registers
    }

    fn height_ports(&self) -> Vec<(&'static str, u32)> {
        height_ports(self.shape)
    }

    fn address_bits(&self) -> u32 {
        self.shape.address_bits()
    }

    fn step_bound(&self) -> u32 {
        self.shape.step_bound()
    }

    fn memory<'a>(&self, pyramid: &'a Pyramid) -> Cow<'a, [u16]> {
        Cow::Borrowed(pyramid.lines(self.shape.log2_side).memory())
    }

    fn set_up_into<A: Arith>(&self, a: &mut A, ray: &[Signal<A>], registers: &mut Vec<Signal<A>>) {
        let &[u, v, du, dv] = ray else {
            panic!("{} ray ports", ray.len());
        };
        let [u, v, du, dv] = [u, v, du, dv].map(Signal::number);
        let setup = wide_setup(a, self.shape, Ray { u, v, du, dv });
        let ray = &setup.ray;
        let numbers = [
            ray.u,
            ray.v,
            ray.du,
            ray.dv,
            ray.exact_below_u,
            ray.exact_below_v,
        ];
        registers.extend(numbers.map(Signal::Number));
        registers.extend([ray.mirror_u, ray.mirror_v].map(Signal::Bit));
        registers.push(Signal::Integer(a.int_wrap(setup.start_level, LEVEL_BITS)));
        walk_row(self.shape, &setup.walk, registers);
        registers.push(Signal::Number(a.zero()));
    }

    fn address<A: Arith>(&self, a: &mut A, registers: &[Signal<A>]) -> A::Int {
        let mut row = Row(registers);
        let ray = ray_of(&mut row);
        row.integer();
        let walk = walk_of(self.shape, &mut row);
        wide_address(a, self.shape, ray.mirror_u, ray.mirror_v, &walk)
    }

    fn step_into<A: Arith>(
        &self,
        a: &mut A,
        registers: &[Signal<A>],
        heights: &[A::Int],
        next_walk: &mut Vec<Signal<A>>,
        answer: &mut Vec<Named<A>>,
    ) {
        let mut row = Row(registers);
        let ray = ray_of(&mut row);
        let start_level = row.integer();
        let walk = walk_of(self.shape, &mut row);
        let t = row.next().number();
        let result = wide_step(a, self.shape, &ray, start_level, &walk, t, heights);
        walk_row(self.shape, &result.walk, next_walk);
        next_walk.push(Signal::Number(result.t));
        answer.extend([
            ("texel_i", Signal::Integer(result.texel_i)),
            ("texel_j", Signal::Integer(result.texel_j)),
            ("position_u", Signal::Number(result.position_u)),
            ("position_v", Signal::Number(result.position_v)),
        ]);
    }
}

impl Step for WideFixedStep {
    fn name(&self) -> &'static str {
        match self.log2_side {
            1 => "quad_fixed_step",
            _ => "block_fixed_step",
        }
    }

    fn description(&self) -> Vec<String> {
        let mut lines = description(self.shape().lines());
        lines.push(format!("{}. No decision is rounded.", self.format));
        lines.extend(self.format.reasons());
        lines
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

    fn ray_registers(&self) -> Vec<Register> {
        let words = self.shape().words;
        vec![
            ("mirrored_u", Integer(words.entry_bits())),
            ("mirrored_v", Integer(words.entry_bits())),
            ("slope_u", Integer(words.slope_bits + 1)),
            ("slope_v", Integer(words.slope_bits + 1)),
            ("mirror_u", Bit),
            ("mirror_v", Bit),
            ("start_level", Integer(LEVEL_BITS)),
        ]
    }

    fn walk_registers(&self) -> Vec<Register> {
        let shape = self.shape();
        let mut registers = walk_registers(shape.lines());
        registers.extend([
            ("error", Integer(shape.error_bits())),
            ("depth", Integer(shape.words.height_bits + 1)),
            ("at_border_u", Bit),
            ("at_border_v", Bit),
        ]);
        registers
    }

    fn height_ports(&self) -> Vec<(&'static str, u32)> {
        height_ports(self.shape().lines())
    }

    fn address_bits(&self) -> u32 {
        self.shape().lines().address_bits()
    }

    fn step_bound(&self) -> u32 {
        self.shape().lines().step_bound()
    }

    fn memory<'a>(&self, pyramid: &'a Pyramid) -> Cow<'a, [u16]> {
        Cow::Borrowed(pyramid.lines(self.log2_side).memory())
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
        let setup = wide_fixed_setup(a, self.shape(), u, v, du, dv);
        let ray = &setup.ray;
        registers.extend([ray.u, ray.v, ray.slope_u, ray.slope_v].map(Signal::Integer));
        registers.extend([ray.mirror_u, ray.mirror_v].map(Signal::Bit));
        registers.push(Signal::Integer(a.int_wrap(setup.start_level, LEVEL_BITS)));
        self.row(&setup.walk, registers);
    }

    fn address<A: Arith>(&self, a: &mut A, registers: &[Signal<A>]) -> A::Int {
        let (ray, _, walk) = self.registers(registers);
        wide_address(
            a,
            self.shape().lines(),
            ray.mirror_u,
            ray.mirror_v,
            &walk.walk,
        )
    }

    fn step_into<A: Arith>(
        &self,
        a: &mut A,
        registers: &[Signal<A>],
        heights: &[A::Int],
        next_walk: &mut Vec<Signal<A>>,
        answer: &mut Vec<Named<A>>,
    ) {
        let (ray, start_level, walk) = self.registers(registers);
        let (walk, hit) = wide_fixed_step(a, self.shape(), &ray, start_level, &walk, heights);
        answer.extend([
            ("texel_i", Signal::Integer(hit.texel_i)),
            ("texel_j", Signal::Integer(hit.texel_j)),
            ("side", Signal::Bit(hit.side)),
            ("depth_numerator", Signal::Integer(hit.depth_numerator)),
            ("depth_denominator", Signal::Integer(hit.depth_denominator)),
        ]);
        self.row(&walk, next_walk);
    }
}

impl WideFixedStep {
    fn row<A: Arith>(&self, walk: &WideFixedWalk<A>, row: &mut Vec<Signal<A>>) {
        walk_row(self.shape().lines(), &walk.walk, row);
        row.extend([walk.error, walk.depth].map(Signal::Integer));
        row.extend([walk.at_border_u, walk.at_border_v].map(Signal::Bit));
    }

    fn registers<A: Arith>(
        &self,
        registers: &[Signal<A>],
    ) -> (FixedRayRegisters<A>, A::Int, WideFixedWalk<A>) {
        let mut row = Row(registers);
        let ray = FixedRayRegisters {
            u: row.integer(),
            v: row.integer(),
            slope_u: row.integer(),
            slope_v: row.integer(),
            mirror_u: row.next().bit(),
            mirror_v: row.next().bit(),
        };
        let start_level = row.integer();
        let walk = WideFixedWalk {
            walk: walk_of(self.shape().lines(), &mut row),
            error: row.integer(),
            depth: row.integer(),
            at_border_u: row.next().bit(),
            at_border_v: row.next().bit(),
        };
        (ray, start_level, walk)
    }
}

/// Signals taken one after another.
pub(super) struct Row<'a, A: Arith>(pub(super) &'a [Signal<A>]);

impl<A: Arith> Row<'_, A> {
    pub(super) fn next(&mut self) -> Signal<A> {
        let (&first, rest) = self.0.split_first().expect("a signal for each register");
        self.0 = rest;
        first
    }

    pub(super) fn integer(&mut self) -> A::Int {
        self.next().integer()
    }
}

pub(super) fn ray_of<A: Arith>(row: &mut Row<'_, A>) -> RayRegisters<A> {
    RayRegisters {
        u: row.next().number(),
        v: row.next().number(),
        du: row.next().number(),
        dv: row.next().number(),
        exact_below_u: row.next().number(),
        exact_below_v: row.next().number(),
        mirror_u: row.next().bit(),
        mirror_v: row.next().bit(),
    }
}

fn module_name(shape: WideShape) -> &'static str {
    match shape.log2_side {
        1 => "quad_step",
        _ => "block_step",
    }
}

fn description(shape: WideShape) -> Vec<String> {
    vec![
        format!(
            "One step of a walk by lines of {side} x {side} nodes over a {size} x {size} map of \
             {bits} bit heights:",
            side = shape.side(),
            size = shape.size(),
            bits = shape.height_bits
        ),
        "the line's cells are compared with the ray at once, and the first it may hit is gone down \
         into; the others are kept."
            .to_owned(),
    ]
}

const KEPT: [&str; MOST_LINE_LEVELS] = [
    "kept_0", "kept_1", "kept_2", "kept_3", "kept_4", "kept_5", "kept_6", "kept_7", "kept_8",
    "kept_9", "kept_10", "kept_11",
];

const HEIGHTS: [&str; 16] = [
    "height_0",
    "height_1",
    "height_2",
    "height_3",
    "height_4",
    "height_5",
    "height_6",
    "height_7",
    "height_8",
    "height_9",
    "height_10",
    "height_11",
    "height_12",
    "height_13",
    "height_14",
    "height_15",
];

pub(super) fn height_ports(shape: WideShape) -> Vec<(&'static str, u32)> {
    HEIGHTS[..shape.cells()]
        .iter()
        .map(|&name| (name, shape.height_bits))
        .collect()
}

fn walk_registers(shape: WideShape) -> Vec<Register> {
    let mut registers = vec![
        ("level", Integer(LEVEL_BITS)),
        ("i", Integer(INDEX_BITS)),
        ("j", Integer(INDEX_BITS)),
    ];
    // A mask is read without its sign: its register has a bit more.
    let mask = Integer(shape.cells() as u32 + 1);
    registers.extend(
        KEPT[1..shape.line_levels()]
            .iter()
            .map(|&name| (name, mask)),
    );
    registers.extend([
        ("leaves_u", Bit),
        ("leaves_back", Bit),
        ("steps", Integer(WIDE_COUNTER_BITS)),
        ("crossings", Integer(WIDE_COUNTER_BITS)),
        ("hit", Bit),
        ("guard", Bit),
    ]);
    registers
}

fn walk_row<A: Arith>(shape: WideShape, walk: &WideWalk<A>, row: &mut Vec<Signal<A>>) {
    row.extend([walk.level, walk.i, walk.j].map(Signal::Integer));
    row.extend(
        walk.kept[1..shape.line_levels()]
            .iter()
            .copied()
            .map(Signal::Integer),
    );
    row.extend([walk.leaves_u, walk.leaves_back].map(Signal::Bit));
    row.extend([walk.steps, walk.crossings].map(Signal::Integer));
    row.extend([walk.hit, walk.guard].map(Signal::Bit));
}

fn walk_of<A: Arith>(shape: WideShape, row: &mut Row<'_, A>) -> WideWalk<A> {
    let (level, i, j) = (row.integer(), row.integer(), row.integer());
    // Masks of levels without lines are never looked at.
    let mut kept = [level; MOST_LINE_LEVELS];
    for mask in &mut kept[1..shape.line_levels()] {
        *mask = row.integer();
    }
    WideWalk {
        level,
        i,
        j,
        kept,
        leaves_u: row.next().bit(),
        leaves_back: row.next().bit(),
        steps: row.integer(),
        crossings: row.integer(),
        hit: row.next().bit(),
        guard: row.next().bit(),
    }
}
