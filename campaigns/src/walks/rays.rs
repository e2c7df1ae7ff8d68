//! Rays of three kinds: of the calibrated cameras, at random, and on a grid that meets ties.

use rtl_model::calibration::CAMERAS;
use rtl_model::camera::View;
use rtl_model::maps::Pyramid;
use rtl_model::ray::{self, Ray};
use rtl_model::ray_format::{QuantisedRay, RayFormat};

use super::WalkScene;

/// Pixels of a camera's frame on a side: so many that rays hardly repeat.
const FRAME_SIDE: u32 = 8192;

/// The most texels that a random ray travels.
const MOST_TEXELS: f64 = 4096.0;

/// Numbered rays through a map: the same from the same seed.
pub struct RaySource {
    views: Vec<View>,
    format: RayFormat,
    size: u32,
    bits: u32,
    seed: u64,
}

impl RaySource {
    /// The rays of a scene.
    pub fn new(scene: &WalkScene, seed: u64) -> RaySource {
        let view = |(_, camera)| View::new(&camera, &scene.surface, FRAME_SIDE, FRAME_SIDE);
        let pyramid: &Pyramid = &scene.pyramid;
        RaySource {
            views: CAMERAS.into_iter().map(view).collect(),
            format: RayFormat::within_reach(pyramid),
            size: pyramid.size(),
            bits: pyramid.bits(),
            seed,
        }
    }

    /// The format that they are quantised in: of all rays within reach.
    pub fn format(&self) -> &RayFormat {
        &self.format
    }

    /// Ray `number`, quantised, and the ray that it was quantised from; a ray of the grid is made
    /// quantised. In turn: two of a camera, one at random, one of the grid.
    pub fn ray(&self, number: u64) -> (QuantisedRay, Option<Ray<f64>>) {
        let mut draw = Draw::new(self.seed, number);
        match number % 4 {
            0 | 1 => {
                let ray = self.camera_ray(&mut draw);
                (self.format.quantise(ray), Some(ray))
            }
            2 => {
                let ray = self.random_ray(&mut draw);
                (self.format.quantise(ray), Some(ray))
            }
            _ => (self.grid_ray(&mut draw), None),
        }
    }

    /// A view ray of one of the cameras that the unit can walk; at random if a few pixels have
    /// none.
    fn camera_ray(&self, draw: &mut Draw) -> Ray<f64> {
        for _ in 0..16 {
            let view = &self.views[draw.below(self.views.len() as u64) as usize];
            let (x, y) = (draw.below(FRAME_SIDE.into()), draw.below(FRAME_SIDE.into()));
            if let Some(ray) = view.ray(x as u32, y as u32)
                && let Ok(ray) = ray::check(ray.reduced(), self.size)
            {
                return ray;
            }
        }
        self.random_ray(draw)
    }

    /// Any entry, any direction, any slope up to some thousand texels: steep ones as often as
    /// shallow ones.
    fn random_ray(&self, draw: &mut Draw) -> Ray<f64> {
        let size = f64::from(self.size);
        let direction = |draw: &mut Draw| {
            let texels = MOST_TEXELS * 2_f64.powf(-16.0 * draw.part());
            let sign = if draw.below(2) == 0 { 1.0 } else { -1.0 };
            sign * texels / size
        };
        Ray {
            u: draw.part(),
            v: draw.part(),
            du: direction(draw),
            dv: direction(draw),
        }
    }

    /// Entries on borders and quarters of texels, slopes that are equal, zero, or such that borders
    /// are met at whole height steps; one in four a unit of the last place off.
    fn grid_ray(&self, draw: &mut Draw) -> QuantisedRay {
        let quarter = 1_i64 << (self.format.entry_fraction_bits() - 2);
        let entries = u64::from(self.size) * 4;
        let coordinate = |draw: &mut Draw| draw.below(entries) as i64 * quarter;
        let (u, v) = (coordinate(draw), coordinate(draw));
        // A texel in as many height steps as a power of two.
        let texel = 1_i64 << self.format.slope.fraction_bits;
        let slope = |draw: &mut Draw| {
            let steps = draw.below(u64::from(self.bits) + 2) as u32;
            let quarters = draw.below(17) as i64 - 8;
            // No further than other rays: a texel a step is the most.
            (texel >> steps) * quarters / 8
        };
        let du = slope(draw);
        let mut dv = match draw.below(4) {
            0 => du,
            1 => -du,
            _ => slope(draw),
        };
        if draw.below(4) == 0 {
            dv += draw.below(3) as i64 - 1;
        }
        QuantisedRay {
            u,
            v,
            du: self.within_travel(du),
            dv: self.within_travel(dv),
            saturated: false,
        }
    }

    /// A slope, halved until the ray travels no further than random ones.
    fn within_travel(&self, mut slope: i64) -> i64 {
        let most = ((MOST_TEXELS as i64) << self.format.slope.fraction_bits) >> self.bits;
        while slope.abs() > most {
            slope /= 2;
        }
        slope
    }
}

/// Numbers that look random, from a seed and a place.
struct Draw(u64);

impl Draw {
    fn new(seed: u64, number: u64) -> Draw {
        let mut draw = Draw(seed.wrapping_mul(0xd1b5_4a32_d192_ed03) ^ number);
        draw.next();
        draw
    }

    /// By D. Stafford's mixing of a counter ("splitmix64", variant 13).
    fn next(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(0x2545_f491_4f6c_dd1d)
            .wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// One of `0..count`.
    fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }

    /// From 0 to below 1.
    fn part(&mut self) -> f64 {
        (self.next() >> 11) as f64 / 2_f64.powi(53)
    }
}
