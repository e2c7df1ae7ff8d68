//! Emits the exact machine over a map of 256 x 256 texels, without counters, in its area and its
//! throughput configuration, each in a folder of its own.

use hdl_gen::emit::write_design;
use hdl_gen::units::ExactUnit;
use rtl_model::machine::{ExactEffort, ExactMachineShape};
use rtl_model::scene::MachineCache;
use rtl_model::units::bounded_shape::BoundedShape;
use rtl_model::units::fixed_shape::FixedShape;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(folder), Some(slope_bits)) = (arguments.next(), arguments.next()) else {
        return Err("usage: emit_exact FOLDER SLOPE_BITS, such as out/exact 21".into());
    };
    let words = FixedShape {
        root_level: 8,
        height_bits: 8,
        entry_fraction_bits: 12,
        slope_bits: slope_bits.parse()?,
    };
    let cache = MachineCache {
        lines: 1024,
        ..MachineCache::default()
    };
    for (name, log2_side, effort) in [
        ("area", 1, ExactEffort::AREA),
        ("throughput", 2, ExactEffort::THROUGHPUT),
    ] {
        let bounded = BoundedShape::new(words, log2_side);
        println!(
            "{bounded:?}, {} fraction bits, {} delta bits, {} bound bits, {} index bits, {} way bits, {} steps at most",
            bounded.fraction_bits(),
            bounded.delta_bits(),
            bounded.bound_bits(),
            bounded.index_bits(),
            bounded.way_bits(),
            bounded.step_bound()
        );
        let unit = ExactUnit::build(&ExactMachineShape::new(bounded, effort, &cache, false));
        let folder = Path::new(&folder).join(name);
        write_design(&unit.design, &folder)?;
        println!("{}", folder.display());
    }
    Ok(())
}
