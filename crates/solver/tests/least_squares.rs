//! Least squares with bounds, against closed forms.

use faer::Mat;
use flank_solver::{LeastSquares, LeastSquaresFit, LinearModel, Linearized, Range, RangeEnd, ScaledUnknown, SearchEnd};

const EVERYWHERE: Range = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };

fn unknown(start: f64, range: Range) -> ScaledUnknown {
    ScaledUnknown { start, scale: 1.0, range }
}

fn problem(unknowns: Vec<ScaledUnknown>) -> LeastSquares {
    LeastSquares { unknowns, exact: 0, resolution: 1e-6, uses_weak: true, settled: 1e-13, given_up: None }
}

fn rows(residuals: Vec<f64>, slopes: &[&[f64]]) -> Option<Linearized> {
    let jacobian = Mat::from_fn(slopes.len(), slopes[0].len(), |row, column| slopes[row][column]);
    Some(Linearized { residuals, jacobian })
}

/// The valley of Rosenbrock: least at (1, 1).
fn valley(at: &[f64]) -> Option<Linearized> {
    let [x, y] = [at[0], at[1]];
    rows(vec![1.0 - x, 10.0 * (y - x * x)], &[&[-1.0, 0.0], &[-20.0 * x, 10.0]])
}

/// A straight line `a + b t` through values at -2, -1, 0, 1, 2.
fn line(values: [f64; 5]) -> impl Fn(&[f64]) -> Option<Linearized> {
    move |at| {
        let t = |k: usize| k as f64 - 2.0;
        let residuals = (0..5).map(|k| at[0] + at[1] * t(k) - values[k]).collect();
        let slopes: Vec<[f64; 2]> = (0..5).map(|k| [1.0, t(k)]).collect();
        rows(residuals, &slopes.iter().map(|row| &row[..]).collect::<Vec<&[f64]>>())
    }
}

fn near(a: f64, b: f64, by: f64) {
    assert!((a - b).abs() < by, "{a} instead of {b}");
}

#[test]
fn the_end_of_a_curved_valley_is_found() {
    let fit = problem(vec![unknown(-1.2, EVERYWHERE), unknown(1.0, EVERYWHERE)]).solve(valley).expect("finite");
    assert_eq!(fit.end, SearchEnd::Settled);
    fit.values.iter().for_each(|value| near(*value, 1.0, 1e-12));
    assert_eq!(fit.held, [None, None]);
}

/// At x = 0.5 the valley's floor is y = 0.25, and the slope along x is -(1 - x).
#[test]
fn at_a_bound_the_gradient_pushes_outwards() {
    let range = Range { low: -3.0, high: 0.5 };
    let fit = problem(vec![unknown(-1.2, range), unknown(1.0, EVERYWHERE)]).solve(valley).expect("finite");
    assert_eq!((fit.end, &fit.held[..]), (SearchEnd::Settled, &[Some(RangeEnd::High), None][..]));
    assert_eq!(fit.values[0], 0.5, "on the bound, not beside it");
    near(fit.values[1], 0.25, 1e-9);
    near(fit.gradient[0], -0.5, 1e-9);
    near(fit.gradient[1], 0.0, 1e-9);
}

/// A start at the wrong bound is left again, whatever the order in which bounds are met.
#[test]
fn bounds_are_held_no_longer_than_they_push() {
    let [low, high] = [Range { low: 0.0, high: 10.0 }, Range { low: -10.0, high: 1.0 }];
    // the line 1 + 2 t with a and b in boxes: b is best at 1, and a, square to it, at 1
    let found = problem(vec![unknown(0.0, low), unknown(-10.0, high)]).solve(line([-3.0, -1.0, 1.0, 3.0, 5.0]));
    let fit = found.expect("finite");
    near(fit.values[0], 1.0, 1e-12);
    assert_eq!(fit.values[1], 1.0);
    assert_eq!(fit.held, [None, Some(RangeEnd::High)]);
    // residuals -t: their sum with the slopes t is -10
    near(fit.gradient[1], -10.0, 1e-9);
}

/// Two unknowns of which only the sum shows: the direction is named, and the sum is shared between them.
#[test]
fn a_direction_that_shows_nothing_is_named() {
    let sum = |at: &[f64]| rows(vec![at[0] + at[1] - 3.0, 2.0 * (at[0] + at[1]) - 6.0], &[&[1.0, 1.0], &[2.0, 2.0]]);
    let fit = problem(vec![unknown(0.0, EVERYWHERE), unknown(0.0, EVERYWHERE)]).solve(sum).expect("finite");
    fit.values.iter().for_each(|value| near(*value, 1.5, 1e-13));
    let used: Vec<bool> = fit.directions.iter().map(|of| of.is_used).collect();
    assert_eq!(used, [true, false]);
    // sqrt(1 + 1 + 4 + 4) over the root of two residuals
    near(fit.directions[0].size, 5f64.sqrt(), 1e-14);
    let null = &fit.directions[1];
    near(null.shares[0] + null.shares[1], 0.0, 1e-14);
    near(null.shares[0].abs(), 0.5f64.sqrt(), 1e-14);
}

/// Of a straight line through five values the variances are 1/5 and 1/10, the leverages 1/5 + t²/10.
#[test]
fn covariance_and_leverages_are_those_of_a_straight_line() {
    let found = problem(vec![unknown(0.0, EVERYWHERE); 2]).solve(line([1.0, -2.0, 0.5, 4.0, 2.0]));
    let fit = found.expect("finite");
    let LeastSquaresFit { values, covariance, residuals, .. } = &fit;
    near(values[0], 1.1, 1e-13);
    near(values[1], 0.8, 1e-13);
    near(covariance[0][0], 0.2, 1e-14);
    near(covariance[1][1], 0.1, 1e-14);
    near(covariance[0][1], 0.0, 1e-14);
    let model = fit.linear_model();
    for (k, residual) in residuals.iter().enumerate() {
        let leverage = 0.2 + (k as f64 - 2.0).powi(2) / 10.0;
        near(model.leverage(k), leverage, 1e-14);
        near(model.left_out(&[k]).expect("determined")[0], residual / (1.0 - leverage), 1e-13);
    }
    assert_eq!(model.left_out(&[0, 1, 2, 3]), None, "one value makes no line");
    // the line through the first three values, 1, -2, 0.5, has -0.1667 in their middle and falls by 0.25
    let predicted = model.left_out(&[3, 4]).expect("determined");
    near(predicted[0], -2.0 / 3.0 - 4.0, 1e-12);
    near(predicted[1], -11.0 / 12.0 - 2.0, 1e-12);
}

/// A direction below the resolution is left alone in noise, and used where the residuals show it.
#[test]
fn a_weak_direction_is_used_where_it_shows() {
    let weak = |noise: f64| {
        move |at: &[f64]| {
            let wanted =
                |k: usize| 1.0 + 2e-3 * (k as f64 - 3.5) + noise * [1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0][k];
            let slopes: Vec<[f64; 2]> = (0..8).map(|k| [1.0, 1e-3 * (k as f64 - 3.5)]).collect();
            let residuals = slopes.iter().enumerate().map(|(k, s)| at[0] * s[0] + at[1] * s[1] - wanted(k)).collect();
            rows(residuals, &slopes.iter().map(|row| &row[..]).collect::<Vec<&[f64]>>())
        }
    };
    let problem = LeastSquares {
        unknowns: vec![unknown(0.0, EVERYWHERE); 2],
        exact: 0,
        resolution: 0.1,
        uses_weak: true,
        settled: 1e-13,
        given_up: None,
    };
    let fit = problem.solve(weak(1e-6)).expect("finite");
    near(fit.values[1], 2.0, 1e-9);
    assert!(fit.directions[1].is_used);
    let fit = problem.solve(weak(0.5)).expect("finite");
    near(fit.values[1], 0.0, 1e-12);
    assert!(!fit.directions[1].is_used);
}

#[test]
fn where_there_are_no_residuals_no_step_leads() {
    let root = |at: &[f64]| (at[0] > 0.0).then(|| rows(vec![at[0].ln()], &[&[1.0 / at[0]]])).flatten();
    let fit = problem(vec![unknown(20.0, EVERYWHERE)]).solve(root).expect("finite");
    near(fit.values[0], 1.0, 1e-12);
    assert!(problem(vec![unknown(-1.0, EVERYWHERE)]).solve(root).is_none());
}

/// The point of the unit circle that is nearest to (1.2, 0.4), and the one that is no farther right than 0.5.
#[test]
fn what_is_to_be_zero_is_zero() {
    let nearest = |at: &[f64]| {
        let [x, y] = [at[0], at[1]];
        rows(vec![x - 1.2, y - 0.4, x * x + y * y - 1.0], &[&[1.0, 0.0], &[0.0, 1.0], &[2.0 * x, 2.0 * y]])
    };
    let on_circle =
        |range: Range| LeastSquares { exact: 1, ..problem(vec![unknown(0.1, range), unknown(0.9, EVERYWHERE)]) };
    let fit = on_circle(EVERYWHERE).solve(nearest).expect("finite");
    assert_eq!(fit.end, SearchEnd::Settled);
    near(fit.values[0], 0.9f64.sqrt(), 1e-9);
    near(fit.values[1], 0.1f64.sqrt(), 1e-9);
    near(fit.exact[0], 0.0, 1e-13);
    assert_eq!((fit.residuals.len(), fit.rank()), (2, 1), "one direction keeps to the circle");
    fit.gradient.iter().for_each(|slope| near(*slope, 0.0, 1e-8));
    let fit = on_circle(Range { low: -2.0, high: 0.5 }).solve(nearest).expect("finite");
    near(fit.values[1], 0.75f64.sqrt(), 1e-12);
    assert_eq!(fit.held, [Some(RangeEnd::High), None]);
    assert!(fit.gradient[0] < 0.0, "it pushes outwards");
}

/// A residual that stays at 2 and bends: each whole step alone leaves an eighth of the one before, so that sixteen would be taken.
#[test]
fn steps_that_bend_alike_are_taken_together() {
    let bent = |at: &[f64]| {
        let [x, y] = [at[0], at[1]];
        let residuals = vec![x - 1.0, y - 2.0, 2.0 + 0.03 * x * x + 0.001 * y * y];
        rows(residuals, &[&[1.0, 0.0], &[0.0, 1.0], &[0.06 * x, 0.002 * y]])
    };
    let fit = problem(vec![unknown(0.0, EVERYWHERE); 2]).solve(bent).expect("finite");
    assert_eq!(fit.end, SearchEnd::Settled);
    assert!(fit.steps <= 8, "{} steps", fit.steps);
    // x - 1 + 0.06 x r = 0 and y - 2 + 0.002 y r = 0 with the last residual r
    let last = fit.residuals[2];
    near(fit.values[0], 1.0 / (1.0 + 0.06 * last), 1e-12);
    near(fit.values[1], 2.0 / (1.0 + 0.002 * last), 1e-12);
}

/// Values at five places in seven series, of which each may have an offset: what all lie on is `a + b t`, beside a pattern of a hundredth.
fn series(offset: impl Fn(usize, usize) -> f64) -> LinearModel {
    let pattern =
        |row: usize, column: usize| 0.01 * ((12.9898 * row as f64 + 78.233 * column as f64).sin() * 43758.5453).fract();
    let places = (0..35).map(|at| (at / 7, at % 7));
    let values: Vec<f64> =
        places.map(|(row, column)| 3.0 - 2.0 * row as f64 + pattern(row, column) + offset(row, column)).collect();
    LinearModel::new(&values).with(&[vec![1.0; 35], (0..35).map(|at| (at / 7) as f64).collect()])
}

fn lines() -> Vec<Vec<usize>> {
    let rows = (0..5).map(|row| (0..7).map(|column| 7 * row + column).collect());
    rows.chain((0..7).map(|column| (0..5).map(|row| 7 * row + column).collect())).collect()
}

/// One by one they hide behind each other: each of six that are as far off makes what the others scatter by as large.
#[test]
fn residuals_that_hide_each_other_are_found() {
    assert_eq!(series(|_, _| 0.0).outlying(&lines(), 1e-6), [], "nothing is off");
    let off = [(0, 0, 1.0), (1, 4, -1.0), (2, 2, 1.0), (3, 6, 1.0), (4, 1, -1.0), (4, 5, 1.0)];
    let offset = |row, column| off.iter().find(|of| (of.0, of.1) == (row, column)).map_or(0.0, |of| of.2);
    let places: Vec<usize> = off.iter().map(|(row, column, _)| 7 * row + column).collect();
    assert_eq!(series(offset).outlying(&lines(), 1e-6), places);
    // no machine shows so little
    assert_eq!(series(offset).outlying(&lines(), 2.0), []);
}

/// A row at the end that is off takes the straight line with it: what is left is largest in other rows. With two further points beside it, it is
/// those and no other ones.
#[test]
fn lines_of_residuals_are_found_with_points_beside_them() {
    for row in 0..5 {
        let offset = |at: usize, column: usize| match (at, column) {
            _ if at == row => 0.5,
            (at, 3) if at == (row + 2) % 5 => -0.3,
            _ => 0.0,
        };
        let mut wanted: Vec<usize> = (7 * row..7 * row + 7).chain([7 * ((row + 2) % 5) + 3]).collect();
        wanted.sort_unstable();
        let model = series(offset);
        assert_eq!(model.outlying(&lines(), 1e-6), wanted, "row {row}");
        // the line through the others, by the sums that give it
        let rest = model.without(&wanted).expect("enough are left");
        let others: Vec<usize> = (0..35).filter(|at| !wanted.contains(at)).collect();
        let value = |at: usize| {
            let (row, column) = (at / 7, at % 7);
            3.0 - 2.0 * row as f64
                + 0.01 * ((12.9898 * row as f64 + 78.233 * column as f64).sin() * 43758.5453).fract()
                + offset(row, column)
        };
        let n = others.len() as f64;
        let mean = |of: &dyn Fn(usize) -> f64| others.iter().map(|at| of(*at)).sum::<f64>() / n;
        let place = |at: usize| (at / 7) as f64;
        let (t, y) = (mean(&place), mean(&value));
        let square = others.iter().map(|at| (place(*at) - t).powi(2)).sum::<f64>();
        let slope = others.iter().map(|at| (place(*at) - t) * (value(*at) - y)).sum::<f64>() / square;
        let left = |at: usize| value(at) - y - slope * (place(at) - t);
        let variance = others.iter().map(|at| left(*at).powi(2)).sum::<f64>() / (n - 2.0);
        near(rest.variance().expect("more than two"), variance, 1e-14);
        for at in wanted {
            let (off, deviation) = rest.off(at);
            near(off, left(at), 1e-12);
            near(deviation, (variance * (1.0 + 1.0 / n + (place(at) - t).powi(2) / square)).sqrt(), 1e-12);
        }
    }
}
