//! What came of the cases, for people, for programs and for spreadsheets.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde::Serialize;

use rtl_model::hard::{Assessment, HardCase, HardFamily, Promise};
use rtl_model::judge::Judgement;
use rtl_model::scene::{Crossing, Method, WalkFormat};

use crate::summary::json;

/// What each method came to on a case in a format; where it has no answer, why.
pub type Answers = Vec<Result<Assessment, &'static str>>;

/// The JSON of a run. As in every summary, what only a simulator knows is null.
#[derive(Serialize)]
pub struct Report {
    schema: &'static str,
    crossing: String,
    cases: u64,
    /// Rays of the cases.
    case_rays: u64,
    /// Rays walked, over all methods and formats.
    rays: u64,
    /// Rays that break a promise.
    mismatches: u64,
    guards: u64,
    seconds: f64,
    simulator: Option<String>,
    cycles: Option<u64>,
    signals_compared: Option<u64>,
    cycles_compared: Option<u64>,
    walks: Vec<WalkRow>,
    defects: Vec<Defect>,
    #[serde(skip)]
    lines: Vec<CaseRow>,
    #[serde(skip)]
    formats: Vec<WalkFormat>,
    #[serde(skip)]
    methods: Vec<Method>,
}

/// A method in a format, over all cases.
#[derive(Serialize)]
struct WalkRow {
    method: String,
    format: String,
    /// Why it does not walk; then nothing else is of interest.
    unsupported: Option<String>,
    /// Cases of which a ray was walked.
    cases: u64,
    /// Cases all of whose walked rays hit the very texel.
    passed: u64,
    rays: u64,
    right: u64,
    /// Another texel, not later than the exact hit.
    wrong_early: u64,
    late: u64,
    guards: u64,
    refused: u64,
    /// Rays that break a promise.
    defects: u64,
    mean_steps: Option<f64>,
    not_passed: Vec<String>,
}

/// A method in a format on a case: a line of the CSV.
struct CaseRow {
    case: String,
    family: HardFamily,
    method: Method,
    format: WalkFormat,
    promise: Promise,
    counts: Counts,
    steps: u64,
}

/// A ray that breaks a promise.
#[derive(Serialize)]
struct Defect {
    method: String,
    format: String,
    case: String,
    /// The first is 1.
    ray: usize,
    found: &'static str,
}

#[derive(Default, Clone, Copy)]
struct Counts {
    right: u64,
    early: u64,
    late: u64,
    guards: u64,
    refused: u64,
    defects: u64,
}

impl Counts {
    fn of(assessment: &Assessment) -> Counts {
        Counts {
            right: assessment.count(Judgement::Right),
            early: assessment.count(Judgement::Early),
            late: assessment.count(Judgement::Late),
            guards: assessment.count(Judgement::Guard),
            refused: assessment.refused(),
            defects: assessment.defects().count() as u64,
        }
    }
}

/// Rays whose expected hit, as the file has it, is not what the exact reference gives.
fn wrong_expectations(cases: &[HardCase]) -> Vec<Defect> {
    let of_case = |case: &HardCase| {
        let rays = case.rays.iter().enumerate();
        let wrong = rays.filter(|(_, ray)| ray.met_in(&case.map) != Ok(ray.expected));
        let defect = |(at, _)| Defect {
            method: "the exact reference".to_owned(),
            format: "the ray as written".to_owned(),
            case: case.name.clone(),
            ray: at + 1,
            found: "the file expects another hit",
        };
        wrong.map(defect).collect::<Vec<_>>()
    };
    cases.iter().flat_map(of_case).collect()
}

/// Defects that are shown to a person.
const SHOWN: usize = 20;

impl Report {
    /// Of answers in the order of formats, then of cases, then of methods.
    pub fn new(
        cases: &[HardCase],
        methods: &[Method],
        formats: &[WalkFormat],
        crossing: Crossing,
        answers: &[Answers],
        seconds: f64,
    ) -> Report {
        let mut walks = Vec::new();
        let (mut lines, mut defects) = (Vec::new(), wrong_expectations(cases));
        for (place, &method) in methods.iter().enumerate() {
            for (&format, answers) in formats.iter().zip(answers.chunks(cases.len())) {
                let mut row = WalkRow::new(method, format);
                let mut steps = 0;
                for (case, answers) in cases.iter().zip(answers) {
                    let assessment = match &answers[place] {
                        Ok(assessment) => assessment,
                        Err(why) => {
                            row.unsupported = Some((*why).to_owned());
                            continue;
                        }
                    };
                    steps += assessment.steps();
                    row.add(&case.name, assessment);
                    defects.extend(assessment.defects().map(|(ray, found)| Defect {
                        method: row.method.clone(),
                        format: row.format.clone(),
                        case: case.name.clone(),
                        ray: ray + 1,
                        found: word(found),
                    }));
                    lines.push(CaseRow {
                        case: case.name.clone(),
                        family: case.family,
                        method,
                        format,
                        promise: assessment.promise,
                        counts: Counts::of(assessment),
                        steps: assessment.steps(),
                    });
                }
                row.mean_steps = (row.rays > 0).then(|| steps as f64 / row.rays as f64);
                walks.push(row);
            }
        }
        Report {
            schema: "stepwell-hard-1",
            crossing: crossing.to_string(),
            cases: cases.len() as u64,
            case_rays: cases.iter().map(|case| case.rays.len() as u64).sum(),
            rays: walks.iter().map(|row| row.rays).sum(),
            mismatches: defects.len() as u64,
            guards: walks.iter().map(|row| row.guards).sum(),
            seconds,
            simulator: None,
            cycles: None,
            signals_compared: None,
            cycles_compared: None,
            walks,
            defects,
            lines,
            formats: formats.to_vec(),
            methods: methods.to_vec(),
        }
    }

    /// Rays walked.
    pub fn rays(&self) -> u64 {
        self.rays
    }

    /// Rays that break a promise.
    pub fn defects(&self) -> u64 {
        self.mismatches
    }

    /// Why methods do not walk in formats, a line each.
    pub fn reasons(&self) -> String {
        let reason = |row: &WalkRow| {
            let why = row.unsupported.as_ref()?;
            Some((why.clone(), format!("{} in {}", row.method, row.format)))
        };
        let mut reasons: Vec<(String, Vec<String>)> = Vec::new();
        for (why, walk) in self.walks.iter().filter_map(reason) {
            match reasons.iter_mut().find(|(own, _)| *own == why) {
                Some((_, walks)) => walks.push(walk),
                None => reasons.push((why, vec![walk])),
            }
        }
        let lines = reasons.iter().map(|(why, walks)| {
            let more = walks.len().saturating_sub(3);
            let more = if more > 0 {
                format!(" and {more} more")
            } else {
                String::new()
            };
            format!(
                "-  {}{more}: {why}\n",
                walks[..walks.len().min(3)].join(", ")
            )
        });
        lines.collect()
    }

    /// A row a method, a column a format.
    pub fn table(&self) -> String {
        let mut rows = vec![self.header()];
        for (method, walks) in self
            .methods
            .iter()
            .zip(self.walks.chunks(self.formats.len()))
        {
            let mut row = vec![method.to_string()];
            row.extend(walks.iter().map(WalkRow::cell));
            rows.push(row);
        }
        let of_formats = |name: &str, of: fn(&WalkRow) -> u64| {
            let most = |place| {
                let column = self.walks.iter().skip(place).step_by(self.formats.len());
                column.map(of).max().unwrap_or(0).to_string()
            };
            let mut row = vec![name.to_owned()];
            row.extend((0..self.formats.len()).map(most));
            row
        };
        rows.push(of_formats("cases walked", |row| row.cases));
        rows.push(of_formats("rays walked", |row| row.rays));
        rows.push(of_formats("rays refused", |row| row.refused));

        let mut text = format!(
            "{} cases, {} rays, crossing {}; cases passed, and rays of the others:\n\n",
            self.cases, self.case_rays, self.crossing
        );
        text += &aligned(&rows);
        text +=
            "\ne hits another texel, not later   l later than the exact hit   g no hit (guard)\n";
        text +=
            "! breaks its promise: exact and fixed the very texel, floats never late, none hangs\n";
        text += &self.reasons();
        for defect in self.defects.iter().take(SHOWN) {
            let Defect {
                method,
                format,
                case,
                ray,
                found,
            } = defect;
            // Writing to a string does not fail.
            let _ = writeln!(text, "! {method} in {format}: {case} ray {ray}: {found}");
        }
        if self.defects.len() > SHOWN {
            let _ = writeln!(
                text,
                "! and {} more; -o writes all",
                self.defects.len() - SHOWN
            );
        }
        let _ = writeln!(
            text,
            "{} of {} rays break a promise, in {:.1} s",
            self.mismatches, self.rays, self.seconds
        );
        text
    }

    fn header(&self) -> Vec<String> {
        let mut header = vec![String::new()];
        header.extend(self.formats.iter().map(WalkFormat::to_string));
        header
    }

    /// Every ray that does not hit the very texel, with what it should hit.
    pub fn wrong_rays(&self, cases: &[HardCase], answers: &[Answers]) -> String {
        let mut text = String::from("\n");
        for (&format, answers) in self.formats.iter().zip(answers.chunks(cases.len())) {
            for (case, answers) in cases.iter().zip(answers) {
                for (method, assessment) in self.methods.iter().zip(answers) {
                    let Ok(assessment) = assessment else { continue };
                    for (at, judgement) in assessment.judgements.iter().enumerate() {
                        let (Some(judgement), Some(hit)) = (judgement, assessment.hits[at]) else {
                            continue;
                        };
                        if *judgement == Judgement::Right {
                            continue;
                        }
                        let ray = &case.rays[at];
                        let (numerator, denominator) = ray.expected.depth;
                        let _ = writeln!(
                            text,
                            "{} ray {} by {method} in {format}: {}, ({}, {}) at {:?}; as written it is \
                             ({}, {}) at {numerator}/{denominator} = {:.9}\n    u {:?} v {:?} du {:?} dv {:?}",
                            case.name,
                            at + 1,
                            word(*judgement),
                            hit.i,
                            hit.j,
                            hit.t,
                            ray.expected.i,
                            ray.expected.j,
                            numerator as f64 / denominator as f64,
                            ray.ray.u,
                            ray.ray.v,
                            ray.ray.du,
                            ray.ray.dv,
                        );
                    }
                }
            }
        }
        text
    }

    /// Writes `hard.json` and `hard.csv`, a line for each method, format and case.
    pub fn write(&self, folder: &Path) -> anyhow::Result<()> {
        fs::write(folder.join("hard.json"), json(self)?)?;
        fs::write(folder.join("hard.csv"), self.csv())?;
        Ok(())
    }

    fn csv(&self) -> String {
        let mut text = String::from(
            "method,format,crossing,family,case,promise,right,wrong_early,late,guards,refused,defects,steps\n",
        );
        for line in &self.lines {
            let Counts {
                right,
                early,
                late,
                guards,
                refused,
                defects,
            } = line.counts;
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{right},{early},{late},{guards},{refused},{defects},{}",
                line.method,
                line.format,
                self.crossing,
                line.family,
                line.case,
                line.promise.name(),
                line.steps
            );
        }
        text
    }
}

impl WalkRow {
    fn new(method: Method, format: WalkFormat) -> WalkRow {
        WalkRow {
            method: method.to_string(),
            format: format.to_string(),
            unsupported: None,
            cases: 0,
            passed: 0,
            rays: 0,
            right: 0,
            wrong_early: 0,
            late: 0,
            guards: 0,
            refused: 0,
            defects: 0,
            mean_steps: None,
            not_passed: Vec::new(),
        }
    }

    fn add(&mut self, case: &str, assessment: &Assessment) {
        let counts = Counts::of(assessment);
        self.cases += u64::from(assessment.walked() > 0);
        self.passed += u64::from(assessment.has_passed());
        if assessment.walked() > 0 && !assessment.has_passed() {
            self.not_passed.push(case.to_owned());
        }
        self.rays += assessment.walked();
        self.right += counts.right;
        self.wrong_early += counts.early;
        self.late += counts.late;
        self.guards += counts.guards;
        self.refused += counts.refused;
        self.defects += counts.defects;
    }

    fn cell(&self) -> String {
        if self.unsupported.is_some() {
            return "-".to_owned();
        }
        let mut cell = self.passed.to_string();
        for (count, letter) in [
            (self.wrong_early, 'e'),
            (self.late, 'l'),
            (self.guards, 'g'),
        ] {
            if count > 0 {
                let _ = write!(cell, " {count}{letter}");
            }
        }
        if self.defects > 0 {
            let _ = write!(cell, " {}!", self.defects);
        }
        cell
    }
}

/// What a hit is found to be.
fn word(judgement: Judgement) -> &'static str {
    match judgement {
        Judgement::Right => "right",
        Judgement::Early => "another texel, not later than the exact hit",
        Judgement::Late => "later than the exact hit",
        Judgement::Guard => "no hit",
    }
}

/// Rows of cells in columns, two spaces between.
fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter()
            .filter_map(|row| row.get(column))
            .map(String::len)
            .max()
    };
    let widths: Vec<usize> = (0..columns)
        .map(|column| width(column).unwrap_or(0))
        .collect();
    let line = |row: &Vec<String>| {
        let cells = row
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{cell:width$}"));
        let line = cells.collect::<Vec<_>>().join("  ");
        line.trim_end().to_owned() + "\n"
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rtl_model::hard::{ExpectedHit, HardRay};
    use rtl_model::maps::HeightMap;
    use rtl_model::ray::Ray;

    fn case(rays: usize) -> HardCase {
        let ray = HardRay {
            note: String::new(),
            ray: Ray {
                u: 0.0,
                v: 0.0,
                du: 0.0,
                dv: 0.0,
            },
            expected: ExpectedHit {
                i: 0,
                j: 0,
                depth: (1, 3),
                side: false,
            },
        };
        HardCase {
            name: "c".to_owned(),
            family: HardFamily::Spike,
            why: "w".to_owned(),
            source: "s".to_owned(),
            map: HeightMap::new("c", 1, 8, vec![170]).unwrap(),
            rays: vec![ray; rays],
        }
    }

    fn report(promise: Promise, judgements: Vec<Option<Judgement>>) -> Report {
        let hits = vec![None; judgements.len()];
        let cases = [case(judgements.len())];
        let answers = [vec![
            Ok(Assessment {
                promise,
                judgements,
                hits,
            }),
            Err("it has no grid"),
        ]];
        let formats = ["e7f16".parse().unwrap()];
        Report::new(
            &cases,
            &[Method::Oh, Method::Dig],
            &formats,
            Crossing::Index,
            &answers,
            0.5,
        )
    }

    #[test]
    fn a_broken_promise_is_counted_and_shown() {
        let judgements = vec![
            Some(Judgement::Right),
            Some(Judgement::Late),
            Some(Judgement::Early),
            None,
        ];
        let table = report(Promise::NeverLate, judgements.clone()).table();
        for line in [
            "oh            0 1e 1l 1!",
            "dig           -",
            "rays walked   3",
            "rays refused  1",
            "-  dig in e7f16: it has no grid",
            "! oh in e7f16: c ray 2: later than the exact hit",
            "1 of 3 rays break a promise",
        ] {
            assert!(table.contains(line), "{line}\n{table}");
        }
        assert_eq!(report(Promise::VeryTexel, judgements.clone()).defects(), 2);
        assert_eq!(report(Promise::Nothing, judgements).defects(), 0);
    }

    #[test]
    fn a_case_none_of_whose_rays_is_walked_has_not_passed() {
        let report = report(Promise::NeverLate, vec![None, None]);
        assert_eq!(
            (report.rays(), report.walks[0].passed, report.walks[0].cases),
            (0, 0, 0)
        );
    }

    #[test]
    fn json_and_csv_have_the_same_numbers() {
        let report = report(
            Promise::NeverLate,
            vec![Some(Judgement::Guard), Some(Judgement::Right)],
        );
        let value: serde_json::Value = serde_json::from_str(&json(&report).unwrap()).unwrap();
        assert_eq!(value["schema"], "stepwell-hard-1");
        assert_eq!(
            (&value["mismatches"], &value["guards"]),
            (&1.into(), &1.into())
        );
        assert_eq!(value["walks"][1]["unsupported"], "it has no grid");
        let csv = report.csv();
        assert!(
            csv.contains("oh,e7f16,index,spike,c,never late,1,0,0,1,0,1,0\n"),
            "{csv}"
        );
    }
}
