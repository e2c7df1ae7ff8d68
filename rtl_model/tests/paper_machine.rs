//! The paper's machine against the golden walk: every ray comes out once, with the golden hit,
//! whatever stalls; and the loop is full while rays wait.

use std::ops::ControlFlow;
use std::path::Path;

use rtl_model::calibration::{CAMERAS, SURFACES, real_maps};
use rtl_model::camera::View;
use rtl_model::machine::{
    AxiMemoryShape, HitLedger, PaperCounts, PaperInputs, PaperMachine, PaperOutputs, PaperRun,
    PaperShape, RunSummary, StallPattern,
};
use rtl_model::maps::{Channel, HeightMap, MapSource, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::readings::{E7F16, FloatReading, enter};
use rtl_model::scene::{Machine, MachineKind};
use rtl_model::units::paper_step::{HeightLayout, PaperStep};
use rtl_model::units::traverse::shape_for;

/// Stages 0 to 14.
const PASS_CYCLES: u32 = 14;

const MEMORY: AxiMemoryShape = AxiMemoryShape {
    latency: 20,
    bytes_per_cycle: 8,
    outstanding: 4,
    stalls: None,
};

fn shape(pyramid: &Pyramid, layout: HeightLayout, machine: &Machine) -> PaperShape {
    let step = PaperStep {
        shape: shape_for(pyramid),
        layout,
    };
    PaperShape::new(step, 24, machine)
}

fn entered(rays: impl IntoIterator<Item = Ray<f64>>) -> Vec<Ray<u64>> {
    let mut reading = FloatReading(E7F16);
    let rays = rays.into_iter();
    rays.map(|ray| enter(&mut reading, ray)).collect()
}

/// Runs, and holds every hit against the golden walk.
fn check(run: &PaperRun<'_>) -> RunSummary<PaperCounts> {
    let mut ledger = HitLedger::new(run.golden_hits(&FloatReading(E7F16)));
    type Walking = PaperMachine<FloatReading<E7F16>>;
    let each = |machine: &Walking, inputs: &PaperInputs, outputs: &PaperOutputs| {
        if outputs.hit_valid && inputs.hit_ready {
            ledger.enter(machine.hit());
        }
        assert!(!outputs.error);
        ControlFlow::Continue(())
    };
    let summary = run.run(FloatReading(E7F16), each);
    assert_eq!(summary.hits, run.rays.len() as u64);
    assert!(ledger.report().agrees(), "{:?}", ledger.report());
    summary
}

#[test]
fn every_ray_leaves_once_with_the_golden_hit_whatever_stalls() {
    let source: MapSource = "procedural:spikes:64:5".parse().unwrap();
    let pyramid = Pyramid::new(&source.load(Channel::Grey, false).unwrap());
    let rays = entered((0..1500).map(|n| {
        let n = f64::from(n);
        Ray {
            u: (n * 0.013).fract(),
            v: (n * 0.029).fract(),
            du: (n * 0.7).sin() * 3.0,
            dv: (n * 1.3).cos(),
        }
    }));
    for (fifo, lines, seed) in [(16, 64, None), (4, 8, Some(7)), (16, 32, Some(0xace1))] {
        let mut machine = Machine::of_kind(MachineKind::Paper);
        machine.fifo = Some(fifo);
        machine.cache.lines = lines;
        let pattern = |turned: u32| match seed {
            Some(seed) => StallPattern::one_in_eight(u16::rotate_left(seed, turned)),
            None => StallPattern::never(),
        };
        let summary = check(&PaperRun {
            shape: shape(&pyramid, HeightLayout::Tiles, &machine),
            pyramid: &pyramid,
            rays: &rays,
            gaps: pattern(3),
            stalls: pattern(0),
            memory: AxiMemoryShape {
                stalls: seed,
                ..MEMORY
            },
            pass_cycles: PASS_CYCLES,
        });
        assert!(summary.counts.misses > 0);
        if seed.is_none() {
            assert!(summary.occupancy() >= 0.97, "{}", summary.occupancy());
        }
    }
}

/// The rays of a frame of Rocks from the oblique camera, in blocks of so many pixels a side.
fn rocks_oblique(view: &View, block: u32) -> Vec<Ray<u64>> {
    let mut pixels: Vec<(u32, u32)> = (0..480)
        .flat_map(|y| (0..800).map(move |x| (x, y)))
        .collect();
    pixels.sort_by_key(|&(x, y)| (y / block, x / block, y, x));
    let rays = pixels.into_iter().filter_map(|(x, y)| view.ray(x, y));
    entered(rays.map(|ray| ray.reduced()))
}

#[test]
fn rocks_takes_no_more_cycles_than_asked_for() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let Some(folder) = real_maps(&root).unwrap() else {
        eprintln!("left out, no real height maps: set STEPWELL_MAPS to their folder");
        return;
    };
    let rocks = &SURFACES[0];
    let map = HeightMap::load(&folder.join(rocks.file), Channel::Alpha, false).unwrap();
    let pyramid = Pyramid::new(&map);
    let view = View::new(&CAMERAS[1].1, &rocks.surface, 800, 480);
    let rays = rocks_oblique(&view, 16);
    let mut machine = Machine::of_kind(MachineKind::Paper);
    machine.cache.lines = 1024;
    let run = PaperRun {
        shape: shape(&pyramid, HeightLayout::Tiles, &machine),
        pyramid: &pyramid,
        rays: &rays,
        gaps: StallPattern::never(),
        stalls: StallPattern::never(),
        memory: MEMORY,
        pass_cycles: PASS_CYCLES,
    };
    let summary = run.run(FloatReading(E7F16), |_, _, _| ControlFlow::Continue(()));
    assert_eq!(summary.hits, rays.len() as u64);
    assert!(summary.occupancy() >= 0.97, "{}", summary.occupancy());
    assert!(summary.hit_rate() >= 0.97, "{}", summary.hit_rate());
    let cycles = summary.cycles_per_ray();
    assert!((17.0..18.5).contains(&cycles), "{cycles}");
}
