//! The lines of a record for whole frames: one for a format and a variant of the maps, over all methods,
//! and the steps of each method in a table of their own.

use rtl_model::scene::Method;

use crate::frames::FrameRow;
use crate::record::{Provenance, TableShape, grouped};

/// What came of all methods.
pub const FRAMES_TABLE: TableShape = TableShape {
    campaign: "frames",
    columns: &[
        "format",
        "map",
        "screen",
        "methods",
        "rays of each",
        "refused",
        "most wrong",
        "%",
        "by",
        "late",
        "guards",
        "earliest by",
        "tier",
        "date",
        "version",
    ],
    alignment: "---|---|---|--:|--:|--:|--:|--:|---|--:|--:|--:|---|---|---|",
    key_columns: 3,
};

/// Steps of a ray in the mean, for each method.
pub const STEPS_TABLE: TableShape = TableShape {
    campaign: "frames steps",
    columns: &[
        "format",
        "map",
        "screen",
        "texel",
        "oh",
        "tevs",
        "drobot",
        "start-level",
        "multi-level-down",
        "selective-up",
        "coherent-up",
        "mixed-selective",
        "mixed-coherent",
        "quad",
        "block",
        "window",
    ],
    alignment: "---|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|",
    key_columns: 3,
};

/// The methods of [`STEPS_TABLE`]: all that promise not to miss.
pub fn recorded_methods() -> Vec<Method> {
    Method::ALL.into_iter().filter(|m| m.is_safe()).collect()
}

/// The line of [`FRAMES_TABLE`] for the rows of a run: a format, a variant, every method.
///
/// `late` and `guards` are of all methods together; `most wrong` is of the one that has most.
pub fn frames_line(rows: &[FrameRow], provenance: &Provenance) -> Vec<String> {
    let Some(worst) = rows.iter().max_by_key(|row| row.wrong) else {
        return Vec::new();
    };
    let sum = |count: fn(&FrameRow) -> u64| grouped(rows.iter().map(count).sum());
    let most_early = rows.iter().map(|row| row.most_early).fold(0.0, f64::max);
    vec![
        worst.format.clone(),
        worst.variant.clone(),
        worst.screen.clone(),
        rows.len().to_string(),
        grouped(worst.rays),
        grouped(worst.refused),
        grouped(worst.wrong),
        format!(
            "{:.4}",
            100.0 * worst.wrong as f64 / worst.rays.max(1) as f64
        ),
        match worst.wrong {
            0 => "-".to_owned(),
            _ => worst.method.clone(),
        },
        sum(|row| row.late),
        sum(|row| row.guards),
        format!("{most_early:.1e}"),
        provenance.tier.to_string(),
        provenance.date.clone(),
        provenance.version.clone(),
    ]
}

/// The line of [`STEPS_TABLE`] for the rows of a run.
pub fn steps_line(rows: &[FrameRow]) -> Vec<String> {
    let Some(row) = rows.first() else {
        return Vec::new();
    };
    let mut cells = vec![row.format.clone(), row.variant.clone(), row.screen.clone()];
    cells.extend(STEPS_TABLE.columns[3..].iter().map(|method| {
        let row = rows.iter().find(|row| row.method == *method);
        row.map_or("-".to_owned(), |row| format!("{:.2}", row.mean_steps))
    }));
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tier::Tier;

    #[test]
    fn steps_have_a_column_for_every_method() {
        let names: Vec<String> = recorded_methods().iter().map(Method::to_string).collect();
        assert_eq!(names, STEPS_TABLE.columns[3..]);
    }

    #[test]
    fn a_line_tells_the_worst_method_and_counts_all() {
        let row = |method: &str, wrong, late| FrameRow {
            method: method.to_owned(),
            format: "e7f16".to_owned(),
            variant: "own".to_owned(),
            screen: "64x48".to_owned(),
            rays: 1000,
            refused: 2,
            wrong,
            late,
            guards: 1,
            most_early: 0.001 * wrong as f64,
            mean_steps: 3.5,
            seconds: 1.0,
            most_wrong_share: 0.5,
            agreed: true,
        };
        let rows = [row("oh", 1, 4), row("block", 3, 0), row("quad", 0, 5)];
        let provenance = Provenance {
            tier: Tier::Quick,
            date: "2026-01-02".to_owned(),
            version: "0.1.0".to_owned(),
        };
        let line = frames_line(&rows, &provenance);
        assert_eq!(line.len(), FRAMES_TABLE.columns.len());
        let told = [
            "3", "1 000", "2", "3", "0.3000", "block", "9", "3", "3.0e-3",
        ];
        assert_eq!(line[3..12], told);
        let steps = steps_line(&rows);
        assert_eq!(steps.len(), STEPS_TABLE.columns.len());
        assert_eq!(steps.iter().filter(|cell| *cell == "3.50").count(), 3);
    }
}
