// Addition as the definition has it: both operands on one scale, exactly; their sum, exactly;
// rounded once.

`default_nettype none

// The operand of the larger exponent first, and how far apart they are.
module plain_order #(
    parameter EXPONENT_BITS = 7
) (
    input  wire [EXPONENT_BITS-1:0] a_field,
    input  wire [EXPONENT_BITS-1:0] b_field,
    output wire                     swap,        // b's is the larger
    output wire [EXPONENT_BITS-1:0] smaller,
    output wire [EXPONENT_BITS-1:0] difference
);
    assign swap = a_field < b_field;
    assign smaller = swap ? a_field : b_field;
    assign difference = swap ? b_field - a_field : a_field - b_field;
endmodule

// The sum of two finite numbers, the first with the exponent that is `difference` larger.
module plain_sum #(
    parameter EXPONENT_BITS = 7,
    parameter FRACTION_BITS = 16,
    parameter ROUNDING = 0,
    parameter FULL = 0
) (
    input  wire                                 larger_sign,
    input  wire [FRACTION_BITS:0]               larger_significand,
    input  wire                                 smaller_sign,
    input  wire [FRACTION_BITS:0]               smaller_significand,
    input  wire [EXPONENT_BITS-1:0]             smaller_field,
    input  wire [EXPONENT_BITS-1:0]             difference,
    output wire [EXPONENT_BITS+FRACTION_BITS:0] result,
    output wire [4:0]                           flags
);
    // The largest difference, the significand, a carry and a sign.
    localparam WIDTH = (1 << EXPONENT_BITS) - 3 + FRACTION_BITS + 3;
    localparam UNIT_BITS = EXPONENT_BITS + 2;
    wire signed [WIDTH-1:0] larger = {{WIDTH-FRACTION_BITS-1{1'b0}}, larger_significand} << difference;
    wire signed [WIDTH-1:0] smaller = {{WIDTH-FRACTION_BITS-1{1'b0}}, smaller_significand};
    wire signed [WIDTH-1:0] sum = (larger_sign ? -larger : larger) + (smaller_sign ? -smaller : smaller);
    wire is_zero = ~|sum;
    wire signs_differ = larger_sign ^ smaller_sign;
    wire zero_sign = signs_differ ? (ROUNDING == 3) : larger_sign;
    wire sign = is_zero ? zero_sign : sum[WIDTH-1];
    wire [WIDTH-1:0] magnitude = sum[WIDTH-1] ? -sum : sum;
    plain_round #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .ROUNDING(ROUNDING),
                  .FULL(FULL), .WIDTH(WIDTH), .UNIT_BITS(UNIT_BITS))
        round (.sign(sign), .magnitude(magnitude),
               .unit($signed({2'b00, smaller_field}) - $signed({{UNIT_BITS-1{1'b0}}, 1'b1})),
               .result(result), .flags(flags));
endmodule

module plain_add #(
    parameter EXPONENT_BITS = 7,
    parameter FRACTION_BITS = 16,
    parameter ROUNDING = 0,
    parameter FULL = 0,
    parameter SUBTRACT = 0
) (
    input  wire [EXPONENT_BITS+FRACTION_BITS:0] a_i,
    input  wire [EXPONENT_BITS+FRACTION_BITS:0] b_i,
    output wire [EXPONENT_BITS+FRACTION_BITS:0] result_o,
    output wire [4:0]                           flags_o
);
    localparam WIDTH = 1 + EXPONENT_BITS + FRACTION_BITS;
    wire [WIDTH-1:0] b_added = b_i ^ {SUBTRACT != 0, {WIDTH-1{1'b0}}};
    wire a_sign, a_infinite, a_nan, a_signalling, b_sign, b_infinite, b_nan, b_signalling;
    wire [EXPONENT_BITS-1:0] a_field, b_field, smaller_field, difference;
    wire [FRACTION_BITS:0] a_significand, b_significand;
    wire swap;
    plain_number #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .FULL(FULL))
        a (.pattern(a_i), .sign(a_sign), .field(a_field), .significand(a_significand), .is_zero(),
           .is_infinite(a_infinite), .is_nan(a_nan), .is_signalling(a_signalling)),
        b (.pattern(b_added), .sign(b_sign), .field(b_field), .significand(b_significand), .is_zero(),
           .is_infinite(b_infinite), .is_nan(b_nan), .is_signalling(b_signalling));
    plain_order #(.EXPONENT_BITS(EXPONENT_BITS))
        order (.a_field(a_field), .b_field(b_field), .swap(swap), .smaller(smaller_field), .difference(difference));
    wire [WIDTH-1:0] sum;
    wire [4:0] sum_flags;
    plain_sum #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .ROUNDING(ROUNDING), .FULL(FULL))
        finite (.larger_sign(swap ? b_sign : a_sign), .larger_significand(swap ? b_significand : a_significand),
                .smaller_sign(swap ? a_sign : b_sign), .smaller_significand(swap ? a_significand : b_significand),
                .smaller_field(smaller_field), .difference(difference), .result(sum), .flags(sum_flags));
    wire is_nan = a_nan | b_nan | (a_infinite & b_infinite & (a_sign ^ b_sign));
    wire is_infinite = a_infinite | b_infinite;
    wire invalid = a_signalling | b_signalling | (is_nan & ~a_nan & ~b_nan);
    assign result_o = is_nan ? {1'b0, {EXPONENT_BITS{1'b1}}, 1'b1, {FRACTION_BITS-1{1'b0}}}
                    : is_infinite ? {a_infinite ? a_sign : b_sign, {EXPONENT_BITS{1'b1}}, {FRACTION_BITS{1'b0}}}
                    : sum;
    assign flags_o = (is_nan | is_infinite) ? {invalid, 4'b0} : sum_flags;
endmodule

`default_nettype wire
