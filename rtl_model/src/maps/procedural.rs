//! Height maps from a recipe: the same on every machine, and they tile.

use std::fmt;

use rayon::prelude::*;

use super::height_map::check_size;
use super::noise::{blend, fractal, gradient, hash, nearest, pair, smooth_step};
use super::{HeightMap, MapError};

/// What a procedural map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pattern {
    /// Eight courses of four bricks with joints of mortar.
    Bricks,
    /// Round stones, close together.
    Rocks,
    /// Thin cones on a plain: narrow features that a careless traversal misses.
    Spikes,
    /// One mountain with ridges.
    Mountain,
    /// One height everywhere: the seed itself, 0 (bottom) to 255 (top).
    Flat,
    /// Squares of heights 0 and 255, eight by eight; the seed's last bit swaps them. All walls.
    Checkerboard,
}

impl Pattern {
    /// All of them, in the order of the documentation.
    pub const ALL: [Pattern; 6] = [
        Pattern::Bricks,
        Pattern::Rocks,
        Pattern::Spikes,
        Pattern::Mountain,
        Pattern::Flat,
        Pattern::Checkerboard,
    ];

    /// The name in a recipe.
    pub const fn name(self) -> &'static str {
        match self {
            Pattern::Bricks => "bricks",
            Pattern::Rocks => "rocks",
            Pattern::Spikes => "spikes",
            Pattern::Mountain => "mountain",
            Pattern::Flat => "flat",
            Pattern::Checkerboard => "checkerboard",
        }
    }

    /// All names, for messages.
    pub(super) fn list() -> String {
        Pattern::ALL.map(Pattern::name).join(", ")
    }
}

/// The recipe of a map, written `procedural:NAME:SIZE:SEED`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Procedural {
    pattern: Pattern,
    size: u32,
    seed: u64,
}

impl Procedural {
    /// A recipe for a map of `size` x `size` texels of 8 bits.
    ///
    /// # Errors
    /// A size that is not a power of two of 1 to [`MAX_SIZE`](super::MAX_SIZE), or for [`Pattern::Flat`] a seed
    /// above 255.
    pub fn new(pattern: Pattern, size: u32, seed: u64) -> Result<Procedural, MapError> {
        let recipe = Procedural {
            pattern,
            size,
            seed,
        };
        check_size(&recipe.to_string(), size, size)?;
        if pattern == Pattern::Flat && seed > 255 {
            return Err(MapError::ProceduralNumber {
                text: recipe.to_string(),
                found: seed.to_string(),
                part: "seed",
                range: "from 0 to 255, the height of the flat map",
            });
        }
        Ok(recipe)
    }

    /// Reads `NAME:SIZE:SEED`; `text` is the whole, for messages.
    pub(super) fn parse(text: &str, recipe: &str) -> Result<Procedural, MapError> {
        let parts: Vec<&str> = recipe.split(':').collect();
        let [name, size, seed] = parts[..] else {
            return Err(MapError::ProceduralSyntax {
                text: text.to_owned(),
            });
        };
        let pattern = Pattern::ALL
            .into_iter()
            .find(|pattern| pattern.name() == name)
            .ok_or_else(|| MapError::UnknownPattern {
                text: text.to_owned(),
                name: name.to_owned(),
            })?;
        let not_a = |part, found: &str, range| MapError::ProceduralNumber {
            text: text.to_owned(),
            found: found.to_owned(),
            part,
            range,
        };
        let size = size
            .parse()
            .map_err(|_| not_a("size", size, "and a power of two from 1 to 4096"))?;
        let seed = seed
            .parse()
            .map_err(|_| not_a("seed", seed, "from 0 to 18446744073709551615"))?;
        Procedural::new(pattern, size, seed)
    }

    /// What the map shows.
    pub fn pattern(&self) -> Pattern {
        self.pattern
    }

    /// Texels on a side.
    pub fn size(&self) -> u32 {
        self.size
    }

    /// The seed of its randomness.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The map. Its name is the recipe.
    pub fn generate(&self) -> HeightMap {
        let seed = self.seed;
        let heights = match self.pattern {
            Pattern::Bricks => quantised(self.sampled(|u, v| bricks(seed, u, v))),
            Pattern::Rocks => quantised(self.sampled(|u, v| rocks(seed, u, v))),
            Pattern::Spikes => quantised(self.sampled(|u, v| spikes(seed, u, v))),
            Pattern::Mountain => quantised(stretched(self.sampled(|u, v| mountain(seed, u, v)))),
            // A recipe of a flat map has no seed above 255.
            Pattern::Flat => vec![seed as u8; (self.size * self.size) as usize],
            Pattern::Checkerboard => checkerboard(seed, self.size),
        };
        HeightMap::from_bytes(self.to_string(), self.size, &heights)
    }

    /// A function of the position on the unit torus at all texel centres, row by row.
    fn sampled(&self, height: impl Fn(f64, f64) -> f64 + Sync) -> Vec<f64> {
        let centre = |index: u32| (f64::from(index) + 0.5) / f64::from(self.size);
        (0..self.size)
            .into_par_iter()
            .flat_map_iter(|j| {
                let height = &height;
                (0..self.size).map(move |i| height(centre(i), centre(j)))
            })
            .collect()
    }
}

impl fmt::Display for Procedural {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Procedural {
            pattern,
            size,
            seed,
        } = self;
        write!(f, "procedural:{}:{size}:{seed}", pattern.name())
    }
}

/// Heights in [0, 1] as 8-bit integers, rounded to nearest.
fn quantised(heights: Vec<f64>) -> Vec<u8> {
    heights
        .into_iter()
        .map(|height| (height.clamp(0.0, 1.0) * 255.0 + 0.5).floor() as u8)
        .collect()
}

/// Heights moved and scaled so that the lowest is 0 and the highest 1; all 0 if they are one.
fn stretched(mut heights: Vec<f64>) -> Vec<f64> {
    let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    for height in &mut heights {
        *height = if high > low {
            (*height - low) / (high - low)
        } else {
            0.0
        };
    }
    heights
}

/// Bricks in running bond, worn at the edges, each a little higher or lower and tilted.
fn bricks(seed: u64, u: f64, v: f64) -> f64 {
    const COURSES: f64 = 8.0;
    const PER_COURSE: f64 = 4.0;
    const HALF_JOINT: f64 = 0.006;
    const CORNER: f64 = 0.016;

    let course = (v * COURSES).floor();
    let shift = if course % 2.0 == 0.0 { 0.0 } else { 0.5 };
    let along = u * PER_COURSE + shift;
    let brick = along.floor() % PER_COURSE;
    let (across_brick, down_brick) = (along - along.floor(), v * COURSES - course);

    // The distance to the brick's border, rounded at the corners, in repeats of the map; wear moves
    // the border to and fro.
    let wear = 0.006 * fractal(seed ^ 1, u, v, 24, 3);
    let inset = |fraction: f64, length: f64| fraction.min(1.0 - fraction) * length - HALF_JOINT;
    let lack_x = (CORNER - inset(across_brick, 1.0 / PER_COURSE)).max(0.0);
    let lack_y = (CORNER - inset(down_brick, 1.0 / COURSES)).max(0.0);
    let inside = CORNER - (lack_x * lack_x + lack_y * lack_y).sqrt() + wear;

    let own = hash(seed, brick as i64, course as i64);
    let (rise, tilt) = pair(own);
    let face = 0.74
        + 0.18 * rise
        + 0.12 * (tilt - 0.5) * (across_brick - 0.5)
        + 0.10 * fractal(seed ^ 2, u, v, 16, 4);
    let mortar = 0.22 + 0.10 * fractal(seed ^ 3, u, v, 32, 3);
    blend(mortar, face, smooth_step(inside / CORNER))
}

/// Stones that fill the cells of a random division of the plane.
fn rocks(seed: u64, u: f64, v: f64) -> f64 {
    // Bending the plane first keeps the borders between stones from being straight.
    let bend = |salt| 0.02 * fractal(seed ^ salt, u, v, 6, 3);
    let wrap = |x: f64| x - x.floor();
    let stone = nearest(seed, wrap(u + bend(1)), wrap(v + bend(2)), 6, 0.9);
    let (rise, lean) = pair(stone.hash.rotate_left(16));
    let from_gap = stone.second_distance - stone.distance;
    let dome = smooth_step(from_gap / 0.55).sqrt() * (1.0 - 0.35 * stone.distance * stone.distance);
    let slope = 0.35 * ((rise - 0.5) * stone.offset.0 + (lean - 0.5) * stone.offset.1);
    let grain = 0.12 * fractal(seed ^ 3, u, v, 12, 4);
    0.08 + dome * (0.55 + 0.32 * rise + slope) + grain * (0.3 + 0.7 * dome)
}

/// Cones, some of them to the top plane.
fn spikes(seed: u64, u: f64, v: f64) -> f64 {
    let spike = nearest(seed, u, v, 8, 0.7);
    let (rise, width) = pair(spike.hash.rotate_left(16));
    let radius = 0.28 + 0.2 * width;
    let flank = (1.0 - spike.distance / radius).max(0.0);
    let plain = 0.06 + 0.05 * gradient(seed ^ 1, u, v, 4);
    plain + (1.0 - plain) * (0.55 + 0.5 * rise) * flank * flank.sqrt()
}

/// Ridges, the higher the nearer to the middle of the map.
fn mountain(seed: u64, u: f64, v: f64) -> f64 {
    // 1 in the middle of the map, 0 on its border, and flat there: it tiles.
    let swell = |x: f64| {
        let parabola = 4.0 * x * (1.0 - x);
        parabola * parabola
    };
    let body = swell(u) * swell(v);
    let mut ridges = 0.0;
    let mut weight = 0.5;
    // A ridge's fine detail shows on its crest, not in the valley.
    let mut crest = 1.0;
    for octave in 0..6 {
        let fold = 1.0 - 1.8 * gradient(seed.wrapping_add(octave), u, v, 3 << octave).abs();
        let ridge = fold.max(0.0) * fold.max(0.0);
        ridges += weight * ridge * crest;
        crest = ridge;
        weight /= 2.0;
    }
    body * (0.6 + 0.6 * ridges) + 0.12 * ridges
}

/// Eight by eight squares, or as many as there are texels.
fn checkerboard(seed: u64, size: u32) -> Vec<u8> {
    let square = (size / 8).max(1);
    (0..size)
        .flat_map(|j| (0..size).map(move |i| (i / square + j / square) & 1))
        .map(|parity| {
            if u64::from(parity) == seed & 1 {
                255
            } else {
                0
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::MAX_SIZE;

    fn map(pattern: Pattern, size: u32, seed: u64) -> HeightMap {
        Procedural::new(pattern, size, seed).unwrap().generate()
    }

    /// A digest of the heights (FNV-1a, 64 bits).
    fn digest(map: &HeightMap) -> u64 {
        map.heights()
            .iter()
            .fold(0xcbf2_9ce4_8422_2325, |digest, &height| {
                (digest ^ u64::from(height)).wrapping_mul(0x0000_0100_0000_01b3)
            })
    }

    /// Digests recorded once: vectors are made from these maps, so a change here changes those.
    #[test]
    fn a_recipe_gives_the_same_map_everywhere() {
        let digests = [
            (Pattern::Bricks, 64, 1, 0x93f3_98f7_84a6_5aac),
            (Pattern::Bricks, 64, 2, 0xbc67_b338_f35f_af08),
            (Pattern::Rocks, 64, 1, 0x7441_274d_e4d7_f421),
            (Pattern::Rocks, 256, 1, 0x0187_985e_95e8_d631),
            (Pattern::Spikes, 64, 1, 0x2ab4_075a_e844_9964),
            (Pattern::Mountain, 64, 1, 0x48a5_d207_116d_6d2c),
            (Pattern::Flat, 4, 128, 0x2751_0c20_2f07_4065),
            (Pattern::Checkerboard, 16, 0, 0x784e_a92e_2b65_3aa5),
            (Pattern::Checkerboard, 16, 1, 0x9f2d_633f_2a7a_dca5),
        ];
        let found = digests.map(|(pattern, size, seed, _)| {
            (pattern, size, seed, digest(&map(pattern, size, seed)))
        });
        assert_eq!(found, digests, "{found:#x?}");
    }

    #[test]
    fn every_pattern_generates_at_every_small_size() {
        for pattern in Pattern::ALL {
            for size in [1, 2, 4, 8, 16] {
                let map = map(pattern, size, 3);
                assert_eq!((map.size(), map.bits()), (size, 8));
            }
        }
    }

    #[test]
    fn patterns_use_most_of_the_range() {
        for pattern in [
            Pattern::Bricks,
            Pattern::Rocks,
            Pattern::Spikes,
            Pattern::Mountain,
            Pattern::Checkerboard,
        ] {
            for seed in 0..4 {
                let map = map(pattern, 128, seed);
                let low = map.heights().iter().min().unwrap();
                let high = map.heights().iter().max().unwrap();
                assert!(*low < 64 && *high > 220, "{pattern:?}: {low} to {high}");
            }
        }
    }

    /// Across the border of the map, neighbours differ no more than inside it.
    #[test]
    fn patterns_tile() {
        for pattern in [Pattern::Bricks, Pattern::Rocks, Pattern::Mountain] {
            let map = map(pattern, 256, 5);
            let size = i64::from(map.size());
            let step = |i: i64| {
                (0..size)
                    .map(|j| {
                        let across = map.height(i, j).abs_diff(map.height(i - 1, j));
                        let along = map.height(j, i).abs_diff(map.height(j, i - 1));
                        across.max(along)
                    })
                    .max()
            };
            let inside = (1..size).map(step).max().unwrap();
            assert!(step(0) <= inside, "{pattern:?}");
        }
    }

    #[test]
    fn a_checkerboard_has_equal_squares_of_both_heights() {
        let map = map(Pattern::Checkerboard, 16, 0);
        assert_eq!((map.height(0, 0), map.height(1, 1)), (255, 255));
        assert_eq!((map.height(2, 0), map.height(2, 2)), (0, 255));
        let high = map.heights().iter().filter(|&&height| height == 255);
        assert_eq!(high.count(), 128);
    }

    #[test]
    fn the_largest_size_is_the_documented_one() {
        assert_eq!(MAX_SIZE, 4096);
        assert!(Procedural::new(Pattern::Flat, MAX_SIZE, 0).is_ok());
    }
}
