//! Names close to a misspelt one, for error messages that show the way out.

/// At most this many names are offered.
const OFFERED: usize = 3;

/// The names of `known` closest to `wanted`, best first, each once; a few, or none where nothing
/// is close. The last component of a dotted path counts by itself too, so that a signal whose
/// instance was forgotten is found.
pub fn nearest_names<'a>(wanted: &str, known: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    let last = |path: &str| path.rsplit('.').next().unwrap_or_default().to_owned();
    let wanted_last = last(wanted);
    let tolerance = 1 + wanted.len() / 3;
    let mut scored: Vec<(usize, &str)> = known
        .into_iter()
        .filter_map(|name| {
            let whole = edit_distance(wanted, name);
            let tail = edit_distance(&wanted_last, &last(name));
            let close = whole <= tolerance || tail <= wanted_last.len() / 4;
            close.then_some((whole.min(tail + 1), name))
        })
        .collect();
    scored.sort_unstable();
    scored.dedup();
    scored.truncate(OFFERED);
    scored
        .into_iter()
        .map(|(_, name)| name.to_owned())
        .collect()
}

/// The end of an error message: which names are near, if any.
pub(crate) fn did_you_mean(near: &[String]) -> String {
    if near.is_empty() {
        String::new()
    } else {
        format!("; near it: {}", near.join(", "))
    }
}

/// Insertions, deletions and substitutions that turn one text into the other (Levenshtein).
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &to) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(from != to);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_levenshtein() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("depth", "depth"), 0);
    }

    #[test]
    fn offers_misspelt_names_and_forgotten_instances() {
        let known = ["step.exit_depth_u", "step.exit_depth_v", "valid_o"];
        assert_eq!(
            nearest_names("step.exit_deph_u", known),
            ["step.exit_depth_u", "step.exit_depth_v"]
        );
        assert_eq!(nearest_names("exit_depth_v", known)[0], "step.exit_depth_v");
        assert!(nearest_names("completely_else", known).is_empty());
    }
}
