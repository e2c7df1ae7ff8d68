//! Names for the operations that a datapath gave none, for the registers that carry them on.

use std::collections::{HashMap, HashSet};

use super::record::Recording;
use super::signal::{RecordedOperation, SignalId};
use crate::identifier::is_identifier;

/// Names made of others stay below this length.
const LONGEST: usize = 36;

/// The name of every signal, in their order. One that the datapath gave keeps it. Else it is made of
/// the operation and the operands' names; where these have none, of the name of what reads the signal
/// in the end; else of its number among the operations. An inverse always has its number: its operand is
/// read beside it, and the digests of netlists that were published stay as they are.
pub(super) fn names(recording: &Recording) -> Vec<String> {
    let signals = &recording.signals;
    let mut readers: HashMap<SignalId, SignalId> = HashMap::new();
    for (index, signal) in signals.iter().enumerate() {
        for operand in signal.operation.operands() {
            readers.entry(operand).or_insert(SignalId(index));
        }
    }
    let named_reader = |id: SignalId| {
        let mut reader = readers.get(&id);
        while let Some(id) = reader {
            if let Some(name) = recording.signal(*id).name {
                return Some(name);
            }
            reader = readers.get(id);
        }
        None
    };
    let given = signals.iter().filter_map(|signal| signal.name);
    let mut taken: HashSet<String> = given.map(str::to_owned).collect();
    let (mut names, mut readings) = (Vec::with_capacity(signals.len()), 0);
    for (index, signal) in signals.iter().enumerate() {
        if let Some(name) = signal.name {
            names.push(name.to_owned());
            continue;
        }
        if let RecordedOperation::IntFromHeight(height) = signal.operation {
            names.push(format!("{}_as_integer", names[height.index()]));
            readings += 1;
            continue;
        }
        let derived = || {
            if matches!(signal.operation, RecordedOperation::Not(_)) {
                return None;
            }
            let of_operands = of_operands(recording, &signal.operation);
            of_operands
                .filter(|name| name.len() <= LONGEST)
                .or_else(|| {
                    let reader = named_reader(SignalId(index))?;
                    Some(format!("{reader}_{}", noun(&signal.operation)))
                })
        };
        let wanted = derived().unwrap_or_else(|| format!("operation_{}", index - readings));
        let (mut name, mut number) = (wanted.clone(), 2);
        while !is_identifier(&name) || !taken.insert(name.clone()) {
            name = format!("{wanted}_{number}");
            number += 1;
        }
        names.push(name);
    }
    names
}

/// A name out of what the operands are called, if they all have one.
fn of_operands(recording: &Recording, operation: &RecordedOperation) -> Option<String> {
    use RecordedOperation::*;
    let short = |id: SignalId| {
        let signal = recording.signal(id);
        match signal.operation {
            Zero => Some("0".to_owned()),
            Constant(value) if value >= 0 => Some(value.to_string()),
            _ => signal.name.map(str::to_owned),
        }
    };
    let two = |a: SignalId, word: &str, b: SignalId| {
        let name = short(a)?;
        let starts_as_name = name.starts_with(|first: char| first.is_ascii_alphabetic());
        starts_as_name.then_some(format!("{name}_{word}_{}", short(b)?))
    };
    let one = |a: SignalId, word: &str| Some(format!("{}_{word}", recording.signal(a).name?));
    match *operation {
        Add(_, a, b) | IntAdd(a, b) => two(a, "plus", b),
        Sub(_, a, b) | IntSub(a, b) => two(a, "minus", b),
        Mul(_, a, b) | IntMul(a, b) => two(a, "times", b),
        Div(_, a, b) => two(a, "over", b),
        LessThan(a, b) | IntLessThan(a, b) => two(a, "below", b),
        LessEqual(a, b) => two(a, "up_to", b),
        IntEqual(a, b) => two(a, "equals", b),
        And(a, b) => two(a, "and", b),
        Or(a, b) => two(a, "or", b),
        IntXor(a, b) => two(a, "xor", b),
        IsNegative(a) => one(a, "is_negative"),
        IsZero(a) => one(a, "is_zero"),
        IntShiftLeft(a, _, _) => one(a, "shifted_left"),
        IntShiftRight(a, _, _) => one(a, "shifted_right"),
        FromInteger(_, a, _) => one(a, "as_number"),
        Floor(a, _) => one(a, "floor"),
        _ => None,
    }
}

/// What an operation's result is, in a word.
fn noun(operation: &RecordedOperation) -> &'static str {
    use RecordedOperation::*;
    match operation {
        Input { .. } => "input",
        Zero | Constant(_) => "constant",
        Add(..) | IntAdd(..) => "sum",
        Sub(..) | IntSub(..) => "difference",
        Mul(..) | IntMul(..) => "product",
        Div(..) => "quotient",
        UlpsUp(..) => "raised",
        ExactBelow(_) => "exact_below",
        NegateIf(..) => "signed",
        Magnitude(_) => "magnitude",
        IsNegative(_) => "negative",
        IsZero(_) => "zero",
        LessThan(..) | IntLessThan(..) => "below",
        LessEqual(..) => "up_to",
        Select(..) => "chosen",
        FromInteger(..) => "number",
        Scale(..) => "scaled",
        Floor(..) => "floor",
        DepthFromHeight(..) => "depth",
        IntFromHeight(_) => "height",
        IntShiftLeft(..) | IntShiftRight(..) => "shifted",
        IntBitLength(_) => "bit_length",
        IntXor(..) => "xor",
        IntWrap(..) | IntLowBits(..) => "bits",
        And(..) => "and",
        Or(..) => "or",
        Not(_) => "inverse",
        IntComplementIf(..) => "complement",
        IntEqual(..) => "equal",
        IntFromBit(_) => "bit",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::datapath::Recorder;
    use rtl_model::arith::Arith;
    use rtl_model::float::FloatFormat;

    #[test]
    fn names_come_from_operands_then_from_the_reader_and_are_all_different() {
        let mut recorder = Recorder::new(FloatFormat::E7F16);
        let a = recorder.bit_input("a", 0);
        let b = recorder.bit_input("b", 0);
        let both = recorder.and(a, b);
        let again = recorder.and(a, b);
        let neither = recorder.or(both, again);
        let ends = recorder.not(neither);
        recorder.name_bit("ends", ends);
        recorder.output("ends", ends);
        let _unread = recorder.or(both, again);
        let names = names(&recorder.finish());
        let expected = [
            "a",
            "b",
            "a_and_b",
            "a_and_b_2",
            "ends_or",
            "ends",
            "operation_6",
        ];
        assert_eq!(names, expected);
    }
}
