//! What stands in the registers of the exact machine.

use super::exact_shape::ExactMachineShape;
use crate::arith::Arith;
use crate::readings::F64Reading;
use crate::units::bounded_leaf::{LeafCorner, LeafTravel, SeenCorner};
use crate::units::bounded_setup::{AxisEntry, BoundedEntry, BoundedRay, Division, NearProduct};
use crate::units::bounded_shape::MOST_BOUNDED_LINES;
use crate::units::bounded_step::BoundedWalk;
use crate::units::fixed_setup::FixedRayRegisters;
use crate::units::wide_shape::MOST_CELLS;

/// A ray in a setup, or in its slot.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SlotRay {
    pub id: u32,
    pub mirrored_u: i64,
    pub mirrored_v: i64,
    pub slope_u: i64,
    pub slope_v: i64,
    pub mirror_u: bool,
    pub mirror_v: bool,
    pub start_line: i64,
    pub i: i64,
    pub j: i64,
    pub t_delta_u: i64,
    pub t_delta_v: i64,
}

/// What the leaf check reads of a ray.
pub(super) fn fixed_ray<A: Arith<Int = i64, Bit = bool>>(ray: &SlotRay) -> FixedRayRegisters<A> {
    FixedRayRegisters {
        u: ray.mirrored_u,
        v: ray.mirrored_v,
        slope_u: ray.slope_u,
        slope_v: ray.slope_v,
        mirror_u: ray.mirror_u,
        mirror_v: ray.mirror_v,
    }
}

impl SlotRay {
    pub fn bounded<A: Arith<Int = i64, Bit = bool>>(&self) -> BoundedRay<A> {
        BoundedRay {
            fixed: fixed_ray(self),
            t_delta_u: self.t_delta_u,
            t_delta_v: self.t_delta_v,
            start_line: self.start_line,
        }
    }

    pub fn observe_leaf(&self, words: &mut Vec<u64>) {
        words.extend([u64::from(self.id), self.mirrored_u as u64]);
        words.extend([self.mirrored_v, self.slope_u, self.slope_v].map(|word| word as u64));
        words.extend([u64::from(self.mirror_u), self.mirror_v.into()]);
    }
}

/// A walk in the loop.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LoopWalk {
    pub line: i64,
    pub i: i64,
    pub j: i64,
    pub from_own_line: bool,
    pub column: i64,
    pub row: i64,
    pub kept: [i64; MOST_BOUNDED_LINES],
    pub leaves_u: bool,
    pub leaves_back: bool,
    pub resumes: bool,
    pub steps: i64,
    pub crossings: i64,
}

impl LoopWalk {
    pub fn bounded<A: Arith<Int = i64, Bit = bool>>(&self) -> BoundedWalk<A> {
        BoundedWalk {
            line: self.line,
            i: self.i,
            j: self.j,
            from_own_line: self.from_own_line,
            column: self.column,
            row: self.row,
            kept: self.kept,
            leaves_u: self.leaves_u,
            leaves_back: self.leaves_back,
            resumes: self.resumes,
            steps: self.steps,
            crossings: self.crossings,
            hit: false,
            guard: false,
            depth: 0,
        }
    }

    pub fn of(walk: &BoundedWalk<F64Reading>) -> LoopWalk {
        LoopWalk {
            line: walk.line,
            i: walk.i,
            j: walk.j,
            from_own_line: walk.from_own_line,
            column: walk.column,
            row: walk.row,
            kept: walk.kept,
            leaves_u: walk.leaves_u,
            leaves_back: walk.leaves_back,
            resumes: walk.resumes,
            steps: walk.steps,
            crossings: walk.crossings,
        }
    }

    pub fn observe(&self, shape: &ExactMachineShape, words: &mut Vec<u64>) {
        let lines = shape.bounded.line_levels();
        words.extend([self.line, self.i, self.j].map(|word| word as u64));
        words.push(self.from_own_line.into());
        words.extend([self.column, self.row].map(|word| word as u64));
        words.extend(self.kept[..lines].iter().map(|&mask| mask as u64));
        words.extend([u64::from(self.leaves_u), self.leaves_back.into()]);
        words.push(self.resumes.into());
        if shape.counters {
            words.extend([self.steps, self.crossings].map(|word| word as u64));
        }
    }
}

/// A trip, with what comes of it once the cache has answered.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Trip {
    pub valid: bool,
    pub slot: u64,
    pub fresh: bool,
    pub walk: LoopWalk,
    pub ray: SlotRay,
    pub base: (i64, i64),
    pub address: i64,
    /// Of the line that is read, in the cache's line.
    pub place: i64,
    pub missed: bool,
    /// The bounds of a new ray's first block.
    pub own: (i64, i64),
    pub heights: [i64; MOST_CELLS],
    pub after: LoopWalk,
    pub depth: i64,
    pub guard: bool,
    pub near: (i64, i64),
    pub corner_is_known: bool,
    pub v_is_later: bool,
    pub writes: bool,
    pub ends: bool,
}

impl Trip {
    /// The walk as it waits for the leaf check.
    pub fn leaf_walk(&self) -> LeafWalk {
        let walk = &self.after;
        LeafWalk {
            slot: self.slot,
            i: walk.i,
            j: walk.j,
            kept: walk.kept,
            leaves_u: walk.leaves_u,
            leaves_back: walk.leaves_back,
            corner_is_known: self.corner_is_known,
            v_is_later: self.v_is_later,
            depth: self.depth,
            steps: walk.steps,
            crossings: walk.crossings,
            guard: self.guard,
        }
    }
}

/// A walk at the leaf check.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LeafWalk {
    pub slot: u64,
    pub i: i64,
    pub j: i64,
    pub kept: [i64; MOST_BOUNDED_LINES],
    pub leaves_u: bool,
    pub leaves_back: bool,
    pub corner_is_known: bool,
    pub v_is_later: bool,
    pub depth: i64,
    pub steps: i64,
    pub crossings: i64,
    pub guard: bool,
}

impl LeafWalk {
    /// The walk as it goes back into the loop, refused.
    pub fn resumed(&self) -> LoopWalk {
        LoopWalk {
            line: 0,
            i: self.i,
            j: self.j,
            from_own_line: true,
            column: 0,
            row: 0,
            kept: self.kept,
            leaves_u: self.leaves_u,
            leaves_back: self.leaves_back,
            resumes: true,
            steps: self.steps,
            crossings: self.crossings,
        }
    }

    /// What bounds say of the texel's near corner.
    pub fn corner<A: Arith<Int = i64, Bit = bool>>(&self) -> SeenCorner<A> {
        SeenCorner {
            is_known: self.corner_is_known,
            v_is_later: self.v_is_later,
        }
    }

    /// `corner` says how much of what bounds say of the corner is still held there.
    pub fn observe(&self, shape: &ExactMachineShape, corner: usize, words: &mut Vec<u64>) {
        words.extend([self.slot, self.i as u64, self.j as u64]);
        let lines = shape.bounded.line_levels();
        words.extend(self.kept[..lines].iter().map(|&mask| mask as u64));
        words.extend([u64::from(self.leaves_u), self.leaves_back.into()]);
        let seen = [u64::from(self.corner_is_known), self.v_is_later.into()];
        words.extend_from_slice(&seen[..corner]);
        words.push(self.depth as u64);
        if shape.counters {
            words.extend([self.steps as u64, self.crossings as u64]);
            words.push(self.guard.into());
        }
    }
}

/// A walk in the leaf check, or behind it with its verdict.
#[derive(Clone, Copy, Debug)]
pub(super) struct Checking {
    pub walk: LeafWalk,
    pub ray: SlotRay,
    pub turns: u32,
    pub ways: (i64, i64),
    pub travel: LeafTravel<F64Reading>,
    pub corner: LeafCorner<F64Reading>,
    pub refused: bool,
    pub at_border_u: bool,
    pub at_border_v: bool,
    pub way: i64,
    pub slope: i64,
}

impl Checking {
    pub fn observe(&self, words: &mut Vec<u64>) {
        words.push(self.turns.into());
        let integers = [
            self.ways.0,
            self.ways.1,
            self.travel.u,
            self.travel.v,
            self.travel.depth,
            self.corner.u,
            self.corner.v,
            self.corner.error,
        ];
        words.extend(integers.map(|word| word as u64));
    }
}

/// An axis in a setup.
#[derive(Clone, Copy, Debug)]
pub(super) struct SetUpAxis {
    pub saturates: bool,
    /// Its quotient is that of the digits made in this setup.
    pub division: Division<F64Reading>,
    /// The digits made before.
    pub digits_before: i64,
    pub product: NearProduct<F64Reading>,
    /// Where it only waits: the depth between two borders, and the bound of the near one.
    pub t_delta: i64,
    pub t_near: i64,
}

impl SetUpAxis {
    fn of(entry: &AxisEntry<F64Reading>) -> SetUpAxis {
        let mut axis = SetUpAxis {
            saturates: entry.saturates,
            division: entry.division,
            ..SetUpAxis::default()
        };
        axis.product.behind = entry.behind;
        axis
    }
}

impl Default for SetUpAxis {
    fn default() -> Self {
        SetUpAxis {
            saturates: false,
            division: Division {
                remainder: 0,
                first_saturates: false,
                quotient: 0,
            },
            digits_before: 0,
            product: NearProduct { behind: 0, sum: 0 },
            t_delta: 0,
            t_near: 0,
        }
    }
}

/// A setup.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SetUp {
    pub busy: bool,
    /// Cycles with digits to come.
    pub turns: u32,
    pub ray: SlotRay,
    pub axes: [SetUpAxis; 2],
}

impl SetUp {
    pub fn of(id: u32, entry: &BoundedEntry<F64Reading>) -> SetUp {
        let fixed = &entry.fixed;
        SetUp {
            ray: SlotRay {
                id,
                mirrored_u: fixed.u,
                mirrored_v: fixed.v,
                slope_u: fixed.slope_u,
                slope_v: fixed.slope_v,
                mirror_u: fixed.mirror_u,
                mirror_v: fixed.mirror_v,
                start_line: entry.start_line,
                i: entry.i,
                j: entry.j,
                t_delta_u: 0,
                t_delta_v: 0,
            },
            axes: [SetUpAxis::of(&entry.u), SetUpAxis::of(&entry.v)],
            ..SetUp::default()
        }
    }

    pub fn observe(&self, shape: &ExactMachineShape, number: u32, words: &mut Vec<u64>) {
        words.push(self.busy.into());
        if !shape.only_waits(number) {
            words.push(self.turns.into());
        }
        self.ray.observe_leaf(words);
        let ray = &self.ray;
        words.extend([ray.start_line, ray.i, ray.j].map(|word| word as u64));
        for axis in &self.axes {
            if shape.only_waits(number) {
                words.extend([axis.t_delta as u64, axis.t_near as u64]);
                continue;
            }
            let (division, product) = (&axis.division, &axis.product);
            words.push(axis.saturates.into());
            if number == shape.effort.setups {
                words.push(axis.digits_before as u64);
                words.extend([product.behind as u64, product.sum as u64]);
                continue;
            }
            words.extend([product.behind as u64, division.remainder as u64]);
            words.extend([division.first_saturates.into(), division.quotient as u64]);
            if number > 0 {
                words.push(axis.digits_before as u64);
            }
        }
    }
}

pub(super) fn no_place() -> (LeafTravel<F64Reading>, LeafCorner<F64Reading>) {
    let travel = LeafTravel {
        u: 0,
        v: 0,
        depth: 0,
    };
    let corner = LeafCorner {
        u: 0,
        v: 0,
        error: 0,
    };
    (travel, corner)
}

impl Default for Checking {
    fn default() -> Self {
        Checking {
            walk: LeafWalk::default(),
            ray: SlotRay::default(),
            turns: 0,
            ways: (0, 0),
            travel: no_place().0,
            corner: no_place().1,
            refused: false,
            at_border_u: false,
            at_border_v: false,
            way: 0,
            slope: 0,
        }
    }
}
