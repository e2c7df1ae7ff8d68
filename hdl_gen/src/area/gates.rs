//! Gates in a standard-cell library: Yosys and abc.

use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::liberty::Liberty;
use super::mapped::MappedNetlist;
use super::tools::Tools;
use super::{AreaError, read, write};

/// What a module takes in standard cells, before placement; wires have neither area nor delay.
/// Memories of more than 64 words stand apart: a chip has them as macros of static RAM, whose area
/// no library of gates tells. Smaller ones, such as FIFOs, are registers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gates {
    /// Cells, registers included.
    pub cells: u64,
    /// Their area, in square micrometres.
    pub um2: f64,
    /// The same in thousands of two-input NAND gates.
    pub kge: f64,
    /// The longest path through the logic between registers, in nanoseconds, without the
    /// registers' own.
    pub delay_ns: f64,
    /// Memories that stand apart and are not counted.
    #[serde(default)]
    pub memories_apart: u64,
}

/// What stands for a memory that is not built of gates: a cell that Yosys does not know.
const MEMORY_APART: &str = "memory_apart";

/// What abc does, which is Yosys's own sequence for a library but for the last line: with `-d`
/// abc's timing goes into a file, `stats.txt`, because a Yosys in WebAssembly loses what abc
/// prints.
const ABC: &str = "strash\n&get -n\n&fraig -x\n&put\nscorr\ndc2\ndretime\nstrash\n&get -n\n\
                   &dch -f\n&nf\n&put\nbuffer\nupsize\ndnsize\nstime -d\n";

/// Inputs are driven by an inverter, and an output drives 20 fF: about four gates.
const CONSTRAINTS: &str = "set_driving_cell INVX1\nset_load 20\n";

/// Maps a module, on its own, to the library's cells.
pub(super) fn synthesise(
    tools: &Tools,
    folder: &Path,
    sources: &str,
    top: &str,
) -> Result<Gates, AreaError> {
    let liberty = Liberty::read(&tools.liberty)?;
    // abc runs in this folder and leaves its file here.
    let folder = &folder.join("gates");
    fs::create_dir_all(folder).map_err(|problem| AreaError::Write {
        path: folder.clone(),
        problem,
    })?;
    // A copy, because the tools of the virtual environment do not see all folders.
    write(&folder.join("cells.lib"), &tools.liberty)?;
    write(&folder.join("gates.abc"), ABC)?;
    write(&folder.join("gates.constr"), CONSTRAINTS)?;
    let sources: Vec<String> = sources
        .split(' ')
        .map(|name| format!("../{name}"))
        .collect();
    let script = format!(
        "read_verilog {}; synth -flatten -top {top} -run begin:fine; \
         select -set apart t:$mem_v2 r:SIZE>64 %i; setattr -set keep 1 @apart; \
         chtype -set \\{MEMORY_APART} @apart; synth -run fine:check; dfflibmap -liberty cells.lib; \
         abc -liberty cells.lib -constr gates.constr -script gates.abc -dont_use CLKBUF*; \
         opt_clean -purge; write_json gates.json",
        sources.join(" ")
    );
    tools.yosys.run(folder, &["-q", "-p", &script])?;
    let text = read(&folder.join("gates.json"))?;
    let netlist =
        MappedNetlist::read(&text, top).map_err(|problem| tools.yosys.unreadable(problem))?;
    let memories_apart = netlist.count(&[MEMORY_APART]);
    let mut kinds = netlist.kinds();
    kinds.remove(MEMORY_APART);
    let mut um2 = 0.0;
    for (&kind, &count) in &kinds {
        let area = liberty.area(kind).filter(|_| !kind.contains("LATCH"));
        let area = area.ok_or_else(|| {
            tools.yosys.unreadable(format!(
                "{count} cells {kind} where gates and registers belong"
            ))
        })?;
        um2 += area * count as f64;
    }
    // A module that only moves wires has no gates, and abc then says nothing.
    let delay_ns = match kinds.is_empty() {
        true => 0.0,
        false => delay_ns(&read(&folder.join("stats.txt"))?)
            .map_err(|problem| tools.yosys.unreadable(problem))?,
    };
    Ok(Gates {
        cells: kinds.values().sum(),
        um2,
        kge: (liberty.gate_equivalents(um2)).round() / 1000.0,
        delay_ns,
        memories_apart,
    })
}

/// The delay out of abc's `stats.txt`: name, inputs, outputs, gates, area, delay in picoseconds.
fn delay_ns(stats: &str) -> Result<f64, String> {
    let line = stats.lines().last().unwrap_or_default();
    let words: Vec<&str> = line.split_whitespace().collect();
    match words[..] {
        [_, _, _, _, _, delay] => match delay.parse::<f64>() {
            Ok(delay) if delay.is_finite() && delay >= 0.0 => Ok(delay / 1000.0),
            _ => Err(format!("abc's delay is {delay}")),
        },
        _ => Err(format!("abc's figures are `{line}`")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn abc_tells_the_delay() {
        assert_eq!(delay_ns("netlist 117 68 1408 41150 5040 \n"), Ok(5.04));
        for broken in [
            "",
            "netlist 117 68",
            "netlist 1 2 3 4 x",
            "netlist 1 2 3 4 NaN",
        ] {
            assert!(delay_ns(broken).is_err(), "{broken}");
        }
    }
}
