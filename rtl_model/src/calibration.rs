//! The scenes of the 2013 hardware paper: three cameras and seven surfaces.
//!
//! The paper, "Effective traversal algorithms and hardware architecture for pyramidal inverse
//! displacement mapping" (Computers & Graphics, special section on CAD/Graphics 2013), prints
//! neither its cameras nor its depth scales. Those below were settled by measurement: an independent
//! `f64` program run over the seven real maps reproduces the rows \[10\] (Oh et al. 2006) and \[12\]
//! (Tevs et al. 2008) of the paper's Table 4, mean steps per pixel, to 1.2 % and 1.8 % mean deviation.
//! The oblique camera and all depth scales but that of Rocks are the defaults of the DirectX SDK
//! sample the maps come from; the front and grazing cameras, and the depth of Rocks, are fitted.
//! Angles and lengths are those of [`Camera`] and [`Surface`].

use std::env;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::camera::{Camera, Surface};

/// Side of the square plane of every scene, in world units.
pub const SIDE: f64 = 200.0;

/// The camera that looks down on the surface; 84.6 % of a 4:3 screen are on the plane.
pub const FRONT: Camera = Camera {
    eye: [19.50, 195.49, -24.48],
    elevation_deg: 89.04,
    azimuth_deg: -14.0,
    fov_y_deg: 45.0,
};

/// The camera that looks across the surface; 93.3 % of a 4:3 screen are on the plane.
pub const OBLIQUE: Camera = Camera {
    eye: [76.0995, 43.1912, -110.1090],
    elevation_deg: 30.97,
    azimuth_deg: -36.38,
    fov_y_deg: 45.0,
};

/// The camera just above the surface; 22.1 % of a 4:3 screen are on the plane, all in its lower
/// part.
pub const GRAZING: Camera = Camera {
    eye: [42.30, 1.82, 47.06],
    elevation_deg: -12.28,
    azimuth_deg: -98.1,
    fov_y_deg: 45.0,
};

/// The three cameras by the names that scene files and reports use.
pub const CAMERAS: [(&str, Camera); 3] =
    [("front", FRONT), ("oblique", OBLIQUE), ("grazing", GRAZING)];

/// One of the paper's seven surfaces: a height map and how deep and how often it is laid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibratedSurface {
    /// The short name that tables use.
    pub name: &'static str,
    /// File of the height map, in the folder that [`real_maps`] finds. Heights are in its alpha
    /// channel, white is high.
    pub file: &'static str,
    /// Texels on a side of that map.
    pub size: u32,
    /// How the map is laid on the plane.
    pub surface: Surface,
}

const fn calibrated(
    name: &'static str,
    file: &'static str,
    size: u32,
    depth_scale: f64,
    repeat: f64,
) -> CalibratedSurface {
    CalibratedSurface {
        name,
        file,
        size,
        surface: Surface {
            side: SIDE,
            depth_scale,
            repeat,
        },
    }
}

/// The seven surfaces, in the order of the paper's tables.
pub const SURFACES: [CalibratedSurface; 7] = [
    calibrated("rocks", "rocks_NM_height.tga", 256, 10.0, 4.0),
    calibrated("stones", "stones_NM_height.tga", 256, 5.0, 1.0),
    calibrated("four", "four_NM_height.tga", 256, 30.0, 1.0),
    calibrated("saint", "saint_NM_height.tga", 256, 20.0, 1.0),
    calibrated("wall", "wall_NM_height.tga", 256, 8.0, 1.0),
    calibrated("bump", "bump_NM_height.tga", 128, 10.0, 4.0),
    calibrated("dent", "dent_NM_height.tga", 128, 10.0, 4.0),
];

/// The environment variable that names the folder of the real maps.
pub const MAPS_VARIABLE: &str = "STEPWELL_MAPS";

/// The real maps are needed and are not there.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "no height maps in {folder}: set {MAPS_VARIABLE} to the folder that holds {file} and the other \
     six (the environment says CI=true, where a check may not be left out)"
)]
pub struct MapsMissing {
    /// The folder that was looked into.
    pub folder: PathBuf,
    /// A file that was not found there.
    pub file: &'static str,
}

/// The folder that holds the seven real height maps, which are not part of this repository.
///
/// It is the value of `STEPWELL_MAPS`, or else `shared/heightmaps` beside the workspace. Where a map
/// is missing there the answer is `Ok(None)`, and the caller says in one line what it leaves out, so
/// that no check is skipped silently.
///
/// # Errors
/// A missing map, where the environment variable `CI` is `true`: there nothing may be left out.
pub fn real_maps(workspace_root: &Path) -> Result<Option<PathBuf>, MapsMissing> {
    let folder = env::var_os(MAPS_VARIABLE).map_or_else(
        || workspace_root.join("../shared/heightmaps"),
        PathBuf::from,
    );
    let must_be_there = env::var_os("CI").is_some_and(|value| value == "true");
    maps_in(folder, must_be_there)
}

/// `folder`, if it holds all seven maps.
fn maps_in(folder: PathBuf, must_be_there: bool) -> Result<Option<PathBuf>, MapsMissing> {
    let missing = SURFACES
        .iter()
        .map(|surface| surface.file)
        .find(|file| !folder.join(file).is_file());
    match missing {
        None => Ok(Some(folder)),
        Some(_) if !must_be_there => Ok(None),
        Some(file) => Err(MapsMissing { folder, file }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::{Channel, HeightMap};

    #[test]
    fn a_folder_without_the_maps_is_said_to_be_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_path_buf();
        assert_eq!(maps_in(path.clone(), false), Ok(None));
        let error = maps_in(path.clone(), true).unwrap_err();
        assert!(error.to_string().contains("rocks_NM_height.tga"), "{error}");
        for surface in SURFACES {
            std::fs::write(path.join(surface.file), []).unwrap();
        }
        assert_eq!(maps_in(path.clone(), true), Ok(Some(path)));
    }

    #[test]
    fn the_real_maps_have_the_calibrated_sizes() {
        let workspace_root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let Some(folder) = real_maps(&workspace_root).unwrap() else {
            eprintln!("left out, no real height maps: set {MAPS_VARIABLE} to their folder");
            return;
        };
        for surface in SURFACES {
            let path = folder.join(surface.file);
            let map = HeightMap::load(&path, Channel::Alpha, false).unwrap();
            assert_eq!((map.size(), map.bits()), (surface.size, 8));
            let (low, high) = (map.heights().iter().min(), map.heights().iter().max());
            assert!(low < high, "{}: {low:?} to {high:?}", surface.name);
            // Its colours are a normal, not a grey.
            assert!(HeightMap::load(&path, Channel::Grey, false).is_err());
        }
    }
}
