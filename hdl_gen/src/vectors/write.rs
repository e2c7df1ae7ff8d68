//! The regression vectors of a scene, written to a folder.

use std::fs;
use std::path::{Path, PathBuf};

use rtl_model::float::{FloatFormat, Rounding};
use rtl_model::maps::Pyramid;
use rtl_model::scene::{Scene, WalkFormat};
use rtl_model::units::traverse::shape_for;

use super::error::VectorError;
use super::manifest::{Manifest, ManifestFile};
use super::operators::{OperatorChoice, operator_vectors};
use super::rays::{ray_vectors, scene_rays};
use super::set::VectorSet;
use super::step::step_vectors;
use crate::datapath::OperatorLatencies;
use crate::digest::netlist_digest;
use crate::netlist::Module;
use crate::operators::{FloatOperator, float_operator, stream_unit};
use crate::units::{TraverseUnit, UnitConfiguration, build_step_unit};

/// What vectors are made of.
#[derive(Clone, Debug)]
pub struct VectorPlan {
    /// The scene whose map, rays and format are taken.
    pub scene: Scene,
    /// The latencies of the operators, which the vectors do not depend on, but the netlists do.
    pub latencies: OperatorLatencies,
    /// Random operand sets of each operator.
    pub random: u64,
    /// Their seed.
    pub seed: u64,
}

impl VectorPlan {
    /// The plan of the committed vectors, for a scene.
    pub fn for_scene(scene: Scene) -> VectorPlan {
        VectorPlan {
            scene,
            latencies: OperatorLatencies::PAPER,
            random: 160,
            seed: 1,
        }
    }

    /// The format of the scene's walk, if hardware can have it.
    fn format(&self) -> Result<FloatFormat, VectorError> {
        let in_hardware = |format: &FloatFormat| {
            let add = FloatOperator::Add;
            add.check(*format).is_ok()
        };
        match self.scene.walk.format {
            WalkFormat::Float(format) if in_hardware(&format) => Ok(format),
            other => Err(VectorError::NoHardwareFormat {
                scene: self.scene.name.clone(),
                format: other.to_string(),
            }),
        }
    }

    /// The operators that vectors are made for: all there are, in the roundings the step uses and
    /// to nearest.
    pub fn operators(&self, format: FloatFormat) -> Vec<OperatorChoice> {
        use FloatOperator::*;
        use Rounding::{NearestEven, TowardZero, Up};
        [
            (Add, NearestEven),
            (Subtract, NearestEven),
            (Subtract, TowardZero),
            (Subtract, Up),
            (Multiply, NearestEven),
            (Multiply, TowardZero),
            (Divide, NearestEven),
            (Divide, TowardZero),
            (Compare, NearestEven),
            (
                FromInteger {
                    value_bits: 18,
                    exponent_bits: 7,
                },
                TowardZero,
            ),
            (ToInteger { bits: 17 }, NearestEven),
            (Floor, NearestEven),
            (UlpsUp { ulps: 3 }, NearestEven),
            (ExactBelow, NearestEven),
            (DepthFromHeight { bits: 8 }, TowardZero),
            (DepthFromHeight { bits: 16 }, TowardZero),
        ]
        .map(|(kind, rounding)| OperatorChoice {
            kind,
            format,
            rounding,
        })
        .to_vec()
    }

    /// The latency of an operator's stream unit: at least a cycle.
    pub fn latency(&self, kind: FloatOperator) -> u32 {
        let latencies = &self.latencies;
        let cycles = match kind {
            FloatOperator::Add | FloatOperator::Subtract => latencies.adder,
            FloatOperator::Multiply => latencies.multiplier,
            FloatOperator::Divide => latencies.divider,
            FloatOperator::Compare | FloatOperator::LessThan | FloatOperator::LessEqual => {
                latencies.comparator
            }
            _ => latencies.conversion,
        };
        cycles.max(1)
    }
}

/// Writes the vectors of a plan and their manifest into `folder`, which is made where it is
/// missing. All files are put in place together, after all have been written.
///
/// # Errors
/// If the scene has no map, no rays or no format of the hardware, or a file cannot be written.
pub fn write_vectors(plan: &VectorPlan, folder: &Path) -> Result<Manifest, VectorError> {
    let format = plan.format()?;
    let scene = &plan.scene;
    let pyramid = Pyramid::new(&scene.load_map()?);
    let rays = scene_rays(scene, format, &pyramid)?;
    let configuration = UnitConfiguration {
        shape: shape_for(&pyramid),
        format,
        latencies: plan.latencies,
    };
    let mut files = Files::default();
    for choice in plan.operators(format) {
        let latency = plan.latency(choice.kind);
        let core = float_operator(choice.kind, format, choice.rounding, latency);
        let golden = core
            .description
            .iter()
            .find_map(|line| line.strip_prefix("golden: "))
            .unwrap_or_default();
        let unit = stream_unit(&core);
        let set = operator_vectors(choice, plan.random, plan.seed);
        // The formula, then what decides of the last bits.
        let said = core.description.iter().enumerate();
        let said = said.filter(|(line, text)| {
            *line == 0 || text.starts_with("rounding: ") || text.starts_with("policy: ")
        });
        let said: Vec<&str> = said.map(|(_, text)| text.as_str()).collect();
        let entry = Entry {
            unit: &unit,
            description: &said.join("; "),
            golden,
            scene: None,
            seed: (plan.random > 0).then_some(plan.seed),
        };
        files.add(&choice.file_stem(), &set, &entry);
    }

    let step = build_step_unit(&configuration);
    let of_scene = |unit, description, golden| Entry {
        unit,
        description,
        golden,
        scene: Some(scene),
        seed: None,
    };
    let entry = of_scene(
        &step,
        "steps of walks, one a line: the registers before and after",
        "rtl_model::units::traverse_step::traverse_step",
    );
    let set = step_vectors(&step, format, &pyramid, &rays);
    files.add("traverse_step", &set, &entry);

    let traverse = TraverseUnit::build(configuration).design;
    let vectors = ray_vectors(format, &pyramid, &rays);
    let golden = "rtl_model::units::traverse::walk";
    let entry = of_scene(
        &traverse,
        "rays; the id of a ray is its line, from 0",
        golden,
    );
    files.add("rays", &vectors.rays, &entry);
    let entry = of_scene(&traverse, "line k is the hit of the ray with id k", golden);
    files.add("hits", &vectors.hits, &entry);
    let entry = of_scene(
        &traverse,
        "the memory of heights; line k is the word at address k",
        "rtl_model::maps::Pyramid::memory",
    );
    files.add("heights", &vectors.heights, &entry);
    files.write(folder)
}

/// What the manifest says of a file beside what its vectors say.
struct Entry<'a> {
    unit: &'a std::sync::Arc<Module>,
    description: &'a str,
    golden: &'a str,
    scene: Option<&'a Scene>,
    seed: Option<u64>,
}

/// The files of a folder, to be written together.
struct Files {
    manifest: Manifest,
    texts: Vec<(String, String)>,
}

impl Default for Files {
    fn default() -> Files {
        Files {
            manifest: Manifest::empty(),
            texts: Vec::new(),
        }
    }
}

impl Files {
    fn add(&mut self, stem: &str, set: &VectorSet, entry: &Entry<'_>) {
        let name = format!("{stem}.hex");
        let text = set.to_hex();
        let mut file = ManifestFile {
            file: name.clone(),
            description: entry.description.to_owned(),
            unit: entry.unit.name.clone(),
            netlist_digest: netlist_digest(entry.unit),
            golden: entry.golden.to_owned(),
            scene: entry.scene.map(|scene| scene.name.clone()),
            map: entry.scene.map(|scene| scene.map.source.to_string()),
            seed: entry.seed,
            vectors: 0,
            width: 0,
            fields: Vec::new(),
            sha256: String::new(),
        };
        file.describe(set, &text);
        self.manifest.files.push(file);
        self.texts.push((name, text));
    }

    fn write(mut self, folder: &Path) -> Result<Manifest, VectorError> {
        let manifest = (Manifest::FILE.to_owned(), self.manifest.to_json());
        self.texts.push(manifest);
        let failed = |path: &Path| {
            let path: PathBuf = path.to_owned();
            move |problem| VectorError::Write { path, problem }
        };
        fs::create_dir_all(folder).map_err(failed(folder))?;
        let unfinished = tempfile::tempdir_in(folder).map_err(failed(folder))?;
        for (name, text) in &self.texts {
            let path = unfinished.path().join(name);
            fs::write(&path, text).map_err(failed(&path))?;
        }
        for (name, _) in &self.texts {
            let path = folder.join(name);
            fs::rename(unfinished.path().join(name), &path).map_err(failed(&path))?;
        }
        Ok(self.manifest)
    }
}
