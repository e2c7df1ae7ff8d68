//! The seven surfaces under the three cameras.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use rtl_model::calibration::{CAMERAS, MAPS_VARIABLE, SURFACES, real_maps};
use rtl_model::camera::{Surface, View};
use rtl_model::maps::{Channel, HeightMap};
use rtl_model::ray::Ray;
use rtl_model::scene::FrameSize;

use super::MapsOption;

impl MapsOption {
    /// The folder of the real height maps.
    ///
    /// # Errors
    /// There is none: the message says where it was looked for, and how to name it.
    pub fn folder(&self) -> anyhow::Result<PathBuf> {
        if let Some(folder) = &self.maps {
            return Ok(folder.clone());
        }
        match real_maps(Path::new("."))? {
            Some(folder) => Ok(folder),
            None => bail!(
                "no real height maps, which the papers' tables need: name the folder that holds {} \
                 and the other six (from the DirectX SDK) with --maps, or in {MAPS_VARIABLE}",
                SURFACES[0].file
            ),
        }
    }

    /// The height map of one of [`SURFACES`].
    ///
    /// # Errors
    /// As [`HeightMap::load`].
    pub fn load(&self, folder: &Path, surface: usize) -> anyhow::Result<HeightMap> {
        let path = folder.join(SURFACES[surface].file);
        let context = || format!("the height maps in {} (see --maps)", folder.display());
        HeightMap::load(&path, Channel::Alpha, false).with_context(context)
    }
}

/// The rays of a frame of one of [`CAMERAS`] on a surface: pixel by pixel, those that have one.
pub fn frame_rays(surface: &Surface, camera: usize, screen: FrameSize) -> Vec<Ray<f64>> {
    let view = View::new(&CAMERAS[camera].1, surface, screen.width, screen.height);
    let rows = 0..screen.height;
    rows.flat_map(|y| (0..screen.width).map(move |x| (x, y)))
        .filter_map(|(x, y)| view.ray(x, y))
        .map(|ray| ray.reduced())
        .collect()
}
