//! Simplification on construction: each rule by its algebra.

use std::f64::consts::PI;

use flank_expr::{Expr, Graph, Unary};

/// The variables and some of their functions, for tables of cases.
struct Letters<'g> {
    graph: &'g Graph,
    x: Expr<'g>,
    y: Expr<'g>,
    z: Expr<'g>,
}

impl<'g> Letters<'g> {
    fn new(graph: &'g Graph) -> Letters<'g> {
        let [x, y, z] = ["x", "y", "z"].map(|name| graph.variable(name));
        Letters { graph, x, y, z }
    }

    fn c(&self, value: f64) -> Expr<'g> {
        self.graph.constant(value)
    }
}

/// Holds each expression against the text that it must simplify to.
fn check<const N: usize>(cases: impl for<'g> Fn(&Letters<'g>) -> [(Expr<'g>, &'static str); N]) {
    let graph = Graph::new();
    for (index, (found, expected)) in cases(&Letters::new(&graph)).into_iter().enumerate() {
        assert_eq!(found.to_string(), expected, "case {index}");
    }
}

#[test]
fn sums() {
    check(|&Letters { graph, x, y, z }| {
        [
            (x + 0.0, "x"),
            (0.0 + x, "x"),
            (x + x, "2 * x"),
            (x + -y, "x - y"),
            (-x + y, "y - x"),
            (-x + -y, "-(x + y)"),
            (x + -2.0 * y, "x - 2 * y"),
            (1.0 + (2.0 + x), "x + 3"),
            ((x + 1.0) + 2.0, "x + 3"),
            ((x + 1.0) - 3.0, "x - 2"),
            (y + x, "x + y"),
            (x + (y + z), "x + y + z"),
            (graph.constant(2.0) + 3.0, "5"),
            (x.sin().squared() + x.cos().squared(), "1"),
            (x.cos().squared() + x.sin().squared(), "1"),
            (x.cos().squared() + y.sin().squared(), "cos(x)^2 + sin(y)^2"),
            ((x * z.cos() - y * z.sin()).squared() + (x * z.sin() + y * z.cos()).squared(), "x^2 + y^2"),
            ((x * z.cos() - 2.0 * z.sin()).squared() + (2.0 * z.cos() + x * z.sin()).squared(), "x^2 + 4"),
            ((x + y).squared() + (x - z).squared(), "(x + y)^2 + (x - z)^2"),
        ]
    });
}

#[test]
fn differences() {
    check(|&Letters { x, y, .. }| {
        [
            (x - 0.0, "x"),
            (0.0 - x, "-x"),
            (x - x, "0"),
            (x - -y, "x + y"),
            (x - -2.0 * y, "x + 2 * y"),
            ((x + y) - y, "x"),
            ((x + y) - x, "y"),
            (x - (x + y), "-y"),
            (y - (x + y), "-x"),
            ((x - y) - x, "-y"),
            (x - (x - y), "y"),
            ((x - y) + y, "x"),
            (y + (x - y), "x"),
            ((x - y) + (y - x), "0"),
            ((1.0 - y) + (2.0 + y), "3"),
            (-x - y, "-(x + y)"),
            (x - 3.0, "x - 3"),
            (3.0 - x, "3 - x"),
            (-(x - y), "y - x"),
            (-(-x), "x"),
        ]
    });
}

#[test]
fn products() {
    check(|&Letters { x, y, z, .. }| {
        [
            (x * 0.0, "0"),
            (0.0 * x, "0"),
            (x * 1.0, "x"),
            (x * -1.0, "-x"),
            (2.0 * (3.0 * x), "6 * x"),
            ((x * 3.0) * 2.0, "6 * x"),
            (2.0 * -x, "-2 * x"),
            (-(2.0 * x), "-2 * x"),
            (-x * y, "-x * y"),
            (x * -y, "-x * y"),
            (-x * -y, "x * y"),
            ((2.0 * x) * y, "2 * x * y"),
            (x * (2.0 * y), "2 * y * x"),
            ((2.0 * x) * (3.0 * y), "6 * x * y"),
            (y * x, "x * y"),
            (x.sqrt() * x.sqrt(), "x"),
            (x * y + x * z, "x * (y + z)"),
            (x * y - z * x, "x * (y - z)"),
            (2.0 * x + 3.0 * x, "5 * x"),
            (x + 3.0 * x, "4 * x"),
            (3.0 * x - x, "2 * x"),
            (x * (3.0 * x), "3 * x^2"),
            (2.0 * x - 2.0 * y, "2 * (x - y)"),
            (2.0 * (x * y) + 2.0 * (x * z), "2 * x * (y + z)"),
        ]
    });
}

#[test]
fn quotients_and_powers() {
    check(|letters @ &Letters { x, y, .. }| {
        [
            (0.0 / x, "0"),
            (x / x, "1"),
            (x / 1.0, "x"),
            (x / -1.0, "-x"),
            (-x / y, "-x / y"),
            (x / -y, "-x / y"),
            (-x / -y, "x / y"),
            (x / 3.0, "x / 3"),
            ((3.0 * x) / (2.0 * y), "1.5 * x / y"),
            (x.pow(letters.c(0.0)), "1"),
            (x.pow(letters.c(1.0)), "x"),
            (x.pow(letters.c(2.0)), "x^2"),
            (x.pow(letters.c(-1.0)), "1 / x"),
            (x.pow(letters.c(0.5)), "sqrt(x)"),
            (x.pow(letters.c(1.5)), "x^1.5"),
            (x.pow(y), "x^y"),
            (x.powi(3), "x * x^2"),
            (x.powi(-2), "1 / x^2"),
            (x.powi(0), "1"),
        ]
    });
}

#[test]
fn functions() {
    check(|letters @ &Letters { x, y, .. }| {
        [
            ((-x).sin(), "-sin(x)"),
            ((-x).tan(), "-tan(x)"),
            ((-x).asin(), "-asin(x)"),
            ((-x).atan(), "-atan(x)"),
            ((-x).sinh(), "-sinh(x)"),
            ((-x).tanh(), "-tanh(x)"),
            ((-x).sign(), "-sign(x)"),
            ((-x).cos(), "cos(x)"),
            ((-x).cosh(), "cosh(x)"),
            ((-x).abs(), "abs(x)"),
            ((-2.0 * x).sin(), "-sin(2 * x)"),
            ((-2.0 * x).cos(), "cos(2 * x)"),
            ((-2.0 * x).tan(), "-tan(2 * x)"),
            (x.squared().sqrt(), "abs(x)"),
            (x.squared().abs(), "x^2"),
            (x.sqrt().abs(), "sqrt(x)"),
            (x.exp().abs(), "exp(x)"),
            (x.abs().abs(), "abs(x)"),
            (x.min(x), "x"),
            (x.max(x), "x"),
            (y.min(x), "min(x, y)"),
            (x.max(letters.c(3.0)), "max(3, x)"),
            ((-x).exp(), "exp(-x)"),
            ((-x).acos(), "acos(-x)"),
            (y.atan2(x), "atan2(y, x)"),
        ]
    });
}

#[test]
fn constants_that_do_not_merge_stay() {
    let graph = Graph::new();
    let x = graph.variable("x");
    // the product of the constants underflows or overflows, that with x does not
    let cases = [
        (1e-200 * (1e-200 * x), 1e300, 1e-100),
        (1e200 * (1e200 * x), 1e-300, 1e100),
        (((1e-200 * x) * 1e-200) * (x * 1.0), 1e250, 1e100),
        (1e308 + (1e308 + x), -1e308, 1e308),
    ];
    for (found, at, expected) in cases {
        let value = graph.evaluate(&[found], &[at])[0];
        assert!((value / expected - 1.0).abs() < 1e-14, "{found} at {at}: {value}");
    }
}

#[test]
fn one_zero_and_one_nan() {
    let graph = Graph::new();
    assert_eq!(graph.constant(0.0), graph.constant(-0.0));
    assert_eq!(graph.constant(f64::NAN), graph.constant(-f64::NAN));
    assert_eq!(graph.constant(f64::NAN), graph.constant(f64::from_bits(0x7ff8_0000_0000_0001)));
    assert_ne!(graph.constant(f64::INFINITY), graph.constant(f64::NEG_INFINITY));
    assert_eq!(-graph.constant(0.0), graph.constant(0.0));
    assert!(graph.constant(-0.0).is_zero());
    let is_nan = |value: Expr<'_>| value.as_constant().is_some_and(f64::is_nan);
    let infinity = graph.constant(f64::INFINITY);
    assert!(is_nan(infinity - infinity));
    assert!(is_nan(infinity * 0.0));
    assert!(is_nan(graph.constant(0.0) / 0.0));
    assert!(is_nan(graph.constant(-1.0).sqrt()));
    assert!(is_nan(graph.constant(f64::NAN).min(graph.constant(1.0))));
    assert!(is_nan(graph.constant(1.0).max(graph.constant(f64::NAN))));
    assert_eq!((graph.constant(1.0) / 0.0).as_constant(), Some(f64::INFINITY));
}

#[test]
fn nan_and_infinity_do_not_vanish_in_variables() {
    let graph = Graph::new();
    let x = graph.variable("x");
    for f in [x + f64::NAN, x * f64::NAN, f64::NAN / x, x - f64::INFINITY, x / f64::INFINITY] {
        assert!(f.as_constant().is_none(), "{f}");
    }
    assert!(graph.evaluate(&[x * f64::NAN], &[1.0])[0].is_nan());
}

#[test]
fn sine_and_cosine_are_exact_at_right_angles() {
    let graph = Graph::new();
    for k in -4000_i32..4000 {
        let degrees = 90.0 * f64::from(k);
        let sine = [0.0, 1.0, 0.0, -1.0][k.rem_euclid(4) as usize];
        let cosine = [1.0, 0.0, -1.0, 0.0][k.rem_euclid(4) as usize];
        let angles = [
            degrees.to_radians(),
            degrees * (PI / 180.0),
            degrees * PI / 180.0,
            degrees / 180.0 * PI,
            30_f64.to_radians() + (degrees - 30.0).to_radians(),
        ];
        for angle in angles.into_iter().take(if k.abs() > 1 { 5 } else { 4 }) {
            let angle = graph.constant(angle);
            assert_eq!(angle.sin().as_constant(), Some(sine), "sin {degrees}°");
            assert_eq!(angle.cos().as_constant(), Some(cosine), "cos {degrees}°");
            if k % 2 == 0 {
                assert_eq!(angle.tan().as_constant(), Some(0.0), "tan {degrees}°");
            }
        }
    }
}

#[test]
fn other_angles_are_left_alone() {
    let graph = Graph::new();
    for angle in [5e-324, 1e-300, 1e-17, PI + 1e-14, PI / 2.0 - 1e-14, 1.0, 1e9, f64::MAX] {
        for op in [Unary::Sin, Unary::Cos, Unary::Tan] {
            assert_eq!(graph.constant(angle).unary(op).as_constant(), Some(op.apply(angle)), "{op:?} {angle}");
        }
    }
}

#[test]
#[should_panic(expected = "two graphs")]
fn graphs_do_not_mix() {
    let (one, other) = (Graph::new(), Graph::new());
    let _ = one.variable("x") + other.variable("x");
}

#[test]
fn powers() {
    let graph = Graph::new();
    let x = graph.variable("x");
    for exponent in [-64, -63, -7, -1, 0, 1, 2, 3, 5, 10, 31, 63, 64] {
        let found = graph.evaluate(&[x.powi(exponent), x.pow(graph.constant(f64::from(exponent)))], &[-1.1]);
        let expected = (-1.1_f64).powi(exponent);
        assert_eq!(found[0].to_bits(), found[1].to_bits());
        assert!((found[0] / expected - 1.0).abs() < 1e-13, "power {exponent}");
    }
    // no overflow of the exponent itself
    assert_eq!(graph.evaluate(&[x.powi(i32::MIN), x.powi(i32::MAX)], &[1.0]), [1.0, 1.0]);
    assert_eq!(graph.evaluate(&[x.powi(i32::MIN)], &[2.0]), [0.0]);
    assert_eq!(graph.evaluate(&[x.pow(graph.constant(f64::INFINITY))], &[2.0]), [f64::INFINITY]);
    assert!(graph.evaluate(&[x.pow(graph.constant(f64::NAN))], &[2.0])[0].is_nan());
}
