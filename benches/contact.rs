//! Contact of the published bevel pair: found, followed with its edges, its vertex, and the pattern on the gear.

use std::f64::consts::TAU;

use divan::{Bencher, black_box};
use flank_expr::Graph;
use flank_solver::{ContactProblem, GapProblem};
use flank_tests::job;
use flank_tests::pairs::with_pair;

const PAIR: &str = "specs/pairs/bevel_19x62.chain";
/// A pitch of the pinion, and where on its roll the error is extreme.
const PITCH: f64 = TAU / 19.0;
const VERTEX: f64 = -0.035_716_443_622_5;
/// The gap of a mate of the same tooth, mm.
const REACH: f64 = 4.0;

fn main() {
    divan::main();
}

/// The equations, with those of edges.
#[divan::bench]
fn equations(bencher: Bencher) {
    bencher.bench_local(|| {
        let graph = Graph::new();
        with_pair(&job(&graph, PAIR, &[]), &[], true, |pair, _| ContactProblem::new(black_box(pair)))
    });
}

/// Without a start value.
#[divan::bench]
fn found(bencher: Bencher) {
    let graph = Graph::new();
    with_pair(&job(&graph, PAIR, &[]), &[], true, |pair, points| {
        let problem = ContactProblem::new(pair).expect("all bound");
        bencher.bench_local(|| problem.find(black_box(VERTEX), points));
    });
}

/// 101 positions from first to last touch: flank, tip and toe.
#[divan::bench]
fn path_101(bencher: Bencher) {
    let graph = Graph::new();
    with_pair(&job(&graph, PAIR, &[]), &[], true, |pair, points| {
        let problem = ContactProblem::new(pair).expect("all bound");
        let first = problem.find(VERTEX, points).expect("they touch");
        let limits = [VERTEX - 1.5 * PITCH, VERTEX + 1.5 * PITCH];
        bencher.bench_local(|| problem.engagement(black_box(&first), PITCH, 33, limits));
    });
}

/// Where the error is extreme, from a position beside it.
#[divan::bench]
fn vertex(bencher: Bencher) {
    let graph = Graph::new();
    with_pair(&job(&graph, PAIR, &[]), &[], true, |pair, points| {
        let problem = ContactProblem::new(pair).expect("all bound");
        let first = problem.find(VERTEX + 0.05, points).expect("they touch");
        bencher.bench_local(|| problem.vertex_near(black_box(&first)));
    });
}

/// Where one pair of teeth hands over to the next.
#[divan::bench]
fn transfer(bencher: Bencher) {
    let graph = Graph::new();
    with_pair(&job(&graph, PAIR, &[]), &[], true, |pair, points| {
        let problem = ContactProblem::new(pair).expect("all bound");
        let first = problem.find(VERTEX, points).expect("they touch");
        let of = problem.engagement(&first, PITCH, 33, [VERTEX - 2.0 * PITCH, VERTEX + 2.0 * PITCH]);
        bencher.bench_local(|| problem.transfer(black_box(&of), [0, -1], [0.05, 0.2]));
    });
}

/// The gap at 15 x 31 points of the gear's flank over 181 positions.
#[divan::bench]
fn pattern_15x31x181(bencher: Bencher) {
    let graph = Graph::new();
    with_pair(&job(&graph, PAIR, &[]), &[], true, |pair, points| {
        let problem = ContactProblem::new(pair).expect("all bound");
        let first = problem.find(VERTEX, points).expect("they touch");
        let of = problem.engagement(&first, PITCH, 60, [VERTEX - 2.0 * PITCH, VERTEX + 2.0 * PITCH]);
        let lag = |step: isize| of.carried(step).expect("a pair carries").lag;
        let roll = |step: isize| VERTEX + step as f64 * PITCH / 60.0;
        let positions: Vec<[f64; 2]> = (-90..=90).map(|step| [roll(step), lag(step)]).collect();
        let gaps = GapProblem::new(pair, 1).expect("all bound");
        bencher.bench_local(|| gaps.least(black_box(points[1]), &positions, points[0], REACH));
    });
}
