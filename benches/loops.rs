//! A closed loop of three axes beside the same machine with these axes driven: the flank of `arm.chain`, the same grid to the same points.
//!
//! The ratio is printed, of the fastest runs of both, which take turns.

use std::time::{Duration, Instant};

use divan::{Bencher, black_box};
use flank_chain_dsl::{compile_text, render};
use flank_expr::Graph;
use flank_solver::{BoundSurface, Range, SurfacePoint, SurfaceProblem};

const JOBS: [&str; 2] = ["driven", "closed"];
/// Pairs of runs of the small grid.
const RUNS: usize = 200;
/// How far apart the points of both may be, mm.
const SAME: f64 = 1e-11;

/// Rows and columns: what a search for further branches takes counts the less, the more points there are.
const SIDES: [usize; 2] = [101, 1001];

fn main() {
    SIDES.into_iter().for_each(print_ratio);
    divan::main();
}

/// The flank of a job as a problem, the points that are asked for, and how many rows and columns these are.
fn flank(job: &str, side: usize) -> (SurfaceProblem, Vec<[f64; 2]>, [usize; 2]) {
    let graph = Graph::new();
    let side = ("side".to_string(), side.to_string());
    let compilation = compile_text(&graph, "arm", include_str!("arm.chain"), &[side]);
    assert!(!compilation.has_errors(), "{}", render(&compilation.diagnostics, &compilation.sources, false));
    let job = compilation.jobs.iter().find(|known| known.name == job).expect("a job of the text");
    let surface = &job.surfaces[0];
    let sample = surface.sample.as_ref().expect("a sample");
    let coordinates = sample.functions();
    let ranges = surface.unknowns.iter().map(|u| Range { low: u.low, high: u.high }).collect();
    let problem = SurfaceProblem::new(&BoundSurface::new(&surface.surface, ranges, &job.bindings()), coordinates)
        .expect("all bound");
    (problem, sample.targets(), sample.counts)
}

fn print_ratio(side: usize) {
    let both = JOBS.map(|job| flank(job, side));
    let [driven, closed] = both.each_ref().map(|(problem, targets, counts)| problem.solve(targets, *counts).0);
    let apart = |one: &SurfacePoint, other: &SurfacePoint| {
        assert_eq!((one.outcome.word(), other.outcome.word()), ("solved", "solved"));
        one.position.iter().zip(other.position).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let apart = driven.iter().zip(&closed).map(|(one, other)| apart(one, other)).fold(0.0, f64::max);
    assert!(apart < SAME, "the points are {apart:e} mm apart");
    let mut best = [Duration::MAX; 2];
    for _ in 0..(RUNS * SIDES[0] / side).max(5) {
        for ((problem, targets, counts), best) in both.iter().zip(&mut best) {
            let start = Instant::now();
            black_box(problem.solve(targets, *counts));
            *best = start.elapsed().min(*best);
        }
    }
    let [driven, closed] = best.map(|best| best.as_secs_f64() * 1e9 / both[0].1.len() as f64);
    let instructions = both.each_ref().map(|(problem, ..)| problem.system().tape().instructions().len());
    println!(
        "{side} x {side} points: driven {driven:.1} ns a point, closed {closed:.1}: {:.2} times; instructions {instructions:?}; points {apart:.0e} mm apart",
        closed / driven
    );
}

#[divan::bench(args = JOBS)]
fn solve(bencher: Bencher, job: &str) {
    let (problem, targets, counts) = flank(job, SIDES[0]);
    bencher.bench_local(|| problem.solve(black_box(&targets), counts));
}
