//! Fixed-point operators under Verilator against the golden arithmetic: q4.4 on all 65536 operand
//! pairs, mixed formats of 16 and 32 bits on hard and random ones.
//!
//! To compile C++ once and not once an operator, all operators of a set of formats stand side by
//! side in one design, the gallery, and see the same operands.

#[path = "common/tools.rs"]
mod tools;

use std::sync::Arc;

use hdl_gen::fault::plant;
use hdl_gen::netlist::{Builder, Module, Wire};
use hdl_gen::operators::{FixedConfiguration, FixedOperator, stream_unit};
use hdl_gen::pipeline::ENABLE;
use hdl_gen::verify::{Comparison, OperandSets, StreamRun};
use rtl_model::fixed::{FixedFormat, Overflow};
use rtl_model::float::{FloatFormat, Policy, Rounding};
use rtl_model::machine::StallPattern;

/// Cycles of every operator: with one cut inside, so that there are registers between stages.
const LATENCY: u32 = 2;

/// Pairs for formats too wide to try them all.
const PAIRS: u64 = 200_000;

/// Operators behind one handshake.
struct Gallery {
    configurations: Vec<FixedConfiguration>,
    /// The widths of the operands that all see; one takes their low bits.
    widths: [u32; 2],
    pairs: OperandSets,
    unit: Arc<Module>,
}

/// Every operator with operands and result of these formats, with flags.
fn every_operator(
    [a, b, result]: [FixedFormat; 3],
    float: FloatFormat,
    ways: &[(Rounding, Overflow)],
) -> Vec<FixedConfiguration> {
    let policy = Policy::Full;
    let operators = [
        FixedOperator::Add,
        FixedOperator::Subtract,
        FixedOperator::Multiply,
        FixedOperator::Divide,
        FixedOperator::Reciprocal,
        FixedOperator::Negate,
        FixedOperator::Convert,
        FixedOperator::ShiftLeft { amount_bits: 4 },
        FixedOperator::ShiftRight { amount_bits: 4 },
        FixedOperator::FromFloat {
            source: float,
            policy,
        },
        FixedOperator::ToFloat {
            target: float,
            policy,
        },
    ];
    let mut configurations = Vec::new();
    for &(rounding, overflow) in ways {
        configurations.extend(operators.map(|operator| {
            FixedConfiguration::new(operator, a, rounding, overflow)
                .with_operands(a, b)
                .with_result(result)
                .with_flags()
        }));
    }
    let compare = FixedOperator::Compare;
    let compare = FixedConfiguration::new(compare, a, Rounding::Down, Overflow::Wrap);
    configurations.push(compare.with_operands(a, b));
    // A conversion to a float is the same, saturating and wrapping.
    let mut names = std::collections::HashSet::new();
    configurations.retain(|configuration| names.insert(configuration.name()));
    configurations
}

impl Gallery {
    /// Builds it: outputs are named as the operator's module and its port.
    fn new(name: &str, configurations: Vec<FixedConfiguration>, pairs: OperandSets) -> Gallery {
        let mut widths = [1, 1];
        for configuration in &configurations {
            for (widest, width) in widths.iter_mut().zip(configuration.operand_widths()) {
                *widest = width.max(*widest);
            }
        }
        let mut builder = Builder::new(format!("gallery_{name}"));
        builder.describe("Every fixed-point operator, side by side.");
        builder.set_latency(LATENCY);
        let enable = builder.input(ENABLE, 1);
        let operands = [
            builder.input("a_i", widths[0]),
            builder.input("b_i", widths[1]),
        ];
        for configuration in &configurations {
            let module = configuration.build(LATENCY);
            let mut ports = vec![enable];
            for (operand, width) in operands.into_iter().zip(configuration.operand_widths()) {
                let low: Wire = builder.slice(operand, width - 1, 0);
                ports.push(low);
            }
            let instance = configuration.name();
            let results = builder.instance(&instance, &module, &ports);
            for (&result, (port, _)) in results.iter().zip(&module.outputs) {
                builder.output(&format!("{instance}_{port}"), result);
            }
        }
        Gallery {
            configurations,
            widths,
            pairs,
            unit: stream_unit(&builder.finish()),
        }
    }

    /// All pairs of q4.4.
    fn of_bytes() -> Gallery {
        let q4_4 = FixedFormat::q(4, 4);
        let ways: Vec<(Rounding, Overflow)> = Rounding::ALL
            .into_iter()
            .flat_map(|rounding| Overflow::ALL.map(|overflow| (rounding, overflow)))
            .collect();
        let configurations = every_operator([q4_4; 3], FloatFormat::E4F3, &ways);
        let pairs = OperandSets::of_operator(configurations[0], 0, 1);
        Gallery::new("q4_4", configurations, pairs)
    }

    /// Formats of their own for operands and result.
    fn of_wide_words() -> Gallery {
        let formats = [
            FixedFormat::q(4, 12),
            FixedFormat::uq(0, 16),
            FixedFormat::q(8, 16),
        ];
        let ways = [
            (Rounding::NearestEven, Overflow::Saturate),
            (Rounding::Down, Overflow::Wrap),
        ];
        let mut configurations = every_operator(formats, FloatFormat::new(5, 10), &ways);
        let wider = [
            FixedFormat::q(12, 20),
            FixedFormat::q(12, 20),
            FixedFormat::q(12, 20),
        ];
        configurations.extend(every_operator(wider, FloatFormat::E7F16, &ways[..1]));
        let widest = configurations.iter().find(|one| one.a == wider[0]).unwrap();
        let pairs = OperandSets::of_operator(*widest, PAIRS, 1);
        Gallery::new("wide", configurations, pairs)
    }

    /// Appends what every output must be.
    fn golden(&self, pair: &[u64], results: &mut Vec<u64>) {
        for configuration in &self.configurations {
            let mut operands = [0; 2];
            let widths = configuration.operand_widths();
            for (place, &width) in widths.iter().enumerate() {
                operands[place] = pair[place] & (u64::MAX >> (64 - width));
            }
            configuration.golden_results(&operands[..widths.len()], results);
        }
    }

    /// Hands `unit`, the gallery's own or one with a fault, to `simulate`, with all pairs, gaps
    /// and stalls.
    fn run(
        &self,
        unit: &Arc<Module>,
        simulate: impl FnOnce(&StreamRun<'_>) -> Comparison,
    ) -> Comparison {
        let mut idle_results = Vec::new();
        self.golden(&[0, 0], &mut idle_results);
        simulate(&StreamRun {
            unit,
            count: self.pairs.count(),
            vectors: &|k, operands, results| {
                self.pairs.set(k, operands);
                for (operand, width) in operands.iter_mut().zip(self.widths) {
                    *operand &= u64::MAX >> (64 - width);
                }
                self.golden(operands, results);
            },
            idle_results: &idle_results,
            gaps: StallPattern::one_in_eight(3),
            stalls: StallPattern::one_in_eight(7),
        })
    }

    /// All pairs under Verilator: not one result may differ.
    fn agrees_under_verilator(&self) {
        let Some(verilator) = tools::verilator() else {
            return;
        };
        let comparison = self.run(&self.unit, |run| {
            run.verilator(&verilator, None, |_| {}).unwrap()
        });
        assert_eq!(comparison.first, []);
        assert_eq!(comparison.mismatches, 0);
        assert_eq!(comparison.rays, self.pairs.count());
        // The handshake's two; of each operator its result and its flags, of a comparison three.
        let outputs = self.configurations.iter().map(|configuration| {
            if configuration.operator.rounds() {
                2
            } else {
                3
            }
        });
        assert_eq!(
            comparison.signals_compared,
            2 + outputs.sum::<u64>(),
            "outputs compared"
        );
    }
}

#[test]
fn q4_4_agrees_on_all_operand_pairs() {
    let gallery = Gallery::of_bytes();
    assert!(gallery.pairs.is_exhaustive());
    assert_eq!(gallery.pairs.count(), 65_536);
    // Ten operators in eight ways, one in four, and the comparison.
    assert_eq!(gallery.configurations.len(), 10 * 8 + 4 + 1);
    gallery.agrees_under_verilator();
}

#[test]
fn wide_and_mixed_formats_agree() {
    let gallery = Gallery::of_wide_words();
    assert_eq!(gallery.pairs.count(), PAIRS);
    gallery.agrees_under_verilator();
}

#[test]
fn a_fault_in_an_operator_is_caught_and_its_output_named() {
    let gallery = Gallery::of_bytes();
    for configuration in gallery.configurations.iter().step_by(7) {
        let instance = configuration.name();
        let path = if configuration.operator.rounds() {
            format!("core.{instance}.result_registered")
        } else {
            format!("core.{instance}.equal_registered")
        };
        let faulty = plant(&gallery.unit, &path, 0).unwrap();
        let comparison = gallery.run(&faulty, |run| run.embedded(|_, _, _| {}).unwrap());
        assert!(comparison.mismatches > 0, "{path}: not seen");
        assert!(!comparison.first.is_empty(), "{path}: not named");
        for divergence in &comparison.first {
            assert!(
                divergence.signal.starts_with(&instance),
                "{path}: seen at {}",
                divergence.signal
            );
        }
    }
}
