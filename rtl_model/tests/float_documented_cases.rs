//! The tables of docs/numerics.md, read from the page itself.

use rtl_model::float::{Flags, FloatFormat, Operation, Policy, Rounding, SUPPORTED_FORMATS};

const PAGE: &str = include_str!("../../docs/numerics.md");

fn hexadecimal(text: &str, row: &str) -> u64 {
    u64::from_str_radix(text, 16).unwrap_or_else(|_| panic!("not hexadecimal: `{text}` in {row}"))
}

fn cells(row: &str) -> Vec<&str> {
    row.trim_matches('|').split('|').map(str::trim).collect()
}

/// The result, and the flags if the operator has any.
fn evaluate(
    operator: &str,
    policy: Policy,
    rounding: Rounding,
    operands: [u64; 3],
) -> (u64, Option<Flags>) {
    let arithmetic = FloatFormat::E7F16.arithmetic(policy, rounding);
    let [a, b, _] = operands;
    let count = u32::try_from(b).expect("a count");
    match operator {
        "ulps_up" => (arithmetic.ulps_up(a, count), None),
        "depth_from_height" => (arithmetic.depth_from_height(a, count), None),
        name => {
            let operation: Operation = name.parse().expect("an operator");
            let answer = operation.evaluate(arithmetic, operands);
            (answer.bits, Some(answer.flags))
        }
    }
}

#[test]
fn the_worked_examples_hold() {
    let section = PAGE
        .split("## 11. Worked examples")
        .nth(1)
        .and_then(|rest| rest.split("\n## ").next())
        .expect("section 11 of docs/numerics.md");
    let mut examples = 0;
    let mut raised = Flags::NONE;
    let mut wrong = Vec::new();
    for row in section.lines().filter(|line| line.starts_with("| ")) {
        let [operator, policy, rounding, operands, result, flags, _why] = cells(row)[..] else {
            panic!("seven columns in {row}");
        };
        if operator == "operator" {
            continue;
        }
        let mut words = [0; 3];
        for (word, text) in words.iter_mut().zip(operands.split(' ')) {
            *word = hexadecimal(text, row);
        }
        let (bits, actual) = evaluate(
            operator,
            policy.parse().expect(row),
            rounding.parse().expect(row),
            words,
        );
        let expected =
            (flags != "-").then(|| Flags::from_bits(hexadecimal(flags, row).try_into().unwrap()));
        if (bits, actual) != (hexadecimal(result, row), expected) {
            wrong.push(format!("the model gives {bits:06x} and {actual:?}: {row}"));
        }
        raised |= actual.unwrap_or_default();
        examples += 1;
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(examples >= 80, "only {examples} examples found on the page");
    for (flag, name) in Flags::ALL {
        assert!(raised.contains(flag), "no example raises {name}");
    }
}

/// The table of formats in section 1 is the list of the library, in its order.
#[test]
fn the_table_of_formats_holds() {
    let section = PAGE
        .split("\n## ")
        .find(|section| section.starts_with("1. Formats"));
    let rows = section.expect("section 1").lines();
    let rows = rows.filter(|line| line.starts_with("| `e"));
    let mut listed = SUPPORTED_FORMATS.iter();
    for row in rows {
        let cells = cells(row);
        let supported = listed
            .next()
            .unwrap_or_else(|| panic!("not in the list of the library: {row}"));
        let format = supported.format;
        assert_eq!(cells[0], format!("`{format}`"), "{row}");
        assert_eq!(cells[1], supported.alias.unwrap_or("-"), "{row}");
        let pattern = |cell: &str| hexadecimal(cell.split('`').nth(1).expect(row), row);
        assert_eq!(cells[2].parse(), Ok(format.width()), "{row}");
        assert_eq!(cells[3].parse(), Ok(format.exponent_bias()), "{row}");
        assert_eq!(pattern(cells[4]), format.min_normal(), "{row}");
        assert_eq!(pattern(cells[5]), format.max_finite(), "{row}");
        assert_eq!(pattern(cells[6]), format.quiet_nan(), "{row}");
        assert_eq!(pattern(cells[7]), format.one(), "{row}");
        assert_eq!(cells[8], supported.purpose, "{row}");
    }
    assert!(
        listed.next().is_none(),
        "the page lacks a format of the library"
    );
}
