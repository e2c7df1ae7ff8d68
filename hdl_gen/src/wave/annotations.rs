//! What a waveform says of its signals beside their values: lines of its header that other tools
//! skip as comments.
//!
//! ```text
//! $comment stepwell-float traverse.step.t e7f16 $end
//! $comment stepwell-fixed top.t q12.20 $end
//! $comment stepwell-signed traverse.step.i $end
//! $comment stepwell-inputs traverse.step = traverse.step.a traverse.step.b $end
//! $comment stepwell-depends traverse.step.sum_s3 = traverse.step.a_s1@-2 $end
//! ```

use super::signal::{Dependency, EarlierSignal, UnitInputs};
use super::{SignalDeclaration, WaveError};
use crate::netlist::Meaning;
use rtl_model::float::FloatFormat;

/// The annotations of one waveform, in its own full names.
#[derive(Clone, Debug, Default)]
pub(crate) struct Annotations {
    /// Signals that are not plain bits.
    pub meanings: Vec<(String, Meaning)>,
    /// What signals are computed from.
    pub dependencies: Vec<Dependency>,
    /// What enters units.
    pub unit_inputs: Vec<UnitInputs>,
}

/// The line that says how a signal is meant; plain bits need none.
pub(crate) fn meaning_line(signal: &SignalDeclaration) -> Option<String> {
    let name = signal.full_name();
    match signal.meaning {
        Meaning::Bits => None,
        Meaning::Signed => Some(format!("stepwell-signed {name}")),
        Meaning::Float(format) => Some(format!("stepwell-float {name} {format}")),
        Meaning::Fixed(format) => Some(format!("stepwell-fixed {name} {format}")),
    }
}

/// The line that says what a signal is computed from.
pub(crate) fn dependency_line(dependency: &Dependency) -> String {
    let mut line = format!("stepwell-depends {} =", dependency.signal);
    for input in &dependency.inputs {
        let sign = if input.cycles_back == 0 { "" } else { "-" };
        line += &format!(" {}@{sign}{}", input.signal, input.cycles_back);
    }
    line
}

/// The line that says what enters a unit.
pub(crate) fn unit_inputs_line(unit: &UnitInputs) -> String {
    format!("stepwell-inputs {} = {}", unit.unit, unit.inputs.join(" "))
}

/// Can a name stand in an annotation and be read back?
pub(crate) fn is_full_name(name: &str) -> bool {
    !name.is_empty()
        && name != "="
        && name.bytes().all(|byte| byte.is_ascii_graphic())
        && !name.contains("$end")
}

impl Annotations {
    /// Reads the comments of a header; those of others are passed over.
    pub(crate) fn read(file: &str, comments: &[String]) -> Result<Annotations, WaveError> {
        let mut annotations = Annotations::default();
        for comment in comments {
            annotations
                .read_line(comment)
                .map_err(|reason| WaveError::Annotation {
                    name: file.to_owned(),
                    text: comment.clone(),
                    reason,
                })?;
        }
        Ok(annotations)
    }

    fn read_line(&mut self, comment: &str) -> Result<(), String> {
        let mut words = comment.split_ascii_whitespace();
        let keyword = words.next().unwrap_or_default();
        if !keyword.starts_with("stepwell-") {
            return Ok(());
        }
        let subject = words.next().ok_or("it names nothing")?.to_owned();
        let rest: Vec<&str> = words.collect();
        match (keyword, rest.as_slice()) {
            ("stepwell-float", [format]) => {
                let format = float_format(format).ok_or("the format is not of the form e7f16")?;
                self.meanings.push((subject, Meaning::Float(format)));
            }
            ("stepwell-fixed", [format]) => {
                let format = format
                    .parse()
                    .map_err(|_| "the format is not of the form q12.20 or uq0.16")?;
                self.meanings.push((subject, Meaning::Fixed(format)));
            }
            ("stepwell-signed", []) => self.meanings.push((subject, Meaning::Signed)),
            ("stepwell-inputs", ["=", inputs @ ..]) => self.unit_inputs.push(UnitInputs {
                unit: subject,
                inputs: inputs.iter().map(|&input| input.to_owned()).collect(),
            }),
            ("stepwell-depends", ["=", inputs @ ..]) => self.dependencies.push(Dependency {
                signal: subject,
                inputs: inputs
                    .iter()
                    .map(|input| earlier_signal(input).ok_or(format!("`{input}` is not NAME@-N")))
                    .collect::<Result<_, _>>()?,
            }),
            ("stepwell-float" | "stepwell-signed" | "stepwell-inputs" | "stepwell-depends", _) => {
                return Err("it has words too many or too few".to_owned());
            }
            // A later writer may say more than this reader knows.
            _ => {}
        }
        Ok(())
    }
}

/// `NAME@-N`, N cycles ago.
fn earlier_signal(text: &str) -> Option<EarlierSignal> {
    let (signal, offset) = text.rsplit_once('@')?;
    let cycles_back = match offset.strip_prefix('-') {
        Some(digits) => digits.parse().ok()?,
        None if offset == "0" => 0,
        None => return None,
    };
    Some(EarlierSignal {
        signal: signal.to_owned(),
        cycles_back,
    })
}

/// `eXfY`, with widths a float may have.
fn float_format(text: &str) -> Option<FloatFormat> {
    let (exponent, fraction) = text.strip_prefix('e')?.split_once('f')?;
    let (exponent, fraction) = (exponent.parse().ok()?, fraction.parse().ok()?);
    ((2..=11).contains(&exponent) && (2..=52).contains(&fraction))
        .then(|| FloatFormat::new(exponent, fraction))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_read_back_as_they_were_written() {
        let dependency = Dependency {
            signal: "top.sum".to_owned(),
            inputs: [("top.a", 2), ("top.b@1", 0)]
                .map(|(signal, cycles_back)| EarlierSignal {
                    signal: signal.to_owned(),
                    cycles_back,
                })
                .to_vec(),
        };
        let unit = UnitInputs {
            unit: "top".to_owned(),
            inputs: vec!["top.a".to_owned(), "top.b".to_owned()],
        };
        let float = SignalDeclaration {
            path: vec!["top".to_owned()],
            name: "t".to_owned(),
            width: 24,
            meaning: Meaning::Float(FloatFormat::E7F16),
        };
        let lines = [
            dependency_line(&dependency),
            unit_inputs_line(&unit),
            meaning_line(&float).unwrap(),
            "somebody else's remark".to_owned(),
            "stepwell-of-tomorrow top.t 3".to_owned(),
        ];
        assert_eq!(lines[0], "stepwell-depends top.sum = top.a@-2 top.b@1@0");
        assert_eq!(lines[2], "stepwell-float top.t e7f16");
        let read = Annotations::read("file", &lines).unwrap();
        assert_eq!(read.dependencies, [dependency]);
        assert_eq!(read.unit_inputs, [unit]);
        assert_eq!(read.meanings, [("top.t".to_owned(), float.meaning)]);
    }

    #[test]
    fn damaged_lines_are_refused() {
        for line in [
            "stepwell-float",
            "stepwell-float top.t",
            "stepwell-float top.t e99f16",
            "stepwell-float top.t e7f16 again",
            "stepwell-signed top.t 3",
            "stepwell-inputs top a b",
            "stepwell-depends top.t = a",
            "stepwell-depends top.t = a@2",
            "stepwell-depends top.t = a@-x",
            "stepwell-depends top.t = a@-99999999999",
        ] {
            let error = Annotations::read("f.vcd", &[line.to_owned()]).unwrap_err();
            assert!(error.to_string().contains(line), "{error}");
        }
    }
}
