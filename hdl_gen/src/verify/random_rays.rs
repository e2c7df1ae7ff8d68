//! Rays where no scene gives any.

use super::split_mix::SplitMix;
use rtl_model::ray::Ray;

/// Seeded rays that enter anywhere, in any direction, up to two repeats of the map long on either
/// axis.
pub fn random_rays(count: u64, seed: u64) -> Vec<Ray<f64>> {
    let mut random = SplitMix(seed);
    let mut fraction = || (random.next() >> 11) as f64 / (1_u64 << 53) as f64;
    (0..count)
        .map(|_| Ray {
            u: fraction(),
            v: fraction(),
            du: 4.0 * fraction() - 2.0,
            dv: 4.0 * fraction() - 2.0,
        })
        .collect()
}
