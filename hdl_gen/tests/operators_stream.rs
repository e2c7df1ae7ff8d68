//! Stream units under random offers and stalls, and what a pipeline keeps in registers.

mod bench;

use std::collections::VecDeque;

use bench::{Random, all_pairs, golden_binary};
use hdl_gen::netlist::Operation;
use hdl_gen::operators::{
    FloatOperator, Multiplier, OperatorConfiguration, Structure, stream_unit,
};
use hdl_gen::pipeline::longest_path;
use hdl_gen::simulate::Simulator;
use rtl_model::float::{FloatFormat, Rounding};

/// Offers pairs and takes results, each with a chance a cycle; every result must be that of the
/// oldest pair that has none yet. Returns the cycles it took.
fn stream(latency: u32, pairs: usize, offer_percent: u64, take_percent: u64) -> u64 {
    let (format, rounding) = (FloatFormat::E4F3, Rounding::NearestEven);
    let unit = stream_unit(
        &OperatorConfiguration::new(FloatOperator::Add, format, rounding).build(latency),
    );
    assert_eq!(unit.name, format!("float_add_e4f3_rne_l{latency}_unit"));
    let mut simulator = Simulator::new(&unit).unwrap();
    simulator.reset();
    let mut random = Random(u64::from(latency) << 32 | offer_percent << 8 | take_percent);
    let mut operands = all_pairs(format).step_by(7).take(pairs);
    let mut offered: Option<[u64; 2]> = None;
    let mut expected = VecDeque::new();
    let mut last_refused: Option<u64> = None;
    let mut taken = 0;
    while taken < pairs {
        // An offer stands until it is accepted.
        if offered.is_none() && random.below(100) < offer_percent {
            offered = operands.next();
        }
        let [a, b] = offered.unwrap_or([random.below(256), random.below(256)]);
        let ready = u64::from(random.below(100) < take_percent);
        for (port, value) in [
            ("valid_i", offered.is_some().into()),
            ("a_i", a),
            ("b_i", b),
            ("ready_i", ready),
        ] {
            simulator.set(port, value).unwrap();
        }
        if simulator.get("valid_o").unwrap() == 1 {
            let result = simulator.get("result_o").unwrap();
            assert!(
                last_refused.is_none_or(|refused| refused == result),
                "a result that waits changed"
            );
            last_refused = Some(result);
            if ready == 1 {
                assert_eq!(expected.pop_front(), Some(result), "result {taken}");
                taken += 1;
                last_refused = None;
            }
        } else {
            assert_eq!(last_refused, None, "a result that was not taken vanished");
        }
        if offered.is_some() && simulator.get("ready_o").unwrap() == 1 {
            expected.push_back(golden_binary(FloatOperator::Add, format, rounding, a, b));
            offered = None;
        }
        simulator.clock();
    }
    assert!(expected.is_empty(), "results of no pair: {expected:?}");
    simulator.cycles()
}

#[test]
fn a_stream_unit_keeps_order_and_values_under_stalls() {
    for latency in 1..=5 {
        for (offer, take) in [(50, 50), (90, 20), (20, 90), (100, 35), (35, 100)] {
            stream(latency, 1500, offer, take);
        }
    }
}

#[test]
fn a_stream_unit_without_stalls_takes_a_pair_every_cycle() {
    for latency in 1..=5 {
        // One edge of reset; the last result is taken in the cycle after its latency.
        assert_eq!(
            stream(latency, 1000, 100, 100),
            1000 + u64::from(latency) + 1
        );
    }
}

#[test]
#[should_panic(expected = "needs a pipelined core")]
fn combinational_logic_has_no_stream_unit() {
    let core = OperatorConfiguration::new(
        FloatOperator::LessThan,
        FloatFormat::E4F3,
        Rounding::NearestEven,
    )
    .build(0);
    stream_unit(&core);
}

#[test]
fn every_path_crosses_as_many_registers_as_the_latency() {
    for kind in [
        FloatOperator::Add,
        FloatOperator::Divide,
        FloatOperator::Compare,
    ] {
        for latency in 1..=6 {
            let module =
                OperatorConfiguration::new(kind, FloatFormat::E7F16, Rounding::NearestEven)
                    .build(latency);
            // Registers behind an input or behind nothing but constants, along any path.
            let mut crossed: Vec<Option<u32>> = Vec::new();
            for node in &module.nodes {
                let enable = match node.operation {
                    Operation::Register { enable, .. } => enable,
                    _ => None,
                };
                let mut depths = node
                    .operation
                    .operands()
                    .into_iter()
                    .filter(|&operand| Some(operand) != enable)
                    .filter_map(|operand| crossed[operand.index()])
                    .collect::<Vec<_>>();
                depths.dedup();
                assert!(
                    depths.len() <= 1,
                    "{}: {node:?} joins stages {depths:?}",
                    module.name
                );
                let is_register = matches!(node.operation, Operation::Register { .. });
                let is_input = node.operation == Operation::Input;
                if is_register {
                    assert!(
                        !depths.is_empty(),
                        "{}: a constant is registered",
                        module.name
                    );
                }
                let depth = depths.first().map(|depth| depth + u32::from(is_register));
                crossed.push(if is_input { Some(0) } else { depth });
            }
            for (name, wire) in &module.outputs {
                assert_eq!(
                    crossed[wire.index()],
                    Some(latency),
                    "{} {name}",
                    module.name
                );
            }
        }
    }
}

#[test]
fn more_stages_are_shorter_stages() {
    for kind in [
        FloatOperator::Add,
        FloatOperator::Multiply,
        FloatOperator::Divide,
    ] {
        let path = |latency| {
            // A product in a DSP block is one operation, which no cut makes shorter: here it is rows.
            let structure = Structure {
                multiplier: Multiplier::Logic,
                ..Structure::default()
            };
            let configuration =
                OperatorConfiguration::new(kind, FloatFormat::E7F16, Rounding::NearestEven);
            longest_path(&configuration.with_structure(structure).build(latency))
        };
        let paths: Vec<u32> = (1..=4).map(path).collect();
        // One stage holds all the logic; cut, it is read bit by bit, so that a word that is joined
        // of early and late bits is not late as a whole.
        assert!(paths[0] <= path(0), "{} and {paths:?}", path(0));
        // None is longer.
        assert!(
            paths.is_sorted_by(|longer, shorter| longer >= shorter),
            "{paths:?}"
        );
        // Cuts fall between operations, so not into equal parts; but not far from it.
        assert!(paths[1] * 2 < paths[0] * 13 / 10, "{paths:?}");
        assert!(paths[3] * 4 < paths[0] * 16 / 10, "{paths:?}");
    }
}
