//! Height maps: from files and from recipes, and the pyramid of maximum heights over them.

mod error;
mod height_map;
mod larger;
mod lines;
mod load;
mod noise;
mod procedural;
mod pyramid;
mod source;
mod windows;

pub use error::MapError;
pub use height_map::{HeightMap, MAX_SIZE};
pub use larger::{Enlargement, enlarged, tiled};
pub use lines::{Lines, line_address};
pub use load::Channel;
pub use procedural::{Pattern, Procedural};
pub use pyramid::{Pyramid, node_address};
pub use source::MapSource;
pub use windows::{WINDOW_SIDE, all_windows, window};
