//! The walk by bounds is the very hit of the quantised ray: texel, depth and side, whatever ties
//! there are. Bounds that do not hold, and a leaf that is not checked, are seen.

use rtl_model::calibration::{CAMERAS, SURFACES, real_maps};
use rtl_model::camera::View;
use rtl_model::exact::exact_hit;
use rtl_model::maps::{Channel, HeightMap, MapSource, Pyramid};
use rtl_model::ray::{REACH_TEXELS, Ray};
use rtl_model::ray_format::{QuantisedRay, RayFormat, RayRange};
use rtl_model::readings::F64Reading;
use rtl_model::units::bounded::{bounded_walk, bounded_walk_in};
use rtl_model::units::bounded_leaf::leaf_check;
use rtl_model::units::bounded_setup::bounded_setup;
use rtl_model::units::bounded_shape::{BoundedShape, MOST_BOUNDED_LINES};
use rtl_model::units::bounded_step::{
    base_line, bounded_address, bounded_step, bounded_walk_after_leaf, bounded_walk_start,
};
use rtl_model::units::fixed_traverse::FixedHit;
use rtl_model::units::traverse::Status;
use rtl_model::units::wide_fixed::wide_fixed_walk;
use rtl_model::units::wide_fixed_step::WideFixedShape;
use std::path::Path;

/// Seeded numbers.
struct Numbers(u64);

impl Numbers {
    /// From 0 to below `count`.
    fn below(&mut self, count: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 8) % count
    }

    /// From 0 to below 1.
    fn fraction(&mut self) -> f64 {
        self.below(1 << 53) as f64 / (1_u64 << 53) as f64
    }
}

/// A map, half of the time low but for a few towers, so that walks get far; many heights are equal.
fn map(numbers: &mut Numbers, level: u32, bits: u32) -> HeightMap {
    let size = 1_u32 << level;
    let full = (1_u64 << bits) - 1;
    let sparse = numbers.below(2) == 0;
    let heights = (0..size * size).map(|_| {
        let fifteenths = numbers.below(16);
        let fifteenths = if sparse && numbers.below(16) > 0 {
            fifteenths / 8
        } else {
            fifteenths
        };
        (fifteenths * (full / 15)) as u16
    });
    let heights = heights.collect();
    HeightMap::new("any", size, bits, heights).expect("a square map")
}

/// A ray of any direction; one in two on a grid of quarter texels, where ties are.
fn ray(numbers: &mut Numbers, size: u32) -> Ray<f64> {
    let size = f64::from(size);
    if numbers.below(2) == 0 {
        // Slopes in quarters of a texel a height step of 8 bits keep their ties when quantised.
        let mut direction = || match numbers.below(8) {
            0 => 0.0,
            1 => 255.0 / (numbers.below(1000) as f64 + 1.0) / size,
            _ => (numbers.below(65) as f64 - 32.0) * 255.0 / (64.0 * size),
        };
        let (du, dv) = (direction(), direction());
        let mut entry = || numbers.below(4 * size as u64) as f64 / (4.0 * size);
        return Ray {
            u: entry(),
            v: entry(),
            du,
            dv,
        };
    }
    let length = (REACH_TEXELS / size).min(60.0) * 100_000_f64.powf(-numbers.fraction());
    Ray {
        u: numbers.fraction(),
        v: numbers.fraction(),
        du: length * (2.0 * numbers.fraction() - 1.0),
        dv: length * (2.0 * numbers.fraction() - 1.0),
    }
}

fn judge(
    map: &HeightMap,
    format: RayFormat,
    ray: &QuantisedRay,
    hit: &FixedHit,
) -> Result<(), String> {
    let truth = exact_hit(map, format.entered(ray)).expect("a quantised ray");
    let full = i128::from(format.shape().full_height());
    let same_depth = i128::from(hit.depth_numerator) * truth.t.denominator
        == truth.t.numerator * i128::from(hit.depth_denominator) * full;
    let right = (hit.i, hit.j, hit.side) == (truth.i, truth.j, truth.side)
        && same_depth
        && hit.status == Status::Hit;
    match right {
        true => Ok(()),
        false => Err(format!("{ray:?}: {hit:?}, in truth {truth:?}")),
    }
}

#[test]
fn every_hit_is_that_of_the_definition() {
    let (mut checked, mut refused) = (0, 0);
    for seed in 1..=84_u64 {
        let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15 ^ (seed << 20));
        let bits = if seed % 3 == 0 { 16 } else { 8 };
        let map = map(&mut numbers, (seed % 8) as u32, bits);
        let pyramid = Pyramid::new(&map);
        for _ in 0..1_000 {
            let ray = ray(&mut numbers, map.size());
            let narrow = RayFormat::for_rays(&RayRange::of(ray), &pyramid);
            for format in [RayFormat::within_reach(&pyramid), narrow] {
                for log2_side in [1, 2] {
                    let usual = BoundedShape::new(format.shape(), log2_side);
                    let most_lines = 1 + numbers.below(4) as usize;
                    for shape in [
                        usual,
                        BoundedShape {
                            most_lines,
                            ..usual
                        },
                    ] {
                        let ray = format.quantise(ray);
                        let lines = pyramid.lines(log2_side);
                        let (hit, refusals) = bounded_walk_in(&mut F64Reading, shape, lines, &ray);
                        judge(&map, format, &ray, &hit)
                            .unwrap_or_else(|fault| panic!("map {seed}, {shape:?}: {fault}"));
                        assert!(hit.steps < shape.step_bound());
                        checked += 1;
                        refused += u64::from(refusals);
                    }
                }
            }
        }
    }
    assert_eq!(checked, 84 * 8_000);
    assert!(refused > 1_000, "the leaf check had nothing to refuse");
}

/// The rays of a camera over a real map, or a procedural one where there are none.
fn subjects() -> Vec<(&'static str, HeightMap, &'static str, Vec<Ray<f64>>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = real_maps(&root).expect("the real maps, in CI");
    let mut subjects = Vec::new();
    for surface in &SURFACES {
        let source: MapSource = match &folder {
            Some(folder) => folder
                .join(surface.file)
                .to_str()
                .expect("a path")
                .parse()
                .expect("a file"),
            None => format!("procedural:spikes:{}:3", surface.size)
                .parse()
                .expect("a procedural map"),
        };
        let channel = match &folder {
            Some(_) => Channel::Alpha,
            None => Channel::Grey,
        };
        let map = source.load(channel, false).expect("a map");
        for (name, camera) in &CAMERAS {
            let view = View::new(camera, &surface.surface, 160, 120);
            let rays = view.rays(map.size()).expect("rays within reach");
            let rays = rays.into_iter().flatten().collect();
            subjects.push((surface.name, map.clone(), *name, rays));
        }
    }
    if folder.is_none() {
        println!("no real maps: a procedural one instead");
    }
    subjects
}

#[test]
fn frames_agree_with_the_exact_walk_of_method_block() {
    let mut checked = 0;
    println!("map camera rays | quad: steps refused | block: steps refused | exact quad block");
    for (name, map, camera, rays) in subjects() {
        let pyramid = Pyramid::new(&map);
        let range = rays.iter().map(|&ray| RayRange::of(ray));
        let range = range.reduce(RayRange::and).expect("rays");
        let format = RayFormat::for_rays(&range, &pyramid);
        let words = format.shape();
        let mut steps = [0_u64; 4];
        let mut refused = [0_u64; 2];
        for &ray in &rays {
            let ray = format.quantise(ray);
            let [_, block] = [1, 2].map(|log2_side| {
                let shape = WideFixedShape { words, log2_side };
                let hit = wide_fixed_walk(shape, pyramid.lines(log2_side), &ray);
                steps[log2_side as usize + 1] += u64::from(hit.steps);
                hit
            });
            for log2_side in [1, 2] {
                let shape = BoundedShape::new(words, log2_side);
                let lines = pyramid.lines(log2_side);
                let (hit, refusals) = bounded_walk_in(&mut F64Reading, shape, lines, &ray);
                let by_counts = FixedHit {
                    steps: block.steps,
                    crossings: block.crossings,
                    ..hit
                };
                assert_eq!(by_counts, block, "{name} {camera} {ray:?}");
                steps[log2_side as usize - 1] += u64::from(hit.steps);
                refused[log2_side as usize - 1] += u64::from(refusals);
                checked += 1;
            }
        }
        let count = rays.len() as f64;
        let mean = |sum: u64| sum as f64 / count;
        println!(
            "{name} {camera} {count} f={} bits={} | {:.3} {:.4} | {:.3} {:.4} | {:.3} {:.3}",
            BoundedShape::new(words, 1).fraction_bits(),
            BoundedShape::new(words, 1).bound_bits(),
            mean(steps[0]),
            mean(refused[0]),
            mean(steps[1]),
            mean(refused[1]),
            mean(steps[2]),
            mean(steps[3])
        );
    }
    assert!(checked > 100_000, "too few rays prove nothing");
}

#[test]
fn the_largest_maps_are_walked_too() {
    for (level, bits) in [(11, 8), (12, 16)] {
        let mut numbers = Numbers(0xd1b5_4a32_d192_ed03 ^ u64::from(level));
        let map = map(&mut numbers, level, bits);
        let pyramid = Pyramid::new(&map);
        let format = RayFormat::within_reach(&pyramid);
        for _ in 0..2_000 {
            let ray = format.quantise(ray(&mut numbers, map.size()));
            for log2_side in [1, 2] {
                let shape = BoundedShape::new(format.shape(), log2_side);
                let hit = bounded_walk(shape, pyramid.lines(log2_side), &ray);
                judge(&map, format, &ray, &hit)
                    .unwrap_or_else(|fault| panic!("{level} {log2_side}: {fault}"));
            }
        }
    }
}

/// What may be wrong with a walk.
#[derive(Clone, Copy, Debug)]
enum Fault {
    Nothing,
    /// Bounds are a whole height step early, instead of late.
    BoundsAreEarly,
    /// The depth between two borders is two units too long.
    BordersAreFar,
    /// Every texel that the walk comes to is taken.
    LeavesAreNotChecked,
    /// A texel refused is not looked behind.
    MasksAreLost,
    /// A ray that meets the edge of a top is taken to hit the side.
    TopsAreSides,
}

/// The texel of a walk with a fault in it, and whether a side is hit; none at the bound.
fn faulty_walk(
    fault: Fault,
    shape: BoundedShape,
    pyramid: &Pyramid,
    ray: &QuantisedRay,
) -> Option<(u32, u32, bool)> {
    let a = &mut F64Reading;
    let lines = pyramid.lines(shape.log2_side);
    let mut setup = bounded_setup(a, shape, [ray.u, ray.v, ray.du, ray.dv]);
    match fault {
        Fault::BoundsAreEarly => {
            let step = (2 << shape.fraction_bits()) - 1;
            setup.t_near_u -= step;
            setup.t_near_v -= step;
        }
        Fault::BordersAreFar => setup.ray.t_delta_u += 2 << (shape.fraction_bits() - 3),
        _ => {}
    }
    let ray = setup.ray;
    let mut walk = bounded_walk_start(a, ray.start_line, setup.i, setup.j);
    let mut t_near = [(0, 0); MOST_BOUNDED_LINES];
    t_near[ray.start_line as usize] = (setup.t_near_u, setup.t_near_v);
    let cells = shape.lines().cells();
    loop {
        let mirrors = (ray.fixed.mirror_u, ray.fixed.mirror_v);
        let address = bounded_address(a, shape, mirrors, &walk) as usize;
        let line = &lines.memory()[address * cells..][..cells];
        let heights: Vec<i64> = line.iter().map(|&height| height.into()).collect();
        let base = t_near[base_line(a, &walk) as usize];
        let result = bounded_step(a, shape, &ray, &walk, base, &heights);
        t_near[walk.line as usize] = result.t_near;
        walk = result.walk;
        if walk.guard {
            return None;
        }
        if !walk.hit {
            continue;
        }
        let mut verdict = leaf_check(
            a,
            shape,
            &ray.fixed,
            (walk.i, walk.j),
            walk.depth,
            result.corner,
        );
        match fault {
            Fault::LeavesAreNotChecked => verdict.refused = false,
            Fault::TopsAreSides => {
                let depth = walk.depth - 1;
                let below =
                    leaf_check(a, shape, &ray.fixed, (walk.i, walk.j), depth, result.corner);
                verdict.at_border_u |= walk.depth > 0 && below.at_border_u;
            }
            _ => {}
        }
        if verdict.refused {
            walk = bounded_walk_after_leaf(a, &walk, true);
            if matches!(fault, Fault::MasksAreLost) {
                walk.kept = [0; MOST_BOUNDED_LINES];
            }
            continue;
        }
        let texel = |mirror, index: i64| {
            let index = if mirror { -1 - index } else { index };
            index.rem_euclid(shape.words.size().into()) as u32
        };
        let side = verdict.at_border_u || verdict.at_border_v || walk.depth == 0;
        return Some((texel(mirrors.0, walk.i), texel(mirrors.1, walk.j), side));
    }
}

#[test]
fn faults_are_seen() {
    for fault in [
        Fault::Nothing,
        Fault::BoundsAreEarly,
        Fault::BordersAreFar,
        Fault::LeavesAreNotChecked,
        Fault::MasksAreLost,
        Fault::TopsAreSides,
    ] {
        for log2_side in [1, 2] {
            let rays = (1..=4_u64).find_map(|seed| {
                let mut numbers = Numbers(0x2545_f491_4f6c_dd1d ^ (seed << 20));
                let map = map(&mut numbers, 4, 8);
                let pyramid = Pyramid::new(&map);
                let format = RayFormat::within_reach(&pyramid);
                let shape = BoundedShape::new(format.shape(), log2_side);
                (0..1_000).find(|_| {
                    let ray = format.quantise(ray(&mut numbers, map.size()));
                    let truth = exact_hit(&map, format.entered(&ray)).expect("a quantised ray");
                    let hit = faulty_walk(fault, shape, &pyramid, &ray);
                    hit != Some((truth.i, truth.j, truth.side))
                })
            });
            let is_sound = matches!(fault, Fault::Nothing);
            assert_eq!(rays.is_none(), is_sound, "{fault:?}, 2^{log2_side} a side");
        }
    }
}
