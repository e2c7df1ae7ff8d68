//! What the golden machine knows of a traverse unit: ports, the registers of the loop, those of
//! its setup and of its step.

use super::configuration::UnitConfiguration;
use super::probe::{CycleLayout, CycleWords, Probe};
use super::traverse::shown_as;
use super::traverse_datapaths::{BuiltSetup, FreshValue, step_registers};
use crate::datapath::{BuiltDatapath, PipelineRegister, Source};
use crate::netlist::{Meaning, Module};
use rtl_model::machine::{ID_BITS, UnitLatency};
use rtl_model::units::step::Step;

/// The hit ports, and the step's outputs they carry.
const HIT_PORTS: [(&str, &str); 8] = [
    ("hit_i_o", "texel_i_o"),
    ("hit_j_o", "texel_j_o"),
    ("hit_t_o", "t_o"),
    ("hit_u_o", "position_u_o"),
    ("hit_v_o", "position_v_o"),
    ("hit_steps_o", "steps_o"),
    ("hit_crossings_o", "crossings_o"),
    ("hit_guard_o", "guard_o"),
];

/// A unit just built.
pub(super) struct UnitProbes<'a> {
    pub(super) configuration: &'a UnitConfiguration,
    pub(super) latency: UnitLatency,
    pub(super) setup: &'a BuiltSetup,
    pub(super) step: &'a BuiltDatapath,
    pub(super) design: &'a Module,
}

/// A signal and how many cycles before.
type Earlier = (String, u32);

/// The same, a cycle earlier still.
fn before(sources: &[Earlier]) -> Vec<Earlier> {
    let earlier = |(path, cycles): &Earlier| (path.clone(), cycles + 1);
    sources.iter().map(earlier).collect()
}

fn top(name: &str) -> String {
    format!("traverse.{name}")
}

impl UnitProbes<'_> {
    fn layout(&self) -> CycleLayout {
        CycleLayout {
            registers: step_registers(&self.configuration.step).len(),
            operations: self.step.word_count,
            ray_ports: self.configuration.step.ray_ports().len(),
            setup_operations: self.setup.datapath.word_count,
        }
    }

    /// All of them.
    pub(super) fn all(&self) -> Vec<Probe> {
        let mut probes = self.ports();
        probes.extend(self.setup_stages());
        probes.extend(self.stages());
        probes.extend(self.entry_registers());
        probes.extend(self.setup_registers());
        probes.extend(self.step_registers());
        probes
    }

    /// What a signal of the step comes from, as a path in the unit.
    fn paths(&self, sources: &[Source], cycles: u32) -> Vec<Earlier> {
        let height = self.configuration.step.height_ports()[0].0;
        let path = |source: &Source| match source {
            Source::Register(name) => top(&format!("step.{name}")),
            Source::Input(name) if *name == height => top(&format!("{name}_i")),
            Source::Input(name) => top(&format!("{name}_s0")),
        };
        sources
            .iter()
            .map(|source| (path(source), cycles))
            .collect()
    }

    /// What decides whether a ray leaves or goes round again.
    fn control(&self) -> Vec<Earlier> {
        let sources = &self.step.output_sources;
        let mut control = self.paths(&sources["hit_o"], 0);
        control.extend(self.paths(&sources["guard_o"], 0));
        control.push((top(&format!("valid_s{}", self.latency.step)), 0));
        control
    }

    fn control_and(&self, more: &[&str]) -> Vec<Earlier> {
        let mut all = self.control();
        all.extend(more.iter().map(|name| (top(name), 0)));
        all
    }

    /// What decides whether the loop or the setup takes a ray in a cycle.
    fn ready_sources(&self) -> Vec<Earlier> {
        match self.latency.setup {
            0 => self.control_and(&["hit_ready_i"]),
            stages => self.control_and(&["hit_ready_i", &format!("setup_valid_s{stages}")]),
        }
    }

    /// A ray as it arrives in front of stage 0, and its valid bit and id: from the ports, or from
    /// the end of the setup.
    fn arriving(&self) -> (Vec<String>, String, String) {
        match self.latency.setup {
            0 => {
                let ports = self.configuration.step.ray_ports();
                let ports = ports.iter().map(|(name, _)| format!("ray_{name}_i"));
                (
                    ports.collect(),
                    "ray_valid_i".to_owned(),
                    "ray_id_i".to_owned(),
                )
            }
            stages => (
                Vec::new(),
                format!("setup_valid_s{stages}"),
                format!("setup_id_s{stages}"),
            ),
        }
    }

    fn probe(
        &self,
        name: impl Into<String>,
        (width, meaning): (u32, Meaning),
        (word, delay): (usize, u32),
        sources: Vec<Earlier>,
    ) -> Probe {
        Probe {
            scope: vec!["traverse".to_owned()],
            name: name.into(),
            width,
            meaning,
            word,
            delay,
            sources,
        }
    }

    fn ports(&self) -> Vec<Probe> {
        let latency = self.latency.step;
        let bit = (1, Meaning::Bits);
        let id_source = vec![(top(&format!("id_s{latency}")), 0)];
        let mut probes = vec![
            self.probe(
                "ray_ready_o",
                bit,
                (CycleWords::RAY_READY, 0),
                self.ready_sources(),
            ),
            self.probe(
                "hit_valid_o",
                bit,
                (CycleWords::HIT_VALID, 0),
                self.control(),
            ),
            self.probe(
                "hit_id_o",
                (ID_BITS, Meaning::Bits),
                (CycleWords::ID, latency),
                id_source,
            ),
        ];
        let address = format!("{}_o", self.configuration.step.address_port());
        let hit_ports = HIT_PORTS.map(|(port, output)| (port, output.to_owned(), latency));
        let asked_in = self.step.output_stages[&address];
        let module = &self.step.module;
        for (port, output, delay) in
            hit_ports
                .into_iter()
                .chain([("height_address_o", address, asked_in)])
        {
            let word = self.layout().operation(self.step.output_words[&output]);
            let wire = self.design.output(port).expect("a port just made");
            let meaning = match module.output(&output).map(|wire| module.node(wire).meaning) {
                Some(float @ Meaning::Float(_)) => float,
                _ => Meaning::Bits,
            };
            let sources = self.paths(&self.step.output_sources[&output], 0);
            let shown = (self.design.width(wire), meaning);
            probes.push(self.probe(port, shown, (word, delay), sources));
        }
        probes
    }

    /// Valid bits and ids beside the step's stages.
    fn stages(&self) -> Vec<Probe> {
        let latency = self.latency.step;
        let (_, arriving_valid, arriving_id) = self.arriving();
        let mut probes = Vec::new();
        for stage in 0..=latency {
            let (valid_sources, id_sources) = if stage == 0 {
                let valid = self.control_and(&[&arriving_valid, "hit_ready_i"]);
                let mut id = self.control_and(&[&arriving_id, "hit_ready_i"]);
                id.push((top(&format!("id_s{latency}")), 0));
                (before(&valid), before(&id))
            } else {
                let earlier = |name: &str| vec![(top(&format!("{name}_s{}", stage - 1)), 1)];
                (earlier("valid"), earlier("id"))
            };
            probes.push(self.probe(
                format!("valid_s{stage}"),
                (1, Meaning::Bits),
                (CycleWords::VALID, stage),
                valid_sources,
            ));
            probes.push(self.probe(
                format!("id_s{stage}"),
                (ID_BITS, Meaning::Bits),
                (CycleWords::ID, stage),
                id_sources,
            ));
        }
        probes
    }

    /// The registers in front of the step.
    fn entry_registers(&self) -> Vec<Probe> {
        let (ray, ..) = self.arriving();
        let mut ports: Vec<&str> = ray.iter().map(String::as_str).collect();
        ports.push("hit_ready_i");
        let registers = step_registers(&self.configuration.step);
        let probe = |(place, &(name, kind)): (usize, &(&str, _))| {
            let mut sources = self.control_and(&ports);
            sources.extend(self.paths(&self.step.output_sources[&format!("{name}_o")], 0));
            sources.extend(self.fresh_sources(place));
            let shown = shown_as(kind, self.configuration.format);
            let word = (CycleWords::INPUTS + place, 0);
            self.probe(format!("{name}_s0"), shown, word, before(&sources))
        };
        registers.iter().enumerate().map(probe).collect()
    }

    /// What a fresh ray's register comes from at the end of the setup's pipeline.
    fn fresh_sources(&self, place: usize) -> Vec<Earlier> {
        let FreshValue::Port(port) = &self.setup.fresh[place] else {
            return Vec::new();
        };
        let sources = self.setup.datapath.output_sources[port].iter();
        let registers = sources.filter_map(|source| match source {
            Source::Register(name) => Some((top(&format!("setup.{name}")), 0)),
            // The ports themselves are among the sources already.
            Source::Input(_) => None,
        });
        registers.collect()
    }

    /// Valid bits and ids beside the setup's stages. They stall, so that what a value comes from
    /// is not so and so many cycles back: their sources are not given.
    fn setup_stages(&self) -> Vec<Probe> {
        let layout = self.layout();
        let stages = 1..=self.latency.setup;
        let of_stage = |stage| {
            let valid = layout.setup_valid(stage);
            [
                self.probe(
                    format!("setup_valid_s{stage}"),
                    (1, Meaning::Bits),
                    (valid, 0),
                    Vec::new(),
                ),
                self.probe(
                    format!("setup_id_s{stage}"),
                    (ID_BITS, Meaning::Bits),
                    (valid + 1, 0),
                    Vec::new(),
                ),
            ]
        };
        stages.flat_map(of_stage).collect()
    }

    /// The registers inside the setup.
    fn setup_registers(&self) -> Vec<Probe> {
        let layout = self.layout();
        let probe = |register: &PipelineRegister| Probe {
            scope: vec!["traverse".to_owned(), "setup".to_owned()],
            name: register.name.clone(),
            width: register.width,
            meaning: register.meaning,
            word: match register.word {
                Ok(word) => layout.setup_operation(register.stage, word),
                Err(port) => layout.setup_input(register.stage, port),
            },
            delay: 0,
            sources: Vec::new(),
        };
        self.setup.datapath.registers.iter().map(probe).collect()
    }

    /// The registers inside the step.
    fn step_registers(&self) -> Vec<Probe> {
        let layout = self.layout();
        let mut probes = Vec::new();
        for register in &self.step.registers {
            let word = match register.word {
                Ok(word) => layout.operation(word),
                Err(input) if input < layout.registers => CycleWords::INPUTS + input,
                // The height comes from outside; the golden model keeps no register of it.
                Err(_) => continue,
            };
            probes.push(Probe {
                scope: vec!["traverse".to_owned(), "step".to_owned()],
                name: register.name.clone(),
                width: register.width,
                meaning: register.meaning,
                word,
                delay: register.stage,
                sources: self.paths(&register.sources, register.cycles_back),
            });
        }
        probes
    }
}
