//! What is done to a ray once before it is walked by bounds: mirrored, and divided, digit by digit.
//!
//! On each axis the depth from one border of texels to the next is wanted, a quotient by the slope. It is made
//! one binary digit a turn, the highest first, by the restoring recurrence
//!
//! `shifted = 2 * remainder; digit = shifted >= slope; remainder = shifted - digit * slope`,
//!
//! that starts with a texel. The near border of the block that the walk starts in lies `behind` texels
//! back, which is a product by that quotient: `sum = (sum + digit * t_delta) / 2`, the lowest digit of the way first.
//!
//! Where the slope is a texel or less, the quotient would be the whole height of the map: it saturates. Then
//! the ray crosses one border at most, and the way to that is divided instead. Hardware has
//! [`setup_digit`] and [`near_digit`] as often as it makes digits a cycle.

use super::bounded_shape::{BoundedShape, LINE_BITS, MOST_BOUNDED_LINES};
use super::fixed_setup::{FixedRayRegisters, fixed_mirror, shift_left_by, shift_right_by};
use crate::arith::Arith;

/// The registers a ray carries unchanged from step to step.
#[derive(Debug)]
pub struct BoundedRay<A: Arith> {
    /// The quantised ray, mirrored. Entry and slopes are read by the leaf check alone.
    pub fixed: FixedRayRegisters<A>,
    /// A lower bound of the height steps between two borders of texels on u, times
    /// `2^fraction_bits`; saturates.
    pub t_delta_u: A::Int,
    /// The same on v.
    pub t_delta_v: A::Int,
    /// The line that the walk starts with, and crosses at.
    pub start_line: A::Int,
}

impl<A: Arith> Clone for BoundedRay<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for BoundedRay<A> {}

/// An axis between two digits of its quotient.
#[derive(Debug)]
pub struct Division<A: Arith> {
    /// What is left of a texel, in units of the slope's last place; where a texel saturates, of the way to
    /// the first border.
    pub remainder: A::Int,
    /// That saturates too.
    pub first_saturates: A::Bit,
    /// The digits of the depth.
    pub quotient: A::Int,
}

impl<A: Arith> Clone for Division<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for Division<A> {}

/// The bound of a block's near border between two digits of the way to it.
#[derive(Debug)]
pub struct NearProduct<A: Arith> {
    /// The digits of the way from the near border to the entry, the lowest the next; those that are done
    /// come back above, so that after the last it is as before.
    pub behind: A::Int,
    /// The product so far, less the margin that makes the bound late.
    pub sum: A::Int,
}

impl<A: Arith> Clone for NearProduct<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for NearProduct<A> {}

/// What an axis brings into its setup.
#[derive(Debug)]
pub struct AxisEntry<A: Arith> {
    /// The division before its first digit.
    pub division: Division<A>,
    /// The slope is a texel or less.
    pub saturates: A::Bit,
    /// From the near border of the first block to the entry, in units of an entry.
    pub behind: A::Int,
}

/// A ray before its division.
#[derive(Debug)]
pub struct BoundedEntry<A: Arith> {
    /// The mirrored ray.
    pub fixed: FixedRayRegisters<A>,
    /// The line that the walk starts with.
    pub start_line: A::Int,
    /// The near corner of its block, in texels.
    pub i: A::Int,
    /// On the other axis.
    pub j: A::Int,
    /// The axis u.
    pub u: AxisEntry<A>,
    /// The axis v.
    pub v: AxisEntry<A>,
}

/// A ray set up.
#[derive(Debug)]
pub struct BoundedSetUpRay<A: Arith> {
    /// What stays.
    pub ray: BoundedRay<A>,
    /// The near corner of the first block, in texels.
    pub i: A::Int,
    /// On the other axis.
    pub j: A::Int,
    /// The upper bound of the depth of its near border on u.
    pub t_near_u: A::Int,
    /// The same on v.
    pub t_near_v: A::Int,
}

/// The first part of a setup: all that is done before the digits.
pub fn setup_entry<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    [u, v, du, dv]: [A::Int; 4],
) -> BoundedEntry<A> {
    let words = shape.words;
    let fixed = fixed_mirror(a, words, u, v, du, dv);
    let start_line = start_line(a, shape, &fixed);
    let (i, u) = division(a, shape, &DIVISION_U, start_line, fixed.u, fixed.slope_u);
    let (j, v) = division(a, shape, &DIVISION_V, start_line, fixed.v, fixed.slope_v);
    BoundedEntry {
        fixed,
        start_line,
        i,
        j,
        u,
        v,
    }
}

/// One digit of an axis's quotient.
pub fn setup_digit<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    slope: A::Int,
    division: &Division<A>,
) -> Division<A> {
    let one = a.int_constant(1);
    let zero = a.int_constant(0);
    let shifted = a.int_shift_left(division.remainder, one, 1);
    let difference = a.int_sub(shifted, slope);
    let is_below = a.int_less_than(difference, zero);
    let reaches = a.not(is_below);
    let digit = a.or(reaches, division.first_saturates);
    let rest = a.int_select(reaches, difference, shifted);
    let digit = a.int_from_bit(digit);
    let doubled = a.int_shift_left(division.quotient, one, 1);
    let quotient = a.int_or(doubled, digit);
    Division {
        // Below the slope, but where it saturates: then nothing reads it.
        remainder: a.int_low_bits(rest, shape.words.slope_bits),
        first_saturates: division.first_saturates,
        // As many digits as it has bits.
        quotient: a.int_low_bits(quotient, shape.delta_bits()),
    }
}

/// The product before its first digit, to be made in so many: of those that are more than the way has bits, the
/// lowest are zero.
pub fn near_start<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    digits: u32,
    behind: A::Int,
) -> NearProduct<A> {
    let more = digits - shape.behind_bits();
    NearProduct {
        behind: shift_left_by(a, behind, shape.behind_bits() + 1, more),
        sum: a.int_constant(near_sum_start(shape, digits)),
    }
}

/// What the sum starts with: the margin, less than nothing, where it does not fall off below.
pub const fn near_sum_start(shape: BoundedShape, digits: u32) -> i64 {
    -((shape.near_margin() as i64) << digits)
}

/// Bits of the sum, signed: the margin at first, then the quotient times twice the texels of a block.
pub const fn near_sum_bits(shape: BoundedShape, digits: u32) -> u32 {
    let margin = shape.fraction_bits() - shape.order_fraction_bits() + digits;
    let product = shape.largest_block_level() + shape.delta_bits() + 1;
    1 + if margin > product { margin } else { product }
}

/// One digit of the way to a near border, of so many.
pub fn near_digit<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    digits: u32,
    quotient: A::Int,
    product: &NearProduct<A>,
) -> NearProduct<A> {
    let one = a.int_constant(1);
    let zero = a.int_constant(0);
    let level = shape.largest_block_level();
    let digit = a.int_low_bits(product.behind, 1);
    let is_zero = a.int_equal(digit, zero);
    let addend = a.int_select(is_zero, zero, quotient);
    // Nothing is added to the lowest bits, which belong to the texels of a block.
    let low = a.int_low_bits(product.sum, level);
    let high = shift_right_by(a, product.sum, level);
    let high = a.int_add(high, addend);
    let sum_bits = near_sum_bits(shape, digits);
    let high = a.int_wrap(high, sum_bits + 1 - level);
    let high = shift_left_by(a, high, sum_bits + 1 - level, level);
    let sum = a.int_or(high, low);
    let sum = shift_right_by(a, sum, 1);
    let back = shift_left_by(a, digit, 2, digits - 1);
    let behind = a.int_shift_right(product.behind, one, 1);
    let behind = a.int_or(behind, back);
    NearProduct {
        behind: a.int_low_bits(behind, digits),
        sum: a.int_wrap(sum, sum_bits),
    }
}

/// After the last digit: the depth between two borders, and the upper bound of the near one.
///
/// Where it saturates, of the bounds only the one of the first border is near the ray. It is taken a
/// unit of the order fraction up, less the last place: by all that bounds are compared in, no later.
pub fn setup_end<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    digits: u32,
    saturates: A::Bit,
    quotient: A::Int,
    product: &NearProduct<A>,
) -> (A::Int, A::Int) {
    let delta_bits = shape.delta_bits();
    let most = a.int_constant((1 << delta_bits) - 1);
    let t_delta = a.int_select(saturates, most, quotient);
    let yes = a.bit_constant(true);
    let texel = digits - shape.largest_block_level();
    let texels = shift_right_by(a, product.behind, texel);
    let texels_back = a.int_complement_if(yes, texels);
    let back = shift_left_by(a, texels_back, shape.largest_block_level() + 1, delta_bits);
    let below = shape.fraction_bits() - shape.order_fraction_bits();
    let unit = a.int_constant((1 << below) - 1);
    let first = a.int_or(quotient, unit);
    let of_first = a.int_or(back, first);
    let negative = a.int_complement_if(yes, product.sum);
    let near = a.int_select(saturates, of_first, negative);
    (t_delta, a.int_wrap(near, shape.bound_bits()))
}

/// The whole setup of a quantised ray: see [`super::fixed_setup::fixed_setup`].
pub fn bounded_setup<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    ray: [A::Int; 4],
) -> BoundedSetUpRay<A> {
    let entry = setup_entry(a, shape, ray);
    let slopes = (entry.fixed.slope_u, entry.fixed.slope_v);
    let digits = shape.behind_bits();
    let [u, v] = [(&entry.u, slopes.0), (&entry.v, slopes.1)].map(|(axis, slope)| {
        let mut division = axis.division;
        for _ in 0..shape.setup_digits() {
            division = setup_digit(a, shape, slope, &division);
        }
        let mut product = near_start(a, shape, digits, axis.behind);
        for _ in 0..digits {
            product = near_digit(a, shape, digits, division.quotient, &product);
        }
        let quotient = division.quotient;
        setup_end(a, shape, digits, axis.saturates, quotient, &product)
    });
    let ((t_delta_u, t_near_u), (t_delta_v, t_near_v)) = (u, v);
    a.name_int("t_delta_u", t_delta_u);
    a.name_int("t_delta_v", t_delta_v);
    a.name_int("start_t_near_u", t_near_u);
    a.name_int("start_t_near_v", t_near_v);
    BoundedSetUpRay {
        ray: BoundedRay {
            fixed: entry.fixed,
            t_delta_u,
            t_delta_v,
            start_line: entry.start_line,
        },
        i: entry.i,
        j: entry.j,
        t_near_u,
        t_near_v,
    }
}

struct DivisionNames {
    entry_texel: &'static str,
    block: &'static str,
    way: &'static str,
    behind: &'static str,
    saturates: [&'static str; 2],
}

const DIVISION_U: DivisionNames = DivisionNames {
    entry_texel: "entry_i",
    block: "start_i",
    way: "first_way_u",
    behind: "behind_u",
    saturates: ["t_delta_u_saturates", "t_first_u_saturates"],
};
const DIVISION_V: DivisionNames = DivisionNames {
    entry_texel: "entry_j",
    block: "start_j",
    way: "first_way_v",
    behind: "behind_v",
    saturates: ["t_delta_v_saturates", "t_first_v_saturates"],
};

/// The near border of the first block, and the division before its first digit.
fn division<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    names: &DivisionNames,
    start_line: A::Int,
    entry: A::Int,
    slope: A::Int,
) -> (A::Int, AxisEntry<A>) {
    let words = shape.words;
    let texel = shift_right_by(a, entry, words.entry_fraction_bits);
    // The entry is within a map of the origin.
    let texel = a.int_wrap(texel, words.root_level + 1);
    a.name_int(names.entry_texel, texel);
    let in_block = by_line(a, shape, start_line, |a, n| {
        a.int_constant((1 << shape.block_level(n)) - 1)
    });
    let before_block = a.int_and(texel, in_block);
    let before_block = a.int_low_bits(before_block, shape.largest_block_level());
    let block = a.int_sub(texel, before_block);
    let block = a.int_wrap(block, shape.index_bits());
    a.name_int(names.block, block);
    let beyond = a.int_low_bits(entry, words.entry_fraction_bits);
    let level = shape.largest_block_level();
    let behind = shift_left_by(a, before_block, level + 1, words.entry_fraction_bits);
    let behind = a.int_or(behind, beyond);
    a.name_int(names.behind, behind);

    // A height step's slope in as many texels as the map is high is the slope in units of an entry.
    let texel = a.int_constant(1 << words.entry_fraction_bits);
    let way = a.int_sub(texel, beyond);
    a.name_int(names.way, way);
    // A texel or less: by the bits, there is nothing to subtract.
    let texels = shift_right_by(a, slope, words.entry_fraction_bits);
    let fraction = a.int_low_bits(slope, words.entry_fraction_bits);
    let none = a.int_constant(0);
    let one = a.int_constant(1);
    let is_less = a.int_equal(texels, none);
    let is_one = a.int_equal(texels, one);
    let is_whole = a.int_equal(fraction, none);
    let is_a_texel = a.and(is_one, is_whole);
    let delta_saturates = a.or(is_less, is_a_texel);
    a.name_bit(names.saturates[0], delta_saturates);
    // Asked of a slope of a texel at most.
    let low_slope = a.int_low_bits(slope, words.entry_fraction_bits + 1);
    let is_beyond = a.int_less_than(way, low_slope);
    let is_far = a.not(is_beyond);
    let first_saturates = a.and(is_far, delta_saturates);
    a.name_bit(names.saturates[1], first_saturates);
    let division = Division {
        remainder: a.int_select(delta_saturates, way, texel),
        first_saturates,
        quotient: none,
    };
    let axis = AxisEntry {
        division,
        saturates: delta_saturates,
        behind,
    };
    (block, axis)
}

/// The line that a walk starts with, by the ray's reach: see
/// [`super::wide_shape::WideShape::start_reach_log2`].
fn start_line<A: Arith>(a: &mut A, shape: BoundedShape, ray: &FixedRayRegisters<A>) -> A::Int {
    let words = shape.words;
    // The longer one has a bit there if either has.
    let slopes = a.int_or(ray.slope_u, ray.slope_v);
    let mut line = a.int_constant(0);
    for n in 1..shape.line_levels() {
        let reach_log2 = shape.lines().start_reach_log2(shape.lines().line_level(n));
        // As if the map were a height step higher: the slope then is the reach, in units of an
        // entry.
        let bits = reach_log2 + words.entry_fraction_bits;
        if bits >= words.slope_bits {
            break;
        }
        let beyond = shift_right_by(a, slopes, bits);
        let zero = a.int_constant(0);
        let stays = a.int_equal(beyond, zero);
        let reaches = a.not(stays);
        let higher = a.int_constant(n as i64);
        line = a.int_select(reaches, higher, line);
    }
    let line = a.int_wrap(line, LINE_BITS);
    a.name_int("start_line", line);
    line
}

/// What belongs to a line, for the line of this number: a tree of selectors, each by a bit of it.
pub(crate) fn by_line<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    line: A::Int,
    mut of: impl FnMut(&mut A, usize) -> A::Int,
) -> A::Int {
    let count = shape.line_levels();
    let mut words = [line; MOST_BOUNDED_LINES];
    for (n, word) in words[..count].iter_mut().enumerate() {
        *word = of(a, n);
    }
    let zero = a.int_constant(0);
    let (mut left, mut bit) = (count, 1);
    while left > 1 {
        let mask = a.int_constant(bit);
        let digit = a.int_and(line, mask);
        let is_even = a.int_equal(digit, zero);
        for n in 0..left.div_ceil(2) {
            words[n] = match 2 * n + 1 < left {
                true => a.int_select(is_even, words[2 * n], words[2 * n + 1]),
                false => words[2 * n],
            };
        }
        (left, bit) = (left.div_ceil(2), 2 * bit);
    }
    words[0]
}
