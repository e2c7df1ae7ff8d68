//! What the paper's traverse unit is built as: what its golden machine and its Verilog share.

use super::declaration::Declared;
use super::fifo::FifoShape;
use super::height_cache::{CacheAnswer, HeightCacheShape};
use super::read_port::{ADDRESS_BITS, ReadPortShape};
use super::recirculation::ID_BITS;
use crate::scene::Machine;
use crate::units::paper_step::{PAPER_POLICY, PaperStep};
use crate::units::traverse_step::counter_bits;

/// The stage in which the height cache is asked: the address is computed in the one before.
pub const LOOKUP_STAGE: u32 = 1;

/// Entries of FIFO 1 where a machine does not say: those of a loop of the paper's 15 stages.
const FIFO: u32 = 16;

/// The most entries of FIFO 0: what distributed memory holds in its smallest piece. Rays that wait
/// there are not in the loop, so that a few suffice whatever its stages.
const MOST_WAITING: u32 = 16;

/// Bits of the counters, which run over.
pub const COUNTER_BITS: u32 = 32;

/// What the paper's traverse unit is built as.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PaperShape {
    /// The datapath of a pass.
    pub step: PaperStep,
    /// Bits of a number.
    pub number_bits: u32,
    /// FIFO 0, in which rays wait for the loop.
    pub fifo_0: FifoShape,
    /// FIFO 1, in which hits wait to be taken.
    pub fifo_1: FifoShape,
    /// The height cache.
    pub cache: HeightCacheShape,
    /// The port to the memory.
    pub port: ReadPortShape,
    /// Counts passes and gaps.
    pub counters: bool,
}

impl PaperShape {
    /// The unit that a scene's machine describes, with 16 entries in FIFO 1 where it does not say. A cache never has more than half the lines of
    /// the memory: a line's number would leave no tag.
    ///
    /// # Panics
    /// If a block cannot be built so.
    pub fn new(step: PaperStep, number_bits: u32, machine: &Machine) -> PaperShape {
        let (fifo, counters) = (machine.fifo.unwrap_or(FIFO), machine.counters);
        let texel_bits = step.shape.root_level.max(1);
        // Counts are never negative.
        let count_bits = counter_bits(PAPER_POLICY) - 1;
        let ray = ["u", "v", "du", "dv"].map(|name| (name, number_bits));
        let mut in_fifo_0 = vec![("id", ID_BITS)];
        in_fifo_0.extend(ray);
        let in_fifo_1 = [
            ("id", ID_BITS),
            ("i", texel_bits),
            ("j", texel_bits),
            ("t", number_bits),
            ("u", number_bits),
            ("v", number_bits),
            ("steps", count_bits),
            ("crossings", count_bits),
            ("guard", 1),
        ];
        let pending = machine.cache.pending;
        let line_bits = step.address_bits() - 4;
        let cache = HeightCacheShape {
            name: "paper_height_cache".to_owned(),
            height_bits: step.shape.height_bits,
            line_bits,
            lines: machine.cache.lines.min(1 << (line_bits - 1)),
            pending,
            answer: CacheAnswer::Height,
            latency: 2,
            counters,
        };
        cache.check();
        PaperShape {
            number_bits,
            fifo_0: FifoShape::new("paper_fifo_0", fifo.min(MOST_WAITING), &in_fifo_0),
            fifo_1: FifoShape::new("paper_fifo_1", fifo, &in_fifo_1),
            port: ReadPortShape::new("paper_read_port", line_bits, cache.beats(), pending),
            cache,
            counters,
            step,
        }
    }

    /// The stage in which the cache answers.
    pub fn height_stage(&self) -> u32 {
        LOOKUP_STAGE + self.cache.latency
    }

    /// Bits of the count of rays that are in the loop or in FIFO 1.
    pub fn inside_bits(&self) -> u32 {
        self.fifo_1.pointer_bits() + 1
    }

    /// The ports of the unit and the signals of its control, in the order of
    /// [`super::PaperMachine::observe`].
    pub fn declaration(&self) -> Vec<Declared> {
        let mut signals = vec![
            Declared::input("ray_valid_i", 1),
            Declared::input("ray_id_i", ID_BITS),
        ];
        for name in ["u", "v", "du", "dv"] {
            signals.push(Declared::input(format!("ray_{name}_i"), self.number_bits));
        }
        signals.push(Declared::input("hit_ready_i", 1));
        signals.extend([
            Declared::input("mem_arready_i", 1),
            Declared::input("mem_rvalid_i", 1),
            Declared::input("mem_rid_i", self.port.id_bits),
            Declared::input("mem_rdata_i", 64),
            Declared::input("mem_rresp_i", 2),
            Declared::input("mem_rlast_i", 1),
            Declared::output("ray_ready_o", 1),
            Declared::output("hit_valid_o", 1),
        ]);
        for field in &self.fifo_1.fields {
            signals.push(Declared::output(
                format!("hit_{}_o", field.name),
                field.width,
            ));
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
            for name in ["passes_o", "gaps_without_ray_o", "gaps_without_room_o"] {
                signals.push(Declared::output(name, COUNTER_BITS));
            }
            for name in ["cache_hits_o", "cache_misses_o", "lines_fetched_o"] {
                signals.push(Declared::output(name, COUNTER_BITS));
            }
        }
        signals.extend([
            Declared::wire("ends", 1),
            Declared::wire("recirculates", 1),
            Declared::wire("admits", 1),
            Declared::register("rays_inside", self.inside_bits(), 0),
            Declared::register("lookup_valid", 1, 0),
            Declared::register("lookup_address", self.step.address_bits(), 0),
        ]);
        signals
    }
}
