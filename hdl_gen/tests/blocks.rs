//! The blocks of clocked machines: every declared signal of model and Verilog agrees in every
//! cycle, with random traffic and random stalls; and what is planted in the Verilog is found.

#[path = "common/bench.rs"]
mod bench;
#[path = "common/tools.rs"]
mod tools;

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::process::Command;
use std::sync::Arc;

use hdl_gen::blocks::{declared_probes, fifo, height_cache, read_port};
use hdl_gen::netlist::{Module, Operation};
use hdl_gen::verify::{ClockedRun, ClockedTraffic, Comparison, EachCycle, input_ports};
use rtl_model::machine::{
    AxiMemory, AxiMemoryShape, CacheAnswer, ClockedUnit, Declared, Fifo, FifoShape, HeightCache,
    HeightCacheShape, ReadPort, ReadPortInputs, ReadPortShape, StallPattern,
};

/// A block, its Verilog, and traffic for it.
struct Block {
    design: Arc<Module>,
    declaration: Vec<Declared>,
    result: (&'static str, &'static str),
    traffic: Box<ClockedTraffic<'static>>,
}

impl Block {
    fn run<T>(&self, design: &Arc<Module>, with: impl Fn(&ClockedRun<'_>) -> T) -> T {
        let probes = declared_probes(&self.declaration, &[&self.design.name], 0);
        with(&ClockedRun {
            unit: design,
            probes: &probes,
            driven: input_ports(design),
            reset_cycles: 4,
            result: self.result,
            traffic: &*self.traffic,
        })
    }

    fn embedded(&self, design: &Arc<Module>) -> Comparison {
        self.run(design, |run| run.embedded().unwrap())
    }
}

/// Random words, by a linear congruential generator (Knuth's MMIX).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        self.0 >> 20 ^ self.0 << 44
    }

    /// True in about `of_eight` cases of eight.
    fn chance(&mut self, of_eight: u64) -> bool {
        self.next() & 7 < of_eight
    }
}

/// A cycle of one unit: what is driven and what is observed.
fn cycle(unit: &mut dyn ClockedUnit, driven: &[u64], each: &mut EachCycle<'_>) -> ControlFlow<()> {
    let mut words = Vec::new();
    unit.observe(driven, &mut words);
    each(driven, &words)?;
    unit.clock(driven);
    ControlFlow::Continue(())
}

/// More offered than taken for a while, then the other way round.
fn fifo_block(depth: u32, fields: &[(&str, u32)], cycles: u64) -> Block {
    let shape = FifoShape::new("ray_fifo", depth, fields);
    let widths: Vec<u32> = fields.iter().map(|&(_, width)| width).collect();
    Block {
        design: fifo(&shape),
        declaration: shape.declaration(),
        result: ("out_valid_o", "out_ready_i"),
        traffic: Box::new(move |each| {
            let mut fifo = Fifo::new(shape.clone());
            let mut random = Random(9);
            for number in 0..cycles {
                let much = if number >> 7 & 1 == 0 { 6 } else { 3 };
                let mut driven = vec![u64::from(random.chance(much))];
                for width in &widths {
                    driven.push(random.next() & (u64::MAX >> (64 - width)));
                }
                driven.push(u64::from(random.chance(9 - much)));
                cycle(&mut fifo, &driven, each)?;
            }
            ControlFlow::Continue(())
        }),
    }
}

/// Which of the two that work together is looked at.
#[derive(Clone, Copy, PartialEq)]
enum Which {
    Cache,
    Port,
}

fn cache_shape(answer: CacheAnswer, height_bits: u32, latency: u32) -> HeightCacheShape {
    HeightCacheShape {
        name: "height_cache".to_owned(),
        height_bits,
        line_bits: 9,
        lines: 16,
        pending: 4,
        answer,
        latency,
        counters: true,
    }
}

/// A cache behind a port behind a memory that stalls, and errs at last where the port is looked
/// at.
fn cached(shape: &HeightCacheShape, which: Which, stalls: Option<u16>, cycles: u64) -> Block {
    let shape = shape.clone();
    let port_shape = ReadPortShape {
        id: 5,
        base: 0x4000_0000,
        ..ReadPortShape::new("read_port", shape.line_bits, shape.beats(), 3)
    };
    let (design, declaration, result) = match which {
        Which::Cache => (
            height_cache(&shape),
            shape.declaration(),
            ("answer_valid_o", "hit_o"),
        ),
        Which::Port => (
            read_port(&port_shape),
            port_shape.declaration(),
            ("beat_valid_o", "beat_ready_i"),
        ),
    };
    Block {
        design,
        declaration,
        result,
        traffic: Box::new(move |each| {
            let memory = AxiMemoryShape {
                latency: 7,
                bytes_per_cycle: 8,
                outstanding: 2,
                stalls,
            };
            let mut random = Random(4);
            let words: Vec<u64> = (0..u64::from(shape.beats()) << shape.line_bits)
                .map(|_| random.next())
                .collect();
            let mut memory = AxiMemory::new(memory, words);
            let mut port = ReadPort::new(port_shape.clone());
            let mut cache = HeightCache::new(shape.clone());
            let (mut looked_up, mut missed) = (VecDeque::new(), VecDeque::new());
            let mut receiver = match stalls {
                Some(seed) => StallPattern::one_in_eight(seed ^ 0x1234),
                None => StallPattern::never(),
            };
            for number in 0..cycles {
                let answer = memory.outputs();
                let beat_ready = which == Which::Cache || receiver.next_ready();
                let asked = cache.outputs();
                // At last the memory errs, in a way that the seed tells, and the port must tell.
                let errs = which == Which::Port && number + 50 > cycles;
                let mut inputs = ReadPortInputs {
                    request_valid: asked.fetch_valid,
                    request_line: asked.fetch_line,
                    beat_ready,
                    arready: answer.arready,
                    r: answer.r,
                };
                if errs {
                    match stalls.unwrap_or_default() & 3 {
                        0 => inputs.r.response = 2,
                        1 => inputs.r.id ^= 1,
                        2 => inputs.r.last = !inputs.r.last,
                        _ => inputs.r.response = 1,
                    }
                }
                let outputs = port.outputs(&inputs);
                // What missed is asked for again until it hits, sooner or later.
                if asked.answer_valid {
                    let address = looked_up.pop_front().expect("an answer to a lookup");
                    if !asked.hit {
                        missed.push_back(address);
                    }
                }
                let again = missed.len() >= 12 || random.chance(4);
                let address = match missed.front() {
                    Some(&address) if again => address,
                    _ => {
                        // A few lines that come often, some that share their index, all others.
                        let line = match random.next() & 3 {
                            0 | 1 => random.next() & 7,
                            2 => random.next() & 0x33,
                            _ => random.next() & 0x1ff,
                        };
                        match shape.answer {
                            CacheAnswer::Height => line << 4 | random.next() & 15,
                            CacheAnswer::Line => line,
                        }
                    }
                };
                let looks_up = random.chance(7);
                if looks_up && asked.lookup_ready {
                    looked_up.push_back(address);
                    if missed.front() == Some(&address) {
                        missed.pop_front();
                    }
                }
                let cache_driven = [
                    u64::from(looks_up),
                    address,
                    outputs.request_ready.into(),
                    (outputs.beat_valid && beat_ready).into(),
                    outputs.beat_data,
                ];
                let port_driven = [
                    u64::from(inputs.request_valid),
                    inputs.request_line,
                    beat_ready.into(),
                    inputs.arready.into(),
                    inputs.r.valid.into(),
                    inputs.r.id,
                    inputs.r.data,
                    inputs.r.response,
                    inputs.r.last.into(),
                ];
                let mut nobody = |_: &[u64], _: &[u64]| ControlFlow::Continue(());
                match which {
                    Which::Cache => {
                        cycle(&mut cache, &cache_driven, each)?;
                        let _ = cycle(&mut port, &port_driven, &mut nobody);
                    }
                    Which::Port => {
                        cycle(&mut port, &port_driven, each)?;
                        let _ = cycle(&mut cache, &cache_driven, &mut nobody);
                    }
                }
                let mut ar = outputs.ar;
                ar.address -= 0x4000_0000;
                memory.clock(&ar, outputs.rready);
            }
            ControlFlow::Continue(())
        }),
    }
}

const CYCLES: u64 = 6000;
const ALL: Option<u16> = Some(0xbeef);

/// Blocks of each kind, and results that leave at least.
fn blocks() -> Vec<(Block, u64)> {
    let wide = [
        ("id", 20),
        ("u", 24),
        ("v", 24),
        ("depth", 64),
        ("is_new", 1),
    ];
    let line_8 = cache_shape(CacheAnswer::Line, 8, 1);
    let line_16 = cache_shape(CacheAnswer::Line, 16, 2);
    let height_8 = cache_shape(CacheAnswer::Height, 8, 2);
    let height_16 = HeightCacheShape {
        lines: 8,
        pending: 8,
        counters: false,
        ..cache_shape(CacheAnswer::Height, 16, 1)
    };
    vec![
        (fifo_block(16, &wide, CYCLES), 2000),
        (fifo_block(2, &[("id", 3)], CYCLES), 2000),
        (cached(&line_8, Which::Cache, ALL, CYCLES), 500),
        (cached(&line_8, Which::Cache, None, CYCLES), 500),
        (cached(&line_16, Which::Cache, ALL, CYCLES), 500),
        (cached(&height_8, Which::Cache, ALL, CYCLES), 500),
        (cached(&height_16, Which::Cache, ALL, CYCLES), 100),
        (cached(&line_8, Which::Port, ALL, CYCLES), 1000),
        (cached(&line_16, Which::Port, ALL, CYCLES), 1000),
        (cached(&line_8, Which::Port, None, CYCLES), 1000),
    ]
}

#[test]
fn every_signal_agrees_in_every_cycle() {
    for (block, leaving) in blocks() {
        let found = block.embedded(&block.design);
        assert_eq!(
            found.mismatches, 0,
            "{}: {:?}",
            block.design.name, found.first
        );
        assert_eq!(found.cycles_compared, CYCLES);
        assert!(
            found.rays >= leaving,
            "{}: {}",
            block.design.name,
            found.rays
        );
    }
}

/// A design that differs in one node, where that can be.
fn mutant(design: &Arc<Module>, place: usize) -> Option<Arc<Module>> {
    let operation = match design.nodes[place].operation.clone() {
        Operation::Not(a) => Operation::Or(a, a),
        Operation::And(a, b) => Operation::Or(a, b),
        Operation::Or(a, b) => Operation::And(a, b),
        Operation::Xor(a, b) => Operation::Or(a, b),
        // On one bit they are the same.
        Operation::Add(a, b) if design.nodes[place].width > 1 => Operation::Subtract(a, b),
        Operation::Equal(a, b) => Operation::LessThan(a, b),
        Operation::AnyBit(a) => Operation::AllBits(a),
        Operation::AllBits(a) => Operation::AnyBit(a),
        Operation::Mux {
            select,
            when_one,
            when_zero,
        } => Operation::Mux {
            select,
            when_one: when_zero,
            when_zero: when_one,
        },
        Operation::Register {
            next,
            enable: Some(_),
            reset,
        } => Operation::Register {
            next,
            enable: None,
            reset,
        },
        Operation::Register {
            next,
            enable: None,
            reset: Some(reset),
        } => Operation::Register {
            next,
            enable: None,
            reset: Some(reset ^ 1),
        },
        _ => return None,
    };
    let mut mutant = Module::clone(design);
    mutant.nodes[place].operation = operation;
    Some(Arc::new(mutant))
}

/// No named signal shows these faults by itself: only what it leads to does.
#[test]
fn a_fault_in_any_node_is_found() {
    let height = cache_shape(CacheAnswer::Height, 8, 1);
    let line = cache_shape(CacheAnswer::Line, 16, 2);
    let erring = |kind| cached(&height, Which::Port, Some(0xbee0 + kind), CYCLES);
    for traffics in [
        vec![fifo_block(4, &[("id", 20), ("depth", 64)], CYCLES)],
        vec![cached(&height, Which::Cache, ALL, CYCLES)],
        vec![cached(&line, Which::Cache, ALL, CYCLES)],
        (0..4u16).map(erring).collect(),
    ] {
        let block = &traffics[0];
        let mut planted = 0;
        let mut missed = Vec::new();
        for place in 0..block.design.nodes.len() {
            if let Some(mutant) = mutant(&block.design, place) {
                planted += 1;
                let agrees = |block: &Block| block.embedded(&mutant).mismatches == 0;
                if traffics.iter().all(agrees) {
                    missed.push((place, &block.design.nodes[place]));
                }
            }
        }
        assert!(missed.is_empty(), "{}: {missed:?}", block.design.name);
        assert!(planted > 10, "{planted}");
    }
}

#[test]
fn lint_finds_nothing() {
    if !tools::has_tool("verilator") {
        return;
    }
    for (block, _) in blocks() {
        assert_eq!(tools::lint(&block.design, &[]), "");
    }
}

#[test]
fn verilator_agrees_in_every_cycle_and_finds_a_fault() {
    let Some(verilator) = tools::verilator() else {
        return;
    };
    for (block, leaving) in blocks().into_iter().step_by(3) {
        let name = &block.design.name;
        let run = |design| {
            block.run(design, |run| {
                run.verilator(&verilator, None, |_| ()).unwrap()
            })
        };
        let found = run(&block.design);
        assert_eq!(
            (found.mismatches, found.cycles_compared),
            (0, CYCLES),
            "{name}"
        );
        assert!(found.rays >= leaving, "{name}: {}", found.rays);
    }
    let block = fifo_block(4, &[("id", 20)], CYCLES);
    let is_inverted =
        |place: &usize| matches!(block.design.nodes[*place].operation, Operation::Not(_));
    let place = (0..block.design.nodes.len()).find(is_inverted).unwrap();
    let faulty = mutant(&block.design, place).unwrap();
    let found = block.run(&faulty, |run| {
        run.verilator(&verilator, None, |_| ()).unwrap()
    });
    assert!(found.mismatches > 0);
}

#[test]
fn icarus_agrees_in_every_output() {
    if !tools::has_tool("iverilog") {
        return;
    }
    for (block, _) in blocks() {
        let designs = [block.design.clone()];
        let idle = vec![0; block.design.inputs.len()];
        let mut stimuli = vec![vec![(0, idle)]; 3];
        let _ = (block.traffic)(&mut |driven, _| {
            stimuli.push(vec![(1, driven.to_vec())]);
            match stimuli.len() < 1500 {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        });
        let folder = tempfile::tempdir().unwrap();
        bench::write_bench(folder.path(), &designs, &stimuli, true);
        let design = format!("{}.v", block.design.name);
        tools::run(
            Command::new("iverilog")
                .args(["-g2005", "-Wall", "-Wno-timescale", "-o", "bench.vvp"])
                .args([design.as_str(), "testbench.v"])
                .current_dir(folder.path()),
        );
        let mut bench = Command::new("vvp");
        let text = tools::run(bench.args(["-n", "bench.vvp"]).current_dir(folder.path()));
        let answered: Vec<String> = text.lines().map(str::to_owned).collect();
        assert_eq!(answered, bench::embedded(&designs, &stimuli), "{design}");
    }
}
