//! Words, memories and counts as the exact machine's parts are built of them.

use super::Build;
use crate::netlist::Wire;

impl Build<'_> {
    /// The word in this width: of a signed word.
    pub(super) fn fit(&mut self, wire: Wire, width: u32) -> Wire {
        match self.b.width(wire) > width {
            true => self.b.slice(wire, width - 1, 0),
            false => self.b.sign_extend(wire, width),
        }
    }

    pub(super) fn load(&mut self, register: &str, value: Wire, enable: Wire) {
        let register = self.get(register);
        let value = self.fit(value, self.b.width(register));
        self.b.connect_enabled(register, value, enable);
    }

    /// Words side by side in block RAMs of up to 64 bits; answers what is read into registers. Whatever is
    /// written at the edge at which it would be read is not read: the register keeps what it had.
    pub(super) fn read_memory(
        &mut self,
        name: &str,
        fields: &[Wire],
        (writes, write): (Wire, Wire),
        (reads, read): (Wire, Wire),
    ) -> Vec<Wire> {
        let b = &mut self.b;
        let same = b.equal(write, read);
        let collides = b.and(writes, same);
        let apart = b.not(collides);
        let enable = b.and(reads, apart);
        let words = 1 << b.width(write);
        let mut groups: Vec<Vec<Wire>> = Vec::new();
        let mut bits = 65;
        for &field in fields {
            if bits + b.width(field) > 64 {
                groups.push(Vec::new());
                bits = 0;
            }
            bits += b.width(field);
            groups.last_mut().expect("one was pushed").push(field);
        }
        let mut outputs = Vec::new();
        for (number, group) in groups.iter().enumerate() {
            let data = b.concat(group);
            let memory = b.memory(&format!("{name}_{number}"), words, b.width(data));
            b.memory_in_block(memory);
            b.memory_write(memory, writes, write, data);
            let word = b.memory_read(memory, read);
            let word = b.registered(word, Some(enable), None);
            let mut high = b.width(word);
            for &field in group {
                let width = b.width(field);
                outputs.push(b.slice(word, high - 1, high - width));
                high -= width;
            }
        }
        outputs
    }

    /// Is a count at least this?
    pub(super) fn reaches(&mut self, count: Wire, bound: u32) -> Wire {
        let bound = self.b.constant(bound.into(), self.b.width(count));
        let below = self.b.less_than(count, bound);
        self.b.not(below)
    }

    pub(super) fn next_number(&mut self, count: Wire) -> Wire {
        let one = self.b.constant(1, self.b.width(count));
        self.b.add(count, one)
    }

    pub(super) fn all(&mut self, bits: &[Wire]) -> Wire {
        let mut result = bits[0];
        for &bit in &bits[1..] {
            result = self.b.and(result, bit);
        }
        result
    }

    /// The lowest bit set, alone, and its number.
    pub(super) fn lowest(&mut self, word: Wire) -> (Wire, Wire) {
        let width = self.b.width(word);
        let zero = self.b.constant(0, width);
        let negative = self.b.subtract(zero, word);
        let one_hot = self.b.and(word, negative);
        let bits = width.trailing_zeros();
        let number: Vec<Wire> = (0..bits)
            .rev()
            .map(|bit| {
                let places = (0..width).filter(|place| place >> bit & 1 == 1);
                let mask = places.fold(0_u64, |mask, place| mask | 1 << place);
                let mask = self.b.constant(mask, width);
                let of_bit = self.b.and(one_hot, mask);
                self.b.any_bit(of_bit)
            })
            .collect();
        (one_hot, self.b.concat(&number))
    }
}
