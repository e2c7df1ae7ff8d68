//! Numbers of a frame as colours, with a bar that tells which is which.

use image::{Rgb, RgbImage};

use super::canvas::{LETTER, fill, text_width, write};
use super::colour::{background, mix, scale};
use super::{Frame, PixelHit};

pub(super) const PAPER: Rgb<u8> = Rgb([24, 26, 31]);
pub(super) const INK: Rgb<u8> = Rgb([226, 229, 235]);
pub(super) const FAINT_INK: Rgb<u8> = Rgb([150, 156, 168]);
const MARGIN: u32 = 10;
const BAR_WIDTH: u32 = 16;
const TICK: u32 = 4;
/// The least columns and rows the frame takes in a chart: smaller frames are enlarged by a whole
/// factor.
const LEAST_FRAME: (u32, u32) = (320, 160);

/// The numbers at the two ends of a colour bar, `low < high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// The number of the darkest colour.
    pub low: f64,
    /// The number of the brightest colour.
    pub high: f64,
}

/// The steps of each pixel's traversal as colours, with a colour bar and a title that gives least,
/// mean and most.
///
/// `extent` fixes the bar, so that pictures compare; without it the bar spans the frame's own
/// steps. A frame smaller than 320 x 160 pixels is enlarged by a whole factor.
pub fn steps_picture(frame: &Frame, title: &str, extent: Option<Extent>) -> RgbImage {
    let chart = Chart {
        frame,
        number: |hit| f64::from(hit.steps),
        title: format!("{title}: steps"),
        decimals: 0,
        extent,
    };
    chart.draw()
}

/// The depth of each pixel's hit as colours; bar, title and size as for [`steps_picture`].
pub fn depth_picture(frame: &Frame, title: &str, extent: Option<Extent>) -> RgbImage {
    let chart = Chart {
        frame,
        number: |hit| hit.t,
        title: format!("{title}: depth"),
        decimals: 3,
        extent,
    };
    chart.draw()
}

struct Chart<'a> {
    frame: &'a Frame,
    number: fn(&PixelHit) -> f64,
    title: String,
    /// Decimals of the least and the most in the title, 0 for whole numbers; the mean has at least
    /// two.
    decimals: usize,
    extent: Option<Extent>,
}

/// Least, mean and most of a frame's numbers.
struct Summary {
    least: f64,
    mean: f64,
    most: f64,
}

impl Chart<'_> {
    fn draw(&self) -> RgbImage {
        let summary = self.summary();
        let own = summary.as_ref().map_or(
            Extent {
                low: 0.0,
                high: 1.0,
            },
            |summary| Extent {
                low: summary.least,
                high: summary.most,
            },
        );
        let extent = widened(self.extent.unwrap_or(own));
        let subtitle = summary.map_or_else(
            || "no pixel has a ray".to_owned(),
            |Summary { least, mean, most }| {
                let (few, more) = (self.decimals, self.decimals.max(2));
                format!("min {least:.few$}  mean {mean:.more$}  max {most:.few$}")
            },
        );
        let ticks = ticks(extent, self.decimals == 0);
        let labels_width = ticks
            .iter()
            .map(|(_, label)| text_width(label))
            .max()
            .unwrap_or(0);

        let (columns, rows) = (self.frame.width(), self.frame.height());
        let enlarged = LEAST_FRAME
            .0
            .div_ceil(columns)
            .max(LEAST_FRAME.1.div_ceil(rows));
        let (frame_width, frame_height) = (columns * enlarged, rows * enlarged);
        let frame_top = MARGIN + 2 * (LETTER + 4) + 4;
        let bar_left = MARGIN + frame_width + MARGIN;
        let right_of_bar = TICK + 4 + labels_width + MARGIN;
        let titles_width = text_width(&self.title).max(text_width(&subtitle)) + 2 * MARGIN;
        let mut picture = RgbImage::from_pixel(
            (bar_left + BAR_WIDTH + right_of_bar).max(titles_width),
            frame_top + frame_height + MARGIN,
            PAPER,
        );

        write(&mut picture, (MARGIN, MARGIN), &self.title, INK);
        let second_line = (MARGIN, MARGIN + LETTER + 4);
        write(&mut picture, second_line, &subtitle, FAINT_INK);
        for y in 0..rows {
            for x in 0..columns {
                let colour = match self.frame.hit(x, y) {
                    Some(hit) => scale(position((self.number)(hit), extent)),
                    None => mix(PAPER, background(y, rows), 0.5),
                };
                let corner = (MARGIN + x * enlarged, frame_top + y * enlarged);
                fill(&mut picture, corner, (enlarged, enlarged), colour);
            }
        }
        let last_row = frame_height - 1;
        for y in 0..frame_height {
            let colour = scale(1.0 - f64::from(y) / f64::from(last_row.max(1)));
            fill(
                &mut picture,
                (bar_left, frame_top + y),
                (BAR_WIDTH, 1),
                colour,
            );
        }
        for (number, label) in ticks {
            let from_top = (1.0 - position(number, extent)) * f64::from(last_row);
            let y = frame_top + from_top.round() as u32;
            fill(&mut picture, (bar_left + BAR_WIDTH, y), (TICK, 1), INK);
            let label_place = (bar_left + BAR_WIDTH + TICK + 4, y - LETTER / 2 + 1);
            write(&mut picture, label_place, &label, INK);
        }
        picture
    }

    /// None where no pixel has a ray.
    fn summary(&self) -> Option<Summary> {
        let numbers = || self.frame.hits().iter().flatten().map(self.number);
        let count = numbers().count();
        (count > 0).then(|| Summary {
            least: numbers().fold(f64::INFINITY, f64::min),
            mean: numbers().sum::<f64>() / count as f64,
            most: numbers().fold(f64::NEG_INFINITY, f64::max),
        })
    }
}

/// Where `number` lies in `extent`, 0 to 1.
fn position(number: f64, extent: Extent) -> f64 {
    ((number - extent.low) / (extent.high - extent.low)).clamp(0.0, 1.0)
}

/// An extent that a bar can show: finite, with room between its ends.
fn widened(extent: Extent) -> Extent {
    if extent.low < extent.high && (extent.high - extent.low).is_finite() {
        return extent;
    }
    let low = if extent.low.is_finite() {
        extent.low
    } else {
        0.0
    };
    Extent {
        low,
        // More than 1 where that is lost beside a large number.
        high: low + 1.0_f64.max(low.abs() * 1e-6),
    }
}

/// Round numbers within `extent`, three to nine of them, with their labels: multiples of 1, 2 or 5
/// times a power of ten. Where numbers are `whole` there are no others, so there may be but one.
pub(super) fn ticks(extent: Extent, whole: bool) -> Vec<(f64, String)> {
    let span = extent.high - extent.low;
    let finest = span.log10().floor() as i32 - 1;
    let mut exponent = if whole { finest.max(0) } else { finest };
    let mut factors = [1.0, 2.0, 5.0].into_iter().cycle();
    loop {
        let factor = factors.next().unwrap_or(1.0);
        let distance = factor * 10.0_f64.powi(exponent);
        // A number on the border counts as inside, whichever way it was rounded.
        let first = (extent.low / distance - 1e-9).ceil();
        let last = (extent.high / distance + 1e-9).floor();
        if last - first < 9.0 {
            let decimals = usize::try_from(-exponent).unwrap_or(0);
            return (0..=(last - first).max(0.0) as u32)
                .map(|n| (first + f64::from(n)) * distance)
                .map(|number| (number, format!("{number:.decimals$}")))
                .collect();
        }
        if factor == 5.0 {
            exponent += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64, whole: bool) -> Vec<String> {
        ticks(Extent { low, high }, whole)
            .into_iter()
            .map(|(_, label)| label)
            .collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(
            labels(9.0, 43.0, true),
            ["10", "15", "20", "25", "30", "35", "40"]
        );
        assert_eq!(
            labels(0.0, 1.0, false),
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(
            labels(7.0, 8.0, false),
            ["7.0", "7.2", "7.4", "7.6", "7.8", "8.0"]
        );
        assert_eq!(
            labels(0.0, 1000.0, true),
            ["0", "200", "400", "600", "800", "1000"]
        );
    }

    #[test]
    fn whole_numbers_have_whole_ticks() {
        assert_eq!(labels(7.0, 8.0, true), ["7", "8"]);
        assert_eq!(labels(9.0, 12.0, true), ["9", "10", "11", "12"]);
    }

    #[test]
    fn there_are_never_too_few_or_too_many_ticks() {
        for n in 1..2000 {
            let high = f64::from(n) * 0.37;
            for low in [0.0, -3.3, high * 0.9] {
                let count = ticks(Extent { low, high }, false).len();
                assert!((3..=9).contains(&count), "{low} to {high}: {count}");
            }
        }
    }

    #[test]
    fn any_extent_can_be_drawn() {
        for (low, high) in [
            (3.0, 3.0),
            (5.0, 2.0),
            (f64::NAN, 1.0),
            (f64::NEG_INFINITY, f64::INFINITY),
            (1e300, 1e300),
            (-f64::MAX, f64::MAX),
        ] {
            let extent = widened(Extent { low, high });
            assert!(extent.low < extent.high && !ticks(extent, false).is_empty());
        }
    }

    fn hit(steps: u32) -> Option<PixelHit> {
        Some(PixelHit {
            i: 0,
            j: 0,
            t: f64::from(steps) / 10.0,
            u: 0.0,
            v: 0.0,
            steps,
            crossings: 0,
        })
    }

    #[test]
    fn pixels_take_the_colour_of_their_number() {
        let frame = Frame::new(2, 2, vec![hit(2), hit(4), hit(6), None]).unwrap();
        for picture in [
            steps_picture(&frame, "t", None),
            depth_picture(&frame, "t", None),
        ] {
            // A frame of 2 x 2 is enlarged 160 times.
            let top = picture.height() - MARGIN - 320;
            let at = |x: u32, y: u32| *picture.get_pixel(MARGIN + 160 * x + 80, top + 160 * y + 80);
            assert_eq!(at(0, 0), scale(0.0));
            assert_eq!(at(1, 0), scale(0.5));
            assert_eq!(at(0, 1), scale(1.0));
            assert!(
                [at(0, 0), at(1, 0), at(0, 1)]
                    .iter()
                    .all(|&colour| colour != at(1, 1))
            );
        }
    }

    #[test]
    fn a_given_extent_fixes_the_colours() {
        let frame = Frame::new(1, 1, vec![hit(5)]).unwrap();
        let extent = Extent {
            low: 0.0,
            high: 10.0,
        };
        let picture = steps_picture(&frame, "t", Some(extent));
        let middle = *picture.get_pixel(MARGIN + 100, picture.height() - MARGIN - 100);
        assert_eq!(middle, scale(0.5));
    }

    #[test]
    fn the_summary_is_of_pixels_with_rays_alone() {
        let frame = Frame::new(2, 2, vec![hit(2), None, hit(4), hit(9)]).unwrap();
        let chart = Chart {
            frame: &frame,
            number: |hit| f64::from(hit.steps),
            title: String::new(),
            decimals: 0,
            extent: None,
        };
        let Summary { least, mean, most } = chart.summary().unwrap();
        assert_eq!((least, mean, most), (2.0, 5.0, 9.0));
    }

    #[test]
    fn a_frame_without_rays_is_drawn_too() {
        let frame = Frame::new(3, 1, vec![None; 3]).unwrap();
        assert!(steps_picture(&frame, "empty", None).width() > 320);
    }
}
