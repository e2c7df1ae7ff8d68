//! Rays walked, and judged.

use std::ops::Range;

use rayon::prelude::*;
use rtl_model::exact::exact_hit;
use rtl_model::ray_format::QuantisedRay;
use rtl_model::scene::{Family, Method};
use rtl_model::units::bounded::bounded_walk;
use rtl_model::units::bounded_shape::BoundedShape;
use rtl_model::units::fixed_traverse::{FixedHit, fixed_walk};
use rtl_model::units::traverse::Status;
use rtl_model::units::wide_fixed::wide_fixed_walk;
use rtl_model::units::wide_fixed_step::WideFixedShape;
use rtl_model::units::window::window_fixed_walk;
use rtl_model::units::window_fixed_step::WindowFixedShape;

use super::{RaySource, TexelHit, WalkScene, texel_walk};
use crate::sweep::{Difference, Outcome, sweep};

/// Walks `count` rays by `oh` and, in turn, by one of `methods`, and judges either; a case is a
/// ray. `alter` may change a hit, so that a test can see that the comparison tells. Progress is
/// told in rays.
///
/// # Panics
/// If one of the methods samples: it promises no exact hit.
pub fn compare(
    scene: &WalkScene,
    rays: &RaySource,
    methods: &[Method],
    count: u64,
    progress: &(dyn Fn(u64) + Sync),
    alter: impl Fn(FixedHit, u64) -> FixedHit + Sync,
) -> Outcome {
    let check = |numbers: Range<u64>, tell: &mut dyn FnMut(Difference)| {
        for number in numbers {
            let (ray, _) = rays.ray(number);
            let truth = texel_walk(&scene.map, rays.format(), &ray);
            let mut by = |method: Method, place: usize| {
                let hit = alter(walk(scene, rays, method, &ray), number);
                if !agree(&hit, &truth) {
                    tell(difference(number, &ray, place, &hit, &truth));
                    return false;
                }
                true
            };
            if by(Method::Oh, usize::MAX) && !methods.is_empty() {
                let place = (number / 4 % methods.len() as u64) as usize;
                by(methods[place], place);
            }
        }
    };
    sweep(count, check, progress)
}

fn walk(scene: &WalkScene, rays: &RaySource, method: Method, ray: &QuantisedRay) -> FixedHit {
    let words = rays.format().shape();
    match method.family() {
        Family::Nodes(policy) => fixed_walk(words, policy, scene.pyramid.memory(), ray),
        Family::Wide { log2_side } => {
            let shape = WideFixedShape { words, log2_side };
            wide_fixed_walk(shape, scene.pyramid.lines(log2_side), ray)
        }
        Family::Window => window_fixed_walk(WindowFixedShape { words }, &scene.pyramid, ray),
        Family::Bounded { log2_side } => {
            let shape = BoundedShape::new(words, log2_side);
            bounded_walk(shape, scene.pyramid.lines(log2_side), ray)
        }
        Family::Linear(_) => panic!("{method} samples"),
    }
}

/// The same texel, side or top, and the same depth, as ratios?
fn agree(hit: &FixedHit, truth: &TexelHit) -> bool {
    let product = |a: i64, b: i64| i128::from(a) * i128::from(b);
    hit.status == Status::Hit
        && (hit.i, hit.j, hit.side) == (truth.i, truth.j, truth.side)
        && product(hit.depth_numerator, truth.depth_denominator)
            == product(truth.depth_numerator, hit.depth_denominator)
}

/// What differs. The operands are the ray, and the place of the method among those walked in turn.
fn difference(
    index: u64,
    ray: &QuantisedRay,
    place: usize,
    hit: &FixedHit,
    truth: &TexelHit,
) -> Difference {
    let words = |i, j, side, numerator: i64, denominator: i64| {
        vec![
            u64::from(i),
            u64::from(j),
            u64::from(side),
            numerator as u64,
            denominator as u64,
        ]
    };
    let mut operands: Vec<u64> = [ray.u, ray.v, ray.du, ray.dv].map(|n| n as u64).to_vec();
    operands.push(place as u64);
    Difference {
        index,
        operands,
        golden: words(
            hit.i,
            hit.j,
            hit.side,
            hit.depth_numerator,
            hit.depth_denominator,
        ),
        other: words(
            truth.i,
            truth.j,
            truth.side,
            truth.depth_numerator,
            truth.depth_denominator,
        ),
    }
}

/// How often quantising a ray changes its texel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Departure {
    /// Rays looked at, all of the cameras.
    pub rays: u64,
    /// Those whose texel is another one than that of the ray they were quantised from.
    pub texels: u64,
}

impl Departure {
    /// Their share, 0 to 1.
    pub fn share(&self) -> f64 {
        self.texels as f64 / self.rays.max(1) as f64
    }
}

/// Looks at `count` rays of the cameras. The ray that was quantised is judged by the exact reference.
pub fn departures(
    scene: &WalkScene,
    rays: &RaySource,
    count: u64,
    progress: &(dyn Fn(u64) + Sync),
) -> Departure {
    let look = |n: u64| {
        // The first of every four rays is a camera's.
        let (quantised, ray) = rays.ray(4 * n);
        progress(1);
        let Some(Ok(truth)) = ray.map(|ray| exact_hit(&scene.map, ray)) else {
            return Departure::default();
        };
        let hit = texel_walk(&scene.map, rays.format(), &quantised);
        Departure {
            rays: 1,
            texels: u64::from((hit.i, hit.j) != (truth.i, truth.j)),
        }
    };
    let both = |a: Departure, b: Departure| Departure {
        rays: a.rays + b.rays,
        texels: a.texels + b.texels,
    };
    (0..count)
        .into_par_iter()
        .map(look)
        .reduce(Departure::default, both)
}
