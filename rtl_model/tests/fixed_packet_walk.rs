//! Fixed-point rays in packets against the walk of the definition, one at a time: every hit the same
//! in every field, bit for bit, on every instruction set that there is.

use proptest::prelude::*;
use rtl_model::calibration::{CAMERAS, SURFACES, real_maps};
use rtl_model::camera::View;
use rtl_model::fixed_packet::FixedPacketWalker;
use rtl_model::instruction_set::InstructionSet;
use rtl_model::maps::{Channel, HeightMap, MapSource, Pyramid};
use rtl_model::ray::{self, REACH_TEXELS, Ray};
use rtl_model::ray_format::RayFormat;
use rtl_model::scene::Method;
use rtl_model::units::fixed_traverse::fixed_walk;
use rtl_model::units::search_policy::SearchPolicy;
use rtl_model::units::traverse::{Hit, Status};
use rtl_model::units::wide_fixed::wide_fixed_walk;
use rtl_model::units::wide_fixed_step::WideFixedShape;
use std::path::Path;

const UNWALKED: Hit<f64> = Hit {
    i: u32::MAX,
    j: u32::MAX,
    t: f64::NAN,
    u: f64::NAN,
    v: f64::NAN,
    steps: 0,
    crossings: 0,
    status: Status::Guard,
};

/// A hit's bits: a zero of either sign is told from the other.
fn bits(hit: &Hit<f64>) -> ([u64; 3], [u32; 4], Status) {
    (
        [hit.t, hit.u, hit.v].map(f64::to_bits),
        [hit.i, hit.j, hit.steps, hit.crossings],
        hit.status,
    )
}

/// Walks the rays both ways in the format that holds all rays, and answers how many there were.
fn compare(map: &HeightMap, rays: &[Ray<f64>], name: &str) -> usize {
    let pyramid = Pyramid::new(map);
    compare_in(&pyramid, &RayFormat::within_reach(&pyramid), rays, name)
}

fn compare_in(pyramid: &Pyramid, format: &RayFormat, rays: &[Ray<f64>], name: &str) -> usize {
    let admit = |&ray| ray::check(ray, pyramid.size()).expect("a ray within reach");
    let rays: Vec<Ray<f64>> = rays.iter().map(admit).collect();
    let words = format.shape();
    let lines = WideFixedShape {
        words,
        log2_side: 2,
    };
    for method in [Method::Oh, Method::Block] {
        let judge = |&ray: &Ray<f64>| {
            let ray = format.quantise(ray);
            let hit = match method {
                Method::Oh => fixed_walk(words, SearchPolicy::OH, pyramid.memory(), &ray),
                _ => wide_fixed_walk(lines, pyramid.lines(2), &ray),
            };
            hit.to_hit(words, &ray)
        };
        let judged: Vec<Hit<f64>> = rays.iter().map(judge).collect();
        for instruction_set in InstructionSet::ALL {
            let walker = FixedPacketWalker::new(method, pyramid, format).expect("a packet walker");
            let walker = walker.with(instruction_set);
            let mut hits = vec![UNWALKED; rays.len()];
            walker.walk(&rays, &mut hits);
            for ((ray, hit), judged) in rays.iter().zip(&hits).zip(&judged) {
                assert_eq!(
                    bits(hit),
                    bits(judged),
                    "{name}, {method}, {instruction_set}, {format}: {ray:?}\npacket {hit:?}\nalone  {judged:?}"
                );
            }
        }
    }
    rays.len()
}

struct Random(u64);

impl Random {
    fn below(&mut self, count: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % count
    }

    /// 0 to 1.
    fn fraction(&mut self) -> f64 {
        self.below(1 << 53) as f64 / (1_u64 << 53) as f64
    }

    /// An entry coordinate; one in four has few bits, one in sixteen is next to zero or zero.
    fn coordinate(&mut self) -> f64 {
        match self.below(16) {
            0 => self.fraction() * (-(self.below(70) as f64)).exp2(),
            1..=4 => self.below(256) as f64 / 256.0,
            _ => self.fraction(),
        }
    }

    /// Any direction, any length within reach: as often a hundredth of it as all. One in eight along
    /// an axis, one in eight close to the diagonal, one in eight next to nothing on an axis.
    fn ray(&mut self, reach: f64) -> Ray<f64> {
        let length = reach * 100_f64.powf(-self.fraction());
        let (mut du, mut dv) = (2.0 * self.fraction() - 1.0, 2.0 * self.fraction() - 1.0);
        match self.below(8) {
            0 => dv = 0.0,
            1 => dv = du * (1.0 + 1e-3 * (self.fraction() - 0.5)),
            2 => du *= (-(self.below(80) as f64)).exp2(),
            _ => {}
        }
        if self.below(2) == 0 {
            (du, dv) = (dv, du);
        }
        Ray {
            u: self.coordinate(),
            v: self.coordinate(),
            du: du * length,
            dv: dv * length,
        }
    }
}

fn rays(seed: u64, count: usize, reach: f64) -> Vec<Ray<f64>> {
    let mut random = Random(seed);
    (0..count).map(|_| random.ray(reach)).collect()
}

#[test]
fn random_rays_hit_the_same_on_every_procedural_map() {
    let mut walked = 0;
    for name in ["bricks", "rocks", "spikes", "mountain", "checkerboard"] {
        for (size, count) in [
            (1, 500),
            (2, 1_000),
            (16, 5_000),
            (32, 4_000),
            (256, 12_000),
        ] {
            let recipe = format!("procedural:{name}:{size}:5");
            let source = MapSource::parse(&recipe).expect("a recipe");
            let map = source.load(Channel::Grey, false).expect("a procedural map");
            // The longest walks in small texels take the judge long.
            let reach = (REACH_TEXELS / f64::from(size)).min(64.0);
            walked += compare(
                &map,
                &rays(7 + size as u64, count, reach),
                &source.to_string(),
            );
        }
    }
    assert!(walked >= 100_000, "{walked}");
}

#[test]
fn heights_of_16_bits_and_the_longest_rays() {
    let mut random = Random(3);
    for size in [1_u32, 8, 64] {
        let heights = (0..size * size).map(|_| random.below(1 << 16) as u16);
        let map = HeightMap::new("noise", size, 16, heights.collect()).expect("a square map");
        compare(
            &map,
            &rays(11, 3_000, REACH_TEXELS / f64::from(size)),
            "noise",
        );
    }
    // Nothing but the bottom: walks of thousands of steps.
    let flat = HeightMap::new("flat", 64, 16, vec![0; 64 * 64]).expect("a square map");
    compare(&flat, &rays(13, 400, REACH_TEXELS / 64.0), "flat");
}

#[test]
fn few_rays_and_none() {
    let source = MapSource::parse("procedural:rocks:32:1").expect("a recipe");
    let map = source.load(Channel::Grey, false).expect("a procedural map");
    for count in [0, 1, 2, 31, 32, 33, 63, 64, 65, 127, 128, 129] {
        assert_eq!(compare(&map, &rays(17, count, 2.0), "few"), count);
    }
}

#[test]
fn every_format_of_packets() {
    let source = MapSource::parse("procedural:spikes:64:2").expect("a recipe");
    let map = source.load(Channel::Grey, false).expect("a procedural map");
    let pyramid = Pyramid::new(&map);
    for text in ["q1.8", "q2.12", "q4.16", "q8.20", "q8.24", "q1.28", "q8.28"] {
        let format = RayFormat::told(text.parse().expect("a format"), &pyramid).expect(text);
        compare_in(&pyramid, &format, &rays(19, 3_000, 8.0), text);
    }
    let map = HeightMap::new("flat", 64, 16, vec![0; 64 * 64]).expect("a square map");
    let pyramid = Pyramid::new(&map);
    let finest = RayFormat::told("q1.32".parse().expect("a format"), &pyramid).expect("q1.32");
    compare_in(&pyramid, &finest, &rays(23, 300, 8.0), "q1.32");
    let finer = RayFormat::told("q1.33".parse().expect("a format"), &pyramid).expect("q1.33");
    assert!(FixedPacketWalker::new(Method::Oh, &pyramid, &finer).is_none());
}

/// Rays and heights on a coarse grid: ties at every turn.
fn ties(seed: u64, count: u32) -> (HeightMap, Vec<Ray<f64>>) {
    let mut random = Random(seed);
    let heights = (0..64).map(|_| 255 - 16 * random.below(16) as u16);
    let map = HeightMap::new("ties", 8, 8, heights.collect()).expect("a square map");
    // Slopes of few bits.
    let full = 255.0 / 256.0;
    let ray = |random: &mut Random| Ray {
        u: random.below(32) as f64 / 32.0,
        v: random.below(32) as f64 / 32.0,
        du: (random.below(129) as f64 - 64.0) / 32.0 * full,
        dv: (random.below(129) as f64 - 64.0) / 32.0 * full,
    };
    let rays = (0..count).map(|_| ray(&mut random)).collect();
    (map, rays)
}

#[test]
fn ties_are_broken_alike() {
    for seed in 1..=20 {
        let (map, rays) = ties(seed, 5_000);
        compare(&map, &rays, "ties");
    }
}

#[test]
fn the_papers_frames_are_the_same() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let Some(folder) = real_maps(&root).unwrap_or_else(|missing| panic!("{missing}")) else {
        println!("no real height maps: their frames are left out (set STEPWELL_MAPS)");
        return;
    };
    for surface in SURFACES {
        let map = HeightMap::load(&folder.join(surface.file), Channel::Alpha, false)
            .expect("a height map of the paper");
        for (camera, view) in CAMERAS {
            let view = View::new(&view, &surface.surface, 96, 72);
            let rays = view.rays(map.size()).expect("rays within reach");
            let rays: Vec<Ray<f64>> = rays.into_iter().flatten().collect();
            let name = format!("{}, {camera}", surface.name);
            assert!(compare(&map, &rays, &name) > 1_000, "{name}");
        }
    }
}

proptest! {
    #[test]
    fn any_ray_hits_the_same(
        u in 0.0..1.0f64, v in 0.0..1.0f64, du in -8.0..8.0f64, dv in -8.0..8.0f64,
        seed in 1_u64..1 << 40,
    ) {
        let (map, mut rays) = ties(seed, 40);
        rays.push(Ray { u, v, du, dv });
        compare(&map, &rays, "any");
    }
}
