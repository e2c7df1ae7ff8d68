//! The rounder: cuts an exact result at the result's last place.

use rtl_model::float::Rounding;

use super::fit::{Rounded, fit};
use super::{Answer, FixedConfiguration};
use crate::netlist::{Builder, Wire};

/// An exact result.
pub(super) struct Exact {
    /// Two's complement where `signed`.
    pub word: Wire,
    pub signed: bool,
    /// Bits of the word behind the point.
    pub fraction_bits: u32,
    /// Is anything behind the word's last bit? Then there is at least one bit more than the result
    /// keeps.
    pub sticky: Option<Wire>,
    /// The result's sign and that it is far beyond the range, where the word does not tell.
    pub beyond: Option<Beyond>,
}

/// A result that the word cannot hold.
#[derive(Clone, Copy)]
pub(super) struct Beyond {
    /// Is it one?
    pub is_beyond: Wire,
    /// Its sign; None where nothing is negative.
    pub negative: Option<Wire>,
}

impl Exact {
    /// A result that a word holds.
    pub(super) fn new(word: Wire, signed: bool, fraction_bits: u32) -> Exact {
        Exact {
            word,
            signed,
            fraction_bits,
            sticky: None,
            beyond: None,
        }
    }
}

/// Does anybody ask whether the result is exact?
fn asks_inexact(configuration: FixedConfiguration) -> bool {
    configuration.has_flags || configuration.rounding != Rounding::Down
}

/// Rounds, then saturates or wraps: the last sections of an operator.
pub(super) fn round(
    builder: &mut Builder,
    configuration: FixedConfiguration,
    exact: &Exact,
) -> Answer {
    let result_fraction = configuration.result.fraction_bits;
    let Some(places) = exact
        .fraction_bits
        .checked_sub(result_fraction)
        .filter(|&places| places > 0)
    else {
        assert!(exact.sticky.is_none(), "a sticky bit beside a kept one");
        let rounded = Rounded::new(exact.word, exact.signed, exact.fraction_bits);
        return fit(
            builder,
            configuration,
            &Rounded {
                beyond: exact.beyond,
                ..rounded
            },
        );
    };
    builder.section(format!("round: {places} bits are dropped"));
    // At least one bit is kept: of a word that ends behind the result's last place its sign.
    let word = if builder.width(exact.word) > places {
        exact.word
    } else if exact.signed {
        builder.sign_extend(exact.word, places + 1)
    } else {
        builder.zero_extend(exact.word, places + 1)
    };
    let top = builder.width(word) - 1;
    let floor = builder.slice(word, top, places);
    builder.name(floor, "rounded_down");
    let guard = builder.bit(word, places - 1);
    builder.name(guard, "guard_bit");
    let mut below = (places > 1).then(|| {
        let below = builder.slice(word, places - 2, 0);
        builder.any_bit(below)
    });
    if let Some(sticky) = exact.sticky {
        below = Some(match below {
            Some(below) => builder.or(below, sticky),
            None => sticky,
        });
    }
    if let Some(below) = below {
        builder.name(below, "sticky_bit");
    }
    let inexact = asks_inexact(configuration).then(|| {
        let inexact = match below {
            Some(below) => builder.or(guard, below),
            None => guard,
        };
        builder.name(inexact, "is_inexact")
    });
    // Cutting a two's complement word rounds it down.
    let increment = match configuration.rounding {
        Rounding::Down => None,
        Rounding::Up => inexact,
        Rounding::TowardZero => exact.signed.then(|| {
            // A word that could not hold the result has not its sign.
            let own = builder.bit(word, top);
            let negative = exact.beyond.and_then(|beyond| beyond.negative);
            let inexact = inexact.expect("asked for");
            builder.and(negative.unwrap_or(own), inexact)
        }),
        Rounding::NearestEven => {
            let last_bit = builder.bit(floor, 0);
            let odd_or_above = match below {
                Some(below) => builder.or(last_bit, below),
                None => last_bit,
            };
            builder.name(odd_or_above, "odd_or_above");
            Some(builder.and(guard, odd_or_above))
        }
    };
    let word = match increment {
        Some(increment) => {
            builder.name(increment, "round_up");
            // One more bit, so that a carry is seen and not wrapped.
            let bits = builder.width(floor) + 1;
            let floor = if exact.signed {
                builder.sign_extend(floor, bits)
            } else {
                builder.zero_extend(floor, bits)
            };
            let increment = builder.zero_extend(increment, bits);
            let rounded = builder.add(floor, increment);
            builder.name(rounded, "rounded")
        }
        None => floor,
    };
    fit(
        builder,
        configuration,
        &Rounded {
            inexact,
            beyond: exact.beyond,
            ..Rounded::new(word, exact.signed, result_fraction)
        },
    )
}

/// A result as its sign and a magnitude with nothing cut off but what `sticky` tells of.
pub(super) struct SignMagnitude {
    /// None where nothing is negative.
    pub sign: Option<Wire>,
    /// The magnitude's bits down to the result's last place.
    pub kept: Wire,
    /// The bit behind them; none where only the sticky bit matters.
    pub guard: Option<Wire>,
    /// Is anything behind that?
    pub sticky: Option<Wire>,
}

/// Rounds a magnitude and gives it its sign, in one addition: -(m + r) is the complement of m,
/// plus 1 - r.
pub(super) fn round_magnitude(
    builder: &mut Builder,
    configuration: FixedConfiguration,
    exact: &SignMagnitude,
) -> Rounded {
    builder.section("round");
    let inexact = match (exact.guard, exact.sticky) {
        (Some(guard), Some(sticky)) => Some(builder.or(guard, sticky)),
        (one, other) => one.or(other),
    };
    if let Some(inexact) = inexact {
        builder.name(inexact, "is_inexact");
    }
    let increment = match configuration.rounding {
        Rounding::TowardZero => None,
        Rounding::NearestEven => exact.guard.map(|guard| {
            let last_bit = builder.bit(exact.kept, 0);
            let odd_or_above = match exact.sticky {
                Some(sticky) => builder.or(last_bit, sticky),
                None => last_bit,
            };
            builder.name(odd_or_above, "odd_or_above");
            builder.and(guard, odd_or_above)
        }),
        Rounding::Up => inexact.map(|inexact| match exact.sign {
            Some(sign) => {
                let positive = builder.not(sign);
                builder.and(inexact, positive)
            }
            None => inexact,
        }),
        Rounding::Down => match (inexact, exact.sign) {
            (Some(inexact), Some(sign)) => Some(builder.and(inexact, sign)),
            _ => None,
        },
    };
    if let Some(increment) = increment {
        builder.name(increment, "round_up");
    }
    // A carry, and a sign where there is one.
    let bits = builder.width(exact.kept) + 1 + u32::from(exact.sign.is_some());
    let magnitude = builder.zero_extend(exact.kept, bits);
    let (word, carry) = match (exact.sign, increment) {
        (None, increment) => (magnitude, increment),
        (Some(sign), increment) => {
            let signs = builder.sign_extend(sign, bits);
            let complemented = builder.xor(magnitude, signs);
            builder.name(complemented, "complemented");
            let carry = match increment {
                Some(increment) => builder.xor(sign, increment),
                None => sign,
            };
            (complemented, Some(carry))
        }
    };
    let word = match carry {
        Some(carry) => {
            let carry = builder.zero_extend(carry, bits);
            let rounded = builder.add(word, carry);
            builder.name(rounded, "rounded")
        }
        None => word,
    };
    Rounded {
        inexact,
        ..Rounded::new(
            word,
            exact.sign.is_some(),
            configuration.result.fraction_bits,
        )
    }
}
