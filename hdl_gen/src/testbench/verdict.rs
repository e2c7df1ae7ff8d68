//! What a testbench printed.

use serde::Serialize;

/// The outcome of a testbench.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Verdict {
    /// Did it end with `PASS`?
    pub passed: bool,
    /// Vectors that agreed.
    pub agreed: u64,
    /// Vectors there were.
    pub vectors: u64,
    /// The last line, as printed: it says why where it did not pass.
    pub line: String,
    /// The fields that differed in the first failing vectors.
    pub differences: Vec<FieldDifference>,
}

/// A field of a vector that was not as expected.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FieldDifference {
    /// The vector: its line in the file, from 0.
    pub vector: u64,
    /// The field.
    pub field: String,
    /// What it must be, in hexadecimal.
    pub expected: String,
    /// What it was, in hexadecimal; `x` where it was unknown.
    pub found: String,
}

impl Verdict {
    /// Reads the text a testbench printed; none where it ended without `PASS` or `FAIL`.
    ///
    /// A `PASS` that speaks of no vectors, or of others than agreed, is not one.
    pub fn read(printed: &str) -> Option<Verdict> {
        let differences = printed.lines().filter_map(difference).collect();
        let line = printed
            .lines()
            .rev()
            .find(|line| line.starts_with("PASS ") || line.starts_with("FAIL "))?;
        let mut words = line.split_whitespace();
        let passed = words.next() == Some("PASS");
        let agreed = words.next()?.parse().ok()?;
        let vectors = words.nth(1)?.parse().ok()?;
        Some(Verdict {
            passed: passed && agreed == vectors && vectors > 0,
            agreed,
            vectors,
            line: line.to_owned(),
            differences,
        })
    }
}

/// Reads `vector 17: result_o expected 3f0000 found 3f0001`.
fn difference(line: &str) -> Option<FieldDifference> {
    let (vector, rest) = line.strip_prefix("vector ")?.split_once(": ")?;
    let words: Vec<&str> = rest.split_whitespace().collect();
    let [field, "expected", expected, "found", found] = words[..] else {
        return None;
    };
    Some(FieldDifference {
        vector: vector.parse().ok()?,
        field: field.to_owned(),
        expected: expected.to_owned(),
        found: found.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_verdict_is_the_last_line_of_its_kind() {
        let verdict = Verdict::read("noise\nPASS 20 of 20 vectors agree\n$finish called\n");
        let verdict = verdict.unwrap();
        assert!(verdict.passed);
        assert_eq!((verdict.agreed, verdict.vectors), (20, 20));
        assert_eq!(Verdict::read("PASSED\nvector 3\n"), None);
    }

    #[test]
    fn a_pass_of_nothing_is_none() {
        assert!(!Verdict::read("PASS 0 of 0 vectors agree").unwrap().passed);
        assert!(!Verdict::read("PASS 19 of 20 vectors agree").unwrap().passed);
    }

    #[test]
    fn failing_fields_are_read() {
        let text = "vector 17: result_o expected 3f0000 found xx0001\n    operands a_i 0\n\
                    FAIL 19 of 20 vectors agree: results differ\n";
        let verdict = Verdict::read(text).unwrap();
        assert!(!verdict.passed);
        let expected = FieldDifference {
            vector: 17,
            field: "result_o".to_owned(),
            expected: "3f0000".to_owned(),
            found: "xx0001".to_owned(),
        };
        assert_eq!(verdict.differences, [expected]);
    }
}
