//! The golden model: a displacement-mapping traverse unit, bit for bit, with no knowledge of
//! Verilog, of tools or of a command line.
//!
//! Start with [`arith`], the operators a unit's hardware has; [`units`] holds the datapaths written
//! once over them; [`readings`] evaluates those datapaths in a number format; [`float`] is the
//! integer-only float arithmetic behind the golden values, [`fixed`] the fixed-point one; [`exact`]
//! is the independent judge, [`judge`] what it says of whole frames.

pub mod arith;
pub mod calibration;
pub mod camera;
pub mod early;
pub mod exact;
pub mod fixed;
pub mod fixed_packet;
pub mod float;
pub mod frame;
pub mod hard;
pub mod instruction_set;
pub mod judge;
pub mod machine;
pub mod maps;
pub mod packet;
pub mod picture;
pub mod published;
pub mod ray;
pub mod ray_format;
pub mod readings;
pub mod scene;
pub mod units;
pub mod walker;
