//! Points solved many at a time have the answers of the careful path, whatever happens beside them, on any number of threads.

use flank_expr::{Expr, Graph, InstructionSet};
use flank_solver::{Outcome, Range, Solution, System, solve, solve_grid};

fn range(low: f64, high: f64) -> Range {
    Range { low, high }
}

/// Evenly spaced targets in a rectangle.
fn targets([first, second]: [(f64, f64); 2], counts: [usize; 2]) -> Vec<[f64; 2]> {
    let value =
        |(low, high): (f64, f64), k: usize, count: usize| low + (high - low) * k as f64 / (count.max(2) - 1) as f64;
    let row = |i| (0..counts[1]).map(move |j| [value(first, i, counts[0]), value(second, j, counts[1])]);
    (0..counts[0]).flat_map(row).collect()
}

/// Each point again by itself, from where it was found: the same verdict, the same place.
fn assert_careful_agrees(system: &System, ranges: &[Range], targets: &[[f64; 2]], points: &[Solution]) {
    for (target, point) in targets.iter().zip(points).filter(|(_, point)| point.outcome == Outcome::Solved) {
        let careful = solve(system, ranges, target, &point.unknowns);
        assert_eq!(careful.outcome, Outcome::Solved, "{target:?}: {point:?}");
        for ((found, expected), range) in point.unknowns.iter().zip(&careful.unknowns).zip(ranges) {
            assert!((found - expected).abs() <= 1e-11 * (range.high - range.low), "{target:?}: {point:?} {careful:?}");
        }
    }
}

/// A curved system of three unknowns; `y` has no root where the first target is negative.
fn half_solvable(graph: &Graph) -> System {
    let [x, y, z, a, b] = ["x", "y", "z", "a", "b"].map(|name| graph.variable(name));
    let residuals = [x.sin() + 0.2 * y * z - b, y * y - a, z - 0.5 * (x + y).cos()];
    System::new(&residuals, &[x, y, z], &[a, b]).expect("nothing is unbound")
}

const HALF_RANGES: [Range; 3] =
    [Range { low: -1.2, high: 1.2 }, Range { low: 0.0, high: 2.0 }, Range { low: -1.0, high: 1.0 }];

#[test]
fn lanes_that_fail_beside_lanes_that_converge() {
    let graph = Graph::new();
    let system = half_solvable(&graph);
    let counts = [67, 41];
    let targets = targets([(-0.7, 1.5), (-0.4, 0.5)], counts);
    let (points, _) = solve_grid(&system, &HALF_RANGES, &targets, counts);
    for (target, point) in targets.iter().zip(&points) {
        // where it is zero but for rounding, the Jacobian has no inverse
        if target[0].abs() < 1e-12 {
            continue;
        }
        let has_root = target[0] > 0.0;
        assert_eq!(point.outcome == Outcome::Solved, has_root, "{target:?}: {point:?}");
        assert!(!has_root || (point.unknowns[1] - target[0].sqrt()).abs() < 1e-10, "{target:?}: {point:?}");
    }
    assert_careful_agrees(&system, &HALF_RANGES, &targets, &points);
}

#[test]
fn one_thread_and_sixty_four_give_the_same_bits() {
    let graph = Graph::new();
    let system = half_solvable(&graph);
    let counts = [150, 70];
    let targets = targets([(-0.2, 1.5), (-0.4, 0.5)], counts);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
        let (points, effort) = pool.install(|| solve_grid(&system, &HALF_RANGES, &targets, counts));
        let bits = |point: &Solution| -> Vec<u64> {
            point.unknowns.iter().chain([&point.residual]).map(|value| value.to_bits()).collect()
        };
        (points.iter().map(|point| (point.outcome, bits(point))).collect::<Vec<_>>(), effort)
    };
    let alone = on(1);
    assert!(alone == on(2) && alone == on(64));
}

/// The plain loops, vectors, and machine code of its own.
#[test]
fn all_instructions_give_the_same_bits() {
    let graph = Graph::new();
    let counts = [61, 45];
    let targets = targets([(-0.2, 1.5), (-0.4, 0.5)], counts);
    let on = |instructions| {
        let system = half_solvable(&graph).with_instruction_set(instructions);
        let (points, effort) = solve_grid(&system, &HALF_RANGES, &targets, counts);
        let bits = |point: &Solution| -> Vec<u64> { point.unknowns.iter().map(|value| value.to_bits()).collect() };
        (points.iter().map(|point| (point.outcome, bits(point))).collect::<Vec<_>>(), effort)
    };
    let plain = on(InstructionSet::available()[0]);
    assert!(InstructionSet::available().into_iter().skip(1).all(|instructions| on(instructions) == plain));
}

/// One point is solved as a point of a larger grid is.
#[test]
fn grids_of_one_point_and_of_one_line() {
    let graph = Graph::new();
    let system = half_solvable(&graph);
    for counts in [[1, 1], [1, 2], [1, 40], [40, 1], [2, 2]] {
        let targets = targets([(0.5, 1.5), (-0.4, 0.5)], counts);
        let (points, _) = solve_grid(&system, &HALF_RANGES, &targets, counts);
        assert!(points.iter().all(|point| point.outcome == Outcome::Solved), "{counts:?}: {points:?}");
        assert_careful_agrees(&system, &HALF_RANGES, &targets, &points);
    }
}

/// More unknowns than there is a fixed-size elimination for.
#[test]
fn seven_unknowns() {
    let graph = Graph::new();
    let p: Vec<Expr<'_>> = (0..7).map(|k| graph.variable(format!("p{k}"))).collect();
    let (a, b) = (graph.variable("a"), graph.variable("b"));
    let mut residuals = vec![p[0] + 0.1 * p[1].sin() - a, p[1] + 0.1 * p[0] * p[2] - b];
    residuals.extend((2..7).map(|k| p[k] + 0.2 * (p[k - 1] * p[k - 2]).cos() - 0.3 * p[(k + 1) % 7]));
    let system = System::new(&residuals, &p, &[a, b]).expect("nothing is unbound");
    let counts = [23, 19];
    let targets = targets([(-0.5, 0.5), (0.1, 0.9)], counts);
    let ranges = [range(-3.0, 3.0); 7];
    let (points, _) = solve_grid(&system, &ranges, &targets, counts);
    assert!(points.iter().all(|point| point.outcome == Outcome::Solved));
    assert_careful_agrees(&system, &ranges, &targets, &points);
}

/// Values below the smallest normal number on the way.
#[test]
fn denormal_numbers() {
    let graph = Graph::new();
    let [x, y, a, b] = ["x", "y", "a", "b"].map(|name| graph.variable(name));
    let tiny = (x * 1e-200) * (y * 1e-115);
    let system = System::new(&[x - a + tiny, y + x.sin() * 1e-310 - b], &[x, y], &[a, b]).expect("nothing is unbound");
    let counts = [40, 40];
    let targets = targets([(-1e-308, 1e-308), (0.0, 1.0)], counts);
    let ranges = [range(-1.0, 1.0), range(-0.5, 1.5)];
    let (points, _) = solve_grid(&system, &ranges, &targets, counts);
    for (target, point) in targets.iter().zip(&points) {
        assert_eq!(point.outcome, Outcome::Solved);
        assert!((point.unknowns[0] - target[0]).abs() < 1e-11 && (point.unknowns[1] - target[1]).abs() < 1e-11);
    }
}

/// An equation of a hundred thousand nodes.
#[test]
fn a_very_long_equation() {
    let graph = Graph::new();
    let [x, y, a, b] = ["x", "y", "a", "b"].map(|name| graph.variable(name));
    let mut sum = x;
    while graph.len() < 100_000 {
        let k = graph.len() as f64;
        sum = sum + (1e-6 / k) * (x * k.sin() + y).sin();
    }
    let system = System::new(&[sum - a, y + 0.1 * x * x - b], &[x, y], &[a, b]).expect("nothing is unbound");
    let counts = [5, 5];
    let targets = targets([(-0.5, 0.5), (0.0, 0.5)], counts);
    let ranges = [range(-1.0, 1.0); 2];
    let (points, _) = solve_grid(&system, &ranges, &targets, counts);
    assert!(points.iter().all(|point| point.outcome == Outcome::Solved));
    assert_careful_agrees(&system, &ranges, &targets, &points);
}

/// A grid over the edge of a fold: v and -v have the same targets, and the second of them is outside. However coarse the grid, no
/// point is taken from the sheet behind the fold, which shows in the sign of the determinant, and none is missed.
#[test]
fn the_sheet_behind_a_fold_is_not_taken() {
    let graph = Graph::new();
    let [u, v, a, b] = ["u", "v", "a", "b"].map(|name| graph.variable(name));
    let ranges = [range(-2.5, 2.5), range(0.0, 2.0)];
    for bent in [0.0, 0.1] {
        let residuals = [v * v + 0.3 * (3.0 * u).sin() - a, u + bent * v * u.sin() - b];
        let system = System::new(&residuals, &[u, v], &[a, b]).expect("nothing is unbound");
        let determinant =
            |p: &[f64]| 0.9 * (3.0 * p[0]).cos() * bent * p[0].sin() - 2.0 * p[1] * (1.0 + bent * p[1] * p[0].cos());
        for counts in [[150, 40], [40, 150], [31, 31], [12, 90], [90, 12], [300, 300]] {
            let targets = targets([(-0.1, 1.5), (-2.0, 2.0)], counts);
            let (points, _) = solve_grid(&system, &ranges, &targets, counts);
            for (target, point) in targets.iter().zip(&points) {
                let is_root = matches!(point.outcome, Outcome::Solved | Outcome::Outside { .. });
                assert!(!is_root || determinant(&point.unknowns) < 1e-9, "{bent} {counts:?} {target:?}: {point:?}");
                if bent == 0.0 {
                    let height = target[0] - 0.3 * (3.0 * target[1]).sin();
                    assert_eq!(point.outcome == Outcome::Solved, height > 0.0, "{counts:?} {target:?}: {point:?}");
                }
            }
        }
    }
}

/// Lattices are so wide on these grids that strips solve parts of their lines: on few points of them polynomials tell where the next
/// ones are, on a steep step no polynomial does. The roots are unique, and known by bisection.
#[test]
fn lines_of_the_lattice_are_solved_wherever_they_lead() {
    let graph = Graph::new();
    let [x, y, a, b] = ["x", "y", "a", "b"].map(|name| graph.variable(name));
    let ranges = [Range { low: -2.0, high: 2.0 }, Range { low: -2.0, high: 2.0 }];
    for steepness in [0.5, 60.0] {
        let height = |x: f64| x + 0.3 * (steepness * (x - 0.2)).atan();
        let step = x + (steepness * (x - 0.2)).atan() * 0.3;
        let system = System::new(&[step - a, y - 0.2 * x * x - b], &[x, y], &[a, b]).expect("nothing is unbound");
        for counts in [[31, 61], [61, 33], [200, 130], [65, 400]] {
            let targets = targets([(-1.0, 1.2), (-0.7, 0.9)], counts);
            let (points, _) = solve_grid(&system, &ranges, &targets, counts);
            for ([a, b], point) in targets.iter().zip(&points) {
                let (mut low, mut high) = (-2.0, 2.0);
                for _ in 0..60 {
                    let middle: f64 = 0.5 * (low + high);
                    if height(middle) < *a { low = middle } else { high = middle }
                }
                assert_eq!(point.outcome, Outcome::Solved, "{steepness} {counts:?} {a} {b}: {point:?}");
                let expected = [low, b + 0.2 * low * low];
                let near = |(found, expected): (&f64, &f64)| (found - expected).abs() < 1e-10;
                assert!(point.unknowns.iter().zip(&expected).all(near), "{expected:?} {point:?}");
            }
        }
    }
}
