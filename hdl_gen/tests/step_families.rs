//! The step of every method in every kind of format it has, and the loop of those that have one:
//! netlist against golden model, a planted fault in each, and Verilator's lint.

#[path = "common/tools.rs"]
mod tools;

use hdl_gen::fault::plant;
use hdl_gen::units::{TraverseUnit, UnitConfiguration, build_step_unit};
use hdl_gen::vectors::step_vectors;
use hdl_gen::verify::{GoldenRun, Icarus, random_rays, run_embedded, run_vectors_embedded};
use rtl_model::float::FloatFormat;
use rtl_model::machine::StallPattern;
use rtl_model::maps::{Channel, MapSource, Pyramid};
use rtl_model::scene::{Crossing, Family, Method, Walk, WalkFormat};

fn pyramid() -> Pyramid {
    let source = MapSource::parse("procedural:spikes:64:1").unwrap();
    Pyramid::new(&source.load(Channel::Grey, false).unwrap())
}

/// Every method in each of a float and exact fixed point that it has; and a method by an offset.
fn walks() -> Vec<Walk> {
    let formats = [
        WalkFormat::Float(FloatFormat::E7F16),
        WalkFormat::Fixed(None),
    ];
    let levels = [1, 3, 4].map(Method::MultiLevelDown);
    let methods = Method::ALL.into_iter().chain(levels);
    let mut walks: Vec<Walk> = methods
        .flat_map(|method| {
            formats.map(|format| Walk {
                method,
                format,
                crossing: Crossing::Index,
            })
        })
        .filter(|walk| {
            let samples = matches!(walk.method.family(), Family::Linear(_));
            !(samples && walk.format == WalkFormat::Fixed(None))
        })
        .collect();
    walks.extend(Method::FIXED_ONLY.map(|method| Walk {
        method,
        format: formats[1],
        crossing: Crossing::Index,
    }));
    walks.push(Walk {
        method: Method::Tevs,
        format: formats[0],
        crossing: "offset:0.0625".parse().unwrap(),
    });
    walks
}

fn label(walk: Walk) -> String {
    format!("{} {} {}", walk.method, walk.format, walk.crossing)
}

#[test]
fn every_step_is_the_golden_one_and_a_fault_in_it_is_seen() {
    let pyramid = pyramid();
    let walks = walks();
    assert!(walks.len() >= 34);
    for walk in walks {
        let configuration = UnitConfiguration::of(walk, &pyramid).unwrap();
        let unit = build_step_unit(&configuration);
        let rays = random_rays(20, 1);
        let set = step_vectors(&unit, &configuration, &pyramid, &rays, 11);
        let label = label(walk);
        assert!(set.vectors.len() > 30, "{label}: {}", set.vectors.len());
        let verdict = run_vectors_embedded(&unit, &set).unwrap();
        assert!(verdict.passed, "{label}: {verdict:?}");
        assert_eq!(verdict.agreed, set.vectors.len() as u64);

        let step = format!("core.step.hit_s{}", unit.latency);
        let faulty = plant(&unit, &step, 0).or_else(|_| plant(&unit, "core_hit", 0));
        let verdict = run_vectors_embedded(&faulty.unwrap(), &set).unwrap();
        assert!(!verdict.passed, "{label}: a fault unseen");
    }
}

/// The vectors of `dig` carry the samples that each ray's own block leaves it; those of `relief`, the
/// same datapath, always all of them.
#[test]
fn rays_of_depth_interval_grids_carry_intervals_of_their_own() {
    let pyramid = pyramid();
    let intervals = ["relief", "dig"].map(|method| {
        let walk = Walk {
            method: method.parse().unwrap(),
            format: WalkFormat::Float(FloatFormat::E7F16),
            crossing: Crossing::Index,
        };
        let configuration = UnitConfiguration::of(walk, &pyramid).unwrap();
        let unit = build_step_unit(&configuration);
        let set = step_vectors(&unit, &configuration, &pyramid, &random_rays(40, 1), 11);
        let place = |name| set.fields.iter().position(|field| field.name == name);
        let samples = ["first_sample_i", "last_sample_i"].map(|name| place(name).unwrap());
        let vectors = set.vectors.iter();
        vectors
            .map(|vector| samples.map(|place| vector[place]))
            .collect::<std::collections::HashSet<_>>()
    });
    assert_eq!(intervals[0], [[1, 100]].into());
    assert!(intervals[1].len() > 20, "{:?}", intervals[1]);
}

#[test]
fn every_loop_is_the_golden_one_in_every_cycle() {
    let pyramid = pyramid();
    let mut pipelined_setups = 0;
    for walk in walks() {
        let configuration = UnitConfiguration::of(walk, &pyramid).unwrap();
        if configuration.check_loop().is_err() {
            continue;
        }
        let unit = TraverseUnit::build(configuration);
        let rays: Vec<_> = random_rays(40, 1)
            .into_iter()
            .map(|ray| configuration.port_words(ray))
            .collect();
        let run = GoldenRun {
            pyramid: &pyramid,
            rays: &rays,
            stalls: StallPattern::one_in_eight(7),
            step: configuration.step,
            latency: unit.latency,
        };
        let label = label(walk);
        let comparison = run_embedded(&unit, &run, |_, _, _| {}).unwrap();
        assert_eq!(comparison.first, [], "{label}");
        assert_eq!(comparison.mismatches, 0, "{label}");
        assert_eq!(comparison.rays, rays.len() as u64, "{label}");
        if walk.crossing == Crossing::Index {
            assert_eq!(comparison.guards, 0, "{label}");
        }
        if unit.latency.setup == 0 {
            continue;
        }
        // The setup's control and its arithmetic.
        pipelined_setups += 1;
        let register = unit.probes.iter().find(|probe| probe.scope.len() == 2);
        let register = register.map(|probe| format!("{}.{}", probe.scope[1], probe.name));
        for path in ["setup_valid_s1", &register.unwrap()] {
            let faulty = TraverseUnit {
                design: plant(&unit.design, path, 0).unwrap(),
                ..unit.clone()
            };
            let found = run_embedded(&faulty, &run, |_, _, _| {}).unwrap();
            assert!(found.mismatches > 0, "{label}: a fault of {path} unseen");
        }
    }
    assert!(pipelined_setups >= 4, "{pipelined_setups}");
}

/// Icarus reads the ports by the testbench, whose words are those of the unit: a walk that goes up
/// counts further than others, and its setup takes cycles.
#[test]
fn icarus_shows_the_loop_of_a_walk_that_goes_up() {
    if !tools::has_tool("iverilog") {
        return;
    }
    let icarus = Icarus::find().unwrap();
    let pyramid = pyramid();
    let walk = Walk {
        method: Method::MixedSelective,
        format: WalkFormat::Float(FloatFormat::E7F16),
        crossing: Crossing::Index,
    };
    let configuration = UnitConfiguration::of(walk, &pyramid).unwrap();
    let unit = TraverseUnit::build(configuration);
    let rays: Vec<_> = random_rays(40, 1)
        .into_iter()
        .map(|ray| configuration.port_words(ray))
        .collect();
    let run = GoldenRun {
        pyramid: &pyramid,
        rays: &rays,
        stalls: StallPattern::one_in_eight(7),
        step: configuration.step,
        latency: unit.latency,
    };
    let comparison = icarus.run_traverse(&unit, &run).unwrap();
    assert_eq!(comparison.mismatches, 0, "{:?}", comparison.first);
    assert_eq!(comparison.rays, 40);
    assert_eq!(comparison, run_embedded(&unit, &run, |_, _, _| {}).unwrap());
}

#[test]
fn lint_has_nothing_to_say_of_a_step_of_each_family() {
    if !tools::has_tool("verilator") {
        return;
    }
    let pyramid = pyramid();
    for (method, format, crossing) in [
        ("texel", "e7f16", "index"),
        ("mixed-coherent", "e7f16", "index"),
        ("texel", "fixed", "index"),
        ("mixed-selective", "fixed", "index"),
        ("quad", "e7f16", "index"),
        ("block", "fixed", "index"),
        ("window", "e7f16", "index"),
        ("window", "fixed", "index"),
        ("tevs", "e7f16", "offset:0.0625"),
        ("relief", "e7f16", "index"),
        ("pom", "e7f16", "index"),
        ("dig", "e7f16", "index"),
    ] {
        let walk = Walk {
            method: method.parse().unwrap(),
            format: format.parse().unwrap(),
            crossing: crossing.parse().unwrap(),
        };
        let configuration = UnitConfiguration::of(walk, &pyramid).unwrap();
        let unit = build_step_unit(&configuration);
        assert_eq!(tools::lint(&unit, &[]), "", "{}", label(walk));
    }
    let walk = Walk {
        method: Method::MixedSelective,
        format: WalkFormat::Float(FloatFormat::E7F16),
        crossing: Crossing::Index,
    };
    let unit = TraverseUnit::build(UnitConfiguration::of(walk, &pyramid).unwrap());
    assert_eq!(tools::lint(&unit.design, &[]), "", "{}", label(walk));
}
