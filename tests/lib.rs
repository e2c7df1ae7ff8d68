//! End-to-end tests of the public command line and the public crates live in `tests/`; here is what
//! they share.

pub mod command_line;
pub mod subjects;
