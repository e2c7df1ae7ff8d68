//! The pyramid of maximum heights as windows of 4 x 4 nodes see it.

use super::Pyramid;

/// Nodes on a side of a window.
pub const WINDOW_SIDE: i64 = 4;

/// The heights of the window of 4 x 4 nodes of `level` from node `(i, j)` on, row by row; nodes wrap.
///
/// In hardware sixteen banks hold the pyramid, each the nodes of one place modulo 4 on both axes
/// of every level: any window has one node in each, so one read of all banks answers it.
///
/// # Panics
/// If `level` exceeds that of the root.
#[inline]
pub fn window(pyramid: &Pyramid, level: u32, i: i64, j: i64) -> [u16; 16] {
    let mut heights = [0; 16];
    for (n, height) in heights.iter_mut().enumerate() {
        let (column, row) = (n as i64 % WINDOW_SIDE, n as i64 / WINDOW_SIDE);
        *height = pyramid.height(level, i + column, j + row);
    }
    heights
}

/// What the banks answer for each address: the window from the node on whose address in the
/// pyramid's memory it is ([`super::node_address`]), 16 heights to an address. Addresses that no
/// node has hold 0.
///
/// It is sixteen times the pyramid, for vectors and small maps; walks in software ask [`window`].
pub fn all_windows(pyramid: &Pyramid) -> Vec<u16> {
    let mut memory = vec![0; pyramid.memory().len() * 16];
    for level in 0..=pyramid.levels() {
        let nodes = i64::from(pyramid.size() >> level);
        for j in 0..nodes {
            for i in 0..nodes {
                let address = pyramid.node_address(level, i, j) as usize;
                memory[address * 16..][..16].copy_from_slice(&window(pyramid, level, i, j));
            }
        }
    }
    memory
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::HeightMap;

    #[test]
    fn a_window_wraps_and_is_found_by_its_address() {
        let heights = (0..64).map(|n| n * 3).collect();
        let map = HeightMap::new("any", 8, 8, heights).unwrap();
        let pyramid = Pyramid::new(&map);
        let corner = window(&pyramid, 0, 6, 7);
        assert_eq!(corner[0], map.height(6, 7));
        assert_eq!(corner[3], map.height(1, 7));
        assert_eq!(corner[14], map.height(0, 2));
        let memory = all_windows(&pyramid);
        for (level, i, j) in [(0, 6, 7), (1, 3, 0), (3, 0, 0)] {
            let address = pyramid.node_address(level, i, j) as usize;
            assert_eq!(memory[address * 16..][..16], window(&pyramid, level, i, j));
        }
    }
}
