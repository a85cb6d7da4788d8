//! Tapes as machine code: what the suite of all evaluators does not reach.

mod support;

use flank_expr::{Expr, Graph, InstructionSet, LANES, LaneEvaluator, LaneTape, Tape};
use support::{Program, Random};

fn assert_same_bits(a: &LaneEvaluator<'_>, b: &LaneEvaluator<'_>, outputs: usize, lanes: usize) {
    for k in 0..outputs {
        for lane in 0..lanes {
            let (a, b) = (a.output(k)[lane], b.output(k)[lane]);
            assert!(a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan(), "output {k}, lane {lane}: {a} {b}");
        }
    }
}

/// Lanes that differ, a few at a time, with values that live longer than there are registers, across calls.
#[test]
fn random_programs_in_different_lanes() {
    let mut random = Random(11);
    for round in 0..60 {
        let program = Program::wild(&mut random, 5, 40 + 12 * round);
        let graph = Graph::new();
        let variables: Vec<Expr<'_>> = (0..5).map(|k| graph.variable(format!("x{k}"))).collect();
        let outputs = program.build(&variables, &graph);
        let tape = LaneTape::new(&Tape::new(&outputs, &variables).expect("every variable is an input"));
        let mut plain = LaneEvaluator::new(&tape, InstructionSet::widest());
        let values: [[f64; LANES]; 5] = std::array::from_fn(|_| std::array::from_fn(|_| random.between(-3.0, 3.0)));
        values.iter().enumerate().for_each(|(k, values)| *plain.input(k) = *values);
        plain.run();
        for instructions in InstructionSet::available() {
            let mut evaluator = LaneEvaluator::new(&tape, instructions);
            values.iter().enumerate().for_each(|(k, values)| *evaluator.input(k) = *values);
            for count in [1, 4, 5, 8, 9, LANES - 1, LANES, LANES + 1] {
                evaluator.run_first(count);
                assert_same_bits(&plain, &evaluator, outputs.len(), count.min(LANES));
            }
        }
    }
}

/// One lane with an angle for the long reduction, beside one that is no number.
#[test]
fn far_angles_in_one_lane() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    let outputs = [y.sin(), x.cos() * y, x.sin() + y.sin(), (x * y).cos()];
    let tape = LaneTape::new(&Tape::new(&outputs, &[x, y]).expect("x and y are the inputs"));
    let mut all: Vec<_> =
        InstructionSet::available().into_iter().map(|instructions| LaneEvaluator::new(&tape, instructions)).collect();
    for far in [1e6, -4e15, 1e300, f64::INFINITY] {
        for evaluator in &mut all {
            *evaluator.input(0) = std::array::from_fn(|lane| 0.1 * lane as f64);
            *evaluator.input(1) = std::array::from_fn(|lane| -0.3 * lane as f64);
            evaluator.input(0)[7] = far;
            evaluator.input(1)[7] = f64::NAN;
            evaluator.input(1)[9] = far;
            evaluator.run();
        }
        all.iter().for_each(|evaluator| assert_same_bits(&all[0], evaluator, outputs.len(), LANES));
    }
}
