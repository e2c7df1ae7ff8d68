//! Compares two waveforms and prints the first divergence:
//!
//! ```text
//! cargo run -p hdl_gen --example compare_waveforms -- golden.vcd other.vcd
//! ```
//!
//! Exit codes: 0 they agree, 1 they disagree, 2 they could not be compared.

use hdl_gen::wave::{DiffOptions, diff_files};
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [golden, other] = arguments.as_slice() else {
        eprintln!("give two files: compare_waveforms GOLDEN.vcd OTHER.vcd");
        return ExitCode::from(2);
    };
    match diff_files(Path::new(golden), Path::new(other), &DiffOptions::default()) {
        Ok(report) => {
            print!("{report}");
            ExitCode::from(u8::from(!report.agreed))
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}
