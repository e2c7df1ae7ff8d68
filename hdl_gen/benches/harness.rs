//! How much the comparison costs: cycles per second of the traverse unit, and of whole machines,
//! under Verilator with every register compared as the golden model computes it, against the bare
//! Verilated model, whose inputs lie ready in memory and whose outputs nobody looks at.
//!
//! `cargo bench -p hdl_gen --bench harness -- paper` measures the machine of the 2013 paper alone.

use hdl_gen::units::{PaperLoop, PaperUnit, TraverseUnit, UnitConfiguration, paper_stages};
use hdl_gen::verify::{
    ClockedRun, GoldenRun, HarnessPlan, PaperDesign, Verilator, driven_words, run_verilator,
    traverse_plan,
};
use rtl_model::camera::View;
use rtl_model::float::FloatFormat;
use rtl_model::machine::{AxiMemoryShape, PaperRun, PaperShape, StallPattern};
use rtl_model::maps::{Channel, MapSource, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::readings::{E7F16, FloatReading, enter};
use rtl_model::scene::{
    Crossing, Machine, MachineKind, MachineLatencies, Method, Walk, WalkFormat, fifo_that_fills,
};
use rtl_model::units::paper_step::{HeightLayout, PaperStep};
use rtl_model::units::traverse::shape_for;
use std::error::Error;
use std::fs;
use std::ops::ControlFlow;
use std::process::{Command, Stdio};
use std::time::Instant;

/// Runs of each; the median is quoted.
const RUNS: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let words = wanted.iter().filter(|word| !word.starts_with("--"));
    let words: Vec<&str> = words.map(String::as_str).collect();
    let is_wanted = |name: &str| words.is_empty() || words.iter().any(|word| name.contains(word));
    let map = MapSource::parse("procedural:rocks:256:1")?.load(Channel::Grey, false)?;
    let pyramid = Pyramid::new(&map);
    let verilator = Verilator::find()?;
    println!("{}; million cycles/s", verilator.version);
    for method in [Method::Oh, Method::MixedSelective] {
        if !is_wanted(&method.to_string()) {
            continue;
        }
        let walk = Walk {
            method,
            format: WalkFormat::Float(FloatFormat::E7F16),
            crossing: Crossing::Index,
        };
        let unit = TraverseUnit::build(UnitConfiguration::of(walk, &pyramid)?);
        measure(&verilator, &unit, &pyramid)?;
    }
    for (name, latencies) in [
        ("paper", MachineLatencies::PAPER),
        (
            "paper-60mhz",
            MachineLatencies {
                multiplier: 2,
                divider: 5,
                conversion: 2,
                ..MachineLatencies::PAPER
            },
        ),
    ] {
        if is_wanted(name) {
            measure_paper_machine(&verilator, name, latencies, &pyramid)?;
        }
    }
    Ok(())
}

/// The frame's rays from the oblique camera, in tiles of 16 x 16 pixels.
fn frame_rays(pyramid: &Pyramid) -> Result<Vec<Ray<u64>>, Box<dyn Error>> {
    const WIDTH: usize = 320;
    let surface = rtl_model::calibration::SURFACES[0].surface;
    let view = View::new(
        &rtl_model::calibration::OBLIQUE,
        &surface,
        WIDTH as u32,
        240,
    );
    let rays = view.rays(pyramid.size())?;
    let mut places: Vec<usize> = (0..rays.len()).collect();
    places.sort_by_key(|place| (place / WIDTH / 16, place % WIDTH / 16, *place));
    let mut reading = FloatReading(E7F16);
    let chosen = places.into_iter().filter_map(|place| rays[place]);
    Ok(chosen.map(|ray| enter(&mut reading, ray)).collect())
}

fn measure_paper_machine(
    verilator: &Verilator,
    name: &str,
    latencies: MachineLatencies,
    pyramid: &Pyramid,
) -> Result<(), Box<dyn Error>> {
    let rays = frame_rays(pyramid)?;
    let step = PaperStep {
        shape: shape_for(pyramid),
        layout: HeightLayout::Tiles,
    };
    let latencies = latencies.into();
    let mut machine = Machine::of_kind(MachineKind::Paper);
    machine.cache.lines = 1024;
    machine.counters = true;
    let stages = paper_stages(&step, FloatFormat::E7F16, &latencies, 3);
    machine.fifo = Some(fifo_that_fills(stages));
    let shape = PaperShape::new(step, 24, &machine);
    let unit = PaperUnit::build(&PaperLoop::build(&shape, FloatFormat::E7F16, &latencies));
    let run = PaperRun {
        shape,
        pyramid,
        rays: &rays,
        gaps: StallPattern::never(),
        stalls: StallPattern::never(),
        memory: AxiMemoryShape {
            latency: 20,
            bytes_per_cycle: 8,
            outstanding: machine.cache.pending,
            stalls: None,
        },
        pass_cycles: unit.paper.step.latency,
    };
    PaperDesign::of_unit(&unit).compare(&run, E7F16, |run| measure_clocked(verilator, name, run))
}

/// Measures any clocked unit.
fn measure_clocked(
    verilator: &Verilator,
    name: &str,
    run: &ClockedRun<'_>,
) -> Result<(), Box<dyn Error>> {
    let full = run.plan();
    let bare = HarnessPlan::new(
        run.unit,
        &run.driven,
        Vec::new(),
        run.reset_cycles,
        None,
        run.result,
    );
    let program = verilator.build(run.unit, &bare, false)?;
    verilator.build(run.unit, &full, false)?;
    let folder = tempfile::tempdir()?;
    let records = folder.path().join("records");
    let mut bytes = Vec::new();
    let _ = (run.traffic)(&mut |driven, words| {
        bare.append_record(&mut bytes, driven, words);
        ControlFlow::Continue(())
    });
    fs::write(&records, &bytes)?;
    let (mut bare_rates, mut golden_rates, mut compared_rates) = (vec![], vec![], vec![]);
    let mut cycles = 0_u64;
    for _ in 0..RUNS {
        let output = Command::new(&program)
            .args(["-", "--preload"])
            .stdin(Stdio::from(fs::File::open(&records)?))
            .output()?;
        bare_rates.push(reported_rate(&output.stdout)?);

        let start = Instant::now();
        cycles = 0;
        let _ = (run.traffic)(&mut |_, _| {
            cycles += 1;
            ControlFlow::Continue(())
        });
        golden_rates.push(cycles as f64 / start.elapsed().as_secs_f64());

        let start = Instant::now();
        let comparison = run.verilator(verilator, None, |_| {})?;
        assert_eq!(comparison.mismatches, 0);
        assert_eq!(comparison.cycles, cycles);
        compared_rates.push(comparison.cycles as f64 / start.elapsed().as_secs_f64());
    }
    let [bare_rate, golden_rate, compared_rate] =
        [bare_rates, golden_rates, compared_rates].map(|mut rates| median(&mut rates));
    println!(
        "{name:15} bare {:5.2}, golden machine alone {:5.2}, compared in every cycle {:5.2}: ratio \
         {:4.2}; {} signals, {} bytes a cycle, {cycles} cycles",
        bare_rate / 1e6,
        golden_rate / 1e6,
        compared_rate / 1e6,
        compared_rate / bare_rate,
        run.probes.len(),
        full.record_bytes(),
    );
    Ok(())
}

/// Cycles a second, as a harness reports them.
fn reported_rate(report: &[u8]) -> Result<f64, Box<dyn Error>> {
    let report: serde_json::Value = serde_json::from_slice(report)?;
    let cycles = report["cycles"].as_f64().ok_or("no cycles")?;
    Ok(cycles / report["seconds"].as_f64().ok_or("no seconds")?)
}

fn measure(
    verilator: &Verilator,
    unit: &TraverseUnit,
    pyramid: &Pyramid,
) -> Result<(), Box<dyn Error>> {
    let surface = rtl_model::calibration::SURFACES[0].surface;
    let view = View::new(&rtl_model::calibration::OBLIQUE, &surface, 320, 240);
    let mut reading = FloatReading(E7F16);
    let rays = view.rays(pyramid.size())?.into_iter().flatten();
    let rays: Vec<_> = rays.map(|ray| enter(&mut reading, ray)).collect();
    let run = GoldenRun {
        pyramid,
        rays: &rays,
        stalls: StallPattern::one_in_eight(1),
        step: unit.configuration.step,
        latency: unit.latency,
    };

    // The bare model: no signal made readable, nothing compared.
    let full = traverse_plan(unit, &run);
    let driven: Vec<&str> = full.driven.iter().map(|port| port.name.as_str()).collect();
    let bare = HarnessPlan::new(
        &unit.design,
        &driven,
        Vec::new(),
        run.reset_cycles(),
        full.memory.clone(),
        ("hit_valid_o", "hit_ready_i"),
    );
    let program = verilator.build(&unit.design, &bare, false)?;
    verilator.build(&unit.design, &full, false)?;
    let folder = tempfile::tempdir()?;
    let heights = folder.path().join("heights");
    let words = pyramid.memory().iter().flat_map(|word| word.to_le_bytes());
    fs::write(&heights, words.collect::<Vec<u8>>())?;
    let records = folder.path().join("records");
    let mut bytes = Vec::new();
    run.run(E7F16, |inputs, _, words| {
        bare.append_record(&mut bytes, &driven_words(inputs), &words.0);
        ControlFlow::Continue(())
    });
    fs::write(&records, &bytes)?;

    let (mut bare_rates, mut golden_rates, mut compared_rates) = (vec![], vec![], vec![]);
    for _ in 0..RUNS {
        let output = Command::new(&program)
            .arg(&heights)
            .arg("--preload")
            .stdin(Stdio::from(fs::File::open(&records)?))
            .output()?;
        bare_rates.push(reported_rate(&output.stdout)?);

        let start = Instant::now();
        let cycles = run.run(E7F16, |_, _, _| ControlFlow::Continue(()));
        golden_rates.push(cycles as f64 / start.elapsed().as_secs_f64());

        let start = Instant::now();
        let comparison = run_verilator(verilator, unit, &run, E7F16, None, |_| {})?;
        assert_eq!(comparison.mismatches, 0);
        assert_eq!(comparison.cycles, cycles);
        compared_rates.push(comparison.cycles as f64 / start.elapsed().as_secs_f64());
    }
    let bare_rate = median(&mut bare_rates);
    let golden_rate = median(&mut golden_rates);
    let compared_rate = median(&mut compared_rates);
    println!(
        "{:15} bare {:5.2}, golden machine alone {:5.2}, compared in every cycle {:5.2}: ratio \
         {:4.2}; {} signals, {} bytes a cycle, {} rays, {} cycles",
        unit.configuration.method,
        bare_rate / 1e6,
        golden_rate / 1e6,
        compared_rate / 1e6,
        compared_rate / bare_rate,
        unit.probes.len(),
        full.record_bytes(),
        rays.len(),
        bytes.len() / bare.record_bytes(),
    );
    Ok(())
}

fn median(rates: &mut [f64]) -> f64 {
    rates.sort_by(f64::total_cmp);
    rates[rates.len() / 2]
}
