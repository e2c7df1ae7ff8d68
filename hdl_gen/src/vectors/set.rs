//! Vectors of one unit, and the text they are written as.

use super::field::{Field, Role};

/// Vectors of one unit: fields, and for each vector one value a field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VectorSet {
    /// The fields, the first at the most significant end of a line.
    pub fields: Vec<Field>,
    /// The vectors; each value in the low bits of its word.
    pub vectors: Vec<Vec<u64>>,
}

impl VectorSet {
    /// A set without vectors.
    pub fn new(fields: Vec<Field>) -> VectorSet {
        VectorSet {
            fields,
            vectors: Vec::new(),
        }
    }

    /// Bits of a vector.
    pub fn width(&self) -> u32 {
        self.fields.iter().map(|field| field.width).sum()
    }

    /// Bits of the fields of one role.
    pub fn width_of(&self, role: Role) -> u32 {
        let fields = self.fields.iter().filter(|field| field.role == role);
        fields.map(|field| field.width).sum()
    }

    /// Adds a vector.
    ///
    /// # Panics
    /// If there is not one value a field, or a value has bits beyond its field: a mistake of the
    /// code that makes the vectors.
    pub fn push(&mut self, values: Vec<u64>) {
        assert_eq!(values.len(), self.fields.len(), "one value a field");
        for (field, value) in self.fields.iter().zip(&values) {
            assert_eq!(value & !field.mask(), 0, "{}: {value:#x}", field.name);
        }
        self.vectors.push(values);
    }

    /// The set with at most so many of its vectors, taken evenly from first to last.
    pub fn thinned(mut self, most: usize) -> VectorSet {
        let count = self.vectors.len();
        if count > most {
            let kept = (0..most).map(|place| self.vectors[place * count / most].clone());
            self.vectors = kept.collect();
        }
        self
    }

    /// The lowest bit of each field in a vector, in the order of the fields.
    pub fn low_bits(&self) -> Vec<u32> {
        let mut low = self.width();
        let place = |field: &Field| {
            low -= field.width;
            low
        };
        self.fields.iter().map(place).collect()
    }

    /// The content of the `$readmemh` file: a line a vector, lower case, as many digits as the
    /// width takes, zeros in front of the first field.
    pub fn to_hex(&self) -> String {
        let mut text = String::new();
        let mut bits: Vec<u8> = Vec::new();
        for vector in &self.vectors {
            bits.clear();
            for (field, value) in self.fields.iter().zip(vector).rev() {
                bits.extend((0..field.width).map(|bit| (value >> bit & 1) as u8));
            }
            let digits = bits.chunks(4).rev().map(|nibble| {
                let digit = nibble.iter().rev().fold(0, |digit, &bit| digit << 1 | bit);
                char::from(b"0123456789abcdef"[usize::from(digit)])
            });
            text.extend(digits);
            text.push('\n');
        }
        text
    }

    /// Reads what [`VectorSet::to_hex`] writes.
    ///
    /// # Errors
    /// The first line that is not a vector of these fields, and what is wrong with it.
    pub fn from_hex(fields: Vec<Field>, text: &str) -> Result<VectorSet, String> {
        let mut set = VectorSet::new(fields);
        let digits = set.width().div_ceil(4) as usize;
        for (number, line) in text.lines().enumerate() {
            let wrong = |what: &str| Err(format!("line {}: {what}", number + 1));
            if line.len() != digits {
                return wrong(&format!("{} digits where {digits} are wanted", line.len()));
            }
            // The least significant bit first.
            let mut bits = Vec::with_capacity(4 * digits);
            for digit in line.chars().rev() {
                let Some(value) = digit.to_digit(16) else {
                    return wrong(&format!("`{digit}` is no hexadecimal digit"));
                };
                bits.extend((0..4).map(|bit| u64::from(value >> bit & 1)));
            }
            let width = set.width() as usize;
            if bits[width..].contains(&1) {
                return wrong(&format!("a bit above the {width} of a vector is set"));
            }
            let mut low = width;
            let value = |field: &Field| {
                let high = low;
                low -= field.width as usize;
                bits[low..high]
                    .iter()
                    .rev()
                    .fold(0, |word, bit| word << 1 | bit)
            };
            let values = set.fields.iter().map(value).collect();
            set.vectors.push(values);
        }
        Ok(set)
    }
}

#[cfg(test)]
mod tests {
    use super::super::field::FieldFormat;
    use super::*;

    fn fields() -> Vec<Field> {
        [
            ("a_i", Role::Input, 1),
            ("b_i", Role::Input, 64),
            ("c_o", Role::Output, 5),
        ]
        .into_iter()
        .map(|(name, role, width)| Field::new(name, role, width, FieldFormat::Unsigned, ""))
        .collect()
    }

    #[test]
    fn the_first_field_is_at_the_most_significant_end() {
        let mut set = VectorSet::new(fields());
        set.push(vec![1, 0, 0x1f]);
        set.push(vec![0, u64::MAX, 0]);
        assert_eq!(set.width(), 70);
        assert_eq!(set.width_of(Role::Output), 5);
        assert_eq!(set.low_bits(), [69, 5, 0]);
        assert_eq!(set.to_hex(), "20000000000000001f\n1fffffffffffffffe0\n");
        assert_eq!(VectorSet::from_hex(fields(), &set.to_hex()), Ok(set));
    }

    #[test]
    fn lines_that_are_no_vectors_are_named() {
        for (text, expected) in [
            ("0\n", "line 1: 1 digits where 18 are wanted"),
            ("00000000000000000g\n", "line 1: `g` is no"),
            (
                "000000000000000000\n400000000000000000\n",
                "line 2: a bit above the 70",
            ),
        ] {
            let message = VectorSet::from_hex(fields(), text).unwrap_err();
            assert!(message.contains(expected), "{message}");
        }
    }
}
