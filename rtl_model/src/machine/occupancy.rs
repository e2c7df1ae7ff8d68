//! How full a loop is, over time.

/// Trips begun in equal spans of cycles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OccupancyOverTime {
    /// Cycles of a span.
    span: u64,
    /// Trips begun in each.
    trips: Vec<u64>,
    cycles: u64,
}

/// Spans kept: where there are more, two become one.
const MOST_SPANS: usize = 256;

impl Default for OccupancyOverTime {
    fn default() -> Self {
        OccupancyOverTime {
            span: 64,
            trips: vec![0],
            cycles: 0,
        }
    }
}

impl OccupancyOverTime {
    /// A cycle goes by, in which a trip begins or not.
    pub fn cycle(&mut self, trip_begins: bool) {
        if self.cycles == self.span * self.trips.len() as u64 {
            if self.trips.len() == MOST_SPANS {
                self.trips = self.trips.chunks(2).map(|pair| pair.iter().sum()).collect();
                self.span *= 2;
            }
            self.trips.push(0);
        }
        self.cycles += 1;
        if let Some(last) = self.trips.last_mut() {
            *last += u64::from(trip_begins);
        }
    }

    /// For each span the cycle in its middle and the trips begun a cycle, 0 to 1.
    pub fn points(&self) -> Vec<(f64, f64)> {
        let count = self.trips.len();
        let point = |(place, &trips): (usize, &u64)| {
            let start = place as u64 * self.span;
            let cycles = match place + 1 == count {
                true => self.cycles - start,
                false => self.span,
            };
            let middle = start as f64 + cycles as f64 / 2.0;
            (middle, trips as f64 / cycles.max(1) as f64)
        };
        self.trips.iter().enumerate().map(point).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_grow_and_lose_no_trip() {
        let mut occupancy = OccupancyOverTime::default();
        let cycles = 64 * 256 + 100;
        for cycle in 0..cycles {
            occupancy.cycle(cycle % 4 != 0);
        }
        let points = occupancy.points();
        assert_eq!(occupancy.span, 128);
        assert_eq!(occupancy.trips.iter().sum::<u64>(), cycles * 3 / 4);
        assert!(points.iter().all(|point| (point.1 - 0.75).abs() < 1e-9));
        assert_eq!(points.len(), 129);
    }
}
