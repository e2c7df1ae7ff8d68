//! Which signals of two waveforms are the same signal.

use super::error::Names;
use super::reader::{Header, Variable};
use super::signal::joined;
use super::{CLOCK_NAME, INTEGER_SHADOW_SUFFIX, RESET_NAME, WaveError};
use std::collections::{BTreeSet, HashMap, HashSet};
use vcd::VarType;

/// Scopes of the other side that are tried as the one to strip, at most.
const MAX_CANDIDATES: usize = 64;

/// Scopes that stand around a design: Verilator's, and that of this project's testbenches.
const WRAPPERS: [&str; 2] = ["TOP", "testbench"];

/// The signals of a waveform that take part in a comparison, under the names they pair by.
#[derive(Debug, Default)]
pub(crate) struct Side {
    /// The scope whose content is compared; empty for the whole file.
    pub stripped: Vec<String>,
    /// Name without the stripped scope, and index into the header's variables; in file order.
    pub signals: Vec<(String, usize)>,
}

impl Side {
    /// The comparable signals below a scope: bits, but no clock, reset or decoded shadow.
    pub(crate) fn below(header: &Header, stripped: &[String]) -> Side {
        let own_names: HashSet<(usize, &str)> = header
            .variables
            .iter()
            .filter(|variable| variable.is_bits())
            .map(|variable| (variable.scope, variable.name.as_str()))
            .collect();
        let is_shadow = |variable: &Variable| {
            variable.kind == VarType::Integer
                && variable
                    .name
                    .strip_suffix(INTEGER_SHADOW_SUFFIX)
                    .is_some_and(|base| own_names.contains(&(variable.scope, base)))
        };
        let mut seen = HashSet::new();
        let mut signals = Vec::new();
        for (index, variable) in header.variables.iter().enumerate() {
            let is_control = [CLOCK_NAME, RESET_NAME].contains(&variable.name.as_str());
            if !variable.is_bits() || is_control || is_shadow(variable) {
                continue;
            }
            if let Some(name) = name_below(header, variable, stripped)
                && seen.insert(name.clone())
            {
                signals.push((name, index));
            }
        }
        Side {
            stripped: stripped.to_vec(),
            signals,
        }
    }

    /// Names, for messages.
    pub(crate) fn names(&self) -> Names {
        Names(self.signals.iter().map(|(name, _)| name.clone()).collect())
    }

    fn name_set(&self) -> HashSet<&str> {
        self.signals.iter().map(|(name, _)| name.as_str()).collect()
    }
}

/// The full name of a variable without a leading scope, if it stands below that scope.
fn name_below(header: &Header, variable: &Variable, stripped: &[String]) -> Option<String> {
    let below = header.scopes[variable.scope].strip_prefix(stripped)?;
    Some(joined(below, &variable.name))
}

/// A variable of this name below a scope, the outermost there is; of the whole file if there is
/// none below. (A design without registers has no clock of its own, its testbench may.)
pub(crate) fn outermost(header: &Header, stripped: &[String], name: &str) -> Option<usize> {
    let find = |below: &[String]| {
        let named = header.variables.iter().enumerate().filter(|(_, variable)| {
            variable.name == name
                && variable.is_bits()
                && variable.width == 1
                && header.scopes[variable.scope].starts_with(below)
        });
        named
            .min_by_key(|(_, variable)| header.scopes[variable.scope].len())
            .map(|(index, _)| index)
    };
    find(stripped).or_else(|| find(&[]))
}

/// A scope by its name with points, as the caller gave it.
pub(crate) fn scope_named(
    file: &str,
    header: &Header,
    scope: &str,
) -> Result<Vec<String>, WaveError> {
    let found = header.scopes.iter().find(|path| path.join(".") == scope);
    found.cloned().ok_or_else(|| WaveError::NoScope {
        name: file.to_owned(),
        scope: scope.to_owned(),
        has: Names(
            header.scopes[1..]
                .iter()
                .map(|path| path.join("."))
                .collect(),
        ),
    })
}

/// Finds what to strip from each side where the caller did not say, so that as many signals pair
/// as can. Nothing is stripped from a side where that pairs as many.
pub(crate) fn pair_sides(
    golden: &Header,
    other: &Header,
    golden_scope: Option<Vec<String>>,
    other_scope: Option<Vec<String>>,
) -> (Side, Side) {
    let golden_given = golden_scope.is_some();
    let other_given = other_scope.is_some();
    let mut golden_side = Side::below(golden, &golden_scope.unwrap_or_default());
    let mut other_side = Side::below(other, &other_scope.unwrap_or_default());
    let mut best = common_count(&golden_side, &other_side);
    let original = (golden_side.stripped.clone(), other_side.stripped.clone());
    if !other_given {
        for candidate in candidates(golden, &original.0, other) {
            let side = Side::below(other, &candidate);
            let count = common_count(&golden_side, &side);
            if count > best {
                (best, other_side) = (count, side);
            }
        }
    }
    if !golden_given && other_side.stripped == original.1 {
        for candidate in candidates(other, &original.1, golden) {
            let side = Side::below(golden, &candidate);
            let count = common_count(&side, &other_side);
            if count > best {
                (best, golden_side) = (count, side);
            }
        }
    }
    if best == 0 && !golden_given && !other_given {
        // Both may be wrapped, each its own way: two simulators' waveforms of one design.
        for (golden_scope, other_scope) in wrapped_alike(golden, other) {
            let sides = (
                Side::below(golden, &golden_scope),
                Side::below(other, &other_scope),
            );
            let count = common_count(&sides.0, &sides.1);
            if count > best {
                (best, (golden_side, other_side)) = (count, sides);
            }
        }
    }
    (golden_side, other_side)
}

/// What holds the outermost scope of one name on either side, for every name both have, if it is
/// known to hold designs: two different designs with one unit in common are not to be paired by it.
fn wrapped_alike(golden: &Header, other: &Header) -> Vec<(Vec<String>, Vec<String>)> {
    let holder = |header: &Header, name: &String| {
        let named = header.scopes.iter().filter_map(|scope| scope.split_last());
        named
            .filter(|(last, holder)| {
                *last == name && holder.iter().all(|scope| WRAPPERS.contains(&&scope[..]))
            })
            .min_by_key(|(_, holder)| holder.len())
            .map(|(_, holder)| holder.to_vec())
    };
    let names = golden.scopes.iter().filter_map(|scope| scope.last());
    let mut found: Vec<_> = names
        .take(MAX_CANDIDATES)
        .filter_map(|name| Some((holder(golden, name)?, holder(other, name)?)))
        .collect();
    found.dedup();
    found
}

fn common_count(golden: &Side, other: &Side) -> usize {
    let names = golden.name_set();
    let common = |(name, _): &&(String, usize)| names.contains(name.as_str());
    other.signals.iter().filter(common).count()
}

/// Scopes in `wrapped` that hold a scope named as one of the outermost (below `stripped`) of
/// `bare`, the outermost first: `TOP` if both have a `traverse`, one of them as `TOP.traverse`.
fn candidates(bare: &Header, stripped: &[String], wrapped: &Header) -> Vec<Vec<String>> {
    let tops: HashSet<&String> = bare
        .scopes
        .iter()
        .filter(|scope| scope.len() == stripped.len() + 1 && scope.starts_with(stripped))
        .filter_map(|scope| scope.last())
        .collect();
    let found: BTreeSet<(usize, &[String])> = wrapped
        .scopes
        .iter()
        .filter_map(|scope| scope.split_last())
        .filter(|(last, holder)| !holder.is_empty() && tops.contains(last))
        .map(|(_, holder)| (holder.len(), holder))
        .collect();
    let paths = found.into_iter().map(|(_, holder)| holder.to_vec());
    paths.take(MAX_CANDIDATES).collect()
}

/// Signals of one side by name.
pub(crate) fn by_name(side: &Side) -> HashMap<&str, usize> {
    let entries = side.signals.iter();
    entries
        .map(|(name, index)| (name.as_str(), *index))
        .collect()
}

/// The names that only the first side has. Signals of a testbench, beside the design in a scope
/// that was stripped without being asked for, are none of the design's.
pub(crate) fn only_in(side: &Side, other: &Side, scope_was_given: bool) -> Vec<String> {
    let there = other.name_set();
    let ignore_bare = !side.stripped.is_empty() && !scope_was_given;
    let own = side.signals.iter().map(|(name, _)| name);
    own.filter(|name| (!ignore_bare || name.contains('.')) && !there.contains(name.as_str()))
        .cloned()
        .collect()
}
