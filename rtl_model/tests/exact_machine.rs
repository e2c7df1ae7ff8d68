//! The exact machine's hits are those of the golden walk, each once, whatever stalls; what is
//! planted is seen.

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::path::Path;

use rtl_model::calibration::{CAMERAS, SURFACES, real_maps};
use rtl_model::camera::View;
use rtl_model::machine::{
    AxiMemoryShape, ExactCounts, ExactEffort, ExactHit, ExactMachineShape, ExactRun, RunSummary,
    StallPattern,
};
use rtl_model::maps::{Channel, HeightMap, MapSource, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::ray_format::{QuantisedRay, RayFormat, RayRange};
use rtl_model::scene::MachineCache;
use rtl_model::units::bounded::bounded_walk;
use rtl_model::units::bounded_shape::BoundedShape;
use rtl_model::units::fixed_traverse::FixedHit;

const MEMORY: AxiMemoryShape = AxiMemoryShape {
    latency: 20,
    bytes_per_cycle: 8,
    outstanding: 8,
    stalls: None,
};

/// A map, its rays as the hardware has them, and the words they take.
struct Subject {
    name: &'static str,
    camera: &'static str,
    pyramid: Pyramid,
    format: RayFormat,
    rays: Vec<QuantisedRay>,
}

/// The rays of the cameras over the real maps, or procedural ones where there are none.
fn subjects(width: u32, height: u32, wanted: impl Fn(&str, &str) -> bool) -> Vec<Subject> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = real_maps(&root).expect("the real maps, in CI");
    let mut subjects = Vec::new();
    for surface in &SURFACES {
        if !CAMERAS
            .iter()
            .any(|(camera, _)| wanted(surface.name, camera))
        {
            continue;
        }
        let source: MapSource = match &folder {
            Some(folder) => folder.join(surface.file).to_str().expect("a path").parse(),
            None => format!("procedural:spikes:{}:3", surface.size).parse(),
        }
        .expect("a map's source");
        let channel = match &folder {
            Some(_) => Channel::Alpha,
            None => Channel::Grey,
        };
        let map = source.load(channel, false).expect("a map");
        for (camera, view) in &CAMERAS {
            if !wanted(surface.name, camera) {
                continue;
            }
            let view = View::new(view, &surface.surface, width, height);
            let rays = view
                .rays_by_tile(map.size(), 16)
                .expect("rays within reach");
            subjects.push(subject(surface.name, camera, &map, &rays));
        }
    }
    subjects
}

fn subject(
    name: &'static str,
    camera: &'static str,
    map: &HeightMap,
    rays: &[Ray<f64>],
) -> Subject {
    let pyramid = Pyramid::new(map);
    let range = rays.iter().map(|&ray| RayRange::of(ray));
    let range = range.reduce(RayRange::and).expect("rays");
    let format = RayFormat::for_rays(&range, &pyramid);
    Subject {
        name,
        camera,
        rays: rays.iter().map(|&ray| format.quantise(ray)).collect(),
        pyramid,
        format,
    }
}

/// How a machine is run.
#[derive(Clone, Copy)]
struct Traffic {
    gaps: StallPattern,
    stalls: StallPattern,
    receiver_starts: u64,
    memory: AxiMemoryShape,
}

fn free() -> Traffic {
    Traffic {
        gaps: StallPattern::never(),
        stalls: StallPattern::never(),
        receiver_starts: 0,
        memory: MEMORY,
    }
}

fn shape(subject: &Subject, log2_side: u32, effort: ExactEffort) -> ExactMachineShape {
    let bounded = BoundedShape::new(subject.format.shape(), log2_side);
    let cache = MachineCache {
        lines: 1024,
        ..MachineCache::default()
    };
    ExactMachineShape::new(bounded, effort, &cache, true)
}

/// Runs a machine; answers how many hits are not the walk's, lost or duplicated ones among them.
fn run(
    subject: &Subject,
    shape: &ExactMachineShape,
    traffic: Traffic,
    plant: impl Fn(&mut ExactHit),
) -> (RunSummary<ExactCounts>, u64) {
    let lines = subject.pyramid.lines(shape.bounded.log2_side);
    let run = ExactRun {
        shape: shape.clone(),
        lines,
        rays: &subject.rays,
        gaps: traffic.gaps,
        stalls: traffic.stalls,
        receiver_starts: traffic.receiver_starts,
        memory: traffic.memory,
    };
    let mut hits: HashMap<u32, FixedHit> = HashMap::new();
    let mut wrong = 0;
    let summary = run.run(|machine, inputs, outputs| {
        assert!(!outputs.error);
        if outputs.hit_valid && inputs.hit_ready {
            let mut hit = machine.hit();
            plant(&mut hit);
            let again = hits.insert(hit.id, hit.fixed_hit(shape.bounded));
            wrong += u64::from(again.is_some());
        }
        ControlFlow::Continue(())
    });
    for (ray, id) in subject.rays.iter().zip(0..) {
        let expected = bounded_walk(shape.bounded, lines, ray);
        wrong += u64::from(hits.get(&id) != Some(&expected));
    }
    (summary, wrong)
}

const CONFIGURATIONS: [(&str, u32, ExactEffort); 2] = [
    ("area", 1, ExactEffort::AREA),
    ("throughput", 2, ExactEffort::THROUGHPUT),
];

#[test]
fn hits_are_those_of_the_walk_with_and_without_stalls() {
    let stalling = Traffic {
        gaps: StallPattern::one_in_eight(3),
        stalls: StallPattern::one_in_eight(77),
        receiver_starts: 0,
        memory: AxiMemoryShape {
            stalls: Some(19),
            ..MEMORY
        },
    };
    for subject in subjects(48, 32, |_, _| true) {
        for (name, log2_side, effort) in CONFIGURATIONS {
            let shape = shape(&subject, log2_side, effort);
            for traffic in [free(), stalling] {
                let (summary, wrong) = run(&subject, &shape, traffic, |_| ());
                let subject_name = (subject.name, subject.camera, name);
                assert_eq!(summary.hits, subject.rays.len() as u64, "{subject_name:?}");
                assert_eq!(wrong, 0, "{subject_name:?}");
            }
        }
    }
}

#[test]
fn a_receiver_that_is_long_not_ready_stops_no_walk_for_good() {
    let rocks = subjects(64, 48, |map, camera| map == "rocks" && camera == "oblique");
    let late = Traffic {
        receiver_starts: 20_000,
        ..free()
    };
    for (_, log2_side, effort) in CONFIGURATIONS {
        let shape = shape(&rocks[0], log2_side, effort);
        let (summary, wrong) = run(&rocks[0], &shape, late, |_| ());
        assert_eq!((summary.hits, wrong), (rocks[0].rays.len() as u64, 0));
        assert!(summary.cycles > 19_000, "{}", summary.cycles);
    }
}

#[test]
fn wrong_hits_are_seen() {
    let rocks = subjects(32, 24, |map, camera| map == "rocks" && camera == "oblique");
    let shape = shape(&rocks[0], 1, ExactEffort::AREA);
    let plants: [fn(&mut ExactHit); 4] = [
        |hit| hit.i ^= u32::from(hit.id == 17),
        |hit| hit.depth ^= i64::from(hit.id == 17),
        |hit| hit.at_border_u ^= hit.id == 17,
        |hit| hit.id -= u32::from(hit.id == 17),
    ];
    let mut seen = 0;
    for plant in plants {
        let (_, wrong) = run(&rocks[0], &shape, free(), plant);
        seen += u32::from(wrong > 0);
    }
    // A depth does not count where a side is hit.
    assert!(seen >= 3, "{seen}");
}

/// The figures of a frame of 800 x 480.
#[test]
#[ignore = "whole frames: run with --release -- --ignored --nocapture"]
fn frames_keep_the_loop_full() {
    let all = std::env::var("ALL_SUBJECTS").is_ok();
    println!(
        "map camera configuration | cycles a ray, occupancy | trips, refusals a ray, hit rate, bytes a ray | Mcycles/s"
    );
    let wanted = |map: &str, camera: &str| all || (map == "rocks" && camera == "oblique");
    for subject in subjects(800, 480, wanted) {
        for (name, log2_side, effort) in CONFIGURATIONS {
            let shape = shape(&subject, log2_side, effort);
            let start = std::time::Instant::now();
            let lines = subject.pyramid.lines(log2_side);
            let run = ExactRun {
                shape,
                lines,
                rays: &subject.rays,
                gaps: StallPattern::never(),
                stalls: StallPattern::never(),
                receiver_starts: 0,
                memory: MEMORY,
            };
            let summary = run.run(|_, _, _| ControlFlow::Continue(()));
            let seconds = start.elapsed().as_secs_f64();
            let rays = summary.hits as f64;
            println!(
                "{} {} {name} | {:.3} {:.4} | {:.3} {:.3} {:.4} {:.2} | {:.2}",
                subject.name,
                subject.camera,
                summary.cycles_per_ray(),
                summary.occupancy(),
                summary.counts.trips as f64 / rays,
                summary.counts.refusals as f64 / rays,
                summary.hit_rate(),
                summary.bytes as f64 / rays,
                summary.cycles as f64 / seconds / 1e6
            );
            if (subject.name, subject.camera) == ("rocks", "oblique") {
                let most_cycles = if log2_side == 1 { 11.5 } else { 8.0 };
                assert!(summary.cycles_per_ray() < most_cycles);
                assert!(summary.occupancy() >= 0.97);
            }
        }
    }
}
