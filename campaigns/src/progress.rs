//! A bar on the terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar from 0 to `total` cases of something, on standard error, only where that is a terminal.
pub fn bar(total: u64, of: &str) -> ProgressBar {
    let template = format!("{of} {{wide_bar}} {{pos}} of {{len}}, {{eta}} left");
    let bar = ProgressBar::new(total);
    match ProgressStyle::with_template(&template) {
        Ok(style) => bar.with_style(style),
        // The template is fixed but for a name; a plain bar does as well.
        Err(_) => bar,
    }
}
