//! The units by the names the command line has for them.

use anyhow::bail;

use hdl_gen::operators::FloatOperator;
use rtl_model::fixed::FixedFormat;
use rtl_model::float::FloatFormat;
use rtl_model::scene::WalkFormat;
use rtl_model::units::traverse_step::{EXACT_EXIT_ULPS, INDEX_BITS, LEVEL_BITS};

use crate::options::NumberFormat;

/// The operators, with the parameters the traverse unit has them with.
pub const OPERATORS: [FloatOperator; 22] = [
    FloatOperator::Add,
    FloatOperator::Subtract,
    FloatOperator::Multiply,
    FloatOperator::Divide,
    FloatOperator::SquareRoot,
    FloatOperator::Minimum,
    FloatOperator::Maximum,
    FloatOperator::Compare,
    FloatOperator::CompareSignalling,
    FloatOperator::LessThan,
    FloatOperator::LessEqual,
    FloatOperator::FromInteger {
        value_bits: INDEX_BITS + 1,
        exponent_bits: LEVEL_BITS + 2,
    },
    FloatOperator::FromSigned { bits: 32 },
    FloatOperator::FromUnsigned { bits: 32 },
    FloatOperator::ToInteger { bits: INDEX_BITS },
    FloatOperator::ToUnsigned { bits: 32 },
    FloatOperator::Convert {
        target: FloatFormat::new(8, 23),
    },
    FloatOperator::RoundToIntegral,
    FloatOperator::Floor,
    FloatOperator::UlpsUp {
        ulps: EXACT_EXIT_ULPS,
    },
    FloatOperator::ExactBelow,
    FloatOperator::DepthFromHeight { bits: 8 },
];

/// The names of the fixed-point operators.
pub const FIXED_OPERATORS: [&str; 12] = [
    "fixed_add",
    "fixed_sub",
    "fixed_mul",
    "fixed_div",
    "fixed_reciprocal",
    "fixed_negate",
    "fixed_convert",
    "fixed_shift_left",
    "fixed_shift_right",
    "fixed_cmp",
    "fixed_from_float",
    "fixed_to_float",
];

/// The float operator of this name.
pub fn named_operator(name: &str) -> anyhow::Result<FloatOperator> {
    let found = OPERATORS
        .into_iter()
        .find(|operator| operator.name() == name);
    let Some(operator) = found else {
        let names = OPERATORS.map(FloatOperator::name).join(", ");
        let fixed = FIXED_OPERATORS.join(", ");
        bail!("--unit {name}: unknown; the units are {names}, {fixed}, traverse_step, traverse");
    };
    Ok(operator)
}

/// The format of a unit of floats: e7f16 unless told.
pub fn float_format(chosen: Option<NumberFormat>) -> anyhow::Result<FloatFormat> {
    match chosen {
        None => Ok(FloatFormat::E7F16),
        Some(NumberFormat::Walk(WalkFormat::Float(format))) => Ok(format),
        Some(NumberFormat::Walk(other)) => {
            bail!("format {other} has no hardware: take a float eXfY, such as e7f16")
        }
        Some(NumberFormat::Fixed(format)) => bail!(
            "format {format}: this unit computes with floats; take eXfY, such as e7f16, or a \
             fixed-point operator, such as --unit fixed_mul"
        ),
    }
}

/// The format of fixed-point operands or results: what is told, or another's.
pub fn fixed_format(
    option: &str,
    chosen: Option<NumberFormat>,
    otherwise: FixedFormat,
) -> anyhow::Result<FixedFormat> {
    match chosen {
        None => Ok(otherwise),
        Some(NumberFormat::Fixed(format)) => Ok(format),
        Some(NumberFormat::Walk(format)) => {
            bail!("{option} {format}: take a fixed-point format qI.F or uqI.F, such as q4.12")
        }
    }
}
