//! The hardware's units, each datapath written once over [`crate::arith::Arith`].

pub mod fixed_setup;
pub mod fixed_shape;
pub mod search_policy;
pub mod step;
pub mod traverse;
mod traverse_axis;
pub mod traverse_setup;
pub mod traverse_step;
