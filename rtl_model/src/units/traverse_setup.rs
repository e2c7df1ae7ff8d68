//! What is done to a ray once, before its first step.
//!
//! The walk is written for rays that travel toward larger u and v. A ray that travels the other way
//! on an axis is mirrored there: its coordinate and its direction change sign, and a node index i
//! becomes -1 - i, all bits inverted. Mirroring is exact, costs a few gates, and halves the
//! cases of the walk; ties come out right by themselves, since "the texel it travels into" is
//! always the one above the border.

use super::search_policy::SearchPolicy;
use super::traverse_shape::TraverseShape;
use super::traverse_start::start_node;
use crate::arith::Arith;

/// The registers a ray carries unchanged from step to step.
#[derive(Debug)]
pub struct RayRegisters<A: Arith> {
    /// Entry coordinate, mirrored: -1 to 1, zero or above where `du` was not negative.
    pub u: A::Num,
    /// Entry coordinate on the other axis, mirrored.
    pub v: A::Num,
    /// Offset for one unit of depth, zero or above.
    pub du: A::Num,
    /// Offset on the other axis, zero or above.
    pub dv: A::Num,
    /// Differences of a node border and u are exact below this power of two.
    pub exact_below_u: A::Num,
    /// Differences of a node border and v are exact below this power of two.
    pub exact_below_v: A::Num,
    /// Was u mirrored?
    pub mirror_u: A::Bit,
    /// Was v mirrored?
    pub mirror_v: A::Bit,
}

impl<A: Arith> Clone for RayRegisters<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for RayRegisters<A> {}

/// A ray as its registers hold it, and the node its walk starts at. Of a start at the root the
/// index is 0 on either axis, or -1 where a mirrored coordinate lies below zero.
#[derive(Debug)]
pub struct SetUpRay<A: Arith> {
    /// What stays.
    pub ray: RayRegisters<A>,
    /// Level of the start node.
    pub level: A::Int,
    /// Its index on u.
    pub i: A::Int,
    /// Its index on v.
    pub j: A::Int,
}

/// Mirrors a ray with u and v in [0, 1), exactly: no operation rounds. Finds the node its walk
/// starts at; of that, only the ray's end is rounded, and nothing but steps depends on it.
pub fn traverse_setup<A: Arith>(
    a: &mut A,
    shape: TraverseShape,
    policy: SearchPolicy,
    u: A::Num,
    v: A::Num,
    du: A::Num,
    dv: A::Num,
) -> SetUpRay<A> {
    let (ray, root) = mirror_ray(a, u, v, du, dv);
    let start = start_node(a, shape, policy, &ray, root);
    SetUpRay {
        ray,
        level: start.level,
        i: start.i,
        j: start.j,
    }
}

/// The ray mirrored, and the index of its root node on u and on v.
pub(super) fn mirror_ray<A: Arith>(
    a: &mut A,
    u: A::Num,
    v: A::Num,
    du: A::Num,
    dv: A::Num,
) -> (RayRegisters<A>, (A::Int, A::Int)) {
    let (mirror_u, u, du, i) = mirror_axis(a, &AXIS_U, u, du);
    let (mirror_v, v, dv, j) = mirror_axis(a, &AXIS_V, v, dv);
    let exact_below_u = a.exact_below(u);
    a.name_num("exact_below_u", exact_below_u);
    let exact_below_v = a.exact_below(v);
    a.name_num("exact_below_v", exact_below_v);
    let ray = RayRegisters {
        u,
        v,
        du,
        dv,
        exact_below_u,
        exact_below_v,
        mirror_u,
        mirror_v,
    };
    (ray, (i, j))
}

struct AxisNames {
    mirror: &'static str,
    coordinate: &'static str,
    direction: &'static str,
    below_zero: &'static str,
    root: &'static str,
}

const AXIS_U: AxisNames = AxisNames {
    mirror: "mirror_u",
    coordinate: "mirrored_u",
    direction: "magnitude_du",
    below_zero: "below_zero_u",
    root: "root_i",
};
const AXIS_V: AxisNames = AxisNames {
    mirror: "mirror_v",
    coordinate: "mirrored_v",
    direction: "magnitude_dv",
    below_zero: "below_zero_v",
    root: "root_j",
};

fn mirror_axis<A: Arith>(
    a: &mut A,
    names: &AxisNames,
    coordinate: A::Num,
    direction: A::Num,
) -> (A::Bit, A::Num, A::Num, A::Int) {
    let mirror = a.is_negative(direction);
    a.name_bit(names.mirror, mirror);
    let mirrored = a.negate_if(mirror, coordinate);
    a.name_num(names.coordinate, mirrored);
    let magnitude = a.magnitude(direction);
    a.name_num(names.direction, magnitude);
    let below_zero = a.is_negative(mirrored);
    a.name_bit(names.below_zero, below_zero);
    let zero = a.int_constant(0);
    let root = a.int_complement_if(below_zero, zero);
    a.name_int(names.root, root);
    (mirror, mirrored, magnitude, root)
}
