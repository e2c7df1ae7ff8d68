// The height cache: a hit answers with what the memory has at the address, no line is asked for
// while it is on its way, no more lines are on their way than there are slots, and none is pushed
// out before it has been hit: so who asks until he is answered is answered.
//
// The height that is watched is any one: the solver chooses its address and what the memory has
// there. The memory answers in the order it is asked, as late as it likes.

`default_nettype none

module height_cache_properties (
    input wire        clk_i,
    input wire        lookup_valid_i,
    input wire [5:0]  lookup_address_i,
    input wire        fetch_ready_i,
    input wire        beat_valid_i,
    input wire [63:0] beat_data_i
);
    localparam [2:0] SLOTS = 3'd2;

    // Reset in the first cycle, and never again.
    reg started = 1'b0;
    always @(posedge clk_i) started <= 1'b1;

    wire       lookup_ready, answer_valid, hit, fetch_valid;
    wire [7:0] height;
    wire [1:0] fetch_line;

    height_cache dut (
        .clk_i            (clk_i),
        .rst_ni           (started),
        .lookup_valid_i   (lookup_valid_i),
        .lookup_address_i (lookup_address_i),
        .fetch_ready_i    (fetch_ready_i),
        .beat_valid_i     (beat_valid_i),
        .beat_data_i      (beat_data_i),
        .lookup_ready_o   (lookup_ready),
        .answer_valid_o   (answer_valid),
        .hit_o            (hit),
        .height_o         (height),
        .fetch_valid_o    (fetch_valid),
        .fetch_line_o     (fetch_line)
    );

    wire asks = started && fetch_valid && fetch_ready_i;

    // Lines asked for and not yet whole, the oldest first; and which of its two beats comes next.
    reg [1:0] line_0 = 2'd0, line_1 = 2'd0;
    reg [2:0] on_their_way = 3'd0;
    reg       beat = 1'b0;
    wire      ends = beat_valid_i && beat;
    always @(posedge clk_i) begin
        if (beat_valid_i) beat <= !beat;
        on_their_way <= on_their_way + {2'd0, asks} - {2'd0, ends};
        if (ends) line_0 <= line_1;
        if (asks) begin
            if (on_their_way == {2'd0, ends}) line_0 <= fetch_line;
            else line_1 <= fetch_line;
        end
    end

    // A memory answers what it was asked, never before.
    always @* assume (!beat_valid_i || (started && on_their_way != 3'd0));

    // The watched height: a line's first beat has its heights 0 to 7, the first in the low bits.
    (* anyconst *) reg [5:0] address;
    (* anyconst *) reg [7:0] in_memory;
    wire [63:0] from_height_on = beat_data_i >> {address[2:0], 3'd0};
    always @* if (beat_valid_i && line_0 == address[5:4] && beat == address[3])
        assume (from_height_on[7:0] == in_memory);

    reg asked_for_watched = 1'b0;
    always @(posedge clk_i)
        asked_for_watched <= started && lookup_valid_i && lookup_ready && lookup_address_i == address;

    always @* if (started) begin
        assert (!asked_for_watched || answer_valid);
        assert (!hit || answer_valid);
        if (asked_for_watched && hit) assert (height == in_memory);
        assert (on_their_way <= SLOTS);
        if (asks) begin
            assert (on_their_way != SLOTS);
            assert (on_their_way == 3'd0 || line_0 != fetch_line);
            assert (on_their_way != 3'd2 || line_1 != fetch_line);
        end
    end

    // Of two lines, the low bit of a line's number is its index. An index whose line has come and
    // not been hit since asks for nothing.
    reg [1:0] unserved = 2'd0;
    reg       looked_up_index = 1'b0;
    always @(posedge clk_i) begin
        looked_up_index <= lookup_address_i[4];
        if (ends) unserved[line_0[0]] <= 1'b1;
        if (started && hit) unserved[looked_up_index] <= 1'b0;
    end
    always @* if (asks) assert (!unserved[fetch_line[0]]);
    always @* cover (asks && unserved == 2'd2);

    // The watched height was fetched, found, and pushed out by another line.
    reg  was_found = 1'b0;
    wire finds = started && asked_for_watched && hit;
    always @(posedge clk_i) if (finds) was_found <= 1'b1;
    always @* cover (finds);
    always @* cover (was_found && asked_for_watched && !hit && !beat_valid_i && on_their_way == 3'd0);
    always @* cover (started && on_their_way == SLOTS);
endmodule

`default_nettype wire
