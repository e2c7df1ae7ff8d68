//! A step of each kind under Verilator, behind its handshakes with gaps and stalls. What is wrong in
//! the hardware, or in what is expected of it, is seen.

#[path = "common/tools.rs"]
mod tools;

use std::sync::Arc;

use hdl_gen::fault::plant;
use hdl_gen::netlist::Module;
use hdl_gen::units::{UnitConfiguration, build_step_unit};
use hdl_gen::vectors::{Role, VectorSet, idle_step_results, step_vectors};
use hdl_gen::verify::{Comparison, StreamRun, Verilator, random_rays};
use rtl_model::machine::StallPattern;
use rtl_model::maps::{Channel, MapSource, Pyramid};
use rtl_model::scene::{Crossing, Walk};

/// A step with what is sent through it.
struct Subject {
    unit: Arc<Module>,
    set: VectorSet,
    idle_results: Vec<u64>,
}

impl Subject {
    fn new(method: &str, format: &str) -> Subject {
        let source = MapSource::parse("procedural:spikes:64:1").unwrap();
        let pyramid = Pyramid::new(&source.load(Channel::Grey, false).unwrap());
        let walk = Walk {
            method: method.parse().unwrap(),
            format: format.parse().unwrap(),
            crossing: Crossing::Index,
        };
        let configuration = UnitConfiguration::of(walk, &pyramid).unwrap();
        let unit = build_step_unit(&configuration);
        let set = step_vectors(&unit, &configuration, &pyramid, &random_rays(20, 1), 11);
        Subject {
            idle_results: idle_step_results(&unit, &configuration, &pyramid),
            set: set.thinned(100),
            unit,
        }
    }

    fn run(&self, verilator: &Verilator) -> Comparison {
        let fields = self.set.fields.iter();
        let inputs = fields.filter(|field| field.role == Role::Input).count();
        let run = StreamRun {
            unit: &self.unit,
            count: self.set.vectors.len() as u64,
            vectors: &|place, operands, results| {
                let vector = &self.set.vectors[place as usize];
                operands.extend_from_slice(&vector[..inputs]);
                results.extend_from_slice(&vector[inputs..]);
            },
            idle_results: &self.idle_results,
            gaps: StallPattern::one_in_eight(3),
            stalls: StallPattern::one_in_eight(7),
        };
        run.verilator(verilator, None, |_| {}).unwrap()
    }
}

/// The step agrees; with one bit of one expected result inverted it does not.
fn agrees_and_tells_a_wrong_bit(method: &str, format: &str) {
    let Some(verilator) = tools::verilator() else {
        return;
    };
    let mut subject = Subject::new(method, format);
    let sound = subject.run(&verilator);
    assert_eq!(sound.first, [], "{method} {format}");
    assert_eq!(sound.mismatches, 0, "{method} {format}");
    assert_eq!(sound.rays, subject.set.vectors.len() as u64);
    assert!(sound.rays > 50, "{method} {format}: {} steps", sound.rays);

    let middle = subject.set.vectors.len() / 2;
    let last = subject.set.vectors[middle].last_mut().unwrap();
    *last ^= 1;
    let wrong = subject.run(&verilator);
    assert!(
        wrong.mismatches > 0,
        "{method} {format}: a wrong bit unseen"
    );
}

#[test]
fn a_node_step_that_goes_up_in_floats() {
    agrees_and_tells_a_wrong_bit("mixed-selective", "e7f16");
}

#[test]
fn a_node_step_in_fixed_point_and_a_fault_in_it() {
    agrees_and_tells_a_wrong_bit("mixed-selective", "fixed");
    let Some(verilator) = tools::verilator() else {
        return;
    };
    let mut subject = Subject::new("mixed-selective", "fixed");
    subject.unit = plant(&subject.unit, "core_hit", 0).unwrap();
    assert!(subject.run(&verilator).mismatches > 0);
}

#[test]
fn a_wide_step_in_floats() {
    agrees_and_tells_a_wrong_bit("quad", "e7f16");
}

#[test]
fn wide_steps_in_fixed_point() {
    agrees_and_tells_a_wrong_bit("block", "fixed");
    agrees_and_tells_a_wrong_bit("window", "fixed");
}

#[test]
fn a_sampling_step() {
    agrees_and_tells_a_wrong_bit("relief", "e7f16");
}
