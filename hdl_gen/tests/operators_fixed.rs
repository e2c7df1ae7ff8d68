//! Fixed-point operators against the golden arithmetic: every word of small formats, every rounding,
//! saturating and wrapping, with and without flags; hard and random words of wider ones.

mod bench;

use bench::{Bench, Mismatch, Random};
use hdl_gen::fault::plant;
use hdl_gen::netlist::Meaning;
use hdl_gen::operators::{FixedConfiguration, FixedOperator, Multiplier};
use rayon::prelude::*;
use rtl_model::fixed::{FixedFormat, Overflow};
use rtl_model::float::{FloatFormat, Policy, Rounding};

const BINARY: [FixedOperator; 5] = [
    FixedOperator::Add,
    FixedOperator::Subtract,
    FixedOperator::Multiply,
    FixedOperator::Divide,
    FixedOperator::Compare,
];

const UNARY: [FixedOperator; 3] = [
    FixedOperator::Reciprocal,
    FixedOperator::Negate,
    FixedOperator::Convert,
];

/// Formats with the point at either end, in the middle, with one bit, with no integer bit.
const SMALL: [FixedFormat; 9] = [
    FixedFormat::q(1, 0),
    FixedFormat::uq(0, 1),
    FixedFormat::uq(1, 0),
    FixedFormat::q(1, 2),
    FixedFormat::q(3, 0),
    FixedFormat::uq(0, 3),
    FixedFormat::q(2, 2),
    FixedFormat::uq(2, 1),
    FixedFormat::uq(4, 0),
];

/// The operator in all roundings, saturating and wrapping, with flags and without.
fn every_way(
    operator: FixedOperator,
    a: FixedFormat,
    b: FixedFormat,
    result: FixedFormat,
) -> Vec<FixedConfiguration> {
    let mut configurations = Vec::new();
    for rounding in Rounding::ALL {
        for overflow in Overflow::ALL {
            let plain = FixedConfiguration::new(operator, a, rounding, overflow)
                .with_operands(a, b)
                .with_result(result);
            configurations.extend([plain, plain.with_flags()]);
        }
    }
    if !operator.rounds() {
        configurations.truncate(1);
    }
    configurations
}

/// The golden answer with its output ports side by side, as the bench reads them.
fn golden(configuration: FixedConfiguration, operands: &[u64]) -> u64 {
    let mut results = Vec::new();
    configuration.golden_results(operands, &mut results);
    if !configuration.operator.rounds() {
        return results[0] << 2 | results[1] << 1 | results[2];
    }
    results[1..]
        .iter()
        .fold(results[0], |word, flags| word << 5 | flags)
}

/// Every operand, or every pair of operands.
fn exhaustive(configuration: FixedConfiguration, latency: u32) -> Result<u64, Mismatch> {
    let mut bench = Bench::new(&configuration.build(latency));
    let widths = configuration.operand_widths();
    let words = |width: u32| 0..1_u64 << width;
    match widths[..] {
        [a] => bench.run(words(a).map(|a| [a]), |operands| {
            golden(configuration, &operands)
        }),
        [a, b] => {
            let pairs = words(a).flat_map(|a| words(b).map(move |b| [a, b]));
            bench.run(pairs, |operands| golden(configuration, &operands))
        }
        _ => unreachable!("one or two operands"),
    }
}

fn all_agree(configurations: Vec<FixedConfiguration>, latency: u32) -> u64 {
    configurations
        .into_par_iter()
        .map(|configuration| {
            let agreed = exhaustive(configuration, latency);
            agreed.unwrap_or_else(|mismatch| panic!("{configuration:?}: {mismatch:x?}"))
        })
        .sum()
}

#[test]
fn every_pair_of_small_words_agrees() {
    let mut configurations = Vec::new();
    for operator in BINARY {
        for a in SMALL {
            for b in SMALL {
                for result in SMALL {
                    configurations.extend(every_way(operator, a, b, result));
                }
            }
        }
    }
    assert!(all_agree(configurations, 0) > 2_000_000);
}

#[test]
fn every_small_word_alone_agrees() {
    let shifts = (1..=4).flat_map(|amount_bits| {
        [
            FixedOperator::ShiftLeft { amount_bits },
            FixedOperator::ShiftRight { amount_bits },
        ]
    });
    let mut configurations = Vec::new();
    for operator in UNARY.into_iter().chain(shifts) {
        for a in SMALL {
            for result in SMALL {
                configurations.extend(every_way(operator, a, a, result));
            }
        }
    }
    assert!(all_agree(configurations, 0) > 500_000);
}

#[test]
fn products_without_a_dsp_block_agree() {
    let formats =
        (1..=6).flat_map(|width| [FixedFormat::q(1, width - 1), FixedFormat::uq(width, 0)]);
    let formats: Vec<FixedFormat> = formats.collect();
    let mut configurations = Vec::new();
    for &a in &formats {
        for &b in &formats {
            let result = FixedFormat::q(4, 3);
            let ways = every_way(FixedOperator::Multiply, a, b, result).into_iter();
            configurations.extend(ways.map(|one| one.with_multiplier(Multiplier::Logic)));
        }
    }
    assert!(configurations[0].name().ends_with("_logic_rne_saturate"));
    assert!(all_agree(configurations, 0) > 200_000);
}

#[test]
fn pipelines_of_any_depth_agree() {
    let shifts = [
        FixedOperator::ShiftLeft { amount_bits: 3 },
        FixedOperator::ShiftRight { amount_bits: 3 },
    ];
    for latency in 1..=5 {
        let mut configurations = Vec::new();
        for operator in BINARY.into_iter().chain(UNARY).chain(shifts) {
            let (a, b) = (FixedFormat::q(2, 3), FixedFormat::uq(1, 3));
            configurations.extend(every_way(operator, a, b, FixedFormat::q(2, 2)));
        }
        assert!(all_agree(configurations, latency) > 10_000);
    }
}

/// To and from floats, of both policies, that reach into, over and below the fixed-point range.
fn conversions(source: FloatFormat) -> impl Iterator<Item = FixedOperator> {
    Policy::ALL.into_iter().flat_map(move |policy| {
        [
            FixedOperator::FromFloat { source, policy },
            FixedOperator::ToFloat {
                target: source,
                policy,
            },
        ]
    })
}

#[test]
fn every_small_float_and_word_agrees() {
    let mut configurations = Vec::new();
    for source in [
        FloatFormat::E4F3,
        FloatFormat::new(2, 5),
        FloatFormat::new(3, 2),
        FloatFormat::new(5, 2),
    ] {
        for operator in conversions(source) {
            for format in SMALL {
                configurations.extend(every_way(operator, format, format, format));
            }
            let wide = [
                FixedFormat::q(4, 8),
                FixedFormat::uq(10, 0),
                FixedFormat::uq(0, 9),
                FixedFormat::q(20, 20),
            ];
            for format in wide {
                configurations.extend(every_way(operator, FixedFormat::q(5, 5), format, format));
            }
        }
    }
    assert!(all_agree(configurations, 0) > 200_000);
}

/// A word of a format, hard more often than chance would have it.
fn word(random: &mut Random, format: FixedFormat) -> u64 {
    let any = random.next();
    let shift = random.below(64);
    let word = match random.below(6) {
        0 => any >> shift,
        1 => (any >> shift).wrapping_neg(),
        2 => (1 << shift) + random.below(3),
        3 => (1_u64 << shift)
            .wrapping_neg()
            .wrapping_sub(random.below(3)),
        4 => format.min().wrapping_sub(random.below(3)),
        _ => any,
    };
    word & format.value_mask()
}

#[test]
fn wide_words_agree() {
    let formats = [
        FixedFormat::q(4, 12),
        FixedFormat::q(12, 20),
        FixedFormat::uq(0, 16),
        FixedFormat::uq(20, 12),
    ];
    let mut configurations = Vec::new();
    for operator in BINARY.into_iter().chain(UNARY) {
        for a in formats {
            for (b, result) in [(a, a), (formats[0], formats[1]), (formats[2], formats[0])] {
                configurations.extend(every_way(operator, a, b, result));
            }
        }
    }
    for amount_bits in [5, 6] {
        for operator in [
            FixedOperator::ShiftLeft { amount_bits },
            FixedOperator::ShiftRight { amount_bits },
        ] {
            configurations.extend(every_way(operator, formats[1], formats[1], formats[1]));
            configurations.extend(every_way(operator, formats[2], formats[1], formats[0]));
        }
    }
    for operator in conversions(FloatFormat::E7F16) {
        for format in formats {
            configurations.extend(every_way(operator, format, format, format));
        }
    }
    let compared: u64 = configurations
        .into_par_iter()
        .map(|configuration| {
            let mut bench = Bench::new(&configuration.build(0));
            let mut random = Random(9);
            let formats = configuration.operands();
            let agreed = match formats[..] {
                [Meaning::Float(source)] => {
                    let vectors = (0..20_000).map(|_| [random.next() & source.value_mask()]);
                    bench.run(vectors, |operands| golden(configuration, &operands))
                }
                [Meaning::Fixed(a)] => {
                    let vectors = (0..2_000).map(|_| [word(&mut random, a)]);
                    bench.run(vectors, |operands| golden(configuration, &operands))
                }
                [Meaning::Fixed(a), Meaning::Fixed(b)] => {
                    let vectors = (0..2_000).map(|_| [word(&mut random, a), word(&mut random, b)]);
                    bench.run(vectors, |operands| golden(configuration, &operands))
                }
                _ => unreachable!("one or two operands"),
            };
            agreed.unwrap_or_else(|mismatch| panic!("{configuration:?}: {mismatch:x?}"))
        })
        .sum();
    assert!(compared > 2_000_000, "{compared}");
}

#[test]
fn a_module_is_named_by_all_that_it_depends_on() {
    let q4_12 = FixedFormat::q(4, 12);
    let plain = FixedConfiguration::new(
        FixedOperator::Multiply,
        q4_12,
        Rounding::NearestEven,
        Overflow::Saturate,
    );
    assert_eq!(plain.module_name(1), "fixed_mul_q4_12_rne_saturate_l1");
    let mixed = plain
        .with_operands(q4_12, FixedFormat::uq(0, 16))
        .with_result(FixedFormat::q(12, 20))
        .with_flags();
    assert_eq!(
        mixed.name(),
        "fixed_mul_q4_12_uq0_16_to_q12_20_flags_rne_saturate"
    );
    let shift = FixedConfiguration {
        operator: FixedOperator::ShiftLeft { amount_bits: 4 },
        rounding: Rounding::Down,
        overflow: Overflow::Wrap,
        ..plain
    };
    assert_eq!(
        shift.name(),
        "fixed_shift_left_q4_12_uq4_0_to_q4_12_rdn_wrap"
    );
    let from_float = FixedConfiguration {
        operator: FixedOperator::FromFloat {
            source: FloatFormat::E7F16,
            policy: Policy::Full,
        },
        ..plain
    };
    assert_eq!(
        from_float.name(),
        "fixed_from_float_e7f16_to_q4_12_full_rne_saturate"
    );
    let to_float = FixedConfiguration {
        operator: FixedOperator::ToFloat {
            target: FloatFormat::E7F16,
            policy: Policy::Flush,
        },
        ..plain
    };
    assert_eq!(to_float.name(), "fixed_to_float_q4_12_to_e7f16_rne");
    let compare = FixedConfiguration {
        operator: FixedOperator::Compare,
        ..mixed
    };
    assert_eq!(compare.name(), "fixed_cmp_q4_12_uq0_16");
}

#[test]
fn words_too_wide_are_named() {
    for (operator, format, part) in [
        (FixedOperator::Multiply, FixedFormat::q(20, 20), "80 bits"),
        (FixedOperator::Add, FixedFormat::q(32, 32), "65 bits"),
        (
            FixedOperator::ShiftLeft { amount_bits: 7 },
            FixedFormat::q(8, 8),
            "1 to 6",
        ),
    ] {
        let configuration =
            FixedConfiguration::new(operator, format, Rounding::Down, Overflow::Wrap);
        let error = configuration.check().unwrap_err().to_string();
        assert!(
            error.contains(part) && error.contains(operator.name()),
            "{error}"
        );
    }
}

/// The saturation looks at the rounded word: if it looked at the one before, the carry of the
/// rounding would wrap unseen. A fault in the rounding's addition must be found likewise.
#[test]
fn faults_are_found() {
    let format = FixedFormat::q(2, 3);
    let anywhere = ["round_up", "is_inexact", "overflow", "odd_or_above"];
    for (operator, signal) in [
        (FixedOperator::Multiply, "sticky_bit"),
        (FixedOperator::Multiply, "upper_less_a_excess"),
        (FixedOperator::Divide, "divisor_is_zero"),
        (FixedOperator::Divide, "remainder_nonzero"),
        (FixedOperator::Divide, "quotient_beyond"),
    ] {
        let configuration =
            FixedConfiguration::new(operator, format, Rounding::NearestEven, Overflow::Saturate)
                .with_flags();
        let module = configuration.build(0);
        for signal in anywhere.into_iter().chain([signal]) {
            let faulty = plant(&module, signal, 0).unwrap();
            let pairs = (0..32).flat_map(|a| (0..32).map(move |b| [a, b]));
            let found = Bench::new(&faulty).run(pairs, |pair| golden(configuration, &pair));
            assert!(found.is_err(), "{}: a fault in {signal}", module.name);
        }
    }
}
