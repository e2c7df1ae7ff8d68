//! A bar on the terminal for work that takes a while.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar from 0 to `total` of the things named `unit`, on standard error, and only where that is a
/// terminal. A message, where one is set, says what is at work. Clear it with `finish_and_clear`.
pub fn bar(total: u64, unit: &str) -> ProgressBar {
    let template = format!("{{wide_bar}} {{pos}} of {{len}} {unit}, {{eta}} left {{msg}}");
    let bar = ProgressBar::new(total);
    match ProgressStyle::with_template(&template) {
        Ok(style) => bar.with_style(style),
        // The template is fixed but for the unit; a plain bar does as well.
        Err(_) => bar,
    }
}
