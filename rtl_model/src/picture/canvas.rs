//! Rectangles and text on a picture. What lies outside the picture is not drawn.

use font8x8::legacy::BASIC_LEGACY;
use image::{Rgb, RgbImage};

/// Pixels of a letter on each side.
pub(super) const LETTER: u32 = 8;

/// Fills the rectangle of `width` x `height` pixels whose upper left is `(left, top)`.
pub(super) fn fill(
    picture: &mut RgbImage,
    (left, top): (u32, u32),
    (width, height): (u32, u32),
    colour: Rgb<u8>,
) {
    for y in top..top.saturating_add(height).min(picture.height()) {
        for x in left..left.saturating_add(width).min(picture.width()) {
            picture.put_pixel(x, y, colour);
        }
    }
}

/// Writes `text` with its upper left at `(left, top)`; letters outside ASCII become `?`.
pub(super) fn write(picture: &mut RgbImage, (left, top): (u32, u32), text: &str, colour: Rgb<u8>) {
    for (index, letter) in text.chars().enumerate() {
        let code = if letter.is_ascii() { letter } else { '?' };
        let rows = BASIC_LEGACY[code as usize];
        for (y, row) in rows.into_iter().enumerate() {
            for x in 0..LETTER {
                // The lowest bit is the leftmost pixel.
                if row >> x & 1 == 1 {
                    let pixel = (left + index as u32 * LETTER + x, top + y as u32);
                    fill(picture, pixel, (1, 1), colour);
                }
            }
        }
    }
}

/// Pixels that `text` takes in a row.
pub(super) fn text_width(text: &str) -> u32 {
    text.chars().count() as u32 * LETTER
}

#[cfg(test)]
mod tests {
    use super::*;

    const INK: Rgb<u8> = Rgb([255, 255, 255]);

    fn ink(picture: &RgbImage) -> usize {
        picture.pixels().filter(|&&pixel| pixel == INK).count()
    }

    #[test]
    fn letters_are_upright_and_unmirrored() {
        let mut picture = RgbImage::new(8, 8);
        write(&mut picture, (0, 0), "L", INK);
        let in_area = |x: std::ops::Range<u32>, y: std::ops::Range<u32>| {
            y.flat_map(|y| x.clone().map(move |x| (x, y)))
                .filter(|&(x, y)| *picture.get_pixel(x, y) == INK)
                .count()
        };
        // The stem of an L is at the left, its foot at the bottom right.
        assert!(in_area(0..4, 0..4) > in_area(4..8, 0..4));
        assert!(in_area(4..8, 4..8) > in_area(4..8, 0..4));
    }

    #[test]
    fn what_lies_outside_is_not_drawn() {
        let mut picture = RgbImage::new(4, 4);
        fill(&mut picture, (2, 2), (u32::MAX, u32::MAX), INK);
        assert_eq!(ink(&picture), 4);
        write(&mut picture, (100, 0), "far away", INK);
        assert_eq!(ink(&picture), 4);
    }

    #[test]
    fn a_letter_without_a_glyph_is_a_question_mark() {
        let (mut odd, mut question) = (RgbImage::new(8, 8), RgbImage::new(8, 8));
        write(&mut odd, (0, 0), "\u{e4}", INK);
        write(&mut question, (0, 0), "?", INK);
        assert_eq!(odd, question);
        assert!(ink(&odd) > 0);
    }
}
