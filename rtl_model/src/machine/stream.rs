//! A pipeline that stalls as a whole: what a single operator behind handshakes does.

/// What the ports of a stalling pipeline carry in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamOutputs<'a> {
    /// Operands offered in this cycle are taken.
    pub ready: bool,
    /// A result is offered.
    pub valid: bool,
    /// The result, or what stands in its place.
    pub results: &'a [u64],
}

/// A pipeline of operators, cycle by cycle. It advances in every cycle in which its last place is
/// empty or its result is taken; else everything stays.
#[derive(Clone, Debug)]
pub struct StreamMachine {
    /// Valid bits, the newest first.
    valid: Vec<bool>,
    /// Results, `width` words a place, as a ring.
    results: Vec<u64>,
    width: usize,
    newest: usize,
}

impl StreamMachine {
    /// A pipeline of `latency` places (at least one), after a reset in which every place has
    /// filled with the result of idle operands.
    pub fn new(latency: u32, idle_results: &[u64]) -> StreamMachine {
        let places = latency.max(1) as usize;
        StreamMachine {
            valid: vec![false; places],
            results: idle_results.repeat(places),
            width: idle_results.len(),
            newest: 0,
        }
    }

    fn last(&self) -> usize {
        (self.newest + self.valid.len() - 1) % self.valid.len()
    }

    /// What the output ports carry while the receiver is ready or not.
    pub fn outputs(&self, receiver_ready: bool) -> StreamOutputs<'_> {
        let last = self.last();
        let valid = self.valid[last];
        StreamOutputs {
            ready: receiver_ready || !valid,
            valid,
            results: &self.results[last * self.width..][..self.width],
        }
    }

    /// The rising edge at the end of a cycle: `results` belong to the operands offered in it.
    pub fn clock(&mut self, receiver_ready: bool, operands_valid: bool, results: &[u64]) {
        if !self.outputs(receiver_ready).ready {
            return;
        }
        let place = self.last();
        self.valid[place] = operands_valid;
        self.results[place * self.width..][..self.width].copy_from_slice(results);
        self.newest = place;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_result_appears_after_the_latency_and_waits_to_be_taken() {
        let mut machine = StreamMachine::new(3, &[9]);
        machine.clock(false, true, &[1]);
        machine.clock(false, true, &[2]);
        assert!(!machine.outputs(false).valid);
        machine.clock(false, false, &[9]);
        for _ in 0..3 {
            let outputs = machine.outputs(false);
            assert_eq!(
                (outputs.ready, outputs.valid, outputs.results),
                (false, true, &[1][..])
            );
            machine.clock(false, true, &[3]);
        }
        machine.clock(true, false, &[9]);
        assert_eq!(machine.outputs(true).results, [2]);
        machine.clock(true, false, &[9]);
        assert!(!machine.outputs(true).valid);
    }
}
