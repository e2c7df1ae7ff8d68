//! From a pixel to the ray a traverse unit walks.
//!
//! World space is that of the 2013 paper's scenes: left-handed, `y` up, the displaced surface a
//! square in the plane `y = 0` with its centre at the origin. The texture coordinate `u` grows with
//! `x` and `v` falls with `z`, so that from above, with `z` up, the map is seen as displayed.
//!
//! A ray is `f64` here; the unit's format rounds it on entry.

mod degrees;

use glam::DVec3;
use thiserror::Error;

use crate::ray::{self, Ray, RayError};
use degrees::sine_cosine;

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye is, in world units `[x, y, z]`; `y` is above 0, the plane.
    pub eye: [f64; 3],
    /// Pitch of the view axis below the horizon, in degrees: 90 looks straight down, negative
    /// values look up.
    pub elevation_deg: f64,
    /// Direction of the view axis over the plane, in degrees from `+z` towards `+x`.
    pub azimuth_deg: f64,
    /// The vertical field of view, in degrees; above 0, below 180.
    pub fov_y_deg: f64,
}

/// The square that the height map displaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Side of the square, in world units.
    pub side: f64,
    /// World units below the plane of depth 1, the bottom.
    pub depth_scale: f64,
    /// Repeats of the map across a side.
    pub repeat: f64,
}

impl Surface {
    /// The surface laid with a map that repeats its own `copies` times on a side
    /// ([`crate::maps::tiled`]), so that it looks the same.
    #[must_use]
    pub fn with_tiled_map(self, copies: u32) -> Surface {
        Surface {
            repeat: self.repeat / f64::from(copies),
            ..self
        }
    }

    /// How deep depth 1 is, in repeats of the map.
    pub fn depth_in_repeats(&self) -> f64 {
        self.depth_scale / self.side * self.repeat
    }
}

/// Where a pixel's view ray enters the surface: a [`Ray`] that has not been reduced to one repeat.
///
/// `u` and `v` run from 0 to the surface's repeat; `du` and `dv` are the offset for one unit of
/// depth, in the same units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceRay {
    /// Entry along `x`.
    pub u: f64,
    /// Entry against `z`.
    pub v: f64,
    /// Change of `u` over one unit of depth.
    pub du: f64,
    /// Change of `v` over one unit of depth.
    pub dv: f64,
}

impl SurfaceRay {
    /// The ray with its entry reduced to the first repeat, [0, 1): what a unit walks, since the map
    /// wraps. See [`ray::reduce`] for the rounding.
    pub fn reduced(self) -> Ray<f64> {
        Ray {
            u: ray::reduce(self.u),
            v: ray::reduce(self.v),
            du: self.du,
            dv: self.dv,
        }
    }
}

/// A pixel whose ray a unit cannot walk.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "pixel ({x}, {y}): {problem}; a higher eye, or a smaller `depth_scale` or `repeat` of the \
     surface, makes a steeper ray"
)]
pub struct PixelRayError {
    /// Column of the pixel, 0 at the left.
    pub x: u32,
    /// Row of the pixel, 0 at the top.
    pub y: u32,
    /// What is wrong with its ray.
    pub problem: RayError,
}

/// A camera before a surface, for a frame of `width` x `height` pixels: gives each pixel its ray.
#[derive(Clone, Copy, Debug)]
pub struct View {
    eye: DVec3,
    /// The view axis, of length 1.
    forward: DVec3,
    /// From the centre of the frame to the middle of its right edge, at distance 1 from the eye.
    half_right: DVec3,
    /// From the centre of the frame to the middle of its upper edge, at distance 1 from the eye.
    half_up: DVec3,
    surface: Surface,
    width: u32,
    height: u32,
}

impl View {
    /// The view of `camera` on `surface`. Pixels are square.
    pub fn new(camera: &Camera, surface: &Surface, width: u32, height: u32) -> View {
        let (sin_elevation, cos_elevation) = sine_cosine(camera.elevation_deg);
        let (sin_azimuth, cos_azimuth) = sine_cosine(camera.azimuth_deg);
        let (sin_half_fov, cos_half_fov) = sine_cosine(camera.fov_y_deg / 2.0);
        let half_height = sin_half_fov / cos_half_fov;
        let half_width = half_height * f64::from(width) / f64::from(height);
        let right = DVec3::new(cos_azimuth, 0.0, -sin_azimuth);
        let up = DVec3::new(
            sin_elevation * sin_azimuth,
            cos_elevation,
            sin_elevation * cos_azimuth,
        );
        View {
            eye: DVec3::from_array(camera.eye),
            forward: DVec3::new(
                cos_elevation * sin_azimuth,
                -sin_elevation,
                cos_elevation * cos_azimuth,
            ),
            half_right: right * half_width,
            half_up: up * half_height,
            surface: *surface,
            width,
            height,
        }
    }

    /// The ray through the centre of pixel `(x, y)`, counted from the upper left; none where it
    /// looks up or misses the square.
    pub fn ray(&self, x: u32, y: u32) -> Option<SurfaceRay> {
        let across = (2.0 * f64::from(x) + 1.0) / f64::from(self.width) - 1.0;
        let upwards = 1.0 - (2.0 * f64::from(y) + 1.0) / f64::from(self.height);
        let direction = self.forward + self.half_right * across + self.half_up * upwards;
        let fall = -direction.y;
        let distance = self.eye.y / fall;
        // Written so that NaN has no ray.
        if !(fall > 0.0 && distance > 0.0) {
            return None;
        }
        let entry = self.eye + direction * distance;
        let Surface {
            side,
            depth_scale,
            repeat,
        } = self.surface;
        let half = side / 2.0;
        if !(entry.x.abs() <= half && entry.z.abs() <= half) {
            return None;
        }
        Some(SurfaceRay {
            u: (entry.x / side + 0.5) * repeat,
            v: (0.5 - entry.z / side) * repeat,
            du: direction.x / fall * depth_scale / side * repeat,
            dv: -direction.z / fall * depth_scale / side * repeat,
        })
    }

    /// The rays of the whole frame, row by row from the upper left, reduced and checked for a map
    /// of `map_size` x `map_size` texels.
    ///
    /// # Errors
    /// The first pixel whose ray does not pass [`ray::check`].
    pub fn rays(&self, map_size: u32) -> Result<Vec<Option<Ray<f64>>>, PixelRayError> {
        (0..self.height)
            .flat_map(|y| (0..self.width).map(move |x| (x, y)))
            .map(|(x, y)| {
                self.ray(x, y)
                    .map(|ray| ray::check(ray.reduced(), map_size))
                    .transpose()
                    .map_err(|problem| PixelRayError { x, y, problem })
            })
            .collect()
    }

    /// The rays of the whole frame, as [`View::rays`] has them, in the order in which a renderer
    /// sends them: by square tiles of `tile` x `tile` pixels, each row by row.
    ///
    /// # Errors
    /// As of [`View::rays`].
    pub fn rays_by_tile(&self, map_size: u32, tile: u32) -> Result<Vec<Ray<f64>>, PixelRayError> {
        let rays = self.rays(map_size)?;
        let mut places: Vec<u32> = (0..rays.len() as u32).collect();
        places.sort_by_key(|place| {
            let (x, y) = (place % self.width, place / self.width);
            (y / tile, x / tile, y, x)
        });
        let chosen = places.into_iter().filter_map(|place| rays[place as usize]);
        Ok(chosen.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration;

    const SURFACE: Surface = Surface {
        side: 200.0,
        depth_scale: 10.0,
        repeat: 4.0,
    };

    /// Part of a 1024 x 768 screen whose pixels have a ray.
    fn share_on_the_plane(camera: &Camera) -> f64 {
        let (width, height) = (1024, 768);
        let view = View::new(camera, &SURFACE, width, height);
        let rays = view.rays(256).unwrap();
        rays.iter().flatten().count() as f64 / rays.len() as f64
    }

    #[test]
    fn the_calibrated_cameras_see_their_share_of_the_plane() {
        for (camera, expected) in [
            (calibration::FRONT, 0.846),
            (calibration::OBLIQUE, 0.933),
            (calibration::GRAZING, 0.221),
        ] {
            let share = share_on_the_plane(&camera);
            assert!((share - expected).abs() < 5e-4, "{camera:?}: {share}");
        }
    }

    #[test]
    fn a_camera_looking_straight_down_sees_the_map_as_displayed() {
        let camera = Camera {
            eye: [0.0, 100.0, 0.0],
            elevation_deg: 90.0,
            azimuth_deg: 0.0,
            fov_y_deg: 60.0,
        };
        let view = View::new(&camera, &SURFACE, 3, 3);
        let centre = view.ray(1, 1).unwrap();
        assert_eq!(
            (centre.u, centre.v, centre.du, centre.dv),
            (2.0, 2.0, 0.0, 0.0)
        );
        let right = view.ray(2, 1).unwrap();
        let below = view.ray(1, 2).unwrap();
        assert!(right.u > centre.u && right.du > 0.0 && right.v == centre.v);
        assert!(below.v > centre.v && below.dv > 0.0 && below.u == centre.u);
    }

    #[test]
    fn the_offset_is_the_travel_from_top_to_bottom() {
        // 45 degrees down towards +z: ten units down are ten units along z, v falls.
        let camera = Camera {
            eye: [10.0, 30.0, -50.0],
            elevation_deg: 45.0,
            azimuth_deg: 0.0,
            fov_y_deg: 45.0,
        };
        let ray = View::new(&camera, &SURFACE, 1, 1).ray(0, 0).unwrap();
        let close = |a: f64, b: f64| (a - b).abs() < 1e-14;
        assert!(close(ray.u, (10.0 / 200.0 + 0.5) * 4.0));
        assert!(close(ray.v, (0.5 + 20.0 / 200.0) * 4.0));
        assert!(close(ray.du, 0.0));
        assert!(close(ray.dv, -10.0 / 200.0 * 4.0));
        let reduced = ray.reduced();
        assert!(close(reduced.u, 0.2) && close(reduced.v, 0.4));
    }

    #[test]
    fn the_sky_has_no_rays() {
        let camera = Camera {
            elevation_deg: -60.0,
            ..calibration::GRAZING
        };
        assert_eq!(share_on_the_plane(&camera), 0.0);
    }

    #[test]
    fn a_ray_too_shallow_for_the_unit_names_its_pixel() {
        let camera = Camera {
            eye: [0.0, 1e-4, 0.0],
            elevation_deg: 0.0,
            azimuth_deg: 0.0,
            fov_y_deg: 4e-4,
        };
        let error = View::new(&camera, &SURFACE, 1, 2).rays(256).unwrap_err();
        assert_eq!((error.x, error.y), (0, 1));
        assert!(error.to_string().contains("higher eye"), "{error}");
    }
}
