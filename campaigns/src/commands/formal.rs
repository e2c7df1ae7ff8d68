//! `campaigns formal`

use std::time::Instant;

use campaigns::formal::{Prover, Unproven};
use campaigns::row::Row;
use campaigns::tier::Tier;
use clap::Args;
use hdl_gen::fault::plant;
use hdl_gen::operators::{FloatOperator, OperatorConfiguration};
use rtl_model::float::{FloatFormat, Policy, Rounding};

use super::{Common, names_of};
use crate::progress::bar;

/// Options of the campaign.
#[derive(Args)]
#[command(
    after_help = "A case is one question to the solver; together they cover all operands.\n\n\
                  Example:\n  campaigns formal --operator float_add --format e7f16 --rounding rne"
)]
pub struct Formal {
    #[command(flatten)]
    common: Common,
    /// Seconds allowed for a case
    #[arg(long, default_value_t = 600)]
    seconds: u64,
    /// Invert a bit of a signal of the hardware, to see that it is refuted
    #[arg(long, value_name = "SIGNAL:BIT")]
    plant_fault: Option<String>,
}

/// What is proven under every rounding, and from which tier on.
fn subjects() -> Vec<(Tier, OperatorConfiguration)> {
    use FloatOperator::{
        Add, Compare, CompareSignalling, Convert, Divide, Floor, FromInteger, FromSigned,
        FromUnsigned, Multiply, RoundToIntegral, SquareRoot, Subtract, ToInteger, ToUnsigned,
    };
    let to_integer = ToInteger { bits: 24 };
    let from_integer = FromInteger {
        value_bits: 24,
        exponent_bits: 8,
    };
    let mut subjects = Vec::new();
    let mut add = |tier: Tier, operator: FloatOperator, format: FloatFormat| {
        let plain = OperatorConfiguration::new(operator, format, Rounding::NearestEven);
        subjects.push((tier, plain));
        // Everything else that its hardware can do; of the wide adders that takes hours.
        let many_cases = matches!(operator, Add | Subtract) && format.width() > 10;
        let tier = match many_cases {
            true => Tier::Exhaustive,
            false => tier.max(Tier::Substantial),
        };
        let full = plain.with_policy(Policy::Full);
        for other in [plain.with_flags(), full, full.with_flags()] {
            if other.check().is_ok() {
                subjects.push((tier, other));
            }
        }
    };
    let fp24 = FloatFormat::E7F16;
    add(Tier::Quick, Compare, fp24);
    let half = FloatFormat::new(5, 10);
    for operator in [
        CompareSignalling,
        Floor,
        RoundToIntegral,
        to_integer,
        ToUnsigned { bits: 24 },
        from_integer,
        FromSigned { bits: 24 },
        FromUnsigned { bits: 24 },
        Convert { target: half },
        Add,
        Subtract,
    ] {
        add(Tier::Substantial, operator, fp24);
    }
    for operator in [Add, Multiply, Divide, SquareRoot] {
        add(Tier::Quick, operator, FloatFormat::E4F3);
        add(Tier::Substantial, operator, FloatFormat::new(3, 4));
        add(Tier::Substantial, operator, FloatFormat::new(5, 2));
    }
    // As wide as it goes.
    for operator in [Multiply, Divide, SquareRoot] {
        add(Tier::Substantial, operator, FloatFormat::new(5, 5));
        add(Tier::Exhaustive, operator, FloatFormat::new(5, 7));
    }
    add(Tier::Exhaustive, Multiply, fp24);
    subjects
}

impl Formal {
    /// Runs it.
    pub fn run(self) -> anyhow::Result<bool> {
        let prover = Prover::find(self.seconds)?;
        let judge = format!("{} + {}", prover.yosys.version, prover.solver.version);
        let mut rows = Vec::new();
        for (tier, configuration) in subjects() {
            let wanted = tier <= self.common.run.tier
                && self.common.wants_operator(configuration.operator.name())
                && self.common.wants_format(configuration.format)
                && self.common.wants_policy(configuration.policy);
            if !wanted {
                continue;
            }
            let row = self.row(&prover, &judge, configuration)?;
            self.common.run.finish(&row)?;
            rows.push(row);
        }
        self.common.run.conclude("formal", &rows)
    }

    fn row(
        &self,
        prover: &Prover,
        judge: &str,
        subject: OperatorConfiguration,
    ) -> anyhow::Result<Row> {
        let rounds = subject.operator.rounds();
        let roundings = match rounds {
            true => self.common.roundings(),
            false => vec![subject.rounding],
        };
        let begin = Instant::now();
        let (mut cases, mut differences, mut first) = (0, 0, Vec::new());
        for &rounding in &roundings {
            let configuration = OperatorConfiguration {
                rounding,
                ..subject
            };
            let mut hardware = configuration.build(0);
            if let Some(fault) = &self.plant_fault {
                let (signal, bit) = fault.rsplit_once(':').unwrap_or((fault, "0"));
                hardware = plant(&hardware, signal, bit.parse()?)?;
            }
            let progress = bar(1, &configuration.name());
            let proof = self.common.run.in_threads(|| {
                prover.prove(configuration, &hardware, &|done, total| {
                    progress.set_length(total);
                    progress.inc(done);
                })
            })??;
            progress.finish_and_clear();
            cases += proof.cases;
            differences += proof.unproven.len() as u64;
            let shown = proof
                .unproven
                .iter()
                .take(4)
                .map(|unproven| match unproven {
                    Unproven::Refuted(example) => format!("{}: refuted, {example}", hardware.name),
                    Unproven::Undecided(case) => {
                        format!(
                            "{}: not decided in {} s: {case}",
                            hardware.name, self.seconds
                        )
                    }
                });
            first.extend(shown);
        }
        Ok(Row {
            campaign: "formal",
            operator: subject.operator.name().to_owned(),
            format: subject.format.to_string(),
            policy: match subject.has_flags {
                true => format!("{}, flags", subject.policy),
                false => subject.policy.to_string(),
            },
            roundings: match rounds {
                true => names_of(&roundings),
                false => "-".to_owned(),
            },
            judge: judge.to_owned(),
            cases,
            exhaustive: true,
            differences,
            seconds: begin.elapsed().as_secs_f64(),
            seed: None,
            first,
        })
    }
}
