//! Operators under Verilator against the golden arithmetic: e4f3 on all 65536 operand pairs, e7f16
//! on a million, hard cases included; every operator, every rounding.
//!
//! To compile C++ once a format and not once an operator, all operators of a format stand side by
//! side in one design, the gallery, and see the same operands.

#[path = "common/operators.rs"]
mod operators;
#[path = "common/tools.rs"]
mod tools;

use std::sync::Arc;

use hdl_gen::fault::plant;
use hdl_gen::netlist::{Builder, Module, Operation, Wire};
use hdl_gen::operators::{FloatOperator, OperatorConfiguration, stream_unit};
use hdl_gen::pipeline::ENABLE;
use hdl_gen::verify::{Comparison, OperandSets, StreamRun};
use rtl_model::float::{FloatFormat, Rounding};
use rtl_model::machine::StallPattern;

use operators::every_operator;

/// Cycles of every operator: with one cut inside, so that there are registers between stages.
const LATENCY: u32 = 2;

/// Pairs for a format too wide to try them all.
const PAIRS: u64 = 1_000_000;

/// All operators of a format behind one handshake.
struct Gallery {
    format: FloatFormat,
    operators: Vec<(FloatOperator, Rounding)>,
    unit: Arc<Module>,
}

impl Gallery {
    /// Builds it: operands `a_i` and `b_i`, outputs named as the operator, its rounding and, where
    /// it has several, its port.
    fn new(format: FloatFormat) -> Gallery {
        let operators = every_operator(format);
        let mut builder = Builder::new(format!("gallery_{format}"));
        builder.describe("Every operator in every rounding, side by side.");
        builder.set_latency(LATENCY);
        let enable = builder.input(ENABLE, 1);
        let a = builder.input("a_i", format.width());
        let b = builder.input("b_i", format.width());
        for &(operator, rounding) in &operators {
            let module = OperatorConfiguration::new(operator, format, rounding).build(LATENCY);
            let widths = operator.operand_widths(format);
            let mut ports = vec![enable];
            for (operand, width) in [a, b].into_iter().zip(widths) {
                ports.push(low_bits(&mut builder, operand, width));
            }
            let instance = instance_name(operator, rounding);
            let results = builder.instance(&instance, &module, &ports);
            for (&result, (port, _)) in results.iter().zip(&module.outputs) {
                builder.output(&output_name(&instance, port), result);
            }
        }
        Gallery {
            format,
            operators,
            unit: stream_unit(&builder.finish()),
        }
    }

    /// The operand pairs: those of an operator with two floats, for all.
    fn pairs(&self) -> OperandSets {
        OperandSets::new(FloatOperator::Add, self.format, PAIRS, 1)
    }

    /// Appends what every output must be.
    fn golden(&self, pair: &[u64], results: &mut Vec<u64>) {
        for &(operator, rounding) in &self.operators {
            let mut operands = [0; 2];
            let widths = operator.operand_widths(self.format);
            for (place, &width) in widths.iter().enumerate() {
                operands[place] = pair[place] & (u64::MAX >> (64 - width));
            }
            operator.golden_results(self.format, rounding, &operands[..widths.len()], results);
        }
    }

    /// Hands `unit`, the gallery's own or one with a fault, to `simulate`, with all pairs, gaps
    /// and stalls.
    fn run(
        &self,
        unit: &Arc<Module>,
        simulate: impl FnOnce(&StreamRun<'_>) -> Comparison,
    ) -> Comparison {
        let pairs = self.pairs();
        let mut idle_results = Vec::new();
        self.golden(&[0, 0], &mut idle_results);
        simulate(&StreamRun {
            unit,
            count: pairs.count(),
            vectors: &|k, operands, results| {
                pairs.set(k, operands);
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
        let pairs = self.pairs();
        let comparison = self.run(&self.unit, |run| {
            run.verilator(&verilator, None, |_| {}).unwrap()
        });
        assert_eq!(comparison.first, []);
        assert_eq!(comparison.mismatches, 0);
        assert_eq!(comparison.rays, pairs.count());
        // The handshake's two and the results: one of each operator, but four of the comparisons.
        let results = self.operators.len() as u64 + 2 * 3;
        assert_eq!(comparison.signals_compared, 2 + results);
    }
}

/// The operator's name, with its rounding where it has one: what tells a gallery's instances apart.
fn instance_name(operator: FloatOperator, rounding: Rounding) -> String {
    match operator.rounds() {
        true => format!("{}_{rounding}", operator.name()),
        false => operator.name().to_owned(),
    }
}

/// The gallery's port for an instance's: where there is one result it has the instance's name.
fn output_name(instance: &str, port: &str) -> String {
    match port {
        "result_o" => format!("{instance}_o"),
        port => format!("{instance}_{port}"),
    }
}

/// The lower bits of a word, with zeros in front where it has not as many.
fn low_bits(builder: &mut Builder, word: Wire, width: u32) -> Wire {
    match builder.width(word) {
        narrow if narrow < width => builder.zero_extend(word, width),
        _ => builder.slice(word, width - 1, 0),
    }
}

#[test]
fn a_gallery_holds_every_operator_in_every_rounding() {
    let operators = every_operator(FloatFormat::E7F16);
    let in_all_roundings = operators.iter().filter(|(operator, _)| operator.rounds());
    // Five of arithmetic, seven conversions; comparison and all that is exact or rounds one way.
    assert_eq!(in_all_roundings.count(), 12 * 4);
    assert_eq!(operators.len(), 12 * 4 + 10);
}

#[test]
fn e4f3_agrees_on_all_operand_pairs() {
    let gallery = Gallery::new(FloatFormat::E4F3);
    assert!(gallery.pairs().is_exhaustive());
    assert_eq!(gallery.pairs().count(), 65_536);
    gallery.agrees_under_verilator();
}

#[test]
fn e7f16_agrees_on_a_million_operand_pairs() {
    let gallery = Gallery::new(FloatFormat::E7F16);
    assert_eq!(gallery.pairs().count(), PAIRS);
    gallery.agrees_under_verilator();
}

/// The last of the registers between the module's stages: no output port. (The first, in a divider
/// the divisor, has bits whose inversion changes no result.)
fn inner_register(module: &Module) -> &str {
    let is_output = |place| {
        let mut drivers = module.outputs.iter().map(|(_, driver)| driver.index());
        drivers.any(|driver| driver == place)
    };
    let inner = module.nodes.iter().enumerate().rev();
    let inner = inner.filter(|(place, node)| {
        matches!(node.operation, Operation::Register { .. }) && !is_output(*place)
    });
    let mut names = inner.filter_map(|(_, node)| node.name.as_deref());
    names
        .next()
        .unwrap_or_else(|| panic!("{} has no named register between its stages", module.name))
}

#[test]
fn a_fault_in_any_operator_is_caught_and_its_output_named() {
    let gallery = Gallery::new(FloatFormat::E4F3);
    for &(operator, rounding) in &gallery.operators {
        let instance = instance_name(operator, rounding);
        let module = OperatorConfiguration::new(operator, gallery.format, rounding).build(LATENCY);
        let path = format!("core.{instance}.{}", inner_register(&module));
        let faulty = plant(&gallery.unit, &path, 0).unwrap();
        let comparison = gallery.run(&faulty, |run| run.embedded(|_, _, _| {}).unwrap());
        assert!(comparison.mismatches > 0, "{path}: not seen");
        assert!(!comparison.first.is_empty(), "{path}: not named");
        let ports = module.outputs.iter();
        let own_outputs: Vec<String> = ports
            .map(|(port, _)| output_name(&instance, port))
            .collect();
        for divergence in &comparison.first {
            assert_eq!(divergence.unit, "gallery_e4f3_unit", "{path}");
            assert!(
                own_outputs.contains(&divergence.signal),
                "{path}: seen at {}",
                divergence.signal
            );
        }
    }
}
