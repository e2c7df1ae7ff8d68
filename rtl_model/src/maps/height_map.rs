//! A square of heights.

use std::path::Path;

use super::{Channel, MapError, load};

/// The most texels on a side. 4096 fit the index registers of the unit with room for eight
/// repeats, and a pyramid's addresses into 25 bits.
pub const MAX_SIZE: u32 = 4096;

/// A square height map with a power of two of texels on a side, which wraps on both axes.
///
/// Row `j` lies along `v`, column `i` along `u`: texel `(i, j)` is the box over
/// `[i, i+1) x [j, j+1)` in texels. Row 0 is the upper row of the map as displayed. Heights are
/// unsigned normalised integers of 8 or 16 bits, white is high; the depth of height `h` is
/// `1 - h / max_height`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HeightMap {
    name: String,
    size: u32,
    bits: u32,
    heights: Vec<u16>,
}

impl HeightMap {
    /// A map of `size` x `size` texels from its heights, row by row.
    ///
    /// `name` is what messages and reports call the map. `bits` is 8 or 16.
    ///
    /// # Errors
    /// A size that is not a power of two of 1 to [`MAX_SIZE`], heights that are not as many as the
    /// texels, bits that are neither 8 nor 16, or a height that does not fit them.
    pub fn new(name: &str, size: u32, bits: u32, heights: Vec<u16>) -> Result<HeightMap, MapError> {
        check_size(name, size, size)?;
        if bits != 8 && bits != 16 {
            return Err(MapError::UnsupportedBits {
                name: name.to_owned(),
                bits,
            });
        }
        if heights.len() != size as usize * size as usize {
            return Err(MapError::HeightCount {
                name: name.to_owned(),
                size,
                found: heights.len(),
            });
        }
        let maximum = max_height(bits);
        if let Some(index) = heights.iter().position(|&height| height > maximum) {
            return Err(MapError::HeightOutOfRange {
                name: name.to_owned(),
                height: heights[index],
                i: index as u32 % size,
                j: index as u32 / size,
                bits,
            });
        }
        Ok(HeightMap {
            name: name.to_owned(),
            size,
            bits,
            heights,
        })
    }

    /// A map of 8 bits of a size that has been checked: one height for each of its texels.
    pub(super) fn from_bytes(name: String, size: u32, heights: &[u8]) -> HeightMap {
        debug_assert_eq!(heights.len(), size as usize * size as usize);
        HeightMap {
            name,
            size,
            bits: 8,
            heights: heights.iter().map(|&height| u16::from(height)).collect(),
        }
    }

    /// Reads a map from a PNG, TGA or PGM file. See [`Channel`] for the `channel`;
    /// `white_is_low` inverts the heights.
    ///
    /// The format is told from the content, and for TGA, which has no mark of its own, from the
    /// file's ending. Orientation flags of TGA are obeyed. Samples of 8 bits or fewer give a map of
    /// 8 bits, wider ones of 16. Colour profiles and gamma are ignored: a height is no colour.
    ///
    /// # Errors
    /// [`MapError`] names the file, what is wrong with it and the way out.
    pub fn load(path: &Path, channel: Channel, white_is_low: bool) -> Result<HeightMap, MapError> {
        let map = load::load(path, channel)?;
        Ok(if white_is_low { map.inverted() } else { map })
    }

    /// The map with black high and white low.
    #[must_use]
    pub fn inverted(mut self) -> HeightMap {
        let maximum = self.max_height();
        for height in &mut self.heights {
            *height = maximum - *height;
        }
        self
    }

    /// What messages and reports call the map.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Texels on a side: a power of two.
    pub fn size(&self) -> u32 {
        self.size
    }

    /// Bits of a height: 8 or 16.
    pub fn bits(&self) -> u32 {
        self.bits
    }

    /// The level of the pyramid's root, which is the logarithm of the size to base 2.
    pub fn levels(&self) -> u32 {
        self.size.trailing_zeros()
    }

    /// The height of depth 0: 255 or 65535.
    pub fn max_height(&self) -> u16 {
        max_height(self.bits)
    }

    /// The heights, row by row.
    pub fn heights(&self) -> &[u16] {
        &self.heights
    }

    /// The height of texel `(i, j)`; the map wraps.
    pub fn height(&self, i: i64, j: i64) -> u16 {
        let mask = i64::from(self.size) - 1;
        // Both are below the size once masked.
        let (column, row) = ((i & mask) as usize, (j & mask) as usize);
        self.heights[row * self.size as usize + column]
    }

    /// The depth of texel `(i, j)`, `1 - height / max_height` rounded to nearest; 0 is the top
    /// plane, 1 the bottom.
    pub fn depth(&self, i: i64, j: i64) -> f64 {
        let maximum = self.max_height();
        f64::from(maximum - self.height(i, j)) / f64::from(maximum)
    }
}

/// The largest height of `bits` bits, 8 or 16.
fn max_height(bits: u32) -> u16 {
    u16::MAX >> (16 - bits)
}

/// Whether a map may have these columns and rows.
pub(super) fn check_size(name: &str, width: u32, height: u32) -> Result<(), MapError> {
    if width == 0 || height == 0 || width.max(height) > MAX_SIZE {
        return Err(MapError::SizeOutOfRange {
            name: name.to_owned(),
            size: u64::from(if width == 0 || height == 0 {
                0
            } else {
                width.max(height)
            }),
        });
    }
    if width != height {
        return Err(MapError::NotSquare {
            name: name.to_owned(),
            width,
            height,
            // The power of two at or below the shorter side.
            fitting: 1 << width.min(height).ilog2(),
        });
    }
    if !width.is_power_of_two() {
        let above = width.next_power_of_two();
        return Err(MapError::NotPowerOfTwo {
            name: name.to_owned(),
            size: width,
            below: above / 2,
            above,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_found_by_column_and_row_and_wrap() {
        let map = HeightMap::new("m", 2, 8, vec![0, 1, 2, 255]).unwrap();
        assert_eq!((map.height(1, 0), map.height(0, 1)), (1, 2));
        assert_eq!((map.height(-1, 0), map.height(2, 3)), (1, 2));
        assert_eq!((map.depth(0, 0), map.depth(1, 1)), (1.0, 0.0));
        assert_eq!((map.levels(), map.max_height()), (1, 255));
    }

    #[test]
    fn inversion_swaps_top_and_bottom() {
        let map = HeightMap::new("m", 1, 16, vec![1]).unwrap();
        assert_eq!(map.inverted().heights(), [65534]);
    }

    #[test]
    fn what_is_no_map_is_refused_with_a_way_out() {
        for (size, bits, heights, expected) in [
            (0, 8, vec![], "1 to 4096"),
            (3, 8, vec![0; 9], "2 x 2 or 4 x 4"),
            (8192, 8, vec![], "1 to 4096"),
            (4, 8, vec![0; 12], "12 heights for 4 x 4 texels"),
            (1, 9, vec![0], "8 or 16"),
            (2, 8, vec![0, 0, 0, 256], "(1, 1)"),
        ] {
            let message = HeightMap::new("m", size, bits, heights)
                .unwrap_err()
                .to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
