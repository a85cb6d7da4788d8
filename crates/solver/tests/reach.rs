//! Branches that leave their ranges: which points count does not depend on where the grid begins, or on how it is sampled.

use std::f64::consts::{PI, TAU};

use flank_expr::geometry::{Surface, Vector3};
use flank_expr::{Expr, Graph};
use flank_solver::{Band, BoundSurface, Outcome, Range, SurfacePoint, SurfaceProblem};

fn range(low: f64, high: f64) -> Range {
    Range { low, high }
}

/// Over `u` and `v`, asked for by two functions of them; followed two ranges beyond its own.
fn plane(
    graph: &Graph,
    coordinates: impl for<'g> Fn(Expr<'g>, Expr<'g>) -> [Expr<'g>; 2],
    ranges: [Range; 2],
    keep: Option<(usize, Range)>,
) -> SurfaceProblem {
    let [u, v] = ["u", "v"].map(|name| graph.variable(name));
    let surface = Surface::parametric([u, v], Vector3([u, v, graph.constant(0.0)]), false);
    let keep: Vec<_> = keep.into_iter().map(|(unknown, range)| ([u, v][unknown], range)).collect();
    let surface = BoundSurface::new(&surface, ranges.to_vec(), &[]);
    let problem = SurfaceProblem::new(&surface, coordinates(u, v)).expect("nothing is unbound");
    let problem = problem.following_beyond(ranges.map(|range| range.beyond(0.0)).to_vec());
    problem.keeping(&surface, &keep).expect("nothing is unbound")
}

/// A grid from one corner to the other.
fn grid(counts: [usize; 2], [a, b]: [Range; 2]) -> Vec<[f64; 2]> {
    let at = |range: Range, k: usize, count: usize| {
        range.low + (range.high - range.low) * k as f64 / (count.max(2) - 1) as f64
    };
    (0..counts[0] * counts[1]).map(|k| [at(a, k / counts[1], counts[0]), at(b, k % counts[1], counts[1])]).collect()
}

/// A corner of the sample lies in the ranges, u from -1 to 1 and v from 0 to 1; the middle lies outside, within what is followed or
/// far beyond it.
#[test]
fn points_in_range_are_found_wherever_the_middle_is() {
    let graph = Graph::new();
    let problem = plane(&graph, |u, v| [u + 0.1 * v * v, v], [range(-1.0, 1.0), range(0.0, 1.0)], None);
    for (sample, beyond) in [([range(0.4, 5.0), range(0.5, 3.0)], false), ([range(0.4, 60.0), range(0.0, 90.0)], true)]
    {
        for counts in [[2, 3], [21, 8], [24, 30], [70, 51]] {
            let targets = grid(counts, sample);
            let (points, effort) = problem.solve(&targets, counts);
            for ([a, b], point) in targets.iter().zip(&points) {
                let u = a - 0.1 * b * b;
                let is_inside = u.abs() <= 1.0 && (0.0..=1.0).contains(b);
                assert_eq!(point.outcome == Outcome::Solved, is_inside, "{counts:?}: {a} {b} {:?}", point.outcome);
                if let Outcome::Outside { unknown, by } = point.outcome {
                    let excess = if unknown == 0 { u.abs() - 1.0 } else { b - 1.0 };
                    assert!((by - excess).abs() < 1e-9);
                }
            }
            let solved = points.iter().filter(|point| point.outcome == Outcome::Solved).count();
            assert!(solved > 0 && !effort.is_given_up);
            let outside = points.iter().filter(|point| matches!(point.outcome, Outcome::Outside { .. })).count();
            assert!(beyond || solved + outside == points.len(), "{counts:?}");
        }
    }
}

/// Where nothing lies in the middle, other points are looked at on all threads at once; which of them count does not depend on that.
#[test]
fn a_branch_looked_for_elsewhere_is_the_same_on_any_number_of_threads() {
    let graph = Graph::new();
    let ranges = [range(-1.0, 1.0), range(0.0, 1.0)];
    let problem = plane(&graph, |u, v| [u + 0.1 * v * v, v], ranges, None);
    let counts = [24, 30];
    for sample in [[range(0.4, 60.0), range(0.0, 90.0)], [range(9.0, 60.0), range(9.0, 90.0)]] {
        let targets = grid(counts, sample);
        let found = [1, 2, 5].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
            pool.install(|| problem.solve(&targets, counts))
        });
        assert!(found[0].1.boxes > 1, "{:?}", found[0].1);
        // as texts: what was never reached is not a number, which does not equal itself
        let [one, two, five] = found.map(|found| format!("{found:?}"));
        assert!(one == two && one == five);
    }
}

/// v = a - u, and sin u = b: the sample keeps the branch about u = 2 pi, which has v below its range in the middle, and within it
/// farther on. The branches before it are within the range in the middle already.
#[test]
fn what_is_kept_counts_in_the_middle_even_out_of_range() {
    let graph = Graph::new();
    let ranges = [range(-1.5, 7.5), range(0.0, 9.0)];
    let fold = |b: f64| TAU + b.asin();
    for counts in [[9, 3], [33, 5], [6, 6]] {
        let targets = grid(counts, [range(0.0, 8.566), range(-0.5, 0.5)]);
        let middle = targets[(counts[0] / 2) * counts[1] + counts[1] / 2];
        let out = middle[0] - fold(middle[1]);
        let problem = plane(&graph, |u, v| [u + v, u.sin()], ranges, Some((0, range(TAU - 1.0, TAU + 1.0))));
        let (points, effort) = problem.solve(&targets, counts);
        assert!(out < 0.0 && !effort.is_kept_elsewhere, "{out}");
        for ([a, b], point) in targets.iter().zip(&points) {
            let v = a - fold(*b);
            assert_eq!(point.outcome == Outcome::Solved, (0.0..=9.0).contains(&v), "{counts:?}: {a} {b} {point:?}");
            assert!(point.outcome != Outcome::Solved || (point.unknowns[0] - fold(*b)).abs() < 1e-9);
        }
        assert!(points.iter().any(|point| point.outcome == Outcome::Solved));
    }
}

/// A branch is kept as far as the condition holds, not in the middle alone.
#[test]
fn what_is_kept_is_so_at_every_point() {
    let graph = Graph::new();
    let ranges = [range(-3.0, 3.0), range(-3.0, 3.0)];
    let problem = plane(&graph, |u, v| [u, v], ranges, Some((0, range(-1.0, 0.5))));
    for counts in [[5, 5], [31, 40]] {
        let targets = grid(counts, [range(-2.0, 2.0), range(-2.0, 2.0)]);
        let (points, _) = problem.solve(&targets, counts);
        for ([a, _], point) in targets.iter().zip(&points) {
            let expected = if (-1.0..=0.5).contains(a) { Outcome::Solved } else { Outcome::NotKept { condition: 0 } };
            assert_eq!(point.outcome, expected, "{a}");
        }
    }
}

/// The surface turns back at a = 0, so that no branch has a point in the middle: what is kept is told by where it was looked at.
#[test]
fn what_is_kept_elsewhere_is_told() {
    let graph = Graph::new();
    let problem = plane(&graph, |u, v| [v * v, u], [range(-1.0, 1.0), range(-3.0, 3.0)], Some((1, range(0.0, 3.0))));
    let targets = grid([9, 5], [range(-6.0, 2.0), range(-0.5, 0.5)]);
    let (points, effort) = problem.solve(&targets, [9, 5]);
    assert!(effort.is_kept_elsewhere && effort.anchor[0] > 0.0, "{effort:?}");
    for ([a, _], point) in targets.iter().zip(&points).filter(|(target, _)| target[0] != 0.0) {
        assert_eq!(point.outcome == Outcome::Solved, *a > 0.0);
        assert!(*a < 0.0 || point.unknowns[1] > 0.0);
    }
}

/// A cylinder that its angle goes round once and more; asked for by y and z, on the side on which the ranges have their seam.
fn cylinder(graph: &Graph, angles: Range) -> SurfaceProblem {
    let [angle, z] = ["angle", "z"].map(|name| graph.variable(name));
    let surface = Surface::parametric([angle, z], Vector3([3.0 * angle.cos(), 3.0 * angle.sin(), z]), false);
    let ranges = vec![angles, range(-1.0, 1.0)];
    let surface = BoundSurface::new(&surface, ranges.clone(), &[]);
    let problem = SurfaceProblem::new(&surface, [3.0 * angle.sin(), z]);
    let problem =
        problem.expect("nothing is unbound").following_beyond(ranges.iter().map(|range| range.beyond(0.0)).collect());
    problem.keeping(&surface, &[(angle.cos(), range(-1.0, 0.0))]).expect("nothing is unbound")
}

fn is_on_the_left(target: [f64; 2], point: &SurfacePoint, angles: Range) -> bool {
    let [y, z] = target;
    let expected = [-(9.0 - y * y).sqrt(), y, z];
    let is_near = point.position.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9);
    let is_in_range = angles.low <= point.unknowns[0] && point.unknowns[0] <= angles.high;
    point.outcome == Outcome::Solved && is_near && is_in_range
}

/// The seam of a full turn is no end of the surface, and what a turn brings back is no other branch.
#[test]
fn a_full_turn_has_no_seam() {
    let graph = Graph::new();
    for angles in [range(-PI, PI), range(-TAU, TAU), range(0.0, TAU), range(-5.0, 20.0), range(PI, 3.0 * PI)] {
        let problem = cylinder(&graph, angles);
        for counts in [[1, 1], [3, 3], [40, 9], [9, 40]] {
            let targets = grid(counts, [range(-2.9, 2.9), range(-1.0, 1.0)]);
            let (points, effort) = problem.solve(&targets, counts);
            assert_eq!(effort.branches.len(), 1, "{angles:?}");
            for (target, point) in targets.iter().zip(&points) {
                assert!(is_on_the_left(*target, point, angles), "{angles:?}, {counts:?}: {target:?} {point:?}");
            }
        }
    }
}

fn in_bands(problem: &SurfaceProblem, targets: &[[f64; 2]], counts: [usize; 2]) -> Vec<SurfacePoint> {
    let mut points = Vec::new();
    let take = |band: &Band<'_>| {
        points.extend(band.points());
        Ok::<_, ()>(())
    };
    problem.in_bands(|i, j| targets[i * counts[1] + j], counts, None, take).expect("nothing fails");
    points
}

/// Also where the grid is handed over in bands.
#[test]
fn bands_across_a_seam_have_the_bits_of_the_whole() {
    let (graph, counts, angles) = (Graph::new(), [150, 40], range(-PI, PI));
    let problem = cylinder(&graph, angles).at_once(300);
    let targets = grid(counts, [range(-2.9, 2.9), range(-1.0, 1.0)]);
    let (whole, _) = problem.solve(&targets, counts);
    assert_eq!(whole, in_bands(&problem, &targets, counts));
    assert!(targets.iter().zip(&whole).all(|(target, point)| is_on_the_left(*target, point, angles)));
}

/// Bands of a branch that the ranges hold only a part of, not with the middle.
#[test]
fn bands_beyond_the_ranges_have_the_bits_of_the_whole() {
    let (graph, counts) = (Graph::new(), [150, 40]);
    let problem =
        plane(&graph, |u, v| [u + 0.1 * (3.0 * v).sin(), v], [range(-1.0, 1.0), range(0.0, 1.0)], None).at_once(300);
    let targets = grid(counts, [range(0.4, 4.5), range(0.0, 1.0)]);
    let (whole, _) = problem.solve(&targets, counts);
    assert_eq!(whole, in_bands(&problem, &targets, counts));
    for ([a, b], point) in targets.iter().zip(&whole) {
        assert_eq!(point.outcome == Outcome::Solved, a - 0.1 * (3.0 * b).sin() <= 1.0, "{a} {b}: {point:?}");
    }
}

/// A branch that does not qualify in the middle is met again at every other point that is tried: it is followed once.
#[test]
fn a_branch_that_does_not_qualify_is_followed_once() {
    let graph = Graph::new();
    let ranges = [range(-1.0, 1.0), range(0.0, 1.0)];
    let keep = Some((0, range(20.0, 21.0)));
    let problem = plane(&graph, |u, v| [u + 0.2 * u * u * u, v + 0.3 * u * v], ranges, keep);
    let counts = [24, 25];
    let targets = grid(counts, [range(-0.9, 0.9), range(0.3, 0.6)]);
    let (points, effort) = problem.solve(&targets, counts);
    assert!(points.iter().all(|point| point.outcome != Outcome::Solved), "none is kept");
    // some hundred points are tried, and to follow the branch takes more than one evaluation a point
    assert!(effort.evaluations < 40 * targets.len() as u64, "{}", effort.evaluations);
}

/// Of more branches than are known again none qualifies: the search for another one ends before all points have been tried.
#[test]
fn branches_that_do_not_qualify_are_not_followed_without_end() {
    let graph = Graph::new();
    let ranges = [range(-1.0, 1.0), range(0.0, 1.0)];
    let problem = plane(&graph, |u, v| [(40.0 * u).sin(), v + 0.3 * u * v], ranges, Some((0, range(20.0, 21.0))));
    let counts = [24, 25];
    let targets = grid(counts, [range(-0.9, 0.9), range(0.35, 0.6)]);
    let (points, effort) = problem.solve(&targets, counts);
    assert!(points.iter().all(|point| point.outcome != Outcome::Solved), "none is kept");
    assert!(effort.is_given_up, "and it is told that not all was looked at");
    // 125 branches are followed from the middle, as far as they lead beyond the ranges, with some 2,700 evaluations each; elsewhere as many as
    // are allowed, where all of them again from each of 256 points would take 80,000,000
    assert!(effort.evaluations < 600_000, "{}", effort.evaluations);
}
