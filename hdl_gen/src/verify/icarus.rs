//! Icarus Verilog as the second opinion: the emitted Verilog and its plain testbench, run by a
//! simulator that shares nothing with the others.
//!
//! It is thousands of times slower than a compiled model, and knows unknown values: a register
//! that nobody set shows.

use super::divergence::{Comparison, Divergence};
use super::embedded::DIVERGENT_CYCLES;
use super::golden::{GoldenRun, History};
use super::waveform::{conform_window, waveform_signals};
use crate::emit::{EmitError, write_design};
use crate::netlist::Module;
use crate::testbench::{TraverseBench, Verdict, stream_testbench, traverse_testbench};
use crate::units::TraverseUnit;
use crate::vectors::{RayVectors, VectorSet, ray_vectors};
use crate::wave::{ConformOptions, CycleNumbers, LogicWord, Samples, WaveError, WriterOptions};
use std::fs::{self, File};
use std::io::{self, BufReader};
use std::ops::{ControlFlow, RangeInclusive};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use thiserror::Error;

/// Why Icarus Verilog could not be used.
#[derive(Debug, Error)]
pub enum IcarusError {
    /// One of its two programs is not installed.
    #[error(
        "{tool} was not found: install Icarus Verilog (`make tools`, or `apt-get install \
         iverilog`), or use --sim embedded, which needs no tool"
    )]
    NotFound {
        /// `iverilog` or `vvp`.
        tool: &'static str,
    },
    /// A folder or file could not be written.
    #[error("{}: cannot be written ({problem})", path.display())]
    Write {
        /// What could not be written.
        path: PathBuf,
        /// Why.
        problem: io::Error,
    },
    /// The Verilog could not be emitted.
    #[error(transparent)]
    Emit(#[from] EmitError),
    /// A program refused its input or ended with an error.
    #[error("{tool} failed on the emitted design:\n{output}")]
    Failed {
        /// `iverilog` or `vvp`.
        tool: &'static str,
        /// What it printed.
        output: String,
    },
    /// The testbench ended without a verdict.
    #[error("the testbench printed neither PASS nor FAIL:\n{output}")]
    NoVerdict {
        /// What was printed.
        output: String,
    },
    /// The waveform could not be read.
    #[error(transparent)]
    Wave(#[from] WaveError),
    /// The waveform ends before the golden run does, with nothing different in it.
    #[error(
        "the waveform ends after {found} cycles, the golden run after {expected}; the testbench \
         said: {verdict}"
    )]
    ShortWaveform {
        /// Cycles in the waveform.
        found: u64,
        /// Cycles of the golden run.
        expected: u64,
        /// The testbench's last line.
        verdict: String,
    },
    /// Every signal agreed in every cycle, and the testbench did not pass: one of the two is wrong.
    #[error("all signals agree, and still the testbench said: {verdict}")]
    Contradiction {
        /// The testbench's last line.
        verdict: String,
    },
}

/// An installed Icarus Verilog.
#[derive(Clone, Debug)]
pub struct Icarus {
    /// The first line of `iverilog -V`; empty where it prints none.
    pub version: String,
}

impl Icarus {
    /// Looks for `iverilog` and `vvp` on the `PATH`.
    ///
    /// # Errors
    /// The one that is missing.
    pub fn find() -> Result<Icarus, IcarusError> {
        let said = |tool: &'static str| match Command::new(program(tool)).arg("-V").output() {
            Ok(output) => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
            Err(_) => Err(IcarusError::NotFound { tool }),
        };
        let said_by_compiler = said("iverilog")?;
        said("vvp")?;
        Ok(Icarus {
            version: said_by_compiler.lines().next().unwrap_or("").to_owned(),
        })
    }

    /// Sends vectors through a unit with the handshakes of [`crate::operators::stream_unit`], by
    /// its testbench.
    ///
    /// # Errors
    /// If the design cannot be emitted, compiled or run. A wrong result is none: the verdict says
    /// so.
    pub fn run_vectors(&self, unit: &Arc<Module>, set: &VectorSet) -> Result<Verdict, IcarusError> {
        let folder = temporary_folder()?;
        write(folder.path(), "vectors.hex", &set.to_hex())?;
        let bench = stream_testbench(unit, set, "vectors.hex");
        self.run(folder.path(), unit, &bench, None)
    }

    /// Sends rays through the traverse unit and holds its hits against the expected ones, by its
    /// testbench.
    ///
    /// # Errors
    /// If the design cannot be emitted, compiled or run. A wrong hit is none: the verdict says so.
    pub fn run_rays(
        &self,
        unit: &TraverseUnit,
        vectors: &RayVectors,
        bench: &TraverseBench,
    ) -> Result<Verdict, IcarusError> {
        let folder = temporary_folder()?;
        self.run_bench(folder.path(), unit, vectors, bench, None)
    }

    /// Sends the rays of a golden run through the traverse unit, by its testbench, and compares
    /// every probe in every cycle with the golden machine's.
    ///
    /// An unknown value counts as a difference; in the list of differences its unknown bits are
    /// those that were not expected.
    ///
    /// # Errors
    /// If the design cannot be emitted, compiled or run, or its waveform not read; if the waveform
    /// agrees and the testbench, which looks at the hits alone, does not.
    pub fn run_traverse(
        &self,
        unit: &TraverseUnit,
        run: &GoldenRun<'_>,
    ) -> Result<Comparison, IcarusError> {
        let recorded = self.record(unit, run)?;
        let comparison = compare(unit, run, recorded.waveform()?)?;
        let all_agree = comparison.mismatches == 0;
        if all_agree && comparison.cycles < recorded.golden_cycles {
            return Err(IcarusError::ShortWaveform {
                found: comparison.cycles,
                expected: recorded.golden_cycles,
                verdict: recorded.verdict.line,
            });
        }
        if all_agree && !recorded.verdict.passed {
            return Err(IcarusError::Contradiction {
                verdict: recorded.verdict.line,
            });
        }
        Ok(comparison)
    }

    /// Runs the traverse unit as [`Icarus::run_traverse`] does and writes a window of its waveform
    /// as [`super::golden_waveform`] writes the golden one: the same signals, hierarchy and times.
    /// Returns the output and the cycles written.
    ///
    /// # Errors
    /// If the design cannot be emitted, compiled or run, or a waveform not be read or written.
    pub fn waveform<W: io::Write>(
        &self,
        unit: &TraverseUnit,
        run: &GoldenRun<'_>,
        window: RangeInclusive<u64>,
        output: W,
    ) -> Result<(W, u64), IcarusError> {
        let recorded = self.record(unit, run)?;
        let options = conform_options();
        Ok(conform_window(
            unit,
            recorded.waveform()?,
            &options,
            window,
            output,
        )?)
    }

    /// Runs the traverse unit by its testbench and records its waveform.
    fn record(&self, unit: &TraverseUnit, run: &GoldenRun<'_>) -> Result<Recorded, IcarusError> {
        let format = unit.configuration.format;
        let vectors = ray_vectors(unit, run.pyramid, run.rays);
        let golden_cycles = run.run(format, |_, _, _| ControlFlow::Continue(()));
        let bench = TraverseBench {
            rays: run.rays.len(),
            stalls: run.stalls,
            // A sound unit needs no more than the golden machine; what hangs should not do so for
            // long.
            watchdog: golden_cycles + 64,
        };
        let folder = temporary_folder()?;
        let verdict = self.run_bench(folder.path(), unit, &vectors, &bench, Some(VCD))?;
        Ok(Recorded {
            folder,
            verdict,
            golden_cycles,
        })
    }

    /// The traverse unit's testbench, with these files beside it.
    fn run_bench(
        &self,
        folder: &Path,
        unit: &TraverseUnit,
        vectors: &RayVectors,
        bench: &TraverseBench,
        vcd: Option<&str>,
    ) -> Result<Verdict, IcarusError> {
        for (name, set) in [
            ("rays.hex", &vectors.rays),
            ("hits.hex", &vectors.hits),
            ("heights.hex", &vectors.heights),
        ] {
            write(folder, name, &set.to_hex())?;
        }
        let bench = traverse_testbench(unit, bench);
        self.run(folder, &unit.design, &bench, vcd)
    }

    /// Compiles a design with its testbench in a folder and runs it there.
    fn run(
        &self,
        folder: &Path,
        design: &Arc<Module>,
        bench: &str,
        vcd: Option<&str>,
    ) -> Result<Verdict, IcarusError> {
        let mut sources = write_design(design, folder)?;
        sources.push(write(folder, "testbench.v", bench)?);
        let compiled = "testbench.vvp";
        let mut compiler = Command::new(program("iverilog"));
        compiler.args(["-g2005", "-Wall", "-o", compiled]);
        printed("iverilog", compiler.args(&sources).current_dir(folder))?;
        let mut simulator = Command::new(program("vvp"));
        simulator.args(["-n", compiled]).current_dir(folder);
        if let Some(vcd) = vcd {
            simulator.arg(format!("+vcd={vcd}"));
        }
        let output = printed("vvp", &mut simulator)?;
        Verdict::read(&output).ok_or(IcarusError::NoVerdict { output })
    }
}

/// The waveform in the folder of a run.
const VCD: &str = "traverse.vcd";

/// What the testbench's instances stand in.
const TESTBENCH: &str = "testbench_traverse";

/// A run of the traverse unit.
struct Recorded {
    folder: tempfile::TempDir,
    verdict: Verdict,
    golden_cycles: u64,
}

impl Recorded {
    fn waveform(&self) -> Result<BufReader<File>, WaveError> {
        let path = self.folder.path().join(VCD);
        match File::open(&path) {
            Ok(file) => Ok(BufReader::new(file)),
            Err(source) => Err(WaveError::Read {
                name: path.display().to_string(),
                source,
            }),
        }
    }
}

/// Where the testbench has the unit; cycle 0 begins with the first edge it records.
fn conform_options() -> ConformOptions {
    ConformOptions {
        name: VCD.to_owned(),
        strip: TESTBENCH.to_owned(),
        rename: Vec::new(),
        clock: format!("{TESTBENCH}.traverse.clk_i"),
        reset: Some(format!("{TESTBENCH}.traverse.rst_ni")),
        cycles: CycleNumbers::FromFirstEdge(0),
        writer: WriterOptions::default(),
    }
}

/// Holds the waveform of the testbench against the golden machine, cycle by cycle as it is read.
fn compare(
    unit: &TraverseUnit,
    run: &GoldenRun<'_>,
    waveform: impl io::BufRead,
) -> Result<Comparison, WaveError> {
    let declarations = waveform_signals(unit);
    // The probes are declared last, after the inputs.
    let declarations = &declarations[declarations.len() - unit.probes.len()..];
    let mut samples = Samples::open(waveform, declarations, &conform_options())?;
    let mut history = History::new(unit.latency.step);
    let mut comparison = Comparison {
        signals_compared: unit.probes.len() as u64,
        ..Comparison::default()
    };
    let mut divergent_cycles = 0;
    let mut problem = None;
    run.run(unit.configuration.format, |inputs, outputs, words| {
        history.push(&words.0);
        match samples.next_cycle() {
            // A cycle left out would shift all that follow.
            Ok(Some(cycle)) if cycle == comparison.cycles => {}
            Ok(_) => return ControlFlow::Break(()),
            Err(error) => {
                problem = Some(error);
                return ControlFlow::Break(());
            }
        }
        let mut differs = 0;
        for (probe, &value) in unit.probes.iter().zip(samples.values()) {
            let expected = history.expected(probe);
            if value == LogicWord::known(expected) {
                continue;
            }
            differs += 1;
            if divergent_cycles == 0 {
                comparison.first.push(Divergence {
                    cycle: comparison.cycles,
                    unit: probe.scope.join("."),
                    signal: probe.name.clone(),
                    expected,
                    found: value.value & !value.unknown | !expected & value.unknown,
                });
            }
        }
        comparison.mismatches += differs;
        comparison.cycles += 1;
        comparison.cycles_compared += 1;
        if outputs.hit_valid && inputs.hit_ready {
            comparison.rays += 1;
            comparison.guards += u64::from(outputs.hit_guard);
        }
        divergent_cycles += u64::from(differs > 0);
        if divergent_cycles >= DIVERGENT_CYCLES {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    });
    problem.map_or(Ok(comparison), Err)
}

/// The program behind a tool's name: the compiler is looked for where `STEPWELL_IVERILOG` points,
/// if that is set.
fn program(tool: &str) -> PathBuf {
    let chosen = match tool {
        "iverilog" => std::env::var_os("STEPWELL_IVERILOG"),
        _ => None,
    };
    chosen.map_or_else(|| PathBuf::from(tool), PathBuf::from)
}

fn temporary_folder() -> Result<tempfile::TempDir, IcarusError> {
    tempfile::tempdir().map_err(|problem| IcarusError::Write {
        path: std::env::temp_dir(),
        problem,
    })
}

fn write(folder: &Path, name: &str, text: &str) -> Result<PathBuf, IcarusError> {
    let path = folder.join(name);
    match fs::write(&path, text) {
        Ok(()) => Ok(path),
        Err(problem) => Err(IcarusError::Write { path, problem }),
    }
}

/// What a program prints on its standard output; an error if it prints any on the other one.
fn printed(tool: &'static str, command: &mut Command) -> Result<String, IcarusError> {
    let output = command
        .output()
        .map_err(|_| IcarusError::NotFound { tool })?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        return Ok(text);
    }
    let output = text + &String::from_utf8_lossy(&output.stderr);
    Err(IcarusError::Failed { tool, output })
}
