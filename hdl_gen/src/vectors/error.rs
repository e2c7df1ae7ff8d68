//! Why vectors could not be made, written or read.

use std::io;
use std::path::PathBuf;

use rtl_model::camera::PixelRayError;
use rtl_model::maps::MapError;
use rtl_model::walker::{AdmissionError, WalkerError};
use thiserror::Error;

use crate::units::NoHardware;

/// Why vectors could not be made, written or read.
#[derive(Debug, Error)]
pub enum VectorError {
    /// The scene's map could not be loaded.
    #[error(transparent)]
    Map(#[from] MapError),
    /// A pixel of the scene has a ray that no unit can walk.
    #[error(transparent)]
    Ray(#[from] PixelRayError),
    /// The scene's method, format and crossing do not go together.
    #[error(transparent)]
    Walk(#[from] WalkerError),
    /// There is no hardware of the scene's walk.
    #[error(transparent)]
    NoHardware(#[from] NoHardware),
    /// A ray that the format cannot hold.
    #[error("pixel ({x}, {y}): {problem}")]
    Admission {
        /// Column of the pixel.
        x: u32,
        /// Row of the pixel.
        y: u32,
        /// What is wrong with its ray.
        problem: AdmissionError,
    },
    /// No ray of the frame meets the surface.
    #[error("scene `{scene}`: no pixel looks at the surface; turn the camera toward it")]
    NoRays {
        /// The scene's name.
        scene: String,
    },
    /// The scene is walked in a format that no hardware is built in.
    #[error("scene `{scene}`: format {format} is no format of the hardware; use one like e7f16")]
    NoHardwareFormat {
        /// The scene's name.
        scene: String,
        /// The format.
        format: String,
    },
    /// A file or folder could not be written.
    #[error("{}: cannot be written ({problem}); check that the folder can be written to",
        path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        problem: io::Error,
    },
    /// A file could not be read.
    #[error("{}: cannot be read ({problem}); `make vectors` writes it", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        problem: io::Error,
    },
    /// The manifest is not one.
    #[error("{}: no manifest of vectors ({problem}); `make vectors` writes one", path.display())]
    Manifest {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// A vector file is not as the manifest describes it.
    #[error("{}: {problem}; `make vectors` writes it anew", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
}
