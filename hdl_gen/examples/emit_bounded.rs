//! Emits the datapaths of a unit that walks by bounds over a map of 256 x 256 texels, each in a folder
//! of its own, a step in one to six stages.

use hdl_gen::emit::write_design;
use hdl_gen::units::build_bounded;
use rtl_model::units::bounded_datapaths::BoundedDatapath;
use rtl_model::units::bounded_shape::BoundedShape;
use rtl_model::units::fixed_shape::FixedShape;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(folder), Some(slope_bits)) = (arguments.next(), arguments.next()) else {
        return Err("usage: emit_bounded FOLDER SLOPE_BITS, such as out/bounded 21".into());
    };
    let words = FixedShape {
        root_level: 8,
        height_bits: 8,
        entry_fraction_bits: 12,
        slope_bits: slope_bits.parse()?,
    };
    for (name, log2_side) in [("quad", 1), ("block", 2)] {
        let shape = BoundedShape::new(words, log2_side);
        println!("{name}: {shape:?}, {} fraction bits", shape.fraction_bits());
        let mut datapaths = vec![
            (BoundedDatapath::SetupEntry, 0, 1),
            (BoundedDatapath::SetupDigits(1), 0, 1),
            (BoundedDatapath::SetupDigits(2), 0, 1),
            (BoundedDatapath::SetupNear(2, shape.behind_bits()), 0, 1),
            (BoundedDatapath::SetupEnd(shape.behind_bits()), 0, 1),
            (BoundedDatapath::LeafEntry, 0, 1),
            (BoundedDatapath::LeafTravel(1), 0, 1),
            (BoundedDatapath::LeafTravel(2), 0, 1),
            (BoundedDatapath::LeafCorner(1), 0, 1),
            (BoundedDatapath::LeafVerdict, 0, 1),
        ];
        for stages in 1..=6 {
            // A height is there two cycles after its address, if there is time.
            datapaths.push((BoundedDatapath::Step, (stages - 1).min(2), stages));
        }
        for (datapath, height_stage, stages) in datapaths {
            let built = build_bounded(datapath, shape, height_stage, stages);
            let own = match datapath {
                BoundedDatapath::Step => format!("step_{stages}"),
                other => format!("{other:?}").replace(['(', ')'], "_"),
            };
            let folder = Path::new(&folder).join(name).join(own);
            write_design(&built.module, &folder)?;
            println!("{}: {} registers", folder.display(), built.registers.len());
        }
    }
    Ok(())
}
