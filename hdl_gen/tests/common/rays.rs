//! Rays all over a map, in all directions.

use rtl_model::float::FloatFormat;
use rtl_model::ray::Ray;
use rtl_model::readings::{FloatReading, NumberFormat};

/// So many rays as bits of a format, the same in every run: entries spread evenly over the map,
/// directions from steep to shallow in all four quadrants; of sixteen one goes along u, one along v
/// and one straight down.
pub fn rays(format: FloatFormat, count: u32) -> Vec<Ray<u64>> {
    let mut reading = FloatReading(format);
    let ray = |k: u32| {
        // Multiples of irrational numbers: neither entries nor directions ever come again.
        let place = f64::from(k);
        let along_u = f64::from(u8::from(!matches!(k % 16, 5 | 13)));
        let along_v = f64::from(u8::from(!matches!(k % 16, 9 | 13)));
        Ray {
            u: reading.coordinate((place * 0.618_034).fract()),
            v: reading.coordinate((place * 0.414_214).fract()),
            du: reading.direction(along_u * (place * 0.7).sin()),
            dv: reading.direction(along_v * (place * 1.3).cos() * 2.0),
        }
    };
    (0..count).map(ray).collect()
}
