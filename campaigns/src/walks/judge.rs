//! The judge: the texels that a quantised ray passes, one by one.
//!
//! It follows the definition of a hit in words of 64 bits, without pyramid, mirroring or error
//! term, and so shares nothing with the walks it judges. A test holds it against
//! `rtl_model::exact::exact_hit`, which takes rays of any kind and is slower by far.

use rtl_model::maps::HeightMap;
use rtl_model::ray_format::{QuantisedRay, RayFormat};

/// The hit of a quantised ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TexelHit {
    /// Texel on u.
    pub i: u32,
    /// Texel on v.
    pub j: u32,
    /// Is it a hit on the texel's side? Else on its top.
    pub side: bool,
    /// The depth in height steps, times the denominator.
    pub depth_numerator: i64,
    /// At least 1.
    pub depth_denominator: i64,
}

/// One axis of the way: distances in the units of an entry.
struct Axis {
    texel: i64,
    /// Which way it goes: -1, 0 or 1.
    forward: i64,
    /// Magnitude of the slope.
    slope: i64,
    /// From the entry to the border that the texel is left by.
    distance: i64,
}

impl Axis {
    fn new(entry: i64, slope: i64, unit: i64) -> Axis {
        let (texel, within) = (entry.div_euclid(unit), entry.rem_euclid(unit));
        // A ray on a border belongs to the texel it travels into.
        let (texel, distance) = match slope < 0 {
            true if within == 0 => (texel - 1, unit),
            true => (texel, within),
            false => (texel, unit - within),
        };
        Axis {
            texel,
            forward: slope.signum(),
            slope: slope.abs(),
            distance,
        }
    }
}

/// Walks the texels of a map along a quantised ray, to its hit.
pub fn texel_walk(map: &HeightMap, format: &RayFormat, ray: &QuantisedRay) -> TexelHit {
    let unit = 1_i64 << format.entry_fraction_bits();
    let bits = map.bits();
    let full_height = (1_i64 << bits) - 1;
    let (mask, levels) = (i64::from(map.size()) - 1, map.levels());
    let heights = map.heights();
    let mut u = Axis::new(ray.u, ray.du, unit);
    let mut v = Axis::new(ray.v, ray.dv, unit);
    // The depth of the way so far, in height steps: a ratio.
    let (mut numerator, mut denominator) = (0, 1);
    loop {
        let (i, j) = (u.texel & mask, v.texel & mask);
        let depth = full_height - i64::from(heights[((j << levels) | i) as usize]);
        let hit = |side, depth_numerator, depth_denominator| TexelHit {
            i: i as u32,
            j: j as u32,
            side,
            depth_numerator,
            depth_denominator,
        };
        if depth * denominator <= numerator {
            return hit(true, numerator, denominator);
        }
        // Through an exact corner u is crossed first; an axis that stands still never is.
        let left = match u.distance * v.slope <= v.distance * u.slope {
            true => &mut u,
            false => &mut v,
        };
        // A border that is never reached has slope zero, and a depth times zero is within it.
        if depth * left.slope <= left.distance << bits {
            return hit(false, depth, 1);
        }
        (numerator, denominator) = (left.distance << bits, left.slope);
        left.texel += left.forward;
        left.distance += unit;
    }
}
