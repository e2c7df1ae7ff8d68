//! `campaigns frames`

use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use campaigns::frame_table::{
    FRAMES_TABLE, STEPS_TABLE, frames_line, recorded_methods, steps_line,
};
use campaigns::frames::{FrameRow, FrameRun, Variant};
use campaigns::record::record_lines;
use campaigns::tier::Tier;
use clap::Args;
use rtl_model::scene::{FrameSize, Method, WalkFormat};

use super::provenance;
use crate::progress::bar;

/// Options of the campaign.
#[derive(Args)]
#[command(
    after_help = "Tiers: quick has frames of 64 x 48 pixels; substantial 1024 x 768 on the maps' own \
                  sizes and 256 x 192 on larger ones, whose rays pass over thousands of texels; \
                  exhaustive 1024 x 768 of all.\n\n\
                  Example:\n  campaigns frames --variant own --method oh,block --format e7f16"
)]
pub struct Frames {
    /// How much is tried
    #[arg(long, value_enum, default_value_t = Tier::Quick)]
    tier: Tier,
    /// Only these methods, such as oh; all that promise not to miss unless told
    #[arg(long, value_delimiter = ',')]
    method: Vec<Method>,
    /// Only these formats; f64, exact and e7f16 unless told
    #[arg(long, value_delimiter = ',')]
    format: Vec<WalkFormat>,
    /// Only these variants of the maps: own, tiled:1024, tiled:4096, enlarged:1024, enlarged:4096
    #[arg(long, value_delimiter = ',')]
    variant: Vec<Variant>,
    /// Pixels of each frame, in place of the tier's
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_screen)]
    screen: Option<FrameSize>,
    /// Threads; 0 is one a core
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// The result as JSON on standard output
    #[arg(long)]
    json: bool,
    /// Put the result into this file's table
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
}

impl Frames {
    /// Runs it.
    pub fn run(self) -> anyhow::Result<bool> {
        let methods: Vec<Method> = match self.method.is_empty() {
            true => recorded_methods(),
            false => self.method.clone(),
        };
        if self.record.is_some() && !self.method.is_empty() {
            bail!("frames: a line of the record is of all methods: leave --method or --record out");
        }
        let formats = match self.format.is_empty() {
            true => ["f64", "exact", "e7f16"]
                .map(|name| name.parse().expect("a format"))
                .to_vec(),
            false => self.format.clone(),
        };
        let variants = match self.variant.is_empty() {
            true => Variant::ALL.to_vec(),
            false => self.variant.clone(),
        };
        let runs: Vec<FrameRun> = variants
            .iter()
            .flat_map(|&variant| formats.iter().map(move |&format| (variant, format)))
            .map(|(variant, format)| FrameRun {
                variant,
                format,
                methods: methods.clone(),
                screen: self.screen_of(variant),
            })
            .collect();
        let bar = bar(runs.iter().map(FrameRun::frames).sum(), "frames");
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads)
            .build()
            .context("no threads")?;
        let workspace = Path::new(".");
        let mut rows = Vec::new();
        for run in &runs {
            let done = pool.install(|| run.walk(workspace, &|| bar.inc(1)));
            let done = done.inspect_err(|_| bar.finish_and_clear())?;
            // Shown and recorded at once: a campaign that is stopped keeps what it has found.
            for row in &done {
                bar.suspend(|| self.show(row))?;
            }
            if let Some(path) = &self.record {
                let provenance = provenance(self.tier);
                record_lines(path, &FRAMES_TABLE, vec![frames_line(&done, &provenance)])?;
                record_lines(path, &STEPS_TABLE, vec![steps_line(&done)])?;
            }
            rows.extend(done);
        }
        bar.finish_and_clear();
        if rows.iter().all(|row| row.rays == 0) {
            bail!("frames: no pixel has a ray; take a larger --screen");
        }
        if self.json {
            let summary = serde_json::json!({
                "schema": "stepwell-campaign-frames-1",
                "tier": self.tier.to_string(),
                "agreed": rows.iter().all(|row| row.agreed),
                "rows": rows,
            });
            let text = serde_json::to_string_pretty(&summary)?;
            writeln!(io::stdout().lock(), "{text}")?;
        }
        Ok(rows.iter().all(|row| row.agreed))
    }

    fn screen_of(&self, variant: Variant) -> FrameSize {
        let size = |width, height| FrameSize { width, height };
        let large = match variant {
            Variant::Own => size(1024, 768),
            Variant::Tiled(_) | Variant::Enlarged(_) => size(256, 192),
        };
        let of_tier = self.tier.of(size(64, 48), large, size(1024, 768));
        self.screen.unwrap_or(of_tier)
    }

    fn show(&self, row: &FrameRow) -> anyhow::Result<()> {
        if self.json {
            return Ok(());
        }
        match writeln!(io::stdout().lock(), "{}", row.line()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
            _ => Ok(()),
        }
    }
}

pub(super) fn parse_screen(text: &str) -> Result<FrameSize, String> {
    let side = |text: &str| text.parse().ok().filter(|side| (1..=8192).contains(side));
    text.split_once('x')
        .and_then(|(width, height)| {
            Some(FrameSize {
                width: side(width)?,
                height: side(height)?,
            })
        })
        .ok_or_else(|| format!("`{text}` is not a size: WIDTHxHEIGHT, such as 256x192"))
}
