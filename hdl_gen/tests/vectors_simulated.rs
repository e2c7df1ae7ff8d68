//! The committed vectors' like under Icarus Verilog and the embedded simulator.

use hdl_gen::fault::plant;
use hdl_gen::netlist::Module;
use hdl_gen::operators::stream_unit;
use hdl_gen::units::{UnitConfiguration, build_step_unit};
use hdl_gen::vectors::{
    KEPT_EVERY, StepVectors, VectorPlan, VectorSet, operator_vectors, scene_rays, step_vectors,
};
use hdl_gen::verify::{Icarus, run_vectors_embedded};
use rtl_model::float::FloatFormat;
use rtl_model::maps::Pyramid;
use rtl_model::scene::Scene;
use rtl_model::units::traverse::shape_for;
use std::path::Path;
use std::sync::Arc;

const FORMAT: FloatFormat = FloatFormat::E7F16;

fn plan() -> VectorPlan {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/small.toml");
    VectorPlan::for_scene(Scene::load(&scene).unwrap())
}

/// Icarus Verilog, if it is installed; CI must have it.
fn icarus() -> Option<Icarus> {
    match Icarus::find() {
        Ok(icarus) => Some(icarus),
        Err(missing) => {
            let strict = std::env::var("CI").is_ok_and(|value| value == "true");
            assert!(!strict, "{missing}");
            println!("{missing}: this check is left out");
            None
        }
    }
}

/// Every unit behind handshakes that has vectors, with them.
fn units() -> Vec<(Arc<Module>, VectorSet)> {
    let plan = plan();
    let mut units: Vec<(Arc<Module>, VectorSet)> = plan
        .operators(FORMAT)
        .into_iter()
        .map(|choice| {
            let latency = plan.latencies.of_operator(choice.operator);
            let core = choice.build(latency);
            let set = operator_vectors(choice, plan.random, plan.seed);
            (stream_unit(&core), set)
        })
        .collect();
    let pyramid = Pyramid::new(&plan.scene.load_map().unwrap());
    let configuration = UnitConfiguration::oh(shape_for(&pyramid), FORMAT);
    let step = build_step_unit(&configuration);
    let rays = scene_rays(&plan.scene, &pyramid).unwrap();
    let set = step_vectors(&step, &configuration, &pyramid, &rays, KEPT_EVERY);
    units.push((step, set));
    units.extend(other_steps(&plan, &pyramid));
    units
}

/// The steps of other kinds; their few vectors show walks that go on and walks that have ended.
fn other_steps(plan: &VectorPlan, pyramid: &Pyramid) -> Vec<(Arc<Module>, VectorSet)> {
    let steps = plan.other_steps().map(|walk| {
        let StepVectors { stem, unit, set } = plan.step(walk, pyramid).unwrap();
        let hit = set.fields.iter().position(|field| field.name == "hit_o");
        let hits = set.vectors.iter().map(|vector| vector[hit.unwrap()]);
        let hits: u64 = hits.sum();
        assert!(
            0 < hits && hits < set.vectors.len() as u64,
            "{stem}: {hits}"
        );
        (unit, set)
    });
    steps.to_vec()
}

#[test]
fn every_unit_gives_the_golden_results() {
    let icarus = icarus();
    for (unit, set) in units() {
        let count = set.vectors.len() as u64;
        // A step's vectors are chosen, one of each kind; an operator's are many.
        let least = if unit.name.ends_with("_step_unit") {
            20
        } else {
            100
        };
        assert!(count > least, "{}: {count} vectors", unit.name);
        let verdict = run_vectors_embedded(&unit, &set).unwrap();
        assert!(verdict.passed, "{}: {verdict:?}", unit.name);
        assert_eq!(verdict.agreed, count);
        if let Some(icarus) = &icarus {
            let verdict = icarus.run_vectors(&unit, &set).unwrap();
            assert!(verdict.passed, "{}: {verdict:?}", unit.name);
            assert_eq!(verdict.agreed, count);
        }
    }
}

#[test]
fn nothing_compared_is_no_success() {
    let plan = plan();
    let choice = plan.operators(FORMAT)[0];
    let core = choice.build(2);
    let unit = stream_unit(&core);
    let mut set = operator_vectors(choice, 0, 1);
    set.vectors.clear();
    assert!(!run_vectors_embedded(&unit, &set).unwrap().passed);
    if let Some(icarus) = icarus() {
        assert!(!icarus.run_vectors(&unit, &set).unwrap().passed);
    }
}

#[test]
fn faults_of_the_handshake_and_of_the_arithmetic_are_caught() {
    let plan = plan();
    let choice = plan.operators(FORMAT)[0];
    let core = choice.build(2);
    let unit = stream_unit(&core);
    let set = operator_vectors(choice, plan.random, plan.seed);
    let icarus = icarus();
    for (path, bit) in [
        ("core_result", 0),
        ("advance", 0),
        ("valid_places", 0),
        ("valid_places", 1),
        ("last_is_valid", 0),
    ] {
        let faulty = plant(&unit, path, bit).unwrap();
        let verdict = run_vectors_embedded(&faulty, &set).unwrap();
        assert!(!verdict.passed, "{path} embedded: {verdict:?}");
        if let Some(icarus) = &icarus {
            let verdict = icarus.run_vectors(&faulty, &set).unwrap();
            assert!(!verdict.passed, "{path} Icarus: {verdict:?}");
            println!("{path}: {}", verdict.line);
        }
    }
}
