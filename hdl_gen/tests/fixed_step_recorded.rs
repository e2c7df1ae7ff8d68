//! The exact fixed-point step as a netlist is recorded from: every word within the recorder's 64
//! bits, no float in it, and no divider.

use hdl_gen::datapath::{Kind, RecordedOperation, Recorder};
use rtl_model::fixed::FixedFormat;
use rtl_model::float::FloatFormat;
use rtl_model::maps::{HeightMap, Pyramid};
use rtl_model::ray_format::RayFormat;
use rtl_model::scene::{Family, Method};
use rtl_model::units::fixed_node_step::FixedStep;
use rtl_model::units::step::{Register, RegisterKind, Signal, Step};

fn inputs(recorder: &mut Recorder, registers: &[Register]) -> Vec<Signal<Recorder>> {
    let input = |&(name, kind): &Register| match kind {
        RegisterKind::Number => Signal::Number(recorder.num_input(name, 0)),
        RegisterKind::Integer(bits) => Signal::Integer(recorder.int_input(name, bits, 0)),
        RegisterKind::Bit => Signal::Bit(recorder.bit_input(name, 0)),
    };
    registers.iter().map(input).collect()
}

fn output(recorder: &mut Recorder, registers: &[Register], signals: &[Signal<Recorder>]) {
    assert_eq!(registers.len(), signals.len());
    for ((name, _), signal) in registers.iter().zip(signals) {
        match *signal {
            Signal::Number(signal) => recorder.output(*name, signal),
            Signal::Integer(signal) => recorder.output(*name, signal),
            Signal::Bit(signal) => recorder.output(*name, signal),
        }
    }
}

#[test]
fn every_fixed_step_is_recorded_without_floats_or_dividers() {
    let mut recorded = 0;
    for (size, bits) in [(1, 8), (256, 8), (4096, 8), (4096, 16)] {
        let heights = vec![0; (size * size) as usize];
        let pyramid = Pyramid::new(&HeightMap::new("flat", size, bits, heights).unwrap());
        let finest = (bits..50)
            .rev()
            .map(|fraction| FixedFormat::q(64 - fraction, fraction));
        let finest = finest
            .filter_map(|format| RayFormat::told(format, &pyramid).ok())
            .next()
            .expect("a finest format");
        for format in [RayFormat::within_reach(&pyramid), finest] {
            for method in Method::ALL {
                let Family::Nodes(policy) = method.family() else {
                    continue;
                };
                let step = FixedStep::new(format, policy);
                let mut recorder = Recorder::new(FloatFormat::E7F16);
                let ports = inputs(&mut recorder, &step.ray_ports());
                let declared = [step.ray_registers(), step.walk_registers()].concat();
                let set_up = step.set_up(&mut recorder, &ports);
                output(&mut recorder, &declared, &set_up);
                let row = inputs(&mut recorder, &declared);
                step.address(&mut recorder, &row);
                let height = recorder.height_input("height", bits, 0);
                let (walk, _) = step.step(&mut recorder, &row, &[height]);
                output(&mut recorder, &step.walk_registers(), &walk);

                let recording = recorder.finish();
                let registers = declared
                    .iter()
                    .chain(&declared[step.ray_registers().len()..]);
                assert_eq!(recording.outputs.len(), registers.clone().count());
                for (output, (name, kind)) in recording.outputs.iter().zip(registers) {
                    let width = recording.width(output.signal);
                    let declared = match kind {
                        RegisterKind::Integer(bits) => *bits,
                        RegisterKind::Bit => 1,
                        RegisterKind::Number => panic!("{name} is a float"),
                    };
                    assert!(
                        width <= declared,
                        "{method}: {name} of {width} bits, not {declared}"
                    );
                }
                let floats = recording
                    .signals
                    .iter()
                    .filter(|signal| signal.kind == Kind::Num);
                assert_eq!(floats.count(), 0, "{method}");
                // Height by slope, on either axis, and the setup's two for the error term.
                let products = recording
                    .signals
                    .iter()
                    .filter(|signal| matches!(signal.operation, RecordedOperation::IntMul(..)));
                assert_eq!(products.count(), 2 + 2, "{method}");
                recorded += 1;
            }
        }
    }
    assert_eq!(recorded, 4 * 2 * 10);
}
