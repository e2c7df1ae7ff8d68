//! The options that say which operator, shared by all commands that take `--unit`.

use anyhow::bail;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use hdl_gen::datapath::OperatorLatencies;
use hdl_gen::operators::{Multiplier, OperatorConfiguration, Radix, Structure};
use rtl_model::float::{FloatFormat, Policy, Rounding};

use crate::units::named_operator;

/// The longest latency a person may ask for, in cycles.
const MAX_LATENCY: i64 = 32;

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

    /// Of an operator: its cycles; the paper's budget unless told
    #[arg(long, value_name = "CYCLES",
        value_parser = clap::value_parser!(u32).range(1..=MAX_LATENCY))]
    latency: Option<u32>,

    /// Of an operator: what multiplies significands, a DSP block (unless told) or logic
    #[arg(long, value_name = "MULTIPLIER",
        value_parser = named(["dsp", "logic"], [Multiplier::Dsp, Multiplier::Logic]))]
    multiplier: Option<Multiplier>,

    /// Of an operator: the radix of divisions and square roots, 2 (unless told) or 4
    #[arg(long, value_name = "RADIX",
        value_parser = named(["2", "4"], [Radix::Two, Radix::Four]))]
    radix: Option<Radix>,
}

/// An operator that is asked for, and that there is.
#[derive(Clone, Copy, Debug)]
pub struct ChosenOperator {
    /// All but the latency.
    pub configuration: OperatorConfiguration,
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
        let given = [
            ("--rounding", self.rounding.is_some()),
            ("--policy", self.policy.is_some()),
            ("--flags", self.flags),
            ("--latency", self.latency.is_some()),
            ("--multiplier", self.multiplier.is_some()),
            ("--radix", self.radix.is_some()),
        ];
        match given.iter().find(|(_, given)| *given) {
            Some((option, _)) => bail!(
                "{option} is of operators, and {subject} is none: leave it out, or name an \
                 operator with --unit, such as --unit float_add"
            ),
            None => Ok(()),
        }
    }

    /// The operator of this name in this format, as the options have it.
    ///
    /// # Errors
    /// If there is no such operator, or none of this kind.
    pub fn choose(&self, name: &str, format: FloatFormat) -> anyhow::Result<ChosenOperator> {
        let operator = named_operator(name)?;
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
            configuration,
            latency: self
                .latency
                .unwrap_or(OperatorLatencies::PAPER.of_operator(operator)),
        })
    }
}

/// A parser of values that are called by names.
fn named<T: Copy + Send + Sync + 'static>(
    names: [&'static str; 2],
    values: [T; 2],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(names).try_map(move |name| {
        let known = names.iter().zip(values).find(|(known, _)| **known == name);
        known.map(|(_, value)| value).ok_or("no such value")
    })
}
