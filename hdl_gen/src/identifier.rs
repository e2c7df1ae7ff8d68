//! Which names Verilog takes.

/// The words Verilog-2005 keeps for itself (IEEE 1364-2005, annex B), and those SystemVerilog adds
/// that a signal is likely to be named by: files are read by tools of both.
const RESERVED: &str = "\
    always and assign automatic begin buf bufif0 bufif1 case casex casez cell cmos config \
    deassign default defparam design disable edge else end endcase endconfig endfunction \
    endgenerate endmodule endprimitive endspecify endtable endtask event for force forever \
    fork function generate genvar highz0 highz1 if ifnone incdir include initial inout input \
    instance integer join large liblist library localparam macromodule medium module nand \
    negedge nmos nor noshowcancelled not notif0 notif1 or output parameter pmos posedge \
    primitive pull0 pull1 pulldown pullup pulsestyle_ondetect pulsestyle_onevent rcmos real \
    realtime reg release repeat rnmos rpmos rtran rtranif0 rtranif1 scalared showcancelled \
    signed small specify specparam strong0 strong1 supply0 supply1 table task time tran \
    tranif0 tranif1 tri tri0 tri1 triand trior trireg unsigned use uwire vectored wait wand \
    weak0 weak1 while wire wor xnor xor alias assert assume before bind bit break byte \
    chandle checker class clocking const constraint context continue cover cross dist do \
    enum eventually expect export extends extern final foreach global iff implements implies \
    import inside int interface intersect let local logic longint matches modport new \
    nexttime null package packed priority program property protected pure rand randc \
    randcase ref restrict return sequence shortint shortreal solve static string strong \
    struct super tagged this throughout timeprecision timeunit type typedef union unique \
    until untyped var virtual void weak wildcard with within";

/// May a module, signal or instance have this name, in Verilog and in SystemVerilog?
pub fn is_identifier(name: &str) -> bool {
    let starts = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    let goes_on = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    starts && goes_on && !RESERVED.split(' ').any(|word| word == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keywords_and_odd_characters_are_refused() {
        assert!(is_identifier("exit_depth_u") && is_identifier("_a1"));
        for name in [
            "reg", "logic", "always", "within", "1st", "", "a.b", "a-b", "größe",
        ] {
            assert!(!is_identifier(name), "{name}");
        }
    }
}
