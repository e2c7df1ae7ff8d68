//! What the exact machine's ports carry, and what it counts.

use super::super::read_port::{AxiAddress, AxiBeat};
use super::super::run_summary::Lookups;
use crate::ray_format::QuantisedRay;

/// What the unit's input ports carry in a cycle.
#[derive(Clone, Copy, Debug)]
pub struct ExactInputs {
    /// A ray is offered.
    pub ray_valid: bool,
    /// Its id.
    pub ray_id: u32,
    /// The ray.
    pub ray: QuantisedRay,
    /// A hit would be taken.
    pub hit_ready: bool,
    /// The memory takes an address.
    pub arready: bool,
    /// What the memory answers.
    pub r: AxiBeat,
}

/// What the unit's handshakes carry in a cycle, and what its control does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExactOutputs {
    /// A ray offered in this cycle is taken.
    pub ray_ready: bool,
    /// A hit is offered.
    pub hit_valid: bool,
    /// The walk in the last stage goes round again.
    pub recirculates: bool,
    /// The walk in the last stage goes to the leaf check.
    pub ends: bool,
    /// A walk refused by the leaf check goes back into the loop.
    pub returns: bool,
    /// A ray enters the loop.
    pub admits: bool,
    /// The address channel of the memory.
    pub ar: AxiAddress,
    /// A beat of the memory would be taken.
    pub rready: bool,
    /// The memory has answered wrongly.
    pub error: bool,
}

/// A hit that the unit offers: what its ports carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExactHit {
    /// The ray's id.
    pub id: u32,
    /// The texel.
    pub i: u32,
    /// The texel on v.
    pub j: u32,
    /// It is the texel's side across u that is hit.
    pub at_border_u: bool,
    /// It is that across v.
    pub at_border_v: bool,
    /// From that side's border to the ray's entry, in units of an entry: negative.
    pub way: i64,
    /// The ray's slope on that axis.
    pub slope: i64,
    /// The depth of the texel, in height steps: that of a hit on its top.
    pub depth: i64,
    /// Steps: lines read.
    pub steps: u32,
    /// Blocks of the start line crossed.
    pub crossings: u32,
    /// The walk ended at the step bound.
    pub guard: bool,
}

/// What has been counted since reset. In a cycle a trip begins, or there is a gap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExactCounts {
    /// Trips begun.
    pub trips: u64,
    /// Cycles in which none began.
    pub gaps: u64,
    /// Walks refused by the leaf check.
    pub refusals: u64,
    /// Lookups that found their line.
    pub hits: u64,
    /// Lookups that did not.
    pub misses: u64,
    /// Lines fetched.
    pub lines_fetched: u64,
}

impl Lookups for ExactCounts {
    fn hits_and_misses(&self) -> (u64, u64) {
        (self.hits, self.misses)
    }
}

impl ExactInputs {
    /// The words of the input ports, in their declared order; those of signed ones in 64 bits.
    pub fn words(&self) -> [u64; 13] {
        [
            self.ray_valid.into(),
            self.ray_id.into(),
            self.ray.u as u64,
            self.ray.v as u64,
            self.ray.du as u64,
            self.ray.dv as u64,
            self.hit_ready.into(),
            self.arready.into(),
            self.r.valid.into(),
            self.r.id,
            self.r.data,
            self.r.response,
            self.r.last.into(),
        ]
    }
}
