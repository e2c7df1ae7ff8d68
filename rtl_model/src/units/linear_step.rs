//! The steps of the sampling methods with their registers in a row.

use super::linear_ray::{
    LinearRay, LinearShape, NOMINAL_DEPTH, SAMPLE_BITS, SampleRange, texel_address,
};
use super::pom_step::{self, PomWalk, pom_start, pom_step};
use super::relief_step::{self, BINARY_STEP_BITS, ReliefWalk, relief_start, relief_step};
use super::step::{Named, Register, RegisterKind, Signal, Step};
use crate::arith::Arith;
use crate::maps::Pyramid;
use crate::ray::Ray;
use crate::readings::{NumberFormat, enter};
use crate::scene::LinearSearch;

/// The step of a sampling method on a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LinearStep {
    /// The map it is built for.
    pub shape: LinearShape,
    /// The method.
    pub search: LinearSearch,
}

/// Bits of the register that counts crossings, of which a sampling method has none.
const CROSSING_BITS: u32 = 2;

/// How many registers a ray carries unchanged.
const RAY_REGISTERS: usize = 7;

impl LinearStep {
    /// Bits of a texel index, signed.
    fn texel_bits(self) -> u32 {
        self.shape.root_level + 1
    }

    /// What the ray ports carry for a ray that takes these samples.
    fn ports<R: NumberFormat>(
        reading: &mut R,
        ray: Ray<f64>,
        samples: SampleRange,
    ) -> Vec<Signal<R>> {
        let ray = LinearRay::enter(reading, ray, samples);
        let mut ports = [ray.u, ray.v, ray.du, ray.dv, ray.spacing]
            .map(Signal::Number)
            .to_vec();
        ports.extend([ray.first_sample, ray.last_sample].map(Signal::Integer));
        ports
    }

    fn ray<A: Arith>(ray: &[Signal<A>]) -> LinearRay<A> {
        LinearRay {
            u: ray[0].number(),
            v: ray[1].number(),
            du: ray[2].number(),
            dv: ray[3].number(),
            spacing: ray[4].number(),
            first_sample: ray[5].integer(),
            last_sample: ray[6].integer(),
        }
    }

    fn relief_walk<A: Arith>(walk: &[Signal<A>]) -> ReliefWalk<A> {
        ReliefWalk {
            t: walk[0].number(),
            texel_i: walk[1].integer(),
            texel_j: walk[2].integer(),
            sample: walk[3].integer(),
            near: walk[4].number(),
            far: walk[5].number(),
            refining: walk[6].bit(),
            binary_steps: walk[7].integer(),
            steps: walk[8].integer(),
            hit: walk[10].bit(),
            guard: walk[11].bit(),
        }
    }

    fn relief_signals<A: Arith>(walk: &ReliefWalk<A>, crossings: A::Int) -> [Signal<A>; 12] {
        [
            Signal::Number(walk.t),
            Signal::Integer(walk.texel_i),
            Signal::Integer(walk.texel_j),
            Signal::Integer(walk.sample),
            Signal::Number(walk.near),
            Signal::Number(walk.far),
            Signal::Bit(walk.refining),
            Signal::Integer(walk.binary_steps),
            Signal::Integer(walk.steps),
            Signal::Integer(crossings),
            Signal::Bit(walk.hit),
            Signal::Bit(walk.guard),
        ]
    }

    fn pom_walk<A: Arith>(walk: &[Signal<A>]) -> PomWalk<A> {
        PomWalk {
            t: walk[0].number(),
            texel_i: walk[1].integer(),
            texel_j: walk[2].integer(),
            sample: walk[3].integer(),
            near: walk[4].number(),
            clearance: walk[5].number(),
            steps: walk[6].integer(),
            hit: walk[8].bit(),
            guard: walk[9].bit(),
        }
    }

    fn pom_signals<A: Arith>(walk: &PomWalk<A>, crossings: A::Int) -> [Signal<A>; 10] {
        [
            Signal::Number(walk.t),
            Signal::Integer(walk.texel_i),
            Signal::Integer(walk.texel_j),
            Signal::Integer(walk.sample),
            Signal::Number(walk.near),
            Signal::Number(walk.clearance),
            Signal::Integer(walk.steps),
            Signal::Integer(crossings),
            Signal::Bit(walk.hit),
            Signal::Bit(walk.guard),
        ]
    }
}

impl Step for LinearStep {
    fn name(&self) -> &'static str {
        match self.search {
            LinearSearch::Relief => "relief_step",
            LinearSearch::Pom => "pom_step",
            LinearSearch::Dig => "dig_step",
        }
    }

    fn description(&self) -> Vec<String> {
        let what = match self.search {
            LinearSearch::Relief => {
                "One sample of relief mapping (rtl_model::units::relief_step): linear down to the \
                 first below the surface, then binary."
            }
            LinearSearch::Pom => {
                "One sample of parallax occlusion mapping (rtl_model::units::pom_step): linear, \
                 and where the last two samples' straight line meets the ray."
            }
            LinearSearch::Dig => {
                "One sample of the confined search of a depth-interval grid \
                 (rtl_model::units::relief_step): linear within the samples of the pixel block, \
                 then binary."
            }
        };
        let shape = self.shape;
        vec![
            what.to_owned(),
            format!(
                "Map of {size} x {size} texels, heights of {} bits. It may miss.",
                shape.height_bits,
                size = shape.size()
            ),
        ]
    }

    fn ray_ports(&self) -> Vec<Register> {
        vec![
            ("u", RegisterKind::Number),
            ("v", RegisterKind::Number),
            ("du", RegisterKind::Number),
            ("dv", RegisterKind::Number),
            ("spacing", RegisterKind::Number),
            ("first_sample", RegisterKind::Integer(SAMPLE_BITS)),
            ("last_sample", RegisterKind::Integer(SAMPLE_BITS)),
        ]
    }

    fn ray_registers(&self) -> Vec<Register> {
        self.ray_ports()
    }

    fn walk_registers(&self) -> Vec<Register> {
        let texel = RegisterKind::Integer(self.texel_bits());
        let mut registers = vec![
            ("t", RegisterKind::Number),
            ("i", texel),
            ("j", texel),
            ("sample", RegisterKind::Integer(SAMPLE_BITS)),
            ("near", RegisterKind::Number),
        ];
        match self.search {
            LinearSearch::Pom => registers.push(("clearance", RegisterKind::Number)),
            LinearSearch::Relief | LinearSearch::Dig => registers.extend([
                ("far", RegisterKind::Number),
                ("refining", RegisterKind::Bit),
                ("binary_steps", RegisterKind::Integer(BINARY_STEP_BITS)),
            ]),
        }
        registers.extend([
            ("steps", RegisterKind::Integer(SAMPLE_BITS)),
            ("crossings", RegisterKind::Integer(CROSSING_BITS)),
            ("hit", RegisterKind::Bit),
            ("guard", RegisterKind::Bit),
        ]);
        registers
    }

    fn height_ports(&self) -> Vec<(&'static str, u32)> {
        vec![("height", self.shape.height_bits)]
    }

    fn address_bits(&self) -> u32 {
        self.shape.address_bits()
    }

    fn step_bound(&self) -> u32 {
        match self.search {
            LinearSearch::Pom => pom_step::STEP_BOUND,
            LinearSearch::Relief | LinearSearch::Dig => relief_step::STEP_BOUND,
        }
    }

    /// The ray, and the samples of the method for it: of `dig` those of a corner ray, from top to
    /// bottom; the angle is that of a surface of [`NOMINAL_DEPTH`].
    fn enter<R: NumberFormat>(&self, reading: &mut R, ray: Ray<f64>) -> Vec<Signal<R>> {
        let entered = enter(reading, ray).map(|number| reading.to_f64(number));
        let samples = SampleRange::of(self.search, entered, NOMINAL_DEPTH);
        Self::ports(reading, ray, samples)
    }

    /// As [`Step::enter`]; of `dig` with the samples that the corner rays of the ray's block leave
    /// it ([`SampleRange::of_listed_ray`]).
    fn enter_over<R: NumberFormat>(
        &self,
        reading: &mut R,
        pyramid: &Pyramid,
        ray: Ray<f64>,
    ) -> Vec<Signal<R>> {
        match self.search {
            LinearSearch::Dig => {
                let samples = SampleRange::of_listed_ray(reading, pyramid, ray);
                Self::ports(reading, ray, samples)
            }
            LinearSearch::Relief | LinearSearch::Pom => self.enter(reading, ray),
        }
    }

    fn set_up_into<A: Arith>(&self, a: &mut A, ray: &[Signal<A>], registers: &mut Vec<Signal<A>>) {
        let ports = Self::ray(ray);
        let crossings = a.int_constant(0);
        registers.extend_from_slice(ray);
        match self.search {
            LinearSearch::Pom => {
                let walk = pom_start(a, self.shape, &ports);
                registers.extend(Self::pom_signals(&walk, crossings));
            }
            LinearSearch::Relief | LinearSearch::Dig => {
                let walk = relief_start(a, self.shape, &ports);
                registers.extend(Self::relief_signals(&walk, crossings));
            }
        }
    }

    fn address<A: Arith>(&self, a: &mut A, registers: &[Signal<A>]) -> A::Int {
        let walk = &registers[RAY_REGISTERS..];
        texel_address(a, self.shape, walk[1].integer(), walk[2].integer())
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
        let ray = Self::ray(ray);
        let (texel_i, texel_j, position_u, position_v) = match self.search {
            LinearSearch::Pom => {
                let crossings = walk[7].integer();
                let walk = Self::pom_walk(walk);
                let result = pom_step(a, self.shape, &ray, &walk, heights[0]);
                let (i, j) = (result.walk.texel_i, result.walk.texel_j);
                next_walk.extend(Self::pom_signals(&result.walk, crossings));
                (i, j, result.position_u, result.position_v)
            }
            LinearSearch::Relief | LinearSearch::Dig => {
                let crossings = walk[9].integer();
                let walk = Self::relief_walk(walk);
                let result = relief_step(a, self.shape, &ray, &walk, heights[0]);
                let (i, j) = (result.walk.texel_i, result.walk.texel_j);
                next_walk.extend(Self::relief_signals(&result.walk, crossings));
                (i, j, result.position_u, result.position_v)
            }
        };
        answer.extend([
            ("position_u", Signal::Number(position_u)),
            ("position_v", Signal::Number(position_v)),
            ("texel_i", Signal::Integer(texel_i)),
            ("texel_j", Signal::Integer(texel_j)),
        ]);
    }
}
