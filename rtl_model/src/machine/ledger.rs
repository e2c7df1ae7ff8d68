//! What left a unit, held against what had to: every ray once, with its own answer.

/// Keeps account of the hits that leave a unit.
#[derive(Clone, Debug)]
pub struct HitLedger {
    width: usize,
    /// The words of each ray's hit, its id the first, one ray after the other.
    expected: Vec<u64>,
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
    /// An account of rays whose hits must be these: `width` words each, the first the ray's id,
    /// which is its place.
    ///
    /// # Panics
    /// If the words are not a whole number of hits.
    pub fn new(expected: Vec<u64>, width: usize) -> HitLedger {
        assert!(width > 0 && expected.len().is_multiple_of(width));
        let rays = expected.len() / width;
        HitLedger {
            width,
            expected,
            has_left: vec![false; rays],
            report: HitReport {
                rays: rays as u64,
                ..HitReport::default()
            },
        }
    }

    /// A hit leaves.
    pub fn enter(&mut self, found: &[u64]) {
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
        let expected = &self.expected[id * self.width..][..self.width];
        self.report.differing += u64::from(found != expected);
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
        let mut ledger = HitLedger::new(vec![0, 7, 1, 8, 2, 9], 2);
        ledger.enter(&[1, 8]);
        ledger.enter(&[0, 7]);
        assert!(!ledger.report().agrees());
        let mut whole = ledger.clone();
        whole.enter(&[2, 9]);
        assert!(whole.report().agrees());
        ledger.enter(&[2, 8]);
        ledger.enter(&[1, 8]);
        ledger.enter(&[3, 8]);
        let report = ledger.report();
        assert_eq!(
            (report.lost(), report.duplicated, report.differing),
            (0, 2, 1)
        );
    }
}
