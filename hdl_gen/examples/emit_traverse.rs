//! Emits the traverse unit for a map of 256 x 256 texels into a folder.

use hdl_gen::emit::write_design;
use hdl_gen::units::{TraverseUnit, UnitConfiguration};
use rtl_model::float::FloatFormat;
use rtl_model::units::traverse_step::TraverseShape;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args()
        .nth(1)
        .ok_or("usage: emit_traverse FOLDER")?;
    let unit = TraverseUnit::build(UnitConfiguration::oh(
        TraverseShape {
            root_level: 8,
            height_bits: 8,
        },
        FloatFormat::E7F16,
    ));
    for file in write_design(&unit.design, folder.as_ref())? {
        println!("{}", file.display());
    }
    Ok(())
}
