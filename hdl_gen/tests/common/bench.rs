//! A testbench that plays random stimuli to designs under a Verilog simulator and prints every
//! output in every cycle, and the same played to the embedded simulator.

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use hdl_gen::emit::{verilog, write_design};
use hdl_gen::netlist::Module;
use hdl_gen::simulate::Simulator;

/// Random stimuli: by cycle, by design, the reset and the value of each input.
pub type Stimuli = Vec<Vec<(u64, Vec<u64>)>>;

/// Stimuli from a seed, by the splitmix64 generator (Steele et al., OOPSLA 2014).
#[allow(dead_code)] // not every test program makes them up
pub fn stimuli(designs: &[Arc<Module>], cycles: usize, mut seed: u64) -> Stimuli {
    let mut random = || {
        seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = seed;
        mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ mixed >> 31
    };
    (0..cycles)
        .map(|cycle| {
            let of_design = |design: &Arc<Module>| {
                let reset = u64::from(cycle > 1 && random() % 16 != 0);
                let value = |&wire: &_| {
                    // Small and all-one words more often than chance would have it.
                    let raw = match random() % 8 {
                        0 => random() % 4,
                        1 => u64::MAX,
                        _ => random(),
                    };
                    raw & (u64::MAX >> (64 - design.width(wire)))
                };
                (reset, design.inputs.iter().map(value).collect())
            };
            designs.iter().map(of_design).collect()
        })
        .collect()
}

/// What the embedded simulator answers: one line a cycle, all outputs in hexadecimal.
pub fn embedded(designs: &[Arc<Module>], stimuli: &Stimuli) -> Vec<String> {
    let mut simulators: Vec<Simulator> = designs
        .iter()
        .map(|design| Simulator::new(design).unwrap())
        .collect();
    stimuli
        .iter()
        .map(|cycle| {
            let mut line = String::new();
            for (simulator, (reset, values)) in simulators.iter_mut().zip(cycle) {
                let top = simulator.top().clone();
                if top.has_reset() {
                    simulator.set("rst_ni", *reset).unwrap();
                }
                for (&wire, &value) in top.inputs.iter().zip(values) {
                    let input = simulator
                        .input(top.node(wire).name.as_ref().unwrap())
                        .unwrap();
                    simulator.set_input(input, value);
                }
                for (name, _) in &top.outputs {
                    let _ = write!(line, "{:x} ", simulator.get(name).unwrap());
                }
                simulator.clock();
            }
            line
        })
        .collect()
}

/// Writes the designs and a testbench with its stimuli; `start_at_zero` sets the registers, which
/// an event-driven simulator starts at unknown values.
pub fn write_bench(dir: &Path, designs: &[Arc<Module>], stimuli: &Stimuli, start_at_zero: bool) {
    let mut bench = String::from("module testbench;\n");
    let mut drive = String::new();
    let mut show = String::new();
    let mut zero = String::new();
    let mut bits = 0;
    bench += "    reg clk = 0;\n    integer cycle;\n    integer place;\n";
    for (index, design) in designs.iter().enumerate() {
        write_design(design, dir).unwrap();
        let mut ports = Vec::new();
        let _ = writeln!(bench, "    reg rst{index} = 0;");
        let _ = writeln!(drive, "            rst{index} = word[{bits}];");
        bits += 1;
        if design.is_clocked() {
            ports.push(".clk_i(clk)".to_owned());
        }
        if design.has_reset() {
            ports.push(format!(".rst_ni(rst{index})"));
        }
        for (port, &wire) in design.inputs.iter().enumerate() {
            let width = design.width(wire);
            let _ = writeln!(bench, "    reg [{}:0] in{index}_{port} = 0;", width - 1);
            let _ = writeln!(
                drive,
                "            in{index}_{port} = word[{bits} +: {width}];"
            );
            bits += width;
            let name = design.node(wire).name.as_ref().unwrap();
            ports.push(format!(".{name}(in{index}_{port})"));
        }
        for (port, (name, wire)) in design.outputs.iter().enumerate() {
            let width = design.width(*wire);
            let _ = writeln!(bench, "    wire [{}:0] out{index}_{port};", width - 1);
            let _ = writeln!(show, "            $write(\"%0h \", out{index}_{port});");
            ports.push(format!(".{name}(out{index}_{port})"));
        }
        let _ = writeln!(
            bench,
            "    {} dut{index} ({});",
            design.name,
            ports.join(", ")
        );
        if start_at_zero {
            for (path, words) in registers(design, &format!("dut{index}")) {
                let _ = match words {
                    None => writeln!(zero, "        {path} = 0;"),
                    Some(words) => writeln!(
                        zero,
                        "        for (place = 0; place < {words}; place = place + 1) \
                         {path}[place] = 0;"
                    ),
                };
            }
        }
    }
    let cycles = stimuli.len();
    let _ = write!(
        bench,
        "    reg [{top}:0] word;\n    reg [{top}:0] words [0:{last}];\n    initial begin\n{zero}\
         \x20       $readmemh(\"stimuli.hex\", words);\n\
         \x20       for (cycle = 0; cycle < {cycles}; cycle = cycle + 1) begin\n\
         \x20           word = words[cycle];\n{drive}            #1;\n{show}\
         \x20           $write(\"\\n\");\n            clk = 1;\n            #1;\n            clk = 0;\n\
         \x20       end\n        $finish;\n    end\nendmodule\n",
        top = bits - 1,
        last = cycles - 1,
    );
    std::fs::write(dir.join("testbench.v"), bench).unwrap();
    std::fs::write(dir.join("stimuli.hex"), stimuli_file(designs, stimuli)).unwrap();
}

/// One word a cycle, the first design's reset at the low end.
fn stimuli_file(designs: &[Arc<Module>], stimuli: &Stimuli) -> String {
    let mut text = String::new();
    for cycle in stimuli {
        let mut bits: Vec<u8> = Vec::new();
        for (design, (reset, values)) in designs.iter().zip(cycle) {
            bits.push(*reset as u8);
            for (&wire, value) in design.inputs.iter().zip(values) {
                bits.extend((0..design.width(wire)).map(|bit| (value >> bit & 1) as u8));
            }
        }
        let digits = bits.chunks(4).rev().map(|chunk| {
            let digit = chunk
                .iter()
                .rev()
                .fold(0, |digit, &bit| digit << 1 | u32::from(bit));
            char::from_digit(digit, 16).unwrap()
        });
        text.extend(digits);
        text.push('\n');
    }
    text
}

/// The registers and memories of a design by their path, as the emitted text declares them, with
/// the words of a memory.
fn registers(module: &Module, path: &str) -> Vec<(String, Option<u32>)> {
    let text = verilog(module, "0");
    let declared = text.lines().map(str::trim_start).filter_map(|line| {
        let declares = line.starts_with("reg ") || line.starts_with("output reg ");
        let code = line.split("//").next().unwrap().trim_end();
        let code = code.trim_end_matches([';', ',']);
        let (code, words) = match code.split_once(" [0:") {
            Some((code, last)) => {
                let last: u32 = last.trim_end_matches(']').parse().unwrap();
                (code, Some(last + 1))
            }
            None => (code, None),
        };
        let name = code.split_whitespace().next_back()?;
        declares.then(|| (format!("{path}.{name}"), words))
    });
    let mut paths: Vec<(String, Option<u32>)> = declared.collect();
    for instance in &module.instances {
        let head = format!("{} {} (", instance.module.name, instance.name);
        if text.contains(&head) {
            paths.extend(registers(
                &instance.module,
                &format!("{path}.{}", instance.name),
            ));
        }
    }
    paths
}
