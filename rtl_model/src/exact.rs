//! The exact reference: the hit of a ray, by the definition, in integers that never round.
//!
//! It walks the texels of the map one after another in the order in which the ray enters them and
//! takes the first that is hit on its side or its top. It shares no code with any traversal: no
//! pyramid, no mirroring, no number format. A ray's four numbers are dyadic rationals, so with a
//! common power of two every border crossing is a ratio of two integers, and every decision the
//! comparison of two products.

use crate::maps::HeightMap;
use crate::ray::Ray;
use num_bigint::BigInt;
use std::cmp::Ordering;
use thiserror::Error;

/// A depth as a ratio of integers; the denominator is positive.
#[derive(Clone, Copy, Debug)]
pub struct ExactDepth {
    /// Above the line.
    pub numerator: i128,
    /// Below the line, at least 1.
    pub denominator: i128,
}

impl ExactDepth {
    /// Compares with a depth as a format holds it.
    pub fn compare_with(self, depth: f64) -> Ordering {
        self.compare_with_usual(depth)
            .unwrap_or_else(|| self.compare_with_any(depth))
    }

    /// The same for depths as they usually are: from `2^-74` to below `2^53`.
    fn compare_with_usual(self, depth: f64) -> Option<Ordering> {
        let exponent = i32::try_from(depth.to_bits() >> 52).ok()? - 1075;
        if self.numerator < 0 || !(-127..=0).contains(&exponent) {
            return None;
        }
        let significand = 1 << 52 | u128::from(depth.to_bits() & ((1 << 52) - 1));
        let left = wide_product(self.numerator.unsigned_abs(), 1 << -exponent);
        let right = wide_product(self.denominator.unsigned_abs(), significand);
        Some(left.cmp(&right))
    }

    fn compare_with_any(self, depth: f64) -> Ordering {
        let depth = num_rational::BigRational::from_float(depth).expect("a finite depth");
        let left = BigInt::from(self.numerator) * depth.denom();
        let right = BigInt::from(self.denominator) * depth.numer();
        left.cmp(&right)
    }

    /// The nearest `f64`, give or take a rounding.
    pub fn to_f64(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }
}

/// *The* hit of a ray.
#[derive(Clone, Copy, Debug)]
pub struct ExactHit {
    /// Texel on u, 0 to size - 1.
    pub i: u32,
    /// Texel on v, 0 to size - 1.
    pub j: u32,
    /// Depth of the hit.
    pub t: ExactDepth,
    /// Is it a hit on the texel's side? Else on its top.
    pub side: bool,
    /// Texels looked at, the one hit among them.
    pub texels: u64,
}

/// Why a ray has no exact answer.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum ExactError {
    /// A component is NaN or infinite.
    #[error("a ray component is not a finite number")]
    NotFinite,
    /// The ray's numbers span too many bits for this program's integers.
    #[error("a ray component is finer than 2^-{FINEST}: the exact reference does not go below")]
    TooFine,
    /// The ray's numbers are too large.
    #[error("a ray component is larger than 2^{LARGEST}: the exact reference does not go above")]
    TooLarge,
}

/// Ray components are multiples of 2^-`FINEST`.
const FINEST: i32 = 99;
/// Ray components are at most 2^`LARGEST` in magnitude, the reach of the unit on a map of a single
/// texel: with 12 bits of map size and `FINEST` fraction bits that is at most 2^125, and a border's
/// distance from an entry at most twice that.
const LARGEST: i32 = 14;

/// One axis of a ray: in units of texels / 2^scale.
struct Axis {
    /// Entry coordinate.
    start: i128,
    /// Offset for a unit of depth.
    direction: i128,
    /// Index of the texel the ray is in, not wrapped.
    texel: i128,
    /// log2 of the units in a texel.
    scale: u32,
}

impl Axis {
    fn new(start: i128, direction: i128, scale: u32) -> Axis {
        let unit = 1_i128 << scale;
        let texel = start.div_euclid(unit);
        let on_border = start.rem_euclid(unit) == 0;
        // A ray on a border belongs to the texel it travels into.
        let texel = if on_border && direction < 0 {
            texel - 1
        } else {
            texel
        };
        Axis {
            start,
            direction,
            texel,
            scale,
        }
    }

    /// The depth at which the ray leaves its texel on this axis; `None` if never.
    fn exit(&self) -> Option<ExactDepth> {
        let border = match self.direction.cmp(&0) {
            Ordering::Less => self.texel,
            Ordering::Equal => return None,
            Ordering::Greater => self.texel + 1,
        };
        let distance = (border << self.scale) - self.start;
        Some(ExactDepth {
            numerator: distance.abs(),
            denominator: self.direction.abs(),
        })
    }

    fn cross(&mut self) {
        self.texel += self.direction.signum();
    }
}

/// The hit of a ray in a map, exactly. The ray is taken as it stands, bit for bit.
///
/// # Errors
/// If the ray is not finite, or its numbers do not fit the integers used here.
pub fn exact_hit(map: &HeightMap, ray: Ray<f64>) -> Result<ExactHit, ExactError> {
    let parts = [
        dyadic(ray.u)?,
        dyadic(ray.v)?,
        dyadic(ray.du)?,
        dyadic(ray.dv)?,
    ];
    let scale = parts
        .iter()
        .map(|part| part.fraction_bits)
        .max()
        .unwrap_or(0);
    let [u, v, du, dv] = parts.map(|part| {
        part.mantissa * (1_i128 << (scale - part.fraction_bits)) * i128::from(map.size())
    });
    let mut axis_u = Axis::new(u, du, scale);
    let mut axis_v = Axis::new(v, dv, scale);
    let full_height = (1_i128 << map.bits()) - 1;
    let mut entry = ExactDepth {
        numerator: 0,
        denominator: 1,
    };
    let mut texels = 0;
    loop {
        texels += 1;
        let i = axis_u.texel.rem_euclid(i128::from(map.size())) as u32;
        let j = axis_v.texel.rem_euclid(i128::from(map.size())) as u32;
        let depth = ExactDepth {
            numerator: full_height - i128::from(map.height(i.into(), j.into())),
            denominator: full_height,
        };
        let hit = |t, side| {
            Ok(ExactHit {
                i,
                j,
                t,
                side,
                texels,
            })
        };
        if compare(depth, entry) != Ordering::Greater {
            return hit(entry, true);
        }
        let (exit_u, exit_v) = (axis_u.exit(), axis_v.exit());
        // Through an exact corner the ray crosses u first.
        let u_first = match (exit_u, exit_v) {
            (Some(exit_u), Some(exit_v)) => compare(exit_u, exit_v) != Ordering::Greater,
            (exit_u, _) => exit_u.is_some(),
        };
        let exit = if u_first { exit_u } else { exit_v };
        match exit {
            Some(exit) if compare(depth, exit) == Ordering::Greater => {
                if u_first {
                    axis_u.cross()
                } else {
                    axis_v.cross()
                }
                entry = exit;
            }
            _ => return hit(depth, false),
        }
    }
}

/// Compares two depths: the cross products, each of up to 254 bits.
fn compare(a: ExactDepth, b: ExactDepth) -> Ordering {
    let product = |x: i128, y: i128| wide_product(x.unsigned_abs(), y.unsigned_abs());
    // Depths along a walk are never negative.
    debug_assert!(a.numerator >= 0 && b.numerator >= 0);
    product(a.numerator, b.denominator).cmp(&product(b.numerator, a.denominator))
}

/// `a * b` as (high, low) 128-bit halves.
fn wide_product(a: u128, b: u128) -> (u128, u128) {
    const LOW: u128 = u64::MAX as u128;
    if let Some(product) = a.checked_mul(b) {
        return (0, product);
    }
    let (a_high, a_low) = (a >> 64, a & LOW);
    let (b_high, b_low) = (b >> 64, b & LOW);
    let low = a_low * b_low;
    let middle = a_high * b_low + (low >> 64);
    let other_middle = a_low * b_high + (middle & LOW);
    let high = a_high * b_high + (middle >> 64) + (other_middle >> 64);
    (high, (other_middle << 64) | (low & LOW))
}

/// `mantissa / 2^fraction_bits`.
#[derive(Clone, Copy)]
struct Dyadic {
    mantissa: i128,
    fraction_bits: u32,
}

fn dyadic(value: f64) -> Result<Dyadic, ExactError> {
    if !value.is_finite() {
        return Err(ExactError::NotFinite);
    }
    if value.abs() > 2_f64.powi(LARGEST) {
        return Err(ExactError::TooLarge);
    }
    // Scaling by a power of two is exact, so what is left behind the point is seen exactly.
    let scaled = value * 2_f64.powi(FINEST);
    if scaled.fract() != 0.0 {
        return Err(ExactError::TooFine);
    }
    let mut mantissa = scaled as i128;
    let mut fraction_bits = FINEST as u32;
    let spare = mantissa.trailing_zeros().min(fraction_bits);
    mantissa >>= spare;
    fraction_bits -= spare;
    Ok(Dyadic {
        mantissa,
        fraction_bits,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A map of four texels a side: all at the bottom but for the named ones at full height.
    fn towers(texels: &[(u32, u32)]) -> HeightMap {
        let mut heights = vec![0_u16; 16];
        for &(i, j) in texels {
            heights[(j * 4 + i) as usize] = 255;
        }
        HeightMap::new("towers", 4, 8, heights).expect("a square map")
    }

    fn ray(u: f64, v: f64, du: f64, dv: f64) -> Ray<f64> {
        Ray { u, v, du, dv }
    }

    #[test]
    fn depths_compare_the_same_by_both_ways() {
        let (mut usual, mut order) = (0, [0; 3]);
        for n in 1..2000_i128 {
            let denominator = n * n * 0x1_0001 + 1;
            let numerator = denominator / (n % 37 + 1);
            let exact = ExactDepth {
                numerator: numerator << (n % 60),
                denominator: denominator << (n % 60),
            };
            let near = exact.to_f64();
            for depth in [
                near,
                near.next_up(),
                near.next_down(),
                0.5,
                1.0,
                0.0,
                -near,
                1e-30,
            ] {
                let told = exact.compare_with(depth);
                assert_eq!(told, exact.compare_with_any(depth), "{exact:?} {depth}");
                usual += i32::from(exact.compare_with_usual(depth) == Some(told));
                order[(told as i32 + 1) as usize] += 1;
            }
        }
        assert!(
            usual > 8000 && order.iter().all(|&count| count > 100),
            "{usual} {order:?}"
        );
    }

    #[test]
    fn a_vertical_ray_hits_the_top_it_stands_over() {
        let hit = exact_hit(&towers(&[]), ray(0.3, 0.8, 0.0, 0.0)).unwrap();
        assert_eq!((hit.i, hit.j, hit.side, hit.texels), (1, 3, false, 1));
        assert_eq!(hit.t.compare_with(1.0), Ordering::Equal);
    }

    #[test]
    fn a_tower_is_hit_on_its_side() {
        let hit = exact_hit(&towers(&[(2, 0)]), ray(0.0, 0.125, 2.0, 0.0)).unwrap();
        assert_eq!((hit.i, hit.j, hit.side, hit.texels), (2, 0, true, 3));
        assert_eq!(hit.t.compare_with(0.25), Ordering::Equal);
    }

    #[test]
    fn a_ray_on_a_border_belongs_to_the_texel_it_travels_into() {
        let map = towers(&[(0, 0), (1, 1)]);
        // Travelling left from the border at 0.25, it starts in texel 0, a tower.
        let hit = exact_hit(&map, ray(0.25, 0.0, -1.0, 0.0)).unwrap();
        assert_eq!((hit.i, hit.j, hit.side, hit.texels), (0, 0, true, 1));
        // Not moving on u, it belongs to texel 1, to the right.
        let hit = exact_hit(&map, ray(0.25, 0.0, 0.0, 1.0)).unwrap();
        assert_eq!((hit.i, hit.j, hit.texels), (1, 1, 2));
    }

    #[test]
    fn through_a_corner_u_is_crossed_first() {
        // The diagonal from the origin passes the corner (1, 1): the texel between is (1, 0),
        // never (0, 1).
        let hit = exact_hit(&towers(&[(1, 0)]), ray(0.0, 0.0, 1.0, 1.0)).unwrap();
        assert_eq!((hit.i, hit.j, hit.side), (1, 0, true));
        let hit = exact_hit(&towers(&[(0, 1), (1, 1)]), ray(0.0, 0.0, 1.0, 1.0)).unwrap();
        assert_eq!((hit.i, hit.j, hit.side), (1, 1, true));
    }

    #[test]
    fn the_map_wraps_both_ways() {
        let hit = exact_hit(&towers(&[(3, 2)]), ray(0.1, 0.6, -1.0, 0.0)).unwrap();
        assert_eq!((hit.i, hit.j, hit.side, hit.texels), (3, 2, true, 2));
        let hit = exact_hit(&towers(&[(0, 2)]), ray(0.9, 0.6, 1.0, 0.0)).unwrap();
        assert_eq!((hit.i, hit.j, hit.side, hit.texels), (0, 2, true, 2));
    }

    #[test]
    fn products_of_any_width_compare_rightly() {
        let cases = [
            0,
            1,
            3,
            (1 << 64) - 1,
            1 << 64,
            (1_u128 << 100) + 7,
            u128::MAX >> 1,
        ];
        for a in cases {
            for b in cases {
                let big = BigInt::from(a) * BigInt::from(b);
                let (high, low) = wide_product(a, b);
                assert_eq!((BigInt::from(high) << 128_u32) + BigInt::from(low), big);
            }
        }
    }

    #[test]
    fn rays_beyond_the_integers_are_refused() {
        let map = towers(&[]);
        let refused = |u, du| exact_hit(&map, ray(u, 0.0, du, 0.0)).unwrap_err();
        assert_eq!(refused(f64::NAN, 0.0), ExactError::NotFinite);
        assert_eq!(refused(0.0, 2_f64.powi(-101)), ExactError::TooFine);
        assert_eq!(refused(0.0, 1e9), ExactError::TooLarge);
        assert_eq!(refused(0.0, 2_f64.powi(14).next_up()), ExactError::TooLarge);
    }

    #[test]
    fn the_reach_of_the_unit_is_within_the_integers() {
        let spike = HeightMap::new("spike", 1, 8, vec![102]).unwrap();
        let reach = 2_f64.powi(14);
        let hit = exact_hit(&spike, ray(2_f64.powi(-99), reach, reach, -reach)).unwrap();
        assert_eq!((hit.i, hit.j, hit.side), (0, 0, false));
        assert_eq!(hit.t.numerator * 5, hit.t.denominator * 3);
    }
}
