//! `campaigns hardware`

use anyhow::bail;
use campaigns::hardware::Gallery;
use campaigns::row::Row;
use clap::Args;
use hdl_gen::fault::plant;
use hdl_gen::operators::{FloatOperator, OperatorConfiguration};
use hdl_gen::verify::Verilator;
use rtl_model::float::{FloatFormat, Policy, Rounding};

use super::{Common, names_of};
use crate::progress::bar;

/// Options of the campaign.
#[derive(Args)]
#[command(
    after_help = "A case is one operand set in one rounding; each rounding gets all sets. Operands \
                  of at most 24 bits together are tried in full.\n\n\
                  Example:\n  campaigns hardware --operator float_add --tier substantial --seed 1"
)]
pub struct Hardware {
    #[command(flatten)]
    common: Common,
    /// The seed of the operands
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Operand sets an operator, in place of the tier's
    #[arg(long)]
    cases: Option<u64>,
    /// Cycles of every operator
    #[arg(long, default_value_t = 2)]
    latency: u32,
    /// Invert a bit of a signal of the design, to see that it is caught
    #[arg(long, value_name = "SIGNAL:BIT")]
    plant_fault: Option<String>,
}

/// The operators; widths that are a parameter are those of the format's own words.
fn operators(format: FloatFormat) -> Vec<FloatOperator> {
    let bits = format.width();
    vec![
        FloatOperator::Add,
        FloatOperator::Subtract,
        FloatOperator::Multiply,
        FloatOperator::Divide,
        FloatOperator::SquareRoot,
        FloatOperator::Minimum,
        FloatOperator::Maximum,
        FloatOperator::Compare,
        FloatOperator::CompareSignalling,
        FloatOperator::LessThan,
        FloatOperator::LessEqual,
        FloatOperator::FromInteger {
            value_bits: bits,
            exponent_bits: 8,
        },
        FloatOperator::FromSigned { bits },
        FloatOperator::FromUnsigned { bits },
        FloatOperator::ToInteger { bits },
        FloatOperator::ToUnsigned { bits },
        FloatOperator::Convert {
            target: FloatFormat::new(5, 10),
        },
        FloatOperator::RoundToIntegral,
        FloatOperator::Floor,
        FloatOperator::UlpsUp { ulps: 3 },
        FloatOperator::ExactBelow,
        FloatOperator::DepthFromHeight { bits: 16 },
    ]
}

impl Hardware {
    /// Runs it.
    pub fn run(self) -> anyhow::Result<bool> {
        if self.latency == 0 {
            bail!("--latency 0: a stream needs at least one register");
        }
        let verilator = Verilator::find()?;
        let formats = match self.common.format.as_slice() {
            [] => vec![FloatFormat::E4F3, FloatFormat::E7F16],
            own => own.to_vec(),
        };
        let mut rows = Vec::new();
        for format in formats {
            for operator in operators(format) {
                if !self.common.wants_operator(operator.name()) {
                    continue;
                }
                let plain = OperatorConfiguration::new(operator, format, Rounding::NearestEven);
                for subject in [plain, plain.with_policy(Policy::Full).with_flags()] {
                    if !self.common.wants_policy(subject.policy) || subject.check().is_err() {
                        continue;
                    }
                    let row = self.row(&verilator, subject)?;
                    self.common.run.finish(&row)?;
                    rows.push(row);
                }
            }
        }
        self.common.run.conclude("hardware", &rows)
    }

    fn row(&self, verilator: &Verilator, subject: OperatorConfiguration) -> anyhow::Result<Row> {
        let rounds = subject.operator.rounds();
        let roundings = match rounds {
            true => self.common.roundings(),
            false => vec![subject.rounding],
        };
        let of = |&rounding: &Rounding| OperatorConfiguration {
            rounding,
            ..subject
        };
        let tier = self.common.run.tier;
        let count = self
            .cases
            .unwrap_or(tier.of(100_000, 100_000_000, 1_000_000_000));
        let configurations = roundings.iter().map(of).collect();
        let gallery = Gallery::new(configurations, self.latency, count, self.seed);
        let mut unit = gallery.unit.clone();
        if let Some(fault) = &self.plant_fault {
            let (signal, bit) = fault.rsplit_once(':').unwrap_or((fault, "0"));
            unit = plant(&unit, signal, bit.parse()?)?;
        }
        let progress = bar(gallery.count(), &subject.name());
        let outcome = gallery.run(&unit, verilator, &|done| progress.set_position(done))?;
        progress.finish_and_clear();
        let first = outcome.first.iter().map(|difference| {
            format!(
                "set {} of seed {}: operands {:x?}: golden {:x?}, hardware {:x?}",
                difference.index,
                self.seed,
                difference.operands,
                difference.golden,
                difference.other
            )
        });
        Ok(Row {
            campaign: "hardware",
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
            judge: format!("{}, latency {}", short(&verilator.version), self.latency),
            cases: outcome.cases,
            exhaustive: gallery.is_exhaustive(),
            differences: outcome.differences,
            seconds: outcome.duration.as_secs_f64(),
            seed: (!gallery.is_exhaustive()).then_some(self.seed),
            first: first.collect(),
        })
    }
}

/// Name and number of a simulator.
fn short(version: &str) -> String {
    let words: Vec<&str> = version.split_whitespace().take(2).collect();
    words.join(" ")
}
