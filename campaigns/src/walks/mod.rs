//! The exact fixed-point walk against a walk of the texels one by one, both in integers, over many
//! millions of rays; and how often the texel of a quantised ray is not that of the ray it was
//! quantised from.

mod compare;
mod judge;
mod rays;
mod scenes;

pub use compare::{Departure, compare, departures};
pub use judge::{TexelHit, texel_walk};
pub use rays::RaySource;
pub use scenes::{Variant, WalkScene, height_maps};
