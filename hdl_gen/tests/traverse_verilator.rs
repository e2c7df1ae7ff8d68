//! The traverse unit in other shapes and formats than its usual one: heights of 16 bits, floats of
//! 32 bits and of more, for which the records that pass between golden machine and simulator have
//! words of 64. Every register in every cycle must be the golden machine's, in the embedded
//! simulator and, for the two that differ most, under Verilator.

#[path = "common/rays.rs"]
mod rays;
#[path = "common/tools.rs"]
mod tools;

use hdl_gen::units::{TraverseUnit, UnitConfiguration};
use hdl_gen::verify::{Comparison, GoldenRun, run_embedded, run_verilator, traverse_plan};
use rtl_model::float::FloatFormat;
use rtl_model::machine::StallPattern;
use rtl_model::maps::{Channel, HeightMap, MapSource, Pyramid};
use rtl_model::units::traverse::shape_for;

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
    record_bits: u32,
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
    assert_eq!(traverse_plan(&unit, &run).word_bits, record_bits);
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

fn agrees_embedded(map: &HeightMap, format: FloatFormat, record_bits: u32) {
    expect_agreement(map, format, 2000, record_bits, |unit, run| {
        run_embedded(unit, run, |_, _, _| {}).unwrap()
    });
}

fn agrees_under_verilator(map: &HeightMap, format: FloatFormat, record_bits: u32) {
    let Some(verilator) = tools::verilator() else {
        return;
    };
    expect_agreement(map, format, 20_000, record_bits, |unit, run| {
        run_verilator(&verilator, unit, run, format, None, |_| {}).unwrap()
    });
}

#[test]
fn floats_of_24_bits_agree_embedded() {
    agrees_embedded(&rocks(), FloatFormat::E7F16, 32);
}

#[test]
fn heights_of_16_bits_agree_embedded() {
    agrees_embedded(&fine_rocks(), FloatFormat::E7F16, 32);
}

#[test]
fn floats_of_32_bits_agree_embedded() {
    agrees_embedded(&rocks(), E8F23, 32);
}

#[test]
fn floats_of_34_bits_agree_embedded() {
    agrees_embedded(&fine_rocks(), E8F25, 64);
}

#[test]
fn floats_of_24_bits_agree_under_verilator() {
    agrees_under_verilator(&rocks(), FloatFormat::E7F16, 32);
}

#[test]
fn floats_of_34_bits_and_heights_of_16_agree_under_verilator() {
    agrees_under_verilator(&fine_rocks(), E8F25, 64);
}
