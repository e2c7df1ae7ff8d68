//! How much the comparison costs: cycles per second of the traverse unit under Verilator with every
//! register compared as the golden model computes it, against the bare Verilated model, whose
//! inputs lie ready in memory and whose outputs nobody looks at.

use hdl_gen::units::{TraverseUnit, UnitConfiguration};
use hdl_gen::verify::{
    GoldenRun, HarnessPlan, Verilator, driven_words, run_verilator, traverse_plan,
};
use rtl_model::camera::View;
use rtl_model::float::FloatFormat;
use rtl_model::machine::StallPattern;
use rtl_model::maps::{Channel, MapSource, Pyramid};
use rtl_model::readings::{E7F16, FloatReading, enter};
use rtl_model::scene::{Crossing, Method, Walk, WalkFormat};
use std::error::Error;
use std::fs;
use std::ops::ControlFlow;
use std::process::{Command, Stdio};
use std::time::Instant;

/// Runs of each; the median is quoted.
const RUNS: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let map = MapSource::parse("procedural:rocks:256:1")?.load(Channel::Grey, false)?;
    let pyramid = Pyramid::new(&map);
    let verilator = Verilator::find()?;
    println!("{}; million cycles/s", verilator.version);
    for method in [Method::Oh, Method::MixedSelective] {
        let walk = Walk {
            method,
            format: WalkFormat::Float(FloatFormat::E7F16),
            crossing: Crossing::Index,
        };
        let unit = TraverseUnit::build(UnitConfiguration::of(walk, &pyramid)?);
        measure(&verilator, &unit, &pyramid)?;
    }
    Ok(())
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
        let report: serde_json::Value = serde_json::from_slice(&output.stdout)?;
        let cycles = report["cycles"].as_f64().ok_or("no cycles")?;
        bare_rates.push(cycles / report["seconds"].as_f64().ok_or("no seconds")?);

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
