//! A SAT solver that reads DIMACS: CaDiCaL, or z3 where there is none.

use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use thiserror::Error;

/// Why a solver gave no answer.
#[derive(Debug, Error)]
pub enum SolverError {
    /// None is installed.
    #[error(
        "no SAT solver was found: install CaDiCaL (`make tools`, or `apt-get install cadical`) or \
         z3, or set STEPWELL_SAT to a program that reads DIMACS and answers as they do"
    )]
    NotFound,
    /// It could not be run or its answer makes no sense.
    #[error("the SAT solver {solver} failed: {problem}")]
    Failed {
        /// The program.
        solver: String,
        /// What is wrong.
        problem: String,
    },
}

/// What a solver says of clauses.
#[derive(Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing satisfies them.
    Unsatisfiable,
    /// These literals do; a variable that is not named may be either.
    Satisfiable(Vec<i64>),
    /// It gave up within the time allowed.
    Undecided,
}

/// An installed solver.
#[derive(Clone, Debug)]
pub struct Solver {
    program: PathBuf,
    arguments: Vec<OsString>,
    /// Its name and version.
    pub version: String,
}

impl Solver {
    /// Looks for one: `STEPWELL_SAT`, `cadical`, `z3`. `seconds` is the time allowed for a question.
    ///
    /// # Errors
    /// If there is none.
    pub fn find(seconds: u64) -> Result<Solver, SolverError> {
        let own = std::env::var_os("STEPWELL_SAT").map(PathBuf::from);
        let candidates = match own {
            Some(program) => vec![program],
            None => vec![PathBuf::from("cadical"), PathBuf::from("z3")],
        };
        for program in candidates {
            let Ok(output) = Command::new(&program).arg("--version").output() else {
                continue;
            };
            let name = program.file_name().unwrap_or_default().to_string_lossy();
            let arguments: Vec<OsString> = match &*name {
                "z3" => vec![
                    "-dimacs".into(),
                    format!("-T:{seconds}").into(),
                    "-in".into(),
                ],
                "cadical" => vec!["-q".into(), "-t".into(), seconds.to_string().into()],
                _ => Vec::new(),
            };
            let printed = String::from_utf8_lossy(&output.stdout).trim().to_owned();
            let version = match printed.to_lowercase().contains(&*name) {
                true => printed,
                false => format!("{name} {printed}"),
            };
            return Ok(Solver {
                program,
                arguments,
                version,
            });
        }
        Err(SolverError::NotFound)
    }

    /// Asks it.
    ///
    /// # Errors
    /// If it cannot be run, or says neither yes, no nor that it does not know.
    pub fn solve(&self, clauses: &str) -> Result<Verdict, SolverError> {
        let failed = |problem: String| SolverError::Failed {
            solver: self.program.display().to_string(),
            problem,
        };
        let mut child = Command::new(&self.program)
            .args(&self.arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|problem| failed(problem.to_string()))?;
        let mut input = child.stdin.take().expect("a piped standard input");
        // A solver that hangs up early says so by its answer.
        let _ = input.write_all(clauses.as_bytes());
        drop(input);
        let output = child
            .wait_with_output()
            .map_err(|problem| failed(problem.to_string()))?;
        let text = String::from_utf8_lossy(&output.stdout);
        verdict(&text).ok_or_else(|| failed(format!("it ended with {}", output.status)))
    }
}

/// Reads a solver's answer.
fn verdict(text: &str) -> Option<Verdict> {
    let mut answer = None;
    let mut literals = Vec::new();
    for line in text.lines() {
        match line.split_once(' ').unwrap_or((line, "")) {
            ("s", said) => answer = Some(said.trim().to_owned()),
            ("v", values) => {
                let values = values.split_whitespace().map(str::parse::<i64>);
                literals.extend(values.filter_map(Result::ok).filter(|&value| value != 0));
            }
            ("unknown" | "timeout" | "c", _) if answer.is_none() => {
                answer = Some("UNKNOWN".to_owned());
            }
            _ => {}
        }
    }
    match answer.as_deref() {
        Some("UNSATISFIABLE") => Some(Verdict::Unsatisfiable),
        Some("SATISFIABLE") => Some(Verdict::Satisfiable(literals)),
        Some("UNKNOWN") => Some(Verdict::Undecided),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_read() {
        assert_eq!(verdict("s UNSATISFIABLE\n"), Some(Verdict::Unsatisfiable));
        let model = verdict("s SATISFIABLE\nv -1 2\nv 3 0\n");
        assert_eq!(model, Some(Verdict::Satisfiable(vec![-1, 2, 3])));
        assert_eq!(verdict("c UNKNOWN\n"), Some(Verdict::Undecided));
        assert_eq!(verdict("Segmentation fault\n"), None);
        assert_eq!(verdict(""), None);
    }
}
