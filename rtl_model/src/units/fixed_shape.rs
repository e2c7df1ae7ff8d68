//! How wide the words of the exact fixed-point walk are, and why.
//!
//! All numbers of the walk are integers. A *slope* is texels travelled per height step (a height
//! step is one unit of a height, 1/255 or 1/65535 of the depth) times `2^fraction_bits`; an *entry*
//! is a texel coordinate times `2^entry_fraction_bits`, with as many fewer fraction bits as a
//! height has bits. The position of a ray `n` height steps below the top is then
//! `(entry << height_bits) + n * slope`, exactly.

use super::traverse_step::INDEX_BITS;
use crate::ray::REACH_TEXELS;

/// Bits of the step and crossing counters, signed: enough for [`FixedShape::step_bound`].
pub const FIXED_COUNTER_BITS: u32 = 18;

/// What an exact fixed-point traverse unit is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FixedShape {
    /// Level of the pyramid's root: log2 of the map's size, 0 to 12.
    pub root_level: u32,
    /// Bits of a height: 8 or 16.
    pub height_bits: u32,
    /// Fraction bits of a texel in an entry coordinate.
    pub entry_fraction_bits: u32,
    /// Bits of a slope's magnitude.
    pub slope_bits: u32,
}

impl FixedShape {
    /// Texels on a side of the map.
    pub const fn size(self) -> u32 {
        1 << self.root_level
    }

    /// The largest height: height steps from top to bottom.
    pub const fn full_height(self) -> i64 {
        (1 << self.height_bits) - 1
    }

    /// Fraction bits of a slope, and of a position.
    pub const fn fraction_bits(self) -> u32 {
        self.entry_fraction_bits + self.height_bits
    }

    /// Bits of an entry coordinate, signed: mirrored, it lies from -1 to 1 map.
    pub const fn entry_bits(self) -> u32 {
        self.root_level + self.entry_fraction_bits + 1
    }

    /// Bits of a position, signed: that of a texel index, and its fraction.
    pub const fn position_bits(self) -> u32 {
        INDEX_BITS + self.fraction_bits()
    }

    /// Bits of the error term, signed.
    ///
    /// It is the cross product of the ray's slopes and the way from the ray's entry to the near
    /// corner of a node. The ray passes through the node, so the corner is off the ray by at most
    /// the side of the node along either axis: the term is at most the root's side times the
    /// larger slope.
    pub const fn error_bits(self) -> u32 {
        self.root_level + self.entry_fraction_bits + self.slope_bits + 1
    }

    /// Texels that a ray can travel on an axis, rounded up: what the largest slope makes of all
    /// height steps, or the reach of all rays and the rounding of a slope.
    pub const fn travel(self) -> u32 {
        let slope = (1_i128 << self.slope_bits) - 1;
        let travel = ((slope * self.full_height() as i128) >> self.fraction_bits()) + 1;
        let reach = REACH_TEXELS as i128 + 1;
        (if travel < reach { travel } else { reach }) as u32
    }

    /// More steps than any ray can take; a walk that gets there answers `guard`.
    ///
    /// Every decision is exact, so a walk follows the path of its ray and crosses a border of
    /// texels at most once: on either axis at most the travel and one. A step crosses, or goes
    /// down; an ascent comes with a crossing, and is gone down again once.
    pub const fn step_bound(self, ascends: bool) -> u32 {
        let crossings = 2 * (self.travel() + 1);
        self.root_level + 1 + crossings + if ascends { crossings } else { 0 }
    }

    /// Bits of a height's address in the pyramid's memory.
    pub const fn address_bits(self) -> u32 {
        2 * self.root_level + 1
    }
}
