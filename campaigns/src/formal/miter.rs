//! The Verilog that asks whether a hardware operator and its plain specification can differ.

use std::fmt::Write;

use hdl_gen::netlist::Module;
use hdl_gen::operators::{FloatOperator, OperatorConfiguration};
use rtl_model::float::{Policy, Rounding};

/// The texts of the plain specifications, in the order in which they build on each other.
pub const SPECIFICATIONS: [(&str, &str); 8] = [
    ("plain_round.v", include_str!("../../formal/plain_round.v")),
    (
        "plain_number.v",
        include_str!("../../formal/plain_number.v"),
    ),
    ("plain_add.v", include_str!("../../formal/plain_add.v")),
    (
        "plain_multiply.v",
        include_str!("../../formal/plain_multiply.v"),
    ),
    (
        "plain_divide.v",
        include_str!("../../formal/plain_divide.v"),
    ),
    (
        "plain_square_root.v",
        include_str!("../../formal/plain_square_root.v"),
    ),
    (
        "plain_compare.v",
        include_str!("../../formal/plain_compare.v"),
    ),
    (
        "plain_integer.v",
        include_str!("../../formal/plain_integer.v"),
    ),
];

/// The name of every miter's module.
pub const MITER: &str = "miter";

/// The output that is 1 where the two differ.
pub const DIFFERS: &str = "differs";

/// An operator's plain specification: its module, and its parameters beside those of the format.
#[derive(Clone, Debug)]
pub struct Specification {
    /// The module's name.
    pub module: &'static str,
    /// Are rounding and policy among its parameters?
    rounds: bool,
    /// Parameters of the operator's own.
    parameters: Vec<(&'static str, u32)>,
}

impl Specification {
    /// That of an operator, where there is one.
    pub fn of(operator: FloatOperator) -> Option<Specification> {
        let (module, rounds, parameters) = match operator {
            FloatOperator::Add => ("plain_add", true, vec![("SUBTRACT", 0)]),
            FloatOperator::Subtract => ("plain_add", true, vec![("SUBTRACT", 1)]),
            FloatOperator::Multiply => ("plain_multiply", true, vec![]),
            FloatOperator::Divide => ("plain_divide", true, vec![]),
            FloatOperator::SquareRoot => ("plain_square_root", true, vec![]),
            FloatOperator::Compare => ("plain_compare", false, vec![("SIGNALLING", 0)]),
            FloatOperator::CompareSignalling => ("plain_compare", false, vec![("SIGNALLING", 1)]),
            FloatOperator::FromSigned { bits } => {
                ("plain_from_word", true, vec![("BITS", bits), ("SIGNED", 1)])
            }
            FloatOperator::FromUnsigned { bits } => {
                ("plain_from_word", true, vec![("BITS", bits), ("SIGNED", 0)])
            }
            FloatOperator::ToUnsigned { bits } => (
                "plain_to_integer",
                true,
                vec![("BITS", bits), ("SIGNED", 0)],
            ),
            FloatOperator::Convert { target } => (
                "plain_convert",
                true,
                vec![
                    ("TARGET_EXPONENT_BITS", target.exponent_bits),
                    ("TARGET_FRACTION_BITS", target.fraction_bits),
                ],
            ),
            FloatOperator::RoundToIntegral => {
                ("plain_round_to_integral", true, vec![("RAISES", 1)])
            }
            FloatOperator::FromInteger {
                value_bits,
                exponent_bits,
            } => (
                "plain_from_integer",
                true,
                vec![("VALUE_BITS", value_bits), ("SCALE_BITS", exponent_bits)],
            ),
            FloatOperator::ToInteger { bits } => ("plain_to_integer", true, vec![("BITS", bits)]),
            FloatOperator::Floor => (
                "plain_round_to_integral",
                false,
                vec![("ROUNDING", 3), ("RAISES", 0)],
            ),
            _ => return None,
        };
        Some(Specification {
            module,
            rounds,
            parameters,
        })
    }

    /// Has it this output?
    pub fn has_output(&self, port: &str) -> bool {
        match self.module {
            "plain_compare" => matches!(
                port,
                "less_than_o" | "less_equal_o" | "equal_o" | "unordered_o" | "flags_o"
            ),
            _ => matches!(port, "result_o" | "flags_o"),
        }
    }

    /// The parameters in Verilog, `#(...)`.
    fn parameters(&self, configuration: OperatorConfiguration) -> String {
        let mut text = format_parameters(configuration);
        if self.rounds {
            let _ = write!(
                text,
                ", .ROUNDING({})",
                rounding_number(configuration.rounding)
            );
        }
        for (name, value) in &self.parameters {
            let _ = write!(text, ", .{name}({value})");
        }
        text
    }
}

/// The number that the specifications know a rounding by.
fn rounding_number(rounding: Rounding) -> u32 {
    match rounding {
        Rounding::NearestEven => 0,
        Rounding::TowardZero => 1,
        Rounding::Up => 2,
        Rounding::Down => 3,
    }
}

fn format_parameters(configuration: OperatorConfiguration) -> String {
    format!(
        ".EXPONENT_BITS({}), .FRACTION_BITS({}), .FULL({})",
        configuration.format.exponent_bits,
        configuration.format.fraction_bits,
        u32::from(configuration.policy == Policy::Full),
    )
}

/// Name and width of a module's ports.
fn inputs(module: &Module) -> Vec<(String, u32)> {
    let ports = module.inputs.iter().map(|&wire| module.node(wire));
    ports
        .map(|node| (node.name.clone().unwrap_or_default(), node.width))
        .collect()
}

fn outputs(module: &Module) -> Vec<(String, u32)> {
    let ports = module.outputs.iter();
    ports
        .map(|(name, wire)| (name.clone(), module.width(*wire)))
        .collect()
}

/// The instance of the hardware, its results and those of the specification on wires of their
/// own, and which of them differ.
fn comparison(hardware: &Module, plain: &str, condition: &str) -> String {
    let mut text = String::new();
    let mut ports = Vec::new();
    for (name, _) in inputs(hardware) {
        ports.push(format!(".{name}({name})"));
    }
    for (name, width) in outputs(hardware) {
        let _ = writeln!(
            text,
            "    wire [{}:0] found_{name}, wanted_{name};",
            width - 1
        );
        ports.push(format!(".{name}(found_{name})"));
    }
    let _ = writeln!(
        text,
        "    {} hardware ({});",
        hardware.name,
        ports.join(", ")
    );
    text += plain;
    let differences: Vec<String> = outputs(hardware)
        .iter()
        .map(|(name, _)| format!("(found_{name} != wanted_{name})"))
        .collect();
    let _ = writeln!(
        text,
        "    assign {DIFFERS} = {condition} & ({});",
        differences.join(" | ")
    );
    for (name, _) in inputs(hardware) {
        let _ = writeln!(text, "    assign operand_{name} = {name};");
    }
    for (name, _) in outputs(hardware) {
        let _ = writeln!(text, "    assign hardware_{name} = found_{name};");
        let _ = writeln!(text, "    assign plain_{name} = wanted_{name};");
    }
    text
}

/// The ports by which a difference is read: operands, and both sides' results.
fn witness_ports(hardware: &Module) -> String {
    let mut text = String::new();
    for (name, width) in inputs(hardware) {
        let _ = write!(text, ",\n    output wire [{}:0] operand_{name}", width - 1);
    }
    for (name, width) in outputs(hardware) {
        let _ = write!(
            text,
            ",\n    output wire [{0}:0] hardware_{name}, plain_{name}",
            width - 1
        );
    }
    text
}

/// Any operands whatever: hardware and specification side by side.
pub fn whole(
    configuration: OperatorConfiguration,
    specification: &Specification,
    hardware: &Module,
) -> String {
    let mut text = format!("module {MITER} (\n");
    for (name, width) in inputs(hardware) {
        let _ = writeln!(text, "    input wire [{}:0] {name},", width - 1);
    }
    let _ = write!(
        text,
        "    output wire {DIFFERS}{}\n);\n",
        witness_ports(hardware)
    );
    let mut ports = Vec::new();
    for (port, (name, _)) in ["a_i", "b_i"].into_iter().zip(inputs(hardware)) {
        ports.push(format!(".{port}({name})"));
    }
    for (name, _) in outputs(hardware) {
        ports.push(format!(".{name}(wanted_{name})"));
    }
    let plain = format!(
        "    {} #({}) plain ({});\n",
        specification.module,
        specification.parameters(configuration),
        ports.join(", ")
    );
    text += &comparison(hardware, &plain, "1'b1");
    text + "endmodule\n"
}

/// The operands of a sum of finite numbers, told apart by what makes a case of the proof: which is
/// the larger, by how much, and the exponent of the smaller.
fn case_module(configuration: OperatorConfiguration) -> String {
    let (e, f) = (
        configuration.format.exponent_bits,
        configuration.format.fraction_bits,
    );
    let top = e + f;
    let subtract = u32::from(configuration.operator == FloatOperator::Subtract);
    let full = u32::from(configuration.policy == Policy::Full);
    format!(
        "// Two finite operands, the signs those of the terms of the sum.
module sum_case (
    input wire swap,
    input wire [{e1}:0] smaller_field, difference,
    input wire larger_sign, smaller_sign, larger_hidden, smaller_hidden,
    input wire [{f1}:0] larger_fraction, smaller_fraction,
    output wire valid,
    output wire [{f}:0] larger_significand, smaller_significand,
    output wire [{top}:0] a_i, b_i
);
    wire [{e}:0] larger_field = {{1'b0, smaller_field}} + {{1'b0, difference}};
    assign valid = (smaller_field != 0) & (larger_field < {all_ones})
                 & (smaller_hidden | (smaller_field == 1)) & (larger_hidden | (larger_field == 1));
    assign larger_significand = {{larger_hidden, (larger_hidden | {full}) ? larger_fraction : {f}'d0}};
    assign smaller_significand = {{smaller_hidden, (smaller_hidden | {full}) ? smaller_fraction : {f}'d0}};
    wire [{top1}:0] larger = {{larger_hidden ? larger_field[{e1}:0] : {e}'d0, larger_fraction}};
    wire [{top1}:0] smaller = {{smaller_hidden ? smaller_field : {e}'d0, smaller_fraction}};
    assign a_i = swap ? {{smaller_sign, smaller}} : {{larger_sign, larger}};
    assign b_i = swap ? {{larger_sign ^ 1'd{subtract}, larger}} : {{smaller_sign ^ 1'd{subtract}, smaller}};
endmodule
",
        e1 = e - 1,
        f1 = f - 1,
        top1 = top - 1,
        all_ones = (1_u32 << e) - 1,
    )
}

/// What both miters of a sum of finite numbers have in common: the case's inputs and its operands.
fn case_wires(configuration: OperatorConfiguration) -> String {
    let top = configuration.format.width() - 1;
    let f = configuration.format.fraction_bits;
    format!(
        "    wire valid;
    wire [{top}:0] a_i, b_i;
    wire [{f}:0] larger_significand, smaller_significand;
    sum_case operands (.swap(swap), .smaller_field(smaller_field), .difference(difference),
        .larger_sign(larger_sign), .smaller_sign(smaller_sign), .larger_hidden(larger_hidden),
        .smaller_hidden(smaller_hidden), .larger_fraction(larger_fraction),
        .smaller_fraction(smaller_fraction), .valid(valid), .larger_significand(larger_significand),
        .smaller_significand(smaller_significand), .a_i(a_i), .b_i(b_i));
"
    )
}

/// The sum of two finite numbers, case by case.
pub fn finite_sum(configuration: OperatorConfiguration, hardware: &Module) -> String {
    let (e, f) = (
        configuration.format.exponent_bits,
        configuration.format.fraction_bits,
    );
    let mut text = case_module(configuration);
    let _ = write!(
        text,
        "module {MITER} (
    input wire swap,
    input wire [{e1}:0] smaller_field, difference,
    input wire larger_sign, smaller_sign, larger_hidden, smaller_hidden,
    input wire [{f1}:0] larger_fraction, smaller_fraction,
    output wire {DIFFERS}{ports}
);
{wires}",
        e1 = e - 1,
        f1 = f - 1,
        ports = witness_ports(hardware),
        wires = case_wires(configuration),
    );
    let has_flags = hardware.output("flags_o").is_some();
    let flags = if has_flags { "wanted_flags_o" } else { "" };
    let plain = format!(
        "    plain_sum #({}, .ROUNDING({})) plain (.larger_sign(larger_sign), \
         .larger_significand(larger_significand), .smaller_sign(smaller_sign), \
         .smaller_significand(smaller_significand), .smaller_field(smaller_field), \
         .difference(difference), .result(wanted_result_o), .flags({flags}));\n",
        format_parameters(configuration),
        rounding_number(configuration.rounding),
    );
    text += &comparison(hardware, &plain, "valid");
    text + "endmodule\n"
}

/// That every pair of finite operands is one of the cases of [`finite_sum`], and that the
/// specification hands the very terms of that case to its sum.
pub fn sum_coverage(configuration: OperatorConfiguration) -> String {
    let (e, f) = (
        configuration.format.exponent_bits,
        configuration.format.fraction_bits,
    );
    let parameters = format_parameters(configuration);
    let subtract = u32::from(configuration.operator == FloatOperator::Subtract);
    let mut text = case_module(configuration);
    let _ = write!(
        text,
        "module {MITER} (
    input wire [{top}:0] a_given, b_given,
    output wire {DIFFERS},
    output wire [{top}:0] operand_a_i, operand_b_i
);
    // As plain_add takes its operands apart.
    wire [{top}:0] b_added = b_given ^ {{1'd{subtract}, {top}'d0}};
    wire a_sign, b_sign, a_infinite, b_infinite, a_nan, b_nan, swap;
    wire [{e1}:0] a_field, b_field, smaller_field, difference;
    wire [{f}:0] a_significand, b_significand;
    plain_number #({parameters})
        a (.pattern(a_given), .sign(a_sign), .field(a_field), .significand(a_significand), .is_zero(),
           .is_infinite(a_infinite), .is_nan(a_nan), .is_signalling()),
        b (.pattern(b_added), .sign(b_sign), .field(b_field), .significand(b_significand), .is_zero(),
           .is_infinite(b_infinite), .is_nan(b_nan), .is_signalling());
    plain_order #(.EXPONENT_BITS({e}))
        order (.a_field(a_field), .b_field(b_field), .swap(swap), .smaller(smaller_field), .difference(difference));
    wire larger_sign = swap ? b_sign : a_sign;
    wire smaller_sign = swap ? a_sign : b_sign;
    wire [{top}:0] larger = swap ? b_given : a_given;
    wire [{top}:0] smaller = swap ? a_given : b_given;
    wire larger_hidden = |larger[{top1}:{f}];
    wire smaller_hidden = |smaller[{top1}:{f}];
    wire [{f1}:0] larger_fraction = larger[{f1}:0];
    wire [{f1}:0] smaller_fraction = smaller[{f1}:0];
{wires}    wire covered = valid & (difference <= {largest}) & (a_i == a_given) & (b_i == b_given)
        & (larger_significand == (swap ? b_significand : a_significand))
        & (smaller_significand == (swap ? a_significand : b_significand));
    assign {DIFFERS} = ~(a_infinite | b_infinite | a_nan | b_nan) & ~covered;
    assign operand_a_i = a_given;
    assign operand_b_i = b_given;
endmodule
",
        top = e + f,
        top1 = e + f - 1,
        e1 = e - 1,
        f1 = f - 1,
        largest = largest_difference(configuration),
        wires = case_wires(configuration),
    );
    text
}

/// How far the exponents of finite numbers can be apart.
pub fn largest_difference(configuration: OperatorConfiguration) -> u32 {
    (1 << configuration.format.exponent_bits) - 3
}
