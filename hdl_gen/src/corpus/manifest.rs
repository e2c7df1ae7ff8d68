//! The manifest of a corpus.

use serde::{Deserialize, Serialize};

/// What `manifest.json` says.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CorpusManifest {
    /// [`CorpusManifest::SCHEMA`].
    pub schema: String,
    /// The tool that wrote the files, and its version.
    pub tool: String,
    /// The seed of what is random in them.
    pub seed: u64,
    /// The files, in the order in which they were made.
    pub files: Vec<CorpusFile>,
}

/// One file: the vectors of an operator under one rounding and policy.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CorpusFile {
    /// The file, beside the manifest.
    pub file: String,
    /// The operator, by its name on the command line.
    pub operator: String,
    /// The format of the arithmetic.
    pub format: String,
    /// `rne`, `rtz`, `rup` or `rdn`; of an operator that does not round, the first of these.
    pub rounding: String,
    /// Would another rounding give other results?
    pub rounds: bool,
    /// `flush` or `full`.
    pub policy: String,
    /// The words of a line: operands `a`, `b`, `c` as far as there are such, `result`, `flags`.
    pub columns: Vec<CorpusColumn>,
    /// Lines.
    pub lines: u64,
    /// The SHA-256 of the file, 64 hexadecimal digits.
    pub sha256: String,
}

/// A word of each line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CorpusColumn {
    /// Its name.
    pub name: String,
    /// `eXfY`, `iN`, `uN`, `truth` or `flags`.
    pub format: String,
    /// Its bits; it has a hexadecimal digit for every four.
    pub width: u32,
}

impl CorpusManifest {
    /// The name and version of its form.
    pub const SCHEMA: &'static str = "stepwell-corpus-1";
    /// Its file.
    pub const FILE: &'static str = "manifest.json";
}
