//! Look-up tables of six inputs on a Xilinx 7 series device: Yosys.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::mapped::MappedNetlist;
use super::tools::Tools;
use super::{AreaError, read};

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
}

const LUTS: [&str; 7] = ["LUT1", "LUT2", "LUT3", "LUT4", "LUT5", "LUT6", "INV"];

/// Maps the design. Shift registers stay registers, or the layers around it would become such.
pub(super) fn synthesise(
    tools: &Tools,
    folder: &Path,
    sources: &str,
    top: &str,
) -> Result<Xilinx, AreaError> {
    let script = format!(
        "read_verilog {sources}; synth_xilinx -family xc7 -flatten -nosrl -noiopad -noclkbuf \
         -top {top}; write_json xilinx.json"
    );
    tools.yosys.run(folder, &["-q", "-p", &script])?;
    let text = read(&folder.join("xilinx.json"))?;
    let netlist =
        MappedNetlist::read(&text, top).map_err(|problem| tools.yosys.unreadable(problem))?;
    Ok(Xilinx {
        lut6: netlist.count(&LUTS),
        carry: netlist.count(&["CARRY4"]),
        dsp: netlist.count(&["DSP48E1"]),
    })
}
