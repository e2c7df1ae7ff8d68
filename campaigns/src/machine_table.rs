//! The line of a record for a machine: all maps and cameras together.

use rtl_model::scene::FrameSize;

use crate::machines::MachineRow;
use crate::record::{Provenance, TableShape, grouped};

/// What came of all frames of a machine.
pub const MACHINES_TABLE: TableShape = TableShape {
    campaign: "machines",
    columns: &[
        "machine",
        "stalls",
        "screen",
        "frames",
        "rays",
        "cycles compared",
        "signals",
        "mismatches",
        "lost",
        "twice",
        "wrong hits",
        "wrong texels",
        "cycles/pixel, mean of frames",
        "least occupancy",
        "bytes/pixel",
        "tier",
        "date",
        "version",
    ],
    alignment: "---|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|---|---|---|",
    key_columns: 3,
};

/// The line of [`MACHINES_TABLE`] for the frames of a machine with or without stalls.
pub fn machines_lines(
    rows: &[MachineRow],
    screen: FrameSize,
    provenance: &Provenance,
) -> Vec<String> {
    let Some(first) = rows.first() else {
        return Vec::new();
    };
    let sum = |count: fn(&MachineRow) -> u64| grouped(rows.iter().map(count).sum());
    let mean = |figure: fn(&MachineRow) -> f64| {
        format!(
            "{:.2}",
            rows.iter().map(figure).sum::<f64>() / rows.len() as f64
        )
    };
    let least = rows.iter().map(|row| row.occupancy).fold(1.0, f64::min);
    vec![
        first.machine.to_owned(),
        if first.stalls { "random" } else { "none" }.to_owned(),
        format!("{}x{}", screen.width, screen.height),
        rows.len().to_string(),
        sum(|row| row.rays),
        sum(|row| row.cycles_compared),
        first.signals.to_string(),
        sum(|row| row.mismatches),
        sum(|row| row.lost),
        sum(|row| row.duplicated),
        sum(|row| row.wrong_hits),
        sum(|row| row.wrong_texels),
        mean(|row| row.cycles_per_pixel),
        format!("{least:.3}"),
        mean(|row| row.bytes_per_pixel),
        provenance.tier.to_string(),
        provenance.date.clone(),
        provenance.version.clone(),
    ]
}
