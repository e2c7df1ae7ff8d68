//! A policy that goes up at any border must remember what it has passed: with that switched off,
//! walks go down into what they have left; some never end, the others take more steps.

use rtl_model::maps::{Channel, MapSource, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::readings::{E7F16, ExactReading, FloatReading, NumberFormat};
use rtl_model::scene::{Family, Method};
use rtl_model::units::node_step::NodeStep;
use rtl_model::units::step::{Signal, Step};
use rtl_model::units::traverse::shape_for;

/// Far more steps than any of the walks below takes.
const MANY_STEPS: i64 = 2_000;

/// Steps of a walk to its hit, `MANY_STEPS` if it does not get there. With `forgets`, the borders
/// passed are set back before each step.
fn steps_of<R: NumberFormat>(
    reading: &mut R,
    step: NodeStep,
    pyramid: &Pyramid,
    ray: Ray<f64>,
    forgets: bool,
) -> i64 {
    reading.forget();
    let ports = step.enter(reading, ray);
    let mut row = step.set_up(reading, &ports);
    let first = step.ray_registers().len();
    let registers = step.walk_registers();
    let place = |name| {
        let place = registers.iter().position(|(register, _)| *register == name);
        first + place.expect("a declared register")
    };
    let borders = ["passed_border_i", "passed_border_j"].map(place);
    let start = borders.map(|border| row[border].integer());
    let memory = step.memory(pyramid);
    for steps in 1..MANY_STEPS {
        if forgets {
            for (border, start) in borders.into_iter().zip(start) {
                row[border] = Signal::Integer(start);
            }
        }
        let address = step.address(reading, &row);
        let height = i64::from(memory[address as usize]);
        let (walk, _) = step.step(reading, &row, &[height]);
        row.splice(first.., walk);
        if row[place("hit")].bit() {
            return steps;
        }
    }
    MANY_STEPS
}

/// Walks that never end, and the steps of all.
fn walks<R: NumberFormat>(reading: &mut R, method: Method, forgets: bool) -> (u32, i64) {
    let Family::Nodes(policy) = method.family() else {
        panic!("{method} looks at nodes");
    };
    assert!(policy.remembers_borders());
    let source: MapSource = "procedural:spikes:32:3".parse().expect("a recipe");
    let map = source.load(Channel::Grey, false).expect("a procedural map");
    let pyramid = Pyramid::new(&map);
    let step = NodeStep {
        shape: shape_for(&pyramid),
        policy,
    };
    let (mut endless, mut all) = (0, 0);
    for n in 0..100 {
        let n = f64::from(n);
        let ray = Ray {
            u: (n * 0.013).fract(),
            v: (n * 0.029).fract(),
            du: (n * 0.7).sin() * 3.0,
            dv: (n * 1.3).cos(),
        };
        let steps = steps_of(reading, step, &pyramid, ray, forgets);
        endless += u32::from(steps == MANY_STEPS);
        all += steps;
    }
    (endless, all)
}

#[test]
fn a_walk_that_goes_up_at_every_border_and_forgets_never_ends() {
    let float = &mut FloatReading(E7F16);
    assert_eq!(walks(float, Method::Drobot, false).0, 0);
    let (endless, _) = walks(float, Method::Drobot, true);
    println!("{endless} of 100 walks that forget never end");
    assert!(endless > 50, "{endless} of 100");
}

/// Without rounding too: at the border the near child is the one, and that has been left.
#[test]
fn an_exact_walk_that_forgets_never_ends() {
    let exact = &mut ExactReading::default();
    assert_eq!(walks(exact, Method::Drobot, false).0, 0);
    assert!(walks(exact, Method::Drobot, true).0 > 50);
}

/// A crossing does not go up where the last did, so these get on; but every ascent takes them back.
#[test]
fn a_walk_that_goes_up_at_second_borders_and_forgets_takes_longer() {
    for method in [Method::CoherentUp, Method::MixedCoherent] {
        let float = &mut FloatReading(E7F16);
        let (endless, steps) = walks(float, method, false);
        assert_eq!(endless, 0, "{method}");
        let (_, more_steps) = walks(float, method, true);
        println!("{method}: {steps} steps, {more_steps} where it forgets");
        assert!(more_steps > steps + steps / 20, "{method}");
    }
}
