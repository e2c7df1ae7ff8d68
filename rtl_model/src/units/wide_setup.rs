//! What is done to a ray once before a wide walk.

use super::traverse_setup::{RayRegisters, mirror_ray};
use super::traverse_step::INDEX_BITS;
use super::wide_shape::WideShape;
use super::wide_walk::{WideWalk, start_level, wide_walk_start};
use crate::arith::Arith;
use crate::float::Rounding::TowardZero;
use crate::ray::Ray;

/// A ray set up for a wide walk.
#[derive(Debug)]
pub struct WideSetUpRay<A: Arith> {
    /// What stays, as of every walk.
    pub ray: RayRegisters<A>,
    /// The level of the lines that the walk starts with, and crosses at.
    pub start_level: A::Int,
    /// The walk before its first step.
    pub walk: WideWalk<A>,
}

/// Mirrors a ray with u and v in [0, 1), and chooses where its walk starts. Exact.
pub fn wide_setup<A: Arith>(a: &mut A, shape: WideShape, ray: Ray<A::Num>) -> WideSetUpRay<A> {
    let (ray, _) = mirror_ray(a, ray.u, ray.v, ray.du, ray.dv);
    let reach = a.max(ray.du, ray.dv);
    a.name_num("longer_direction", reach);
    let start_level = start_level(a, shape, |a, texels_log2| {
        let one = a.int_constant(1);
        let exponent = a.int_constant(i64::from(texels_log2) - i64::from(shape.root_level));
        let least = a.number_from_integer(TowardZero, one, exponent);
        a.less_equal(least, reach)
    });
    let texel_i = entry_texel(a, shape, ray.u);
    a.name_int("entry_i", texel_i);
    let texel_j = entry_texel(a, shape, ray.v);
    a.name_int("entry_j", texel_j);
    let walk = wide_walk_start(a, shape, start_level, texel_i, texel_j);
    WideSetUpRay {
        ray,
        start_level,
        walk,
    }
}

/// The texel that a mirrored ray enters: it travels toward larger coordinates, so on a border it is
/// the one above.
fn entry_texel<A: Arith>(a: &mut A, shape: WideShape, coordinate: A::Num) -> A::Int {
    let texels = a.scale(coordinate, shape.root_level as i32);
    a.floor(texels, INDEX_BITS)
}
