//! Sine and cosine of an angle in degrees, the same to the last bit on every machine.
//!
//! The sine of a platform's mathematics library may differ from another's in its last bit. Rays
//! become committed test vectors, so they are made of additions and multiplications only, which
//! IEEE 754 defines exactly.

use std::f64::consts::PI;

/// Terms of each Taylor series. On [-45, 45] degrees the first one left out is below 1e-19.
const TERMS: u32 = 9;

/// Sine and cosine of `degrees`, each within 2 units in the last place of 1. Exact at multiples of
/// 90 degrees. NaN for what is not finite.
pub(super) fn sine_cosine(degrees: f64) -> (f64, f64) {
    // Both subtractions are exact: the remainder by definition, and the rest because it is a
    // multiple of the last place of a number no smaller than itself.
    let turn = degrees % 360.0;
    let quarters = (turn / 90.0).round();
    let radians = (turn - 90.0 * quarters) * (PI / 180.0);
    let (sine, cosine) = (sine_series(radians), cosine_series(radians));
    match quarters.rem_euclid(4.0) {
        1.0 => (cosine, -sine),
        2.0 => (-sine, -cosine),
        3.0 => (-cosine, sine),
        _ => (sine, cosine),
    }
}

/// `x - x^3/3! + x^5/5! - ...`, by Horner's scheme.
fn sine_series(x: f64) -> f64 {
    let square = x * x;
    let tail = (1..TERMS).rev().fold(1.0, |sum, term| {
        1.0 - square / f64::from(2 * term * (2 * term + 1)) * sum
    });
    x * tail
}

/// `1 - x^2/2! + x^4/4! - ...`, by Horner's scheme.
fn cosine_series(x: f64) -> f64 {
    let square = x * x;
    (1..=TERMS).rev().fold(1.0, |sum, term| {
        1.0 - square / f64::from((2 * term - 1) * 2 * term) * sum
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn multiples_of_a_right_angle_are_exact() {
        assert_eq!(sine_cosine(0.0), (0.0, 1.0));
        assert_eq!(sine_cosine(90.0), (1.0, 0.0));
        assert_eq!(sine_cosine(-90.0), (-1.0, 0.0));
        assert_eq!(sine_cosine(180.0), (0.0, -1.0));
        assert_eq!(sine_cosine(270.0), (-1.0, 0.0));
        assert_eq!(sine_cosine(-630.0), (1.0, 0.0));
    }

    proptest! {
        #[test]
        fn agrees_with_the_mathematics_library(degrees in -720.0..720.0f64) {
            let (sine, cosine) = sine_cosine(degrees);
            // The library is handed a rounded angle of up to 12.6 radians: 2e-15 is its share.
            let radians = degrees.to_radians();
            prop_assert!((sine - radians.sin()).abs() < 3e-15);
            prop_assert!((cosine - radians.cos()).abs() < 3e-15);
            prop_assert!((sine * sine + cosine * cosine - 1.0).abs() < 1e-15);
        }
    }
}
