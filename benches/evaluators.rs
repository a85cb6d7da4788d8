//! Kernels and evaluators: the flank of `spiral_bevel.chain`, residuals with Jacobian, one point at a time and in lanes.

use divan::{Bencher, black_box, counter::ItemsCount};
use flank_chain_dsl::compile_text;
use flank_expr::{
    Binary, End, Graph, InstructionSet, Interval, LANES, LaneEvaluator, LaneTape, ScalarEvaluator, Tape, Unary,
    integral,
};
use flank_solver::{BoundSurface, Range, SurfaceProblem};

fn main() {
    divan::main();
}

/// Unknowns and targets near the middle of the flank.
const POINT: [f64; 5] = [5.4, -2.45, -0.26, 81.0, 27.0];

fn flank_tape() -> Tape {
    let graph = Graph::new();
    let compilation = compile_text(&graph, "spiral_bevel", include_str!("spiral_bevel.chain"), &[]);
    let job = &compilation.jobs[0];
    let surface = &job.surfaces[0];
    let sample = surface.sample.as_ref().expect("a sample");
    let coordinates = sample.functions();
    let ranges = surface.unknowns.iter().map(|u| Range { low: u.low, high: u.high }).collect();
    let problem = SurfaceProblem::new(&BoundSurface::new(&surface.surface, ranges, &job.bindings()), coordinates)
        .expect("all bound");
    problem.system().tape().clone()
}

#[divan::bench]
fn flank_one_by_one(bencher: Bencher) {
    let tape = flank_tape();
    let (mut evaluator, mut out) = (ScalarEvaluator::new(&tape), vec![0.0; tape.output_count()]);
    bencher.counter(ItemsCount::new(1usize)).bench_local(|| evaluator.run(black_box(&POINT), black_box(&mut out)));
}

/// On each set of instructions that the machine has, the plain one first.
#[divan::bench(args = 0..InstructionSet::available().len())]
fn flank_in_lanes(bencher: Bencher, set: usize) {
    let tape = LaneTape::new(&flank_tape());
    let mut evaluator = LaneEvaluator::new(&tape, InstructionSet::available()[set]);
    for (k, value) in POINT.into_iter().enumerate() {
        evaluator.input(k).fill(value);
    }
    bencher.counter(ItemsCount::new(LANES)).bench_local(|| black_box(&mut evaluator).run());
}

const FUNCTIONS: [Unary; 9] =
    [Unary::Sin, Unary::Cos, Unary::Tan, Unary::Asin, Unary::Acos, Unary::Atan, Unary::Exp, Unary::Ln, Unary::Sqrt];

fn function(of: &str) -> Unary {
    FUNCTIONS.into_iter().find(|op| op.name() == of).expect("one of the functions")
}

#[divan::bench(args = FUNCTIONS.map(Unary::name))]
fn kernel_one_by_one(bencher: Bencher, name: &str) {
    let op = function(name);
    bencher.counter(ItemsCount::new(1usize)).bench_local(|| black_box(op).apply(black_box(0.7)));
}

#[divan::bench(args = FUNCTIONS.map(Unary::name))]
fn kernel_in_lanes(bencher: Bencher, name: &str) {
    let graph = Graph::new();
    let x = graph.variable("x");
    lanes(bencher, &Tape::new(&[x.unary(function(name))], &[x]).expect("x is the input"));
}

#[divan::bench]
fn sine_with_cosine_in_lanes(bencher: Bencher) {
    let graph = Graph::new();
    let x = graph.variable("x");
    lanes(bencher, &Tape::new(&[x.sin(), x.cos()], &[x]).expect("x is the input"));
}

#[divan::bench]
fn atan2_in_lanes(bencher: Bencher) {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    lanes(bencher, &Tape::new(&[y.binary(Binary::Atan2, x)], &[x, y]).expect("x and y are the inputs"));
}

/// The slope of an ellipse's arc over a quarter turn, and the arc: its integral. A point takes value and slope, `by_itself` the value.
#[divan::bench(args = [("integrand", "by_itself"), ("integral", "by_itself"), ("integrand", "with_slopes"), ("integral", "with_slopes")])]
fn arc_in_lanes(bencher: Bencher, (what, how): (&str, &str)) {
    let graph = Graph::new();
    let (p, turn) = (graph.variable("p"), graph.variable("turn"));
    let slope = (p.sin().squared() + 0.64 * p.cos().squared()).sqrt();
    let end = |expr, low, high| End { expr, range: Interval::new(low, high) };
    let ends = [end(graph.constant(0.0), 0.0, 0.0), end(turn, 0.0, std::f64::consts::FRAC_PI_2)];
    let value = match what {
        "integral" => integral(slope, p, ends, &[]).expect("it is smooth"),
        _ => graph.substitute(&[slope], &[(p, turn)])[0],
    };
    let slopes = [value, value.derivative(turn), value.derivative(turn).derivative(turn)];
    let outputs = if how == "by_itself" { &slopes[..1] } else { &slopes[..] };
    lanes(bencher, &Tape::new(outputs, &[turn]).expect("turn is the input"));
}

fn lanes(bencher: Bencher, tape: &Tape) {
    let laid_out = LaneTape::new(tape);
    let mut evaluator = LaneEvaluator::new(&laid_out, InstructionSet::fastest());
    for k in 0..tape.input_count() {
        for (lane, value) in evaluator.input(k).iter_mut().enumerate() {
            *value = 0.1 + 0.02 * lane as f64;
        }
    }
    bencher.counter(ItemsCount::new(LANES)).bench_local(|| black_box(&mut evaluator).run());
}
