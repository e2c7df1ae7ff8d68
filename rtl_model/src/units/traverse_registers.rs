//! The registers of a walk, and what they hold before its first step.

use super::search_policy::SearchPolicy;
use super::traverse_setup::SetUpRay;
use super::traverse_shape::{INDEX_BITS, SHIFT_BITS};
use crate::arith::Arith;

/// The registers of a walk that change from step to step.
#[derive(Debug)]
pub struct WalkRegisters<A: Arith> {
    /// Level of the node looked at; 0 is the map itself.
    pub level: A::Int,
    /// Index of the node on u, mirrored where the ray is, not wrapped to the map.
    pub i: A::Int,
    /// Index of the node on v.
    pub j: A::Int,
    /// Depth reached: never later than the ray truly is.
    pub t: A::Num,
    /// The depth t is that at which a border of v was crossed.
    pub at_border_v: A::Bit,
    /// A corner was in doubt and u was crossed first: the node across the corner is owed a visit.
    pub corner_owed: A::Bit,
    /// The visit across the corner is being paid: the next crossing goes behind the corner.
    pub corner_paid: A::Bit,
    /// The borders passed, where the policy remembers them
    /// ([`SearchPolicy::remembers_borders`]).
    pub passed: Option<PassedBorders<A>>,
    /// The step before crossed into this node without going up, where the policy asks
    /// ([`SearchPolicy::remembers_crossing`]).
    pub crossed_before: Option<A::Bit>,
    /// Steps taken.
    pub steps: A::Int,
    /// Node crossings among them.
    pub crossings: A::Int,
    /// The walk has ended in a hit: level 0, node (i, j), depth t.
    pub hit: A::Bit,
    /// The walk has ended at the step bound.
    pub guard: A::Bit,
}

impl<A: Arith> Clone for WalkRegisters<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for WalkRegisters<A> {}

/// The last border passed on either axis, in texels, mirrored where the ray is: the first texel
/// that the ray can still be in.
#[derive(Debug)]
pub struct PassedBorders<A: Arith> {
    /// On u.
    pub i: A::Int,
    /// On v.
    pub j: A::Int,
}

impl<A: Arith> Clone for PassedBorders<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for PassedBorders<A> {}

/// The walk's registers before its first step: at its start node, at depth 0.
pub fn walk_start<A: Arith>(
    a: &mut A,
    policy: SearchPolicy,
    setup: &SetUpRay<A>,
) -> WalkRegisters<A> {
    let no = a.bit_constant(false);
    let none = a.int_constant(0);
    let passed = policy.remembers_borders().then(|| {
        let mut near_border = |name, index| {
            let border = a.int_shift_left(index, setup.level, SHIFT_BITS);
            // A start node lies in the first repeat of the map, or in that before it.
            let border = a.int_wrap(border, INDEX_BITS);
            a.name_int(name, border);
            border
        };
        PassedBorders {
            i: near_border("start_border_i", setup.i),
            j: near_border("start_border_j", setup.j),
        }
    });
    WalkRegisters {
        level: setup.level,
        i: setup.i,
        j: setup.j,
        t: a.zero(),
        at_border_v: no,
        corner_owed: no,
        corner_paid: no,
        passed,
        crossed_before: policy.remembers_crossing().then_some(no),
        steps: none,
        crossings: none,
        hit: no,
        guard: no,
    }
}
