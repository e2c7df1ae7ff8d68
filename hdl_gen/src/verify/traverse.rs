//! The whole traverse unit under Verilator: every ray, every register, every cycle.

use super::divergence::Comparison;
use super::golden::GoldenRun;
use super::record::{HarnessPlan, MemoryPorts};
use super::verilator::{RecordStream, TraceWindow, Verilator, VerilatorError, run_harness};
use crate::units::TraverseUnit;
use rtl_model::machine::CycleInputs;
use rtl_model::readings::HasFormat;
use std::fmt::Debug;
use std::io;
use std::ops::ControlFlow;

/// The words for the ports driven, in the order of [`TraverseUnit::driven_ports`].
pub fn driven_words(inputs: &CycleInputs) -> [u64; 7] {
    [
        inputs.ray_valid.into(),
        inputs.ray_id.into(),
        inputs.ray.u,
        inputs.ray.v,
        inputs.ray.du,
        inputs.ray.dv,
        inputs.hit_ready.into(),
    ]
}

/// What the harness of a traverse unit drives and compares.
pub fn traverse_plan(unit: &TraverseUnit, run: &GoldenRun<'_>) -> HarnessPlan {
    let driven = unit.driven_ports();
    let driven: Vec<&str> = driven.iter().map(String::as_str).collect();
    HarnessPlan::new(
        &unit.design,
        &driven,
        unit.probes.clone(),
        run.reset_cycles(),
        Some(MemoryPorts {
            words: run.pyramid.memory().len(),
            address: "height_address_o".to_owned(),
            data: unit.height_port(),
        }),
        ("hit_valid_o", "hit_ready_i"),
    )
}

/// Runs the unit under Verilator beside the golden machine. `format` is the unit's, as a type
/// where it is known when this is compiled. `progress` is told now and then how many rays have
/// left.
///
/// # Errors
/// If Verilator cannot build or run the design.
pub fn run_verilator<H: HasFormat + Debug>(
    verilator: &Verilator,
    unit: &TraverseUnit,
    run: &GoldenRun<'_>,
    format: H,
    window: Option<&TraceWindow>,
    mut progress: impl FnMut(u64),
) -> Result<Comparison, VerilatorError> {
    let plan = traverse_plan(unit, run);
    let program = verilator.build(&unit.design, &plan, window.is_some())?;
    let mut guards = 0;
    let mut rays: u64 = 0;
    let stream = |records: &mut RecordStream<'_>| -> io::Result<()> {
        let mut outcome = Ok(());
        run.run(format, |inputs, outputs, words| {
            if let Err(problem) = records.send(&driven_words(inputs), &words.0) {
                outcome = Err(problem);
                return ControlFlow::Break(());
            }
            if outputs.hit_valid && inputs.hit_ready {
                rays += 1;
                guards += u64::from(outputs.hit_guard);
                if rays.is_multiple_of(1024) {
                    progress(rays);
                }
            }
            ControlFlow::Continue(())
        });
        outcome
    };
    let comparison = run_harness(&program, &plan, Some(run.pyramid.memory()), window, stream)?;
    Ok(Comparison {
        guards,
        ..comparison
    })
}
