//! The picture as a person would see it.

use glam::DVec3;
use image::RgbImage;

use super::Frame;
use super::colour::{background, encode};
use crate::camera::Surface;
use crate::maps::HeightMap;
use crate::scene::Light;

/// Light from the sky and from the lamp on what faces them, in linear red, green and blue.
const SKY: DVec3 = DVec3::new(0.17, 0.20, 0.25);
const LAMP: DVec3 = DVec3::new(0.90, 0.84, 0.74);
/// The material at the bottom and at the top, in linear red, green and blue.
const LOW: DVec3 = DVec3::new(0.34, 0.20, 0.12);
const HIGH: DVec3 = DVec3::new(0.84, 0.82, 0.76);

/// The frame in the light of one lamp: Lambert's law with light from the sky besides, on a
/// material that is darker and browner the deeper it lies. Pixels without a ray show a dim sky.
///
/// The picture is as large as the frame. Normals are central differences of the heights around the
/// texel that was hit, weighted by Sobel's kernel; a wrong texel therefore shows as a speck. `surface`
/// is how the map is laid: it says how steep the slopes are.
pub fn shaded_picture(
    frame: &Frame,
    map: &HeightMap,
    surface: &Surface,
    light: &Light,
) -> RgbImage {
    let to_light = DVec3::from_array(light.direction).normalize_or(DVec3::Z);
    // Depth in texels: what a difference of 1 in depth is in the map's own plane.
    let relief = surface.depth_scale * surface.repeat / surface.side * f64::from(map.size());
    RgbImage::from_fn(frame.width(), frame.height(), |x, y| {
        let Some(hit) = frame.hit(x, y) else {
            return background(y, frame.height());
        };
        let normal = normal(map, i64::from(hit.i), i64::from(hit.j), relief);
        let material = HIGH.lerp(LOW, hit.t.clamp(0.0, 1.0));
        // A slope sees a part of the sky, and a deep place less of that.
        let open = (0.5 + 0.5 * normal.z) * (1.0 - 0.6 * hit.t.clamp(0.0, 1.0));
        let lambert = normal.dot(to_light).max(0.0);
        let lit = material * (SKY * open + LAMP * lambert);
        image::Rgb([encode(lit.x), encode(lit.y), encode(lit.z)])
    })
}

/// The normal at texel `(i, j)` in tangent space, of length 1; `relief` is the depth in texels.
fn normal(map: &HeightMap, i: i64, j: i64, relief: f64) -> DVec3 {
    let depth = |across: i64, along: i64| map.depth(i + across, j + along);
    // Sobel: a central difference over two texels, averaged over three rows as 1, 2, 1.
    let sobel = |side: &dyn Fn(i64, i64) -> f64| {
        let edge = |at: i64| side(at, -1) + 2.0 * side(at, 0) + side(at, 1);
        (edge(1) - edge(-1)) / 8.0
    };
    let along_u = sobel(&|at, row| depth(at, row));
    let along_v = sobel(&|at, column| depth(column, at));
    // Depth grows away from the normal, so its slope is the normal's lean.
    DVec3::new(along_u * relief, along_v * relief, 1.0).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::PixelHit;

    const SURFACE: Surface = Surface {
        side: 1.0,
        depth_scale: 0.25,
        repeat: 1.0,
    };

    /// A frame with a pixel for each texel of `map`, seen from straight above.
    fn from_above(map: &HeightMap) -> Frame {
        let size = map.size();
        let texels = (0..size).flat_map(|j| (0..size).map(move |i| (i, j)));
        let hits = texels
            .map(|(i, j)| {
                Some(PixelHit {
                    i,
                    j,
                    t: map.depth(i64::from(i), i64::from(j)),
                    u: 0.0,
                    v: 0.0,
                    steps: 0,
                    crossings: 0,
                })
            })
            .collect();
        Frame::new(size, size, hits).unwrap()
    }

    /// A ridge along v: heights rise from column 0 to 8 and fall again.
    fn ridge() -> HeightMap {
        let heights = (0..256u16).map(|n| 30 * (8 - (n % 16).abs_diff(8)));
        HeightMap::new("ridge", 16, 8, heights.collect()).unwrap()
    }

    fn brightness(picture: &RgbImage, x: u32) -> u32 {
        picture.get_pixel(x, 5).0.into_iter().map(u32::from).sum()
    }

    #[test]
    fn slopes_that_face_the_light_are_brighter() {
        let map = ridge();
        let lit_from = |u: f64| {
            let light = Light {
                direction: [u, 0.0, 1.0],
            };
            shaded_picture(&from_above(&map), &map, &SURFACE, &light)
        };
        // Column 4 faces the left, column 12 the right; both are as deep.
        let (left, right) = (lit_from(-1.0), lit_from(1.0));
        assert!(brightness(&left, 4) > brightness(&left, 12));
        assert!(brightness(&right, 4) < brightness(&right, 12));
        assert_eq!(brightness(&left, 4), brightness(&right, 12));
    }

    #[test]
    fn a_normal_leans_away_from_the_ridge_by_its_slope() {
        let normal = normal(&ridge(), 4, 0, 4.0);
        let slope = 30.0 / 255.0 * 4.0;
        assert!((normal.x / normal.z + slope).abs() < 1e-12);
        assert_eq!(normal.y, 0.0);
    }

    #[test]
    fn pixels_without_a_ray_show_the_background() {
        let map = ridge();
        let frame = Frame::new(1, 2, vec![None; 2]).unwrap();
        let picture = shaded_picture(&frame, &map, &SURFACE, &Light::default());
        assert_eq!(*picture.get_pixel(0, 0), background(0, 2));
        assert_eq!(*picture.get_pixel(0, 1), background(1, 2));
    }
}
