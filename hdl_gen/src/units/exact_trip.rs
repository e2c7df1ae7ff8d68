//! A trip round the loop of the exact machine, recorded from the function the golden machine
//! evaluates, and cut into stages.

use crate::datapath::{
    BitSignal, BuiltDatapath, IntSignal, OperatorLatencies, Recorder, Recording, build,
    schedule_in_stages,
};
use rtl_model::float::FloatFormat;
use rtl_model::machine::{ExactMachineShape, READ_STAGE, exact_trip};
use rtl_model::units::bounded_setup::BoundedRay;
use rtl_model::units::bounded_shape::{LINE_BITS, MOST_BOUNDED_LINES};
use rtl_model::units::bounded_step::BoundedWalk;
use rtl_model::units::fixed_setup::FixedRayRegisters;

/// The name of the module.
pub const EXACT_TRIP: &str = "exact_trip";

const HEIGHTS: [&str; 16] = [
    "height_0",
    "height_1",
    "height_2",
    "height_3",
    "height_4",
    "height_5",
    "height_6",
    "height_7",
    "height_8",
    "height_9",
    "height_10",
    "height_11",
    "height_12",
    "height_13",
    "height_14",
    "height_15",
];

/// The input of a walk's register: how a walk leaves its block has the same name in the step.
pub(super) fn trip_input(register: &'static str) -> &'static str {
    match register {
        "leaves_u" => "left_u",
        "leaves_back" => "left_back",
        name => name,
    }
}

fn record(shape: &ExactMachineShape) -> Recording {
    let bounded = shape.bounded;
    // Nothing is computed in the format.
    let mut recorder = Recorder::new(FloatFormat::E7F16);
    let r = &mut recorder;
    let delta = bounded.delta_bits() + 1;
    let t_delta_u = r.int_input("t_delta_u", delta, READ_STAGE);
    let t_delta_v = r.int_input("t_delta_v", delta, READ_STAGE);
    let mirror_u = r.bit_input("mirror_u", READ_STAGE);
    let mirror_v = r.bit_input("mirror_v", READ_STAGE);
    let start_line = r.int_input("start_line", LINE_BITS, READ_STAGE);
    let mut integers: Vec<IntSignal> = Vec::new();
    let mut bits: Vec<BitSignal> = Vec::new();
    const BITS: [&str; 4] = ["from_own_line", "leaves_u", "leaves_back", "resumes"];
    for (name, width) in shape.walk_registers() {
        match BITS.contains(&name) {
            true => bits.push(r.bit_input(trip_input(name), 0)),
            false => integers.push(r.int_input(name, width, 0)),
        }
    }
    let t_base_u = r.int_input("t_base_u", bounded.bound_bits(), READ_STAGE);
    let t_base_v = r.int_input("t_base_v", bounded.bound_bits(), READ_STAGE);
    let fresh = r.bit_input("fresh", READ_STAGE);
    let missed = r.bit_input("missed", shape.height_stage());
    let cells = bounded.lines().cells();
    let heights: Vec<IntSignal> = HEIGHTS[..cells]
        .iter()
        .map(|name| r.height_input(name, bounded.words.height_bits, shape.height_stage()))
        .collect();

    let lines = bounded.line_levels();
    let [line, i, j, column, row] = integers[..5] else {
        unreachable!("the integers of a walk");
    };
    let mut kept = [line; MOST_BOUNDED_LINES];
    kept[..lines].copy_from_slice(&integers[5..5 + lines]);
    let walk = BoundedWalk {
        line,
        i,
        j,
        from_own_line: bits[0],
        column,
        row,
        kept,
        leaves_u: bits[1],
        leaves_back: bits[2],
        resumes: bits[3],
        // Not read where they are not counted.
        steps: *integers.get(5 + lines).unwrap_or(&line),
        crossings: *integers.get(6 + lines).unwrap_or(&line),
        // A walk in the loop has ended by neither; a trip does not read them.
        hit: fresh,
        guard: fresh,
        depth: line,
    };
    let ray = BoundedRay {
        fixed: FixedRayRegisters {
            // Only the leaf check reads these.
            u: t_delta_u,
            v: t_delta_v,
            slope_u: t_delta_u,
            slope_v: t_delta_v,
            mirror_u,
            mirror_v,
        },
        t_delta_u,
        t_delta_v,
        start_line,
    };
    let trip = exact_trip(
        r,
        (bounded, shape.counters),
        &ray,
        &walk,
        (t_base_u, t_base_v),
        (fresh, missed),
        &heights,
    );
    r.early_output("line_address", trip.address);
    let after = &trip.walk;
    r.output("line", after.line);
    r.output("i", after.i);
    r.output("j", after.j);
    r.output("from_own_line", after.from_own_line);
    r.output("column", after.column);
    r.output("row", after.row);
    for (name, &mask) in rtl_model::machine::KEPT_NAMES
        .iter()
        .zip(&after.kept[..lines])
    {
        r.output(*name, mask);
    }
    r.output("leaves_u", after.leaves_u);
    r.output("leaves_back", after.leaves_back);
    r.output("resumes", after.resumes);
    if shape.counters {
        r.output("steps", after.steps);
        r.output("crossings", after.crossings);
        r.output("guard", after.guard);
    }
    r.output("depth", after.depth);
    r.output("corner_is_known", trip.corner.is_known);
    r.output("v_is_later", trip.corner.v_is_later);
    r.output("ends", trip.ends);
    r.output("near_line", line);
    r.output("t_near_u", trip.t_near.0);
    r.output("t_near_v", trip.t_near.1);
    r.output("writes", trip.writes);
    recorder.finish()
}

/// The module `exact_trip`, in as many stages as the shape says.
pub fn build_exact_trip(shape: &ExactMachineShape) -> BuiltDatapath {
    const LATENCIES: OperatorLatencies = OperatorLatencies::PAPER;
    let recording = record(shape);
    let stages = shape.effort.stages;
    let schedule = schedule_in_stages(&recording, &LATENCIES, stages);
    let bounded = shape.bounded;
    let description = [
        format!(
            "A trip of a walk by bounds through lines of {side} x {side} nodes over a {size} x \
             {size} map of {bits} bit heights.",
            side = bounded.lines().side(),
            size = bounded.lines().size(),
            bits = bounded.words.height_bits
        ),
        "Where the line has missed the cache, the walk comes out as it went in.".to_owned(),
        format!(
            "A ray's constants, bounds and fresh_i are read {READ_STAGE} cycles after a walk's registers, \
             heights and missed_i {} after them.",
            shape.height_stage()
        ),
        "golden: rtl_model::machine::exact_trip".to_owned(),
    ];
    build(&recording, &schedule, &LATENCIES, EXACT_TRIP, &description)
}
