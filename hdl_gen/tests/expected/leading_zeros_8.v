// leading_zeros_8
//
// Zeros above the highest one bit; 8 where there is none.
//
// Latency: none, the outputs follow the inputs.
// Emitted by stepwell VERSION.

`default_nettype none

module leading_zeros_8 (
    input  wire [7:0] value_i,
    output wire [3:0] count_o,
    output wire       is_zero_o
);

    // ---- a ladder from the top bit down ----
    assign count_o = value_i[7] ? 4'd0 :
                     value_i[6] ? 4'd1 :
                     value_i[5] ? 4'd2 :
                     value_i[4] ? 4'd3 :
                     value_i[3] ? 4'd4 :
                     value_i[2] ? 4'd5 :
                     value_i[1] ? 4'd6 :
                     value_i[0] ? 4'd7 :
                                  4'd8;

    // ---- is it zero? ----
    assign is_zero_o = ~|value_i;

endmodule

`default_nettype wire
