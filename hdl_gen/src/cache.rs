//! Where results are kept that take long to make and depend on nothing but their sources.

use std::path::{Path, PathBuf};

/// The folder for one kind of result: in `STEPWELL_CACHE`, else in the user's cache folder, else
/// in a temporary one. It need not be there yet.
pub(crate) fn folder(kind: &str) -> PathBuf {
    if let Some(folder) = std::env::var_os("STEPWELL_CACHE") {
        return PathBuf::from(folder).join(kind);
    }
    let cache = std::env::var_os("XDG_CACHE_HOME").map(PathBuf::from);
    let home = || std::env::var_os("HOME").map(|home| Path::new(&home).join(".cache"));
    cache
        .or_else(home)
        .unwrap_or_else(std::env::temp_dir)
        .join("stepwell")
        .join(kind)
}
