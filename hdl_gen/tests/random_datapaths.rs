//! Random datapaths: a recipe is run by the golden reading and recorded as a netlist, and both
//! must give the same for every operation: in the embedded simulator, and, behind handshakes and
//! after Verilator's lint with all warnings on, under Verilator.

#[path = "common/tools.rs"]
mod tools;

use hdl_gen::datapath::{OperatorLatencies, Recorder, build, schedule};
use hdl_gen::fault::plant;
use hdl_gen::netlist::Module;
use hdl_gen::operators::stream_unit;
use hdl_gen::simulate::Simulator;
use hdl_gen::verify::StreamRun;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use rtl_model::arith::Arith;
use rtl_model::float::{FloatFormat, Rounding};
use rtl_model::machine::StallPattern;
use rtl_model::readings::{FloatReading, Traced};
use std::sync::Arc;

const E7F16: FloatFormat = FloatFormat::E7F16;
const E5F10: FloatFormat = FloatFormat::new(5, 10);
const NUMBERS: [&str; 4] = ["number_a", "number_b", "number_c", "number_d"];
const INTEGERS: [(&str, u32); 3] = [("narrow", 5), ("middle", 12), ("wide", 33)];
const BITS: [&str; 2] = ["bit_a", "bit_b"];
const HEIGHT_BITS: u32 = 8;

/// One operation of a recipe: which, on which of the signals so far, with which literal.
#[derive(Clone, Copy, Debug)]
struct Step {
    kind: u8,
    picks: [u16; 3],
    number: u32,
}

/// Kinds of operations that [`follow`] knows.
const KINDS: u8 = 37;

fn recipe(steps: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Step>> {
    let step = (0..KINDS, any::<[u16; 3]>(), any::<u32>());
    let step = step.prop_map(|(kind, picks, number)| Step {
        kind,
        picks,
        number,
    });
    prop::collection::vec(step, steps)
}

/// The signals made so far; an integer with the bits it may take.
struct Pools<A: Arith> {
    numbers: Vec<A::Num>,
    integers: Vec<(A::Int, u32)>,
    bits: Vec<A::Bit>,
}

/// The latest signals more often than the first.
fn pick<T: Copy>(pool: &[T], wanted: u16) -> T {
    let wanted = usize::from(wanted);
    match wanted % 3 {
        0 => pool[(wanted / 3) % pool.len()],
        _ => pool[pool.len() - 1 - (wanted / 3) % pool.len().min(6)],
    }
}

/// Runs a recipe in any reading; every result joins the pools.
fn follow<A: Arith>(a: &mut A, recipe: &[Step], height: A::Int, pools: &mut Pools<A>) {
    for step in recipe {
        let number = |which: usize| pick(&pools.numbers, step.picks[which]);
        let integer = |which: usize| pick(&pools.integers, step.picks[which]);
        let bit = |which: usize| pick(&pools.bits, step.picks[which]);
        let rounding = Rounding::ALL[step.number as usize % Rounding::ALL.len()];
        let (x, y) = (number(0), number(1));
        let ((m, m_bits), (n, n_bits)) = (integer(0), integer(1));
        let wider = m_bits.max(n_bits);
        let made: (A::Int, u32) = match step.kind {
            kind @ 0..=12 => {
                let result = match kind {
                    0 => a.add(rounding, x, y),
                    1 => a.sub(rounding, x, y),
                    2 => a.mul(rounding, x, y),
                    3 => a.div(rounding, x, y),
                    4 => {
                        let magnitude = a.magnitude(x);
                        a.ulps_up(magnitude, 1 + step.number % 3)
                    }
                    5 => a.exact_below(x),
                    6 => a.negate_if(bit(1), x),
                    7 => a.select(bit(2), x, y),
                    8 => {
                        let value = a.int_wrap(m, 17);
                        let exponent = a.int_wrap(n, 7);
                        a.number_from_integer(rounding, value, exponent)
                    }
                    9 => a.depth_from_height(height, HEIGHT_BITS),
                    // Scaling is among the newest: more often than the others.
                    _ => a.scale(x, (step.number % 161) as i32 - 80),
                };
                pools.numbers.push(result);
                continue;
            }
            kind @ 13..=20 => {
                let result = match kind {
                    13 => a.is_negative(x),
                    14 => a.is_zero(x),
                    15 => a.less_than(x, y),
                    16 => a.less_equal(x, y),
                    17 => a.int_equal(m, n),
                    18 => a.int_less_than(m, n),
                    19 => {
                        let not = a.not(bit(0));
                        a.and(not, bit(1))
                    }
                    _ => a.or(bit(0), bit(1)),
                };
                pools.bits.push(result);
                continue;
            }
            21 | 22 => {
                let bits = 2 + step.number % 30;
                (a.floor(x, bits), bits)
            }
            23 => (a.int_add(m, n), wider + 1),
            24 => (a.int_sub(m, n), wider + 1),
            25 | 26 => (a.int_mul(m, n), m_bits + n_bits),
            27 | 28 => {
                let amount_bits = 1 + step.number % 6;
                let amount = a.int_low_bits(n, amount_bits);
                (a.int_shift_right(m, amount, amount_bits), m_bits)
            }
            29 => {
                let amount = a.int_low_bits(n, 4);
                (a.int_shift_left(m, amount, 4), m_bits + 15)
            }
            30 | 31 => {
                let not_negative = a.int_low_bits(m, m_bits - 1);
                (a.int_bit_length(not_negative), 7)
            }
            32 => (a.int_xor(m, n), wider),
            33 => (a.int_and(m, n), wider),
            34 => (a.int_or(m, n), wider),
            35 => (a.int_complement_if(bit(2), m), m_bits),
            _ => (a.int_select(bit(2), m, n), wider),
        };
        // So that whatever is made of it next stays below 64 bits.
        let made = match made.1 {
            ..=32 => made,
            _ => (a.int_wrap(made.0, 30), 30),
        };
        pools.integers.push(made);
    }
}

/// A recipe as hardware: every signal of its pools is an output.
fn hardware(recipe: &[Step], format: FloatFormat) -> Arc<Module> {
    let mut recorder = Recorder::new(format);
    let mut pools = Pools {
        numbers: NUMBERS.map(|name| recorder.num_input(name, 0)).to_vec(),
        integers: INTEGERS
            .map(|(name, bits)| (recorder.int_input(name, bits, 0), bits.min(32)))
            .to_vec(),
        bits: BITS.map(|name| recorder.bit_input(name, 0)).to_vec(),
    };
    // The widest input is wrapped like any wide result.
    let wide = recorder.int_wrap(pools.integers[2].0, 30);
    pools.integers[2] = (wide, 30);
    let height = recorder.height_input("height", HEIGHT_BITS, 0);
    follow(&mut recorder, recipe, height, &mut pools);
    // Named, so that a fault can be planted there.
    recorder.name_num("last_number", pools.numbers[pools.numbers.len() - 1]);
    recorder.name_int("last_integer", pools.integers[pools.integers.len() - 1].0);
    for (place, &number) in pools.numbers.iter().enumerate() {
        recorder.output(format!("number_{place}"), number);
    }
    for (place, &(integer, _)) in pools.integers.iter().enumerate() {
        recorder.output(format!("integer_{place}"), integer);
    }
    for (place, &bit) in pools.bits.iter().enumerate() {
        recorder.output(format!("bit_{place}"), bit);
    }
    let recording = recorder.finish();
    let latencies = OperatorLatencies::PAPER;
    let schedule = schedule(&recording, &latencies);
    build(&recording, &schedule, &latencies, "random_datapath", &[]).module
}

/// What the golden reading makes of the input words of [`hardware`], in the order of its outputs;
/// the words of integers in 64 bits.
fn golden(recipe: &[Step], format: FloatFormat, inputs: &[u64]) -> Vec<u64> {
    let mut reading = Traced {
        reading: FloatReading(format),
        words: Vec::new(),
    };
    let signed = |word: u64, bits: u32| (word << (64 - bits)) as i64 >> (64 - bits);
    let mut pools = Pools {
        numbers: inputs[..4].to_vec(),
        integers: INTEGERS
            .iter()
            .zip(&inputs[4..])
            .map(|(&(_, bits), &word)| (signed(word, bits), bits.min(32)))
            .collect(),
        bits: inputs[7..9].iter().map(|&word| word != 0).collect(),
    };
    let wide = reading.int_wrap(pools.integers[2].0, 30);
    pools.integers[2] = (wide, 30);
    let height = inputs[9] as i64;
    follow(&mut reading, recipe, height, &mut pools);
    let numbers = pools.numbers.iter().copied();
    let integers = pools.integers.iter().map(|&(integer, _)| integer as u64);
    let bits = pools.bits.iter().map(|&bit| u64::from(bit));
    numbers.chain(integers).chain(bits).collect()
}

/// Input words: all over the formats, and often at their ends.
fn inputs(format: FloatFormat, seed: u64, k: u64) -> Vec<u64> {
    let mut state =
        seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ k.wrapping_mul(0xd134_2543_de82_ef95);
    let mut random = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    };
    let low = |word: u64, bits: u32| word & (u64::MAX >> (64 - bits));
    let mut words = Vec::new();
    for _ in NUMBERS {
        let special = [
            0,
            format.min_normal(),
            format.max_finite(),
            format.infinity(),
            format.quiet_nan(),
            format.one(),
            format.min_normal() - 1,
            low(random(), format.width() - 1),
        ];
        let chosen = special[(random() % 8) as usize];
        let value = match random() % 4 {
            0 => chosen,
            1 => chosen | format.sign_bit(),
            _ => low(random(), format.width()),
        };
        words.push(value);
    }
    for (_, bits) in INTEGERS {
        let value = match random() % 5 {
            0 => 0,
            1 => u64::MAX,
            2 => 1 << (bits - 1),
            _ => random(),
        };
        words.push(low(value, bits));
    }
    words.extend(BITS.map(|_| random() & 1));
    words.push(low(random(), HEIGHT_BITS));
    words
}

fn config(cases: u32) -> Config {
    let mut config = Config {
        failure_persistence: None,
        ..Config::default()
    };
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(5);
    }
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = cases;
    }
    config
}

/// The first difference in so many evaluations under the embedded simulator.
fn difference(module: &Arc<Module>, recipe: &[Step], format: FloatFormat) -> Option<String> {
    let mut simulator = Simulator::new(module).unwrap();
    let clocked = module.latency > 0;
    for k in 0..40 {
        let words = inputs(format, 1, k);
        let ports = module.inputs.iter().filter_map(|&port| {
            let name = module.node(port).name.as_deref()?;
            (name != "enable_i").then_some(name)
        });
        for (name, &word) in ports.zip(&words) {
            simulator.set(name, word).unwrap();
        }
        if clocked {
            simulator.set("enable_i", 1).unwrap();
        }
        simulator.settle();
        for _ in 0..module.latency {
            simulator.clock();
            simulator.settle();
        }
        let expected = golden(recipe, format, &words);
        for ((name, wire), expected) in module.outputs.iter().zip(expected) {
            let mask = u64::MAX >> (64 - module.width(*wire));
            let found = simulator.get(name).unwrap();
            if found != expected & mask {
                let expected = expected & mask;
                return Some(format!("{name}: {found:x} for {expected:x} of {words:x?}"));
            }
        }
    }
    None
}

proptest! {
    #![proptest_config(config(150))]

    #[test]
    fn every_operation_is_the_golden_one(recipe in recipe(1..30), coarse: bool) {
        let format = if coarse { E5F10 } else { E7F16 };
        let module = hardware(&recipe, format);
        let found = difference(&module, &recipe, format);
        prop_assert!(found.is_none(), "{}", found.unwrap());
    }
}

/// Recipes that have operations of all kinds between them.
fn large_recipes() -> Vec<Vec<Step>> {
    let mut runner = TestRunner::new(config(1));
    let all_kinds = |place: usize, step: Step| Step {
        // 37 is prime: every kind once in as many steps, in another order for each recipe.
        kind: (place * (5 + usize::from(step.picks[2] % 7)) % usize::from(KINDS)) as u8,
        ..step
    };
    let recipes: Vec<Vec<Step>> = (0..2)
        .map(|_| {
            let mut steps = recipe(60..80).new_tree(&mut runner).unwrap().current();
            let stride = steps[0].picks[2];
            for (place, step) in steps.iter_mut().enumerate() {
                let picks = [step.picks[0], step.picks[1], stride];
                *step = all_kinds(place, Step { picks, ..*step });
            }
            steps
        })
        .collect();
    for recipe in &recipes {
        for kind in 0..KINDS {
            let is_there = recipe.iter().any(|step| step.kind == kind);
            assert!(is_there, "a recipe has no operation of kind {kind}");
        }
    }
    recipes
}

/// So many vectors under Verilator: compared, and how many values differed.
fn under_verilator(unit: &Arc<Module>, recipe: &[Step], count: u64) -> Option<(u64, u64)> {
    let verilator = tools::verilator()?;
    let ports = unit.outputs.iter();
    let masks: Vec<u64> = ports
        .filter(|(name, _)| !matches!(name.as_str(), "ready_o" | "valid_o"))
        .map(|(_, wire)| u64::MAX >> (64 - unit.width(*wire)))
        .collect();
    let results = |words: &[u64]| {
        let golden = golden(recipe, E7F16, words).into_iter();
        golden.zip(&masks).map(|(word, mask)| word & mask)
    };
    let idle: Vec<u64> = results(&[0; 10]).collect();
    let run = StreamRun {
        unit,
        count,
        vectors: &|k, operands: &mut Vec<u64>, golden: &mut Vec<u64>| {
            operands.extend(inputs(E7F16, 2, k));
            golden.extend(results(operands));
        },
        idle_results: &idle,
        gaps: StallPattern::one_in_eight(3),
        stalls: StallPattern::one_in_eight(7),
    };
    verilator.build(unit, &run.plan(), false).unwrap();
    let comparison = run.verilator(&verilator, None, |_| {}).unwrap();
    Some((comparison.rays, comparison.mismatches))
}

#[test]
fn verilator_agrees_and_its_lint_has_nothing_to_say() {
    for recipe in large_recipes() {
        let unit = stream_unit(&hardware(&recipe, E7F16));
        if tools::has_tool("verilator") {
            assert_eq!(tools::lint(&unit, &[]), "");
        }
        let Some(found) = under_verilator(&unit, &recipe, 5_000) else {
            return;
        };
        assert_eq!(found, (5_000, 0));
    }
}

#[test]
fn a_planted_fault_is_seen() {
    // One operation of each of the newest kinds.
    for kind in [10, 21, 25, 27, 30, 32] {
        let recipe = [Step {
            kind,
            picks: [1, 4, 0],
            number: 84,
        }];
        let module = hardware(&recipe, E7F16);
        assert_eq!(difference(&module, &recipe, E7F16), None);
        let output = match kind {
            10 => "number_4",
            _ => "integer_3",
        };
        let driver = module.output(&format!("{output}_o")).unwrap();
        let name = module.node(driver).name.clone().unwrap();
        let faulty = plant(&module, &name, 0).unwrap();
        assert!(difference(&faulty, &recipe, E7F16).is_some(), "{kind}");
    }
}
