//! What a machine's run on a list of rays came to.

/// With so many rays still to be offered the loop should be full.
pub(super) const WAITING: usize = 64;

/// Cycles without a hit after which a run gives up: a memory that answers is never so slow.
pub(super) const PATIENCE: u64 = 1 << 20;

/// What a run came to, with what its machine counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RunSummary<C> {
    /// Cycles from the first ray's entry into the loop to the last hit's leaving.
    pub cycles: u64,
    /// Hits that left.
    pub hits: u64,
    /// What the machine counted.
    pub counts: C,
    /// Bytes that came from the memory.
    pub bytes: u64,
    /// Cycles in which 64 or more rays had still to be offered, from the first ray's entry on.
    pub busy_cycles: u64,
    /// Trips begun in them.
    pub busy_trips: u64,
}

/// Lookups of a height cache.
pub trait Lookups {
    /// Those that found what they looked for, and those that did not.
    fn hits_and_misses(&self) -> (u64, u64);
}

impl<C> RunSummary<C> {
    /// Trips begun in a cycle while rays wait: 1 where the loop is always full.
    pub fn occupancy(&self) -> f64 {
        self.busy_trips as f64 / self.busy_cycles as f64
    }

    /// Cycles of a ray, in the mean.
    pub fn cycles_per_ray(&self) -> f64 {
        self.cycles as f64 / self.hits as f64
    }
}

impl<C: Lookups> RunSummary<C> {
    /// Lookups that found what they looked for, of all.
    pub fn hit_rate(&self) -> f64 {
        let (hits, misses) = self.counts.hits_and_misses();
        hits as f64 / (hits + misses) as f64
    }
}
