//! What is done to a ray once before it is walked by bounds: mirrored, and divided, digit by digit.
//!
//! On each axis two quotients by the slope are wanted: the depth from one border of texels to the
//! next, and that of the first border ahead. Both are made one binary digit a turn, the highest
//! first, by the restoring recurrence
//!
//! `shifted = 2 * remainder; digit = shifted >= slope; remainder = shifted - digit * slope`,
//!
//! that starts with a texel, and with the way to the border. The bound of the near border of the block that the walk
//! starts in lies some texels back: it comes along, `near = 2 * near + first's digit - texels * delta's digit`, so
//! that it is exactly the one quotient less so many of the other, with no product. Hardware has
//! [`setup_digit`] as often as it makes digits a cycle.

use super::bounded_shape::{BoundedShape, LINE_BITS, MOST_BOUNDED_LINES};
use super::fixed_setup::{FixedRayRegisters, fixed_mirror, shift_right_by};
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

/// An axis between two digits.
#[derive(Debug)]
pub struct Division<A: Arith> {
    /// What is left of a texel, in units of the slope's last place.
    pub delta_remainder: A::Int,
    /// What is left of the way to the first border.
    pub first_remainder: A::Int,
    /// The quotient of a texel by the slope saturates.
    pub delta_saturates: A::Bit,
    /// That of the way does.
    pub first_saturates: A::Bit,
    /// Texels from the near border of the block to the first border ahead: 1 to its side.
    pub texels_back: A::Int,
    /// The digits of the depth between two borders.
    pub t_delta: A::Int,
    /// The bound of the near border, as far as the digits go.
    pub t_near: A::Int,
}

impl<A: Arith> Clone for Division<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for Division<A> {}

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
    /// The division on u before its first digit.
    pub u: Division<A>,
    /// The same on v.
    pub v: Division<A>,
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

/// The first half of a setup: all that is done before the digits.
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

/// One digit of an axis.
pub fn setup_digit<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    slope: A::Int,
    division: &Division<A>,
) -> Division<A> {
    let delta = (division.delta_remainder, division.delta_saturates);
    let (delta_digit, delta_remainder) = digit(a, shape, slope, delta);
    let first = (division.first_remainder, division.first_saturates);
    let (first_digit, first_remainder) = digit(a, shape, slope, first);
    let one = a.int_constant(1);
    let zero = a.int_constant(0);
    let first_digit = a.int_from_bit(first_digit);
    let doubled = a.int_shift_left(division.t_near, one, 1);
    // The last bit of what is doubled is free.
    let near = a.int_or(doubled, first_digit);
    let back = a.int_select(delta_digit, division.texels_back, zero);
    let near = a.int_sub(near, back);
    let t_near = a.int_wrap(near, shape.bound_bits());
    let delta_digit = a.int_from_bit(delta_digit);
    let doubled = a.int_shift_left(division.t_delta, one, 1);
    let t_delta = a.int_or(doubled, delta_digit);
    // As many digits as it has bits.
    let t_delta = a.int_low_bits(t_delta, shape.delta_bits());
    Division {
        delta_remainder,
        first_remainder,
        t_delta,
        t_near,
        ..*division
    }
}

/// After the last digit: the upper bound of a near border, from the lower one.
pub fn setup_end<A: Arith>(a: &mut A, shape: BoundedShape, t_near: A::Int) -> A::Int {
    let margin = shape.fraction_bits() - shape.order_fraction_bits();
    let margin = a.int_constant(1 << margin);
    let upper = a.int_add(t_near, margin);
    a.int_wrap(upper, shape.bound_bits())
}

/// The whole setup of a quantised ray: see [`super::fixed_setup::fixed_setup`].
pub fn bounded_setup<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    ray: [A::Int; 4],
) -> BoundedSetUpRay<A> {
    let entry = setup_entry(a, shape, ray);
    let (mut u, mut v) = (entry.u, entry.v);
    for _ in 0..shape.setup_digits() {
        u = setup_digit(a, shape, entry.fixed.slope_u, &u);
        v = setup_digit(a, shape, entry.fixed.slope_v, &v);
    }
    a.name_int("t_delta_u", u.t_delta);
    a.name_int("t_delta_v", v.t_delta);
    let t_near_u = setup_end(a, shape, u.t_near);
    a.name_int("start_t_near_u", t_near_u);
    let t_near_v = setup_end(a, shape, v.t_near);
    a.name_int("start_t_near_v", t_near_v);
    BoundedSetUpRay {
        ray: BoundedRay {
            fixed: entry.fixed,
            t_delta_u: u.t_delta,
            t_delta_v: v.t_delta,
            start_line: entry.start_line,
        },
        i: entry.i,
        j: entry.j,
        t_near_u,
        t_near_v,
    }
}

/// A digit and what it leaves.
fn digit<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    slope: A::Int,
    (remainder, saturates): (A::Int, A::Bit),
) -> (A::Bit, A::Int) {
    let one = a.int_constant(1);
    let zero = a.int_constant(0);
    let shifted = a.int_shift_left(remainder, one, 1);
    let difference = a.int_sub(shifted, slope);
    let is_below = a.int_less_than(difference, zero);
    let reaches = a.not(is_below);
    let digit = a.or(reaches, saturates);
    let rest = a.int_select(reaches, difference, shifted);
    // Below the slope, but where it saturates: then nothing reads it.
    (digit, a.int_low_bits(rest, shape.words.slope_bits))
}

struct DivisionNames {
    entry_texel: &'static str,
    block: &'static str,
    way: &'static str,
    texels_back: &'static str,
    saturates: [&'static str; 2],
}

const DIVISION_U: DivisionNames = DivisionNames {
    entry_texel: "entry_i",
    block: "start_i",
    way: "first_way_u",
    texels_back: "texels_back_u",
    saturates: ["t_delta_u_saturates", "t_first_u_saturates"],
};
const DIVISION_V: DivisionNames = DivisionNames {
    entry_texel: "entry_j",
    block: "start_j",
    way: "first_way_v",
    texels_back: "texels_back_v",
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
) -> (A::Int, Division<A>) {
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
    let one = a.int_constant(1);
    let texels_back = a.int_add(before_block, one);
    a.name_int(names.texels_back, texels_back);

    // A height step's slope in as many texels as the map is high is the slope in units of an entry.
    let texel = a.int_constant(1 << words.entry_fraction_bits);
    let beyond = a.int_low_bits(entry, words.entry_fraction_bits);
    let way = a.int_sub(texel, beyond);
    a.name_int(names.way, way);
    // A texel or less: by the bits, there is nothing to subtract.
    let texels = shift_right_by(a, slope, words.entry_fraction_bits);
    let fraction = a.int_low_bits(slope, words.entry_fraction_bits);
    let none = a.int_constant(0);
    let is_less = a.int_equal(texels, none);
    let is_one = a.int_equal(texels, one);
    let is_whole = a.int_equal(fraction, none);
    let is_a_texel = a.and(is_one, is_whole);
    let delta_saturates = a.or(is_less, is_a_texel);
    a.name_bit(names.saturates[0], delta_saturates);
    let reaches = a.int_less_than(way, slope);
    let first_saturates = a.not(reaches);
    a.name_bit(names.saturates[1], first_saturates);
    let division = Division {
        delta_remainder: texel,
        first_remainder: way,
        delta_saturates,
        first_saturates,
        texels_back,
        t_delta: none,
        t_near: none,
    };
    (block, division)
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
