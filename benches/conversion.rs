//! A pinion carried over to the free-form machine: its positions, its series, and the proof of what these leave.

use divan::{Bencher, black_box};
use flank_expr::Graph;
use flank_solver::{PoseProblem, Posture, Range};
use flank_tests::conversion::{Conversion, compiled};

/// Of the roll that the flank needs, rad.
const ROLL: Range = Range { low: -0.181, high: 0.199 };

fn main() {
    divan::main();
}

/// With a posture in the middle of the roll.
fn pinion<'g>(graph: &'g Graph) -> (PoseProblem<'g>, Posture) {
    let (job, target) = compiled(graph, ["specs/bevel/pinion_19x62.chain", "specs/machines/free_form.chain"]);
    let problem = Conversion::new(graph, &job, &target, ["work", "cutter"]).problem;
    let first = problem.postures(&[middle()]).swap_remove(0);
    (problem, first)
}

fn middle() -> f64 {
    0.5 * (ROLL.low + ROLL.high)
}

/// Both ways from the middle.
#[divan::bench]
fn positions_1001(bencher: Bencher) {
    let graph = Graph::new();
    let (problem, first) = pinion(&graph);
    let way = |end: f64| -> Vec<Vec<f64>> {
        (0..=500).map(|k| vec![middle() + (end - middle()) * f64::from(k) / 500.0]).collect()
    };
    let ways = [way(ROLL.low), way(ROLL.high)];
    bencher.bench_local(|| ways.each_ref().map(|way| problem.follow(black_box(&first), way)));
}

#[divan::bench(args = [6, 12, 30])]
fn series(bencher: Bencher, order: usize) {
    let graph = Graph::new();
    let (problem, first) = pinion(&graph);
    bencher.bench_local(|| problem.series(black_box(&first), &[middle()], 0, order));
}

#[divan::bench]
fn proof(bencher: Bencher) {
    let graph = Graph::new();
    let (problem, first) = pinion(&graph);
    bencher.bench_local(|| problem.tube(black_box(&first), middle(), ROLL));
}
