//! Keeps what every operation gave: the golden side of a pipeline's registers.

use crate::arith::{Arith, Concrete};
use crate::float::Rounding;

/// A reading whose values are words of bits, so that they can be compared with hardware.
pub trait Word: Concrete {
    /// The bits of a number.
    fn word(&self, value: Self::Num) -> u64;
    /// The number of these bits.
    fn number(&self, word: u64) -> Self::Num;
}

impl<H: super::HasFormat> Word for super::FloatReading<H> {
    #[inline(always)]
    fn word(&self, value: u64) -> u64 {
        value
    }
    #[inline(always)]
    fn number(&self, word: u64) -> u64 {
        word
    }
}

/// Evaluates as the reading inside does, and appends the result of every operation to `words`.
///
/// A datapath is straight-line code, so the k-th word is the result of the k-th operation of the
/// netlist that was recorded from the same function. Integers are kept in two's complement; the
/// netlist knows their widths.
#[derive(Clone, Debug, Default)]
pub struct Traced<R> {
    /// The reading that computes.
    pub reading: R,
    /// The results so far, in the order of the operations.
    pub words: Vec<u64>,
}

impl<R: Word> Word for Traced<R> {
    #[inline(always)]
    fn word(&self, value: R::Num) -> u64 {
        self.reading.word(value)
    }
    #[inline(always)]
    fn number(&self, word: u64) -> R::Num {
        self.reading.number(word)
    }
}

impl<R: Word> Traced<R> {
    #[inline(always)]
    fn num(&mut self, value: R::Num) -> R::Num {
        self.words.push(self.reading.word(value));
        value
    }
    #[inline(always)]
    fn int(&mut self, value: i64) -> i64 {
        self.words.push(value as u64);
        value
    }
    #[inline(always)]
    fn bit(&mut self, value: bool) -> bool {
        self.words.push(u64::from(value));
        value
    }
}

/// Forwards operators to the reading inside and keeps their results.
macro_rules! keep {
    ($kind:ident: $($name:ident($($argument:ident: $type:ty),*) -> $result:ty;)*) => {
        $(#[inline(always)]
        fn $name(&mut self, $($argument: $type),*) -> $result {
            let value = self.reading.$name($($argument),*);
            self.$kind(value)
        })*
    };
}

impl<R: Word> Arith for Traced<R> {
    type Num = R::Num;
    type Int = i64;
    type Bit = bool;

    keep! { num:
        zero() -> R::Num;
        add(rounding: Rounding, a: R::Num, b: R::Num) -> R::Num;
        sub(rounding: Rounding, a: R::Num, b: R::Num) -> R::Num;
        mul(rounding: Rounding, a: R::Num, b: R::Num) -> R::Num;
        div(rounding: Rounding, a: R::Num, b: R::Num) -> R::Num;
        ulps_up(a: R::Num, ulps: u32) -> R::Num;
        exact_below(a: R::Num) -> R::Num;
        negate_if(condition: bool, a: R::Num) -> R::Num;
        magnitude(a: R::Num) -> R::Num;
        select(condition: bool, when_one: R::Num, when_zero: R::Num) -> R::Num;
        number_from_integer(rounding: Rounding, value: i64, exponent: i64) -> R::Num;
        scale(a: R::Num, exponent: i32) -> R::Num;
        depth_from_height(height: i64, bits: u32) -> R::Num;
    }
    keep! { int:
        floor(a: R::Num, bits: u32) -> i64;
        int_constant(value: i64) -> i64;
        int_add(a: i64, b: i64) -> i64;
        int_sub(a: i64, b: i64) -> i64;
        int_shift_left(a: i64, amount: i64, amount_bits: u32) -> i64;
        int_shift_right(a: i64, amount: i64, amount_bits: u32) -> i64;
        int_mul(a: i64, b: i64) -> i64;
        int_bit_length(a: i64) -> i64;
        int_xor(a: i64, b: i64) -> i64;
        int_wrap(a: i64, bits: u32) -> i64;
        int_low_bits(a: i64, bits: u32) -> i64;
        int_and(a: i64, b: i64) -> i64;
        int_or(a: i64, b: i64) -> i64;
        int_complement_if(condition: bool, a: i64) -> i64;
        int_select(condition: bool, when_one: i64, when_zero: i64) -> i64;
        int_from_bit(condition: bool) -> i64;
    }
    keep! { bit:
        is_negative(a: R::Num) -> bool;
        is_zero(a: R::Num) -> bool;
        less_than(a: R::Num, b: R::Num) -> bool;
        less_equal(a: R::Num, b: R::Num) -> bool;
        int_equal(a: i64, b: i64) -> bool;
        int_less_than(a: i64, b: i64) -> bool;
        bit_constant(value: bool) -> bool;
        and(a: bool, b: bool) -> bool;
        or(a: bool, b: bool) -> bool;
        not(a: bool) -> bool;
    }
}
