//! Runs an operator's netlist against its golden function, vector by vector.
#![allow(dead_code)] // every test program uses its own part of it

use std::collections::VecDeque;
use std::sync::Arc;

use hdl_gen::netlist::Module;
use hdl_gen::operators::FloatOperator;
use hdl_gen::simulate::{Input, Signal, Simulator};
use rtl_model::float::{FloatFormat, Rounding, ToIntegerError};

/// A splitmix64 sequence: the tests' only source of chance, the same in every run.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, bound: u64) -> u64 {
        self.next() % bound
    }
}

/// Where netlist and golden function differ.
#[derive(Debug, PartialEq, Eq)]
pub struct Mismatch {
    pub module: String,
    pub operands: Vec<u64>,
    pub expected: u64,
    pub got: u64,
}

/// A netlist under test; its outputs are read side by side, the first at the top.
pub struct Bench {
    module: Arc<Module>,
    simulator: Simulator,
    operands: Vec<Input>,
    enable: Option<Input>,
    outputs: Vec<Signal>,
    random: Random,
}

impl Bench {
    pub fn new(module: &Arc<Module>) -> Bench {
        let simulator = Simulator::new(module).expect("a netlist without loops");
        let names = module
            .inputs
            .iter()
            .map(|&wire| module.node(wire).name.clone().unwrap());
        let (enables, operands): (Vec<String>, Vec<String>) =
            names.partition(|name| name == "enable_i");
        let input = |name: &String| simulator.input(name).unwrap();
        Bench {
            operands: operands.iter().map(input).collect(),
            enable: enables.first().map(input),
            outputs: module
                .outputs
                .iter()
                .map(|(name, _)| simulator.signal(name).unwrap())
                .collect(),
            module: module.clone(),
            simulator,
            random: Random(7),
        }
    }

    fn result(&mut self) -> u64 {
        self.simulator.settle();
        self.outputs.iter().fold(0, |word, &output| {
            word << output.width() | self.simulator.peek(output)
        })
    }

    fn clock(&mut self, enabled: bool) {
        if let Some(enable) = self.enable {
            self.simulator.set_input(enable, enabled.into());
        }
        self.simulator.clock();
    }

    /// Streams all vectors through, one a cycle, stalling a pipeline now and then; the first
    /// difference, or how many vectors agreed.
    pub fn run<const N: usize>(
        &mut self,
        vectors: impl Iterator<Item = [u64; N]>,
        golden: impl Fn([u64; N]) -> u64,
    ) -> Result<u64, Mismatch> {
        assert_eq!(self.operands.len(), N, "{}: inputs", self.module.name);
        let latency = self.module.latency as usize;
        let mut in_flight: VecDeque<([u64; N], u64)> = VecDeque::new();
        let mut agreed = 0;
        let drain = std::iter::repeat_n([0; N], latency.saturating_sub(1));
        for vector in vectors.chain(drain) {
            for (&input, value) in self.operands.iter().zip(vector) {
                self.simulator.set_input(input, value);
            }
            in_flight.push_back((vector, golden(vector)));
            if latency > 0 {
                self.clock(true);
            }
            if in_flight.len() < latency.max(1) {
                continue;
            }
            let (operands, expected) = in_flight.pop_front().expect("just pushed");
            if latency > 0 && self.random.below(16) == 0 {
                // A stalled pipeline neither moves nor looks at its inputs.
                for index in 0..N {
                    let input = self.operands[index];
                    let noise = self.random.next() & (u64::MAX >> (64 - input.width()));
                    self.simulator.set_input(input, noise);
                }
                self.clock(false);
            }
            let got = self.result();
            if got != expected {
                return Err(Mismatch {
                    module: self.module.name.clone(),
                    operands: operands.to_vec(),
                    expected,
                    got,
                });
            }
            agreed += 1;
        }
        Ok(agreed)
    }
}

/// The golden result of an operator with two float operands.
pub fn golden_binary(
    kind: FloatOperator,
    format: FloatFormat,
    rounding: Rounding,
    a: u64,
    b: u64,
) -> u64 {
    match kind {
        FloatOperator::Add => format.add(rounding, a, b),
        FloatOperator::Subtract => format.sub(rounding, a, b),
        FloatOperator::Multiply => format.mul(rounding, a, b),
        FloatOperator::Divide => format.div(rounding, a, b),
        FloatOperator::LessThan => format.less_than(a, b).into(),
        FloatOperator::LessEqual => format.less_equal(a, b).into(),
        FloatOperator::Compare => {
            u64::from(format.less_than(a, b)) << 3
                | u64::from(format.less_equal(a, b)) << 2
                | u64::from(format.equal(a, b)) << 1
                | u64::from(format.compare(a, b).is_none())
        }
        other => panic!("{other:?} has no two float operands"),
    }
}

/// The golden result of an operator with one operand.
pub fn golden_unary(kind: FloatOperator, format: FloatFormat, rounding: Rounding, a: u64) -> u64 {
    match kind {
        FloatOperator::Floor => format.floor(a),
        FloatOperator::UlpsUp { ulps } => format.ulps_up(a, ulps),
        FloatOperator::ExactBelow => format.exact_below(a),
        FloatOperator::DepthFromHeight { bits } => format.depth_from_height(a, bits),
        FloatOperator::ToInteger { bits } => {
            let integer = format
                .to_integer(rounding, a)
                .unwrap_or_else(ToIntegerError::saturated);
            let limit = 1_i64 << (bits - 1);
            let integer = integer.clamp(-limit, limit - 1);
            integer.cast_unsigned() & (u64::MAX >> (64 - bits))
        }
        other => panic!("{other:?} has not one operand"),
    }
}

/// All pairs of a small format.
pub fn all_pairs(format: FloatFormat) -> impl Iterator<Item = [u64; 2]> {
    let count = 1 << format.width();
    (0..count).flat_map(move |a| (0..count).map(move |b| [a, b]))
}

/// Pairs that are hard more often than chance would have it: near cancellations, exponents a few
/// places apart, short and long runs of equal bits, quotients near ties, the special patterns.
pub fn hard_pair(random: &mut Random, format: FloatFormat) -> [u64; 2] {
    let a = hard_operand(random, format);
    let b = match random.below(6) {
        0 => a ^ format.sign_bit() ^ random.below(8),
        1 => {
            let apart = random.below(u64::from(format.fraction_bits) + 5);
            let fraction = hard_operand(random, format) & format.fraction_mask();
            let exponent =
                ((a >> format.fraction_bits) & format.exponent_all_ones()).saturating_sub(apart);
            (random.below(2) * format.sign_bit()) | exponent << format.fraction_bits | fraction
        }
        2 => {
            // What completes an exponent sum or difference to the ends of the range.
            let exponent = (a >> format.fraction_bits) & format.exponent_all_ones();
            let bias = u64::from(format.exponent_bias().unsigned_abs());
            let wanted =
                (bias + random.below(3)).saturating_sub(exponent) & format.exponent_all_ones();
            let fraction = random.next() & format.fraction_mask();
            (random.below(2) * format.sign_bit()) | wanted << format.fraction_bits | fraction
        }
        _ => hard_operand(random, format),
    };
    [a, b]
}

fn hard_operand(random: &mut Random, format: FloatFormat) -> u64 {
    let any = random.next() & format.value_mask();
    let fraction_mask = format.fraction_mask();
    match random.below(8) {
        0 => {
            let specials = [
                0,
                1,
                format.min_normal() - 1,
                format.min_normal(),
                format.min_normal() + 1,
                format.one(),
                format.one() - 1,
                format.max_finite(),
                format.infinity(),
                format.infinity() + 1,
                format.quiet_nan(),
            ];
            let index = random.below(specials.len() as u64) as usize;
            specials[index] | random.below(2) * format.sign_bit()
        }
        1 => {
            any & !fraction_mask
                | fraction_mask << random.below(u64::from(format.fraction_bits)) & fraction_mask
        }
        2 => any & !fraction_mask | fraction_mask >> random.below(u64::from(format.fraction_bits)),
        3 => any & !fraction_mask | 1 << random.below(u64::from(format.fraction_bits)),
        // Exponents near that of one, where sums and products stay in range.
        4 | 5 => {
            let near = format.exponent_bias().unsigned_abs() as u64 + random.below(5);
            let exponent = near.saturating_sub(2).min(format.exponent_all_ones());
            any & (format.sign_bit() | fraction_mask) | exponent << format.fraction_bits
        }
        _ => any,
    }
}
