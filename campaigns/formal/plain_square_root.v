// The square root as the definition has it: the largest integer whose square is not above the
// widened significand, found bit by bit; a last bit that says whether the square falls short.

`default_nettype none

module plain_square_root #(
    parameter EXPONENT_BITS = 4,
    parameter FRACTION_BITS = 3,
    parameter ROUNDING = 0,
    parameter FULL = 0
) (
    input  wire [EXPONENT_BITS+FRACTION_BITS:0] a_i,
    output wire [EXPONENT_BITS+FRACTION_BITS:0] result_o,
    output wire [4:0]                           flags_o
);
    localparam BIAS = (1 << (EXPONENT_BITS - 1)) - 1;
    localparam ROOT_BITS = 2 * FRACTION_BITS + 4;
    localparam SQUARE_BITS = 2 * ROOT_BITS;
    localparam BELOW = SQUARE_BITS - FRACTION_BITS - 3;
    localparam WIDTH = ROOT_BITS + 1;
    localparam UNIT_BITS = EXPONENT_BITS + 3 + $clog2(SQUARE_BITS);
    wire sign, is_zero, is_infinite, operand_nan, is_signalling;
    wire [EXPONENT_BITS-1:0] field;
    wire [FRACTION_BITS:0] significand;
    plain_number #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .FULL(FULL))
        a (.pattern(a_i), .sign(sign), .field(field), .significand(significand), .is_zero(is_zero),
           .is_infinite(is_infinite), .is_nan(operand_nan), .is_signalling(is_signalling));
    // value = significand * 2^scale with the scale made even by one more place where it is odd.
    wire signed [UNIT_BITS-1:0] scale = $signed({1'b0, field}) - (BIAS + FRACTION_BITS) - BELOW;
    wire odd = scale[0];
    wire [SQUARE_BITS-1:0] square = {2'b00, significand, {BELOW{1'b0}}} << odd;
    integer place;
    reg [ROOT_BITS-1:0] root;
    reg [ROOT_BITS-1:0] trial;
    always @* begin
        root = {ROOT_BITS{1'b0}};
        trial = {ROOT_BITS{1'b0}};
        for (place = ROOT_BITS - 1; place >= 0; place = place - 1) begin
            trial = root;
            trial[place] = 1'b1;
            if ({{ROOT_BITS{1'b0}}, trial} * {{ROOT_BITS{1'b0}}, trial} <= square)
                root = trial;
        end
    end
    wire falls_short = ({{ROOT_BITS{1'b0}}, root} * {{ROOT_BITS{1'b0}}, root}) != square;
    wire signed [UNIT_BITS-1:0] even_scale = scale - $signed({{UNIT_BITS-1{1'b0}}, odd});
    wire signed [UNIT_BITS-1:0] root_scale = even_scale >>> 1;
    wire signed [UNIT_BITS-1:0] unit = root_scale + (BIAS - 1 + FRACTION_BITS) - 1;
    wire [EXPONENT_BITS+FRACTION_BITS:0] rounded;
    wire [4:0] rounded_flags;
    plain_round #(.EXPONENT_BITS(EXPONENT_BITS), .FRACTION_BITS(FRACTION_BITS), .ROUNDING(ROUNDING),
                  .FULL(FULL), .WIDTH(WIDTH), .UNIT_BITS(UNIT_BITS))
        round (.sign(1'b0), .magnitude({root, falls_short}), .unit(unit), .result(rounded), .flags(rounded_flags));
    wire no_root = sign & ~is_zero & ~operand_nan;
    wire is_nan = operand_nan | no_root;
    assign result_o = is_nan ? {1'b0, {EXPONENT_BITS{1'b1}}, 1'b1, {FRACTION_BITS-1{1'b0}}}
                    : is_zero ? {sign, {EXPONENT_BITS+FRACTION_BITS{1'b0}}}
                    : is_infinite ? {1'b0, {EXPONENT_BITS{1'b1}}, {FRACTION_BITS{1'b0}}}
                    : rounded;
    assign flags_o = (is_nan | is_zero | is_infinite) ? {is_signalling | no_root, 4'b0} : rounded_flags;
endmodule

`default_nettype wire
