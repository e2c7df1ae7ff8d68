//! What a walk by bounds is built for, and how wide its words are and why.
//!
//! Depths are in height steps here: 0 is the top, `2^height_bits - 1` the bottom.

use super::fixed_shape::FixedShape;
use super::wide_shape::WideShape;

/// The most lines one above the other that a walk by bounds goes through.
pub const MOST_BOUNDED_LINES: usize = 6;

/// Bits of the number of a line level, signed.
pub const LINE_BITS: u32 = 4;

/// Bits of the column or row that a walk goes on with, signed: -1 to 3.
pub const PLACE_BITS: u32 = 3;

/// What a unit that walks by bounds is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BoundedShape {
    /// The words of its rays.
    pub words: FixedShape,
    /// log2 of the cells on a side of a line: 1 or 2.
    pub log2_side: u32,
    /// The most levels of lines, 1 to [`MOST_BOUNDED_LINES`]; a map may have fewer.
    pub most_lines: usize,
}

impl BoundedShape {
    /// The shape with the usual levels of lines: four of 2 x 2, three of 4 x 4.
    ///
    /// More are worth their registers only to rays longer than 128 texels (`docs/bounded_walk.md`).
    pub const fn new(words: FixedShape, log2_side: u32) -> BoundedShape {
        BoundedShape {
            words,
            log2_side,
            most_lines: if log2_side == 1 { 4 } else { 3 },
        }
    }

    /// The lines of the map and their path order.
    pub const fn lines(self) -> WideShape {
        WideShape {
            root_level: self.words.root_level,
            height_bits: self.words.height_bits,
            log2_side: self.log2_side,
        }
    }

    /// Levels of lines that a walk reads: line `n` has cells of level `n * log2_side`.
    pub const fn line_levels(self) -> usize {
        let levels = self.lines().line_levels();
        if levels < self.most_lines {
            levels
        } else {
            self.most_lines
        }
    }

    /// log2 of the texels on a side of the block of line `n`.
    pub const fn block_level(self, n: usize) -> u32 {
        (n as u32 + 1) * self.log2_side
    }

    /// log2 of the texels on a side of the largest block.
    pub const fn largest_block_level(self) -> u32 {
        self.block_level(self.line_levels() - 1)
    }

    /// The most borders of texels that a bound is carried over: those that a ray crosses on an
    /// axis, those of the block it starts in, and those of a block at its end.
    pub const fn most_borders(self) -> u32 {
        self.words.travel() + (2 << self.largest_block_level())
    }

    /// Bits of the way from a block's near border to a ray's entry in it, in units of an entry.
    pub const fn behind_bits(self) -> u32 {
        self.largest_block_level() + self.words.entry_fraction_bits
    }

    /// What makes the near border of a block later, in units of a bound's last place.
    ///
    /// The product of a way within the block by a depth rounded down errs late by less than the block has
    /// texels; with the margin, by a unit of [`BoundedShape::order_fraction_bits`].
    pub const fn near_margin(self) -> u32 {
        (1 << (self.fraction_bits() - self.order_fraction_bits()))
            - (1 << self.largest_block_level())
    }

    /// Fraction bits of a height step that two bounds are compared in.
    ///
    /// An eighth of a step, or finer where a ray may cross the largest block in less than four of
    /// them: then the two corners of a block's side could not be told apart.
    pub const fn order_fraction_bits(self) -> u32 {
        let mut bits = 3;
        // The depth of a block, 2^(height_bits + level) / travel, in units of 2^-bits: at least 4.
        while (self.words.travel() as u64) << 2
            > 1 << (self.words.height_bits + self.largest_block_level() + bits)
        {
            bits += 1;
        }
        bits
    }

    /// Fraction bits of a bound.
    ///
    /// The first is late by less than a block's texels in units of the last place, and each border on
    /// takes off less than one: together less than a unit of [`BoundedShape::order_fraction_bits`].
    pub const fn fraction_bits(self) -> u32 {
        let borders = self.most_borders() + (1 << self.largest_block_level()) + 2;
        self.order_fraction_bits() + (u32::BITS - (borders - 1).leading_zeros())
    }

    /// Bits of the depth between two borders, which saturates, without a sign: less than the height
    /// of the map, and the fraction.
    pub const fn delta_bits(self) -> u32 {
        self.words.height_bits + self.fraction_bits()
    }

    /// Bits of a bound, signed: the near border of a block may lie as many saturated distances
    /// behind the start as the block has texels, its far border as many beyond the bottom.
    pub const fn bound_bits(self) -> u32 {
        self.largest_block_level() + self.delta_bits() + 2
    }

    /// Bits of a texel's index, signed, not wrapped to the map: from a map behind the origin to a
    /// ray's travel and a block beyond the first repeat.
    pub const fn index_bits(self) -> u32 {
        let most = self.words.size() + self.words.travel() + (2 << self.largest_block_level());
        u32::BITS - most.leading_zeros() + 1
    }

    /// Bits of the way from an entry to a texel's border, signed.
    pub const fn way_bits(self) -> u32 {
        self.index_bits() + self.words.entry_fraction_bits + 1
    }

    /// Digits that the setup's division makes, one after another.
    pub const fn setup_digits(self) -> u32 {
        self.delta_bits()
    }

    /// More steps than any ray can take; a walk that gets there answers `guard`.
    ///
    /// On each level a ray leaves at most so many blocks and one on either axis, and each corner in
    /// doubt adds one. A texel that the leaf check refuses adds a step.
    pub const fn step_bound(self) -> u32 {
        let travel = self.words.travel();
        let mut bound = 4 * travel + 8;
        let mut n = 0;
        while n < self.line_levels() {
            bound += 4 * ((travel >> self.block_level(n)) + 2);
            n += 1;
        }
        bound
    }

    /// Bits of the step and crossing counters, signed.
    pub const fn counter_bits(self) -> u32 {
        u32::BITS - self.step_bound().leading_zeros() + 1
    }

    /// Bits of a line's address.
    pub const fn address_bits(self) -> u32 {
        self.lines().address_bits()
    }
}
