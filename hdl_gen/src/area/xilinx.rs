//! Look-up tables of six inputs on a Xilinx 7 series device: Yosys.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::mapped::MappedNetlist;
use super::tools::Tools;
use super::{AreaError, Flow, read};

/// What a module takes on a Xilinx 7 series device, after synthesis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Xilinx {
    /// Look-up tables of any size: each takes the place of one with six inputs. Inverters count as
    /// such.
    pub lut6: u64,
    /// Carry cells of four bits, `CARRY4`.
    pub carry: u64,
    /// Multipliers of 25 by 18 bits, `DSP48E1`.
    pub dsp: u64,
    /// Of the look-up tables the ones of distributed memory.
    #[serde(default)]
    pub lut6_memory: u64,
    /// Block RAMs of 18 Kbit: a `RAMB36E1` is two.
    #[serde(default)]
    pub bram: u64,
}

const LUTS: [&str; 7] = ["LUT1", "LUT2", "LUT3", "LUT4", "LUT5", "LUT6", "INV"];

/// Cells of distributed memory, and the look-up tables they take (UG474).
const MEMORIES: [(&str, u64); 7] = [
    ("RAM32X1D", 2),
    ("RAM64X1D", 2),
    ("RAM128X1D", 4),
    ("RAM32M", 4),
    ("RAM64M", 4),
    ("RAM32X1S", 1),
    ("RAM64X1S", 1),
];

/// Maps the design. Shift registers stay registers, or the layers around it would become such.
pub(super) fn synthesise(
    tools: &Tools,
    folder: &Path,
    sources: &str,
    top: &str,
    flow: Flow,
) -> Result<Xilinx, AreaError> {
    let dsp = if flow.no_dsp { " -nodsp" } else { "" };
    let script = format!(
        "read_verilog {sources}; synth_xilinx -family xc7 -flatten -nosrl -noiopad -noclkbuf{dsp} \
         -top {top}; write_json xilinx.json"
    );
    tools.yosys.run(folder, &["-q", "-p", &script])?;
    let text = read(&folder.join("xilinx.json"))?;
    let netlist =
        MappedNetlist::read(&text, top).map_err(|problem| tools.yosys.unreadable(problem))?;
    let memories = MEMORIES.map(|(kind, luts)| luts * netlist.count(&[kind]));
    let lut6_memory = memories.iter().sum();
    Ok(Xilinx {
        lut6: netlist.count(&LUTS) + lut6_memory,
        lut6_memory,
        bram: netlist.count(&["RAMB18E1"]) + 2 * netlist.count(&["RAMB36E1"]),
        carry: netlist.count(&["CARRY4"]),
        dsp: netlist.count(&["DSP48E1"]),
    })
}
