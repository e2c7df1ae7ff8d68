//! What is said to the person or the program at the other end.

use std::io::{self, ErrorKind, Write};

use anyhow::Context;

/// Writes to standard output through `write`. A reader who has gone away, such as `head`, has seen
/// what it wanted: that is no error.
pub fn answer(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> anyhow::Result<()> {
    let mut output = io::BufWriter::new(io::stdout().lock());
    match write(&mut output).and_then(|()| output.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(error).context("standard output: cannot be written")
        }
        _ => Ok(()),
    }
}

/// One line on standard error, in the program's name.
pub fn complain(message: &str) {
    // Nobody can be told if even this fails.
    let _ = writeln!(io::stderr(), "stepwell: {}", one_line(message));
}

/// A message of several lines as one. The TOML reader's picture of the place, lines that start with
/// a line number and a bar, is left out: the message has the line and the column in words.
fn one_line(message: &str) -> String {
    let is_picture = |line: &str| {
        line.trim_start_matches(|letter: char| letter.is_ascii_digit() || letter == ' ')
            .starts_with('|')
    };
    let mut joined = String::new();
    for line in message.lines().filter(|line| !is_picture(line)) {
        let line = line.trim();
        if !joined.is_empty() && !line.is_empty() {
            joined.push_str(if joined.ends_with(':') { " " } else { ": " });
        }
        joined.push_str(line);
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_become_one_line_without_pictures() {
        assert_eq!(
            one_line("scene a.toml: at line 3\n   |\n 3 | x = 1\n   | ^\nunknown field `x`\n"),
            "scene a.toml: at line 3: unknown field `x`"
        );
        assert_eq!(one_line("plain"), "plain");
        assert_eq!(one_line("head:\n  tail"), "head: tail");
    }
}
