// Rounding as the definition has it, for the plain specifications: an exact magnitude, cut at a
// place that is found by looking at every bit, and a comparison of what is cut off with one half.
// No leading-zero tree, no barrel shifter, no sharing: this is to be read, not to be built.

`default_nettype none

// The magnitude without its `cut` lowest bits, rounded by what these are worth.
module plain_round_at #(
    parameter FRACTION_BITS = 16,
    parameter ROUNDING = 0,  // 0 nearest even, 1 toward zero, 2 up, 3 down
    parameter WIDTH = 40,    // bits of the magnitude
    parameter CUT_BITS = 9   // bits of `cut`, signed
) (
    input  wire                        sign,
    input  wire        [WIDTH-1:0]     magnitude,
    input  wire signed [CUT_BITS-1:0]  cut,      // 0 and below: nothing is cut, zeros are appended
    output wire [FRACTION_BITS+1:0]    rounded,
    output wire                        inexact
);
    localparam KEPT_BITS = FRACTION_BITS + 1;
    integer place;
    // any_below[p]: is a bit below place p set?
    reg [WIDTH:0] any_below;
    always @* begin
        any_below[0] = 1'b0;
        for (place = 0; place < WIDTH; place = place + 1)
            any_below[place + 1] = any_below[place] | magnitude[place];
    end
    // Zeros above, so that a part that reaches beyond the magnitude is defined.
    wire [WIDTH+KEPT_BITS-1:0] padded = {{KEPT_BITS{1'b0}}, magnitude};

    reg [KEPT_BITS-1:0] kept;
    reg at_half;     // the first bit cut off: worth half a unit
    reg beyond;      // anything after it
    always @* begin
        kept = {KEPT_BITS{1'b0}};
        at_half = 1'b0;
        beyond = (cut > $signed(WIDTH)) & any_below[WIDTH];
        for (place = 0; place < KEPT_BITS; place = place + 1)
            if (cut == -place)
                kept = padded[KEPT_BITS-1:0] << place;
        for (place = 1; place <= WIDTH; place = place + 1)
            if (cut == place) begin
                kept = padded[place +: KEPT_BITS];
                at_half = magnitude[place - 1];
                beyond = any_below[place - 1];
            end
    end
    assign inexact = at_half | beyond;
    wire away = (ROUNDING == 0) ? at_half & (beyond | kept[0])
              : (ROUNDING == 1) ? 1'b0
              : (ROUNDING == 2) ? inexact & ~sign
              :                   inexact & sign;
    assign rounded = {1'b0, kept} + {{KEPT_BITS{1'b0}}, away};
endmodule

// The float of an exact value: (-1)^sign * magnitude * 2^unit, in units of the smallest subnormal
// number.
module plain_round #(
    parameter EXPONENT_BITS = 7,
    parameter FRACTION_BITS = 16,
    parameter ROUNDING = 0,
    parameter FULL = 0,      // subnormal numbers as IEEE 754 has them; else they become zeros
    parameter WIDTH = 40,    // bits of the magnitude
    parameter UNIT_BITS = 9  // bits of `unit`, signed; WIDTH + unit must fit, too
) (
    input  wire                                   sign,
    input  wire        [WIDTH-1:0]                magnitude,
    input  wire signed [UNIT_BITS-1:0]            unit,
    output wire [EXPONENT_BITS+FRACTION_BITS:0]   result,
    output wire [4:0]                             flags   // invalid, by zero, overflow, underflow, inexact
);
    localparam CUT_BITS = UNIT_BITS + 2;
    localparam PATTERN_BITS = CUT_BITS + FRACTION_BITS + 2;
    localparam MAGNITUDE_BITS = EXPONENT_BITS + FRACTION_BITS;
    localparam [MAGNITUDE_BITS-1:0] INFINITY = {{EXPONENT_BITS{1'b1}}, {FRACTION_BITS{1'b0}}};
    localparam signed [PATTERN_BITS-1:0] WIDE_INFINITY = INFINITY;
    localparam signed [PATTERN_BITS-1:0] SMALLEST_NORMAL = 1 << FRACTION_BITS;

    // With no end to the exponent: the significand's FRACTION_BITS + 1 bits begin at the leading one.
    integer place;
    reg signed [CUT_BITS-1:0] free_cut;
    always @* begin
        free_cut = {CUT_BITS{1'b0}};
        for (place = 0; place < WIDTH; place = place + 1)
            if (magnitude[place])
                free_cut = place - FRACTION_BITS;
    end
    wire [FRACTION_BITS+1:0] free_rounded;
    wire free_inexact;
    plain_round_at #(.FRACTION_BITS(FRACTION_BITS), .ROUNDING(ROUNDING), .WIDTH(WIDTH), .CUT_BITS(CUT_BITS))
        free (.sign(sign), .magnitude(magnitude), .cut(free_cut), .rounded(free_rounded), .inexact(free_inexact));
    // The pattern is an integer: exponent field - 1 in units of 2^FRACTION_BITS, plus the
    // significand with its leading one; a carry out of the significand runs on by itself.
    wire signed [CUT_BITS-1:0] wide_unit = {{CUT_BITS-UNIT_BITS{unit[UNIT_BITS-1]}}, unit};
    wire signed [CUT_BITS-1:0] free_exponent = free_cut + wide_unit;
    wire signed [PATTERN_BITS-1:0] free_pattern =
        $signed({{2{free_exponent[CUT_BITS-1]}}, free_exponent, {FRACTION_BITS{1'b0}}})
        + $signed({{PATTERN_BITS-FRACTION_BITS-2{1'b0}}, free_rounded});
    wire is_zero = ~|magnitude;
    wire overflow = ~is_zero & (free_pattern >= WIDE_INFINITY);
    wire tiny = ~is_zero & (free_pattern < SMALLEST_NORMAL);

    // With the lower end: no bit below the smallest subnormal number is kept.
    wire signed [CUT_BITS-1:0] least_cut = -wide_unit;
    wire signed [CUT_BITS-1:0] full_cut = (free_cut < least_cut) ? least_cut : free_cut;
    wire [FRACTION_BITS+1:0] full_rounded;
    wire full_inexact;
    plain_round_at #(.FRACTION_BITS(FRACTION_BITS), .ROUNDING(ROUNDING), .WIDTH(WIDTH), .CUT_BITS(CUT_BITS))
        full (.sign(sign), .magnitude(magnitude), .cut(full_cut), .rounded(full_rounded), .inexact(full_inexact));
    wire signed [CUT_BITS-1:0] full_exponent = full_cut + wide_unit;
    wire [PATTERN_BITS-1:0] full_pattern =
        {2'b00, full_exponent, {FRACTION_BITS{1'b0}}} + {{PATTERN_BITS-FRACTION_BITS-2{1'b0}}, full_rounded};

    wire to_largest = (ROUNDING == 1) | ((ROUNDING == 2) & sign) | ((ROUNDING == 3) & ~sign);
    wire [MAGNITUDE_BITS-1:0] bounded =
        overflow ? INFINITY - {{MAGNITUDE_BITS-1{1'b0}}, to_largest}
        : (FULL != 0) ? full_pattern[MAGNITUDE_BITS-1:0]
        : tiny ? {MAGNITUDE_BITS{1'b0}}
        : free_pattern[MAGNITUDE_BITS-1:0];
    assign result = {sign, is_zero ? {MAGNITUDE_BITS{1'b0}} : bounded};
    wire inexact = overflow | ((FULL != 0) ? full_inexact : free_inexact | tiny);
    wire underflow = tiny & ((FULL != 0) ? full_inexact : 1'b1);
    assign flags = is_zero ? 5'b0 : {2'b00, overflow, underflow, inexact};
endmodule

`default_nettype wire
