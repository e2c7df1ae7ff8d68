//! The blocks that clocked machines are made of, as Verilog: the twins of the models of the same
//! names in [`rtl_model::machine`]. Names, widths and reset values come from the declaration that
//! both share; what a block does is written here anew.

mod declared;
mod fifo;
mod height_cache;
mod read_port;

pub use declared::declared_probes;
pub use fifo::fifo;
pub use height_cache::height_cache;
pub use read_port::read_port;
