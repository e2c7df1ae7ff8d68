//! Area and speed of a module, measured by synthesis, placement and routing.
//!
//! [`measure`] takes the very netlist that simulation verified ([`crate::digest`] tells them
//! apart), emits its Verilog, and has three targets built of it:
//!
//! - Lattice ECP5, placed and routed by nextpnr with several seeds ([`Ecp5`]), the module standing
//!   between two layers of registers on each side, which count for nothing;
//! - Xilinx 7 series, as far as synthesis goes ([`Xilinx`]);
//! - standard cells, by abc ([`Gates`]), the module alone.
//!
//! Figures compare only at one version of the tools ([`Versions`]), so the project pins them.

mod cached;
mod ecp5;
mod gates;
mod liberty;
mod mapped;
mod pads;
mod tools;
mod wrapper;
mod xilinx;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::emit::{EmitError, write_design};
use crate::netlist::Module;

pub use ecp5::Ecp5;
pub use gates::Gates;
pub use tools::{Tools, Versions};
pub use wrapper::between_registers;
pub use xilinx::Xilinx;

/// Why a module was not measured.
#[derive(Debug, Error)]
pub enum AreaError {
    /// A tool is not there.
    #[error(
        "not found: {what}. Run `make tools` in the project's folder, which installs what is \
         missing, or let {variable} name it"
    )]
    Missing {
        /// A program or a file.
        what: String,
        /// The variable that may name one.
        variable: &'static str,
    },
    /// A tool does not start, or ended with an error.
    #[error("{tool} failed; if `make tools` does not mend it, it said:\n{output}")]
    Failed {
        /// Its path.
        tool: String,
        /// The end of what it said.
        output: String,
    },
    /// A tool was ended after its time limit.
    #[error(
        "{tool} took more than {minutes} minutes and was ended: give it more with --time-limit, or \
         measure with the machine less busy. What was measured before it is kept"
    )]
    TooLong {
        /// Its path.
        tool: String,
        /// The limit.
        minutes: u64,
    },
    /// A tool gave something else than it must.
    #[error("{tool} gave what is not understood ({what}): run `make tools` for the pinned version")]
    Unreadable {
        /// Its name.
        tool: &'static str,
        /// What is wrong.
        what: String,
    },
    /// A file could not be written.
    #[error("{}: cannot be written ({problem})", path.display())]
    Write {
        /// Which.
        path: PathBuf,
        /// Why.
        problem: io::Error,
    },
    /// A file that a tool should have written could not be read.
    #[error("{}: cannot be read ({problem})", path.display())]
    Read {
        /// Which.
        path: PathBuf,
        /// Why.
        problem: io::Error,
    },
    /// The Verilog could not be emitted.
    #[error(transparent)]
    Emit(#[from] EmitError),
}

/// How a module is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flow {
    /// Placements on the ECP5, with seeds from 1 on; at least 1.
    pub seeds: u32,
    /// Leaves out Yosys's `-nowidelut`: functions of up to seven inputs may be built of
    /// multiplexers, as it does unless told. Such logic takes more look-up tables.
    pub wide_luts: bool,
    /// Multiplies in look-up tables: no hard multiplier is used, on either device.
    pub no_dsp: bool,
}

impl Flow {
    /// The median of three seeds, `-nowidelut`.
    pub const DEFAULT: Flow = Flow {
        seeds: 3,
        wide_luts: false,
        no_dsp: false,
    };

    /// How many steps a measurement takes: what [`measure`] tells of.
    pub fn steps(self) -> u64 {
        u64::from(self.seeds) + 3
    }
}

/// What a module takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// On a Lattice ECP5.
    pub ecp5: Ecp5,
    /// On a Xilinx 7 series device.
    pub xilinx: Xilinx,
    /// In standard cells.
    pub gates: Gates,
}

/// Measures a module; `step` is called after each of [`Flow::steps`], from any thread. A module
/// that was measured before, in this way and with these tools, is not measured again: its figures
/// come from the cache.
///
/// # Errors
/// If a tool fails, or gives what is not understood.
pub fn measure(
    module: &Arc<Module>,
    flow: Flow,
    tools: &Tools,
    step: &(dyn Fn() + Sync),
) -> Result<Figures, AreaError> {
    let folder = scratch()?;
    let folder = folder.path();
    let sources = write_design(&between_registers(module), folder)?;
    let key = cached::key(&sources, flow, tools)?;
    if let Some(figures) = cached::figures(&key) {
        (0..flow.steps()).for_each(|_| step());
        return Ok(figures);
    }
    let figures = measure_anew(module, flow, tools, step)?;
    cached::keep(&key, &figures);
    Ok(figures)
}

/// [`measure`] without the cache.
///
/// # Errors
/// If a tool fails, or gives what is not understood.
pub fn measure_anew(
    module: &Arc<Module>,
    flow: Flow,
    tools: &Tools,
    step: &(dyn Fn() + Sync),
) -> Result<Figures, AreaError> {
    let folder = scratch()?;
    let folder = folder.path();
    let wrapper = between_registers(module);
    let sources = write_design(&wrapper, folder)?;
    let core_sources = names(&sources[..sources.len() - 1]);
    let sources = names(&sources);
    let synthesised = ecp5::synthesise(tools, folder, &sources, &wrapper.name, flow)?;
    step();
    let answers = in_parallel(flow.steps() as usize - 1, |job| {
        let answer = match job {
            0 => Answer::Xilinx(xilinx::synthesise(
                tools,
                folder,
                &sources,
                &wrapper.name,
                flow,
            )?),
            1 => Answer::Gates(gates::synthesise(
                tools,
                folder,
                &core_sources,
                &module.name,
            )?),
            seed => Answer::Placed(ecp5::place(tools, folder, seed as u64 - 1)?),
        };
        step();
        Ok(answer)
    })?;
    let (mut xilinx, mut gates, mut placed) = (None, None, Vec::new());
    for answer in answers {
        match answer {
            Answer::Xilinx(answer) => xilinx = Some(answer),
            Answer::Gates(answer) => gates = Some(answer),
            Answer::Placed(answer) => placed.push(answer),
        }
    }
    let (Some(xilinx), Some(gates)) = (xilinx, gates) else {
        unreachable!("every job has answered");
    };
    Ok(Figures {
        ecp5: ecp5::summary(&synthesised, &placed),
        xilinx,
        gates,
    })
}

/// A folder that is gone when it goes out of scope.
fn scratch() -> Result<tempfile::TempDir, AreaError> {
    let builder = tempfile::Builder::new().prefix("stepwell-area-").tempdir();
    builder.map_err(|problem| AreaError::Write {
        path: std::env::temp_dir(),
        problem,
    })
}

/// What a job came to.
enum Answer {
    Xilinx(Xilinx),
    Gates(Gates),
    Placed(ecp5::Placed),
}

/// The files' names, which are module names and need no quotes.
fn names(paths: &[PathBuf]) -> String {
    let names = paths.iter().filter_map(|path| path.file_name());
    let names: Vec<_> = names.map(|name| name.to_string_lossy()).collect();
    names.join(" ")
}

/// Does jobs 0 to `count - 1`, as many at a time as there are processors, and answers in their
/// order; after a failure no other is begun.
fn in_parallel<T: Send>(
    count: usize,
    job: impl Fn(usize) -> Result<T, AreaError> + Sync,
) -> Result<Vec<T>, AreaError> {
    let next = AtomicUsize::new(0);
    let answers: Mutex<Vec<(usize, Result<T, AreaError>)>> = Mutex::default();
    let workers = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for _ in 0..workers.min(count) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    if index >= count {
                        return;
                    }
                    let answer = job(index);
                    if answer.is_err() {
                        next.store(count, Ordering::Relaxed);
                    }
                    let mut answers = answers.lock().unwrap_or_else(|poison| poison.into_inner());
                    answers.push((index, answer));
                }
            });
        }
    });
    let mut answers = answers
        .into_inner()
        .unwrap_or_else(|poison| poison.into_inner());
    answers.sort_by_key(|(index, _)| *index);
    answers.into_iter().map(|(_, answer)| answer).collect()
}

fn read(path: &Path) -> Result<String, AreaError> {
    fs::read_to_string(path).map_err(|problem| AreaError::Read {
        path: path.to_owned(),
        problem,
    })
}

fn write(path: &Path, text: &str) -> Result<(), AreaError> {
    fs::write(path, text).map_err(|problem| AreaError::Write {
        path: path.to_owned(),
        problem,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_answer_in_order_and_a_failure_is_told() {
        let squares = in_parallel(20, |job| Ok(job * job)).unwrap();
        assert_eq!(squares, (0..20).map(|job| job * job).collect::<Vec<_>>());
        let failure = in_parallel(20, |job| match job {
            7 => Err(AreaError::Missing {
                what: "seven".to_owned(),
                variable: "SEVEN",
            }),
            _ => Ok(job),
        });
        assert!(failure.unwrap_err().to_string().contains("make tools"));
    }
}
