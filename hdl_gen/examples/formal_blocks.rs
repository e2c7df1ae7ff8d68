//! Writes the blocks that `formal/` proves properties of, small enough for a solver, to the folder
//! named, and to its folder `faulty` the same with a fault in each.
//!
//! ```text
//! cargo run --package hdl_gen --example formal_blocks -- out/formal
//! ```

use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;

use hdl_gen::blocks::{fifo, height_cache, read_port};
use hdl_gen::datapath::OperatorLatencies;
use hdl_gen::emit::write_design;
use hdl_gen::fault::plant;
use hdl_gen::netlist::Module;
use hdl_gen::units::{ExactUnit, PaperLoop, PaperUnit};
use rtl_model::float::FloatFormat;
use rtl_model::machine::{
    CacheAnswer, ExactEffort, ExactMachineShape, FifoShape, HeightCacheShape, PaperShape,
    ReadPortShape,
};
use rtl_model::scene::{Machine, MachineCache, MachineKind};
use rtl_model::units::bounded_shape::BoundedShape;
use rtl_model::units::fixed_shape::FixedShape;
use rtl_model::units::paper_step::{HeightLayout, PaperStep};
use rtl_model::units::traverse_step::TraverseShape;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from);
    let folder = folder.ok_or("name the folder to write to: `-- out/formal`")?;
    for (design, faulty_signal) in blocks() {
        write_design(&design, &folder)?;
        write_design(&plant(&design, faulty_signal, 0)?, &folder.join("faulty"))?;
    }
    write_design(&paper_machine(), &folder)?;
    write_design(&exact_machine(), &folder)?;
    for (fault, design, line, faulty_line) in FAULTS {
        let sound = std::fs::read_to_string(folder.join(design))?;
        if sound.matches(line).count() != 1 {
            return Err(format!("{design} has no line to plant a fault in: {line}").into());
        }
        let folder = folder.join(fault);
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join(design), sound.replace(line, faulty_line))?;
    }
    Ok(())
}

/// Faults more exact than an inverted signal: a controller that lets in one ray too many, a ray that
/// is dropped where it should go round, one that takes the id of the ray behind it; and a line that
/// may be pushed out as soon as it has come. And of the exact machine: a slot that stays free though
/// a ray is in it, a refused walk that is dropped, and a check that takes the id of the hit before.
const FAULTS: [(&str, &str, &str, &str); 7] = [
    (
        "overbooked",
        "paper_loop.v",
        "rays_inside < 3'd4",
        "rays_inside < 3'd5",
    ),
    (
        "dropped",
        "paper_loop.v",
        "valid_s0 <= recirculates | admits;",
        "valid_s0 <= admits;",
    ),
    (
        "mixed",
        "paper_loop.v",
        "id_s5  <= id_s4;",
        "id_s5  <= id_s3;",
    ),
    (
        "unserved",
        "height_cache.v",
        "serves_0           = hit_o & ",
        "serves_0           = ",
    ),
    (
        "lent",
        "exact_machine.v",
        "(free_slots & (~(admits",
        "(free_slots & (~(returns",
    ),
    (
        "dropped",
        "exact_machine.v",
        "recirculates | (returns | admits);",
        "recirculates | admits;",
    ),
    (
        "mixed",
        "exact_machine.v",
        "check_id              <= waiting_id;",
        "check_id              <= answer_id;",
    ),
];

/// Each block with the signal that is inverted in its faulty twin.
fn blocks() -> Vec<(Arc<Module>, &'static str)> {
    let cache = HeightCacheShape {
        name: "height_cache".to_owned(),
        height_bits: 8,
        line_bits: 2,
        lines: 2,
        pending: 2,
        answer: CacheAnswer::Height,
        latency: 1,
        counters: false,
    };
    vec![
        (fifo(&FifoShape::new("fifo", 4, &[("item", 2)])), "puts"),
        (
            read_port(&ReadPortShape::new("read_port", 3, 2, 2)),
            "takes_beat",
        ),
        (height_cache(&cache), "collided_s1"),
    ]
}

/// The paper's machine for a map of 8 x 8 texels, with FIFOs of four places, and the datapaths that
/// the proofs cut away.
fn paper_machine() -> Arc<Module> {
    let step = PaperStep {
        shape: TraverseShape {
            root_level: 3,
            height_bits: 8,
        },
        layout: HeightLayout::Tiles,
    };
    let mut machine = Machine::of_kind(MachineKind::Paper);
    machine.fifo = Some(4);
    machine.cache = MachineCache {
        lines: 2,
        pending: 2,
    };
    let format = FloatFormat::E7F16;
    let shape = PaperShape::new(step, format.width(), &machine);
    PaperUnit::build(&PaperLoop::build(&shape, format, &OperatorLatencies::PAPER)).design
}

/// The exact machine for a map of 8 x 8 texels with four slots, and the datapaths that the proofs
/// cut away.
fn exact_machine() -> Arc<Module> {
    let words = FixedShape {
        root_level: 3,
        height_bits: 8,
        entry_fraction_bits: 2,
        slope_bits: 6,
    };
    let effort = ExactEffort {
        slots: 4,
        stages: 8,
        setups: 2,
        waiting_rays: 0,
        ..ExactEffort::AREA
    };
    let cache = MachineCache {
        lines: 2,
        pending: 2,
    };
    let shape = ExactMachineShape::new(BoundedShape::new(words, 1), effort, &cache, false);
    ExactUnit::build(&shape).design
}
