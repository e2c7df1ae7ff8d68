// Multiplication as the definition has it: the exact product, rounded once.

`default_nettype none

module plain_multiply #(
    parameter EXPONENT_BITS = 4,
    parameter FRACTION_BITS = 3,
    parameter ROUNDING = 0,
    parameter FULL = 0
) (
    input  wire [EXPONENT_BITS+FRACTION_BITS:0] a_i,
    input  wire [EXPONENT_BITS+FRACTION_BITS:0] b_i,
    output wire [EXPONENT_BITS+FRACTION_BITS:0] result_o,
    output wire [4:0]                           flags_o
);
    localparam BIAS = (1 << (EXPONENT_BITS - 1)) - 1;
    localparam WIDTH = 2 * FRACTION_BITS + 2;
    localparam UNIT_BITS = EXPONENT_BITS + 3 + $clog2(WIDTH);
    wire a_sign, a_zero, a_infinite, a_nan, a_signalling, b_sign, b_zero, b_infinite, b_nan, b_signalling;
    wire [EXPONENT_BITS-1:0] a_field, b_field;
    wire [FRACTION_BITS:0] a_significand, b_significand;
    plain_number #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .FULL(FULL))
        a (.pattern(a_i), .sign(a_sign), .field(a_field), .significand(a_significand), .is_zero(a_zero),
           .is_infinite(a_infinite), .is_nan(a_nan), .is_signalling(a_signalling)),
        b (.pattern(b_i), .sign(b_sign), .field(b_field), .significand(b_significand), .is_zero(b_zero),
           .is_infinite(b_infinite), .is_nan(b_nan), .is_signalling(b_signalling));
    wire [WIDTH-1:0] product = {{FRACTION_BITS+1{1'b0}}, a_significand} * {{FRACTION_BITS+1{1'b0}}, b_significand};
    // 1.0 is 2^FRACTION_BITS at the field BIAS, in units of 2^(1 - BIAS - FRACTION_BITS).
    wire signed [UNIT_BITS-1:0] unit = $signed({1'b0, a_field}) + $signed({1'b0, b_field}) - (BIAS + FRACTION_BITS + 1);
    wire sign = a_sign ^ b_sign;
    wire [EXPONENT_BITS+FRACTION_BITS:0] rounded;
    wire [4:0] rounded_flags;
    plain_round #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .ROUNDING(ROUNDING),
                  .FULL(FULL), .WIDTH(WIDTH), .UNIT_BITS(UNIT_BITS))
        round (.sign(sign), .magnitude(product), .unit(unit), .result(rounded), .flags(rounded_flags));
    wire no_product = (a_zero & b_infinite) | (a_infinite & b_zero);
    wire is_nan = a_nan | b_nan | no_product;
    wire is_infinite = a_infinite | b_infinite;
    wire invalid = a_signalling | b_signalling | (no_product & ~a_nan & ~b_nan);
    assign result_o = is_nan ? {1'b0, {EXPONENT_BITS{1'b1}}, 1'b1, {FRACTION_BITS-1{1'b0}}}
                    : is_infinite ? {sign, {EXPONENT_BITS{1'b1}}, {FRACTION_BITS{1'b0}}}
                    : rounded;
    assign flags_o = (is_nan | is_infinite) ? {invalid, 4'b0} : rounded_flags;
endmodule

`default_nettype wire
