//! When the receiver of hits is not ready: a pattern anybody can make again.

/// A 16-bit linear feedback shift register (taps 16, 15, 13, 4; period 65535), stepped once a
/// cycle. The testbenches contain the same register in Verilog.
#[derive(Clone, Copy, Debug)]
pub struct StallPattern {
    state: u16,
    stalls: bool,
}

impl StallPattern {
    /// Not ready in about one cycle of eight. The seed may be anything; zero, which the register
    /// would never leave, is replaced by one.
    pub fn one_in_eight(seed: u16) -> StallPattern {
        StallPattern {
            state: seed.max(1),
            stalls: true,
        }
    }

    /// That of a seed, or none.
    pub fn seeded(seed: Option<u16>) -> StallPattern {
        seed.map_or(StallPattern::never(), StallPattern::one_in_eight)
    }

    /// When sender and receiver of a machine stall, by the seed of a run.
    pub fn of_sender_and_receiver(seed: Option<u16>) -> [StallPattern; 2] {
        [seed.map(|seed| seed.rotate_left(3)), seed].map(StallPattern::seeded)
    }

    /// Always ready.
    pub fn never() -> StallPattern {
        StallPattern {
            state: 1,
            stalls: false,
        }
    }

    /// The register's state, from which the pattern can be made again elsewhere; none where it
    /// never stalls.
    pub fn state(&self) -> Option<u16> {
        self.stalls.then_some(self.state)
    }

    /// Is the receiver ready in this cycle? Steps the register.
    pub fn next_ready(&mut self) -> bool {
        let bit = self.state ^ (self.state >> 1) ^ (self.state >> 3) ^ (self.state >> 12);
        let ready = !self.stalls || self.state & 7 != 0;
        self.state = (self.state >> 1) | (bit << 15);
        ready
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_register_runs_through_all_its_states() {
        let mut pattern = StallPattern::one_in_eight(0xace1);
        let mut stalled = 0;
        for step in 1..=65535 {
            stalled += u32::from(!pattern.next_ready());
            assert_eq!(pattern.state == 0xace1, step == 65535);
        }
        // Every state but zero occurs once: 8191 of the 65535 end in three zeros.
        assert_eq!(stalled, 8191);
    }
}
