//! The pyramid of maximum heights, laid out by lines of several nodes.

use super::Pyramid;

/// The nodes of a [`Pyramid`] in lines of `2^log2_side` on a side, a line to an address.
///
/// Lines lie at levels 0, `log2_side`, `2 log2_side` and so on, up to the first whose line holds the
/// whole map. A line belongs to its *block*, the node `log2_side` levels above its cells; where that
/// is above the root the map repeats within the line. Levels between are not kept.
///
/// An address is a one, then the block's index on v, then on u, each of as many bits as there are
/// levels between the block and the root ([`line_address`]). For a map of 8 x 8 texels in lines of
/// 2 x 2, `L = 3`:
///
/// | level of the cells | lines | address, in binary |
/// |---|---|---|
/// | 2 | 1 x 1 | `00001` |
/// | 1 | 2 x 2 | `001ji` |
/// | 0, the map | 4 x 4 | `1jjii` |
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lines {
    log2_side: u32,
    memory: Vec<u16>,
}

/// The address of the line of block `(i, j)` whose cells are of `level`, in a memory of lines of
/// `2^log2_side` on a side over a map of `2^levels` texels a side; `i` and `j` wrap.
///
/// # Panics
/// If `level` has no lines.
pub fn line_address(levels: u32, log2_side: u32, level: u32, i: i64, j: i64) -> u32 {
    assert!(
        level.is_multiple_of(log2_side) && (level == 0 || level < levels),
        "no lines of 2^{log2_side} a side at level {level} of {levels}"
    );
    let index_bits = levels.saturating_sub(level + log2_side);
    let mask = (1_i64 << index_bits) - 1;
    let (column, row) = ((i & mask) as u32, (j & mask) as u32);
    (1 << (2 * index_bits)) | (row << index_bits) | column
}

impl Lines {
    /// The lines of a pyramid, of 2 x 2 (`log2_side` 1) or 4 x 4 (2) nodes.
    pub fn new(pyramid: &Pyramid, log2_side: u32) -> Lines {
        let levels = pyramid.levels();
        let side = 1_i64 << log2_side;
        let cells = (side * side) as usize;
        let lines = 2 << (2 * levels.saturating_sub(log2_side));
        let mut memory = vec![0; lines * cells];
        let mut level = 0;
        loop {
            let blocks = 1_i64 << levels.saturating_sub(level + log2_side);
            for j in 0..blocks {
                for i in 0..blocks {
                    let address = line_address(levels, log2_side, level, i, j) as usize;
                    for (cell, height) in memory[address * cells..][..cells].iter_mut().enumerate()
                    {
                        let (column, row) = (cell as i64 % side, cell as i64 / side);
                        *height = pyramid.height(level, i * side + column, j * side + row);
                    }
                }
            }
            level += log2_side;
            if level >= levels {
                return Lines { log2_side, memory };
            }
        }
    }

    /// log2 of the nodes on a side of a line.
    pub fn log2_side(&self) -> u32 {
        self.log2_side
    }

    /// The memory: the heights of the line at address `n` from `n * 4^log2_side` on, row by row.
    /// Lines that no address names are 0.
    pub fn memory(&self) -> &[u16] {
        &self.memory
    }

    /// The memory alone.
    pub fn into_memory(self) -> Vec<u16> {
        self.memory
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::HeightMap;
    use std::collections::HashSet;

    fn pyramid(levels: u32) -> Pyramid {
        let size = 1_u32 << levels;
        let heights = (0..size * size).map(|n| (n * 7919 % 251) as u16).collect();
        Pyramid::new(&HeightMap::new("any", size, 8, heights).unwrap())
    }

    #[test]
    fn a_line_holds_the_nodes_under_its_block() {
        for levels in 0..=6 {
            for log2_side in [1, 2] {
                let pyramid = pyramid(levels);
                let lines = Lines::new(&pyramid, log2_side);
                let side = 1_i64 << log2_side;
                for level in (0..levels.max(1)).step_by(log2_side as usize) {
                    for (i, j) in [(0, 0), (-1, 2), (5, -3)] {
                        let address = line_address(levels, log2_side, level, i, j) as usize;
                        let line = &lines.memory()[address << (2 * log2_side)..];
                        for cell in 0..side * side {
                            let (column, row) = (i * side + cell % side, j * side + cell / side);
                            assert_eq!(
                                line[cell as usize],
                                pyramid.height(level, column, row),
                                "{levels} levels, side {side}, level {level}, block ({i}, {j})"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn addresses_are_unique_and_those_of_the_documentation() {
        for levels in 0..=7_u32 {
            for log2_side in [1, 2] {
                let mut seen = HashSet::new();
                let memory = 2_u32 << (2 * levels.saturating_sub(log2_side));
                for level in (0..levels.max(1)).step_by(log2_side as usize) {
                    let blocks = 1_i64 << levels.saturating_sub(level + log2_side);
                    for n in 0..blocks * blocks {
                        let address =
                            line_address(levels, log2_side, level, n % blocks, n / blocks);
                        assert!(address < memory && seen.insert(address));
                    }
                }
            }
        }
        assert_eq!(line_address(3, 1, 2, 0, 0), 1);
        assert_eq!(line_address(3, 1, 1, 1, 0), 0b00101);
        assert_eq!(line_address(3, 1, 0, 2, 3), 0b11110);
        assert_eq!(line_address(7, 2, 6, 3, 9), 1);
        assert_eq!(line_address(0, 2, 0, 5, -1), 1);
    }

    #[test]
    #[should_panic(expected = "no lines of 2^2 a side at level 1 of 4")]
    fn levels_between_lines_have_no_address() {
        line_address(4, 2, 1, 0, 0);
    }
}
