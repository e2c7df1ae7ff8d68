//! The areas of standard cells, out of a Liberty file.

use std::collections::BTreeMap;

use super::AreaError;

/// What is counted in: the cell whose area is one gate equivalent.
const GATE: &str = "NAND2X1";

/// The cells of a library with their areas.
#[derive(Clone, Debug, PartialEq)]
pub struct Liberty {
    /// What the library calls itself.
    pub name: String,
    areas: BTreeMap<String, f64>,
    gate: f64,
}

impl Liberty {
    /// Reads the name of the library, and of every cell its area. Liberty is a tree of groups
    /// `kind(name) { ... }` and attributes `name : value;`.
    ///
    /// # Errors
    /// If that is not what the text is, or it has no two-input NAND gate to count in.
    pub fn read(text: &str) -> Result<Liberty, AreaError> {
        let problem = |what: &str| AreaError::Unreadable {
            tool: "the standard-cell library",
            what: what.to_owned(),
        };
        let text = without_comments(text);
        let mut name = None;
        let mut areas = BTreeMap::new();
        // The names of the groups that are open, with what they are.
        let mut open: Vec<(&str, &str)> = Vec::new();
        let mut rest = text.as_str();
        while let Some(end) = rest.find(['{', '}', ';']) {
            let statement = rest[..end].trim();
            match rest.as_bytes()[end] {
                b'{' => {
                    let group = group(statement).ok_or_else(|| problem(statement))?;
                    if open.is_empty() && group.0 == "library" {
                        name = Some(group.1.to_owned());
                    }
                    open.push(group);
                }
                b'}' => {
                    open.pop().ok_or_else(|| problem("a brace too many"))?;
                }
                _ => {
                    if let [("library", _), ("cell", cell)] = open[..]
                        && let Some(("area", value)) = attribute(statement)
                    {
                        let area = value.parse().ok().filter(|area: &f64| area.is_finite());
                        areas.insert(cell.to_owned(), area.ok_or_else(|| problem(statement))?);
                    }
                }
            }
            rest = &rest[end + 1..];
        }
        if !open.is_empty() {
            return Err(problem("it ends within a group"));
        }
        let name = name.ok_or_else(|| problem("it is no library"))?;
        let gate = areas.get(GATE).copied().filter(|area| *area > 0.0);
        let gate = gate.ok_or_else(|| problem("it has no cell NAND2X1 to count in"))?;
        Ok(Liberty { name, areas, gate })
    }

    /// The area of a cell; None of one that is not in the library.
    pub fn area(&self, cell: &str) -> Option<f64> {
        self.areas.get(cell).copied()
    }

    /// An area in gate equivalents: the library's smallest two-input NAND gates.
    pub fn gate_equivalents(&self, area: f64) -> f64 {
        area / self.gate
    }
}

/// `kind` and `name` of `kind(name)`, `kind ("name")`; the name may be empty.
fn group(statement: &str) -> Option<(&str, &str)> {
    let (kind, name) = statement.split_once('(')?;
    let name = name.strip_suffix(')')?.trim().trim_matches('"');
    Some((kind.trim(), name))
}

/// `name` and `value` of `name : value`.
fn attribute(statement: &str) -> Option<(&str, &str)> {
    let (name, value) = statement.split_once(':')?;
    Some((name.trim(), value.trim().trim_matches('"')))
}

fn without_comments(text: &str) -> String {
    let mut parts = text.split("/*");
    let mut kept = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        kept.push_str(part.split_once("*/").map_or("", |(_, after)| after));
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELLS: &str = "/* of { no } matter; */ library(two) { unit : \"1ns\"; \
        define(x, y); cell (NAND2X1) { area : 24; pin(A) { area : 7; timing() { } } } \
        cell(\"DFF\") { ff (IQ,IQN) { next : \"D\"; } area : 96.5 ; } }";

    #[test]
    fn cells_have_their_areas_and_pins_do_not_count() {
        let cells = Liberty::read(CELLS).unwrap();
        assert_eq!(cells.name, "two");
        assert_eq!(cells.area("NAND2X1"), Some(24.0));
        assert_eq!(cells.area("DFF"), Some(96.5));
        assert_eq!(cells.area("A"), None);
        assert_eq!(cells.gate_equivalents(48.0), 2.0);
    }

    #[test]
    fn what_is_no_library_is_refused() {
        for (old, new) in [
            ("NAND2X1", "NOT"),
            ("24", "much"),
            ("24", "inf"),
            ("24", "0"),
            ("library(two)", "folder(two)"),
            ("library(two)", "library"),
            ("96.5 ; } }", "96.5 ; }"),
            ("96.5 ; } }", "96.5 ; } } }"),
        ] {
            assert!(CELLS.contains(old));
            let broken = CELLS.replacen(old, new, 1);
            assert!(Liberty::read(&broken).is_err(), "{broken}");
        }
        assert!(Liberty::read("").is_err());
        // However it is cut off, it is refused and nothing panics.
        for end in 0..CELLS.len() {
            assert!(Liberty::read(&CELLS[..end]).is_err(), "{end}");
        }
    }
}
