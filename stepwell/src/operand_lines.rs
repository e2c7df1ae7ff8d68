//! Operand files: the lines of hexadecimal words by which strangers check the golden arithmetic.

use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Context, anyhow, bail};

/// The most operands that an operator has.
pub const MOST_OPERANDS: usize = 3;

/// The longest line that is read: far more than the operands need.
const LONGEST_LINE: u64 = 1 << 12;

/// Memory for reading ahead.
const READ_AHEAD: usize = 1 << 17;

/// Where operands come from.
#[derive(Clone, Debug)]
pub enum OperandSource {
    /// `-`
    StandardInput,
    /// A file.
    File(PathBuf),
}

impl FromStr for OperandSource {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text {
            "-" => OperandSource::StandardInput,
            path => OperandSource::File(path.into()),
        })
    }
}

impl fmt::Display for OperandSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OperandSource::StandardInput => f.write_str("standard input"),
            OperandSource::File(path) => write!(f, "{}", path.display()),
        }
    }
}

impl OperandSource {
    /// Opens it. Each line has an operand for every one of these widths; where that is one, a second
    /// word may follow.
    ///
    /// # Errors
    /// If the file is missing or cannot be read.
    pub fn open(&self, widths: &[u32]) -> anyhow::Result<OperandLines<'_>> {
        let (input, bytes): (Box<dyn Read>, u64) = match self {
            OperandSource::StandardInput => (Box::new(io::stdin().lock()), 0),
            OperandSource::File(path) => {
                let opened = File::open(path).and_then(|file| {
                    let metadata = file.metadata()?;
                    if metadata.is_dir() {
                        return Err(io::ErrorKind::IsADirectory.into());
                    }
                    Ok((file, metadata.len()))
                });
                let (file, length) = opened.map_err(|cause| {
                    anyhow!(
                        "operands {self}: cannot be read ({cause}); check the path, or give - for \
                         standard input"
                    )
                })?;
                (Box::new(file), length)
            }
        };
        Ok(OperandLines {
            source: self,
            widths: widths.to_vec(),
            input: BufReader::with_capacity(READ_AHEAD, input),
            line: Vec::new(),
            number: 0,
            blank: None,
            bytes,
        })
    }
}

/// The lines of an operand file, one at a time in the same memory.
pub struct OperandLines<'a> {
    source: &'a OperandSource,
    widths: Vec<u32>,
    input: BufReader<Box<dyn Read>>,
    line: Vec<u8>,
    /// Lines read so far.
    number: u64,
    /// The first blank line.
    blank: Option<u64>,
    /// Length of the file, where it is known.
    bytes: u64,
}

/// The operands of a line. Of an operator with one, `ignored` is what follows it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operands {
    /// The words that the operator reads; 0 beyond them.
    pub words: [u64; MOST_OPERANDS],
    /// A second word where the operator has one operand.
    pub ignored: Option<u64>,
}

impl OperandLines<'_> {
    /// Bytes of the file, 0 where that is not known.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The next operands, and how many bytes they took; none at the end.
    ///
    /// # Errors
    /// If the line is not of the form; the message names it and the way out.
    #[inline]
    pub fn next(&mut self) -> anyhow::Result<Option<(Operands, u64)>> {
        let mut taken = 0;
        loop {
            self.line.clear();
            let mut limited = self.input.by_ref().take(LONGEST_LINE);
            let length = limited
                .read_until(b'\n', &mut self.line)
                .with_context(|| format!("operands {}: cannot be read", self.source))?
                as u64;
            if length == 0 {
                return Ok(None);
            }
            self.number += 1;
            taken += length;
            match self.parse() {
                Ok(None) => {
                    self.blank.get_or_insert(self.number);
                }
                // Blank lines at the end are nobody's; one before operands would shift the answers.
                Ok(Some(operands)) => match self.blank {
                    None => return Ok(Some((operands, taken))),
                    Some(blank) => {
                        bail!("operands {}, line {blank}: blank; remove it", self.source)
                    }
                },
                Err(problem) => bail!("operands {}, line {}: {problem}", self.source, self.number),
            }
        }
    }

    /// The operands of this line; none if it is blank.
    fn parse(&self) -> Result<Option<Operands>, String> {
        let mut operands = Operands::default();
        let mut count = 0;
        let mut words = self
            .line
            .split(|byte| byte.is_ascii_whitespace())
            .filter(|word| !word.is_empty());
        for (place, &width) in self.widths.iter().enumerate() {
            let Some(word) = words.next() else {
                break;
            };
            operands.words[place] = parse_word(word, width)?;
            count += 1;
        }
        if count == 0 {
            return Ok(None);
        }
        if count < self.widths.len() {
            let plural = if count == 1 { "" } else { "s" };
            return Err(format!(
                "{count} operand{plural}; this operator has {}, each in hexadecimal",
                self.widths.len()
            ));
        }
        if count == 1
            && let Some(word) = words.next()
        {
            operands.ignored = Some(parse_word(word, u64::BITS)?);
        }
        if words.next().is_some() {
            return Err(match self.widths.len() {
                1 => "more than two words; this operator has one operand, and a second word is \
                      ignored"
                    .to_owned(),
                most => format!("more than {most} words; this operator has {most} operands"),
            });
        }
        if !self.line.ends_with(b"\n") && self.line.len() as u64 == LONGEST_LINE {
            return Err(format!(
                "longer than {LONGEST_LINE} bytes; give one operation a line"
            ));
        }
        Ok(Some(operands))
    }
}

/// A hexadecimal word of so many bits, `0x` before it or not.
fn parse_word(word: &[u8], width: u32) -> Result<u64, String> {
    let digits = match word {
        [b'0', b'x' | b'X', rest @ ..] => rest,
        all => all,
    };
    let mut value = 0_u64;
    let mut too_wide = false;
    let mut is_number = !digits.is_empty();
    for &byte in digits {
        let Some(digit) = (byte as char).to_digit(16) else {
            is_number = false;
            break;
        };
        too_wide |= value >> 60 != 0;
        value = value << 4 | u64::from(digit);
    }
    if !is_number {
        return Err(format!("`{}` is not hexadecimal", shown(word)));
    }
    if too_wide || value > u64::MAX >> (u64::BITS - width) {
        return Err(format!("`{}` has more than {width} bits", shown(word)));
    }
    Ok(value)
}

/// A word of a file for a message: cut where it is long, on one line whatever it holds.
fn shown(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(word);
    let mut shown: String = text.chars().take(LONGEST).collect();
    if shown.len() < text.len() {
        shown.push_str("...");
    }
    shown.escape_debug().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read_in_either_case_and_within_their_width() {
        assert_eq!(parse_word(b"3f8000", 24), Ok(0x3f8000));
        assert_eq!(parse_word(b"0X3F", 24), Ok(0x3f));
        assert_eq!(parse_word(b"0000000000000000000001", 1), Ok(1));
        assert_eq!(parse_word(b"FFFFFFFFFFFFFFFF", 64), Ok(u64::MAX));
        for (word, width) in [(&b"1000000"[..], 24), (b"10000000000000000", 64), (b"2", 1)] {
            let message = parse_word(word, width).unwrap_err();
            assert!(message.contains("bits"), "{message}");
        }
        for word in [&b"0x"[..], b"3g", b"-1", b"+1", b"\xff"] {
            let message = parse_word(word, 24).unwrap_err();
            assert!(message.contains("not hexadecimal"), "{message}");
        }
    }
}
