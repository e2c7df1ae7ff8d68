//! The maps that rays are sent through: those of the calibrated surfaces, as they are and larger,
//! with heights of 8 and 16 bits.

use std::fmt;
use std::path::Path;

use anyhow::Context;
use rtl_model::calibration::{SIDE, SURFACES, real_maps};
use rtl_model::camera::Surface;
use rtl_model::maps::{Channel, Enlargement, HeightMap, MapSource, Pyramid, enlarged, tiled};

/// What is made of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// As it is.
    Own,
    /// Repeated to 4096 x 4096 texels.
    Tiled,
    /// Heights of 16 bits, interpolated to four times as many texels on a side.
    Smooth,
    /// Heights of 16 bits, interpolated to 4096 x 4096 texels.
    LargeSmooth,
}

impl Variant {
    /// All of them.
    pub const ALL: [Variant; 4] = [
        Variant::Own,
        Variant::Tiled,
        Variant::Smooth,
        Variant::LargeSmooth,
    ];
}

impl fmt::Display for Variant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Variant::Own => "own size, 8 bit",
            Variant::Tiled => "tiled to 4096, 8 bit",
            Variant::Smooth => "interpolated x 4, 16 bit",
            Variant::LargeSmooth => "interpolated to 4096, 16 bit",
        })
    }
}

/// A map, its pyramid, and the surface that it lies on.
pub struct WalkScene {
    /// The map.
    pub map: HeightMap,
    /// Its pyramid.
    pub pyramid: Pyramid,
    /// The surface, by which cameras see it.
    pub surface: Surface,
}

/// The height maps: the seven real ones, or two recipes where they are not there; and whether they
/// are the real ones.
///
/// # Errors
/// A map that cannot be read, or that is missing where nothing may be left out.
pub fn height_maps(workspace: &Path) -> anyhow::Result<(Vec<(HeightMap, Surface)>, bool)> {
    if let Some(folder) = real_maps(workspace)? {
        let load = |surface: &rtl_model::calibration::CalibratedSurface| {
            let map = HeightMap::load(&folder.join(surface.file), Channel::Alpha, false)?;
            Ok((map, surface.surface))
        };
        return Ok((
            SURFACES.iter().map(load).collect::<anyhow::Result<_>>()?,
            true,
        ));
    }
    let recipe = |(recipe, depth_scale): (&str, f64)| {
        let source: MapSource = recipe.parse()?;
        let surface = Surface {
            side: SIDE,
            depth_scale,
            repeat: 4.0,
        };
        Ok((source.load(Channel::Grey, false)?, surface))
    };
    let recipes = [
        ("procedural:rocks:256:1", 10.0),
        ("procedural:spikes:128:1", 30.0),
    ];
    let maps: anyhow::Result<Vec<_>> = recipes.into_iter().map(recipe).collect();
    Ok((maps?, false))
}

impl WalkScene {
    /// A variant of a map on its surface.
    ///
    /// # Errors
    /// If the map cannot be made larger.
    pub fn new(map: &HeightMap, surface: Surface, variant: Variant) -> anyhow::Result<WalkScene> {
        let (map, surface) = match variant {
            Variant::Own => (map.clone(), surface),
            Variant::Tiled => {
                let surface = surface.with_tiled_map(4096 / map.size());
                (tiled(map, 4096)?, surface)
            }
            Variant::Smooth => (smooth(map, 4 * map.size())?, surface),
            Variant::LargeSmooth => (smooth(map, 4096)?, surface),
        };
        let pyramid = Pyramid::new(&map);
        Ok(WalkScene {
            map,
            pyramid,
            surface,
        })
    }
}

/// The map with heights of 16 bits, interpolated between its own.
fn smooth(map: &HeightMap, size: u32) -> anyhow::Result<HeightMap> {
    // 255 becomes 65535.
    let heights = map.heights().iter().map(|height| height * 257).collect();
    let name = format!("{}, 16 bit", map.name());
    let wide = HeightMap::new(&name, map.size(), 16, heights).context("heights of 16 bits")?;
    Ok(enlarged(&wide, size, Enlargement::Bilinear)?)
}
