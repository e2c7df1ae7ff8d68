//! Which operands stand in a corpus: directed, hard and random ones.

use rtl_model::float::{FloatFormat, IntegerFormat, Operation, Word};

use crate::verify::split_mix::SplitMix;

/// The operands of an operator, `lines` of them, the same on every machine: first every combination
/// of special values, as far as they reach within a third of the lines; then hard ones, and among
/// them one random in every bit out of three.
pub fn operand_lines(
    operation: Operation,
    format: FloatFormat,
    lines: usize,
    seed: u64,
) -> Vec<[u64; 3]> {
    let words = operation.operands(format);
    let mut found = directed(&words, lines / 3);
    let mut random = Random(SplitMix(seed));
    while found.len() < lines {
        let mut operands = [0; 3];
        if random.below(3) == 0 {
            for (operand, word) in operands.iter_mut().zip(&words) {
                *operand = random.bits(word.width());
            }
        } else {
            operands = match (operation, words[0]) {
                (Operation::FusedMultiplyAdd, _) => random.triple(format),
                (Operation::SquareRoot, _) => [random.radicand(format), 0, 0],
                (Operation::FromFloat(source), _) => [random.near_range(source, format), 0, 0],
                (Operation::ToFloat(target), _) => [random.near_range(format, target), 0, 0],
                (Operation::ToInteger(target) | Operation::ToIntegerExact(target), _) => {
                    [random.near_integer(format, target.bits), 0, 0]
                }
                (_, Word::Integer(source)) => [random.integer(source, format), 0, 0],
                _ if words.len() == 1 => [random.near_integer(format, format.fraction_bits), 0, 0],
                _ => random.pair(format),
            };
        }
        found.push(operands);
    }
    found
}

/// Combinations of special values, up to `most`, spread over all of them where there are more.
fn directed(words: &[Word], most: usize) -> Vec<[u64; 3]> {
    let specials: Vec<Vec<u64>> = words.iter().map(|&word| special_values(word)).collect();
    let all: usize = specials.iter().map(Vec::len).product();
    let count = all.min(most);
    (0..count)
        .map(|place| {
            let mut rest = place * all / count;
            let mut operands = [0; 3];
            for (operand, values) in operands.iter_mut().zip(&specials) {
                *operand = values[rest % values.len()];
                rest /= values.len();
            }
            operands
        })
        .collect()
}

/// Ends of every range of numbers, and NaNs.
fn special_values(word: Word) -> Vec<u64> {
    match word {
        Word::Float(format) => {
            let one = format.one();
            [
                0,
                1,
                format.min_normal() - 1,
                format.min_normal(),
                one - 1,
                one,
                one + 1,
                format.max_finite(),
                format.infinity(),
                format.infinity() + 1,
                format.quiet_nan(),
            ]
            .into_iter()
            .flat_map(|value| [value, value | format.sign_bit()])
            .collect()
        }
        Word::Integer(format) => {
            let mask = format.mask();
            let mut values = vec![0, 1, 2, mask, mask - 1, mask >> 1, (mask >> 1) + 1];
            values.extend((2..format.bits).map(|bit| 1 << bit));
            values
        }
        Word::Truth => vec![0, 1],
    }
}

struct Random(SplitMix);

impl Random {
    fn bits(&mut self, width: u32) -> u64 {
        self.0.next() >> (64 - width)
    }

    /// A number from 0 to `count - 1`.
    fn below(&mut self, count: u64) -> u64 {
        ((self.0.next() >> 32) * count) >> 32
    }

    /// A number from `low` to `high`, both included.
    fn within(&mut self, low: i64, high: i64) -> i64 {
        low + self.below((high - low + 1) as u64) as i64
    }

    /// The float of this sign (its last bit), exponent field, brought into range, and fraction.
    fn float(format: FloatFormat, sign: u64, field: i64, fraction: u64) -> u64 {
        let field = field.clamp(0, format.exponent_all_ones() as i64) as u64;
        let sign = if sign & 1 == 1 { format.sign_bit() } else { 0 };
        sign | field << format.fraction_bits | fraction & format.fraction_mask()
    }

    /// A fraction with long runs of equal bits, or few ones.
    fn fraction(&mut self, format: FloatFormat) -> u64 {
        let mask = format.fraction_mask();
        let place = self.below(u64::from(format.fraction_bits));
        match self.below(6) {
            0 => 0,
            1 => mask,
            2 => 1 << place,
            3 => mask << place & mask,
            4 => mask >> place,
            _ => self.bits(format.fraction_bits) << place & mask,
        }
    }

    fn pair(&mut self, format: FloatFormat) -> [u64; 3] {
        let fraction_bits = i64::from(format.fraction_bits);
        let bias = i64::from(format.exponent_bias());
        let signs = self.bits(2);
        let field = self.within(1, 2 * bias);
        let other = match self.below(4) {
            // Close to each other: cancellation.
            0 => {
                let a = self.bits(format.width());
                let b = a.wrapping_add_signed(self.within(-3, 3)) ^ (signs << (format.width() - 1));
                return [a, b & format.value_mask(), 0];
            }
            1 => field + self.within(-2, 2),
            // One ends where the other's rounding begins.
            2 => field - self.within(fraction_bits - 1, fraction_bits + 2),
            // A product or a quotient at an end of the range, or among the subnormal numbers.
            _ => {
                let result = if self.below(2) == 0 {
                    self.within(-fraction_bits - 2, 2)
                } else {
                    2 * bias + self.within(-1, 2)
                };
                if self.below(2) == 0 {
                    result + bias - field
                } else {
                    field + bias - result
                }
            }
        };
        let (first, second) = (self.fraction(format), self.fraction(format));
        let a = Self::float(format, signs, field, first);
        [a, Self::float(format, signs >> 1, other, second), 0]
    }

    /// The third is near the product of the others, with the opposite sign, or begins or ends where
    /// the product's rounding does.
    fn triple(&mut self, format: FloatFormat) -> [u64; 3] {
        let fraction_bits = i64::from(format.fraction_bits);
        let bias = i64::from(format.exponent_bias());
        let [a, b, _] = self.pair(format);
        let field =
            |value: u64| (value >> format.fraction_bits & format.exponent_all_ones()) as i64;
        let product = field(a) + field(b) - bias;
        let significand =
            |value: u64| u128::from(value & format.fraction_mask() | format.min_normal());
        let exact = significand(a) * significand(b);
        let length = 128 - i64::from(exact.leading_zeros());
        let opposite = (a ^ b) >> (format.width() - 1) ^ 1;
        let c = match self.below(3) {
            0 | 1 => {
                let leading = (exact >> (length - fraction_bits - 1)) as u64;
                let near = leading.wrapping_add_signed(self.within(-1, 1));
                let carry = length - 2 * fraction_bits - 1;
                Self::float(format, opposite, product + carry, near)
            }
            _ => {
                let distance = self.within(fraction_bits - 1, 2 * fraction_bits + 3);
                let away = if self.below(2) == 0 {
                    distance
                } else {
                    -distance
                };
                let fraction = self.fraction(format);
                Self::float(format, self.0.next(), product + away, fraction)
            }
        };
        [a, b, c]
    }

    /// A square or a number beside one, of any magnitude.
    fn radicand(&mut self, format: FloatFormat) -> u64 {
        let fraction_bits = i64::from(format.fraction_bits);
        let root = u128::from(format.min_normal() | self.fraction(format));
        let square = root * root;
        let length = 128 - i64::from(square.leading_zeros());
        let leading = (square >> (length - fraction_bits - 1)) as u64;
        let near = leading.wrapping_add_signed(self.within(-1, 1));
        let field = self.within(1 - fraction_bits, 2 * i64::from(format.exponent_bias()));
        if field >= 1 {
            Self::float(format, 0, field, near)
        } else {
            Self::float(format, 0, 0, near >> (1 - field))
        }
    }

    /// From below one half to beyond so many bits, with a half after the point or anything there.
    fn near_integer(&mut self, format: FloatFormat, bits: u32) -> u64 {
        let bias = i64::from(format.exponent_bias());
        let exponent = self.within(-3, i64::from(bits) + 2);
        let mut fraction = self.fraction(format);
        let below_point = i64::from(format.fraction_bits) - exponent;
        if self.below(2) == 0 && (1..=i64::from(format.fraction_bits)).contains(&below_point) {
            let half = 1_u64 << (below_point - 1);
            fraction = self.bits(format.fraction_bits) & !(2 * half - 1) | half;
        }
        Self::float(format, self.0.next(), bias + exponent, fraction)
    }

    /// Of every length; half of those that are longer than a significand are ties or beside one.
    fn integer(&mut self, source: IntegerFormat, format: FloatFormat) -> u64 {
        let length = 1 + self.below(u64::from(source.bits)) as u32;
        let mut magnitude = self.bits(length) | 1 << (length - 1);
        if let Some(dropped @ 1..) = length.checked_sub(format.fraction_bits + 1)
            && self.below(2) == 0
        {
            let half = 1_u64 << (dropped - 1);
            magnitude =
                (magnitude & !(2 * half - 1) | half).wrapping_add_signed(self.within(-1, 1));
        }
        let negate = source.signed && self.below(2) == 0;
        let value = if negate {
            magnitude.wrapping_neg()
        } else {
            magnitude
        };
        value & source.mask()
    }

    /// Values of one format at the ends of another one's range, and ties at its last bit.
    fn near_range(&mut self, source: FloatFormat, target: FloatFormat) -> u64 {
        let bias = i64::from(target.exponent_bias());
        let exponent = match self.below(3) {
            0 => -bias + self.within(-i64::from(target.fraction_bits) - 2, 2),
            1 => bias + self.within(-1, 2),
            _ => self.within(-bias, bias),
        };
        let mut fraction = self.fraction(source);
        if let Some(dropped @ 1..) = source.fraction_bits.checked_sub(target.fraction_bits)
            && self.below(2) == 0
        {
            let half = 1_u64 << (dropped - 1);
            fraction = (self.bits(source.fraction_bits) & !(2 * half - 1) | half)
                .wrapping_add_signed(self.within(-1, 1));
        }
        let field = i64::from(source.exponent_bias()) + exponent;
        Self::float(source, self.0.next(), field, fraction)
    }
}
