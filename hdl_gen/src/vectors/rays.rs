//! Vectors of the whole traverse unit: rays, the hits they end in, the memory of heights.

use rtl_model::float::FloatFormat;
use rtl_model::maps::Pyramid;
use rtl_model::ray::Ray;
use rtl_model::readings::{FloatReading, NumberFormat};
use rtl_model::scene::{Scene, Walk, WalkFormat};
use rtl_model::units::search_policy::SearchPolicy;
use rtl_model::units::traverse::{Hit, Status, shape_for, walk};
use rtl_model::units::traverse_step::COUNTER_BITS;
use rtl_model::walker::Walker;

use super::error::VectorError;
use super::field::{Field, FieldFormat, Role};
use super::set::VectorSet;

/// Rays in, hits out, and what the unit reads on the way.
#[derive(Clone, Debug)]
pub struct RayVectors {
    /// `u`, `v`, `du`, `dv`; a ray's id is its line, from 0.
    pub rays: VectorSet,
    /// `i`, `j`, `t`, `u`, `v`, `steps`, `crossings`, `guard`: line k is the answer to ray k, in
    /// whatever order the unit gives them.
    pub hits: VectorSet,
    /// The pyramid's memory, a height a line.
    pub heights: VectorSet,
}

/// The rays of a scene's frame as bits of the format, row by row; pixels without a ray are left
/// out.
///
/// # Errors
/// If the frame has no ray, or one that no unit can walk or the format cannot hold.
pub fn scene_rays(
    scene: &Scene,
    format: FloatFormat,
    pyramid: &Pyramid,
) -> Result<Vec<Ray<u64>>, VectorError> {
    let walker = Walker::new(
        Walk {
            format: WalkFormat::Float(format),
            ..scene.walk
        },
        pyramid,
    )?;
    let mut reading = FloatReading(format);
    let mut rays = Vec::new();
    let pixels = scene.view().rays(pyramid.size())?;
    for (x, y, ray) in (0..).zip(pixels).filter_map(|(pixel, ray): (u32, _)| {
        let (x, y) = (pixel % scene.frame.width, pixel / scene.frame.width);
        ray.map(|ray| (x, y, ray))
    }) {
        let ray = walker
            .admit(ray)
            .map_err(|problem| VectorError::Admission { x, y, problem })?;
        rays.push(Ray {
            u: reading.coordinate(ray.u),
            v: reading.coordinate(ray.v),
            du: reading.direction(ray.du),
            dv: reading.direction(ray.dv),
        });
    }
    if rays.is_empty() {
        let scene = scene.name.clone();
        return Err(VectorError::NoRays { scene });
    }
    Ok(rays)
}

/// The vectors of a traverse unit: each ray (bits of the format) walked by the golden model.
pub fn ray_vectors(format: FloatFormat, pyramid: &Pyramid, rays: &[Ray<u64>]) -> RayVectors {
    let shape = shape_for(pyramid);
    let float = |name, role, meaning| {
        let width = format.width();
        Field::new(name, role, width, FieldFormat::Float(format), meaning)
    };
    let unsigned =
        |name, role, width, meaning| Field::new(name, role, width, FieldFormat::Unsigned, meaning);
    let texel_bits = shape.root_level.max(1);
    // The counters are never negative, so their sign is not given out.
    let count_bits = COUNTER_BITS - 1;
    let mut vectors = RayVectors {
        rays: VectorSet::new(vec![
            float("u", Role::Input, "entry along the rows, 0 to 1"),
            float("v", Role::Input, "entry along the columns, 0 to 1"),
            float("du", Role::Input, "offset of u for one unit of depth"),
            float("dv", Role::Input, "offset of v for one unit of depth"),
        ]),
        hits: VectorSet::new(vec![
            unsigned("i", Role::Output, texel_bits, "texel on u"),
            unsigned("j", Role::Output, texel_bits, "texel on v"),
            float("t", Role::Output, "depth, 0 top to 1 bottom"),
            float("u", Role::Output, "position on u, not wrapped"),
            float("v", Role::Output, "position on v, not wrapped"),
            unsigned("steps", Role::Output, count_bits, "steps taken"),
            unsigned(
                "crossings",
                Role::Output,
                count_bits,
                "node crossings among them",
            ),
            Field::new(
                "guard",
                Role::Output,
                1,
                FieldFormat::Bit,
                "the walk ended at the step bound: a defect",
            ),
        ]),
        heights: VectorSet::new(vec![unsigned(
            "height",
            Role::Memory,
            shape.height_bits,
            "the highest height of the node at this address",
        )]),
    };
    let mut reading = FloatReading(format);
    for &ray in rays {
        let hit: Hit<u64> = walk(
            &mut reading,
            SearchPolicy::OH,
            pyramid,
            pyramid.memory(),
            ray,
        );
        vectors.rays.push(vec![ray.u, ray.v, ray.du, ray.dv]);
        vectors.hits.push(vec![
            hit.i.into(),
            hit.j.into(),
            hit.t,
            hit.u,
            hit.v,
            hit.steps.into(),
            hit.crossings.into(),
            (hit.status == Status::Guard).into(),
        ]);
    }
    for &height in pyramid.memory() {
        vectors.heights.push(vec![height.into()]);
    }
    vectors
}
