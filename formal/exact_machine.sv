// The exact machine: no ray is lost or duplicated, the FIFO of ended walks has a place for every
// one, and a hit that is offered stands until it is taken and carries the id of the ray that came.
//
// What computes is cut away, so that the proof holds whatever it answers: the setups' digits, the
// trip, the leaf check's digits and verdict, the height cache and the port to the memory give any
// value in any cycle, and a setup and a check take as many cycles as the solver likes. A ray may go
// round, and be refused, as often as it likes. What is left is the control: the chain of setups, the slots, the loop's valid bits, the FIFO, the four
// places of the leaf check, and the memory of what a ray brought, by slot.
//
// The ray that is watched is any one: the solver chooses its id, and the slot that is watched.

`default_nettype none

module exact_machine_properties (
    input wire        clk_i,
    input wire        ray_valid_i,
    input wire [19:0] ray_id_i,
    input wire        hit_ready_i
);
    // Reset in the first cycle, and never again.
    reg started = 1'b0;
    always @(posedge clk_i) started <= 1'b1;

    wire         ray_ready, hit_valid, hit_at_border_u, hit_at_border_v;
    wire [19:0]  hit_id;
    wire [2:0]   hit_i, hit_j;
    wire [9:0]   hit_way;
    wire [5:0]   hit_slope;
    wire [7:0]   hit_depth;

    // Registers of the machine.
    wire [7:0]  valid;
    wire [1:0]  slot_s0, slot_s1, slot_s2, slot_s3, slot_s4, slot_s5, slot_s6, slot_s7;
    wire [1:0]  slot_s0_next, fetched_slot, waiting_slot, check_slot, answer_slot;
    wire        fetched_valid, waiting_valid, check_valid, answer_valid, answer_refused;
    wire [19:0] fetched_id, waiting_id, check_id, answer_id, setup_0_id, setup_1_id, setup_2_id;
    wire        setup_0_busy, setup_1_busy, setup_2_busy, fresh_s0, admits, ends, returns;
    wire [3:0]  free_slots;
    wire [2:0]  count;
    wire [1:0]  write_pointer, read_pointer, place_0, place_1, place_2, place_3;
    wire [47:0] ray_0, ray_1, ray_2, ray_3;

    exact_machine dut (
        .clk_i             (clk_i),
        .rst_ni            (started),
        .ray_valid_i       (ray_valid_i),
        .ray_id_i          (ray_id_i),
        .hit_ready_i       (hit_ready_i),
        .ray_ready_o       (ray_ready),
        .hit_valid_o       (hit_valid),
        .hit_id_o          (hit_id),
        .hit_i_o           (hit_i),
        .hit_j_o           (hit_j),
        .hit_at_border_u_o (hit_at_border_u),
        .hit_at_border_v_o (hit_at_border_v),
        .hit_way_o         (hit_way),
        .hit_slope_o       (hit_slope),
        .hit_depth_o       (hit_depth),
        .valid_s0          (valid[0]),
        .valid_s1          (valid[1]),
        .valid_s2          (valid[2]),
        .valid_s3          (valid[3]),
        .valid_s4          (valid[4]),
        .valid_s5          (valid[5]),
        .valid_s6          (valid[6]),
        .valid_s7          (valid[7]),
        .slot_s0           (slot_s0),
        .slot_s1           (slot_s1),
        .slot_s2           (slot_s2),
        .slot_s3           (slot_s3),
        .slot_s4           (slot_s4),
        .slot_s5           (slot_s5),
        .slot_s6           (slot_s6),
        .slot_s7           (slot_s7),
        .slot_s0_next      (slot_s0_next),
        .fetched_valid     (fetched_valid),
        .fetched_slot      (fetched_slot),
        .fetched_id        (fetched_id),
        .waiting_valid     (waiting_valid),
        .waiting_slot      (waiting_slot),
        .waiting_id        (waiting_id),
        .check_valid       (check_valid),
        .check_slot        (check_slot),
        .check_id          (check_id),
        .answer_valid      (answer_valid),
        .answer_slot       (answer_slot),
        .answer_id         (answer_id),
        .answer_refused    (answer_refused),
        .setup_0_busy      (setup_0_busy),
        .setup_0_id        (setup_0_id),
        .setup_1_busy      (setup_1_busy),
        .setup_1_id        (setup_1_id),
        .setup_2_busy      (setup_2_busy),
        .setup_2_id        (setup_2_id),
        .fresh_s0          (fresh_s0),
        .admits            (admits),
        .ends              (ends),
        .returns           (returns),
        .free_slots        (free_slots),
        .\leaf_rays_0[0]   (ray_0),
        .\leaf_rays_0[1]   (ray_1),
        .\leaf_rays_0[2]   (ray_2),
        .\leaf_rays_0[3]   (ray_3),
        .\leaf_fifo.places_0[0]   (place_0),
        .\leaf_fifo.places_0[1]   (place_1),
        .\leaf_fifo.places_0[2]   (place_2),
        .\leaf_fifo.places_0[3]   (place_3),
        .\leaf_fifo.count         (count),
        .\leaf_fifo.write_pointer (write_pointer),
        .\leaf_fifo.read_pointer  (read_pointer)
    );

    wire leaves = started && hit_valid && hit_ready_i;

    // Is this place of the FIFO taken, with the oldest item where it reads?
    function is_taken(input [1:0] place, input [1:0] read, input [2:0] taken);
        reg [1:0] behind;
        begin
            behind = place - read;
            is_taken = {1'b0, behind} < taken;
        end
    endfunction

    wire [3:0] is_in_fifo = {
        is_taken(2'd3, read_pointer, count),
        is_taken(2'd2, read_pointer, count),
        is_taken(2'd1, read_pointer, count),
        is_taken(2'd0, read_pointer, count)
    };

    // Every slot is in one place, and only in one: free, in a stage, in the FIFO, or at the leaf
    // check. So no ray in a slot is lost or duplicated.
    genvar slot;
    generate
        for (slot = 0; slot < 4; slot = slot + 1) begin : places
            wire [16:0] are = {
                free_slots[slot],
                valid[0] && slot_s0 == slot,
                valid[1] && slot_s1 == slot,
                valid[2] && slot_s2 == slot,
                valid[3] && slot_s3 == slot,
                valid[4] && slot_s4 == slot,
                valid[5] && slot_s5 == slot,
                valid[6] && slot_s6 == slot,
                valid[7] && slot_s7 == slot,
                is_in_fifo[0] && place_0 == slot,
                is_in_fifo[1] && place_1 == slot,
                is_in_fifo[2] && place_2 == slot,
                is_in_fifo[3] && place_3 == slot,
                fetched_valid && fetched_slot == slot,
                waiting_valid && waiting_slot == slot,
                check_valid && check_slot == slot,
                answer_valid && answer_slot == slot
            };
            always @* if (started) begin
                assert (are != 17'd0);
                assert ((are & (are - 17'd1)) == 17'd0);
            end
        end
    endgenerate

    always @* if (started) begin
        // The FIFO's pointers hang together, and no walk that ends finds it full.
        assert (count <= 3'd4);
        assert (write_pointer == read_pointer + count[1:0]);
        assert (!ends || count != 3'd4);
    end

    // The watched slot holds the ray that was let into it, until its hit is taken.
    (* anyconst *) reg [1:0] watched_slot;
    reg [19:0] held_id = 20'd0;
    always @(posedge clk_i) if (started && admits && slot_s0_next == watched_slot) held_id <= setup_2_id;
    wire is_held = !free_slots[watched_slot];
    wire [47:0] held_ray = watched_slot == 2'd0 ? ray_0 :
                           watched_slot == 2'd1 ? ray_1 :
                           watched_slot == 2'd2 ? ray_2 : ray_3;
    always @* if (started) begin
        if (is_held) assert (held_ray[47:28] == held_id);
        if (fetched_valid && fetched_slot == watched_slot) assert (fetched_id == held_id);
        if (waiting_valid && waiting_slot == watched_slot) assert (waiting_id == held_id);
        if (check_valid && check_slot == watched_slot) assert (check_id == held_id);
        if (answer_valid && answer_slot == watched_slot) assert (answer_id == held_id);
        if (hit_valid && answer_slot == watched_slot) assert (hit_id == held_id);
    end

    // Every ray of the watched id that came and was not let into the loop is in a setup. The last
    // one holds a ray for a cycle after it was let in.
    (* anyconst *) reg [19:0] watched;
    reg [2:0] set_up = 3'd0;
    wire watched_enters = started && ray_valid_i && ray_ready && ray_id_i == watched;
    wire watched_admits = started && admits && setup_2_id == watched;
    always @(posedge clk_i)
        set_up <= started ? set_up + {2'd0, watched_enters} - {2'd0, watched_admits} : 3'd0;
    wire in_setup_0 = setup_0_busy && setup_0_id == watched;
    wire in_setup_1 = setup_1_busy && setup_1_id == watched;
    wire in_setup_2 = setup_2_busy && !fresh_s0 && setup_2_id == watched;
    always @* if (started) begin
        assert (set_up == {2'd0, in_setup_0} + {2'd0, in_setup_1} + {2'd0, in_setup_2});
        assert (!fresh_s0 || setup_2_busy);
        assert (!admits || (setup_2_busy && !fresh_s0));
    end

    // A hit that is offered stands until it is taken.
    reg held = 1'b0;
    wire [51:0] hit =
        {hit_id, hit_i, hit_j, hit_at_border_u, hit_at_border_v, hit_way, hit_slope, hit_depth};
    reg [51:0] hit_before;
    always @(posedge clk_i) begin
        held       <= started && hit_valid && !hit_ready_i;
        hit_before <= hit;
    end
    always @* if (started && held) assert (hit_valid && hit == hit_before);

    // All slots are taken, and walks wait; a refused walk goes back, and a hit leaves behind it.
    always @* cover (started && free_slots == 4'd0 && count == 3'd2);
    reg was_refused = 1'b0;
    always @(posedge clk_i)
        if (started && returns && answer_slot == watched_slot) was_refused <= 1'b1;
    always @* cover (leaves && was_refused && answer_slot == watched_slot);
endmodule

`default_nettype wire
