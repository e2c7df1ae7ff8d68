//! What a wide traverse unit is built for, and the order in which a ray meets the cells of a line.
//!
//! A *line* is what one read of the memory answers: the heights of `2^log2_side` nodes on a side,
//! its *cells*, all of one level of the pyramid and all children (`quad`) or grandchildren
//! (`block`) of one node, its *block*. Lines lie at levels 0, `log2_side`, `2 log2_side` and so on.

use crate::ray::REACH_TEXELS;

/// The most cells of a line.
pub const MOST_CELLS: usize = 16;

/// The most cells on a side of a line.
pub const MOST_SIDE: usize = 4;

/// The most lines one above the other: of lines of 2 x 2 over the largest map.
pub const MOST_LINE_LEVELS: usize = 12;

/// Bits of the step and crossing counters, signed: enough for [`WideShape::step_bound`].
pub const WIDE_COUNTER_BITS: u32 = 18;

/// Columns and rows of the cells of a line of 2 x 2, in path order.
const QUAD_ORDER: [(usize, usize); 4] = [(0, 0), (1, 0), (0, 1), (1, 1)];

/// The same of a line of 4 x 4.
const BLOCK_ORDER: [(usize, usize); 16] = [
    (0, 0),
    (1, 0),
    (0, 1),
    (2, 0),
    (1, 1),
    (0, 2),
    (3, 0),
    (2, 1),
    (1, 2),
    (0, 3),
    (3, 1),
    (2, 2),
    (1, 3),
    (3, 2),
    (2, 3),
    (3, 3),
];

/// What a wide traverse unit is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct WideShape {
    /// Level of the pyramid's root: log2 of the map's size, 0 to 12.
    pub root_level: u32,
    /// Bits of a height: 8 or 16.
    pub height_bits: u32,
    /// log2 of the cells on a side of a line: 1 or 2.
    pub log2_side: u32,
}

impl WideShape {
    /// Texels on a side of the map.
    pub const fn size(self) -> u32 {
        1 << self.root_level
    }

    /// Cells on a side of a line.
    pub const fn side(self) -> usize {
        1 << self.log2_side
    }

    /// Cells of a line.
    pub const fn cells(self) -> usize {
        self.side() * self.side()
    }

    /// Levels at which lines lie: from 0 to the first whose line holds the whole map.
    ///
    /// Where `log2_side` does not divide the root's level, that line holds the map more than once,
    /// which wraps.
    pub const fn line_levels(self) -> usize {
        let levels = self.root_level.div_ceil(self.log2_side);
        if levels == 0 { 1 } else { levels as usize }
    }

    /// The level of the `n`th lines from below.
    pub const fn line_level(self, n: usize) -> u32 {
        n as u32 * self.log2_side
    }

    /// The cells of a line in path order, column and row of each.
    ///
    /// A ray that travels toward larger u and v meets cells in the order of column plus row. Of two
    /// with the same sum it meets one, except where it passes a corner so closely that rounding
    /// leaves open which; then the one on u comes first, as through an exact corner.
    pub const fn path_order(self) -> &'static [(usize, usize)] {
        match self.log2_side {
            1 => &QUAD_ORDER,
            _ => &BLOCK_ORDER,
        }
    }

    /// log2 of the reach, in texels from top to bottom on the longer axis, from which on a walk
    /// starts at `level` or above.
    ///
    /// A walk reads about `reach / side of a block` lines at the level it starts at, and a few below
    /// where the surface comes close. Started at the lowest block that holds the whole ray it would read fewer there,
    /// but all those that lead down to the surface. Reach to the power of two thirds is the block
    /// that needs fewest lines on the calibrated scenes (`docs/traversals.md`).
    pub const fn start_reach_log2(self, level: u32) -> u32 {
        (3 * level).div_ceil(2) + (2 - self.log2_side)
    }

    /// More steps than any ray within reach can take; a walk that gets there answers `guard`.
    ///
    /// No line is read twice, and only lines whose block the ray passes through, or a block beside a
    /// corner in doubt. At each level the ray leaves at most `reach / side of a block` blocks and one
    /// on either axis; a corner in doubt makes three visits of two.
    pub const fn step_bound(self) -> u32 {
        let mut bound = 0;
        let mut n = 0;
        while n < self.line_levels() {
            let blocks = (REACH_TEXELS as u32 >> (self.line_level(n) + self.log2_side)) + 1;
            bound += 3 * blocks + 1;
            n += 1;
        }
        bound
    }

    /// Bits of a line's address.
    pub const fn address_bits(self) -> u32 {
        2 * self.root_level.saturating_sub(self.log2_side) + 1
    }
}
