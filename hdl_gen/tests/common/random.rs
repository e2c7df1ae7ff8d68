//! Random designs: a recipe is a list of numbers that proptest can shrink, and any recipe builds.

use std::sync::Arc;

use hdl_gen::emit::verilog;
use hdl_gen::netlist::{Builder, Module, Wire};
use proptest::prelude::*;

/// One step of a recipe: what to build, from which of the wires built so far.
#[derive(Clone, Debug)]
pub struct Step {
    kind: u8,
    picks: [u16; 3],
    number: u64,
}

/// A recipe for a module: input widths and steps.
#[derive(Clone, Debug)]
pub struct Recipe {
    inputs: Vec<u32>,
    steps: Vec<Step>,
    outputs: Vec<u16>,
}

fn step() -> impl Strategy<Value = Step> {
    (0u8..30, any::<[u16; 3]>(), any::<u64>()).prop_map(|(kind, picks, number)| Step {
        kind,
        picks,
        number,
    })
}

fn recipe(steps: usize) -> impl Strategy<Value = Recipe> {
    let width = prop_oneof![Just(1u32), 1u32..9, 1u32..65];
    (
        prop::collection::vec(width, 1..5),
        prop::collection::vec(step(), 1..steps),
        prop::collection::vec(any::<u16>(), 1..6),
    )
        .prop_map(|(inputs, steps, outputs)| Recipe {
            inputs,
            steps,
            outputs,
        })
}

/// A random design, shown in failures by its Verilog.
#[derive(Clone)]
pub struct Design(pub Arc<Module>);

impl std::fmt::Debug for Design {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let modules = self.0.hierarchy();
        modules
            .iter()
            .try_for_each(|module| write!(f, "\n{}", verilog(module, "TEST")))
    }
}

/// A design of up to three levels; module names begin with `prefix`.
pub fn design(prefix: &'static str) -> impl Strategy<Value = Design> {
    (recipe(12), recipe(25), recipe(70)).prop_map(move |(leaf, middle, top)| {
        let leaf = build(&format!("{prefix}_leaf"), &leaf, &[]);
        let middle = build(
            &format!("{prefix}_middle"),
            &middle,
            std::slice::from_ref(&leaf),
        );
        Design(build(&format!("{prefix}_top"), &top, &[leaf, middle]))
    })
}

/// The word cut, or extended by zeros, to a width.
fn fit(b: &mut Builder, word: Wire, width: u32) -> Wire {
    if b.width(word) > width {
        b.slice(word, width - 1, 0)
    } else {
        b.zero_extend(word, width)
    }
}

fn build(name: &str, recipe: &Recipe, library: &[Arc<Module>]) -> Arc<Module> {
    let mut b = Builder::new(name);
    let mut pool: Vec<Wire> = Vec::new();
    for (index, &width) in recipe.inputs.iter().enumerate() {
        pool.push(b.input(&format!("in{index}_i"), width));
    }
    let mut open: Vec<(Wire, u16)> = Vec::new();
    let mut memories = Vec::new();
    for (index, step) in recipe.steps.iter().enumerate() {
        // The later wires more often than the first.
        let pick = |which: usize| {
            let wanted = usize::from(step.picks[which]);
            let near = pool.len().min(12);
            match wanted % 3 {
                0 => pool[(wanted / 3) % pool.len()],
                _ => pool[pool.len() - 1 - (wanted / 3) % near],
            }
        };
        let (x, y, z) = (pick(0), pick(1), pick(2));
        let width = b.width(x);
        let enable = |b: &mut Builder| (step.number & 1 == 1).then(|| b.any_bit(z));
        let reset = (step.number & 2 == 2).then_some(step.number >> 2 & (u64::MAX >> (64 - width)));
        let built = match step.kind {
            0 => b.not(x),
            kind @ (1..=5 | 9..=10) => {
                let y = fit(&mut b, y, width);
                match kind {
                    1 => b.and(x, y),
                    2 => b.or(x, y),
                    3 => b.xor(x, y),
                    4 => b.add(x, y),
                    5 => b.subtract(x, y),
                    9 => b.equal(x, y),
                    _ => b.less_than(x, y),
                }
            }
            6 => {
                let narrow = |width: u32| width.min(32);
                let x = fit(&mut b, x, narrow(width));
                let other = narrow(b.width(y));
                let y = fit(&mut b, y, other);
                match step.number % 2 {
                    0 => b.multiply(x, y),
                    _ => b.multiply_signed(x, y),
                }
            }
            kind @ 7..=8 => {
                // Verilator takes no amount above 32 bits, should it work out its value.
                let amount = b.width(y).min(32);
                let y = fit(&mut b, y, amount);
                if kind == 7 {
                    b.shift_left(x, y)
                } else {
                    b.shift_right(x, y)
                }
            }
            11 | 12 => {
                let y = fit(&mut b, y, width);
                let select = b.any_bit(z);
                b.mux(select, x, y)
            }
            13 => {
                let words: Vec<Wire> = [x, y, z, x]
                    .into_iter()
                    .take(2 + step.number as usize % 3)
                    .collect();
                let total: u32 = words.iter().map(|&word| b.width(word)).sum();
                if total <= 64 {
                    b.concat(&words)
                } else {
                    b.not(y)
                }
            }
            14..=16 => {
                let low = (step.number % u64::from(width)) as u32;
                let high = low + (step.number >> 32) as u32 % (width - low);
                b.slice(x, high, low)
            }
            17 => b.zero_extend(x, width + (step.number % u64::from(65 - width)) as u32),
            18 => b.sign_extend(x, width + (step.number % u64::from(65 - width)) as u32),
            19 => b.any_bit(x),
            20 => b.all_bits(x),
            21 => {
                let enable = enable(&mut b);
                b.registered(x, enable, reset)
            }
            22 => {
                let enable = enable(&mut b);
                let register = b.register(width, enable, reset);
                open.push((register, step.picks[1]));
                register
            }
            23 | 24 if !library.is_empty() => {
                let module = &library[step.number as usize % library.len()];
                let inputs: Vec<Wire> = module
                    .inputs
                    .iter()
                    .enumerate()
                    .map(|(port, &wire)| fit(&mut b, pick(port % 3), module.width(wire)))
                    .collect();
                let outputs = b.instance(&format!("u{index}"), module, &inputs);
                pool.extend(&outputs);
                outputs[0]
            }
            25 => {
                // Extremes more often than chance would have it.
                let value = match step.number % 4 {
                    0 => 0,
                    1 => u64::MAX,
                    _ => step.number >> 8,
                };
                b.constant(value & (u64::MAX >> (64 - width)), width)
            }
            28 | 29 => {
                // Read at two places at most, written from what is built later.
                let bits = b.width(y).min(1 + step.number as u32 % 5);
                let memory = b.memory(&format!("memory{index}"), 1 << bits, width);
                memories.push((memory, bits, width, step.picks));
                let address = fit(&mut b, y, bits);
                let word = b.memory_read(memory, address);
                if step.kind == 28 {
                    word
                } else {
                    pool.push(word);
                    let word = b.constant(0, bits);
                    let first = b.memory_read(memory, word);
                    let enable = enable(&mut b);
                    b.registered(first, enable, None)
                }
            }
            26 => {
                b.section(format!("part {index}"));
                b.not(x)
            }
            _ => {
                b.name(x, format!("s{index}"));
                continue;
            }
        };
        pool.push(built);
    }
    for (register, wanted) in open {
        let value = pool[usize::from(wanted) % pool.len()];
        let width = b.width(register);
        let value = fit(&mut b, value, width);
        b.connect(register, value);
    }
    for (memory, bits, width, picks) in memories {
        let pick = |which: usize| pool[usize::from(picks[which]) % pool.len()];
        let (enable, address, data) = (pick(0), pick(1), pick(2));
        let enable = b.any_bit(enable);
        let extended = b.width(address).max(bits);
        let address = fit(&mut b, address, extended);
        let address = fit(&mut b, address, bits);
        let data = fit(&mut b, data, width);
        b.memory_write(memory, enable, address, data);
    }
    for (index, &wanted) in recipe.outputs.iter().enumerate() {
        let near = pool.len().min(24);
        b.output(
            &format!("out{index}_o"),
            pool[pool.len() - 1 - usize::from(wanted) % near],
        );
    }
    b.finish()
}
