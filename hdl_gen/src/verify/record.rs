//! What the golden model sends to a harness for each cycle, and the C++ that reads it.

use crate::netlist::Module;
use crate::units::Probe;
use std::collections::BTreeMap;
use std::fmt::Write;

/// An input port of the design, driven anew in every cycle.
#[derive(Clone, Debug)]
pub struct DrivenPort {
    /// The port's name.
    pub name: String,
}

/// A design prepared for a harness: what is driven, what is compared, and where each word stands.
#[derive(Clone, Debug)]
pub struct HarnessPlan {
    /// Name of the top module.
    pub top: String,
    /// Ports driven by the first words of a record, in order.
    pub driven: Vec<DrivenPort>,
    /// The signals compared.
    pub probes: Vec<Probe>,
    /// For each golden word that a probe reads: its place in a record, behind the driven ones.
    places: BTreeMap<usize, usize>,
    /// Bits of a word of a record: 32, or 64 where a signal needs them.
    pub word_bits: u32,
    /// Cycles in reset before cycle 0.
    pub reset_cycles: u32,
    /// The synchronous memory beside the design: words, address port, data port.
    pub memory: Option<MemoryPorts>,
    /// The pair of ports that are both 1 when a result leaves.
    pub result: (String, String),
}

/// The ports of a synchronous read-only memory.
#[derive(Clone, Debug)]
pub struct MemoryPorts {
    /// Words it holds.
    pub words: usize,
    /// The design's output.
    pub address: String,
    /// The design's input, one cycle later.
    pub data: String,
}

impl HarnessPlan {
    /// A plan for a design.
    pub fn new(
        design: &Module,
        driven: &[&str],
        probes: Vec<Probe>,
        reset_cycles: u32,
        memory: Option<MemoryPorts>,
        result: (&str, &str),
    ) -> HarnessPlan {
        let mut places = BTreeMap::new();
        for probe in &probes {
            places.entry(probe.word).or_insert(0);
        }
        for (place, (_, entry)) in places.iter_mut().enumerate() {
            *entry = driven.len() + place;
        }
        let widest_port = driven
            .iter()
            .filter_map(|name| design.input(name).map(|wire| design.width(wire)))
            .max();
        let widest = probes.iter().map(|probe| probe.width).max().max(widest_port).unwrap_or(1);
        HarnessPlan {
            top: design.name.clone(),
            driven: driven.iter().map(|&name| DrivenPort { name: name.to_owned() }).collect(),
            probes,
            places,
            word_bits: if widest > 32 { 64 } else { 32 },
            reset_cycles,
            memory,
            result: (result.0.to_owned(), result.1.to_owned()),
        }
    }

    /// Words of a record.
    pub fn record_words(&self) -> usize {
        self.driven.len() + self.places.len()
    }

    /// Appends the bytes of a record: driven words, then the golden ones that are read.
    pub fn append_record(&self, bytes: &mut Vec<u8>, driven: &[u64], golden: &[u64]) {
        debug_assert_eq!(driven.len(), self.driven.len());
        let golden = self.places.keys().map(|&word| golden[word]);
        if self.word_bits == 32 {
            for word in driven.iter().copied().chain(golden) {
                bytes.extend_from_slice(&(word as u32).to_le_bytes());
            }
        } else {
            for word in driven.iter().copied().chain(golden) {
                bytes.extend_from_slice(&word.to_le_bytes());
            }
        }
    }

    /// Cycles whose golden words are kept: a power of two above the longest delay.
    fn ring_cycles(&self) -> usize {
        let longest = self.probes.iter().map(|probe| probe.delay).max().unwrap_or(0);
        (longest as usize + 1).next_power_of_two()
    }

    /// The C++ expression of a probe's signal in a Verilated model.
    fn signal(&self, probe: &Probe) -> String {
        if probe.scope.len() == 1 && (probe.name.ends_with("_o") || probe.name.ends_with("_i")) {
            return format!("top.{}", probe.name);
        }
        format!("top.rootp->{}__DOT__{}", probe.scope.join("__DOT__"), probe.name)
    }

    /// The Verilator configuration that makes the compared signals readable.
    pub fn verilator_configuration(&self, module_of: impl Fn(&[String]) -> String) -> String {
        let mut text = String::from("`verilator_config\n");
        for probe in &self.probes {
            if probe.scope.len() == 1 && probe.name.ends_with("_o") {
                continue;
            }
            let module = module_of(&probe.scope);
            let _ = writeln!(
                text,
                "public_flat_rd -module \"{module}\" -var \"{}\"",
                probe.name
            );
        }
        text
    }

    /// The file `design.h` of the harness for Verilator.
    pub fn design_header(&self) -> String {
        let mut text = String::new();
        let top = &self.top;
        let _ = writeln!(
            text,
            "// Generated for the unit {top}: what harness.cpp needs to know of it.\n\
             #pragma once\n\
             #include <cstddef>\n#include <cstdint>\n\
             #include \"V{top}.h\"\n#include \"V{top}___024root.h\"\n\n\
             using Top = V{top};\n\
             using Word = uint{}_t;\n",
            self.word_bits
        );
        let (words, has_memory) =
            self.memory.as_ref().map_or((0, false), |memory| (memory.words, true));
        for (kind, name, value) in [
            ("size_t", "kRecordWords", self.record_words()),
            ("size_t", "kRingCycles", self.ring_cycles()),
            ("size_t", "kProbes", self.probes.len()),
            ("size_t", "kMemoryWords", words),
            ("int", "kResetCycles", self.reset_cycles as usize),
        ] {
            let _ = writeln!(text, "constexpr {kind} {name} = {value};");
        }
        let _ = writeln!(text, "constexpr bool kHasMemory = {has_memory};\n");
        let _ = writeln!(
            text,
            "// The golden words of the last cycles.\n\
             struct GoldenWords {{\n  const Word* ring;\n  uint64_t cycle;\n  \
             const Word* before(uint64_t cycles) const {{\n    \
             return ring + ((cycle - cycles) % kRingCycles) * kRecordWords;\n  }}\n}};\n"
        );
        let _ = writeln!(text, "inline void drive(Top& top, const Word* record) {{");
        for (place, port) in self.driven.iter().enumerate() {
            let _ = writeln!(text, "  top.{} = record[{place}];", port.name);
        }
        let _ = writeln!(text, "}}\n");
        match &self.memory {
            Some(memory) => {
                let _ = writeln!(
                    text,
                    "inline uint64_t memory_address(const Top& top) {{ return top.{}; }}\n\
                     inline void drive_height(Top& top, uint16_t height) {{ top.{} = height; }}\n",
                    memory.address, memory.data
                );
            }
            None => {
                let _ = writeln!(
                    text,
                    "inline uint64_t memory_address(const Top&) {{ return 0; }}\n\
                     inline void drive_height(Top&, uint16_t) {{}}\n"
                );
            }
        }
        let _ = writeln!(
            text,
            "// Does a result leave in this cycle?\n\
             inline bool result_leaves(const Top& top) {{ return top.{} & top.{}; }}\n",
            self.result.0, self.result.1
        );
        self.comparison(&mut text);
        text
    }

    /// The function that compares all probes without a branch, and the two that look closer.
    fn comparison(&self, text: &mut String) {
        let _ = writeln!(
            text,
            "inline bool differs(const Top& top, const GoldenWords& golden) {{\n  \
             uint64_t difference = 0;"
        );
        let mut delays: Vec<u32> = self.probes.iter().map(|probe| probe.delay).collect();
        delays.sort_unstable();
        delays.dedup();
        for delay in delays {
            let _ = writeln!(text, "  {{\n    const Word* const words = golden.before({delay});");
            for probe in self.probes.iter().filter(|probe| probe.delay == delay) {
                let _ = writeln!(
                    text,
                    "    difference |= (words[{}] & {:#x}ULL) ^ {};",
                    self.places[&probe.word],
                    probe.mask(),
                    self.signal(probe)
                );
            }
            let _ = writeln!(text, "  }}");
        }
        let _ = writeln!(text, "  return difference != 0;\n}}\n");
        let _ = writeln!(
            text,
            "inline uint64_t expected_value(const GoldenWords& golden, size_t probe) {{\n  \
             switch (probe) {{"
        );
        for (place, probe) in self.probes.iter().enumerate() {
            let _ = writeln!(
                text,
                "    case {place}: return golden.before({})[{}] & {:#x}ULL;",
                probe.delay,
                self.places[&probe.word],
                probe.mask()
            );
        }
        let _ = writeln!(text, "    default: return 0;\n  }}\n}}\n");
        let _ = writeln!(
            text,
            "inline uint64_t found_value(const Top& top, size_t probe) {{\n  switch (probe) {{"
        );
        for (place, probe) in self.probes.iter().enumerate() {
            let _ = writeln!(text, "    case {place}: return {};", self.signal(probe));
        }
        let _ = writeln!(text, "    default: return 0;\n  }}\n}}");
    }
}
