// Conversions as the definition has them: integers to floats, floats to integers.

`default_nettype none

// a_i * 2^b_i, rounded once.
module plain_from_integer #(
    parameter EXPONENT_BITS = 7,
    parameter FRACTION_BITS = 16,
    parameter ROUNDING = 0,
    parameter FULL = 0,
    parameter VALUE_BITS = 24,
    parameter SCALE_BITS = 8
) (
    input  wire signed [VALUE_BITS-1:0]         a_i,
    input  wire signed [SCALE_BITS-1:0]         b_i,
    output wire [EXPONENT_BITS+FRACTION_BITS:0] result_o,
    output wire [4:0]                           flags_o
);
    localparam BIAS = (1 << (EXPONENT_BITS - 1)) - 1;
    localparam WIDEST = SCALE_BITS > EXPONENT_BITS ? SCALE_BITS : EXPONENT_BITS;
    localparam UNIT_BITS = WIDEST + 3 + $clog2(VALUE_BITS + FRACTION_BITS);
    wire [VALUE_BITS-1:0] magnitude = a_i[VALUE_BITS-1] ? -a_i : a_i;
    wire signed [UNIT_BITS-1:0] unit = {{UNIT_BITS-SCALE_BITS{b_i[SCALE_BITS-1]}}, b_i}
                                     + $signed(BIAS - 1 + FRACTION_BITS);
    plain_round #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .ROUNDING(ROUNDING),
                  .FULL(FULL), .WIDTH(VALUE_BITS), .UNIT_BITS(UNIT_BITS))
        round (.sign(a_i[VALUE_BITS-1]), .magnitude(magnitude), .unit(unit), .result(result_o), .flags(flags_o));
endmodule

// a_i, rounded once.
module plain_from_word #(
    parameter EXPONENT_BITS = 7,
    parameter FRACTION_BITS = 16,
    parameter ROUNDING = 0,
    parameter FULL = 0,
    parameter BITS = 24,
    parameter SIGNED = 1
) (
    input  wire [BITS-1:0]                      a_i,
    output wire [EXPONENT_BITS+FRACTION_BITS:0] result_o,
    output wire [4:0]                           flags_o
);
    localparam BIAS = (1 << (EXPONENT_BITS - 1)) - 1;
    localparam UNIT_BITS = EXPONENT_BITS + 3 + $clog2(BITS + FRACTION_BITS);
    wire sign = (SIGNED != 0) & a_i[BITS-1];
    wire [BITS-1:0] magnitude = sign ? -a_i : a_i;
    wire signed [UNIT_BITS-1:0] unit = BIAS - 1 + FRACTION_BITS;
    plain_round #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .ROUNDING(ROUNDING),
                  .FULL(FULL), .WIDTH(BITS), .UNIT_BITS(UNIT_BITS))
        round (.sign(sign), .magnitude(magnitude), .unit(unit), .result(result_o), .flags(flags_o));
endmodule

// A finite float as an integer and what is below its point, exactly.
module plain_point #(
    parameter EXPONENT_BITS = 7,
    parameter FRACTION_BITS = 16,
    parameter ROUNDING = 0,
    parameter WIDTH = 65
) (
    input  wire                     sign,
    input  wire [EXPONENT_BITS-1:0] field,
    input  wire [FRACTION_BITS:0]   significand,
    output wire [WIDTH-1:0]         integer_magnitude,  // rounded
    output wire                     inexact
);
    localparam BIAS = (1 << (EXPONENT_BITS - 1)) - 1;
    localparam BELOW = BIAS - 1 + FRACTION_BITS;  // places below the point of a smallest number
    wire [WIDTH+BELOW-1:0] exact = {{WIDTH+BELOW-FRACTION_BITS-1{1'b0}}, significand} << (field - 1'b1);
    wire [WIDTH-1:0] whole = exact[WIDTH+BELOW-1:BELOW];
    wire at_half = exact[BELOW-1];
    wire beyond = |exact[BELOW-2:0];
    assign inexact = at_half | beyond;
    wire away = (ROUNDING == 0) ? at_half & (beyond | whole[0])
              : (ROUNDING == 1) ? 1'b0
              : (ROUNDING == 2) ? inexact & ~sign
              :                   inexact & sign;
    assign integer_magnitude = whole + {{WIDTH-1{1'b0}}, away};
endmodule

// The integer a_i rounds to, saturated; 0 for NaN.
module plain_to_integer #(
    parameter EXPONENT_BITS = 7,
    parameter FRACTION_BITS = 16,
    parameter ROUNDING = 0,
    parameter FULL = 0,
    parameter BITS = 24,
    parameter SIGNED = 1
) (
    input  wire [EXPONENT_BITS+FRACTION_BITS:0] a_i,
    output wire [BITS-1:0]                      result_o,
    output wire [4:0]                           flags_o
);
    // The largest number's integer, and the integer's own range, whichever is wider.
    localparam LARGEST = (1 << (EXPONENT_BITS - 1)) + 1;
    localparam WIDTH = LARGEST > BITS ? LARGEST : BITS + 1;
    wire sign, is_infinite, is_nan;
    wire [EXPONENT_BITS-1:0] field;
    wire [FRACTION_BITS:0] significand;
    plain_number #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .FULL(FULL))
        a (.pattern(a_i), .sign(sign), .field(field), .significand(significand), .is_zero(),
           .is_infinite(is_infinite), .is_nan(is_nan), .is_signalling());
    wire [WIDTH-1:0] magnitude;
    wire inexact;
    plain_point #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .ROUNDING(ROUNDING), .WIDTH(WIDTH))
        point (.sign(sign), .field(field), .significand(significand), .integer_magnitude(magnitude), .inexact(inexact));
    wire [WIDTH-1:0] signed_limit = {{WIDTH-BITS+1{1'b0}}, {BITS-1{1'b1}}} + {{WIDTH-1{1'b0}}, sign};
    wire [WIDTH-1:0] unsigned_limit = sign ? {WIDTH{1'b0}} : {{WIDTH-BITS{1'b0}}, {BITS{1'b1}}};
    wire [WIDTH-1:0] limit = (SIGNED != 0) ? signed_limit : unsigned_limit;
    wire beyond = is_infinite | (magnitude > limit);
    wire [WIDTH-1:0] bounded = beyond ? limit : magnitude;
    wire [WIDTH-1:0] signed_value = sign ? -bounded : bounded;
    assign result_o = is_nan ? {BITS{1'b0}} : signed_value[BITS-1:0];
    assign flags_o = (is_nan | beyond) ? 5'b10000 : {4'b0, inexact};
endmodule

// The integer a_i rounds to, as a float.
module plain_round_to_integral #(
    parameter EXPONENT_BITS = 7,
    parameter FRACTION_BITS = 16,
    parameter ROUNDING = 0,
    parameter FULL = 0,
    parameter RAISES = 1  // inexact where the result is not a_i
) (
    input  wire [EXPONENT_BITS+FRACTION_BITS:0] a_i,
    output wire [EXPONENT_BITS+FRACTION_BITS:0] result_o,
    output wire [4:0]                           flags_o
);
    localparam BIAS = (1 << (EXPONENT_BITS - 1)) - 1;
    localparam LARGEST = (1 << (EXPONENT_BITS - 1)) + 1;
    localparam UNIT_BITS = EXPONENT_BITS + 4 + $clog2(FRACTION_BITS + 1);
    wire sign, is_zero, is_infinite, is_nan, is_signalling;
    wire [EXPONENT_BITS-1:0] field;
    wire [FRACTION_BITS:0] significand;
    plain_number #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .FULL(FULL))
        a (.pattern(a_i), .sign(sign), .field(field), .significand(significand), .is_zero(is_zero),
           .is_infinite(is_infinite), .is_nan(is_nan), .is_signalling(is_signalling));
    wire [LARGEST-1:0] magnitude;
    wire inexact;
    plain_point #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .ROUNDING(ROUNDING), .WIDTH(LARGEST))
        point (.sign(sign), .field(field), .significand(significand), .integer_magnitude(magnitude), .inexact(inexact));
    wire [EXPONENT_BITS+FRACTION_BITS:0] rounded;
    wire [4:0] rounded_flags;
    wire signed [UNIT_BITS-1:0] unit = BIAS - 1 + FRACTION_BITS;
    plain_round #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .ROUNDING(ROUNDING), .FULL(FULL),
                  .WIDTH(LARGEST), .UNIT_BITS(UNIT_BITS))
        round (.sign(sign), .magnitude(magnitude), .unit(unit), .result(rounded), .flags(rounded_flags));
    wire overflow = rounded_flags[2];
    assign result_o = is_nan ? {1'b0, {EXPONENT_BITS{1'b1}}, 1'b1, {FRACTION_BITS-1{1'b0}}}
                    : is_infinite ? {sign, {EXPONENT_BITS{1'b1}}, {FRACTION_BITS{1'b0}}}
                    : is_zero ? {sign, {EXPONENT_BITS+FRACTION_BITS{1'b0}}}
                    : rounded;
    assign flags_o = is_nan ? {is_signalling, 4'b0}
                   : (is_infinite | is_zero) ? 5'b0
                   : {2'b0, overflow, 1'b0, overflow | ((RAISES != 0) & inexact)};
endmodule

// a_i in another format, rounded once.
module plain_convert #(
    parameter EXPONENT_BITS = 7,
    parameter FRACTION_BITS = 16,
    parameter ROUNDING = 0,
    parameter FULL = 0,
    parameter TARGET_EXPONENT_BITS = 5,
    parameter TARGET_FRACTION_BITS = 10
) (
    input  wire [EXPONENT_BITS+FRACTION_BITS:0]               a_i,
    output wire [TARGET_EXPONENT_BITS+TARGET_FRACTION_BITS:0] result_o,
    output wire [4:0]                                         flags_o
);
    localparam BIAS = (1 << (EXPONENT_BITS - 1)) - 1;
    localparam TARGET_BIAS = (1 << (TARGET_EXPONENT_BITS - 1)) - 1;
    localparam WIDEST = TARGET_EXPONENT_BITS > EXPONENT_BITS ? TARGET_EXPONENT_BITS : EXPONENT_BITS;
    localparam UNIT_BITS = WIDEST + 4 + $clog2(FRACTION_BITS + TARGET_FRACTION_BITS);
    wire sign, is_infinite, is_nan, is_signalling;
    wire [EXPONENT_BITS-1:0] field;
    wire [FRACTION_BITS:0] significand;
    plain_number #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .FULL(FULL))
        a (.pattern(a_i), .sign(sign), .field(field), .significand(significand), .is_zero(),
           .is_infinite(is_infinite), .is_nan(is_nan), .is_signalling(is_signalling));
    wire signed [UNIT_BITS-1:0] unit = $signed({1'b0, field}) - (BIAS + FRACTION_BITS)
                                     + (TARGET_BIAS - 1 + TARGET_FRACTION_BITS);
    wire [TARGET_EXPONENT_BITS+TARGET_FRACTION_BITS:0] rounded;
    wire [4:0] rounded_flags;
    plain_round #(.EXPONENT_BITS(TARGET_EXPONENT_BITS), .FRACTION_BITS(TARGET_FRACTION_BITS), .ROUNDING(ROUNDING),
                  .FULL(FULL), .WIDTH(FRACTION_BITS + 1), .UNIT_BITS(UNIT_BITS))
        round (.sign(sign), .magnitude(significand), .unit(unit), .result(rounded), .flags(rounded_flags));
    assign result_o = is_nan ? {1'b0, {TARGET_EXPONENT_BITS{1'b1}}, 1'b1, {TARGET_FRACTION_BITS-1{1'b0}}}
                    : is_infinite ? {sign, {TARGET_EXPONENT_BITS{1'b1}}, {TARGET_FRACTION_BITS{1'b0}}}
                    : rounded;
    assign flags_o = (is_nan | is_infinite) ? {is_signalling, 4'b0} : rounded_flags;
endmodule

`default_nettype wire
