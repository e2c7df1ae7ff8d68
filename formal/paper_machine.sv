// The 2013 paper's machine: no ray is lost or duplicated, FIFO 1 has a place for every hit, and a
// hit that is offered stands until it is taken.
//
// What computes is cut away, so that the proof holds whatever it answers: the pass, the setup, the
// height cache and the port to the memory give any value in any cycle. A ray may so go round as
// often as the solver likes. What is left is the control: FIFO 0, the loop's valid bits and ids,
// the controller, FIFO 1. Their registers are led out as ports, since a proof by induction has to
// say how they hang together.
//
// The ray that is watched is any one: the solver chooses its id.

`default_nettype none

module paper_machine_properties (
    input wire        clk_i,
    input wire        ray_valid_i,
    input wire [19:0] ray_id_i,
    input wire [23:0] ray_u_i,
    input wire        hit_ready_i
);
    localparam [2:0] PLACES = 3'd4;

    // Reset in the first cycle, and never again.
    reg started = 1'b0;
    always @(posedge clk_i) started <= 1'b1;

    wire        ray_ready, hit_valid, hit_guard, ends, admits;
    wire [19:0] hit_id, waiting_id;
    wire [2:0]  hit_i, hit_j;
    wire [23:0] hit_t, hit_u, hit_v;
    wire [17:0] hit_steps, hit_crossings;

    // Registers of the machine.
    wire [14:0] valid;
    wire [19:0] id_s0, id_s1, id_s2, id_s3, id_s4, id_s5, id_s6, id_s7, id_s8, id_s9, id_s10, id_s11, id_s12, id_s13, id_s14;
    wire [2:0]  rays_inside, count_0, count_1;
    wire [1:0]  write_pointer_0, read_pointer_0, write_pointer_1, read_pointer_1;
    wire [43:0] place_0_0, place_0_1, place_0_2, place_0_3;
    wire [49:0] place_1_0, place_1_1, place_1_2, place_1_3;

    paper_machine dut (
        .clk_i           (clk_i),
        .rst_ni          (started),
        .ray_valid_i     (ray_valid_i),
        .ray_id_i        (ray_id_i),
        .ray_u_i         (ray_u_i),
        .hit_ready_i     (hit_ready_i),
        .ray_ready_o     (ray_ready),
        .hit_valid_o     (hit_valid),
        .hit_id_o        (hit_id),
        .hit_i_o         (hit_i),
        .hit_j_o         (hit_j),
        .hit_t_o         (hit_t),
        .hit_u_o         (hit_u),
        .hit_v_o         (hit_v),
        .hit_steps_o     (hit_steps),
        .hit_crossings_o (hit_crossings),
        .hit_guard_o     (hit_guard),
        .\paper_loop.valid_s0  (valid[0]),
        .\paper_loop.id_s0  (id_s0),
        .\paper_loop.valid_s1  (valid[1]),
        .\paper_loop.id_s1  (id_s1),
        .\paper_loop.valid_s2  (valid[2]),
        .\paper_loop.id_s2  (id_s2),
        .\paper_loop.valid_s3  (valid[3]),
        .\paper_loop.id_s3  (id_s3),
        .\paper_loop.valid_s4  (valid[4]),
        .\paper_loop.id_s4  (id_s4),
        .\paper_loop.valid_s5  (valid[5]),
        .\paper_loop.id_s5  (id_s5),
        .\paper_loop.valid_s6  (valid[6]),
        .\paper_loop.id_s6  (id_s6),
        .\paper_loop.valid_s7  (valid[7]),
        .\paper_loop.id_s7  (id_s7),
        .\paper_loop.valid_s8  (valid[8]),
        .\paper_loop.id_s8  (id_s8),
        .\paper_loop.valid_s9  (valid[9]),
        .\paper_loop.id_s9  (id_s9),
        .\paper_loop.valid_s10  (valid[10]),
        .\paper_loop.id_s10  (id_s10),
        .\paper_loop.valid_s11  (valid[11]),
        .\paper_loop.id_s11  (id_s11),
        .\paper_loop.valid_s12  (valid[12]),
        .\paper_loop.id_s12  (id_s12),
        .\paper_loop.valid_s13  (valid[13]),
        .\paper_loop.id_s13  (id_s13),
        .\paper_loop.valid_s14  (valid[14]),
        .\paper_loop.id_s14  (id_s14),
        .\fifo_0.places_0[0]  (place_0_0),
        .\fifo_0.places_0[1]  (place_0_1),
        .\fifo_0.places_0[2]  (place_0_2),
        .\fifo_0.places_0[3]  (place_0_3),
        .\fifo_0.count  (count_0),
        .\fifo_0.write_pointer  (write_pointer_0),
        .\fifo_0.read_pointer  (read_pointer_0),
        .\fifo_1.places_0[0]  (place_1_0),
        .\fifo_1.places_0[1]  (place_1_1),
        .\fifo_1.places_0[2]  (place_1_2),
        .\fifo_1.places_0[3]  (place_1_3),
        .\fifo_1.count  (count_1),
        .\fifo_1.write_pointer  (write_pointer_1),
        .\fifo_1.read_pointer  (read_pointer_1),
        .\paper_loop.rays_inside  (rays_inside),
        .\paper_loop.admits  (admits),
        .\paper_loop.waiting_id_i  (waiting_id),
        .\paper_loop.ends  (ends)
    );

    wire enters = started && ray_valid_i && ray_ready;
    wire leaves = started && hit_valid && hit_ready_i;

    // Rays of the watched id, as the handshakes tell: put into FIFO 0 and let into the loop, put
    // into FIFO 1 and taken from it.
    (* anyconst *) reg [19:0] watched;
    wire watched_enters = enters && ray_id_i == watched;
    wire watched_admits = started && admits && waiting_id == watched;
    wire watched_ends   = started && ends && id_s14 == watched;
    wire watched_leaves = leaves && hit_id == watched;
    reg [4:0] waiting = 5'd0, ended = 5'd0;
    always @(posedge clk_i) begin
        if (!started) begin
            waiting <= 5'd0;
            ended   <= 5'd0;
        end else begin
            waiting <= waiting + {4'd0, watched_enters} - {4'd0, watched_admits};
            ended   <= ended + {4'd0, watched_ends} - {4'd0, watched_leaves};
        end
    end

    // Every ray that was let into the loop and did not end is in a stage, and only in one; so is
    // every ray of the watched id.
    wire [4:0] in_flight;
    stages_hold all_rays (
        .clk_i   (clk_i),
        .started (started),
        .enters  (started && admits),
        .leaves  (started && ends),
        .stages  (valid),
        .inside  (in_flight)
    );
`ifndef COUNTS
    stages_hold watched_rays (
        .clk_i   (clk_i),
        .started (started),
        .enters  (watched_admits),
        .leaves  (watched_ends),
        .stages  (in_loop),
        .inside  ()
    );
`endif

    // Is this place of a FIFO taken, with the oldest item where it reads?
    function is_taken(input [1:0] place, input [1:0] read, input [2:0] count);
        reg [1:0] behind;
        begin
            behind = place - read;
            is_taken = {1'b0, behind} < count;
        end
    endfunction

    // Where rays of that id are.
    reg [14:0] in_loop;
    reg [3:0]  in_fifo_0, in_fifo_1;
    always @* begin
        in_loop[0] = valid[0] && id_s0 == watched;
        in_loop[1] = valid[1] && id_s1 == watched;
        in_loop[2] = valid[2] && id_s2 == watched;
        in_loop[3] = valid[3] && id_s3 == watched;
        in_loop[4] = valid[4] && id_s4 == watched;
        in_loop[5] = valid[5] && id_s5 == watched;
        in_loop[6] = valid[6] && id_s6 == watched;
        in_loop[7] = valid[7] && id_s7 == watched;
        in_loop[8] = valid[8] && id_s8 == watched;
        in_loop[9] = valid[9] && id_s9 == watched;
        in_loop[10] = valid[10] && id_s10 == watched;
        in_loop[11] = valid[11] && id_s11 == watched;
        in_loop[12] = valid[12] && id_s12 == watched;
        in_loop[13] = valid[13] && id_s13 == watched;
        in_loop[14] = valid[14] && id_s14 == watched;
        in_fifo_0[0] = is_taken(2'd0, read_pointer_0, count_0) && place_0_0[43:24] == watched;
        in_fifo_0[1] = is_taken(2'd1, read_pointer_0, count_0) && place_0_1[43:24] == watched;
        in_fifo_0[2] = is_taken(2'd2, read_pointer_0, count_0) && place_0_2[43:24] == watched;
        in_fifo_0[3] = is_taken(2'd3, read_pointer_0, count_0) && place_0_3[43:24] == watched;
        in_fifo_1[0] = is_taken(2'd0, read_pointer_1, count_1) && place_1_0[49:30] == watched;
        in_fifo_1[1] = is_taken(2'd1, read_pointer_1, count_1) && place_1_1[49:30] == watched;
        in_fifo_1[2] = is_taken(2'd2, read_pointer_1, count_1) && place_1_2[49:30] == watched;
        in_fifo_1[3] = is_taken(2'd3, read_pointer_1, count_1) && place_1_3[49:30] == watched;
    end

    function [4:0] ones(input [3:0] bits);
        ones = ({4'd0, bits[0]} + {4'd0, bits[1]}) + ({4'd0, bits[2]} + {4'd0, bits[3]});
    endfunction


    always @* if (started) begin
        // The controller counts what is in the loop and in FIFO 1, and lets in no more.
        assert ({2'd0, rays_inside} == in_flight + {2'd0, count_1});
        assert (rays_inside <= PLACES);
        // No hit finds FIFO 1 full.
        assert (!ends || count_1 != PLACES);
        // The FIFOs' pointers hang together.
        assert (count_0 <= PLACES && count_1 <= PLACES);
        assert (write_pointer_0 == read_pointer_0 + count_0[1:0]);
        assert (write_pointer_1 == read_pointer_1 + count_1[1:0]);
`ifndef COUNTS
        // Every ray of that id that is put into a FIFO and not taken is in it, and only once.
        assert (waiting == ones(in_fifo_0));
        assert (ended == ones(in_fifo_1));
`endif
    end

    // A hit that is offered stands until it is taken.
    reg         held = 1'b0;
    wire [134:0] hit = {hit_id, hit_i, hit_j, hit_t, hit_u, hit_v, hit_steps, hit_crossings, hit_guard};
    reg [134:0] hit_before;
    always @(posedge clk_i) begin
        held       <= started && hit_valid && !hit_ready_i;
        hit_before <= hit;
    end
    always @* if (started && held) assert (hit_valid && hit == hit_before);

    // FIFO 1 is full, and rays wait in FIFO 0.
    always @* cover (started && count_1 == PLACES && count_0 == PLACES);
    // The watched ray goes round.
    reg was_last = 1'b0;
    always @(posedge clk_i) was_last <= started && in_loop[14];
    always @* cover (started && was_last && in_loop[0]);
endmodule

// Of the rays that entered a ring of stages and did not leave it, each is in a stage, and no other.
module stages_hold (
    input wire        clk_i,
    input wire        started,
    input wire        enters,  // into stage 0
    input wire        leaves,  // from the last stage, instead of going round
    input wire [14:0] stages,  // where there is a ray
    output wire [4:0] inside   // that entered and did not leave
);
    // Five bits a stage k: rays in stage k and behind it. They are counted as rays move, and
    // each count hangs together with the next, so that a solver never has to add up the stages.
    reg [74:0] counts;
    assign inside = counts[4:0];
    integer k;
    always @(posedge clk_i) begin
        counts[4:0] <= started ? counts[4:0] + {4'd0, enters} - {4'd0, leaves} : 5'd0;
        for (k = 1; k < 15; k = k + 1)
            counts[5 * k +: 5] <= started
                ? counts[5 * k +: 5] + {4'd0, stages[k - 1]} - {4'd0, stages[14]}
                : 5'd0;
    end
    always @* if (started) begin
        for (k = 0; k < 14; k = k + 1)
            assert (counts[5 * k +: 5] == counts[5 * k + 5 +: 5] + {4'd0, stages[k]});
        assert (counts[74:70] == {4'd0, stages[14]});
    end
endmodule

`default_nettype wire
