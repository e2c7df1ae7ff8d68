//! Signals over the cycles of a clock, as a logic analyser shows them.

use image::{Rgb, RgbImage};

use super::canvas::{LETTER, fill, text_width, write};
use super::chart;

const PAPER: Rgb<u8> = chart::PAPER;
const INK: Rgb<u8> = chart::INK;
const FAINT_INK: Rgb<u8> = chart::FAINT_INK;
const GRID: Rgb<u8> = Rgb([40, 44, 52]);
/// Of signals of one bit.
const LEVEL: Rgb<u8> = Rgb([86, 180, 233]);
/// Behind a bit that is 1.
const HIGH: Rgb<u8> = Rgb([28, 54, 74]);
/// Around words.
const WORD: Rgb<u8> = Rgb([230, 159, 0]);
/// What is unknown.
const UNKNOWN: Rgb<u8> = Rgb([213, 94, 0]);
const MARGIN: u32 = 10;
/// Rows of a signal, with the gap below it.
const ROW: u32 = 22;
/// Rows that its levels are apart.
const SWING: u32 = 14;
/// Between the numbers of cycles that are written.
const NUMBERED_EVERY: u64 = 5;

/// What a signal shows, cycle by cycle; none where it is unknown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wave {
    /// One bit.
    Bit(Vec<Option<bool>>),
    /// Anything wider, as it is written. A value with no room in its cycles reaches into the next ones,
    /// in another colour, or where these have none to spare is cut.
    Word(Vec<Option<String>>),
}

/// Waves over one clock.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Waves {
    /// Above them.
    pub title: String,
    /// The number of the first cycle.
    pub first_cycle: u64,
    /// Columns of a cycle, at least 4.
    pub cycle_columns: u32,
    /// The signals, uppermost first.
    pub signals: Vec<(String, Wave)>,
}

impl Waves {
    /// The picture. Of a signal with fewer cycles than others the rest is left empty.
    pub fn draw(&self) -> RgbImage {
        let columns = self.cycle_columns.max(4);
        let names = self.signals.iter().map(|(name, _)| text_width(name)).max();
        let left = MARGIN + names.unwrap_or(0) + MARGIN;
        let cycles = self.signals.iter().map(|(_, wave)| wave.cycles()).max();
        let cycles = cycles.unwrap_or(0) as u32;
        let top = MARGIN + 2 * (LETTER + 8);
        let height = top + self.signals.len() as u32 * ROW + MARGIN;
        let width = (left + cycles * columns + MARGIN).max(text_width(&self.title) + 2 * MARGIN);
        let mut picture = RgbImage::from_pixel(width, height, PAPER);
        write(&mut picture, (MARGIN, MARGIN), &self.title, INK);
        let numbers = MARGIN + LETTER + 8;
        write(&mut picture, (MARGIN, numbers), "cycle", FAINT_INK);
        for (place, number) in (0..=cycles).zip(self.first_cycle..) {
            let x = left + place * columns;
            fill(
                &mut picture,
                (x, top - 4),
                (1, height - top - MARGIN + 4),
                GRID,
            );
            let has_room = x + 2 + text_width(&number.to_string()) <= left + cycles * columns;
            if has_room && number.is_multiple_of(NUMBERED_EVERY) {
                fill(&mut picture, (x, top - 8), (1, 8), FAINT_INK);
                write(
                    &mut picture,
                    (x + 2, numbers),
                    &number.to_string(),
                    FAINT_INK,
                );
            }
        }
        for (row, (name, wave)) in (0..).zip(&self.signals) {
            let y = top + row * ROW;
            write(&mut picture, (MARGIN, y + 4), name, INK);
            match wave {
                Wave::Bit(levels) => draw_bit(&mut picture, (left, y), columns, levels),
                Wave::Word(texts) => draw_word(&mut picture, (left, y), columns, texts),
            }
        }
        picture
    }
}

impl Wave {
    fn cycles(&self) -> usize {
        match self {
            Wave::Bit(levels) => levels.len(),
            Wave::Word(texts) => texts.len(),
        }
    }
}

fn draw_bit(picture: &mut RgbImage, (left, y): (u32, u32), columns: u32, levels: &[Option<bool>]) {
    let mut before = None;
    for (place, &level) in (0..).zip(levels) {
        let x = left + place * columns;
        match level {
            Some(true) => {
                fill(picture, (x, y), (columns, SWING), HIGH);
                fill(picture, (x, y), (columns + 1, 2), LEVEL);
            }
            Some(false) => fill(picture, (x, y + SWING - 1), (columns + 1, 1), LEVEL),
            None => fill(picture, (x, y + SWING / 2), (columns, 3), UNKNOWN),
        }
        if before.is_some_and(|before| before != level) {
            fill(picture, (x, y), (1, SWING), LEVEL);
        }
        before = Some(level);
    }
}

fn draw_word(
    picture: &mut RgbImage,
    (left, y): (u32, u32),
    columns: u32,
    texts: &[Option<String>],
) {
    let runs: Vec<&[Option<String>]> = texts.chunk_by(|a, b| a == b).collect();
    let shown = |run: &[Option<String>]| run[0].clone().unwrap_or_else(|| "x".to_owned());
    let mut x = left;
    // Up to here a value that had no room is written.
    let mut taken = 0;
    for (place, run) in runs.iter().enumerate() {
        let width = run.len() as u32 * columns;
        let colour = if run[0].is_some() { WORD } else { UNKNOWN };
        fill(picture, (x, y), (width, 1), colour);
        fill(picture, (x, y + SWING), (width + 1, 1), colour);
        fill(picture, (x, y), (1, SWING), colour);
        fill(picture, (x + width, y), (1, SWING), colour);
        let text = shown(run);
        let start = taken.max(x + 3);
        let end = x + width;
        let behind = start + text_width(&text) + 6;
        let next = runs.get(place + 1).map(|next| {
            let end = end + next.len() as u32 * columns;
            behind + text_width(&shown(next)) < end
        });
        if start + text_width(&text) <= end {
            write(picture, (start, y + 4), &text, INK);
        } else if next == Some(true) {
            write(picture, (start, y + 4), &text, WORD);
            taken = behind;
        } else {
            // A value cut short ends in a mark, so that it is not taken for another.
            let letters = (end.saturating_sub(start) / LETTER) as usize;
            let cut: String = match letters {
                0 | 1 => String::new(),
                _ => text.chars().take(letters - 1).chain(['~']).collect(),
            };
            write(picture, (start, y + 4), &cut, INK);
        }
        x = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(picture: &RgbImage, colour: Rgb<u8>) -> usize {
        picture.pixels().filter(|&&pixel| pixel == colour).count()
    }

    fn waves(wave: Wave) -> RgbImage {
        let waves = Waves {
            title: String::new(),
            first_cycle: 0,
            cycle_columns: 20,
            signals: vec![("s".to_owned(), wave)],
        };
        waves.draw()
    }

    #[test]
    fn a_high_bit_is_filled_and_an_unknown_one_marked() {
        let high = |levels: Vec<Option<bool>>| {
            let picture = waves(Wave::Bit(levels));
            (count(&picture, HIGH), count(&picture, UNKNOWN))
        };
        let (one, unknown) = high(vec![Some(false), Some(true), Some(false)]);
        assert!(one > 0 && unknown == 0);
        let (two, _) = high(vec![Some(true), Some(true), Some(false)]);
        assert!(two > one);
        assert_eq!(high(vec![Some(false); 3]).0, 0);
        assert!(high(vec![None, Some(false)]).1 > 0);
    }

    #[test]
    fn a_word_has_an_edge_where_it_changes_and_is_cut_to_fit() {
        let text = |text: &str| Some(text.to_owned());
        let edges = |texts: Vec<Option<String>>| count(&waves(Wave::Word(texts)), WORD);
        let same = edges(vec![text("1"), text("1"), text("1")]);
        assert!(edges(vec![text("1"), text("2"), text("1")]) > same);
        // Two letters fit into a cycle of 20 columns.
        let cut = waves(Wave::Word(vec![text("1234"), text("5")]));
        let whole = waves(Wave::Word(vec![text("1~"), text("5")]));
        assert_eq!(cut, whole);
    }

    #[test]
    fn a_word_without_room_reaches_into_a_long_run_behind_it() {
        let word = |text: &str| Some(text.to_owned());
        let short = |text: &str| {
            let texts = [vec![word(text)], vec![word("0"); 9]].concat();
            count(&waves(Wave::Word(texts)), WORD)
        };
        // Its letters are in the colour of the edges.
        assert!(short("1234") > short("12"));
        assert_eq!(short("12"), short("34"));
    }

    #[test]
    fn anything_can_be_drawn() {
        for wave in [
            Wave::Bit(vec![]),
            Wave::Word(vec![]),
            Wave::Word(vec![None, None]),
        ] {
            assert!(waves(wave).width() > 0);
        }
    }
}
