//! `stepwell vectors`: the small regression set that is committed.

use std::path::PathBuf;

use clap::Args;

use hdl_gen::vectors::{VectorPlan, write_vectors};
use rtl_model::scene::Scene;

use super::Outcome;
use crate::output::OutputFolder;
use crate::terminal;

/// The regression vectors of all operators, of the step and of a scene's rays, with their manifest
///
/// This is how the committed folder `vectors` is made; `git diff` then shows what a change of the
/// golden model or of a port did to them.
#[derive(Args, Debug)]
#[command(after_help = "Example: stepwell vectors -o out/vectors")]
pub struct Arguments {
    /// Scene whose map and rays are taken
    #[arg(value_name = "SCENE", default_value = "scenes/small.toml")]
    scene: PathBuf,

    /// Folder for the files, made if missing
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

/// Writes the vectors.
pub fn run(arguments: Arguments) -> anyhow::Result<Outcome> {
    let scene = Scene::load(&arguments.scene)?;
    let folder = OutputFolder::prepare(&arguments.output)?;
    let mut text = String::new();
    folder.publish(|folder| {
        let manifest = write_vectors(&VectorPlan::for_scene(scene), folder)?;
        for file in &manifest.files {
            text += &format!(
                "{:5} vectors of {:4} bits  {}\n",
                file.vectors, file.width, file.file
            );
        }
        Ok(())
    })?;
    terminal::answer(|output| output.write_all(text.as_bytes()))?;
    Ok(Outcome::Agreed)
}
