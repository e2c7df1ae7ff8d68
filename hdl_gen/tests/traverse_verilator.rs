//! The traverse unit under Verilator, against the golden machine.

use hdl_gen::datapath::OperatorLatencies;
use hdl_gen::units::{TraverseUnit, UnitConfiguration};
use hdl_gen::verify::*;
use rtl_model::float::FloatFormat;
use rtl_model::machine::StallPattern;
use rtl_model::maps::{Channel, MapSource, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::readings::{E7F16, FloatReading, NumberFormat};
use rtl_model::units::traverse::shape_for;

#[test]
fn verilator_agrees() {
    let map = MapSource::parse("procedural:rocks:64:1")
        .unwrap()
        .load(Channel::Grey, false)
        .unwrap();
    let pyramid = Pyramid::new(&map);
    let unit = TraverseUnit::build(UnitConfiguration {
        shape: shape_for(&pyramid),
        format: FloatFormat::E7F16,
        latencies: OperatorLatencies::PAPER,
    });
    let mut reading = FloatReading(E7F16);
    let rays: Vec<_> = (0..100_000)
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
    let mut n = 0;
    run.run(E7F16, |_, _, w| {
        n += w.0.len();
        std::ops::ControlFlow::Continue(())
    });
    println!("golden alone {:?} words {n}", start.elapsed());
    let v = Verilator::find().unwrap();
    let start = std::time::Instant::now();
    let comparison = run_verilator(&v, &unit, &run, E7F16, None, |_| {}).unwrap();
    println!("{comparison:?} {:?}", start.elapsed());
    let start = std::time::Instant::now();
    let comparison = run_verilator(&v, &unit, &run, E7F16, None, |_| {}).unwrap();
    println!("{comparison:?} {:?}", start.elapsed());
    assert_eq!(comparison.mismatches, 0);
}
