//! The datapaths of a unit that walks by bounds, each with its inputs and outputs in a row: for
//! whoever records a netlist of them, or closes them to a machine.
//!
//! | datapath | turns | does |
//! |---|---|---|
//! | [`SetupEntry`] | 1 | mirrors a ray, and puts it into its first block |
//! | [`SetupDigits`] | [`BoundedShape::setup_digits`] / digits | divides |
//! | [`SetupNear`] | bits of the way in a block / digits | multiplies |
//! | [`SetupEnd`] | 1 | takes care of slopes that saturate |
//! | [`Step`] | once a line | the loop |
//! | [`LeafEntry`] | 1 | the ways from a texel's borders to the ray |
//! | [`LeafTravel`] | height bits / digits | the ray at the texel's depth |
//! | [`LeafCorner`] | [`corner_digits`] / digits | the error term |
//! | [`LeafVerdict`] | 1 | hit, by which side, or refused |

use super::bounded_leaf::{
    SeenCorner, corner_bits, corner_digit, corner_digits, corner_start, leaf_place, leaf_verdict,
    leaf_ways, travel_digit,
};
use super::bounded_setup::{
    BoundedEntry, BoundedRay, Division, NearProduct, near_digit, near_sum_bits, setup_digit,
    setup_end, setup_entry,
};
use super::bounded_shape::{BoundedShape, LINE_BITS, PLACE_BITS};
use super::bounded_step::{BoundedWalk, MASK_NAMES, bounded_address, bounded_step};
use super::fixed_setup::FixedRayRegisters;
use super::step::{Named, Register, RegisterKind, Signal};
use super::wide_unit::{Row, height_ports};
use crate::arith::Arith;
use RegisterKind::{Bit, Integer};

/// A datapath of the unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoundedDatapath {
    /// A ray before its division.
    SetupEntry,
    /// So many digits of the quotient of one axis.
    SetupDigits(u32),
    /// So many digits of the way to its near border, and how many there are.
    SetupNear(u32, u32),
    /// An axis after its last digit; of the way there were so many.
    SetupEnd(u32),
    /// A step, with the address it asks for as its first output; bounds of blocks come from a memory
    /// and go there.
    Step,
    /// The ways from the texel's near borders to the ray's entry.
    LeafEntry,
    /// So many digits of the depth.
    LeafTravel(u32),
    /// So many digits of the error term.
    LeafCorner(u32),
    /// The answer.
    LeafVerdict,
}

use BoundedDatapath::*;

impl BoundedDatapath {
    /// The module's name.
    pub fn name(self, shape: BoundedShape) -> String {
        let kind = match shape.log2_side {
            1 => "quad",
            _ => "block",
        };
        let name = match self {
            SetupEntry => "setup_entry",
            SetupDigits(_) => "setup_digits",
            SetupNear(..) => "setup_near",
            SetupEnd(_) => "setup_end",
            Step => "step",
            LeafEntry => "leaf_entry",
            LeafTravel(_) => "leaf_travel",
            LeafCorner(_) => "leaf_corner",
            LeafVerdict => "leaf_verdict",
        };
        format!("bounded_{kind}_{name}")
    }

    /// The inputs, in order, but for a step's heights.
    pub fn inputs(self, shape: BoundedShape) -> Vec<Register> {
        let words = shape.words;
        let (entry, slope) = (Integer(words.entry_bits()), Integer(words.slope_bits + 1));
        let way = Integer(shape.way_bits());
        let position = Integer(shape.way_bits() + words.height_bits);
        let depth = Integer(words.height_bits + 1);
        match self {
            SetupEntry => vec![("u", entry), ("v", entry), ("du", slope), ("dv", slope)],
            SetupDigits(_) => {
                let mut inputs = vec![("slope", slope)];
                inputs.extend(division_registers(shape));
                inputs
            }
            SetupNear(_, digits) => {
                let mut inputs = vec![("quotient", Integer(shape.delta_bits() + 1))];
                inputs.extend(product_registers(shape, digits));
                inputs
            }
            SetupEnd(digits) => {
                let mut inputs = vec![
                    ("saturates", Bit),
                    ("quotient", Integer(shape.delta_bits() + 1)),
                ];
                inputs.extend(product_registers(shape, digits));
                inputs
            }
            Step => {
                let mut inputs = vec![
                    ("t_delta_u", Integer(shape.delta_bits() + 1)),
                    ("t_delta_v", Integer(shape.delta_bits() + 1)),
                    ("mirror_u", Bit),
                    ("mirror_v", Bit),
                    ("start_line", Integer(LINE_BITS)),
                ];
                inputs.extend(bounded_walk_registers(shape));
                let bound = Integer(shape.bound_bits());
                inputs.extend([("t_base_u", bound), ("t_base_v", bound)]);
                inputs
            }
            LeafEntry => vec![
                ("mirrored_u", entry),
                ("mirrored_v", entry),
                ("i", Integer(shape.index_bits())),
                ("j", Integer(shape.index_bits())),
                ("slope_u", slope),
                ("slope_v", slope),
                ("corner_is_known", Bit),
                ("v_is_later", Bit),
            ],
            LeafTravel(_) => vec![
                ("slope_u", slope),
                ("slope_v", slope),
                ("travel_u", position),
                ("travel_v", position),
                ("depth_digits", depth),
            ],
            LeafCorner(_) => {
                let digits = Integer(corner_digits(shape) + 1);
                vec![
                    ("slope_u", slope),
                    ("slope_v", slope),
                    ("corner_u", digits),
                    ("corner_v", digits),
                    ("error", Integer(corner_bits(shape))),
                ]
            }
            LeafVerdict => vec![
                ("slope_u", slope),
                ("slope_v", slope),
                ("way_u", way),
                ("way_v", way),
                ("travel_u", position),
                ("travel_v", position),
                ("error", Integer(corner_bits(shape))),
            ],
        }
    }

    /// The heights that a step reads, each of so many bits.
    pub fn heights(self, shape: BoundedShape) -> Vec<(&'static str, u32)> {
        match self {
            Step => height_ports(shape.lines()),
            _ => Vec::new(),
        }
    }

    /// The outputs, named, of inputs and heights in their order.
    pub fn evaluate<A: Arith>(
        self,
        a: &mut A,
        shape: BoundedShape,
        inputs: &[Signal<A>],
        heights: &[A::Int],
    ) -> Vec<Named<A>> {
        let mut row = Row(inputs);
        let integers = |named: &[(&'static str, A::Int)]| -> Vec<Named<A>> {
            let signal = |&(name, value)| (name, Signal::Integer(value));
            named.iter().map(signal).collect()
        };
        match self {
            SetupEntry => {
                let ray = [(); 4].map(|()| row.integer());
                let entry = setup_entry(a, shape, ray);
                entry_outputs(&entry)
            }
            SetupDigits(count) => {
                let slope = row.integer();
                let mut division = division_of(&mut row);
                for _ in 0..count {
                    division = setup_digit(a, shape, slope, &division);
                }
                vec![
                    ("remainder", Signal::Integer(division.remainder)),
                    ("first_saturates", Signal::Bit(division.first_saturates)),
                    ("quotient", Signal::Integer(division.quotient)),
                ]
            }
            SetupNear(count, digits) => {
                let quotient = row.integer();
                let mut product = product_of(&mut row);
                for _ in 0..count {
                    product = near_digit(a, shape, digits, quotient, &product);
                }
                integers(&[("behind", product.behind), ("sum", product.sum)])
            }
            SetupEnd(digits) => {
                let saturates = row.next().bit();
                let quotient = row.integer();
                let product = product_of(&mut row);
                let end = setup_end(a, shape, digits, saturates, quotient, &product);
                integers(&[("t_delta", end.0), ("t_near", end.1)])
            }
            Step => step_outputs(a, shape, &mut row, heights),
            LeafEntry => {
                let mut ray = no_ray(a);
                (ray.u, ray.v) = (row.integer(), row.integer());
                let (i, j) = (row.integer(), row.integer());
                (ray.slope_u, ray.slope_v) = (row.integer(), row.integer());
                let ways = leaf_ways(a, shape, &ray, i, j);
                let seen = SeenCorner {
                    is_known: row.next().bit(),
                    v_is_later: row.next().bit(),
                };
                let corner = corner_start(a, shape, &ray, ways, seen);
                integers(&[
                    ("way_u", ways.0),
                    ("way_v", ways.1),
                    ("corner_u", corner.u),
                    ("corner_v", corner.v),
                    ("error", corner.error),
                ])
            }
            LeafTravel(count) => {
                let ray = slopes(a, &mut row);
                let mut travel = super::bounded_leaf::LeafTravel {
                    u: row.integer(),
                    v: row.integer(),
                    depth: row.integer(),
                };
                for _ in 0..count {
                    travel = travel_digit(a, shape, &ray, &travel);
                }
                integers(&[
                    ("travel_u", travel.u),
                    ("travel_v", travel.v),
                    ("depth_digits", travel.depth),
                ])
            }
            LeafCorner(count) => {
                let ray = slopes(a, &mut row);
                let mut corner = super::bounded_leaf::LeafCorner {
                    u: row.integer(),
                    v: row.integer(),
                    error: row.integer(),
                };
                for _ in 0..count {
                    corner = corner_digit(a, shape, &ray, &corner);
                }
                integers(&[
                    ("corner_u", corner.u),
                    ("corner_v", corner.v),
                    ("error", corner.error),
                ])
            }
            LeafVerdict => {
                let ray = slopes(a, &mut row);
                let ways = (row.integer(), row.integer());
                let travel = super::bounded_leaf::LeafTravel {
                    u: row.integer(),
                    v: row.integer(),
                    depth: a.int_constant(0),
                };
                let error = row.integer();
                let place = leaf_place(a, shape, ways, &travel);
                let verdict = leaf_verdict(a, shape, &ray, ways, &place, error);
                vec![
                    (
                        "is_before",
                        Signal::Bit(a.or(place.is_before_u, place.is_before_v)),
                    ),
                    ("refused", Signal::Bit(verdict.refused)),
                    ("at_border_u", Signal::Bit(verdict.at_border_u)),
                    ("at_border_v", Signal::Bit(verdict.at_border_v)),
                ]
            }
        }
    }
}

/// The registers of a walk that a step changes, but for the bounds of blocks.
pub fn bounded_walk_registers(shape: BoundedShape) -> Vec<Register> {
    let count = shape.line_levels();
    let mut registers = vec![
        ("line", Integer(LINE_BITS)),
        ("i", Integer(shape.index_bits())),
        ("j", Integer(shape.index_bits())),
        ("from_own_line", Bit),
        ("column", Integer(PLACE_BITS)),
        ("row", Integer(PLACE_BITS)),
    ];
    // A mask is read without its sign: its register has a bit more.
    let mask = Integer(shape.lines().cells() as u32 + 1);
    registers.extend(MASK_NAMES[..count].iter().map(|&name| (name, mask)));
    registers.extend([
        ("leaves_u", Bit),
        ("leaves_back", Bit),
        ("resumes", Bit),
        ("steps", Integer(shape.counter_bits())),
        ("crossings", Integer(shape.counter_bits())),
        ("hit", Bit),
        ("guard", Bit),
        ("depth", Integer(shape.words.height_bits + 1)),
    ]);
    registers
}

/// A walk from its registers in a row.
pub(super) fn bounded_walk_of<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    row: &mut Row<'_, A>,
) -> BoundedWalk<A> {
    let (line, i, j) = (row.integer(), row.integer(), row.integer());
    let from_own_line = row.next().bit();
    let (column, place_row) = (row.integer(), row.integer());
    let mut kept = [a.int_constant(0); super::bounded_shape::MOST_BOUNDED_LINES];
    for mask in &mut kept[..shape.line_levels()] {
        *mask = row.integer();
    }
    BoundedWalk {
        line,
        i,
        j,
        from_own_line,
        column,
        row: place_row,
        kept,
        leaves_u: row.next().bit(),
        leaves_back: row.next().bit(),
        resumes: row.next().bit(),
        steps: row.integer(),
        crossings: row.integer(),
        hit: row.next().bit(),
        guard: row.next().bit(),
        depth: row.integer(),
    }
}

/// Appends the registers of a walk to a row.
pub(super) fn bounded_walk_row<A: Arith>(
    shape: BoundedShape,
    walk: &BoundedWalk<A>,
    row: &mut Vec<Signal<A>>,
) {
    row.extend([walk.line, walk.i, walk.j].map(Signal::Integer));
    row.push(Signal::Bit(walk.from_own_line));
    row.extend([walk.column, walk.row].map(Signal::Integer));
    let kept = &walk.kept[..shape.line_levels()];
    row.extend(kept.iter().copied().map(Signal::Integer));
    row.extend([walk.leaves_u, walk.leaves_back, walk.resumes].map(Signal::Bit));
    row.extend([walk.steps, walk.crossings].map(Signal::Integer));
    row.extend([walk.hit, walk.guard].map(Signal::Bit));
    row.push(Signal::Integer(walk.depth));
}

fn step_outputs<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    row: &mut Row<'_, A>,
    heights: &[A::Int],
) -> Vec<Named<A>> {
    let mut fixed = no_ray(a);
    let (t_delta_u, t_delta_v) = (row.integer(), row.integer());
    (fixed.mirror_u, fixed.mirror_v) = (row.next().bit(), row.next().bit());
    let ray = BoundedRay {
        fixed,
        t_delta_u,
        t_delta_v,
        start_line: row.integer(),
    };
    let walk = bounded_walk_of(a, shape, row);
    let base = (row.integer(), row.integer());
    let mirrors = (fixed.mirror_u, fixed.mirror_v);
    let address = bounded_address(a, shape, mirrors, &walk);
    let result = bounded_step(a, shape, &ray, &walk, base, heights);
    let mut outputs = vec![("line_address", Signal::Integer(address))];
    let names = bounded_walk_registers(shape).into_iter();
    let mut signals = Vec::new();
    bounded_walk_row(shape, &result.walk, &mut signals);
    outputs.extend(names.map(|(name, _)| name).zip(signals));
    outputs.push(("t_near_u", Signal::Integer(result.t_near.0)));
    outputs.push(("t_near_v", Signal::Integer(result.t_near.1)));
    outputs.push(("corner_is_known", Signal::Bit(result.corner.is_known)));
    outputs.push(("v_is_later", Signal::Bit(result.corner.v_is_later)));
    outputs
}

/// A ray of which nothing is known; what a datapath reads is put in.
pub(super) fn no_ray<A: Arith>(a: &mut A) -> FixedRayRegisters<A> {
    let (none, no) = (a.int_constant(0), a.bit_constant(false));
    FixedRayRegisters {
        u: none,
        v: none,
        slope_u: none,
        slope_v: none,
        mirror_u: no,
        mirror_v: no,
    }
}

fn slopes<A: Arith>(a: &mut A, row: &mut Row<'_, A>) -> FixedRayRegisters<A> {
    let mut ray = no_ray(a);
    (ray.slope_u, ray.slope_v) = (row.integer(), row.integer());
    ray
}

fn division_registers(shape: BoundedShape) -> [Register; 3] {
    [
        ("remainder", Integer(shape.words.slope_bits + 1)),
        ("first_saturates", Bit),
        ("quotient", Integer(shape.delta_bits() + 1)),
    ]
}

fn division_of<A: Arith>(row: &mut Row<'_, A>) -> Division<A> {
    Division {
        remainder: row.integer(),
        first_saturates: row.next().bit(),
        quotient: row.integer(),
    }
}

fn product_registers(shape: BoundedShape, digits: u32) -> [Register; 2] {
    [
        ("behind", Integer(digits + 1)),
        ("sum", Integer(near_sum_bits(shape, digits))),
    ]
}

fn product_of<A: Arith>(row: &mut Row<'_, A>) -> NearProduct<A> {
    NearProduct {
        behind: row.integer(),
        sum: row.integer(),
    }
}

/// What a ray is before its division: what does not begin with the same constant for every ray.
fn entry_outputs<A: Arith>(entry: &BoundedEntry<A>) -> Vec<Named<A>> {
    let fixed = &entry.fixed;
    vec![
        ("mirrored_u", Signal::Integer(fixed.u)),
        ("mirrored_v", Signal::Integer(fixed.v)),
        ("slope_u", Signal::Integer(fixed.slope_u)),
        ("slope_v", Signal::Integer(fixed.slope_v)),
        ("mirror_u", Signal::Bit(fixed.mirror_u)),
        ("mirror_v", Signal::Bit(fixed.mirror_v)),
        ("start_line", Signal::Integer(entry.start_line)),
        ("i", Signal::Integer(entry.i)),
        ("j", Signal::Integer(entry.j)),
        ("remainder_u", Signal::Integer(entry.u.division.remainder)),
        ("remainder_v", Signal::Integer(entry.v.division.remainder)),
        (
            "first_saturates_u",
            Signal::Bit(entry.u.division.first_saturates),
        ),
        (
            "first_saturates_v",
            Signal::Bit(entry.v.division.first_saturates),
        ),
        ("saturates_u", Signal::Bit(entry.u.saturates)),
        ("saturates_v", Signal::Bit(entry.v.saturates)),
        ("behind_u", Signal::Integer(entry.u.behind)),
        ("behind_v", Signal::Integer(entry.v.behind)),
    ]
}
