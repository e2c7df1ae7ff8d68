//! The testbenches under Verilator's lint, all warnings on.

use hdl_gen::emit::write_design;
use hdl_gen::netlist::Module;
use hdl_gen::operators::{FloatOperator, OperatorConfiguration, stream_unit};
use hdl_gen::testbench::{TraverseBench, stream_testbench, traverse_testbench};
use hdl_gen::units::{TraverseUnit, UnitConfiguration};
use hdl_gen::vectors::operator_vectors;
use hdl_gen::verify::Verilator;
use rtl_model::float::{FloatFormat, Rounding};
use rtl_model::machine::StallPattern;
use rtl_model::units::traverse_step::TraverseShape;
use std::process::Command;
use std::sync::Arc;

/// What the lint says of a design below its testbench; nothing is best.
fn lint(design: &Arc<Module>, bench: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let mut sources = write_design(design, folder.path()).unwrap();
    sources.push(folder.path().join("testbench.v"));
    std::fs::write(sources.last().unwrap(), bench).unwrap();
    // The design has no timescale of its own: only the testbench speaks of time.
    let output = Command::new("verilator")
        .args(["--lint-only", "--timing", "-Wall", "-Wno-TIMESCALEMOD"])
        .args(["-Wno-DECLFILENAME", "--top-module"])
        .arg(format!("testbench_{}", design.name))
        .args(&sources)
        .output()
        .unwrap();
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn testbenches_are_clean_under_lint() {
    if let Err(missing) = Verilator::find() {
        let strict = std::env::var("CI").is_ok_and(|value| value == "true");
        assert!(!strict, "{missing}");
        println!("{missing}: this check is left out");
        return;
    }
    let unit = TraverseUnit::build(UnitConfiguration::oh(
        TraverseShape {
            root_level: 6,
            height_bits: 8,
        },
        FloatFormat::E7F16,
    ));
    let bench = TraverseBench {
        rays: 700,
        stalls: StallPattern::one_in_eight(7),
        watchdog: 100_000,
    };
    assert_eq!(lint(&unit.design, &traverse_testbench(&unit, &bench)), "");

    for kind in [FloatOperator::Add, FloatOperator::Compare] {
        let choice = OperatorConfiguration::new(kind, FloatFormat::E7F16, Rounding::NearestEven);
        let unit = stream_unit(&choice.build(2));
        let set = operator_vectors(choice, 4, 1);
        assert_eq!(
            lint(&unit, &stream_testbench(&unit, &set, "vectors.hex")),
            ""
        );
    }
}
