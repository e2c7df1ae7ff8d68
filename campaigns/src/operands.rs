//! Which operands an operation is tried on.
//!
//! Uniformly random floats hardly ever cancel, tie, or come near an end of the range. As Hauser's
//! TestFloat does, exponents and fractions are drawn from classes that do, and operands of one
//! case are related to each other: close in exponent or value, half a unit apart, or with a product
//! or quotient near either end of the range.

use rtl_model::float::{FloatFormat, Operation, Word};

/// Operand sets, numbered from 0: the k-th is the same on every machine and in every thread.
#[derive(Clone, Debug)]
pub struct Operands {
    operation: Operation,
    format: FloatFormat,
    widths: Vec<u32>,
    hard: Vec<u64>,
    seed: u64,
    count: u64,
    exhaustive: bool,
}

/// SplitMix64 (Steele, Lea, Flood 2014).
struct SplitMix(u64);

impl SplitMix {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Below `bound`, which is small.
    fn below(&mut self, bound: u64) -> u64 {
        ((self.next() >> 32) * bound) >> 32
    }
}

impl Operands {
    /// `count` sets: every one where there are no more than that; else all combinations of hard
    /// values, then seeded ones.
    pub fn new(operation: Operation, format: FloatFormat, count: u64, seed: u64) -> Operands {
        let words = operation.operands(format);
        let widths: Vec<u32> = words.iter().copied().map(Word::width).collect();
        let bits: u32 = widths.iter().sum();
        let exhaustive = bits < 63 && 1 << bits <= count;
        let hard = match operation {
            Operation::FromInteger(source) => hard_integers(source.bits),
            _ => hard_floats(format),
        };
        Operands {
            operation,
            format,
            widths,
            hard,
            seed,
            count: if exhaustive { 1 << bits } else { count },
            exhaustive,
        }
    }

    /// How many there are.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Are they all there can be?
    pub fn is_exhaustive(&self) -> bool {
        self.exhaustive
    }

    /// Operands in a set.
    pub fn width(&self) -> usize {
        self.widths.len()
    }

    /// The k-th set; operands that the operation does not have are 0.
    #[inline]
    pub fn set(&self, k: u64) -> [u64; 3] {
        let mut operands = [0; 3];
        if self.exhaustive {
            let mut rest = k;
            for (operand, &width) in operands.iter_mut().zip(&self.widths) {
                *operand = rest & (u64::MAX >> (64 - width));
                rest >>= width;
            }
            return operands;
        }
        let hard = self.hard.len() as u64;
        let combinations = hard.pow(self.widths.len() as u32);
        if k < combinations {
            let mut rest = k;
            for operand in operands.iter_mut().take(self.widths.len()) {
                *operand = self.hard[(rest % hard) as usize];
                rest /= hard;
            }
            return operands;
        }
        let mut random = SplitMix(self.seed ^ k.wrapping_mul(0xd134_2543_de82_ef95));
        if let Operation::FromInteger(source) = self.operation {
            operands[0] = integer(&mut random, source.bits);
            return operands;
        }
        for operand in operands.iter_mut().take(self.widths.len()) {
            *operand = self.float(&mut random);
        }
        if self.widths.len() > 1 {
            self.relate(&mut random, &mut operands);
        }
        operands
    }

    /// A float with an exponent and a fraction of some class.
    fn float(&self, random: &mut SplitMix) -> u64 {
        let format = self.format;
        let bits = random.next();
        let uniform = bits & format.value_mask();
        let choice = random.next();
        let all_ones = format.exponent_all_ones();
        let exponent = match choice & 15 {
            0 => choice >> 8 & 3,
            1 => all_ones - (choice >> 8 & 3),
            2..=5 => {
                // Near one, where fractions and integers meet.
                let span = u64::from(format.fraction_bits) + 4;
                let bias = format.exponent_bias() as u64;
                (bias + (choice >> 8) % (2 * span + 1))
                    .saturating_sub(span)
                    .min(all_ones)
            }
            _ => uniform >> format.fraction_bits & all_ones,
        };
        let place = (choice >> 32) % u64::from(format.fraction_bits);
        let second = (choice >> 40) % u64::from(format.fraction_bits);
        let fraction = match choice >> 4 & 15 {
            0 => 0,
            1 => 1 << place,
            2 => !(1 << place),
            3 => (1 << place) - 1,
            4 => !((1 << place) - 1),
            5 => 1 << place | 1 << second,
            6 => uniform & !((1 << place) - 1),
            7 => uniform | ((1 << place) - 1),
            _ => uniform,
        };
        uniform & format.sign_bit()
            | exponent << format.fraction_bits
            | fraction & format.fraction_mask()
    }

    /// Makes the last operand a close relation of the others in three cases of four.
    fn relate(&self, random: &mut SplitMix, operands: &mut [u64; 3]) {
        let format = self.format;
        let fraction_bits = format.fraction_bits;
        let all_ones = format.exponent_all_ones() as i64;
        let bias = i64::from(format.exponent_bias());
        let exponent = |value: u64| (value >> fraction_bits & format.exponent_all_ones()) as i64;
        let with_exponent = |value: u64, exponent: i64| {
            let exponent = exponent.clamp(0, all_ones) as u64;
            value & !(format.exponent_all_ones() << fraction_bits) | exponent << fraction_bits
        };
        let span = i64::from(fraction_bits) + 4;
        let choice = random.next();
        let offset = (choice >> 8) as i64 % (span + 1);
        let [a, b, _] = *operands;
        match (self.operation, choice & 7) {
            (_, 0 | 1) => {}
            (Operation::FusedMultiplyAdd, kind) => {
                let product = exponent(a) + exponent(b) - bias;
                if kind < 5 {
                    operands[2] = with_exponent(operands[2], product + offset);
                    return;
                }
                // Minus the product but for the last bits: it cancels.
                let hidden = 1_u128 << fraction_bits;
                let mask = u128::from(format.fraction_mask());
                let exact = (u128::from(a) & mask | hidden) * (u128::from(b) & mask | hidden);
                let carry = (exact >> (2 * fraction_bits + 1)) as u32;
                let leading = (exact >> (fraction_bits + carry) & mask) as u64;
                let last = (choice >> 60) & (choice >> 56) & 3;
                let sign = (a ^ b ^ format.sign_bit()) & format.sign_bit();
                operands[2] = with_exponent(sign | (leading ^ last), product + i64::from(carry));
            }
            (Operation::Multiply, kind) => {
                let edge = if kind < 6 { 0 } else { all_ones };
                operands[1] = with_exponent(b, edge + offset + bias - exponent(a));
            }
            (Operation::Divide, kind) => {
                let edge = if kind < 6 { 0 } else { all_ones };
                operands[1] = with_exponent(b, exponent(a) + bias - edge - offset);
            }
            (_, 2 | 3) => operands[1] = with_exponent(b, exponent(a) + offset),
            (_, 4) => {
                operands[1] = a ^ (choice >> 32 & 0xf) ^ (choice & format.sign_bit());
            }
            (_, 5) => {
                operands[1] =
                    (a ^ format.sign_bit()).wrapping_add(choice >> 60) & format.value_mask()
            }
            (_, _) => {
                // Half a unit of the last place of a, exactly, and nothing below.
                let apart = 1 + offset.unsigned_abs() % u64::from(fraction_bits);
                let below = (1_u64 << apart) - 1;
                operands[1] =
                    with_exponent(b & !below | (below + 1) >> 1, exponent(a) - apart as i64);
            }
        }
    }
}

/// Zeros, the ends of every range and their neighbours, powers of two, infinities, NaNs of both
/// kinds.
fn hard_floats(format: FloatFormat) -> Vec<u64> {
    let one = format.one();
    let positive = [
        0,
        1,
        format.min_normal() - 1,
        format.min_normal(),
        format.min_normal() + 1,
        one - 1,
        one,
        one + 1,
        one + (1 << (format.fraction_bits - 1)),
        format.max_finite() - 1,
        format.max_finite(),
        format.infinity(),
        format.infinity() + 1,
        format.quiet_nan(),
        format.value_mask() >> 1,
    ];
    positive
        .into_iter()
        .flat_map(|value| [value, value | format.sign_bit()])
        .collect()
}

fn hard_integers(width: u32) -> Vec<u64> {
    let full = u64::MAX >> (64 - width);
    let mut values = vec![0, full];
    for bit in 0..width {
        let power = 1 << bit;
        values.extend([power - 1, power, power + 1, full - power, full - power + 1]);
    }
    values.iter_mut().for_each(|value| *value &= full);
    values
}

/// An integer with any number of leading bits alike, and often a half and nothing below it.
fn integer(random: &mut SplitMix, width: u32) -> u64 {
    let full = u64::MAX >> (64 - width);
    let value = random.next() as i64 >> (64 - width) >> random.below(u64::from(width));
    let last = random.below(u64::from(width));
    let value = match random.next() & 3 {
        0 => value as u64 & !((1 << last) - 1),
        1 => value as u64 | ((1 << last) - 1),
        _ => value as u64,
    };
    value & full
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::{HALF, SINGLE};
    use rtl_model::float::{Flags, IntegerFormat, Policy, Rounding};

    /// How many of so many sets raise these flags, and how many are ties.
    fn share(operation: Operation, format: FloatFormat, flags: Flags) -> f64 {
        let operands = Operands::new(operation, format, 100_000, 7);
        assert!(!operands.is_exhaustive());
        let arithmetic = format.arithmetic(Policy::Full, Rounding::NearestEven);
        let raised = (0..operands.count()).filter(|&k| {
            let answer = operation.evaluate(arithmetic, operands.set(k));
            answer.flags.contains(flags)
        });
        raised.count() as f64 / operands.count() as f64
    }

    #[test]
    fn underflow_overflow_and_exact_results_are_not_rare() {
        for format in [FloatFormat::E7F16, SINGLE] {
            for operation in [
                Operation::Multiply,
                Operation::Divide,
                Operation::FusedMultiplyAdd,
            ] {
                for flags in [Flags::UNDERFLOW, Flags::OVERFLOW, Flags::INVALID] {
                    let share = share(operation, format, flags);
                    assert!(share > 0.01, "{operation} {format} {flags}: {share}");
                }
            }
            let share = share(Operation::Add, format, Flags::INEXACT);
            assert!((0.2..0.8).contains(&share), "inexact sums: {share}");
        }
    }

    #[test]
    fn ties_are_not_rare() {
        let format = FloatFormat::E7F16;
        let rounded = |rounding, operation: Operation, set| {
            operation.evaluate(format.arithmetic(Policy::Full, rounding), set)
        };
        for (operation, least) in [(Operation::Add, 0.02), (Operation::Multiply, 0.005)] {
            let operands = Operands::new(operation, format, 100_000, 7);
            let ties = (0..operands.count()).filter(|&k| {
                let set = operands.set(k);
                // Widened by one bit a tie is exact.
                let exact = FloatFormat::new(7, 17).arithmetic(Policy::Full, Rounding::Down);
                let wide = [set[0] << 1, set[1] << 1, 0];
                rounded(Rounding::Down, operation, set).flags == Flags::INEXACT
                    && operation.evaluate(exact, wide).flags == Flags::NONE
            });
            let share = ties.count() as f64 / operands.count() as f64;
            assert!(share > least, "{operation}: {share}");
        }
    }

    #[test]
    fn few_operands_are_all_tried() {
        let operands = Operands::new(Operation::SquareRoot, HALF, 100_000, 7);
        assert!(operands.is_exhaustive());
        assert_eq!(operands.count(), 65_536);
        assert_eq!(operands.set(65_535), [0xffff, 0, 0]);
        let integers = Operation::FromInteger(IntegerFormat::I64);
        assert!(!Operands::new(integers, HALF, 1 << 40, 7).is_exhaustive());
    }
}
