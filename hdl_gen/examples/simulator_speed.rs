//! Cycles a second of the embedded simulator on a made-up pipelined datapath of about a thousand
//! nodes: `cargo run --release -p hdl_gen --example simulator_speed`.

use std::sync::Arc;
use std::time::Instant;

use hdl_gen::netlist::{Builder, Module};
use hdl_gen::simulate::{SimulateError, Simulator};

const STAGES: usize = 60;
const CYCLES: u64 = 500_000;

/// Each stage adds, multiplies, shifts, compares and chooses, as float operators do.
fn datapath() -> Arc<Module> {
    let mut b = Builder::new("datapath");
    let mut left = b.input("left_i", 24);
    let mut right = b.input("right_i", 24);
    for _ in 0..STAGES {
        let sum = b.add(left, right);
        let difference = b.subtract(left, right);
        let swapped = b.less_than(left, right);
        let chosen = b.mux(swapped, difference, sum);
        let low = b.slice(left, 15, 0);
        let high = b.slice(right, 23, 16);
        let product = b.multiply(low, high);
        let amount = b.slice(chosen, 4, 0);
        let shifted = b.shift_right(product, amount);
        let any = b.any_bit(shifted);
        let flipped = b.xor(chosen, shifted);
        let both = b.and(swapped, any);
        let next = b.mux(both, flipped, sum);
        let rotated_low = b.slice(next, 10, 0);
        let rotated_high = b.slice(next, 23, 11);
        let rotated = b.concat(&[rotated_low, rotated_high]);
        left = b.registered(rotated, None, None);
        right = b.registered(chosen, None, None);
    }
    b.output("left_o", left);
    b.output("right_o", right);
    b.finish()
}

fn main() -> Result<(), SimulateError> {
    let top = datapath();
    let mut simulator = Simulator::new(&top)?;
    let (left, right) = (simulator.input("left_i")?, simulator.input("right_i")?);
    let output = simulator.signal("left_o")?;
    let mut checksum = 0u64;
    let start = Instant::now();
    for cycle in 0..CYCLES {
        simulator.set_input(left, cycle.wrapping_mul(0x9e37_79b9) & 0xff_ffff);
        simulator.set_input(right, cycle.wrapping_mul(0x85eb_ca6b) & 0xff_ffff);
        simulator.settle();
        checksum = checksum.rotate_left(5) ^ simulator.peek(output);
        simulator.clock();
    }
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{} nodes, {} steps a cycle: {:.0} cycles/s, {:.2} ns a step (checksum {checksum:016x})",
        top.nodes.len(),
        simulator.steps(),
        CYCLES as f64 / seconds,
        seconds * 1e9 / (CYCLES as f64 * simulator.steps() as f64),
    );
    Ok(())
}
