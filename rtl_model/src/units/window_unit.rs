//! Window steps with their registers in a row: by numbers that may round, and in exact fixed point.

use std::borrow::Cow;

use super::fixed_setup::FixedRayRegisters;
use super::step::{Named, Register, RegisterKind, Signal, Step};
use super::traverse_step::{INDEX_BITS, LEVEL_BITS};
use super::wide_shape::WIDE_COUNTER_BITS;
use super::wide_unit::{Row, height_ports, ray_of};
use super::window_fixed_step::{
    WindowFixedRay, WindowFixedShape, WindowFixedWalk, window_fixed_setup, window_fixed_step,
};
use super::window_step::{WindowRay, window_setup, window_step};
use super::window_walk::{WindowShape, WindowWalk, window_address};
use crate::arith::Arith;
use crate::maps::{Pyramid, all_windows};
use crate::ray::Ray;
use crate::ray_format::RayFormat;
use crate::readings::NumberFormat;
use RegisterKind::{Bit, Integer, Number};

/// The datapaths of a window walk in numbers that may round: method `window`.
#[derive(Clone, Copy, Debug)]
pub struct WindowStep {
    /// The map.
    pub shape: WindowShape,
}

/// The datapaths of a window walk in exact fixed point.
#[derive(Clone, Copy, Debug)]
pub struct WindowFixedStep {
    format: RayFormat,
}

impl WindowFixedStep {
    /// The walk of rays in this format.
    pub fn new(format: RayFormat) -> WindowFixedStep {
        WindowFixedStep { format }
    }

    /// The format of its rays.
    pub fn format(&self) -> RayFormat {
        self.format
    }

    /// Its words.
    pub fn shape(&self) -> WindowFixedShape {
        WindowFixedShape {
            words: self.format.shape(),
        }
    }
}

impl Step for WindowStep {
    fn name(&self) -> &'static str {
        "window_step"
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
            ("entry_i", Integer(INDEX_BITS)),
            ("entry_j", Integer(INDEX_BITS)),
        ]
    }

    fn walk_registers(&self) -> Vec<Register> {
        let mut registers = walk_registers();
        registers.push(("t", Number));
        registers
    }

    fn height_ports(&self) -> Vec<(&'static str, u32)> {
        height_ports(self.shape.cells())
    }

    fn address_bits(&self) -> u32 {
        self.shape.address_bits()
    }

    fn step_bound(&self) -> u32 {
        self.shape.step_bound()
    }

    fn memory<'a>(&self, pyramid: &'a Pyramid) -> Cow<'a, [u16]> {
        Cow::Owned(all_windows(pyramid))
    }

    fn set_up_into<A: Arith>(&self, a: &mut A, ray: &[Signal<A>], registers: &mut Vec<Signal<A>>) {
        let &[u, v, du, dv] = ray else {
            panic!("{} ray ports", ray.len());
        };
        let [u, v, du, dv] = [u, v, du, dv].map(Signal::number);
        let (ray, walk) = window_setup(a, self.shape, Ray { u, v, du, dv });
        let numbers = [
            ray.ray.u,
            ray.ray.v,
            ray.ray.du,
            ray.ray.dv,
            ray.ray.exact_below_u,
            ray.ray.exact_below_v,
        ];
        registers.extend(numbers.map(Signal::Number));
        registers.extend([ray.ray.mirror_u, ray.ray.mirror_v].map(Signal::Bit));
        registers.extend([ray.entry_i, ray.entry_j].map(Signal::Integer));
        registers.extend(walk_row(&walk));
        registers.push(Signal::Number(a.zero()));
    }

    fn address<A: Arith>(&self, a: &mut A, registers: &[Signal<A>]) -> A::Int {
        let (ray, walk, _) = WindowStep::registers(registers);
        window_address(a, self.shape, ray.ray.mirror_u, ray.ray.mirror_v, &walk)
    }

    fn step_into<A: Arith>(
        &self,
        a: &mut A,
        registers: &[Signal<A>],
        heights: &[A::Int],
        next_walk: &mut Vec<Signal<A>>,
        answer: &mut Vec<Named<A>>,
    ) {
        let (ray, walk, t) = WindowStep::registers(registers);
        let result = window_step(a, self.shape, &ray, &walk, t, heights);
        next_walk.extend(walk_row(&result.walk));
        next_walk.push(Signal::Number(result.t));
        answer.extend([
            ("texel_i", Signal::Integer(result.texel_i)),
            ("texel_j", Signal::Integer(result.texel_j)),
            ("position_u", Signal::Number(result.position_u)),
            ("position_v", Signal::Number(result.position_v)),
        ]);
    }
}

impl WindowStep {
    fn registers<A: Arith>(registers: &[Signal<A>]) -> (WindowRay<A>, WindowWalk<A>, A::Num) {
        let mut row = Row(registers);
        let ray = WindowRay {
            ray: ray_of(&mut row),
            entry_i: row.integer(),
            entry_j: row.integer(),
        };
        let walk = walk_of(&mut row);
        (ray, walk, row.next().number())
    }
}

impl Step for WindowFixedStep {
    fn name(&self) -> &'static str {
        "window_fixed_step"
    }

    fn description(&self) -> Vec<String> {
        let mut lines = description(self.shape().windows());
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
            ("entry_i", Integer(words.root_level + 1)),
            ("entry_j", Integer(words.root_level + 1)),
        ]
    }

    fn walk_registers(&self) -> Vec<Register> {
        let words = self.shape().words;
        let mut registers = walk_registers();
        registers.extend([
            ("error", Integer(words.error_bits())),
            ("depth", Integer(words.height_bits + 1)),
            ("at_border_u", Bit),
            ("at_border_v", Bit),
        ]);
        registers
    }

    fn height_ports(&self) -> Vec<(&'static str, u32)> {
        height_ports(self.shape().windows().cells())
    }

    fn address_bits(&self) -> u32 {
        self.shape().windows().address_bits()
    }

    fn step_bound(&self) -> u32 {
        self.shape().windows().step_bound()
    }

    fn memory<'a>(&self, pyramid: &'a Pyramid) -> Cow<'a, [u16]> {
        Cow::Owned(all_windows(pyramid))
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
        let (ray, walk) = window_fixed_setup(a, self.shape(), u, v, du, dv);
        let words = [ray.ray.u, ray.ray.v, ray.ray.slope_u, ray.ray.slope_v];
        registers.extend(words.map(Signal::Integer));
        registers.extend([ray.ray.mirror_u, ray.ray.mirror_v].map(Signal::Bit));
        registers.extend([ray.entry_i, ray.entry_j].map(Signal::Integer));
        fixed_walk_row(&walk, registers);
    }

    fn address<A: Arith>(&self, a: &mut A, registers: &[Signal<A>]) -> A::Int {
        let (ray, walk) = WindowFixedStep::registers(registers);
        let windows = self.shape().windows();
        window_address(a, windows, ray.ray.mirror_u, ray.ray.mirror_v, &walk.walk)
    }

    fn step_into<A: Arith>(
        &self,
        a: &mut A,
        registers: &[Signal<A>],
        heights: &[A::Int],
        next_walk: &mut Vec<Signal<A>>,
        answer: &mut Vec<Named<A>>,
    ) {
        let (ray, walk) = WindowFixedStep::registers(registers);
        let (walk, hit) = window_fixed_step(a, self.shape(), &ray, &walk, heights);
        answer.extend([
            ("texel_i", Signal::Integer(hit.texel_i)),
            ("texel_j", Signal::Integer(hit.texel_j)),
            ("side", Signal::Bit(hit.side)),
            ("depth_numerator", Signal::Integer(hit.depth_numerator)),
            ("depth_denominator", Signal::Integer(hit.depth_denominator)),
        ]);
        fixed_walk_row(&walk, next_walk);
    }
}

impl WindowFixedStep {
    fn registers<A: Arith>(registers: &[Signal<A>]) -> (WindowFixedRay<A>, WindowFixedWalk<A>) {
        let mut row = Row(registers);
        let ray = WindowFixedRay {
            ray: FixedRayRegisters {
                u: row.integer(),
                v: row.integer(),
                slope_u: row.integer(),
                slope_v: row.integer(),
                mirror_u: row.next().bit(),
                mirror_v: row.next().bit(),
            },
            entry_i: row.integer(),
            entry_j: row.integer(),
        };
        let walk = WindowFixedWalk {
            walk: walk_of(&mut row),
            error: row.integer(),
            depth: row.integer(),
            at_border_u: row.next().bit(),
            at_border_v: row.next().bit(),
        };
        (ray, walk)
    }
}

fn description(shape: WindowShape) -> Vec<String> {
    vec![
        format!(
            "One step of a walk by windows of 4 x 4 nodes over a {size} x {size} map of {bits} bit \
             heights:",
            size = shape.size(),
            bits = shape.height_bits
        ),
        "the nodes from the ray's own on are compared with it at once, and the first it may hit is \
         gone down into, two levels."
            .to_owned(),
    ]
}

fn walk_registers() -> Vec<Register> {
    vec![
        ("level", Integer(LEVEL_BITS)),
        ("i", Integer(INDEX_BITS)),
        ("j", Integer(INDEX_BITS)),
        ("steps", Integer(WIDE_COUNTER_BITS)),
        ("crossings", Integer(WIDE_COUNTER_BITS)),
        ("hit", Bit),
        ("guard", Bit),
    ]
}

fn walk_row<A: Arith>(walk: &WindowWalk<A>) -> [Signal<A>; 7] {
    [
        Signal::Integer(walk.level),
        Signal::Integer(walk.i),
        Signal::Integer(walk.j),
        Signal::Integer(walk.steps),
        Signal::Integer(walk.crossings),
        Signal::Bit(walk.hit),
        Signal::Bit(walk.guard),
    ]
}

fn fixed_walk_row<A: Arith>(walk: &WindowFixedWalk<A>, row: &mut Vec<Signal<A>>) {
    row.extend(walk_row(&walk.walk));
    row.extend([walk.error, walk.depth].map(Signal::Integer));
    row.extend([walk.at_border_u, walk.at_border_v].map(Signal::Bit));
}

fn walk_of<A: Arith>(row: &mut Row<'_, A>) -> WindowWalk<A> {
    WindowWalk {
        level: row.integer(),
        i: row.integer(),
        j: row.integer(),
        steps: row.integer(),
        crossings: row.integer(),
        hit: row.next().bit(),
        guard: row.next().bit(),
    }
}
