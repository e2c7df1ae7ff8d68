//! The product of two significands: one multiplication, or rows of adders.

use super::configuration::Multiplier;
use crate::netlist::{Builder, Wire};

/// The full product of two significands.
pub(super) fn significand_product(
    builder: &mut Builder,
    multiplier: Multiplier,
    a: Wire,
    b: Wire,
) -> Wire {
    let product = match multiplier {
        Multiplier::Dsp => builder.multiply(a, b),
        Multiplier::Logic => product_by_rows(builder, a, b),
    };
    builder.name(product, "significand_product")
}

/// A word and the place of its lowest bit in the product.
#[derive(Clone, Copy)]
struct Row {
    word: Wire,
    place: u32,
}

impl Row {
    /// The place above its highest bit. A sum of rows never has a carry beyond the highest of
    /// these: each is a product of `a` with some bits of `b`, and so is the sum.
    fn end(self, builder: &Builder) -> u32 {
        self.place + builder.width(self.word)
    }
}

/// Two bits of `b` select one of 0, `a`, 2 `a` and 3 `a`: half as many rows as bits, each of two
/// look-up tables a bit, where a row for every bit would take as many and twice the adders. Booth's
/// digits do without 3 `a`, but have signs, and so cost as many tables and more places. The rows are
/// added two by two, in a tree of carry chains.
fn product_by_rows(builder: &mut Builder, a: Wire, b: Wire) -> Wire {
    let width = builder.width(a);
    let zero = builder.constant(0, 1);
    let none = builder.constant(0, width + 2);
    let once = builder.zero_extend(a, width + 2);
    let twice = builder.concat(&[zero, a, zero]);
    let thrice = builder.add(once, twice);
    builder.name(thrice, "three_times_a");
    let mut rows = Vec::new();
    for place in (0..builder.width(b)).step_by(2) {
        if place + 1 == builder.width(b) {
            let top = builder.bit(b, place);
            let once = builder.slice(once, width, 0);
            let none = builder.slice(none, width, 0);
            let word = builder.mux(top, once, none);
            builder.name(word, format!("row_{place}"));
            rows.push(Row { word, place });
            break;
        }
        let low = builder.bit(b, place);
        let high = builder.bit(b, place + 1);
        let with_high = builder.mux(low, thrice, twice);
        let without_high = builder.mux(low, once, none);
        let word = builder.mux(high, with_high, without_high);
        builder.name(word, format!("row_{place}"));
        rows.push(Row { word, place });
    }
    // A few rows more than a full tree has: three rows to two by a level of tables, which is faster than a chain.
    let leaves = (rows.len() + 1).next_power_of_two() / 2;
    let mut level = Vec::new();
    let mut excess = rows.len() - leaves;
    if 3 * excess > rows.len() {
        excess = 0; // The tree has the height of the next power of two, then.
    }
    while let Some(first) = rows.pop() {
        if excess > 0 {
            let second = rows.pop().expect("as many rows as excess and leaves");
            let third = rows.pop().expect("as many rows as excess and leaves");
            level.extend(
                three_to_two(builder, [third, second, first])
                    .into_iter()
                    .rev(),
            );
            excess -= 1;
        } else {
            level.push(first);
        }
    }
    level.reverse();
    while level.len() > 1 {
        level = level
            .chunks(2)
            .map(|pair| match *pair {
                [low, high] => sum(builder, low, high),
                _ => pair[0],
            })
            .collect();
    }
    level[0].word
}

/// The word as it stands from a place to below another, zeros around it.
fn placed(builder: &mut Builder, row: Row, place: u32, end: u32) -> Wire {
    let mut word = row.word;
    if row.place > place {
        let zeros = builder.constant(0, row.place - place);
        word = builder.concat(&[word, zeros]);
    }
    builder.zero_extend(word, end - place)
}

/// Two rows whose sum is that of three: in every place the sum bit and the carry.
fn three_to_two(builder: &mut Builder, rows: [Row; 3]) -> [Row; 2] {
    let place = rows[0].place;
    let ends = rows.map(|row| row.end(builder));
    let end = ends.into_iter().max().expect("three rows");
    let [x, y, z] = rows.map(|row| placed(builder, row, place, end));
    let differ = builder.xor(x, y);
    let sums = builder.xor(differ, z);
    builder.name(sums, format!("sums_from_{place}"));
    let both = builder.and(x, y);
    let either = builder.and(differ, z);
    let carries = builder.or(both, either);
    // No carry leaves the highest place.
    let carries = builder.slice(carries, end - place - 2, 0);
    builder.name(carries, format!("carries_from_{place}"));
    let carries = Row {
        word: carries,
        place: place + 1,
    };
    [Row { word: sums, place }, carries]
}

/// The sum of two rows: the places below the higher one pass.
fn sum(builder: &mut Builder, low: Row, high: Row) -> Row {
    let end = low.end(builder).max(high.end(builder));
    let passing = high.place - low.place;
    let top = builder.width(low.word) - 1;
    let upper = Row {
        word: builder.slice(low.word, top, passing),
        place: high.place,
    };
    let upper = placed(builder, upper, high.place, end);
    let high = placed(builder, high, high.place, end);
    let added = builder.add(upper, high);
    builder.name(added, format!("rows_{}_to_{}", low.place, end - 1));
    let word = if passing > 0 {
        let below = builder.slice(low.word, passing - 1, 0);
        builder.concat(&[added, below])
    } else {
        added
    };
    Row {
        word,
        place: low.place,
    }
}
