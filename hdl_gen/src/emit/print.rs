//! The text of a module's file, from its plan.

use std::fmt::Write;

use super::expression::{Expression, LINE, literal};
use super::plan::{Item, Plan, RegisterGroup, Section, WriteBlock};
use crate::netlist::{Meaning, Module, Operation, Wire};
use crate::simulate::RESET;

/// The name of the clock.
pub(super) const CLOCK: &str = "clk_i";
/// Assignments line up within a block, unless a name is longer than this.
const ALIGNED_NAME: usize = 28;

/// The file of a module.
pub(super) fn print(module: &Module, tool_version: &str) -> String {
    let plan = Plan::new(module);
    let mut file = File {
        text: String::new(),
        plan,
    };
    file.header(tool_version);
    file.ports();
    file.constants();
    // Taken out while it is printed from, since printing needs the rest of the plan.
    let sections = std::mem::take(&mut file.plan.sections);
    for (section, title) in sections.iter().zip(&module.sections) {
        file.section(section, title);
    }
    file.plan.sections = sections;
    file.outputs();
    file.unread();
    file.gap();
    file.text += "endmodule\n\n`default_nettype wire\n";
    file.text
}

struct File<'m> {
    text: String,
    plan: Plan<'m>,
}

impl File<'_> {
    fn line(&mut self, line: &str) {
        self.text += line.trim_end();
        self.text.push('\n');
    }

    /// An empty line between blocks; none behind a heading or a line that is empty.
    fn gap(&mut self) {
        let last = self.text.trim_end_matches('\n').lines().next_back();
        let heading = last.is_some_and(|line| line.starts_with("    // ----"));
        if !heading && !self.text.ends_with("\n\n") {
            self.text.push('\n');
        }
    }

    fn header(&mut self, tool_version: &str) {
        let module = self.plan.module;
        self.line(&format!("// {}", module.name));
        self.line("//");
        for line in &module.description {
            self.line(&format!("// {line}"));
        }
        if !module.description.is_empty() {
            self.line("//");
        }
        self.line(&match module.latency {
            0 if module.is_clocked() => "// Latency: none stated.".to_owned(),
            0 => "// Latency: none, the outputs follow the inputs.".to_owned(),
            1 => "// Latency: 1 cycle.".to_owned(),
            cycles => format!("// Latency: {cycles} cycles."),
        });
        self.line(&format!("// Emitted by stepwell {tool_version}."));
        self.line("\n`default_nettype none");
        self.gap();
    }

    fn ports(&mut self) {
        let module = self.plan.module;
        // Direction and kind, width, name, remark.
        let mut ports: Vec<(&str, u32, String, String)> = Vec::new();
        if module.is_clocked() {
            ports.push(("input  wire", 1, CLOCK.to_owned(), String::new()));
        }
        if module.has_reset() {
            let remark = "synchronous, active low".to_owned();
            ports.push(("input  wire", 1, RESET.to_owned(), remark));
        }
        for &wire in &module.inputs {
            let node = module.node(wire);
            let name = node.name.clone().unwrap_or_default();
            ports.push(("input  wire", node.width, name, remark(node.meaning)));
        }
        for (name, wire) in &module.outputs {
            let node = module.node(*wire);
            let register = matches!(node.operation, Operation::Register { .. })
                && self.plan.signal(*wire) == Some(name);
            let kind = if register {
                "output reg "
            } else {
                "output wire"
            };
            ports.push((kind, node.width, name.clone(), remark(node.meaning)));
        }
        let width = ports
            .iter()
            .map(|port| range(port.1).len())
            .max()
            .unwrap_or_default();
        let name = ports
            .iter()
            .map(|port| port.2.len())
            .max()
            .unwrap_or_default();
        self.line(&format!("module {} (", module.name));
        let last = ports.len().saturating_sub(1);
        for (index, (kind, bits, port, remark)) in ports.iter().enumerate() {
            let port = format!("{port}{}", if index == last { "" } else { "," });
            let mut line = format!("    {kind} {:width$}{port}", range(*bits));
            if !remark.is_empty() {
                let pad = name + 1 - port.len();
                let _ = write!(line, "{} // {remark}", " ".repeat(pad));
            }
            self.line(&line);
        }
        self.line(");");
    }

    fn heading(&mut self, title: &str) {
        self.gap();
        self.line(&format!("    // ---- {title} ----"));
    }

    /// Named constants as localparams. Those that only shaped the netlist, such as widths, are
    /// told in comments: Verilog has no use for them, and lint tools complain of what has none.
    fn constants(&mut self) {
        let module = self.plan.module;
        let mut lines = Vec::new();
        let reason = |name: &str| {
            let found = module
                .localparams
                .iter()
                .find(|constant| constant.name == name);
            found.map_or(String::new(), |constant| constant.reason.clone())
        };
        let mut printed = Vec::new();
        for (index, node) in module.nodes.iter().enumerate() {
            let (Operation::Constant(value), Some(name)) = (&node.operation, &node.name) else {
                continue;
            };
            if self.plan.is_read(Wire(index as u32)) {
                let text = format!(
                    "localparam {}{name} = {};",
                    range(node.width),
                    literal(*value, node.width)
                );
                lines.push((text, reason(name)));
                printed.push(name);
            }
        }
        let width = lines
            .iter()
            .map(|(text, _)| text.len())
            .max()
            .unwrap_or_default();
        let shaped: Vec<_> = module
            .localparams
            .iter()
            .filter(|constant| !printed.contains(&&constant.name))
            .collect();
        if lines.is_empty() && shaped.is_empty() {
            return;
        }
        self.heading("constants");
        for (text, reason) in lines {
            self.line(&match reason.as_str() {
                "" => format!("    {text}"),
                reason => format!("    {text:width$}  // {reason}"),
            });
        }
        if !shaped.is_empty() {
            self.line("    // Built into the widths and literals below:");
            let name = shaped.iter().map(|constant| constant.name.len()).max();
            let name = name.unwrap_or_default();
            let values: Vec<_> = shaped.iter().map(|c| c.value.to_string()).collect();
            let value = values.iter().map(String::len).max().unwrap_or_default();
            for (constant, number) in shaped.iter().zip(&values) {
                let start = format!("    //   {:name$} = {number:>value$}  ", constant.name);
                let next_line = format!("\n    //{}", " ".repeat(start.len() - 6));
                let reason = wrapped(&constant.reason, start.len(), &next_line);
                self.line(&format!("{start}{reason}"));
            }
        }
    }

    fn section(&mut self, section: &Section, title: &str) {
        let module = self.plan.module;
        if section.registers.is_empty()
            && section.items.is_empty()
            && section.groups.is_empty()
            && section.memories.is_empty()
            && section.writes.is_empty()
        {
            return;
        }
        if title == "ports" {
            self.gap();
        } else {
            self.heading(title);
        }
        // One column for the names of all that is declared here.
        let wires = section.items.iter().filter_map(|item| match item {
            Item::Wire { wire, .. } => Some(*wire),
            Item::Instance(_) | Item::Outputs(_) => None,
        });
        let declared = section.registers.iter().copied().chain(wires);
        let memories = section
            .memories
            .iter()
            .map(|&place| &module.memories[place]);
        let column = declared
            .filter(|&wire| !self.plan.is_port(wire))
            .map(|wire| module.width(wire))
            .chain(memories.clone().map(|memory| memory.width))
            .map(|width| range(width).len())
            .max()
            .unwrap_or_default();
        for &wire in &section.registers {
            if !self.plan.is_port(wire) {
                let name = self.plan.signal(wire).unwrap_or_default();
                let range = range(module.width(wire));
                self.line(&format!("    reg  {range:column$}{name};"));
            }
        }
        for memory in memories {
            let (range, last) = (range(memory.width), memory.words - 1);
            if memory.in_block {
                self.line("    (* ram_style = \"block\" *)");
            }
            self.line(&format!(
                "    reg  {range:column$}{} [0:{last}];",
                memory.name
            ));
        }
        let alike = |a: &Item, b: &Item| match (a, b) {
            (Item::Wire { wire: a, .. }, Item::Wire { wire: b, .. }) => {
                self.plan.is_port(*a) == self.plan.is_port(*b)
            }
            _ => false,
        };
        let blocks: Vec<&[Item]> = section.items.chunk_by(alike).collect();
        for block in blocks {
            if let [Item::Instance(instance)] = block {
                self.instance(*instance);
            } else if let [Item::Outputs(instance)] = block {
                self.gap();
                self.instance_outputs(*instance);
                self.gap();
            } else {
                self.wires(block, column);
            }
        }
        for group in &section.groups {
            self.gap();
            self.registers(group);
        }
        for write in &section.writes {
            self.gap();
            self.memory_write(write);
        }
    }

    fn memory_write(&mut self, write: &WriteBlock) {
        let name = &self.plan.module.memories[write.memory].name;
        let place = format!("{name}[{}]", write.address.flat());
        let (condition, indent) = match &write.enable {
            Some(enable) => (format!("if ({}) ", enable.flat()), 12),
            None => (String::new(), 8),
        };
        let mut lines = vec![format!("    always @(posedge {CLOCK}) begin")];
        if write.enable.is_some() {
            lines.push(format!("        {condition}begin"));
        }
        let start = format!("{}{place}", " ".repeat(indent));
        lines.push(assignment(&start, "<=", &write.data));
        if write.enable.is_some() {
            lines.push("        end".to_owned());
        }
        lines.push("    end".to_owned());
        for line in lines {
            self.line(&line);
        }
    }

    /// Consecutive wires with their values, lined up.
    fn wires(&mut self, block: &[Item], column: usize) {
        let module = self.plan.module;
        let rows: Vec<(String, &str, &Expression)> = block
            .iter()
            .filter_map(|item| match item {
                Item::Wire { wire, value } => {
                    let name = self.plan.signal(*wire).unwrap_or_default();
                    let start = if self.plan.is_port(*wire) {
                        "    assign ".to_owned()
                    } else {
                        format!("    wire {:column$}", range(module.width(*wire)))
                    };
                    Some((start, name, value))
                }
                Item::Instance(_) | Item::Outputs(_) => None,
            })
            .collect();
        let lengths = rows.iter().map(|(_, name, _)| name.len());
        let name_width = lengths
            .filter(|&length| length <= ALIGNED_NAME)
            .max()
            .unwrap_or_default();
        let lines: Vec<String> = rows
            .iter()
            .map(|(start, name, value)| {
                assignment(&format!("{start}{name:name_width$}"), "=", value)
            })
            .collect();
        for line in lines {
            self.line(&line);
        }
    }

    /// Declares the wires on the outputs of an instance.
    fn instance_outputs(&mut self, index: usize) {
        let module = self.plan.module;
        let instance = &module.instances[index];
        let Some((_, outputs)) = self.plan.connections[index].clone() else {
            return;
        };
        let declared: Vec<(String, u32)> = outputs
            .iter()
            .zip(&instance.module.outputs)
            .filter(|(name, _)| !module.outputs.iter().any(|(port, _)| port == *name))
            .map(|(name, (_, driver))| (name.clone(), instance.module.width(*driver)))
            .collect();
        let column = declared.iter().map(|(_, width)| range(*width).len()).max();
        for (name, width) in &declared {
            let column = column.unwrap_or_default();
            self.line(&format!("    wire {:column$}{name};", range(*width)));
        }
    }

    fn instance(&mut self, index: usize) {
        let module = self.plan.module;
        let instance = &module.instances[index];
        let Some((inputs, outputs)) = self.plan.connections[index].clone() else {
            return;
        };
        self.gap();
        if !instance.ahead {
            self.instance_outputs(index);
        }
        let mut ports: Vec<(String, String)> = Vec::new();
        if instance.module.is_clocked() {
            ports.push((CLOCK.to_owned(), CLOCK.to_owned()));
        }
        if instance.module.has_reset() {
            ports.push((RESET.to_owned(), RESET.to_owned()));
        }
        let input_names = instance.module.inputs.iter().map(|&wire| {
            let name = instance.module.node(wire).name.clone();
            name.unwrap_or_default()
        });
        ports.extend(input_names.zip(inputs.iter().map(Expression::flat)));
        let output_names = instance.module.outputs.iter().map(|(name, _)| name.clone());
        ports.extend(output_names.zip(outputs));
        let width = ports
            .iter()
            .map(|(port, _)| port.len())
            .max()
            .unwrap_or_default();
        self.line(&format!("    {} {} (", instance.module.name, instance.name));
        let last = ports.len().saturating_sub(1);
        for (index, (port, value)) in ports.iter().enumerate() {
            let comma = if index == last { "" } else { "," };
            self.line(&format!("        .{port:width$} ({value}){comma}"));
        }
        self.line("    );");
        self.gap();
    }

    fn registers(&mut self, group: &RegisterGroup) {
        let name = |wire: Wire| self.plan.signal(wire).unwrap_or_default();
        let names = group.registers.iter().map(|&(wire, _, _)| name(wire).len());
        let width = names
            .filter(|&length| length <= ALIGNED_NAME)
            .max()
            .unwrap_or_default();
        let with_reset = group.registers.iter().any(|(_, reset, _)| reset.is_some());
        let condition = group
            .enable
            .as_ref()
            .map(|enable| format!("if ({}) ", enable.flat()));
        let condition = condition.unwrap_or_default();
        let mut lines = vec![format!("    always @(posedge {CLOCK}) begin")];
        let deep = with_reset || group.enable.is_some();
        let indent = " ".repeat(if deep { 12 } else { 8 });
        if with_reset {
            lines.push(format!("        if (!{RESET}) begin"));
            for (wire, reset, _) in &group.registers {
                let bits = self.plan.module.width(*wire);
                let value = literal(reset.unwrap_or_default(), bits);
                lines.push(format!("{indent}{:width$} <= {value};", name(*wire)));
            }
            lines.push(format!("        end else {condition}begin"));
        } else if deep {
            lines.push(format!("        {condition}begin"));
        }
        for (wire, _, value) in &group.registers {
            let start = format!("{indent}{:width$}", name(*wire));
            lines.push(assignment(&start, "<=", value));
        }
        if deep {
            lines.push("        end".to_owned());
        }
        lines.push("    end".to_owned());
        for line in lines {
            self.line(&line);
        }
    }

    fn outputs(&mut self) {
        let outputs = std::mem::take(&mut self.plan.outputs);
        if outputs.is_empty() {
            return;
        }
        self.heading("outputs");
        let width = outputs
            .iter()
            .map(|(name, _)| name.len())
            .max()
            .unwrap_or_default();
        for (name, value) in &outputs {
            self.line(&assignment(
                &format!("    assign {name:width$}"),
                "=",
                value,
            ));
        }
    }

    /// Gathers the bits that nothing reads in a signal whose name tells lint tools so.
    fn unread(&mut self) {
        let module = self.plan.module;
        let mut unread = Vec::new();
        let connected = |pred: fn(&Module) -> bool| {
            let mut instances = module.instances.iter().zip(&self.plan.connections);
            instances.any(|(instance, used)| used.is_some() && pred(&instance.module))
        };
        if module.is_clocked() && !self.plan.has_registers(false) && !connected(Module::is_clocked)
        {
            unread.push(Expression::atom(CLOCK));
        }
        if module.has_reset() && !self.plan.has_registers(true) && !connected(Module::has_reset) {
            unread.push(Expression::atom(RESET));
        }
        unread.extend(self.plan.unread());
        if unread.is_empty() {
            return;
        }
        unread.insert(0, Expression::atom("1'b0"));
        self.heading("bits that nothing reads");
        self.line("    // Gathered here so that lint tools see that they are known to end.");
        let name = self.plan.new_name("unused");
        let start = format!("    wire {name} = &");
        let bits = Expression::Concat(unread).broken(start.len());
        self.line(&format!("{start}{bits};"));
    }
}

/// `start = value;`, on several lines where one would be too long; below the name where the name
/// leaves no room beside it.
fn assignment(start: &str, operator: &str, value: &Expression) -> String {
    let beside = format!("{start} {operator} ");
    let text = format!("{beside}{};", value.broken(beside.len()));
    if text.lines().all(|line| line.len() <= LINE) {
        return text;
    }
    let column = 4 + start.len() - start.trim_start().len();
    let indent = " ".repeat(column);
    let below = value.broken(column);
    format!("{} {operator}\n{indent}{below};", start.trim_end())
}

/// A remark behind text that ends at `column`, on as many lines as it takes.
fn wrapped(remark: &str, column: usize, line_break: &str) -> String {
    let mut text = String::new();
    let mut at = column;
    for word in remark.split_whitespace() {
        if at > column && at + word.len() > LINE {
            text.truncate(text.trim_end().len());
            text += line_break;
            at = column;
        }
        text += word;
        text.push(' ');
        at += word.len() + 1;
    }
    text
}

/// `[7:0] `, or nothing for one bit.
fn range(width: u32) -> String {
    match width {
        1 => String::new(),
        _ => format!("[{}:0] ", width - 1),
    }
}

/// How a port's bits are meant, for the reader.
fn remark(meaning: Meaning) -> String {
    match meaning {
        Meaning::Bits => String::new(),
        Meaning::Signed => "two's complement".to_owned(),
        Meaning::Float(format) => format!("float {format}"),
        Meaning::Fixed(format) => format!("fixed {format}"),
    }
}
