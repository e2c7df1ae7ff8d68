//! What tells the pyramid traversals apart: where a walk starts, how far it goes down at once, and
//! when it goes up again. Everything else (where the ray is, what it meets) is one walking core.
//!
//! The rules are those of the project's notes on the papers, settled by measurement.

/// Where a walk starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Start {
    /// At the root of the pyramid.
    Root,
    /// At the lowest node that holds the whole ray: its level is the bit length of the larger
    /// exclusive or of entry and exit texel index; the root where the ray leaves the tile
    /// (the 2013 hardware paper, 3.1).
    WholeRay,
    /// At the texel that the ray enters.
    Texel,
}

/// When a walk goes a level up: always together with a crossing, in one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Ascent {
    /// Never (Oh et al. 2006).
    Never,
    /// Where the index of the border crossed, in units of its level, is even (Tevs et al. 2008).
    EvenBorder,
    /// At every crossing (Drobot 2010).
    Always,
    /// As `EvenBorder`, but not where the predicted position (that at the node's depth) lies in a
    /// neighbour: the larger of the index differences on both axes is 1 (2013 paper, 3.3, c1).
    Selective,
    /// Where the step before was a crossing at this level too (2013 paper, 3.3, c2).
    Coherent,
}

/// A pyramid traversal that looks at a node a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SearchPolicy {
    /// Where it starts.
    pub start: Start,
    /// Levels that it goes down at once, 1 to 4, until its first crossing and where so many are
    /// left; else one (2013 paper, 3.2).
    pub levels_down: u32,
    /// When it goes up.
    pub ascent: Ascent,
}

impl SearchPolicy {
    /// That of method `oh`: from the root, a level at a time, never up.
    pub const OH: SearchPolicy = SearchPolicy {
        start: Start::Root,
        levels_down: 1,
        ascent: Ascent::Never,
    };

    /// Can a walk get behind a border by going up and down again? Then it must remember the last
    /// one it crossed: a rounded position does not tell on which side of it the walk is.
    pub const fn remembers_borders(self) -> bool {
        matches!(self.ascent, Ascent::Always | Ascent::Coherent)
    }

    /// Must it know whether the step before crossed too?
    pub const fn remembers_crossing(self) -> bool {
        matches!(self.ascent, Ascent::Coherent)
    }

    /// Does it look at nothing but the map, level 0?
    pub const fn is_flat(self) -> bool {
        matches!((self.start, self.ascent), (Start::Texel, Ascent::Never))
    }
}
