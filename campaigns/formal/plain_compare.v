// The order of two floats as the definition has it: both on one fixed-point scale, as signed
// integers, compared.

`default_nettype none

module plain_compare #(
    parameter EXPONENT_BITS = 7,
    parameter FRACTION_BITS = 16,
    parameter FULL = 0,
    parameter SIGNALLING = 0  // any NaN is invalid, not only a signalling one
) (
    input  wire [EXPONENT_BITS+FRACTION_BITS:0] a_i,
    input  wire [EXPONENT_BITS+FRACTION_BITS:0] b_i,
    output wire                                 less_than_o,
    output wire                                 less_equal_o,
    output wire                                 equal_o,
    output wire                                 unordered_o,
    output wire [4:0]                           flags_o
);
    // Every finite number is an integer of units of the smallest subnormal one; infinity is above.
    localparam WIDTH = (1 << EXPONENT_BITS) + FRACTION_BITS + 1;
    wire a_sign, a_nan, a_signalling, b_sign, b_nan, b_signalling;
    wire [EXPONENT_BITS-1:0] a_field, b_field;
    wire [FRACTION_BITS:0] a_significand, b_significand;
    plain_number #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .FULL(FULL))
        a (.pattern(a_i), .sign(a_sign), .field(a_field), .significand(a_significand), .is_zero(),
           .is_infinite(), .is_nan(a_nan), .is_signalling(a_signalling)),
        b (.pattern(b_i), .sign(b_sign), .field(b_field), .significand(b_significand), .is_zero(),
           .is_infinite(), .is_nan(b_nan), .is_signalling(b_signalling));
    wire signed [WIDTH-1:0] a_magnitude = {{WIDTH-FRACTION_BITS-1{1'b0}}, a_significand} << (a_field - 1'b1);
    wire signed [WIDTH-1:0] b_magnitude = {{WIDTH-FRACTION_BITS-1{1'b0}}, b_significand} << (b_field - 1'b1);
    wire signed [WIDTH-1:0] a_value = a_sign ? -a_magnitude : a_magnitude;
    wire signed [WIDTH-1:0] b_value = b_sign ? -b_magnitude : b_magnitude;
    assign unordered_o = a_nan | b_nan;
    assign less_than_o = ~unordered_o & (a_value < b_value);
    assign equal_o = ~unordered_o & (a_value == b_value);
    assign flags_o = {a_signalling | b_signalling | (unordered_o & (SIGNALLING != 0)), 4'b0};
    assign less_equal_o = ~unordered_o & (a_value <= b_value);
endmodule

`default_nettype wire
