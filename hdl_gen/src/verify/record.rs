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
    /// Its bits.
    pub width: u32,
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
    /// Cycles in reset before cycle 0.
    pub reset_cycles: u32,
    /// The synchronous memory beside the design: words, address port, data port.
    pub memory: Option<MemoryPorts>,
    /// The pair of ports that are both 1 when a result leaves.
    pub result: (String, String),
    layout: RecordLayout,
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

/// Bytes in which Verilator holds a signal of so many bits.
fn bytes_of(width: u32) -> usize {
    match width {
        0..=8 => 1,
        9..=16 => 2,
        17..=32 => 4,
        _ => 8,
    }
}

/// The type of such a signal in C++.
fn type_of(width: u32) -> String {
    format!("uint{}_t", 8 * bytes_of(width))
}

fn mask(width: u32) -> u64 {
    u64::MAX >> (64 - width)
}

/// A word of a record: its place among the driven or the golden words, and the bits of it that are
/// sent.
#[derive(Clone, Copy, Debug)]
struct Field {
    word: usize,
    mask: u64,
}

/// The words of a record that have one size.
#[derive(Clone, Debug, Default)]
struct FieldsOfSize {
    driven: Vec<Field>,
    golden: Vec<Field>,
}

/// How a record is packed: every word in the bytes in which Verilator holds a signal of its width,
/// the longest in front, so that each is aligned and compared as it stands.
#[derive(Clone, Debug)]
struct RecordLayout {
    /// Words of 8, 4, 2 and 1 bytes.
    fields: [FieldsOfSize; 4],
    /// Where the word of each driven port stands.
    driven: Vec<usize>,
    /// Where a golden word of so many bits stands.
    golden: BTreeMap<(usize, u32), usize>,
    /// All in all, a multiple of 8.
    bytes: usize,
}

impl RecordLayout {
    fn new(driven: &[DrivenPort], probes: &[Probe]) -> RecordLayout {
        let mut layout = RecordLayout {
            fields: Default::default(),
            driven: vec![0; driven.len()],
            golden: probes
                .iter()
                .map(|probe| ((probe.word, probe.width), 0))
                .collect(),
            bytes: 0,
        };
        for (size, fields) in [8, 4, 2, 1].into_iter().zip(&mut layout.fields) {
            for (word, port) in driven.iter().enumerate() {
                if bytes_of(port.width) == size {
                    let mask = mask(port.width);
                    fields.driven.push(Field { word, mask });
                    layout.driven[word] = layout.bytes;
                    layout.bytes += size;
                }
            }
            for (&(word, width), place) in &mut layout.golden {
                if bytes_of(width) == size {
                    let mask = mask(width);
                    fields.golden.push(Field { word, mask });
                    *place = layout.bytes;
                    layout.bytes += size;
                }
            }
        }
        layout.bytes = layout.bytes.next_multiple_of(8);
        layout
    }

    fn pack(&self, record: &mut [u8], driven: &[u64], golden: &[u64]) {
        let [of_8, of_4, of_2, of_1] = &self.fields;
        let record = of_8.pack::<8>(record, driven, golden);
        let record = of_4.pack::<4>(record, driven, golden);
        let record = of_2.pack::<2>(record, driven, golden);
        of_1.pack::<1>(record, driven, golden);
    }
}

impl FieldsOfSize {
    /// Packs the words to the front of what is left of a record; returns what is left then.
    fn pack<'a, const SIZE: usize>(
        &self,
        record: &'a mut [u8],
        driven: &[u64],
        golden: &[u64],
    ) -> &'a mut [u8] {
        let bytes = SIZE * (self.driven.len() + self.golden.len());
        let (own, rest) = record.split_at_mut(bytes);
        let mut places = own.chunks_exact_mut(SIZE);
        for (fields, words) in [(&self.driven, driven), (&self.golden, golden)] {
            for (field, place) in fields.iter().zip(places.by_ref()) {
                let word = words[field.word] & field.mask;
                place.copy_from_slice(&word.to_le_bytes()[..SIZE]);
            }
        }
        rest
    }
}

impl HarnessPlan {
    /// A plan for a design.
    ///
    /// # Panics
    /// If a driven port is no input of the design.
    pub fn new(
        design: &Module,
        driven: &[&str],
        probes: Vec<Probe>,
        reset_cycles: u32,
        memory: Option<MemoryPorts>,
        result: (&str, &str),
    ) -> HarnessPlan {
        let port = |&name: &&str| {
            let wire = design.input(name).expect("a driven port is an input");
            DrivenPort {
                name: name.to_owned(),
                width: design.width(wire),
            }
        };
        let driven: Vec<DrivenPort> = driven.iter().map(port).collect();
        HarnessPlan {
            top: design.name.clone(),
            layout: RecordLayout::new(&driven, &probes),
            driven,
            probes,
            reset_cycles,
            memory,
            result: (result.0.to_owned(), result.1.to_owned()),
        }
    }

    /// Bytes of a record.
    pub fn record_bytes(&self) -> usize {
        self.layout.bytes
    }

    /// Appends a record to `bytes`: the words of the driven ports, and those golden words of the
    /// cycle that a probe is compared with.
    pub fn append_record(&self, bytes: &mut Vec<u8>, driven: &[u64], golden: &[u64]) {
        debug_assert_eq!(driven.len(), self.driven.len());
        let start = bytes.len();
        bytes.resize(start + self.layout.bytes, 0);
        self.layout.pack(&mut bytes[start..], driven, golden);
    }

    /// Cycles before the present one whose records are kept: the longest delay.
    fn history(&self) -> usize {
        let delays = self.probes.iter().map(|probe| probe.delay);
        delays.max().unwrap_or(0) as usize
    }

    /// The C++ expression of what a probe must be.
    fn golden(&self, probe: &Probe) -> String {
        format!(
            "before<{}>(record, {}, {})",
            type_of(probe.width),
            probe.delay,
            self.layout.golden[&(probe.word, probe.width)]
        )
    }

    /// The C++ expression of a probe's signal in a Verilated model.
    fn signal(&self, probe: &Probe) -> String {
        if probe.scope.len() == 1 && (probe.name.ends_with("_o") || probe.name.ends_with("_i")) {
            return format!("top.{}", probe.name);
        }
        format!(
            "top.rootp->{}__DOT__{}",
            probe.scope.join("__DOT__"),
            probe.name
        )
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
             #include <cstddef>\n#include <cstdint>\n#include <cstring>\n\
             #include \"V{top}.h\"\n#include \"V{top}___024root.h\"\n\n\
             using Top = V{top};\n"
        );
        let (words, has_memory) = self
            .memory
            .as_ref()
            .map_or((0, false), |memory| (memory.words, true));
        for (kind, name, value) in [
            ("size_t", "kRecordBytes", self.record_bytes()),
            ("size_t", "kHistory", self.history()),
            ("size_t", "kProbes", self.probes.len()),
            ("size_t", "kMemoryWords", words),
            ("int", "kResetCycles", self.reset_cycles as usize),
        ] {
            let _ = writeln!(text, "constexpr {kind} {name} = {value};");
        }
        let _ = writeln!(text, "constexpr bool kHasMemory = {has_memory};\n");
        let _ = writeln!(
            text,
            "// A word of the record of so many cycles before.\n\
             template <class Word>\n\
             inline Word before(const unsigned char* record, size_t cycles, size_t place) {{\n  \
             Word word;\n  \
             std::memcpy(&word, record - cycles * kRecordBytes + place, sizeof word);\n  \
             return word;\n}}\n"
        );
        let _ = writeln!(
            text,
            "inline void drive(Top& top, const unsigned char* record) {{"
        );
        for (place, port) in self.layout.driven.iter().zip(&self.driven) {
            let _ = writeln!(
                text,
                "  top.{} = before<{}>(record, 0, {place});",
                port.name,
                type_of(port.width)
            );
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
            "// Differences are gathered in several words, which do not wait for each other.\n\
             inline bool differs(const Top& top, const unsigned char* record) {{"
        );
        for place in 0..GATHERED {
            let _ = writeln!(text, "  uint64_t difference_{place} = 0;");
        }
        for (place, probe) in self.probes.iter().enumerate() {
            let _ = writeln!(
                text,
                "  difference_{} |= static_cast<uint64_t>({} ^ {});",
                place % GATHERED,
                self.golden(probe),
                self.signal(probe)
            );
        }
        let all: Vec<String> = (0..GATHERED)
            .map(|place| format!("difference_{place}"))
            .collect();
        let _ = writeln!(text, "  return ({}) != 0;\n}}\n", all.join(" | "));
        let _ = writeln!(
            text,
            "inline uint64_t expected_value(const unsigned char* record, size_t probe) {{\n  \
             switch (probe) {{"
        );
        for (place, probe) in self.probes.iter().enumerate() {
            let _ = writeln!(text, "    case {place}: return {};", self.golden(probe));
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

/// Words in which a comparison gathers differences.
const GATHERED: usize = 4;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::netlist::Meaning;

    fn probe(word: usize, width: u32, delay: u32) -> Probe {
        Probe {
            scope: vec!["unit".to_owned()],
            name: format!("word_{word}_of_{width}"),
            width,
            meaning: Meaning::Bits,
            word,
            delay,
            sources: Vec::new(),
        }
    }

    #[test]
    fn a_record_holds_each_word_in_the_bytes_of_its_signal() {
        let port = |name: &str, width| DrivenPort {
            name: name.to_owned(),
            width,
        };
        let driven = [port("valid_i", 1), port("id_i", 20)];
        // Two registers of one value send it once; a narrower view of it is a word of its own.
        let probes = [
            probe(1, 33, 0),
            probe(0, 1, 1),
            probe(2, 12, 0),
            probe(2, 12, 5),
            probe(2, 8, 2),
        ];
        let layout = RecordLayout::new(&driven, &probes);
        assert_eq!(layout.bytes, 24);
        let mut record = vec![0; layout.bytes];
        let golden = [1, 0xffff_fff6_5432_1098, 0xffff_ffff_ffff_fedc];
        layout.pack(&mut record, &[1, 0xabcde], &golden);
        let word = |place: usize, bytes: usize| {
            let bytes = record[place..place + bytes].iter().rev();
            bytes.fold(0_u64, |word, &byte| word << 8 | u64::from(byte))
        };
        assert_eq!(word(layout.golden[&(1, 33)], 8), 0x0_5432_1098);
        assert_eq!(word(layout.driven[1], 4), 0xabcde);
        assert_eq!(word(layout.golden[&(2, 12)], 2), 0xedc);
        assert_eq!(word(layout.driven[0], 1), 1);
        assert_eq!(word(layout.golden[&(0, 1)], 1), 1);
        assert_eq!(word(layout.golden[&(2, 8)], 1), 0xdc);
        // Aligned, with nothing over another, and nothing but zeros behind them.
        assert_eq!(layout.golden[&(1, 33)], 0);
        assert_eq!(layout.driven, [14, 8]);
        assert!(record[17..].iter().all(|&byte| byte == 0));
    }
}
