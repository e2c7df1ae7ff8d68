//! A slice of the proofs: the comparator at e7f16, adder, multiplier and divider at e4f3, and
//! faults that are refuted.

use campaigns::formal::{Counterexample, Proof, Prover, Unproven};
use hdl_gen::fault::plant;
use hdl_gen::operators::{FloatOperator, OperatorConfiguration};
use rtl_model::float::{FloatFormat, Rounding};

/// The tools, which continuous integration has; elsewhere their absence is said.
fn prover() -> Option<Prover> {
    match Prover::find(60) {
        Ok(prover) => Some(prover),
        Err(problem) if std::env::var_os("CI").is_none() => {
            eprintln!("left out: {problem}");
            None
        }
        Err(problem) => panic!("{problem}"),
    }
}

fn configuration(operator: FloatOperator, format: FloatFormat) -> OperatorConfiguration {
    OperatorConfiguration::new(operator, format, Rounding::NearestEven)
}

fn prove(prover: &Prover, configuration: OperatorConfiguration) -> Proof {
    let hardware = configuration.build(0);
    prover.prove(configuration, &hardware, &|_, _| {}).unwrap()
}

#[test]
fn the_comparator_is_proven_at_e7f16() {
    let Some(prover) = prover() else { return };
    let proof = prove(
        &prover,
        configuration(FloatOperator::Compare, FloatFormat::E7F16),
    );
    assert_eq!(proof.unproven, []);
    assert_eq!(proof.cases, 1);
    assert!(proof.gates > 1000);
}

#[test]
fn arithmetic_is_proven_at_e4f3() {
    let Some(prover) = prover() else { return };
    let operators = [
        FloatOperator::Add,
        FloatOperator::Multiply,
        FloatOperator::Divide,
    ];
    for operator in operators {
        let proof = prove(&prover, configuration(operator, FloatFormat::E4F3));
        assert_eq!(proof.unproven, [], "{operator:?}");
        assert_eq!(proof.cases, 1);
    }
}

/// Beyond eight bits a sum is proven case by case: that the cases cover all operands is one, then
/// those of infinities and NaNs, then two for each distance of the exponents.
#[test]
fn a_sum_is_proven_by_cases() {
    let Some(prover) = prover() else { return };
    let proof = prove(
        &prover,
        configuration(FloatOperator::Subtract, FloatFormat::new(3, 7)),
    );
    assert_eq!(proof.unproven, []);
    assert_eq!(proof.cases, 1 + 2 + 2 * 6);
}

fn refute(prover: &Prover, configuration: OperatorConfiguration, signal: &str) -> Counterexample {
    let hardware = plant(&configuration.build(0), signal, 0).unwrap();
    let proof = prover.prove(configuration, &hardware, &|_, _| {}).unwrap();
    match proof.unproven.into_iter().next() {
        Some(Unproven::Refuted(example)) => example,
        other => panic!("{signal}: {other:?}"),
    }
}

#[test]
fn a_fault_is_refuted_by_operands_on_which_it_shows() {
    let Some(prover) = prover() else { return };
    for format in [FloatFormat::E4F3, FloatFormat::new(3, 7)] {
        let adder = configuration(FloatOperator::Add, format);
        for signal in ["result", "effective_subtraction"] {
            let example = refute(&prover, adder, signal);
            let [(_, a), (_, b)] = example.operands[..] else {
                panic!("{example}");
            };
            let (_, hardware, plain) = example.results[0].clone();
            assert_ne!(hardware, plain, "{example}");
            // The third opinion: the golden model has what the specification has.
            assert_eq!(format.add(Rounding::NearestEven, a, b), plain, "{example}");
            assert_eq!(example.golden[0], plain, "{example}");
        }
    }
}
