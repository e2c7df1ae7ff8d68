//! The paper's traverse unit, its loop alone and the whole, beside the golden machine:
//! every register and control signal, every cycle, with and without stalls; a planted fault shows.

use std::sync::Arc;

use hdl_gen::datapath::OperatorLatencies;
use hdl_gen::netlist::Module;
use hdl_gen::units::{PaperLoop, PaperUnit};
use hdl_gen::verify::{PaperDesign, Verilator};
use rtl_model::float::FloatFormat;
use rtl_model::machine::{AxiMemoryShape, PaperRun, PaperShape, StallPattern};
use rtl_model::maps::{Channel, MapSource, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::readings::{E7F16, FloatReading, enter};
use rtl_model::scene::{Machine, MachineKind};
use rtl_model::units::paper_step::{HeightLayout, PaperStep};
use rtl_model::units::traverse::shape_for;

fn pyramid() -> Pyramid {
    let source: MapSource = "procedural:spikes:64:5".parse().unwrap();
    Pyramid::new(&source.load(Channel::Grey, false).unwrap())
}

fn rays(count: u32) -> Vec<Ray<u64>> {
    let mut reading = FloatReading(E7F16);
    let ray = |n: u32| {
        let n = f64::from(n);
        Ray {
            u: (n * 0.013).fract(),
            v: (n * 0.029).fract(),
            du: (n * 0.7).sin() * 3.0,
            dv: (n * 1.3).cos(),
        }
    };
    (0..count).map(|n| enter(&mut reading, ray(n))).collect()
}

fn built(pyramid: &Pyramid, machine: &Machine) -> PaperLoop {
    let step = PaperStep {
        shape: shape_for(pyramid),
        layout: HeightLayout::Tiles,
    };
    let shape = PaperShape::new(step, 24, machine);
    PaperLoop::build(&shape, FloatFormat::E7F16, &OperatorLatencies::PAPER)
}

fn run<'a>(
    paper: &PaperLoop,
    pyramid: &'a Pyramid,
    rays: &'a [Ray<u64>],
    seed: Option<u16>,
) -> PaperRun<'a> {
    let pattern = |turned: u32| match seed {
        Some(seed) => StallPattern::one_in_eight(seed.rotate_left(turned)),
        None => StallPattern::never(),
    };
    PaperRun {
        shape: paper.shape.clone(),
        pyramid,
        rays,
        gaps: pattern(3),
        stalls: pattern(0),
        memory: AxiMemoryShape {
            latency: 20,
            bytes_per_cycle: 8,
            outstanding: 4,
            stalls: seed,
        },
        pass_cycles: paper.step.latency,
    }
}

#[test]
fn every_register_of_the_loop_is_the_golden_one_in_every_cycle() {
    let pyramid = pyramid();
    let rays = rays(150);
    for (counters, seed) in [(true, None), (false, Some(0xace1))] {
        let mut machine = Machine::of_kind(MachineKind::Paper);
        machine.counters = counters;
        machine.cache.lines = 16;
        let paper = built(&pyramid, &machine);
        assert_eq!(paper.step.latency, 14, "fifteen stages");
        let design = PaperDesign::of_loop(&paper);
        let comparison = design
            .compare(&run(&paper, &pyramid, &rays, seed), E7F16, |run| {
                run.embedded()
            })
            .unwrap();
        assert_eq!(comparison.first, [], "{}", comparison.mismatches);
        assert_eq!(comparison.rays, 150);
        assert!(comparison.signals_compared > 200 && comparison.cycles > 1500);
    }
}

#[test]
fn a_controller_that_admits_too_many_is_seen() {
    let pyramid = pyramid();
    let rays = rays(60);
    let mut machine = Machine::of_kind(MachineKind::Paper);
    machine.fifo = Some(4);
    let paper = built(&pyramid, &machine);
    let mut design = PaperDesign::of_loop(&paper);
    let mut faulty = Module::clone(&paper.design);
    // The controller's bound is the constant 4 in the bits of its count: one more is a fault.
    let bits = paper.shape.inside_bits();
    let bound = faulty.nodes.iter_mut().find(|node| {
        node.width == bits && node.operation == hdl_gen::netlist::Operation::Constant(4)
    });
    bound.unwrap().operation = hdl_gen::netlist::Operation::Constant(5);
    design.design = Arc::new(faulty);
    let comparison = design
        .compare(&run(&paper, &pyramid, &rays, None), E7F16, |run| {
            run.embedded()
        })
        .unwrap();
    let signals: Vec<&str> = comparison
        .first
        .iter()
        .map(|one| one.signal.as_str())
        .collect();
    assert!(signals.contains(&"admits"), "{signals:?}");
}

#[test]
fn every_register_of_the_unit_is_the_golden_one_in_every_cycle() {
    let pyramid = pyramid();
    let rays = rays(150);
    for (counters, seed) in [(true, None), (false, Some(0xace1))] {
        let mut machine = Machine::of_kind(MachineKind::Paper);
        machine.counters = counters;
        machine.cache.lines = 16;
        let unit = PaperUnit::build(&built(&pyramid, &machine));
        let run = run(&unit.paper, &pyramid, &rays, seed);
        let comparison = PaperDesign::of_unit(&unit)
            .compare(&run, E7F16, |run| run.embedded())
            .unwrap();
        assert_eq!(comparison.first, [], "{}", comparison.mismatches);
        assert_eq!(comparison.rays, 150);
        assert!(comparison.signals_compared > 300 && comparison.cycles > 1500);
    }
}

#[test]
fn the_unit_agrees_under_verilator() {
    let verilator = match Verilator::find() {
        Ok(verilator) => verilator,
        Err(why) if std::env::var_os("CI").is_none() => {
            eprintln!("left out: {why}");
            return;
        }
        Err(why) => panic!("{why}"),
    };
    let pyramid = pyramid();
    let rays = rays(1000);
    let machine = Machine::of_kind(MachineKind::Paper);
    let unit = PaperUnit::build(&built(&pyramid, &machine));
    let run = run(&unit.paper, &pyramid, &rays, Some(0xbeef));
    let comparison = PaperDesign::of_unit(&unit)
        .compare(&run, E7F16, |run| run.verilator(&verilator, None, |_| ()))
        .unwrap();
    assert_eq!(comparison.first, [], "{}", comparison.mismatches);
    assert_eq!(comparison.rays, 1000);
}
