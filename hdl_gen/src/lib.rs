//! From the golden model's datapaths to Verilog, vectors, testbenches and simulators.

pub mod area;
pub mod blocks;
mod cache;
pub mod corpus;
pub mod datapath;
pub mod digest;
pub mod emit;
pub mod fault;
pub mod identifier;
pub mod nearest;
pub mod netlist;
pub mod operators;
pub mod package;
pub mod pipeline;
pub mod simulate;
pub mod testbench;
pub mod units;
pub mod vectors;
pub mod verify;
pub mod wave;
