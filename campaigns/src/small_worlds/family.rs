//! The line of a record for a world: what all methods that promise the same came to in it.

use std::time::Duration;

use rtl_model::judge::Verdict;
use rtl_model::scene::WalkFormat;

use super::{MethodOutcome, World};
use crate::record::{Provenance, TableShape, grouped};

/// The table of the record.
pub const FAMILY_TABLE: TableShape = TableShape {
    campaign: "small-worlds",
    columns: &[
        "format",
        "maps and rays",
        "promise",
        "methods",
        "walks",
        "broken",
        "early",
        "late",
        "guards",
        "refused",
        "seconds",
        "tier, seed",
        "date",
        "version",
    ],
    alignment: "---|---|---|--:|--:|--:|--:|--:|--:|--:|--:|---|---|---|",
    key_columns: 3,
};

/// Sums over the methods that promise the same.
#[derive(Clone, Debug, PartialEq)]
pub struct FamilyRow {
    /// The number format.
    pub format: String,
    /// The world's name.
    pub world: String,
    /// What is promised.
    pub promise: &'static str,
    /// How many methods.
    pub methods: u64,
    /// Are these all the maps there are?
    pub is_complete: bool,
    /// All walks.
    pub verdict: Verdict,
    /// Walks that break the promise.
    pub broken: u64,
    /// Rays that the format or the unit refuses, once for each method.
    pub refused: u64,
    /// Time of walking and judging, over all threads.
    pub duration: Duration,
}

impl FamilyRow {
    /// The rows of a world: one for each promise, in the order of the methods.
    pub fn of(format: WalkFormat, world: &World, outcomes: &[MethodOutcome]) -> Vec<FamilyRow> {
        let mut rows: Vec<FamilyRow> = Vec::new();
        for outcome in outcomes {
            if outcome.unsupported.is_some() {
                continue;
            }
            let promise = outcome.promise.name();
            let place = rows.iter().position(|row| row.promise == promise);
            let place = place.unwrap_or_else(|| {
                rows.push(FamilyRow {
                    format: format.to_string(),
                    world: world.name(),
                    promise,
                    methods: 0,
                    is_complete: world.maps.is_complete(),
                    verdict: Verdict::default(),
                    broken: 0,
                    refused: 0,
                    duration: Duration::ZERO,
                });
                rows.len() - 1
            });
            let row = &mut rows[place];
            row.methods += 1;
            row.verdict = row.verdict.plus(outcome.verdict);
            row.broken += outcome.defects;
            row.refused += outcome.refused;
            row.duration += outcome.duration;
        }
        rows
    }

    /// The line of [`FAMILY_TABLE`]; `seed` is that of sampled maps.
    pub fn cells(&self, seed: u64, provenance: &Provenance) -> Vec<String> {
        let (walks, tier) = (grouped(self.verdict.rays), provenance.tier);
        let (walks, tier) = match self.is_complete {
            true => (format!("{walks} (all)"), tier.to_string()),
            false => (walks, format!("{tier}, {seed}")),
        };
        vec![
            self.format.clone(),
            self.world.clone(),
            self.promise.to_owned(),
            self.methods.to_string(),
            walks,
            grouped(self.broken),
            grouped(self.verdict.early),
            grouped(self.verdict.late),
            grouped(self.verdict.guards),
            grouped(self.refused),
            format!("{:.1}", self.duration.as_secs_f64()),
            tier,
            provenance.date.clone(),
            provenance.version.clone(),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::small_worlds::{MapSet, RaySet};
    use crate::tier::Tier;
    use rtl_model::scene::Method;

    #[test]
    fn a_row_sums_all_methods_and_shows_what_one_breaks() {
        let world = World {
            maps: MapSet::all(0),
            rays: RaySet::FourBits { entry_bits: 1 },
        };
        let format: WalkFormat = "e7f16".parse().unwrap();
        let methods = [Method::Oh, Method::Block, Method::Window];
        // One method's answers are planted late.
        let rows = |late: f64| {
            let outcomes = world.judge(format, &methods, &|_| {}, &|method, _, mut hit| {
                if method == Method::Block {
                    hit.t += late;
                }
                hit
            });
            FamilyRow::of(format, &world, &outcomes.unwrap())
        };
        let [row]: [FamilyRow; 1] = rows(0.0).try_into().unwrap();
        let walks = row.verdict.rays / 3;
        assert_eq!((row.methods, row.broken, row.verdict.late), (3, 0, 0));
        assert!(walks > 0 && row.verdict.right == 3 * walks, "{row:?}");
        let [broken]: [FamilyRow; 1] = rows(2.0).try_into().unwrap();
        assert_eq!((broken.broken, broken.verdict.late), (walks, walks));
        let provenance = Provenance {
            tier: Tier::Quick,
            date: "2026-01-02".to_owned(),
            version: "0.1.0".to_owned(),
        };
        let cells = broken.cells(1, &provenance);
        assert_eq!(cells.len(), FAMILY_TABLE.columns.len());
        assert_eq!(cells[5], grouped(walks));
        assert!(cells[4].ends_with("(all)"), "{cells:?}");
    }
}
