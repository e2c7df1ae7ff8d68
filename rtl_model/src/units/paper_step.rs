//! The datapath of the 2013 hardware paper's traverse unit: one pass of a ray round the loop, in
//! one of two modes (section 4.2, figure 7).
//!
//! In mode *start level*, the first pass of every ray, the hit position is computed at full depth:
//! the register t holds 1, and the multipliers and adders that give the position in every pass give
//! the ray's end. The start level is decided from it. In mode *walk* a pass is one step of
//! `mixed-selective`, bit for bit that of [`traverse_step`]: the same bounds, the same carried
//! indices, so that every hit is that of the golden walk.
//!
//! A pass changes nothing of the walk where the height cache missed: the ray asks again in its
//! next pass. So there is no register that says whether a walk has ended, as the other loops have
//! one: a ray that has hit leaves at the end of that very pass.

use super::node_step::{RAY_REGISTERS, ray_row};
use super::search_policy::{Ascent, SearchPolicy, Start};
use super::step::{Named, Register, RegisterKind, Signal};
use super::traverse_setup::{RayRegisters, mirror_ray};
use super::traverse_shape::{INDEX_BITS, LEVEL_BITS, SHIFT_BITS, TraverseShape, counter_bits};
use super::traverse_start::node_of_whole_ray;
use super::traverse_step::{WalkRegisters, traverse_step};
use crate::arith::Arith;
use crate::maps::{Pyramid, node_address};

/// Bits of the nodes on a side of a line of heights: a line holds 4 x 4 nodes of a level.
const LINE_SIDE_BITS: u32 = 2;

/// The paper's traversal: its three parts a, b and c1 together.
pub const PAPER_POLICY: SearchPolicy = SearchPolicy {
    start: Start::WholeRay,
    levels_down: 2,
    ascent: Ascent::Selective,
};

/// How the pyramid lies in memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum HeightLayout {
    /// Row by row, each level in one piece, as [`crate::maps::Pyramid::memory`] is: a line of 16
    /// heights is a piece of a row.
    Rows,
    /// The same levels in the same places, but in tiles of 4 x 4 nodes, which are lines.
    #[default]
    Tiles,
}

/// The paper's traverse unit on a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PaperStep {
    /// The map it is built for.
    pub shape: TraverseShape,
    /// How its heights lie in memory.
    pub layout: HeightLayout,
}

/// The registers of the loop besides the ray's own, which are [`PaperStep::ray_registers`].
struct LoopRegisters<A: Arith> {
    ray: RayRegisters<A>,
    starts: A::Bit,
    level: A::Int,
    i: A::Int,
    j: A::Int,
    t: A::Num,
    at_border_v: A::Bit,
    corner_owed: A::Bit,
    corner_paid: A::Bit,
    steps: A::Int,
    crossings: A::Int,
}

impl<A: Arith> LoopRegisters<A> {
    fn of(row: &[Signal<A>]) -> LoopRegisters<A> {
        let mut row = row.iter();
        let mut next = || *row.next().expect("as many registers as are declared");
        let registers = LoopRegisters {
            ray: RayRegisters {
                u: next().number(),
                v: next().number(),
                du: next().number(),
                dv: next().number(),
                exact_below_u: next().number(),
                exact_below_v: next().number(),
                mirror_u: next().bit(),
                mirror_v: next().bit(),
            },
            starts: next().bit(),
            level: next().integer(),
            i: next().integer(),
            j: next().integer(),
            t: next().number(),
            at_border_v: next().bit(),
            corner_owed: next().bit(),
            corner_paid: next().bit(),
            steps: next().integer(),
            crossings: next().integer(),
        };
        assert!(row.next().is_none(), "no more registers than are declared");
        registers
    }
}

impl PaperStep {
    /// The ports a ray comes in by: its entry and its offset for one unit of depth.
    pub fn ray_ports(&self) -> Vec<Register> {
        RAY_REGISTERS[..4].to_vec()
    }

    /// The registers a ray carries unchanged from pass to pass.
    pub fn ray_registers(&self) -> Vec<Register> {
        RAY_REGISTERS.to_vec()
    }

    /// The registers of its walk; `starts` says that the pass is in mode start level.
    pub fn walk_registers(&self) -> Vec<Register> {
        let index = RegisterKind::Integer(INDEX_BITS);
        let count = RegisterKind::Integer(counter_bits(PAPER_POLICY));
        vec![
            ("starts", RegisterKind::Bit),
            ("level", RegisterKind::Integer(LEVEL_BITS)),
            ("i", index),
            ("j", index),
            ("t", RegisterKind::Number),
            ("at_border_v", RegisterKind::Bit),
            ("corner_owed", RegisterKind::Bit),
            ("corner_paid", RegisterKind::Bit),
            ("steps", count),
            ("crossings", count),
        ]
    }

    /// Bits of an address of a height.
    pub fn address_bits(&self) -> u32 {
        // The root of the tiled layout is at address 4, the nodes below it at 8 to 13. Two lines
        // are the fewest that a cache tells apart.
        self.shape.address_bits().max(6)
    }

    /// A ray as it enters the loop: appends its registers, the walk's in mode start level, at full
    /// depth.
    pub fn set_up_into<A: Arith>(&self, a: &mut A, ray: &[Signal<A>], row: &mut Vec<Signal<A>>) {
        let [u, v, du, dv] = [0, 1, 2, 3].map(|port| ray[port].number());
        let (ray, _) = mirror_ray(a, u, v, du, dv);
        let (yes, no) = (a.bit_constant(true), a.bit_constant(false));
        let (one, none) = (a.int_constant(1), a.int_constant(0));
        let full_depth = a.number_from_integer(crate::float::Rounding::NearestEven, one, none);
        ray_row(&ray, row);
        row.push(Signal::Bit(yes));
        row.extend([none; 3].map(Signal::Integer));
        row.push(Signal::Number(full_depth));
        row.extend([no; 3].map(Signal::Bit));
        row.extend([none; 2].map(Signal::Integer));
    }

    /// [`PaperStep::set_up_into`] a row of its own, where speed does not matter.
    pub fn set_up<A: Arith>(&self, a: &mut A, ray: &[Signal<A>]) -> Vec<Signal<A>> {
        let mut row = Vec::new();
        self.set_up_into(a, ray, &mut row);
        row
    }

    /// Where the height of node `(i, j)` of a level lies in memory; `i` and `j` wrap. The same as
    /// [`PaperStep::address`], for those who fill the memory.
    pub fn height_address(&self, level: u32, i: i64, j: i64) -> u32 {
        let rows = node_address(self.shape.root_level, level, i, j);
        match self.layout {
            HeightLayout::Rows => rows,
            HeightLayout::Tiles => {
                let below_root = self.shape.root_level - level;
                let (marked_j, i) = (rows >> below_root, rows & ((1 << below_root) - 1));
                ((marked_j >> 2) << (below_root + 2)) | (i >> 2) << 4 | (marked_j & 3) << 2 | i & 3
            }
        }
    }

    /// The memory that a pyramid's heights lie in, from address 0 on; unused heights are 0.
    pub fn memory(&self, pyramid: &Pyramid) -> Vec<u16> {
        let mut memory = vec![0; 1 << self.address_bits()];
        for level in 0..=self.shape.root_level {
            let nodes = 1_i64 << (self.shape.root_level - level);
            for (j, i) in (0..nodes).flat_map(|j| (0..nodes).map(move |i| (j, i))) {
                memory[self.height_address(level, i, j) as usize] = pyramid.height(level, i, j);
            }
        }
        memory
    }

    /// Where the height of the walk's node lies in memory. With k index bits of the node's level on
    /// each axis, and r the index on v with a one in front (bit k): row by row the address is
    /// `r << k | i`; in tiles `(r >> 2) << (k + 2) | (i >> 2) << 4 | (r & 3) << 2 | (i & 3)`, which
    /// names no height twice either: the root is at 4, the four nodes below it at 8 to 13.
    pub fn address<A: Arith>(&self, a: &mut A, registers: &[Signal<A>]) -> A::Int {
        let LoopRegisters {
            ray, level, i, j, ..
        } = LoopRegisters::of(registers);
        let root_level = a.int_constant(i64::from(self.shape.root_level));
        let below_root = a.int_sub(root_level, level);
        let below_root = a.int_low_bits(below_root, SHIFT_BITS);
        a.name_int("below_root", below_root);
        let one = a.int_constant(1);
        let nodes_on_a_side = a.int_shift_left(one, below_root, SHIFT_BITS);
        let nodes_on_a_side = a.int_wrap(nodes_on_a_side, INDEX_BITS);
        a.name_int("nodes_on_a_side", nodes_on_a_side);
        let index_mask = a.int_sub(nodes_on_a_side, one);
        a.name_int("index_mask", index_mask);
        let i = a.int_complement_if(ray.mirror_u, i);
        let i = a.int_and(i, index_mask);
        a.name_int("wrapped_i", i);
        let j = a.int_complement_if(ray.mirror_v, j);
        let j = a.int_and(j, index_mask);
        let j = a.int_or(j, nodes_on_a_side);
        a.name_int("marked_j", j);
        let address = match self.layout {
            HeightLayout::Rows => {
                let row = a.int_shift_left(j, below_root, SHIFT_BITS);
                a.int_or(row, i)
            }
            HeightLayout::Tiles => {
                let side_bits = a.int_constant(i64::from(LINE_SIDE_BITS));
                let line_bits = a.int_constant(i64::from(2 * LINE_SIDE_BITS));
                let tile_j = a.int_shift_right(j, side_bits, SHIFT_BITS);
                let tile_row = a.int_shift_left(tile_j, below_root, SHIFT_BITS);
                let tile_row = a.int_shift_left(tile_row, side_bits, 2);
                a.name_int("tile_row", tile_row);
                let tile_i = a.int_shift_right(i, side_bits, SHIFT_BITS);
                let tile_column = a.int_shift_left(tile_i, line_bits, 3);
                let tile = a.int_or(tile_row, tile_column);
                a.name_int("tile", tile);
                let row_in_tile = a.int_low_bits(j, LINE_SIDE_BITS);
                let row_in_tile = a.int_shift_left(row_in_tile, side_bits, 2);
                let column_in_tile = a.int_low_bits(i, LINE_SIDE_BITS);
                let in_tile = a.int_or(row_in_tile, column_in_tile);
                a.name_int("place_in_tile", in_tile);
                a.int_or(tile, in_tile)
            }
        };
        // Marker, v and u take 2 * below_root + 1 bits, so nothing but zeros is cut.
        let address = a.int_low_bits(address, self.address_bits());
        a.name_int("node_address", address);
        address
    }

    /// One pass of a ray. `height` counts in mode walk, where the cache did not miss: there
    /// `missed` is 0. Appends the walk registers after the pass to `after`, and to `answers`
    /// `hit`, `guard` (one of them says that the ray leaves) and what it has hit: `depth`,
    /// `position_u`, `position_v`, `texel_i`, `texel_j`.
    pub fn step_into<A: Arith>(
        &self,
        a: &mut A,
        registers: &[Signal<A>],
        height: A::Int,
        missed: A::Bit,
        after: &mut Vec<Signal<A>>,
        answers: &mut Vec<Named<A>>,
    ) {
        let row = LoopRegisters::of(registers);
        let keeps = a.or(row.starts, missed);
        a.name_bit("keeps", keeps);
        let no = a.bit_constant(false);
        let walk = WalkRegisters {
            level: row.level,
            i: row.i,
            j: row.j,
            t: row.t,
            at_border_v: row.at_border_v,
            corner_owed: row.corner_owed,
            corner_paid: row.corner_paid,
            passed: None,
            crossed_before: None,
            steps: row.steps,
            crossings: row.crossings,
            hit: no,
            // A walk that has ended stays as it is: so does one that is not to be changed.
            guard: keeps,
        };
        let result = traverse_step(a, self.shape, PAPER_POLICY, &row.ray, &walk, height);
        let changes = a.not(keeps);
        a.name_bit("changes", changes);
        let guard = a.and(result.walk.guard, changes);
        a.name_bit("ends_by_guard", guard);
        // Of a walk that has ended the step does not keep this bit.
        let at_border_if_kept = a.and(keeps, row.at_border_v);
        let at_border_if_not = a.and(changes, result.walk.at_border_v);
        let at_border_v = a.or(at_border_if_kept, at_border_if_not);
        a.name_bit("at_border_v_after", at_border_v);

        let end = (result.mirrored_position_u, result.mirrored_position_v);
        let start = node_of_whole_ray(a, self.shape, &row.ray, end);
        let level = a.int_select(row.starts, start.level, result.walk.level);
        let level = a.int_wrap(level, LEVEL_BITS);
        a.name_int("level_after", level);
        let i = a.int_select(row.starts, start.i, result.walk.i);
        let i = a.int_wrap(i, INDEX_BITS);
        a.name_int("i_after", i);
        let j = a.int_select(row.starts, start.j, result.walk.j);
        let j = a.int_wrap(j, INDEX_BITS);
        a.name_int("j_after", j);
        // A walk begins at the top.
        let top = a.zero();
        let t = a.select(row.starts, top, result.walk.t);
        a.name_num("t_after", t);

        after.extend([
            Signal::Bit(no),
            Signal::Integer(level),
            Signal::Integer(i),
            Signal::Integer(j),
            Signal::Number(t),
            Signal::Bit(at_border_v),
            Signal::Bit(result.walk.corner_owed),
            Signal::Bit(result.walk.corner_paid),
            Signal::Integer(result.walk.steps),
            Signal::Integer(result.walk.crossings),
        ]);
        answers.extend([
            ("hit", Signal::Bit(result.walk.hit)),
            ("guard", Signal::Bit(guard)),
            ("depth", Signal::Number(result.walk.t)),
            ("position_u", Signal::Number(result.position_u)),
            ("position_v", Signal::Number(result.position_v)),
            ("texel_i", Signal::Integer(result.texel_i)),
            ("texel_j", Signal::Integer(result.texel_j)),
        ]);
    }

    /// [`PaperStep::step_into`] rows of their own, where speed does not matter.
    pub fn step<A: Arith>(
        &self,
        a: &mut A,
        registers: &[Signal<A>],
        height: A::Int,
        missed: A::Bit,
    ) -> (Vec<Signal<A>>, Vec<Named<A>>) {
        let (mut after, mut answers) = (Vec::new(), Vec::new());
        self.step_into(a, registers, height, missed, &mut after, &mut answers);
        (after, answers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::{Channel, MapSource};
    use crate::ray::Ray;
    use crate::readings::{E7F16, FloatReading, enter};
    use crate::units::traverse::{Status, shape_for, walk};
    use std::collections::HashSet;

    /// A ray's passes, in which every third lookup misses: the answer, and the passes.
    fn passes(step: PaperStep, memory: &[u16], ray: Ray<u64>) -> (Vec<u64>, u64) {
        let a = &mut FloatReading(E7F16);
        let ports = [ray.u, ray.v, ray.du, ray.dv].map(Signal::Number);
        let mut row = step.set_up(a, &ports);
        let mut passes = 0;
        loop {
            let starts = passes == 0;
            let missed = !starts && passes % 3 == 2;
            let address = step.address(a, &row) as usize;
            // What a cache that misses shows is of no use, nor what it shows at the start.
            let height = match starts || missed {
                true => (passes * 77) & 255,
                false => i64::from(memory[address]),
            };
            let (after, answers) = step.step(a, &row, height, missed);
            passes += 1;
            row.truncate(step.ray_registers().len());
            row.extend(after);
            let answer = |place: usize| answers[place].1;
            let (hit, guard) = (answer(0).bit(), answer(1).bit());
            assert!(
                !(starts || missed) || !(hit || guard),
                "a pass that only keeps"
            );
            if hit || guard {
                let [t, u, v] = [2, 3, 4].map(|place| answer(place).number());
                let [i, j] = [5, 6].map(|place| answer(place).integer() as u64);
                let counted = row.len() - 2;
                let [steps, crossings] =
                    [counted, counted + 1].map(|place| row[place].integer() as u64);
                let missed = (passes as u64) / 3;
                assert_eq!(
                    passes as u64,
                    1 + steps + missed,
                    "a start, steps and misses"
                );
                return (vec![i, j, t, u, v, steps, crossings, guard.into()], steps);
            }
        }
    }

    #[test]
    fn every_hit_is_that_of_the_golden_walk() {
        let mut steps = 0;
        for map in ["procedural:spikes:32:3", "procedural:spikes:64:5"] {
            let source: MapSource = map.parse().unwrap();
            let pyramid = Pyramid::new(&source.load(Channel::Grey, false).unwrap());
            for layout in [HeightLayout::Rows, HeightLayout::Tiles] {
                let step = PaperStep {
                    shape: shape_for(&pyramid),
                    layout,
                };
                let memory = step.memory(&pyramid);
                for n in 0..300 {
                    let n = f64::from(n);
                    let ray = Ray {
                        u: (n * 0.013).fract(),
                        v: (n * 0.029).fract(),
                        du: (n * 0.7).sin() * 3.0,
                        dv: (n * 1.3).cos() * (n * 0.11).sin(),
                    };
                    let a = &mut FloatReading(E7F16);
                    let ray = enter(a, ray);
                    let hit = walk(a, PAPER_POLICY, &pyramid, pyramid.memory(), ray);
                    let expected = vec![
                        hit.i.into(),
                        hit.j.into(),
                        hit.t,
                        hit.u,
                        hit.v,
                        hit.steps.into(),
                        hit.crossings.into(),
                        (hit.status == Status::Guard).into(),
                    ];
                    let (found, taken) = passes(step, &memory, ray);
                    assert_eq!(found, expected, "{map} {ray:?}");
                    steps += taken;
                }
            }
        }
        assert!(steps > 5000, "{steps}");
    }

    #[test]
    fn a_layout_gives_every_node_its_own_address() {
        for (layout, root_level) in [HeightLayout::Rows, HeightLayout::Tiles]
            .into_iter()
            .flat_map(|layout| (0..=6).map(move |root_level| (layout, root_level)))
        {
            let shape = TraverseShape {
                root_level,
                height_bits: 8,
            };
            let step = PaperStep { shape, layout };
            let mut seen = HashSet::new();
            for level in 0..=root_level {
                let nodes = 1_i64 << (root_level - level);
                for n in 0..nodes * nodes {
                    let address = step.height_address(level, n % nodes, n / nodes);
                    assert!(address >> step.address_bits() == 0 && seen.insert(address));
                }
            }
        }
    }
}
