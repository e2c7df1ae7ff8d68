//! e7f16 arithmetic on slices of numbers: fast, and the same bits as one number at a time.
//!
//! A number is its pattern in the low 24 bits of a `u32`; the upper ones are not read, and zero in
//! results. The policy is `flush`. The route is that of [`super::ThroughF64`], for the reasons given
//! there, laid out for vector instructions, those of AVX2 where the machine has them
//! ([`InstructionSet`]). Only the operation itself is done in `f64`, four numbers to a
//! vector; what comes before and after is done on 32 bits, eight to a vector:
//!
//! 1. a pattern becomes the `f32` of its value, exactly: that has more exponents and more fraction bits;
//! 2. the operation is done in `f64`, and its result *rounded to odd* to the 24 bits of an `f32`: the
//!    bits beyond are cut off, and the last one is set if any of them was. The result lies
//!    between 2^-126 and 2^128, as an `f32` does;
//! 3. that is rounded to the 17 bits of the format. Rounding to odd to at least 17 + 2 bits first makes no
//!    difference to any rounding (Boldo and Melquiond 2008).
//!
//! Each step is a loop of its own over a block of numbers: in one loop the compiler would take all
//! steps four at a time.
//!
//! ```
//! use rtl_model::float::{Rounding, slices};
//!
//! let mut sums = [0; 3];
//! slices::add(Rounding::NearestEven, &[0x3f0000; 3], &[0x3f0000, 0xbf0000, 0x2e0000], &mut sums);
//! assert_eq!(sums, [0x400000, 0x000000, 0x3f0000]);
//! ```

use super::Rounding;
use super::through_f64::{error_of_sum, to_odd};
use crate::instruction_set::{InstructionSet, Work};

/// Which operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operator {
    /// `a + b`.
    Add,
    /// `a - b`.
    Subtract,
    /// `a * b`.
    Multiply,
    /// `a / b`.
    Divide,
}

impl Operator {
    /// All four.
    pub const ALL: [Operator; 4] = [
        Operator::Add,
        Operator::Subtract,
        Operator::Multiply,
        Operator::Divide,
    ];
}

/// `a + b` of each pair.
///
/// # Panics
/// As all of these: if the three are not of one length.
pub fn add(rounding: Rounding, a: &[u32], b: &[u32], results: &mut [u32]) {
    evaluate(
        InstructionSet::Detected,
        Operator::Add,
        rounding,
        a,
        b,
        results,
    );
}

/// `a - b` of each pair.
pub fn sub(rounding: Rounding, a: &[u32], b: &[u32], results: &mut [u32]) {
    evaluate(
        InstructionSet::Detected,
        Operator::Subtract,
        rounding,
        a,
        b,
        results,
    );
}

/// `a * b` of each pair.
pub fn mul(rounding: Rounding, a: &[u32], b: &[u32], results: &mut [u32]) {
    evaluate(
        InstructionSet::Detected,
        Operator::Multiply,
        rounding,
        a,
        b,
        results,
    );
}

/// `a / b` of each pair.
pub fn div(rounding: Rounding, a: &[u32], b: &[u32], results: &mut [u32]) {
    evaluate(
        InstructionSet::Detected,
        Operator::Divide,
        rounding,
        a,
        b,
        results,
    );
}

/// Any of them, compiled for these instructions.
pub fn evaluate(
    instruction_set: InstructionSet,
    operator: Operator,
    rounding: Rounding,
    a: &[u32],
    b: &[u32],
    results: &mut [u32],
) {
    assert!(
        a.len() == results.len() && b.len() == results.len(),
        "slices of {}, {} and {} numbers",
        a.len(),
        b.len(),
        results.len()
    );
    instruction_set.run(Pairs {
        operator,
        rounding,
        a,
        b,
        results,
    });
}

/// Numbers of a block.
const BLOCK: usize = 128;

/// The sign of a pattern.
const SIGN: u32 = 1 << 23;
const MIN_NORMAL: u32 = 1 << 16;
const INFINITY: u32 = 0x7f << 16;
const QUIET_NAN: u32 = INFINITY | 1 << 15;
/// The sign of an `f32`.
const F32_SIGN: u32 = 1 << 31;
const F32_INFINITY: u32 = 0xff << 23;
/// Fraction bits of an `f32` beyond those of the format.
const DROPPED: u32 = 23 - 16;
/// The difference of the biases, 127 - 63.
const REBIAS: u32 = 64;

struct Pairs<'a> {
    operator: Operator,
    rounding: Rounding,
    a: &'a [u32],
    b: &'a [u32],
    results: &'a mut [u32],
}

impl Work for Pairs<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        match self.operator {
            Operator::Add => self.each_rounding::<Add>(),
            Operator::Subtract => self.each_rounding::<Subtract>(),
            Operator::Multiply => self.each_rounding::<Multiply>(),
            Operator::Divide => self.each_rounding::<Divide>(),
        }
    }
}

/// An operator as a type, so that each has loops of its own.
trait Operate {
    /// The result in `f64`, as good as the exact one under this rounding.
    fn operate(rounding: Rounding, a: f64, b: f64) -> f64;
}

struct Add;
struct Subtract;
struct Multiply;
struct Divide;

impl Operate for Add {
    #[inline(always)]
    fn operate(rounding: Rounding, a: f64, b: f64) -> f64 {
        let sum = a + b;
        let sum = match rounding {
            Rounding::NearestEven => sum,
            _ => to_odd(sum, error_of_sum(a, b, sum)),
        };
        match rounding {
            // A difference of nothing is -0, and +0 only the sum of two such.
            Rounding::Down => {
                let signs = (a.to_bits() | b.to_bits()) & (1 << 63);
                select(sum == 0.0, f64::from_bits(signs), sum)
            }
            _ => sum,
        }
    }
}

impl Operate for Subtract {
    #[inline(always)]
    fn operate(rounding: Rounding, a: f64, b: f64) -> f64 {
        Add::operate(rounding, a, -b)
    }
}

impl Operate for Multiply {
    #[inline(always)]
    fn operate(_: Rounding, a: f64, b: f64) -> f64 {
        a * b
    }
}

impl Operate for Divide {
    #[inline(always)]
    fn operate(_: Rounding, a: f64, b: f64) -> f64 {
        a / b
    }
}

impl Pairs<'_> {
    /// A loop for each rounding, so that there is no choice left inside it.
    #[inline(always)]
    fn each_rounding<O: Operate>(self) {
        match self.rounding {
            Rounding::NearestEven => self.each_block::<O>(Rounding::NearestEven),
            Rounding::TowardZero => self.each_block::<O>(Rounding::TowardZero),
            Rounding::Up => self.each_block::<O>(Rounding::Up),
            Rounding::Down => self.each_block::<O>(Rounding::Down),
        }
    }

    #[inline(always)]
    fn each_block<O: Operate>(self, rounding: Rounding) {
        let (a_blocks, a_rest) = self.a.as_chunks::<BLOCK>();
        let (b_blocks, b_rest) = self.b.as_chunks::<BLOCK>();
        let (blocks, rest) = self.results.as_chunks_mut::<BLOCK>();
        for ((results, a), b) in blocks.iter_mut().zip(a_blocks).zip(b_blocks) {
            operate_block::<O>(rounding, a, b, results);
        }
        let count = rest.len();
        if count > 0 {
            let (mut a, mut b, mut results) = ([0; BLOCK], [0; BLOCK], [0; BLOCK]);
            a[..count].copy_from_slice(a_rest);
            b[..count].copy_from_slice(b_rest);
            operate_block::<O>(rounding, &a, &b, &mut results);
            rest.copy_from_slice(&results[..count]);
        }
    }
}

#[inline(always)]
fn operate_block<O: Operate>(
    rounding: Rounding,
    a: &[u32; BLOCK],
    b: &[u32; BLOCK],
    results: &mut [u32; BLOCK],
) {
    let (mut x, mut y) = ([0.0_f32; BLOCK], [0.0_f32; BLOCK]);
    for place in 0..BLOCK {
        x[place] = value(a[place]);
        y[place] = value(b[place]);
    }
    let mut odd = [0.0_f32; BLOCK];
    for place in 0..BLOCK {
        let result = O::operate(rounding, f64::from(x[place]), f64::from(y[place]));
        odd[place] = to_odd_f32(result);
    }
    for place in 0..BLOCK {
        results[place] = rounded(rounding, odd[place]);
    }
}

/// The value of a pattern, subnormal ones flushed.
#[inline(always)]
fn value(pattern: u32) -> f32 {
    let magnitude = pattern & (SIGN - 1);
    let normal = (magnitude << DROPPED) + (REBIAS << 23);
    let finite = select(magnitude < MIN_NORMAL, 0, normal);
    let bits = finite | select(magnitude < INFINITY, 0, F32_INFINITY);
    f32::from_bits(bits | ((pattern & SIGN) << 8))
}

/// An `f64` within the range of `f32`, infinite or NaN, rounded to odd.
#[inline(always)]
fn to_odd_f32(value: f64) -> f32 {
    /// The fraction bits that an `f32` does not have.
    const BEYOND: u64 = (1 << 29) - 1;
    let bits = value.to_bits();
    // Any one of them carries into the place of the last bit kept.
    let last = (bits & BEYOND) + BEYOND;
    f64::from_bits((bits | last) & !BEYOND) as f32
}

/// The pattern of a value that has been rounded to odd.
#[inline(always)]
fn rounded(rounding: Rounding, value: f32) -> u32 {
    let bits = value.to_bits();
    let sign = bits & F32_SIGN;
    let absolute = bits ^ sign;
    let negative = sign != 0;
    const ALL: u32 = (1 << DROPPED) - 1;
    let increment = match rounding {
        Rounding::NearestEven => (ALL >> 1) + (absolute >> DROPPED & 1),
        Rounding::TowardZero => 0,
        Rounding::Up => select(negative, 0, ALL),
        Rounding::Down => select(negative, ALL, 0),
    };
    // Signed, and the exponents far from its ends: what lies below the format's is negative.
    let rebias = (REBIAS << 16) as i32;
    let pattern = (absolute.wrapping_add(increment) >> DROPPED) as i32 - rebias;
    let most = match rounding {
        Rounding::NearestEven => INFINITY,
        Rounding::TowardZero => select(absolute == F32_INFINITY, INFINITY, INFINITY - 1),
        Rounding::Up => select(
            negative & (absolute != F32_INFINITY),
            INFINITY - 1,
            INFINITY,
        ),
        Rounding::Down => select(
            negative | (absolute == F32_INFINITY),
            INFINITY,
            INFINITY - 1,
        ),
    };
    let magnitude = select(
        pattern < MIN_NORMAL as i32,
        0,
        select(pattern < most as i32, pattern as u32, most),
    );
    select(absolute > F32_INFINITY, QUIET_NAN, magnitude | (sign >> 8))
}

/// One of two values that have both been computed.
#[inline(always)]
fn select<T>(condition: bool, when_true: T, when_false: T) -> T {
    if condition { when_true } else { when_false }
}
