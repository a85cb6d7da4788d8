//! Integrals: values against closed forms, slopes by the integrand, enclosures, series, and what they cost.

use std::f64::consts::FRAC_PI_4;

use flank_expr::{
    End, Expr, Graph, Interval, IntervalEvaluator, ScalarEvaluator, Tape, TaylorEvaluator, Unproven, integral,
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
fn an_arc_costs_ten_integrands() {
    let graph = Graph::new();
    let (t, x) = (graph.variable("t"), graph.variable("x"));
    for (ratio, most) in [(0.94, 10), (0.8, 12)] {
        let speed = (t.sin().squared() + (ratio * t.cos()).squared()).sqrt();
        let arc = from_zero(speed, t, x, FRAC_PI_4).expect("smooth");
        let nodes = arc.to_string().matches("sqrt").count();
        assert!(nodes <= most, "{ratio}: {nodes}");
    }
}
