//! The e7f16 walk in packets against the same traversal in the machine's own `f32`: nanoseconds a ray on
//! one thread, all in one run, on the seven maps of the paper from its three cameras at 1024 x 768.
//!
//! The rival is scalar code written for `f32` and nothing else (`native/`). It has no bounds to keep
//! and no corner to doubt, so it does less; it is given its rays in `f32` and whatever layout of the
//! pyramid it likes, made beforehand. Written in three ways, of which the quickest counts on each
//! scene. Ours rounds its rays from `f64` within the time that is measured.

mod comparison;
mod native;
mod scenes;

use comparison::{Target, print_missed, print_row, quickest};
use native::{BranchFree, Literal, NativeHit, NativeWalk, RowByRow, ZOrder};
use rtl_model::instruction_set::InstructionSet;
use rtl_model::maps::Pyramid;
use rtl_model::packet::PacketWalker;
use rtl_model::ray::Ray;
use rtl_model::readings::{E7F16, ExactReading, F64Reading, FloatReading, NumberFormat, enter};
use rtl_model::units::search_policy::SearchPolicy;
use rtl_model::units::traverse::{Hit, Status, walk};
use std::hint::black_box;

/// Rounds of each comparison.
const RUNS: usize = 9;
/// Of the scalar readings one ray in so many is walked.
const SAMPLE: usize = 16;
/// Of the exact reading, whose plain rival takes long.
const EXACT_SAMPLE: usize = 256;

const UNWALKED: Hit<f64> = Hit {
    i: 0,
    j: 0,
    t: 0.0,
    u: 0.0,
    v: 0.0,
    steps: 0,
    crossings: 0,
    status: Status::Guard,
};

fn main() {
    println!(
        "e7f16 `oh`, bit-exact, in packets ({}), 1024 x 768, one thread, nanoseconds a ray, quickest of {RUNS}",
        InstructionSet::Detected
    );
    let met = scenes::for_each(scene);
    print_missed(&met);
}

/// The rows of a scene; of the main one the targets are higher and the rows more.
fn scene(name: &str, pyramid: &Pyramid, rays: &[Ray<f64>], is_main: bool) -> Vec<bool> {
    let packets = PacketWalker::new(pyramid);
    let plain = packets.clone().with(InstructionSet::Plain);
    let native_rays: Vec<Ray<f32>> = rays
        .iter()
        .map(|ray| ray.map(|value| value as f32))
        .collect();
    let (z_order, row_by_row, branch_free, literal) = (
        ZOrder::new(pyramid),
        RowByRow::new(pyramid),
        BranchFree::new(pyramid),
        Literal::new(pyramid),
    );
    let mut hits = vec![UNWALKED; rays.len()];
    let mut plain_hits = hits.clone();
    let mut native_hits = [(); 4].map(|()| vec![NativeHit::default(); rays.len()]);
    let [z_hits, row_hits, free_hits, literal_hits] = &mut native_hits;
    // The literal one is slow, and its target is the main scene's.
    let literal_rays = if is_main { &native_rays[..] } else { &[] };
    let [ours, plain_time, z_time, row_time, free_time, literal_time] = quickest(
        RUNS,
        [
            &mut || packets.walk(black_box(rays), &mut hits),
            &mut || plain.walk(black_box(rays), &mut plain_hits),
            &mut || z_order.walk_all(black_box(&native_rays), z_hits),
            &mut || row_by_row.walk_all(black_box(&native_rays), row_hits),
            &mut || branch_free.walk_all(black_box(&native_rays), free_hits),
            &mut || literal.walk_all(black_box(literal_rays), literal_hits),
        ],
    );
    assert!(hits == plain_hits, "{name}: the instruction sets differ");
    for (way, native) in native_hits
        .iter()
        .enumerate()
        .take(if is_main { 4 } else { 3 })
    {
        let near = |ours: f64, native: f32| (ours - f64::from(native)).abs() < 1e-3;
        let same = |(hit, native): (&Hit<f64>, &NativeHit)| {
            (hit.i, hit.j) == (native.i, native.j)
                && near(hit.t, native.t)
                && near(hit.u, native.u)
                && near(hit.v, native.v)
                && native.steps - native.crossings == pyramid.levels() + 1
        };
        let agreeing = hits.iter().zip(native).filter(|&pair| same(pair)).count();
        assert!(
            agreeing * 100 > rays.len() * 97,
            "{name}: rival {way} finds {agreeing} of {} hits",
            rays.len()
        );
    }
    let each = 1e9 / rays.len() as f64;
    let (rival, rival_time) = [
        ("f32, Z order", z_time),
        ("f32, row by row", row_time),
        ("f32, branch-free", free_time),
    ]
    .into_iter()
    .min_by(|a, b| a.1.total_cmp(&b.1))
    .expect("three rivals");
    let target = Target::SpeedAtLeast(if is_main { 1.5 } else { 1.1 });
    let row =
        |rival: &str, time: f64, target| print_row(name, ours * each, rival, time * each, target);
    let mut met = vec![row(rival, rival_time, target)];
    if is_main {
        let literal = "f32, literal: positions, divisions";
        met.push(row(literal, literal_time, Target::SpeedAtLeast(3.0)));
        row("the same, plain instructions", plain_time, Target::Speed);
        let some: Vec<Ray<f64>> = rays.iter().copied().step_by(SAMPLE).collect();
        let [golden, in_f64] = quickest(
            3,
            [
                &mut || golden_walks(FloatReading(E7F16), pyramid, &some),
                &mut || golden_walks(F64Reading, pyramid, &some),
            ],
        );
        // Rows are scaled to all rays.
        let scale = rays.len() as f64 / some.len() as f64;
        row(
            "the definition, e7f16, one by one",
            golden * scale,
            Target::Speed,
        );
        row(
            "the definition, f64, one by one",
            in_f64 * scale,
            Target::Speed,
        );
        let few: Vec<Ray<f64>> = rays.iter().copied().step_by(EXACT_SAMPLE).collect();
        let [filtered, in_rationals] = quickest(
            3,
            [
                &mut || golden_walks(ExactReading::default(), pyramid, &few),
                &mut || golden_walks(ExactReading::plain(), pyramid, &few),
            ],
        );
        let each = 1e9 / few.len() as f64;
        print_row(
            "the definition, exact",
            filtered * each,
            "the same, rationals throughout",
            in_rationals * each,
            Target::Speed,
        );
    }
    met
}

fn golden_walks<R: NumberFormat>(mut reading: R, pyramid: &Pyramid, rays: &[Ray<f64>]) {
    let memory = pyramid.memory();
    let steps: u64 = rays
        .iter()
        .map(|&ray| {
            reading.forget();
            let ray = enter(&mut reading, ray);
            u64::from(walk(&mut reading, SearchPolicy::OH, pyramid, memory, ray).steps)
        })
        .sum();
    black_box(steps);
}
