//! Larger maps made of smaller ones, to see what the size of a map does.

use super::{HeightMap, MapError};

/// Where an enlarged map has its heights from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Enlargement {
    /// The texel that covers the place: the same boxes, each cut into many.
    Nearest,
    /// Between the centres of the four nearest texels of the original, which wraps, linearly on
    /// both axes, in integers, rounded to nearest (halves up): a smoother surface of the same form.
    Bilinear,
}

/// The map repeated to `size` x `size` texels. A scene keeps its looks, texel by texel, if the
/// repeat of its surface is divided by the number of copies on a side
/// ([`Surface::with_tiled_map`](crate::camera::Surface::with_tiled_map)).
///
/// # Errors
/// A size that no map has, or that is below the map's own.
pub fn tiled(map: &HeightMap, size: u32) -> Result<HeightMap, MapError> {
    let name = format!("{} tiled to {size}", map.name());
    check_larger(map, &name, size)?;
    let side = i64::from(size);
    let heights = (0..side * side).map(|texel| map.height(texel % side, texel / side));
    HeightMap::new(&name, size, map.bits(), heights.collect())
}

/// The map drawn larger, with `size` x `size` texels and heights of the same bits. A scene keeps
/// its looks with the same repeat; a ray then travels over so many more texels.
///
/// # Errors
/// A size that no map has, or that is below the map's own.
pub fn enlarged(
    map: &HeightMap,
    size: u32,
    enlargement: Enlargement,
) -> Result<HeightMap, MapError> {
    let name = format!("{} enlarged to {size}", map.name());
    check_larger(map, &name, size)?;
    let factor = i64::from(size / map.size());
    let side = i64::from(size);
    let height_at = |texel: i64| {
        let (i, j) = (texel % side, texel / side);
        match enlargement {
            Enlargement::Nearest => map.height(i / factor, j / factor),
            Enlargement::Bilinear => bilinear(map, factor, i, j),
        }
    };
    let heights = (0..side * side).map(height_at).collect();
    HeightMap::new(&name, size, map.bits(), heights)
}

/// Is `size` a map's, and not below this one's?
fn check_larger(map: &HeightMap, name: &str, size: u32) -> Result<(), MapError> {
    super::height_map::check_size(name, size, size)?;
    if size < map.size() {
        return Err(MapError::NotLarger {
            name: map.name().to_owned(),
            size: map.size(),
            wanted: size,
        });
    }
    Ok(())
}

/// The height at the centre of texel `(i, j)` of a map `factor` times as large.
fn bilinear(map: &HeightMap, factor: i64, i: i64, j: i64) -> u16 {
    // In halves of a small texel the centre is at 2 i + 1; a large texel is 2 factor wide.
    let place = |index: i64| {
        let from_first_centre = 2 * index + 1 - factor;
        let width = 2 * factor;
        (
            from_first_centre.div_euclid(width),
            from_first_centre.rem_euclid(width),
        )
    };
    let width = 2 * factor;
    let ((column, right), (row, below)) = (place(i), place(j));
    let height = |i, j| i64::from(map.height(i, j));
    let upper = height(column, row) * (width - right) + height(column + 1, row) * right;
    let lower = height(column, row + 1) * (width - right) + height(column + 1, row + 1) * right;
    let sum = upper * (width - below) + lower * below;
    let weight = width * width;
    // A mean of heights: within their bits.
    ((sum + weight / 2) / weight) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> HeightMap {
        HeightMap::new("m", 2, 8, vec![0, 40, 80, 255]).unwrap()
    }

    #[test]
    fn a_tiled_map_repeats() {
        let (map, large) = (map(), tiled(&map(), 8).unwrap());
        assert_eq!((large.size(), large.bits()), (8, 8));
        for j in 0..8 {
            for i in 0..8 {
                assert_eq!(large.height(i, j), map.height(i, j));
            }
        }
        assert_eq!(large.name(), "m tiled to 8");
    }

    #[test]
    fn the_nearest_texel_is_cut_into_equal_ones() {
        let (map, large) = (map(), enlarged(&map(), 8, Enlargement::Nearest).unwrap());
        for j in 0..8 {
            for i in 0..8 {
                assert_eq!(large.height(i, j), map.height(i / 4, j / 4));
            }
        }
    }

    #[test]
    fn between_two_centres_heights_rise_evenly_and_wrap() {
        let heights = vec![0, 80, 0, 80];
        let map = HeightMap::new("m", 2, 8, heights).unwrap();
        let large = enlarged(&map, 8, Enlargement::Bilinear).unwrap();
        // Centres of the large texels are at 2 and 6; those of the small at 0.5, 1.5, ...
        let row: Vec<u16> = (0..8).map(|i| large.height(i, 3)).collect();
        assert_eq!(row, [30, 10, 10, 30, 50, 70, 70, 50]);
    }

    #[test]
    fn bilinear_of_the_same_size_is_the_map() {
        let map = map();
        for enlargement in [Enlargement::Nearest, Enlargement::Bilinear] {
            let same = enlarged(&map, 2, enlargement).unwrap();
            assert_eq!(same.heights(), map.heights());
        }
    }

    #[test]
    fn heights_of_sixteen_bits_keep_them() {
        let map = HeightMap::new("m", 1, 16, vec![65535]).unwrap();
        let large = enlarged(&map, 16, Enlargement::Bilinear).unwrap();
        assert_eq!(large.bits(), 16);
        assert!(large.heights().iter().all(|&height| height == 65535));
    }

    #[test]
    fn smaller_maps_and_other_sizes_are_refused() {
        for (size, expected) in [
            (1, "2 texels on a side"),
            (3, "power of two"),
            (8192, "4096"),
        ] {
            for message in [
                tiled(&map(), size).unwrap_err().to_string(),
                enlarged(&map(), size, Enlargement::Bilinear)
                    .unwrap_err()
                    .to_string(),
            ] {
                assert!(message.contains(expected), "{message}");
            }
        }
    }
}
