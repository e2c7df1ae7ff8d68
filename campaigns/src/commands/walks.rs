//! `campaigns walks`

use std::io::{self, ErrorKind, Write};
use std::path::Path;

use anyhow::{Context, bail};
use campaigns::row::Row;
use campaigns::walks::{
    Departure, RaySource, Variant, WalkScene, compare, departures, height_maps,
};
use clap::Args;
use rtl_model::scene::Method;

use super::Run;
use crate::progress::bar;

/// Options of the campaign.
#[derive(Args)]
#[command(
    after_help = "A case is a ray: walked by oh and, in turn, by one of the other exact methods \
                  (--method names some of them). The table's column of roundings says what \
                  share of the cameras' rays has another texel than before it was quantised.\n\n\
                  Example:\n  campaigns walks --tier substantial --seed 1 --record docs/campaigns.md"
)]
pub struct Walks {
    #[command(flatten)]
    run: Run,
    /// Beside oh, only this exact method; may be given several times
    #[arg(long)]
    method: Vec<Method>,
    /// The seed of the rays
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Rays in all, in place of the tier's
    #[arg(long)]
    rays: Option<u64>,
}

/// The most of a map's own rays whose texel quantising may change, with slopes of 20 fraction bits.
const MOST_DEPARTURES: f64 = 0.0003;

/// One in so many rays is looked at for that.
const DEPARTURE_SHARE: u64 = 64;

impl Walks {
    /// Runs it.
    pub fn run(self) -> anyhow::Result<bool> {
        let methods: Vec<Method> = match self.method.as_slice() {
            [] => Method::ALL
                .into_iter()
                .chain(Method::FIXED_ONLY)
                .filter(|method| method.is_safe())
                .collect(),
            own => own.to_vec(),
        };
        if let Some(method) = methods.iter().find(|method| !method.is_safe()) {
            bail!("--method {method}: it samples, and promises no exact hit; take another");
        }
        let tier = self.run.tier.of(200_000, 100_000_000, 2_000_000_000);
        let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let (maps, are_real) = height_maps(&workspace)?;
        if !are_real {
            eprintln!("walks: the real height maps are not here; two recipes stand in for them");
        }
        let each = self
            .rays
            .unwrap_or(tier)
            .div_ceil((maps.len() * Variant::ALL.len()) as u64);
        let mut rows = Vec::new();
        for variant in Variant::ALL {
            let mut departed = Departure::default();
            let mut row: Option<Row> = None;
            for (map, surface) in &maps {
                let scene = WalkScene::new(map, *surface, variant)?;
                let rays = RaySource::new(&scene, self.seed);
                let progress = bar(
                    each + each / DEPARTURE_SHARE,
                    &format!("{}, {variant}", map.name()),
                );
                let count = &|done| progress.inc(done);
                let (outcome, departure) = self.run.in_threads(|| {
                    let outcome = compare(&scene, &rays, &methods, each, count, |hit, _| hit);
                    let departure = departures(&scene, &rays, each / DEPARTURE_SHARE, count);
                    (outcome, departure)
                })?;
                progress.finish_and_clear();
                departed.rays += departure.rays;
                departed.texels += departure.texels;
                let own = Row {
                    campaign: "walks",
                    operator: "exact methods".to_owned(),
                    format: rays.format().slope.to_string(),
                    policy: variant.to_string(),
                    roundings: String::new(),
                    judge: "texel by texel".to_owned(),
                    cases: outcome.cases,
                    exhaustive: false,
                    differences: outcome.differences,
                    seconds: outcome.duration.as_secs_f64(),
                    seed: Some(self.seed),
                    first: outcome
                        .first
                        .iter()
                        .map(|difference| {
                            let method = match difference.operands[4] {
                                u64::MAX => Method::Oh,
                                place => methods[place as usize],
                            };
                            let ray: Vec<i64> =
                                difference.operands[..4].iter().map(|&n| n as i64).collect();
                            format!(
                                "{method} {} ray {} of seed {}: u, v, du, dv {ray:?} in {}: i, j, \
                                 side, depth above and below the line {:?}, texel by texel {:?}",
                                scene.map.name(),
                                difference.index,
                                self.seed,
                                rays.format(),
                                difference.golden,
                                difference.other
                            )
                        })
                        .collect(),
                };
                row = Some(match row {
                    None => own,
                    Some(sum) => joined(sum, own),
                });
            }
            if let Some(mut row) = row {
                row.roundings = format!("{:.4} % depart", 100.0 * departed.share());
                let is_too_much = variant == Variant::Own && departed.share() > MOST_DEPARTURES;
                if is_too_much {
                    row.differences += departed.texels;
                    row.first.push(format!(
                        "quantising changes the texel of {} of {} rays of the cameras, more than \
                         {:.2} %",
                        departed.texels,
                        departed.rays,
                        100.0 * MOST_DEPARTURES
                    ));
                }
                self.run.finish(&row)?;
                self.tell(variant, &departed)?;
                rows.push(row);
            }
        }
        self.run.conclude("walks", &rows)
    }

    /// Says how often quantising changes a texel.
    fn tell(&self, variant: Variant, departed: &Departure) -> anyhow::Result<()> {
        if self.run.json {
            return Ok(());
        }
        let told = writeln!(
            io::stdout().lock(),
            "    {variant}: quantising changes the texel of {} of {} rays of the cameras ({:.4} %)",
            departed.texels,
            departed.rays,
            100.0 * departed.share()
        );
        match told {
            Err(problem) if problem.kind() != ErrorKind::BrokenPipe => {
                Err(problem).context("standard output: cannot be written")
            }
            _ => Ok(()),
        }
    }
}

/// Two maps' rows as one.
fn joined(mut sum: Row, other: Row) -> Row {
    sum.cases += other.cases;
    sum.differences += other.differences;
    sum.seconds += other.seconds;
    sum.first.extend(other.first);
    sum.first.truncate(campaigns::sweep::SHOWN);
    sum
}
