//! Look-up tables, carries, multipliers and clock on a Lattice ECP5: Yosys and nextpnr.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::mapped::MappedNetlist;
use super::pads::fitted;
use super::tools::Tools;
use super::{AreaError, Flow, read, write};

/// What a module takes on an ECP5 of 85 thousand look-up tables, speed grade 6.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ecp5 {
    /// Look-up tables of four inputs that are taken: nextpnr's `TRELLIS_COMB`. Those that hold
    /// logic, two for every carry cell, those that lead into and out of carry chains, and one or
    /// two that drive the constants 0 and 1. Distributed memory takes six for 16 words of 4 bits:
    /// three slices of two, as its data sheet says (FPGA-DS-02012, distributed RAM).
    pub lut4_taken: u64,
    /// Of those the ones that hold logic or distributed memory.
    pub lut4: u64,
    /// Of those the ones of distributed memory.
    #[serde(default)]
    pub lut4_memory: u64,
    /// Registers, without the layers around the module.
    pub ff: u64,
    /// Carry cells of two bits, `CCU2C`.
    pub carry: u64,
    /// Multipliers of 18 by 18 bits, `MULT18X18D`.
    pub dsp: u64,
    /// Block RAMs of 18 Kbit, `DP16KD`.
    #[serde(default)]
    pub bram: u64,
    /// The highest clock from register to register, in MHz: the median of the seeds.
    pub fmax_mhz: f64,
    /// The same of every seed, from seed 1 on.
    pub fmax_mhz_of_seeds: Vec<f64>,
}

/// What synthesis alone can tell.
pub(super) struct Synthesised {
    lut4: u64,
    lut4_memory: u64,
    ff: u64,
    carry: u64,
    dsp: u64,
    bram: u64,
}

/// Look-up tables that a `TRELLIS_DPR16X4` takes: four hold the words, and the slice that feeds
/// them what is written can do nothing else.
const LUT4_OF_MEMORY: u64 = 6;
/// Those of them that nextpnr counts as `TRELLIS_COMB`; the rest is a `TRELLIS_RAMW`.
const LUT4_OF_WRITING: u64 = 2;

/// What one placement tells.
pub(super) struct Placed {
    lut4_taken: u64,
    fmax_mhz: f64,
}

/// The netlist that is placed.
const NETLIST: &str = "ecp5.json";

/// A register, where it takes its value and where it gives it.
const REGISTER: (&str, &str, &str) = ("TRELLIS_FF", "DI", "Q");

/// Maps the design to ECP5. With `wide_luts` abc may build functions of up to seven inputs out of
/// pairs of look-up tables and multiplexers, which is Yosys's default; without (`-nowidelut`)
/// logic like ours takes fewer of them. With `no_dsp` products are made of look-up tables.
pub(super) fn synthesise(
    tools: &Tools,
    folder: &Path,
    sources: &str,
    top: &str,
    flow: Flow,
) -> Result<Synthesised, AreaError> {
    let wide = if flow.wide_luts { "" } else { " -nowidelut" };
    let dsp = if flow.no_dsp { " -nodsp" } else { "" };
    let script =
        format!("read_verilog {sources}; synth_ecp5{wide}{dsp} -top {top} -json {NETLIST}");
    tools.yosys.run(folder, &["-q", "-p", &script])?;
    let text = read(&folder.join(NETLIST))?;
    let unreadable = |problem| tools.yosys.unreadable(problem);
    let netlist = MappedNetlist::read(&text, top).map_err(unreadable)?;
    if let Some(text) = fitted(&text, top, REGISTER).map_err(unreadable)? {
        write(&folder.join(NETLIST), &text)?;
    }
    let lut4_memory = LUT4_OF_MEMORY * netlist.count(&["TRELLIS_DPR16X4"]);
    let (kind, data, out) = REGISTER;
    Ok(Synthesised {
        lut4: netlist.count(&["LUT4"]) + lut4_memory,
        lut4_memory,
        ff: netlist.registers_within(kind, data, out),
        carry: netlist.count(&["CCU2C"]),
        dsp: netlist.count(&["MULT18X18D"]),
        bram: netlist.count(&["DP16KD", "PDPW16KD"]),
    })
}

/// Places and routes it. The largest package gives pads enough for every operator; a step of the
/// traverse unit has more ports ([`fitted`]).
pub(super) fn place(tools: &Tools, folder: &Path, seed: u64) -> Result<Placed, AreaError> {
    let (seed, report) = (seed.to_string(), format!("placed_{seed}.json"));
    let mut arguments = vec!["--quiet", "--85k", "--speed", "6", "--package", "CABGA756"];
    arguments.extend(["--json", NETLIST, "--report", &report, "--seed", &seed]);
    arguments.extend(["--timing-allow-fail", "--lpf-allow-unconstrained"]);
    tools.nextpnr.run(folder, &arguments)?;
    let text = read(&folder.join(&report))?;
    placed(&text).map_err(|problem| tools.nextpnr.unreadable(problem))
}

/// Both together.
pub(super) fn summary(synthesised: &Synthesised, placed: &[Placed]) -> Ecp5 {
    let fmax_mhz_of_seeds: Vec<f64> = placed.iter().map(|one| rounded(one.fmax_mhz)).collect();
    Ecp5 {
        lut4_taken: placed
            .iter()
            .map(|one| one.lut4_taken)
            .max()
            .unwrap_or_default(),
        lut4: synthesised.lut4,
        lut4_memory: synthesised.lut4_memory,
        ff: synthesised.ff,
        carry: synthesised.carry,
        dsp: synthesised.dsp,
        bram: synthesised.bram,
        fmax_mhz: median(&fmax_mhz_of_seeds),
        fmax_mhz_of_seeds,
    }
}

/// The middle one, or the mean of the two in the middle; NaN of none.
fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => sorted[n / 2],
        n => rounded((sorted[n / 2 - 1] + sorted[n / 2]) / 2.0),
    }
}

/// To a hundredth: more means nothing.
fn rounded(mhz: f64) -> f64 {
    (mhz * 100.0).round() / 100.0
}

#[derive(Deserialize)]
struct Report {
    fmax: BTreeMap<String, Clock>,
    utilization: BTreeMap<String, Utilization>,
}

#[derive(Deserialize)]
struct Clock {
    achieved: f64,
}

#[derive(Deserialize)]
struct Utilization {
    used: u64,
}

/// Reads nextpnr's report, of a design with one clock.
fn placed(text: &str) -> Result<Placed, String> {
    let report: Report = serde_json::from_str(text).map_err(|problem| problem.to_string())?;
    let comb = report.utilization.get("TRELLIS_COMB");
    let comb = comb.ok_or("no TRELLIS_COMB in its report")?.used;
    let writing = report.utilization.get("TRELLIS_RAMW");
    let lut4_taken = comb + LUT4_OF_WRITING * writing.map_or(0, |cells| cells.used);
    let clocks: Vec<&Clock> = report.fmax.values().collect();
    match clocks[..] {
        [clock] if clock.achieved > 0.0 => Ok(Placed {
            lut4_taken,
            fmax_mhz: clock.achieved,
        }),
        _ => Err(format!(
            "{} clocks in its report, where one is",
            clocks.len()
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REPORT: &str = r#"{"critical_paths": [], "fmax": {"$glbnet$clk": {"achieved": 58.37,
        "constraint": 12}}, "utilization": {"TRELLIS_COMB": {"available": 83640, "used": 449}}}"#;

    #[test]
    fn a_report_is_read_and_a_broken_one_refused() {
        let read = placed(REPORT).unwrap();
        assert_eq!((read.lut4_taken, read.fmax_mhz), (449, 58.37));
        let memory = r#""utilization": {"TRELLIS_RAMW": {"available": 9, "used": 3}, "#;
        let with_memory = REPORT.replacen(r#""utilization": {"#, memory, 1);
        assert_eq!(placed(&with_memory).unwrap().lut4_taken, 455);
        for (old, new) in [
            ("TRELLIS_COMB", "LUT4"),
            (r#""$glbnet$clk""#, r#""x": {"achieved": 1}, "$glbnet$clk""#),
            ("58.37", "0"),
            ("58.37", "\"58.37\""),
            ("449", "-1"),
        ] {
            assert!(placed(&REPORT.replacen(old, new, 1)).is_err(), "{new}");
        }
        for end in 0..REPORT.len() {
            assert!(placed(&REPORT[..end]).is_err(), "{end}");
        }
    }

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(&[58.0, 3.0, 60.0]), 58.0);
        assert_eq!(median(&[58.0]), 58.0);
        assert_eq!(median(&[58.0, 60.0]), 59.0);
        assert!(median(&[]).is_nan());
    }
}
