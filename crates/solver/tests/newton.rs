//! Newton and grids on textbook problems: each outcome has a problem that must end in it.

use flank_expr::Graph;
use flank_expr::geometry::{Surface, Vector3};
use flank_solver::{BoundSurface, Outcome, Range, SurfaceProblem, System, TOLERANCE, solve, solve_grid};

fn range(low: f64, high: f64) -> Range {
    Range { low, high }
}

/// x² − a = 0 from a start.
fn square_root(a: f64, ranges: Range, start: f64) -> flank_solver::Solution {
    let graph = Graph::new();
    let (x, parameter) = (graph.variable("x"), graph.variable("a"));
    let system = System::new(&[x * x - parameter], &[x], &[parameter]).expect("nothing is unbound");
    solve(&system, &[ranges], &[a], &[start])
}

#[test]
fn a_root_inside_is_solved_to_rounding() {
    let solution = square_root(2.0, range(0.0, 10.0), 9.0);
    assert_eq!(solution.outcome, Outcome::Solved);
    assert!((solution.unknowns[0] - 2f64.sqrt()).abs() < 4.0 * f64::EPSILON);
    assert!(solution.residual <= TOLERANCE);
}

#[test]
fn a_root_outside_says_which_unknown_and_by_how_much() {
    let solution = square_root(2.0, range(1.5, 10.0), 9.0);
    let Outcome::Outside { unknown: 0, by } = solution.outcome else { panic!("{solution:?}") };
    assert!((by - (1.5 - 2f64.sqrt())).abs() < 1e-12);
}

#[test]
fn a_root_on_the_end_of_its_range_is_inside() {
    assert_eq!(square_root(4.0, range(2.0, 10.0), 9.0).outcome, Outcome::Solved);
    assert_eq!(square_root(4.0, range(0.0, 2.0), 0.5).outcome, Outcome::Solved);
}

#[test]
fn no_root_is_never_a_success() {
    let solution = square_root(-1.0, range(-3.0, 10.0), 9.0);
    assert!(matches!(solution.outcome, Outcome::NotConverged { iterations: 1.. } | Outcome::Singular), "{solution:?}");
    assert!(solution.residual >= 1.0);
}

#[test]
fn a_double_root_is_singular() {
    let solution = square_root(0.0, range(-3.0, 10.0), 9.0);
    assert_ne!(solution.outcome, Outcome::Solved, "a double root has no derivative to stand on: {solution:?}");
}

#[test]
fn a_domain_error_is_not_converged() {
    let graph = Graph::new();
    let x = graph.variable("x");
    let system = System::new(&[(x - 5.0).sqrt() + x], &[x], &[]).unwrap();
    let solution = solve(&system, &[range(0.0, 4.0)], &[], &[1.0]);
    assert_eq!(solution.outcome, Outcome::NotConverged { iterations: solution.iterations });
    assert!(solution.residual.is_nan());
}

#[test]
fn five_unknowns_of_very_different_size() {
    let graph = Graph::new();
    let x: Vec<_> = (0..5).map(|k| graph.variable(format!("x{k}"))).collect();
    let scale = [1e-3, 1.0, 1e3, 1e-1, 1e2];
    let residuals: Vec<_> = (0..5)
        .map(|k| {
            let (a, b) = (x[k] / scale[k], x[(k + 1) % 5] / scale[(k + 1) % 5]);
            a + 0.3 * b.sin() - (1.0 + 0.1 * k as f64)
        })
        .collect();
    let system = System::new(&residuals, &x, &[]).unwrap();
    let ranges: Vec<Range> = scale.iter().map(|s| range(-3.0 * s, 3.0 * s)).collect();
    let solution = solve(&system, &ranges, &[], &[0.0; 5]);
    assert_eq!(solution.outcome, Outcome::Solved, "{solution:?}");
}

/// A sine wave has several roots in the range: the whole grid must stay on one of them.
#[test]
fn a_grid_stays_on_one_branch() {
    let graph = Graph::new();
    let (x, y, a, b) = (graph.variable("x"), graph.variable("y"), graph.variable("a"), graph.variable("b"));
    let system = System::new(&[x.sin() - a, y - b], &[x, y], &[a, b]).unwrap();
    let targets: Vec<[f64; 2]> =
        (0..21).flat_map(|i| (0..5).map(move |j| [-0.9 + 0.09 * f64::from(i), f64::from(j)])).collect();
    let (points, effort) = solve_grid(&system, &[range(-10.0, 10.0), range(-1.0, 5.0)], &targets, [21, 5]);
    assert!(effort.branches.len() > 1, "the ranges hold several branches");
    let branch = |x: f64| ((x / std::f64::consts::PI) + 0.5).floor();
    for point in &points {
        assert_eq!(point.outcome, Outcome::Solved);
        assert_eq!(branch(point.unknowns[0]), branch(points[0].unknowns[0]));
    }
}

/// A branch that leaves the ranges does not continue on another one that happens to lie inside.
#[test]
fn a_grid_does_not_jump_to_a_copy() {
    let graph = Graph::new();
    let (x, y, a, b) = (graph.variable("x"), graph.variable("y"), graph.variable("a"), graph.variable("b"));
    // x is an angle: x and x + 2π give the same point; at its middle the range holds one of them only
    let half = (x / 2.0).tan();
    let system = System::new(&[half - (a / 2.0).tan(), y - b], &[x, y], &[a, b]).unwrap();
    let targets: Vec<[f64; 2]> = (0..41).map(|i| [-2.0 + 0.1 * f64::from(i), 0.0]).collect();
    let (points, _) = solve_grid(&system, &[range(-1.5, 5.0), range(-1.0, 1.0)], &targets, [41, 1]);
    for (target, point) in targets.iter().zip(&points) {
        let inside = target[0] >= -1.5;
        assert_eq!(point.outcome == Outcome::Solved, inside, "at {target:?}: {point:?}");
    }
}

#[test]
fn an_unsolvable_grid_has_a_verdict_for_every_point() {
    let graph = Graph::new();
    let (x, y, a, b) = (graph.variable("x"), graph.variable("y"), graph.variable("a"), graph.variable("b"));
    let system = System::new(&[x * x + 1.0 + a, y - b], &[x, y], &[a, b]).unwrap();
    let (points, effort) = solve_grid(&system, &[range(-1.0, 1.0); 2], &[[0.5, 0.5]; 12], [3, 4]);
    assert_eq!(points.len(), 12);
    assert_eq!(effort.branches.len(), 0);
    assert!(points.iter().all(|point| point.outcome != Outcome::Solved));
}

#[test]
fn empty_grids_and_single_points() {
    let graph = Graph::new();
    let (x, y, a, b) = (graph.variable("x"), graph.variable("y"), graph.variable("a"), graph.variable("b"));
    let system = System::new(&[x - a, y - b], &[x, y], &[a, b]).unwrap();
    assert!(solve_grid(&system, &[range(-1.0, 1.0); 2], &[], [0, 0]).0.is_empty());
    let (points, _) = solve_grid(&system, &[range(-1.0, 1.0); 2], &[[0.25, -0.5]], [1, 1]);
    assert_eq!(points[0].unknowns, [0.25, -0.5]);
}

/// The whole way on a surface without motions: a plunged sphere.
#[test]
fn points_of_a_sphere_by_height_and_angle() {
    let graph = Graph::new();
    let (u, v) = (graph.variable("u"), graph.variable("v"));
    let position = Vector3([5.0 * u.cos() * v.cos(), 5.0 * u.cos() * v.sin(), 5.0 * u.sin()]);
    let sphere = Surface::parametric([u, v], position, true);
    let [x, y, z] = position.0;
    let problem = SurfaceProblem::new(
        &BoundSurface::new(&sphere, vec![range(-1.5, 1.5), range(-3.0, 3.0)], &[]),
        [z, y.atan2(x)],
    )
    .unwrap();
    let targets: Vec<[f64; 2]> = (0..9).map(|k| [-4.0 + f64::from(k), -1.0 + 0.25 * f64::from(k)]).collect();
    for (target, point) in targets.iter().zip(problem.solve(&targets, [9, 1]).0) {
        assert_eq!(point.outcome, Outcome::Solved);
        let outward: Vec<f64> = point.position.iter().map(|c| c / 5.0).collect();
        assert!((point.position[2] - target[0]).abs() < 1e-11);
        assert!(point.normal.iter().zip(&outward).all(|(n, o)| (n - o).abs() < 1e-12), "{point:?}");
    }
}

/// Two spacings of numbers at 1e5 are more than the tolerance of small things.
#[test]
fn a_converged_point_of_a_very_large_thing_is_solved() {
    let graph = Graph::new();
    let (x, target) = (graph.variable("x"), graph.variable("t"));
    let system = System::new(&[1e5 * x.sin() - target], &[x], &[target]).expect("nothing is unbound");
    for k in 0..200 {
        let angle = 0.2 + 0.005 * f64::from(k);
        let solution = solve(&system, &[range(0.0, 1.5)], &[1e5 * angle.sin()], &[0.7]);
        assert_eq!(solution.outcome, Outcome::Solved, "{solution:?}");
        assert!((solution.unknowns[0] - angle).abs() < 1e-14);
    }
}

/// However many roots the ranges hold and however wide they are, the branch around their middle is taken.
#[test]
fn of_branches_that_reach_as_far_the_middle_one_is_taken() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    let targets = [graph.variable("s"), graph.variable("t")];
    let system = System::new(&[x.sin() - targets[0], y - targets[1]], &[x, y], &targets).expect("nothing is unbound");
    for width in [4.0, 11.0, 37.0] {
        let ranges = [range(0.4 - width, 0.4 + width), range(-1.0, 1.0)];
        let (points, effort) = solve_grid(&system, &ranges, &[[0.2, 0.0], [0.3, 0.0], [0.4, 0.0]], [3, 1]);
        assert!(effort.branches.len() > 1);
        for (point, sine) in points.iter().zip([0.2f64, 0.3, 0.4]) {
            assert_eq!(point.outcome, Outcome::Solved);
            assert!((point.unknowns[0] - sine.asin()).abs() < 1e-12, "{point:?}");
        }
    }
}

/// y = x and y = -x cross at zero; a grid that starts on one of them stays on it up to the crossing, and leads nowhere beyond.
#[test]
fn a_grid_ends_where_branches_cross() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    let targets = [graph.variable("s"), graph.variable("t")];
    let (z, crossing) = (graph.variable("z"), (y - x) * (y + x));
    let system = System::new(&[crossing, x - targets[0], z - targets[1]], &[x, y, z], &targets).expect("all bound");
    for count in [6, 10, 40] {
        let rows: Vec<[f64; 2]> = (0..count).map(|k| [f64::from(2 * k + 1) / f64::from(count) - 1.0, 0.5]).collect();
        let (points, _) = solve_grid(&system, &[range(-2.0, 2.0); 3], &rows, [rows.len(), 1]);
        let solved: Vec<_> = points.iter().filter(|point| point.outcome == Outcome::Solved).collect();
        let slopes: Vec<f64> = solved.iter().map(|point| (point.unknowns[1] / point.unknowns[0]).round()).collect();
        assert!(slopes.iter().all(|slope| *slope == slopes[0]), "{slopes:?}");
        let sides: Vec<f64> = solved.iter().map(|point| point.unknowns[0].signum()).collect();
        assert!(sides.iter().all(|side| *side == sides[0]) && 2 * sides.len() == rows.len(), "{sides:?}");
    }
}
