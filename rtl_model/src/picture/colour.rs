//! Colours for numbers, and the background of pictures.

use image::Rgb;

/// Nine colours at equal distances along matplotlib's colour map *viridis* (van der Walt and Smith
/// 2015, public domain): equal steps of the number are equal steps to the eye, and its lightness
/// rises throughout, so that it reads in grey and to the colour-blind as well.
const VIRIDIS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
];

/// The colour for `position`, 0 (dark) to 1 (bright); what is outside takes the nearer
/// end, and NaN the dark one.
pub(super) fn scale(position: f64) -> Rgb<u8> {
    let last = VIRIDIS.len() - 1;
    let position = if position.is_nan() { 0.0 } else { position };
    let place = position.clamp(0.0, 1.0) * last as f64;
    let below = (place as usize).min(last - 1);
    mix(
        Rgb(VIRIDIS[below]),
        Rgb(VIRIDIS[below + 1]),
        place - below as f64,
    )
}

/// `a` at 0, `b` at 1, linear between in the encoded values.
pub(super) fn mix(a: Rgb<u8>, b: Rgb<u8>, share: f64) -> Rgb<u8> {
    let channel =
        |n: usize| (f64::from(a[n]) + (f64::from(b[n]) - f64::from(a[n])) * share).round() as u8;
    Rgb([channel(0), channel(1), channel(2)])
}

/// Linear light in [0, 1] as the encoded byte of sRGB (IEC 61966-2-1).
pub(super) fn encode(linear: f64) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let encoded = if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    };
    (255.0 * encoded).round() as u8
}

/// The background of row `y` of `height`, for pixels without a ray: a dim sky.
pub(super) fn background(y: u32, height: u32) -> Rgb<u8> {
    let share = (f64::from(y) + 0.5) / f64::from(height);
    mix(Rgb([38, 44, 56]), Rgb([92, 100, 112]), share)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance, for colours on their way up.
    fn luminance(colour: Rgb<u8>) -> f64 {
        let linear = |byte: u8| (f64::from(byte) / 255.0).powf(2.2);
        0.2126 * linear(colour[0]) + 0.7152 * linear(colour[1]) + 0.0722 * linear(colour[2])
    }

    #[test]
    fn the_scale_brightens_throughout() {
        let luminances: Vec<f64> = (0..=64)
            .map(|n| luminance(scale(f64::from(n) / 64.0)))
            .collect();
        assert!(luminances.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn the_scale_takes_any_number() {
        assert_eq!(scale(-1.0), Rgb(VIRIDIS[0]));
        assert_eq!(scale(2.0), Rgb(VIRIDIS[8]));
        assert_eq!(scale(0.5), Rgb(VIRIDIS[4]));
        assert_eq!(scale(f64::NAN), Rgb(VIRIDIS[0]));
    }

    #[test]
    fn light_is_encoded_by_the_standard() {
        assert_eq!((encode(0.0), encode(1.0), encode(9.0)), (0, 255, 255));
        // Middle grey: 21.4 % of the light is byte 127 or 128.
        assert!((127..=128).contains(&encode(0.214)));
    }
}
