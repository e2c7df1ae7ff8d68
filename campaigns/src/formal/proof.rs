//! The proof of one operator: its parts, their cases, and what a solver says of each.

use std::fmt;
use std::sync::Arc;

use hdl_gen::netlist::Module;
use hdl_gen::operators::{FloatOperator, OperatorConfiguration};
use rayon::prelude::*;
use thiserror::Error;

use super::graph::Graph;
use super::miter::{self, DIFFERS, Specification};
use super::solver::{Solver, SolverError, Verdict};
use super::yosys::{Yosys, YosysError};

/// Why an operator was neither proven nor refuted.
#[derive(Debug, Error)]
pub enum ProofError {
    /// There is nothing to hold it against.
    #[error("{0} has no plain specification")]
    NoSpecification(String),
    /// The specification does not have a result of the hardware's.
    #[error("the plain specification of {operator} has no {port}")]
    NoSuchResult {
        /// The operator.
        operator: String,
        /// The hardware's output.
        port: String,
    },
    /// No gates.
    #[error(transparent)]
    Yosys(#[from] YosysError),
    /// No answer.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// The solver's operands do not differ: it, or the reading of its answer, is wrong.
    #[error("the solver's counter-example to {0} is none")]
    NotACounterexample(String),
}

/// Operands on which hardware and specification differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counterexample {
    /// The case it was found in.
    pub case: String,
    /// The operands, in the order of the hardware's ports.
    pub operands: Vec<(String, u64)>,
    /// Results: port, what the hardware gives, what the specification has.
    pub results: Vec<(String, u64, u64)>,
    /// What the golden model has, in the order of the results.
    pub golden: Vec<u64>,
}

impl fmt::Display for Counterexample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.case)?;
        for (name, value) in &self.operands {
            write!(f, " {name} = {value:x}")?;
        }
        for (place, (name, hardware, plain)) in self.results.iter().enumerate() {
            write!(
                f,
                "; {name}: hardware {hardware:x}, specification {plain:x}"
            )?;
            if let Some(golden) = self.golden.get(place) {
                write!(f, ", golden {golden:x}")?;
            }
        }
        Ok(())
    }
}

/// Cases that are not proven.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unproven {
    /// Refuted.
    Refuted(Counterexample),
    /// The solver gave up on it.
    Undecided(String),
}

/// What came of an operator's proof.
#[derive(Clone, Debug, Default)]
pub struct Proof {
    /// Cases asked about.
    pub cases: u64,
    /// Those not proven, in order.
    pub unproven: Vec<Unproven>,
    /// Gates of the miters before their inputs were made constants.
    pub gates: u64,
}

/// Constants for a case: an input port, and the bits of it, from the lowest.
struct Case {
    name: String,
    constants: Vec<(&'static str, u32, u32, u64)>,
}

impl Case {
    fn all() -> Vec<Case> {
        vec![Case {
            name: "all operands".to_owned(),
            constants: Vec::new(),
        }]
    }

    /// The constant of an input `port[bit]`, or of a port of one bit.
    fn value(&self, input: &str) -> Option<bool> {
        let (port, bit) = match input.split_once('[') {
            Some((port, bit)) => (port, bit.strip_suffix(']')?.parse::<u32>().ok()?),
            None => (input, 0),
        };
        let mut constants = self.constants.iter();
        let &(_, lowest, _, value) = constants.find(|&&(name, lowest, width, _)| {
            name == port && (lowest..lowest + width).contains(&bit)
        })?;
        Some(value >> (bit - lowest) & 1 == 1)
    }
}

/// A miter and the cases that are asked about it.
struct Part {
    miter: String,
    cases: Vec<Case>,
}

/// The tools.
pub struct Prover {
    /// Makes gates.
    pub yosys: Yosys,
    /// Answers.
    pub solver: Solver,
}

impl Prover {
    /// Finds the tools; `seconds` is the time allowed for a case.
    ///
    /// # Errors
    /// If one is not installed.
    pub fn find(seconds: u64) -> Result<Prover, ProofError> {
        Ok(Prover {
            yosys: Yosys::find()?,
            solver: Solver::find(seconds)?,
        })
    }

    /// Proves that the combinational module of an operator equals its specification, or finds where
    /// it does not. `progress` is told of every case that is done and how many there are.
    ///
    /// # Errors
    /// If there is no specification, or a tool fails.
    pub fn prove(
        &self,
        configuration: OperatorConfiguration,
        hardware: &Arc<Module>,
        progress: &(dyn Fn(u64, u64) + Sync),
    ) -> Result<Proof, ProofError> {
        let parts = parts(configuration, hardware)?;
        let total = parts.iter().map(|part| part.cases.len() as u64).sum();
        let mut proof = Proof::default();
        for part in &parts {
            let graph = self.yosys.gates(hardware, &part.miter)?;
            proof.gates += graph.gates() as u64;
            let answers: Vec<Option<Unproven>> = part
                .cases
                .par_iter()
                .map(|case| {
                    let answer = self.ask(configuration, hardware, &graph, case);
                    progress(1, total);
                    answer
                })
                .collect::<Result<_, _>>()?;
            proof.cases += answers.len() as u64;
            proof.unproven.extend(answers.into_iter().flatten());
        }
        Ok(proof)
    }

    fn ask(
        &self,
        configuration: OperatorConfiguration,
        hardware: &Module,
        graph: &Graph,
        case: &Case,
    ) -> Result<Option<Unproven>, ProofError> {
        let special = graph.specialised(DIFFERS, |input| case.value(input));
        match self.solver.solve(&special.clauses(DIFFERS))? {
            Verdict::Unsatisfiable => Ok(None),
            Verdict::Undecided => Ok(Some(Unproven::Undecided(case.name.clone()))),
            Verdict::Satisfiable(model) => {
                let mut inputs: Vec<bool> = graph
                    .inputs
                    .iter()
                    .map(|name| case.value(name).unwrap_or(false))
                    .collect();
                for literal in model {
                    // Variable 1 is the constant, 2 the first input.
                    let place = literal.unsigned_abs() as usize;
                    if let Some(place) = place.checked_sub(2)
                        && let Some(name) = graph.inputs.get(place)
                        && case.value(name).is_none()
                    {
                        inputs[place] = literal > 0;
                    }
                }
                witness(configuration, hardware, graph, case, &inputs)
                    .map(|found| Some(Unproven::Refuted(found)))
                    .ok_or_else(|| ProofError::NotACounterexample(hardware.name.clone()))
            }
        }
    }
}

/// Reads the operands and both results off the miter; `None` if they do not differ.
fn witness(
    configuration: OperatorConfiguration,
    hardware: &Module,
    graph: &Graph,
    case: &Case,
    inputs: &[bool],
) -> Option<Counterexample> {
    let values = graph.evaluate(inputs);
    let word = |port: &str| {
        let mut word = None;
        for ((name, _), &value) in graph.outputs.iter().zip(&values) {
            let (own, bit) = match name.split_once('[') {
                Some((own, bit)) => (own, bit.strip_suffix(']')?.parse::<u32>().ok()?),
                None => (name.as_str(), 0),
            };
            if own == port {
                word = Some(word.unwrap_or(0) | u64::from(value) << bit);
            }
        }
        word
    };
    if word(DIFFERS)? == 0 {
        return None;
    }
    let input_names = hardware
        .inputs
        .iter()
        .filter_map(|&wire| hardware.node(wire).name.clone());
    let operands: Vec<(String, u64)> = input_names
        .map(|name| word(&format!("operand_{name}")).map(|value| (name, value)))
        .collect::<Option<_>>()?;
    let results = hardware.outputs.iter().filter_map(|(name, _)| {
        let side = |side: &str| word(&format!("{side}_{name}"));
        Some((name.clone(), side("hardware")?, side("plain")?))
    });
    let results: Vec<_> = results.collect();
    let mut golden = Vec::new();
    let operand_words: Vec<u64> = operands.iter().map(|(_, value)| *value).collect();
    configuration.golden_results(&operand_words, &mut golden);
    Some(Counterexample {
        case: case.name.clone(),
        operands,
        results,
        golden,
    })
}

/// Formats up to this width are proven in one go, whatever the operator.
const WHOLE_WIDTH: u32 = 10;

fn parts(configuration: OperatorConfiguration, hardware: &Module) -> Result<Vec<Part>, ProofError> {
    let name = configuration.operator.name().to_owned();
    let Some(specification) = Specification::of(configuration.operator) else {
        return Err(ProofError::NoSpecification(name));
    };
    for (port, _) in &hardware.outputs {
        if !specification.has_output(port) {
            return Err(ProofError::NoSuchResult {
                operator: name,
                port: port.clone(),
            });
        }
    }
    let whole = miter::whole(configuration, &specification, hardware);
    let format = configuration.format;
    let sum = matches!(
        configuration.operator,
        FloatOperator::Add | FloatOperator::Subtract
    );
    if sum && format.width() > WHOLE_WIDTH {
        let not_finite = |port: &'static str| Case {
            name: format!("{port} infinite or NaN"),
            constants: vec![(
                port,
                format.fraction_bits,
                format.exponent_bits,
                format.exponent_all_ones(),
            )],
        };
        let differences = (0..=miter::largest_difference(configuration)).flat_map(|difference| {
            [(0, "a"), (1, "b")].map(|(swap, larger)| Case {
                name: format!("{larger} larger by 2^{difference}"),
                constants: vec![
                    ("swap", 0, 1, swap),
                    ("difference", 0, format.exponent_bits, u64::from(difference)),
                ],
            })
        });
        return Ok(vec![
            Part {
                miter: miter::sum_coverage(configuration),
                cases: vec![Case {
                    name: "the cases cover all finite operands".to_owned(),
                    constants: Vec::new(),
                }],
            },
            Part {
                miter: whole,
                cases: vec![not_finite("a_i"), not_finite("b_i")],
            },
            Part {
                miter: miter::finite_sum(configuration, hardware),
                cases: differences.collect(),
            },
        ]);
    }
    let by_exponent = matches!(
        configuration.operator,
        FloatOperator::Floor
            | FloatOperator::RoundToIntegral
            | FloatOperator::ToInteger { .. }
            | FloatOperator::ToUnsigned { .. }
    );
    let cases = if by_exponent && format.width() > WHOLE_WIDTH {
        let fields = 0..=format.exponent_all_ones();
        fields
            .map(|field| Case {
                name: format!("a_i of exponent field {field:x}"),
                constants: vec![("a_i", format.fraction_bits, format.exponent_bits, field)],
            })
            .collect()
    } else {
        Case::all()
    };
    Ok(vec![Part {
        miter: whole,
        cases,
    }])
}
