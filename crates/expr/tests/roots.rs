//! Unknowns that equations give: values and slopes against closed forms and numbers from elsewhere, enclosures, series, every evaluator, what
//! is replaced in them, and what is refused.

use std::f64::consts::PI;

use flank_expr::{
    Expr, Graph, InstructionSet, Interval, IntervalEvaluator, LANES, LaneEvaluator, LaneTape, NoRoot, ScalarEvaluator,
    Tape, TaylorEvaluator, Unknown, roots,
};

/// The root of one equation that one variable moves.
fn root<'g>(
    residual: Expr<'g>,
    (unknown, range): (Expr<'g>, (f64, f64)),
    (moves, within): (Expr<'g>, (f64, f64)),
) -> Result<Expr<'g>, NoRoot> {
    let unknown = Unknown { variable: unknown, range: Interval::new(range.0, range.1) };
    roots(&[residual], &[unknown], &[(moves, Interval::new(within.0, within.1))]).map(|roots| roots[0])
}

fn at(exprs: &[Expr<'_>], inputs: &[Expr<'_>], values: &[f64]) -> Vec<f64> {
    let tape = Tape::new(exprs, inputs).expect("all given");
    let mut out = vec![f64::NAN; exprs.len()];
    ScalarEvaluator::new(&tape).run(values, &mut out);
    out
}

#[test]
fn values_slopes_enclosures_and_series_are_those_of_the_closed_form() {
    let graph = Graph::new();
    let (x, a) = (graph.variable("x"), graph.variable("a"));
    // what is zero, where the unknown lies, the closed form
    let cases = [
        (x.exp() - a, (0.0, 2.0), a.ln()),
        (x * x * x - a, (0.9, 2.0), a.ln().exp().pow(graph.constant(1.0 / 3.0))),
        (x.sin() - a / 6.0, (0.0, 1.2), (a / 6.0).asin()),
        (a * x - 1.0, (0.1, 1.1), 1.0 / a),
        (x.tan() - x - a, (0.2, 1.5), a.arcinv()),
    ];
    for (residual, range, exact) in cases {
        let found = root(residual, (x, range), (a, (1.0, 5.0))).expect("one root");
        let slopes = [found, exact].map(|f| f.derivative(a));
        let bends = slopes.map(|slope| slope.derivative(a));
        let exprs = [found, exact, slopes[0], slopes[1], bends[0], bends[1]];
        let tape = Tape::new(&exprs, &[a]).expect("a is the input");
        let mut series = TaylorEvaluator::new(&tape, 3);
        for k in 0..=40 {
            let value = 1.0 + f64::from(k) / 10.0;
            let mut out = [0.0; 6];
            ScalarEvaluator::new(&tape).run(&[value], &mut out);
            for pair in out.chunks(2) {
                assert!((pair[0] - pair[1]).abs() < 4e-15 * pair[1].abs().max(1.0), "{exact} at {value}: {out:?}");
            }
            let mut boxes = [Interval::WHOLE; 6];
            IntervalEvaluator::new(&tape).run(&[Interval::new(value, value + 1e-3)], &mut boxes);
            for pair in [[0, 1], [2, 3], [4, 5]] {
                assert!(boxes[pair[0]].contains(out[pair[1]]), "{exact} at {value}: {boxes:?}");
            }
            // the mean-value form is as narrow as the slope lets it be
            assert!(boxes[0].width() < 1.5e-3 * out[3].abs() + 1e-6, "{exact} at {value}: {boxes:?}");
            let mut terms = [0.0; 24];
            series.run(&[value, 1.0, 0.0, 0.0], &mut terms);
            for order in 0..4 {
                let (own, other) = (terms[order], terms[4 + order]);
                assert!((own - other).abs() < 1e-11 * other.abs().max(1.0), "{exact} at {value}, order {order}");
            }
        }
    }
}

/// Kepler's equation over a whole turn: E of M by 40-digit arithmetic (eccentricities 0.2 and 0.9).
#[test]
fn keplers_equation_is_solved_over_a_turn() {
    let graph = Graph::new();
    let (e, m) = (graph.variable("E"), graph.variable("M"));
    for eccentricity in [0.2, 0.9] {
        let found = root(e - eccentricity * e.sin() - m, (e, (0.0, 2.0 * PI)), (m, (0.0, 2.0 * PI))).expect("one root");
        for k in 0..=720 {
            let mean = f64::from(k) * PI / 360.0;
            let [value, slope] = at(&[found, found.derivative(m)], &[m], &[mean])[..] else { panic!("two outputs") };
            let rest = value - eccentricity * value.sin() - mean;
            assert!(rest.abs() < 4e-15, "{eccentricity}, {mean}: {rest:e}");
            assert!((slope * (1.0 - eccentricity * value.cos()) - 1.0).abs() < 1e-14, "{eccentricity}, {mean}");
        }
    }
}

/// Crank 1, coupler 4, rocker 3 on a ground of 3.5: coupler and rocker angle against Freudenstein's closed form.
#[test]
fn two_unknowns_of_two_equations() {
    let graph = Graph::new();
    let [crank, coupler, rocker] = ["crank", "coupler", "rocker"].map(|name| graph.variable(name));
    let closes = [
        crank.cos() + 4.0 * coupler.cos() - 3.5 - 3.0 * rocker.cos(),
        crank.sin() + 4.0 * coupler.sin() - 3.0 * rocker.sin(),
    ];
    let unknown = |variable, lo: f64, hi: f64| Unknown { variable, range: Interval::new(lo, hi) };
    let turn = (crank, Interval::new(0.0, 2.0 * PI));
    let found = roots(&closes, &[unknown(coupler, 0.0, 1.5), unknown(rocker, 0.8, 2.6)], &[turn]).expect("one root");
    for k in 0..360 {
        let angle = f64::from(k).to_radians();
        let exprs = [found[0], found[1], found[1].derivative(crank)];
        let [coupler, rocker, slope] = at(&exprs, &[crank], &[angle])[..] else { panic!("three outputs") };
        let (k1, k2, k3) = (3.5, 3.5 / 3.0, (1.0 + 9.0 + 3.5 * 3.5 - 16.0) / 6.0);
        let (a, b) = (2.0 * angle.sin(), 2.0 * angle.cos() - 2.0 * k1);
        let c = 2.0 * (k2 * angle.cos() - k3);
        let exact = 2.0 * ((a + (a * a + b * b - c * c).sqrt()).atan2(b - c));
        let exact = exact.rem_euclid(2.0 * PI);
        let other = (2.0 * (a - (a * a + b * b - c * c).sqrt()).atan2(b - c)).rem_euclid(2.0 * PI);
        let near = (rocker - exact).abs().min((rocker - other).abs());
        assert!(near < 1e-14, "{k}: {rocker}, {exact} or {other}");
        // along the coupler, both ends move alike
        let (speed, along) = (angle - coupler, rocker - coupler);
        assert!((slope - speed.sin() / (3.0 * along.sin())).abs() < 1e-13, "{k}: {slope}");
    }
}

/// An arm of three joints whose hand stays level and goes along a line: two equations, and a sine that gives the wrist by the other two.
/// Against the triangle of both arms.
#[test]
fn a_sine_gives_its_angle_where_one_multiple_is_left() {
    let graph = Graph::new();
    let [shoulder, elbow, wrist, way] = ["shoulder", "elbow", "wrist", "way"].map(|name| graph.variable(name));
    let inner = shoulder + elbow;
    let residuals = [
        (inner + wrist).sin(),
        4.0 * shoulder.cos() + 3.0 * inner.cos() - 5.0,
        4.0 * shoulder.sin() + 3.0 * inner.sin() - way,
    ];
    let unknown = |variable, lo: f64, hi: f64| Unknown { variable, range: Interval::new(lo, hi) };
    let unknowns = |wrist_range: (f64, f64)| {
        [unknown(shoulder, -1.2, 0.0), unknown(elbow, 1.0, 2.0), unknown(wrist, wrist_range.0, wrist_range.1)]
    };
    let moves = (way, Interval::new(-1.0, 1.0));
    let square = way * way + 25.0;
    let bend = ((square - 25.0) / 24.0).acos();
    let exact = (way / 5.0).atan() - ((square + 7.0) / (8.0 * square.sqrt())).acos();
    let found = roots(&residuals, &unknowns((-2.0, 0.0)), &[moves]).expect("one root");
    // half a turn more closes the sine, too
    let half_turn = roots(&residuals, &unknowns((-2.0 - PI, -PI)), &[moves]).expect("one root");
    let exprs = [
        found[0],
        found[1],
        found[2],
        half_turn[2],
        found[2].derivative(way),
        exact,
        bend,
        (exact + bend).derivative(way),
    ];
    for k in -20..=20 {
        let place = f64::from(k) / 20.0;
        let out = at(&exprs, &[way], &[place]);
        let wrist = -out[5] - out[6];
        let errors = [out[0] - out[5], out[1] - out[6], out[2] - wrist, out[3] - (wrist - PI), out[4] + out[7]];
        assert!(errors.iter().all(|error| error.abs() < 2e-14), "{place}: {errors:?}");
    }
    // the wrist does not get there, gets there in part of the way, or gets there in two ways
    let refused = |range| roots(&residuals, &unknowns(range), &[moves]).expect_err("no root");
    assert!(matches!(refused((-0.5, 0.0)), NoRoot::None(_)));
    assert!(matches!(refused((-1.0, 0.0)), NoRoot::None(_)));
    assert!(matches!(refused((-2.0 - PI, 0.0)), NoRoot::Several(_)));
    // a little beyond the way its place is known, and the wrist leaves its range
    let narrow = roots(&residuals, &unknowns((-2.0, -0.703)), &[moves]).expect("one root");
    let [wide, narrow] = [&found, &narrow].map(|found| at(found, &[way], &[-1.01]));
    assert!(wide[2] > -0.702, "{wide:?}");
    assert!(narrow.iter().all(|value| value.is_nan()), "{narrow:?}");
}

#[test]
fn a_root_in_a_root_and_what_is_replaced() {
    let graph = Graph::new();
    let [x, y, a, b] = ["x", "y", "a", "b"].map(|name| graph.variable(name));
    let within = |lo, hi| Interval::new(lo, hi);
    let unknown = |variable, range| Unknown { variable, range };
    let given = [(a, within(1.0, 4.0)), (b, within(2.0, 2.0))];
    // x = √a inside y: y³ = b x
    let inner = roots(&[x * x - a], &[unknown(x, within(0.5, 3.0))], &given).expect("one root")[0];
    let outer = roots(&[y * y * y - b * inner], &[unknown(y, within(0.5, 3.0))], &given).expect("one root")[0];
    let exact = (b * a.sqrt()).pow(graph.constant(1.0 / 3.0));
    let both = |f: Expr<'_>, g: Expr<'_>, values: &[f64], what: &str| {
        let out = graph.evaluate(&[f, g], values);
        assert!((out[0] - out[1]).abs() < 1e-14, "{what}: {out:?}");
    };
    let values = [0.0, 0.0, 2.3, 2.0, 1.9];
    both(outer, exact, &values, "the value");
    for (variable, name) in [(a, "a"), (b, "b")] {
        both(outer.derivative(variable), exact.derivative(variable), &values, name);
    }
    both(outer.derivative(a).derivative(b), exact.derivative(a).derivative(b), &values, "a and b");
    let t = graph.variable("t");
    let [replaced, other] = graph.substitute(&[outer, exact], &[(a, t * t), (b, graph.constant(2.0))])[..] else {
        panic!()
    };
    both(replaced, other, &values, "replaced");
    both(replaced.derivative(t), other.derivative(t), &values, "slope of what is replaced");
    let number = graph.substitute(&[outer], &[(a, graph.constant(4.0)), (b, graph.constant(2.0))])[0];
    let number = number.as_constant().expect("nothing moves any more");
    assert!((number - 4.0_f64.cbrt()).abs() < 1e-15, "{number}");
}

/// Lanes of any kind give the same bits as numbers one by one; beyond the ranges, where two steps do not settle, all say NaN.
#[test]
fn lanes_are_numbers_one_by_one() {
    let graph = Graph::new();
    let (e, m) = (graph.variable("E"), graph.variable("M"));
    let found = root(e - 0.6 * e.sin() - m, (e, (0.0, 2.0 * PI)), (m, (0.0, 2.0 * PI))).expect("one root");
    let tape = Tape::new(&[found, found.derivative(m)], &[m]).expect("m is the input");
    let lanes = LaneTape::new(&tape);
    let points: Vec<f64> = (0..LANES).map(|k| k as f64 * 0.3).collect();
    assert!(points[LANES - 1] > 8.0, "some lie beyond");
    for instructions in InstructionSet::available() {
        let mut evaluator = LaneEvaluator::new(&lanes, instructions);
        evaluator.input(0).copy_from_slice(&points);
        evaluator.run();
        agree(&tape, &points, &evaluator);
    }
}

fn agree(tape: &Tape, points: &[f64], evaluator: &LaneEvaluator<'_>) {
    let mut scalar = ScalarEvaluator::new(tape);
    let mut settled = 0;
    for (lane, point) in points.iter().enumerate() {
        let mut out = [0.0; 2];
        scalar.run(&[*point], &mut out);
        for (k, value) in out.iter().enumerate() {
            let other = evaluator.output(k)[lane];
            assert!(value.to_bits() == other.to_bits() || value.is_nan() && other.is_nan(), "{point}: {value} {other}");
        }
        settled += usize::from(!out[0].is_nan());
    }
    assert!((20..LANES).contains(&settled), "{settled}");
}

#[test]
fn what_is_no_function_is_refused() {
    let graph = Graph::new();
    let (x, a) = (graph.variable("x"), graph.variable("a"));
    let of = |residual, range| root(residual, (x, range), (a, (1.0, 4.0)));
    assert!(matches!(of(x * x - a, (-3.0, 3.0)), Err(NoRoot::Several(_))));
    assert!(matches!(of(x * x + a, (-3.0, 3.0)), Err(NoRoot::None(_))));
    assert!(matches!(of(x * x - a, (0.0, 1.5)), Err(NoRoot::None(at)) if at[0] > 2.0));
    // a double root at a = 1
    assert!(matches!(of(x * x - (a - 1.0), (0.0, 3.0)), Err(NoRoot::Unproven(_))));
    assert!(matches!(of((x - 1.0) * (a - 2.0), (0.0, 3.0)), Err(NoRoot::Unproven(_) | NoRoot::Several(_))));
}

/// What comes again and again over the range is not taken for a constant, and what moves along a part of the way alone is seen.
#[test]
fn what_moves_over_whole_turns_has_its_root_all_the_way() {
    let graph = Graph::new();
    let (q, a) = (graph.variable("q"), graph.variable("a"));
    let cases = [
        (a.sin(), PI),
        (a.sin(), 2.0 * PI),
        ((2.0 * a).sin(), 0.5 * PI),
        (a.sin() * a.sin(), PI),
        ((3.0 * a).sin(), PI),
        (a * (1.0 - a) * (1.0 + a), 1.0),
        ((-4.0 * (a * a)).exp(), PI),
    ];
    for (law, end) in cases {
        let residual = q + 0.3 * (q * q * q) - law;
        let found = root(residual, (q, (-2.0, 2.0)), (a, (-end, end))).unwrap_or_else(|why| panic!("{law}: {why}"));
        let off = graph.substitute(&[residual], &[(q, found)])[0];
        for k in 0..=500 {
            let value = end * (f64::from(k) / 250.0 - 1.0);
            let [off, found] = at(&[off, found], &[a], &[value])[..] else { panic!("two numbers") };
            assert!(off.abs() < 1e-14, "{law} at {value}: {found} leaves {off}");
        }
    }
}

/// The boxes alone decide nothing here: one equation that rises all over the range has one root where its ends have other signs.
#[test]
fn what_rises_all_over_a_range_is_proven() {
    let graph = Graph::new();
    let (w, a) = (graph.variable("w"), graph.variable("a"));
    let cubic = w * w * w + w - a;
    let cases =
        [((0.0, 4.0), (0.5, 1.5)), ((-4.0, 4.0), (0.5, 1.5)), ((-4.0, 4.0), (3.0, 3.0)), ((-40.0, 50.0), (-1.0, 2.0))];
    for (range, moves) in cases {
        let found = root(cubic, (w, range), (a, moves)).expect("it rises");
        let off = graph.substitute(&[cubic], &[(w, found)])[0];
        for k in 0..=20 {
            let value = moves.0 + (moves.1 - moves.0) * f64::from(k) / 20.0;
            let [off] = at(&[off], &[a], &[value])[..] else { panic!("one number") };
            assert!(off.abs() < 1e-15 * value.abs().max(1.0) * 4.0, "{off} at {value}");
        }
    }
    assert!(matches!(root(cubic, (w, (1.0, 4.0)), (a, (0.5, 1.5))), Err(NoRoot::None(_))));
}
