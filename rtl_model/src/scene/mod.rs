//! Scene files: what is rendered, how it is walked, and which effects it calls for.
//!
//! A scene is a TOML file:
//!
//! ```
//! let scene = rtl_model::scene::Scene::from_toml(
//!     r#"
//!     name = "example"                     # letters, digits, `-` and `_`: files are called so
//!     [map]
//!     source = "procedural:rocks:256:1"    # or a file, relative to this one: PNG, TGA, PGM
//!     channel = "grey"                     # alpha | red | grey, which is the default
//!     white_is_low = false                 # the default
//!     [surface]
//!     side = 200.0                         # world units of the square plane, centred at the origin
//!     depth_scale = 10.0                   # world units below the plane for depth 1
//!     repeat = 4.0                         # repeats of the map across the side
//!     [camera]                             # or only: preset = "front" | "oblique" | "grazing"
//!     eye = [76.0, 43.0, -110.0]           # x, y (up), z in world units; above the plane
//!     elevation_deg = 31.0                 # pitch of the view axis below the horizon
//!     azimuth_deg = -36.0                  # from +z towards +x
//!     fov_y_deg = 45.0                     # the vertical field of view
//!     [light]                              # may be left out
//!     direction = [-0.5, -0.4, 0.75]       # tangent space, from the surface to the light
//!     [frame]
//!     width = 320                          # pixels
//!     height = 240
//!     [walk]
//!     method = "oh"                        # the traversal
//!     format = "e7f16"                     # eXfY | f64 | exact | fixed | qI.F
//!     crossing = "index"                   # the default | offset:X, for comparison
//!     [machine]                            # may be left out: then rays go round a bare loop
//!     kind = "paper"                       # paper | exact: the whole clocked traverse unit
//!     fifo = 16                            # entries of FIFO 0 before the loop and FIFO 1 behind it
//!     # effort = "area"                    # of the exact machine: area | throughput
//!     tile = 16                            # rays come by square tiles of so many pixels a side
//!     counters = false                     # count trips, hits, misses and stalls in hardware
//!     cache = { lines = 256, pending = 4 } # lines of 16 heights; lines on their way at most
//!     memory = { latency = 20, bytes_per_cycle = 8, stalls = false }
//!     [effects]                            # none so far; may be left out
//!     "#,
//!     std::path::Path::new("example.toml"),
//! )?;
//! assert_eq!(scene.walk.format.to_string(), "e7f16");
//! # Ok::<(), rtl_model::scene::SceneError>(())
//! ```
//!
//! A key that is not known is an error: a scene never means less than it says.

mod file;
mod machine;
mod method;
mod walk;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::camera::{Camera, Surface, View};
use crate::maps::{Channel, HeightMap, MapError, MapSource};
pub use machine::{
    Machine, MachineCache, MachineEffort, MachineKind, MachineLatencies, MachineMemory,
    fifo_that_fills,
};
pub use method::{Family, LinearSearch, Method};
pub use walk::{BorderOffset, Crossing, Walk, WalkError, WalkFormat};

/// The most pixels a frame may have on a side.
pub const MAX_FRAME_SIDE: u32 = 8192;

/// A scene whose values have all been checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// What its files and reports are called: letters, digits, `-` and `_`.
    pub name: String,
    /// The height map.
    pub map: SceneMap,
    /// The square it displaces.
    pub surface: Surface,
    /// The view on it.
    pub camera: Camera,
    /// The light on it.
    pub light: Light,
    /// The pixels of the picture.
    pub frame: FrameSize,
    /// How its rays are traversed.
    pub walk: Walk,
    /// The clocked machine that walks them, if it is to be more than the bare loop of steps.
    pub machine: Option<Machine>,
    /// What it calls for beyond the first hit.
    pub effects: Effects,
}

/// Which height map a scene uses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneMap {
    /// A recipe, or a file whose path is relative to the working directory.
    pub source: MapSource,
    /// Which part of an image is the height.
    pub channel: Channel,
    /// Whether black is high.
    pub white_is_low: bool,
}

/// A light infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// From the surface to the light, in tangent space: along u, along v, and out of the surface.
    /// `u` and `v` run to the right and downwards in the map as displayed, so `[-1, -1, 1]` is the
    /// customary light from the upper left. Of any length above 0; the third component is above 0.
    pub direction: [f64; 3],
}

impl Default for Light {
    /// From the upper left, about 50 degrees above the surface.
    fn default() -> Self {
        Light {
            direction: [-0.5, -0.4, 0.75],
        }
    }
}

/// The pixels of a frame, 1 to [`MAX_FRAME_SIDE`] on a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameSize {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// The effects of a scene. There are none yet; a scene that asks for one is refused.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Effects {}

/// Why there is no scene. Each message names the file, the place in it and the way out.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SceneError {
    /// No such file.
    #[error("scene {path}: no such file; check the path")]
    Missing {
        /// The file.
        path: PathBuf,
    },
    /// The file is there and cannot be read.
    #[error("scene {path}: cannot be read ({cause})")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        cause: String,
    },
    /// The text is not a scene.
    #[error("scene {path}: {problem}")]
    Invalid {
        /// The file.
        path: PathBuf,
        /// The line, the field, what is wrong with it and what would be right.
        problem: String,
    },
}

impl Scene {
    /// Reads a scene file.
    ///
    /// # Errors
    /// A file that is missing, unreadable or not a scene.
    pub fn load(path: &Path) -> Result<Scene, SceneError> {
        let text = fs::read_to_string(path).map_err(|error| {
            let path = path.to_owned();
            match error.kind() {
                io::ErrorKind::NotFound => SceneError::Missing { path },
                _ => SceneError::Unreadable {
                    path,
                    cause: error.to_string(),
                },
            }
        })?;
        Scene::from_toml(&text, path)
    }

    /// Reads a scene from its text. `origin` is the file it came from: messages name it, and a
    /// relative path in the scene starts in its folder.
    ///
    /// # Errors
    /// Text that is not a scene.
    pub fn from_toml(text: &str, origin: &Path) -> Result<Scene, SceneError> {
        let mut scene = file::read(text).map_err(|problem| SceneError::Invalid {
            path: origin.to_owned(),
            problem,
        })?;
        let folder = origin.parent().unwrap_or(Path::new(""));
        scene.map.source = scene.map.source.relative_to(folder);
        Ok(scene)
    }

    /// The scene's height map: reads the file or follows the recipe.
    ///
    /// # Errors
    /// As [`HeightMap::load`].
    pub fn load_map(&self) -> Result<HeightMap, MapError> {
        self.map
            .source
            .load(self.map.channel, self.map.white_is_low)
    }

    /// The view of the scene's camera, which gives each pixel its ray.
    pub fn view(&self) -> View {
        View::new(
            &self.camera,
            &self.surface,
            self.frame.width,
            self.frame.height,
        )
    }
}
