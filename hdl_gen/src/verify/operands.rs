//! Which operands an operator is tried on.

use super::split_mix::SplitMix;
use crate::operators::FloatOperator;
use rtl_model::float::FloatFormat;

/// Operand sets, numbered from 0: the k-th is the same on every machine.
#[derive(Clone, Debug)]
pub struct OperandSets {
    widths: Vec<u32>,
    format: FloatFormat,
    floats: bool,
    hard: Vec<u64>,
    seed: u64,
    count: u64,
    exhaustive: bool,
}

/// Operands of so many bits in all are tried in every combination.
const EXHAUSTIVE_BITS: u32 = 16;

impl OperandSets {
    /// Sets for an operator: every combination where the operands have at most 16 bits together;
    /// else all pairs of hard cases (zeros, the ends of every range, powers of two and their
    /// neighbours, NaN and infinity), then, up to `count`, seeded ones, random in every bit or
    /// close to each other in exponent or value.
    pub fn new(operator: FloatOperator, format: FloatFormat, count: u64, seed: u64) -> OperandSets {
        let widths = operator.operand_widths(format);
        let bits: u32 = widths.iter().sum();
        let exhaustive = bits <= EXHAUSTIVE_BITS;
        let floats = !matches!(
            operator,
            FloatOperator::FromInteger { .. } | FloatOperator::DepthFromHeight { .. }
        );
        let hard = if floats {
            hard_floats(format)
        } else {
            hard_integers(widths[0])
        };
        let count = if exhaustive { 1 << bits } else { count };
        OperandSets {
            widths,
            format,
            floats,
            hard,
            seed,
            count,
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

    /// The k-th set, into `operands`.
    pub fn set(&self, k: u64, operands: &mut Vec<u64>) {
        operands.clear();
        if self.exhaustive {
            let mut rest = k;
            for &width in &self.widths {
                operands.push(rest & (u64::MAX >> (64 - width)));
                rest >>= width;
            }
            return;
        }
        let hard = self.hard.len() as u64;
        if k < hard * hard {
            let pair = [
                self.hard[(k % hard) as usize],
                self.hard[(k / hard) as usize],
            ];
            for (&width, value) in self.widths.iter().zip(pair) {
                operands.push(value & (u64::MAX >> (64 - width)));
            }
            return;
        }
        let mut random = SplitMix(self.seed ^ k.wrapping_mul(0xd134_2543_de82_ef95));
        for &width in &self.widths {
            operands.push(random.next() >> (64 - width));
        }
        if self.floats {
            self.bring_close(&mut random, operands);
        }
    }

    /// In half of the sets, makes operands that random bits hardly ever are: of nearly the same
    /// exponent or value, at the ends of the exponent's range, with long runs in the fraction.
    fn bring_close(&self, random: &mut SplitMix, operands: &mut [u64]) {
        let format = self.format;
        let style = random.next();
        let fraction_bits = format.fraction_bits;
        let exponent = |value: u64| value >> fraction_bits & format.exponent_all_ones();
        let with_exponent = |value: u64, exponent: u64| {
            value & !(format.exponent_all_ones() << fraction_bits) | exponent << fraction_bits
        };
        let second = operands.len() - 1;
        match style % 16 {
            0..=2 => {
                let span = u64::from(fraction_bits) + 4;
                let near = exponent(operands[0]) + random.next() % (2 * span + 1);
                let near = near.saturating_sub(span).min(format.exponent_all_ones());
                operands[second] = with_exponent(operands[second], near);
            }
            3 => {
                operands[second] =
                    operands[0] ^ (random.next() & 0xf) ^ (style >> 32 & format.sign_bit())
            }
            4 | 5 => {
                let last = random.next() % u64::from(fraction_bits + 1);
                for operand in operands.iter_mut() {
                    let ones = (1_u64 << last) - 1;
                    *operand = if style >> 40 & 1 == 0 {
                        *operand | ones
                    } else {
                        *operand & !ones
                    };
                }
            }
            6 => {
                for operand in operands.iter_mut() {
                    *operand = with_exponent(*operand, random.next() & 3);
                }
            }
            7 => {
                for operand in operands.iter_mut() {
                    *operand =
                        with_exponent(*operand, format.exponent_all_ones() - (random.next() & 3));
                }
            }
            _ => {}
        }
    }
}

fn hard_floats(format: FloatFormat) -> Vec<u64> {
    let one = format.one();
    let positive = [
        0,
        1,
        format.min_normal() - 1,
        format.min_normal(),
        format.min_normal() + 1,
        2 * format.min_normal(),
        one - 1,
        one,
        one + 1,
        one + (1 << (format.fraction_bits - 1)),
        one + format.min_normal(),
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
    let half = 1 << (width - 1);
    let mut values = vec![0, 1, 2, 3, half - 1, half, half + 1, full - 1, full];
    values.extend((2..width - 1).flat_map(|bit| [(1 << bit) - 1, 1 << bit, (1 << bit) + 1]));
    values
}
