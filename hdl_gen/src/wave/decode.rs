//! Bits as the numbers they stand for, and how far apart two numbers are.

use super::LogicWord;
use super::logic::low_mask;
use crate::netlist::Meaning;
use rtl_model::float::FloatFormat;

/// The value of a float's bits, exactly: every value of every format up to e11f52 is an `f64`.
///
/// Bits above the format's width are ignored. A subnormal pattern is decoded as the number IEEE
/// 754 gives it, also where the hardware reads it as zero. Every NaN becomes one quiet NaN.
pub fn float_to_f64(format: FloatFormat, bits: u64) -> f64 {
    let exponent = bits >> format.fraction_bits & format.exponent_all_ones();
    let fraction = bits & format.fraction_mask();
    let magnitude = if exponent == format.exponent_all_ones() {
        if fraction == 0 {
            f64::INFINITY
        } else {
            return f64::NAN;
        }
    } else {
        let hidden_one = if exponent == 0 { 0 } else { format.min_normal() };
        let scale = exponent.max(1) as i32 - format.exponent_bias() - format.fraction_bits as i32;
        // At most 53 bits: exact. So is the product, a multiple of 2^-1074 with at most 53 bits.
        (hidden_one | fraction) as f64 * power_of_two(scale)
    };
    if bits & format.sign_bit() == 0 {
        magnitude
    } else {
        -magnitude
    }
}

/// `2^exponent` for -1074 to 1023.
fn power_of_two(exponent: i32) -> f64 {
    if exponent >= -1022 {
        f64::from_bits(((exponent + 1023) as u64) << 52)
    } else {
        f64::from_bits(1 << (exponent + 1074))
    }
}

/// The low `width` bits (1 to 64) as a two's complement integer.
pub fn two_s_complement(width: u32, bits: u64) -> i64 {
    let unused = 64 - width.clamp(1, 64);
    ((bits << unused) as i64) >> unused
}

/// How many representable values one must step over to come from `a` to `b`: the distance in
/// units in the last place where both have the same exponent. None where either is NaN.
///
/// The values are ordered as numbers; the two zeros are one place, so they are 0 steps apart;
/// infinity is one step beyond the largest finite value.
pub fn steps_between(format: FloatFormat, a: u64, b: u64) -> Option<u64> {
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

/// A word as people read it: a float as a decimal number, a signed or unsigned integer in decimal.
/// None where a bit is x or z.
pub fn decoded(meaning: Meaning, width: u32, word: LogicWord) -> Option<String> {
    let bits = word.low_bits(width).as_known()?;
    Some(match meaning {
        Meaning::Bits => (bits & low_mask(width)).to_string(),
        Meaning::Signed => two_s_complement(width, bits).to_string(),
        Meaning::Float(format) => real_text(float_to_f64(format, bits)),
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

    #[test]
    fn binary64_and_binary32_decode_as_the_machine_decodes_them() {
        let binary64 = FloatFormat::new(11, 52);
        let binary32 = FloatFormat::new(8, 23);
        let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
        for round in 0..200_000_u64 {
            bits = bits.wrapping_mul(0xd134_2543_de82_ef95).wrapping_add(round);
            // A third of the patterns are subnormal, a few special.
            let pattern = match round % 6 {
                0 | 1 => bits & 0x800f_ffff_ffff_ffff,
                2 => bits | 0x7ff0_0000_0000_0000,
                _ => bits,
            };
            let machine = f64::from_bits(pattern);
            let ours = float_to_f64(binary64, pattern);
            assert!(machine.is_nan() && ours.is_nan() || machine.to_bits() == ours.to_bits());
            let single = (pattern >> 32) as u32;
            let (machine, ours) = (
                f64::from(f32::from_bits(single)),
                float_to_f64(binary32, u64::from(single)),
            );
            assert!(machine.is_nan() && ours.is_nan() || machine.to_bits() == ours.to_bits());
        }
    }

    #[test]
    fn the_steps_of_a_small_format_are_the_count_of_values_between() {
        let format = FloatFormat::E4F3;
        let all: Vec<u64> = (0..=format.value_mask()).collect();
        // Distinct numbers in order; the two zeros are one.
        let mut numbers: Vec<f64> = all.iter().map(|&b| float_to_f64(format, b)).collect();
        numbers.retain(|number| !number.is_nan());
        numbers.sort_by(f64::total_cmp);
        numbers.dedup_by(|a, b| a == b);
        let rank = |bits: u64| {
            let value = float_to_f64(format, bits);
            numbers.iter().position(|&number| number == value)
        };
        for &a in &all {
            for &b in &all {
                let expected = match (rank(a), rank(b)) {
                    (Some(a), Some(b)) => Some(a.abs_diff(b) as u64),
                    _ => None,
                };
                assert_eq!(steps_between(format, a, b), expected, "{a:#x} {b:#x}");
            }
        }
    }

    #[test]
    fn real_text_is_short_and_reads_back() {
        for value in [0.1, -5e-324, f64::MIN, 1.0 / 3.0, f64::INFINITY, 1e300, -0.0] {
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
}
