//! Vectors of a step: what stands before it and what it makes of that, out of real walks.

use std::cmp::Ordering;
use std::collections::HashMap;

use rtl_model::float::{FloatFormat, Rounding};
use rtl_model::maps::Pyramid;
use rtl_model::ray::{Ray, reach_in};
use rtl_model::readings::FloatReading;
use rtl_model::units::step::{Named, Register, RegisterKind, Signal, Step};

use super::field::{Field, FieldFormat, Role};
use super::set::VectorSet;
use crate::netlist::Module;
use crate::units::{UnitConfiguration, step_registers};

type Reading = FloatReading<FloatFormat>;
type Row = Vec<Signal<Reading>>;

/// Steps kept of each kind (see [`Kind`]).
const KEPT_OF_A_KIND: u32 = 2;
/// Of a frame's steps, every so manyeth is kept besides in committed vectors: what is common should
/// be there too.
pub const KEPT_EVERY: u64 = 499;

/// Steps looked at of a usual ray's walk ...
const MOST_STEPS: u32 = 500;
/// ... and of a ray's through corners: there are thousands of those, and the flattest go on for
/// thousands of steps of a kind.
const MOST_CORNER_STEPS: u32 = 48;

/// Vectors of a step in front of `pyramid`: of the walks of `rays` and of rays along the axes,
/// through corners and at the ends of their range, two steps of every kind there is, and of the
/// former every `kept_every`th; and steps of walks that have ended or end at the step bound.
///
/// `unit` is [`crate::units::build_step_unit`]'s: the fields are its ports without the handshakes.
pub fn step_vectors(
    unit: &Module,
    configuration: &UnitConfiguration,
    pyramid: &Pyramid,
    rays: &[Ray<f64>],
    kept_every: u64,
) -> VectorSet {
    let mut chosen = Chosen::new(unit, configuration, pyramid);
    chosen.kept_every = kept_every;
    for &ray in rays {
        chosen.walk(ray, true);
    }
    for ray in corner_rays(configuration.format, pyramid.size()) {
        chosen.walk(ray, false);
    }
    if let Some(&ray) = rays.first() {
        chosen.ends(ray);
    }
    chosen.set
}

/// The same of the walks of `rays` alone, without the thousands of rays through corners: for the
/// steps that few vectors are kept of.
pub fn few_step_vectors(
    unit: &Module,
    configuration: &UnitConfiguration,
    pyramid: &Pyramid,
    rays: &[Ray<f64>],
) -> VectorSet {
    let mut chosen = Chosen::new(unit, configuration, pyramid);
    for &ray in rays {
        chosen.walk(ray, true);
    }
    if let Some(&ray) = rays.first() {
        chosen.ends(ray);
    }
    chosen.set
}

/// What the step answers to inputs that are all zero bits: what stands in the gaps of its
/// pipeline. In the order of the unit's outputs, the handshakes aside.
pub fn idle_step_results(
    unit: &Module,
    configuration: &UnitConfiguration,
    pyramid: &Pyramid,
) -> Vec<u64> {
    let mut chosen = Chosen::new(unit, configuration, pyramid);
    let reading = FloatReading(configuration.format);
    let registers = chosen.registers.iter();
    let row: Row = registers
        .map(|&(_, kind)| Signal::of_word(&reading, kind, 0))
        .collect();
    let address = configuration.step.address(&mut chosen.reading, &row);
    let heights = vec![0; configuration.step.height_ports().len()];
    let (vector, _) = chosen.step_at(&row, address, &heights);
    let fields = chosen.set.fields.iter();
    let inputs = fields.filter(|field| field.role == Role::Input).count();
    vector[inputs..].to_vec()
}

/// What makes a step different from others: the bits before and after it; where in the pyramid it
/// is, and, where it stays there, which way each index goes; whether it advances.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Kind {
    bits: Vec<bool>,
    level: Option<Level>,
    integers: Vec<Ordering>,
    numbers_change: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Level {
    is_lowest: bool,
    goes: Ordering,
}

/// Integers that count what happens, and say nothing of what does.
const COUNTERS: [&str; 2] = ["steps", "crossings"];

struct Chosen<'a> {
    configuration: UnitConfiguration,
    reading: Reading,
    pyramid: &'a Pyramid,
    memory: std::borrow::Cow<'a, [u16]>,
    registers: Vec<Register>,
    unchanged: usize,
    set: VectorSet,
    kinds: HashMap<Kind, u32>,
    steps: u64,
    kept_every: u64,
}

impl<'a> Chosen<'a> {
    fn new(unit: &Module, configuration: &UnitConfiguration, pyramid: &'a Pyramid) -> Self {
        let step = configuration.step;
        Chosen {
            configuration: *configuration,
            reading: FloatReading(configuration.format),
            pyramid,
            memory: step.memory(pyramid),
            registers: step_registers(&step),
            unchanged: step.ray_registers().len(),
            set: VectorSet::new(fields(unit, &step)),
            kinds: HashMap::new(),
            steps: 0,
            kept_every: KEPT_EVERY,
        }
    }

    fn place(&self, name: &str) -> usize {
        let mut names = self.registers.iter().map(|(register, _)| *register);
        let place = names.position(|register| register == name);
        place.unwrap_or_else(|| panic!("every walk has the register {name}"))
    }

    fn has_ended(&self, row: &Row) -> bool {
        row[self.place("hit")].bit() || row[self.place("guard")].bit()
    }

    /// Walks a ray and keeps the steps whose kind is still wanted; of a usual ray, some more.
    fn walk(&mut self, ray: Ray<f64>, usual: bool) {
        let mut row = self.start(ray);
        let most = if usual { MOST_STEPS } else { MOST_CORNER_STEPS };
        for _ in 0..most {
            if self.has_ended(&row) {
                break;
            }
            let (vector, next) = self.step(&row);
            let kept = self.kinds.entry(self.kind(&row, &next)).or_insert(0);
            let by_chance = usual && self.steps.is_multiple_of(self.kept_every);
            if *kept < KEPT_OF_A_KIND || by_chance {
                *kept += 1;
                self.set.push(vector);
            }
            self.steps += 1;
            row = next;
        }
    }

    /// The first and the last steps of a walk, once with its counter just below the step bound,
    /// once with the walk ended either way.
    fn ends(&mut self, ray: Ray<f64>) {
        let mut row = self.start(ray);
        let first = row.clone();
        let mut last = row.clone();
        while !self.has_ended(&row) {
            last = row.clone();
            row = self.step(&row).1;
        }
        let bound = i64::from(self.configuration.step.step_bound());
        let (steps, hit, guard) = (self.place("steps"), self.place("hit"), self.place("guard"));
        for row in [first, last] {
            for (count, has_hit, at_bound) in [
                (bound - 1, false, false),
                (row[steps].integer(), true, false),
                (bound, false, true),
            ] {
                let mut row = row.clone();
                row[steps] = Signal::Integer(count);
                row[hit] = Signal::Bit(has_hit);
                row[guard] = Signal::Bit(at_bound);
                let vector = self.step(&row).0;
                self.set.push(vector);
            }
        }
    }

    fn start(&mut self, ray: Ray<f64>) -> Row {
        let step = self.configuration.step;
        let ports = step.enter_over(&mut self.reading, self.pyramid, ray);
        step.set_up(&mut self.reading, &ports)
    }

    /// The vector of a step, and the registers after it.
    fn step(&mut self, row: &Row) -> (Vec<u64>, Row) {
        let step = self.configuration.step;
        let address = step.address(&mut self.reading, row);
        let ports = step.height_ports().len();
        let line = &self.memory[address as usize * ports..][..ports];
        let heights: Vec<i64> = line.iter().map(|&height| height.into()).collect();
        self.step_at(row, address, &heights)
    }

    /// The same with heights that need not be the node's.
    fn step_at(&mut self, row: &Row, address: i64, heights: &[i64]) -> (Vec<u64>, Row) {
        let step = self.configuration.step;
        let (walk, named) = step.step(&mut self.reading, row, heights);
        let mut next = row[..self.unchanged].to_vec();
        next.extend(walk);
        let before = self.named_words(row).collect::<HashMap<_, _>>();
        let after: HashMap<_, _> = self
            .named_words(&next)
            .chain(
                named
                    .iter()
                    .map(|(name, signal): &Named<Reading>| (*name, signal.word(&self.reading))),
            )
            .chain([(step.address_port(), address.cast_unsigned())])
            .collect();
        let ports = step.height_ports();
        let heights: HashMap<&str, u64> = ports
            .iter()
            .zip(heights)
            .map(|(&(name, _), &height)| (name, height.cast_unsigned()))
            .collect();
        let vector = self.set.fields.iter().map(|field| {
            let (name, _) = field.name.rsplit_once('_').unwrap_or((&field.name, ""));
            let value = match field.role {
                Role::Input => before.get(name).or(heights.get(name)),
                _ => after.get(name),
            };
            let value = value.unwrap_or_else(|| panic!("{}: no port of the step", field.name));
            value & field.mask()
        });
        (vector.collect(), next)
    }

    fn named_words<'r>(&'r self, row: &'r Row) -> impl Iterator<Item = (&'static str, u64)> + 'r {
        let registers = self.registers.iter().zip(row);
        registers.map(|(&(name, _), signal)| (name, signal.word(&self.reading)))
    }

    fn kind(&self, row: &Row, next: &Row) -> Kind {
        let mut kind = Kind {
            bits: Vec::new(),
            level: None,
            integers: Vec::new(),
            numbers_change: false,
        };
        for ((&(name, of), before), after) in self.registers.iter().zip(row).zip(next) {
            match of {
                RegisterKind::Bit => kind.bits.extend([before.bit(), after.bit()]),
                RegisterKind::Integer(_) if name == "level" => {
                    kind.level = Some(Level {
                        is_lowest: before.integer() == 0,
                        goes: after.integer().cmp(&before.integer()),
                    });
                }
                RegisterKind::Integer(_) if COUNTERS.contains(&name) => {}
                RegisterKind::Integer(_) => {
                    kind.integers.push(after.integer().cmp(&before.integer()));
                }
                RegisterKind::Number => kind.numbers_change |= before.number() != after.number(),
            }
        }
        // On another level an index counts other nodes.
        match kind.level {
            Some(level) if level.goes.is_ne() => kind.integers.clear(),
            _ => kind.numbers_change = false,
        }
        kind
    }
}

/// Rays along the axes and the diagonals, from corners, midlines and just beside them, upright and
/// as flat as they may be, with zeros of either sign.
fn corner_rays(format: FloatFormat, size: u32) -> Vec<Ray<f64>> {
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
                let ray = |dv| Ray { u, v, du, dv };
                rays.extend(directions.map(|dv| ray(dv).map(|word| format.to_f64(word))));
            }
        }
    }
    rays
}

/// The ports of the unit, its handshakes aside.
fn fields(unit: &Module, step: &impl Step) -> Vec<Field> {
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
            let (base, _) = name.rsplit_once('_').unwrap_or((name, ""));
            let is_height = step.height_ports().iter().any(|(port, _)| *port == base);
            let is_address = base == step.address_port();
            let format = match is_height || is_address || base.starts_with("texel_") {
                true => FieldFormat::Unsigned,
                false => FieldFormat::of_port(node.meaning, node.width),
            };
            let meaning = match (is_height, is_address) {
                (true, _) => "height of the walk's node",
                (_, true) => "where that height lies in the memory",
                _ => meaning(base),
            };
            Field::new(name, role, node.width, format, meaning)
        })
        .collect()
}

/// What a register or an answer is, by its name.
fn meaning(name: &str) -> &'static str {
    match name {
        "position_u" => "position on u after the step, not mirrored",
        "position_v" => "position on v after the step, not mirrored",
        "texel_i" => "texel on u, once the walk has ended",
        "texel_j" => "texel on v, once the walk has ended",
        "u" | "v" => "entry coordinate, mirrored where the ray is",
        "du" => "offset on u for one unit of depth, mirrored: not negative",
        "dv" => "offset on v for one unit of depth, mirrored: not negative",
        "exact_below_u" => "differences with u are exact below this",
        "exact_below_v" => "differences with v are exact below this",
        "mirror_u" => "the ray travels toward smaller u",
        "mirror_v" => "the ray travels toward smaller v",
        "level" => "level of the node, 0 the map",
        "i" => "index of the node on u, mirrored, not wrapped",
        "j" => "index of the node on v, mirrored, not wrapped",
        "t" => "depth reached, 0 top to 1 bottom",
        "at_border_v" => "the depth reached is that of a border of v crossed",
        "corner_owed" => "the node across a corner is owed a visit",
        "corner_paid" => "the visit across a corner is being paid",
        "steps" => "steps taken",
        "crossings" => "node crossings among them",
        "hit" => "the walk has ended in a hit",
        "guard" => "the walk has ended at the step bound",
        _ => "of this name in the step's source",
    }
}
