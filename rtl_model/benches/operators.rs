//! e7f16 arithmetic on slices against the machine's own `f32` and against `rustc_apfloat` with the same
//! widths: nanoseconds a number on one thread, all in one run.
//!
//! The native rival is the plain loop, compiled for the same instruction set by the same means. The
//! rival in software has its numbers unpacked beforehand, so that it is timed for its arithmetic
//! alone, while ours reads and writes patterns. Both are timed on 2^16 numbers, which lie in the second
//! level of cache as a frame's do; the first rows say what is left where all lies in the first.

mod comparison;

use comparison::{Target, print_missed, print_row, quickest};
use pulp::{Arch, Simd, WithSimd};
use rtl_model::float::slices::{self, Operator};
use rtl_model::float::{FloatFormat, Policy, Rounding};
use rtl_model::instruction_set::InstructionSet;
use rustc_apfloat::ieee::{IeeeFloat, Semantics};
use rustc_apfloat::{Float, Round};
use std::hint::black_box;

/// Rounds of each comparison with native floats: short ones, and many, so that some are undisturbed.
const RUNS: usize = 2000;
/// Rounds of the comparisons with slower rivals.
const LONG_RUNS: usize = 50;
/// Passes of ours in such a round. The rival's numbers take megabytes, and push ours out of the second level of
/// cache; the first pass brings them back.
const PASSES: usize = 16;
/// Operations timed at once, at least.
const OPERATIONS: usize = 1 << 18;

/// 24 bits, 7 of them exponent.
struct E7F16Semantics;

impl Semantics for E7F16Semantics {
    const BITS: usize = 24;
    const EXP_BITS: usize = 7;
}

type Software = IeeeFloat<E7F16Semantics>;

const OPERATORS: [(&str, Operator); 3] = [
    ("add", Operator::Add),
    ("mul", Operator::Multiply),
    ("div", Operator::Divide),
];

fn main() {
    println!(
        "e7f16 on slices ({}), to nearest even, one thread, nanoseconds a number, quickest of {RUNS} rounds",
        InstructionSet::Detected
    );
    let mut met = Vec::new();
    for (name, operator) in OPERATORS {
        native(name, operator, 1 << 11, Target::Time);
        met.push(native(name, operator, 1 << 16, Target::TimeAtMost(7.0)));
        met.push(software(name, operator, 1 << 16));
        other_routes(name, operator, 1 << 16);
    }
    print_missed(&met);
}

/// Patterns of either sign with exponents from -16 to 15: no special values, and sums that cancel.
fn operands(count: usize) -> (Vec<u32>, Vec<u32>) {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut pattern = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        let field = 63 - 16 + (state >> 32) as u32 % 32;
        (state as u32 & 0x80_ffff) | (field << 16)
    };
    (0..count).map(|_| (pattern(), pattern())).unzip()
}

fn native(name: &str, operator: Operator, count: usize, target: Target) -> bool {
    let (a, b) = operands(count);
    let value = |&pattern: &u32| FloatFormat::E7F16.to_f64(pattern.into()) as f32;
    let x: Vec<f32> = a.iter().map(value).collect();
    let y: Vec<f32> = b.iter().map(value).collect();
    let (mut results, mut native_results) = (vec![0; count], vec![0.0; count]);
    let repeats = OPERATIONS / count;
    let arch = Arch::new();
    let [ours, rivals] = quickest(
        RUNS,
        [
            &mut || {
                for _ in 0..repeats {
                    let (a, b) = (black_box(&a), black_box(&b));
                    slices::evaluate(
                        InstructionSet::Detected,
                        operator,
                        Rounding::NearestEven,
                        a,
                        b,
                        &mut results,
                    );
                    black_box(&mut results);
                }
            },
            &mut || {
                for _ in 0..repeats {
                    arch.dispatch(NativePairs {
                        operator,
                        a: black_box(&x),
                        b: black_box(&y),
                        results: &mut native_results,
                    });
                    black_box(&mut native_results);
                }
            },
        ],
    );
    let each = 1e9 / (repeats * count) as f64;
    let what = format!("{name}, {count} numbers");
    print_row(what, ours * each, "native f32", rivals * each, target)
}

struct NativePairs<'a> {
    operator: Operator,
    a: &'a [f32],
    b: &'a [f32],
    results: &'a mut [f32],
}

impl WithSimd for NativePairs<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let pairs = self.results.iter_mut().zip(self.a).zip(self.b);
        match self.operator {
            Operator::Add => pairs.for_each(|((result, a), b)| *result = a + b),
            Operator::Subtract => pairs.for_each(|((result, a), b)| *result = a - b),
            Operator::Multiply => pairs.for_each(|((result, a), b)| *result = a * b),
            Operator::Divide => pairs.for_each(|((result, a), b)| *result = a / b),
        }
    }
}

fn software(name: &str, operator: Operator, count: usize) -> bool {
    let (a, b) = operands(count);
    let unpack = |&pattern: &u32| Software::from_bits(pattern.into());
    let x: Vec<Software> = a.iter().map(unpack).collect();
    let y: Vec<Software> = b.iter().map(unpack).collect();
    let mut results = vec![0; count];
    let mut software_results = x.clone();
    let [ours, rivals] = quickest(
        LONG_RUNS,
        [
            &mut || {
                for _ in 0..PASSES {
                    let (a, b) = (black_box(&a), black_box(&b));
                    slices::evaluate(
                        InstructionSet::Detected,
                        operator,
                        Rounding::NearestEven,
                        a,
                        b,
                        &mut results,
                    );
                    black_box(&mut results);
                }
            },
            &mut || {
                let nearest = Round::NearestTiesToEven;
                let pairs = software_results.iter_mut().zip(&x).zip(&y);
                match operator {
                    Operator::Add => pairs.for_each(|((r, &x), &y)| *r = x.add_r(y, nearest).value),
                    Operator::Subtract => {
                        pairs.for_each(|((r, &x), &y)| *r = x.sub_r(y, nearest).value)
                    }
                    Operator::Multiply => {
                        pairs.for_each(|((r, &x), &y)| *r = x.mul_r(y, nearest).value)
                    }
                    Operator::Divide => {
                        pairs.for_each(|((r, &x), &y)| *r = x.div_r(y, nearest).value)
                    }
                }
                black_box(&mut software_results);
            },
        ],
    );
    // The rival computes the same: nothing here is subnormal or special but what flushes.
    let differences = results
        .iter()
        .zip(&software_results)
        .filter(|&(&ours, rival)| u128::from(ours) != rival.to_bits());
    assert_eq!(
        differences.count(),
        0,
        "{name}: the rival has other results"
    );
    let each = 1e9 / count as f64;
    let what = format!("{name}, {count} numbers");
    let target = Target::SpeedAtLeast(20.0);
    print_row(
        what,
        ours / PASSES as f64 * each,
        "rustc_apfloat (7, 16)",
        rivals * each,
        target,
    )
}

/// The other ways to the same bits, for information.
fn other_routes(name: &str, operator: Operator, count: usize) {
    let (a, b) = operands(count);
    let [mut fast, mut avx2, mut plain, mut single, mut integer] = [(); 5].map(|()| vec![0; count]);
    let arithmetic = FloatFormat::E7F16.arithmetic(Policy::Flush, Rounding::NearestEven);
    let through_f64 = arithmetic.through_f64().expect("17 significant bits");
    let on = |set, results: &mut [u32]| {
        for _ in 0..PASSES {
            let (a, b) = (black_box(&a), black_box(&b));
            slices::evaluate(set, operator, Rounding::NearestEven, a, b, results);
        }
    };
    let one_by_one = |results: &mut [u32], operate: &dyn Fn(u64, u64) -> u64| {
        for ((result, &a), &b) in results.iter_mut().zip(black_box(&a)).zip(&b) {
            *result = operate(a.into(), b.into()) as u32;
        }
    };
    let [ours, avx2_time, plain_time, single_time, integer_time] = quickest(
        LONG_RUNS,
        [
            &mut || on(InstructionSet::Detected, &mut fast),
            &mut || on(InstructionSet::Avx2, &mut avx2),
            &mut || on(InstructionSet::Plain, &mut plain),
            &mut || match operator {
                Operator::Add => one_by_one(&mut single, &|a, b| through_f64.add(a, b)),
                Operator::Subtract => one_by_one(&mut single, &|a, b| through_f64.sub(a, b)),
                Operator::Multiply => one_by_one(&mut single, &|a, b| through_f64.mul(a, b)),
                Operator::Divide => one_by_one(&mut single, &|a, b| through_f64.div(a, b)),
            },
            &mut || match operator {
                Operator::Add => one_by_one(&mut integer, &|a, b| arithmetic.add(a, b).bits),
                Operator::Subtract => one_by_one(&mut integer, &|a, b| arithmetic.sub(a, b).bits),
                Operator::Multiply => one_by_one(&mut integer, &|a, b| arithmetic.mul(a, b).bits),
                Operator::Divide => one_by_one(&mut integer, &|a, b| arithmetic.div(a, b).bits),
            },
        ],
    );
    let same = fast == avx2 && fast == plain && fast == single && fast == integer;
    assert!(same, "{name}");
    let each = 1e9 / count as f64;
    let ours = ours / PASSES as f64;
    for (rival, time) in [
        ("the same, AVX2", avx2_time / PASSES as f64),
        ("the same, plain instructions", plain_time / PASSES as f64),
        ("through f64, a call each", single_time),
        ("by integers, a call each", integer_time),
    ] {
        let what = format!("{name}, {count} numbers");
        print_row(what, ours * each, rival, time * each, Target::Speed);
    }
}
