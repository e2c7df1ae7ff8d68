//! Vectors of the whole traverse unit: rays, the hits they end in, the memory of heights.

use std::collections::HashMap;

use rtl_model::float::FloatFormat;
use rtl_model::maps::Pyramid;
use rtl_model::ray::Ray;
use rtl_model::readings::FloatReading;
use rtl_model::scene::Scene;
use rtl_model::units::any_step::AnyStep;
use rtl_model::units::step::{Signal, Step};
use rtl_model::walker::Walker;

use super::error::VectorError;
use super::field::{Field, FieldFormat, Role};
use super::set::VectorSet;
use crate::netlist::Meaning;
use crate::units::TraverseUnit;

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

/// The rays of a scene's frame, admitted, row by row; pixels without a ray are left out.
///
/// # Errors
/// If the frame has no ray, or one that no unit can walk or the format cannot hold.
pub fn scene_rays(scene: &Scene, pyramid: &Pyramid) -> Result<Vec<Ray<f64>>, VectorError> {
    let walker = Walker::new(scene.walk, pyramid)?;
    let mut rays = Vec::new();
    let pixels = scene.view().rays(pyramid.size())?;
    for (x, y, ray) in (0..).zip(pixels).filter_map(|(pixel, ray): (u32, _)| {
        let (x, y) = (pixel % scene.frame.width, pixel / scene.frame.width);
        ray.map(|ray| (x, y, ray))
    }) {
        let ray = walker
            .admit(ray)
            .map_err(|problem| VectorError::Admission { x, y, problem })?;
        rays.push(ray);
    }
    if rays.is_empty() {
        let scene = scene.name.clone();
        return Err(VectorError::NoRays { scene });
    }
    Ok(rays)
}

/// The vectors of a traverse unit: each ray walked by the golden model, from the bits that its
/// ports carry.
pub fn ray_vectors(unit: &TraverseUnit, pyramid: &Pyramid, rays: &[Ray<u64>]) -> RayVectors {
    let configuration = &unit.configuration;
    let design = &unit.design;
    let field = |port: &str, name: &str, role, meaning: &str| {
        let wire = design.input(port).or(design.output(port));
        let wire = wire.unwrap_or_else(|| panic!("{port}: a port of the unit"));
        let node = design.node(wire);
        let probe = unit.probes.iter().find(|probe| probe.name == port);
        // The counters and texels of the ports have no sign.
        let format = match probe.map_or(node.meaning, |probe| probe.meaning) {
            Meaning::Float(format) => FieldFormat::Float(format),
            Meaning::Signed if role == Role::Input => FieldFormat::Signed,
            _ if node.width == 1 && name == "guard" => FieldFormat::Bit,
            _ => FieldFormat::Unsigned,
        };
        Field::new(name, role, node.width, format, meaning)
    };
    let ray_fields = configuration.step.ray_ports();
    let ray_fields = ray_fields.iter().map(|&(name, _)| {
        let meaning = match name {
            "u" => "entry along the rows, 0 to 1",
            "v" => "entry along the columns, 0 to 1",
            "du" => "offset of u for one unit of depth",
            "dv" => "offset of v for one unit of depth",
            _ => "of this name in the step's source",
        };
        field(&format!("ray_{name}_i"), name, Role::Input, meaning)
    });
    let hit_fields = [
        ("i", "texel on u"),
        ("j", "texel on v"),
        ("t", "depth, 0 top to 1 bottom"),
        ("u", "position on u, not wrapped"),
        ("v", "position on v, not wrapped"),
        ("steps", "steps taken"),
        ("crossings", "node crossings among them"),
        ("guard", "the walk ended at the step bound: a defect"),
    ];
    let hit_fields = hit_fields
        .map(|(name, meaning)| field(&format!("hit_{name}_o"), name, Role::Output, meaning));
    let height = Field::new(
        "height",
        Role::Memory,
        configuration.shape.height_bits,
        FieldFormat::Unsigned,
        "the highest height of the node at this address",
    );
    let mut vectors = RayVectors {
        rays: VectorSet::new(ray_fields.collect()),
        hits: VectorSet::new(hit_fields.to_vec()),
        heights: VectorSet::new(vec![height]),
    };
    let memory = configuration.step.memory(pyramid);
    let mut reading = FloatReading(configuration.format);
    for &ray in rays {
        let ports = [ray.u, ray.v, ray.du, ray.dv];
        vectors.rays.push(ports.to_vec());
        let hit = walk(&mut reading, &configuration.step, &memory, &ports);
        let hits = &vectors.hits.fields;
        let words = hits
            .iter()
            .map(|field| hit[field.name.as_str()] & field.mask());
        let words = words.collect();
        vectors.hits.push(words);
    }
    for &height in memory.iter() {
        vectors.heights.push(vec![height.into()]);
    }
    vectors
}

/// Walks a ray to its hit; the words of the hit ports, by their names.
fn walk(
    reading: &mut FloatReading<FloatFormat>,
    step: &AnyStep,
    memory: &[u16],
    ports: &[u64],
) -> HashMap<&'static str, u64> {
    let kinds = step.ray_ports().into_iter().zip(ports);
    let ray: Vec<_> = kinds
        .map(|((_, kind), &word)| Signal::of_word(reading, kind, word))
        .collect();
    let mut row = step.set_up(reading, &ray);
    let unchanged = step.ray_registers().len();
    let registers = step.walk_registers();
    let bit = |row: &[Signal<_>], wanted: &str| {
        let mut names = registers.iter().map(|&(name, _)| name);
        let place = names.position(|name| name == wanted);
        place.is_some_and(|place| row[unchanged + place].bit())
    };
    loop {
        let address = step.address(reading, &row);
        let height = i64::from(memory[address as usize]);
        let (walk, named) = step.step(reading, &row, &[height]);
        row.truncate(unchanged);
        row.extend(walk);
        if !bit(&row, "hit") && !bit(&row, "guard") {
            continue;
        }
        let registers = registers.iter().zip(&row[unchanged..]);
        let registers = registers.map(|(&(name, _), signal)| (name, signal.word(reading)));
        let answers = named.iter().map(|(name, signal)| {
            let port = match *name {
                "texel_i" => "i",
                "texel_j" => "j",
                "position_u" => "u",
                "position_v" => "v",
                other => other,
            };
            (port, signal.word(reading))
        });
        // The answers last: a walk's registers i and j are a node's.
        return registers.chain(answers).collect();
    }
}
