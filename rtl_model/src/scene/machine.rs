//! The clocked machine of a scene: which one, and what stands around its loop.

use serde::{Deserialize, Serialize};

/// Which machine walks a scene's rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MachineKind {
    /// The traverse unit of the 2013 hardware paper (section 4): 15 stages, floats, a ray's start
    /// level computed in a pass of its own, a height cache that sends a ray round on a miss.
    Paper,
    /// The exact fixed-point traverse unit: no divider and no multiplier in the loop.
    Exact,
}

impl MachineKind {
    /// Its name in scene files.
    pub const fn name(self) -> &'static str {
        match self {
            MachineKind::Paper => "paper",
            MachineKind::Exact => "exact",
        }
    }
}

/// How much hardware the exact machine has of each kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MachineEffort {
    /// Little area.
    Area,
    /// Few cycles a ray.
    Throughput,
}

/// A machine, as a scene's table `[machine]` has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Which one.
    pub kind: MachineKind,
    /// Entries of FIFO 1 behind the loop, which bound the rays inside: a power of two, 2 to 64.
    /// FIFO 0 before the loop has as many, but at most 16. Unless told, as many as fill the loop
    /// ([`fifo_that_fills`]).
    #[serde(default, deserialize_with = "checked::fifo")]
    pub fifo: Option<u32>,
    /// Of the paper's machine: cycles of its operators; the paper's unless told.
    #[serde(default)]
    pub latencies: Option<MachineLatencies>,
    /// Of the exact machine: how much hardware it has. Unless told, little area where the scene's
    /// method reads 2 x 2 heights, and few cycles where it reads 4 x 4.
    #[serde(default)]
    pub effort: Option<MachineEffort>,
    /// Pixels on a side of the square tiles in which the frame's rays come, tile by tile, each row
    /// by row: a power of two, 1 to 8192. With 1 they come row by row of the frame.
    #[serde(default = "default_tile", deserialize_with = "checked::tile")]
    pub tile: u32,
    /// Counts trips, hits, misses and stalls in hardware. What is counted takes area, so nothing
    /// is unless it is asked for.
    #[serde(default)]
    pub counters: bool,
    /// The height cache.
    #[serde(default)]
    pub cache: MachineCache,
    /// The memory behind it.
    #[serde(default)]
    pub memory: MachineMemory,
}

/// Cycles of the operators of the paper's machine, each 1 to 32; the paper's own where a table
/// leaves one out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct MachineLatencies {
    /// Float adder and subtractor.
    #[serde(deserialize_with = "checked::cycles")]
    pub adder: u32,
    /// Float multiplier.
    #[serde(deserialize_with = "checked::cycles")]
    pub multiplier: u32,
    /// Float divider.
    #[serde(deserialize_with = "checked::cycles")]
    pub divider: u32,
    /// Float comparator.
    #[serde(deserialize_with = "checked::cycles")]
    pub comparator: u32,
    /// Between integers and floats, and from heights to depths.
    #[serde(deserialize_with = "checked::cycles")]
    pub conversion: u32,
}

impl MachineLatencies {
    /// The budget of the 2013 hardware paper (section 4.2): adder and divider two cycles,
    /// multiplier and comparator one; conversions, of which it does not speak, one.
    pub const PAPER: MachineLatencies = MachineLatencies {
        adder: 2,
        multiplier: 1,
        divider: 2,
        comparator: 1,
        conversion: 1,
    };

    /// The most cycles of an operator.
    pub const LONGEST: u32 = 32;
}

impl Default for MachineLatencies {
    fn default() -> Self {
        MachineLatencies::PAPER
    }
}

/// The entries of FIFO 1 that let a loop of so many stages be full, within 2 to 64: one more than
/// the stages, since a hit stands in FIFO 1 for a cycle at least, as a power of two.
pub fn fifo_that_fills(stages: u32) -> u32 {
    (stages + 1).next_power_of_two().clamp(2, 64)
}

/// The height cache of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachineCache {
    /// Lines of 16 heights that it holds: a power of two, 2 to 65536.
    #[serde(default = "default_lines", deserialize_with = "checked::lines")]
    pub lines: u32,
    /// Lines that may be on their way at once: 2, 4 or 8.
    #[serde(default = "default_pending", deserialize_with = "checked::pending")]
    pub pending: u32,
}

/// The memory that a machine's height cache is filled from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachineMemory {
    /// Cycles from an address to its first beat: 1 to 1000.
    #[serde(default = "default_latency", deserialize_with = "checked::latency")]
    pub latency: u32,
    /// Bytes that come a cycle at most, of a bus of 8: 1, 2, 4 or 8.
    #[serde(default = "default_bytes", deserialize_with = "checked::bytes")]
    pub bytes_per_cycle: u32,
    /// Does it stall at random?
    #[serde(default)]
    pub stalls: bool,
}

fn default_tile() -> u32 {
    16
}

fn default_lines() -> u32 {
    256
}

fn default_pending() -> u32 {
    4
}

fn default_latency() -> u32 {
    20
}

fn default_bytes() -> u32 {
    8
}

impl Default for MachineCache {
    /// 256 lines: 4 KiB of 8-bit heights.
    fn default() -> Self {
        MachineCache {
            lines: default_lines(),
            pending: default_pending(),
        }
    }
}

impl Default for MachineMemory {
    /// 20 cycles to the first beat, 8 bytes a cycle: the 64-bit bus at the unit's own clock that
    /// the 2013 paper has (section 4.3).
    fn default() -> Self {
        MachineMemory {
            latency: default_latency(),
            bytes_per_cycle: default_bytes(),
            stalls: false,
        }
    }
}

impl Machine {
    /// A machine of this kind with everything else as if nothing were said.
    pub fn of_kind(kind: MachineKind) -> Machine {
        Machine {
            kind,
            fifo: None,
            latencies: None,
            effort: None,
            tile: default_tile(),
            counters: false,
            cache: MachineCache::default(),
            memory: MachineMemory::default(),
        }
    }
}

/// Values checked where they are read, so that the reader of TOML can add the line to the message.
mod checked {
    use serde::{Deserialize, Deserializer, de::Error};

    fn number<'de, D: Deserializer<'de>>(
        deserializer: D,
        is_right: impl Fn(u32) -> bool,
        rule: &str,
    ) -> Result<u32, D::Error> {
        let number = i64::deserialize(deserializer)?;
        u32::try_from(number)
            .ok()
            .filter(|&number| is_right(number))
            .ok_or_else(|| D::Error::custom(format!("{number} is not {rule}")))
    }

    fn is_power_of_two(number: u32, least: u32, most: u32) -> bool {
        number.is_power_of_two() && (least..=most).contains(&number)
    }

    pub(super) fn fifo<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<u32>, D::Error> {
        let rule = "a FIFO's entries: a power of two, 2 to 64";
        number(deserializer, |n| is_power_of_two(n, 2, 64), rule).map(Some)
    }

    pub(super) fn cycles<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
        let rule = "an operator's cycles: 1 to 32";
        let longest = super::MachineLatencies::LONGEST;
        number(deserializer, |n| (1..=longest).contains(&n), rule)
    }

    pub(super) fn tile<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
        let rule = "a tile's side in pixels: a power of two, 1 to 8192";
        number(deserializer, |n| is_power_of_two(n, 1, 8192), rule)
    }

    pub(super) fn lines<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
        let rule = "a cache's lines: a power of two, 2 to 65536";
        number(deserializer, |n| is_power_of_two(n, 2, 65536), rule)
    }

    pub(super) fn pending<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
        let rule = "the lines that may be on their way: 2, 4 or 8";
        number(deserializer, |n| is_power_of_two(n, 2, 8), rule)
    }

    pub(super) fn latency<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
        let rule = "a latency: 1 to 1000 cycles";
        number(deserializer, |n| (1..=1000).contains(&n), rule)
    }

    pub(super) fn bytes<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
        let rule = "the bytes of a cycle: 1, 2, 4 or 8";
        number(deserializer, |n| is_power_of_two(n, 1, 8), rule)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_out_has_its_usual_value() {
        let machine: Machine = toml::from_str("kind = \"paper\"").unwrap();
        assert_eq!(machine, Machine::of_kind(MachineKind::Paper));
        let text = "kind = \"exact\"\nfifo = 8\n[cache]\nlines = 512\n[memory]\nstalls = true";
        let machine: Machine = toml::from_str(text).unwrap();
        assert_eq!((machine.fifo, machine.cache.lines), (Some(8), 512));
        assert_eq!(machine.effort, None);
        let text = "kind = \"exact\"\neffort = \"throughput\"";
        let effort = toml::from_str::<Machine>(text).unwrap().effort;
        assert_eq!(effort, Some(MachineEffort::Throughput));
        assert!(machine.memory.stalls && machine.memory.latency == 20);
        let text = "kind = \"paper\"\nlatencies = { divider = 8, conversion = 2 }";
        let machine: Machine = toml::from_str(text).unwrap();
        let latencies = MachineLatencies {
            divider: 8,
            conversion: 2,
            ..MachineLatencies::PAPER
        };
        assert_eq!(machine.latencies, Some(latencies));
    }

    #[test]
    fn a_fifo_has_a_place_more_than_the_loop_has_stages() {
        let entries = [(1, 2), (15, 16), (16, 32), (24, 32), (32, 64), (64, 64)];
        for (stages, fifo) in entries {
            assert_eq!(fifo_that_fills(stages), fifo, "{stages}");
        }
    }

    #[test]
    fn a_wrong_value_is_refused_with_its_rule() {
        for (text, rule) in [
            ("fifo = 3", "power of two"),
            ("fifo = 128", "2 to 64"),
            ("tile = 3", "power of two"),
            ("latencies = { adder = 0 }", "1 to 32"),
            ("latencies = { divider = 33 }", "1 to 32"),
            ("latencies = { root = 2 }", "unknown field"),
            ("[cache]\nlines = 1", "2 to 65536"),
            ("[cache]\npending = 16", "2, 4 or 8"),
            ("[memory]\nlatency = 0", "1 to 1000"),
            ("[memory]\nbytes_per_cycle = 3", "1, 2, 4 or 8"),
            ("speed = 3", "unknown field"),
        ] {
            let text = format!("kind = \"paper\"\n{text}");
            let message = toml::from_str::<Machine>(&text).unwrap_err().to_string();
            assert!(message.contains(rule), "{text}: {message}");
        }
        let message = toml::from_str::<Machine>("kind = \"other\"").unwrap_err();
        assert!(
            message.to_string().contains("`paper` or `exact`"),
            "{message}"
        );
    }
}
