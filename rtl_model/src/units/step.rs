//! A step of a traversal as hardware sees it: registers in, an address out, heights in, registers
//! out.
//!
//! Each family of traversals has a datapath function of its own, with registers that are typed
//! and named. A [`Step`] puts them in a row, so that whoever records a netlist, writes vectors or
//! closes a pipeline to a loop need not know which family it is.

use std::borrow::Cow;

use crate::arith::Arith;
use crate::maps::Pyramid;
use crate::ray::Ray;
use crate::readings::{NumberFormat, Word, enter};

/// What kind of word a register is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RegisterKind {
    /// A number in the unit's format.
    Number,
    /// A two's complement integer of this many bits.
    Integer(u32),
    /// One bit.
    Bit,
}

/// A register, or a port: its name in Rust, Verilog, vectors and waveforms, and its kind.
pub type Register = (&'static str, RegisterKind);

/// A signal of any kind.
#[derive(Debug)]
pub enum Signal<A: Arith> {
    /// A number.
    Number(A::Num),
    /// An integer.
    Integer(A::Int),
    /// A bit.
    Bit(A::Bit),
}

impl<A: Arith> Clone for Signal<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for Signal<A> {}

impl<A: Arith> Signal<A> {
    /// The number.
    ///
    /// # Panics
    /// If the signal is none: a [`Step`] was handed other registers than it declares.
    pub fn number(self) -> A::Num {
        match self {
            Signal::Number(number) => number,
            _ => panic!("no number where one is declared"),
        }
    }

    /// The integer.
    ///
    /// # Panics
    /// As [`Signal::number`].
    pub fn integer(self) -> A::Int {
        match self {
            Signal::Integer(integer) => integer,
            _ => panic!("no integer where one is declared"),
        }
    }

    /// The bit.
    ///
    /// # Panics
    /// As [`Signal::number`].
    pub fn bit(self) -> A::Bit {
        match self {
            Signal::Bit(bit) => bit,
            _ => panic!("no bit where one is declared"),
        }
    }
}

impl<R: Word> Signal<R> {
    /// The signal's bits; those of an integer in 64.
    pub fn word(self, reading: &R) -> u64 {
        match self {
            Signal::Number(number) => reading.word(number),
            Signal::Integer(integer) => integer as u64,
            Signal::Bit(bit) => bit.into(),
        }
    }

    /// The signal of these bits; of an integer, those of its width.
    pub fn of_word(reading: &R, kind: RegisterKind, word: u64) -> Self {
        match kind {
            RegisterKind::Number => Signal::Number(reading.number(word)),
            RegisterKind::Integer(bits) => {
                let above = 64 - bits;
                Signal::Integer((word << above) as i64 >> above)
            }
            RegisterKind::Bit => Signal::Bit(word != 0),
        }
    }
}

/// A named result of a datapath.
pub type Named<A> = (&'static str, Signal<A>);

/// The datapaths of a family of traversals, with their registers in a row.
pub trait Step {
    /// The module's name, such as `traverse_step`.
    fn name(&self) -> &'static str;
    /// What the module's header says: what it does, of which method, on which map.
    fn description(&self) -> Vec<String>;
    /// The ports a ray comes in by, before it is set up.
    fn ray_ports(&self) -> Vec<Register>;
    /// The registers a ray carries unchanged from step to step.
    fn ray_registers(&self) -> Vec<Register>;
    /// The registers of its walk. `hit` and `guard` are among them, and `steps` and `crossings`.
    fn walk_registers(&self) -> Vec<Register>;
    /// The ports by which the memory answers: a height each, of so many bits, in order.
    fn height_ports(&self) -> Vec<(&'static str, u32)>;
    /// The port by which the memory is asked.
    fn address_port(&self) -> &'static str {
        "node_address"
    }
    /// Bits of an address.
    fn address_bits(&self) -> u32;
    /// The step at which a walk without a hit ends with `guard`.
    fn step_bound(&self) -> u32;

    /// What the memory holds: at address `n`, the heights from `n * height_ports().len()` on, as
    /// many as there are ports.
    fn memory<'a>(&self, pyramid: &'a Pyramid) -> Cow<'a, [u16]> {
        Cow::Borrowed(pyramid.memory())
    }
    /// What the ray ports carry for an admitted ray, in their declared order. Here: `u`, `v`,
    /// `du`, `dv`, each rounded once as the reading's [`NumberFormat`] says.
    fn enter<R: NumberFormat>(&self, reading: &mut R, ray: Ray<f64>) -> Vec<Signal<R>> {
        let ray = enter(reading, ray);
        [ray.u, ray.v, ray.du, ray.dv].map(Signal::Number).to_vec()
    }
    /// The same in front of a map, where it depends on what the map holds. Here: [`Step::enter`].
    fn enter_over<R: NumberFormat>(
        &self,
        reading: &mut R,
        _: &Pyramid,
        ray: Ray<f64>,
    ) -> Vec<Signal<R>> {
        self.enter(reading, ray)
    }

    /// Sets a ray up: appends ray registers, then walk registers, in their declared order.
    fn set_up_into<A: Arith>(&self, a: &mut A, ray: &[Signal<A>], registers: &mut Vec<Signal<A>>);
    /// The address the memory is asked for, unsigned; `registers` are ray and walk registers.
    fn address<A: Arith>(&self, a: &mut A, registers: &[Signal<A>]) -> A::Int;
    /// One step: appends the walk registers after it, in their declared order, to `next_walk`, and
    /// what the hit would be (`texel_i`, `texel_j`, depth and position), named, to `answer`.
    fn step_into<A: Arith>(
        &self,
        a: &mut A,
        registers: &[Signal<A>],
        heights: &[A::Int],
        next_walk: &mut Vec<Signal<A>>,
        answer: &mut Vec<Named<A>>,
    );

    /// [`Step::set_up_into`] a row of its own, where speed does not matter.
    fn set_up<A: Arith>(&self, a: &mut A, ray: &[Signal<A>]) -> Vec<Signal<A>> {
        let mut registers = Vec::new();
        self.set_up_into(a, ray, &mut registers);
        registers
    }
    /// [`Step::step_into`] rows of their own, where speed does not matter.
    fn step<A: Arith>(
        &self,
        a: &mut A,
        registers: &[Signal<A>],
        heights: &[A::Int],
    ) -> (Vec<Signal<A>>, Vec<Named<A>>) {
        let (mut next_walk, mut answer) = (Vec::new(), Vec::new());
        self.step_into(a, registers, heights, &mut next_walk, &mut answer);
        (next_walk, answer)
    }
}
