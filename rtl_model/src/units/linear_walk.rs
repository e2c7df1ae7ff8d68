//! Whole searches of the sampling methods in software.

use super::linear_ray::{LinearRay, LinearShape, texel_address};
use super::pom_step::{pom_start, pom_step};
use super::relief_step::{ReliefWalk, relief_start, relief_step};
use super::traverse::{Hit, Status};
use crate::arith::Concrete;
use crate::maps::Pyramid;

/// The shape of a sampling unit for a map.
pub fn linear_shape_for(pyramid: &Pyramid) -> LinearShape {
    LinearShape {
        root_level: pyramid.levels(),
        height_bits: pyramid.bits(),
    }
}

/// Relief mapping of a ray: its linear samples, then binary ones.
pub fn relief_walk<R: Concrete>(
    reading: &mut R,
    pyramid: &Pyramid,
    ray: &LinearRay<R>,
) -> Hit<R::Num> {
    let shape = linear_shape_for(pyramid);
    let mut walk = relief_start(reading, shape, ray);
    loop {
        let height = height(reading, pyramid, &walk);
        let result = relief_step(reading, shape, ray, &walk, height);
        walk = result.walk;
        if walk.hit || walk.guard {
            return Hit {
                i: walk.texel_i as u32,
                j: walk.texel_j as u32,
                t: walk.t,
                u: result.position_u,
                v: result.position_v,
                steps: walk.steps as u32,
                crossings: 0,
                status: status(walk.hit),
            };
        }
    }
}

/// The number of the first linear sample of a ray that lies below the surface: relief mapping
/// without its binary steps. It takes as many steps as it passes samples.
pub fn first_sample_below<R: Concrete>(
    reading: &mut R,
    pyramid: &Pyramid,
    ray: &LinearRay<R>,
) -> u32 {
    let shape = linear_shape_for(pyramid);
    let mut walk = relief_start(reading, shape, ray);
    while !(walk.refining || walk.guard) {
        let height = height(reading, pyramid, &walk);
        walk = relief_step(reading, shape, ray, &walk, height).walk;
    }
    walk.sample as u32
}

/// Parallax occlusion mapping of a ray.
pub fn pom_walk<R: Concrete>(
    reading: &mut R,
    pyramid: &Pyramid,
    ray: &LinearRay<R>,
) -> Hit<R::Num> {
    let shape = linear_shape_for(pyramid);
    let mut walk = pom_start(reading, shape, ray);
    loop {
        let address = texel_address(reading, shape, walk.texel_i, walk.texel_j);
        let height = i64::from(pyramid.memory()[address as usize]);
        let result = pom_step(reading, shape, ray, &walk, height);
        walk = result.walk;
        if walk.hit || walk.guard {
            return Hit {
                i: walk.texel_i as u32,
                j: walk.texel_j as u32,
                t: walk.t,
                u: result.position_u,
                v: result.position_v,
                steps: walk.steps as u32,
                crossings: 0,
                status: status(walk.hit),
            };
        }
    }
}

fn height<R: Concrete>(reading: &mut R, pyramid: &Pyramid, walk: &ReliefWalk<R>) -> i64 {
    let shape = linear_shape_for(pyramid);
    let address = texel_address(reading, shape, walk.texel_i, walk.texel_j);
    i64::from(pyramid.memory()[address as usize])
}

fn status(hit: bool) -> Status {
    if hit { Status::Hit } else { Status::Guard }
}
