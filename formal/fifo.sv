// The FIFO never overflows or underflows, and an item that is put in behind n others is the one
// that is offered when these n have been taken: nothing is lost, doubled, reordered or changed.
//
// The item that is watched is any one, since the solver chooses when `watch` is 1.

`default_nettype none

module fifo_properties (
    input wire       clk_i,
    input wire       in_valid_i,
    input wire [1:0] in_item_i,
    input wire       out_ready_i,
    input wire       watch
);
    localparam [2:0] DEPTH = 3'd4;

    // Reset in the first cycle, and never again.
    reg started = 1'b0;
    always @(posedge clk_i) started <= 1'b1;

    wire       in_ready, out_valid;
    wire [1:0] out_item;
    wire [2:0] count;

    fifo dut (
        .clk_i       (clk_i),
        .rst_ni      (started),
        .in_valid_i  (in_valid_i),
        .in_item_i   (in_item_i),
        .out_ready_i (out_ready_i),
        .in_ready_o  (in_ready),
        .out_valid_o (out_valid),
        .out_item_o  (out_item),
        .count_o     (count)
    );

    wire put  = started && in_valid_i && in_ready;
    wire take = started && out_valid && out_ready_i;

    // Items put in and not yet taken, as the handshakes tell.
    reg [7:0] inside = 8'd0;
    always @(posedge clk_i) inside <= inside + {7'd0, put} - {7'd0, take};

    // The watched item: how many stand before it, and what it is.
    reg       watching = 1'b0;
    reg [1:0] item;
    reg [7:0] before;
    always @(posedge clk_i) begin
        if (put && watch && !watching) begin
            watching <= 1'b1;
            item     <= in_item_i;
            before   <= inside - {7'd0, take};
        end else if (watching && take) begin
            before <= before - 8'd1;
            if (before == 8'd0) watching <= 1'b0;
        end
    end

    always @* if (started) begin
        assert (count == inside);
        assert (count <= DEPTH);
        assert (in_ready == (count != DEPTH));
        assert (out_valid == (count != 3'd0));
        if (watching) assert (before < inside);
    end

`ifdef CONTENT
    always @* if (started && watching && before == 8'd0) assert (out_item == item);

    // The pointers have gone round, and the last place has been taken.
    reg [3:0] taken = 4'd0;
    always @(posedge clk_i) taken <= taken + {3'd0, take};
    always @* cover (taken == 4'd6 && count == DEPTH);
`endif
endmodule

`default_nettype wire
