//! Crossing by an offset, beside the carried index: what is published is wrong where the offset is
//! large, and never ends where it is small.

use rtl_model::judge::{Truth, Verdict};
use rtl_model::maps::{HeightMap, MapSource, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::readings::{E7F16, F64Reading, FloatReading, NumberFormat, enter};
use rtl_model::scene::{Crossing, Family, Method};
use rtl_model::units::linear_ray::{LinearRay, NOMINAL_DEPTH, SampleRange};
use rtl_model::units::linear_step::LinearStep;
use rtl_model::units::linear_walk::{linear_shape_for, pom_walk, relief_walk};
use rtl_model::units::offset_node_step::OffsetNodeStep;
use rtl_model::units::offset_walk::{offset_shape_for, walk_by_offset};
use rtl_model::units::search_policy::SearchPolicy;
use rtl_model::units::step::{Signal, Step};
use rtl_model::units::traverse::{Hit, Status};

fn map(recipe: &str) -> HeightMap {
    let source = MapSource::parse(recipe).expect("a recipe");
    let map = source.load(Default::default(), false);
    map.expect("a procedural map")
}

fn rays(count: u32, reach: f64) -> Vec<Ray<f64>> {
    let ray = |n: f64| Ray {
        u: (n * 0.013).fract(),
        v: (n * 0.029).fract(),
        du: (n * 0.7).sin() * reach,
        dv: (n * 1.3).cos() * reach,
    };
    (0..count).map(f64::from).map(ray).collect()
}

fn judged(format: &str, map: &HeightMap, rays: &[Ray<f64>], crossing: &str) -> Verdict {
    let pyramid = Pyramid::new(map);
    let format = format.parse().expect("a format");
    let truth = Truth::of(format, map, &pyramid, rays, &|_| ()).expect("sound rays");
    let crossing = crossing.parse().expect("a crossing");
    truth
        .judge_walk(Method::Oh, crossing, &pyramid, &|_| ())
        .expect("oh by an offset")
}

#[test]
fn the_larger_the_offset_the_more_texels_are_wrong() {
    let (map, rays) = (map("procedural:rocks:256:1"), rays(4000, 1.0));
    let wrong = |crossing| judged("f64", &map, &rays, crossing).wrong;
    let offsets = ["offset:0.5", "offset:0.0625", "offset:0.001", "index"].map(wrong);
    assert!(offsets[0] > 200, "{offsets:?} of 4000");
    assert!(offsets.is_sorted_by(|a, b| a > b), "{offsets:?} of 4000");
    assert_eq!(offsets[3], 0);
}

#[test]
fn an_offset_that_rounding_eats_never_ends() {
    let (map, rays) = (map("procedural:rocks:1024:1"), rays(1000, 0.5));
    let guards = |crossing| judged("e7f16", &map, &rays, crossing).guards;
    let offsets = ["offset:0.5", "offset:0.0001", "index"].map(guards);
    assert!(offsets[1] > 200, "{offsets:?} of 1000");
    assert_eq!((offsets[0], offsets[2]), (0, 0));
}

#[test]
fn steps_are_those_of_the_method() {
    let (map, rays) = (map("procedural:rocks:64:1"), rays(500, 1.0));
    let pyramid = Pyramid::new(&map);
    for ray in rays {
        let shape = offset_shape_for(&pyramid, SearchPolicy::OH, 1e-9);
        let hit = walk_by_offset(&mut F64Reading, shape, pyramid.memory(), ray);
        assert_eq!(hit.steps, pyramid.levels() + 1 + hit.crossings);
    }
}

#[test]
fn every_policy_finds_nearly_every_texel_by_a_small_offset() {
    let (map, rays) = (map("procedural:rocks:128:1"), rays(1000, 1.0));
    let pyramid = Pyramid::new(&map);
    let truth = Truth::of(
        "f64".parse().expect("a format"),
        &map,
        &pyramid,
        &rays,
        &|_| (),
    );
    let truth = truth.expect("sound rays");
    let crossing: Crossing = "offset:0.000001".parse().expect("a crossing");
    let mut policies = 0;
    for method in Method::ALL {
        if let Family::Nodes(_) = method.family() {
            let verdict = truth.judge_walk(method, crossing, &pyramid, &|_| ());
            let verdict = verdict.expect("a node method by an offset");
            assert!(verdict.wrong <= 2, "{method}: {verdict:?}");
            assert_eq!(verdict.guards, 0, "{method}");
            policies += 1;
        }
    }
    assert_eq!(policies, 10);
}

/// Walks a ray by the registers in a row, to its end, without a short cut.
fn walked_in_a_row<R: NumberFormat, S: Step>(
    reading: &mut R,
    step: &S,
    pyramid: &Pyramid,
    ray: Ray<f64>,
) -> Hit<R::Num> {
    let memory = step.memory(pyramid);
    let names: Vec<&str> = step.ray_registers().iter().map(|(name, _)| *name).collect();
    let walk_names: Vec<&str> = step
        .walk_registers()
        .iter()
        .map(|(name, _)| *name)
        .collect();
    let ports = step.enter_over(reading, pyramid, ray);
    assert_eq!(ports.len(), step.ray_ports().len());
    let mut registers = step.set_up(reading, &ports);
    assert_eq!(registers.len(), names.len() + walk_names.len());
    loop {
        let address = step.address(reading, &registers);
        assert!(address >= 0 && address >> step.address_bits() == 0);
        let height = i64::from(memory[address as usize]);
        let (walk, answer) = step.step(reading, &registers, &[height]);
        registers.splice(names.len().., walk);
        let register = |name| -> Signal<R> {
            let place = walk_names.iter().position(|known| *known == name);
            registers[names.len() + place.expect("a register of the walk")]
        };
        let answer = |name| -> Signal<R> {
            let found = answer.iter().find(|(known, _)| *known == name);
            found.expect("part of the answer").1
        };
        if register("hit").bit() || register("guard").bit() {
            // Ended: another step changes nothing.
            let (again, _) = step.step(reading, &registers, &[height]);
            for (before, after) in registers[names.len()..].iter().zip(&again) {
                match (before, after) {
                    (Signal::Integer(a), Signal::Integer(b)) => assert_eq!(a, b),
                    (Signal::Bit(a), Signal::Bit(b)) => assert_eq!(a, b),
                    (&Signal::Number(a), &Signal::Number(b)) => {
                        assert_eq!(reading.to_f64(a), reading.to_f64(b));
                    }
                    _ => panic!("another kind of register"),
                }
            }
            return Hit {
                i: answer("texel_i").integer() as u32,
                j: answer("texel_j").integer() as u32,
                t: register("t").number(),
                u: answer("position_u").number(),
                v: answer("position_v").number(),
                steps: register("steps").integer() as u32,
                crossings: register("crossings").integer() as u32,
                status: match register("hit").bit() {
                    true => Status::Hit,
                    false => Status::Guard,
                },
            };
        }
    }
}

#[test]
fn registers_in_a_row_walk_as_the_typed_ones_and_hang_as_long() {
    let map = map("procedural:rocks:1024:1");
    let pyramid = Pyramid::new(&map);
    let mut hangs = 0;
    let mut reading = FloatReading(E7F16);
    for method in [Method::Oh, Method::MixedSelective, Method::MixedCoherent] {
        let Family::Nodes(policy) = method.family() else {
            panic!("a node method");
        };
        let shape = offset_shape_for(&pyramid, policy, 1e-4);
        for ray in rays(40, 0.5) {
            let row = walked_in_a_row(&mut reading, &OffsetNodeStep { shape }, &pyramid, ray);
            let entered = enter(&mut reading, ray);
            let typed = walk_by_offset(&mut reading, shape, pyramid.memory(), entered);
            assert_eq!(row, typed, "{method}");
            hangs += u32::from(typed.status == Status::Guard);
        }
    }
    assert!((10..110).contains(&hangs), "{hangs} of 120");
}

#[test]
fn samplers_in_a_row_search_as_the_typed_ones() {
    let map = map("procedural:rocks:64:1");
    let pyramid = Pyramid::new(&map);
    let shape = linear_shape_for(&pyramid);
    let mut reading = FloatReading(E7F16);
    for search in [Method::Relief, Method::Pom, Method::Dig] {
        let Family::Linear(search) = search.family() else {
            panic!("a method that samples");
        };
        for ray in rays(200, 1.0) {
            let step = LinearStep { shape, search };
            let row = walked_in_a_row(&mut reading, &step, &pyramid, ray);
            let entered = enter(&mut reading, ray).map(|number| reading.to_f64(number));
            let samples = match Method::Dig.family() == Family::Linear(search) {
                true => SampleRange::of_listed_ray(&mut reading, &pyramid, ray),
                false => SampleRange::of(search, entered, NOMINAL_DEPTH),
            };
            let ray = LinearRay::enter(&mut reading, ray, samples);
            let typed = match Method::Pom.family() == Family::Linear(search) {
                true => pom_walk(&mut reading, &pyramid, &ray),
                false => relief_walk(&mut reading, &pyramid, &ray),
            };
            assert_eq!(row, typed, "{search:?}");
        }
    }
}
