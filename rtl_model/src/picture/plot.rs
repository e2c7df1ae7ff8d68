//! Figures as points and lines over two axes.

use image::{Rgb, RgbImage};

use super::canvas::{LETTER, fill, text_width, write};
use super::chart::ticks;
use super::{Extent, chart};

const PAPER: Rgb<u8> = chart::PAPER;
const INK: Rgb<u8> = chart::INK;
const FAINT_INK: Rgb<u8> = chart::FAINT_INK;
const GRID: Rgb<u8> = Rgb([48, 52, 60]);
const MARGIN: u32 = 10;
/// Columns and rows between the axes and their opposite sides.
const AREA: (u32, u32) = (640, 400);

/// Eight colours that the colour-blind tell apart, for a dark ground: those of Okabe and Ito 2008,
/// the black one replaced by white.
const COLOURS: [[u8; 3]; 8] = [
    [230, 159, 0],
    [86, 180, 233],
    [0, 158, 115],
    [240, 228, 66],
    [213, 94, 0],
    [204, 121, 167],
    [0, 114, 178],
    [235, 235, 235],
];

/// An axis of a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct PlotAxis {
    /// What is along it, and in which unit.
    pub label: String,
    /// Equal distances are equal factors: numbers not above 0 stand at the lower end.
    pub logarithmic: bool,
}

/// Points that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What the legend calls them.
    pub name: String,
    /// Places along both axes; what is not finite is not drawn.
    pub points: Vec<(f64, f64)>,
    /// A line from each point to the next, and the points on it; else points alone.
    pub joined: bool,
}

/// Series over two axes, with a legend. Axes span all their numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// Above it.
    pub title: String,
    /// From left to right.
    pub x: PlotAxis,
    /// From below.
    pub y: PlotAxis,
    /// A line where both numbers are equal, and both axes with the same extent.
    pub diagonal: bool,
    /// What is drawn, in the order of the legend.
    pub series: Vec<Series>,
}

/// An axis with its extent, in logarithms to base 10 where it is logarithmic.
struct Scale {
    logarithmic: bool,
    extent: Extent,
}

impl Scale {
    fn of(axis: &PlotAxis, numbers: impl Iterator<Item = f64> + Clone) -> Scale {
        let logarithmic = axis.logarithmic;
        let shown = numbers.filter(|&number| number.is_finite() && (!logarithmic || number > 0.0));
        let low = shown.clone().fold(f64::INFINITY, f64::min);
        let high = shown.fold(f64::NEG_INFINITY, f64::max);
        let extent = if logarithmic {
            // Whole decades; one where there is nothing to show.
            let (low, high) = if low <= high {
                (low, high)
            } else {
                (1.0, 10.0)
            };
            let (low, high) = (low.log10().floor(), high.log10().ceil());
            Extent {
                low,
                high: high.max(low + 1.0),
            }
        } else {
            let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
            // Numbers start at 0 unless they are far from it, and points keep off the edge.
            let low = if low > 0.0 && low < high * 0.7 {
                0.0
            } else {
                low
            };
            let room = (high - low).max(high.abs() * 1e-3) * 0.04;
            Extent {
                low: if low == 0.0 { 0.0 } else { low - room },
                high: high + room.max(1e-9),
            }
        };
        Scale {
            logarithmic,
            extent,
        }
    }

    /// 0 at the lower end to 1 at the upper.
    fn position(&self, number: f64) -> f64 {
        let number = match self.logarithmic {
            true if number > 0.0 => number.log10(),
            true => self.extent.low,
            false => number,
        };
        ((number - self.extent.low) / (self.extent.high - self.extent.low)).clamp(0.0, 1.0)
    }

    fn ticks(&self) -> Vec<(f64, String)> {
        if !self.logarithmic {
            return ticks(self.extent, false);
        }
        let decades = (self.extent.low as i32)..=(self.extent.high as i32);
        // A number for each decade, or for every second, third ... where there are many.
        let every = (decades.clone().count() / 10 + 1) as i32;
        decades
            .filter(|decade| decade % every == 0)
            .map(|decade| {
                let label = match decade {
                    -3..=4 => {
                        let decimals = usize::try_from(-decade).unwrap_or(0);
                        format!("{:.decimals$}", 10_f64.powi(decade))
                    }
                    _ => format!("1e{decade}"),
                };
                (10_f64.powi(decade), label)
            })
            .collect()
    }
}

impl Plot {
    /// The plot as a picture.
    pub fn draw(&self) -> RgbImage {
        let points = || self.series.iter().flat_map(|series| series.points.iter());
        let (across, upwards) = (points().map(|point| point.0), points().map(|point| point.1));
        let (x, y) = if self.diagonal {
            let both = || across.clone().chain(upwards.clone());
            (Scale::of(&self.x, both()), Scale::of(&self.y, both()))
        } else {
            (
                Scale::of(&self.x, across.clone()),
                Scale::of(&self.y, upwards.clone()),
            )
        };
        let (x_ticks, y_ticks) = (x.ticks(), y.ticks());
        let widest = |labels: &mut dyn Iterator<Item = &str>| labels.map(text_width).max();
        let labels = widest(&mut y_ticks.iter().map(|(_, label)| label.as_str())).unwrap_or(0);
        let names = widest(&mut self.series.iter().map(|series| series.name.as_str())).unwrap_or(0);
        let left = MARGIN + labels + 6;
        let top = MARGIN + 2 * (LETTER + 6);
        let legend_left = left + AREA.0 + MARGIN;
        let width =
            (legend_left + 2 * LETTER + names + MARGIN).max(text_width(&self.title) + 2 * MARGIN);
        let legend_height = self.series.len() as u32 * (LETTER + 6);
        let height = top + AREA.1.max(legend_height) + 2 * (LETTER + 8) + MARGIN;
        let mut picture = RgbImage::from_pixel(width, height, PAPER);

        write(&mut picture, (MARGIN, MARGIN), &self.title, INK);
        write(
            &mut picture,
            (MARGIN, MARGIN + LETTER + 6),
            &self.y.label,
            FAINT_INK,
        );
        let column = |number: f64| left + (x.position(number) * f64::from(AREA.0 - 1)) as u32;
        let row = |number: f64| top + ((1.0 - y.position(number)) * f64::from(AREA.1 - 1)) as u32;
        for (number, label) in &x_ticks {
            let at = column(*number);
            fill(&mut picture, (at, top), (1, AREA.1), GRID);
            let centred = at.saturating_sub(text_width(label) / 2);
            write(&mut picture, (centred, top + AREA.1 + 6), label, INK);
        }
        for (number, label) in &y_ticks {
            let at = row(*number);
            fill(&mut picture, (left, at), (AREA.0, 1), GRID);
            let right_aligned = left - 6 - text_width(label);
            let middle = (at + 1).saturating_sub(LETTER / 2);
            write(&mut picture, (right_aligned, middle), label, INK);
        }
        let below = top + AREA.1 + LETTER + 14;
        write(&mut picture, (left, below), &self.x.label, FAINT_INK);
        fill(&mut picture, (left, top), (1, AREA.1), FAINT_INK);
        fill(
            &mut picture,
            (left, top + AREA.1 - 1),
            (AREA.0, 1),
            FAINT_INK,
        );
        if self.diagonal {
            let corner = |n: f64| (column(n), row(n));
            let ends = match x.logarithmic {
                true => (10_f64.powf(x.extent.low), 10_f64.powf(x.extent.high)),
                false => (x.extent.low, x.extent.high),
            };
            line(&mut picture, corner(ends.0), corner(ends.1), FAINT_INK);
        }

        for (number, series) in self.series.iter().enumerate() {
            let colour = Rgb(COLOURS[number % COLOURS.len()]);
            // Beyond eight series colours come again, with hollow points.
            let hollow = number / COLOURS.len() % 2 == 1;
            let drawn = series.points.iter();
            let drawn: Vec<(u32, u32)> = drawn
                .filter(|(x, y)| x.is_finite() && y.is_finite())
                .map(|&(x, y)| (column(x), row(y)))
                .collect();
            if series.joined {
                for pair in drawn.windows(2) {
                    line(&mut picture, pair[0], pair[1], colour);
                }
            }
            for &place in &drawn {
                point(&mut picture, place, colour, hollow);
            }
            let text_top = top + number as u32 * (LETTER + 6);
            point(
                &mut picture,
                (legend_left + 3, text_top + LETTER / 2),
                colour,
                hollow,
            );
            write(
                &mut picture,
                (legend_left + 2 * LETTER, text_top),
                &series.name,
                INK,
            );
        }
        picture
    }
}

/// A square of five pixels a side around a place.
fn point(picture: &mut RgbImage, (x, y): (u32, u32), colour: Rgb<u8>, hollow: bool) {
    let corner = (x.saturating_sub(2), y.saturating_sub(2));
    fill(picture, corner, (5, 5), colour);
    if hollow {
        fill(picture, (corner.0 + 1, corner.1 + 1), (3, 3), PAPER);
    }
}

/// A line of one pixel's width from a place to another.
fn line(picture: &mut RgbImage, from: (u32, u32), to: (u32, u32), colour: Rgb<u8>) {
    let steps = from.0.abs_diff(to.0).max(from.1.abs_diff(to.1)).max(1);
    for step in 0..=steps {
        let share = f64::from(step) / f64::from(steps);
        let between =
            |a: u32, b: u32| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u32;
        let place = (between(from.0, to.0), between(from.1, to.1));
        fill(picture, place, (1, 1), colour);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(logarithmic: bool, points: Vec<(f64, f64)>) -> Plot {
        let axis = |label: &str| PlotAxis {
            label: label.to_owned(),
            logarithmic,
        };
        Plot {
            title: "t".to_owned(),
            x: axis("x"),
            y: axis("y"),
            diagonal: false,
            series: vec![Series {
                name: "s".to_owned(),
                points,
                joined: false,
            }],
        }
    }

    /// The places of the first series' points: columns and rows of their upper left pixels, but for
    /// the one in the legend.
    fn corners(picture: &RgbImage) -> Vec<(u32, u32)> {
        let colour = Rgb(COLOURS[0]);
        let is_ink = |x: u32, y: u32| *picture.get_pixel(x, y) == colour;
        let mut found = Vec::new();
        for y in 1..picture.height() {
            for x in 1..picture.width() {
                if is_ink(x, y) && !is_ink(x - 1, y) && !is_ink(x, y - 1) {
                    found.push((x, y));
                }
            }
        }
        let legend = found.iter().copied().max_by_key(|place| place.0);
        found.retain(|&place| Some(place) != legend);
        found
    }

    #[test]
    fn points_stand_in_the_order_of_their_numbers() {
        for logarithmic in [false, true] {
            let picture = plot(logarithmic, vec![(1.0, 2.0), (20.0, 300.0)]).draw();
            let mut places = corners(&picture);
            places.sort();
            assert_eq!(places.len(), 2);
            // More on x is further right, more on y further up.
            assert!(places[0].0 < places[1].0 && places[0].1 > places[1].1);
        }
    }

    #[test]
    fn equal_factors_are_equal_distances_on_a_logarithmic_axis() {
        let picture = plot(true, vec![(1.0, 1.0), (10.0, 10.0), (100.0, 100.0)]).draw();
        let mut places = corners(&picture);
        places.sort();
        let distances = [places[1].0 - places[0].0, places[2].0 - places[1].0];
        assert!(distances[0].abs_diff(distances[1]) <= 1, "{places:?}");
    }

    #[test]
    fn any_numbers_can_be_drawn() {
        for logarithmic in [false, true] {
            for points in [
                vec![],
                vec![(f64::NAN, 1.0), (f64::INFINITY, 2.0)],
                vec![(0.0, 0.0)],
                vec![(3.0, 3.0), (3.0, 3.0)],
                vec![(-1.0, 1e-300), (5.0, 1e300)],
            ] {
                for diagonal in [false, true] {
                    let mut drawn = plot(logarithmic, points.clone());
                    drawn.diagonal = diagonal;
                    drawn.series[0].joined = true;
                    assert!(drawn.draw().width() > AREA.0);
                }
            }
        }
    }

    #[test]
    fn a_line_joins_its_points() {
        let mut joined = plot(false, vec![(0.0, 0.0), (10.0, 10.0)]);
        let inked = |plot: &Plot| {
            let picture = plot.draw();
            let colour = Rgb(COLOURS[0]);
            picture.pixels().filter(|&&pixel| pixel == colour).count()
        };
        let without = inked(&joined);
        joined.series[0].joined = true;
        assert!(inked(&joined) > without + 300);
    }
}
