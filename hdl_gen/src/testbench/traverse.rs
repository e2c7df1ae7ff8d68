//! The testbench of the whole traverse unit.

use rtl_model::machine::{ID_BITS, StallPattern};

use super::filled_in;
use crate::units::TraverseUnit;
use crate::vectors::RayVectors;

const TEXT: &str = include_str!("../../../testbenches/verilog/testbench_traverse.v.in");

/// How the testbench of a traverse unit runs.
#[derive(Clone, Copy, Debug)]
pub struct TraverseBench {
    /// Rays: lines of `rays.hex` and `hits.hex`.
    pub rays: usize,
    /// When it is not ready for a hit.
    pub stalls: StallPattern,
    /// Cycles after which the unit is taken to hang.
    pub watchdog: u64,
}

impl TraverseBench {
    /// For these vectors: the watchdog allows twice the cycles that the rays need one after
    /// another, and some more for each.
    pub fn new(unit: &TraverseUnit, vectors: &RayVectors, stalls: StallPattern) -> TraverseBench {
        let mut fields = vectors.hits.fields.iter();
        let steps = fields.position(|field| field.name == "steps");
        let steps_of = |hit: &Vec<u64>| steps.map_or(0, |place| hit[place]);
        let steps: u64 = vectors.hits.vectors.iter().map(steps_of).sum();
        let rays = vectors.rays.vectors.len();
        let trip = u64::from(unit.latency.step) + 1;
        TraverseBench {
            rays,
            stalls,
            watchdog: 2 * trip * (steps + 4 * rays as u64 + 64),
        }
    }
}

/// The file `testbench_traverse.v`.
pub fn traverse_testbench(unit: &TraverseUnit, bench: &TraverseBench) -> String {
    let shape = unit.configuration.shape;
    // A walk that goes up can take more steps than others.
    let steps = unit.design.output("hit_steps_o");
    let count_bits = unit
        .design
        .width(steps.expect("a port of every traverse unit"));
    // The longest run that a 32-bit integer of Verilog counts.
    let watchdog = bench.watchdog.min(i32::MAX as u64);
    filled_in(
        TEXT,
        &[
            ("VERSION", env!("CARGO_PKG_VERSION")),
            ("VECTORS", &bench.rays.to_string()),
            (
                "STALL_SEED",
                &format!("{:04x}", bench.stalls.state().unwrap_or(0)),
            ),
            ("WATCHDOG", &watchdog.to_string()),
            ("LATENCY", &unit.latency.step.to_string()),
            ("SETUP_LATENCY", &unit.latency.setup.to_string()),
            (
                "NUMBER_BITS",
                &unit.configuration.format.width().to_string(),
            ),
            ("ID_BITS", &ID_BITS.to_string()),
            ("TEXEL_BITS", &shape.root_level.max(1).to_string()),
            ("COUNT_BITS", &count_bits.to_string()),
            ("HEIGHT_BITS", &shape.height_bits.to_string()),
            ("ADDRESS_BITS", &shape.address_bits().to_string()),
        ],
    )
}
