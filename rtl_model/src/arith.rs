//! The operators a unit's hardware has, as a trait.
//!
//! A datapath is written once, as plain Rust over [`Arith`], and read in several ways: in the float
//! whose bits the hardware computes, in `f64`, in exact rationals, or as wires of a netlist that
//! becomes Verilog. A datapath is straight-line code: every decision is a [`Arith::Bit`] that
//! selects between values, never a Rust `if`, since a wire has no value to branch on. The k-th
//! operation of one reading is therefore the k-th of every other, and this is what lets the
//! golden model say what each pipeline register must hold.

use crate::float::Rounding;
use std::fmt::Debug;

/// The operators of a datapath. The three associated types are the three kinds of signal.
///
/// Every arithmetic operator names its rounding: which way an error may fall is part of a
/// datapath's design (a traversal must never step past the surface), so it is written where the
/// operation is. Readings without rounding (exact) or with one only (`f64`) ignore it.
pub trait Arith {
    /// A number in the reading's format.
    type Num: Copy + Debug;
    /// A signed integer: a node index, a level, a count.
    type Int: Copy + Debug;
    /// One bit: the result of a comparison.
    type Bit: Copy + Debug;

    /// The number zero.
    fn zero(&mut self) -> Self::Num;
    /// `a + b`.
    fn add(&mut self, rounding: Rounding, a: Self::Num, b: Self::Num) -> Self::Num;
    /// `a - b`.
    fn sub(&mut self, rounding: Rounding, a: Self::Num, b: Self::Num) -> Self::Num;
    /// `a * b`.
    fn mul(&mut self, rounding: Rounding, a: Self::Num, b: Self::Num) -> Self::Num;
    /// `a / b`. A division of a nonzero number by zero is infinite.
    fn div(&mut self, rounding: Rounding, a: Self::Num, b: Self::Num) -> Self::Num;
    /// A number at least `ulps` units in the last place above `a`, which must not be negative;
    /// infinity where there is none. A result below the smallest normal number is flushed, so zero
    /// stays zero. Readings that do not round answer `a` itself: the operator turns a lower bound
    /// into an upper one, and there the two are the same.
    fn ulps_up(&mut self, a: Self::Num, ulps: u32) -> Self::Num;
    /// The power of two below which every multiple of `a`'s last nonzero fraction bit is
    /// representable; infinity for zero, and in readings that do not round. A difference of `a`
    /// and a number of no finer grain is exact if its result is below this.
    fn exact_below(&mut self, a: Self::Num) -> Self::Num;
    /// `-a` where `condition` holds, else `a`. Exact.
    fn negate_if(&mut self, condition: Self::Bit, a: Self::Num) -> Self::Num;
    /// `|a|`. Exact.
    fn magnitude(&mut self, a: Self::Num) -> Self::Num;
    /// Is `a` below zero? Minus zero is not.
    fn is_negative(&mut self, a: Self::Num) -> Self::Bit;
    /// Is `a` zero, of either sign?
    fn is_zero(&mut self, a: Self::Num) -> Self::Bit;
    /// `a < b`; false where either is NaN.
    fn less_than(&mut self, a: Self::Num, b: Self::Num) -> Self::Bit;
    /// `a <= b`; false where either is NaN.
    fn less_equal(&mut self, a: Self::Num, b: Self::Num) -> Self::Bit;
    /// `when_one` where `condition` holds, else `when_zero`.
    fn select(
        &mut self,
        condition: Self::Bit,
        when_one: Self::Num,
        when_zero: Self::Num,
    ) -> Self::Num;
    /// `value * 2^exponent`.
    fn number_from_integer(
        &mut self,
        rounding: Rounding,
        value: Self::Int,
        exponent: Self::Int,
    ) -> Self::Num;
    /// `a * 2^exponent`. Exact, but for a result beyond the format's exponents: infinity, or zero.
    fn scale(&mut self, a: Self::Num, exponent: i32) -> Self::Num;
    /// The largest integer not above `a`, as a two's complement integer of `bits` bits; the nearer
    /// end of their range where it lies beyond; 0 for NaN.
    fn floor(&mut self, a: Self::Num, bits: u32) -> Self::Int;
    /// The depth `1 - height / (2^bits - 1)` of an unsigned normalised height, rounded toward zero
    /// depth, that is toward the ray (DESIGN: conservative).
    fn depth_from_height(&mut self, height: Self::Int, bits: u32) -> Self::Num;

    /// An integer constant.
    fn int_constant(&mut self, value: i64) -> Self::Int;
    /// `a + b`, exact: the result is as wide as it must be.
    fn int_add(&mut self, a: Self::Int, b: Self::Int) -> Self::Int;
    /// `a - b`, exact.
    fn int_sub(&mut self, a: Self::Int, b: Self::Int) -> Self::Int;
    /// `a * 2^amount`, exact; `amount` is at least 0 and below `2^amount_bits`.
    fn int_shift_left(&mut self, a: Self::Int, amount: Self::Int, amount_bits: u32) -> Self::Int;
    /// `a / 2^amount`, rounded down; `amount` is at least 0 and below `2^amount_bits`.
    fn int_shift_right(&mut self, a: Self::Int, amount: Self::Int, amount_bits: u32) -> Self::Int;
    /// `a * b`, exact.
    fn int_mul(&mut self, a: Self::Int, b: Self::Int) -> Self::Int;
    /// Bits of `a` without leading zeros: 0 for 0, 3 for 4 to 7. `a` is not negative.
    fn int_bit_length(&mut self, a: Self::Int) -> Self::Int;
    /// The low `bits` bits of `a`, read as a signed integer: the one operation that may lose bits,
    /// and named for it. A datapath that relies on `a` fitting says why.
    fn int_wrap(&mut self, a: Self::Int, bits: u32) -> Self::Int;
    /// The low `bits` bits of `a`, read as an unsigned integer.
    fn int_low_bits(&mut self, a: Self::Int, bits: u32) -> Self::Int;
    /// Bitwise and of two's complement integers.
    fn int_and(&mut self, a: Self::Int, b: Self::Int) -> Self::Int;
    /// Bitwise or of two's complement integers.
    fn int_or(&mut self, a: Self::Int, b: Self::Int) -> Self::Int;
    /// Bitwise exclusive or of two's complement integers.
    fn int_xor(&mut self, a: Self::Int, b: Self::Int) -> Self::Int;
    /// `-1 - a` (all bits inverted) where `condition` holds, else `a`.
    fn int_complement_if(&mut self, condition: Self::Bit, a: Self::Int) -> Self::Int;
    /// `a == b`.
    fn int_equal(&mut self, a: Self::Int, b: Self::Int) -> Self::Bit;
    /// `a < b`.
    fn int_less_than(&mut self, a: Self::Int, b: Self::Int) -> Self::Bit;
    /// `when_one` where `condition` holds, else `when_zero`.
    fn int_select(
        &mut self,
        condition: Self::Bit,
        when_one: Self::Int,
        when_zero: Self::Int,
    ) -> Self::Int;
    /// 1 where `condition` holds, else 0.
    fn int_from_bit(&mut self, condition: Self::Bit) -> Self::Int;

    /// A constant bit.
    fn bit_constant(&mut self, value: bool) -> Self::Bit;
    /// Both.
    fn and(&mut self, a: Self::Bit, b: Self::Bit) -> Self::Bit;
    /// Either.
    fn or(&mut self, a: Self::Bit, b: Self::Bit) -> Self::Bit;
    /// The other.
    fn not(&mut self, a: Self::Bit) -> Self::Bit;

    /// The smaller of two numbers, `a` where they are equal: a comparator and a selector.
    fn min(&mut self, a: Self::Num, b: Self::Num) -> Self::Num {
        let b_is_smaller = self.less_than(b, a);
        self.select(b_is_smaller, b, a)
    }
    /// The larger of two numbers, `a` where they are equal: a comparator and a selector.
    fn max(&mut self, a: Self::Num, b: Self::Num) -> Self::Num {
        let b_is_larger = self.less_than(a, b);
        self.select(b_is_larger, b, a)
    }

    /// Gives the latest operation's result its name in Verilog, waveforms and reports.
    /// Readings that only compute ignore it.
    fn name_num(&mut self, _name: &'static str, _value: Self::Num) {}
    /// As [`Arith::name_num`], for an integer.
    fn name_int(&mut self, _name: &'static str, _value: Self::Int) {}
    /// As [`Arith::name_num`], for a bit.
    fn name_bit(&mut self, _name: &'static str, _value: Self::Bit) {}
}

/// A reading whose integers and bits are plain values, so that a program can act on them.
pub trait Concrete: Arith<Int = i64, Bit = bool> {}

impl<A: Arith<Int = i64, Bit = bool>> Concrete for A {}
