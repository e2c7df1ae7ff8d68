//! `campaigns routes`

use anyhow::bail;
use campaigns::routes::{OPERATIONS, compare};
use campaigns::row::Row;
use campaigns::sweep::Outcome;
use clap::Args;
use rtl_model::float::{FloatFormat, Operation, Policy};

use super::{Common, names_of};
use crate::progress::bar;

/// Options of the campaign.
#[derive(Args)]
#[command(
    after_help = "Formats of at most ten bits, and operations of one operand, are tried in full.\n\n\
                  Example:\n  campaigns routes --tier substantial --seed 1 --operator div"
)]
pub struct Routes {
    #[command(flatten)]
    common: Common,
    /// The seed of the operands
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Cases an operator and rounding, in place of the tier's
    #[arg(long)]
    cases: Option<u64>,
}

impl Routes {
    /// Runs it.
    pub fn run(self) -> anyhow::Result<bool> {
        let formats = match self.common.format.as_slice() {
            [] => vec![
                FloatFormat::E4F3,
                FloatFormat::new(3, 4),
                FloatFormat::new(5, 2),
                FloatFormat::new(4, 5),
                FloatFormat::E7F16,
            ],
            own => own.to_vec(),
        };
        let mut rows = Vec::new();
        for format in formats {
            for policy in Policy::ALL {
                for operation in OPERATIONS {
                    let wanted = self.common.wants_policy(policy)
                        && self.common.wants_operator(&operation.to_string());
                    if wanted {
                        let row = self.row(format, policy, operation)?;
                        self.common.run.finish(&row)?;
                        rows.push(row);
                    }
                }
            }
        }
        self.common.run.conclude("routes", &rows)
    }

    fn row(
        &self,
        format: FloatFormat,
        policy: Policy,
        operation: Operation,
    ) -> anyhow::Result<Row> {
        let roundings = self.common.roundings();
        // Small formats are tried in full in every tier.
        let least = if format.width() <= 10 { 1 << 20 } else { 0 };
        // Four roundings: two hundred million pairs an operator.
        let tier = self.common.run.tier.of(500_000, 50_000_000, 500_000_000);
        let cases = self.cases.unwrap_or(tier.max(least));
        let progress = bar(
            cases * roundings.len() as u64,
            &format!("{operation} {format} {policy}"),
        );
        let mut outcome = Outcome::default();
        let mut exhaustive = true;
        let mut first = Vec::new();
        for &rounding in &roundings {
            let arithmetic = format.arithmetic(policy, rounding);
            let run = self.common.run.in_threads(|| {
                let count = &|done| progress.inc(done);
                compare(
                    arithmetic,
                    operation,
                    cases,
                    self.seed,
                    count,
                    |answer, _| answer,
                )
            })?;
            let Some((own, all)) = run else {
                bail!("{format} has more than 25 significant bits: f64 is no second route");
            };
            exhaustive &= all;
            first.extend(own.first.iter().map(|difference| {
                format!(
                    "{operation} {format} {policy} {rounding} case {} of seed {}: operands {:x?}: \
                     integers {:x?}, f64 {:x?}; keep it as a line of campaigns/named_cases.txt",
                    difference.index,
                    self.seed,
                    difference.operands,
                    difference.golden,
                    difference.other
                )
            }));
            outcome = outcome.and(own);
        }
        progress.finish_and_clear();
        Ok(Row {
            campaign: "routes",
            operator: operation.to_string(),
            format: format.to_string(),
            policy: policy.to_string(),
            roundings: names_of(&roundings),
            judge: "f64, rounded once".to_owned(),
            cases: outcome.cases,
            exhaustive,
            differences: outcome.differences,
            seconds: outcome.duration.as_secs_f64(),
            seed: (!exhaustive).then_some(self.seed),
            first,
        })
    }
}
