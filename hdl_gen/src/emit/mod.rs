//! Verilog-2005 for people: one module a file, comments, sections in dataflow order.
//!
//! Nodes with a name are signals; nodes without one stand inside the expressions that use them as
//! long as those stay short, and get a name made of what they are where not. What no output
//! depends on is not printed. The files pass `verilator --lint-only -Wall` without waivers.

mod definition;
mod expression;
mod known;
mod naming;
mod plan;
mod print;
mod shape;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::digest::netlist_digest;
use crate::netlist::Module;

/// Why a design was not written.
#[derive(Debug, thiserror::Error)]
pub enum EmitError {
    /// A file or folder could not be written.
    #[error("{}: {source}; check that the folder can be written to and the disk has room",
        path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Two modules of one name that differ: one file cannot hold both.
    #[error(
        "two different modules are named {name}, and both would be {name}.v; \
         name them after the parameters they differ in"
    )]
    NameClash {
        /// The name.
        name: String,
    },
}

/// The Verilog of one module, not of those it uses; `tool_version` stands in the header.
pub fn verilog(module: &Module, tool_version: &str) -> String {
    print::print(module, tool_version)
}

/// Writes every module of the hierarchy to its own file `NAME.v` in `dir`, which is made where it
/// is missing; answers the files, each behind those of the modules it uses.
///
/// No file is in place before all are written, so that a full disk leaves none half done.
///
/// # Errors
/// [`EmitError::Write`], [`EmitError::NameClash`].
pub fn write_design(top: &Arc<Module>, dir: &Path) -> Result<Vec<PathBuf>, EmitError> {
    let modules = distinct_modules(top)?;
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| EmitError::Write { path, source }
    };
    std::fs::create_dir_all(dir).map_err(failed(dir))?;
    let unfinished = tempfile::tempdir_in(dir).map_err(failed(dir))?;
    let mut written = Vec::new();
    for module in &modules {
        let name = format!("{}.v", module.name);
        let path = unfinished.path().join(&name);
        let text = verilog(module, env!("CARGO_PKG_VERSION"));
        std::fs::write(&path, text).map_err(failed(&path))?;
        written.push((path, dir.join(name)));
    }
    let mut paths = Vec::new();
    for (from, to) in written {
        std::fs::rename(from, &to).map_err(failed(&to))?;
        paths.push(to);
    }
    Ok(paths)
}

/// The modules of a hierarchy, each once; two that share a name must be the same.
fn distinct_modules(top: &Arc<Module>) -> Result<Vec<Arc<Module>>, EmitError> {
    let modules = top.hierarchy();
    for user in &modules {
        for instance in &user.instances {
            let module = &instance.module;
            let same = modules.iter().any(|known| {
                known.name == module.name
                    && (Arc::ptr_eq(known, module)
                        || netlist_digest(known) == netlist_digest(module))
            });
            if !same {
                let name = module.name.clone();
                return Err(EmitError::NameClash { name });
            }
        }
    }
    Ok(modules)
}
