//! Operands, half of them drawn to be hard: a case is a function of seed and index alone.

use rtl_model::float::{FloatFormat, IntegerFormat, Operation, Policy, Rounding};

use super::compare::Subject;

/// One test. Operators that do not round ignore the rounding, and every one the operands that it
/// does not have.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    pub policy: Policy,
    pub rounding: Rounding,
    pub operands: [u64; 3],
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
pub fn case(subject: Subject, format: FloatFormat, seed: u64, index: u64) -> Case {
    let mut random = Random::new(seed, index);
    let rounding = Rounding::ALL[random.below(4) as usize];
    let policy = Policy::ALL[random.below(2) as usize];
    let operands = match subject {
        Subject::FromScaledInteger => {
            let (value, exponent) = integer_and_exponent(format, &mut random);
            [value, exponent, 0]
        }
        Subject::Operation(operation) => match operation {
            Operation::FusedMultiplyAdd => triple(format, &mut random),
            Operation::SquareRoot => [radicand(format, &mut random), 0, 0],
            Operation::ToInteger(target) | Operation::ToIntegerExact(target) => {
                [near_integers(format, target.bits, &mut random), 0, 0]
            }
            Operation::RoundToIntegral | Operation::RoundToIntegralExact | Operation::Floor => [
                near_integers(format, format.fraction_bits, &mut random),
                0,
                0,
            ],
            Operation::FromInteger(source) => [integer(format, source, &mut random), 0, 0],
            Operation::ToFloat(target) => [near_range(format, target, &mut random), 0, 0],
            Operation::FromFloat(source) => [near_range(source, format, &mut random), 0, 0],
            _ => {
                let (a, b) = pair(format, &mut random);
                [a, b, 0]
            }
        },
    };
    Case {
        policy,
        rounding,
        operands,
    }
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
            // Among the subnormal numbers, too.
            let below = if edge == 0 { -fraction_bits - 3 } else { -2 };
            let wanted = edge + random.within(below, 2);
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

/// Values from far below one half to beyond an integer of so many bits, most with few bits after
/// the point.
fn near_integers(format: FloatFormat, bits: u32, random: &mut Random) -> u64 {
    let bits = i64::from(bits);
    let bias = (1i64 << (format.exponent_bits - 1)) - 1;
    let sign = random.next();
    match random.below(8) {
        0 | 1 => any(format, random),
        2 => special(format, random),
        3 | 4 => {
            let field = bias + random.within(-3, bits + 2);
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
            let field = bias + random.within(bits - 2, bits + 1);
            pattern(format, sign, field, hard_fraction(format, random))
        }
    }
}

/// Factors as in any pair, and an addend that is near the product, just below its last bit, or any.
fn triple(format: FloatFormat, random: &mut Random) -> [u64; 3] {
    let (a, b) = pair(format, random);
    let bias = (1i64 << (format.exponent_bits - 1)) - 1;
    let all_ones = 2 * bias + 1;
    let field = |value: u64| (value >> format.fraction_bits) as i64 & all_ones;
    let product = field(a) + field(b) - bias;
    let fraction_bits = i64::from(format.fraction_bits);
    let signs = random.next();
    let c = match random.below(8) {
        0 | 1 => any(format, random),
        2 => special(format, random),
        // Cancels the leading bits of the product, and where the fractions allow it all of them.
        3 | 4 => {
            let mut significand =
                u128::from(a) & ((1 << format.fraction_bits) - 1) | 1 << format.fraction_bits;
            significand *=
                u128::from(b) & ((1 << format.fraction_bits) - 1) | 1 << format.fraction_bits;
            let bits = 128 - i64::from(significand.leading_zeros());
            let leading = (significand >> (bits - fraction_bits - 1)) as u64;
            let carry = bits - 2 * fraction_bits - 1;
            let opposite = (a ^ b) >> (format.width() - 1) ^ 1;
            let near = leading.wrapping_add_signed(random.within(-1, 1));
            pattern(format, opposite, product + carry, near)
        }
        5 => pattern(
            format,
            signs,
            product + random.within(-2, 2),
            hard_fraction(format, random),
        ),
        // Reaches just below the last bit of the product, or the product just below its own.
        _ => {
            let distance = random.within(fraction_bits - 1, 2 * fraction_bits + 4);
            let other = if signs & 2 == 0 {
                product - distance
            } else {
                product + distance
            };
            pattern(format, signs, other, hard_fraction(format, random))
        }
    };
    [a, b, c]
}

/// Any number; and squares, the numbers beside them, and squares of numbers with one bit more.
fn radicand(format: FloatFormat, random: &mut Random) -> u64 {
    let bias = (1i64 << (format.exponent_bits - 1)) - 1;
    match random.below(4) {
        0 => any(format, random),
        1 => special(format, random),
        2 => {
            let field = random.within(0, 2 * bias);
            let sign = u64::from(random.below(8) == 0);
            pattern(format, sign, field, hard_fraction(format, random))
        }
        _ => {
            let length = 1 + random.below(u64::from(format.fraction_bits) + 2);
            let root =
                u128::from(1u64 << (length - 1) | (random.next() & ((1 << (length - 1)) - 1)));
            let square = root * root;
            let bits = 128 - i64::from(square.leading_zeros());
            let fraction_bits = i64::from(format.fraction_bits);
            let shift = bits - fraction_bits - 1;
            let leading = if shift >= 0 {
                square >> shift
            } else {
                square << -shift
            };
            let near = (leading as u64).wrapping_add_signed(random.within(-1, 1));
            // Of either parity, so that half of them are no squares after all.
            let field = random.within(1 - fraction_bits, 2 * bias);
            if field >= 1 {
                pattern(format, 0, field, near)
            } else {
                pattern(format, 0, 0, near >> (1 - field))
            }
        }
    }
}

/// Integers of every length, ties at the format's last bit among them, and the ends of the range.
fn integer(format: FloatFormat, source: IntegerFormat, random: &mut Random) -> u64 {
    let mask = source.mask();
    let fraction_bits = u64::from(format.fraction_bits);
    let magnitude = match random.below(4) {
        0 => [0, 1, mask, mask >> 1, (mask >> 1) + 1, mask - 1][random.below(6) as usize],
        1 => {
            let tie = (1u64 << (fraction_bits + 1)) | (random.next() >> (63 - fraction_bits)) | 1;
            let shift = random.below(63 - fraction_bits);
            (tie << shift).wrapping_add_signed(random.within(-1, 1))
        }
        _ => random.next() >> random.below(64),
    };
    let negate = source.signed && random.below(2) == 1;
    (if negate {
        magnitude.wrapping_neg()
    } else {
        magnitude
    }) & mask
}

/// Values of one format around the ends of another one's range, and ties at its last bit.
fn near_range(source: FloatFormat, target: FloatFormat, random: &mut Random) -> u64 {
    let source_bias = (1i64 << (source.exponent_bits - 1)) - 1;
    let bias = (1i64 << (target.exponent_bits - 1)) - 1;
    let sign = random.next();
    let exponent = match random.below(8) {
        0 => return any(source, random),
        1 => return special(source, random),
        2 | 3 => -bias + random.within(-i64::from(target.fraction_bits) - 2, 2),
        4 => bias + random.within(-2, 2),
        _ => random.within(-bias, bias + 1),
    };
    let fraction = match random.below(3) {
        0 => random.next(),
        1 => hard_fraction(source, random),
        // A tie, or the numbers beside one.
        _ => {
            let dropped = source.fraction_bits.saturating_sub(target.fraction_bits);
            let half = if dropped == 0 {
                0
            } else {
                1u64 << (dropped - 1)
            };
            let kept = random.next() & !((1u64 << dropped) - 1);
            (kept | half).wrapping_add_signed(random.within(-1, 1))
        }
    };
    pattern(source, sign, source_bias + exponent, fraction)
}
