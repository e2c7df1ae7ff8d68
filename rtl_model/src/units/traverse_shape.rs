//! What a traverse unit is built for, and how wide that makes its registers.

use super::search_policy::{Ascent, SearchPolicy};
use crate::ray::REACH_TEXELS;

/// Bits of a node index, signed: a walk starts in texels -4096 to 4095 and reaches 2^14 texels.
pub const INDEX_BITS: u32 = 16;

/// Bits of the step and crossing counters, signed, of a walk that never goes up: enough for its
/// [`TraverseShape::step_bound`]. Of any walk: [`counter_bits`].
pub const COUNTER_BITS: u32 = 17;

/// Bits of a level, signed: 0 to 12, and -1 in passing.
pub const LEVEL_BITS: u32 = 5;

/// Bits of the amount of a shift by a level or by levels below the root: 0 to 12.
pub(super) const SHIFT_BITS: u32 = 4;

/// Bits of the step and crossing counters, signed: enough for [`TraverseShape::step_bound`].
pub const fn counter_bits(policy: SearchPolicy) -> u32 {
    match policy.ascent {
        Ascent::Never => COUNTER_BITS,
        Ascent::Always | Ascent::Coherent => COUNTER_BITS + 1,
        Ascent::EvenBorder | Ascent::Selective => COUNTER_BITS + 2,
    }
}

/// What a traverse unit is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TraverseShape {
    /// Level of the pyramid's root: log2 of the map's size, 0 to 12.
    pub root_level: u32,
    /// Bits of a height: 8 or 16.
    pub height_bits: u32,
}

impl TraverseShape {
    /// Texels on a side of the map.
    pub const fn size(self) -> u32 {
        1 << self.root_level
    }

    /// More steps than any ray within reach can take; a walk that gets there answers `guard`.
    ///
    /// A step crosses, or goes down at least a level. Levels are gone down `root_level + 1` times,
    /// and once more for each ascent; an ascent is part of a crossing, so there are no more ascents
    /// than crossings.
    pub const fn step_bound(self, policy: SearchPolicy) -> u32 {
        let crossings = self.most_crossings(policy);
        let ascents = match policy.ascent {
            Ascent::Never => 0,
            _ => crossings,
        };
        self.root_level + 1 + crossings + ascents
    }

    /// No ray within reach crosses more often.
    ///
    /// Going straight, a crossing moves on by at least a texel on one axis, and there are
    /// `reach + size` of them on either; a corner in doubt makes three crossings of two. So it is
    /// where no border is crossed twice: where the walk never goes up, or remembers its borders.
    /// Else a crossing that goes up can lead to one border being crossed again, and to no more than
    /// that (`units::traverse_ascent`).
    const fn most_crossings(self, policy: SearchPolicy) -> u32 {
        let crossings = 3 * (REACH_TEXELS as u32 + self.size());
        match policy.ascent {
            Ascent::EvenBorder | Ascent::Selective => 2 * crossings,
            Ascent::Never | Ascent::Always | Ascent::Coherent => crossings,
        }
    }

    /// Bits of a height's address in the pyramid's memory.
    pub const fn address_bits(self) -> u32 {
        2 * self.root_level + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Family, Method};

    #[test]
    fn the_counters_hold_the_step_bound_and_no_bit_is_idle() {
        let largest = TraverseShape {
            root_level: 12,
            height_bits: 16,
        };
        let mut policies = 0;
        for method in Method::ALL {
            let Family::Nodes(policy) = method.family() else {
                continue;
            };
            let most = (1_u32 << (counter_bits(policy) - 1)) - 1;
            let bound = largest.step_bound(policy);
            assert!((most / 2 + 1..=most).contains(&bound), "{method}: {bound}");
            policies += 1;
        }
        assert_eq!(policies, 10);
    }
}
