//! Bits as the numbers they stand for, and how far apart two numbers are.

use super::LogicWord;
use super::logic::low_mask;
use crate::netlist::Meaning;
use rtl_model::fixed::Fixed;

/// The low `width` bits (1 to 64) as a two's complement integer.
pub fn two_s_complement(width: u32, bits: u64) -> i64 {
    let unused = 64 - width.clamp(1, 64);
    ((bits << unused) as i64) >> unused
}

/// How many representable values one must step over to come from `a` to `b`: the distance in
/// units in the last place where both have the same exponent. None where either is NaN.
///
/// The values are ordered as numbers; the two zeros are one place, so they are 0 steps apart;
/// infinity is one step beyond the largest finite value. Subnormal patterns count as steps, also
/// where the hardware reads them as zero.
///
/// Between fixed-point numbers it is the distance in units in the last place. Integers and plain
/// bits have none.
pub fn steps_between(meaning: Meaning, a: u64, b: u64) -> Option<u64> {
    let format = match meaning {
        Meaning::Bits | Meaning::Signed => return None,
        Meaning::Float(format) => format,
        Meaning::Fixed(format) => {
            let units = |bits| Fixed::new(format, bits).units();
            return u64::try_from(units(a).abs_diff(units(b))).ok();
        }
    };
    let place = |bits: u64| {
        let magnitude = bits & (format.sign_bit() - 1);
        if magnitude > format.infinity() {
            return None;
        }
        let place = magnitude as i64; // below 2^63: the sign bit is not in it
        Some(if bits & format.sign_bit() == 0 {
            place
        } else {
            -place
        })
    };
    Some(place(a)?.abs_diff(place(b)?))
}

/// A word as people read it: a float as a decimal number (as the hardware reads it: a subnormal
/// pattern is a zero), a fixed-point number as its exact decimal, a signed or unsigned integer in decimal. None where a bit is x or z.
pub fn decoded(meaning: Meaning, width: u32, word: LogicWord) -> Option<String> {
    let bits = word.low_bits(width).as_known()?;
    Some(match meaning {
        Meaning::Bits => (bits & low_mask(width)).to_string(),
        Meaning::Signed => two_s_complement(width, bits).to_string(),
        Meaning::Float(format) => real_text(format.to_f64(bits)),
        Meaning::Fixed(format) => Fixed::new(format, bits).to_string(),
    })
}

/// A real number in the fewest digits that read back to the same `f64`, never more than 32
/// characters (the longest token some VCD readers take), specials as C's `printf` spells them.
pub(crate) fn real_text(value: f64) -> String {
    if value.is_nan() {
        "nan".to_owned()
    } else {
        format!("{value:?}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rtl_model::float::FloatFormat;

    #[test]
    fn the_steps_of_a_small_format_are_the_count_of_values_between() {
        let format = FloatFormat::E4F3;
        let all: Vec<u64> = (0..=format.value_mask()).collect();
        // IEEE 754 by its definition: bias 7, three fraction bits, subnormals counted.
        let number = |bits: u64| {
            let (exponent, fraction) = ((bits >> 3 & 15) as i32, (bits & 7) as f64);
            let magnitude = match exponent {
                0 => fraction / 8.0 * 2f64.powi(-6),
                15 if fraction == 0.0 => f64::INFINITY,
                15 => f64::NAN,
                _ => (1.0 + fraction / 8.0) * 2f64.powi(exponent - 7),
            };
            if bits >> 7 == 1 {
                -magnitude
            } else {
                magnitude
            }
        };
        // Distinct numbers in order; the two zeros are one.
        let mut numbers: Vec<f64> = all.iter().map(|&bits| number(bits)).collect();
        numbers.retain(|number| !number.is_nan());
        numbers.sort_by(f64::total_cmp);
        numbers.dedup_by(|a, b| a == b);
        let rank = |bits: u64| {
            let value = number(bits);
            numbers.iter().position(|&other| other == value)
        };
        for &a in &all {
            for &b in &all {
                let expected = match (rank(a), rank(b)) {
                    (Some(a), Some(b)) => Some(a.abs_diff(b) as u64),
                    _ => None,
                };
                assert_eq!(
                    steps_between(Meaning::Float(format), a, b),
                    expected,
                    "{a:#x} {b:#x}"
                );
            }
        }
    }

    #[test]
    fn real_text_is_short_and_reads_back() {
        for value in [
            0.1,
            -5e-324,
            f64::MIN,
            1.0 / 3.0,
            f64::INFINITY,
            1e300,
            -0.0,
        ] {
            let text = real_text(value);
            assert!(text.len() <= 25, "{text}");
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
        assert!(real_text(f64::NAN).parse::<f64>().unwrap().is_nan());
    }

    #[test]
    fn integers_decode_with_their_sign() {
        assert_eq!(two_s_complement(5, 0x1f), -1);
        assert_eq!(two_s_complement(64, u64::MAX), -1);
        assert_eq!(decoded(Meaning::Signed, 4, 8.into()).unwrap(), "-8");
        assert_eq!(decoded(Meaning::Bits, 4, 8.into()).unwrap(), "8");
        assert_eq!(decoded(Meaning::Bits, 4, LogicWord::X), None);
    }

    #[test]
    fn floats_decode_as_the_hardware_reads_them() {
        let format = FloatFormat::E7F16;
        let text = |bits: u64| decoded(Meaning::Float(format), 24, bits.into()).unwrap();
        assert_eq!(text(format.one()), "1.0");
        assert_eq!(text(format.one() + 1), "1.0000152587890625");
        assert_eq!(text(format.sign_bit() | format.infinity()), "-inf");
        assert_eq!(text(format.quiet_nan()), "nan");
        assert_eq!(text(1), "0.0");
    }
}
