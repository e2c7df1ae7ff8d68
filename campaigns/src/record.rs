//! The file that says what was run last: one table a campaign, one line an operator.
//!
//! A run replaces its own lines and leaves the others, so that a campaign can be run operator by
//! operator, on several days.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::Path;

use anyhow::{Context, bail};

use crate::row::Row;
use crate::tier::Tier;

/// What a campaign's table looks like.
pub struct TableShape {
    /// The campaign, whose place in the file it is.
    pub campaign: &'static str,
    /// The names of the columns.
    pub columns: &'static [&'static str],
    /// The line of Markdown below them, but for its first bar.
    pub alignment: &'static str,
    /// So many columns, the first, tell lines apart.
    pub key_columns: usize,
}

/// The columns of a campaign of operators; the first four tell lines apart.
const COLUMNS: [&str; 12] = [
    "operator",
    "format",
    "policy",
    "against",
    "roundings",
    "cases",
    "differences",
    "seconds",
    "cases/s",
    "tier, seed",
    "date",
    "version",
];

/// The table of a campaign of operators.
fn operators(campaign: &'static str) -> TableShape {
    TableShape {
        campaign,
        columns: &COLUMNS,
        alignment: "---|---|---|---|---|--:|--:|--:|--:|---|---|---|",
        key_columns: 4,
    }
}

/// What stands before a campaign's table, and after it.
fn markers(campaign: &str) -> (String, String) {
    (
        format!("<!-- campaigns {campaign}: begin -->"),
        format!("<!-- campaigns {campaign}: end -->"),
    )
}

/// When and with what a campaign was run.
pub struct Provenance {
    /// Its size.
    pub tier: Tier,
    /// The day, `YYYY-MM-DD`.
    pub date: String,
    /// The version of the program and its commit.
    pub version: String,
}

/// Puts rows of one campaign into the file, which has a place for it.
///
/// # Errors
/// If the file cannot be read or written, or has no such place.
pub fn record(path: &Path, rows: &[Row], provenance: &Provenance) -> anyhow::Result<()> {
    let Some(campaign) = rows.first().map(|row| row.campaign) else {
        return Ok(());
    };
    let lines = rows.iter().map(|row| cells(row, provenance)).collect();
    record_lines(path, &operators(campaign), lines)
}

/// Puts lines of a table into the file, which has a place for it; each replaces the one that has
/// the same cells in the key columns.
///
/// # Errors
/// If the file cannot be read or written, or has no such place.
pub fn record_lines(
    path: &Path,
    shape: &TableShape,
    lines: Vec<Vec<String>>,
) -> anyhow::Result<()> {
    let campaign = shape.campaign;
    let name = path.display();
    let text = fs::read_to_string(path).with_context(|| format!("{name}: cannot be read"))?;
    let text = updated(&text, shape, lines)
        .with_context(|| format!("{name}: no place for `{campaign}`"))?;
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let mut file = tempfile::NamedTempFile::new_in(folder)
        .with_context(|| format!("{name}: cannot be written"))?;
    file.write_all(text.as_bytes())
        .and_then(|()| file.as_file().sync_all())
        .with_context(|| format!("{name}: cannot be written"))?;
    // A temporary file is the owner's alone; this one is like the one it replaces.
    if let Ok(old) = fs::metadata(path) {
        let _ = fs::set_permissions(file.path(), old.permissions());
    }
    file.persist(path)
        .with_context(|| format!("{name}: cannot be written"))?;
    Ok(())
}

fn updated(text: &str, shape: &TableShape, new: Vec<Vec<String>>) -> anyhow::Result<String> {
    let (begin, end) = markers(shape.campaign);
    let Some((before, rest)) = text.split_once(&begin) else {
        bail!("it lacks the line {begin}");
    };
    let Some((table, after)) = rest.split_once(&end) else {
        bail!("it lacks the line {end}");
    };
    let mut lines: BTreeMap<Vec<String>, Vec<String>> = BTreeMap::new();
    for line in table.lines().filter(|line| line.starts_with("| ")).skip(1) {
        let cells: Vec<String> = line
            .trim_matches('|')
            .split('|')
            .map(|cell| cell.trim().to_owned())
            .collect();
        if cells.len() == shape.columns.len() {
            lines.insert(cells[..shape.key_columns].to_vec(), cells);
        }
    }
    for cells in new {
        lines.insert(cells[..shape.key_columns].to_vec(), cells);
    }
    let mut table = format!("| {} |\n|", shape.columns.join(" | "));
    table += &format!("{}\n", shape.alignment);
    for cells in lines.values() {
        table += &format!("| {} |\n", cells.join(" | "));
    }
    Ok(format!("{before}{begin}\n{table}{end}{after}"))
}

fn cells(row: &Row, provenance: &Provenance) -> Vec<String> {
    let cases = match row.exhaustive {
        true => format!("{} (all)", grouped(row.cases)),
        false => grouped(row.cases),
    };
    let tier = match row.seed {
        Some(seed) => format!("{}, {seed}", provenance.tier),
        None => provenance.tier.to_string(),
    };
    vec![
        row.operator.clone(),
        row.format.clone(),
        row.policy.clone(),
        row.judge.clone(),
        row.roundings.clone(),
        cases,
        row.differences.to_string(),
        format!("{:.1}", row.seconds),
        grouped(row.rate().round() as u64),
        tier,
        provenance.date.clone(),
        provenance.version.clone(),
    ]
}

/// Digits in groups of three.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(operator: &str, differences: u64) -> Row {
        Row {
            campaign: "softfloat",
            operator: operator.to_owned(),
            format: "e8f23".to_owned(),
            policy: "full".to_owned(),
            roundings: "rne rtz".to_owned(),
            judge: "SoftFloat f32".to_owned(),
            cases: 1_234_567,
            exhaustive: false,
            differences,
            seconds: 2.0,
            seed: Some(1),
            first: Vec::new(),
        }
    }

    #[test]
    fn a_run_replaces_its_own_lines_only() {
        let provenance = Provenance {
            tier: Tier::Quick,
            date: "2026-01-02".to_owned(),
            version: "0.1.0".to_owned(),
        };
        let (begin, end) = markers("softfloat");
        let text = format!("# Head\n\n{begin}\n{end}\ntail\n");
        let put = |text: &str, rows: &[Row]| {
            let lines = rows.iter().map(|row| cells(row, &provenance)).collect();
            updated(text, &operators("softfloat"), lines)
        };
        let once = put(&text, &[row("mul", 3), row("add", 0)]).unwrap();
        assert!(once.starts_with("# Head\n"), "{once}");
        assert!(once.ends_with("\ntail\n"), "{once}");
        assert!(once.contains("| mul | e8f23 | full | SoftFloat f32 | rne rtz | 1 234 567 | 3 | 2.0 | 617 284 | quick, 1 |"), "{once}");
        assert!(once.find("| add |") < once.find("| mul |"), "{once}");
        let again = put(&once, &[row("mul", 0)]).unwrap();
        assert_eq!(again.matches("| mul |").count(), 1);
        assert_eq!(again.matches("| add |").count(), 1);
        assert!(!again.contains("| 3 |"), "{again}");
        assert!(put("# Head\n", &[]).is_err());
    }
}
