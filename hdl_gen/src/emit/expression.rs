//! Verilog expressions as trees, and their printing on one line or on several.
//!
//! Verilog widens the operands of an expression to the context they stand in. Here every operand
//! of an operator is as wide as its result by construction, so that no context can widen it and
//! parentheses are for the reader.

/// Columns a line may fill.
pub(super) const LINE: usize = 96;

/// An expression.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Expression {
    /// A name, a select or a literal.
    Atom(String),
    /// `!a`, `~a`, `|a`, `&a`, `~|a`, `~&a`.
    Unary(&'static str, Box<Expression>),
    /// `a + b + c`; more than two operands only where the operator allows it from left to right.
    Chain(&'static str, Vec<Expression>),
    /// `select ? value : select ? value : otherwise`: the first select that is 1 decides.
    Choice(Vec<(Expression, Expression)>, Box<Expression>),
    /// `{a, b, c}`.
    Concat(Vec<Expression>),
    /// `{4{a}}`.
    Replicate(u32, Box<Expression>),
}

impl Expression {
    pub(super) fn atom(text: impl Into<String>) -> Expression {
        Expression::Atom(text.into())
    }

    /// On one line.
    pub(super) fn flat(&self) -> String {
        match self {
            Expression::Atom(text) => text.clone(),
            // Two operators in a row read as one, to some tools too.
            Expression::Unary(operator, a) => match **a {
                Expression::Unary(..) => format!("{operator}({})", a.flat()),
                _ => format!("{operator}{}", a.operand()),
            },
            Expression::Chain(operator, operands) => operands
                .iter()
                .map(Expression::operand)
                .collect::<Vec<_>>()
                .join(&format!(" {operator} ")),
            Expression::Choice(arms, otherwise) => {
                let arms = arms.iter().map(|arm| format!("{} : ", arm_text(arm)));
                format!("{}{}", arms.collect::<String>(), otherwise.operand())
            }
            Expression::Concat(parts) => format!("{{{}}}", flat_parts(parts).join(", ")),
            Expression::Replicate(times, a) => format!("{{{times}{{{}}}}}", a.flat()),
        }
    }

    /// On one line, in parentheses where it stands beside an operator.
    fn operand(&self) -> String {
        match self {
            Expression::Atom(_) | Expression::Concat(_) | Expression::Replicate(..) => self.flat(),
            // `a & &b` would be read twice.
            Expression::Unary("!" | "~", a) if matches!(**a, Expression::Atom(_)) => self.flat(),
            _ => format!("({})", self.flat()),
        }
    }

    /// Behind text that ends at column `column`, on as many lines as it takes; choices between
    /// more than two values always stand one below the other.
    pub(super) fn broken(&self, column: usize) -> String {
        let flat = self.flat();
        let ladder = matches!(self, Expression::Choice(arms, _) if arms.len() > 1);
        if !ladder && column + flat.len() < LINE {
            return flat;
        }
        let indent = format!("\n{}", " ".repeat(column));
        match self {
            Expression::Choice(arms, otherwise) => {
                let selects: Vec<String> =
                    arms.iter().map(|(select, _)| select.operand()).collect();
                let widest = selects.iter().map(String::len).max().unwrap_or_default();
                let mut text = String::new();
                for (select, (_, value)) in selects.iter().zip(arms) {
                    let value = value.operand();
                    text += &format!("{select:widest$} ? {value} :{indent}");
                }
                text + &" ".repeat(widest + 3) + &otherwise.operand()
            }
            Expression::Concat(parts) => {
                let inner = format!("\n{}", " ".repeat(column + 1));
                format!("{{{}}}", filled(&flat_parts(parts), column + 1, &inner))
            }
            Expression::Chain(operator, operands) => operands
                .iter()
                .map(Expression::operand)
                .collect::<Vec<_>>()
                .join(&format!(" {operator}{indent}")),
            _ => flat,
        }
    }
}

fn flat_parts(parts: &[Expression]) -> Vec<String> {
    parts
        .iter()
        .map(|part| match part {
            Expression::Choice(..) => part.operand(),
            _ => part.flat(),
        })
        .collect()
}

fn arm_text((select, value): &(Expression, Expression)) -> String {
    format!("{} ? {}", select.operand(), value.operand())
}

/// Items with commas between, as many on a line as fit.
fn filled(items: &[String], column: usize, line_break: &str) -> String {
    let mut text = String::new();
    let mut at = column;
    for (index, item) in items.iter().enumerate() {
        let last = index + 1 == items.len();
        if at > column && at + item.len() + 2 > LINE {
            text.truncate(text.trim_end().len());
            text += line_break;
            at = column;
        }
        text += item;
        if !last {
            text += ", ";
        }
        at += item.len() + 2;
    }
    text
}

/// A sized literal: a bit in binary, small numbers in decimal, patterns in hexadecimal.
pub(super) fn literal(value: u64, width: u32) -> String {
    let all_ones = value == u64::MAX >> (64 - width);
    if width == 1 {
        format!("1'b{value}")
    } else if value < 256 && !(all_ones && width > 4) {
        format!("{width}'d{value}")
    } else {
        let digits = format!("{value:x}");
        let mut grouped = String::new();
        for (index, digit) in digits.chars().enumerate() {
            // Groups of four, counted from the right.
            if index > 0 && (digits.len() - index) % 4 == 0 {
                grouped.push('_');
            }
            grouped.push(digit);
        }
        format!("{width}'h{grouped}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn atom(text: &str) -> Expression {
        Expression::atom(text)
    }

    #[test]
    fn literals_are_sized_and_readable() {
        assert_eq!(literal(1, 1), "1'b1");
        assert_eq!(literal(63, 7), "7'd63");
        assert_eq!(literal(15, 4), "4'd15");
        assert_eq!(literal(127, 7), "7'h7f");
        assert_eq!(literal(0x3ff_0000, 32), "32'h3ff_0000");
        assert_eq!(literal(u64::MAX, 64), "64'hffff_ffff_ffff_ffff");
    }

    #[test]
    fn operators_inside_operators_are_in_parentheses() {
        let sum = Expression::Chain("+", vec![atom("a"), atom("b")]);
        let any = Expression::Unary("|", Box::new(atom("c")));
        let not = Expression::Unary("~", Box::new(sum.clone()));
        let and = Expression::Chain("&", vec![not, any]);
        assert_eq!(and.flat(), "(~(a + b)) & (|c)");
        let joined = Expression::Concat(vec![atom("1'b0"), sum]);
        assert_eq!(joined.flat(), "{1'b0, a + b}");
    }

    #[test]
    fn choices_stand_one_below_the_other() {
        let choice = Expression::Choice(
            vec![(atom("is_nan"), atom("nan")), (atom("far"), atom("b"))],
            Box::new(atom("c")),
        );
        assert_eq!(
            choice.broken(4),
            "is_nan ? nan :\n    far    ? b :\n             c"
        );
    }

    #[test]
    fn long_lists_are_filled_line_by_line() {
        let parts = (0..40).map(|i| atom(&format!("name_{i}"))).collect();
        let text = Expression::Concat(parts).broken(10);
        assert!(text.lines().count() > 3);
        assert!(
            text.lines()
                .all(|line| line.len() <= LINE && line == line.trim_end())
        );
    }
}
