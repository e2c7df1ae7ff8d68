//! The hardware's units, each datapath written once over [`crate::arith::Arith`].

pub mod traverse;
pub mod traverse_setup;
pub mod traverse_step;
