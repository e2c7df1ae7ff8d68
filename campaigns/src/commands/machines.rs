//! `campaigns machines`

use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::bail;
use campaigns::machine_table::{MACHINES_TABLE, machines_lines};
use campaigns::machines::{
    Hardware, MachineCampaign, MachineChoice, MachineFrame, MachineRow, wrong_texels_are_few,
};
use campaigns::record::record_lines;
use campaigns::tier::Tier;
use clap::Args;
use hdl_gen::verify::Verilator;
use rtl_model::scene::FrameSize;

use super::frames::parse_screen;
use super::provenance;
use crate::progress::bar;

/// Options of the campaign.
#[derive(Args)]
#[command(
    after_help = "Tiers: quick has frames of 64 x 48 pixels; substantial 400 x 240; exhaustive \
                  800 x 480.\n\n\
                  Example:\n  campaigns machines --machine exact-block --map rocks --camera oblique \
                  --screen 800x480"
)]
pub struct Machines {
    /// How much is tried
    #[arg(long, value_enum, default_value_t = Tier::Quick)]
    tier: Tier,
    /// Only these machines: paper, exact-quad, exact-block
    #[arg(long, value_delimiter = ',', value_parser = parse_machine)]
    machine: Vec<MachineChoice>,
    /// Only these maps, such as rocks
    #[arg(long, value_delimiter = ',')]
    map: Vec<String>,
    /// Only these cameras: front, oblique, grazing
    #[arg(long, value_delimiter = ',')]
    camera: Vec<String>,
    /// Only with stalls of sender, receiver and memory (true), or only without (false)
    #[arg(long)]
    stalls: Option<bool>,
    /// Pixels of each frame, in place of the tier's
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_screen)]
    screen: Option<FrameSize>,
    /// Threads of the golden walks; 0 is one a core
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// The result as JSON on standard output
    #[arg(long)]
    json: bool,
    /// Put the result into this file's table
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
}

impl Machines {
    /// Runs it.
    pub fn run(self) -> anyhow::Result<bool> {
        let is_part = !(self.map.is_empty() && self.camera.is_empty());
        if self.record.is_some() && is_part {
            bail!(
                "machines: a line of the record is of all maps and cameras: leave --map and \
                   --camera, or --record, out"
            );
        }
        let machines = match self.machine.is_empty() {
            true => MachineChoice::ALL.to_vec(),
            false => self.machine.clone(),
        };
        let stalls = match self.stalls {
            Some(stalls) => vec![stalls],
            None => vec![false, true],
        };
        let size = |width, height| FrameSize { width, height };
        let of_tier = self.tier.of(size(64, 48), size(400, 240), size(800, 480));
        let screen = self.screen.unwrap_or(of_tier);
        let wanted = |map: &str, camera: &str| {
            let is_in = |names: &[String], name: &str| {
                names.is_empty() || names.iter().any(|own| own == name)
            };
            is_in(&self.map, map) && is_in(&self.camera, camera)
        };
        let frames = MachineFrame::load(Path::new("."), screen, wanted)?;
        if frames.is_empty() {
            bail!("machines: no map and camera is named so, or none sees the surface");
        }
        let verilator = Verilator::find()?;
        let campaign = MachineCampaign {
            hardware: Hardware::Verilator(&verilator),
            planted: None,
        };
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads)
            .build()?;
        let bar = bar(
            (frames.len() * machines.len() * stalls.len()) as u64,
            "frames",
        );
        let mut rows = Vec::new();
        for &machine in &machines {
            for &stalls in &stalls {
                let mut done = Vec::new();
                for frame in &frames {
                    let row = pool.install(|| campaign.run(machine, frame, stalls));
                    let row = row.inspect_err(|_| bar.finish_and_clear())?;
                    bar.suspend(|| self.show(&row))?;
                    bar.inc(1);
                    done.push(row);
                }
                if let Some(path) = &self.record {
                    let lines = machines_lines(&done, screen, &provenance(self.tier));
                    record_lines(path, &MACHINES_TABLE, vec![lines])?;
                }
                rows.extend(done);
            }
        }
        bar.finish_and_clear();
        if !wrong_texels_are_few(&rows) {
            eprintln!("machines: more texels are wrong than a 24-bit float's share of the rays");
        }
        let agreed = rows.iter().all(|row| row.agreed) && wrong_texels_are_few(&rows);
        if self.json {
            let summary = serde_json::json!({
                "schema": "stepwell-campaign-machines-1",
                "tier": self.tier.to_string(),
                "screen": format!("{}x{}", screen.width, screen.height),
                "agreed": agreed,
                "rows": rows,
            });
            let text = serde_json::to_string_pretty(&summary)?;
            writeln!(io::stdout().lock(), "{text}")?;
        }
        Ok(agreed)
    }

    fn show(&self, row: &MachineRow) -> anyhow::Result<()> {
        if self.json {
            return Ok(());
        }
        let mut output = io::stdout().lock();
        let shown = writeln!(output, "{}", row.line()).and_then(|()| {
            let first = row.first.iter();
            first
                .take(3)
                .try_for_each(|line| writeln!(output, "    {line}"))
        });
        match shown {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
            _ => Ok(()),
        }
    }
}

fn parse_machine(text: &str) -> Result<MachineChoice, String> {
    let known = MachineChoice::ALL
        .into_iter()
        .find(|one| one.name() == text);
    known.ok_or_else(|| {
        let names = MachineChoice::ALL.map(MachineChoice::name);
        format!("unknown machine `{text}`: there is {}", names.join(", "))
    })
}
