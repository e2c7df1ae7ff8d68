//! The numbers of the exact fixed-point walk: how a ray is quantised, once, before every decision
//! about it is exact.
//!
//! An entry is a texel coordinate with [`RayFormat::entry_fraction_bits`] fraction bits, truncated,
//! so that it stays in its texel. A slope is texels per height step, in the signed format that
//! gives the walk its name, rounded to nearest (ties away from zero, so that a mirrored ray is the
//! mirrored quantised ray). `docs/fixed_walk.md` says why the widths are what they are.

use std::fmt;

use thiserror::Error;

use crate::arith::Arith;
use crate::fixed::FixedFormat;
use crate::float::Rounding::NearestEven;
use crate::maps::Pyramid;
use crate::ray::{REACH_TEXELS, Ray};
use crate::readings::{Interval, IntervalReading};
use crate::units::fixed_shape::FixedShape;

/// Fraction bits of a texel in an entry coordinate, unless a format says otherwise: an entry is off
/// by less than 1/4096 of a texel.
pub const ENTRY_FRACTION_BITS: u32 = 12;

/// The most bits that a word of the walk may have: sums of two of them are still made in 64.
const MOST_WORD_BITS: u32 = 62;

/// The formats of the exact fixed-point walk through a map, and where they come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayFormat {
    /// Texels per height step, signed.
    pub slope: FixedFormat,
    /// Level of the pyramid's root.
    root_level: u32,
    /// Bits of a height.
    height_bits: u32,
    choice: Choice,
}

/// Who chose a format, and from what.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Choice {
    /// It was asked for.
    Told,
    /// It holds every ray that a unit walks.
    Reach,
    /// It holds rays whose slopes, in units of the last place, reach so far.
    Rays { steepest: i128 },
}

/// A format in which there is no exact fixed-point walk through a map.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RayFormatError {
    /// No fraction of a texel would be left for an entry.
    #[error(
        "format {format}: over heights of {height_bits} bits a slope needs at least {height_bits} \
         fraction bits, such as q{integer_bits}.{usual}; or take `fixed`"
    )]
    TooCoarse {
        /// The format.
        format: FixedFormat,
        /// Bits of a height.
        height_bits: u32,
        /// The integer bits asked for.
        integer_bits: u32,
        /// The fraction bits that `fixed` takes.
        usual: u32,
    },
    /// The walk would need longer words than there are.
    #[error(
        "format {format}: on a {size} x {size} map the words of the walk would have {bits} bits, more \
         than {MOST_WORD_BITS}: take fewer bits, or `fixed`"
    )]
    TooFine {
        /// The format.
        format: FixedFormat,
        /// The map's texels on a side.
        size: u32,
        /// Bits of the longest word.
        bits: u32,
    },
}

/// A ray in the integers of a [`RayFormat`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QuantisedRay {
    /// Entry: texels times `2^entry_fraction_bits`, from 0 to below the map's size.
    pub u: i64,
    /// Entry on the other axis.
    pub v: i64,
    /// Slope: texels per height step times `2^fraction_bits`.
    pub du: i64,
    /// Slope on the other axis.
    pub dv: i64,
    /// Was a slope beyond the format, and made its largest number of that sign?
    pub saturated: bool,
}

/// The range of each number of some rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayRange(Ray<Interval>);

impl RayRange {
    /// The range of one ray.
    pub fn of(ray: Ray<f64>) -> RayRange {
        RayRange(ray.map(Interval::point))
    }

    /// The smallest range that holds both.
    pub fn and(self, other: RayRange) -> RayRange {
        RayRange(Ray {
            u: self.0.u.hull(other.0.u),
            v: self.0.v.hull(other.0.v),
            du: self.0.du.hull(other.0.du),
            dv: self.0.dv.hull(other.0.dv),
        })
    }

    /// The most texels that a ray of the range travels on an axis, on a map of so many on a side.
    pub fn most_texels(&self, size: u32) -> f64 {
        let most = [self.0.du, self.0.dv].map(|range| range.low.abs().max(range.high.abs()));
        most[0].max(most[1]) * f64::from(size)
    }

    /// The range of each number.
    pub fn intervals(&self) -> Ray<Interval> {
        self.0
    }
}

impl RayFormat {
    /// The walk through the map of `pyramid` with slopes in this format.
    ///
    /// # Errors
    /// A format with less fraction bits than a height has bits, or one in which the words of the
    /// walk grow too long; an unsigned one is told by its smallest number, zero.
    ///
    /// # Panics
    /// If the format is unsigned.
    pub fn told(format: FixedFormat, pyramid: &Pyramid) -> Result<RayFormat, RayFormatError> {
        RayFormat::checked(format, pyramid.levels(), pyramid.bits(), Choice::Told)
    }

    /// The format that holds every ray within the reach of all units ([`REACH_TEXELS`]).
    pub fn within_reach(pyramid: &Pyramid) -> RayFormat {
        let (root_level, height_bits) = (pyramid.levels(), pyramid.bits());
        let fraction_bits = ENTRY_FRACTION_BITS + height_bits;
        let steepest = steepest_within_reach(height_bits, fraction_bits);
        RayFormat {
            slope: holding(steepest.into(), fraction_bits),
            root_level,
            height_bits,
            choice: Choice::Reach,
        }
    }

    /// The narrowest format that holds all rays of a range: the interval reading of the quantiser
    /// says how far their slopes go.
    pub fn for_rays(range: &RayRange, pyramid: &Pyramid) -> RayFormat {
        let widest = RayFormat::within_reach(pyramid);
        let mut reading = IntervalReading::default();
        let slopes = quantised(&mut reading, widest.shape(), range.intervals());
        let steepest = [slopes.du, slopes.dv]
            .map(|slope| slope.low.abs().max(slope.high.abs()))
            .into_iter()
            .fold(0, i128::max);
        RayFormat {
            slope: holding(steepest, widest.slope.fraction_bits),
            choice: Choice::Rays { steepest },
            ..widest
        }
    }

    fn checked(
        format: FixedFormat,
        root_level: u32,
        height_bits: u32,
        choice: Choice,
    ) -> Result<RayFormat, RayFormatError> {
        assert!(format.signed, "a slope has a sign");
        if format.fraction_bits < height_bits {
            return Err(RayFormatError::TooCoarse {
                format,
                height_bits,
                integer_bits: format.integer_bits,
                usual: height_bits + ENTRY_FRACTION_BITS,
            });
        }
        let checked = RayFormat {
            slope: format,
            root_level,
            height_bits,
            choice,
        };
        // A position is the longest word of a long fraction, whatever the slope; beyond, the other
        // lengths need not be known.
        let position = crate::units::traverse_step::INDEX_BITS + format.fraction_bits;
        let bits = if position > MOST_WORD_BITS {
            position
        } else {
            position.max(checked.shape().error_bits())
        };
        if bits > MOST_WORD_BITS {
            return Err(RayFormatError::TooFine {
                format,
                size: 1 << root_level,
                bits,
            });
        }
        Ok(checked)
    }

    /// Fraction bits of a texel in an entry coordinate.
    pub const fn entry_fraction_bits(&self) -> u32 {
        self.slope.fraction_bits - self.height_bits
    }

    /// The format of an entry coordinate, in texels.
    pub const fn entry(&self) -> FixedFormat {
        let fraction_bits = self.entry_fraction_bits();
        // A map of one texel, with entries of whole texels, still has a bit.
        let integer_bits = if self.root_level + fraction_bits == 0 {
            1
        } else {
            self.root_level
        };
        FixedFormat::uq(integer_bits, fraction_bits)
    }

    /// The words of the walk.
    pub fn shape(&self) -> FixedShape {
        let within_reach = steepest_within_reach(self.height_bits, self.slope.fraction_bits);
        FixedShape {
            root_level: self.root_level,
            height_bits: self.height_bits,
            entry_fraction_bits: self.entry_fraction_bits(),
            slope_bits: (self.slope.width() - 1).min(64 - within_reach.leading_zeros()),
        }
    }

    /// The largest magnitude of a slope, in units of its last place.
    pub fn steepest(&self) -> i64 {
        (1 << self.shape().slope_bits) - 1
    }

    /// An admitted ray (see [`crate::ray::check`]) in the format's integers.
    #[inline]
    pub fn quantise(&self, ray: Ray<f64>) -> QuantisedRay {
        let size = f64::from(1_u32 << self.root_level);
        // Scaling by a power of two is exact.
        let entry =
            |coordinate: f64| (coordinate * size * power_of_two(self.entry_fraction_bits())) as i64;
        let unit = size * power_of_two(self.slope.fraction_bits);
        let full_height = ((1_u32 << self.height_bits) - 1).into();
        let steepest = self.steepest();
        let slope = |direction: f64| {
            let magnitude = nearest_quotient(direction.abs() * unit, full_height);
            let saturated = magnitude > steepest;
            let magnitude = magnitude.min(steepest);
            let slope = if direction < 0.0 {
                -magnitude
            } else {
                magnitude
            };
            (slope, saturated)
        };
        let ((du, du_saturated), (dv, dv_saturated)) = (slope(ray.du), slope(ray.dv));
        QuantisedRay {
            u: entry(ray.u),
            v: entry(ray.v),
            du,
            dv,
            saturated: du_saturated | dv_saturated,
        }
    }

    /// The quantised ray as four `f64`, exactly: the ray that hits are judged by.
    pub fn entered(&self, ray: &QuantisedRay) -> Ray<f64> {
        let size = f64::from(1_u32 << self.root_level);
        let entry = |entry: i64| entry as f64 / power_of_two(self.entry_fraction_bits()) / size;
        let full_height = (1_i64 << self.height_bits) - 1;
        let direction = |slope: i64| {
            (slope * full_height) as f64 / power_of_two(self.slope.fraction_bits) / size
        };
        Ray {
            u: entry(ray.u),
            v: entry(ray.v),
            du: direction(ray.du),
            dv: direction(ray.dv),
        }
    }

    /// Why these formats: a line each for the range of a slope, its fraction, and an entry.
    pub fn reasons(&self) -> [String; 3] {
        let full_height = (1_u32 << self.height_bits) - 1;
        let most = power_of_two(self.slope.integer_bits - 1);
        let integer_bits = self.slope.integer_bits;
        let range = match self.choice {
            Choice::Told => format!(
                "{integer_bits} integer bits as told: slopes below {most} texels per height step"
            ),
            Choice::Reach => format!(
                "{integer_bits} integer bits: slopes are at most {:.3} texels per height step, \
                 {REACH_TEXELS} texels from top to bottom being the reach of every unit",
                REACH_TEXELS / f64::from(full_height)
            ),
            Choice::Rays { steepest } => format!(
                "{integer_bits} integer bits: the slopes of these rays are at most {:.6} texels per \
                 height step (interval arithmetic), so they are below {most}",
                steepest as f64 / power_of_two(self.slope.fraction_bits)
            ),
        };
        let (fraction, entry) = (self.slope.fraction_bits, self.entry_fraction_bits());
        let parts = power_of_two(entry);
        [
            range,
            format!(
                "{fraction} fraction bits, {entry} of an entry and {} of a height: over all \
                 {full_height} height steps a slope rounded to nearest moves the ray by less than \
                 half of 1/{parts} texel",
                self.height_bits
            ),
            format!(
                "entries {}, truncated: less than 1/{parts} texel",
                self.entry()
            ),
        ]
    }
}

impl fmt::Display for RayFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "slopes {}, entries {}", self.slope, self.entry())
    }
}

/// The quantiser as a datapath: the definition, of which [`RayFormat::quantise`] is the quick form.
/// Slopes beyond the format saturate. Exact in the exact reading alone.
pub fn quantised<A: Arith>(a: &mut A, shape: FixedShape, ray: Ray<A::Num>) -> Ray<A::Int> {
    let entry = |a: &mut A, coordinate: A::Num| {
        let texels = a.scale(
            coordinate,
            (shape.root_level + shape.entry_fraction_bits) as i32,
        );
        a.floor(texels, shape.entry_bits())
    };
    let slope = |a: &mut A, direction: A::Num| {
        let negative = a.is_negative(direction);
        let magnitude = a.magnitude(direction);
        let texels = a.scale(magnitude, (shape.root_level + shape.fraction_bits()) as i32);
        let full_height = a.int_constant(shape.full_height());
        let zero = a.int_constant(0);
        let full_height = a.number_from_integer(NearestEven, full_height, zero);
        let a_step = a.div(NearestEven, texels, full_height);
        let one = a.int_constant(1);
        let one = a.number_from_integer(NearestEven, one, zero);
        let half = a.scale(one, -1);
        let rounded = a.add(NearestEven, a_step, half);
        let magnitude = a.floor(rounded, shape.slope_bits + 1);
        let opposite = a.int_sub(zero, magnitude);
        a.int_select(negative, opposite, magnitude)
    };
    let u = entry(a, ray.u);
    a.name_int("quantised_u", u);
    let v = entry(a, ray.v);
    a.name_int("quantised_v", v);
    let du = slope(a, ray.du);
    a.name_int("quantised_du", du);
    let dv = slope(a, ray.dv);
    a.name_int("quantised_dv", dv);
    Ray { u, v, du, dv }
}

/// The slope of a ray at the end of its reach, in units of the last place.
fn steepest_within_reach(height_bits: u32, fraction_bits: u32) -> i64 {
    let full_height = (1_i128 << height_bits) - 1;
    let reach = (REACH_TEXELS as i128) << fraction_bits;
    ((2 * reach + full_height) / (2 * full_height)) as i64
}

/// The narrowest signed format with so many fraction bits that holds a magnitude.
fn holding(magnitude: i128, fraction_bits: u32) -> FixedFormat {
    let bits = 128 - magnitude.leading_zeros();
    FixedFormat::q(1 + bits.saturating_sub(fraction_bits), fraction_bits)
}

/// `2^exponent`.
fn power_of_two(exponent: u32) -> f64 {
    f64::from_bits(u64::from(1023 + exponent) << 52)
}

/// The integer nearest to `numerator / denominator`, ties away from zero; the denominator an integer
/// of at most 16 bits, the numerator not negative, not above `2^53`.
#[inline]
fn nearest_quotient(numerator: f64, denominator: f64) -> i64 {
    debug_assert!((0.0..=9_007_199_254_740_992.0).contains(&numerator));
    let quotient = (numerator / denominator).round();
    // Exact: the product is an integer up to 2^53, and the remainder is no larger than the
    // denominator and a multiple of the numerator's last place.
    let remainder = numerator - quotient * denominator;
    // The quotient was rounded twice, so it may be one off.
    let quotient = quotient as i64;
    if 2.0 * remainder >= denominator {
        quotient + 1
    } else if -2.0 * remainder > denominator {
        quotient - 1
    } else {
        quotient
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::HeightMap;
    use crate::readings::{ExactReading, NumberFormat};
    use proptest::prelude::*;

    fn pyramid(size: u32, bits: u32) -> Pyramid {
        let heights = vec![0; (size * size) as usize];
        Pyramid::new(&HeightMap::new("flat", size, bits, heights).unwrap())
    }

    fn ray(u: f64, v: f64, du: f64, dv: f64) -> Ray<f64> {
        Ray { u, v, du, dv }
    }

    #[test]
    fn every_ray_within_reach_fits_what_fixed_takes() {
        for (size, bits, name) in [(256, 8, "q8.20"), (4096, 8, "q8.20"), (4096, 16, "q1.28")] {
            let format = RayFormat::within_reach(&pyramid(size, bits));
            assert_eq!(format.slope.to_string(), name);
            let reach = REACH_TEXELS / f64::from(size);
            let shallow = format.quantise(ray(0.0, 0.0, reach, -reach));
            assert!(!shallow.saturated && shallow.du == -shallow.dv);
        }
    }

    #[test]
    fn a_format_is_as_narrow_as_its_rays() {
        let pyramid = pyramid(256, 8);
        // Slopes of 256 texels in 255 steps: just above 1.
        let range =
            RayRange::of(ray(0.1, 0.2, -1.0, 0.5)).and(RayRange::of(ray(0.3, 0.9, 0.9, 0.0)));
        let format = RayFormat::for_rays(&range, &pyramid);
        assert_eq!(format.to_string(), "slopes q2.20, entries uq8.12");
        let reason = format.reasons().join("; ");
        for part in [
            "at most 1.003922 texels per height step (interval arithmetic), so they are below 2",
            "20 fraction bits, 12 of an entry and 8 of a height",
            "half of 1/4096 texel",
            "entries uq8.12, truncated",
        ] {
            assert!(reason.contains(part), "{reason}");
        }
        let still = RayRange::of(ray(0.1, 0.2, 0.0, -0.0));
        assert_eq!(
            RayFormat::for_rays(&still, &pyramid).slope,
            FixedFormat::q(1, 20)
        );
    }

    #[test]
    fn a_slope_beyond_the_format_saturates_either_way() {
        let pyramid = pyramid(256, 8);
        let format = RayFormat::told(FixedFormat::q(2, 20), &pyramid).unwrap();
        let fits = format.quantise(ray(0.5, 0.5, 1.9, -1.9));
        assert!(!fits.saturated);
        let beyond = format.quantise(ray(0.5, 0.5, 3.0, -3.0));
        assert!(beyond.saturated);
        assert_eq!((beyond.du, beyond.dv), ((2 << 20) - 1, 1 - (2 << 20)));
    }

    #[test]
    fn formats_without_a_walk_are_refused_with_the_way_out() {
        let refused = |format: FixedFormat, size, bits| {
            RayFormat::told(format, &pyramid(size, bits))
                .unwrap_err()
                .to_string()
        };
        let coarse = refused(FixedFormat::q(8, 4), 256, 8);
        assert!(
            coarse.contains("such as q8.20; or take `fixed`"),
            "{coarse}"
        );
        let coarse = refused(FixedFormat::q(4, 12), 4, 16);
        assert!(coarse.contains("at least 16 fraction bits"), "{coarse}");
        for format in [
            FixedFormat::q(8, 30),
            FixedFormat::q(1, 46),
            FixedFormat::q(1, 63),
        ] {
            let fine = refused(format, 4096, 8);
            assert!(fine.contains("take fewer bits, or `fixed`"), "{fine}");
        }
        for (integer_bits, fraction_bits, size, bits) in [
            (8, 20, 4096, 8),
            (1, 28, 4096, 16),
            (20, 8, 1, 8),
            (1, 8, 1, 8),
            (36, 28, 4096, 16),
        ] {
            let format = FixedFormat::q(integer_bits, fraction_bits);
            assert!(
                RayFormat::told(format, &pyramid(size, bits)).is_ok(),
                "{format}"
            );
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2048))]

        /// The quick quantiser is the definition, read exactly; what it makes reads back.
        #[test]
        fn quantising_is_exact(
            level in 0_u32..8, bits in prop_oneof![Just(8_u32), Just(16)],
            integer_bits in 1_u32..10, entry_bits in 0_u32..14,
            u in 0.0..1.0_f64, v in 0.0..1.0_f64,
            du in prop_oneof![-60.0..60.0_f64, -1e-6..1e-6_f64, Just(0.0)],
            ties in -4000_i32..4000, tie: bool,
        ) {
            let pyramid = pyramid(1 << level, bits);
            let told = FixedFormat::q(integer_bits, entry_bits + bits);
            let format = RayFormat::told(told, &pyramid).unwrap();
            let shape = format.shape();
            // Half way between two slopes where the factor is odd.
            let half_slope = f64::from(ties) * shape.full_height() as f64
                / power_of_two(shape.fraction_bits() + 1 + level);
            let ray = ray(u, v, du, if tie { half_slope } else { -du / 3.0 });
            let quantised_ray = format.quantise(ray);
            let mut exact = ExactReading::default();
            let numbers = ray.map(|number| exact.direction(number));
            let defined = quantised(&mut exact, shape, numbers);
            prop_assert_eq!(
                (quantised_ray.u, quantised_ray.v, quantised_ray.du, quantised_ray.dv),
                (defined.u, defined.v, defined.du, defined.dv)
            );
            let entered = format.entered(&quantised_ray);
            let again = format.quantise(entered);
            prop_assert_eq!(again, QuantisedRay { saturated: false, ..quantised_ray });
            prop_assert_eq!(format.entered(&again), entered);
            prop_assert!(entered.u <= u && u - entered.u < 1.0 / f64::from(shape.size()));
        }

        /// A range's format saturates none of its rays.
        #[test]
        fn a_chosen_format_holds_its_rays(
            ends in proptest::collection::vec((-60.0..60.0_f64, -1.0..1.0_f64), 1..6),
            bits in prop_oneof![Just(8_u32), Just(16)],
        ) {
            let pyramid = pyramid(256, bits);
            let rays: Vec<_> = ends.iter().map(|&(du, dv)| ray(0.5, 0.25, du, dv)).collect();
            let ranges = rays.iter().copied().map(RayRange::of);
            let range = ranges.reduce(RayRange::and).unwrap();
            let format = RayFormat::for_rays(&range, &pyramid);
            prop_assert!(rays.iter().all(|&ray| !format.quantise(ray).saturated));
            // And one bit less would not do.
            if format.slope.integer_bits > 1 {
                let narrow = FixedFormat::q(format.slope.integer_bits - 1, format.slope.fraction_bits);
                let narrow = RayFormat::told(narrow, &pyramid).unwrap();
                prop_assert!(rays.iter().any(|&ray| narrow.quantise(ray).saturated));
            }
        }
    }
}
