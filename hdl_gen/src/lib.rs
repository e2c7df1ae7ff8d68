//! From the golden model's datapaths to Verilog, vectors, testbenches and simulators.

pub mod datapath;
pub mod emit;
pub mod nearest;
pub mod netlist;
pub mod operators;
pub mod pipeline;
pub mod simulate;
pub mod units;
pub mod verify;
pub mod wave;
