//! Self-checking testbenches in plain Verilog-2005, for anybody's simulator.
//!
//! Their fixed text stands in `testbenches/verilog/*.v.in`; what depends on the unit (names,
//! widths, ports) is put in here, where the text says `@NAME@`. They read the files that
//! [`crate::vectors`] writes, and end with one line, `PASS` or `FAIL`, which [`Verdict`] reads.

mod machine;
mod stream;
mod traverse;
mod verdict;

pub use machine::machine_testbench;
pub use stream::stream_testbench;
pub use traverse::{TraverseBench, traverse_testbench};
pub use verdict::{FieldDifference, Verdict};

/// Puts values in for the `@NAME@`s of a text.
///
/// # Panics
/// If a name is left over: a mistake of the text or of the list.
fn filled_in(text: &str, values: &[(&str, &str)]) -> String {
    let mut filled = text.to_owned();
    for (name, value) in values {
        filled = filled.replace(&format!("@{name}@"), value);
    }
    // An event control is written `@(`: what is left of the form `@NAME` was forgotten.
    let mut left = filled.split('@').skip(1);
    assert!(
        left.all(|rest| rest.starts_with('(')),
        "a name of the testbench's text has no value"
    );
    filled
}
