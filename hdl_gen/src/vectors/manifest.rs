//! The manifest beside the vector files.

use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::error::VectorError;
use super::field::{Field, FieldFormat, Role};
use super::set::VectorSet;

/// What `manifest.json` says.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// [`Manifest::SCHEMA`].
    pub schema: String,
    /// The tool that wrote the files, and its version.
    pub tool: String,
    /// The files, in the order in which they were made.
    pub files: Vec<ManifestFile>,
}

/// One file of vectors.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ManifestFile {
    /// The file, beside the manifest.
    pub file: String,
    /// What it holds, in a sentence.
    pub description: String,
    /// The module it is for.
    pub unit: String,
    /// The fingerprint of that module's netlist, as in reports of area.
    pub netlist_digest: String,
    /// The function of the golden model that gave the expected values.
    pub golden: String,
    /// The scene whose rays it holds.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub scene: Option<String>,
    /// The height map.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub map: Option<String>,
    /// The seed of what is random in it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub seed: Option<u64>,
    /// Vectors: lines of the file.
    pub vectors: u64,
    /// Bits of a vector.
    pub width: u32,
    /// The fields, the first at the most significant end.
    pub fields: Vec<ManifestField>,
    /// The SHA-256 of the file, 64 hexadecimal digits.
    pub sha256: String,
}

/// One field of a vector.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ManifestField {
    /// Its name.
    pub name: String,
    /// `input`, `output` or `memory`.
    pub role: Role,
    /// Its most significant bit in a vector.
    pub msb: u32,
    /// Its least significant bit in a vector.
    pub lsb: u32,
    /// Bits.
    pub width: u32,
    /// `float eXfY`, `signed`, `unsigned` or `bit`.
    pub format: FieldFormat,
    /// What it is.
    pub meaning: String,
}

impl Manifest {
    /// The name and version of its form.
    pub const SCHEMA: &'static str = "stepwell-vectors-1";
    /// The name of its file.
    pub const FILE: &'static str = "manifest.json";

    /// A manifest of no files, by this version of the tool.
    pub fn empty() -> Manifest {
        Manifest {
            schema: Manifest::SCHEMA.to_owned(),
            tool: concat!("stepwell ", env!("CARGO_PKG_VERSION")).to_owned(),
            files: Vec::new(),
        }
    }

    /// Reads the manifest of a folder.
    ///
    /// # Errors
    /// If there is none, or it is not of this form.
    pub fn read(folder: &Path) -> Result<Manifest, VectorError> {
        let path = folder.join(Manifest::FILE);
        let text = fs::read_to_string(&path).map_err(|problem| VectorError::Read {
            path: path.clone(),
            problem,
        })?;
        let invalid = |problem: String| VectorError::Manifest {
            path: path.clone(),
            problem,
        };
        let manifest: Manifest =
            serde_json::from_str(&text).map_err(|problem| invalid(problem.to_string()))?;
        if manifest.schema != Manifest::SCHEMA {
            return Err(invalid(format!(
                "its schema is `{}`, and `{}` is read here",
                manifest.schema,
                Manifest::SCHEMA
            )));
        }
        for file in &manifest.files {
            file.check_fields().map_err(invalid)?;
        }
        Ok(manifest)
    }

    /// The entry of a file.
    pub fn file(&self, name: &str) -> Option<&ManifestFile> {
        self.files.iter().find(|file| file.file == name)
    }

    /// Its text: JSON in lines, a newline at the end.
    pub(super) fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("text, numbers and lists");
        text.push('\n');
        text
    }
}

impl ManifestFile {
    /// Takes over what the vectors themselves say; the caller adds the rest.
    pub(super) fn describe(&mut self, set: &VectorSet, text: &str) {
        self.vectors = set.vectors.len() as u64;
        self.width = set.width();
        let places = set.fields.iter().zip(set.low_bits());
        self.fields = places
            .map(|(field, lsb)| ManifestField {
                name: field.name.clone(),
                role: field.role,
                msb: lsb + field.width - 1,
                lsb,
                width: field.width,
                format: field.format,
                meaning: field.meaning.clone(),
            })
            .collect();
        self.sha256 = sha256(text);
    }

    /// The fields of its vectors.
    pub fn set_fields(&self) -> Vec<Field> {
        let field = |field: &ManifestField| {
            Field::new(
                &field.name,
                field.role,
                field.width,
                field.format,
                &field.meaning,
            )
        };
        self.fields.iter().map(field).collect()
    }

    /// Reads the vectors from the folder the manifest stands in.
    ///
    /// # Errors
    /// If the file cannot be read, is not the one the digest was made of, or does not hold the
    /// vectors described.
    pub fn read(&self, folder: &Path) -> Result<VectorSet, VectorError> {
        let path = folder.join(&self.file);
        let text = fs::read_to_string(&path).map_err(|problem| VectorError::Read {
            path: path.clone(),
            problem,
        })?;
        let found = sha256(&text);
        let invalid = |problem: String| VectorError::File {
            path: path.clone(),
            problem,
        };
        if found != self.sha256 {
            return Err(invalid(format!(
                "its SHA-256 is {found}, and the manifest says {}",
                self.sha256
            )));
        }
        let set = VectorSet::from_hex(self.set_fields(), &text).map_err(invalid)?;
        if set.vectors.len() as u64 != self.vectors {
            return Err(invalid(format!(
                "{} vectors, and the manifest says {}",
                set.vectors.len(),
                self.vectors
            )));
        }
        Ok(set)
    }

    /// Do the fields lie side by side and fill a vector?
    fn check_fields(&self) -> Result<(), String> {
        let mut above = self.width;
        for field in &self.fields {
            let fits = (1..=64).contains(&field.width)
                && field.msb.checked_add(1) == Some(above)
                && field.lsb.checked_add(field.width) == Some(above);
            if !fits {
                return Err(format!(
                    "{}: field `{}` is not the {} bits below bit {above}",
                    self.file, field.name, field.width
                ));
            }
            above = field.lsb;
        }
        if above != 0 {
            return Err(format!(
                "{}: no field has its lowest {above} bits",
                self.file
            ));
        }
        Ok(())
    }
}

/// 64 hexadecimal digits.
pub(crate) fn sha256(text: &str) -> String {
    let digest = Sha256::digest(text);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
