//! Every operator there is, in every rounding it has.

use hdl_gen::operators::FloatOperator;
use rtl_model::float::{FloatFormat, Rounding};

/// All operators of a format, each in all four roundings where its result depends on one, else
/// once. Widths that are a parameter are those of the format's own words, or of a byte.
pub fn every_operator(format: FloatFormat) -> Vec<(FloatOperator, Rounding)> {
    let bits = format.width();
    let operators = [
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
            value_bits: bits,
            exponent_bits: 8,
        },
        FloatOperator::FromSigned { bits },
        FloatOperator::FromUnsigned { bits },
        FloatOperator::ToInteger { bits },
        FloatOperator::ToUnsigned { bits },
        FloatOperator::Convert {
            target: FloatFormat::new(4, 2),
        },
        FloatOperator::RoundToIntegral,
        FloatOperator::Floor,
        FloatOperator::UlpsUp { ulps: 3 },
        FloatOperator::ExactBelow,
        FloatOperator::DepthFromHeight { bits: 8 },
    ];
    let in_its_roundings = |operator: FloatOperator| {
        let roundings = match operator.rounds() {
            true => Rounding::ALL.as_slice(),
            false => &[Rounding::NearestEven],
        };
        roundings.iter().map(move |&rounding| (operator, rounding))
    };
    operators.into_iter().flat_map(in_its_roundings).collect()
}
