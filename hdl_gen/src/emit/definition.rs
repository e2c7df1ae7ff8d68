//! The expression of each operation, from what its operands are called.

use super::expression::{Expression, literal};
use super::plan::{Plan, Reference};
use crate::netlist::{Node, Operation, Wire};

impl Plan<'_> {
    /// A slice without a name: a select of the signal, or the bits of the literal.
    pub(super) fn slice(&self, from: Wire, low: u32, node: &Node) -> Reference {
        match self.references[from.index()].clone() {
            Some(Reference::Select { base, low: inner }) => self.slice(base, inner + low, node),
            Some(Reference::Literal(value)) => {
                Reference::Literal(value >> low & (u64::MAX >> (64 - node.width)))
            }
            _ => Reference::Select { base: from, low },
        }
    }

    /// The text of a node where a user reads it; notes that its bits are read.
    pub(super) fn operand(&mut self, wire: Wire) -> Expression {
        let width = self.module.width(wire);
        match self.references[wire.index()].clone() {
            Some(Reference::Signal(name)) => {
                self.read[wire.index()] = u64::MAX;
                Expression::Atom(name)
            }
            Some(Reference::Select { base, low }) => self.select(base, low, width),
            Some(Reference::Literal(value)) => Expression::Atom(literal(value, width)),
            Some(Reference::Inline(expression)) => expression,
            // Only a node that stands before what it reads: no builder makes one.
            None => Expression::Atom(format!("n{}", wire.index())),
        }
    }

    /// Bits of a signal where a user reads them; notes that they are read.
    fn select(&mut self, base: Wire, low: u32, count: u32) -> Expression {
        self.read[base.index()] |= (u64::MAX >> (64 - count)) << low;
        let name = self.signal(base).unwrap_or_default();
        select(name, self.module.width(base), low, count)
    }

    /// The expression of a node's operation.
    pub(super) fn definition(&mut self, node: &Node, known: Option<u64>) -> Expression {
        if let Some(value) = known {
            return Expression::Atom(literal(value, node.width));
        }
        match &node.operation {
            Operation::Not(a) => match self.operand(*a) {
                Expression::Chain("==", sides) => Expression::Chain("!=", sides),
                Expression::Chain("<", sides) => Expression::Chain(">=", sides),
                Expression::Unary("!" | "~", twice) => *twice,
                Expression::Unary("|", a) => Expression::Unary("~|", a),
                Expression::Unary("&", a) => Expression::Unary("~&", a),
                operand => {
                    let operator = if node.width == 1 { "!" } else { "~" };
                    Expression::Unary(operator, Box::new(operand))
                }
            },
            Operation::And(a, b) => self.chain("&", *a, *b),
            Operation::Or(a, b) => self.chain("|", *a, *b),
            Operation::Xor(a, b) => self.chain("^", *a, *b),
            Operation::Add(a, b) => self.chain("+", *a, *b),
            Operation::Subtract(a, b) => self.chain("-", *a, *b),
            Operation::ShiftLeft(a, b) => self.shift("<<", *a, *b),
            Operation::ShiftRight(a, b) => self.shift(">>", *a, *b),
            Operation::Equal(a, b) => self.pair("==", *a, *b),
            Operation::LessThan(a, b) => self.pair("<", *a, *b),
            Operation::Multiply(a, b) => {
                // Operands as wide as the product, or Verilog would drop its upper half.
                let sides = [*a, *b].map(|side| {
                    let zeros = literal(0, node.width - self.module.width(side));
                    Expression::Concat(vec![Expression::Atom(zeros), self.operand(side)])
                });
                Expression::Chain("*", sides.to_vec())
            }
            Operation::MultiplySigned(a, b) => {
                // Extended like the others; `$signed` tells synthesis that the bits in front are
                // copies, so that it takes no multiplier for them.
                let sides = [*a, *b].map(|side| {
                    let extended = self.sign_extend(side, node.width).flat();
                    Expression::Atom(format!("$signed({extended})"))
                });
                Expression::Chain("*", sides.to_vec())
            }
            Operation::Mux {
                select,
                when_one,
                when_zero,
            } => {
                let mut arms = vec![(self.operand(*select), self.operand(*when_one))];
                match self.operand(*when_zero) {
                    Expression::Choice(more, otherwise) => {
                        arms.extend(more);
                        Expression::Choice(arms, otherwise)
                    }
                    otherwise => Expression::Choice(arms, Box::new(otherwise)),
                }
            }
            Operation::Concat(parts) => {
                let mut texts = Vec::new();
                for &part in parts {
                    match self.operand(part) {
                        Expression::Concat(inner) => texts.extend(inner),
                        text => texts.push(text),
                    }
                }
                match &texts[..] {
                    [first, rest @ ..] if rest.len() > 1 && rest.iter().all(|t| t == first) => {
                        Expression::Replicate(texts.len() as u32, Box::new(first.clone()))
                    }
                    _ => Expression::Concat(texts),
                }
            }
            Operation::Slice { from, low } => match self.slice(*from, *low, node) {
                Reference::Select { base, low } => self.select(base, low, node.width),
                Reference::Literal(value) => Expression::Atom(literal(value, node.width)),
                Reference::Signal(_) | Reference::Inline(_) => self.operand(*from),
            },
            Operation::SignExtend(from) => self.sign_extend(*from, node.width),
            Operation::AnyBit(a) => Expression::Unary("|", Box::new(self.operand(*a))),
            Operation::AllBits(a) => Expression::Unary("&", Box::new(self.operand(*a))),
            Operation::Constant(value) => Expression::Atom(literal(*value, node.width)),
            Operation::MemoryRead { memory, address } => {
                let address = self.operand(*address).flat();
                let name = &self.module.memory(*memory).name;
                Expression::Atom(format!("{name}[{address}]"))
            }
            Operation::Input | Operation::Register { .. } | Operation::InstanceOutput { .. } => {
                Expression::Atom(node.name.clone().unwrap_or_default())
            }
        }
    }

    fn pair(&mut self, operator: &'static str, a: Wire, b: Wire) -> Expression {
        Expression::Chain(operator, vec![self.operand(a), self.operand(b)])
    }

    /// A shift; a known amount is a plain number.
    fn shift(&mut self, operator: &'static str, a: Wire, amount: Wire) -> Expression {
        match self.known[amount.index()] {
            Some(number) => {
                let number = Expression::Atom(number.to_string());
                Expression::Chain(operator, vec![self.operand(a), number])
            }
            None => self.pair(operator, a, amount),
        }
    }

    /// `a op b`, where a chain of the same operator on the left goes on without parentheses.
    fn chain(&mut self, operator: &'static str, a: Wire, b: Wire) -> Expression {
        let b = self.operand(b);
        match self.operand(a) {
            Expression::Chain(inner, mut operands) if inner == operator => {
                operands.push(b);
                Expression::Chain(operator, operands)
            }
            a => Expression::Chain(operator, vec![a, b]),
        }
    }

    fn sign_extend(&mut self, from: Wire, width: u32) -> Expression {
        let own = self.module.width(from);
        let whole = self.operand(from);
        let sign = match &self.references[from.index()] {
            Some(Reference::Select { base, low }) => {
                let name = self.signal(*base).unwrap_or_default();
                select(name, self.module.width(*base), low + own - 1, 1)
            }
            Some(Reference::Literal(value)) => Expression::Atom(literal(value >> (own - 1), 1)),
            _ => match &whole {
                Expression::Atom(name) => select(name, own, own - 1, 1),
                other => other.clone(),
            },
        };
        if own == 1 {
            return Expression::Replicate(width, Box::new(whole));
        }
        let copies = match width - own {
            1 => sign,
            more => Expression::Replicate(more, Box::new(sign)),
        };
        Expression::Concat(vec![copies, whole])
    }
}

/// The bits `low` up of a signal of `width` bits, `count` of them; a signal of one bit has none.
pub(super) fn select(name: &str, width: u32, low: u32, count: u32) -> Expression {
    Expression::Atom(if count == width {
        name.to_owned()
    } else if count == 1 {
        format!("{name}[{low}]")
    } else {
        format!("{name}[{}:{low}]", low + count - 1)
    })
}
