//! The step of the methods that look at a node a step, with its registers in a row.

use super::search_policy::SearchPolicy;
use super::step::{Named, Register, RegisterKind, Signal, Step};
use super::traverse_setup::{RayRegisters, traverse_setup};
use super::traverse_step::{
    INDEX_BITS, LEVEL_BITS, PassedBorders, TraverseShape, WalkRegisters, counter_bits,
    node_address, traverse_step, walk_start,
};
use crate::arith::Arith;
use crate::scene::Method;

/// The traverse unit of a map and a policy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NodeStep {
    /// The map it is built for.
    pub shape: TraverseShape,
    /// The traversal.
    pub policy: SearchPolicy,
}

pub(super) const RAY_REGISTERS: [Register; 8] = [
    ("u", RegisterKind::Number),
    ("v", RegisterKind::Number),
    ("du", RegisterKind::Number),
    ("dv", RegisterKind::Number),
    ("exact_below_u", RegisterKind::Number),
    ("exact_below_v", RegisterKind::Number),
    ("mirror_u", RegisterKind::Bit),
    ("mirror_v", RegisterKind::Bit),
];

impl NodeStep {
    /// The registers of a row, typed; those that the policy has none of hold what they always would.
    fn registers<A: Arith>(
        &self,
        a: &mut A,
        row: &[Signal<A>],
    ) -> (RayRegisters<A>, WalkRegisters<A>) {
        let mut row = row.iter();
        let mut next = || *row.next().expect("as many registers as are declared");
        let ray = RayRegisters {
            u: next().number(),
            v: next().number(),
            du: next().number(),
            dv: next().number(),
            exact_below_u: next().number(),
            exact_below_v: next().number(),
            mirror_u: next().bit(),
            mirror_v: next().bit(),
        };
        let flat = self.policy.is_flat();
        let walk = WalkRegisters {
            level: match flat {
                true => a.int_constant(0),
                false => next().integer(),
            },
            i: next().integer(),
            j: next().integer(),
            t: next().number(),
            at_border_v: match flat {
                true => a.bit_constant(false),
                false => next().bit(),
            },
            corner_owed: next().bit(),
            corner_paid: next().bit(),
            passed: self.policy.remembers_borders().then(|| PassedBorders {
                i: next().integer(),
                j: next().integer(),
            }),
            crossed_before: self.policy.remembers_crossing().then(|| next().bit()),
            steps: next().integer(),
            crossings: next().integer(),
            hit: next().bit(),
            guard: next().bit(),
        };
        assert!(row.next().is_none(), "no more registers than are declared");
        (ray, walk)
    }

    fn walk_row<A: Arith>(&self, walk: &WalkRegisters<A>, row: &mut Vec<Signal<A>>) {
        let flat = self.policy.is_flat();
        if !flat {
            row.push(Signal::Integer(walk.level));
        }
        row.extend([walk.i, walk.j].map(Signal::Integer));
        row.push(Signal::Number(walk.t));
        if !flat {
            row.push(Signal::Bit(walk.at_border_v));
        }
        row.extend([walk.corner_owed, walk.corner_paid].map(Signal::Bit));
        if let Some(passed) = walk.passed {
            row.extend([passed.i, passed.j].map(Signal::Integer));
        }
        row.extend(walk.crossed_before.map(Signal::Bit));
        row.extend([walk.steps, walk.crossings].map(Signal::Integer));
        row.extend([walk.hit, walk.guard].map(Signal::Bit));
    }
}

pub(super) fn ray_row<A: Arith>(ray: &RayRegisters<A>, row: &mut Vec<Signal<A>>) {
    let numbers = [
        ray.u,
        ray.v,
        ray.du,
        ray.dv,
        ray.exact_below_u,
        ray.exact_below_v,
    ];
    row.extend(numbers.map(Signal::Number));
    row.extend([ray.mirror_u, ray.mirror_v].map(Signal::Bit));
}

impl Step for NodeStep {
    fn name(&self) -> &'static str {
        "traverse_step"
    }

    fn description(&self) -> Vec<String> {
        let method = match Method::of(self.policy) {
            Some(method) => format!("method {method}"),
            None => format!("{:?}", self.policy),
        };
        vec![
            format!(
                "One step of the walk down and across the pyramid of maximum heights: {method}."
            ),
            format!(
                "map: {0} x {0} texels, heights of {1} bits",
                self.shape.size(),
                self.shape.height_bits
            ),
        ]
    }

    fn ray_ports(&self) -> Vec<Register> {
        RAY_REGISTERS[..4].to_vec()
    }

    fn ray_registers(&self) -> Vec<Register> {
        RAY_REGISTERS.to_vec()
    }

    fn walk_registers(&self) -> Vec<Register> {
        let flat = self.policy.is_flat();
        let index = RegisterKind::Integer(INDEX_BITS);
        let count = RegisterKind::Integer(counter_bits(self.policy));
        let mut registers = Vec::new();
        if !flat {
            registers.push(("level", RegisterKind::Integer(LEVEL_BITS)));
        }
        registers.extend([("i", index), ("j", index), ("t", RegisterKind::Number)]);
        if !flat {
            registers.push(("at_border_v", RegisterKind::Bit));
        }
        registers.extend([
            ("corner_owed", RegisterKind::Bit),
            ("corner_paid", RegisterKind::Bit),
        ]);
        if self.policy.remembers_borders() {
            registers.extend([("passed_border_i", index), ("passed_border_j", index)]);
        }
        if self.policy.remembers_crossing() {
            registers.push(("crossed_before", RegisterKind::Bit));
        }
        registers.extend([
            ("steps", count),
            ("crossings", count),
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
        self.shape.step_bound(self.policy)
    }

    fn set_up_into<A: Arith>(&self, a: &mut A, ray: &[Signal<A>], registers: &mut Vec<Signal<A>>) {
        let [u, v, du, dv] = [0, 1, 2, 3].map(|port| ray[port].number());
        let setup = traverse_setup(a, self.shape, self.policy, u, v, du, dv);
        let walk = walk_start(a, self.policy, &setup);
        ray_row(&setup.ray, registers);
        self.walk_row(&walk, registers);
    }

    fn address<A: Arith>(&self, a: &mut A, registers: &[Signal<A>]) -> A::Int {
        let (ray, walk) = self.registers(a, registers);
        node_address(a, self.shape, self.policy, &ray, &walk)
    }

    /// The walk registers after the step, then `position_u`, `position_v`, `texel_i` and `texel_j`;
    /// the depth of the hit is the register `t`.
    fn step_into<A: Arith>(
        &self,
        a: &mut A,
        registers: &[Signal<A>],
        heights: &[A::Int],
        next_walk: &mut Vec<Signal<A>>,
        answer: &mut Vec<Named<A>>,
    ) {
        let (ray, walk) = self.registers(a, registers);
        let result = traverse_step(a, self.shape, self.policy, &ray, &walk, heights[0]);
        answer.extend([
            ("position_u", Signal::Number(result.position_u)),
            ("position_v", Signal::Number(result.position_v)),
            ("texel_i", Signal::Integer(result.texel_i)),
            ("texel_j", Signal::Integer(result.texel_j)),
        ]);
        self.walk_row(&result.walk, next_walk);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::{Channel, MapSource, Pyramid};
    use crate::ray::Ray;
    use crate::readings::{E7F16, FloatReading};
    use crate::scene::Family;
    use crate::units::traverse::{Status, shape_for, walk};

    /// Walks by rows of registers.
    fn walk_rows(step: NodeStep, pyramid: &Pyramid, ray: Ray<f64>) -> Vec<u64> {
        let mut reading = FloatReading(E7F16);
        let ports = step.enter(&mut reading, ray);
        let mut row = step.set_up(&mut reading, &ports);
        let ray_registers = step.ray_registers().len();
        let declared = step.walk_registers();
        assert_eq!(row.len(), ray_registers + declared.len());
        let place = |name| {
            let place = declared.iter().position(|(register, _)| *register == name);
            place.expect("a declared register")
        };
        let memory = step.memory(pyramid);
        loop {
            let address = step.address(&mut reading, &row);
            assert!(address >> step.address_bits() == 0);
            let height = i64::from(memory[address as usize]);
            let (after, outputs) = step.step(&mut reading, &row, &[height]);
            for (signal, (name, kind)) in after.iter().zip(&declared) {
                match (signal, kind) {
                    (Signal::Integer(value), RegisterKind::Integer(bits)) => {
                        let half = 1_i64 << (bits - 1);
                        assert!((-half..half).contains(value), "{name} is {value}");
                    }
                    (Signal::Number(_), RegisterKind::Number)
                    | (Signal::Bit(_), RegisterKind::Bit) => {}
                    _ => panic!("{name} is {signal:?}"),
                }
            }
            row.splice(ray_registers.., after.iter().copied());
            if after[place("hit")].bit() || after[place("guard")].bit() {
                let [u, v, i, j] = [0, 1, 2, 3].map(|place: usize| outputs[place].1);
                return vec![
                    i.integer() as u64,
                    j.integer() as u64,
                    after[place("t")].number(),
                    u.number(),
                    v.number(),
                    after[place("steps")].integer() as u64,
                    after[place("crossings")].integer() as u64,
                    after[place("guard")].bit().into(),
                ];
            }
        }
    }

    #[test]
    fn a_walk_by_rows_is_the_walk() {
        let source: MapSource = "procedural:spikes:32:3".parse().unwrap();
        let pyramid = Pyramid::new(&source.load(Channel::Grey, false).unwrap());
        let mut policies = 0;
        for method in Method::ALL {
            let Family::Nodes(policy) = method.family() else {
                continue;
            };
            policies += 1;
            let step = NodeStep {
                shape: shape_for(&pyramid),
                policy,
            };
            for n in 0..200 {
                let n = f64::from(n);
                let ray = Ray {
                    u: (n * 0.013).fract(),
                    v: (n * 0.029).fract(),
                    du: (n * 0.7).sin() * 3.0,
                    dv: (n * 1.3).cos(),
                };
                let entered = crate::readings::enter(&mut FloatReading(E7F16), ray);
                let mut reading = FloatReading(E7F16);
                let hit = walk(&mut reading, policy, &pyramid, pyramid.memory(), entered);
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
                assert_eq!(walk_rows(step, &pyramid, ray), expected, "{method} {ray:?}");
            }
        }
        assert_eq!(policies, 10);
    }

    #[test]
    fn a_policy_has_the_registers_it_needs() {
        let registers = |method: &str| {
            let Family::Nodes(policy) = method.parse::<Method>().unwrap().family() else {
                panic!("{method} looks at nodes");
            };
            let shape = TraverseShape {
                root_level: 8,
                height_bits: 8,
            };
            NodeStep { shape, policy }.walk_registers().len()
        };
        assert_eq!(registers("texel"), 9);
        assert_eq!(registers("oh"), 11);
        assert_eq!(registers("mixed-selective"), 11);
        assert_eq!(registers("drobot"), 13);
        assert_eq!(registers("coherent-up"), 14);
    }
}
