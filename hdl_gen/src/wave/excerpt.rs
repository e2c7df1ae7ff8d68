//! Some signals of a waveform over some cycles, as values: what a picture is drawn of.

use std::collections::HashMap;
use std::io::BufRead;
use std::ops::RangeInclusive;

use super::annotations::Annotations;
use super::cycles::{CycleNumbers, CycleSampler};
use super::error::Names;
use super::reader::{Header, Reader};
use super::{CLOCK_NAME, LogicWord, WaveError, decoded};
use crate::nearest::nearest_names;
use crate::netlist::Meaning;

/// Plain bits of more than this many are read in hexadecimal, others in decimal.
const MOST_DECIMAL_BITS: u32 = 16;

/// A signal over the cycles of an excerpt.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExcerptSignal {
    /// Its full name.
    pub name: String,
    /// Bits.
    pub width: u32,
    /// How they are meant, as far as the file says.
    pub meaning: Meaning,
    /// Its value in each cycle, settled.
    pub values: Vec<LogicWord>,
}

/// Some signals over some cycles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excerpt {
    /// The number of the first cycle.
    pub first_cycle: u64,
    /// The signals, in the order in which they were asked for.
    pub signals: Vec<ExcerptSignal>,
}

impl ExcerptSignal {
    /// The values as a person reads them, fractions to six places; none where a bit is unknown.
    pub fn texts(&self) -> Vec<Option<String>> {
        let text = |word: &LogicWord| match self.meaning {
            Meaning::Bits if self.width > MOST_DECIMAL_BITS => {
                let word = word.low_bits(self.width).as_known()?;
                Some(format!("{word:x}"))
            }
            meaning => decoded(meaning, self.width, *word).map(rounded),
        };
        self.values.iter().map(text).collect()
    }
}

/// A number in decimal with no more than six places behind the point.
fn rounded(text: String) -> String {
    let is_long = |number: &str| {
        number
            .split_once('.')
            .is_some_and(|(_, places)| places.len() > 6)
    };
    match text.parse::<f64>() {
        Ok(number) if is_long(&text) => match number.abs() {
            1e-3..1e9 => {
                let shown = format!("{number:.6}");
                let shown = shown.trim_end_matches('0');
                // One digit is left behind the point.
                format!("{shown}{}", if shown.ends_with('.') { "0" } else { "" })
            }
            _ => format!("{number:.4e}"),
        },
        _ => text,
    }
}

/// Reads signals over a window of cycles. A signal is asked for by its full name, or by as much of
/// its end as tells it from all others.
///
/// # Errors
/// If the file cannot be read or is no VCD, has no clock, not the window, or not the signals.
pub fn excerpt(
    file: &str,
    input: impl BufRead,
    wanted: &[String],
    window: RangeInclusive<u64>,
) -> Result<Excerpt, WaveError> {
    let reader = Reader::open(file, input)?;
    let annotations = Annotations::read(file, &reader.header.comments)?;
    let meanings: HashMap<String, Meaning> = annotations.meanings.into_iter().collect();
    let clock = clock(file, &reader.header)?;
    let watched = wanted.iter().map(|name| named(file, &reader.header, name));
    let watched = watched.collect::<Result<Vec<_>, _>>()?;
    let mut signals: Vec<ExcerptSignal> = watched
        .iter()
        .map(|&index| {
            let variable = &reader.header.variables[index];
            let name = reader.header.full_name(variable);
            ExcerptSignal {
                width: variable.width,
                meaning: meanings.get(&name).copied().unwrap_or(Meaning::Bits),
                name,
                values: Vec::new(),
            }
        })
        .collect();
    let (mut sampler, slots) = CycleSampler::new(reader, clock, &watched, CycleNumbers::ByTime);
    let mut first_cycle = None;
    while let Some(cycle) = sampler.next_cycle()? {
        if cycle.number > *window.end() {
            break;
        }
        if window.contains(&cycle.number) {
            first_cycle.get_or_insert(cycle.number);
            for (signal, &slot) in signals.iter_mut().zip(&slots) {
                signal.values.push(sampler.value(slot)[0]);
            }
        }
    }
    let first_cycle = first_cycle.ok_or_else(|| WaveError::NoWindow {
        name: file.to_owned(),
        first: *window.start(),
        last: *window.end(),
    })?;
    Ok(Excerpt {
        first_cycle,
        signals,
    })
}

/// The outermost clock.
fn clock(file: &str, header: &Header) -> Result<usize, WaveError> {
    let variables = header.variables.iter().enumerate();
    let clocks = variables.filter(|(_, variable)| {
        variable.is_bits() && variable.width == 1 && variable.name == CLOCK_NAME
    });
    let outermost = clocks.min_by_key(|(_, variable)| header.scopes[variable.scope].len());
    outermost
        .map(|(index, _)| index)
        .ok_or_else(|| WaveError::NoClock {
            name: file.to_owned(),
            signal: CLOCK_NAME.to_owned(),
            has: Names(header.top_scopes()),
        })
}

/// The variable that a name means.
fn named(file: &str, header: &Header, wanted: &str) -> Result<usize, WaveError> {
    let problem = |reason: String| WaveError::NoSignal {
        name: file.to_owned(),
        signal: wanted.to_owned(),
        reason,
    };
    let bits = header.variables.iter().enumerate();
    let full: Vec<(usize, String)> = bits
        .filter(|(_, variable)| variable.is_bits())
        .map(|(index, variable)| (index, header.full_name(variable)))
        .collect();
    let end = format!(".{wanted}");
    let found = match full.iter().find(|(_, name)| name == wanted) {
        Some(found) => found,
        None => {
            let mut ending = full.iter().filter(|(_, name)| name.ends_with(&end));
            match (ending.next(), ending.next()) {
                (Some(found), None) => found,
                (Some((_, one)), Some((_, other))) => {
                    return Err(problem(format!(
                        "it may be `{one}` or `{other}`; name more of its path"
                    )));
                }
                (None, _) => {
                    let names = full.iter().map(|(_, name)| name.as_str());
                    let near = nearest_names(wanted, names);
                    return Err(problem(match near.is_empty() {
                        true => "it is not there".to_owned(),
                        false => format!("it is not there; near it: {}", near.join(", ")),
                    }));
                }
            }
        }
    };
    match header.variables[found.0].width {
        1..=64 => Ok(found.0),
        width => Err(problem(format!(
            "it has {width} bits, and up to 64 are shown"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{SignalDeclaration, Writer, WriterOptions};
    use super::*;

    /// Cycle c holds c in `top.a.count`, 10 c in `top.b.count`, a sign in `top.a.signed`.
    fn file() -> Vec<u8> {
        let signal = |scope: &str, name: &str, meaning| SignalDeclaration {
            path: vec!["top".to_owned(), scope.to_owned()],
            name: name.to_owned(),
            width: 20,
            meaning,
        };
        let declarations = [
            signal("a", "count", Meaning::Bits),
            signal("a", "signed", Meaning::Signed),
            signal("b", "count", Meaning::Bits),
        ];
        let options = WriterOptions {
            shadows: true,
            first_cycle: 5,
            ..WriterOptions::default()
        };
        let mut writer = Writer::new(Vec::new(), &declarations, &options).unwrap();
        for cycle in 5..15_u64 {
            let words = [cycle, (1 << 20) - cycle, 10 * cycle].map(LogicWord::known);
            writer.cycle(true, &words).unwrap();
        }
        writer.finish().unwrap()
    }

    fn read(wanted: &[&str], window: RangeInclusive<u64>) -> Result<Excerpt, WaveError> {
        let wanted: Vec<String> = wanted.iter().map(|&name| name.to_owned()).collect();
        excerpt("f.vcd", file().as_slice(), &wanted, window)
    }

    #[test]
    fn values_are_those_of_the_cycles_and_read_as_they_are_meant() {
        let shown = read(&["b.count", "signed"], 12..=99).unwrap();
        assert_eq!(shown.first_cycle, 12);
        let names = shown.signals.iter().map(|signal| signal.name.as_str());
        assert_eq!(names.collect::<Vec<_>>(), ["top.b.count", "top.a.signed"]);
        let texts = |place: usize| -> Vec<String> {
            let texts = shown.signals[place].texts().into_iter();
            texts.map(Option::unwrap).collect()
        };
        assert_eq!(texts(0), ["78", "82", "8c"]);
        assert_eq!(texts(1), ["-12", "-13", "-14"]);
    }

    #[test]
    fn long_fractions_are_rounded_and_nothing_else() {
        for (text, shown) in [
            ("0.3764686584472656", "0.376469"),
            ("-0.125", "-0.125"),
            ("0.25000000001", "0.25"),
            ("0.99999999", "1.0"),
            ("1.52587890625e-5", "1.5259e-5"),
            ("123456789", "123456789"),
            ("nan", "nan"),
        ] {
            assert_eq!(rounded(text.to_owned()), shown);
        }
    }

    #[test]
    fn names_that_mean_none_or_several_are_refused_with_the_way_out() {
        let message = |wanted: &str| read(&[wanted], 5..=9).unwrap_err().to_string();
        let several = message("count");
        assert!(
            several.contains("`top.a.count` or `top.b.count`"),
            "{several}"
        );
        let none = message("a.coun");
        assert!(none.contains("near it: top.a.count"), "{none}");
        let window = read(&["signed"], 20..=30).unwrap_err().to_string();
        assert!(window.contains("no cycle from 20 to 30"), "{window}");
    }
}
