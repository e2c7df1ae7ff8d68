//! Comparisons, of numbers of any two formats.

use std::cmp::Ordering;

use super::Fixed;

impl Fixed {
    /// The order of two values, whatever their formats. All six relations follow from it:
    /// `compare(b).is_lt()` and its kin. (`==` of two `Fixed` asks for the same format and bits.)
    pub fn compare(self, b: Fixed) -> Ordering {
        match (self.is_negative(), b.is_negative()) {
            (true, false) => Ordering::Less,
            (false, true) => Ordering::Greater,
            (false, false) => self.compare_magnitudes(b),
            (true, true) => b.compare_magnitudes(self),
        }
    }

    /// The order of the distances from zero.
    fn compare_magnitudes(self, b: Fixed) -> Ordering {
        // Below 2^128, as for a sum.
        let fraction_bits = self.format.fraction_bits.max(b.format.fraction_bits);
        let aligned =
            |x: Fixed| u128::from(x.magnitude()) << (fraction_bits - x.format.fraction_bits);
        aligned(self).cmp(&aligned(b))
    }
}
