//! The traverse unit in other shapes and formats than its usual one: heights of 16 bits, floats of
//! 32 bits and of more, for which the records that pass between golden machine and simulator have
//! words of 8 bytes. Every register in every cycle must be the golden machine's, in the embedded
//! simulator and, for the two that differ most, under Verilator.

#[path = "common/rays.rs"]
mod rays;
#[path = "common/tools.rs"]
mod tools;

use hdl_gen::units::{TraverseUnit, UnitConfiguration};
use hdl_gen::verify::{
    Comparison, GoldenRun, driven_words, run_embedded, run_harness, run_verilator, traverse_plan,
};
use rtl_model::float::FloatFormat;
use rtl_model::machine::StallPattern;
use rtl_model::maps::{Channel, HeightMap, MapSource, Pyramid};
use rtl_model::units::traverse::shape_for;
use std::collections::BTreeSet;
use std::ops::ControlFlow;

const E8F23: FloatFormat = FloatFormat::new(8, 23);
const E8F25: FloatFormat = FloatFormat::new(8, 25);

/// Rocks of 64 x 64 texels with heights of 8 bits.
fn rocks() -> HeightMap {
    let source = MapSource::parse("procedural:rocks:64:1").unwrap();
    source.load(Channel::Grey, false).unwrap()
}

/// The same rocks with heights of 16 bits, of which the lower eight differ from texel to texel.
fn fine_rocks() -> HeightMap {
    let coarse = rocks();
    let fine = (0_u16..).zip(coarse.heights()).map(|(place, &height)| {
        let grain = place.wrapping_mul(40_503) >> 8;
        height << 8 | grain
    });
    HeightMap::new("fine rocks", coarse.size(), 16, fine.collect()).unwrap()
}

/// A unit and its map: `compare` is handed the unit and the run of `count` rays, and nothing it
/// finds may differ.
fn expect_agreement(
    map: &HeightMap,
    format: FloatFormat,
    count: u32,
    has_long_words: bool,
    compare: impl FnOnce(&TraverseUnit, &GoldenRun<'_>) -> Comparison,
) {
    let pyramid = Pyramid::new(map);
    let unit = TraverseUnit::build(UnitConfiguration::oh(shape_for(&pyramid), format));
    let rays = rays::rays(format, count);
    let run = GoldenRun {
        pyramid: &pyramid,
        rays: &rays,
        stalls: StallPattern::one_in_eight(7),
        step: unit.configuration.step,
        latency: unit.latency,
    };
    let widest = unit.probes.iter().map(|probe| probe.width).max();
    assert_eq!(widest > Some(32), has_long_words);
    let comparison = compare(&unit, &run);
    assert_eq!(comparison.first, []);
    assert_eq!(comparison.mismatches, 0);
    assert_eq!(comparison.rays, u64::from(count));
    assert_eq!(comparison.guards, 0, "no ray may reach the step bound");
    assert_eq!(comparison.signals_compared, unit.probes.len() as u64);
    // A ray takes many steps, each a trip round: far more cycles than rays.
    assert!(comparison.cycles_compared > comparison.rays);
    assert_eq!(comparison.cycles_compared, comparison.cycles);
}

fn agrees_embedded(map: &HeightMap, format: FloatFormat, has_long_words: bool) {
    expect_agreement(map, format, 2000, has_long_words, |unit, run| {
        run_embedded(unit, run, |_, _, _| {}).unwrap()
    });
}

fn agrees_under_verilator(map: &HeightMap, format: FloatFormat, has_long_words: bool) {
    let Some(verilator) = tools::verilator() else {
        return;
    };
    expect_agreement(map, format, 20_000, has_long_words, |unit, run| {
        run_verilator(&verilator, unit, run, format, None, |_| {}).unwrap()
    });
}

#[test]
fn floats_of_24_bits_agree_embedded() {
    agrees_embedded(&rocks(), FloatFormat::E7F16, false);
}

#[test]
fn heights_of_16_bits_agree_embedded() {
    agrees_embedded(&fine_rocks(), FloatFormat::E7F16, false);
}

#[test]
fn floats_of_32_bits_agree_embedded() {
    agrees_embedded(&rocks(), E8F23, false);
}

#[test]
fn floats_of_34_bits_agree_embedded() {
    agrees_embedded(&fine_rocks(), E8F25, true);
}

#[test]
fn floats_of_24_bits_agree_under_verilator() {
    agrees_under_verilator(&rocks(), FloatFormat::E7F16, false);
}

#[test]
fn floats_of_34_bits_and_heights_of_16_agree_under_verilator() {
    agrees_under_verilator(&fine_rocks(), E8F25, true);
}

/// Every signal is compared, from its first bit to its last: a bit of a golden word changed in one
/// cycle is found in each signal that holds the word, as many cycles later as it stands behind.
#[test]
fn each_bit_of_a_golden_word_changed_is_found_under_verilator() {
    let Some(verilator) = tools::verilator() else {
        return;
    };
    let pyramid = Pyramid::new(&fine_rocks());
    let unit = TraverseUnit::build(UnitConfiguration::oh(shape_for(&pyramid), E8F25));
    let rays = rays::rays(E8F25, 20);
    let run = GoldenRun {
        pyramid: &pyramid,
        rays: &rays,
        stalls: StallPattern::one_in_eight(7),
        step: unit.configuration.step,
        latency: unit.latency,
    };
    let plan = traverse_plan(&unit, &run);
    let program = verilator.build(&unit.design, &plan, false).unwrap();
    let ends = |probe: &hdl_gen::units::Probe| [(probe.word, 0), (probe.word, probe.width - 1)];
    let changes: BTreeSet<(usize, u32)> = unit.probes.iter().flat_map(ends).collect();
    assert!(changes.len() > 100, "{} ends of words", changes.len());
    const CHANGED_IN: u64 = 40;
    for (word, bit) in changes {
        let holds = |probe: &&hdl_gen::units::Probe| probe.word == word && probe.width > bit;
        let delays: Vec<u64> = unit
            .probes
            .iter()
            .filter(holds)
            .map(|probe| u64::from(probe.delay))
            .collect();
        let soonest = *delays.iter().min().unwrap();
        let comparison = run_harness(&program, &plan, Some(pyramid.memory()), None, |records| {
            let (mut cycle, mut outcome) = (0, Ok(()));
            run.run(E8F25, |inputs, _, words| {
                let mut golden = words.0.clone();
                golden[word] ^= u64::from(cycle == CHANGED_IN) << bit;
                cycle += 1;
                outcome = records.send(&driven_words(inputs), &golden);
                match outcome {
                    Ok(()) => ControlFlow::Continue(()),
                    Err(_) => ControlFlow::Break(()),
                }
            });
            outcome
        })
        .unwrap();
        assert_eq!(comparison.mismatches, delays.len() as u64, "{word} {bit}");
        for first in &comparison.first {
            assert_eq!(first.cycle, CHANGED_IN + soonest, "{first:?}");
            assert_eq!(first.expected ^ first.found, 1 << bit, "{first:?}");
        }
        let found_soonest = delays.iter().filter(|&&delay| delay == soonest).count();
        assert_eq!(comparison.first.len(), found_soonest);
    }
}
