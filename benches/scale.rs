//! Time and memory over the number of points of a grid that is handed over in bands of rows: the flank of `spiral_bevel.chain`.
//!
//! `cargo bench -p flank-benches --bench scale` goes to a million points, with `-- --full` to ten million.

use std::convert::Infallible;
use std::hint::black_box;
use std::time::Instant;

use flank_benches::peak_memory;
use flank_chain_dsl::compile_text;
use flank_expr::Graph;
use flank_solver::{BoundSurface, Range, SurfaceProblem};

/// Rows and columns: 10³ to 10⁷ points.
const SIDES: [usize; 5] = [32, 100, 316, 1000, 3162];

fn main() {
    let is = |flag: &str| std::env::args().any(|argument| argument == flag);
    let sizes = match (is("--test"), is("--full")) {
        (true, _) => 2,
        (_, true) => SIDES.len(),
        _ => SIDES.len() - 1,
    };
    let times: Vec<(f64, f64)> = SIDES[..sizes].iter().map(|side| measured(*side)).collect();
    println!("time grows as points^{:.2}", flank_benches::slope(&times));
}

/// Points, and the fastest time to solve them; the ends of the unknowns are all that is kept.
fn measured(side: usize) -> (f64, f64) {
    let graph = Graph::new();
    let sizes = ["rows", "columns"].map(|name| (name.to_string(), side.to_string()));
    let compilation = compile_text(&graph, "spiral_bevel", include_str!("spiral_bevel.chain"), &sizes);
    let job = &compilation.jobs[0];
    let surface = &job.surfaces[0];
    let sample = surface.sample.as_ref().expect("a sample");
    let coordinates = sample.functions();
    let ranges = surface.unknowns.iter().map(|u| Range { low: u.low, high: u.high }).collect();
    let problem = SurfaceProblem::new(&BoundSurface::new(&surface.surface, ranges, &job.bindings()), coordinates)
        .expect("all bound");
    let start = problem.solve(&[sample.grid.at(side / 2, side / 2)], [1, 1]).0.remove(0).unknowns;
    let points = side * side;
    let run = || {
        let (begin, mut solved) = (Instant::now(), 0);
        let ended = problem.in_bands(
            |i, j| sample.grid.at(i, j),
            sample.counts,
            Some(&start),
            |band| {
                solved += black_box(band).solved();
                Ok::<_, Infallible>(())
            },
        );
        assert!(ended.is_ok() && solved == points, "{solved} of {points} points are solved");
        begin.elapsed().as_secs_f64()
    };
    let runs = (2_000_000 / points).clamp(2, 50);
    let best = (0..runs).map(|_| run()).fold(f64::INFINITY, f64::min);
    println!(
        "{points:9} points: {:6.1} ns a point, {:5.0} MiB at the most so far",
        best * 1e9 / points as f64,
        peak_memory()
    );
    (points as f64, best)
}
