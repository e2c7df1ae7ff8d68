//! Why a signal differs: is it where the fault is, or only downstream of it?
//!
//! Asked of the first cycle in which anything differs. A signal all of whose inputs agreed in the
//! cycles they were sampled in has no excuse: the fault is in what computes it.

use super::annotations::Annotations;
use super::signal::EarlierSignal;
use serde::Serialize;
use std::collections::{HashMap, VecDeque};
use std::fmt;

/// What the inputs of a differing signal say about it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "verdict", rename_all = "kebab-case")]
pub enum Cause {
    /// Every input of the signal was equal when it was sampled: the fault is in its computation.
    First,
    /// It is not known what the signal is computed from, but all that enters its unit is equal up
    /// to and in this cycle: the fault is in the unit.
    WithinUnit {
        /// The unit's scope.
        unit: String,
    },
    /// An input differed already.
    EffectOf {
        /// The input's full name.
        signal: String,
        /// The cycle it was sampled in.
        cycle: u64,
    },
    /// It cannot be told.
    Unknown {
        /// Why not.
        reason: String,
    },
}

impl Cause {
    /// Causes before what is unknown before effects.
    pub(crate) fn rank(&self) -> u8 {
        match self {
            Cause::First => 0,
            Cause::WithinUnit { .. } => 1,
            Cause::Unknown { .. } => 2,
            Cause::EffectOf { .. } => 3,
        }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Cause::First => f.write_str("inputs equal: this is a first cause"),
            Cause::WithinUnit { unit } => {
                write!(f, "all that enters {unit} is equal: the cause is within it")
            }
            Cause::EffectOf { signal, cycle } => {
                write!(f, "inputs differ: an effect of {signal} in cycle {cycle}")
            }
            Cause::Unknown { reason } => write!(f, "inputs unknown: {reason}"),
        }
    }
}

/// How the two values of a signal compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Agreement {
    /// All bits known and equal.
    Equal,
    /// Equal, but for bits that are unknown on both sides (or golden ones, if those are excused).
    AsFarAsKnown,
    Differs,
}

/// What annotations say, by the names signals pair by, and how the last cycles compared.
#[derive(Debug)]
pub(crate) struct Causes {
    dependencies: HashMap<String, Vec<EarlierSignal>>,
    unit_inputs: HashMap<String, Vec<String>>,
    pair_by_name: HashMap<String, usize>,
    /// Cycle and the agreement of every pair in it, the latest cycle last.
    history: VecDeque<(u64, Vec<Agreement>)>,
    depth: usize,
}

impl Causes {
    /// Cycles of history kept, at most: deeper than any pipeline that is looked at by waveform.
    const MAX_DEPTH: usize = 1024;

    /// Annotations of which names have been brought to the names of the pairs.
    pub(crate) fn new(annotations: Annotations, pair_by_name: HashMap<String, usize>) -> Causes {
        let inputs = annotations.dependencies.iter().flat_map(|d| &d.inputs);
        let deepest = inputs.map(|input| input.cycles_back as usize).max();
        Causes {
            dependencies: annotations
                .dependencies
                .into_iter()
                .map(|dependency| (dependency.signal, dependency.inputs))
                .collect(),
            unit_inputs: annotations
                .unit_inputs
                .into_iter()
                .map(|unit| (unit.unit, unit.inputs))
                .collect(),
            pair_by_name,
            history: VecDeque::new(),
            depth: deepest.unwrap_or(0).min(Causes::MAX_DEPTH) + 1,
        }
    }

    /// Remembers how a cycle compared, be it in reset or not.
    pub(crate) fn remember(&mut self, cycle: u64, agreements: &[Agreement]) {
        let mut kept = if self.history.len() == self.depth {
            self.history.pop_front().unwrap_or_default().1
        } else {
            Vec::new()
        };
        kept.clear();
        kept.extend_from_slice(agreements);
        self.history.push_back((cycle, kept));
    }

    /// Why a signal differs in a cycle, the latest remembered and the first that differs.
    pub(crate) fn of(&self, signal: &str, unit: &str, cycle: u64) -> Cause {
        let Some(inputs) = self.dependencies.get(signal) else {
            return self.within(unit, cycle);
        };
        let mut doubt = None;
        for input in inputs {
            let EarlierSignal {
                signal: name,
                cycles_back,
            } = input;
            let Some(sampled) = cycle.checked_sub(u64::from(*cycles_back)) else {
                doubt = Some(format!("{name} was sampled before cycle 0"));
                continue;
            };
            match self.agreement(name, sampled) {
                Ok(Agreement::Equal) => {}
                Ok(Agreement::Differs) => {
                    return Cause::EffectOf {
                        signal: name.clone(),
                        cycle: sampled,
                    };
                }
                Ok(Agreement::AsFarAsKnown) => {
                    doubt = Some(format!("{name} has unknown bits in cycle {sampled}"));
                }
                Err(reason) => doubt = Some(reason),
            }
        }
        match doubt {
            None => Cause::First,
            Some(reason) => Cause::Unknown { reason },
        }
    }

    fn agreement(&self, name: &str, cycle: u64) -> Result<Agreement, String> {
        let pair = self
            .pair_by_name
            .get(name)
            .ok_or_else(|| format!("{name} is not in both waveforms"))?;
        let kept = self.history.iter().find(|(number, _)| *number == cycle);
        match kept {
            Some((_, agreements)) => Ok(agreements[*pair]),
            None => Err(format!("cycle {cycle} of {name} is not in both waveforms")),
        }
    }

    /// Judges by what enters the unit, where the signal's own inputs are not told.
    fn within(&self, unit: &str, cycle: u64) -> Cause {
        let Some(inputs) = self.unit_inputs.get(unit) else {
            return Cause::Unknown {
                reason: "neither waveform says what it is computed from".to_owned(),
            };
        };
        for input in inputs {
            match self.agreement(input, cycle) {
                Ok(Agreement::Equal) => {}
                Ok(Agreement::AsFarAsKnown) => {
                    return Cause::Unknown {
                        reason: format!("{input} has unknown bits"),
                    };
                }
                Ok(Agreement::Differs) => {
                    return Cause::Unknown {
                        reason: format!("{input}, which enters {unit}, differs too"),
                    };
                }
                Err(reason) => return Cause::Unknown { reason },
            }
        }
        Cause::WithinUnit {
            unit: unit.to_owned(),
        }
    }
}
