//! Compares two waveforms: what is asked, and what of either takes part.

use super::annotations::Annotations;
use super::cause::Causes;
use super::comparison::{Comparison, Track};
use super::cycles::CycleNumbers;
use super::error::{Names, SideNames};
use super::pairing::{Side, by_name, only_in, pair_sides, scope_named};
use super::reader::{Header, Reader};
use super::report::{DiffReport, SideReport, WidthMismatch};
use super::signal::Dependency;
use super::{UnitInputs, WaveError};
use crate::netlist::Meaning;
use std::collections::HashMap;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// A VCD to compare: what it is called in messages, and where it is read from.
#[derive(Debug)]
pub struct Waveform<R> {
    /// The file's name.
    pub name: String,
    /// Its content.
    pub input: R,
}

/// What the caller knows of one side.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SideOptions {
    /// The scope, with points, that stands for the whole: what is below it is compared, under
    /// names without it. Where none is given it is found (`TOP`, `testbench`).
    pub scope: Option<String>,
    /// How its cycles are numbered.
    pub cycles: CycleNumbers,
}

/// How two waveforms are compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DiffOptions {
    /// Of the first.
    pub golden: SideOptions,
    /// Of the second.
    pub other: SideOptions,
    /// How signals are meant, by the names they pair by; goes before what the files say.
    pub meanings: Vec<(String, Meaning)>,
    /// How many signals of the first divergence are reported in full.
    pub signals_shown: usize,
    /// Takes x in the first waveform for "need not be compared". A register without reset holds
    /// nothing the model can name until it is first written, and a two-valued simulator shows
    /// some value there.
    pub excuse_golden_unknown: bool,
    /// Takes x in the second waveform for "need not be compared": the same register, in a
    /// simulator that knows x.
    pub excuse_other_unknown: bool,
}

impl Default for DiffOptions {
    /// Scopes found, cycles by time, 20 signals shown, x equal to x alone.
    fn default() -> DiffOptions {
        DiffOptions {
            golden: SideOptions::default(),
            other: SideOptions::default(),
            meanings: Vec::new(),
            signals_shown: 20,
            excuse_golden_unknown: false,
            excuse_other_unknown: false,
        }
    }
}

/// [`diff`] of two files.
///
/// # Errors
/// As [`diff`], or if a file cannot be opened.
pub fn diff_files(
    golden: &Path,
    other: &Path,
    options: &DiffOptions,
) -> Result<DiffReport, WaveError> {
    let open = |path: &Path| {
        let name = path.display().to_string();
        match File::open(path) {
            Ok(file) => Ok(Waveform {
                name,
                input: BufReader::with_capacity(1 << 16, file),
            }),
            Err(source) => Err(WaveError::Read { name, source }),
        }
    };
    diff(open(golden)?, open(other)?, options)
}

/// Compares two waveforms: every signal that both have, in every cycle that both have and in which
/// neither is in reset, by the values settled at the cycle's end.
///
/// Signals pair by hierarchical name; an outer scope that only one side has is stripped. Clocks,
/// resets and decoded shadows are not compared. The outermost `clk_i` tells the cycles and the
/// outermost `rst_ni`, if there is one, the reset. Up to the cycle in which both have left reset
/// nothing is compared, later only what is not in reset on both sides. A bit that is x or z on one
/// side differs from everything but itself.
///
/// Both files are read once, side by side; memory does not grow with their length.
///
/// # Errors
/// If a file cannot be read or is no whole VCD, has no clock, or if nothing could be compared: no
/// common signals, no common cycles out of reset, no known value.
pub fn diff(
    golden: Waveform<impl BufRead>,
    other: Waveform<impl BufRead>,
    options: &DiffOptions,
) -> Result<DiffReport, WaveError> {
    let golden = Reader::open(&golden.name, golden.input)?;
    let other = Reader::open(&other.name, other.input)?;
    let scope_of = |reader_name: &str, header: &Header, side: &SideOptions| {
        let scope = side.scope.as_deref();
        scope
            .map(|scope| scope_named(reader_name, header, scope))
            .transpose()
    };
    let (golden_side, other_side) = pair_sides(
        &golden.header,
        &other.header,
        scope_of(&golden.name, &golden.header, &options.golden)?,
        scope_of(&other.name, &other.header, &options.other)?,
    );
    let (pairs, width_mismatches) = paired(&golden, &golden_side, &other, &other_side)?;
    let (causes, meanings) = annotated(
        (&golden, &golden_side),
        (&other, &other_side),
        &pairs,
        options,
    )?;
    let golden_report = side_report(&golden, &golden_side, &other_side, &options.golden);
    let other_report = side_report(&other, &other_side, &golden_side, &options.other);

    let golden = Track::new(
        golden,
        &golden_side,
        &pairs,
        |pair| pair.golden,
        &options.golden,
    )?;
    let other = Track::new(
        other,
        &other_side,
        &pairs,
        |pair| pair.other,
        &options.other,
    )?;
    let report = DiffReport {
        schema: DiffReport::SCHEMA,
        agreed: false,
        golden: golden_report,
        other: other_report,
        signals_compared: 0,
        cycles_compared: 0,
        first_cycle_compared: 0,
        last_cycle_compared: 0,
        cycles_in_reset: 0,
        differing_pairs: 0,
        partly_unknown_pairs: 0,
        signals_differing: 0,
        reset_disagreements: 0,
        width_mismatches,
        first_divergence: None,
        notes: Vec::new(),
    };
    Comparison::new(golden, other, pairs, meanings, causes, options, report).run()
}

/// A signal that both have.
#[derive(Debug)]
pub(crate) struct Pair {
    pub name: String,
    /// Bits.
    pub width: u32,
    /// Its place in the golden header's variables.
    pub golden: usize,
    /// Its place in the other header's variables.
    pub other: usize,
}

/// Pairs the signals of both sides by name.
fn paired<G: BufRead, O: BufRead>(
    golden: &Reader<G>,
    golden_side: &Side,
    other: &Reader<O>,
    other_side: &Side,
) -> Result<(Vec<Pair>, Vec<WidthMismatch>), WaveError> {
    let there = by_name(other_side);
    let (mut pairs, mut mismatches) = (Vec::new(), Vec::new());
    for (name, index) in &golden_side.signals {
        let Some(&other_index) = there.get(name.as_str()) else {
            continue;
        };
        let width = golden.header.variables[*index].width;
        let other_width = other.header.variables[other_index].width;
        if width == other_width {
            pairs.push(Pair {
                name: name.clone(),
                width,
                golden: *index,
                other: other_index,
            });
        } else {
            mismatches.push(WidthMismatch {
                signal: name.clone(),
                golden_width: width,
                other_width,
            });
        }
    }
    if pairs.is_empty() && mismatches.is_empty() {
        return Err(WaveError::NoCommonSignals {
            golden: Box::new(side_names(golden, golden_side)),
            other: Box::new(side_names(other, other_side)),
        });
    }
    Ok((pairs, mismatches))
}

fn side_names<R>(reader: &Reader<R>, side: &Side) -> SideNames {
    SideNames {
        name: reader.name.clone(),
        top_scopes: Names(reader.header.top_scopes()),
        signals: side.names(),
    }
}

/// What the options and both headers say of the pairs; the golden header goes before the other.
fn annotated<G: BufRead, O: BufRead>(
    (golden, golden_side): (&Reader<G>, &Side),
    (other, other_side): (&Reader<O>, &Side),
    pairs: &[Pair],
    options: &DiffOptions,
) -> Result<(Causes, Vec<Meaning>), WaveError> {
    let golden_says = Annotations::read(&golden.name, &golden.header.comments)?;
    let other_says = Annotations::read(&other.name, &other.header.comments)?;
    let mut merged = Annotations::default();
    // The later goes before the earlier.
    for (says, side) in [(other_says, other_side), (golden_says, golden_side)] {
        let prefix = side.stripped.iter().map(|scope| format!("{scope}."));
        let prefix: String = prefix.collect();
        let short = |name: String| match name.strip_prefix(&prefix) {
            Some(below) => below.to_owned(),
            None => name,
        };
        let meanings = says.meanings.into_iter();
        merged
            .meanings
            .extend(meanings.map(|(name, m)| (short(name), m)));
        for dependency in says.dependencies {
            let mut inputs = dependency.inputs;
            for input in &mut inputs {
                input.signal = short(std::mem::take(&mut input.signal));
            }
            merged.dependencies.push(Dependency {
                signal: short(dependency.signal),
                inputs,
            });
        }
        merged
            .unit_inputs
            .extend(says.unit_inputs.into_iter().map(|unit| UnitInputs {
                unit: short(unit.unit),
                inputs: unit.inputs.into_iter().map(short).collect(),
            }));
    }
    let mut meanings: HashMap<&str, Meaning> = HashMap::new();
    for (name, meaning) in merged.meanings.iter().chain(&options.meanings) {
        meanings.insert(name, *meaning);
    }
    let of_pair = |pair: &Pair| match meanings.get(pair.name.as_str()) {
        // A format of another width cannot be how these bits are meant.
        Some(Meaning::Float(format)) if format.width() != pair.width => Meaning::Bits,
        Some(Meaning::Fixed(format)) if format.width() != pair.width => Meaning::Bits,
        Some(&meaning) => meaning,
        None => Meaning::Bits,
    };
    let of_pairs = pairs.iter().map(of_pair).collect();
    let names = pairs.iter().enumerate();
    let pair_by_name = names
        .map(|(index, pair)| (pair.name.clone(), index))
        .collect();
    Ok((Causes::new(merged, pair_by_name), of_pairs))
}

fn side_report<R>(
    reader: &Reader<R>,
    side: &Side,
    opposite: &Side,
    options: &SideOptions,
) -> SideReport {
    let only_here = only_in(side, opposite, options.scope.is_some());
    SideReport {
        name: reader.name.clone(),
        stripped_scope: side.stripped.join("."),
        first_cycle: 0,
        last_cycle: 0,
        signals_only_here: only_here.len(),
        examples_only_here: only_here.into_iter().take(5).collect(),
    }
}
