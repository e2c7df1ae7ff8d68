//! The exact fixed-point walks in packets, `oh` against the same in the machine's own scalar `f32`, and
//! `block` against `oh`: nanoseconds a ray
//! on one thread, all in one run, on the seven maps of the paper from its three cameras at 1024 x 768.
//!
//! The rival is scalar code written for `f32` and nothing else (`native/`), written in three ways, of
//! which the quickest counts on each scene; it is given its rays in `f32` and whatever layout of the pyramid
//! it likes, made beforehand. Ours quantises its rays, and divides and rounds its answers, within the
//! time that is measured.

mod comparison;
mod native;
mod scenes;

use comparison::{Target, print_missed, print_row, quickest};
use native::{BranchFree, NativeHit, NativeWalk, RowByRow, ZOrder};
use rtl_model::fixed_packet::FixedPacketWalker;
use rtl_model::instruction_set::InstructionSet;
use rtl_model::maps::Pyramid;
use rtl_model::ray::Ray;
use rtl_model::ray_format::RayFormat;
use rtl_model::scene::Method;
use rtl_model::units::fixed_traverse::fixed_walk;
use rtl_model::units::search_policy::SearchPolicy;
use rtl_model::units::traverse::{Hit, Status};
use std::hint::black_box;

/// Rounds of each comparison.
const RUNS: usize = 9;
/// Of the definition one ray in so many is walked.
const SAMPLE: usize = 16;

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
        "exact fixed point in packets ({}), 1024 x 768, one thread, nanoseconds a ray, quickest of {RUNS}",
        InstructionSet::Detected
    );
    let met = scenes::for_each(scene);
    print_missed(&met);
}

/// The rows of a scene; of the main one the target is that of the issue, and the rows are more.
fn scene(name: &str, pyramid: &Pyramid, rays: &[Ray<f64>], is_main: bool) -> Vec<bool> {
    let format = RayFormat::within_reach(pyramid);
    let packets =
        FixedPacketWalker::new(Method::Oh, pyramid, &format).expect("a format for packets");
    let plain = packets.clone().with(InstructionSet::Plain);
    let blocks = FixedPacketWalker::new(Method::Block, pyramid, &format).expect("for packets");
    let native_rays: Vec<Ray<f32>> = rays
        .iter()
        .map(|ray| ray.map(|value| value as f32))
        .collect();
    let (z_order, row_by_row, branch_free) = (
        ZOrder::new(pyramid),
        RowByRow::new(pyramid),
        BranchFree::new(pyramid),
    );
    let mut hits = vec![UNWALKED; rays.len()];
    let mut plain_hits = hits.clone();
    let mut block_hits = hits.clone();
    let mut native_hits = [(); 3].map(|()| vec![NativeHit::default(); rays.len()]);
    let [z_hits, row_hits, free_hits] = &mut native_hits;
    let [ours, plain_time, block_time, z_time, row_time, free_time] = quickest(
        RUNS,
        [
            &mut || packets.walk(black_box(rays), &mut hits),
            &mut || plain.walk(black_box(rays), &mut plain_hits),
            &mut || blocks.walk(black_box(rays), &mut block_hits),
            &mut || z_order.walk_all(black_box(&native_rays), z_hits),
            &mut || row_by_row.walk_all(black_box(&native_rays), row_hits),
            &mut || branch_free.walk_all(black_box(&native_rays), free_hits),
        ],
    );
    assert!(hits == plain_hits, "{name}: the instruction sets differ");
    for (hit, block_hit) in hits.iter().zip(&block_hits) {
        let numbers = |hit: &Hit<f64>| (hit.i, hit.j, hit.t, hit.u, hit.v);
        assert!(
            numbers(hit) == numbers(block_hit),
            "{name}: {hit:?}, {block_hit:?}"
        );
    }
    for (way, native) in native_hits.iter().enumerate() {
        let agreeing = hits
            .iter()
            .zip(native)
            .filter(|(hit, native)| (hit.i, hit.j) == (native.i, native.j))
            .count();
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
    let row = |what: &str, ours: f64, rival: &str, time: f64, target| {
        print_row(
            format!("{name}: {what}"),
            ours * each,
            rival,
            time * each,
            target,
        )
    };
    let target = if is_main {
        Target::SpeedAtLeast(1.8)
    } else {
        Target::Speed
    };
    let met = vec![
        row("oh", ours, rival, rival_time, target),
        row(
            "block",
            block_time,
            "oh, ours",
            ours,
            Target::SpeedAtLeast(0.9),
        ),
    ];
    if is_main {
        row(
            "oh",
            ours,
            "the same, plain instructions",
            plain_time,
            Target::Speed,
        );
        let some: Vec<Ray<f64>> = rays.iter().copied().step_by(SAMPLE).collect();
        let [definition] = quickest(3, [&mut || definition_walks(&format, pyramid, &some)]);
        // Scaled to all rays.
        let scale = rays.len() as f64 / some.len() as f64;
        row(
            "oh",
            ours,
            "the definition, one by one",
            definition * scale,
            Target::Speed,
        );
    }
    met
}

fn definition_walks(format: &RayFormat, pyramid: &Pyramid, rays: &[Ray<f64>]) {
    let shape = format.shape();
    let steps: u64 = rays
        .iter()
        .map(|&ray| {
            let ray = format.quantise(ray);
            let hit = fixed_walk(shape, SearchPolicy::OH, pyramid.memory(), &ray);
            u64::from(hit.to_hit(shape, &ray).steps)
        })
        .sum();
    black_box(steps);
}
