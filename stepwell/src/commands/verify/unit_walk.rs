//! The walk of a unit where no scene gives any, and its rays.

use hdl_gen::verify::random_rays;
use rtl_model::float::FloatFormat;
use rtl_model::maps::Pyramid;
use rtl_model::ray::Ray;
use rtl_model::scene::{Crossing, Method, Walk, WalkFormat};
use rtl_model::walker::Walker;

use crate::options::{NumberFormat, Replacements};

/// Method `oh` in e7f16, but for what the command line says.
pub fn unit_walk(replacements: &Replacements) -> anyhow::Result<Walk> {
    let method = replacements.method.unwrap_or(Method::Oh);
    chosen_walk(method, replacements.format, replacements.crossing)
}

/// A method in e7f16, from node to node by index, but for what the command line says.
pub fn chosen_walk(
    method: Method,
    format: Option<NumberFormat>,
    crossing: Option<Crossing>,
) -> anyhow::Result<Walk> {
    Ok(Walk {
        method,
        format: match format {
            None => WalkFormat::Float(FloatFormat::E7F16),
            Some(format) => format.of_walk()?,
        },
        crossing: crossing.unwrap_or(Crossing::Index),
    })
}

/// Random rays that the walk admits.
pub fn unit_rays(
    walk: Walk,
    pyramid: &Pyramid,
    count: u64,
    seed: u64,
) -> anyhow::Result<Vec<Ray<f64>>> {
    let walker = Walker::new(walk, pyramid)?;
    let rays = random_rays(count, seed).into_iter();
    rays.map(|ray| Ok(walker.admit(ray)?)).collect()
}
