//! Nodes in Z order, as packets have them: with branches, and with none but the one that ends a walk.

use super::{Mirrored, NativeHit, NativeWalk, depth, hit, mirror};
use rtl_model::maps::Pyramid;
use rtl_model::ray::Ray;

const BITS_U: u32 = 0x5555_5555;
const BITS_V: u32 = 0xaaaa_aaaa;

fn depths_in_z_order(pyramid: &Pyramid) -> Vec<f32> {
    let interleave = |index: u32| (0..16).fold(0, |bits, k| bits | ((index >> k) & 1) << (2 * k));
    let mut depths = vec![0.0; pyramid.memory().len()];
    for level in 0..=pyramid.levels() {
        let nodes = 1_u32 << (pyramid.levels() - level);
        for j in 0..nodes {
            for i in 0..nodes {
                let place = (nodes * nodes) | interleave(i) | (interleave(j) << 1);
                let height = pyramid.height(level, i64::from(i), i64::from(j));
                depths[place as usize] = depth(height, pyramid.bits());
            }
        }
    }
    depths
}

/// The neighbour of a node in the bits that are not kept.
#[inline(always)]
fn neighbour(node: u32, kept: u32, amount: u32) -> u32 {
    ((node | kept).wrapping_add(amount) & !kept) | (node & kept)
}

#[inline(always)]
fn index_of(node: u32, levels: u32) -> u32 {
    let mut bits = node & BITS_U;
    bits = (bits | (bits >> 1)) & 0x3333_3333;
    bits = (bits | (bits >> 2)) & 0x0f0f_0f0f;
    bits = (bits | (bits >> 4)) & 0x00ff_00ff;
    (bits | (bits >> 8)) & ((1 << levels) - 1)
}

pub struct ZOrder {
    levels: u32,
    depths: Vec<f32>,
}

impl ZOrder {
    pub fn new(pyramid: &Pyramid) -> ZOrder {
        ZOrder {
            levels: pyramid.levels(),
            depths: depths_in_z_order(pyramid),
        }
    }
}

impl NativeWalk for ZOrder {
    #[inline(always)]
    fn walk(&self, ray: Ray<f32>) -> NativeHit {
        let Mirrored {
            mirror_u,
            mirror_v,
            du,
            dv,
            per_u,
            per_v,
            mut border_u,
            mut border_v,
        } = mirror(ray);
        let next_u = if mirror_u { BITS_U } else { 1 };
        let next_v = if mirror_v { BITS_V } else { 2 };
        let near_child = u32::from(mirror_u) | (u32::from(mirror_v) << 1);
        let bottom = 1_u32 << (2 * self.levels);
        let depths = &self.depths[..];
        let mask = depths.len() - 1;
        let (mut node, mut leading_one) = (1_u32, 1_u32);
        let (mut t, mut size, mut steps) = (0.0_f32, 1.0_f32, 0_u32);
        loop {
            steps += 1;
            let depth = depths[node as usize & mask];
            let (exit_u, exit_v) = (border_u * per_u, border_v * per_v);
            let exit = if exit_u < exit_v { exit_u } else { exit_v };
            if depth <= t || depth <= exit {
                t = if depth > t { depth } else { t };
                if leading_one == bottom {
                    let texel = (
                        index_of(node, self.levels),
                        index_of(node >> 1, self.levels),
                    );
                    return hit(ray, texel, t, steps, self.levels);
                }
                size *= 0.5;
                let (midline_u, midline_v) = (border_u - size, border_v - size);
                let (far_u, far_v) = (t * du >= midline_u, t * dv >= midline_v);
                border_u = if far_u { border_u } else { midline_u };
                border_v = if far_v { border_v } else { midline_v };
                node = (node << 2) ^ u32::from(far_u) ^ (u32::from(far_v) << 1) ^ near_child;
                leading_one <<= 2;
            } else {
                t = exit;
                let above = leading_one.wrapping_neg();
                if exit_u <= exit_v {
                    border_u += size;
                    node = neighbour(node, above | BITS_V, next_u);
                } else {
                    border_v += size;
                    node = neighbour(node, above | BITS_U, next_v);
                }
            }
        }
    }
}

pub struct BranchFree(ZOrder);

impl BranchFree {
    pub fn new(pyramid: &Pyramid) -> BranchFree {
        BranchFree(ZOrder::new(pyramid))
    }
}

/// All ones or all zeros.
#[inline(always)]
fn all_bits(condition: bool) -> u32 {
    u32::from(condition).wrapping_neg()
}

impl NativeWalk for BranchFree {
    #[inline(always)]
    fn walk(&self, ray: Ray<f32>) -> NativeHit {
        let Mirrored {
            mirror_u,
            mirror_v,
            du,
            dv,
            per_u,
            per_v,
            mut border_u,
            mut border_v,
        } = mirror(ray);
        let next_u = if mirror_u { BITS_U } else { 1 };
        let next_v = if mirror_v { BITS_V } else { 2 };
        let near_child = u32::from(mirror_u) | (u32::from(mirror_v) << 1);
        let levels = self.0.levels;
        let bottom = 1_u32 << (2 * levels);
        let depths = &self.0.depths[..];
        let mask = depths.len() - 1;
        let (mut node, mut leading_one) = (1_u32, 1_u32);
        let (mut t, mut size, mut steps) = (0.0_f32, 1.0_f32, 0_u32);
        loop {
            steps += 1;
            let depth = depths[node as usize & mask];
            let (exit_u, exit_v) = (border_u * per_u, border_v * per_v);
            let exit = if exit_u < exit_v { exit_u } else { exit_v };
            let limit = if exit > t { exit } else { t };
            let down = all_bits(depth <= limit);
            let reached = if depth < exit { depth } else { exit };
            t = if reached > t { reached } else { t };
            if down != 0 && leading_one == bottom {
                let texel = (index_of(node, levels), index_of(node >> 1, levels));
                return hit(ray, texel, t, steps, levels);
            }
            let half = 0.5 * size;
            let far_u = all_bits(t * du >= border_u - half);
            let far_v = all_bits(t * dv >= border_v - half);
            let child = (node << 2) ^ (far_u & 1) ^ (far_v & 2) ^ near_child;
            let u_first = all_bits(exit_u <= exit_v);
            let kept = leading_one.wrapping_neg() | (BITS_V & u_first) | (BITS_U & !u_first);
            let across = neighbour(node, kept, (next_u & u_first) | (next_v & !u_first));
            node = (child & down) | (across & !down);
            leading_one <<= 2 & down;
            // Half a node back for the near child, a node on across, or nothing.
            let back = (-half).to_bits() & down;
            let on = size.to_bits() & !down;
            border_u += f32::from_bits((back & !far_u) | (on & u_first));
            border_v += f32::from_bits((back & !far_v) | (on & !u_first));
            size = f32::from_bits((half.to_bits() & down) | (size.to_bits() & !down));
        }
    }
}
