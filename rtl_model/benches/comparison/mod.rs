//! Subjects timed beside their rivals, in one run, and the table of what came out.

// Each of the programs that share this file uses a part of it.
#![allow(dead_code)]

use rustix::time::{ClockId, clock_gettime};
use std::fmt::Display;

/// Seconds of the quickest of `runs` rounds, for each subject. In a round every subject runs once, so
/// that a machine that is busy for a while is busy for all; the quickest round is the one that was
/// disturbed least. Seconds are those of this thread alone: while another program has the
/// processor, they stand still.
pub fn quickest<const N: usize>(runs: usize, mut subjects: [&mut dyn FnMut(); N]) -> [f64; N] {
    let mut best = [f64::INFINITY; N];
    for _ in 0..runs {
        for (best, subject) in best.iter_mut().zip(&mut subjects) {
            let start = seconds_of_this_thread();
            subject();
            *best = best.min(seconds_of_this_thread() - start);
        }
    }
    best
}

fn seconds_of_this_thread() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// What a ratio is to be.
#[derive(Clone, Copy)]
pub enum Target {
    /// Ours takes at most so many times as long as the rival.
    TimeAtMost(f64),
    /// Ours is at least so many times as fast.
    SpeedAtLeast(f64),
    /// For information: how many times as fast.
    Speed,
    /// For information: how many times as long.
    Time,
}

/// Prints a row: what it is about, nanoseconds of ours, the rival and its nanoseconds, the ratio, and
/// whether the target is met. The answer is false where it is not.
pub fn print_row(
    what: impl Display,
    ours: f64,
    rival: impl Display,
    rivals: f64,
    target: Target,
) -> bool {
    let (ratio, words, wanted, met) = match target {
        Target::TimeAtMost(most) => {
            let ratio = ours / rivals;
            (
                ratio,
                "x its time",
                format!("<= {most}"),
                Some(ratio <= most),
            )
        }
        Target::SpeedAtLeast(least) => {
            let ratio = rivals / ours;
            (
                ratio,
                "x as fast",
                format!(">= {least}"),
                Some(ratio >= least),
            )
        }
        Target::Speed => (rivals / ours, "x as fast", String::new(), None),
        Target::Time => (ours / rivals, "x its time", String::new(), None),
    };
    let verdict = match met {
        Some(true) => "met",
        Some(false) => "MISSED",
        None => "",
    };
    println!(
        "{what:34} {ours:8.3} ns   {rival:32} {rivals:8.3} ns   {ratio:6.2} {words:10} {wanted:7} {verdict}"
    );
    met != Some(false)
}

/// The last line: how many targets were missed.
pub fn print_missed(rows: &[bool]) {
    let missed = rows.iter().filter(|&&met| !met).count();
    println!("targets missed: {missed} of {}", rows.len());
}
