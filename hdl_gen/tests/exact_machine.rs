//! The exact machine beside its golden model: every register and control signal, every cycle, with and
//! without stalls; planted faults show.

use std::sync::Arc;

use hdl_gen::netlist::{Module, Operation};
use hdl_gen::units::ExactUnit;
use hdl_gen::verify::{ExactDesign, Verilator};
use rtl_model::machine::{AxiMemoryShape, ExactEffort, ExactMachineShape, ExactRun, StallPattern};
use rtl_model::maps::{Channel, MapSource, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::ray_format::{QuantisedRay, RayFormat};
use rtl_model::scene::MachineCache;
use rtl_model::units::bounded_shape::BoundedShape;

fn pyramid() -> Pyramid {
    let source: MapSource = "procedural:spikes:64:5".parse().unwrap();
    Pyramid::new(&source.load(Channel::Grey, false).unwrap())
}

fn rays(format: RayFormat, count: u32) -> Vec<QuantisedRay> {
    let ray = |n: u32| {
        let n = f64::from(n);
        Ray {
            u: (n * 0.013).fract(),
            v: (n * 0.029).fract(),
            du: (n * 0.7).sin(),
            dv: (n * 1.3).cos(),
        }
    };
    (0..count).map(|n| format.quantise(ray(n))).collect()
}

fn unit(pyramid: &Pyramid, log2_side: u32, effort: ExactEffort, counters: bool) -> ExactUnit {
    let format = RayFormat::within_reach(pyramid);
    let bounded = BoundedShape::new(format.shape(), log2_side);
    let cache = MachineCache {
        lines: 16,
        ..MachineCache::default()
    };
    ExactUnit::build(&ExactMachineShape::new(bounded, effort, &cache, counters))
}

fn run<'a>(
    unit: &ExactUnit,
    pyramid: &'a Pyramid,
    rays: &'a [QuantisedRay],
    seed: Option<u16>,
) -> ExactRun<'a> {
    let pattern = |turned: u32| match seed {
        Some(seed) => StallPattern::one_in_eight(seed.rotate_left(turned)),
        None => StallPattern::never(),
    };
    ExactRun {
        shape: unit.shape.clone(),
        lines: pyramid.lines(unit.shape.bounded.log2_side),
        rays,
        gaps: pattern(3),
        stalls: pattern(0),
        receiver_starts: if seed.is_some() { 1000 } else { 0 },
        memory: AxiMemoryShape {
            latency: 20,
            bytes_per_cycle: 8,
            outstanding: 4,
            stalls: seed,
        },
    }
}

const CONFIGURATIONS: [(u32, ExactEffort); 2] =
    [(1, ExactEffort::AREA), (2, ExactEffort::THROUGHPUT)];

#[test]
fn every_register_is_the_golden_one_in_every_cycle() {
    let pyramid = pyramid();
    let rays = rays(RayFormat::within_reach(&pyramid), 300);
    for (log2_side, effort) in CONFIGURATIONS {
        for (counters, seed) in [(true, None), (false, Some(0xace1))] {
            let unit = unit(&pyramid, log2_side, effort, counters);
            let run = run(&unit, &pyramid, &rays, seed);
            let comparison = ExactDesign::of(&unit)
                .compare(&run, |run| run.embedded())
                .unwrap();
            assert_eq!(comparison.first, [], "{}", comparison.mismatches);
            assert_eq!(comparison.rays, 300);
            assert!(comparison.signals_compared > 300 && comparison.cycles > 1500);
        }
    }
}

/// A copy of the design in which the first node that is so is changed.
fn planted(
    design: &Module,
    is_it: impl Fn(&Module, &Operation) -> bool,
    change: impl Fn(&mut Operation),
) -> Arc<Module> {
    let mut faulty = design.clone();
    let place = faulty
        .nodes
        .iter()
        .position(|node| is_it(design, &node.operation));
    change(&mut faulty.nodes[place.expect("such a node")].operation);
    Arc::new(faulty)
}

#[test]
fn planted_faults_are_found() {
    let pyramid = pyramid();
    let rays = rays(RayFormat::within_reach(&pyramid), 100);
    let unit = unit(&pyramid, 1, ExactEffort::AREA, false);
    let run = run(&unit, &pyramid, &rays, Some(7));
    let named = |name: &str| {
        let place = unit.design.nodes.iter();
        let mut places = place.map(|node| node.name.as_deref() == Some(name));
        places.position(|is_it| is_it).expect("a named node")
    };
    for name in ["admits", "returns", "missed"] {
        // An and of two that has become an or.
        let mut faulty = Module::clone(&unit.design);
        let operation = &mut faulty.nodes[named(name)].operation;
        let Operation::And(a, b) = *operation else {
            panic!("{name} is {operation:?}");
        };
        *operation = Operation::Or(a, b);
        let mut design = ExactDesign::of(&unit);
        design.design = Arc::new(faulty);
        let comparison = design.compare(&run, |run| run.embedded()).unwrap();
        let signals: Vec<&str> = comparison
            .first
            .iter()
            .map(|one| one.signal.as_str())
            .collect();
        assert!(signals.contains(&name), "{name}: {signals:?}");
    }
    // A memory that is not read.
    let reads =
        |_: &Module, operation: &Operation| matches!(operation, Operation::MemoryRead { .. });
    let mut design = ExactDesign::of(&unit);
    design.design = planted(&unit.design, reads, |operation| {
        *operation = Operation::Constant(0);
    });
    let comparison = design.compare(&run, |run| run.embedded()).unwrap();
    assert!(!comparison.first.is_empty());
}

#[test]
fn the_machine_agrees_under_verilator() {
    let verilator = match Verilator::find() {
        Ok(verilator) => verilator,
        Err(why) if std::env::var_os("CI").is_none() => {
            eprintln!("left out: {why}");
            return;
        }
        Err(why) => panic!("{why}"),
    };
    let pyramid = pyramid();
    let rays = rays(RayFormat::within_reach(&pyramid), 2000);
    let unit = unit(&pyramid, 1, ExactEffort::AREA, true);
    let run = run(&unit, &pyramid, &rays, Some(5));
    let comparison = ExactDesign::of(&unit)
        .compare(&run, |run| run.verilator(&verilator, None, |_| ()))
        .unwrap();
    assert_eq!(comparison.first, [], "{}", comparison.mismatches);
    assert_eq!(comparison.rays, 2000);
}
