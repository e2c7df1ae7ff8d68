//! What a clocked unit's model and its Verilog share: the names, widths and reset values of ports
//! and registers. What they do is written twice.

/// What a declared signal is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeclaredKind {
    /// An input port.
    Input,
    /// An output port.
    Output,
    /// A signal inside that follows inputs and registers within the cycle.
    Wire,
    /// A register, with its value under reset; data registers have none.
    Register(Option<u64>),
}

/// A port or a signal of a clocked unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Declared {
    /// Its name, the same in the model's declaration and in Verilog.
    pub name: String,
    /// Its bits, 1 to 64.
    pub width: u32,
    /// What it is.
    pub kind: DeclaredKind,
}

impl Declared {
    /// An input port.
    pub fn input(name: impl Into<String>, width: u32) -> Declared {
        Declared::new(name, width, DeclaredKind::Input)
    }

    /// An output port.
    pub fn output(name: impl Into<String>, width: u32) -> Declared {
        Declared::new(name, width, DeclaredKind::Output)
    }

    /// A signal inside.
    pub fn wire(name: impl Into<String>, width: u32) -> Declared {
        Declared::new(name, width, DeclaredKind::Wire)
    }

    /// A register of control, with its value under reset.
    pub fn register(name: impl Into<String>, width: u32, reset: u64) -> Declared {
        Declared::new(name, width, DeclaredKind::Register(Some(reset)))
    }

    /// A register of data, which no reset touches.
    pub fn data_register(name: impl Into<String>, width: u32) -> Declared {
        Declared::new(name, width, DeclaredKind::Register(None))
    }

    fn new(name: impl Into<String>, width: u32, kind: DeclaredKind) -> Declared {
        let name = name.into();
        assert!((1..=64).contains(&width), "{name}: a width of {width} bits");
        Declared { name, width, kind }
    }
}

/// A unit of hardware, cycle by cycle: what can be held against its Verilog.
///
/// A cycle is: inputs are driven, [`observe`](ClockedUnit::observe) tells every declared signal,
/// [`clock`](ClockedUnit::clock) is the rising edge that ends the cycle. The inputs are words in
/// the order of the declared input ports.
pub trait ClockedUnit {
    /// The input ports, in the order in which they are driven, then all signals that are observed.
    fn declaration(&self) -> Vec<Declared>;

    /// Appends the word of every declared signal that is no input, in the order of the
    /// declaration, as it stands in this cycle.
    fn observe(&self, driven: &[u64], words: &mut Vec<u64>);

    /// The rising edge at the end of this cycle.
    fn clock(&mut self, driven: &[u64]);
}

/// The bits that tell `count` things apart: none for one.
pub fn bits_for(count: u32) -> u32 {
    count.next_power_of_two().trailing_zeros()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_tell_things_apart() {
        let bits: Vec<u32> = [1, 2, 3, 4, 5, 256].map(bits_for).to_vec();
        assert_eq!(bits, [0, 1, 2, 2, 3, 8]);
    }
}
