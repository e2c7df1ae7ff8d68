//! Rays and a map where no scene gives any.

use rtl_model::float::FloatFormat;
use rtl_model::maps::{Channel, MapSource};
use rtl_model::ray::Ray;
use rtl_model::readings::{FloatReading, enter};
use rtl_model::scene::SceneMap;

use crate::options::Replacements;

/// Walked where no --map is given.
const DEFAULT_MAP: &str = "procedural:spikes:64:1";

/// The map for a unit on its own.
pub fn unit_map(replacements: &Replacements) -> anyhow::Result<SceneMap> {
    match replacements.map.chosen() {
        Some(map) => Ok(map),
        None => Ok(SceneMap {
            source: MapSource::parse(DEFAULT_MAP)?,
            channel: Channel::default(),
            white_is_low: false,
        }),
    }
}

/// Seeded rays that enter anywhere, in any direction, up to two repeats of the map long on either
/// axis, as bits of a format.
pub fn random_rays(format: FloatFormat, count: u64, seed: u64) -> Vec<Ray<u64>> {
    let mut reading = FloatReading(format);
    let mut state = seed;
    // Fractions of 2^53 by SplitMix64 (Steele, Lea, Flood 2014).
    let mut fraction = move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..count)
        .map(|_| {
            let ray = Ray {
                u: fraction(),
                v: fraction(),
                du: 4.0 * fraction() - 2.0,
                dv: 4.0 * fraction() - 2.0,
            };
            enter(&mut reading, ray)
        })
        .collect()
}
