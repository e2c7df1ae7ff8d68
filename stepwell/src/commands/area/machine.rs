//! A scene's machine: its units, and the pixels it gives a second for what it takes.

use std::str::FromStr;
use std::sync::Arc;

use anyhow::bail;
use serde::Serialize;

use hdl_gen::datapath::OperatorLatencies;
use hdl_gen::netlist::Module;
use hdl_gen::units::PAPER_LOOP;
use rtl_model::float::FloatFormat;
use rtl_model::readings::E7F16;
use rtl_model::scene::{MachineKind, Scene};

use super::report::UnitFigures;
use super::subject::{MachineUnit, Subject};
use crate::machine::{MachineReport, PaperScene, machine_of};

/// What the whole machine is called among its units.
const WHOLE: &str = "machine";

/// The unit whose memory is no part of a comparison.
const CACHE: &str = "height_cache";

/// The most cycles of an operator.
const LONGEST: u32 = 32;

/// Cycles of the operators of the paper's machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Latencies(pub OperatorLatencies);

impl FromStr for Latencies {
    type Err = String;

    fn from_str(text: &str) -> Result<Latencies, String> {
        let cycles = text.split(',').map(|word| {
            let cycles = word.trim().parse().ok();
            cycles.filter(|cycles| (1..=LONGEST).contains(cycles))
        });
        let cycles: Option<Vec<u32>> = cycles.collect();
        match cycles.as_deref() {
            Some(&[adder, multiplier, divider, comparator, conversion]) => {
                Ok(Latencies(OperatorLatencies {
                    adder,
                    multiplier,
                    divider,
                    comparator,
                    conversion,
                }))
            }
            _ => Err(format!(
                "five numbers of cycles, 1 to {LONGEST}, of adder, multiplier, divider, \
                 comparator and conversion, such as 2,1,8,1,1"
            )),
        }
    }
}

/// A machine to be measured.
pub struct MeasuredMachine {
    kind: MachineKind,
    latencies: OperatorLatencies,
    units: Vec<MachineUnit>,
    report: MachineReport,
}

impl MeasuredMachine {
    /// Builds the scene's machine and runs its golden model on the frame.
    ///
    /// # Errors
    /// If the scene has no machine, or it cannot be built.
    pub fn of(scene: &Scene, latencies: Option<Latencies>) -> anyhow::Result<MeasuredMachine> {
        let machine = machine_of(scene)?;
        let latencies = latencies.map_or(OperatorLatencies::PAPER, |chosen| chosen.0);
        match machine.kind {
            MachineKind::Paper => {
                let subject = PaperScene::with_latencies(scene, &machine, &latencies)?;
                let design = &subject.unit.design;
                let report = match subject.format {
                    // The format the unit is made for: its arithmetic compiled for it.
                    FloatFormat::E7F16 => subject.golden(E7F16, None),
                    other => subject.golden(other, None),
                };
                Ok(MeasuredMachine {
                    kind: machine.kind,
                    latencies,
                    units: units(design, &[PAPER_LOOP], &subject.format.to_string()),
                    report,
                })
            }
            MachineKind::Exact => bail!(
                "scene {}: machine {} is not measured yet; take kind = \"{}\"",
                scene.name,
                machine.kind.name(),
                MachineKind::Paper.name()
            ),
        }
    }

    /// What is measured: every unit, and then all of it.
    pub fn subjects(&self) -> Vec<Subject> {
        self.units.iter().cloned().map(Subject::Unit).collect()
    }

    /// What the figures of [`MeasuredMachine::subjects`] come to; none without those of the whole.
    pub fn figures(&self, units: &[UnitFigures]) -> Option<MachineFigures> {
        let whole = units.iter().find(|unit| unit.unit == WHOLE)?;
        let cache = units.iter().find(|unit| unit.unit == CACHE);
        let cache_memory_lut4 = cache.map_or(0, |cache| cache.lut4_memory);
        let lut4 = whole.lut4 - cache_memory_lut4.min(whole.lut4);
        let mpixels = whole.fmax_mhz / self.report.cycles_per_pixel;
        Some(MachineFigures {
            latencies: self.latencies,
            kind: self.kind.name(),
            lut4_without_cache_memory: lut4,
            cache_memory_lut4,
            cache_memory_bram: cache.map_or(0, |cache| cache.bram),
            mpixels_per_second: mpixels,
            mpixels_per_second_per_klut: 1000.0 * mpixels / lut4 as f64,
            run: self.report.clone(),
        })
    }

    /// Did every ray of the golden run leave once, with the golden walk's hit?
    pub fn agrees(&self) -> bool {
        self.report.agrees()
    }
}

/// The instances of a machine, those of its modules `opened` too, and then all of it.
fn units(design: &Arc<Module>, opened: &[&str], format: &str) -> Vec<MachineUnit> {
    let unit = |name: String, module: &Arc<Module>| MachineUnit {
        name,
        module: module.clone(),
        format: format.to_owned(),
    };
    let mut units = Vec::new();
    for instance in &design.instances {
        units.push(unit(instance.name.clone(), &instance.module));
        if opened.contains(&instance.module.name.as_str()) {
            units.extend(instance.module.instances.iter().map(|within| {
                let name = format!("{}.{}", instance.name, within.name);
                unit(name, &within.module)
            }));
        }
    }
    units.push(unit(WHOLE.to_owned(), design));
    units
}

/// What a machine reaches. The memory of its height cache, words and tags, stands apart.
#[derive(Clone, Debug, Serialize)]
pub struct MachineFigures {
    #[serde(skip)]
    kind: &'static str,
    /// Cycles of its operators.
    pub latencies: OperatorLatencies,
    /// Look-up tables on the ECP5 of all but the cache's memory.
    pub lut4_without_cache_memory: u64,
    /// Look-up tables that hold the cache's memory.
    pub cache_memory_lut4: u64,
    /// Block RAMs that hold it.
    pub cache_memory_bram: u64,
    /// Millions of pixels a second at the clock that the ECP5 achieved.
    pub mpixels_per_second: f64,
    /// The same of each thousand of `lut4_without_cache_memory`.
    pub mpixels_per_second_per_klut: f64,
    /// What the golden run came to.
    #[serde(flatten)]
    run: MachineReport,
}

impl MachineFigures {
    /// Lines for people.
    pub fn text(&self) -> String {
        let OperatorLatencies {
            adder,
            multiplier,
            divider,
            comparator,
            conversion,
        } = self.latencies;
        let mut text = String::new();
        if self.kind == MachineKind::Paper.name() {
            text += &format!(
                "cycles of operators: adder {adder}, multiplier {multiplier}, divider {divider}, \
                 comparator {comparator}, conversion {conversion}\n"
            );
        }
        text + &format!(
            "cache memory apart: {} BRAM and {} LUT4 hold the height cache's words and tags; {} \
             LUT4 do all else. In gates memories of more than 64 words stand apart\n\
             {:.2} cycles a pixel, {:.3} Mpixels/s, {:.4} Mpixels/s per kLUT4\n",
            self.cache_memory_bram,
            self.cache_memory_lut4,
            self.lut4_without_cache_memory,
            self.run.cycles_per_pixel,
            self.mpixels_per_second,
            self.mpixels_per_second_per_klut,
        )
    }
}
