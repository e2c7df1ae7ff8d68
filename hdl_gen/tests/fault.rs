//! Planted faults are seen where they should be, and nowhere else.

mod common;

use std::sync::Arc;

use hdl_gen::emit::verilog;
use hdl_gen::fault::{FaultError, plant};
use hdl_gen::netlist::Module;
use hdl_gen::simulate::Simulator;

/// The outputs of the toy after a few cycles of fixed inputs.
fn outputs(top: &Arc<Module>) -> Vec<u64> {
    let mut simulator = Simulator::new(top).unwrap();
    for (name, value) in [("a_i", 200), ("b_i", 190), ("tag_i", 0x123456)] {
        simulator.set(name, value).unwrap();
    }
    simulator.set("valid_i", 1).unwrap();
    simulator.set("ready_i", 1).unwrap();
    simulator.reset();
    for _ in 0..4 {
        simulator.clock();
    }
    let ports = top.outputs.iter();
    ports
        .map(|(name, _)| simulator.get(name).unwrap())
        .collect()
}

#[test]
fn the_faultless_design_answers_what_it_should() {
    let top = common::normalised_difference();
    // 200 - 190 = 10 = 1010b: four zeros above it among eight bits.
    assert_eq!(outputs(&top), [0xa0, 63 - 4, 0, (63 - 4) << 16 | 0x3456, 1]);
}

#[test]
fn faults_are_seen_at_the_outputs_they_reach() {
    let top = common::normalised_difference();
    let good = outputs(&top);
    // Path, bit, and the outputs that must change.
    for (path, bit, changed) in [
        ("magnitude_q", 0, vec![0]),
        ("tag_i", 3, vec![3]),
        ("tag_i", 20, vec![]),
        ("difference", 1, vec![0]),
        ("exponent_o", 2, vec![1]),
        ("valid_o", 0, vec![4]),
        ("counter.count_o", 0, vec![0, 1, 3]),
        ("leading_zeros_8.count_o", 0, vec![0, 1, 3]),
        ("normalised_difference.EXPONENT_BIAS", 5, vec![1, 3]),
    ] {
        let faulty = plant(&top, path, bit).unwrap();
        let answers = outputs(&faulty);
        let differing: Vec<usize> = (0..good.len()).filter(|&i| good[i] != answers[i]).collect();
        assert_eq!(differing, changed, "{path}[{bit}]");
    }
}

#[test]
fn only_the_faulty_module_says_so() {
    let top = common::normalised_difference();
    let faulty = plant(&top, "counter.value_i", 7).unwrap();
    let inner = &faulty.instances[0].module;
    assert!(verilog(inner, "0").contains("// FAULT PLANTED: bit 7 of `counter.value_i`"));
    assert!(!verilog(&faulty, "0").contains("FAULT"));
    assert!(!verilog(&top.instances[0].module, "0").contains("FAULT"));
    assert_eq!(inner.name, "leading_zeros_8");
}

#[test]
fn errors_name_near_paths_and_the_width() {
    let top = common::normalised_difference();
    let error = plant(&top, "counter.cuont_o", 0).unwrap_err();
    assert!(error.to_string().contains("counter.count_o"), "{error}");
    let error = plant(&top, "difference", 9).unwrap_err();
    assert!(matches!(error, FaultError::NoSuchBit { width: 9, .. }));
    assert!(error.to_string().contains("bits 0 to 8"), "{error}");
}
