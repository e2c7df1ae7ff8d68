//! The golden machines work in the buffers they begin with: ten times the rays allocate no more.

#[path = "common/rays.rs"]
mod rays;

use allocation_counter::measure;
use hdl_gen::datapath::OperatorLatencies;
use hdl_gen::units::{PaperLoop, PaperUnit, TraverseUnit, UnitConfiguration};
use hdl_gen::verify::{GoldenRun, PaperDesign, driven_words, traverse_plan};
use rtl_model::float::FloatFormat;
use rtl_model::machine::{AxiMemoryShape, PaperRun, PaperShape, StallPattern};
use rtl_model::maps::{Channel, MapSource, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::readings::E7F16;
use rtl_model::scene::{Crossing, Machine, MachineKind, Method, Walk, WalkFormat};
use rtl_model::units::paper_step::{HeightLayout, PaperStep};
use rtl_model::units::traverse::shape_for;
use std::ops::ControlFlow;

/// Allocations of a run that packs every cycle's record, and its cycles.
fn allocations(unit: &TraverseUnit, pyramid: &Pyramid, rays: &[Ray<u64>]) -> (u64, u64) {
    let run = GoldenRun {
        pyramid,
        rays,
        stalls: StallPattern::one_in_eight(3),
        step: unit.configuration.step,
        latency: unit.latency,
    };
    let plan = traverse_plan(unit, &run);
    let mut record = Vec::with_capacity(plan.record_bytes());
    let mut cycles = 0;
    let counted = measure(|| {
        cycles = run.run(E7F16, |inputs, _, words| {
            record.clear();
            plan.append_record(&mut record, &driven_words(inputs), &words.0);
            ControlFlow::Continue(())
        });
    });
    (counted.count_total, cycles)
}

#[test]
fn a_run_allocates_nothing_per_cycle() {
    let source = MapSource::parse("procedural:rocks:64:1").unwrap();
    let pyramid = Pyramid::new(&source.load(Channel::Grey, false).unwrap());
    let rays = rays::rays(FloatFormat::E7F16, 1000);
    let offset: Crossing = "offset:0.01".parse().unwrap();
    for (method, crossing) in [
        (Method::Oh, Crossing::Index),
        (Method::MixedSelective, Crossing::Index),
        (Method::MixedSelective, offset),
    ] {
        let walk = Walk {
            method,
            format: WalkFormat::Float(FloatFormat::E7F16),
            crossing,
        };
        let unit = TraverseUnit::build(UnitConfiguration::of(walk, &pyramid).unwrap());
        let (few, few_cycles) = allocations(&unit, &pyramid, &rays[..100]);
        let (many, many_cycles) = allocations(&unit, &pyramid, &rays);
        assert!(many_cycles > 5 * few_cycles, "{few_cycles} {many_cycles}");
        // The machine itself is made of buffers: a count of none would be no count.
        assert!(few > 0, "{walk:?}");
        assert_eq!(few, many, "{walk:?}");
    }
}

/// Allocations of a run of the paper's machine that packs every cycle's record, and its cycles.
fn machine_allocations(unit: &PaperUnit, pyramid: &Pyramid, rays: &[Ray<u64>]) -> (u64, u64) {
    let design = PaperDesign::of_unit(unit);
    let run = PaperRun {
        shape: unit.paper.shape.clone(),
        pyramid,
        rays,
        gaps: StallPattern::one_in_eight(5),
        stalls: StallPattern::one_in_eight(3),
        memory: AxiMemoryShape {
            latency: 20,
            bytes_per_cycle: 8,
            outstanding: 4,
            stalls: Some(7),
        },
        pass_cycles: unit.paper.step.latency,
    };
    design.compare(&run, E7F16, |run| {
        let plan = run.plan();
        let mut record = Vec::with_capacity(plan.record_bytes());
        let mut cycles = 0;
        let counted = measure(|| {
            let _ = (run.traffic)(&mut |driven, words| {
                record.clear();
                plan.append_record(&mut record, driven, words);
                cycles += 1;
                ControlFlow::Continue(())
            });
        });
        (counted.count_total, cycles)
    })
}

#[test]
fn a_run_of_the_papers_machine_allocates_nothing_per_cycle() {
    let source = MapSource::parse("procedural:rocks:64:1").unwrap();
    let pyramid = Pyramid::new(&source.load(Channel::Grey, false).unwrap());
    let rays = rays::rays(FloatFormat::E7F16, 1000);
    let step = PaperStep {
        shape: shape_for(&pyramid),
        layout: HeightLayout::Tiles,
    };
    let shape = PaperShape::new(step, 24, &Machine::of_kind(MachineKind::Paper));
    let latencies = OperatorLatencies::PAPER;
    let unit = PaperUnit::build(&PaperLoop::build(&shape, FloatFormat::E7F16, &latencies));
    let (few, few_cycles) = machine_allocations(&unit, &pyramid, &rays[..100]);
    let (many, many_cycles) = machine_allocations(&unit, &pyramid, &rays);
    assert!(many_cycles > 4 * few_cycles, "{few_cycles} {many_cycles}");
    assert!(few > 0);
    assert_eq!(few, many);
}
