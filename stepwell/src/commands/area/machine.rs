//! A scene's machine: its units, and the pixels it gives a second for what it takes.

use std::fmt::Display;
use std::sync::Arc;

use serde::Serialize;

use hdl_gen::area::Flow;
use hdl_gen::netlist::Module;
use hdl_gen::units::PAPER_LOOP;
use rtl_model::scene::{MachineKind, MachineLatencies, Scene};

use super::report::UnitFigures;
use super::subject::{MachineUnit, Subject};
use crate::machine::{ExactScene, MachineReport, PaperScene, machine_of};

/// What the whole machine is called among its units.
const WHOLE: &str = "machine";

/// The unit whose memory is no part of a comparison.
const CACHE: &str = "height_cache";

/// A machine to be measured: its units, and its golden run on the scene's frame.
pub struct MeasuredMachine {
    latencies: Option<MachineLatencies>,
    units: Vec<MachineUnit>,
    report: MachineReport,
}

impl MeasuredMachine {
    /// Builds the scene's machine and runs its golden model on the frame.
    ///
    /// # Errors
    /// If the scene has no machine, or it cannot be built.
    pub fn of(scene: &Scene) -> anyhow::Result<MeasuredMachine> {
        let machine = machine_of(scene)?;
        match machine.kind {
            MachineKind::Paper => {
                let subject = PaperScene::of(scene, &machine)?;
                Ok(MeasuredMachine {
                    latencies: Some(subject.latencies),
                    ..MeasuredMachine::new(
                        &subject.unit.design,
                        &[PAPER_LOOP],
                        subject.format,
                        subject.golden_run(None),
                    )
                })
            }
            MachineKind::Exact => {
                let subject = ExactScene::of(scene, &machine)?;
                Ok(MeasuredMachine::new(
                    &subject.unit.design,
                    &[],
                    scene.walk.format,
                    subject.golden_run(None),
                ))
            }
        }
    }

    /// A machine of any kind: measured are its instances, in place of its modules `opened` those
    /// within them, and all of it; `report` is what its golden run came to.
    pub fn new(
        design: &Arc<Module>,
        opened: &[&str],
        format: impl Display,
        report: MachineReport,
    ) -> MeasuredMachine {
        MeasuredMachine {
            latencies: None,
            units: units(design, opened, &format.to_string()),
            report,
        }
    }

    /// What is measured, and how: every unit with one placement, and then all of it with as many
    /// as are asked for.
    pub fn subjects(&self, flow: Flow) -> Vec<(Subject, Flow)> {
        let subject = |unit: &MachineUnit| {
            let seeds = if unit.name == WHOLE { flow.seeds } else { 1 };
            (Subject::Unit(unit.clone()), Flow { seeds, ..flow })
        };
        self.units.iter().map(subject).collect()
    }

    /// What the figures of [`MeasuredMachine::subjects`] come to; none without those of the whole.
    pub fn figures(&self, units: &[UnitFigures]) -> Option<MachineFigures> {
        let whole = units.iter().find(|unit| unit.unit == WHOLE)?;
        let cache = units.iter().find(|unit| unit.unit == CACHE);
        let cache_memory_lut4 = cache.map_or(0, |cache| cache.lut4_memory);
        let lut4 = whole.lut4_taken - cache_memory_lut4.min(whole.lut4_taken);
        let parts = units.iter().filter(|unit| unit.unit != WHOLE);
        let of_parts: u64 = parts.map(|unit| unit.lut4_taken).sum();
        let mpixels = whole.fmax_mhz / self.report.cycles_per_pixel;
        Some(MachineFigures {
            latencies: self.latencies,
            lut4_without_cache_memory: lut4,
            lut4_in_no_unit: whole.lut4_taken as i64 - of_parts as i64,
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

/// The instances of a machine, in place of a module `opened` those within it, and then all of it.
fn units(design: &Arc<Module>, opened: &[&str], format: &str) -> Vec<MachineUnit> {
    let unit = |name: String, module: &Arc<Module>| MachineUnit {
        name,
        module: module.clone(),
        format: format.to_owned(),
    };
    let mut units = Vec::new();
    for instance in &design.instances {
        if opened.contains(&instance.module.name.as_str()) {
            units.extend(instance.module.instances.iter().map(|within| {
                let name = format!("{}.{}", instance.name, within.name);
                unit(name, &within.module)
            }));
        } else {
            units.push(unit(instance.name.clone(), &instance.module));
        }
    }
    units.push(unit(WHOLE.to_owned(), design));
    units
}

/// What a machine reaches. The memory of its height cache, words and tags, stands apart.
#[derive(Clone, Debug, Serialize)]
pub struct MachineFigures {
    /// Of the paper's machine, cycles of its operators.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub latencies: Option<MachineLatencies>,
    /// Look-up tables taken on the ECP5 by all but the cache's memory, those of carries included.
    pub lut4_without_cache_memory: u64,
    /// Look-up tables of the whole less those of its units: what connects and controls them, less
    /// what they share, or has no use, once they are connected.
    pub lut4_in_no_unit: i64,
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
        let mut text = String::new();
        if let Some(latencies) = self.latencies {
            let MachineLatencies {
                adder,
                multiplier,
                divider,
                comparator,
                conversion,
            } = latencies;
            text += &format!(
                "cycles of operators: adder {adder}, multiplier {multiplier}, divider {divider}, \
                 comparator {comparator}, conversion {conversion}\n"
            );
        }
        text + &format!(
            "{} LUT4 of machine are those of no unit: control, less what its units share once they \
             are connected. Units are placed once\n\
             cache memory apart: {} BRAM and {} LUT4 hold the height cache's words and tags; {} \
             LUT4 do all else. In gates memories of more than 64 words stand apart\n\
             {:.2} cycles a pixel, {:.3} Mpixels/s, {:.4} Mpixels/s per kLUT4\n",
            self.lut4_in_no_unit,
            self.cache_memory_bram,
            self.cache_memory_lut4,
            self.lut4_without_cache_memory,
            self.run.cycles_per_pixel,
            self.mpixels_per_second,
            self.mpixels_per_second_per_klut,
        )
    }
}
