// normalised_difference
//
// |a - b| shifted left until its top bit is 1, and by how much it was shifted.
// Source: hdl_gen/tests/common/mod.rs, `normalised_difference`.
//
// Latency: 2 cycles.
// Emitted by stepwell VERSION.

`default_nettype none

module normalised_difference (
    input  wire        clk_i,
    input  wire        rst_ni,       // synchronous, active low
    input  wire        ready_i,
    input  wire        valid_i,
    input  wire [7:0]  a_i,
    input  wire [7:0]  b_i,
    input  wire [23:0] tag_i,        // float e7f16
    output reg  [7:0]  normalised_o,
    output reg  [6:0]  exponent_o,
    output reg         flag_o,
    output reg  [22:0] packed_o,
    output wire        valid_o
);

    // ---- constants ----
    localparam [6:0] EXPONENT_BIAS = 7'd63;  // 2^(7-1) - 1, the bias of e7f16
    // Built into the widths and literals below:
    //   MAGNITUDE_BITS = 8  width of both magnitudes

    // ---- handshake ----
    reg  stage_1_valid;
    wire advance = !stage_1_valid | ready_i;

    always @(posedge clk_i) begin
        if (!rst_ni) begin
            stage_1_valid <= 1'b0;
        end else begin
            stage_1_valid <= advance ? valid_i : stage_1_valid;
        end
    end

    // ---- stage 1: difference of magnitudes ----
    reg  [7:0]  magnitude_q;
    reg  [15:0] tag_q;
    reg  [7:0]  high_product_q;
    wire [8:0]  difference        = {1'b0, a_i} - {1'b0, b_i};
    wire [15:0] high_product_wide = {8'd0, a_i} * {8'd0, b_i};
    wire [7:0]  high_product      = high_product_wide[15:8];

    always @(posedge clk_i) begin
        if (advance) begin
            magnitude_q    <= difference[8] ? (~difference[7:0] + 8'd1) : difference[7:0];
            tag_q          <= tag_i[15:0];
            high_product_q <= high_product;
        end
    end

    // ---- stage 2: normalise ----
    wire [3:0] counter_count;
    wire       unused_counter_is_zero;
    leading_zeros_8 counter (
        .value_i   (magnitude_q),
        .count_o   (counter_count),
        .is_zero_o (unused_counter_is_zero)
    );

    wire [7:0] normalised_next = magnitude_q << counter_count;
    wire [6:0] exponent_next   = EXPONENT_BIAS - {3'd0, counter_count};
    wire       flag_and        = ({{3{exponent_next[6]}}, exponent_next} < 10'h3c0) &
                                 (normalised_next == high_product_q);

    always @(posedge clk_i) begin
        if (!rst_ni) begin
            flag_o <= 1'b1;
        end else begin
            flag_o <= flag_and | high_product_q[0];
        end
    end

    always @(posedge clk_i) begin
        if (ready_i) begin
            normalised_o <= normalised_next;
            exponent_o   <= exponent_next;
            packed_o     <= {exponent_next, tag_q};
        end
    end

    // ---- outputs ----
    assign valid_o = stage_1_valid;

    // ---- bits that nothing reads ----
    // Gathered here so that lint tools see that they are known to end.
    wire unused = &{1'b0, tag_i[23:16], high_product_wide[7:0]};

endmodule

`default_nettype wire
