//! `campaigns small-worlds`

use anyhow::bail;
use campaigns::record::record_lines;
use campaigns::row::Row;
use campaigns::small_worlds::{FAMILY_TABLE, FamilyRow, MapSet, MethodOutcome, RaySet, World};
use clap::Args;
use rtl_model::float::FloatFormat;
use rtl_model::scene::{Method, WalkFormat};

use super::{Run, provenance};
use crate::progress::bar;

/// Options of the campaign.
#[derive(Args)]
#[command(
    after_help = "A difference is a ray that breaks what its format promises: exact and fixed point the very\n\
                  texel, floats never late and no guard, f64 no guard. The column `roundings` counts the rays\n\
                  that hit another texel: early, and of f64 late ones. A record has one line for each format and\n\
                  world, summed over all methods; --json has every method.\n\n\
                  Example:\n  campaigns small-worlds --tier quick --method oh --format e5f4"
)]
pub struct SmallWorlds {
    #[command(flatten)]
    run: Run,
    /// Only this traversal, such as oh; may be given several times
    #[arg(long)]
    method: Vec<Method>,
    /// Only this number format: eXfY, f64, exact, fixed or qI.F; may be given several times
    #[arg(long)]
    format: Vec<WalkFormat>,
    /// The seed of sampled maps
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl SmallWorlds {
    /// Runs it.
    pub fn run(self) -> anyhow::Result<bool> {
        let methods = self.methods();
        if self.run.record.is_some() && !self.method.is_empty() {
            bail!(
                "small-worlds: a line of the record sums over all methods: leave --method or --record out"
            );
        }
        let mut rows = Vec::new();
        for (format, worlds) in self.subjects()? {
            for world in worlds {
                let progress = bar(world.maps.count(), &format!("{format}, {}", world.name()));
                let count = &|done| progress.inc(done);
                let outcomes = self
                    .run
                    .in_threads(|| world.judge(format, &methods, count, &|_, _, hit| hit))??;
                progress.finish_and_clear();
                for outcome in outcomes
                    .iter()
                    .filter(|outcome| outcome.unsupported.is_none())
                {
                    let row = self.row(format, &world, outcome);
                    self.run.show(&row)?;
                    rows.push(row);
                }
                if let Some(path) = &self.run.record {
                    let provenance = provenance(self.run.tier);
                    let families = FamilyRow::of(format, &world, &outcomes);
                    let lines = families
                        .iter()
                        .map(|row| row.cells(self.seed, &provenance))
                        .collect();
                    record_lines(path, &FAMILY_TABLE, lines)?;
                }
                let unsupported = outcomes
                    .iter()
                    .find_map(|outcome| Some((outcome.method, outcome.unsupported?)));
                if let Some((method, why)) = unsupported
                    && outcomes.iter().all(|outcome| outcome.unsupported.is_some())
                {
                    bail!("{method} in {format}: {why}");
                }
            }
        }
        self.run.conclude("small-worlds", &rows)
    }

    fn methods(&self) -> Vec<Method> {
        if !self.method.is_empty() {
            return self.method.clone();
        }
        let levels = [1, 3, 4].map(Method::MultiLevelDown);
        let all = Method::ALL.into_iter().chain(levels);
        let all = all.chain(Method::FIXED_ONLY);
        all.filter(|method| method.is_safe()).collect()
    }

    /// Formats with the worlds they are tried in.
    fn subjects(&self) -> anyhow::Result<Vec<(WalkFormat, Vec<World>)>> {
        let tier = self.run.tier;
        let entry_bits = tier.of(2, 2, 4);
        let grid = |maps| World {
            maps,
            rays: RaySet::FourBits { entry_bits },
        };
        let sample = |count, log2_size| MapSet::sample(count, self.seed, log2_size);
        let every = tier.of(MapSet::every(37, 1), MapSet::all(1), MapSet::all(1));
        let on_grid = |larger| {
            vec![
                grid(MapSet::all(0)),
                grid(every),
                grid(sample(larger, 2)),
                grid(sample(larger / 4, 3)),
            ]
        };
        let larger = tier.of(40, 2_000, 20_000);
        // Rationals take their time.
        let of_exact = vec![
            grid(MapSet::all(0)),
            grid(tier.of(MapSet::every(409, 1), MapSet::every(16, 1), MapSet::all(1))),
            grid(sample(tier.of(4, 100, 2_000), 2)),
        ];
        let small = FloatFormat::new(4, 2);
        let all_of_small = |maps| World {
            maps,
            rays: RaySet::AllOf(small),
        };
        let of_small = vec![
            all_of_small(tier.of(MapSet::every(8, 0), MapSet::all(0), MapSet::all(0))),
            all_of_small(tier.of(sample(1, 1), sample(4, 1), MapSet::all(1))),
        ];
        let fixed_point = |maps| World {
            maps,
            rays: RaySet::FixedPoint,
        };
        let of_fixed_point = vec![
            fixed_point(MapSet::all(0)),
            fixed_point(tier.of(MapSet::every(97, 1), MapSet::all(1), MapSet::all(1))),
            fixed_point(sample(tier.of(8, 400, 4_000), 2)),
        ];
        let mut subjects = Vec::new();
        let formats = match self.format.as_slice() {
            [] => ["e4f2", "e5f4", "e7f16", "f64", "fixed", "q4.10", "exact"]
                .iter()
                .map(|name| name.parse())
                .collect::<Result<Vec<_>, _>>()?,
            own => own.to_vec(),
        };
        for format in formats {
            let worlds = match format {
                WalkFormat::Float(own) if own == small => of_small.clone(),
                WalkFormat::Fixed(Some(_)) => of_fixed_point.clone(),
                WalkFormat::Exact => of_exact.clone(),
                _ => on_grid(larger),
            };
            subjects.push((format, worlds));
        }
        Ok(subjects)
    }

    fn row(&self, format: WalkFormat, world: &World, outcome: &MethodOutcome) -> Row {
        let verdict = &outcome.verdict;
        let mut remarks = Vec::new();
        for (count, word) in [
            (verdict.early, "early"),
            (verdict.late, "late"),
            (verdict.guards, "guards"),
            (outcome.refused, "refused"),
        ] {
            if count > 0 {
                remarks.push(format!("{count} {word}"));
            }
        }
        let is_seeded = !world.maps.is_complete();
        Row {
            campaign: "small-worlds",
            operator: outcome.method.to_string(),
            format: format.to_string(),
            policy: world.name(),
            roundings: if remarks.is_empty() {
                "-".to_owned()
            } else {
                remarks.join(", ")
            },
            judge: format!("exact hit, {}", outcome.promise.name()),
            cases: verdict.rays,
            exhaustive: world.maps.is_complete(),
            differences: outcome.defects,
            seconds: outcome.duration.as_secs_f64(),
            seed: is_seeded.then_some(self.seed),
            first: outcome.first.clone(),
        }
    }
}
