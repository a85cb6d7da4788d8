//! Random straight-line programs, and their meaning without any simplification or sharing.
#![allow(dead_code, unreachable_pub)] // each test file uses its own part of it

pub mod frames;

use std::collections::HashMap;

use flank_expr::{Binary, Expr, Graph, Unary};

/// A small deterministic generator (Knuth's 64-bit LCG, upper bits).
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, end: usize) -> usize {
        (self.unit() * end as f64) as usize
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// One step of a program; operands are indices of earlier steps.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    Constant(f64),
    Variable(usize),
    Unary(Unary, usize),
    Binary(Binary, usize, usize),
}

/// Steps, the first ones being the variables.
#[derive(Clone, Debug)]
pub struct Program {
    pub variables: usize,
    pub steps: Vec<Step>,
}

/// The point at which tame programs are well conditioned.
pub fn reference_point(variables: usize) -> Vec<f64> {
    (0..variables).map(|k| 0.4 + 0.37 * k as f64).collect()
}

const CONSTANTS: [f64; 10] = [0.0, 1.0, -1.0, 2.0, 0.5, -0.75, 3.0, -2.0, 0.1, 1.5];

impl Program {
    /// Any operations on any operands: most values soon are infinite or not numbers.
    pub fn wild(random: &mut Random, variables: usize, length: usize) -> Program {
        Program::random(random, variables, length, |_, _| true)
    }

    /// Values of moderate size, far from the edges of domains and from kinks, near [`reference_point`].
    pub fn tame(random: &mut Random, variables: usize, length: usize) -> Program {
        let point = reference_point(variables);
        let mut values: Vec<f64> = Vec::new();
        Program::random(random, variables, length, move |step, _| {
            let is_fine = is_tame(step, &values);
            if is_fine {
                values.push(value(step, &point, &values));
            }
            is_fine
        })
    }

    fn random(
        random: &mut Random,
        variables: usize,
        length: usize,
        mut accept: impl FnMut(Step, usize) -> bool,
    ) -> Program {
        let mut steps = Vec::new();
        for k in 0..variables {
            assert!(accept(Step::Variable(k), k));
            steps.push(Step::Variable(k));
        }
        while steps.len() < length {
            let operand = |random: &mut Random| random.below(steps.len());
            let step = match random.below(20) {
                0 | 1 => Step::Constant(random.pick(&CONSTANTS)),
                2..8 => Step::Unary(random.pick(&Unary::ALL), operand(random)),
                8..16 => {
                    let op = random.pick(&Binary::ALL[..4]);
                    Step::Binary(op, operand(random), operand(random))
                }
                _ => {
                    let op = random.pick(&Binary::ALL);
                    Step::Binary(op, operand(random), operand(random))
                }
            };
            if accept(step, steps.len()) {
                steps.push(step);
            }
        }
        Program { variables, steps }
    }

    /// Every step as an expression, with all rules.
    pub fn build<'g>(&self, variables: &[Expr<'g>], graph: &'g Graph) -> Vec<Expr<'g>> {
        let mut built: Vec<Expr<'g>> = Vec::with_capacity(self.steps.len());
        for &step in &self.steps {
            built.push(match step {
                Step::Constant(value) => graph.constant(value),
                Step::Variable(k) => variables[k],
                Step::Unary(op, a) => built[a].unary(op),
                Step::Binary(op, a, b) => built[a].binary(op, built[b]),
            });
        }
        built
    }

    /// Every step as a number, without any rule.
    pub fn evaluate(&self, point: &[f64]) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.steps.len());
        for &step in &self.steps {
            values.push(value(step, point, &values));
        }
        values
    }

    /// Operations that a step is made of if equal ones are shared and nothing is simplified; changes of sign not counted.
    pub fn operations(&self, root: usize) -> usize {
        let mut same: HashMap<String, usize> = HashMap::new();
        let mut canonical: Vec<usize> = Vec::new();
        for (index, step) in self.steps.iter().enumerate() {
            let settled = match *step {
                Step::Unary(op, a) => Step::Unary(op, canonical[a]),
                Step::Binary(op, a, b) => Step::Binary(op, canonical[a], canonical[b]),
                leaf => leaf,
            };
            canonical.push(*same.entry(format!("{settled:?}")).or_insert(index));
        }
        let mut is_used = vec![false; self.steps.len()];
        is_used[canonical[root]] = true;
        let mut count = 0;
        for index in (0..=canonical[root]).rev().filter(|&k| canonical[k] == k) {
            if !is_used[index] {
                continue;
            }
            match self.steps[index] {
                Step::Unary(op, a) => {
                    is_used[canonical[a]] = true;
                    count += usize::from(op != Unary::Neg);
                }
                Step::Binary(_, a, b) => {
                    is_used[canonical[a]] = true;
                    is_used[canonical[b]] = true;
                    count += 1;
                }
                _ => {}
            }
        }
        count
    }
}

fn value(step: Step, point: &[f64], values: &[f64]) -> f64 {
    match step {
        Step::Constant(value) => value,
        Step::Variable(k) => point[k],
        Step::Unary(op, a) => op.apply(values[a]),
        Step::Binary(op, a, b) => op.apply(values[a], values[b]),
    }
}

fn is_tame(step: Step, values: &[f64]) -> bool {
    const MARGIN: f64 = 0.05;
    let has_room = match step {
        Step::Constant(_) | Step::Variable(_) => return true,
        Step::Unary(op, a) => match op {
            Unary::Sqrt | Unary::Ln => values[a] > MARGIN,
            Unary::Acosh => values[a] > 1.0 + MARGIN,
            Unary::Arcinv => values[a].abs() > MARGIN,
            Unary::Asin | Unary::Acos | Unary::Atanh => values[a].abs() < 1.0 - MARGIN,
            Unary::Tan => values[a].cos().abs() > 0.2,
            Unary::Abs | Unary::Sign => values[a].abs() > MARGIN,
            _ => true,
        },
        Step::Binary(op, a, b) => match op {
            Binary::Div => values[b].abs() > MARGIN,
            Binary::Pow => values[a] > MARGIN,
            Binary::Min | Binary::Max => (values[a] - values[b]).abs() > MARGIN,
            Binary::Atan2 => values[a].abs() > MARGIN,
            _ => true,
        },
    };
    let size = match step {
        Step::Unary(op, a) => op.apply(values[a]),
        Step::Binary(op, a, b) => op.apply(values[a], values[b]),
        _ => 1.0,
    };
    has_room && (MARGIN..20.0).contains(&size.abs())
}
