//! A tape as statements.

use super::Language;
use super::helpers::{Helper, Helpers};
use super::names::{Scope, curve, local};
use crate::symbolic::curve::Curve;
use crate::symbolic::op::{Binary, Unary};
use crate::tape::{Instruction, Operation, Tape};

/// The statements of a function and the helpers that they call.
pub(super) struct Body {
    pub(super) statements: Vec<String>,
    pub(super) helpers: Helpers,
}

impl Body {
    /// Of a tape whose first outputs are values, all others derivatives.
    pub(super) fn new(language: Language, scope: &Scope, tape: &Tape, values: usize) -> Body {
        let mut writer = Writer {
            language,
            function: scope.function(),
            curves: tape.curves().iter().map(|curve| domain_text(language, curve)).collect(),
            registers: registers(language, scope, tape),
            locals: 0,
            body: Body { statements: Vec::new(), helpers: Helpers::default() },
        };
        for name in unread(scope, tape) {
            writer.body.statements.extend(language.unused(name));
        }
        for (number, curve) in tape.curves().iter().enumerate() {
            writer.body.statements.push(curve_table(language, number, curve));
        }
        for &instruction in tape.instructions() {
            writer.write(instruction);
        }
        for (index, &register) in tape.outputs().iter().enumerate() {
            let place = match index.checked_sub(values) {
                None => format!("values[{index}]"),
                Some(index) => format!("derivatives[{index}]"),
            };
            let stored = format!("{place} = {};", writer.registers[register as usize]);
            writer.body.statements.push(stored);
        }
        writer.body
    }
}

/// What each register of a tape holds at first, as text.
fn registers(language: Language, scope: &Scope, tape: &Tape) -> Vec<String> {
    let numbers = tape.constants().iter().map(|value| language.number(*value));
    let mut registers: Vec<String> = scope.arguments().iter().cloned().chain(numbers).collect();
    registers.resize(tape.register_count(), String::new());
    registers
}

/// Arguments that no instruction and no output reads.
fn unread<'a>(scope: &'a Scope, tape: &Tape) -> impl Iterator<Item = &'a String> {
    let reads = tape.instructions().iter().flat_map(|step| match step.operation {
        Operation::Binary(_) | Operation::Settled => [step.a, step.b],
        Operation::Middle | Operation::Widened => [step.a; 2],
        Operation::Unary(_) | Operation::Curve(_) | Operation::SinCos => [step.a; 2],
    });
    let read: Vec<u32> = reads.chain(tape.outputs().iter().copied()).collect();
    (0u32..).zip(scope.arguments()).filter(move |(register, _)| !read.contains(register)).map(|(_, name)| name)
}

fn domain_text(language: Language, curve: &Curve) -> String {
    let (low, high) = curve.domain();
    format!("{}, {}", language.number(low), language.number(high))
}

/// Left knot and cubic of each piece.
fn curve_table(language: Language, number: usize, of: &Curve) -> String {
    let row = |index: usize| {
        let (knot, coefficients) = of.piece(index);
        [knot].into_iter().chain(coefficients).collect()
    };
    let rows: Vec<Vec<f64>> = (0..of.piece_count()).map(row).collect();
    language.table(&curve(number), &rows)
}

struct Writer<'a> {
    language: Language,
    function: &'a str,
    /// Lower and upper end of each curve, as arguments.
    curves: Vec<String>,
    registers: Vec<String>,
    locals: usize,
    body: Body,
}

impl Writer<'_> {
    fn write(&mut self, Instruction { operation, out, a, b }: Instruction) {
        let [x, y] = [a, b].map(|register| self.registers.get(register as usize).cloned().unwrap_or_default());
        match operation {
            Operation::Unary(op) => {
                let text = self.unary(op, &x);
                self.define(out, &text);
            }
            Operation::Binary(op) => {
                let text = self.binary(op, &x, &y);
                self.define(out, &text);
            }
            Operation::Curve(order) => {
                let (table, domain) = (curve(b as usize), self.curves[b as usize].clone());
                let pieces = match self.language {
                    Language::C => format!("{table}, (int)(sizeof {table} / sizeof {table}[0])"),
                    Language::Rust | Language::JavaScript => table,
                };
                let text = self.call(Helper::Curve, &[&pieces, &domain, &order.to_string(), &x]);
                self.define(out, &text);
            }
            Operation::Middle | Operation::Widened => self.registers[out as usize] = x,
            Operation::Settled => {
                let size = self.unary(Unary::Abs, &y);
                let root = self.library("sqrt", &[&format!("{} - {size}", self.language.number(1.0))]);
                let text = format!("{x} + {} * {root}", self.language.number(0.0));
                self.define(out, &text);
            }
            Operation::SinCos => {
                let [sine, cosine] = ["sin", "cos"].map(|name| self.library(name, &[&x]));
                self.define(out, &sine);
                self.define(b, &cosine);
            }
        }
    }

    fn define(&mut self, register: u32, value: &str) {
        self.locals += 1;
        let name = local(self.locals);
        self.body.statements.push(self.language.definition(&name, value));
        self.registers[register as usize] = name;
    }

    /// A call of the language's own library.
    fn library(&self, name: &str, operands: &[&str]) -> String {
        let path = match self.language {
            Language::C => "",
            Language::Rust => "f64::",
            Language::JavaScript => "Math.",
        };
        format!("{path}{name}({})", operands.join(", "))
    }

    fn call(&mut self, helper: Helper, operands: &[&str]) -> String {
        self.body.helpers.insert(helper);
        format!("{}_{}({})", self.function, helper.name(), operands.join(", "))
    }

    fn unary(&mut self, op: Unary, x: &str) -> String {
        let name = match op {
            Unary::Neg if x.starts_with('-') => return format!("-({x})"),
            Unary::Neg => return format!("-{x}"),
            Unary::Sign => return self.call(Helper::Sign, &[x]),
            Unary::Arcinv => return self.call(Helper::Arcinv, &[x]),
            Unary::Abs if self.language == Language::C => "fabs",
            Unary::Ln if self.language != Language::Rust => "log",
            Unary::Sqrt | Unary::Sin | Unary::Cos | Unary::Tan | Unary::Asin | Unary::Acos | Unary::Atan => op.name(),
            Unary::Sinh | Unary::Cosh | Unary::Tanh | Unary::Asinh | Unary::Acosh | Unary::Atanh => op.name(),
            Unary::Exp | Unary::Ln | Unary::Abs => op.name(),
        };
        self.library(name, &[x])
    }

    fn binary(&mut self, op: Binary, x: &str, y: &str) -> String {
        match op {
            Binary::Add | Binary::Sub | Binary::Mul | Binary::Div => format!("{x} {} {y}", op.name()),
            Binary::Pow => match self.language {
                Language::C => self.library("pow", &[x, y]),
                Language::Rust => self.library("powf", &[x, y]),
                Language::JavaScript => self.call(Helper::Pow, &[x, y]),
            },
            Binary::Atan2 => self.library("atan2", &[x, y]),
            Binary::Min => self.call(Helper::Min, &[x, y]),
            Binary::Max => self.call(Helper::Max, &[x, y]),
        }
    }
}
