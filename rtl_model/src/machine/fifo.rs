//! A FIFO: what is put in first is offered first, in the cycle after it was put in.

use super::declaration::{ClockedUnit, Declared, bits_for};

/// One of the words that stand side by side in a place of a FIFO.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FifoField {
    /// Its ports are `in_NAME_i` and `out_NAME_o`.
    pub name: String,
    /// Its bits, 1 to 64.
    pub width: u32,
}

/// What a FIFO is built as.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FifoShape {
    /// The module's name.
    pub name: String,
    /// Places: a power of two, at least 2.
    pub depth: u32,
    /// What a place holds, at least one field.
    pub fields: Vec<FifoField>,
}

impl FifoShape {
    /// A shape, checked.
    ///
    /// # Panics
    /// If `depth` is no power of two from 2 up, or there is no field.
    pub fn new(name: &str, depth: u32, fields: &[(&str, u32)]) -> FifoShape {
        let shape = FifoShape {
            name: name.to_owned(),
            depth,
            fields: fields
                .iter()
                .map(|&(name, width)| FifoField {
                    name: name.to_owned(),
                    width,
                })
                .collect(),
        };
        shape.check();
        shape
    }

    /// # Panics
    /// If it is no FIFO that can be built.
    pub fn check(&self) {
        let name = &self.name;
        let depth = self.depth;
        assert!(
            depth >= 2 && depth.is_power_of_two(),
            "FIFO {name}: a depth of {depth}, which is no power of two from 2 up"
        );
        assert!(!self.fields.is_empty(), "FIFO {name}: no field");
    }

    /// Bits of a pointer to a place; the count has one more.
    pub fn pointer_bits(&self) -> u32 {
        bits_for(self.depth)
    }

    /// Ports and registers, in the order of the words of [`ClockedUnit`].
    pub fn declaration(&self) -> Vec<Declared> {
        let pointer = self.pointer_bits();
        let mut signals = vec![Declared::input("in_valid_i", 1)];
        for field in &self.fields {
            signals.push(Declared::input(format!("in_{}_i", field.name), field.width));
        }
        signals.push(Declared::input("out_ready_i", 1));
        signals.push(Declared::output("in_ready_o", 1));
        signals.push(Declared::output("out_valid_o", 1));
        for field in &self.fields {
            signals.push(Declared::output(
                format!("out_{}_o", field.name),
                field.width,
            ));
        }
        signals.push(Declared::output("count_o", pointer + 1));
        signals.push(Declared::wire("puts", 1));
        signals.push(Declared::wire("takes", 1));
        signals.push(Declared::register("count", pointer + 1, 0));
        signals.push(Declared::register("write_pointer", pointer, 0));
        signals.push(Declared::register("read_pointer", pointer, 0));
        signals
    }
}

/// What a FIFO's output ports carry in a cycle; none follows an input within the cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FifoOutputs<'a> {
    /// What is offered in this cycle is put in: a place is free.
    pub in_ready: bool,
    /// Something is offered.
    pub out_valid: bool,
    /// Its fields; where nothing is offered, what stood in that place before, at first zeros.
    pub out: &'a [u64],
    /// Places that are taken.
    pub count: u32,
}

/// A FIFO. A full one takes nothing, even where something is taken out in the same cycle.
#[derive(Clone, Debug)]
pub struct Fifo {
    shape: FifoShape,
    places: Vec<u64>,
    /// What was put in, and taken out, since reset.
    put: u64,
    taken: u64,
}

impl Fifo {
    /// A FIFO after its reset.
    ///
    /// # Panics
    /// If the shape is none that can be built.
    pub fn new(shape: FifoShape) -> Fifo {
        shape.check();
        Fifo {
            places: vec![0; shape.depth as usize * shape.fields.len()],
            shape,
            put: 0,
            taken: 0,
        }
    }

    /// What it is built as.
    pub fn shape(&self) -> &FifoShape {
        &self.shape
    }

    fn pointer(&self, count: u64) -> usize {
        // The depth is a power of two.
        (count & u64::from(self.shape.depth - 1)) as usize
    }

    /// What the output ports carry in this cycle.
    pub fn outputs(&self) -> FifoOutputs<'_> {
        let fields = self.shape.fields.len();
        let count = (self.put - self.taken) as u32;
        FifoOutputs {
            in_ready: count < self.shape.depth,
            out_valid: count > 0,
            out: &self.places[self.pointer(self.taken) * fields..][..fields],
            count,
        }
    }

    /// The rising edge at the end of a cycle, in which `put` was offered and what the FIFO offers
    /// would be taken where `out_ready` is true.
    pub fn clock(&mut self, put: Option<&[u64]>, out_ready: bool) {
        let FifoOutputs {
            in_ready,
            out_valid,
            ..
        } = self.outputs();
        if let Some(put) = put.filter(|_| in_ready) {
            let fields = self.shape.fields.len();
            let place = self.pointer(self.put) * fields;
            self.places[place..][..fields].copy_from_slice(put);
            self.put += 1;
        }
        self.taken += u64::from(out_valid && out_ready);
    }
}

impl ClockedUnit for Fifo {
    fn declaration(&self) -> Vec<Declared> {
        self.shape.declaration()
    }

    fn observe(&self, driven: &[u64], words: &mut Vec<u64>) {
        let outputs = self.outputs();
        let out_ready = driven[1 + self.shape.fields.len()] != 0;
        words.push(outputs.in_ready.into());
        words.push(outputs.out_valid.into());
        words.extend_from_slice(outputs.out);
        words.push(outputs.count.into());
        words.push((driven[0] != 0 && outputs.in_ready).into());
        words.push((outputs.out_valid && out_ready).into());
        words.push(outputs.count.into());
        words.push(self.pointer(self.put) as u64);
        words.push(self.pointer(self.taken) as u64);
    }

    fn clock(&mut self, driven: &[u64]) {
        let fields = self.shape.fields.len();
        let put = (driven[0] != 0).then(|| &driven[1..][..fields]);
        Fifo::clock(self, put, driven[1 + fields] != 0);
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use super::*;

    fn fifo() -> Fifo {
        Fifo::new(FifoShape::new("fifo", 4, &[("id", 20), ("depth", 24)]))
    }

    #[test]
    fn what_is_put_in_comes_out_in_order() {
        let mut fifo = fifo();
        let mut expected = VecDeque::new();
        let mut state = 1u64;
        let mut most = 0;
        for cycle in 0..2000u64 {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            let (offers, takes) = (state >> 60 & 3 != 0, state >> 62 != 0);
            let outputs = fifo.outputs();
            assert_eq!(outputs.count as usize, expected.len());
            assert_eq!(outputs.out_valid, !expected.is_empty());
            assert_eq!(outputs.in_ready, expected.len() < 4);
            most = most.max(outputs.count);
            if let Some(front) = expected.front() {
                assert_eq!(outputs.out, front);
            }
            let in_ready = outputs.in_ready;
            let put = [cycle, !cycle & 0xff_ffff];
            fifo.clock(offers.then_some(&put[..]), takes);
            if takes {
                expected.pop_front();
            }
            if offers && in_ready {
                expected.push_back(put);
            }
        }
        assert_eq!(most, 4);
    }

    #[test]
    fn the_words_follow_the_declaration() {
        let mut fifo = fifo();
        ClockedUnit::clock(&mut fifo, &[1, 7, 9, 0]);
        let mut words = Vec::new();
        fifo.observe(&[0, 0, 0, 0], &mut words);
        assert_eq!(words, [1, 1, 7, 9, 1, 0, 0, 1, 1, 0]);
        assert_eq!(fifo.declaration().len(), 4 + words.len());
    }

    #[test]
    #[should_panic(expected = "no power of two")]
    fn a_depth_that_is_no_power_of_two_is_refused() {
        FifoShape::new("fifo", 12, &[("id", 20)]);
    }
}
