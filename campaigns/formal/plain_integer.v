// Conversions as the definition has them: integers to floats, floats to integers.

`default_nettype none

// value_i * 2^exponent_i, rounded once.
module plain_from_integer #(
    parameter EXPONENT_BITS = 7,
    parameter FRACTION_BITS = 16,
    parameter ROUNDING = 0,
    parameter FULL = 0,
    parameter VALUE_BITS = 24,
    parameter SCALE_BITS = 8
) (
    input  wire signed [VALUE_BITS-1:0]         value_i,
    input  wire signed [SCALE_BITS-1:0]         exponent_i,
    output wire [EXPONENT_BITS+FRACTION_BITS:0] result_o,
    output wire [4:0]                           flags_o
);
    localparam BIAS = (1 << (EXPONENT_BITS - 1)) - 1;
    localparam WIDEST = SCALE_BITS > EXPONENT_BITS ? SCALE_BITS : EXPONENT_BITS;
    localparam UNIT_BITS = WIDEST + 3 + $clog2(VALUE_BITS + FRACTION_BITS);
    wire [VALUE_BITS-1:0] magnitude = value_i[VALUE_BITS-1] ? -value_i : value_i;
    wire signed [UNIT_BITS-1:0] unit = {{UNIT_BITS-SCALE_BITS{exponent_i[SCALE_BITS-1]}}, exponent_i}
                                     + $signed(BIAS - 1 + FRACTION_BITS);
    plain_round #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .ROUNDING(ROUNDING),
                  .FULL(FULL), .WIDTH(VALUE_BITS), .UNIT_BITS(UNIT_BITS))
        round (.sign(value_i[VALUE_BITS-1]), .magnitude(magnitude), .unit(unit), .result(result_o), .flags(flags_o));
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
    parameter BITS = 24
) (
    input  wire [EXPONENT_BITS+FRACTION_BITS:0] a_i,
    output wire [BITS-1:0]                      result_o
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
    wire [WIDTH-1:0] limit = {{WIDTH-BITS+1{1'b0}}, {BITS-1{1'b1}}} + {{WIDTH-1{1'b0}}, sign};
    wire [WIDTH-1:0] bounded = (is_infinite | (magnitude > limit)) ? limit : magnitude;
    wire [WIDTH-1:0] signed_value = sign ? -bounded : bounded;
    assign result_o = is_nan ? {BITS{1'b0}} : signed_value[BITS-1:0];
endmodule

// The largest integer not above a_i, as a float.
module plain_floor #(
    parameter EXPONENT_BITS = 7,
    parameter FRACTION_BITS = 16,
    parameter FULL = 0
) (
    input  wire [EXPONENT_BITS+FRACTION_BITS:0] a_i,
    output wire [EXPONENT_BITS+FRACTION_BITS:0] result_o
);
    localparam BIAS = (1 << (EXPONENT_BITS - 1)) - 1;
    localparam LARGEST = (1 << (EXPONENT_BITS - 1)) + 1;
    localparam UNIT_BITS = EXPONENT_BITS + 4 + $clog2(FRACTION_BITS);
    wire sign, is_zero, is_infinite, is_nan;
    wire [EXPONENT_BITS-1:0] field;
    wire [FRACTION_BITS:0] significand;
    plain_number #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .FULL(FULL))
        a (.pattern(a_i), .sign(sign), .field(field), .significand(significand), .is_zero(is_zero),
           .is_infinite(is_infinite), .is_nan(is_nan), .is_signalling());
    wire [LARGEST-1:0] magnitude;
    wire inexact;
    plain_point #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .ROUNDING(3), .WIDTH(LARGEST))
        point (.sign(sign), .field(field), .significand(significand), .integer_magnitude(magnitude), .inexact(inexact));
    wire [EXPONENT_BITS+FRACTION_BITS:0] rounded;
    wire [4:0] flags;
    wire signed [UNIT_BITS-1:0] unit = BIAS - 1 + FRACTION_BITS;
    plain_round #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .ROUNDING(3), .FULL(FULL),
                  .WIDTH(LARGEST), .UNIT_BITS(UNIT_BITS))
        round (.sign(sign), .magnitude(magnitude), .unit(unit), .result(rounded), .flags(flags));
    assign result_o = is_nan ? {1'b0, {EXPONENT_BITS{1'b1}}, 1'b1, {FRACTION_BITS-1{1'b0}}}
                    : is_infinite ? {sign, {EXPONENT_BITS{1'b1}}, {FRACTION_BITS{1'b0}}}
                    : is_zero ? {sign, {EXPONENT_BITS+FRACTION_BITS{1'b0}}}
                    : rounded;
endmodule

`default_nettype wire
