//! The hardware's units, each datapath written once over [`crate::arith::Arith`].

mod fixed_answer;
mod fixed_ascent;
mod fixed_child;
pub mod fixed_node_step;
pub mod fixed_setup;
pub mod fixed_shape;
pub mod fixed_step;
pub mod fixed_traverse;
pub mod search_policy;
pub mod step;
pub mod traverse;
mod traverse_axis;
pub mod traverse_setup;
pub mod traverse_step;
pub mod wide;
mod wide_border;
pub mod wide_fixed;
pub mod wide_fixed_step;
pub mod wide_setup;
pub mod wide_shape;
pub mod wide_step;
pub mod wide_unit;
pub mod wide_walk;
