//! Ray files and hit files: the CSV by which strangers check the golden model.
//!
//! Rays: the header `u,v,du,dv`, then a ray a line, decimal or hex floats. Hits: the header
//! [`HITS_HEADER`], then a hit a line, in the order of the rays.

use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Context, anyhow, bail};

use rtl_model::ray::Ray;
use rtl_model::units::traverse::Hit;
use rtl_model::walker::Walker;

use crate::numbers::parse_f64;

/// The fields of a ray, which are also the header of a ray file.
const FIELDS: [&str; 4] = ["u", "v", "du", "dv"];

/// The header of a hit file.
pub const HITS_HEADER: &str = "i,j,t,u,v,steps,crossings,status";

/// The longest line that is read: far more than four numbers need.
const LONGEST_LINE: u64 = 1 << 16;

/// Where rays come from.
#[derive(Clone, Debug)]
pub enum RaySource {
    /// `-`
    StandardInput,
    /// A file.
    File(PathBuf),
}

impl FromStr for RaySource {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text {
            "-" => RaySource::StandardInput,
            path => RaySource::File(path.into()),
        })
    }
}

impl fmt::Display for RaySource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RaySource::StandardInput => f.write_str("standard input"),
            RaySource::File(path) => write!(f, "{}", path.display()),
        }
    }
}

impl RaySource {
    /// All rays, each as `walker` admits it: entries are reduced to the first repeat of the map.
    ///
    /// # Errors
    /// A file that is missing, or the first line that is no ray; the message names line and field.
    pub fn read(&self, walker: &Walker<'_>) -> anyhow::Result<Vec<Ray<f64>>> {
        let input: Box<dyn Read> = match self {
            RaySource::StandardInput => Box::new(io::stdin().lock()),
            RaySource::File(path) => Box::new(File::open(path).map_err(|cause| {
                anyhow!(
                    "rays {self}: cannot be read ({cause}); check the path, or give - for standard \
                     input"
                )
            })?),
        };
        let mut lines = Lines {
            input: BufReader::new(input),
            bytes: Vec::new(),
            number: 0,
        };
        let Some(header) = lines.next().with_context(|| format!("rays {self}"))? else {
            bail!("rays {self}: empty; its first line is u,v,du,dv");
        };
        let header = header.trim_start_matches('\u{feff}');
        if !header.split(',').map(str::trim).eq(FIELDS) {
            bail!(
                "rays {self}, line 1: the header is {}; it must be u,v,du,dv",
                quoted(header)
            );
        }
        let mut rays = Vec::new();
        let mut blank = None;
        loop {
            let number = lines.number + 1;
            let place = || format!("rays {self}, line {number}");
            let Some(line) = lines.next().with_context(place)? else {
                break;
            };
            if line.trim().is_empty() {
                blank.get_or_insert(number);
                continue;
            }
            // Blank lines at the end are nobody's ray; one before a ray would shift the answers.
            if let Some(blank) = blank {
                bail!("rays {self}, line {blank}: blank; a ray has four fields, u,v,du,dv");
            }
            let ray = parse_ray(line).with_context(place)?;
            rays.push(walker.admit(ray).with_context(place)?);
        }
        Ok(rays)
    }
}

/// Lines of text, one at a time in the same memory.
struct Lines<R> {
    input: BufReader<R>,
    bytes: Vec<u8>,
    /// Lines read so far.
    number: u64,
}

impl<R: Read> Lines<R> {
    /// The next line without its end; none at the end of the file.
    fn next(&mut self) -> anyhow::Result<Option<&str>> {
        self.bytes.clear();
        let mut limited = self.input.by_ref().take(LONGEST_LINE);
        let length = limited.read_until(b'\n', &mut self.bytes)?;
        if length == 0 {
            return Ok(None);
        }
        self.number += 1;
        let ended = self.bytes.ends_with(b"\n");
        if !ended && length as u64 == LONGEST_LINE {
            bail!("longer than {LONGEST_LINE} bytes; give a ray a line");
        }
        let text = str::from_utf8(&self.bytes)
            .ok()
            .context("not text in UTF-8")?;
        Ok(Some(text.trim_end_matches(['\n', '\r'])))
    }
}

fn parse_ray(line: &str) -> anyhow::Result<Ray<f64>> {
    let mut texts = [""; 4];
    let mut count = 0;
    for text in line.split(',') {
        if let Some(place) = texts.get_mut(count) {
            *place = text.trim();
        }
        count += 1;
    }
    if count < FIELDS.len() {
        let missing = FIELDS[count];
        let plural = if count == 1 { "" } else { "s" };
        bail!("{count} field{plural}, `{missing}` is missing; a ray has four, u,v,du,dv");
    }
    if count > FIELDS.len() {
        bail!("{count} fields; a ray has four, u,v,du,dv");
    }
    let mut values = [0.0; 4];
    for ((value, text), field) in values.iter_mut().zip(texts).zip(FIELDS) {
        if text.is_empty() {
            bail!("`{field}` is missing; a ray has four fields, u,v,du,dv");
        }
        *value = parse_f64(text).with_context(|| format!("`{field}` is {}", quoted(text)))?;
    }
    let [u, v, du, dv] = values;
    Ok(Ray { u, v, du, dv })
}

/// Text of a file for a message: cut where it is long, on one line whatever it holds.
fn quoted(text: &str) -> String {
    const LONGEST: usize = 40;
    let mut shown: String = text.chars().take(LONGEST).collect();
    if shown.len() < text.len() {
        shown.push_str("...");
    }
    format!("`{}`", shown.escape_debug())
}

/// Writes a hit file. Numbers are the shortest decimals that read back to the same `f64`.
pub fn write_hits(output: &mut dyn Write, hits: &[Hit<f64>]) -> io::Result<()> {
    writeln!(output, "{HITS_HEADER}")?;
    for hit in hits {
        writeln!(
            output,
            "{},{},{:?},{:?},{:?},{},{},{}",
            hit.i, hit.j, hit.t, hit.u, hit.v, hit.steps, hit.crossings, hit.status
        )?;
    }
    Ok(())
}
