//! Simplification on construction: all rules together keep values and save operations.

mod support;

use flank_expr::{Binary, Expr, Graph, Instruction, Operation, Tape, Unary};
use support::{Program, Random, Step, reference_point};

/// A number and a bound of what rounding can make of it, whatever the order of operations.
#[derive(Clone, Copy, Debug)]
struct Rounded {
    value: f64,
    error: f64,
}

impl Rounded {
    fn unary(op: Unary, a: Rounded) -> Rounded {
        let value = op.apply(a.value);
        // the largest change over the range of the operand, by three samples
        let spread =
            [a.value - a.error, a.value + a.error].map(|x| (op.apply(x) - value).abs()).into_iter().fold(0.0, f64::max);
        Rounded { value, error: 2.0 * spread + f64::EPSILON * value.abs() }
    }

    fn binary(op: Binary, a: Rounded, b: Rounded) -> Rounded {
        let value = op.apply(a.value, b.value);
        let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
        let spread = corners
            .map(|(s, t)| (op.apply(a.value + s * a.error, b.value + t * b.error) - value).abs())
            .into_iter()
            .fold(0.0, f64::max);
        let operands = match op {
            Binary::Add | Binary::Sub => a.value.abs() + b.value.abs(),
            _ => 0.0,
        };
        Rounded { value, error: 2.0 * spread + f64::EPSILON * (value.abs() + operands) }
    }

    fn run(program: &Program, point: &[f64]) -> Vec<Rounded> {
        let exact = |value| Rounded { value, error: 0.0 };
        let mut values: Vec<Rounded> = Vec::new();
        for &step in &program.steps {
            values.push(match step {
                Step::Constant(value) => exact(value),
                Step::Variable(k) => exact(point[k]),
                Step::Unary(op, a) => Rounded::unary(op, values[a]),
                Step::Binary(op, a, b) => Rounded::binary(op, values[a], values[b]),
            });
        }
        values
    }
}

#[test]
fn random_programs_keep_their_values() {
    let mut random = Random(4);
    let mut compared = 0;
    for _ in 0..300 {
        let program = Program::tame(&mut random, 3, 120);
        let graph = Graph::new();
        let variables: Vec<Expr<'_>> = (0..3).map(|k| graph.variable(format!("x{k}"))).collect();
        let built = program.build(&variables, &graph);
        let point = reference_point(3);
        let found = graph.evaluate(&built, &point);
        for (index, (found, expected)) in found.into_iter().zip(Rounded::run(&program, &point)).enumerate() {
            if expected.error > 1e-6 * expected.value.abs() {
                continue;
            }
            compared += 1;
            assert!(
                (found - expected.value).abs() <= 4.0 * expected.error + 1e-15,
                "step {index}: {found} instead of {expected:?}: {}",
                built[index]
            );
        }
    }
    assert!(compared > 10_000, "only {compared} steps were well conditioned");
}

#[test]
fn substitution_keeps_values() {
    let mut random = Random(5);
    for _ in 0..50 {
        let program = Program::tame(&mut random, 3, 80);
        let graph = Graph::new();
        let [x, y, z, w] = ["x", "y", "z", "w"].map(|name| graph.variable(name));
        let built = program.build(&[x, y, z], &graph);
        let [a, b, c] = reference_point(3)[..] else { panic!("three") };
        // x = 2w, y = w + (b − w), z = a number; x and y swapped twice
        let replaced = graph.substitute(&built, &[(x, 2.0 * w), (y, w + (b - a / 2.0)), (z, graph.constant(c))]);
        let swapped = graph.substitute(&graph.substitute(&built, &[(x, y), (y, x)]), &[(x, y), (y, x)]);
        let point = [a, b, c, a / 2.0];
        let expected = Rounded::run(&program, &[a, b, c]);
        let found = graph.evaluate(&replaced, &point);
        let again = graph.evaluate(&swapped, &point);
        for (k, expected) in expected.iter().enumerate() {
            let tolerance = 20.0 * expected.error + 1e-13;
            if expected.error < 1e-9 {
                assert!((found[k] - expected.value).abs() <= tolerance, "{} is {}", built[k], found[k]);
                assert!((again[k] - expected.value).abs() <= tolerance, "{} is {}", built[k], again[k]);
            }
        }
    }
}

/// Operations of an expression; changes of sign are not counted.
fn operations(root: Expr<'_>, inputs: &[Expr<'_>]) -> usize {
    let tape = Tape::new(&[root], inputs).expect("every variable is an input");
    let is_counted = |step: &&Instruction| step.operation != Operation::Unary(Unary::Neg);
    tape.instructions().iter().filter(is_counted).count()
}

/// All trees of up to three operations over a few letters and operations that have rules.
#[test]
fn no_rule_makes_a_small_tree_longer() {
    let leaves = [Step::Variable(0), Step::Variable(1), Step::Constant(2.0), Step::Constant(-0.75)];
    let none: Vec<Vec<Step>> = leaves.iter().map(|&leaf| vec![leaf]).collect();
    let one = grown(&[&none], &[(&none, &none)]);
    let two = grown(&[&one], &[(&one, &none), (&none, &one)]);
    let three = grown(&[&two], &[(&two, &none), (&none, &two), (&one, &one)]);
    assert!(three.len() > 100_000, "{} trees", three.len());
    for tree in one.iter().chain(&two).chain(&three) {
        check_length(tree);
    }
}

type Trees = [Vec<Step>];

/// An operation more: on each of the trees, and on each pair.
fn grown(trees: &[&Trees], pairs: &[(&Trees, &Trees)]) -> Vec<Vec<Step>> {
    let mut made = Vec::new();
    for tree in trees.iter().copied().flatten() {
        for op in [Unary::Neg, Unary::Sin, Unary::Cos, Unary::Sqrt] {
            let root = Step::Unary(op, tree.len() - 1);
            made.push(tree.iter().copied().chain([root]).collect());
        }
    }
    for (left, right) in pairs
        .iter()
        .flat_map(|(lefts, rights)| lefts.iter().flat_map(|left| rights.iter().map(move |right| (left, right))))
    {
        let moved = right.iter().map(|&step| match step {
            Step::Unary(op, a) => Step::Unary(op, a + left.len()),
            Step::Binary(op, a, b) => Step::Binary(op, a + left.len(), b + left.len()),
            leaf => leaf,
        });
        let both: Vec<Step> = left.iter().copied().chain(moved).collect();
        for op in &Binary::ALL[..4] {
            let root = Step::Binary(*op, left.len() - 1, both.len() - 1);
            made.push(both.iter().copied().chain([root]).collect());
        }
    }
    made
}

fn check_length(steps: &[Step]) {
    let program = Program { variables: 2, steps: steps.to_vec() };
    let graph = Graph::new();
    let letters = ["x", "y"].map(|name| graph.variable(name));
    let root = program.build(&letters, &graph)[steps.len() - 1];
    let (with, without) = (operations(root, &letters), program.operations(steps.len() - 1));
    assert!(with <= without, "{with} operations instead of {without}: {root} from {steps:?}");
}

#[test]
fn rules_save_operations_in_the_sum() {
    let mut random = Random(6);
    let (mut with, mut without) = (0, 0);
    for _ in 0..200 {
        let program = Program::tame(&mut random, 3, 100);
        let graph = Graph::new();
        let variables: Vec<Expr<'_>> = (0..3).map(|k| graph.variable(format!("x{k}"))).collect();
        let root = program.build(&variables, &graph)[99];
        with += operations(root, &variables);
        without += program.operations(99);
    }
    assert!(with * 100 < without * 95, "{with} with rules, {without} without");
}
