//! Writes the regression vectors of the small scene into a folder, as `make vectors` does:
//!
//! ```text
//! cargo run --release -p hdl_gen --example write_vectors -- vectors
//! ```

use hdl_gen::vectors::{VectorPlan, write_vectors};
use rtl_model::scene::Scene;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args()
        .nth(1)
        .ok_or("usage: write_vectors FOLDER")?;
    let scene = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/small.toml"));
    let plan = VectorPlan::for_scene(Scene::load(scene)?);
    let manifest = write_vectors(&plan, folder.as_ref())?;
    for file in &manifest.files {
        println!(
            "{} vectors of {} bits: {}",
            file.vectors, file.width, file.file
        );
    }
    Ok(())
}
