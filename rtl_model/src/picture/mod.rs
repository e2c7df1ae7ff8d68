//! Pictures of a frame of hits: shaded, and as maps of its steps and depths; and plots of figures.

mod canvas;
mod chart;
mod colour;
mod frame;
mod plot;
mod save;
mod shade;
mod waves;

pub use chart::{Extent, depth_picture, steps_picture};
pub use frame::{Frame, FrameError, PixelHit};
pub use plot::{Plot, PlotAxis, Series};
pub use save::{SaveError, save_png};
pub use shade::shaded_picture;
pub use waves::{Wave, Waves};
