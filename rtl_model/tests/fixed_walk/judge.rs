//! Judges exact fixed-point walks by the exact reference on the quantised ray.

use num_bigint::BigInt;
use rtl_model::exact::{ExactHit, exact_hit};
use rtl_model::maps::{HeightMap, Pyramid};
use rtl_model::ray_format::{QuantisedRay, RayFormat};
use rtl_model::scene::{Family, Method};
use rtl_model::units::fixed_traverse::{FixedHit, fixed_walk};
use rtl_model::units::search_policy::{Ascent, SearchPolicy};
use rtl_model::units::traverse::Status;
use std::cmp::Ordering;

/// The policies of all methods that look at a node a step, and of all levels down.
pub fn policies() -> Vec<(Method, SearchPolicy)> {
    let levels = (1..=Method::MOST_LEVELS_DOWN).map(Method::MultiLevelDown);
    let methods = Method::ALL.into_iter().chain(levels);
    let policies: Vec<_> = methods
        .filter_map(|method| match method.family() {
            Family::Nodes(policy) => Some((method, policy)),
            _ => None,
        })
        .collect();
    assert_eq!(policies.len(), 14);
    policies
}

/// A map, its pyramid, and the format of its rays.
pub struct Scene {
    pub map: HeightMap,
    pub pyramid: Pyramid,
    pub format: RayFormat,
}

impl Scene {
    pub fn new(map: HeightMap, format: impl FnOnce(&Pyramid) -> RayFormat) -> Scene {
        let pyramid = Pyramid::new(&map);
        let format = format(&pyramid);
        Scene {
            map,
            pyramid,
            format,
        }
    }

    pub fn walk(&self, policy: SearchPolicy, ray: &QuantisedRay) -> FixedHit {
        fixed_walk(self.format.shape(), policy, self.pyramid.memory(), ray)
    }

    /// What is wrong with a hit of this ray, if anything.
    pub fn fault(
        &self,
        policy: SearchPolicy,
        ray: &QuantisedRay,
        hit: &FixedHit,
    ) -> Option<String> {
        self.fault_by(&self.truth(ray), policy, ray, hit)
    }

    fn truth(&self, ray: &QuantisedRay) -> ExactHit {
        exact_hit(&self.map, self.format.entered(ray)).expect("a quantised ray")
    }

    fn fault_by(
        &self,
        truth: &ExactHit,
        policy: SearchPolicy,
        ray: &QuantisedRay,
        hit: &FixedHit,
    ) -> Option<String> {
        let shape = self.format.shape();
        let full_height = shape.full_height();
        let left = BigInt::from(hit.depth_numerator) * truth.t.denominator;
        let right = BigInt::from(hit.depth_denominator) * full_height * truth.t.numerator;
        let number = hit.to_hit(shape, ray);
        let entered = self.format.entered(ray);
        let checks = [
            ("guard", hit.status == Status::Hit),
            ("texel", (hit.i, hit.j) == (truth.i, truth.j)),
            ("side", hit.side == truth.side),
            ("depth", left == right),
            (
                "t is late",
                truth.t.compare_with(number.t) != Ordering::Less,
            ),
            (
                "t is early",
                truth.t.compare_with(number.t.next_up()) == Ordering::Less,
            ),
            (
                "position",
                near(number.u, entered.u + truth.t.to_f64() * entered.du)
                    && near(number.v, entered.v + truth.t.to_f64() * entered.dv),
            ),
            (
                "steps",
                hit.steps < shape.step_bound(policy.ascent != Ascent::Never)
                    && (policy != SearchPolicy::OH
                        || hit.steps == shape.root_level + 1 + hit.crossings),
            ),
        ];
        let (name, _) = checks.into_iter().find(|(_, holds)| !holds)?;
        Some(format!(
            "{name}: {ray:?} in {} through {}: {hit:?}, truth {truth:?}",
            self.format,
            self.map.name()
        ))
    }

    /// Walks a ray by every policy and panics at the first fault.
    pub fn check(&self, policies: &[(Method, SearchPolicy)], ray: &QuantisedRay) {
        let truth = self.truth(ray);
        for &(method, policy) in policies {
            let hit = self.walk(policy, ray);
            if let Some(fault) = self.fault_by(&truth, policy, ray, &hit) {
                panic!("{method}: {fault}");
            }
        }
    }
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * (1.0 + b.abs())
}

/// Numbers that look random, from a seed.
pub struct Draw(pub u64);

impl Draw {
    /// One of `0..count`.
    pub fn below(&mut self, count: u64) -> i64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % count) as i64
    }

    /// One of `-most..=most`.
    pub fn around(&mut self, most: i64) -> i64 {
        self.below(2 * most as u64 + 1) - most
    }
}
