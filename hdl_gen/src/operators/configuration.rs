//! Everything that an operator's module depends on but its latency.

use std::sync::Arc;

#[cfg(doc)]
use rtl_model::float::Flags;
use rtl_model::float::{FloatFormat, Policy, Rounding};

use super::{FloatOperator, UnsupportedOperator};
use crate::netlist::{Builder, Module};
use crate::pipeline::{pipelined, without_unused};

/// What the product of two significands is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Multiplier {
    /// One `*`, which synthesis maps to a DSP block where the target has them.
    #[default]
    Dsp,
    /// Rows of adders in look-up tables, on every target.
    Logic,
}

/// The radix of a digit recurrence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Radix {
    /// One bit of the result a row.
    #[default]
    Two,
    /// Two bits of the result a row.
    Four,
    /// Two bits a row, but one in the middle of the recurrence, for a quarter of the bits: less area
    /// than radix 4, less delay than radix 2.
    Mixed,
}

/// How an operator is built: nothing here changes a bit of its results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Structure {
    /// Of multiplications.
    pub multiplier: Multiplier,
    /// Of divisions; a square root is of radix 2.
    pub radix: Radix,
}

/// An operator with its format, its rounding, its policy, whether it has flags, and how it is
/// built. With a latency it names one module.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct OperatorConfiguration {
    /// What it computes.
    pub operator: FloatOperator,
    /// Its numbers.
    pub format: FloatFormat,
    /// Its rounding, where it has one.
    pub rounding: Rounding,
    /// What it makes of subnormal numbers.
    pub policy: Policy,
    /// Has it the port `flags_o`, [`Flags::WIDTH`] bits in the order of [`Flags`]?
    pub has_flags: bool,
    /// How it is built.
    pub structure: Structure,
}

impl OperatorConfiguration {
    /// The hardware's default: policy `flush`, no flags, a DSP block, radix 2.
    pub fn new(
        operator: FloatOperator,
        format: FloatFormat,
        rounding: Rounding,
    ) -> OperatorConfiguration {
        OperatorConfiguration {
            operator,
            format,
            rounding,
            policy: Policy::Flush,
            has_flags: false,
            structure: Structure::default(),
        }
    }

    /// This policy in place of its own.
    pub fn with_policy(self, policy: Policy) -> OperatorConfiguration {
        OperatorConfiguration { policy, ..self }
    }

    /// With the port `flags_o`.
    pub fn with_flags(self) -> OperatorConfiguration {
        OperatorConfiguration {
            has_flags: true,
            ..self
        }
    }

    /// Built this way.
    pub fn with_structure(self, structure: Structure) -> OperatorConfiguration {
        OperatorConfiguration { structure, ..self }
    }

    /// Its module's name without the latency, on which no result depends: the operator, the
    /// format, its own parameters, what differs from the default, and the rounding where it has
    /// one, as in `float_add_e7f16_full_flags_rne`.
    pub fn name(self) -> String {
        let mut name = format!(
            "{}_{}{}",
            self.operator.name(),
            self.format,
            self.operator.parameters()
        );
        if self.policy == Policy::Full {
            name += "_full";
        }
        if self.has_flags {
            name += "_flags";
        }
        if self.structure.multiplier == Multiplier::Logic {
            name += "_logic";
        }
        if self.operator == FloatOperator::Divide {
            name += match self.structure.radix {
                Radix::Two => "",
                Radix::Four => "_radix4",
                Radix::Mixed => "_radix_mixed",
            };
        }
        if self.operator.rounds() {
            name += "_";
            name += self.rounding.name();
        }
        name
    }

    /// The name of its module in so many cycles, such as `float_add_e7f16_rne_l2`.
    pub fn module_name(self, latency: u32) -> String {
        format!("{}_l{latency}", self.name())
    }

    /// Can it be built?
    ///
    /// # Errors
    /// If a word of it would be wider than 64 bits, or a parameter is out of its range.
    pub fn check(self) -> Result<(), UnsupportedOperator> {
        self.operator.check(self.format)
    }

    /// Its module: combinational for latency 0, else a pipeline that takes new operands every
    /// cycle in which `enable_i` is 1 (see [`pipelined`]).
    ///
    /// # Panics
    /// Where [`OperatorConfiguration::check`] fails.
    pub fn build(self, latency: u32) -> Arc<Module> {
        if let Err(error) = self.check() {
            panic!("{error}");
        }
        let name = self.module_name(latency);
        let mut builder = Builder::new(&name);
        self.describe(&mut builder, latency);
        super::build(&mut builder, self);
        pipelined(&without_unused(&builder.finish()), latency, &name)
    }

    /// The header comment.
    fn describe(self, builder: &mut Builder, latency: u32) {
        let format = self.format;
        builder.describe(self.operator.formula());
        builder.describe(format!(
            "format: {format} (1 sign, {} exponent, {} fraction bits, bias {})",
            format.exponent_bits,
            format.fraction_bits,
            format.exponent_bias()
        ));
        if self.operator.rounds() {
            builder.describe(format!("rounding: {}", self.rounding));
        }
        builder.describe(match self.policy {
            Policy::Flush => {
                "policy: flush (subnormal operands and results are zeros of their sign)"
            }
            Policy::Full => "policy: full (subnormal numbers as in IEEE 754)",
        });
        builder.describe(format!("latency: {latency}"));
        builder.describe(format!(
            "golden: rtl_model::float::FloatArithmetic::{}",
            self.operator.golden()
        ));
    }
}
