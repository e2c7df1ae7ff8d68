//! The options that say which operator, shared by all commands that take `--unit`.

use anyhow::bail;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use hdl_gen::datapath::OperatorLatencies;
use hdl_gen::operators::{
    AnyOperator, FixedConfiguration, FixedOperator, Multiplier, OperatorConfiguration, Radix,
    Structure,
};
use rtl_model::fixed::{FixedFormat, Overflow};
use rtl_model::float::{Policy, Rounding};

use crate::options::NumberFormat;
use crate::units::{FIXED_OPERATORS, fixed_format, float_format, named_operator};

/// The longest latency a person may ask for, in cycles.
const MAX_LATENCY: i64 = 32;

/// The format of a fixed-point operator unless told.
const DEFAULT_FIXED: FixedFormat = FixedFormat::q(4, 12);

/// The options below, as they are written.
const EVERY_OPTION: [&str; 9] = [
    "--rounding",
    "--policy",
    "--flags",
    "--latency",
    "--multiplier",
    "--radix",
    "--result-format",
    "--b-format",
    "--overflow",
];

/// What an operator is beside its name and its format.
#[derive(Args, Clone, Debug)]
pub struct OperatorOptions {
    /// Of an operator: rne (unless told), rtz, rup or rdn
    #[arg(long, value_name = "ROUNDING")]
    rounding: Option<Rounding>,

    /// Of an operator: flush (unless told: subnormal numbers are zeros) or full (as in IEEE 754)
    #[arg(long, value_name = "POLICY")]
    policy: Option<Policy>,

    /// Of an operator: with the port flags_o
    #[arg(long)]
    flags: bool,

    /// Of a fixed-point operator: the format of its result; that of its operands unless told
    #[arg(long, value_name = "FORMAT")]
    result_format: Option<NumberFormat>,

    /// Of a fixed-point operator: the format of its second operand; that of the first unless told
    #[arg(long, value_name = "FORMAT")]
    b_format: Option<NumberFormat>,

    /// Of a fixed-point operator: saturate (unless told) or wrap where a result is beyond the range
    #[arg(long, value_name = "OVERFLOW")]
    overflow: Option<Overflow>,

    /// Of an operator: its cycles; the paper's budget unless told
    #[arg(long, value_name = "CYCLES",
        value_parser = clap::value_parser!(u32).range(1..=MAX_LATENCY))]
    latency: Option<u32>,

    /// Of an operator: what multiplies significands, a DSP block (unless told) or logic
    #[arg(long, value_name = "MULTIPLIER",
        value_parser = named(["dsp", "logic"], [Multiplier::Dsp, Multiplier::Logic]))]
    multiplier: Option<Multiplier>,

    /// Of an operator: the radix of divisions, 2 (unless told), 4, or mixed: rows of either
    #[arg(long, value_name = "RADIX",
        value_parser = named(["2", "4", "mixed"], [Radix::Two, Radix::Four, Radix::Mixed]))]
    radix: Option<Radix>,
}

/// An operator that is asked for, and that there is.
#[derive(Clone, Copy, Debug)]
pub struct ChosenOperator {
    /// All but the latency.
    pub configuration: AnyOperator,
    /// Cycles.
    pub latency: u32,
}

impl OperatorOptions {
    /// Complains of any option that was given, since `subject` is no operator: nothing that a
    /// person says is ignored.
    ///
    /// # Errors
    /// If there is one.
    pub fn none_for(&self, subject: &str) -> anyhow::Result<()> {
        match self.given(&EVERY_OPTION) {
            Some(option) => bail!(
                "{option} is of operators, and {subject} is none: leave it out, or name an \
                 operator with --unit, such as --unit float_add"
            ),
            None => Ok(()),
        }
    }

    /// The first of these options that was given.
    fn given(&self, options: &[&'static str]) -> Option<&'static str> {
        let is_given = |option: &&&str| match **option {
            "--rounding" => self.rounding.is_some(),
            "--policy" => self.policy.is_some(),
            "--flags" => self.flags,
            "--latency" => self.latency.is_some(),
            "--multiplier" => self.multiplier.is_some(),
            "--radix" => self.radix.is_some(),
            "--result-format" => self.result_format.is_some(),
            "--b-format" => self.b_format.is_some(),
            "--overflow" => self.overflow.is_some(),
            other => unreachable!("no option {other}"),
        };
        options.iter().find(is_given).copied()
    }

    /// Complains of any of these options that was given: the operator has no use for it.
    fn refuse(&self, name: &str, options: &[&'static str]) -> anyhow::Result<()> {
        match self.given(options) {
            Some(option) => bail!("{option}: {name} has no use for it; leave it out"),
            None => Ok(()),
        }
    }

    /// The operator of this name in this format, as the options have it.
    ///
    /// # Errors
    /// If there is no such operator, or none of this kind.
    pub fn choose(
        &self,
        name: &str,
        format: Option<NumberFormat>,
    ) -> anyhow::Result<ChosenOperator> {
        if FIXED_OPERATORS.contains(&name) {
            return self.choose_fixed(name, format);
        }
        let operator = named_operator(name)?;
        let format = float_format(format)?;
        self.refuse(name, &["--result-format", "--b-format", "--overflow"])?;
        let configuration = OperatorConfiguration {
            operator,
            format,
            rounding: self.rounding.unwrap_or(Rounding::NearestEven),
            policy: self.policy.unwrap_or_default(),
            has_flags: self.flags,
            structure: Structure {
                multiplier: self.multiplier.unwrap_or_default(),
                radix: self.radix.unwrap_or_default(),
            },
        };
        configuration.check()?;
        Ok(ChosenOperator {
            configuration: configuration.into(),
            latency: self
                .latency
                .unwrap_or(OperatorLatencies::PAPER.of_operator(operator)),
        })
    }

    /// The fixed-point operator of this name.
    fn choose_fixed(
        &self,
        name: &str,
        format: Option<NumberFormat>,
    ) -> anyhow::Result<ChosenOperator> {
        self.refuse(name, &["--radix"])?;
        if name != "fixed_mul" {
            self.refuse(name, &["--multiplier"])?;
        }
        let is_conversion = matches!(name, "fixed_from_float" | "fixed_to_float");
        if !is_conversion {
            self.refuse(name, &["--policy"])?;
        }
        if !matches!(
            name,
            "fixed_add" | "fixed_sub" | "fixed_mul" | "fixed_div" | "fixed_cmp"
        ) {
            self.refuse(name, &["--b-format"])?;
        }
        match name {
            "fixed_cmp" => self.refuse(
                name,
                &["--rounding", "--flags", "--result-format", "--overflow"],
            )?,
            "fixed_to_float" => self.refuse(name, &["--overflow"])?,
            _ => {}
        }
        let policy = self.policy.unwrap_or_default();
        let (a, result, operator) = match name {
            "fixed_from_float" => {
                let source = float_format(format)?;
                let result = fixed_format("--result-format", self.result_format, DEFAULT_FIXED)?;
                (result, result, FixedOperator::FromFloat { source, policy })
            }
            "fixed_to_float" => {
                let a = fixed_format("--format", format, DEFAULT_FIXED)?;
                let target = float_format(self.result_format)?;
                (a, a, FixedOperator::ToFloat { target, policy })
            }
            _ => {
                let a = fixed_format("--format", format, DEFAULT_FIXED)?;
                let result = fixed_format("--result-format", self.result_format, a)?;
                // Every distance that leaves something of the word.
                let amount_bits = (u32::BITS - (a.width() - 1).leading_zeros()).clamp(1, 6);
                let operator = match name {
                    "fixed_add" => FixedOperator::Add,
                    "fixed_sub" => FixedOperator::Subtract,
                    "fixed_mul" => FixedOperator::Multiply,
                    "fixed_div" => FixedOperator::Divide,
                    "fixed_reciprocal" => FixedOperator::Reciprocal,
                    "fixed_negate" => FixedOperator::Negate,
                    "fixed_convert" => FixedOperator::Convert,
                    "fixed_shift_left" => FixedOperator::ShiftLeft { amount_bits },
                    "fixed_shift_right" => FixedOperator::ShiftRight { amount_bits },
                    _ => FixedOperator::Compare,
                };
                (a, result, operator)
            }
        };
        let configuration = FixedConfiguration {
            operator,
            a,
            b: fixed_format("--b-format", self.b_format, a)?,
            result,
            rounding: self.rounding.unwrap_or(Rounding::NearestEven),
            overflow: self.overflow.unwrap_or_default(),
            has_flags: self.flags,
            multiplier: self.multiplier.unwrap_or_default(),
        };
        configuration.check()?;
        Ok(ChosenOperator {
            configuration: configuration.into(),
            latency: self
                .latency
                .unwrap_or(OperatorLatencies::PAPER.of_fixed_operator(operator)),
        })
    }
}

/// A parser of values that are called by names.
fn named<T: Copy + Send + Sync + 'static, const COUNT: usize>(
    names: [&'static str; COUNT],
    values: [T; COUNT],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(names).try_map(move |name| {
        let known = names.iter().zip(values).find(|(known, _)| **known == name);
        known.map(|(_, value)| value).ok_or("no such value")
    })
}
