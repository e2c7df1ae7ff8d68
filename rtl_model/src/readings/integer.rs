//! The integer and bit operators, which mean the same in every reading with plain values.

/// Implements the integer and bit operators of [`crate::arith::Arith`] with `i64` and `bool`.
///
/// Integers of a datapath are at most 64 bits wide (the recorder of netlists sees to it), so `i64`
/// holds every exact result; overflow checks of test builds would show the contrary.
macro_rules! plain_integers_and_bits {
    () => {
        type Int = i64;
        type Bit = bool;

        #[inline(always)]
        fn int_constant(&mut self, value: i64) -> i64 {
            value
        }
        #[inline(always)]
        fn int_add(&mut self, a: i64, b: i64) -> i64 {
            a + b
        }
        #[inline(always)]
        fn int_sub(&mut self, a: i64, b: i64) -> i64 {
            a - b
        }
        #[inline(always)]
        fn int_shift_left(&mut self, a: i64, amount: i64, amount_bits: u32) -> i64 {
            debug_assert!((0..1 << amount_bits).contains(&amount));
            a << (amount & ((1 << amount_bits) - 1))
        }
        #[inline(always)]
        fn int_shift_right(&mut self, a: i64, amount: i64, amount_bits: u32) -> i64 {
            debug_assert!((0..1 << amount_bits).contains(&amount));
            a >> (amount & ((1 << amount_bits) - 1)).min(63)
        }
        #[inline(always)]
        fn int_mul(&mut self, a: i64, b: i64) -> i64 {
            a * b
        }
        #[inline(always)]
        fn int_bit_length(&mut self, a: i64) -> i64 {
            debug_assert!(a >= 0);
            i64::from(64 - a.leading_zeros())
        }
        #[inline(always)]
        fn int_xor(&mut self, a: i64, b: i64) -> i64 {
            a ^ b
        }
        #[inline(always)]
        fn int_wrap(&mut self, a: i64, bits: u32) -> i64 {
            (a << (64 - bits)) >> (64 - bits)
        }
        #[inline(always)]
        fn int_low_bits(&mut self, a: i64, bits: u32) -> i64 {
            a & ((1 << bits) - 1)
        }
        #[inline(always)]
        fn int_and(&mut self, a: i64, b: i64) -> i64 {
            a & b
        }
        #[inline(always)]
        fn int_or(&mut self, a: i64, b: i64) -> i64 {
            a | b
        }
        #[inline(always)]
        fn int_complement_if(&mut self, condition: bool, a: i64) -> i64 {
            a ^ -i64::from(condition)
        }
        #[inline(always)]
        fn int_equal(&mut self, a: i64, b: i64) -> bool {
            a == b
        }
        #[inline(always)]
        fn int_less_than(&mut self, a: i64, b: i64) -> bool {
            a < b
        }
        #[inline(always)]
        fn int_select(&mut self, condition: bool, when_one: i64, when_zero: i64) -> i64 {
            if condition { when_one } else { when_zero }
        }
        #[inline(always)]
        fn int_from_bit(&mut self, condition: bool) -> i64 {
            i64::from(condition)
        }
        #[inline(always)]
        fn bit_constant(&mut self, value: bool) -> bool {
            value
        }
        #[inline(always)]
        fn and(&mut self, a: bool, b: bool) -> bool {
            a & b
        }
        #[inline(always)]
        fn or(&mut self, a: bool, b: bool) -> bool {
            a | b
        }
        #[inline(always)]
        fn not(&mut self, a: bool) -> bool {
            !a
        }
    };
}

pub(super) use plain_integers_and_bits;
