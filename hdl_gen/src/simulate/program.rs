//! What the embedded simulator executes: steps on a flat memory of words, grouped by opcode.

/// What a step does with its operands; `mask` and `shift` are the step's literals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Opcode {
    /// `a ^ mask`
    Not,
    /// `a & b`
    And,
    /// `a | b`
    Or,
    /// `a ^ b`
    Xor,
    /// `(a + b) & mask`
    Add,
    /// `(a - b) & mask`
    Subtract,
    /// `a * b`, which fits, or whose low bits are wanted
    Multiply,
    /// `(a << b) & mask`, 0 where b reaches 64
    ShiftLeft,
    /// `a >> b`, 0 where b reaches 64
    ShiftRight,
    /// `a == b`
    Equal,
    /// `a < b`
    LessThan,
    /// `a ? b : c`
    Mux,
    /// `(a << shift) | b`
    Join,
    /// `(a >> shift) & mask`
    Slice,
    /// Bit `shift` of a is its sign: repeated up to `mask`.
    SignExtend,
    /// `a != 0`
    AnyBit,
    /// `a == mask`
    AllBits,
    /// The word `a` behind the address `mask`
    MemoryRead,
}

impl Opcode {
    pub(super) const COUNT: usize = Opcode::MemoryRead as usize + 1;

    /// How many of a step's operands are addresses.
    pub(super) fn operands(self) -> usize {
        match self {
            Opcode::Not
            | Opcode::Slice
            | Opcode::SignExtend
            | Opcode::AnyBit
            | Opcode::AllBits
            | Opcode::MemoryRead => 1,
            Opcode::Mux => 3,
            _ => 2,
        }
    }
}

/// One step: read up to three words, write one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Step {
    /// Addresses of the operands; those the opcode does not use are 0.
    pub(super) operands: [u32; 3],
    /// Address of the result.
    pub(super) result: u32,
    /// A literal the opcode may use.
    pub(super) mask: u64,
    /// Another, below 64.
    pub(super) shift: u32,
}

/// Consecutive steps of one opcode: one dispatch for all of them.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) opcode: Opcode,
    pub(super) steps: Vec<Step>,
}

/// Executes steps of one opcode in order.
pub(super) fn execute(opcode: Opcode, steps: &[Step], memory: &mut [u64]) {
    match opcode {
        Opcode::Not => one(steps, memory, |s, a| a ^ s.mask),
        Opcode::And => two(steps, memory, |_, a, b| a & b),
        Opcode::Or => two(steps, memory, |_, a, b| a | b),
        Opcode::Xor => two(steps, memory, |_, a, b| a ^ b),
        Opcode::Add => two(steps, memory, |s, a, b| a.wrapping_add(b) & s.mask),
        Opcode::Subtract => two(steps, memory, |s, a, b| a.wrapping_sub(b) & s.mask),
        Opcode::Multiply => two(steps, memory, |_, a, b| a.wrapping_mul(b)),
        Opcode::ShiftLeft => two(
            steps,
            memory,
            |s, a, b| {
                if b < 64 { (a << b) & s.mask } else { 0 }
            },
        ),
        Opcode::ShiftRight => two(steps, memory, |_, a, b| if b < 64 { a >> b } else { 0 }),
        Opcode::Equal => two(steps, memory, |_, a, b| u64::from(a == b)),
        Opcode::LessThan => two(steps, memory, |_, a, b| u64::from(a < b)),
        Opcode::Mux => {
            for step in steps {
                let [select, one, zero] = step.operands.map(|operand| memory[operand as usize]);
                memory[step.result as usize] = if select != 0 { one } else { zero };
            }
        }
        Opcode::Join => two(steps, memory, |s, a, b| (a << s.shift) | b),
        Opcode::Slice => one(steps, memory, |s, a| (a >> s.shift) & s.mask),
        Opcode::SignExtend => one(steps, memory, |s, a| {
            let sign = 1u64 << s.shift;
            (a ^ sign).wrapping_sub(sign) & s.mask
        }),
        Opcode::AnyBit => one(steps, memory, |_, a| u64::from(a != 0)),
        Opcode::AllBits => one(steps, memory, |s, a| u64::from(a == s.mask)),
        Opcode::MemoryRead => {
            for step in steps {
                let place = step.mask + memory[step.operands[0] as usize];
                memory[step.result as usize] = memory[place as usize];
            }
        }
    }
}

#[inline(always)]
fn one(steps: &[Step], memory: &mut [u64], f: impl Fn(&Step, u64) -> u64) {
    for step in steps {
        let a = memory[step.operands[0] as usize];
        memory[step.result as usize] = f(step, a);
    }
}

#[inline(always)]
fn two(steps: &[Step], memory: &mut [u64], f: impl Fn(&Step, u64, u64) -> u64) {
    for step in steps {
        let a = memory[step.operands[0] as usize];
        let b = memory[step.operands[1] as usize];
        memory[step.result as usize] = f(step, a, b);
    }
}
