//! Everything that a fixed-point operator's module depends on but its latency.

use std::sync::Arc;

use rtl_model::fixed::{FixedFormat, Overflow};
#[cfg(doc)]
use rtl_model::float::Flags;
use rtl_model::float::{Policy, Rounding};

use super::super::{FloatOperator, Multiplier, UnsupportedOperator};
use super::{FixedOperator, align, build, float, product, quotient, shift, word_fits};
use crate::netlist::{Builder, Meaning, Module};
use crate::pipeline::{pipelined, without_unused};

/// A fixed-point operator with its formats, its rounding, what it does beyond the range, and whether
/// it has flags. With a latency it names one module.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FixedConfiguration {
    /// What it computes.
    pub operator: FixedOperator,
    /// The format of `a_i`.
    pub a: FixedFormat,
    /// The format of `b_i`, where that is a number.
    pub b: FixedFormat,
    /// The format of `result_o`.
    pub result: FixedFormat,
    /// Which neighbour an inexact result becomes.
    pub rounding: Rounding,
    /// What a result beyond the range becomes.
    pub overflow: Overflow,
    /// Has it the port `flags_o`, [`Flags::WIDTH`] bits in the order of [`Flags`]?
    pub has_flags: bool,
    /// What a product is made of; nothing of it changes a bit of the result.
    pub multiplier: Multiplier,
}

impl FixedConfiguration {
    /// Operands and result of one format; no flags.
    pub fn new(
        operator: FixedOperator,
        format: FixedFormat,
        rounding: Rounding,
        overflow: Overflow,
    ) -> FixedConfiguration {
        FixedConfiguration {
            operator,
            a: format,
            b: format,
            result: format,
            rounding,
            overflow,
            has_flags: false,
            multiplier: Multiplier::Dsp,
        }
    }

    /// With its product, where it has one, made of this.
    pub fn with_multiplier(self, multiplier: Multiplier) -> FixedConfiguration {
        FixedConfiguration { multiplier, ..self }
    }

    /// With operands of these formats.
    pub fn with_operands(self, a: FixedFormat, b: FixedFormat) -> FixedConfiguration {
        FixedConfiguration { a, b, ..self }
    }

    /// With a result of this format.
    pub fn with_result(self, result: FixedFormat) -> FixedConfiguration {
        FixedConfiguration { result, ..self }
    }

    /// With the port `flags_o`; a comparison has none.
    pub fn with_flags(self) -> FixedConfiguration {
        FixedConfiguration {
            has_flags: true,
            ..self
        }
    }

    /// How its operands are meant, in the order of its input ports.
    pub fn operands(self) -> Vec<Meaning> {
        let (a, b) = (Meaning::Fixed(self.a), Meaning::Fixed(self.b));
        match self.operator {
            FixedOperator::Add
            | FixedOperator::Subtract
            | FixedOperator::Multiply
            | FixedOperator::Divide
            | FixedOperator::Compare => vec![a, b],
            FixedOperator::Reciprocal
            | FixedOperator::Negate
            | FixedOperator::Convert
            | FixedOperator::ToFloat { .. } => vec![a],
            FixedOperator::ShiftLeft { amount_bits }
            | FixedOperator::ShiftRight { amount_bits } => {
                vec![a, Meaning::Fixed(FixedFormat::uq(amount_bits, 0))]
            }
            FixedOperator::FromFloat { source, .. } => vec![Meaning::Float(source)],
        }
    }

    /// Widths of its operands, in the order of its input ports.
    pub fn operand_widths(self) -> Vec<u32> {
        let width = |operand| match operand {
            Meaning::Fixed(format) => format.width(),
            Meaning::Float(format) => format.width(),
            Meaning::Bits | Meaning::Signed => unreachable!("operands are numbers"),
        };
        self.operands().into_iter().map(width).collect()
    }

    /// How its result is meant; of a comparison that of each output.
    pub fn result_meaning(self) -> Meaning {
        match self.operator {
            FixedOperator::ToFloat { target, .. } => Meaning::Float(target),
            FixedOperator::Compare => Meaning::Bits,
            _ => Meaning::Fixed(self.result),
        }
    }

    /// Its formats as words: one where all are the same, else the operands', `to` and the result's.
    fn format_words(self) -> Vec<String> {
        let operands = self.operands();
        let result = self.result_meaning();
        let uniform = operands.iter().all(|&operand| operand == operands[0])
            && (result == operands[0] || !self.operator.rounds());
        let named = &operands[..if uniform { 1 } else { operands.len() }];
        let mut words: Vec<String> = named.iter().map(|&operand| format_name(operand)).collect();
        if !uniform && self.operator.rounds() {
            words.extend(["to".to_owned(), format_name(result)]);
        }
        words
    }

    /// Its formats, as reports name them: `q4.12`, or `q4.12 uq0.16 to q12.20` where they differ.
    pub fn formats(self) -> String {
        self.format_words().join(" ")
    }

    /// Its module's name without the latency: the operator, its formats, what differs from the
    /// default, then the rounding and what it does beyond the range, as in
    /// `fixed_mul_q4_12_rne_saturate`. A point is no part of a name in Verilog.
    pub fn name(self) -> String {
        let mut name = self.operator.name().to_owned();
        for word in self.format_words() {
            name += &format!("_{}", word.replace('.', "_"));
        }
        if let FixedOperator::FromFloat { policy, .. } | FixedOperator::ToFloat { policy, .. } =
            self.operator
            && policy == Policy::Full
        {
            name += "_full";
        }
        if self.operator.rounds() {
            if self.has_flags {
                name += "_flags";
            }
            if self.multiplier == Multiplier::Logic {
                name += "_logic";
            }
            name += &format!("_{}", self.rounding);
        }
        if self.operator.has_fixed_result() {
            name += &format!("_{}", self.overflow);
        }
        name
    }

    /// The name of its module in so many cycles, such as `fixed_mul_q4_12_rne_saturate_l1`.
    pub fn module_name(self, latency: u32) -> String {
        format!("{}_l{latency}", self.name())
    }

    /// Can it be built?
    ///
    /// # Errors
    /// If a word of it would be wider than 64 bits, or a parameter is out of its range.
    pub fn check(self) -> Result<(), UnsupportedOperator> {
        let fits = |word, width| word_fits(self.operator, word, width);
        match self.operator {
            FixedOperator::Add | FixedOperator::Subtract => {
                fits("exact sum", align::common(self.a, self.b).width() + 1)
            }
            FixedOperator::Compare => {
                fits("aligned operand", align::common(self.a, self.b).width())
            }
            FixedOperator::Negate => fits("exact result", self.a.width() + 1),
            FixedOperator::Convert => fits("operand with a place for a carry", self.a.width() + 1),
            FixedOperator::Multiply => fits("exact product", product::widest_word(self)),
            FixedOperator::Divide | FixedOperator::Reciprocal => {
                fits("widest word", quotient::widest_word(self))
            }
            FixedOperator::ShiftLeft { amount_bits }
            | FixedOperator::ShiftRight { amount_bits } => {
                if !(1..=6).contains(&amount_bits) {
                    return Err(UnsupportedOperator::WidthOutOfRange {
                        operator: self.operator.name(),
                        parameter: "amount",
                        width: amount_bits,
                        least: 1,
                        most: 6,
                    });
                }
                fits("shifted word", shift::widest_word(self))
            }
            FixedOperator::FromFloat { source, policy } => fits(
                "aligned significand",
                float::widest_word(self, source, policy),
            ),
            FixedOperator::ToFloat { target, .. } => {
                FloatOperator::Add.check(target)?;
                fits("word to be rounded", float::widest_sum(self, target))
            }
        }
    }

    /// Its module: combinational for latency 0, else a pipeline that takes new operands every
    /// cycle in which `enable_i` is 1 (see [`pipelined`]).
    ///
    /// # Panics
    /// Where [`FixedConfiguration::check`] fails.
    pub fn build(self, latency: u32) -> Arc<Module> {
        if let Err(error) = self.check() {
            panic!("{error}");
        }
        let name = self.module_name(latency);
        let mut builder = Builder::new(&name);
        self.describe(&mut builder, latency);
        build(&mut builder, self);
        pipelined(&without_unused(&builder.finish()), latency, &name)
    }

    /// The header comment.
    fn describe(self, builder: &mut Builder, latency: u32) {
        builder.describe(self.operator.formula());
        for (name, operand) in ["a_i", "b_i"].into_iter().zip(self.operands()) {
            builder.describe(format!("{name}: {}", description(operand)));
        }
        if self.operator.rounds() {
            builder.describe(format!("result_o: {}", description(self.result_meaning())));
            builder.describe(format!("rounding: {}", self.rounding));
        }
        if self.operator.has_fixed_result() {
            builder.describe(match self.overflow {
                Overflow::Saturate => {
                    "overflow: saturate (first rounded, then moved to the nearer end of the range)"
                }
                Overflow::Wrap => "overflow: wrap (first rounded, then cut to the low bits)",
            });
        }
        if let FixedOperator::FromFloat { policy, .. } | FixedOperator::ToFloat { policy, .. } =
            self.operator
        {
            builder.describe(match policy {
                Policy::Flush => "policy: flush (subnormal floats are zeros of their sign)",
                Policy::Full => "policy: full (subnormal floats as in IEEE 754)",
            });
        }
        builder.describe(format!("latency: {latency}"));
        builder.describe(format!(
            "golden: rtl_model::fixed::{}",
            self.operator.golden()
        ));
    }
}

/// A format by its name.
fn format_name(meaning: Meaning) -> String {
    match meaning {
        Meaning::Fixed(format) => format.to_string(),
        Meaning::Float(format) => format.to_string(),
        Meaning::Bits | Meaning::Signed => "bits".to_owned(),
    }
}

/// A format in words.
fn description(meaning: Meaning) -> String {
    match meaning {
        Meaning::Fixed(format) => {
            let (integer, fraction) = (format.integer_bits, format.fraction_bits);
            let kind = if format.signed {
                "two's complement, the sign among"
            } else {
                "unsigned,"
            };
            format!("{format} ({kind} {integer} integer bits, {fraction} fraction bits)")
        }
        Meaning::Float(format) => format!(
            "{format} (1 sign, {} exponent, {} fraction bits, bias {})",
            format.exponent_bits,
            format.fraction_bits,
            format.exponent_bias()
        ),
        Meaning::Bits | Meaning::Signed => "bits".to_owned(),
    }
}
