//! Vectors of the step: what stands before it and what it makes of that, out of real walks.

use std::collections::HashMap;

use rtl_model::float::{FloatFormat, Rounding};
use rtl_model::machine::STEP_INPUTS;
use rtl_model::maps::Pyramid;
use rtl_model::ray::{Ray, reach_in};
use rtl_model::readings::FloatReading;
use rtl_model::units::search_policy::SearchPolicy;
use rtl_model::units::traverse::shape_for;
use rtl_model::units::traverse_setup::{RayRegisters, SetUpRay, traverse_setup};
use rtl_model::units::traverse_step::{
    StepResult, TraverseShape, WalkRegisters, node_address, traverse_step, walk_start,
};

use super::field::{Field, FieldFormat, Role};
use super::set::VectorSet;
use crate::netlist::Module;

type Reading = FloatReading<FloatFormat>;

/// Steps kept of each kind (see [`Kind`]).
const KEPT_OF_A_KIND: u32 = 2;
/// Of a frame's steps, every so manyeth is kept besides: what is common should be there too.
const KEPT_EVERY: u64 = 499;

/// Vectors of the step in front of `pyramid`: of the walks of `rays` (bits of `format`) and of rays
/// along the axes, through corners and at the ends of their range, two steps of every kind there
/// is, and some more; and steps of walks that have ended or end at the step bound.
///
/// `unit` is [`crate::units::build_step_unit`]'s: the fields are its ports without the handshakes.
pub fn step_vectors(
    unit: &Module,
    format: FloatFormat,
    pyramid: &Pyramid,
    rays: &[Ray<u64>],
) -> VectorSet {
    let mut chosen = Chosen {
        reading: FloatReading(format),
        shape: shape_for(pyramid),
        pyramid,
        set: VectorSet::new(fields(unit)),
        kinds: HashMap::new(),
        steps: 0,
    };
    for &ray in rays {
        chosen.walk(ray, true);
    }
    for ray in corner_rays(format, pyramid.size()) {
        chosen.walk(ray, false);
    }
    if let Some(&ray) = rays.first() {
        chosen.ends(ray);
    }
    chosen.set
}

/// What the step answers to inputs that are all zero bits: what stands in the gaps of its
/// pipeline. In the order of the unit's outputs, the handshakes aside.
pub fn idle_step_results(unit: &Module, format: FloatFormat, pyramid: &Pyramid) -> Vec<u64> {
    let mut chosen = Chosen {
        reading: FloatReading(format),
        shape: shape_for(pyramid),
        pyramid,
        set: VectorSet::new(fields(unit)),
        kinds: HashMap::new(),
        steps: 0,
    };
    let ray = RayRegisters {
        u: 0,
        v: 0,
        du: 0,
        dv: 0,
        exact_below_u: 0,
        exact_below_v: 0,
        mirror_u: false,
        mirror_v: false,
    };
    let idle = SetUpRay {
        ray,
        level: 0,
        i: 0,
        j: 0,
    };
    let walk = walk_start(&mut chosen.reading, SearchPolicy::OH, &idle);
    let address = node_address(
        &mut chosen.reading,
        chosen.shape,
        SearchPolicy::OH,
        &ray,
        &walk,
    );
    let (vector, _) = chosen.step_at(&ray, &walk, address, 0);
    let inputs = chosen
        .set
        .fields
        .iter()
        .filter(|field| field.role == Role::Input)
        .count();
    vector[inputs..].to_vec()
}

/// What makes a step different from others: where the ray goes, where in the pyramid it is, what
/// it does, what it owes.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Kind {
    mirrored: (bool, bool),
    at_root: bool,
    at_level_0: bool,
    outcome: Outcome,
    at_border_v: bool,
    corner: (bool, bool),
    owes_next: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Outcome {
    Hits,
    Descends,
    DescendsFurther,
    CrossesU,
    CrossesV,
    GoesBack,
}

struct Chosen<'a> {
    reading: Reading,
    shape: TraverseShape,
    pyramid: &'a Pyramid,
    set: VectorSet,
    kinds: HashMap<Kind, u32>,
    steps: u64,
}

impl Chosen<'_> {
    /// Walks a ray and keeps the steps whose kind is still wanted; of a usual ray, some more.
    fn walk(&mut self, ray: Ray<u64>, usual: bool) {
        let (ray, mut walk) = self.start(ray);
        while !walk.hit && !walk.guard {
            let (vector, result) = self.step(&ray, &walk);
            let kind = self.kind(&ray, &walk, &result);
            let kept = self.kinds.entry(kind).or_insert(0);
            let by_chance = usual && self.steps.is_multiple_of(KEPT_EVERY);
            if *kept < KEPT_OF_A_KIND || by_chance {
                *kept += 1;
                self.set.push(vector);
            }
            self.steps += 1;
            walk = result.walk;
        }
    }

    /// The first and the last steps of a walk, once with its counter just below the step bound,
    /// once with the walk ended either way.
    fn ends(&mut self, ray: Ray<u64>) {
        let (ray, mut walk) = self.start(ray);
        let first = walk;
        let mut last = walk;
        while !walk.hit && !walk.guard {
            last = walk;
            walk = self.step(&ray, &walk).1.walk;
        }
        let below_bound = i64::from(self.shape.step_bound(SearchPolicy::OH)) - 1;
        for walk in [first, last] {
            for (steps, hit, guard) in [
                (below_bound, false, false),
                (walk.steps, true, false),
                (below_bound + 1, false, true),
            ] {
                let walk = WalkRegisters {
                    steps,
                    hit,
                    guard,
                    ..walk
                };
                let vector = self.step(&ray, &walk).0;
                self.set.push(vector);
            }
        }
    }

    fn start(&mut self, ray: Ray<u64>) -> (RayRegisters<Reading>, WalkRegisters<Reading>) {
        let reading = &mut self.reading;
        let setup = traverse_setup(
            reading,
            self.shape,
            SearchPolicy::OH,
            ray.u,
            ray.v,
            ray.du,
            ray.dv,
        );
        let walk = walk_start(reading, SearchPolicy::OH, &setup);
        (setup.ray, walk)
    }

    /// The vector of a step, and its result.
    fn step(
        &mut self,
        ray: &RayRegisters<Reading>,
        walk: &WalkRegisters<Reading>,
    ) -> (Vec<u64>, StepResult<Reading>) {
        let address = node_address(&mut self.reading, self.shape, SearchPolicy::OH, ray, walk);
        let height = i64::from(self.pyramid.memory()[address as usize]);
        self.step_at(ray, walk, address, height)
    }

    /// The same with a height that need not be the node's.
    fn step_at(
        &mut self,
        ray: &RayRegisters<Reading>,
        walk: &WalkRegisters<Reading>,
        address: i64,
        height: i64,
    ) -> (Vec<u64>, StepResult<Reading>) {
        let result = traverse_step(
            &mut self.reading,
            self.shape,
            SearchPolicy::OH,
            ray,
            walk,
            height,
        );
        let vector = self.set.fields.iter().map(|field| {
            let value = match (field.role, field.name.as_str()) {
                (_, "height_i") => height as u64,
                (_, "node_address_o") => address as u64,
                (_, "position_u_o") => result.position_u,
                (_, "position_v_o") => result.position_v,
                (_, "texel_i_o") => result.texel_i as u64,
                (_, "texel_j_o") => result.texel_j as u64,
                (Role::Input, name) => register(ray, walk, name),
                (_, name) => register(ray, &result.walk, name),
            };
            value & field.mask()
        });
        (vector.collect(), result)
    }

    fn kind(
        &self,
        ray: &RayRegisters<Reading>,
        walk: &WalkRegisters<Reading>,
        result: &StepResult<Reading>,
    ) -> Kind {
        let next = &result.walk;
        Kind {
            mirrored: (ray.mirror_u, ray.mirror_v),
            at_root: walk.level == i64::from(self.shape.root_level),
            at_level_0: walk.level == 0,
            outcome: if next.hit {
                Outcome::Hits
            } else if next.level < walk.level {
                match next.t == walk.t {
                    true => Outcome::Descends,
                    false => Outcome::DescendsFurther,
                }
            } else if next.i < walk.i {
                Outcome::GoesBack
            } else if next.i > walk.i {
                Outcome::CrossesU
            } else {
                Outcome::CrossesV
            },
            at_border_v: walk.at_border_v,
            corner: (walk.corner_owed, walk.corner_paid),
            owes_next: next.corner_owed,
        }
    }
}

/// A register by the name of its port: that in [`STEP_INPUTS`], and `_i` or `_o`.
fn register(ray: &RayRegisters<Reading>, walk: &WalkRegisters<Reading>, port: &str) -> u64 {
    let (name, _) = port.rsplit_once('_').unwrap_or((port, ""));
    match name {
        "u" => ray.u,
        "v" => ray.v,
        "du" => ray.du,
        "dv" => ray.dv,
        "exact_below_u" => ray.exact_below_u,
        "exact_below_v" => ray.exact_below_v,
        "mirror_u" => ray.mirror_u.into(),
        "mirror_v" => ray.mirror_v.into(),
        "level" => walk.level as u64,
        "i" => walk.i as u64,
        "j" => walk.j as u64,
        "t" => walk.t,
        "at_border_v" => walk.at_border_v.into(),
        "corner_owed" => walk.corner_owed.into(),
        "corner_paid" => walk.corner_paid.into(),
        "steps" => walk.steps as u64,
        "crossings" => walk.crossings as u64,
        "hit" => walk.hit.into(),
        "guard" => walk.guard.into(),
        _ => unreachable!("{port}: no register of the step; there are {STEP_INPUTS:?}"),
    }
}

/// Rays along the axes and the diagonals, from corners, midlines and just beside them, upright and
/// as flat as they may be, with zeros of either sign.
fn corner_rays(format: FloatFormat, size: u32) -> Vec<Ray<u64>> {
    let number = |value: f64| format.from_f64(Rounding::NearestEven, value);
    let coordinates = [
        0,
        format.min_normal(),
        number(0.5),
        number(0.5) - 1,
        number(0.5) + 1,
        format.one() - 1,
        number(1.5 / f64::from(size)),
    ];
    let reach = number(reach_in(format.fraction_bits) / f64::from(size)).min(format.max_finite());
    let directions = [
        0,
        format.sign_bit(),
        format.one(),
        format.one() | format.sign_bit(),
        number(-1.0) + 1,
        reach,
        reach | format.sign_bit(),
        format.min_normal(),
    ];
    let mut rays = Vec::new();
    for u in coordinates {
        for v in coordinates {
            for du in directions {
                rays.extend(directions.map(|dv| Ray { u, v, du, dv }));
            }
        }
    }
    rays
}

/// The ports of the unit, its handshakes aside.
fn fields(unit: &Module) -> Vec<Field> {
    let handshakes = ["valid_i", "ready_i", "valid_o", "ready_o"];
    let inputs = unit.inputs.iter().map(|&wire| {
        let name = unit
            .node(wire)
            .name
            .as_deref()
            .expect("an input has a name");
        (name, wire, Role::Input)
    });
    let outputs = unit.outputs.iter();
    let outputs = outputs.map(|(name, wire)| (name.as_str(), *wire, Role::Output));
    inputs
        .chain(outputs)
        .filter(|(name, ..)| !handshakes.contains(name))
        .map(|(name, wire, role)| {
            let node = unit.node(wire);
            let format = match name {
                "height_i" | "node_address_o" | "texel_i_o" | "texel_j_o" => FieldFormat::Unsigned,
                _ => FieldFormat::of_port(node.meaning, node.width),
            };
            Field::new(name, role, node.width, format, meaning(name))
        })
        .collect()
}

/// What a port of the step carries.
fn meaning(port: &str) -> &'static str {
    match port {
        "height_i" => "height of the walk's node",
        "node_address_o" => "where that height lies in the memory",
        "position_u_o" => "position on u after the step, not mirrored",
        "position_v_o" => "position on v after the step, not mirrored",
        "texel_i_o" => "texel on u, once the walk has ended",
        "texel_j_o" => "texel on v, once the walk has ended",
        "u_i" | "u_o" => "entry coordinate, mirrored where the ray is",
        "v_i" | "v_o" => "entry coordinate, mirrored where the ray is",
        "du_i" | "du_o" => "offset on u for one unit of depth, mirrored: not negative",
        "dv_i" | "dv_o" => "offset on v for one unit of depth, mirrored: not negative",
        "exact_below_u_i" | "exact_below_u_o" => "differences with u are exact below this",
        "exact_below_v_i" | "exact_below_v_o" => "differences with v are exact below this",
        "mirror_u_i" | "mirror_u_o" => "the ray travels toward smaller u",
        "mirror_v_i" | "mirror_v_o" => "the ray travels toward smaller v",
        "level_i" | "level_o" => "level of the node, 0 the map",
        "i_i" | "i_o" => "index of the node on u, mirrored, not wrapped",
        "j_i" | "j_o" => "index of the node on v, mirrored, not wrapped",
        "t_i" | "t_o" => "depth reached, 0 top to 1 bottom",
        "at_border_v_i" | "at_border_v_o" => "the depth reached is that of a border of v crossed",
        "corner_owed_i" | "corner_owed_o" => "the node across a corner is owed a visit",
        "corner_paid_i" | "corner_paid_o" => "the visit across a corner is being paid",
        "steps_i" | "steps_o" => "steps taken",
        "crossings_i" | "crossings_o" => "node crossings among them",
        "hit_i" | "hit_o" => "the walk has ended in a hit",
        "guard_i" | "guard_o" => "the walk has ended at the step bound",
        _ => unreachable!("{port}: no port of the step"),
    }
}
