//! From the golden model's datapaths to Verilog, vectors, testbenches and simulators.

pub mod netlist;
pub mod operators;
