//! The traverse unit's netlist in the embedded simulator, against the golden machine.

use hdl_gen::datapath::OperatorLatencies;
use hdl_gen::units::{TraverseUnit, UnitConfiguration};
use hdl_gen::verify::{GoldenRun, run_embedded};
use rtl_model::float::FloatFormat;
use rtl_model::machine::StallPattern;
use rtl_model::maps::{Channel, MapSource, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::readings::{E7F16, FloatReading, NumberFormat};
use rtl_model::units::traverse::shape_for;

#[test]
fn every_register_is_the_golden_one_in_every_cycle() {
    let map = MapSource::parse("procedural:rocks:64:1").unwrap().load(Channel::Grey, false).unwrap();
    let pyramid = Pyramid::new(&map);
    let configuration = UnitConfiguration {
        shape: shape_for(&pyramid),
        format: FloatFormat::E7F16,
        latencies: OperatorLatencies::PAPER,
    };
    let unit = TraverseUnit::build(configuration);
    println!("latency {} probes {}", unit.latency, unit.probes.len());
    let mut reading = FloatReading(E7F16);
    let rays: Vec<_> = (0..2000)
        .map(|k| {
            let k = f64::from(k);
            Ray {
                u: reading.coordinate((k * 0.618_034).fract()),
                v: reading.coordinate((k * 0.414_214).fract()),
                du: reading.direction((k * 0.7).sin()),
                dv: reading.direction((k * 1.3).cos() * 2.0),
            }
        })
        .collect();
    let run = GoldenRun {
        pyramid: &pyramid,
        rays: &rays,
        stalls: StallPattern::one_in_eight(7),
        latency: unit.latency,
    };
    let start = std::time::Instant::now();
    let comparison = run_embedded(&unit, &run, |_, _, _| {}).unwrap();
    println!("{comparison:?} {:?}", start.elapsed());
    assert_eq!(comparison.mismatches, 0);
    assert_eq!(comparison.rays, 2000);
    assert_eq!(comparison.guards, 0);
}
