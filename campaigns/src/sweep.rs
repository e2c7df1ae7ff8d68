//! A run over numbered cases, in parallel, the same whatever the number of threads.

use std::ops::Range;
use std::time::{Duration, Instant};

use rayon::prelude::*;

/// Cases handed to a thread at a time.
const CHUNK: u64 = 1 << 16;

/// Differences kept to be shown.
pub const SHOWN: usize = 8;

/// A case on which two sides differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Its number: with the seed it gives the operands again.
    pub index: u64,
    /// The operands.
    pub operands: Vec<u64>,
    /// What one side has: a result and flags, or several results.
    pub golden: Vec<u64>,
    /// What the other has.
    pub other: Vec<u64>,
}

/// What came of a run.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Cases tried.
    pub cases: u64,
    /// Cases on which the two sides differ.
    pub differences: u64,
    /// The first of them.
    pub first: Vec<Difference>,
    /// How long it took.
    pub duration: Duration,
}

impl Outcome {
    /// Both runs as one; `other` comes after this.
    pub fn and(mut self, other: Outcome) -> Outcome {
        self.cases += other.cases;
        self.differences += other.differences;
        self.first.extend(other.first);
        self.first.truncate(SHOWN);
        self.duration += other.duration;
        self
    }
}

/// Tries cases 0 to `count` in chunks. `check` tells of a chunk's differences, in order;
/// `progress` is told of the cases done.
pub fn sweep(
    count: u64,
    check: impl Fn(Range<u64>, &mut dyn FnMut(Difference)) + Sync,
    progress: &(dyn Fn(u64) + Sync),
) -> Outcome {
    let begin = Instant::now();
    let outcome = (0..count.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let cases = chunk * CHUNK..count.min((chunk + 1) * CHUNK);
            let mut outcome = Outcome {
                cases: cases.end - cases.start,
                ..Outcome::default()
            };
            check(cases, &mut |difference| {
                outcome.differences += 1;
                if outcome.first.len() < SHOWN {
                    outcome.first.push(difference);
                }
            });
            progress(outcome.cases);
            outcome
        })
        // Rayon keeps the order of what it reduces.
        .reduce(Outcome::default, Outcome::and);
    Outcome {
        duration: begin.elapsed(),
        ..outcome
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn odd_ones(threads: usize) -> Outcome {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| {
            let check = |cases: Range<u64>, tell: &mut dyn FnMut(Difference)| {
                for index in cases.filter(|index| index % 100_003 == 7) {
                    tell(Difference {
                        index,
                        operands: vec![],
                        golden: vec![],
                        other: vec![],
                    });
                }
            };
            sweep(2_000_000, check, &|_| {})
        })
    }

    #[test]
    fn a_run_does_not_depend_on_the_number_of_threads() {
        let (one, three) = (odd_ones(1), odd_ones(3));
        assert_eq!((one.cases, one.differences), (2_000_000, 20));
        assert_eq!((three.cases, three.differences), (2_000_000, 20));
        assert_eq!(one.first, three.first);
        assert_eq!(one.first.len(), SHOWN);
        assert_eq!(one.first[0].index, 7);
    }
}
