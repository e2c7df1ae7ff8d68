//! Reads a VCD: its header as flat tables, then its value changes one by one.
//!
//! The header is read command by command, not by the parser's own recursion, so that a file of
//! nothing but opened scopes cannot exhaust the stack.

use super::WaveError;
use super::signal::{MAX_SCOPE_DEPTH, joined};
use std::io::{BufRead, ErrorKind};
use vcd::{Command, IdCode, ParseError, Parser, ReferenceIndex, TimescaleUnit, VarType};

/// The widest variable that is read: a guard against a damaged width, not a limit of VCD.
const MAX_WIDTH: u32 = 1 << 20;

/// A variable as the header declares it.
#[derive(Clone, Debug)]
pub(crate) struct Variable {
    /// Its place in [`Header::scopes`].
    pub scope: usize,
    pub name: String,
    /// Bits.
    pub width: u32,
    pub kind: VarType,
    /// What its changes are marked with; variables that are one net share it.
    pub code: IdCode,
}

impl Variable {
    /// Does it hold bits? Reals, texts and constants do not take part in a comparison.
    pub(crate) fn is_bits(&self) -> bool {
        !matches!(
            self.kind,
            VarType::Real | VarType::Event | VarType::String | VarType::Parameter
        )
    }
}

/// A VCD header.
#[derive(Clone, Debug, Default)]
pub(crate) struct Header {
    /// The paths of all scopes; the first is the root, which is empty.
    pub scopes: Vec<Vec<String>>,
    pub variables: Vec<Variable>,
    pub comments: Vec<String>,
    /// What a time counts, in femtoseconds. A file that does not say counts ns.
    pub time_unit_fs: u128,
}

impl Header {
    /// The scopes and the name of a variable, with points between.
    pub(crate) fn full_name(&self, variable: &Variable) -> String {
        joined(&self.scopes[variable.scope], &variable.name)
    }

    /// The names of the outermost scopes.
    pub(crate) fn top_scopes(&self) -> Vec<String> {
        let tops = self.scopes.iter().filter(|scope| scope.len() == 1);
        tops.map(|scope| scope[0].clone()).collect()
    }
}

/// A VCD being read; the header is behind it.
pub(crate) struct Reader<R> {
    /// The file, for messages.
    pub name: String,
    pub header: Header,
    parser: Parser<R>,
}

impl<R: BufRead> Reader<R> {
    /// Reads the header.
    pub(crate) fn open(name: &str, input: R) -> Result<Reader<R>, WaveError> {
        let mut reader = Reader {
            name: name.to_owned(),
            header: Header {
                scopes: vec![Vec::new()],
                time_unit_fs: 1_000_000,
                ..Header::default()
            },
            parser: Parser::new(input),
        };
        let mut open_scopes = vec![0];
        loop {
            let Some(command) = reader.next_command()? else {
                return Err(WaveError::Truncated {
                    name: reader.name,
                    line: reader.parser.line(),
                });
            };
            if command == Command::Enddefinitions {
                return if open_scopes.len() == 1 {
                    Ok(reader)
                } else {
                    Err(reader.syntax("the header ends with scopes open"))
                };
            }
            if let Err(reason) = reader.header.take(command, &mut open_scopes) {
                return Err(reader.syntax(reason));
            }
        }
    }

    /// The next command, or None at the end of the file.
    pub(crate) fn next_command(&mut self) -> Result<Option<Command>, WaveError> {
        self.parser.next().transpose().map_err(|source| {
            let name = self.name.clone();
            let parse_error = source
                .get_ref()
                .and_then(|inner| inner.downcast_ref::<ParseError>());
            match (parse_error, source.kind()) {
                (Some(error), _) => WaveError::Syntax {
                    name,
                    line: error.line(),
                    reason: error.kind().to_string(),
                },
                (None, ErrorKind::UnexpectedEof) => WaveError::Truncated {
                    name,
                    line: self.parser.line(),
                },
                _ => WaveError::Read { name, source },
            }
        })
    }

    /// An error at the present line.
    pub(crate) fn syntax(&self, reason: impl Into<String>) -> WaveError {
        WaveError::Syntax {
            name: self.name.clone(),
            line: self.parser.line(),
            reason: reason.into(),
        }
    }
}

impl Header {
    /// Takes in one declaration.
    fn take(&mut self, command: Command, open_scopes: &mut Vec<usize>) -> Result<(), String> {
        // The root is never closed, so there always is an innermost scope.
        let innermost = open_scopes.last().copied().unwrap_or(0);
        match command {
            Command::ScopeDef(_, name) => {
                if open_scopes.len() > MAX_SCOPE_DEPTH {
                    return Err(format!("scopes nested more than {MAX_SCOPE_DEPTH} deep"));
                }
                let mut path = self.scopes[innermost].clone();
                path.push(name);
                self.scopes.push(path);
                open_scopes.push(self.scopes.len() - 1);
            }
            Command::Upscope if open_scopes.len() > 1 => {
                open_scopes.pop();
            }
            Command::Upscope => return Err("$upscope with no scope open".to_owned()),
            Command::VarDef(kind, width, code, name, index) => {
                // One bit of a vector that the simulator split: its index is part of its name.
                let name = match index {
                    Some(ReferenceIndex::BitSelect(bit)) if width == 1 => format!("{name}[{bit}]"),
                    _ => name,
                };
                let variable = Variable {
                    scope: innermost,
                    name,
                    width,
                    kind,
                    code,
                };
                if variable.is_bits() && !(1..=MAX_WIDTH).contains(&width) {
                    return Err(format!("`{}` is {width} bits wide", variable.name));
                }
                self.variables.push(variable);
            }
            Command::Comment(text) => self.comments.push(text),
            Command::Timescale(count, unit) => {
                if count == 0 {
                    return Err("a timescale of 0".to_owned());
                }
                self.time_unit_fs = u128::from(count) * femtoseconds(unit);
            }
            Command::Date(_) | Command::Version(_) => {}
            _ => return Err("a value or a time before $enddefinitions".to_owned()),
        }
        Ok(())
    }
}

fn femtoseconds(unit: TimescaleUnit) -> u128 {
    match unit {
        TimescaleUnit::S => 1_000_000_000_000_000,
        TimescaleUnit::MS => 1_000_000_000_000,
        TimescaleUnit::US => 1_000_000_000,
        TimescaleUnit::NS => 1_000_000,
        TimescaleUnit::PS => 1_000,
        TimescaleUnit::FS => 1,
    }
}
