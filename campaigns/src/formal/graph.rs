//! An and-inverter graph: read from a binary AIGER file, specialised to constants, evaluated,
//! written as clauses.

use std::collections::HashMap;

use thiserror::Error;

/// A literal: twice a node's number, plus 1 where it is inverted. Node 0 is the constant false.
pub type Literal = u32;

const FALSE: Literal = 0;
const TRUE: Literal = 1;

/// Why a file is not a graph.
#[derive(Debug, Error)]
#[error("the AIGER file that Yosys wrote cannot be read: {0}")]
pub struct GraphError(&'static str);

/// A combinational circuit. Nodes are the constant, the inputs, then the gates, each after those
/// that it reads.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    /// Names of the inputs, `port[bit]`, in the order of their nodes.
    pub inputs: Vec<String>,
    /// The two literals of every gate.
    gates: Vec<(Literal, Literal)>,
    /// Names and literals of the outputs.
    pub outputs: Vec<(String, Literal)>,
    /// Gates by their literals, so that none stands twice.
    known: HashMap<(Literal, Literal), Literal>,
}

impl Graph {
    /// Reads a binary AIGER file with symbols and without latches.
    ///
    /// # Errors
    /// If it is anything else.
    pub fn read(bytes: &[u8]) -> Result<Graph, GraphError> {
        let mut lines = Lines { rest: bytes };
        let header = lines.next()?;
        let mut words = header.split(' ');
        if words.next() != Some("aig") {
            return Err(GraphError("it does not begin with aig"));
        }
        let mut number = || {
            let word = words.next().and_then(|word| word.parse::<usize>().ok());
            word.ok_or(GraphError("its header has no five numbers"))
        };
        let (_, inputs, latches, outputs, gates) =
            (number()?, number()?, number()?, number()?, number()?);
        if latches != 0 {
            return Err(GraphError("it has registers"));
        }
        let mut graph = Graph {
            inputs: vec![String::new(); inputs],
            ..Graph::default()
        };
        for _ in 0..outputs {
            let literal = lines.next()?.parse().map_err(|_| GraphError("an output"))?;
            graph.outputs.push((String::new(), literal));
        }
        for place in 0..gates {
            let own = 2 * (1 + inputs + place) as u32;
            let left = own.checked_sub(lines.delta()?);
            let left = left.ok_or(GraphError("a gate"))?;
            let right = left.checked_sub(lines.delta()?);
            graph.gates.push((left, right.ok_or(GraphError("a gate"))?));
        }
        while !lines.rest.is_empty() {
            let Ok(line) = lines.next() else { break };
            if line == "c" {
                break;
            }
            let (place, name) = line.split_once(' ').ok_or(GraphError("a symbol"))?;
            let (kind, place) = place.split_at(1);
            let place: usize = place.parse().map_err(|_| GraphError("a symbol"))?;
            let slot = match kind {
                "i" => graph.inputs.get_mut(place),
                "o" => graph.outputs.get_mut(place).map(|(name, _)| name),
                _ => None,
            };
            *slot.ok_or(GraphError("a symbol"))? = name.to_owned();
        }
        Ok(graph)
    }

    /// How many gates it has.
    pub fn gates(&self) -> usize {
        self.gates.len()
    }

    fn first_gate(&self) -> usize {
        1 + self.inputs.len()
    }

    /// The conjunction of two literals: a gate only where it is neither constant nor there already.
    fn and(&mut self, left: Literal, right: Literal) -> Literal {
        let (left, right) = (left.min(right), left.max(right));
        match (left, right) {
            (FALSE, _) => return FALSE,
            (TRUE, other) => return other,
            _ if left == right => return left,
            _ if left ^ 1 == right => return FALSE,
            _ => {}
        }
        if let Some(&known) = self.known.get(&(left, right)) {
            return known;
        }
        let own = 2 * (self.first_gate() + self.gates.len()) as u32;
        self.gates.push((left, right));
        self.known.insert((left, right), own);
        own
    }

    /// The part of the graph that one output depends on, with the value of some inputs given:
    /// `value` answers by an input's name. The other inputs keep their places.
    pub fn specialised(&self, output: &str, value: impl Fn(&str) -> Option<bool>) -> Graph {
        let mut special = Graph {
            inputs: self.inputs.clone(),
            ..Graph::default()
        };
        let root = self.output(output);
        let mut needed = vec![false; self.first_gate() + self.gates.len()];
        if let Some(root) = root {
            needed[(root >> 1) as usize] = true;
        }
        for (place, &(left, right)) in self.gates.iter().enumerate().rev() {
            if needed[self.first_gate() + place] {
                needed[(left >> 1) as usize] = true;
                needed[(right >> 1) as usize] = true;
            }
        }
        let mut moved = vec![FALSE; needed.len()];
        for (place, name) in self.inputs.iter().enumerate() {
            moved[1 + place] = match value(name) {
                Some(bit) => Literal::from(bit),
                None => 2 * (1 + place) as u32,
            };
        }
        let at =
            |moved: &[Literal], literal: Literal| moved[(literal >> 1) as usize] ^ (literal & 1);
        for (place, &(left, right)) in self.gates.iter().enumerate() {
            let own = self.first_gate() + place;
            if needed[own] {
                moved[own] = special.and(at(&moved, left), at(&moved, right));
            }
        }
        if let Some(root) = root {
            let literal = at(&moved, root);
            special.outputs.push((output.to_owned(), literal));
        }
        special
    }

    /// An output's literal.
    pub fn output(&self, name: &str) -> Option<Literal> {
        let mut outputs = self.outputs.iter();
        outputs.find(|(own, _)| own == name).map(|(_, l)| *l)
    }

    /// The value of every output for these values of the inputs.
    pub fn evaluate(&self, inputs: &[bool]) -> Vec<bool> {
        let mut values = vec![false];
        values.extend_from_slice(inputs);
        let at = |values: &[bool], literal: Literal| {
            values[(literal >> 1) as usize] ^ (literal & 1 == 1)
        };
        for &(left, right) in &self.gates {
            values.push(at(&values, left) & at(&values, right));
        }
        let outputs = self.outputs.iter();
        outputs.map(|&(_, literal)| at(&values, literal)).collect()
    }

    /// Clauses that hold of inputs and gates exactly where this output is 1, in the DIMACS
    /// format. Variable n + 1 is node n.
    pub fn clauses(&self, output: &str) -> String {
        use std::fmt::Write;
        let variable = |literal: Literal| {
            let variable = i64::from(literal >> 1) + 1;
            if literal & 1 == 1 {
                -variable
            } else {
                variable
            }
        };
        let nodes = self.first_gate() + self.gates.len();
        let mut text = format!("p cnf {nodes} {}\n-1 0\n", 3 * self.gates.len() + 2);
        for (place, &(left, right)) in self.gates.iter().enumerate() {
            let own = (self.first_gate() + place + 1) as i64;
            let (left, right) = (variable(left), variable(right));
            let _ = writeln!(
                text,
                "-{own} {left} 0\n-{own} {right} 0\n{own} {} {} 0",
                -left, -right
            );
        }
        let root = self.output(output).unwrap_or(FALSE);
        let _ = writeln!(text, "{} 0", variable(root));
        text
    }
}

/// A file that begins with lines and goes on with bytes.
struct Lines<'a> {
    rest: &'a [u8],
}

impl<'a> Lines<'a> {
    fn next(&mut self) -> Result<&'a str, GraphError> {
        let end = self.rest.iter().position(|&byte| byte == b'\n');
        let end = end.ok_or(GraphError("it ends within a line"))?;
        let line = std::str::from_utf8(&self.rest[..end]);
        self.rest = &self.rest[end + 1..];
        line.map_err(|_| GraphError("a line is no text"))
    }

    /// A number in groups of seven bits, the lowest first.
    fn delta(&mut self) -> Result<u32, GraphError> {
        let mut number = 0;
        for shift in (0..32).step_by(7) {
            let (&byte, rest) = self.rest.split_first().ok_or(GraphError("a gate"))?;
            self.rest = rest;
            number |= u32::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(number);
            }
        }
        Err(GraphError("a gate"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x and y, and their exclusive or, of three gates.
    fn example() -> Graph {
        let mut graph = Graph {
            inputs: vec!["x".to_owned(), "y".to_owned()],
            ..Graph::default()
        };
        let both = graph.and(2, 4);
        let neither = graph.and(3, 5);
        let differ = graph.and(both ^ 1, neither ^ 1);
        graph.outputs = vec![("both".to_owned(), both), ("differ".to_owned(), differ)];
        graph
    }

    #[test]
    fn a_graph_computes_what_its_gates_say() {
        let graph = example();
        for (x, y) in [(false, false), (false, true), (true, false), (true, true)] {
            assert_eq!(graph.evaluate(&[x, y]), [x & y, x ^ y]);
        }
    }

    #[test]
    fn a_constant_input_leaves_no_gate_of_an_exclusive_or() {
        let graph = example();
        let given = graph.specialised("differ", |name| (name == "y").then_some(true));
        assert_eq!(given.gates(), 0);
        assert_eq!(given.outputs, [("differ".to_owned(), 3)]);
        assert_eq!(graph.specialised("both", |_| None).gates(), 1);
    }

    #[test]
    fn clauses_say_what_the_gates_say() {
        let text = example().clauses("both");
        assert!(
            text.starts_with("p cnf 6 11\n-1 0\n-4 2 0\n-4 3 0\n4 -2 -3 0\n"),
            "{text}"
        );
        assert!(text.ends_with("\n4 0\n"), "{text}");
    }

    #[test]
    fn what_is_no_graph_is_refused() {
        for text in [
            "",
            "aag 1 1 0 1 0\n2\n2\n",
            "aig 1 0 1 0 0\n",
            "aig 3 2 0 1 1\n6\n",
        ] {
            assert!(Graph::read(text.as_bytes()).is_err(), "{text:?}");
        }
    }
}
