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
            // one place at a time, and of the outputs only the first ones
            for lane in [0, 3, LANES - 1] {
                let mut found = vec![0.0; outputs.len().div_ceil(2)];
                evaluator.run_at(&values.map(|values| values[lane]), &mut found);
                for (k, found) in found.into_iter().enumerate() {
                    let expected = plain.output(k)[lane];
                    assert!(
                        found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan(),
                        "{k}, {lane}"
                    );
                }
            }
        }
    }
}

/// Outputs in memory of the caller are those that are kept otherwise, however they are computed.
#[test]
fn outputs_go_to_memory_of_the_caller() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    // one of them in memory as it is, one the same in all lanes
    let outputs = [x * y, x, graph.constant(2.5), y.sin(), x + y.cos()];
    let laid_out = || LaneTape::new(&Tape::new(&outputs, &[x, y]).expect("x and y are the inputs"));
    let (kept, written) = (laid_out(), laid_out().writing(4));
    let values = |scale: f64| std::array::from_fn(|lane| scale * (lane as f64 - 9.5));
    for instructions in InstructionSet::available() {
        let [mut expected, mut found] = [&kept, &written].map(|tape| LaneEvaluator::new(tape, instructions));
        // an angle of the second ones takes the long reduction
        for scale in [0.3, 1e6] {
            for evaluator in [&mut expected, &mut found] {
                *evaluator.input(0) = values(0.7);
                *evaluator.input(1) = values(scale);
            }
            expected.run();
            // at a line of the caches, and beside it
            for beside in [0, 1] {
                let mut memory = [f64::NAN; 6 * LANES];
                let first = memory.as_ptr().align_offset(64) + beside;
                found.run_into(LANES, memory[first..].as_chunks_mut().0.split_at_mut(4).0);
                instructions.settle();
                let out = memory[first..].as_chunks().0;
                (0..4).for_each(|k| assert_eq!(expected.output(k), &out[k], "{instructions:?}"));
                assert_eq!(expected.output(4), found.output(4));
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
