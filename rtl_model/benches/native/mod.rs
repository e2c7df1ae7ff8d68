//! Method `oh` in scalar native `f32`: the rivals, each as quick as it could be made.
//!
//! Three carry the node and the distances to its far borders from step to step, use one reciprocal a
//! ray and axis instead of divisions, and read depths that are `f32` already. They differ in what pays on
//! one scene and not on another: the order of the nodes in memory, and branches or none. The fourth
//! is the method as it is written down.

// Each of the programs that share this file uses a part of it.
#![allow(dead_code, unused_imports)]

mod literal;
mod row_by_row;
mod z_order;

pub use literal::Literal;
pub use row_by_row::RowByRow;
pub use z_order::{BranchFree, ZOrder};

use rtl_model::maps::Pyramid;
use rtl_model::ray::Ray;

/// What a walk in `f32` answers.
#[derive(Clone, Copy, Default)]
pub struct NativeHit {
    pub i: u32,
    pub j: u32,
    pub t: f32,
    pub u: f32,
    pub v: f32,
    pub steps: u32,
    pub crossings: u32,
}

/// A way to walk one ray.
pub trait NativeWalk {
    fn walk(&self, ray: Ray<f32>) -> NativeHit;

    fn walk_all(&self, rays: &[Ray<f32>], hits: &mut [NativeHit]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.walk(*ray);
        }
    }
}

/// A height as a depth.
fn depth(height: u16, bits: u32) -> f32 {
    1.0 - f32::from(height) / ((1_u32 << bits) - 1) as f32
}

/// A ray mirrored to travel toward larger u and v.
struct Mirrored {
    mirror_u: bool,
    mirror_v: bool,
    du: f32,
    dv: f32,
    per_u: f32,
    per_v: f32,
    /// Distances to the root's far borders.
    border_u: f32,
    border_v: f32,
}

#[inline(always)]
fn mirror(ray: Ray<f32>) -> Mirrored {
    let (mirror_u, mirror_v) = (ray.du < 0.0, ray.dv < 0.0);
    let (du, dv) = (ray.du.abs(), ray.dv.abs());
    Mirrored {
        mirror_u,
        mirror_v,
        du,
        dv,
        per_u: 1.0 / du,
        per_v: 1.0 / dv,
        border_u: if mirror_u { ray.u } else { 1.0 - ray.u },
        border_v: if mirror_v { ray.v } else { 1.0 - ray.v },
    }
}

/// The answer, found at level 0 in this texel.
#[inline(always)]
fn hit(ray: Ray<f32>, (i, j): (u32, u32), t: f32, steps: u32, pyramid_levels: u32) -> NativeHit {
    NativeHit {
        i,
        j,
        t,
        u: ray.u + t * ray.du,
        v: ray.v + t * ray.dv,
        steps,
        crossings: steps - pyramid_levels - 1,
    }
}

/// The depths of all nodes, in the order of the pyramid's memory.
fn depths(pyramid: &Pyramid) -> Vec<f32> {
    let heights = pyramid.memory().iter();
    heights
        .map(|&height| depth(height, pyramid.bits()))
        .collect()
}
