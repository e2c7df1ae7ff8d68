//! A slice of the campaign under Verilator, and a fault that it catches.

use campaigns::hardware::Gallery;
use hdl_gen::fault::plant;
use hdl_gen::operators::{FloatOperator, OperatorConfiguration};
use hdl_gen::verify::Verilator;
use rtl_model::float::{FloatFormat, Rounding};

fn gallery(format: FloatFormat, count: u64) -> Gallery {
    let configurations = [Rounding::NearestEven, Rounding::Up]
        .map(|rounding| OperatorConfiguration::new(FloatOperator::Add, format, rounding));
    Gallery::new(configurations.to_vec(), 2, count, 3)
}

#[test]
fn the_adder_is_the_golden_one_and_a_fault_is_not() {
    let verilator = match Verilator::find() {
        Ok(verilator) => verilator,
        Err(problem) if std::env::var_os("CI").is_none() => {
            eprintln!("left out: {problem}");
            return;
        }
        Err(problem) => panic!("{problem}"),
    };
    let gallery = gallery(FloatFormat::E7F16, 200_000);
    assert!(!gallery.is_exhaustive());
    let outcome = gallery.run(&gallery.unit, &verilator, &|_| {}).unwrap();
    assert_eq!(outcome.cases, 2 * 200_000);
    assert_eq!(outcome.first, []);
    assert_eq!(outcome.differences, 0);

    let faulty = plant(&gallery.unit, "core.in_rup.result_o", 0).unwrap();
    let outcome = gallery.run(&faulty, &verilator, &|_| {}).unwrap();
    assert!(outcome.differences > 0);
    let difference = &outcome.first[0];
    // The operands are those of the result that differs.
    let [a, b] = difference.operands[..] else {
        panic!("{difference:?}");
    };
    let format = FloatFormat::E7F16;
    assert_eq!(difference.golden, [format.add(Rounding::Up, a, b)]);
    assert_eq!(difference.other[0] ^ difference.golden[0], 1);
}
