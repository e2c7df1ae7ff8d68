//! What a table of the paper came to, for people and for programs.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::time::Duration;

use serde::Serialize;

use rtl_model::calibration::{CAMERAS, SURFACES};
use rtl_model::judge::Verdict;
use rtl_model::picture::{Plot, PlotAxis, Series, save_png};
use rtl_model::published::{Cell, Table};
use rtl_model::scene::{FrameSize, Method, WalkFormat};

use crate::commands::Outcome;

/// The most that a method's mean absolute deviation from the paper may be.
const MOST_MEAN_DEVIATION: f64 = 0.03;
/// The most that a cell may be off.
const MOST_DEVIATION: f64 = 0.10;

/// A cell of the paper's table and ours.
#[derive(Clone, Debug, Serialize)]
pub struct OurCell {
    #[serde(skip)]
    place: Cell,
    method: String,
    map: &'static str,
    camera: &'static str,
    /// The paper's figure.
    paper: Option<f64>,
    /// No reading reproduces the paper's.
    doubtful: bool,
    ours: f64,
    /// Ours by the paper's.
    ratio: Option<f64>,
    rays: u64,
    wrong: u64,
    late: u64,
    guards: u64,
    mean_steps: f64,
    mean_crossings: f64,
}

impl OurCell {
    /// A cell of `table` whose frame was judged.
    pub fn new(table: Table, cell: Cell, verdict: &Verdict) -> OurCell {
        let mean_steps = verdict.mean_steps().unwrap_or(f64::NAN);
        let ours = match table {
            Table::CrossingProbability => 100.0 * verdict.crossing_share().unwrap_or(f64::NAN),
            Table::LevelsDown | Table::StepsPerPixel => mean_steps,
        };
        OurCell {
            place: cell,
            method: cell.method.to_string(),
            map: SURFACES[cell.surface].name,
            camera: CAMERAS[cell.camera].0,
            paper: cell.figure.map(|figure| figure.value),
            doubtful: cell.figure.is_some_and(|figure| figure.doubtful),
            ours,
            ratio: cell.figure.map(|figure| ours / figure.value),
            rays: verdict.rays,
            wrong: verdict.wrong,
            late: verdict.late,
            guards: verdict.guards,
            mean_steps,
            mean_crossings: verdict.mean_crossings().unwrap_or(f64::NAN),
        }
    }

    /// How far ours is from the paper's, where that counts.
    fn deviation(&self) -> Option<f64> {
        (!self.doubtful).then_some(())?;
        self.ratio.map(|ratio| ratio - 1.0)
    }
}

/// All cells of a method.
#[derive(Clone, Debug, Serialize)]
struct MethodReport {
    method: String,
    /// Cells that count: with a figure that is not doubtful.
    cells: usize,
    mean_absolute_deviation: Option<f64>,
    /// The cell that is furthest off.
    worst: Option<Worst>,
    /// Ours from each camera, the mean of the maps.
    ours_by_camera: [Option<f64>; CAMERAS.len()],
    wrong: u64,
    guards: u64,
    /// Within both limits, and no wrong texel or guard where the method promises none.
    agreed: bool,
}

#[derive(Clone, Debug, Serialize)]
struct Worst {
    map: &'static str,
    camera: &'static str,
    deviation: f64,
}

impl MethodReport {
    fn of(method: Method, cells: &[&OurCell], format: WalkFormat) -> MethodReport {
        let deviations: Vec<(f64, &OurCell)> = cells
            .iter()
            .filter_map(|cell| Some((cell.deviation()?, *cell)))
            .collect();
        let sum: f64 = deviations
            .iter()
            .map(|(deviation, _)| deviation.abs())
            .sum();
        let mean = (!deviations.is_empty()).then(|| sum / deviations.len() as f64);
        let worst = deviations
            .iter()
            .max_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()))
            .map(|(deviation, cell)| Worst {
                map: cell.map,
                camera: cell.camera,
                deviation: *deviation,
            });
        let (wrong, guards, late) = cells.iter().fold((0, 0, 0), |sum, cell| {
            (sum.0 + cell.wrong, sum.1 + cell.guards, sum.2 + cell.late)
        });
        // A float of the hardware may be early in a neighbouring texel; nothing safe is ever late.
        let may_be_early = matches!(format, WalkFormat::Float(_));
        let sound = !method.is_safe() || (guards + late == 0 && (may_be_early || wrong == 0));
        let within = mean.is_none_or(|mean| mean <= MOST_MEAN_DEVIATION)
            && worst
                .as_ref()
                .is_none_or(|worst| worst.deviation.abs() <= MOST_DEVIATION);
        let ours_by_camera = std::array::from_fn(|camera| {
            let own = cells.iter().filter(|cell| cell.place.camera == camera);
            let (sum, count) =
                own.fold((0.0, 0), |(sum, count), cell| (sum + cell.ours, count + 1));
            (count > 0).then(|| sum / f64::from(count))
        });
        MethodReport {
            method: method.to_string(),
            ours_by_camera,
            cells: deviations.len(),
            mean_absolute_deviation: mean,
            worst,
            wrong,
            guards,
            agreed: sound && within,
        }
    }
}

/// A table of the paper beside ours. Every JSON summary of this program has the keys from
/// `mismatches` to `simulator`; no hardware is run here, so that those of it are null.
#[derive(Debug, Serialize)]
pub struct Report {
    schema: &'static str,
    table: String,
    quantity: &'static str,
    source: &'static str,
    format: String,
    method: String,
    width: u32,
    height: u32,
    rays: u64,
    /// Wrong texels of methods that promise none.
    mismatches: u64,
    guards: u64,
    cycles: Option<u64>,
    signals_compared: Option<u64>,
    cycles_compared: Option<u64>,
    simulator: Option<String>,
    limits: Limits,
    methods: Vec<MethodReport>,
    cells: Vec<OurCell>,
    agreed: bool,
    seconds: f64,
}

#[derive(Debug, Serialize)]
struct Limits {
    mean_absolute_deviation: f64,
    deviation: f64,
}

impl Report {
    /// The report on a table's cells.
    pub fn new(
        table: Table,
        format: WalkFormat,
        screen: FrameSize,
        cells: Vec<OurCell>,
        time: Duration,
    ) -> Report {
        let mut order: Vec<Method> = Vec::new();
        for cell in &cells {
            if !order.contains(&cell.place.method) {
                order.push(cell.place.method);
            }
        }
        let methods: Vec<MethodReport> = order
            .iter()
            .map(|&method| {
                let own = cells.iter().filter(|cell| cell.place.method == method);
                MethodReport::of(method, &own.collect::<Vec<_>>(), format)
            })
            .collect();
        let of_safe = cells.iter().filter(|cell| cell.place.method.is_safe());
        let names: Vec<String> = order.iter().map(Method::to_string).collect();
        Report {
            schema: "stepwell-paper-1",
            table: format!("table{}", table.number()),
            quantity: table.quantity(),
            source: "Computers & Graphics, special section on CAD/Graphics 2013: Effective traversal \
                     algorithms and hardware architecture for pyramidal inverse displacement mapping",
            format: format.to_string(),
            method: names.join(","),
            width: screen.width,
            height: screen.height,
            rays: cells.iter().map(|cell| cell.rays).sum(),
            mismatches: of_safe.map(|cell| cell.wrong).sum(),
            guards: cells.iter().map(|cell| cell.guards).sum(),
            cycles: None,
            signals_compared: None,
            cycles_compared: None,
            simulator: None,
            limits: Limits {
                mean_absolute_deviation: MOST_MEAN_DEVIATION,
                deviation: MOST_DEVIATION,
            },
            agreed: methods.iter().all(|method| method.agreed),
            methods,
            cells,
            seconds: time.as_secs_f64(),
        }
    }

    /// Agreed, if every method is within the limits and none has a wrong texel that promises none.
    pub fn outcome(&self) -> Outcome {
        match self.agreed {
            true => Outcome::Agreed,
            false => Outcome::Disagreed,
        }
    }

    /// The table for a terminal.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{} of the 2013 hardware paper: {}\n{} x {} pixels in {}, every hit judged by the exact \
             reference. Each cell: paper, ours, deviation in percent; ? is doubtful and does not \
             count.\n\n",
            self.table, self.quantity, self.width, self.height, self.format
        );
        let cameras = CAMERAS.map(|(name, _)| format!("{name:^23}"));
        let _ = writeln!(
            text,
            "{:18} {:7} {}  wrong",
            "method",
            "map",
            cameras.join(" ")
        );
        for (number, cell) in self.cells.iter().enumerate() {
            let starts_row = cell.place.camera == 0;
            if starts_row {
                let _ = write!(text, "{:18} {:7}", cell.method, cell.map);
            }
            let _ = write!(text, " {}", cell_text(cell));
            let ends_row = self
                .cells
                .get(number + 1)
                .is_none_or(|next| next.place.camera == 0);
            if ends_row {
                let row = &self.cells[..=number];
                let own = |other: &&OurCell| (&other.method, other.map) == (&cell.method, cell.map);
                let wrong: u64 = row.iter().filter(own).map(|cell| cell.wrong).sum();
                let _ = writeln!(text, "  {wrong:5}");
            }
        }
        let _ = writeln!(
            text,
            "\n{:18} {:>5}  {:>19}  {:<26} {:<21} {:>7} {:>6}",
            "method",
            "cells",
            "mean abs. deviation",
            "worst cell",
            "ours, mean of maps",
            "wrong",
            "guards"
        );
        for method in &self.methods {
            let mean = method.mean_absolute_deviation;
            let mean = mean.map_or("-".to_owned(), |mean| format!("{:.2} %", 100.0 * mean));
            let worst = method.worst.as_ref().map_or("-".to_owned(), |worst| {
                format!(
                    "{} {} {:+.1} %",
                    worst.map,
                    worst.camera,
                    100.0 * worst.deviation
                )
            });
            let ours = method.ours_by_camera;
            let ours = ours.map(|mean| mean.map_or("-".to_owned(), |mean| format!("{mean:.2}")));
            let ours = ours.join(" / ");
            let _ = writeln!(
                text,
                "{:18} {:5}  {mean:>19}  {worst:<26} {ours:<21} {:>7} {:>6}{}",
                method.method,
                method.cells,
                method.wrong,
                method.guards,
                if method.agreed { "" } else { "  MISSED" }
            );
        }
        let _ = writeln!(
            text,
            "\n{}: a method's mean absolute deviation at most {:.0} %, a cell at most {:.0} %, 0 wrong \
             texels; {} rays in {:.1} s",
            if self.agreed { "agreed" } else { "missed" },
            100.0 * MOST_MEAN_DEVIATION,
            100.0 * MOST_DEVIATION,
            self.rays,
            self.seconds
        );
        text
    }

    /// Writes the table as CSV, as JSON and as a plot.
    pub fn save(&self, folder: &Path) -> anyhow::Result<()> {
        let file = |ending: &str| folder.join(format!("{}.{ending}", self.table));
        fs::write(file("csv"), self.csv())?;
        fs::write(file("json"), crate::summary::json(self)?)?;
        save_png(&self.plot().draw(), &file("png"))?;
        Ok(())
    }

    /// One line a cell.
    fn csv(&self) -> String {
        let mut text = "method,map,camera,paper,doubtful,ours,ratio,rays,wrong,late,guards,\
                        mean_steps,mean_crossings\n"
            .to_owned();
        let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
        for cell in &self.cells {
            let _ = writeln!(
                text,
                "{},{},{},{},{},{:.4},{},{},{},{},{},{:.4},{:.4}",
                cell.method,
                cell.map,
                cell.camera,
                number(cell.paper),
                if cell.doubtful { "yes" } else { "" },
                cell.ours,
                cell.ratio
                    .map_or(String::new(), |ratio| format!("{ratio:.4}")),
                cell.rays,
                cell.wrong,
                cell.late,
                cell.guards,
                cell.mean_steps,
                cell.mean_crossings
            );
        }
        text
    }

    /// Ours over the paper's, a series a method; doubtful cells are a series of their own.
    fn plot(&self) -> Plot {
        let axis = |whose: &str| PlotAxis {
            label: format!("{whose}: {}", self.quantity),
            logarithmic: false,
        };
        let series = |name: &str, of: &dyn Fn(&OurCell) -> bool| Series {
            name: name.to_owned(),
            points: self
                .cells
                .iter()
                .filter(|cell| of(cell))
                .filter_map(|cell| Some((cell.paper?, cell.ours)))
                .collect(),
            joined: false,
        };
        let mut all: Vec<Series> = self
            .methods
            .iter()
            .map(|method| {
                let own = |cell: &OurCell| cell.method == method.method && !cell.doubtful;
                series(&method.method, &own)
            })
            .collect();
        if self.cells.iter().any(|cell| cell.doubtful) {
            all.push(series("doubtful", &|cell| cell.doubtful));
        }
        Plot {
            title: format!(
                "{} of the 2013 hardware paper, {} x {} in {}",
                self.table, self.width, self.height, self.format
            ),
            x: axis("paper"),
            y: axis("ours"),
            diagonal: true,
            series: all,
        }
    }
}

/// Paper, ours and deviation in 23 columns.
fn cell_text(cell: &OurCell) -> String {
    let Some((paper, ratio)) = cell.paper.zip(cell.ratio) else {
        return format!("{:>6} {:>7.2}         ", "-", cell.ours);
    };
    let mark = if cell.doubtful { '?' } else { ' ' };
    format!(
        "{paper:>6.1} {:>7.2} {:>+6.1}{mark} ",
        cell.ours,
        100.0 * (ratio - 1.0)
    )
}
