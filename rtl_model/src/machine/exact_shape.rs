//! What the exact machine is built as: what its golden model and its Verilog share.

use super::declaration::{Declared, bits_for};
use super::exact_trip::address_on_curve;
use super::fifo::FifoShape;
use super::height_cache::{CacheAnswer, HeightCacheShape};
use super::read_port::{ADDRESS_BITS, ReadPortShape};
use super::recirculation::ID_BITS;
use crate::maps::Lines;
use crate::scene::MachineCache;
use crate::units::bounded_leaf::{corner_bits, corner_digits};
use crate::units::bounded_setup::near_sum_bits;
use crate::units::bounded_shape::{BoundedShape, LINE_BITS, PLACE_BITS};

/// Bits of the counters, which run over.
pub const EXACT_COUNTER_BITS: u32 = 32;

/// The names of the candidates kept, by line.
pub const KEPT_NAMES: [&str; 6] = ["kept_0", "kept_1", "kept_2", "kept_3", "kept_4", "kept_5"];

/// How much hardware the exact machine has of each kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExactEffort {
    /// Rays that may be inside at once: a power of two, 2 to 64.
    pub slots: u32,
    /// Stages of the loop; the height arrives in the sixth.
    pub stages: u32,
    /// Setups one behind the other, each with its share of the digits of the quotients, one a cycle.
    pub setups: u32,
    /// Digits of the way to a near border that the setup behind them makes a cycle.
    pub near_digits: u32,
    /// Rays that may wait behind them, set up, in registers: where several leave the loop one
    /// after the other, as many follow at once.
    pub waiting_rays: u32,
    /// Digits of the depth that the leaf check makes a cycle: 1, 2, 4 or 8.
    pub travel_digits: u32,
    /// Digits of the error term that it makes a cycle.
    pub corner_digits: u32,
}

impl ExactEffort {
    /// Little area, for lines of 2 x 2 heights.
    pub const AREA: ExactEffort = ExactEffort {
        slots: 16,
        stages: 8,
        setups: 4,
        near_digits: 4,
        waiting_rays: 2,
        travel_digits: 2,
        corner_digits: 1,
    };

    /// Few cycles a ray, for lines of 4 x 4 heights. The loop is longer than it need be: a ray that
    /// waits for its line asks again less often.
    pub const THROUGHPUT: ExactEffort = ExactEffort {
        slots: 32,
        stages: 10,
        setups: 10,
        near_digits: 12,
        waiting_rays: 4,
        travel_digits: 8,
        corner_digits: 4,
    };
}

/// What the exact machine is built as.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExactMachineShape {
    /// The walk.
    pub bounded: BoundedShape,
    /// How much hardware there is.
    pub effort: ExactEffort,
    /// Where walks wait for the leaf check.
    pub leaf_fifo: FifoShape,
    /// The height cache.
    pub cache: HeightCacheShape,
    /// The port to the memory.
    pub port: ReadPortShape,
    /// Counts trips, gaps and checks, and tells of each hit the steps, the crossings and whether it is one
    /// of the guard.
    pub counters: bool,
}

/// The stage in which what stage 0 has read of a ray is there: its constants, and the bounds of its block.
///
/// Between the two a block RAM has given its word: that takes half a cycle.
pub const READ_STAGE: u32 = 2;

/// The stage in front of which the golden machine knows what a trip has read.
pub const KNOWN_STAGE: u32 = 1;

/// The stage in which the cache is asked; the address is computed in the one before.
const LOOKUP_STAGE: u32 = READ_STAGE + 1;

impl ExactMachineShape {
    /// A machine. A cache never has more than half the lines of the memory: a line's number would
    /// leave no tag.
    ///
    /// # Panics
    /// If it is none that can be built.
    pub fn new(
        bounded: BoundedShape,
        effort: ExactEffort,
        cache: &MachineCache,
        counters: bool,
    ) -> ExactMachineShape {
        let offset_bits = 4 - 2 * bounded.log2_side;
        let line_bits = bounded.address_bits() - offset_bits;
        let cache = HeightCacheShape {
            name: "exact_height_cache".to_owned(),
            height_bits: bounded.words.height_bits,
            line_bits,
            lines: cache.lines.min(1 << (line_bits - 1)),
            pending: cache.pending,
            answer: CacheAnswer::Line,
            // A block RAM, and a register behind it.
            latency: 2,
            counters,
        };
        cache.check();
        let slot = [("slot", bits_for(effort.slots))];
        let shape = ExactMachineShape {
            leaf_fifo: FifoShape::new("exact_leaf_fifo", effort.slots, &slot),
            port: ReadPortShape::new("exact_read_port", line_bits, cache.beats(), cache.pending),
            bounded,
            effort,
            cache,
            counters,
        };
        shape.check();
        shape
    }

    fn check(&self) {
        let effort = &self.effort;
        assert!(
            effort.slots.is_power_of_two() && (2..=64).contains(&effort.slots),
            "{} slots",
            effort.slots
        );
        assert!(effort.stages > self.height_stage(), "too few stages");
        assert!(
            effort.setups >= 1 && effort.near_digits >= 1 && effort.corner_digits >= 1,
            "no setup, or no digits"
        );
        let height_bits = self.bounded.words.height_bits;
        assert!(
            effort.travel_digits >= 1 && height_bits.is_multiple_of(effort.travel_digits),
            "{} digits a cycle of {height_bits}",
            effort.travel_digits
        );
    }

    /// The stage in which the cache answers.
    pub fn height_stage(&self) -> u32 {
        LOOKUP_STAGE + self.cache.latency
    }

    /// Bits of a slot's number.
    pub fn slot_bits(&self) -> u32 {
        bits_for(self.effort.slots)
    }

    /// Bits of the place in a cache line of the line that a step reads.
    pub fn offset_bits(&self) -> u32 {
        4 - 2 * self.bounded.log2_side
    }

    /// Setups, the one behind them, and behind that those places that only hold a ray.
    pub fn setup_places(&self) -> u32 {
        self.effort.setups + 1 + self.effort.waiting_rays
    }

    /// Does a ray only wait at this place of the chain of setups?
    pub fn only_waits(&self, setup: u32) -> bool {
        setup > self.effort.setups
    }

    /// Digits of the way to a near border that are made: as many as it has bits, or some more.
    pub fn near_digits(&self) -> u32 {
        let digits = self.effort.near_digits;
        self.bounded.behind_bits().div_ceil(digits) * digits
    }

    /// Cycles in which a setup makes digits: of the quotients, or, behind the last of those, of the ways to
    /// the near borders. None where a ray only waits.
    pub fn setup_turns(&self, setup: u32) -> u32 {
        let (setups, digits) = (self.effort.setups, self.bounded.setup_digits());
        match setup {
            _ if self.only_waits(setup) => 0,
            _ if setup == setups => self.near_digits() / self.effort.near_digits,
            _ => digits / setups + u32::from(setup < digits % setups),
        }
    }

    /// Digits of a quotient that are made before a setup.
    pub fn digits_before(&self, setup: u32) -> u32 {
        (0..setup).map(|before| self.setup_turns(before)).sum()
    }

    /// Bits of the count of such cycles.
    pub fn setup_turn_bits(&self) -> u32 {
        let most = self
            .setup_turns(0)
            .max(self.setup_turns(self.effort.setups));
        bits_for(most + 1).max(1)
    }

    /// Cycles in which the leaf check makes digits of the depth.
    pub fn travel_turns(&self) -> u32 {
        self.bounded.words.height_bits / self.effort.travel_digits
    }

    /// Cycles in which it makes digits of the error term.
    pub fn corner_turns(&self) -> u32 {
        corner_digits(self.bounded) / self.effort.corner_digits
    }

    /// Digits of the error term that are left to be made in front of the verdict.
    pub fn corner_rest(&self) -> u32 {
        corner_digits(self.bounded) % self.effort.corner_digits
    }

    /// Bits of the count of the leaf check's cycles.
    pub fn leaf_turn_bits(&self) -> u32 {
        bits_for(self.travel_turns().max(self.corner_turns()) + 1).max(1)
    }

    /// The words that the memory behind the read port holds: the lines of each level along a Z
    /// curve ([`curve_address`](super::curve_address)).
    pub fn memory_words(&self, lines: &Lines) -> Vec<u64> {
        let bits = self.bounded.words.height_bits;
        let cells = self.bounded.lines().cells();
        let mut heights = vec![0; lines.memory().len()];
        for (address, line) in (0..).zip(lines.memory().chunks(cells)) {
            if let Some(address) = address_on_curve(address) {
                heights[address as usize * cells..][..cells].copy_from_slice(line);
            }
        }
        let word = |heights: &[u16]| {
            let places = heights.iter().zip(0u32..);
            places.fold(0, |word, (&height, place)| {
                word | u64::from(height) << (place * bits)
            })
        };
        heights.chunks(64 / bits as usize).map(word).collect()
    }

    /// The fields of a hit: their ports are `hit_NAME_o`.
    pub fn hit_fields(&self) -> Vec<(&'static str, u32)> {
        let words = self.bounded.words;
        let count_bits = self.bounded.counter_bits() - 1;
        let mut fields = vec![
            ("id", ID_BITS),
            ("i", words.root_level.max(1)),
            ("j", words.root_level.max(1)),
            ("at_border_u", 1),
            ("at_border_v", 1),
            ("way", self.bounded.way_bits()),
            ("slope", words.slope_bits),
            ("depth", words.height_bits),
        ];
        if self.counters {
            fields.extend([
                ("steps", count_bits),
                ("crossings", count_bits),
                ("guard", 1),
            ]);
        }
        fields
    }

    /// The ports that a ray comes in by, behind valid and id.
    pub fn ray_ports(&self) -> [(&'static str, u32); 4] {
        let words = self.bounded.words;
        let (entry, slope) = (words.entry_bits(), words.slope_bits + 1);
        [("u", entry), ("v", entry), ("du", slope), ("dv", slope)]
    }

    /// The registers of a walk in the loop.
    pub fn walk_registers(&self) -> Vec<(&'static str, u32)> {
        let shape = self.bounded;
        let mask = shape.lines().cells() as u32 + 1;
        let mut registers = vec![
            ("line", LINE_BITS),
            ("i", shape.index_bits()),
            ("j", shape.index_bits()),
            ("from_own_line", 1),
            ("column", PLACE_BITS),
            ("row", PLACE_BITS),
        ];
        registers.extend(KEPT_NAMES[..shape.line_levels()].iter().map(|&n| (n, mask)));
        registers.extend([("leaves_u", 1), ("leaves_back", 1), ("resumes", 1)]);
        if self.counters {
            registers.extend([
                ("steps", shape.counter_bits()),
                ("crossings", shape.counter_bits()),
            ]);
        }
        registers
    }

    /// The registers of a mirrored ray, which go with it through the setups.
    pub fn ray_registers(&self) -> Vec<(&'static str, u32)> {
        let (shape, words) = (self.bounded, self.bounded.words);
        let (entry, slope) = (words.entry_bits(), words.slope_bits + 1);
        vec![
            ("id", ID_BITS),
            ("mirrored_u", entry),
            ("mirrored_v", entry),
            ("slope_u", slope),
            ("slope_v", slope),
            ("mirror_u", 1),
            ("mirror_v", 1),
            ("start_line", LINE_BITS),
            ("texel_u", shape.index_bits()),
            ("texel_v", shape.index_bits()),
        ]
    }

    /// The registers of an axis in a setup, without their axis: of a division, of its quotient the digits
    /// made here and those made before; behind the divisions, of the product; where a ray only waits, of what
    /// has come of it.
    pub fn setup_registers(&self, setup: u32) -> Vec<(&'static str, u32)> {
        let shape = self.bounded;
        if self.only_waits(setup) {
            return vec![
                ("t_delta", shape.delta_bits()),
                ("t_near", shape.bound_bits()),
            ];
        }
        if setup == self.effort.setups {
            return vec![
                ("saturates", 1),
                ("quotient", shape.delta_bits()),
                ("behind", self.near_digits()),
                ("sum", near_sum_bits(shape, self.near_digits())),
            ];
        }
        let mut registers = vec![
            ("saturates", 1),
            ("behind", shape.behind_bits()),
            ("remainder", shape.words.slope_bits),
            ("first_saturates", 1),
            ("digits", self.setup_turns(setup)),
        ];
        if setup > 0 {
            registers.push(("digits_before", self.digits_before(setup)));
        }
        registers
    }

    /// The registers of a walk at a place of the leaf check: `waiting`, `check` or `answer`.
    pub fn leaf_walk_registers(&self, place: &str) -> Vec<(&'static str, u32)> {
        let bounded = self.bounded;
        let cells = bounded.lines().cells() as u32;
        let mut registers = vec![
            ("slot", self.slot_bits()),
            ("texel_u", bounded.index_bits()),
            ("texel_v", bounded.index_bits()),
        ];
        let kept = KEPT_NAMES[..bounded.line_levels()].iter();
        registers.extend(kept.map(|&name| (name, cells)));
        registers.extend([("leaves_u", 1), ("leaves_back", 1)]);
        if place != "answer" {
            registers.push(("corner_is_known", 1));
        }
        if place == "waiting" {
            registers.push(("v_is_later", 1));
        }
        registers.push(("depth", bounded.words.height_bits));
        if self.counters {
            let count_bits = bounded.counter_bits() - 1;
            registers.extend([
                ("steps", count_bits),
                ("crossings", count_bits),
                ("guard", 1),
            ]);
        }
        registers
    }

    /// The registers of a ray's constants at the leaf check.
    pub fn leaf_ray_registers(&self) -> Vec<(&'static str, u32)> {
        self.ray_registers()[..7].to_vec()
    }

    /// The ports of the unit and the signals of its control and data but for those within a trip,
    /// in the order of [`super::ExactMachine::observe`].
    pub fn declaration(&self) -> Vec<Declared> {
        let mut signals = vec![
            Declared::input("ray_valid_i", 1),
            Declared::input("ray_id_i", ID_BITS),
        ];
        for (name, width) in self.ray_ports() {
            signals.push(Declared::input(format!("ray_{name}_i"), width));
        }
        signals.extend([
            Declared::input("hit_ready_i", 1),
            Declared::input("mem_arready_i", 1),
            Declared::input("mem_rvalid_i", 1),
            Declared::input("mem_rid_i", self.port.id_bits),
            Declared::input("mem_rdata_i", 64),
            Declared::input("mem_rresp_i", 2),
            Declared::input("mem_rlast_i", 1),
            Declared::output("ray_ready_o", 1),
            Declared::output("hit_valid_o", 1),
        ]);
        for (name, width) in self.hit_fields() {
            signals.push(Declared::output(format!("hit_{name}_o"), width));
        }
        signals.extend([
            Declared::output("mem_arvalid_o", 1),
            Declared::output("mem_araddr_o", ADDRESS_BITS),
            Declared::output("mem_arlen_o", 8),
            Declared::output("mem_arsize_o", 3),
            Declared::output("mem_arburst_o", 2),
            Declared::output("mem_arid_o", self.port.id_bits),
            Declared::output("mem_rready_o", 1),
            Declared::output("error_o", 1),
        ]);
        if self.counters {
            for name in ["trips_o", "gaps_o", "refusals_o"] {
                signals.push(Declared::output(name, EXACT_COUNTER_BITS));
            }
            for name in ["cache_hits_o", "cache_misses_o", "lines_fetched_o"] {
                signals.push(Declared::output(name, EXACT_COUNTER_BITS));
            }
        }
        let data = |name: String, width| Declared::data_register(name, width);
        for setup in 0..self.setup_places() {
            signals.push(Declared::register(format!("setup_{setup}_busy"), 1, 0));
            if !self.only_waits(setup) {
                let turns = self.setup_turn_bits();
                signals.push(Declared::register(format!("setup_{setup}_turns"), turns, 0));
            }
            for (name, width) in self.ray_registers() {
                signals.push(data(format!("setup_{setup}_{name}"), width));
            }
            for axis in ["u", "v"] {
                for (name, width) in self.setup_registers(setup) {
                    signals.push(data(format!("setup_{setup}_{name}_{axis}"), width));
                }
            }
        }
        signals.push(Declared::register(
            "free_slots",
            self.effort.slots,
            u64::MAX >> (64 - self.effort.slots),
        ));
        signals.extend([
            Declared::wire("recirculates", 1),
            Declared::wire("ends", 1),
            Declared::wire("returns", 1),
            Declared::wire("admits", 1),
        ]);
        for (name, width) in self.walk_registers() {
            signals.push(data(format!("{name}_s0"), width));
        }
        signals.push(Declared::register("lookup_valid", 1, 0));
        signals.push(Declared::register(
            "lookup_address",
            self.bounded.address_bits(),
            0,
        ));
        signals.push(Declared::register("fetched_valid", 1, 0));
        signals.push(data("fetched_slot".to_owned(), self.slot_bits()));
        signals.push(Declared::wire("fetched_id", ID_BITS));
        for place in ["waiting", "check", "answer"] {
            signals.push(Declared::register(format!("{place}_valid"), 1, 0));
            for (name, width) in self.leaf_walk_registers(place) {
                signals.push(data(format!("{place}_{name}"), width));
            }
            for (name, width) in self.leaf_ray_registers() {
                let is_kept = match name {
                    "mirrored_u" | "mirrored_v" => place == "waiting",
                    "slope_u" | "slope_v" => place != "answer",
                    _ => true,
                };
                if is_kept {
                    signals.push(data(format!("{place}_{name}"), width));
                }
            }
        }
        signals.push(Declared::register("check_turns", self.leaf_turn_bits(), 0));
        let position = self.bounded.way_bits() + self.bounded.words.height_bits;
        let digits = corner_digits(self.bounded) + 1;
        for (name, width) in [
            ("check_way_u", self.bounded.way_bits()),
            ("check_way_v", self.bounded.way_bits()),
            ("check_travel_u", position),
            ("check_travel_v", position),
            ("check_depth_digits", self.bounded.words.height_bits + 1),
            ("check_corner_u", digits),
            ("check_corner_v", digits),
            ("check_error", corner_bits(self.bounded)),
            ("answer_refused", 1),
            ("answer_at_border_u", 1),
            ("answer_at_border_v", 1),
            ("answer_way", self.bounded.way_bits()),
            ("answer_slope", self.bounded.words.slope_bits),
        ] {
            signals.push(data(name.to_owned(), width));
        }
        signals
    }
}
