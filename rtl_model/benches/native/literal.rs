//! The method as it is written down: the position is known, the node is the one it lies in, and the
//! borders, the exits and the depth are divided out.

use super::{NativeHit, NativeWalk, hit};
use rtl_model::maps::Pyramid;
use rtl_model::ray::Ray;

pub struct Literal<'a> {
    pyramid: &'a Pyramid,
}

impl Literal<'_> {
    pub fn new(pyramid: &Pyramid) -> Literal<'_> {
        Literal { pyramid }
    }
}

impl NativeWalk for Literal<'_> {
    #[inline(always)]
    fn walk(&self, ray: Ray<f32>) -> NativeHit {
        let (mirror_u, mirror_v) = (ray.du < 0.0, ray.dv < 0.0);
        let (u, v) = (
            if mirror_u { -ray.u } else { ray.u },
            if mirror_v { -ray.v } else { ray.v },
        );
        let (du, dv) = (ray.du.abs(), ray.dv.abs());
        let full = ((1_u32 << self.pyramid.bits()) - 1) as f32;
        let memory = self.pyramid.memory();
        let (mut level, mut t, mut steps) = (self.pyramid.levels(), 0.0_f32, 0_u32);
        let (mut at_u, mut at_v) = (u, v);
        loop {
            steps += 1;
            let below_root = self.pyramid.levels() - level;
            let nodes = (1_u32 << below_root) as f32;
            let (i, j) = ((at_u * nodes).floor(), (at_v * nodes).floor());
            let mask = (1_i32 << below_root) - 1;
            let column = (if mirror_u { !(i as i32) } else { i as i32 }) & mask;
            let row = (if mirror_v { !(j as i32) } else { j as i32 }) & mask;
            let address = (1 << (2 * below_root)) | (row << below_root) | column;
            let depth = 1.0 - f32::from(memory[address as usize]) / full;
            let (border_u, border_v) = ((i + 1.0) / nodes, (j + 1.0) / nodes);
            let (exit_u, exit_v) = ((border_u - u) / du, (border_v - v) / dv);
            let exit = exit_u.min(exit_v);
            if depth <= t || depth <= exit {
                if depth > t {
                    t = depth;
                    (at_u, at_v) = (u + t * du, v + t * dv);
                }
                if level == 0 {
                    let texel = (column as u32, row as u32);
                    return hit(ray, texel, t, steps, self.pyramid.levels());
                }
                level -= 1;
            } else {
                t = t.max(exit);
                // On the border that is crossed, whatever a product would make of it.
                (at_u, at_v) = if exit_u <= exit_v {
                    (border_u, v + t * dv)
                } else {
                    (u + t * du, border_v)
                };
            }
        }
    }
}
