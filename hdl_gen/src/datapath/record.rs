//! Records a datapath: the reading of [`Arith`] in which a value is a signal yet to be computed.

use super::signal::{BitSignal, IntSignal, Kind, NumSignal, Recorded, RecordedOperation, SignalId};
use rtl_model::arith::Arith;
use rtl_model::float::{FloatFormat, Rounding};

/// A recorded datapath.
#[derive(Clone, Debug)]
pub struct Recording {
    /// The float format of its numbers.
    pub format: FloatFormat,
    /// Its signals; the operands of each stand before it.
    pub signals: Vec<Recorded>,
    /// Its results by port name, in order, and whether the port must appear in the last stage
    /// together with the others, or as soon as it is there.
    pub outputs: Vec<Output>,
}

/// A result of a recorded datapath.
#[derive(Clone, Debug)]
pub struct Output {
    /// The port's name.
    pub name: String,
    /// The signal.
    pub signal: SignalId,
    /// Is it wanted as soon as it is there, and not with the others in the last stage?
    pub early: bool,
}

impl Recording {
    /// A signal.
    pub fn signal(&self, id: SignalId) -> &Recorded {
        &self.signals[id.index()]
    }

    /// Bits of a signal.
    pub fn width(&self, id: SignalId) -> u32 {
        match self.signal(id).kind {
            Kind::Num => self.format.width(),
            Kind::Int(width) | Kind::Height(width) => width,
            Kind::Bit => 1,
        }
    }

    /// The inputs, in order.
    pub fn inputs(&self) -> impl Iterator<Item = SignalId> + '_ {
        let is_input = |&index: &usize| {
            matches!(
                self.signals[index].operation,
                RecordedOperation::Input { .. }
            )
        };
        (0..self.signals.len()).filter(is_input).map(SignalId)
    }

    /// Adds a result, delivered in the last stage with the others.
    pub fn add_output(&mut self, name: impl Into<String>, signal: impl Into<SignalId>) {
        self.outputs.push(Output {
            name: name.into(),
            signal: signal.into(),
            early: false,
        });
    }

    /// Operations recorded: the words that the golden reading keeps for an evaluation.
    pub fn word_count(&self) -> usize {
        self.signals
            .iter()
            .filter(|signal| signal.word.is_some())
            .count()
    }
}

/// Records what is done with its signals.
#[derive(Debug)]
pub struct Recorder {
    recording: Recording,
    words: usize,
}

impl Recorder {
    /// Nothing recorded yet; numbers are floats of `format`.
    pub fn new(format: FloatFormat) -> Recorder {
        Recorder {
            recording: Recording {
                format,
                signals: Vec::new(),
                outputs: Vec::new(),
            },
            words: 0,
        }
    }

    /// A number from outside.
    pub fn num_input(&mut self, name: &'static str, stage: u32) -> NumSignal {
        NumSignal(self.input(name, stage, Kind::Num))
    }

    /// A two's complement integer of `bits` bits from outside.
    pub fn int_input(&mut self, name: &'static str, bits: u32, stage: u32) -> IntSignal {
        IntSignal(self.input(name, stage, Kind::Int(bits)))
    }

    /// A height of `bits` bits from outside: for `depth_from_height`, or an integer that is not
    /// negative.
    pub fn height_input(&mut self, name: &'static str, bits: u32, stage: u32) -> IntSignal {
        let height = self.input(name, stage, Kind::Height(bits));
        self.recording.signals.push(Recorded {
            operation: RecordedOperation::IntFromHeight(height),
            kind: Kind::Int(bits + 1),
            name: None,
            word: None,
        });
        IntSignal(SignalId(self.recording.signals.len() - 1))
    }

    /// A bit from outside.
    pub fn bit_input(&mut self, name: &'static str, stage: u32) -> BitSignal {
        BitSignal(self.input(name, stage, Kind::Bit))
    }

    fn input(&mut self, name: &'static str, stage: u32, kind: Kind) -> SignalId {
        self.recording.signals.push(Recorded {
            operation: RecordedOperation::Input { stage },
            kind,
            name: Some(name),
            word: None,
        });
        SignalId(self.recording.signals.len() - 1)
    }

    /// A result, delivered in the last stage with the others.
    pub fn output(&mut self, name: impl Into<String>, signal: impl Into<SignalId>) {
        self.recording.add_output(name, signal);
    }

    /// A result that leaves in the stage in which it is computed.
    pub fn early_output(&mut self, name: impl Into<String>, signal: impl Into<SignalId>) {
        self.recording.outputs.push(Output {
            name: name.into(),
            signal: signal.into(),
            early: true,
        });
    }

    /// The recording.
    pub fn finish(self) -> Recording {
        self.recording
    }

    fn record(&mut self, operation: RecordedOperation, kind: Kind) -> SignalId {
        let word = Some(self.words);
        self.words += 1;
        self.recording.signals.push(Recorded {
            operation,
            kind,
            name: None,
            word,
        });
        SignalId(self.recording.signals.len() - 1)
    }

    fn num(&mut self, operation: RecordedOperation) -> NumSignal {
        NumSignal(self.record(operation, Kind::Num))
    }

    fn int(&mut self, operation: RecordedOperation, bits: u32) -> IntSignal {
        assert!(bits <= 64, "an integer of {bits} bits in a datapath");
        IntSignal(self.record(operation, Kind::Int(bits)))
    }

    fn bit(&mut self, operation: RecordedOperation) -> BitSignal {
        BitSignal(self.record(operation, Kind::Bit))
    }

    fn bits(&self, a: IntSignal) -> u32 {
        self.recording.width(a.0)
    }

    fn wider(&self, a: IntSignal, b: IntSignal) -> u32 {
        self.bits(a).max(self.bits(b))
    }

    fn name(&mut self, name: &'static str, id: SignalId) {
        self.recording.signals[id.index()].name.get_or_insert(name);
    }
}

/// Bits of a two's complement integer that holds `value`.
fn signed_bits(value: i64) -> u32 {
    65 - value
        .unsigned_abs()
        .leading_zeros()
        .min((!value).unsigned_abs().leading_zeros())
}

impl Arith for Recorder {
    type Num = NumSignal;
    type Int = IntSignal;
    type Bit = BitSignal;

    fn zero(&mut self) -> NumSignal {
        self.num(RecordedOperation::Zero)
    }
    fn add(&mut self, rounding: Rounding, a: NumSignal, b: NumSignal) -> NumSignal {
        self.num(RecordedOperation::Add(rounding, a.0, b.0))
    }
    fn sub(&mut self, rounding: Rounding, a: NumSignal, b: NumSignal) -> NumSignal {
        self.num(RecordedOperation::Sub(rounding, a.0, b.0))
    }
    fn mul(&mut self, rounding: Rounding, a: NumSignal, b: NumSignal) -> NumSignal {
        self.num(RecordedOperation::Mul(rounding, a.0, b.0))
    }
    fn div(&mut self, rounding: Rounding, a: NumSignal, b: NumSignal) -> NumSignal {
        self.num(RecordedOperation::Div(rounding, a.0, b.0))
    }
    fn ulps_up(&mut self, a: NumSignal, ulps: u32) -> NumSignal {
        self.num(RecordedOperation::UlpsUp(a.0, ulps))
    }
    fn exact_below(&mut self, a: NumSignal) -> NumSignal {
        self.num(RecordedOperation::ExactBelow(a.0))
    }
    fn negate_if(&mut self, condition: BitSignal, a: NumSignal) -> NumSignal {
        self.num(RecordedOperation::NegateIf(condition.0, a.0))
    }
    fn magnitude(&mut self, a: NumSignal) -> NumSignal {
        self.num(RecordedOperation::Magnitude(a.0))
    }
    fn is_negative(&mut self, a: NumSignal) -> BitSignal {
        self.bit(RecordedOperation::IsNegative(a.0))
    }
    fn is_zero(&mut self, a: NumSignal) -> BitSignal {
        self.bit(RecordedOperation::IsZero(a.0))
    }
    fn less_than(&mut self, a: NumSignal, b: NumSignal) -> BitSignal {
        self.bit(RecordedOperation::LessThan(a.0, b.0))
    }
    fn less_equal(&mut self, a: NumSignal, b: NumSignal) -> BitSignal {
        self.bit(RecordedOperation::LessEqual(a.0, b.0))
    }
    fn select(&mut self, condition: BitSignal, one: NumSignal, zero: NumSignal) -> NumSignal {
        self.num(RecordedOperation::Select(condition.0, one.0, zero.0))
    }
    fn number_from_integer(
        &mut self,
        rounding: Rounding,
        value: IntSignal,
        exponent: IntSignal,
    ) -> NumSignal {
        self.num(RecordedOperation::FromInteger(
            rounding, value.0, exponent.0,
        ))
    }
    fn scale(&mut self, a: NumSignal, exponent: i32) -> NumSignal {
        self.num(RecordedOperation::Scale(a.0, exponent))
    }
    fn floor(&mut self, a: NumSignal, bits: u32) -> IntSignal {
        self.int(RecordedOperation::Floor(a.0, bits), bits)
    }
    fn depth_from_height(&mut self, height: IntSignal, bits: u32) -> NumSignal {
        // The height itself, if it is one that comes from outside.
        let height = match self.recording.signal(height.0).operation {
            RecordedOperation::IntFromHeight(height) => height,
            _ => height.0,
        };
        self.num(RecordedOperation::DepthFromHeight(height, bits))
    }

    fn int_constant(&mut self, value: i64) -> IntSignal {
        self.int(RecordedOperation::Constant(value), signed_bits(value))
    }
    fn int_add(&mut self, a: IntSignal, b: IntSignal) -> IntSignal {
        self.int(RecordedOperation::IntAdd(a.0, b.0), self.wider(a, b) + 1)
    }
    fn int_sub(&mut self, a: IntSignal, b: IntSignal) -> IntSignal {
        self.int(RecordedOperation::IntSub(a.0, b.0), self.wider(a, b) + 1)
    }
    fn int_shift_left(&mut self, a: IntSignal, amount: IntSignal, amount_bits: u32) -> IntSignal {
        let bits = self.bits(a) + (1 << amount_bits) - 1;
        self.int(
            RecordedOperation::IntShiftLeft(a.0, amount.0, amount_bits),
            bits,
        )
    }
    fn int_shift_right(&mut self, a: IntSignal, amount: IntSignal, amount_bits: u32) -> IntSignal {
        self.int(
            RecordedOperation::IntShiftRight(a.0, amount.0, amount_bits),
            self.bits(a),
        )
    }
    fn int_mul(&mut self, a: IntSignal, b: IntSignal) -> IntSignal {
        let bits = self.bits(a) + self.bits(b);
        self.int(RecordedOperation::IntMul(a.0, b.0), bits)
    }
    fn int_bit_length(&mut self, a: IntSignal) -> IntSignal {
        // The sign is none of the bits counted.
        let most = i64::from(self.bits(a) - 1);
        self.int(RecordedOperation::IntBitLength(a.0), signed_bits(most))
    }
    fn int_xor(&mut self, a: IntSignal, b: IntSignal) -> IntSignal {
        self.int(RecordedOperation::IntXor(a.0, b.0), self.wider(a, b))
    }
    fn int_wrap(&mut self, a: IntSignal, bits: u32) -> IntSignal {
        let kept = bits.min(self.bits(a));
        self.int(RecordedOperation::IntWrap(a.0, bits), kept)
    }
    fn int_low_bits(&mut self, a: IntSignal, bits: u32) -> IntSignal {
        // A zero in front: the low bits are not negative.
        self.int(RecordedOperation::IntLowBits(a.0, bits), bits + 1)
    }
    fn int_and(&mut self, a: IntSignal, b: IntSignal) -> IntSignal {
        self.int(RecordedOperation::And(a.0, b.0), self.wider(a, b))
    }
    fn int_or(&mut self, a: IntSignal, b: IntSignal) -> IntSignal {
        self.int(RecordedOperation::Or(a.0, b.0), self.wider(a, b))
    }
    fn int_complement_if(&mut self, condition: BitSignal, a: IntSignal) -> IntSignal {
        self.int(
            RecordedOperation::IntComplementIf(condition.0, a.0),
            self.bits(a),
        )
    }
    fn int_equal(&mut self, a: IntSignal, b: IntSignal) -> BitSignal {
        self.bit(RecordedOperation::IntEqual(a.0, b.0))
    }
    fn int_less_than(&mut self, a: IntSignal, b: IntSignal) -> BitSignal {
        self.bit(RecordedOperation::IntLessThan(a.0, b.0))
    }
    fn int_select(&mut self, condition: BitSignal, one: IntSignal, zero: IntSignal) -> IntSignal {
        let bits = self.wider(one, zero);
        self.int(RecordedOperation::Select(condition.0, one.0, zero.0), bits)
    }
    fn int_from_bit(&mut self, condition: BitSignal) -> IntSignal {
        self.int(RecordedOperation::IntFromBit(condition.0), 2)
    }

    fn bit_constant(&mut self, value: bool) -> BitSignal {
        self.bit(RecordedOperation::Constant(i64::from(value)))
    }
    fn and(&mut self, a: BitSignal, b: BitSignal) -> BitSignal {
        self.bit(RecordedOperation::And(a.0, b.0))
    }
    fn or(&mut self, a: BitSignal, b: BitSignal) -> BitSignal {
        self.bit(RecordedOperation::Or(a.0, b.0))
    }
    fn not(&mut self, a: BitSignal) -> BitSignal {
        self.bit(RecordedOperation::Not(a.0))
    }

    fn name_num(&mut self, name: &'static str, value: NumSignal) {
        self.name(name, value.0);
    }
    fn name_int(&mut self, name: &'static str, value: IntSignal) {
        self.name(name, value.0);
    }
    fn name_bit(&mut self, name: &'static str, value: BitSignal) {
        self.name(name, value.0);
    }
}
