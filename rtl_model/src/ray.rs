//! The ray a traverse unit walks, and what it must satisfy before it enters one.

use thiserror::Error;

/// A view ray in tangent space, from the top plane (depth 0) to the bottom (depth 1).
///
/// `u` and `v` say where it enters the top plane, in texture coordinates: 1.0 is one repeat of the
/// map, which wraps. `du` and `dv` are the offset for one unit of depth, in the same units; the
/// position at depth `t` is `(u + t du, v + t dv)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Ray<N> {
    /// Where the ray enters, along the rows of the map.
    pub u: N,
    /// Where the ray enters, along its columns; grows downwards in the map as displayed.
    pub v: N,
    /// Change of `u` over one unit of depth.
    pub du: N,
    /// Change of `v` over one unit of depth.
    pub dv: N,
}

impl<N> Ray<N> {
    /// The same ray with each number converted, in the order u, v, du, dv.
    pub fn map<M>(self, mut convert: impl FnMut(N) -> M) -> Ray<M> {
        Ray {
            u: convert(self.u),
            v: convert(self.v),
            du: convert(self.du),
            dv: convert(self.dv),
        }
    }
}

/// How far a ray may travel on either axis between top and bottom, in texels.
///
/// At this reach the borders that a ray of the unit's own format e7f16 crosses on one axis lie at
/// least 2^-14 apart in depth, 8 units in the last place of a depth below 1: more than the 6 over
/// which the walk may doubt which border comes first (`units::traverse_step`). The index registers
/// are as wide as this reach needs.
pub const REACH_TEXELS: f64 = 16_384.0;

/// The same for a float with this many fraction bits: a quarter of the numbers from 1/2 to 1, and
/// never more than [`REACH_TEXELS`].
pub fn reach_in(fraction_bits: u32) -> f64 {
    let reach = 1_u64 << (fraction_bits - 2);
    (reach as f64).min(REACH_TEXELS)
}

/// Why a ray cannot be walked.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RayError {
    /// A component is NaN or infinite.
    #[error("ray: `{component}` is {value}: all four numbers must be finite")]
    NotFinite {
        /// The component's name: u, v, du or dv.
        component: &'static str,
        /// What it was.
        value: f64,
    },
    /// The ray is too shallow for the unit's index registers.
    #[error(
        "ray: `{component}` is {value}, which on a {size} x {size} map is {texels} texels from top \
         to bottom, more than the {REACH_TEXELS} within the unit's reach: take a steeper \
         ray, a smaller depth scale or a smaller map"
    )]
    TooShallow {
        /// The component's name: du or dv.
        component: &'static str,
        /// What it was.
        value: f64,
        /// The map's texels on a side.
        size: u32,
        /// Texels travelled on that axis.
        texels: f64,
    },
}

/// Checks a ray against a map of `size` x `size` texels and reduces its entry to the first repeat.
///
/// All components must be finite, and neither `|du| * size` nor `|dv| * size` may exceed
/// [`REACH_TEXELS`]. The answer has `u` and `v` in [0, 1), by [`reduce`]; `du` and `dv` are kept.
///
/// # Errors
/// [`RayError`] says which component is at fault and what would help.
pub fn check(ray: Ray<f64>, size: u32) -> Result<Ray<f64>, RayError> {
    for (component, value) in [("u", ray.u), ("v", ray.v), ("du", ray.du), ("dv", ray.dv)] {
        if !value.is_finite() {
            return Err(RayError::NotFinite { component, value });
        }
    }
    for (component, value) in [("du", ray.du), ("dv", ray.dv)] {
        // The product is exact: a map's size is a power of two. It may be infinite.
        let texels = value.abs() * f64::from(size);
        if texels > REACH_TEXELS {
            return Err(RayError::TooShallow {
                component,
                value,
                size,
                texels,
            });
        }
    }
    Ok(Ray {
        u: reduce(ray.u),
        v: reduce(ray.v),
        ..ray
    })
}

/// The position in [0, 1) that a wrapping map shows at `position`: `position - floor(position)`.
///
/// Exact where `position` is not negative, and where the result is representable; else rounded to
/// nearest, except that what would round to 1 becomes the largest number below 1: a position just
/// before a border stays in the texel before it. NaN and infinities give NaN.
pub fn reduce(position: f64) -> f64 {
    let fraction = position - position.floor();
    if fraction < 1.0 {
        // Adding a positive zero turns minus zero into zero and leaves the rest.
        fraction + 0.0
    } else if fraction.is_nan() {
        fraction
    } else {
        1.0_f64.next_down()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RAY: Ray<f64> = Ray {
        u: 0.25,
        v: 0.5,
        du: 0.1,
        dv: -0.2,
    };

    #[test]
    fn a_sound_ray_passes_unchanged() {
        assert_eq!(check(RAY, 256), Ok(RAY));
    }

    #[test]
    fn entries_are_reduced_to_the_first_repeat() {
        let ray = Ray {
            u: 3.75,
            v: -0.25,
            ..RAY
        };
        let reduced = check(ray, 256).unwrap();
        assert_eq!((reduced.u, reduced.v), (0.75, 0.75));
        assert_eq!((reduced.du, reduced.dv), (ray.du, ray.dv));
    }

    #[test]
    fn a_position_just_before_a_border_stays_before_it() {
        assert_eq!(reduce(-1e-30), 1.0_f64.next_down());
        assert_eq!(reduce(-0.0).to_bits(), 0.0_f64.to_bits());
        assert_eq!(reduce(1.0), 0.0);
        assert!(reduce(f64::INFINITY).is_nan());
    }

    #[test]
    fn numbers_that_are_not_finite_are_named() {
        for (component, ray) in [
            ("u", Ray { u: f64::NAN, ..RAY }),
            (
                "v",
                Ray {
                    v: f64::INFINITY,
                    ..RAY
                },
            ),
            (
                "du",
                Ray {
                    du: f64::NEG_INFINITY,
                    ..RAY
                },
            ),
            (
                "dv",
                Ray {
                    dv: f64::NAN,
                    ..RAY
                },
            ),
        ] {
            let message = check(ray, 256).unwrap_err().to_string();
            assert!(message.contains(&format!("`{component}`")), "{message}");
        }
    }

    #[test]
    fn the_reach_is_a_closed_bound() {
        let at_the_bound = Ray { du: -64.0, ..RAY };
        assert_eq!(check(at_the_bound, 256), Ok(at_the_bound));
        let beyond = Ray {
            dv: 64.0_f64.next_up(),
            ..RAY
        };
        assert!(matches!(
            check(beyond, 256),
            Err(RayError::TooShallow {
                component: "dv",
                size: 256,
                ..
            })
        ));
        let overflowing = Ray {
            du: f64::MAX,
            ..RAY
        };
        assert!(check(overflowing, 256).is_err());
    }

    proptest! {
        #[test]
        fn reduction_lands_in_the_first_repeat(position in proptest::num::f64::NORMAL) {
            let reduced = reduce(position);
            prop_assert!((0.0..1.0).contains(&reduced));
            prop_assert_eq!(reduce(reduced), reduced);
        }

        #[test]
        fn reduction_undoes_whole_repeats(thousandths in 0u32..1024, repeats in -64i32..64) {
            let position = f64::from(thousandths) / 1024.0;
            prop_assert_eq!(reduce(position + f64::from(repeats)), position);
        }
    }
}
