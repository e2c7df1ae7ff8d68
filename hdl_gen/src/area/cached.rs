//! Figures that were measured before.

use std::fs;
use std::path::PathBuf;

use sha2::{Digest, Sha256};

use super::tools::Tools;
use super::{AreaError, Figures, Flow, read};
use crate::cache;

/// Changes whenever the scripts, or what is counted, do: figures of another are not taken.
const FLOW_VERSION: u32 = 1;

/// A digest of all that the figures depend on: the Verilog, the flow, the tools and the cells.
pub(super) fn key(sources: &[PathBuf], flow: Flow, tools: &Tools) -> Result<String, AreaError> {
    let mut hash = Sha256::new();
    // Without multipliers is told only where it is so: figures measured before stay known.
    let how = format!(
        "Flow {{ seeds: {}, wide_luts: {} }}{}",
        flow.seeds,
        flow.wide_luts,
        if flow.no_dsp { " no_dsp" } else { "" }
    );
    let versions = serde_json::to_string(&tools.versions).unwrap_or_default();
    for text in [&format!("{FLOW_VERSION} {how}"), &versions, &tools.liberty] {
        hash.update((text.len() as u64).to_le_bytes());
        hash.update(text);
    }
    for source in sources {
        hash.update(read(source)?);
    }
    let digest = hash.finalize();
    Ok(digest
        .iter()
        .take(12)
        .map(|byte| format!("{byte:02x}"))
        .collect())
}

/// The figures kept under a key, if there are such, and they are understood.
pub(super) fn figures(key: &str) -> Option<Figures> {
    let text = fs::read_to_string(path(key)).ok()?;
    serde_json::from_str(&text).ok()
}

/// Keeps figures. Where that fails they are measured again another time: no harm is done.
pub(super) fn keep(key: &str, figures: &Figures) {
    let keep = || -> Option<()> {
        let path = path(key);
        let folder = path.parent()?;
        fs::create_dir_all(folder).ok()?;
        let file = tempfile::NamedTempFile::new_in(folder).ok()?;
        serde_json::to_writer(&file, figures).ok()?;
        file.persist(&path).ok().map(|_| ())
    };
    let _ = keep();
}

fn path(key: &str) -> PathBuf {
    cache::folder("measured").join(format!("{key}.json"))
}
