//! Designs that several tests share.

use std::sync::Arc;

use hdl_gen::netlist::{Builder, Meaning, Module};
use rtl_model::float::FloatFormat;

/// Counts the zeros above the highest one bit of eight bits.
pub fn leading_zeros() -> Arc<Module> {
    let mut b = Builder::new("leading_zeros_8");
    b.describe("Zeros above the highest one bit; 8 where there is none.");
    let value = b.input("value_i", 8);
    b.section("a ladder from the top bit down");
    let mut count = b.constant(8, 4);
    for bit in 0..8 {
        let here = b.bit(value, bit);
        let zeros = b.constant(7 - u64::from(bit), 4);
        count = b.mux(here, zeros, count);
    }
    b.section("is it zero?");
    let any = b.any_bit(value);
    let none = b.not(any);
    b.output("count_o", count);
    b.output("is_zero_o", none);
    b.finish()
}

/// A toy of two pipeline stages that has a bit of everything: the difference of two magnitudes,
/// normalised, with a handshake.
pub fn normalised_difference() -> Arc<Module> {
    let counter = leading_zeros();
    let mut b = Builder::new("normalised_difference");
    b.describe("|a - b| shifted left until its top bit is 1, and by how much it was shifted.");
    b.describe("Source: hdl_gen/tests/common/mod.rs, `normalised_difference`.");
    b.set_latency(2);
    b.localparam("MAGNITUDE_BITS", 8, "width of both magnitudes");
    b.localparam("EXPONENT_BIAS", 63, "2^(7-1) - 1, the bias of e7f16");
    let ready = b.input("ready_i", 1);
    let valid = b.input("valid_i", 1);
    let left = b.input("a_i", 8);
    let right = b.input("b_i", 8);
    let tag = b.input("tag_i", 24);
    b.mean(tag, Meaning::Float(FloatFormat::E7F16));

    b.section("handshake");
    let stage_1_valid = b.register(1, None, Some(0));
    b.name(stage_1_valid, "stage_1_valid");
    let stage_1_free = b.not(stage_1_valid);
    let advance = b.or(stage_1_free, ready);
    b.name(advance, "advance");
    let held = b.mux(advance, valid, stage_1_valid);
    b.connect(stage_1_valid, held);

    b.section("stage 1: difference of magnitudes");
    let a_wide = b.zero_extend(left, 9);
    let b_wide = b.zero_extend(right, 9);
    let difference = b.subtract(a_wide, b_wide);
    b.name(difference, "difference");
    b.mean(difference, Meaning::Signed);
    let negative = b.bit(difference, 8);
    let low = b.slice(difference, 7, 0);
    let inverted = b.not(low);
    let one = b.constant(1, 8);
    let negated = b.add(inverted, one);
    let magnitude = b.mux(negative, negated, low);
    let magnitude_q = b.registered(magnitude, Some(advance), None);
    b.name(magnitude_q, "magnitude_q");
    let tag_low = b.slice(tag, 15, 0);
    let tag_q = b.registered(tag_low, Some(advance), None);
    let product = b.multiply(left, right);
    let high_product = b.slice(product, 15, 8);
    b.name(high_product, "high_product");
    let product_q = b.registered(high_product, Some(advance), None);

    b.section("stage 2: normalise");
    let bias = b.constant(63, 7);
    b.name(bias, "EXPONENT_BIAS");
    let counted = b.instance("counter", &counter, &[magnitude_q]);
    let shifted = b.shift_left(magnitude_q, counted[0]);
    let count_wide = b.zero_extend(counted[0], 7);
    let exponent = b.subtract(bias, count_wide);
    let signed = b.sign_extend(exponent, 10);
    let limit = b.constant(0x3c0, 10);
    let above = b.less_than(signed, limit);
    let same = b.equal(shifted, product_q);
    let odd = b.bit(product_q, 0);
    let both = b.and(above, same);
    let either = b.or(both, odd);
    let normalised_q = b.registered(shifted, Some(ready), None);
    let exponent_q = b.registered(exponent, Some(ready), None);
    let flag_q = b.registered(either, None, Some(1));
    let packed = b.concat(&[exponent, tag_q]);
    let packed_q = b.registered(packed, Some(ready), None);
    b.output("normalised_o", normalised_q);
    b.output("exponent_o", exponent_q);
    b.output("flag_o", flag_q);
    b.output("packed_o", packed_q);
    b.output("valid_o", stage_1_valid);
    b.finish()
}
