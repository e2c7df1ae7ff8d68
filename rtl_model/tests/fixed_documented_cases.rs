//! The tables of docs/fixed_point.md, read from the page itself.

use rtl_model::fixed::{Fixed, FixedArithmetic, FixedFormat, FixedOperation};
use rtl_model::float::Policy;

const PAGE: &str = include_str!("../../docs/fixed_point.md");

fn hexadecimal(text: &str, row: &str) -> u64 {
    u64::from_str_radix(text, 16).unwrap_or_else(|_| panic!("not hexadecimal: `{text}` in {row}"))
}

fn cells(row: &str) -> Vec<&str> {
    row.trim_matches('|').split('|').map(str::trim).collect()
}

/// A format, or any where there is none.
fn format(text: &str, row: &str) -> FixedFormat {
    match text {
        "-" => FixedFormat::q(1, 0),
        text => text.parse().expect(row),
    }
}

#[test]
fn the_worked_examples_hold() {
    let section = PAGE
        .split("## 5. Worked examples")
        .nth(1)
        .and_then(|rest| rest.split("\n## ").next())
        .expect("section 5 of docs/fixed_point.md");
    let mut operators = std::collections::HashSet::new();
    let mut examples = 0;
    let mut wrong = Vec::new();
    for row in section.lines().filter(|line| line.starts_with("| ")) {
        let [
            operator,
            formats,
            rounding,
            overflow,
            a,
            b,
            result,
            flags,
            _why,
        ] = cells(row)[..]
        else {
            panic!("nine columns in {row}");
        };
        if operator == "operator" {
            continue;
        }
        let operation: FixedOperation = operator.parse().expect(row);
        let formats: Vec<FixedFormat> = formats.split(' ').map(|text| format(text, row)).collect();
        let [a_format, b_format, result_format] = formats[..] else {
            panic!("three formats in {row}");
        };
        let arithmetic = FixedArithmetic::new(
            result_format,
            rounding.parse().expect(row),
            overflow.parse().expect(row),
        );
        assert_eq!(b == "-", operation.operands() == 1, "{row}");
        let b = if b == "-" { 0 } else { hexadecimal(b, row) };
        let words = [hexadecimal(a, row), b];
        let answer = operation.evaluate(arithmetic, Policy::Flush, (a_format, b_format), words);
        let expected = (hexadecimal(result, row), hexadecimal(flags, row));
        if (answer.bits, u64::from(answer.flags.bits())) != expected {
            wrong.push(format!(
                "the model gives {:x} {:02x}: {row}",
                answer.bits,
                answer.flags.bits()
            ));
        }
        operators.insert(operator);
        examples += 1;
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(examples >= 50, "only {examples} examples found on the page");
    assert!(operators.len() >= 14, "only {operators:?} have examples");
}

/// The table of formats in section 1.
#[test]
fn the_table_of_formats_holds() {
    let mut formats = 0;
    for row in PAGE.lines() {
        let cells = cells(row);
        let name = cells[0].trim_matches('`');
        let Ok(format) = name.parse::<FixedFormat>() else {
            continue;
        };
        // Such as `8000` = -8.
        let end = |cell: &str| {
            let (word, value) = cell.split_once(" = ").expect(row);
            let number = Fixed::new(format, hexadecimal(word.trim_matches('`'), row));
            assert_eq!(number.to_string(), value, "{row}");
            number.bits
        };
        assert_eq!(cells[1].parse(), Ok(format.width()), "{row}");
        assert_eq!(end(cells[2]), format.min(), "{row}");
        assert_eq!(end(cells[3]), format.max(), "{row}");
        assert_eq!(Fixed::new(format, 1).to_string(), cells[4], "{row}");
        formats += 1;
    }
    assert_eq!(formats, 5);
}

/// Every operator has a row in section 3, by its name.
#[test]
fn every_operator_is_described() {
    for operation in FixedOperation::plain() {
        let name = format!("`{operation}`");
        assert!(
            PAGE.lines()
                .any(|row| row.starts_with('|') && row.contains(&name)),
            "{name}"
        );
    }
}
