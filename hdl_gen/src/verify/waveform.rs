//! The golden machine's waveform: what the unit's signals must show, without any simulator.

use super::dependencies::traverse_dependencies;
use super::golden::{GoldenRun, History};
use crate::netlist::Meaning;
use crate::units::{CycleWords, Probe, TraverseUnit};
use crate::wave::{LogicWord, SignalDeclaration, WaveError, Writer, WriterOptions};
use rtl_model::machine::{CycleInputs, ID_BITS};
use std::io::Write;
use std::ops::{ControlFlow, RangeInclusive};

/// The signals of a golden waveform: the unit's probes, in their order, then its input ports.
pub fn traverse_declarations(unit: &TraverseUnit) -> Vec<SignalDeclaration> {
    let probes = unit.probes.iter().map(|probe| SignalDeclaration {
        path: probe.scope.clone(),
        name: probe.name.clone(),
        width: probe.width,
        meaning: probe.meaning,
    });
    let float = Meaning::Float(unit.configuration.format);
    let number_bits = unit.configuration.format.width();
    let inputs = [
        ("ray_valid_i", 1, Meaning::Bits),
        ("ray_id_i", ID_BITS, Meaning::Bits),
        ("ray_u_i", number_bits, float),
        ("ray_v_i", number_bits, float),
        ("ray_du_i", number_bits, float),
        ("ray_dv_i", number_bits, float),
        ("hit_ready_i", 1, Meaning::Bits),
        (
            "height_i",
            unit.configuration.shape.height_bits,
            Meaning::Bits,
        ),
    ];
    let inputs = inputs.map(|(name, width, meaning)| SignalDeclaration {
        path: vec![unit.design.name.clone()],
        name: name.to_owned(),
        width,
        meaning,
    });
    probes.chain(inputs).collect()
}

/// Writes the waveform of a golden run, from the first to the last cycle of `window` as far as the
/// run has them: every signal the golden model knows, under the names and in the hierarchy of the
/// Verilog, with the values of floats and signed integers beside their bits, and what each signal
/// is computed from in comments. Returns the output and the cycles written.
///
/// # Errors
/// If the window holds no cycle of the run, or the output cannot be written.
pub fn golden_waveform<W: Write>(
    unit: &TraverseUnit,
    run: &GoldenRun<'_>,
    window: RangeInclusive<u64>,
    output: W,
) -> Result<(W, u64), WaveError> {
    let declarations = traverse_declarations(unit);
    let options = WriterOptions {
        first_cycle: *window.start(),
        shadows: true,
        dependencies: traverse_dependencies(unit, &declarations),
        ..WriterOptions::default()
    };
    let mut writer = Writer::new(output, &declarations, &options)?;
    let memory = run.pyramid.memory();
    let is_address = |probe: &&Probe| probe.name == "height_address_o";
    let address = unit.probes.iter().find(is_address);
    let address_of = |words: &CycleWords| {
        let probe = address.expect("the unit has a memory");
        (words.0[probe.word] & probe.mask()) as usize
    };
    let mut history = History::new(unit.latency);
    let mut values = Vec::with_capacity(declarations.len());
    let mut height: Option<u64> = None;
    let mut cycle = 0;
    let mut written = 0;
    let mut problem = None;
    run.run(unit.configuration.format, |inputs, _, words| {
        history.push(words);
        let next_height = u64::from(memory[address_of(words)]);
        if window.contains(&cycle) {
            values.clear();
            let probes = unit.probes.iter();
            values.extend(probes.map(|probe| LogicWord::known(history.expected(probe))));
            // Before cycle 0 the address was that of the idle ray, as it is in it.
            let height = height.unwrap_or(next_height);
            values.extend(input_words(inputs, height).map(LogicWord::known));
            if let Err(error) = writer.cycle(1, &values) {
                problem = Some(error);
                return ControlFlow::Break(());
            }
            written += 1;
        }
        height = Some(next_height);
        cycle += 1;
        if cycle > *window.end() {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    });
    if let Some(problem) = problem {
        return Err(problem);
    }
    if written == 0 {
        return Err(WaveError::CycleNumber {
            cycle: *window.start(),
            reason: format!("the run has {cycle} cycles, counted from 0"),
        });
    }
    Ok((writer.finish()?, written))
}

/// The words of the input ports, in the order of their declarations.
fn input_words(inputs: &CycleInputs<u64>, height: u64) -> impl Iterator<Item = u64> {
    [
        inputs.ray_valid.into(),
        inputs.ray_id.into(),
        inputs.ray.u,
        inputs.ray.v,
        inputs.ray.du,
        inputs.ray.dv,
        inputs.hit_ready.into(),
        height,
    ]
    .into_iter()
}
