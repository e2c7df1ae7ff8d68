//! The step by an offset with its registers in a row.

use super::offset_step::{
    COUNTER_BITS, INDEX_BITS, LEVEL_BITS, OffsetRay, OffsetShape, OffsetWalk, offset_address,
    offset_setup, offset_step,
};
use super::step::{Named, Register, RegisterKind, Signal, Step};
use crate::arith::Arith;

/// The step of a pyramid traversal that crosses borders by an offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetNodeStep {
    /// Map, policy and offset.
    pub shape: OffsetShape,
}

/// How many registers a ray carries unchanged.
const RAY_REGISTERS: usize = 5;

impl OffsetNodeStep {
    fn ray<A: Arith>(ray: &[Signal<A>]) -> OffsetRay<A> {
        OffsetRay {
            u: ray[0].number(),
            v: ray[1].number(),
            du: ray[2].number(),
            dv: ray[3].number(),
            offset: ray[4].number(),
        }
    }

    fn walk<A: Arith>(walk: &[Signal<A>]) -> OffsetWalk<A> {
        OffsetWalk {
            level: walk[0].integer(),
            i: walk[1].integer(),
            j: walk[2].integer(),
            t: walk[3].number(),
            crossed: walk[4].bit(),
            steps: walk[5].integer(),
            crossings: walk[6].integer(),
            hit: walk[7].bit(),
            guard: walk[8].bit(),
        }
    }

    fn signals<A: Arith>(walk: &OffsetWalk<A>) -> [Signal<A>; 9] {
        [
            Signal::Integer(walk.level),
            Signal::Integer(walk.i),
            Signal::Integer(walk.j),
            Signal::Number(walk.t),
            Signal::Bit(walk.crossed),
            Signal::Integer(walk.steps),
            Signal::Integer(walk.crossings),
            Signal::Bit(walk.hit),
            Signal::Bit(walk.guard),
        ]
    }
}

impl Step for OffsetNodeStep {
    fn name(&self) -> &'static str {
        "offset_step"
    }

    fn description(&self) -> Vec<String> {
        let OffsetShape {
            root_level,
            height_bits,
            policy,
            texels,
        } = self.shape;
        let size = 1 << root_level;
        vec![
            "One step of a pyramid traversal that crosses borders by an offset, as published \
             (rtl_model::units::offset_step): for comparison."
                .to_owned(),
            format!(
                "Map of {size} x {size} texels, heights of {height_bits} bits. {policy:?}, \
                 {texels} texels beyond a border. It misses, and can walk for ever."
            ),
        ]
    }

    fn ray_ports(&self) -> Vec<Register> {
        ["u", "v", "du", "dv"]
            .map(|name| (name, RegisterKind::Number))
            .to_vec()
    }

    fn ray_registers(&self) -> Vec<Register> {
        ["u", "v", "du", "dv", "offset"]
            .map(|name| (name, RegisterKind::Number))
            .to_vec()
    }

    fn walk_registers(&self) -> Vec<Register> {
        vec![
            ("level", RegisterKind::Integer(LEVEL_BITS)),
            ("i", RegisterKind::Integer(INDEX_BITS)),
            ("j", RegisterKind::Integer(INDEX_BITS)),
            ("t", RegisterKind::Number),
            ("crossed", RegisterKind::Bit),
            ("steps", RegisterKind::Integer(COUNTER_BITS)),
            ("crossings", RegisterKind::Integer(COUNTER_BITS)),
            ("hit", RegisterKind::Bit),
            ("guard", RegisterKind::Bit),
        ]
    }

    fn height_ports(&self) -> Vec<(&'static str, u32)> {
        vec![("height", self.shape.height_bits)]
    }

    fn address_bits(&self) -> u32 {
        self.shape.address_bits()
    }

    fn step_bound(&self) -> u32 {
        self.shape.step_bound()
    }

    fn set_up_into<A: Arith>(&self, a: &mut A, ray: &[Signal<A>], registers: &mut Vec<Signal<A>>) {
        let ports = [0, 1, 2, 3].map(|port| ray[port].number());
        let (ray, walk) = offset_setup(a, self.shape, ports);
        registers.extend([ray.u, ray.v, ray.du, ray.dv, ray.offset].map(Signal::Number));
        registers.extend(Self::signals(&walk));
    }

    fn address<A: Arith>(&self, a: &mut A, registers: &[Signal<A>]) -> A::Int {
        let walk = &registers[RAY_REGISTERS..];
        offset_address(a, self.shape, &Self::walk(walk))
    }

    fn step_into<A: Arith>(
        &self,
        a: &mut A,
        registers: &[Signal<A>],
        heights: &[A::Int],
        next_walk: &mut Vec<Signal<A>>,
        answer: &mut Vec<Named<A>>,
    ) {
        let (ray, walk) = registers.split_at(RAY_REGISTERS);
        let (ray, walk) = (Self::ray(ray), Self::walk(walk));
        let result = offset_step(a, self.shape, &ray, &walk, heights[0]);
        answer.extend([
            ("position_u", Signal::Number(result.position_u)),
            ("position_v", Signal::Number(result.position_v)),
            ("texel_i", Signal::Integer(result.texel_i)),
            ("texel_j", Signal::Integer(result.texel_j)),
        ]);
        next_walk.extend(Self::signals(&result.walk));
    }
}
