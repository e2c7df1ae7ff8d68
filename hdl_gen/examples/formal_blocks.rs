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
use hdl_gen::emit::write_design;
use hdl_gen::fault::plant;
use hdl_gen::netlist::Module;
use rtl_model::machine::{CacheAnswer, FifoShape, HeightCacheShape, ReadPortShape};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from);
    let folder = folder.ok_or("name the folder to write to: `-- out/formal`")?;
    for (design, faulty_signal) in blocks() {
        write_design(&design, &folder)?;
        write_design(&plant(&design, faulty_signal, 0)?, &folder.join("faulty"))?;
    }
    Ok(())
}

/// Each block with the signal that is inverted in its faulty twin.
fn blocks() -> Vec<(Arc<Module>, &'static str)> {
    let cache = HeightCacheShape {
        name: "height_cache".to_owned(),
        height_bits: 8,
        line_bits: 3,
        lines: 2,
        pending: 2,
        answer: CacheAnswer::Line,
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
