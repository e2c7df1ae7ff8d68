//! The quadtree of maximum heights that a traversal walks.

use super::{HeightMap, Lines};
use std::sync::OnceLock;

/// The pyramid of a height map with a side of `2^L` texels: level 0 is the map, level `L` its single
/// root, and an inner node holds the maximum height of its four children, which is their minimum
/// depth.
///
/// It is kept as the hardware keeps it, in one memory of `2 * 4^L` words. [`node_address`] puts
/// the level into the leading one of an address, so that no level needs a base address or an
/// adder; for a map of 4 x 4 texels, `L = 2`:
///
/// | level | nodes | address, in binary | addresses |
/// |---|---|---|---|
/// | (none) | | `00000` | 0, unused, holds 0 |
/// | 2, the root | 1 x 1 | `00001` | 1 |
/// | (none) | | `0001x` | 2 to 3, unused, hold 0 |
/// | 1 | 2 x 2 | `001ji` | 4 to 7 |
/// | (none) | | `01xxx` | 8 to 15, unused, hold 0 |
/// | 0, the map | 4 x 4 | `1jjii` | 16 to 31 |
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pyramid {
    levels: u32,
    bits: u32,
    memory: Vec<u16>,
    lines: LinesOnDemand,
}

/// The pyramid's lines of 2 x 2 and of 4 x 4, laid out when they are first asked for: they follow
/// from the rest, so they do not tell pyramids apart.
#[derive(Clone, Debug, Default)]
struct LinesOnDemand([OnceLock<Lines>; 2]);

impl PartialEq for LinesOnDemand {
    fn eq(&self, _: &LinesOnDemand) -> bool {
        true
    }
}

impl Eq for LinesOnDemand {}

/// The address of node `(i, j)` of `level` in the memory of a pyramid whose root is at level
/// `levels`; `i` and `j` wrap.
///
/// With `k = levels - level` index bits on each axis it is `(1 << 2k) | (j << k) | i`, `i` and `j`
/// taken modulo `2^k`: the root is at address 1, and level 0 at `4^levels` to `2 * 4^levels - 1`.
///
/// # Panics
/// If `level` exceeds `levels`, or `levels` exceeds 15, the most that fit the answer.
pub fn node_address(levels: u32, level: u32, i: i64, j: i64) -> u32 {
    assert!(
        level <= levels && levels <= 15,
        "level {level} of a pyramid with root {levels}"
    );
    let index_bits = levels - level;
    let mask = (1_i64 << index_bits) - 1;
    let (column, row) = ((i & mask) as u32, (j & mask) as u32);
    (1 << (2 * index_bits)) | (row << index_bits) | column
}

impl Pyramid {
    /// The pyramid over `map`.
    pub fn new(map: &HeightMap) -> Pyramid {
        let levels = map.levels();
        let texels = map.heights().len();
        let mut memory = vec![0; 2 * texels];
        memory[texels..].copy_from_slice(map.heights());
        for level in 1..=levels {
            let nodes = 1_i64 << (levels - level);
            for j in 0..nodes {
                for i in 0..nodes {
                    let child = |right, below| {
                        memory
                            [node_address(levels, level - 1, 2 * i + right, 2 * j + below) as usize]
                    };
                    let highest = child(0, 0)
                        .max(child(1, 0))
                        .max(child(0, 1))
                        .max(child(1, 1));
                    memory[node_address(levels, level, i, j) as usize] = highest;
                }
            }
        }
        Pyramid {
            levels,
            bits: map.bits(),
            memory,
            lines: LinesOnDemand::default(),
        }
    }

    /// The level of the root; the map has `2^levels` texels on a side.
    pub fn levels(&self) -> u32 {
        self.levels
    }

    /// Texels on a side of the map.
    pub fn size(&self) -> u32 {
        1 << self.levels
    }

    /// Bits of a height: 8 or 16.
    pub fn bits(&self) -> u32 {
        self.bits
    }

    /// The maximum height in node `(i, j)` of `level`; `i` and `j` wrap.
    ///
    /// # Panics
    /// If `level` exceeds [`Pyramid::levels`].
    pub fn height(&self, level: u32, i: i64, j: i64) -> u16 {
        self.memory[self.node_address(level, i, j) as usize]
    }

    /// Where node `(i, j)` of `level` lies in [`Pyramid::memory`]; see [`node_address`].
    ///
    /// # Panics
    /// If `level` exceeds [`Pyramid::levels`].
    pub fn node_address(&self, level: u32, i: i64, j: i64) -> u32 {
        node_address(self.levels, level, i, j)
    }

    /// Bits of an address: `2 * levels + 1`.
    pub fn address_bits(&self) -> u32 {
        2 * self.levels + 1
    }

    /// The same heights in lines of `2^log2_side` nodes on a side, laid out at the first call.
    ///
    /// # Panics
    /// If `log2_side` is neither 1 nor 2.
    pub fn lines(&self, log2_side: u32) -> &Lines {
        self.lines.0[log2_side as usize - 1].get_or_init(|| Lines::new(self, log2_side))
    }

    /// The memory as the hardware holds it, `2 * 4^levels` words; unused words are 0.
    pub fn memory(&self) -> &[u16] {
        &self.memory
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashSet;

    /// Any map of up to 16 x 16 texels.
    fn any_map() -> impl Strategy<Value = HeightMap> {
        (0u32..5, prop_oneof![Just(8u32), Just(16u32)]).prop_flat_map(|(levels, bits)| {
            let size = 1u32 << levels;
            let heights =
                proptest::collection::vec(0..=(u16::MAX >> (16 - bits)), (size * size) as usize);
            heights.prop_map(move |heights| HeightMap::new("any", size, bits, heights).unwrap())
        })
    }

    proptest! {
        #[test]
        fn a_node_holds_the_maximum_of_the_texels_under_it(map in any_map()) {
            let pyramid = Pyramid::new(&map);
            for level in 0..=map.levels() {
                let side = 1_i64 << level;
                for j in 0..i64::from(map.size()) / side {
                    for i in 0..i64::from(map.size()) / side {
                        let highest = (0..side * side)
                            .map(|n| map.height(i * side + n % side, j * side + n / side))
                            .max();
                        prop_assert_eq!(Some(pyramid.height(level, i, j)), highest);
                    }
                }
            }
        }

        #[test]
        fn nodes_wrap(map in any_map(), i in -100i64..100, j in -100i64..100) {
            let pyramid = Pyramid::new(&map);
            for level in 0..=map.levels() {
                let nodes = i64::from(map.size() >> level);
                prop_assert_eq!(
                    pyramid.height(level, i, j),
                    pyramid.height(level, i.rem_euclid(nodes), j.rem_euclid(nodes))
                );
            }
            prop_assert_eq!(pyramid.height(0, i, j), map.height(i, j));
        }
    }

    #[test]
    fn addresses_are_unique_and_fit_the_memory() {
        for levels in 0..=6 {
            let map = HeightMap::new("m", 1 << levels, 8, vec![0; 1 << (2 * levels)]).unwrap();
            let pyramid = Pyramid::new(&map);
            let mut seen = HashSet::new();
            for level in 0..=levels {
                for j in 0..1_i64 << (levels - level) {
                    for i in 0..1_i64 << (levels - level) {
                        let address = pyramid.node_address(level, i, j);
                        assert!((address as usize) < pyramid.memory().len());
                        assert!(address >> pyramid.address_bits() == 0);
                        assert!(address != 0 && seen.insert(address));
                    }
                }
            }
            assert_eq!(seen.len(), ((1 << (2 * (levels + 1))) - 1) / 3);
            assert_eq!(pyramid.memory().len(), 2 << (2 * levels));
        }
    }

    #[test]
    fn addresses_are_those_of_the_documentation() {
        assert_eq!(node_address(2, 2, 0, 0), 1);
        assert_eq!(node_address(2, 1, 1, 0), 0b00101);
        assert_eq!(node_address(2, 1, 0, 1), 0b00110);
        assert_eq!(node_address(2, 0, 2, 3), 0b11110);
        assert_eq!(node_address(12, 0, -1, -1), (2 << 24) - 1);
        assert_eq!(node_address(0, 0, 5, 9), 1);
    }

    #[test]
    fn unused_words_are_zero() {
        let map = HeightMap::new("m", 4, 8, vec![9; 16]).unwrap();
        let mut expected = vec![0; 32];
        for used in [1..2, 4..8, 16..32] {
            expected[used].fill(9);
        }
        assert_eq!(Pyramid::new(&map).memory(), expected);
    }
}
