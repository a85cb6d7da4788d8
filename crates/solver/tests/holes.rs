//! A sheet with a hole in it, where all of its rim lies on poles of the tool: there the determinant falls to zero and rises again with its sign.

use flank_expr::Graph;
use flank_solver::{Outcome, Range, System, solve_grid};

const CIRCLE: f64 = 10.0;
const BALL: f64 = 4.0;

fn range(low: f64, high: f64) -> Range {
    Range { low, high }
}

/// A ball that goes around a circle and turns with it, its poles on the radius, asked for by x and y: above is the sheet of v between both
/// poles, below the one beyond them.
fn ring(graph: &Graph) -> System {
    let [u, v, a, x, y] = ["u", "v", "a", "x", "y"].map(|name| graph.variable(name));
    let [outward, along] = [CIRCLE + BALL * v.sin(), BALL * v.cos() * u.sin()];
    let residuals =
        [CIRCLE * v.cos() * u.sin(), outward * a.cos() - along * a.sin() - x, outward * a.sin() + along * a.cos() - y];
    System::new(&residuals, &[u, v, a], &[x, y]).expect("nothing is unbound")
}

/// Whatever rectangle is asked for, and however closely: the points above the ring are those of the sheet above, and none of the other one's.
#[test]
fn no_step_leads_over_a_hole_to_the_sheet_behind_its_rim() {
    let graph = Graph::new();
    let system = ring(&graph);
    // but for its rim the sheet above alone is in the ranges
    let ranges = [range(-1.5, 1.5), range(-1.57, 1.57), range(-3.2, 3.2)];
    let rectangles = [
        ([(-0.65, 18.57), (-12.26, -5.08)], [40, 33]),
        ([(-3.21, 14.96), (-9.23, 1.64)], [60, 33]),
        ([(-8.91, 10.77), (1.47, 20.73)], [33, 12]),
        ([(1.97, 19.05), (-6.95, 10.38)], [40, 33]),
        ([(-6.94, 12.25), (4.68, 22.41)], [50, 33]),
        ([(-14.31, 14.23), (0.54, 14.54)], [25, 25]),
        ([(0.3, 14.5), (-14.2, 14.4)], [20, 41]),
    ];
    for ([first, second], counts) in rectangles {
        let at = |(low, high): (f64, f64), k: usize, count: usize| low + (high - low) * k as f64 / (count - 1) as f64;
        let targets: Vec<[f64; 2]> = (0..counts[0] * counts[1])
            .map(|k| [at(first, k / counts[1], counts[0]), at(second, k % counts[1], counts[1])])
            .collect();
        let (points, _) = solve_grid(&system, &ranges, &targets, counts);
        for ([x, y], point) in targets.iter().zip(&points) {
            let off = (x.hypot(*y) - CIRCLE) / BALL;
            let is_solved = point.outcome == Outcome::Solved;
            assert_eq!(is_solved, off.abs() < 1.0, "{counts:?} {x} {y}: {point:?}");
            assert!(!is_solved || (point.unknowns[1] - off.asin()).abs() < 1e-6, "{counts:?} {x} {y}: {point:?}");
        }
    }
}
