//! `campaigns softfloat`

use clap::Args;

use super::Common;

/// Options of the campaign.
#[derive(Args)]
#[command(
    after_help = "The judge is SoftFloat's own format at e5f10 and e8f23 (policy full), its 64-bit floats rounded once \
                  at e8f7 and e7f16.\n\nExample:\n  campaigns softfloat --tier substantial --seed 1 --record docs/campaigns.md"
)]
pub struct Softfloat {
    #[command(flatten)]
    common: Common,
    /// The seed of the operands
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Cases an operator and rounding, in place of the tier's
    #[arg(long)]
    cases: Option<u64>,
}

#[cfg(not(all(target_arch = "x86_64", target_os = "linux")))]
impl Softfloat {
    pub fn run(self) -> anyhow::Result<bool> {
        anyhow::bail!("softfloat: the crate that compiles SoftFloat knows Linux on x86-64 only")
    }
}

#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
mod supported {
    use anyhow::anyhow;
    use campaigns::cases::named_cases;
    use campaigns::formats::{BFLOAT16, DOUBLE, HALF, SINGLE};
    use campaigns::row::Row;
    use campaigns::softfloat::{Judge, compare, judged_operations};
    use campaigns::sweep::Outcome;
    use rtl_model::float::{FloatFormat, Operation, Policy, Rounding};

    use super::Softfloat;
    use crate::commands::names_of;
    use crate::progress::bar;

    /// What is judged: formats, policies, and the formats that each is converted to.
    fn subjects() -> [(FloatFormat, Policy, Vec<FloatFormat>); 5] {
        let fp24 = FloatFormat::E7F16;
        [
            (HALF, Policy::Full, vec![SINGLE, DOUBLE]),
            (BFLOAT16, Policy::Full, vec![HALF, SINGLE]),
            (SINGLE, Policy::Full, vec![HALF, DOUBLE]),
            (fp24, Policy::Full, vec![HALF, SINGLE]),
            (fp24, Policy::Flush, vec![HALF, SINGLE]),
        ]
    }

    impl Softfloat {
        /// Runs it.
        pub fn run(self) -> anyhow::Result<bool> {
            for case in named_cases().map_err(|problem| anyhow!(problem))? {
                let golden = case.operation.evaluate(case.arithmetic, case.operands);
                let judge = Judge::new(case.arithmetic).answer(case.operation, case.operands);
                if golden != case.answer || judge != case.answer {
                    println!(
                        "named case {}: golden {golden:?}, judge {judge:?}, kept {:?}",
                        case.name, case.answer
                    );
                    return Ok(false);
                }
            }
            let mut rows = Vec::new();
            for (format, policy, targets) in subjects() {
                for operation in judged_operations(&targets) {
                    let wanted = self.common.wants_format(format)
                        && self.common.wants_policy(policy)
                        && self.common.wants_operator(&operation.to_string());
                    if !wanted {
                        continue;
                    }
                    let row = self.row(format, policy, operation)?;
                    self.common.run.finish(&row)?;
                    rows.push(row);
                }
            }
            self.common.run.conclude("softfloat", &rows)
        }

        fn row(
            &self,
            format: FloatFormat,
            policy: Policy,
            operation: Operation,
        ) -> anyhow::Result<Row> {
            // The formats that the project promises a hundred million cases for are SoftFloat's own.
            let native = Judge::new(format.arithmetic(policy, Rounding::NearestEven)).is_native();
            let substantial = if native { 100_000_000 } else { 20_000_000 };
            let cases =
                self.cases
                    .unwrap_or(self.common.run.tier.of(100_000, substantial, 1_000_000_000));
            let roundings = match operation.rounds() {
                true => self.common.roundings(),
                false => vec![Rounding::NearestEven],
            };
            let name = format!("{operation} {format}");
            let progress = bar(cases * roundings.len() as u64, &name);
            let mut outcome = Outcome::default();
            let mut exhaustive = true;
            let mut first = Vec::new();
            for &rounding in &roundings {
                let arithmetic = format.arithmetic(policy, rounding);
                let (own, all) = self.common.run.in_threads(|| {
                    compare(arithmetic, operation, cases, self.seed, &|done| {
                        progress.inc(done)
                    })
                })?;
                exhaustive &= all;
                first.extend(own.first.iter().map(|difference| {
                    format!(
                        "{operation} {format} {policy} {rounding} case {} of seed {}: operands {:x?}: golden {:x?}, SoftFloat {:x?} (result, flags); \
                         keep it as a line of campaigns/named_cases.txt",
                        difference.index, self.seed, difference.operands, difference.golden, difference.other
                    )
                }));
                outcome = outcome.and(own);
            }
            progress.finish_and_clear();
            let judge = Judge::new(format.arithmetic(policy, Rounding::NearestEven));
            Ok(Row {
                campaign: "softfloat",
                operator: operation.to_string(),
                format: format.to_string(),
                policy: policy.to_string(),
                roundings: match operation.rounds() {
                    true => names_of(&roundings),
                    false => "-".to_owned(),
                },
                judge: judge.name().to_owned(),
                cases: outcome.cases,
                exhaustive,
                differences: outcome.differences,
                seconds: 0.0,
                seed: (!exhaustive).then_some(self.seed),
                first,
            }
            .timed(outcome.duration))
        }
    }
}
