//! The embedded simulator on small designs whose answers are known by hand.

use std::sync::Arc;

use hdl_gen::netlist::{Builder, Module};
use hdl_gen::simulate::{SimulateError, Simulator};

/// A counter with enable and reset, and its value plus an offset.
fn counter() -> Arc<Module> {
    let mut b = Builder::new("counter");
    let enable = b.input("enable_i", 1);
    let offset = b.input("offset_i", 8);
    let count = b.register(8, Some(enable), Some(5));
    b.name(count, "count");
    let one = b.constant(1, 8);
    let next = b.add(count, one);
    b.connect(count, next);
    let shifted = b.add(count, offset);
    b.output("count_o", shifted);
    b.finish()
}

#[test]
fn a_counter_counts_holds_wraps_and_resets() {
    let mut simulator = Simulator::new(&counter()).unwrap();
    assert_eq!(simulator.get("count"), Ok(0), "registers start at 0");
    simulator.reset();
    assert_eq!(simulator.get("count"), Ok(5), "reset wins over enable");
    simulator.set("enable_i", 1).unwrap();
    simulator.set("offset_i", 250).unwrap();
    for expected in [255, 0, 1] {
        assert_eq!(simulator.get("count_o"), Ok(expected));
        simulator.clock();
    }
    simulator.set("enable_i", 0).unwrap();
    simulator.clock();
    assert_eq!(simulator.get("count"), Ok(8), "holds while disabled");
    simulator.set("rst_ni", 0).unwrap();
    simulator.clock();
    assert_eq!(simulator.get("count"), Ok(5));
}

#[test]
fn every_operation_at_hand_picked_values() {
    let mut b = Builder::new("operations");
    let a = b.input("a_i", 8);
    let c = b.input("b_i", 8);
    let amount = b.input("amount_i", 7);
    let bit = b.input("bit_i", 1);
    let results = [
        ("not", b.not(a)),
        ("and", b.and(a, c)),
        ("or", b.or(a, c)),
        ("xor", b.xor(a, c)),
        ("add", b.add(a, c)),
        ("subtract", b.subtract(a, c)),
        ("multiply", b.multiply(a, c)),
        ("left", b.shift_left(a, amount)),
        ("right", b.shift_right(a, amount)),
        ("equal", b.equal(a, c)),
        ("less", b.less_than(a, c)),
        ("mux", b.mux(bit, a, c)),
        ("concat", b.concat(&[a, bit, c])),
        ("slice", b.slice(a, 6, 4)),
        ("zero", b.zero_extend(a, 64)),
        ("sign", b.sign_extend(a, 64)),
        ("any", b.any_bit(a)),
        ("all", b.all_bits(a)),
    ];
    for (name, wire) in results {
        b.output(&format!("{name}_o"), wire);
    }
    let mut simulator = Simulator::new(&b.finish()).unwrap();
    let mut expect = |inputs: [u64; 4], expected: &[(&str, u64)]| {
        for (name, value) in ["a_i", "b_i", "amount_i", "bit_i"].iter().zip(inputs) {
            simulator.set(name, value).unwrap();
        }
        for &(name, value) in expected {
            assert_eq!(
                simulator.get(&format!("{name}_o")),
                Ok(value),
                "{name} of {inputs:?}"
            );
        }
    };
    expect(
        [0xb4, 0x5c, 3, 1],
        &[
            ("not", 0x4b),
            ("and", 0x14),
            ("or", 0xfc),
            ("xor", 0xe8),
            ("add", 0x10),
            ("subtract", 0x58),
            ("multiply", 0xb4 * 0x5c),
            ("left", 0xa0),
            ("right", 0x16),
            ("equal", 0),
            ("less", 0),
            ("mux", 0xb4),
            ("concat", 0x1695c),
            ("slice", 3),
            ("zero", 0xb4),
            ("sign", 0xffff_ffff_ffff_ffb4),
            ("any", 1),
            ("all", 0),
        ],
    );
    expect(
        [0xff, 0xff, 100, 0],
        &[
            ("left", 0),
            ("right", 0),
            ("equal", 1),
            ("less", 0),
            ("all", 1),
            ("multiply", 0xfe01),
        ],
    );
    expect(
        [0, 1, 0, 0],
        &[("any", 0), ("less", 1), ("subtract", 0xff), ("sign", 0)],
    );
}

#[test]
fn signals_of_instances_are_found_by_their_path() {
    let inner = counter();
    let mut b = Builder::new("pair");
    let enable = b.input("enable_i", 1);
    let offset = b.input("offset_i", 8);
    let first = b.instance("first", &inner, &[enable, offset]);
    let second = b.instance("second", &inner, &[enable, first[0]]);
    b.output("sum_o", second[0]);
    let mut simulator = Simulator::new(&b.finish()).unwrap();
    simulator.reset();
    simulator.set("enable_i", 1).unwrap();
    simulator.set("offset_i", 100).unwrap();
    simulator.clock();
    assert_eq!(simulator.get("first.count"), Ok(6));
    assert_eq!(simulator.get("second.offset_i"), Ok(106));
    assert_eq!(simulator.get("second.count_o"), Ok(112));
    assert_eq!(simulator.get("sum_o"), Ok(112));

    let error = simulator.signal("frist.count").unwrap_err();
    assert!(matches!(error, SimulateError::NoSuchSignal { .. }));
    assert!(error.to_string().contains("first.count"), "{error}");
    let error = simulator.set("offset", 1).unwrap_err();
    assert!(error.to_string().contains("offset_i"), "{error}");
}

#[test]
#[should_panic(expected = "before it settled")]
fn a_stale_value_is_not_read() {
    let mut simulator = Simulator::new(&counter()).unwrap();
    let output = simulator.signal("count_o").unwrap();
    simulator.clock();
    simulator.peek(output);
}
