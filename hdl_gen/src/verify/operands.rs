//! Which operands an operator is tried on.

use super::split_mix::SplitMix;
use crate::netlist::Meaning;
use crate::operators::{AnyOperator, FixedOperator, FloatOperator, OperatorConfiguration};
use rtl_model::fixed::FixedFormat;
use rtl_model::float::FloatFormat;

/// Operand sets, numbered from 0: the k-th is the same on every machine.
#[derive(Clone, Debug)]
pub struct OperandSets {
    widths: Vec<u32>,
    kind: Kind,
    /// Of each operand.
    hard: Vec<Vec<u64>>,
    seed: u64,
    count: u64,
    exhaustive: bool,
}

/// What makes random operands of an operator hard.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Floats close to each other in exponent or value, or at the ends of the range.
    Floats(FloatFormat),
    /// A float about as large as the numbers of a fixed-point format.
    FloatNear(FloatFormat, FixedFormat),
    /// Fixed-point numbers of every length, and close to each other.
    Fixed,
    /// Integers: nothing.
    Integers,
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
        if operator.takes_floats() {
            let hard = vec![hard_floats(format); widths.len()];
            OperandSets::of(widths, Kind::Floats(format), hard, count, seed)
        } else {
            // The second is cut to its width.
            let hard = vec![hard_integers(widths[0]); widths.len()];
            OperandSets::of(widths, Kind::Integers, hard, count, seed)
        }
    }

    /// Sets for an operator of any family, as [`OperandSets::new`] has them.
    pub fn of_operator(operator: impl Into<AnyOperator>, count: u64, seed: u64) -> OperandSets {
        let fixed = match operator.into() {
            AnyOperator::Float(configuration) => {
                let OperatorConfiguration {
                    operator, format, ..
                } = configuration;
                return OperandSets::new(operator, format, count, seed);
            }
            AnyOperator::Fixed(fixed) => fixed,
        };
        let hard = fixed.operands().into_iter().map(|operand| match operand {
            Meaning::Float(format) => hard_floats(format),
            Meaning::Fixed(format) => hard_fixed(format),
            Meaning::Bits | Meaning::Signed => unreachable!("operands are numbers"),
        });
        let kind = match fixed.operator {
            FixedOperator::FromFloat { source, .. } => Kind::FloatNear(source, fixed.result),
            _ => Kind::Fixed,
        };
        let widths = fixed.operand_widths();
        OperandSets::of(widths, kind, hard.collect(), count, seed)
    }

    fn of(widths: Vec<u32>, kind: Kind, hard: Vec<Vec<u64>>, count: u64, seed: u64) -> OperandSets {
        let bits: u32 = widths.iter().sum();
        let exhaustive = bits <= EXHAUSTIVE_BITS;
        OperandSets {
            widths,
            kind,
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
        let hard_sets: u64 = self.hard.iter().map(|values| values.len() as u64).product();
        if k < hard_sets {
            let mut rest = k;
            for (values, &width) in self.hard.iter().zip(&self.widths) {
                let value = values[(rest % values.len() as u64) as usize];
                operands.push(value & (u64::MAX >> (64 - width)));
                rest /= values.len() as u64;
            }
            return;
        }
        let mut random = SplitMix(self.seed ^ k.wrapping_mul(0xd134_2543_de82_ef95));
        for &width in &self.widths {
            operands.push(random.next() >> (64 - width));
        }
        match self.kind {
            Kind::Floats(format) => bring_close(format, &mut random, operands),
            Kind::FloatNear(source, result) => {
                bring_near(source, result, &mut random, &mut operands[0]);
            }
            Kind::Fixed => self.bring_fixed_close(&mut random, operands),
            Kind::Integers => {}
        }
    }

    /// In three of four sets, makes fixed-point operands that random bits hardly ever are: short
    /// ones, of either sign, and pairs a few units apart.
    fn bring_fixed_close(&self, random: &mut SplitMix, operands: &mut [u64]) {
        let style = random.next();
        if style & 1 == 0 {
            for (operand, &width) in operands.iter_mut().zip(&self.widths) {
                let sign = random.next();
                let short = *operand >> (random.next() % u64::from(width));
                let short = if sign & 1 == 0 {
                    short
                } else {
                    short.wrapping_neg()
                };
                *operand = short & (u64::MAX >> (64 - width));
            }
        }
        if let [a, b] = operands
            && style >> 8 & 3 == 0
            && self.widths[0] == self.widths[1]
        {
            let units = (random.next() & 7).wrapping_sub(4);
            let sign = if style >> 16 & 1 == 0 { 1 } else { u64::MAX };
            *b = a.wrapping_mul(sign).wrapping_add(units) & (u64::MAX >> (64 - self.widths[1]));
        }
    }
}

/// In half of the cases, gives a float the exponent of a number of the fixed-point format, or of
/// one a little outside its range.
fn bring_near(source: FloatFormat, result: FixedFormat, random: &mut SplitMix, operand: &mut u64) {
    let style = random.next();
    if style & 1 == 0 {
        return;
    }
    let lowest = i64::from(source.exponent_bias()) - i64::from(result.fraction_bits) - 3;
    let span = u64::from(result.width()) + 6;
    let field = lowest + i64::try_from((style >> 8) % span).expect("a few bits");
    let field = field.clamp(0, source.exponent_all_ones().cast_signed());
    let mask = source.exponent_all_ones() << source.fraction_bits;
    *operand = *operand & !mask | field.cast_unsigned() << source.fraction_bits;
}

/// In half of the sets, makes operands that random bits hardly ever are: of nearly the same
/// exponent or value, at the ends of the exponent's range, with long runs in the fraction.
fn bring_close(format: FloatFormat, random: &mut SplitMix, operands: &mut [u64]) {
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

/// The ends of the range, and powers of two with their neighbours, of either sign.
fn hard_fixed(format: FixedFormat) -> Vec<u64> {
    let mask = format.value_mask();
    let mut values = vec![
        0,
        format.min(),
        format.min() + 1,
        format.max() - 1,
        format.max(),
    ];
    for bit in 0..format.width() {
        let power = 1_u64 << bit;
        for near in [power - 1, power, power + 1] {
            values.extend([near & mask, near.wrapping_neg() & mask]);
        }
    }
    values.sort_unstable();
    values.dedup();
    // A wide pair has some thousands of hard sets, which leaves room for random ones.
    let step = values.len().div_ceil(64);
    values.into_iter().step_by(step).collect()
}
