//! Families of small maps.

use rtl_model::maps::HeightMap;

/// The eight heights, of 8 bits: their depths are 1, 4/5, 2/3, 3/5, 2/5, 1/3, 1/5 and 0.
const HEIGHTS: [u16; 8] = [0, 51, 85, 102, 153, 170, 204, 255];

/// Maps of eight heights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapSet {
    log2_size: u32,
    choice: Choice,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Choice {
    /// Every map, or every so many of them.
    Every(u64),
    /// So many, seeded.
    Sample { count: u64, seed: u64 },
}

impl MapSet {
    /// All maps of `2^log2_size` texels a side: 8 of one texel, 4096 of 2 x 2. Of larger ones
    /// there are too many: see [`MapSet::sample`].
    ///
    /// # Panics
    /// If `log2_size` is above 1.
    pub fn all(log2_size: u32) -> MapSet {
        MapSet::every(1, log2_size)
    }

    /// Every `stride`-th of them.
    ///
    /// # Panics
    /// As [`MapSet::all`], and if the stride is zero.
    pub fn every(stride: u64, log2_size: u32) -> MapSet {
        assert!(
            log2_size <= 1 && stride > 0,
            "all maps of 1 or 2 x 2 texels"
        );
        let choice = Choice::Every(stride);
        MapSet { log2_size, choice }
    }

    /// So many seeded maps of `2^log2_size` texels a side. Half of them are of two heights only,
    /// so that plateaus and equal neighbours are as common as walls.
    pub fn sample(count: u64, seed: u64, log2_size: u32) -> MapSet {
        let choice = Choice::Sample { count, seed };
        MapSet { log2_size, choice }
    }

    /// Texels on a side.
    pub fn size(&self) -> u32 {
        1 << self.log2_size
    }

    /// How many maps there are.
    pub fn count(&self) -> u64 {
        match self.choice {
            Choice::Every(stride) => self.all_of_them().div_ceil(stride),
            Choice::Sample { count, .. } => count,
        }
    }

    /// Are these all the maps of the family?
    pub fn is_complete(&self) -> bool {
        self.choice == Choice::Every(1)
    }

    /// The name in tables.
    pub fn name(&self) -> String {
        let size = self.size();
        match self.choice {
            Choice::Every(1) => format!("all {size}x{size}"),
            Choice::Every(_) | Choice::Sample { .. } => {
                format!("{} of {size}x{size}", self.count())
            }
        }
    }

    /// A map, from 0 to [`MapSet::count`].
    pub fn map(&self, index: u64) -> HeightMap {
        let texels = 1_u32 << (2 * self.log2_size);
        let heights = match self.choice {
            Choice::Every(stride) => {
                let number = index * stride;
                let digit = |texel: u32| (number >> (3 * texel)) as usize % HEIGHTS.len();
                (0..texels).map(|texel| HEIGHTS[digit(texel)]).collect()
            }
            Choice::Sample { seed, .. } => sampled(seed, index, texels),
        };
        HeightMap::new("small world", self.size(), 8, heights).expect("a square of heights")
    }

    fn all_of_them(&self) -> u64 {
        1 << (3 << (2 * self.log2_size))
    }
}

fn sampled(seed: u64, index: u64, texels: u32) -> Vec<u16> {
    let mut state = seed ^ index.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    // SplitMix64 (Steele, Lea, Flood 2014).
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ (mixed >> 31)) as usize
    };
    let mut palette = HEIGHTS;
    if index % 2 == 1 {
        let two = [HEIGHTS[next() % 8], HEIGHTS[next() % 8]];
        palette = std::array::from_fn(|place| two[place % 2]);
    }
    (0..texels).map(|_| palette[next() % 8]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn all_maps_are_all_different_ones() {
        for (log2_size, expected) in [(0, 8), (1, 4096)] {
            let set = MapSet::all(log2_size);
            let maps = (0..set.count()).map(|index| set.map(index).heights().to_vec());
            assert_eq!(maps.collect::<BTreeSet<_>>().len(), expected);
            assert!(set.is_complete());
        }
        let some = MapSet::every(64, 1);
        assert_eq!((some.count(), some.is_complete()), (64, false));
    }

    #[test]
    fn sampled_maps_differ_and_depend_on_the_seed() {
        let set = |seed| {
            let set = MapSet::sample(100, seed, 2);
            let maps = (0..set.count()).map(|index| set.map(index).heights().to_vec());
            maps.collect::<BTreeSet<_>>()
        };
        assert!(set(1).len() > 90);
        assert_eq!(set(1), set(1));
        assert_ne!(set(1), set(2));
    }
}
