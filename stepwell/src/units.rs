//! The units by the names the command line has for them.

use anyhow::bail;

use hdl_gen::operators::FloatOperator;
use rtl_model::float::FloatFormat;
use rtl_model::scene::WalkFormat;
use rtl_model::units::traverse_step::{EXACT_EXIT_ULPS, INDEX_BITS, LEVEL_BITS};

/// The operators, with the parameters the traverse unit has them with.
pub const OPERATORS: [FloatOperator; 13] = [
    FloatOperator::Add,
    FloatOperator::Subtract,
    FloatOperator::Multiply,
    FloatOperator::Divide,
    FloatOperator::Compare,
    FloatOperator::LessThan,
    FloatOperator::LessEqual,
    FloatOperator::FromInteger {
        value_bits: INDEX_BITS + 1,
        exponent_bits: LEVEL_BITS + 2,
    },
    FloatOperator::ToInteger { bits: INDEX_BITS },
    FloatOperator::Floor,
    FloatOperator::UlpsUp {
        ulps: EXACT_EXIT_ULPS,
    },
    FloatOperator::ExactBelow,
    FloatOperator::DepthFromHeight { bits: 8 },
];

/// The operator of this name.
pub fn named_operator(name: &str) -> anyhow::Result<FloatOperator> {
    let found = OPERATORS
        .into_iter()
        .find(|operator| operator.name() == name);
    let Some(operator) = found else {
        let names = OPERATORS.map(FloatOperator::name).join(", ");
        bail!("--unit {name}: unknown; the units are {names}, traverse_step, traverse");
    };
    Ok(operator)
}

/// The format of a unit: e7f16 unless told, and always a float.
pub fn float_format(chosen: Option<WalkFormat>) -> anyhow::Result<FloatFormat> {
    match chosen {
        None => Ok(FloatFormat::E7F16),
        Some(WalkFormat::Float(format)) => Ok(format),
        Some(other) => bail!("format {other} has no hardware: take a float eXfY, such as e7f16"),
    }
}
