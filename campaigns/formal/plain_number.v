// What a pattern stands for, for the plain specifications.

`default_nettype none

module plain_number #(
    parameter EXPONENT_BITS = 7,
    parameter FRACTION_BITS = 16,
    parameter FULL = 0
) (
    input  wire [EXPONENT_BITS+FRACTION_BITS:0] pattern,
    output wire                                 sign,
    output wire [EXPONENT_BITS-1:0]             field,        // the exponent's, 1 for what has none
    output wire [FRACTION_BITS:0]               significand,  // value = significand * 2^(field - 1)
    output wire                                 is_zero,
    output wire                                 is_infinite,
    output wire                                 is_nan,
    output wire                                 is_signalling
);
    wire [EXPONENT_BITS-1:0] exponent = pattern[EXPONENT_BITS+FRACTION_BITS-1:FRACTION_BITS];
    wire [FRACTION_BITS-1:0] fraction = pattern[FRACTION_BITS-1:0];
    wire hidden = |exponent;
    assign sign = pattern[EXPONENT_BITS+FRACTION_BITS];
    assign field = hidden ? exponent : {{EXPONENT_BITS-1{1'b0}}, 1'b1};
    assign significand = {hidden, (hidden | (FULL != 0)) ? fraction : {FRACTION_BITS{1'b0}}};
    assign is_zero = ~|significand;
    assign is_infinite = (&exponent) & ~|fraction;
    assign is_nan = (&exponent) & (|fraction);
    assign is_signalling = is_nan & ~fraction[FRACTION_BITS-1];
endmodule

`default_nettype wire
