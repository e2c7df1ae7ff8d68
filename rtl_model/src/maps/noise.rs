//! Noise on a torus: what procedural maps are made of.
//!
//! Randomness is an integer hash, and all arithmetic is addition, subtraction, multiplication,
//! division and square root, which IEEE 754 defines to the last bit. The same seed therefore gives
//! the same noise on every machine.
//!
//! Positions `u` and `v` are in [0, 1); every function here wraps there.

/// A 64-bit hash of a seed and two integers: the finaliser of SplitMix64 (Steele, Lea and Flood
/// 2014) over each in turn.
pub(super) fn hash(seed: u64, i: i64, j: i64) -> u64 {
    let scramble = |mut bits: u64| {
        bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^ (bits >> 31)
    };
    scramble(scramble(scramble(seed) ^ i as u64) ^ j as u64)
}

/// Two numbers in [0, 1) from the two halves of a hash.
pub(super) fn pair(hash: u64) -> (f64, f64) {
    let scale = 1.0 / (1_u64 << 32) as f64;
    (
        (hash >> 32) as f64 * scale,
        (hash & 0xffff_ffff) as f64 * scale,
    )
}

/// 0 up to 0, 1 from 1 on, and a smooth cubic between.
pub(super) fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// `a` at 0, `b` at 1, linear between.
pub(super) fn blend(a: f64, b: f64, x: f64) -> f64 {
    a + (b - a) * x
}

/// Gradient noise (Perlin 2002) with `cells` x `cells` cells: continuous with its first and second
/// derivatives, 0 on lattice points, within (-1, 1).
pub(super) fn gradient(seed: u64, u: f64, v: f64, cells: i64) -> f64 {
    let (x, y) = (u * cells as f64, v * cells as f64);
    let (column, row) = (x.floor(), y.floor());
    let (right, down) = (x - column, y - row);
    let slope = |across: i64, along: i64| {
        let corner = hash(
            seed,
            (column as i64 + across).rem_euclid(cells),
            (row as i64 + along).rem_euclid(cells),
        );
        let (slope_x, slope_y) = pair(corner);
        (2.0 * slope_x - 1.0) * (right - across as f64)
            + (2.0 * slope_y - 1.0) * (down - along as f64)
    };
    let fade = |x: f64| x * x * x * (x * (6.0 * x - 15.0) + 10.0);
    blend(
        blend(slope(0, 0), slope(1, 0), fade(right)),
        blend(slope(0, 1), slope(1, 1), fade(right)),
        fade(down),
    )
}

/// Octaves of [`gradient`], each with twice the cells and half the weight of the one before;
/// within (-1, 1).
pub(super) fn fractal(seed: u64, u: f64, v: f64, cells: i64, octaves: u32) -> f64 {
    let mut sum = 0.0;
    let mut weight = 0.5;
    for octave in 0..octaves {
        sum += weight * gradient(seed.wrapping_add(u64::from(octave)), u, v, cells << octave);
        weight /= 2.0;
    }
    sum
}

/// The nearest of randomly placed points, one in each of `cells` x `cells` cells.
pub(super) struct Nearest {
    /// Distance to the nearest point, in cells.
    pub(super) distance: f64,
    /// Distance to the second nearest point, in cells.
    pub(super) second_distance: f64,
    /// From the nearest point to the position, along u and v, in cells.
    pub(super) offset: (f64, f64),
    /// A hash that is the nearest point's own.
    pub(super) hash: u64,
}

/// The nearest point (Worley 1996). `jitter` is how far points stray within their cells: 0 leaves
/// them at the centres, 1 spreads them over the whole.
pub(super) fn nearest(seed: u64, u: f64, v: f64, cells: i64, jitter: f64) -> Nearest {
    let (x, y) = (u * cells as f64, v * cells as f64);
    let (column, row) = (x.floor(), y.floor());
    let mut found = Nearest {
        distance: f64::INFINITY,
        second_distance: f64::INFINITY,
        offset: (0.0, 0.0),
        hash: 0,
    };
    // The second nearest point may lie two cells off, where points stray to far corners. From the
    // middle outwards, most cells turn out to be too far before their point is placed.
    const OUTWARDS: [i64; 5] = [0, -1, 1, -2, 2];
    let gap = |cells_off: i64, within: f64| match cells_off {
        0 => 0.0,
        1.. => cells_off as f64 - within,
        _ => within - 1.0 - cells_off as f64,
    };
    for along in OUTWARDS {
        for across in OUTWARDS {
            let gap_x = gap(across, x - column);
            let gap_y = gap(along, y - row);
            if gap_x * gap_x + gap_y * gap_y > found.second_distance * found.second_distance {
                continue;
            }
            let own = hash(
                seed,
                (column as i64 + across).rem_euclid(cells),
                (row as i64 + along).rem_euclid(cells),
            );
            let (place_x, place_y) = pair(own);
            let dx = x - column - across as f64 - (0.5 + jitter * (place_x - 0.5));
            let dy = y - row - along as f64 - (0.5 + jitter * (place_y - 0.5));
            let distance = (dx * dx + dy * dy).sqrt();
            if distance < found.distance {
                found = Nearest {
                    distance,
                    second_distance: found.distance,
                    offset: (dx, dy),
                    hash: own,
                };
            } else if distance < found.second_distance {
                found.second_distance = distance;
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn noise_wraps_without_a_seam(seed: u64, v in 0.0..1.0f64, cells in 1i64..12) {
            let edge = 1.0_f64.next_down();
            prop_assert!((gradient(seed, 0.0, v, cells) - gradient(seed, edge, v, cells)).abs() < 1e-9);
            prop_assert!((gradient(seed, v, 0.0, cells) - gradient(seed, v, edge, cells)).abs() < 1e-9);
            let (left, right) = (nearest(seed, 0.0, v, cells, 1.0), nearest(seed, edge, v, cells, 1.0));
            prop_assert!((left.distance - right.distance).abs() < 1e-9);
        }

        #[test]
        fn noise_keeps_its_range(seed: u64, u in 0.0..1.0f64, v in 0.0..1.0f64, cells in 1i64..12) {
            prop_assert!(fractal(seed, u, v, cells, 5).abs() < 1.0);
            let found = nearest(seed, u, v, cells, 1.0);
            prop_assert!(found.distance <= found.second_distance);
            prop_assert!(found.second_distance < 3.0);
        }
    }

    /// Leaving out the cells that are too far changes nothing.
    #[test]
    fn the_nearest_points_are_those_of_a_full_search() {
        let (seed, cells) = (9, 5_i64);
        let centre = |n: i64| (n as f64 + 0.5) / 40.0;
        for (u, v) in (0..1600).map(|n| (centre(n % 40), centre(n / 40))) {
            let mut distances: Vec<f64> = (-cells..2 * cells)
                .flat_map(|row| (-cells..2 * cells).map(move |column| (column, row)))
                .map(|(column, row)| {
                    let (place_x, place_y) =
                        pair(hash(seed, column.rem_euclid(cells), row.rem_euclid(cells)));
                    let dx = column as f64 + place_x - u * cells as f64;
                    let dy = row as f64 + place_y - v * cells as f64;
                    (dx * dx + dy * dy).sqrt()
                })
                .collect();
            distances.sort_by(f64::total_cmp);
            let found = nearest(seed, u, v, cells, 1.0);
            assert!((found.distance - distances[0]).abs() < 1e-12);
            assert!((found.second_distance - distances[1]).abs() < 1e-12);
        }
    }

    #[test]
    fn hashes_differ_in_each_argument() {
        let hashes = [hash(0, 0, 0), hash(1, 0, 0), hash(0, 1, 0), hash(0, 0, 1)];
        for (index, one) in hashes.iter().enumerate() {
            assert!(hashes[..index].iter().all(|other| other != one));
        }
    }
}
