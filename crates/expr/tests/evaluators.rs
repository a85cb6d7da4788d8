//! Every evaluator of tapes passes one suite against the oracle.

#[path = "evaluators/suite.rs"]
mod suite;
mod support;

use flank_expr::{
    Graph, InstructionSet, Interval, IntervalEvaluator, LANES, LaneEvaluator, LaneTape, ScalarEvaluator, Tape,
    TaylorEvaluator, Varies,
};
use suite::Subject;

struct Scalar;

impl Subject for Scalar {
    type Value = f64;

    fn evaluate(tape: &Tape, points: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut evaluator = ScalarEvaluator::new(tape);
        points
            .iter()
            .map(|point| {
                let mut outputs = vec![f64::NAN; tape.output_count()];
                evaluator.run(point, &mut outputs);
                outputs
            })
            .collect()
    }

    fn agrees(expected: f64, found: &f64) -> bool {
        expected.to_bits() == found.to_bits() || expected.is_nan() && found.is_nan()
    }
}

evaluator_suite!(scalar, Scalar);

/// Boxes that are points.
struct Points;

impl Subject for Points {
    type Value = Interval;

    fn evaluate(tape: &Tape, points: &[Vec<f64>]) -> Vec<Vec<Interval>> {
        let mut evaluator = IntervalEvaluator::new(tape);
        points
            .iter()
            .map(|point| {
                let inputs: Vec<Interval> = point.iter().copied().map(Interval::point).collect();
                let mut outputs = vec![Interval::EMPTY; tape.output_count()];
                evaluator.run(&inputs, &mut outputs);
                outputs
            })
            .collect()
    }

    /// What is not a number is never claimed to be one.
    fn agrees(expected: f64, found: &Interval) -> bool {
        if expected.is_nan() { !found.continuous } else { found.contains(expected) }
    }
}

evaluator_suite!(intervals, Points);

/// The same where the later half of the inputs stays as it is: the same bits.
struct HalfKnown;

impl Subject for HalfKnown {
    type Value = Interval;

    fn evaluate(tape: &Tape, points: &[Vec<f64>]) -> Vec<Vec<Interval>> {
        let plain = Points::evaluate(tape, points);
        for (point, expected) in points.iter().zip(&plain) {
            let inputs: Vec<Interval> = point.iter().copied().map(Interval::point).collect();
            let (given, last) = inputs.split_at(inputs.len() / 2);
            let mut evaluator = IntervalEvaluator::with_last_inputs(tape, last);
            let mut outputs = vec![Interval::EMPTY; tape.output_count()];
            // whatever was computed before
            let elsewhere: Vec<Interval> = given.iter().map(|x| Interval::point(x.lo + 1.0)).collect();
            evaluator.run(&elsewhere, &mut outputs);
            evaluator.run(given, &mut outputs);
            assert_eq!(&outputs, expected, "{point:?}");
        }
        plain
    }

    fn agrees(expected: f64, found: &Interval) -> bool {
        Points::agrees(expected, found)
    }
}

evaluator_suite!(half_known_intervals, HalfKnown);

/// The same in two parts, wherever the second one begins: the same bits.
struct TwoParts;

impl Subject for TwoParts {
    type Value = Interval;

    fn evaluate(tape: &Tape, points: &[Vec<f64>]) -> Vec<Vec<Interval>> {
        let plain = Points::evaluate(tape, points);
        for first in 0..=tape.output_count() {
            let mut evaluator = IntervalEvaluator::in_two_parts(tape, first);
            for (point, expected) in points.iter().zip(&plain) {
                let inputs: Vec<Interval> = point.iter().copied().map(Interval::point).collect();
                let mut outputs = vec![Interval::EMPTY; tape.output_count()];
                let (before, after) = outputs.split_at_mut(first);
                evaluator.run_first(&inputs, before);
                evaluator.run_rest(after);
                assert_eq!(&outputs, expected, "{first} of the outputs at {point:?}");
                evaluator.run(&inputs, &mut outputs);
                assert_eq!(&outputs, expected, "all at once at {point:?}");
            }
        }
        plain
    }

    fn agrees(expected: f64, found: &Interval) -> bool {
        Points::agrees(expected, found)
    }
}

evaluator_suite!(intervals_in_two_parts, TwoParts);

/// Power series, of which the suite sees the constant terms.
struct Series;

impl Subject for Series {
    type Value = f64;

    fn evaluate(tape: &Tape, points: &[Vec<f64>]) -> Vec<Vec<f64>> {
        const ORDER: usize = 3;
        let mut evaluator = TaylorEvaluator::new(tape, ORDER);
        points
            .iter()
            .map(|point| {
                let inputs: Vec<f64> = point.iter().flat_map(|&x| [x, 1.0, -0.5, 0.25]).collect();
                let mut outputs = vec![f64::NAN; (ORDER + 1) * tape.output_count()];
                evaluator.run(&inputs, &mut outputs);
                outputs.into_iter().step_by(ORDER + 1).collect()
            })
            .collect()
    }

    fn agrees(expected: f64, found: &f64) -> bool {
        Scalar::agrees(expected, found)
    }
}

evaluator_suite!(power_series, Series);

/// Blocks of lanes, on every set of instructions that the machine has.
struct Lanes;

impl Lanes {
    fn on(instructions: InstructionSet, tape: &Tape, points: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let laid_out = LaneTape::new(tape);
        let mut evaluator = LaneEvaluator::new(&laid_out, instructions);
        let mut rows = Vec::new();
        for block in points.chunks(LANES) {
            let point = |lane: usize| &block[lane.min(block.len() - 1)];
            for k in 0..tape.input_count() {
                for (lane, value) in evaluator.input(k).iter_mut().enumerate() {
                    *value = point(lane)[k];
                }
            }
            evaluator.run();
            let row = |lane: usize| (0..tape.output_count()).map(|k| evaluator.output(k)[lane]).collect();
            rows.extend((0..block.len()).map(row));
        }
        rows
    }
}

impl Subject for Lanes {
    type Value = f64;

    fn evaluate(tape: &Tape, points: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut all = InstructionSet::available().into_iter().map(|set| Lanes::on(set, tape, points));
        let plain = all.next().expect("every machine has plain instructions");
        for other in all {
            let pairs = plain.iter().flatten().zip(other.iter().flatten());
            assert!(pairs.into_iter().all(|(a, b)| Lanes::agrees(*a, b)), "{plain:?}, on other instructions {other:?}");
        }
        plain
    }

    fn agrees(expected: f64, found: &f64) -> bool {
        Scalar::agrees(expected, found)
    }
}

evaluator_suite!(lanes, Lanes);

/// Inputs of every kind; what is computed once for all lanes is carried to another evaluator.
struct Varying;

impl Varying {
    fn rows(tape: &Tape, points: &[Vec<f64>], instructions: InstructionSet, first: usize) -> Vec<Vec<f64>> {
        const KINDS: [Varies; 4] = [Varies::ByRun, Varies::Freely, Varies::ByLane, Varies::Seldom];
        let varies: Vec<Varies> = (0..tape.input_count()).map(|k| KINDS[(k + first) % 4]).collect();
        let laid_out = LaneTape::with_inputs(tape, &varies);
        let [mut one, mut other] = [(); 2].map(|()| LaneEvaluator::new(&laid_out, instructions));
        let put = |evaluator: &mut LaneEvaluator<'_>, point: &[f64], has_run: bool| {
            for (k, &value) in point.iter().enumerate() {
                match varies[k] {
                    Varies::ByRun if has_run => evaluator.set_uniform(k, value),
                    Varies::ByRun => {}
                    Varies::Seldom => evaluator.set_uniform(k, value),
                    Varies::ByLane | Varies::Freely => evaluator.input(k).fill(value),
                }
            }
        };
        let mut row = |point: &Vec<f64>| {
            put(&mut one, point, true);
            let mut prepared = Vec::new();
            one.prepare(&mut prepared);
            put(&mut other, point, false);
            other.set_prepared(&prepared);
            [&mut one, &mut other].into_iter().for_each(LaneEvaluator::run);
            let [row, same] = [&one, &other]
                .map(|run| (0..tape.output_count()).map(|k| run.output(k)[LANES - 1]).collect::<Vec<f64>>());
            assert!(row.iter().zip(&same).all(|(a, b)| Varying::agrees(*a, b)), "{row:?}, carried over {same:?}");
            row
        };
        points.iter().map(&mut row).collect()
    }
}

impl Subject for Varying {
    type Value = f64;

    fn evaluate(tape: &Tape, points: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let rows = |instructions| (0..4).map(move |first| Varying::rows(tape, points, instructions, first));
        let mut all: Vec<_> = InstructionSet::available().into_iter().flat_map(rows).collect();
        let plain = all.swap_remove(0);
        for other in all {
            let pairs = plain.iter().flatten().zip(other.iter().flatten());
            assert!(pairs.into_iter().all(|(a, b)| Varying::agrees(*a, b)), "{plain:?}, otherwise {other:?}");
        }
        plain
    }

    fn agrees(expected: f64, found: &f64) -> bool {
        Scalar::agrees(expected, found)
    }
}

evaluator_suite!(varying_inputs, Varying);

/// What depends on uniform inputs alone is no work of lanes, and what depends on the lane alone none of each run.
#[test]
fn parts_are_computed_as_often_as_their_inputs_change() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    let tape = Tape::new(&[y.sin().exp() * x, y.cos()], &[x, y]).expect("every variable is an input");
    let stages = |varies| LaneTape::with_inputs(&tape, varies).stages();
    assert_eq!(LaneTape::new(&tape).stages(), [0, 0, 3]);
    // the product, and the cosine spread over the lanes
    assert_eq!(stages(&[Varies::Freely, Varies::ByRun]), [2, 0, 2]);
    assert_eq!(stages(&[Varies::Freely, Varies::ByLane]), [0, 2, 1]);
    assert_eq!(stages(&[Varies::ByLane, Varies::Seldom]), [2, 1, 1]);
    assert_eq!(stages(&[Varies::ByLane, Varies::ByRun]), [2, 0, 2]);
}

/// Evaluators that are wrong in one way each: the suite must notice.
mod the_suite_notices {
    use super::*;
    use flank_expr::{Operation, Unary};

    /// Runs a tape by hand with the mistake in `write`.
    fn run(tape: &Tape, point: &[f64], write: impl Fn(&mut [f64], usize, f64)) -> Vec<f64> {
        let mut registers = vec![0.0; tape.register_count()];
        registers[..point.len()].copy_from_slice(point);
        registers[point.len()..][..tape.constants().len()].copy_from_slice(tape.constants());
        for step in tape.instructions() {
            let (a, b) = (registers[step.a as usize], registers[step.b as usize]);
            let value = match step.operation {
                Operation::SinCos => {
                    write(&mut registers, step.b as usize, Unary::Cos.apply(a));
                    Unary::Sin.apply(a)
                }
                Operation::Unary(op) => op.apply(a),
                Operation::Curve(order) => tape.curves()[step.b as usize].value(order, a),
                Operation::Binary(op) => op.apply(a, b),
                Operation::Middle | Operation::Settled | Operation::Widened => {
                    unreachable!("no roots or integrals here")
                }
            };
            write(&mut registers, step.out as usize, value);
        }
        let read = |&register: &u32| registers[register as usize];
        tape.outputs().iter().map(read).collect()
    }

    macro_rules! mistake {
        ($name:ident $subject:ident $check:ident $write:expr) => {
            struct $subject;

            impl Subject for $subject {
                type Value = f64;

                fn evaluate(tape: &Tape, points: &[Vec<f64>]) -> Vec<Vec<f64>> {
                    points.iter().map(|point| run(tape, point, $write)).collect()
                }

                fn agrees(expected: f64, found: &f64) -> bool {
                    Scalar::agrees(expected, found)
                }
            }

            #[test]
            #[should_panic(expected = "oracle")]
            fn $name() {
                suite::$check::<$subject>();
            }
        };
    }

    mistake!(one_unit_in_the_last_place LastPlace every_unary_alone |registers, out, value| {
        registers[out] = value.next_up();
    });
    mistake!(a_lost_sign_of_zero LostSign every_binary_alone |registers, out, value| {
        registers[out] = if value == 0.0 { 0.0 } else { value };
    });
    mistake!(a_nan_that_became_a_number LostNan random_programs |registers, out, value| {
        registers[out] = if value.is_nan() { 0.0 } else { value };
    });
    mistake!(a_register_too_far Neighbour combinations |registers, out, value| {
        registers[(out + 1) % registers.len()] = value;
    });
}

/// Registers are free again after their last use, also that of both operands at once.
#[test]
fn a_long_chain_runs_in_a_few_registers() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    let mut f = x;
    for _ in 0..100 {
        f = (f * f - y).sin() + f.cos();
    }
    let tape = Tape::new(&[f], &[x, y]).expect("every variable is an input");
    assert_eq!(tape.instructions().len(), 500);
    assert!(tape.register_count() <= 5, "{} registers", tape.register_count());
}
