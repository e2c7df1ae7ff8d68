//! How much earlier than the exact hit an answer can be.
//!
//! No safe traversal is ever later than the exact hit of the ray as its format holds it. How much
//! earlier it can be is bounded here, for each format, by the roundings of its datapath.
//!
//! # Floats
//!
//! In units in the last place of the depth answered (`2^-(Y+1)` for the depths from 1/2 to 1 of
//! `eXfY`, and less above):
//!
//! - the depth of a border is computed from below, within [`ROUNDED_EXIT_ULPS`] units, that of the
//!   nearer of two borders in doubt therefore within twice as many; that of a surface is rounded
//!   toward the ray, by less than one. So an answer on the texel of the exact hit is earlier by at
//!   most [`SAME_TEXEL_ULPS`] units;
//! - an answer on another texel is one that the walk visited on its path before the exact hit, since
//!   in doubt it visits both. A node is visited in doubt if the ray passes a corner within the
//!   bounds of its borders, or is left late if its surface lies between the bounds of an exit, or if
//!   the position was rounded back across a midline (two roundings, of at most two units each where
//!   the depth's significand is small). The ray misses such a texel by less than it travels within
//!   [`MISSED_TEXEL_ULPS`] units of depth.
//!
//! # The others
//!
//! In exact numbers and in fixed point the texel is the very one. The depth of the exact format is
//! printed to the nearest `f64`, which may be above it; that of fixed point is rounded down, by
//! less than one unit in the last place of an `f64`. `f64` itself rounds to nearest, as programs
//! do, and so promises nothing; on real maps it is found to hit the very texel.

use std::fmt;

use crate::scene::{Crossing, Family, Walk, WalkFormat};
use crate::units::traverse_step::ROUNDED_EXIT_ULPS;

/// The most units in the last place by which a float's answer on the right texel is early.
pub const SAME_TEXEL_ULPS: u32 = 2 * ROUNDED_EXIT_ULPS;

/// The most units in the last place of depth within which a ray travels as far as it misses a
/// texel that a float answers.
pub const MISSED_TEXEL_ULPS: u32 = 2 * ROUNDED_EXIT_ULPS + 2;

/// A bound on how much earlier than the exact hit of the ray as entered an answer can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EarlyBound {
    /// The very texel; the depth is the nearest number that an `f64` holds.
    Nearest,
    /// The very texel; the depth is less than one unit in the last place of an `f64` early.
    LastPlace,
    /// Nothing is promised.
    Measured,
    /// Methods that sample, or that derive a node from a rounded position, promise nothing.
    None,
    /// A float's bound.
    Float {
        /// On the texel of the exact hit: so much of the depth, at most.
        depth: f64,
        /// Else an earlier texel, which the ray misses by at most so many texels.
        missed_texels: f64,
    },
}

impl EarlyBound {
    /// The bound for a walk of rays that travel at most so many texels on an axis, from top to
    /// bottom.
    pub fn of(walk: Walk, most_texels: f64) -> EarlyBound {
        if matches!(walk.method.family(), Family::Linear(_))
            || matches!(walk.crossing, Crossing::Offset(_))
        {
            return EarlyBound::None;
        }
        match walk.format {
            WalkFormat::Exact => EarlyBound::Nearest,
            WalkFormat::Fixed(_) => EarlyBound::LastPlace,
            WalkFormat::F64 => EarlyBound::Measured,
            WalkFormat::Float(format) => {
                // A depth below 1 has units of half the format's precision at most.
                let unit = 0.5_f64.powi(format.fraction_bits as i32 + 1);
                EarlyBound::Float {
                    depth: f64::from(SAME_TEXEL_ULPS) * unit,
                    missed_texels: f64::from(MISSED_TEXEL_ULPS) * unit * most_texels,
                }
            }
        }
    }
}

impl fmt::Display for EarlyBound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EarlyBound::Nearest => f.write_str("none: the very texel, t to the nearest f64"),
            EarlyBound::LastPlace => f.write_str("none: the very texel, t rounded down to an f64"),
            EarlyBound::Measured => f.write_str(
                "not promised in f64, which rounds to nearest; measured: the very texel",
            ),
            EarlyBound::None => f.write_str("not promised: this way of walking may miss"),
            EarlyBound::Float {
                depth,
                missed_texels,
            } => write!(
                f,
                "{SAME_TEXEL_ULPS} units in the last place of t ({depth:.1e}) on the same texel, \
                 else an earlier texel, missed by at most {missed_texels:.1e} texels"
            ),
        }
    }
}
