//! Numbers of e7f16 as the `f64` that have their values: the low 36 fraction bits are zero.

/// One unit in the last of the 17 significant bits, in the pattern of an `f64`.
pub(super) const ULP: u64 = 1 << 36;

/// The bits of an `f64` that a number of e7f16 uses.
const KEPT: u64 = !(ULP - 1);

/// The smallest normal number of e7f16, 2^-62.
pub(super) const MIN_NORMAL: f64 = f64::from_bits((1023 - 62) << 52);

/// `value` rounded to 17 significant bits toward zero. Nothing is flushed.
#[inline(always)]
pub(super) fn truncate(value: f64) -> f64 {
    f64::from_bits(value.to_bits() & KEPT)
}

/// `value` rounded to 17 significant bits, to nearest, ties to even. Nothing is flushed.
#[inline(always)]
pub(super) fn round_to_nearest(value: f64) -> f64 {
    let bits = value.to_bits();
    let odd = (bits >> 36) & 1;
    f64::from_bits(bits.wrapping_add(ULP / 2 - 1 + odd) & KEPT)
}

/// `value`, or zero where it is below the smallest normal number; not for negative ones.
#[inline(always)]
pub(super) fn flush(value: f64) -> f64 {
    if value < MIN_NORMAL { 0.0 } else { value }
}

/// `value` raised by units in the last place; `ulps` is counted in [`ULP`]s.
#[inline(always)]
pub(super) fn raise(value: f64, ulps: u64) -> f64 {
    f64::from_bits(value.to_bits().wrapping_add(ulps))
}

/// The larger: one instruction, unlike `f64::max`, which minds NaN. `b` where one is NaN.
#[inline(always)]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller; `b` where one is NaN.
#[inline(always)]
pub(crate) fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// One of two values that have both been computed.
#[inline(always)]
pub(crate) fn select<T>(condition: bool, when_true: T, when_false: T) -> T {
    if condition { when_true } else { when_false }
}
