//! Test vectors for anybody's simulator and board: `$readmemh` files and a manifest that says what
//! each bit of them means.
//!
//! A file holds one vector a line, in hexadecimal: all its fields side by side, the first at the
//! most significant end, so that one Verilog memory `reg [WIDTH-1:0] vectors [0:COUNT-1]` reads
//! it. `manifest.json` beside the files has the place, width, format and meaning of every field.
//! `docs/formats.md` describes both for people who have no Rust.
//!
//! Every expected value is the golden model's ([`rtl_model`]); no netlist takes part in it.

mod error;
mod field;
mod fixed;
mod machine;
mod manifest;
mod operators;
mod rays;
mod set;
mod step;
mod write;

pub use error::VectorError;
pub use field::{Field, FieldFormat, Role};
pub use machine::{MachineSurroundings, MachineVectors, machine_vectors};
pub(crate) use manifest::sha256;
pub use manifest::{Manifest, ManifestField, ManifestFile};
pub use operators::operator_vectors;
pub use rays::{RayVectors, ray_vectors, scene_rays};
pub use set::VectorSet;
pub use step::{KEPT_EVERY, idle_step_results, step_vectors};
pub(crate) use write::Files;
pub use write::{StepVectors, VectorPlan, hardware_format, write_vectors};
