//! The contact of the published bevel pair, for the count of instructions: `rolling JOB REPETITIONS`, the job one of [`JOBS`].

use std::env::args;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::process::ExitCode;

use flank_expr::Graph;
use flank_solver::{ContactProblem, GapProblem, RollingPair, SurfacePoint};
use flank_tests::job;
use flank_tests::pairs::with_pair;

const JOBS: [&str; 5] = ["found", "path", "vertex", "transfer", "pattern"];
/// A pitch of the pinion, and where on its roll the error is extreme.
const PITCH: f64 = TAU / 19.0;
const VERTEX: f64 = -0.035_716_443_622_5;
/// The gap of a mate of the same tooth, mm.
const REACH: f64 = 4.0;

fn main() -> ExitCode {
    let words: Vec<String> = args().skip(1).collect();
    let repetitions = words.get(1).and_then(|word| word.parse().ok());
    let (Some(name), Some(repetitions)) = (words.first().filter(|name| JOBS.contains(&name.as_str())), repetitions)
    else {
        eprintln!("usage: rolling JOB REPETITIONS, the job one of {}", JOBS.join(", "));
        return ExitCode::FAILURE;
    };
    let graph = Graph::new();
    with_pair(&job(&graph, "specs/pairs/bevel_19x62.chain", &[]), &[], true, |pair, points| {
        repeat(name, repetitions, pair, points)
    });
    ExitCode::SUCCESS
}

fn repeat(name: &str, repetitions: usize, pair: &RollingPair<'_, '_>, points: [&[SurfacePoint]; 2]) {
    let problem = ContactProblem::new(pair).expect("all bound");
    let first = problem.find(VERTEX + 0.05, points).expect("they touch");
    let limits = [VERTEX - 2.0 * PITCH, VERTEX + 2.0 * PITCH];
    let of = problem.engagement(&first, PITCH, 60, limits);
    let lag = |step: isize| of.carried(step).expect("a pair carries").lag;
    let positions: Vec<[f64; 2]> =
        (-90..=90).map(|step| [first.roll + step as f64 * PITCH / 60.0, lag(step)]).collect();
    let gaps = GapProblem::new(pair, 1).expect("all bound");
    for _ in 0..repetitions {
        match name {
            "found" => drop(black_box(problem.find(VERTEX, points))),
            "path" => drop(black_box(problem.engagement(&first, PITCH, 33, limits))),
            "vertex" => drop(black_box(problem.vertex_near(&first))),
            "transfer" => drop(black_box(problem.transfer(&of, [0, -1], [0.05, 0.2]))),
            _ => drop(black_box(gaps.least(points[1], &positions, points[0], REACH))),
        }
    }
}
