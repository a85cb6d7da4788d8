//! Integrals: values against closed forms, slopes by the integrand, enclosures, series, and what they cost.

use std::f64::consts::FRAC_PI_2;

use flank_expr::{
    End, Expr, Graph, Interval, IntervalEvaluator, ScalarEvaluator, Style, Tape, TaylorEvaluator, Unproven, integral,
};

/// The integral of an integrand from 0 to a variable that lies within ±`reach`.
fn from_zero<'g>(integrand: Expr<'g>, own: Expr<'g>, to: Expr<'g>, reach: f64) -> Result<Expr<'g>, Unproven> {
    let from = End { expr: to.graph().constant(0.0), range: Interval::point(0.0) };
    integral(integrand, own, [from, End { expr: to, range: Interval::new(-reach, reach) }], &[])
}

#[test]
fn values_slopes_enclosures_and_series_are_those_of_the_closed_form() {
    let graph = Graph::new();
    let (t, x) = (graph.variable("t"), graph.variable("x"));
    let cases = [
        (1.0 / (1.0 + t.squared()), x.atan()),
        (t.cos() * t.sin().exp(), x.sin().exp() - 1.0),
        (t.tan(), -x.cos().ln()),
        (1.0 / (4.0 - t.squared()).sqrt(), (x / 2.0).asin()),
    ];
    for (integrand, exact) in cases {
        let found = from_zero(integrand, t, x, 1.2).expect("smooth");
        let exprs = [found, exact];
        assert_eq!(found.derivative(x), graph.substitute(&[integrand], &[(t, x)])[0], "the same node");
        let tape = Tape::new(&exprs, &[x]).expect("x is the input");
        let mut series = TaylorEvaluator::new(&tape, 3);
        for k in -12..=12 {
            let at = f64::from(k) / 10.0;
            let mut out = [0.0; 2];
            ScalarEvaluator::new(&tape).run(&[at], &mut out);
            assert!((out[0] - out[1]).abs() < 3e-15, "{exact} at {at}: {out:?}");
            let mut boxes = [Interval::WHOLE; 2];
            // with all that the sum leaves, and the rounding of its numbers
            IntervalEvaluator::new(&tape).run(&[Interval::point(at)], &mut boxes);
            assert!(boxes[0].lo <= boxes[1].lo && boxes[1].hi <= boxes[0].hi, "{exact} at {at}: {boxes:?}");
            assert!(boxes[0].width() < 2e-13, "{exact} at {at}: {boxes:?}");
            IntervalEvaluator::new(&tape).run(&[Interval::new(at, at + 1e-3)], &mut boxes);
            assert!(boxes[0].contains(out[0]) && boxes[0].width() < 0.1, "{exact} at {at}: {boxes:?}");
            let mut terms = [0.0; 8];
            series.run(&[at, 1.0, 0.0, 0.0], &mut terms);
            for order in 0..4 {
                let (own, other) = (terms[order], terms[4 + order]);
                assert!((own - other).abs() < 1e-12 * other.abs().max(1.0), "{exact} at {at}, order {order}");
            }
        }
    }
}

/// Where the ends are replaced, the slopes still are the integrand there: the length of a parabola over a place that moves.
#[test]
fn slopes_stay_the_integrand_where_ends_and_parameters_are_replaced() {
    let graph = Graph::new();
    let [t, x, a, y] = ["t", "x", "a", "y"].map(|name| graph.variable(name));
    let integrand = (1.0 + (a * t).squared()).sqrt();
    let ends = [(graph.constant(0.0), 0.0, 0.0), (x, -2.0, 2.0)]
        .map(|(expr, low, high)| End { expr, range: Interval::new(low, high) });
    let length = integral(integrand, t, ends, &[(a, Interval::point(0.5))]).expect("smooth");
    let [replaced] = graph.substitute(&[length], &[(x, y.sin()), (a, graph.constant(0.5))])[..] else { panic!("one") };
    let slope = (1.0 + (0.5 * y.sin()).squared()).sqrt() * y.cos();
    assert_eq!(replaced.derivative(y), slope, "the same node");
    // by a parameter, against the closed form
    let whole = 0.5 * x * (1.0 + (a * x).squared()).sqrt() + (a * x).asinh() / (2.0 * a);
    let parts = [length, whole, length.derivative(a), whole.derivative(a)];
    for k in -8..=8 {
        let found = graph.evaluate(&parts, &[0.0, 0.25 * f64::from(k), 0.5, 0.0]);
        for pair in found.chunks(2) {
            assert!((pair[0] - pair[1]).abs() < 4e-15, "{k}: {found:?}");
        }
    }
}

#[test]
fn integrals_are_written_as_such() {
    let graph = Graph::new();
    let (t, x) = (graph.variable("t"), graph.variable("x"));
    let found = 2.0 * from_zero(1.0 / (1.0 + t.squared()), t, x, 1.0).expect("smooth");
    assert_eq!(found.to_string(), "2 * integral(t in 0 .. x: 1 / (t^2 + 1))");
    let listing = graph.listing(&[found], Style::Latex, "t");
    assert_eq!(listing.values, ["2\\,\\left(\\int_{0}^{x} \\frac{1}{t^{2} + 1} \\, dt\\right)"]);
}

#[test]
fn what_is_not_smooth_is_refused() {
    let graph = Graph::new();
    let (t, x) = (graph.variable("t"), graph.variable("x"));
    let kinks = [t.abs(), t.max(graph.constant(0.5)), 1.0 / t, t.sqrt(), (t - 1.0).ln(), t.abs() * t.squared()];
    for integrand in kinks {
        assert!(matches!(from_zero(integrand, t, x, 1.0), Err(Unproven::Unbounded(_))), "{integrand}");
    }
    let endless = End { expr: x, range: Interval::WHOLE };
    let from = End { expr: graph.constant(0.0), range: Interval::point(0.0) };
    assert_eq!(integral(t.cos(), t, [from, endless], &[]).err(), Some(Unproven::Endless));
    assert_eq!(from_zero(t.cos(), t, x, 1e6).err(), Some(Unproven::TooLong));
}

/// The arc of an ellipse over a quarter turn of its parameter takes as many integrands as it has square roots.
#[test]
fn an_arc_costs_nine_integrands() {
    let graph = Graph::new();
    let (t, x) = (graph.variable("t"), graph.variable("x"));
    for ratio in [0.94, 0.8] {
        let speed = (t.sin().squared() + (ratio * t.cos()).squared()).sqrt();
        let from = End { expr: graph.constant(0.0), range: Interval::point(0.0) };
        let to = End { expr: x, range: Interval::new(0.0, FRAC_PI_2) };
        let arc = integral(speed, t, [from, to], &[]).expect("smooth");
        let roots = Tape::new(&[arc], &[x]).expect("x is the input").cost(&[0])[0].roots;
        assert!(roots <= 9, "{ratio}: {roots}");
    }
}
