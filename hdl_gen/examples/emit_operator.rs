//! Emits one operator into a folder.
//!
//! `emit_operator FOLDER OPERATOR FORMAT ROUNDING LATENCY [full] [flags] [logic] [radix4 | mixed]`, such as
//! `emit_operator /tmp/add add e7f16 rne 2`.

use hdl_gen::emit::write_design;
use hdl_gen::operators::{FloatOperator, Multiplier, OperatorConfiguration, Radix};
use rtl_model::float::{FloatFormat, Policy, Rounding};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, operator, format, rounding, latency, options @ ..] = &arguments[..] else {
        return Err(
            "usage: emit_operator FOLDER OPERATOR FORMAT ROUNDING LATENCY \
                    [full] [flags] [logic] [radix4 | mixed]"
                .into(),
        );
    };
    let operator = match operator.as_str() {
        "add" => FloatOperator::Add,
        "sub" => FloatOperator::Subtract,
        "mul" => FloatOperator::Multiply,
        "div" => FloatOperator::Divide,
        "cmp" => FloatOperator::Compare,
        other => return Err(format!("unknown operator `{other}`: add, sub, mul or div").into()),
    };
    let widths = format
        .strip_prefix('e')
        .and_then(|text| text.split_once('f'));
    let (exponent_bits, fraction_bits) = widths.ok_or("a format is e<bits>f<bits>")?;
    let format = FloatFormat::new(exponent_bits.parse()?, fraction_bits.parse()?);
    let rounding: Rounding = rounding.parse()?;
    let mut configuration = OperatorConfiguration::new(operator, format, rounding);
    for option in options {
        match option.as_str() {
            "full" => configuration.policy = Policy::Full,
            "flags" => configuration.has_flags = true,
            "logic" => configuration.structure.multiplier = Multiplier::Logic,
            "radix4" => configuration.structure.radix = Radix::Four,
            "mixed" => configuration.structure.radix = Radix::Mixed,
            other => {
                return Err(format!(
                    "unknown option `{other}`: full, flags, logic, radix4 or mixed"
                )
                .into());
            }
        }
    }
    configuration.check()?;
    for file in write_design(&configuration.build(latency.parse()?), folder.as_ref())? {
        println!("{}", file.display());
    }
    Ok(())
}
