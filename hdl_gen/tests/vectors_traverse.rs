//! The whole traverse unit under Icarus Verilog: every register, every cycle.

use hdl_gen::fault::plant;
use hdl_gen::testbench::{FieldDifference, TraverseBench, Verdict};
use hdl_gen::units::{TraverseUnit, UnitConfiguration};
use hdl_gen::vectors::{Manifest, RayVectors, ray_vectors, scene_rays};
use hdl_gen::verify::{GoldenRun, Icarus, golden_waveform, run_embedded, waveform_signals};
use hdl_gen::wave::{Cause, DiffOptions, Waveform, diff};
use rtl_model::float::FloatFormat;
use rtl_model::machine::StallPattern;
use rtl_model::maps::Pyramid;
use rtl_model::ray::Ray;
use rtl_model::scene::Scene;
use rtl_model::units::traverse::shape_for;
use std::ops::ControlFlow;
use std::path::Path;

const FORMAT: FloatFormat = FloatFormat::E7F16;

struct Frame {
    pyramid: Pyramid,
    rays: Vec<Ray<u64>>,
    unit: TraverseUnit,
}

impl Frame {
    fn small() -> Frame {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/small.toml");
        let scene = Scene::load(&scene).unwrap();
        let pyramid = Pyramid::new(&scene.load_map().unwrap());
        let configuration = UnitConfiguration::oh(shape_for(&pyramid), FORMAT);
        let rays = scene_rays(&scene, &pyramid).unwrap().into_iter();
        Frame {
            rays: rays.map(|ray| configuration.port_words(ray)).collect(),
            unit: TraverseUnit::build(configuration),
            pyramid,
        }
    }

    fn run(&self, rays: usize) -> GoldenRun<'_> {
        GoldenRun {
            pyramid: &self.pyramid,
            rays: &self.rays[..rays],
            stalls: StallPattern::one_in_eight(7),
            step: self.unit.configuration.step,
            latency: self.unit.latency,
        }
    }
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

#[test]
fn icarus_shows_the_golden_value_of_every_register_in_every_cycle() {
    let Some(icarus) = icarus() else { return };
    let frame = Frame::small();
    let run = frame.run(frame.rays.len());
    let comparison = icarus.run_traverse(&frame.unit, &run).unwrap();
    assert_eq!(comparison.mismatches, 0, "{:?}", comparison.first);
    assert_eq!(comparison.rays, frame.rays.len() as u64);
    assert_eq!(comparison.guards, 0);
    assert_eq!(comparison.signals_compared, frame.unit.probes.len() as u64);
    // The embedded simulator saw the same run.
    let embedded = run_embedded(&frame.unit, &run, |_, _, _| {}).unwrap();
    assert_eq!(comparison, embedded);
}

/// The unit with one bit of a signal inverted.
fn faulty(unit: &TraverseUnit, path: &str, bit: u32) -> TraverseUnit {
    TraverseUnit {
        design: plant(&unit.design, path, bit).unwrap(),
        ..unit.clone()
    }
}

/// Where the depth at which a node is left first stands in a register.
fn first_exit_register(unit: &TraverseUnit) -> &str {
    let is_exit = |name: &&str| name.starts_with("exit_depth_u_s");
    let names = unit.probes.iter().map(|probe| probe.name.as_str());
    names.into_iter().find(is_exit).unwrap()
}

fn waveform<'a>(name: &str, content: &'a [u8]) -> Waveform<&'a [u8]> {
    Waveform {
        name: name.to_owned(),
        input: content,
    }
}

#[test]
fn icarus_shows_a_planted_fault_where_it_is() {
    let Some(icarus) = icarus() else { return };
    let frame = Frame::small();
    let run = frame.run(40);
    let register = first_exit_register(&frame.unit);
    for (path, bit) in [(format!("step.{register}"), 9), ("id_s3".to_owned(), 19)] {
        let unit = faulty(&frame.unit, &path, bit);
        let found = icarus.run_traverse(&unit, &run).unwrap();
        assert!(found.mismatches > 0, "{path}");
        let embedded = run_embedded(&unit, &run, |_, _, _| {}).unwrap();
        assert_eq!(found, embedded, "{path}");
    }
}

#[test]
fn a_fault_that_unsettles_the_handshake_ends_the_run() {
    let Some(icarus) = icarus() else { return };
    let frame = Frame::small();
    // Rays are lost, or go round for ever: the testbench must not.
    for path in ["hit_valid", "recirculates", "valid_s0"] {
        let unit = faulty(&frame.unit, path, 0);
        let found = icarus.run_traverse(&unit, &frame.run(20)).unwrap();
        assert!(found.mismatches > 0, "{path}");
    }
}

#[test]
fn the_golden_waveform_is_that_of_icarus() {
    let Some(icarus) = icarus() else { return };
    let frame = Frame::small();
    let run = frame.run(40);
    let (golden, cycles) = golden_waveform(&frame.unit, &run, 0..=u64::MAX, Vec::new()).unwrap();
    assert_eq!(cycles, run.run(FORMAT, |_, _, _| ControlFlow::Continue(())));
    let compare = |unit: &TraverseUnit| {
        let (other, _) = icarus
            .waveform(unit, &run, 0..=u64::MAX, Vec::new())
            .unwrap();
        diff(
            waveform("golden.vcd", &golden),
            waveform("icarus.vcd", &other),
            &DiffOptions::default(),
        )
        .unwrap()
    };
    let report = compare(&frame.unit);
    assert!(report.agreed, "{report}");
    let signals = waveform_signals(&frame.unit).len();
    assert_eq!(report.signals_compared, signals);
    assert_eq!(report.cycles_compared, cycles);
    assert_eq!(report.partly_unknown_pairs, 0);

    // The waveform says what signals are computed from, so a first cause is known as one: here a
    // multiplier's, with operands that are not zero.
    let product = "float_mul_e7f16_rtz_l1.significand_product";
    let report = compare(&faulty(&frame.unit, product, 20));
    assert!(!report.agreed);
    let first = &report.first_divergence.unwrap().signals[0];
    assert!(first.signal.starts_with("travelled_"), "{first:?}");
    assert_eq!(first.cause, Cause::First, "{first:?}");
}

/// The testbench's verdict on the small frame.
fn verdict(icarus: &Icarus, frame: &Frame, vectors: &RayVectors) -> Verdict {
    let bench = TraverseBench::new(&frame.unit, vectors, StallPattern::never());
    icarus.run_rays(&frame.unit, vectors, &bench).unwrap()
}

#[test]
fn the_testbench_passes_the_committed_hits_and_names_a_wrong_one() {
    let Some(icarus) = icarus() else { return };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors");
    let manifest = Manifest::read(&folder).unwrap();
    let read = |name| manifest.file(name).unwrap().read(&folder).unwrap();
    let mut vectors = RayVectors {
        rays: read("rays.hex"),
        hits: read("hits.hex"),
        heights: read("heights.hex"),
    };
    let frame = Frame::small();
    let count = vectors.rays.vectors.len() as u64;
    let sound = verdict(&icarus, &frame, &vectors);
    assert!(sound.passed, "{sound:?}");
    assert_eq!((sound.agreed, sound.vectors), (count, count));

    // The last fraction bit of a depth.
    let expected = vectors.hits.vectors[300][2];
    vectors.hits.vectors[300][2] ^= 1;
    let wrong = verdict(&icarus, &frame, &vectors);
    assert!(!wrong.passed, "{wrong:?}");
    assert_eq!(wrong.agreed, count - 1);
    let difference = FieldDifference {
        vector: 300,
        field: "t".to_owned(),
        expected: format!("{:06x}", expected ^ 1),
        found: format!("{expected:06x}"),
    };
    assert_eq!(wrong.differences, [difference]);
}

#[test]
fn the_testbench_of_no_rays_fails() {
    let Some(icarus) = icarus() else { return };
    let frame = Frame::small();
    let vectors = ray_vectors(&frame.unit, &frame.pyramid, &[]);
    let empty = verdict(&icarus, &frame, &vectors);
    assert!(!empty.passed, "{empty:?}");
    assert_eq!(empty.vectors, 0);
}

#[test]
fn a_window_of_the_golden_waveform_is_a_part_of_the_whole() {
    let frame = Frame::small();
    let run = frame.run(40);
    let (whole, cycles) = golden_waveform(&frame.unit, &run, 0..=u64::MAX, Vec::new()).unwrap();
    let (part, written) = golden_waveform(&frame.unit, &run, 100..=149, Vec::new()).unwrap();
    assert_eq!(written, 50);
    let report = diff(
        waveform("whole.vcd", &whole),
        waveform("part.vcd", &part),
        &DiffOptions::default(),
    )
    .unwrap();
    assert!(report.agreed, "{report}");
    assert_eq!(report.cycles_compared, 50);
    let behind_the_end = golden_waveform(&frame.unit, &run, cycles..=u64::MAX, Vec::new());
    let message = behind_the_end.unwrap_err().to_string();
    assert!(message.contains(&format!("{cycles} cycles")), "{message}");
}
