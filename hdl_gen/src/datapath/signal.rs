//! What a recording holds: signals, each the result of one operation of the datapath.

use rtl_model::float::Rounding;

/// A signal of a recording, in the order in which it was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SignalId(pub(super) usize);

impl SignalId {
    /// Its place among all signals of its recording.
    pub fn index(self) -> usize {
        self.0
    }
}

/// A recorded number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NumSignal(pub(super) SignalId);
/// A recorded integer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntSignal(pub(super) SignalId);
/// A recorded bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitSignal(pub(super) SignalId);

impl From<NumSignal> for SignalId {
    fn from(signal: NumSignal) -> SignalId {
        signal.0
    }
}
impl From<IntSignal> for SignalId {
    fn from(signal: IntSignal) -> SignalId {
        signal.0
    }
}
impl From<BitSignal> for SignalId {
    fn from(signal: BitSignal) -> SignalId {
        signal.0
    }
}

/// What kind of word a signal is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A float of the recording's format.
    Num,
    /// A two's complement integer of this many bits: enough for every value its operands allow.
    Int(u32),
    /// An unsigned height of this many bits, for `depth_from_height`; what else reads it reads
    /// [`RecordedOperation::IntFromHeight`].
    Height(u32),
    /// One bit.
    Bit,
}

/// One operation of a datapath, by its [`rtl_model::arith::Arith`] name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordedOperation {
    /// A value from outside, with the stage in which it arrives.
    Input {
        /// Pipeline stage, 0 the first.
        stage: u32,
    },
    /// `zero`.
    Zero,
    /// `add`.
    Add(Rounding, SignalId, SignalId),
    /// `sub`.
    Sub(Rounding, SignalId, SignalId),
    /// `mul`.
    Mul(Rounding, SignalId, SignalId),
    /// `div`.
    Div(Rounding, SignalId, SignalId),
    /// `ulps_up`.
    UlpsUp(SignalId, u32),
    /// `exact_below`.
    ExactBelow(SignalId),
    /// `negate_if`.
    NegateIf(SignalId, SignalId),
    /// `magnitude`.
    Magnitude(SignalId),
    /// `is_negative`.
    IsNegative(SignalId),
    /// `is_zero`.
    IsZero(SignalId),
    /// `less_than`.
    LessThan(SignalId, SignalId),
    /// `less_equal`.
    LessEqual(SignalId, SignalId),
    /// `select` and `int_select`.
    Select(SignalId, SignalId, SignalId),
    /// `number_from_integer`: value, exponent.
    FromInteger(Rounding, SignalId, SignalId),
    /// `scale`: number, exponent.
    Scale(SignalId, i32),
    /// `floor`: number, bits of the integer.
    Floor(SignalId, u32),
    /// `depth_from_height`: height, its bits.
    DepthFromHeight(SignalId, u32),
    /// A height as an integer, with a zero in front: no operation of a datapath, so the golden
    /// reading has no word for it.
    IntFromHeight(SignalId),
    /// `int_constant` and `bit_constant`.
    Constant(i64),
    /// `int_add`.
    IntAdd(SignalId, SignalId),
    /// `int_sub`.
    IntSub(SignalId, SignalId),
    /// `int_shift_left`: value, amount, bits of the amount.
    IntShiftLeft(SignalId, SignalId, u32),
    /// `int_shift_right`: value, amount, bits of the amount.
    IntShiftRight(SignalId, SignalId, u32),
    /// `int_mul`.
    IntMul(SignalId, SignalId),
    /// `int_bit_length`.
    IntBitLength(SignalId),
    /// `int_xor`.
    IntXor(SignalId, SignalId),
    /// `int_wrap`.
    IntWrap(SignalId, u32),
    /// `int_low_bits`.
    IntLowBits(SignalId, u32),
    /// `int_and` and `and`.
    And(SignalId, SignalId),
    /// `int_or` and `or`.
    Or(SignalId, SignalId),
    /// `not`.
    Not(SignalId),
    /// `int_complement_if`.
    IntComplementIf(SignalId, SignalId),
    /// `int_equal`.
    IntEqual(SignalId, SignalId),
    /// `int_less_than`.
    IntLessThan(SignalId, SignalId),
    /// `int_from_bit`.
    IntFromBit(SignalId),
}

impl RecordedOperation {
    /// The signals it reads, in order.
    pub fn operands(&self) -> Vec<SignalId> {
        use RecordedOperation::*;
        match *self {
            Input { .. } | Zero | Constant(_) => vec![],
            UlpsUp(a, _)
            | ExactBelow(a)
            | Magnitude(a)
            | IsNegative(a)
            | IsZero(a)
            | Scale(a, _)
            | Floor(a, _)
            | DepthFromHeight(a, _)
            | IntFromHeight(a)
            | IntBitLength(a)
            | IntWrap(a, _)
            | IntLowBits(a, _)
            | Not(a)
            | IntFromBit(a) => vec![a],
            Add(_, a, b)
            | Sub(_, a, b)
            | Mul(_, a, b)
            | Div(_, a, b)
            | NegateIf(a, b)
            | LessThan(a, b)
            | LessEqual(a, b)
            | FromInteger(_, a, b)
            | IntAdd(a, b)
            | IntSub(a, b)
            | IntShiftLeft(a, b, _)
            | IntShiftRight(a, b, _)
            | IntMul(a, b)
            | IntXor(a, b)
            | And(a, b)
            | Or(a, b)
            | IntComplementIf(a, b)
            | IntEqual(a, b)
            | IntLessThan(a, b) => vec![a, b],
            Select(a, b, c) => vec![a, b, c],
        }
    }

    /// Has it the same value in every cycle?
    pub fn is_constant(&self) -> bool {
        matches!(
            self,
            RecordedOperation::Zero | RecordedOperation::Constant(_)
        )
    }
}

/// A signal of a recording.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// What computes it.
    pub operation: RecordedOperation,
    /// What kind of word it is.
    pub kind: Kind,
    /// Its name, if the datapath gave it one.
    pub name: Option<&'static str>,
    /// For the result of an operation: its place among all operations, which is its place among
    /// the words of the golden reading `Traced`. Inputs have none, nor has a height's reading as an integer.
    pub word: Option<usize>,
}
