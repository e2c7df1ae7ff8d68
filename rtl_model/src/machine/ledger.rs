//! What left a unit, held against what had to: every ray once, with its own answer.

/// Words of a machine's hit, its id the first.
pub const HIT_WORDS: usize = 9;

/// Keeps account of the hits that leave a unit.
#[derive(Clone, Debug)]
pub struct HitLedger {
    /// The words of each ray's hit.
    expected: Vec<[u64; HIT_WORDS]>,
    has_left: Vec<bool>,
    report: HitReport,
}

/// What an account came to. `left` is less than the rays where some were lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HitReport {
    /// Rays sent.
    pub rays: u64,
    /// Rays that left, each counted once.
    pub left: u64,
    /// Hits that left a second time, or of an id that was never sent.
    pub duplicated: u64,
    /// Hits with other words than the golden walk's.
    pub differing: u64,
}

impl HitReport {
    /// Rays that never left.
    pub fn lost(&self) -> u64 {
        self.rays - self.left
    }

    /// Did every ray leave once, with its own hit?
    pub fn agrees(&self) -> bool {
        self.lost() == 0 && self.duplicated == 0 && self.differing == 0
    }
}

impl HitLedger {
    /// An account of rays whose hits must be these; a ray's id is its place.
    pub fn new(expected: Vec<[u64; HIT_WORDS]>) -> HitLedger {
        HitLedger {
            has_left: vec![false; expected.len()],
            report: HitReport {
                rays: expected.len() as u64,
                ..HitReport::default()
            },
            expected,
        }
    }

    /// A hit leaves.
    pub fn enter(&mut self, found: &[u64; HIT_WORDS]) {
        let id = found[0] as usize;
        let Some(has_left) = self.has_left.get_mut(id) else {
            self.report.duplicated += 1;
            return;
        };
        if std::mem::replace(has_left, true) {
            self.report.duplicated += 1;
            return;
        }
        self.report.left += 1;
        self.report.differing += u64::from(*found != self.expected[id]);
    }

    /// The account so far.
    pub fn report(&self) -> HitReport {
        self.report
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_lost_doubled_or_different_is_counted() {
        let hit = |id, i| {
            let mut words = [0; HIT_WORDS];
            (words[0], words[1]) = (id, i);
            words
        };
        let mut ledger = HitLedger::new(vec![hit(0, 7), hit(1, 8), hit(2, 9)]);
        ledger.enter(&hit(1, 8));
        ledger.enter(&hit(0, 7));
        assert!(!ledger.report().agrees());
        let mut whole = ledger.clone();
        whole.enter(&hit(2, 9));
        assert!(whole.report().agrees());
        ledger.enter(&hit(2, 8));
        ledger.enter(&hit(1, 8));
        ledger.enter(&hit(3, 8));
        let report = ledger.report();
        assert_eq!(
            (report.lost(), report.duplicated, report.differing),
            (0, 2, 1)
        );
    }
}
