//! Hard cases: small maps and rays on which traversals go wrong, each with the hit that it must
//! have, in exact arithmetic.
//!
//! The corpus is `vectors/hard/`, a TOML file a case; `docs/formats.md` describes it. What a ray
//! must meet is written down in the file, and stands there by two routes that share nothing with a
//! traversal: `vectors/hard/oracle.py`, and [`crate::exact::exact_hit`], which a test holds against
//! it. [`PreparedCase`] walks a case and says what is right and what breaks a promise.

mod assess;
mod case_file;
mod family;
mod number;

pub use assess::{Assessment, PreparedCase, Promise};
pub use family::HardFamily;

use std::path::{Path, PathBuf};
use std::{fs, io};

use thiserror::Error;

use crate::exact::{ExactDepth, ExactError, ExactHit, exact_hit};
use crate::maps::HeightMap;
use crate::ray::Ray;

/// A case of the corpus.
#[derive(Clone, Debug)]
pub struct HardCase {
    /// What it is called, which is its file's name without the ending.
    pub name: String,
    /// What kind of difficulty it is.
    pub family: HardFamily,
    /// Why it is hard.
    pub why: String,
    /// Where it comes from: addresses of published threads, and what of them was read.
    pub source: String,
    /// The map.
    pub map: HeightMap,
    /// The rays, at least one.
    pub rays: Vec<HardRay>,
}

/// A ray, and what it must meet.
#[derive(Clone, Debug, PartialEq)]
pub struct HardRay {
    /// What is special about it; may be empty.
    pub note: String,
    /// The ray as it comes in: its entry may lie beyond the first repeat.
    pub ray: Ray<f64>,
    /// What it must meet.
    pub expected: ExpectedHit,
}

/// What a ray must meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExpectedHit {
    /// Texel on u, 0 to size - 1.
    pub i: u32,
    /// Texel on v, 0 to size - 1.
    pub j: u32,
    /// Numerator and denominator of the depth, in lowest terms, the denominator positive.
    pub depth: (i128, i128),
    /// Is it a hit on the texel's side? Else on its top.
    pub side: bool,
}

impl From<ExactHit> for ExpectedHit {
    fn from(hit: ExactHit) -> ExpectedHit {
        let ExactDepth {
            numerator,
            denominator,
        } = hit.t;
        let divisor = greatest_common_divisor(numerator, denominator);
        ExpectedHit {
            i: hit.i,
            j: hit.j,
            depth: (numerator / divisor, denominator / divisor),
            side: hit.side,
        }
    }
}

/// Of a depth's numerator and its denominator, which is positive.
fn greatest_common_divisor(numerator: i128, denominator: i128) -> i128 {
    let (mut larger, mut smaller) = (denominator, numerator);
    while smaller != 0 {
        (larger, smaller) = (smaller, larger % smaller);
    }
    larger
}

/// Why there is no corpus. Each message names the file, and what helps.
#[derive(Debug, Error)]
pub enum HardCaseError {
    /// No folder, or it cannot be read.
    #[error(
        "hard cases {folder}: cannot be read ({cause}); name the folder of the corpus, which is \
         vectors/hard in a checkout"
    )]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the operating system says.
        cause: io::Error,
    },
    /// A folder without a case.
    #[error("hard cases {folder}: no file NAME.toml is in it")]
    Empty {
        /// The folder.
        folder: PathBuf,
    },
    /// A file that cannot be read.
    #[error("hard case {file}: cannot be read ({cause})")]
    File {
        /// The file.
        file: PathBuf,
        /// What the operating system says.
        cause: io::Error,
    },
    /// A file that is no case.
    #[error("hard case {file}: {cause}")]
    Content {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        cause: String,
    },
}

impl HardCase {
    /// Reads a case.
    ///
    /// # Errors
    /// A file that cannot be read or is no case: an unknown key, a number that no `f64` holds
    /// exactly, a map that is none, no ray.
    pub fn load(path: &Path) -> Result<HardCase, HardCaseError> {
        let text = fs::read_to_string(path).map_err(|cause| HardCaseError::File {
            file: path.to_owned(),
            cause,
        })?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        case_file::read(&text, &name).map_err(|cause| HardCaseError::Content {
            file: path.to_owned(),
            cause,
        })
    }

    /// Reads every `NAME.toml` of a folder, in the order of their names.
    ///
    /// # Errors
    /// A folder that cannot be read or holds no case, and as [`HardCase::load`].
    pub fn load_folder(folder: &Path) -> Result<Vec<HardCase>, HardCaseError> {
        let problem = |cause| HardCaseError::Folder {
            folder: folder.to_owned(),
            cause,
        };
        let mut paths = Vec::new();
        for entry in fs::read_dir(folder).map_err(problem)? {
            let path = entry.map_err(problem)?.path();
            if path.extension().is_some_and(|ending| ending == "toml") {
                paths.push(path);
            }
        }
        if paths.is_empty() {
            return Err(HardCaseError::Empty {
                folder: folder.to_owned(),
            });
        }
        paths.sort();
        paths.iter().map(|path| HardCase::load(path)).collect()
    }
}

impl HardRay {
    /// What the ray meets in a map by the exact reference.
    ///
    /// # Errors
    /// As [`exact_hit`].
    pub fn met_in(&self, map: &HeightMap) -> Result<ExpectedHit, ExactError> {
        exact_hit(map, self.ray).map(ExpectedHit::from)
    }
}
