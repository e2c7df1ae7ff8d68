//! Operands, half of them drawn to be hard: a case is a function of seed and index alone.

use rtl_model::float::{FloatFormat, Rounding};

use super::compare::Operation;

/// The operands of one test. Operators that do not round ignore the rounding.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    pub rounding: Rounding,
    pub a: u64,
    pub b: u64,
}

/// SplitMix64 (Steele, Lea, Flood 2014): any seed is as good as any other.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64, index: u64) -> Random {
        let mut random = Random(seed ^ index.wrapping_mul(0xd1b5_4a32_d192_ed03));
        random.next();
        random
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from 0 to `count - 1`; the bias of a few parts in 2^32 does not matter here.
    pub fn below(&mut self, count: u64) -> u64 {
        ((self.next() >> 32) * count) >> 32
    }

    /// A number from `low` to `high`, both included.
    pub fn within(&mut self, low: i64, high: i64) -> i64 {
        low + self.below((high - low + 1) as u64) as i64
    }
}

/// The case of this index.
pub fn case(operation: Operation, format: FloatFormat, seed: u64, index: u64) -> Case {
    let mut random = Random::new(seed, index);
    let rounding = Rounding::ALL[random.below(4) as usize];
    let (a, b) = match operation {
        Operation::FromInteger => integer_and_exponent(format, &mut random),
        Operation::ToInteger | Operation::Floor => (near_integers(format, &mut random), 0),
        _ => pair(format, &mut random),
    };
    Case { rounding, a, b }
}

fn pattern(format: FloatFormat, sign: u64, field: i64, fraction: u64) -> u64 {
    let field = field.clamp(0, (1 << format.exponent_bits) - 1) as u64;
    let fraction = fraction & ((1 << format.fraction_bits) - 1);
    (((sign & 1) << format.exponent_bits) | field) << format.fraction_bits | fraction
}

fn any(format: FloatFormat, random: &mut Random) -> u64 {
    random.next() >> (64 - format.width())
}

/// Zeros, ends of the subnormal and normal ranges, one and its neighbours, infinities, NaNs.
fn special(format: FloatFormat, random: &mut Random) -> u64 {
    let one_ulp = 1;
    let min_normal = 1 << format.fraction_bits;
    let infinity = ((1 << format.exponent_bits) - 1) << format.fraction_bits;
    let one = ((1 << (format.exponent_bits - 1)) - 1) << format.fraction_bits;
    let table = [
        0,
        one_ulp,
        min_normal - 1,
        min_normal,
        min_normal + 1,
        2 * min_normal - 1,
        2 * min_normal,
        one - 1,
        one,
        one + 1,
        infinity - min_normal,
        infinity - 1,
        infinity,
        infinity + 1,
        infinity + min_normal / 2,
        infinity + min_normal - 1,
    ];
    let sign = random.next() << 63 >> (64 - format.width());
    sign | table[random.below(table.len() as u64) as usize]
}

/// A fraction whose bits make carries, ties and long runs likely.
fn hard_fraction(format: FloatFormat, random: &mut Random) -> u64 {
    let bits = u64::from(format.fraction_bits);
    let mask = (1u64 << bits) - 1;
    let position = random.below(bits);
    match random.below(7) {
        0 => 0,
        1 => mask,
        2 => 1 << position,
        3 => mask ^ (1 << position),
        4 => mask << position & mask,
        5 => mask >> position,
        _ => random.next() << position & mask,
    }
}

fn pair(format: FloatFormat, random: &mut Random) -> (u64, u64) {
    let fraction_bits = i64::from(format.fraction_bits);
    let bias = (1i64 << (format.exponent_bits - 1)) - 1;
    let all_ones = 2 * bias + 1;
    let signs = random.next();
    match random.below(16) {
        0..=5 => (any(format, random), any(format, random)),
        6 => (special(format, random), special(format, random)),
        7 => {
            let (a, b) = (special(format, random), any(format, random));
            if signs & 1 == 0 { (a, b) } else { (b, a) }
        }
        // Nearly equal magnitudes: cancellation of all but a few bits, and close comparisons.
        8 => {
            let a = any(format, random);
            let magnitudes = (1u64 << (format.width() - 1)) - 1;
            let step = random.within(-3, 3);
            let near = (a & magnitudes).saturating_add_signed(step).min(magnitudes);
            (a, (signs & 1) << (format.width() - 1) | near)
        }
        // Exponents of neighbours, hard fractions: cancellation across a power of two.
        9 => {
            let field = random.within(0, all_ones - 1);
            let other = field + random.within(-2, 2);
            hard_pair(format, random, signs, field, other)
        }
        // The smaller addend reaches just below the last bit of the larger: ties and sticky bits.
        10 | 11 => {
            let distance = random.within(fraction_bits - 1, fraction_bits + 3);
            let field = random.within(1, all_ones - 1);
            hard_pair(format, random, signs, field, field - distance)
        }
        // Products and quotients around the smallest normal and the largest finite number.
        12 | 13 => {
            let field = random.within(1, all_ones - 1);
            let edge = if random.below(2) == 0 { 0 } else { all_ones };
            let wanted = edge + random.within(-2, 2);
            let other = if random.below(2) == 0 {
                wanted + bias - field
            } else {
                field + bias - wanted
            };
            hard_pair(format, random, signs, field, other)
        }
        // Products of just F + 2 bits: half of them ties.
        14 => {
            let first = 1 + random.below(fraction_bits as u64 + 1);
            let second = fraction_bits as u64 + 2 - first;
            let a = short_fraction(format, random, first);
            let b = short_fraction(format, random, second);
            let a_field = random.within(bias / 2, bias + bias / 2);
            let b_field = random.within(bias / 2, bias + bias / 2);
            (
                pattern(format, signs, a_field, a),
                pattern(format, signs >> 1, b_field, b),
            )
        }
        // Dividends just beside a multiple of the divisor: quotients next to a representable value
        // or next to the middle of two.
        _ => {
            let leading = 1u64 << fraction_bits;
            let divisor = leading | (random.next() & (leading - 1));
            let half_units = (2 * leading) | (random.next() & (2 * leading - 1));
            let product = u128::from(divisor) * u128::from(half_units);
            let bits = 128 - i64::from(product.leading_zeros());
            let dividend = (product >> (bits - fraction_bits - 1)) as u64;
            let dividend = dividend.wrapping_add_signed(random.within(-1, 1));
            let a_field = random.within(bias / 2, bias + bias / 2);
            let b_field = random.within(bias / 2, bias + bias / 2);
            (
                pattern(format, signs, a_field, dividend),
                pattern(format, signs >> 1, b_field, divisor),
            )
        }
    }
}

fn hard_pair(
    format: FloatFormat,
    random: &mut Random,
    signs: u64,
    a_field: i64,
    b_field: i64,
) -> (u64, u64) {
    let a = pattern(format, signs, a_field, hard_fraction(format, random));
    let b = pattern(format, signs >> 1, b_field, hard_fraction(format, random));
    if signs & 4 == 0 { (a, b) } else { (b, a) }
}

/// A fraction whose significand has this many bits from its leading to its last one.
fn short_fraction(format: FloatFormat, random: &mut Random, bits: u64) -> u64 {
    let unit = 1u64
        << (u64::from(format.fraction_bits) + 1 - bits.min(u64::from(format.fraction_bits) + 1));
    (random.next() | 1).wrapping_mul(unit) & ((1 << format.fraction_bits) - 1)
}

/// Integers of every length, ties among them, and exponents that lead into, to the ends of and out
/// of the format's range.
fn integer_and_exponent(format: FloatFormat, random: &mut Random) -> (u64, u64) {
    let fraction_bits = u64::from(format.fraction_bits);
    let bias = (1i64 << (format.exponent_bits - 1)) - 1;
    let magnitude = match random.below(8) {
        0 => [0, 1, i64::MAX as u64, i64::MIN as u64][random.below(4) as usize],
        // F + 2 bits, the last one 1: a tie; and its neighbours.
        1 | 2 => {
            let tie = (1u64 << (fraction_bits + 1)) | (random.next() >> (63 - fraction_bits)) | 1;
            let room = 62 - (fraction_bits + 1);
            let shift = random.below(room + 1);
            (tie << shift).wrapping_add_signed(random.within(-1, 1))
        }
        3 => u64::MAX >> (1 + random.below(63)),
        _ => random.next() >> (1 + random.below(63)),
    };
    let integer = if random.below(2) == 0 {
        magnitude as i64
    } else {
        (magnitude as i64).wrapping_neg()
    };
    let length = 64 - i64::from(integer.unsigned_abs().leading_zeros());
    let exponent = match random.below(8) {
        0..=3 => random.within(-bias - 2, bias + 2) - length,
        4 => -bias + 1 - length + random.within(-1, 1),
        5 => bias + 1 - length + random.within(-1, 1),
        6 => [0, i64::MIN, i64::MAX, i64::MIN + 1][random.below(4) as usize],
        _ => random.next() as i64 >> random.below(64),
    };
    (integer as u64, exponent as u64)
}

/// Values from far below one half to beyond 2^63, most with few bits after the point.
fn near_integers(format: FloatFormat, random: &mut Random) -> u64 {
    let bias = (1i64 << (format.exponent_bits - 1)) - 1;
    let sign = random.next();
    match random.below(8) {
        0 | 1 => any(format, random),
        2 => special(format, random),
        3 | 4 => {
            let field = bias + random.within(-3, 66);
            pattern(format, sign, field, random.next())
        }
        // A half after the point, or a hard pattern of bits there.
        5 => {
            let exponent = random.within(0, i64::from(format.fraction_bits) - 1);
            let half = 1u64 << (i64::from(format.fraction_bits) - 1 - exponent);
            let integer = random.next() & !(2 * half - 1);
            pattern(format, sign, bias + exponent, integer | half)
        }
        _ => {
            let field = bias + random.within(-2, 65);
            pattern(format, sign, field, hard_fraction(format, random))
        }
    }
}
