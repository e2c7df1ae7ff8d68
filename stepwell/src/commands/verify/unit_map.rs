//! The map where no scene gives any.

use rtl_model::maps::{Channel, MapSource};
use rtl_model::scene::SceneMap;

use crate::options::MapOptions;

/// Walked where no --map is given.
const DEFAULT_MAP: &str = "procedural:spikes:64:1";

/// The map for a unit on its own.
pub fn unit_map(options: &MapOptions) -> anyhow::Result<SceneMap> {
    match options.chosen() {
        Some(map) => Ok(map),
        None => Ok(SceneMap {
            source: MapSource::parse(DEFAULT_MAP)?,
            channel: Channel::default(),
            white_is_low: false,
        }),
    }
}
