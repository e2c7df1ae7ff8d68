//! Nodes of the pyramid by one integer, in Z order, and their depths in that order.
//!
//! A node k levels below the root is a one and below it the k bits of each index, interleaved: v
//! in the odd bits, u in the even ones. Its children are `4 * node` to `4 * node + 3`, so that going
//! down is a shift, and neighbours in the map are neighbours in memory more often than row by row.

use crate::float::FloatFormat;
use crate::maps::Pyramid;

/// The bits of a node that index u.
pub(crate) const BITS_U: u64 = 0x5555_5555;
/// The bits of a node that index v.
pub(crate) const BITS_V: u64 = 0xaaaa_aaaa;

/// What [`step_by`] adds for one node onwards on this axis.
#[inline(always)]
pub(crate) fn onward(axis: u64) -> u64 {
    axis & axis.wrapping_neg()
}

/// What [`step_by`] adds for one node back: all the axis's bits, which is minus one in them.
#[inline(always)]
pub(crate) fn backward(axis: u64) -> u64 {
    axis
}

/// The neighbour of a node. `kept` has ones where the node's bits stay: the other axis, and from the
/// level's leading one upwards; `amount` is [`onward`] or [`backward`]. The index wraps.
#[inline(always)]
pub(crate) fn step_by(node: u64, kept: u64, amount: u64) -> u64 {
    // Ones in the bits that stay hand the carry on.
    ((node | kept).wrapping_add(amount) & !kept) | (node & kept)
}

/// Index on u of a node of level 0; shift the node right by one for v.
#[inline(always)]
pub(crate) fn index_of(node: u64, size: u32) -> u32 {
    let mut bits = node & BITS_U;
    bits = (bits | (bits >> 1)) & 0x3333_3333;
    bits = (bits | (bits >> 2)) & 0x0f0f_0f0f;
    bits = (bits | (bits >> 4)) & 0x00ff_00ff;
    bits = (bits | (bits >> 8)) & 0xffff;
    bits as u32 & (size - 1)
}

/// The depth of every node, as e7f16 has it, at the node's place in Z order.
#[derive(Clone, Debug)]
pub(crate) struct NodeDepths {
    depths: Vec<f32>,
}

impl NodeDepths {
    pub(super) fn new(pyramid: &Pyramid) -> NodeDepths {
        let format = FloatFormat::E7F16;
        // Of 16-bit heights there may be more than nodes, but never more than 2^16.
        let mut of_height: Vec<f32> = Vec::new();
        let most = pyramid.memory().iter().copied().max().unwrap_or(0);
        of_height.extend((0..=u64::from(most)).map(|height| {
            // 17 significant bits, 2^-16 to 1: an f32 holds it.
            format.to_f64(format.depth_from_height(height, pyramid.bits())) as f32
        }));
        let mut depths = vec![0.0; pyramid.memory().len()];
        for level in 0..=pyramid.levels() {
            let nodes = 1_u32 << (pyramid.levels() - level);
            for j in 0..nodes {
                for i in 0..nodes {
                    let leading_one = nodes * nodes;
                    let place = leading_one | interleave(i) | (interleave(j) << 1);
                    let height = pyramid.height(level, i64::from(i), i64::from(j));
                    depths[place as usize] = of_height[usize::from(height)];
                }
            }
        }
        NodeDepths { depths }
    }

    /// All of them, a power of two: a place is taken modulo their number.
    #[inline(always)]
    pub(super) fn as_slice(&self) -> &[f32] {
        &self.depths
    }
}

/// The bits of an index below 2^16, each followed by room for one more.
pub(crate) fn interleave(index: u32) -> u32 {
    let mut bits = index;
    bits = (bits | (bits << 8)) & 0x00ff_00ff;
    bits = (bits | (bits << 4)) & 0x0f0f_0f0f;
    bits = (bits | (bits << 2)) & 0x3333_3333;
    (bits | (bits << 1)) & 0x5555_5555
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::{Channel, MapSource};

    #[test]
    fn neighbours_wrap_at_their_level() {
        for level_bits in 0..5_u32 {
            let size = 1_u32 << level_bits;
            let leading_one = u64::from(size * size);
            for i in 0..size {
                for j in 0..size {
                    let place = |i: u32, j: u32| {
                        leading_one | u64::from(interleave(i) | (interleave(j) << 1))
                    };
                    let above = leading_one.wrapping_neg();
                    let moved = |axis: u64, amount| step_by(place(i, j), above | !axis, amount);
                    let next = |index: u32| (index + 1) % size;
                    let last = |index: u32| (index + size - 1) % size;
                    assert_eq!(moved(BITS_U, onward(BITS_U)), place(next(i), j));
                    assert_eq!(moved(BITS_U, backward(BITS_U)), place(last(i), j));
                    assert_eq!(moved(BITS_V, onward(BITS_V)), place(i, next(j)));
                    assert_eq!(moved(BITS_V, backward(BITS_V)), place(i, last(j)));
                    assert_eq!(index_of(place(i, j), size), i);
                    assert_eq!(index_of(place(i, j) >> 1, size), j);
                }
            }
        }
    }

    #[test]
    fn every_depth_stands_where_its_node_is_looked_for() {
        let source: MapSource = "procedural:spikes:32:3".parse().unwrap();
        let map = source.load(Channel::Grey, false).unwrap();
        let pyramid = Pyramid::new(&map);
        let depths = NodeDepths::new(&pyramid);
        let format = FloatFormat::E7F16;
        for level in 0..=5 {
            let nodes = 32_u32 >> level;
            for (i, j) in (0..nodes).flat_map(|i| (0..nodes).map(move |j| (i, j))) {
                let place = (nodes * nodes) | interleave(i) | (interleave(j) << 1);
                let height = u64::from(pyramid.height(level, i.into(), j.into()));
                let depth = format.to_f64(format.depth_from_height(height, pyramid.bits()));
                assert_eq!(f64::from(depths.as_slice()[place as usize]), depth);
            }
        }
    }
}
