//! Grids that are solved band after band: the same points, whoever asks for them and however many at once.

use flank_expr::geometry::{Surface, Vector3};
use flank_expr::{Expr, Graph};
use flank_solver::{Band, BoundSurface, Outcome, Range, SurfacePoint, SurfaceProblem};

/// A surface over `u` and `v`, asked for by `height + 0.3 sin 3u` and `u`.
fn waves(height: impl for<'g> Fn(Expr<'g>) -> Expr<'g>, lowest_v: f64) -> SurfaceProblem {
    let graph = Graph::new();
    let [u, v] = ["u", "v"].map(|name| graph.variable(name));
    let surface = Surface::parametric([u, v], Vector3([u, v, 0.3 * u * v]), false);
    let ranges = vec![Range { low: -3.0, high: 3.0 }, Range { low: lowest_v, high: 2.0 }];
    SurfaceProblem::new(&BoundSurface::new(&surface, ranges, &[]), [height(v) + 0.3 * (3.0 * u).sin(), u])
        .expect("nothing is unbound")
}

/// It has no point where the first is less than `0.3 sin 3u`: it turns back along a wavy line. With `v` of either sign there are
/// two branches.
fn turning_back(lowest_v: f64) -> SurfaceProblem {
    waves(|v| v * v, lowest_v)
}

/// It has points between two wavy lines, which it approaches far away.
fn between_lines() -> SurfaceProblem {
    waves(|v| v / (1.0 + v * v).sqrt(), 0.0)
}

/// Both unknowns follow from linear equations. Some points are outside.
fn in_closed_form() -> SurfaceProblem {
    waves(|v| 2.0 * v, 0.1)
}

fn target(counts: [usize; 2]) -> impl Fn(usize, usize) -> [f64; 2] {
    let value = |low: f64, high: f64, k: usize, count: usize| low + (high - low) * k as f64 / (count.max(2) - 1) as f64;
    move |i, j| [value(-0.1, 1.5, i, counts[0]), value(-2.0, 2.0, j, counts[1])]
}

fn all_targets(counts: [usize; 2]) -> Vec<[f64; 2]> {
    let target = target(counts);
    (0..counts[0] * counts[1]).map(|k| target(k / counts[1], k % counts[1])).collect()
}

/// The points as they come, band by band.
fn streamed(problem: &SurfaceProblem, counts: [usize; 2]) -> Vec<SurfacePoint> {
    let mut points: Vec<SurfacePoint> = Vec::new();
    let take = |band: &Band<'_>| {
        assert_eq!(band.rows().start * counts[1], points.len(), "rows come in order");
        assert_eq!(band.points().count(), band.len());
        points.extend(band.points());
        Ok::<_, ()>(())
    };
    problem.in_bands(target(counts), counts, None, take).expect("nothing fails");
    assert_eq!(points.len(), counts[0] * counts[1]);
    points
}

fn bits(points: &[SurfacePoint]) -> Vec<(Outcome, Vec<u64>)> {
    let numbers = |p: &SurfacePoint| [&p.unknowns[..], &p.position, &p.normal, &[p.residual]].concat();
    points.iter().map(|p| (p.outcome, numbers(p).iter().map(|x| x.to_bits()).collect())).collect()
}

#[test]
fn bands_have_the_bits_of_the_whole() {
    for (at_once, counts) in [
        (300, [150, 40]),
        (3000, [150, 40]),
        (10, [1, 50]),
        (10, [2, 50]),
        (10, [50, 1]),
        (10, [5, 7]),
        (usize::MAX, [9, 8]),
    ] {
        for problem in [turning_back(0.0), in_closed_form()] {
            let problem = problem.at_once(at_once);
            let (whole, _) = problem.solve(&all_targets(counts), counts);
            let on = |threads: usize| {
                let pool =
                    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
                pool.install(|| bits(&streamed(&problem, counts)))
            };
            assert!(on(1) == bits(&whole), "{at_once} {counts:?}");
            assert!(on(3) == bits(&whole), "{at_once} {counts:?}");
        }
    }
}

/// The order of work leaves its trace in the last digits only.
#[test]
fn bands_solve_what_is_solved_in_one_piece() {
    let counts = [150, 40];
    let (whole, _) = between_lines().solve(&all_targets(counts), counts);
    for at_once in [300, 1000, 2000] {
        let banded = streamed(&between_lines().at_once(at_once), counts);
        for ((whole, banded), target) in whole.iter().zip(&banded).zip(all_targets(counts)) {
            assert_eq!(
                whole.outcome == Outcome::Solved,
                banded.outcome == Outcome::Solved,
                "{target:?} {whole:?} {banded:?}"
            );
            if whole.outcome == Outcome::Solved {
                // what a residual of 1e-11 leaves open where the height rises least
                let near = whole.unknowns.iter().zip(&banded.unknowns).all(|(a, b)| (a - b).abs() <= 1e-9);
                assert!(near, "{target:?} {whole:?} {banded:?}");
            }
        }
        assert!((1000..5000).contains(&banded.iter().filter(|point| point.outcome == Outcome::Solved).count()));
    }
}

#[test]
fn several_branches_are_refused_in_every_band() {
    let counts = [60, 20];
    let problem = turning_back(-2.0).at_once(100);
    assert!(streamed(&problem, counts).iter().all(|point| point.outcome == Outcome::Ambiguous));
}

#[test]
fn what_takes_the_bands_can_stop_them() {
    let counts = [60, 20];
    let mut taken = 0;
    let ended = turning_back(0.0).at_once(100).in_bands(target(counts), counts, None, |band| {
        taken += band.rows().len();
        if taken > 10 { Err(taken) } else { Ok(()) }
    });
    assert_eq!(ended, Err(12));
}
