//! The golden e7f16 walk against the same traversal in the machine's own `f32`: rays per second on
//! one thread, both in one run.
//!
//! The rival is scalar code written for `f32` and nothing else: mirrored axes, the node index
//! carried, a reciprocal a ray instead of divisions in the loop, native floats, one `u16` pyramid.
//! It has no bounds to keep and no corner to doubt, so it does less than the golden walk.

use rtl_model::calibration::{CAMERAS, SURFACES, real_maps};
use rtl_model::camera::View;
use rtl_model::maps::{Channel, HeightMap, MapSource, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::readings::{E7F16, F64Reading, FloatReading, NumberFormat, enter};
use rtl_model::units::traverse::walk;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

/// Runs of each; the median is quoted.
const RUNS: usize = 5;

fn main() {
    let (name, map) = the_map();
    let pyramid = Pyramid::new(&map);
    println!("{name}, 512 x 384, one thread, thousand rays/s");
    println!("camera      e7f16 golden   f64 reading    native f32   e7f16 / f32");
    for (camera, view) in CAMERAS {
        let view = View::new(&view, &SURFACES[0].surface, 512, 384);
        let rays = view
            .rays(map.size())
            .expect("rays within reach")
            .into_iter()
            .flatten();
        let rays: Vec<Ray<f64>> = rays.collect();
        let golden = rate(&rays, || golden_steps(FloatReading(E7F16), &pyramid, &rays));
        let f64s = rate(&rays, || golden_steps(F64Reading, &pyramid, &rays));
        let native: Vec<_> = rays
            .iter()
            .map(|ray| ray.map(|value| value as f32))
            .collect();
        let f32s = rate(&rays, || {
            native.iter().map(|&ray| native_walk(&pyramid, ray)).sum()
        });
        println!(
            "{camera:8} {:14.0} {:13.0} {:13.0} {:13.3}",
            golden / 1e3,
            f64s / 1e3,
            f32s / 1e3,
            golden / f32s
        );
    }
}

fn the_map() -> (String, HeightMap) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    if let Ok(Some(folder)) = real_maps(&root) {
        let map = HeightMap::load(&folder.join(SURFACES[0].file), Channel::Alpha, false);
        return (
            "the real rocks map".to_owned(),
            map.expect("a height map of the paper"),
        );
    }
    println!("no real height maps: a procedural one stands in (set STEPWELL_MAPS)");
    let source = MapSource::parse("procedural:rocks:256:1").expect("a procedural map");
    let map = source.load(Channel::Grey, false).expect("a procedural map");
    (source.to_string(), map)
}

/// Rays per second: the median of several runs.
fn rate(rays: &[Ray<f64>], mut steps: impl FnMut() -> u64) -> f64 {
    let mut rates: Vec<f64> = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            assert!(black_box(steps()) > rays.len() as u64);
            rays.len() as f64 / start.elapsed().as_secs_f64()
        })
        .collect();
    rates.sort_by(f64::total_cmp);
    rates[RUNS / 2]
}

fn golden_steps<R: NumberFormat>(mut reading: R, pyramid: &Pyramid, rays: &[Ray<f64>]) -> u64 {
    let memory = pyramid.memory();
    rays.iter()
        .map(|&ray| {
            let ray = enter(&mut reading, ray);
            u64::from(walk(&mut reading, pyramid, memory, ray).steps)
        })
        .sum()
}

/// Method `oh` in native floats; returns its steps.
fn native_walk(pyramid: &Pyramid, ray: Ray<f32>) -> u64 {
    let (flip_u, flip_v) = (ray.du < 0.0, ray.dv < 0.0);
    let (u, v) = (
        if flip_u { -ray.u } else { ray.u },
        if flip_v { -ray.v } else { ray.v },
    );
    let (du, dv) = (ray.du.abs(), ray.dv.abs());
    let (per_u, per_v) = (1.0 / du, 1.0 / dv);
    let full = ((1_u32 << pyramid.bits()) - 1) as f32;
    let memory = pyramid.memory();
    let root = pyramid.levels();
    let (mut below_root, mut t, mut steps) = (0_u32, 0.0_f32, 0_u64);
    let (mut i, mut j) = (u.floor() as i32, v.floor() as i32);
    let mut size = 1.0_f32;
    loop {
        steps += 1;
        let mask = (1_i32 << below_root) - 1;
        let column = (if flip_u { !i } else { i }) & mask;
        let row = (if flip_v { !j } else { j }) & mask;
        let address = (1 << (2 * below_root)) | (row << below_root) | column;
        let depth = 1.0 - f32::from(memory[address as usize]) / full;
        let exit_u = ((i + 1) as f32 * size - u) * per_u;
        let exit_v = ((j + 1) as f32 * size - v) * per_v;
        let exit = exit_u.min(exit_v);
        if depth <= t || depth <= exit {
            t = t.max(depth);
            if below_root == root {
                return steps + u64::from(t > 2.0);
            }
            let half = 0.5 * size;
            let far_u = u + t * du >= (2 * i + 1) as f32 * half;
            let far_v = v + t * dv >= (2 * j + 1) as f32 * half;
            (i, j) = (2 * i + i32::from(far_u), 2 * j + i32::from(far_v));
            (below_root, size) = (below_root + 1, half);
        } else {
            t = exit;
            if exit_u <= exit_v { i += 1 } else { j += 1 }
        }
    }
}
