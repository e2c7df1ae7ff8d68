//! Sets of rays, all of them of a kind.

use rtl_model::float::FloatFormat;
use rtl_model::ray::{Ray, reach_in};

/// All rays of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaySet {
    /// Entries of so many bits on each axis, over the map; slopes of four bits, signed, in halves
    /// of a texel: -4 to 3.5 texels. Every format of this project holds them, and they cross borders
    /// at thirds, fifths and sevenths of the depth.
    FourBits {
        /// Bits of an entry, 1 to 4.
        entry_bits: u32,
    },
    /// Every ray that a small float format holds and a unit of it walks: entries below 1,
    /// directions within its reach, both signs of zero.
    AllOf(FloatFormat),
    /// Rays of the fixed-point format q4.10 over heights of 8 bits: every entry (quarters of a
    /// texel), slopes of four bits, signed, in 2^-9 of a texel for a height step: -4 to 3.5 texels,
    /// less a 255th. Nothing of them is rounded.
    FixedPoint,
}

impl RaySet {
    /// The name in tables.
    pub fn name(&self) -> String {
        match self {
            RaySet::FourBits { entry_bits } => format!("entries of {entry_bits} bits, slopes of 4"),
            RaySet::AllOf(format) => format!("every ray of {format}"),
            RaySet::FixedPoint => "rays of q4.10, slopes of 4 bits".to_owned(),
        }
    }

    /// The rays, for maps of `size` texels a side.
    pub fn rays(&self, size: u32) -> Vec<Ray<f64>> {
        let side = f64::from(size);
        match self {
            RaySet::FourBits { entry_bits } => {
                let entries = 1_i32 << entry_bits;
                let entry = |place| f64::from(place) / f64::from(entries);
                let slope = |place| f64::from(place) / 2.0 / side;
                crossed(&(0..entries).map(entry).collect::<Vec<_>>(), &slopes(slope))
            }
            RaySet::AllOf(format) => {
                let values: Vec<f64> = (0..1_u64 << format.width())
                    .filter(|&bits| is_number(*format, bits))
                    .map(|bits| format.to_f64(bits))
                    .collect();
                let reach = reach_in(format.fraction_bits) / side;
                let entries = values.iter().copied();
                let entries = entries.filter(|value| value.is_sign_positive() && *value < 1.0);
                let directions = values.iter().copied().filter(|value| value.abs() <= reach);
                crossed(
                    &entries.collect::<Vec<_>>(),
                    &directions.collect::<Vec<_>>(),
                )
            }
            RaySet::FixedPoint => {
                let entries = 4 * size;
                let entry = |place| f64::from(place) / f64::from(entries);
                let slope = |place| f64::from(place) * 255.0 / 512.0 / side;
                crossed(&(0..entries).map(entry).collect::<Vec<_>>(), &slopes(slope))
            }
        }
    }
}

/// Sixteen slopes: those of four bits, signed.
fn slopes(slope: impl Fn(i32) -> f64) -> Vec<f64> {
    (-8..8).map(slope).collect()
}

/// Zeros and normal numbers: a subnormal pattern reads as a zero, which is there already.
fn is_number(format: FloatFormat, bits: u64) -> bool {
    let magnitude = bits & !format.sign_bit();
    magnitude == 0 || (format.min_normal()..format.infinity()).contains(&magnitude)
}

/// Every entry with every direction, on both axes.
fn crossed(entries: &[f64], directions: &[f64]) -> Vec<Ray<f64>> {
    let mut rays = Vec::with_capacity((entries.len() * directions.len()).pow(2));
    for &u in entries {
        for &v in entries {
            for &du in directions {
                rays.extend(directions.iter().map(|&dv| Ray { u, v, du, dv }));
            }
        }
    }
    rays
}

#[cfg(test)]
mod tests {
    use super::*;
    use rtl_model::maps::{HeightMap, Pyramid};
    use rtl_model::scene::{Crossing, Method, Walk};
    use rtl_model::walker::Walker;

    #[test]
    fn sets_have_the_rays_they_say() {
        assert_eq!(RaySet::FourBits { entry_bits: 2 }.rays(2).len(), 16 * 256);
        assert_eq!(RaySet::FourBits { entry_bits: 4 }.rays(4).len(), 1 << 16);
        assert_eq!(RaySet::FixedPoint.rays(2).len(), 64 * 256);
        // Exponents -6 to -1 with four significands each, and zero; up to 2^-1, both signs.
        let format = FloatFormat::new(4, 2);
        let (entries, directions) = (6 * 4 + 1, 2 * (5 * 4 + 1 + 1));
        let rays = RaySet::AllOf(format).rays(2);
        assert_eq!(rays.len(), (entries * directions) * (entries * directions));
    }

    /// Every ray of a set enters its format as it is.
    #[test]
    fn nothing_is_rounded_on_entry() {
        let map = HeightMap::new("m", 2, 8, vec![0, 51, 102, 255]).unwrap();
        let pyramid = Pyramid::new(&map);
        for (set, formats) in [
            (
                RaySet::FourBits { entry_bits: 4 },
                &["e5f4", "e4f4", "e7f16", "f64", "exact"][..],
            ),
            (RaySet::AllOf(FloatFormat::new(4, 2)), &["e4f2", "e7f16"]),
        ] {
            for format in formats {
                let walk = Walk {
                    method: Method::Oh,
                    format: format.parse().unwrap(),
                    crossing: Crossing::Index,
                };
                let mut walker = Walker::new(walk, &pyramid).unwrap();
                for ray in set.rays(2).into_iter().step_by(7) {
                    let admitted = walker.admit(ray).unwrap();
                    assert_eq!(walker.entered(admitted), ray, "{format}");
                }
            }
        }
    }
}
