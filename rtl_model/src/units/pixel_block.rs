//! The samples that a depth-interval grid leaves to the pixels of a block, and the block of a ray
//! that no frame has.
//!
//! In a frame the corner rays of a block are those of pixels ([`crate::frame`]). A ray of a list has
//! no pixel, and is given one: it is the pixel in the middle of a block of its own, seen by a camera
//! so far away that the rays of neighbouring pixels are parallel, and enter the map
//! [`NOMINAL_PIXEL`] apart. Its corner rays so enter half a block before it and half a block
//! beyond it on both axes. They are searched for it alone, and their samples are not counted among
//! its steps: in a frame sixteen pixels share them.

use super::linear_ray::{INTERVAL_MARGIN, LINEAR_SAMPLES, LinearRay, SampleRange};
use super::linear_walk::first_sample_below;
use crate::maps::Pyramid;
use crate::ray::{Ray, reduce};
use crate::readings::NumberFormat;

/// Pixels on a side of a block of a depth-interval grid (Judnich and Ling, 3: 4 x 4).
pub const BLOCK: u32 = 4;

/// How far apart the rays of neighbouring pixels enter the map where no frame says, in texels. At
/// 1024 x 768 pixels, and 256 texels to a repeat, it is 1.08 for the camera that looks from above,
/// and 0.52 by 1.39 for the oblique one.
pub const NOMINAL_PIXEL: f64 = 1.0;

impl SampleRange {
    /// The samples between the first ones below the surface of a block's corner rays, with
    /// [`INTERVAL_MARGIN`] more on both sides.
    ///
    /// # Panics
    /// Without a corner.
    pub fn between_corners(first_below: &[u32]) -> SampleRange {
        let least = first_below.iter().min().expect("a corner");
        let greatest = first_below.iter().max().expect("a corner");
        SampleRange {
            samples_to_bottom: LINEAR_SAMPLES,
            // The bracket before sample n starts at n - 1; the first sample lies behind its start.
            first: least.saturating_sub(INTERVAL_MARGIN).max(1),
            last: (greatest + INTERVAL_MARGIN).min(LINEAR_SAMPLES),
        }
    }

    /// The samples left to an admitted ray of a list by the corner rays of its own block.
    pub fn of_listed_ray<R: NumberFormat>(
        reading: &mut R,
        pyramid: &Pyramid,
        ray: Ray<f64>,
    ) -> SampleRange {
        let first_below = listed_corners(ray, pyramid.size()).map(|corner| {
            let corner = LinearRay::enter(reading, corner, SampleRange::whole(LINEAR_SAMPLES));
            first_sample_below(reading, pyramid, &corner)
        });
        SampleRange::between_corners(&first_below)
    }
}

/// The corner rays of the block around a ray of a list, on a map of so many texels a side.
fn listed_corners(ray: Ray<f64>, size: u32) -> [Ray<f64>; 4] {
    let away = f64::from(BLOCK / 2) * NOMINAL_PIXEL / f64::from(size);
    [(-away, -away), (away, -away), (-away, away), (away, away)].map(|(u, v)| Ray {
        u: reduce(ray.u + u),
        v: reduce(ray.v + v),
        ..ray
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::HeightMap;
    use crate::readings::F64Reading;

    #[test]
    fn corners_lie_two_texels_away_and_wrap() {
        let ray = Ray {
            u: 1.0 / 16.0,
            v: 0.5,
            du: 0.25,
            dv: -1.0,
        };
        let corners = listed_corners(ray, 16);
        let places = corners.map(|corner| (corner.u * 16.0, corner.v * 16.0));
        assert_eq!(places, [(15.0, 6.0), (3.0, 6.0), (15.0, 10.0), (3.0, 10.0)]);
        assert!(corners.iter().all(|c| (c.du, c.dv) == (0.25, -1.0)));
    }

    /// Straight down, each corner meets its own texel: that of height h is first below the surface
    /// at the sample at or behind its depth.
    #[test]
    fn an_interval_holds_what_its_corners_meet() {
        let mut heights = vec![255_u16; 64];
        for (place, height) in [(1, 204), (5, 153), (33, 102), (37, 51)] {
            heights[place] = height;
        }
        // Texels (1, 0), (5, 0), (1, 4), (5, 4), at a fifth, two, three and four of the depth.
        let pyramid = Pyramid::new(&HeightMap::new("steps", 8, 8, heights).expect("a map"));
        let ray = Ray {
            u: 3.5 / 8.0,
            v: 2.5 / 8.0,
            du: 0.0,
            dv: 0.0,
        };
        let range = SampleRange::of_listed_ray(&mut F64Reading, &pyramid, ray);
        // A sample rounded down may lie just above what is at its depth.
        assert!((19..=20).contains(&range.first), "{range:?}");
        assert!((81..=82).contains(&range.last), "{range:?}");
    }
}
