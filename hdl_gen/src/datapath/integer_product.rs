//! The multiplier of integers, a module of its own: it has registers where a float multiplier has.

use std::sync::Arc;

use crate::netlist::{Builder, Meaning, Module};
use crate::pipeline::pipelined;

/// The module `integer_mul_<A>x<B>_l<latency>`: the full product of two's complement integers of
/// so many bits.
pub(super) fn integer_product(widths: [u32; 2], latency: u32) -> Arc<Module> {
    let name = format!("integer_mul_{}x{}_l{latency}", widths[0], widths[1]);
    let mut builder = Builder::new(&name);
    builder.describe("a * b, two's complement, exact");
    builder.describe("golden: the product of Rust's i64");
    let mut operand = |name: &str, width: u32| {
        let port = builder.input(name, width);
        builder.mean(port, Meaning::Signed)
    };
    let a = operand("a_i", widths[0]);
    let b = operand("b_i", widths[1]);
    builder.section("product");
    let product = builder.multiply_signed(a, b);
    builder.name(product, "product");
    builder.mean(product, Meaning::Signed);
    builder.output("product_o", product);
    pipelined(&builder.finish(), latency, &name)
}
