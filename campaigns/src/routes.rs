//! The golden arithmetic by its two routes: integers on bits, and `f64` rounded once.

use rtl_model::float::{Answer, FloatArithmetic, Operation, ThroughF64};

use crate::operands::Operands;
use crate::sweep::{Difference, Outcome, sweep};

/// The operations that have two routes.
pub const OPERATIONS: [Operation; 5] = [
    Operation::Add,
    Operation::Subtract,
    Operation::Multiply,
    Operation::Divide,
    Operation::SquareRoot,
];

/// The result by way of `f64`.
#[inline]
fn through_f64(route: ThroughF64, operation: Operation, [a, b, _]: [u64; 3]) -> u64 {
    match operation {
        Operation::Add => route.add(a, b),
        Operation::Subtract => route.sub(a, b),
        Operation::Multiply => route.mul(a, b),
        Operation::Divide => route.div(a, b),
        Operation::SquareRoot => route.sqrt(a),
        _ => unreachable!("not one of the operations with two routes"),
    }
}

/// Both routes on `count` cases, or all where there are no more; and whether these were all. `None`
/// where the format is too wide for `f64`. `alter` may change the integer route's answer: for
/// planting faults.
pub fn compare(
    arithmetic: FloatArithmetic,
    operation: Operation,
    count: u64,
    seed: u64,
    progress: &(dyn Fn(u64) + Sync),
    alter: impl Fn(Answer, [u64; 3]) -> Answer + Sync,
) -> Option<(Outcome, bool)> {
    let route = arithmetic.through_f64()?;
    let operands = Operands::new(operation, arithmetic.format, count, seed);
    let outcome = sweep(
        operands.count(),
        |cases, tell| {
            for index in cases {
                let set = operands.set(index);
                let integer = alter(operation.evaluate(arithmetic, set), set).bits;
                let other = through_f64(route, operation, set);
                if integer != other {
                    tell(Difference {
                        index,
                        operands: set[..operands.width()].to_vec(),
                        golden: vec![integer],
                        other: vec![other],
                    });
                }
            }
        },
        progress,
    );
    Some((outcome, operands.is_exhaustive()))
}
