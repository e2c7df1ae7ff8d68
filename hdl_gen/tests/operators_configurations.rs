//! Division, square root, comparisons, selections and conversions in every rounding, policy and
//! radix, with and without flags, against the golden arithmetic, through the embedded simulator.

mod bench;

use bench::{Bench, Random, all_pairs, hard_pair};
use hdl_gen::fault::plant;
use hdl_gen::netlist::Operation;
use hdl_gen::operators::{FloatOperator, OperatorConfiguration, Radix, Structure};
use rayon::prelude::*;
use rtl_model::float::{FloatFormat, Policy, Rounding};

const E5F2: FloatFormat = FloatFormat::new(5, 2);

/// The operators with two floats.
const BINARY: [FloatOperator; 7] = [
    FloatOperator::Divide,
    FloatOperator::Minimum,
    FloatOperator::Maximum,
    FloatOperator::Compare,
    FloatOperator::CompareSignalling,
    FloatOperator::LessThan,
    FloatOperator::LessEqual,
];

/// The operators with one float.
const UNARY: [FloatOperator; 15] = [
    FloatOperator::SquareRoot,
    FloatOperator::RoundToIntegral,
    FloatOperator::Floor,
    FloatOperator::ToInteger { bits: 2 },
    FloatOperator::ToInteger { bits: 6 },
    FloatOperator::ToInteger { bits: 59 },
    FloatOperator::ToUnsigned { bits: 2 },
    FloatOperator::ToUnsigned { bits: 5 },
    FloatOperator::ToUnsigned { bits: 59 },
    FloatOperator::Convert { target: E5F2 },
    FloatOperator::Convert {
        target: FloatFormat::E4F3,
    },
    FloatOperator::Convert {
        target: FloatFormat::new(3, 9),
    },
    FloatOperator::Convert {
        target: FloatFormat::new(8, 23),
    },
    FloatOperator::UlpsUp { ulps: 3 },
    FloatOperator::ExactBelow,
];

/// The operators with an integer.
const OF_INTEGERS: [FloatOperator; 7] = [
    FloatOperator::FromSigned { bits: 2 },
    FloatOperator::FromSigned { bits: 9 },
    FloatOperator::FromUnsigned { bits: 2 },
    FloatOperator::FromUnsigned { bits: 9 },
    FloatOperator::DepthFromHeight { bits: 8 },
    FloatOperator::DepthFromHeight { bits: 16 },
    FloatOperator::FromInteger {
        value_bits: 6,
        exponent_bits: 6,
    },
];

/// An operator in every configuration in which its module differs.
fn configurations(operator: FloatOperator, format: FloatFormat) -> Vec<OperatorConfiguration> {
    let roundings = match operator.rounds() {
        true => Rounding::ALL.as_slice(),
        false => &[Rounding::NearestEven],
    };
    let radices = match operator {
        FloatOperator::Divide => [Radix::Two, Radix::Four, Radix::Mixed].as_slice(),
        _ => &[Radix::Two],
    };
    let mut all = Vec::new();
    for &rounding in roundings {
        for policy in Policy::ALL {
            for &radix in radices {
                let structure = Structure {
                    radix,
                    ..Structure::default()
                };
                let configuration = OperatorConfiguration::new(operator, format, rounding)
                    .with_policy(policy)
                    .with_structure(structure);
                all.extend([configuration, configuration.with_flags()]);
            }
        }
    }
    all
}

/// The golden results side by side, the first at the top, as the bench reads the outputs.
fn golden(configuration: OperatorConfiguration, widths: &[u32], operands: &[u64]) -> u64 {
    let mut results = Vec::new();
    configuration.golden_results(operands, &mut results);
    assert_eq!(results.len(), widths.len(), "{configuration:?}");
    let joined = results.iter().zip(widths);
    joined.fold(0, |word, (result, width)| word << width | result)
}

/// Runs a configuration on vectors: how many agreed, all of them.
fn compare<const N: usize>(
    configuration: OperatorConfiguration,
    latency: u32,
    vectors: impl Iterator<Item = [u64; N]>,
) -> u64 {
    let module = configuration.build(latency);
    assert_eq!(module.latency, latency);
    let outputs = module.outputs.iter();
    let widths: Vec<u32> = outputs.map(|(_, wire)| module.width(*wire)).collect();
    let agreed = Bench::new(&module).run(vectors, |operands| {
        golden(configuration, &widths, &operands)
    });
    agreed.unwrap_or_else(|mismatch| panic!("{mismatch:x?}"))
}

/// Every configuration on every operand of a small format.
fn exhaust(format: FloatFormat, latencies: &[u32]) {
    let cases = |operators: &[FloatOperator]| {
        let all = operators.iter();
        let all = all.flat_map(|&operator| configurations(operator, format));
        let all = all.flat_map(|case| latencies.iter().map(move |&latency| (case, latency)));
        all.collect::<Vec<_>>()
    };
    let patterns = 1 << format.width();
    cases(&BINARY).into_par_iter().for_each(|(case, latency)| {
        let agreed = compare(case, latency, all_pairs(format));
        assert_eq!(agreed, patterns * patterns);
    });
    cases(&UNARY).into_par_iter().for_each(|(case, latency)| {
        let agreed = compare(case, latency, (0..patterns).map(|a| [a]));
        assert_eq!(agreed, patterns);
    });
    let of_integers = cases(&OF_INTEGERS);
    of_integers.into_par_iter().for_each(|(case, latency)| {
        let widths = case.operator.operand_widths(format);
        let count = 1 << widths.iter().sum::<u32>();
        let agreed = match widths[..] {
            [_] => compare(case, latency, (0..count).map(|a| [a])),
            [first, _] => {
                let mask = (1 << first) - 1;
                compare(case, latency, (0..count).map(|k| [k & mask, k >> first]))
            }
            _ => unreachable!("one or two operands"),
        };
        assert_eq!(agreed, count);
    });
}

#[test]
fn every_configuration_agrees_on_all_operands_of_e4f3() {
    exhaust(FloatFormat::E4F3, &[0]);
}

#[test]
fn pipelined_configurations_agree_on_all_operands_of_e3f3() {
    exhaust(FloatFormat::new(3, 3), &[1, 2, 3, 4]);
}

#[test]
fn every_configuration_agrees_on_all_operands_of_other_shapes() {
    for (exponent_bits, fraction_bits) in [(3, 4), (5, 2), (2, 5), (2, 2), (4, 2)] {
        exhaust(FloatFormat::new(exponent_bits, fraction_bits), &[0]);
    }
}

/// Hard and random operands of wide formats.
fn sample(format: FloatFormat, count: usize) {
    let cases = |operators: &[FloatOperator]| {
        let all = operators.iter();
        let all = all.flat_map(|&operator| configurations(operator, format));
        all.collect::<Vec<_>>()
    };
    cases(&BINARY).into_par_iter().for_each(|case| {
        let mut random = Random(7);
        let pairs = std::iter::repeat_with(|| hard_pair(&mut random, format)).take(count);
        assert_eq!(compare(case, 0, pairs), count as u64);
    });
    let mut unary = UNARY.to_vec();
    unary.retain(|operator| !matches!(operator, FloatOperator::ToInteger { bits: 59 }));
    unary.retain(|operator| !matches!(operator, FloatOperator::ToUnsigned { bits: 59 }));
    unary.push(FloatOperator::ToInteger { bits: 32 });
    unary.push(FloatOperator::ToUnsigned { bits: 32 });
    cases(&unary).into_par_iter().for_each(|case| {
        let mut random = Random(8);
        let operands = std::iter::repeat_with(|| [hard_pair(&mut random, format)[0]]).take(count);
        assert_eq!(compare(case, 0, operands), count as u64);
    });
    let of_integers = [32, 64].map(|bits| {
        [
            FloatOperator::FromSigned { bits },
            FloatOperator::FromUnsigned { bits },
        ]
    });
    cases(&of_integers.concat())
        .into_par_iter()
        .for_each(|case| {
            let mut random = Random(9);
            let bits = case.operator.operand_widths(format)[0];
            let operands = std::iter::repeat_with(|| {
                let word = random.next() >> (64 - bits);
                // Of every length, of either sign.
                let moved = word >> random.below(bits.into());
                let ones = random.next() & 1;
                [(moved ^ 0_u64.wrapping_sub(ones)) & (u64::MAX >> (64 - bits))]
            });
            assert_eq!(compare(case, 0, operands.take(count)), count as u64);
        });
}

#[test]
fn every_configuration_agrees_on_hard_and_random_operands_of_wide_formats() {
    sample(FloatFormat::E7F16, 20_000);
    sample(FloatFormat::new(8, 23), 5_000);
    sample(FloatFormat::new(11, 31), 1_000);
}

/// A comparison that cannot fail proves nothing: a bit inverted in any register between two stages
/// of an operator with flags shows at its result or at its flags. But no quotient is rounded up to a
/// power of two, so a divider's rounder never asks whether that made it a normal number.
#[test]
fn a_bit_inverted_between_stages_is_caught() {
    let format = FloatFormat::E4F3;
    let operators = [
        FloatOperator::Divide,
        FloatOperator::SquareRoot,
        FloatOperator::Minimum,
        FloatOperator::CompareSignalling,
        FloatOperator::RoundToIntegral,
        FloatOperator::ToUnsigned { bits: 5 },
        FloatOperator::Convert { target: E5F2 },
    ];
    let cases: Vec<OperatorConfiguration> = operators
        .into_iter()
        .flat_map(|operator| configurations(operator, format))
        .filter(|case| case.has_flags && case.policy == Policy::Full)
        .collect();
    cases.into_par_iter().for_each(|case| {
        let module = case.build(2);
        let outputs = module.outputs.iter();
        let widths: Vec<u32> = outputs.map(|(_, wire)| module.width(*wire)).collect();
        let mut planted = 0;
        for node in &module.nodes {
            let is_register = matches!(node.operation, Operation::Register { .. });
            let (true, Some(name)) = (is_register, &node.name) else {
                continue;
            };
            if case.operator == FloatOperator::Divide && name.starts_with("exponent_is_zero") {
                continue;
            }
            let top = node.width - 1;
            let faulty = plant(&module, name, top).expect("a register of the module");
            let seen = match case.operator.operand_widths(format).len() {
                1 => Bench::new(&faulty).run((0..256).map(|a| [a]), |operand| {
                    golden(case, &widths, &operand)
                }),
                _ => {
                    Bench::new(&faulty).run(all_pairs(format), |pair| golden(case, &widths, &pair))
                }
            };
            assert!(seen.is_err(), "{}: {name}[{top}] is not seen", module.name);
            planted += 1;
        }
        assert!(planted > 2, "{}: {planted} faults", module.name);
    });
}
