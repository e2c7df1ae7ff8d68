// The read port: what it offers stands until it is taken; it takes and hands on as many beats as
// it asked for; and the address is that of the line.

`default_nettype none

module read_port_properties (
    input wire        clk_i,
    input wire        request_valid_i,
    input wire [2:0]  request_line_i,
    input wire        beat_ready_i,
    input wire        mem_arready_i,
    input wire        mem_rvalid_i,
    input wire [3:0]  mem_rid_i,
    input wire [63:0] mem_rdata_i,
    input wire [1:0]  mem_rresp_i,
    input wire        mem_rlast_i
);
    reg started = 1'b0, ran = 1'b0;
    always @(posedge clk_i) begin
        started <= 1'b1;
        ran     <= started;
    end

    wire        request_ready, beat_valid, beat_last, error, arvalid, rready;
    wire [63:0] beat_data;
    wire [31:0] araddr;
    wire [7:0]  arlen;
    wire [2:0]  arsize;
    wire [1:0]  arburst;
    wire [3:0]  arid;

    read_port dut (
        .clk_i           (clk_i),
        .rst_ni          (started),
        .request_valid_i (request_valid_i),
        .request_line_i  (request_line_i),
        .beat_ready_i    (beat_ready_i),
        .mem_arready_i   (mem_arready_i),
        .mem_rvalid_i    (mem_rvalid_i),
        .mem_rid_i       (mem_rid_i),
        .mem_rdata_i     (mem_rdata_i),
        .mem_rresp_i     (mem_rresp_i),
        .mem_rlast_i     (mem_rlast_i),
        .request_ready_o (request_ready),
        .beat_valid_o    (beat_valid),
        .beat_data_o     (beat_data),
        .beat_last_o     (beat_last),
        .error_o         (error),
        .mem_arvalid_o   (arvalid),
        .mem_araddr_o    (araddr),
        .mem_arlen_o     (arlen),
        .mem_arsize_o    (arsize),
        .mem_arburst_o   (arburst),
        .mem_arid_o      (arid),
        .mem_rready_o    (rready)
    );

    wire requested = started && request_valid_i && request_ready;
    wire asked     = started && arvalid && mem_arready_i;
    wire taken     = started && mem_rvalid_i && rready;
    wire handed_on = started && beat_valid && beat_ready_i;

    // Lines requested and not yet asked of the memory; beats the memory owes; beats owed to the
    // one who requests.
    reg [7:0] to_ask = 8'd0, memory_owes = 8'd0, owed = 8'd0;
    always @(posedge clk_i) begin
        to_ask      <= to_ask + {7'd0, requested} - {7'd0, asked};
        memory_owes <= memory_owes + {6'd0, asked, 1'b0} - {7'd0, taken};
        owed        <= owed + {6'd0, requested, 1'b0} - {7'd0, handed_on};
    end

    // A memory answers what it was asked, never before.
    always @* assume (!mem_rvalid_i || memory_owes != 8'd0);

    always @* if (started) begin
        assert (arvalid == (to_ask != 8'd0));
        assert (to_ask <= 8'd1);
        assert (memory_owes <= 8'd4);
        assert (!beat_valid || owed != 8'd0);
        // A line is two beats: the second of them is the last.
        assert (!beat_valid || beat_last == owed[0]);
        assert (owed <= 8'd5);
        // All that is owed stands somewhere.
        assert (owed == {to_ask[6:0], 1'b0} + memory_owes + {7'd0, beat_valid});
        assert (arlen == 8'd1 && arsize == 3'd3 && arburst == 2'd1 && arid == 4'd0);
        assert (araddr[31:7] == 25'd0 && araddr[3:0] == 4'd0);
    end

    reg [2:0] line;
    always @(posedge clk_i) if (requested) line <= request_line_i;
    always @* if (started && arvalid) assert (araddr[6:4] == line);

    // Valid holds until ready, and so does what it stands beside.
    reg        ar_held = 1'b0, beat_held = 1'b0, had_failed = 1'b0;
    reg [31:0] address_before;
    reg [63:0] data_before, data_taken;
    reg        last_before;
    always @(posedge clk_i) begin
        ar_held        <= started && arvalid && !mem_arready_i;
        beat_held      <= started && beat_valid && !beat_ready_i;
        had_failed     <= started && error;
        address_before <= araddr;
        data_before    <= beat_data;
        last_before    <= beat_last;
        if (taken) data_taken <= mem_rdata_i;
    end
    always @* if (ran) begin
        if (ar_held) assert (arvalid && araddr == address_before);
        if (beat_held) assert (beat_valid && beat_data == data_before && beat_last == last_before);
        if (had_failed) assert (error);
        if (beat_valid) assert (beat_data == data_taken);
    end

    always @* cover (owed == 8'd5 && beat_valid && !beat_ready_i);
endmodule

`default_nettype wire
