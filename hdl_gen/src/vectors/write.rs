//! The regression vectors of a scene, written to a folder.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rtl_model::float::{FloatFormat, Rounding};
use rtl_model::maps::Pyramid;
use rtl_model::scene::{Crossing, Method, Scene, Walk, WalkFormat};
use rtl_model::units::step::Step;
use rtl_model::units::traverse_step::{INDEX_BITS, LEVEL_BITS};

use super::error::VectorError;
use super::machine::MachineVectors;
use super::manifest::{Manifest, ManifestFile};
use super::operators::operator_vectors;
use super::rays::{RayVectors, ray_vectors, scene_rays};
use super::set::VectorSet;
use super::step::{KEPT_EVERY, few_step_vectors, step_vectors};
use crate::datapath::OperatorLatencies;
use crate::digest::netlist_digest;
use crate::netlist::Module;
use crate::operators::{AnyOperator, FloatOperator, OperatorConfiguration, stream_unit};
use crate::units::{TraverseUnit, UnitConfiguration, build_step_unit};

/// The format of a scene's walk, if hardware can have it.
///
/// # Errors
/// If it is no float, or one too wide.
pub fn hardware_format(scene: &Scene) -> Result<FloatFormat, VectorError> {
    let in_hardware = |format: &FloatFormat| FloatOperator::Add.check(*format).is_ok();
    match scene.walk.format {
        WalkFormat::Float(format) if in_hardware(&format) => Ok(format),
        other => Err(VectorError::NoHardwareFormat {
            scene: scene.name.clone(),
            format: other.to_string(),
        }),
    }
}

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

    /// The walks whose steps have vectors beside the scene's own: a kind of step each.
    pub fn other_steps(&self) -> [Walk; 6] {
        let float = WalkFormat::Float(FloatFormat::E7F16);
        let fixed = WalkFormat::Fixed(None);
        [
            (Method::MixedSelective, float),
            (Method::Oh, fixed),
            (Method::Block, float),
            (Method::Block, fixed),
            (Method::Relief, float),
            (Method::BoundedQuad, fixed),
        ]
        .map(|(method, format)| Walk {
            method,
            format,
            crossing: Crossing::Index,
        })
    }

    /// The vectors of the step of a walk on the scene's map, with its unit and the name of their file.
    ///
    /// # Errors
    /// If there is no hardware of the walk, or the scene has no rays.
    pub fn step(&self, walk: Walk, pyramid: &Pyramid) -> Result<StepVectors, VectorError> {
        let scene = Scene {
            walk,
            ..self.scene.clone()
        };
        let configuration = UnitConfiguration {
            latencies: self.latencies,
            ..UnitConfiguration::of(walk, pyramid)?
        };
        let unit = build_step_unit(&configuration);
        let rays = scene_rays(&scene, pyramid)?;
        let rays: Vec<_> = rays.into_iter().step_by(RAYS_A_STEP_RAY).collect();
        let set = few_step_vectors(&unit, &configuration, pyramid, &rays);
        let name = configuration.step.name();
        Ok(StepVectors {
            stem: format!("{name}_{}_{}", walk.method, walk.format).replace('-', "_"),
            set: set.thinned(VECTORS_OF_A_STEP),
            unit,
        })
    }

    /// The operators that vectors are made for: all there are, in the roundings the step uses and
    /// to nearest.
    pub fn operators(&self, format: FloatFormat) -> Vec<OperatorConfiguration> {
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
            (SquareRoot, NearestEven),
            (Minimum, NearestEven),
            (Maximum, NearestEven),
            (Compare, NearestEven),
            (
                FromInteger {
                    value_bits: INDEX_BITS + 1,
                    exponent_bits: LEVEL_BITS + 2,
                },
                TowardZero,
            ),
            (FromSigned { bits: 32 }, NearestEven),
            (FromUnsigned { bits: 32 }, NearestEven),
            (ToInteger { bits: INDEX_BITS }, NearestEven),
            (ToUnsigned { bits: 32 }, NearestEven),
            (
                Convert {
                    target: FloatFormat::new(8, 23),
                },
                NearestEven,
            ),
            (RoundToIntegral, NearestEven),
            (Floor, NearestEven),
            (UlpsUp { ulps: 3 }, NearestEven),
            (ExactBelow, NearestEven),
            (DepthFromHeight { bits: 8 }, TowardZero),
            (DepthFromHeight { bits: 16 }, TowardZero),
        ]
        .map(|(operator, rounding)| OperatorConfiguration::new(operator, format, rounding))
        .to_vec()
    }
}

/// Vectors of each step beside the scene's own: enough to show ports, and steps of many kinds.
const VECTORS_OF_A_STEP: usize = 32;
/// Of a scene's rays one in so many is walked for them.
const RAYS_A_STEP_RAY: usize = 16;

/// The vectors of a step, and what they are of.
#[derive(Clone, Debug)]
pub struct StepVectors {
    /// The name of their file: the step's, the method's and the format's.
    pub stem: String,
    /// The step behind handshakes.
    pub unit: Arc<Module>,
    /// The vectors.
    pub set: VectorSet,
}

/// Writes the vectors of a plan and their manifest into `folder`, which is made where it is
/// missing. All files are put in place together, after all have been written.
///
/// # Errors
/// If the scene has no map, no rays or no format of the hardware, or a file cannot be written.
pub fn write_vectors(plan: &VectorPlan, folder: &Path) -> Result<Manifest, VectorError> {
    let scene = &plan.scene;
    let format = hardware_format(scene)?;
    let pyramid = Pyramid::new(&scene.load_map()?);
    let rays = scene_rays(scene, &pyramid)?;
    let configuration = UnitConfiguration {
        latencies: plan.latencies,
        ..UnitConfiguration::of(scene.walk, &pyramid)?
    };
    configuration.check_loop()?;
    let mut files = Files::default();
    for choice in plan.operators(format) {
        let latency = plan.latencies.of_operator(choice.operator);
        let choice = AnyOperator::from(choice);
        let set = operator_vectors(choice, plan.random, plan.seed);
        let seed = (plan.random > 0).then_some(plan.seed);
        files.add_operator(&choice.name(), choice, latency, &set, seed);
    }
    let step = build_step_unit(&configuration);
    let set = step_vectors(&step, &configuration, &pyramid, &rays, KEPT_EVERY);
    files.add_step("traverse_step", &step, &set, Some(scene));
    for walk in plan.other_steps() {
        let StepVectors { stem, unit, set } = plan.step(walk, &pyramid)?;
        files.add_step(&stem, &unit, &set, Some(scene));
    }
    let traverse = TraverseUnit::build(configuration);
    let words = rays.iter().map(|&ray| configuration.port_words(ray));
    let words: Vec<_> = words.collect();
    let vectors = ray_vectors(&traverse, &pyramid, &words);
    files.add_rays(&traverse.design, &vectors, scene);
    files.write(folder)
}

/// The golden function that a module's header names.
fn golden_of(module: &Module) -> &str {
    let mut lines = module.description.iter();
    lines
        .find_map(|line| line.strip_prefix("golden: "))
        .unwrap_or_default()
}

/// What the manifest says of a file beside what its vectors say.
struct Entry<'a> {
    unit: &'a Arc<Module>,
    description: &'a str,
    golden: &'a str,
    scene: Option<&'a Scene>,
    seed: Option<u64>,
}

/// The files of a folder, to be written together: vectors and their manifest.
pub(crate) struct Files {
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
    /// Vectors of an operator's stream unit.
    pub(crate) fn add_operator(
        &mut self,
        stem: &str,
        choice: AnyOperator,
        latency: u32,
        set: &VectorSet,
        seed: Option<u64>,
    ) {
        let core = choice.build(latency);
        let golden = golden_of(&core);
        let unit = stream_unit(&core);
        // The formula, then what decides of the last bits.
        let said = core.description.iter().enumerate();
        let said = said.filter(|(line, text)| {
            let decides = ["rounding: ", "policy: ", "overflow: "];
            *line == 0 || decides.iter().any(|start| text.starts_with(start))
        });
        let said: Vec<&str> = said.map(|(_, text)| text.as_str()).collect();
        let description = said.join("; ");
        let entry = Entry {
            unit: &unit,
            description: &description,
            golden,
            scene: None,
            seed,
        };
        self.add(stem, set, &entry);
    }

    /// Vectors of the step's unit.
    pub(crate) fn add_step(
        &mut self,
        stem: &str,
        unit: &Arc<Module>,
        set: &VectorSet,
        scene: Option<&Scene>,
    ) {
        let entry = Entry {
            unit,
            description: "steps of walks, one a line: the registers before and after",
            golden: golden_of(unit),
            scene,
            seed: None,
        };
        self.add(stem, set, &entry);
    }

    /// The rays of a scene, their hits and the memory.
    pub(crate) fn add_rays(&mut self, unit: &Arc<Module>, vectors: &RayVectors, scene: &Scene) {
        let walk = "rtl_model::units::traverse::walk";
        for (stem, description, golden, set) in [
            (
                "rays",
                "rays; the id of a ray is its line, from 0",
                walk,
                &vectors.rays,
            ),
            (
                "hits",
                "line k is the hit of the ray with id k",
                walk,
                &vectors.hits,
            ),
            (
                "heights",
                "the memory of heights; line k is the word at address k",
                "rtl_model::maps::Pyramid::memory",
                &vectors.heights,
            ),
        ] {
            let entry = Entry {
                unit,
                description,
                golden,
                scene: Some(scene),
                seed: None,
            };
            self.add(stem, set, &entry);
        }
    }

    /// The rays of a machine's scene, the hits of its golden machine, and its memory.
    pub(crate) fn add_machine(
        &mut self,
        unit: &Arc<Module>,
        vectors: &MachineVectors,
        scene: &Scene,
    ) {
        for (stem, description, set) in [
            (
                "rays",
                "rays; the id of a ray is its line, from 0",
                &vectors.rays,
            ),
            (
                "hits",
                "line k is the hit of the ray with id k",
                &vectors.hits,
            ),
            (
                "memory",
                "the memory behind the read port; line k is the word at byte address 8 k",
                &vectors.memory,
            ),
        ] {
            let entry = Entry {
                unit,
                description,
                golden: "rtl_model::machine",
                scene: Some(scene),
                seed: None,
            };
            self.add(stem, set, &entry);
        }
    }

    /// Another file beside the vectors, such as their testbench.
    pub(crate) fn add_text(&mut self, name: &str, text: String) {
        self.texts.push((name.to_owned(), text));
    }

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

    /// Writes all of them, or none.
    pub(crate) fn write(mut self, folder: &Path) -> Result<Manifest, VectorError> {
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
