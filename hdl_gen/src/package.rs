//! All that somebody needs who has a simulator and no Rust: the Verilog of a unit, vectors, the
//! testbench that reads them, a manifest, and a FuseSoC core file that says how they belong
//! together.
//!
//! In the folder: `rtl/` with a file a module, `testbench/` with testbench, vectors and
//! `manifest.json`, and `NAME.core`.

use crate::emit::{EmitError, write_design};
use crate::netlist::Module;
use crate::operators::{AnyOperator, stream_unit};
use crate::testbench::{TraverseBench, machine_testbench, stream_testbench, traverse_testbench};
use crate::units::{NoHardware, TraverseUnit, UnitConfiguration, build_step_unit};
use crate::vectors::{
    Files, KEPT_EVERY, MachineSurroundings, VectorError, machine_vectors, operator_vectors,
    ray_vectors, scene_rays, step_vectors,
};
use crate::verify::ClockedRun;
use rtl_model::machine::StallPattern;
use rtl_model::maps::Pyramid;
use rtl_model::ray::Ray;
use rtl_model::scene::Scene;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use thiserror::Error;

/// Why a package could not be written.
#[derive(Debug, Error)]
pub enum PackageError {
    /// The Verilog.
    #[error(transparent)]
    Emit(#[from] EmitError),
    /// The vectors.
    #[error(transparent)]
    Vectors(#[from] VectorError),
    /// The walk.
    #[error(transparent)]
    NoHardware(#[from] NoHardware),
    /// A folder or file of it.
    #[error("{path}: cannot be written ({problem})")]
    Write {
        /// Which.
        path: PathBuf,
        /// Why.
        problem: std::io::Error,
    },
}

/// What was written.
#[derive(Clone, Debug)]
pub struct Package {
    /// The top module of the design.
    pub top: Arc<Module>,
    /// The testbench's module.
    pub testbench: String,
    /// Vectors in all files of expected results.
    pub vectors: usize,
}

/// The traverse unit of a scene with the rays of its frame.
///
/// # Errors
/// If the scene has no map, no rays or no format of the hardware, or a file cannot be written.
pub fn package_scene(scene: &Scene, folder: &Path) -> Result<Package, PackageError> {
    let pyramid = Pyramid::new(&scene.load_map().map_err(VectorError::from)?);
    let configuration = UnitConfiguration::of(scene.walk, &pyramid)?;
    configuration.check_loop()?;
    let rays = scene_rays(scene, &pyramid)?.into_iter();
    let rays: Vec<Ray<u64>> = rays.map(|ray| configuration.port_words(ray)).collect();
    let unit = TraverseUnit::build(configuration);
    let vectors = ray_vectors(&unit, &pyramid, &rays);
    let bench = TraverseBench::new(&unit, &vectors, StallPattern::one_in_eight(1));
    let mut files = Files::default();
    files.add_rays(&unit.design, &vectors, scene);
    let testbench = format!("testbench_{}", unit.design.name);
    files.add_text(&format!("{testbench}.v"), traverse_testbench(&unit, &bench));
    let hex = ["rays.hex", "hits.hex", "heights.hex"];
    write(unit.design, testbench, files, &hex, rays.len(), folder)
}

/// A whole machine with the rays of its scene, the memory behind it in the testbench. What is
/// expected are the hits of the golden machine: hold them against the golden walk before.
///
/// # Errors
/// If a file cannot be written.
pub fn package_machine(
    run: &ClockedRun<'_>,
    surroundings: &MachineSurroundings,
    scene: &Scene,
    folder: &Path,
) -> Result<Package, PackageError> {
    let vectors = machine_vectors(run, &surroundings.memory_words);
    let mut files = Files::default();
    files.add_machine(run.unit, &vectors, scene);
    let testbench = format!("testbench_{}", run.unit.name);
    let text = machine_testbench(run, surroundings, &vectors);
    files.add_text(&format!("{testbench}.v"), text);
    let hex = ["rays.hex", "hits.hex", "memory.hex"];
    let hits = vectors.hits.vectors.len();
    write(run.unit.clone(), testbench, files, &hex, hits, folder)
}

/// An operator behind handshakes with `random` random operand sets beside the special ones.
///
/// # Errors
/// If a file cannot be written.
pub fn package_operator(
    choice: impl Into<AnyOperator>,
    latency: u32,
    random: u64,
    seed: u64,
    folder: &Path,
) -> Result<Package, PackageError> {
    let choice: AnyOperator = choice.into();
    let core = choice.build(latency);
    let unit = stream_unit(&core);
    let set = operator_vectors(choice, random, seed);
    let mut files = Files::default();
    files.add_operator(
        "vectors",
        choice,
        latency,
        &set,
        (random > 0).then_some(seed),
    );
    let testbench = format!("testbench_{}", unit.name);
    let text = stream_testbench(&unit, &set, "vectors.hex");
    files.add_text(&format!("{testbench}.v"), text);
    write(
        unit,
        testbench,
        files,
        &["vectors.hex"],
        set.vectors.len(),
        folder,
    )
}

/// A step behind handshakes, with steps out of the walks of these rays.
///
/// # Errors
/// If a file cannot be written.
pub fn package_step(
    configuration: &UnitConfiguration,
    pyramid: &Pyramid,
    rays: &[Ray<f64>],
    folder: &Path,
) -> Result<Package, PackageError> {
    let unit = build_step_unit(configuration);
    let set = step_vectors(&unit, configuration, pyramid, rays, KEPT_EVERY);
    let mut files = Files::default();
    files.add_step("vectors", &unit, &set, None);
    let testbench = format!("testbench_{}", unit.name);
    let text = stream_testbench(&unit, &set, "vectors.hex");
    files.add_text(&format!("{testbench}.v"), text);
    write(
        unit,
        testbench,
        files,
        &["vectors.hex"],
        set.vectors.len(),
        folder,
    )
}

fn write(
    top: Arc<Module>,
    testbench: String,
    files: Files,
    hex: &[&str],
    vectors: usize,
    folder: &Path,
) -> Result<Package, PackageError> {
    let failed = |path: PathBuf| move |problem| PackageError::Write { path, problem };
    let rtl = folder.join("rtl");
    fs::create_dir_all(&rtl).map_err(failed(rtl.clone()))?;
    let modules = write_design(&top, &rtl)?;
    files.write(&folder.join("testbench"))?;
    let path = folder.join(format!("{}.core", top.name));
    fs::write(&path, core_file(&top.name, &testbench, &modules, hex)).map_err(failed(path))?;
    Ok(Package {
        top,
        testbench,
        vectors,
    })
}

/// The FuseSoC core file (CAPI2): design, testbench, vectors, and the targets `lint` and `sim`.
fn core_file(top: &str, testbench: &str, modules: &[PathBuf], hex: &[&str]) -> String {
    let mut text = format!(
        "CAPI=2:\n\n# Emitted by stepwell {}.\nname: stepwell::{top}:{}\n\nfilesets:\n  rtl:\n    files:\n",
        env!("CARGO_PKG_VERSION"),
        env!("CARGO_PKG_VERSION")
    );
    for module in modules {
        let name = module.file_name().unwrap_or_default().to_string_lossy();
        let _ = writeln!(text, "      - rtl/{name}");
    }
    text.push_str("    file_type: verilogSource-2005\n  testbench:\n    files:\n");
    let _ = writeln!(
        text,
        "      - testbench/{testbench}.v: {{file_type: verilogSource-2005}}"
    );
    for file in hex {
        let _ = writeln!(
            text,
            "      - testbench/{file}: {{file_type: user, copyto: {file}}}"
        );
    }
    let _ = write!(
        text,
        "\ntargets:\n  default: &default\n    filesets: [rtl]\n    toplevel: {top}\n  \
         lint:\n    <<: *default\n    default_tool: verilator\n    tools:\n      verilator:\n        \
         mode: lint-only\n        verilator_options: [-Wall]\n  \
         sim:\n    filesets: [rtl, testbench]\n    toplevel: {testbench}\n    default_tool: icarus\n    \
         tools:\n      icarus:\n        iverilog_options: [-g2005]\n"
    );
    text
}
