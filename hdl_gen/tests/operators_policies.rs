//! Operators with full subnormal numbers, with flags and of either structure against the golden
//! arithmetic, through the embedded simulator: every pair of small formats, hard pairs of the
//! unit's own and of binary32.

mod bench;

use std::sync::Arc;

use bench::{Bench, Mismatch, Random, all_pairs, hard_pair};
use hdl_gen::fault::plant;
use hdl_gen::netlist::Module;
use hdl_gen::operators::{FloatOperator, Multiplier, OperatorConfiguration, Structure};
use rayon::prelude::*;
use rtl_model::float::{Flags, FloatFormat, Policy, Rounding};

/// Every rounding, both policies, with and without flags, and products with and without a DSP
/// block; but not the default, which the other tests are about.
fn configurations(format: FloatFormat) -> Vec<OperatorConfiguration> {
    let mut configurations = Vec::new();
    let operators = [
        (FloatOperator::Add, Multiplier::Dsp),
        (FloatOperator::Subtract, Multiplier::Dsp),
        (FloatOperator::Multiply, Multiplier::Dsp),
        (FloatOperator::Multiply, Multiplier::Logic),
    ];
    for (operator, multiplier) in operators {
        for rounding in Rounding::ALL {
            for policy in Policy::ALL {
                for has_flags in [false, true] {
                    configurations.push(OperatorConfiguration {
                        policy,
                        has_flags,
                        structure: Structure {
                            multiplier,
                            ..Structure::default()
                        },
                        ..OperatorConfiguration::new(operator, format, rounding)
                    });
                }
            }
        }
    }
    let default = |configuration: &OperatorConfiguration| {
        let OperatorConfiguration {
            operator, rounding, ..
        } = *configuration;
        *configuration == OperatorConfiguration::new(operator, format, rounding)
    };
    configurations.retain(|configuration| !default(configuration));
    configurations
}

/// The results side by side, as the bench reads them.
fn golden(configuration: OperatorConfiguration, operands: [u64; 2]) -> u64 {
    let mut results = Vec::new();
    configuration.golden_results(&operands, &mut results);
    match results[..] {
        [result] => result,
        [result, flags] => result << Flags::WIDTH | flags,
        _ => panic!("{configuration:?}: {} results", results.len()),
    }
}

fn run(
    configuration: OperatorConfiguration,
    module: &Arc<Module>,
    pairs: impl Iterator<Item = [u64; 2]>,
) -> Result<u64, Mismatch> {
    Bench::new(module).run(pairs, |operands| golden(configuration, operands))
}

fn exhaust(configuration: OperatorConfiguration, latency: u32) {
    let module = configuration.build(latency);
    assert_eq!(module.latency, latency);
    assert_eq!(
        module.outputs.len(),
        1 + usize::from(configuration.has_flags)
    );
    let format = configuration.format;
    let agreed = run(configuration, &module, all_pairs(format));
    assert_eq!(agreed, Ok(1 << (2 * format.width())));
}

#[test]
fn combinational_operators_agree_on_every_pair_of_e4f3() {
    configurations(FloatFormat::E4F3)
        .into_par_iter()
        .for_each(|configuration| exhaust(configuration, 0));
}

#[test]
fn pipelined_operators_agree_on_every_pair_of_e3f3() {
    let format = FloatFormat::new(3, 3);
    let configurations = configurations(format);
    (1..=4).into_par_iter().for_each(|latency| {
        for &configuration in &configurations {
            exhaust(configuration, latency);
        }
    });
}

#[test]
fn operators_agree_on_every_pair_of_other_shapes() {
    let shapes = [(3, 4), (5, 2), (2, 5), (2, 2)].map(|(e, f)| FloatFormat::new(e, f));
    shapes.into_par_iter().for_each(|format| {
        for configuration in configurations(format) {
            exhaust(configuration, 0);
        }
    });
}

#[test]
fn operators_agree_on_hard_pairs_of_wide_formats() {
    let shapes = [
        (7, 16, 40_000),
        (8, 23, 20_000),
        (5, 10, 20_000),
        (11, 31, 10_000),
    ];
    for (exponent_bits, fraction_bits, pairs) in shapes {
        let format = FloatFormat::new(exponent_bits, fraction_bits);
        configurations(format)
            .into_par_iter()
            .for_each(|configuration| {
                let latency = configuration.rounding as u32;
                let module = configuration.build(latency);
                let mut random = Random(u64::from(latency));
                let hard = std::iter::repeat_with(|| hard_pair(&mut random, format));
                let agreed = run(configuration, &module, hard.take(pairs));
                assert_eq!(agreed, Ok(pairs as u64));
            });
    }
}

/// Every flag that an operator can raise is raised by some pair: a comparison of flags that are
/// never set would prove little.
#[test]
fn every_flag_is_raised_by_some_pair() {
    for configuration in configurations(FloatFormat::E4F3) {
        if !configuration.has_flags {
            continue;
        }
        let flags = all_pairs(configuration.format).fold(0, |raised, pair| {
            raised | golden(configuration, pair) & ((1 << Flags::WIDTH) - 1)
        });
        let is_sum = configuration.operator != FloatOperator::Multiply;
        let mut all = Flags::INVALID | Flags::OVERFLOW | Flags::INEXACT;
        // A sum below the normal numbers is exact.
        if !(is_sum && configuration.policy == Policy::Full) {
            all |= Flags::UNDERFLOW;
        }
        assert_eq!(flags, u64::from(all.bits()), "{configuration:?}");
    }
}

/// One inverted bit of any named signal shows, but for bits of which only some are read.
#[test]
fn a_planted_fault_is_caught() {
    for configuration in configurations(FloatFormat::new(3, 3)) {
        if !configuration.has_flags || configuration.rounding != Rounding::NearestEven {
            continue;
        }
        let module = configuration.build(0);
        let names = [
            "a_exponent_nonzero",
            "is_nan",
            "guard_bit",
            "is_invalid",
            "raises_inexact",
        ];
        for name in names {
            let faulty = plant(&module, name, 0).unwrap_or_else(|error| panic!("{error}"));
            let outcome = run(configuration, &faulty, all_pairs(configuration.format));
            assert!(outcome.is_err(), "{}: {name}", module.name);
        }
    }
}
