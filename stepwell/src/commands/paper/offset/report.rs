//! What the offsets came to, for people and for programs.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::time::Duration;

use serde::Serialize;

use rtl_model::judge::Verdict;
use rtl_model::picture::{Plot, PlotAxis, Series, save_png};
use rtl_model::scene::{Crossing, FrameSize, Method, WalkFormat};

use crate::commands::Outcome;

/// All frames in a format, at a size, by a crossing.
#[derive(Clone, Debug, Serialize)]
pub struct Case {
    #[serde(skip)]
    walked_in: WalkFormat,
    #[serde(skip)]
    crossed_by: Crossing,
    format: String,
    map_size: u32,
    crossing: String,
    rays: u64,
    /// Rays beyond the reach of the format, which are not walked.
    refused: u64,
    /// Hits in another texel than the exact one.
    wrong: u64,
    /// Hits later than the exact one.
    late: u64,
    /// Walks that reach the step bound: they would never end.
    hangs: u64,
    wrong_percent: f64,
    hangs_percent: f64,
    /// The index keeps what it promises; an offset promises nothing.
    agreed: bool,
}

impl Case {
    /// A case whose frames were judged together.
    pub fn new(
        format: WalkFormat,
        map_size: u32,
        crossing: Crossing,
        refused: u64,
        verdict: &Verdict,
    ) -> Case {
        let percent = |count: u64| 100.0 * count as f64 / verdict.rays.max(1) as f64;
        // A float of the hardware may be early in a neighbouring texel; nothing safe is ever late.
        let may_be_early = matches!(format, WalkFormat::Float(_));
        let keeps = verdict.late + verdict.guards == 0 && (may_be_early || verdict.wrong == 0);
        Case {
            walked_in: format,
            crossed_by: crossing,
            format: format.to_string(),
            map_size,
            crossing: crossing.to_string(),
            rays: verdict.rays,
            refused,
            wrong: verdict.wrong,
            late: verdict.late,
            hangs: verdict.guards,
            wrong_percent: percent(verdict.wrong),
            hangs_percent: percent(verdict.guards),
            agreed: crossing != Crossing::Index || keeps,
        }
    }
}

/// The table. Every JSON summary of this program has the keys from `mismatches` to `simulator`; no
/// hardware is run here, so that those of it are null.
#[derive(Debug, Serialize)]
pub struct OffsetReport {
    schema: &'static str,
    method: String,
    larger: &'static str,
    width: u32,
    height: u32,
    rays: u64,
    /// Broken promises of the index: late hits, hangs, and wrong texels where none are allowed.
    mismatches: u64,
    cycles: Option<u64>,
    signals_compared: Option<u64>,
    cycles_compared: Option<u64>,
    simulator: Option<String>,
    cases: Vec<Case>,
    agreed: bool,
    seconds: f64,
}

impl OffsetReport {
    /// The report on all cases: of each format and size the index first, then the offsets.
    pub fn new(
        method: Method,
        larger: &'static str,
        screen: FrameSize,
        cases: Vec<Case>,
        time: Duration,
    ) -> OffsetReport {
        OffsetReport {
            schema: "stepwell-paper-offset-1",
            method: method.to_string(),
            larger,
            width: screen.width,
            height: screen.height,
            rays: cases.iter().map(|case| case.rays).sum(),
            mismatches: cases.iter().filter(|case| !case.agreed).count() as u64,
            cycles: None,
            signals_compared: None,
            cycles_compared: None,
            simulator: None,
            // A table of nothing agrees with nothing.
            agreed: cases.iter().all(|case| case.agreed) && cases.iter().any(|case| case.rays > 0),
            cases,
            seconds: time.as_secs_f64(),
        }
    }

    /// Agreed, if the index keeps what it promises.
    pub fn outcome(&self) -> Outcome {
        match self.agreed {
            true => Outcome::Agreed,
            false => Outcome::Disagreed,
        }
    }

    /// The cases of one format and size, together.
    fn rows(&self) -> impl Iterator<Item = &[Case]> {
        self.cases
            .chunk_by(|a, b| (a.walked_in, a.map_size) == (b.walked_in, b.map_size))
    }

    /// The table for a terminal.
    pub fn text(&self) -> String {
        let mut text = format!(
            "What a border crossed by an offset costs: wrong texels / hangs, in percent of the rays\n\
             Seven maps, three cameras, {} x {} pixels, method {}, larger maps {}. The offset is in \
             texels along the ray; every hit is judged by the exact reference.\n\n",
            self.width, self.height, self.method, self.larger
        );
        let _ = write!(text, "{:8} {:>5}", "format", "map");
        for case in self.rows().next().unwrap_or_default() {
            let name = case.crossing.trim_start_matches("offset:");
            let _ = write!(text, "  {name:>15}");
        }
        let _ = writeln!(text, "  {:>8} {:>7}", "rays", "refused");
        for row in self.rows() {
            let first = &row[0];
            let _ = write!(text, "{:8} {:>5}", first.format, first.map_size);
            for case in row {
                let mark = if case.agreed { ' ' } else { '!' };
                let _ = write!(
                    text,
                    "{mark} {:>7} /{:>6}",
                    percent(case.wrong_percent),
                    percent(case.hangs_percent)
                );
            }
            let _ = writeln!(text, "  {:>8} {:>7}", first.rays, first.refused);
        }
        let _ = writeln!(
            text,
            "\n{}: by the index no walk hangs and no hit is late, and in f64 and exact numbers no \
             texel is wrong; {} rays in {:.1} s",
            if self.agreed { "agreed" } else { "missed (!)" },
            self.rays,
            self.seconds
        );
        text
    }

    /// Writes the table as CSV, as JSON and as a plot.
    pub fn save(&self, folder: &Path) -> anyhow::Result<()> {
        fs::write(folder.join("offset.csv"), self.csv())?;
        fs::write(folder.join("offset.json"), crate::summary::json(self)?)?;
        save_png(&self.plot().draw(), &folder.join("offset.png"))?;
        Ok(())
    }

    fn csv(&self) -> String {
        let mut text = "format,map_size,crossing,rays,refused,wrong,late,hangs,wrong_percent,\
                        hangs_percent\n"
            .to_owned();
        for case in &self.cases {
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{},{},{:.5},{:.5}",
                case.format,
                case.map_size,
                case.crossing,
                case.rays,
                case.refused,
                case.wrong,
                case.late,
                case.hangs,
                case.wrong_percent,
                case.hangs_percent
            );
        }
        text
    }

    /// Rays that do not get their texel over the offset, a series a format and size; that of the
    /// index, which has no offset, as a level line.
    fn plot(&self) -> Plot {
        let lost = |case: &Case| case.wrong_percent + case.hangs_percent;
        let offset = |case: &Case| match case.crossed_by {
            Crossing::Index => None,
            Crossing::Offset(offset) => Some(offset.texels()),
        };
        let mut series = Vec::new();
        for row in self.rows() {
            series.push(Series {
                name: format!("{} at {}", row[0].format, row[0].map_size),
                points: row
                    .iter()
                    .filter_map(|case| Some((offset(case)?, lost(case))))
                    .filter(|(_, lost)| *lost > 0.0)
                    .collect(),
                joined: true,
            });
        }
        let worst = self
            .cases
            .iter()
            .filter(|case| case.crossed_by == Crossing::Index)
            .max_by(|a, b| lost(a).total_cmp(&lost(b)))
            .filter(|case| lost(case) > 0.0);
        if let Some(worst) = worst {
            let offsets: Vec<f64> = self.cases.iter().filter_map(offset).collect();
            series.push(Series {
                name: format!("index, {} at {}", worst.format, worst.map_size),
                points: offsets.iter().map(|&x| (x, lost(worst))).collect(),
                joined: true,
            });
        }
        Plot {
            title: format!(
                "Borders crossed by an offset: {}, seven maps {}, three cameras",
                self.method, self.larger
            ),
            x: PlotAxis {
                label: "offset in texels along the ray".to_owned(),
                logarithmic: true,
            },
            y: PlotAxis {
                label: "rays in a wrong texel or hung, in percent".to_owned(),
                logarithmic: true,
            },
            diagonal: false,
            series,
        }
    }
}

/// A share in percent: 0 alone is nothing.
fn percent(share: f64) -> String {
    match share {
        0.0 => "0".to_owned(),
        share if share < 0.0005 => "<0.001".to_owned(),
        share if share < 1.0 => format!("{share:.3}"),
        share => format!("{share:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(format: &str, crossing: &str, wrong: u64, late: u64, guards: u64) -> Case {
        let verdict = Verdict {
            rays: 1000,
            wrong,
            late,
            guards,
            ..Verdict::default()
        };
        let (format, crossing) = (format.parse().unwrap(), crossing.parse().unwrap());
        Case::new(format, 256, crossing, 7, &verdict)
    }

    fn report(cases: Vec<Case>) -> OffsetReport {
        let screen = FrameSize {
            width: 4,
            height: 3,
        };
        OffsetReport::new(Method::Oh, "tiled", screen, cases, Duration::from_secs(1))
    }

    #[test]
    fn the_index_must_keep_its_promises_and_an_offset_makes_none() {
        for (case, agreed) in [
            (case("f64", "index", 0, 0, 0), true),
            (case("f64", "index", 1, 0, 0), false),
            (case("e7f16", "index", 3, 0, 0), true),
            (case("e7f16", "index", 0, 1, 0), false),
            (case("e7f16", "index", 0, 0, 1), false),
            (case("e7f16", "offset:0.5", 100, 50, 10), true),
        ] {
            assert_eq!(case.agreed, agreed, "{case:?}");
        }
        assert_eq!(report(vec![]).outcome(), Outcome::Disagreed);
    }

    #[test]
    fn table_csv_and_plot_have_the_same_numbers() {
        let report = report(vec![
            case("f64", "index", 0, 0, 0),
            case("f64", "offset:0.5", 123, 4, 0),
            case("e7f16", "index", 2, 0, 0),
            case("e7f16", "offset:0.5", 120, 5, 456),
        ]);
        let text = report.text();
        let row = "e7f16      256    0.200 /     0    12.00 / 45.60      1000       7\n";
        assert!(text.contains(row), "{text}");
        assert!(text.contains("agreed: "), "{text}");
        let csv = report.csv();
        assert!(
            csv.contains("e7f16,256,offset:0.5,1000,7,120,5,456,12.00000,45.60000\n"),
            "{csv}"
        );
        let plot = report.plot();
        let names: Vec<&str> = plot.series.iter().map(|series| &series.name[..]).collect();
        assert_eq!(names, ["f64 at 256", "e7f16 at 256", "index, e7f16 at 256"]);
        assert_eq!(plot.series[1].points.len(), 1);
        assert!((plot.series[1].points[0].1 - 57.6).abs() < 1e-9);
    }
}
