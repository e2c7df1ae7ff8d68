//! Nodes row by row, as the pyramid's memory has them; branches.

use super::{Mirrored, NativeHit, NativeWalk, depths, hit, mirror};
use rtl_model::maps::Pyramid;
use rtl_model::ray::Ray;

pub struct RowByRow {
    levels: u32,
    depths: Vec<f32>,
}

impl RowByRow {
    pub fn new(pyramid: &Pyramid) -> RowByRow {
        RowByRow {
            levels: pyramid.levels(),
            depths: depths(pyramid),
        }
    }
}

impl NativeWalk for RowByRow {
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
        let (step_u, step_v) = (1 - 2 * i32::from(mirror_u), 1 - 2 * i32::from(mirror_v));
        let (near_u, near_v) = (i32::from(mirror_u), i32::from(mirror_v));
        let (mut i, mut j, mut below_root) = (0_i32, 0_i32, 0_u32);
        let (mut t, mut size, mut steps) = (0.0_f32, 1.0_f32, 0_u32);
        loop {
            steps += 1;
            let mask = (1_i32 << below_root) - 1;
            let (column, row) = (i & mask, j & mask);
            let address = (1 << (2 * below_root)) | (row << below_root) | column;
            let depth = self.depths[address as usize];
            let (exit_u, exit_v) = (border_u * per_u, border_v * per_v);
            let exit = if exit_u < exit_v { exit_u } else { exit_v };
            if depth <= t || depth <= exit {
                t = if depth > t { depth } else { t };
                if below_root == self.levels {
                    return hit(ray, (column as u32, row as u32), t, steps, self.levels);
                }
                size *= 0.5;
                let (midline_u, midline_v) = (border_u - size, border_v - size);
                let (far_u, far_v) = (t * du >= midline_u, t * dv >= midline_v);
                border_u = if far_u { border_u } else { midline_u };
                border_v = if far_v { border_v } else { midline_v };
                i = 2 * i + (i32::from(far_u) ^ near_u);
                j = 2 * j + (i32::from(far_v) ^ near_v);
                below_root += 1;
            } else {
                t = exit;
                if exit_u <= exit_v {
                    i += step_u;
                    border_u += size;
                } else {
                    j += step_v;
                    border_v += size;
                }
            }
        }
    }
}
