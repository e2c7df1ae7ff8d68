//! The worked examples of docs/numerics.md, read from the page itself.

use rtl_model::float::{FloatFormat, Rounding};

const PAGE: &str = include_str!("../../docs/numerics.md");

fn hexadecimal(text: &str, row: &str) -> u64 {
    u64::from_str_radix(text, 16).unwrap_or_else(|_| panic!("not hexadecimal: `{text}` in {row}"))
}

fn evaluate(operator: &str, rounding: Rounding, a: u64, b: u64) -> u64 {
    let format = FloatFormat::E7F16;
    match operator {
        "add" => format.add(rounding, a, b),
        "sub" => format.sub(rounding, a, b),
        "mul" => format.mul(rounding, a, b),
        "div" => format.div(rounding, a, b),
        "min" => format.min(a, b),
        "max" => format.max(a, b),
        "less_than" => format.less_than(a, b).into(),
        "less_equal" => format.less_equal(a, b).into(),
        "equal" => format.equal(a, b).into(),
        "floor" => format.floor(a),
        "ulps_up" => format.ulps_up(a, u32::try_from(b).expect("a number of steps")),
        "depth_from_height" => {
            format.depth_from_height(a, u32::try_from(b).expect("a number of bits"))
        }
        other => panic!("the page has an example of `{other}`, which this test does not know"),
    }
}

#[test]
fn the_worked_examples_hold() {
    let section = PAGE
        .split("## 10. Worked examples")
        .nth(1)
        .and_then(|rest| rest.split("\n## ").next())
        .expect("section 10 of docs/numerics.md");
    let mut examples = 0;
    let mut wrong = Vec::new();
    for row in section.lines().filter(|line| line.starts_with("| ")) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [operator, rounding, a, b, result, _why] = cells[..] else {
            panic!("six columns in {row}");
        };
        if operator == "operator" {
            continue;
        }
        let rounding: Rounding = rounding.parse().expect(row);
        let b = if b == "-" { 0 } else { hexadecimal(b, row) };
        let actual = evaluate(operator, rounding, hexadecimal(a, row), b);
        if actual != hexadecimal(result, row) {
            wrong.push(format!("the model gives {actual:06x}: {row}"));
        }
        examples += 1;
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(examples >= 40, "only {examples} examples found on the page");
}

/// The table of formats in section 1.
#[test]
fn the_table_of_formats_holds() {
    let mut formats = 0;
    for row in PAGE.lines().filter(|line| line.starts_with("| `e")) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let (exponent_bits, fraction_bits) = cells[0]
            .trim_matches('`')
            .trim_start_matches('e')
            .split_once('f')
            .expect(row);
        let format = FloatFormat::new(
            exponent_bits.parse().expect(row),
            fraction_bits.parse().expect(row),
        );
        let pattern = |cell: &str| hexadecimal(cell.split('`').nth(1).expect(row), row);
        assert_eq!(cells[1].parse(), Ok(format.width()), "{row}");
        assert_eq!(cells[2].parse(), Ok(format.exponent_bias()), "{row}");
        assert_eq!(pattern(cells[3]), format.min_normal(), "{row}");
        assert_eq!(pattern(cells[4]), format.max_finite(), "{row}");
        assert_eq!(pattern(cells[5]), format.quiet_nan(), "{row}");
        assert_eq!(pattern(cells[6]), format.one(), "{row}");
        formats += 1;
    }
    assert_eq!(formats, 4);
}
