//! Derivatives against hyper-dual numbers of another library, and at kinks.

mod support;

use std::f64::consts::PI;

use flank_expr::{Binary, Expr, Graph, ScalarEvaluator, Tape, Unary};
use num_dual::{DualNum, HyperDual64};
use support::{Program, Random, Step, reference_point};

/// The value and its derivatives along two directions: (f, f1, f2, f12).
fn dual_unary(op: Unary, a: HyperDual64) -> HyperDual64 {
    match op {
        Unary::Neg => -a,
        Unary::Sqrt => a.sqrt(),
        Unary::Sin => a.sin(),
        Unary::Cos => a.cos(),
        Unary::Tan => a.tan(),
        Unary::Asin => a.asin(),
        Unary::Acos => a.acos(),
        Unary::Atan => a.atan(),
        Unary::Sinh => a.sinh(),
        Unary::Cosh => a.cosh(),
        Unary::Tanh => a.tanh(),
        Unary::Asinh => a.asinh(),
        Unary::Acosh => a.acosh(),
        Unary::Atanh => a.atanh(),
        // Newton on tan y − y = a in dual numbers: three rounds settle two orders
        Unary::Arcinv => {
            (0..3).fold(HyperDual64::from_re(op.apply(a.re)), |y, _| y - (y.tan() - y - a) / y.tan().powi(2))
        }
        Unary::Exp => a.exp(),
        Unary::Ln => a.ln(),
        Unary::Abs if a.re < 0.0 => -a,
        Unary::Abs => a,
        Unary::Sign => HyperDual64::from_re(op.apply(a.re)),
    }
}

fn dual_binary(op: Binary, a: HyperDual64, b: HyperDual64) -> HyperDual64 {
    let is_number = (b.eps1, b.eps2, b.eps1eps2) == (0.0, 0.0, 0.0);
    match op {
        Binary::Add => a + b,
        Binary::Sub => a - b,
        Binary::Mul => a * b,
        Binary::Div => a / b,
        Binary::Pow if is_number => a.powf(b.re),
        Binary::Pow => a.powd(b),
        // the library's own divides by the second operand, which may be zero
        Binary::Atan2 if b.re.abs() >= a.re.abs() => (a / b).atan() + half_turns(a.re, b.re),
        Binary::Atan2 => -(b / a).atan() + (PI / 2.0).copysign(a.re),
        Binary::Min if a.re < b.re => a,
        Binary::Max if a.re > b.re => a,
        Binary::Min | Binary::Max => b,
    }
}

fn half_turns(y: f64, x: f64) -> f64 {
    if x > 0.0 { 0.0 } else { PI.copysign(y) }
}

/// Fails unless the two agree to `tolerance` times the scale. Not-a-number agrees with nothing.
fn agree(found: f64, expected: f64, scale: f64, tolerance: f64) -> Result<(), String> {
    if (found - expected).abs() <= tolerance * scale {
        Ok(())
    } else {
        Err(format!("{found:?} instead of {expected:?} (scale {scale:e})"))
    }
}

/// Arguments inside the domain of an operation, up to the places where it gets steep.
fn arguments(op: Unary) -> Vec<f64> {
    let symmetric = [-20.0, -3.0, -1.2, -0.5, -1e-3, 1e-9, 0.3, 0.9, 1.5, 2.5, 30.0];
    match op {
        Unary::Sqrt | Unary::Ln => vec![1e-12, 1e-3, 0.5, 1.0, 7.0, 1e9],
        Unary::Acosh => vec![1.001, 1.5, 4.0, 1e6],
        Unary::Atanh => vec![-0.999, -0.5, 1e-6, 0.3, 0.999],
        // near zero the slope 1/tan² grows beyond what dual numbers resolve
        Unary::Arcinv => vec![-20.0, -0.5, 0.015, 0.3, 2.0, 30.0],
        Unary::Asin | Unary::Acos => {
            vec![-0.9999999999, -0.99, -0.5, 1e-9, 0.3, 0.999, 0.9999999999]
        }
        _ => symmetric.to_vec(),
    }
}

/// Value, first and second derivative of one operation of one variable.
fn of_unary(op: Unary, at: f64) -> [f64; 3] {
    let graph = Graph::new();
    let x = graph.variable("x");
    let f = x.unary(op);
    let slope = f.derivative(x);
    let found = graph.evaluate(&[f, slope, slope.derivative(x)], &[at]);
    [found[0], found[1], found[2]]
}

fn seeded(at: f64, along: (f64, f64)) -> HyperDual64 {
    HyperDual64::new(at, along.0, along.1, 0.0)
}

/// The value, both slopes, and the three second derivatives.
fn of_binary(op: Binary, (a, b): (f64, f64)) -> [f64; 6] {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    let f = x.binary(op, y);
    let (fx, fy) = (f.derivative(x), f.derivative(y));
    let all = [f, fx, fy, fx.derivative(x), fx.derivative(y), fy.derivative(y)];
    graph.evaluate(&all, &[a, b]).try_into().expect("six")
}

fn expected_of_binary(op: Binary, (a, b): (f64, f64)) -> [f64; 6] {
    let along = |first, second| {
        let unit = |k: usize| if k == 0 { (1.0, 0.0) } else { (0.0, 1.0) };
        let (i, j): ((f64, f64), (f64, f64)) = (unit(first), unit(second));
        dual_binary(op, seeded(a, (i.0, j.0)), seeded(b, (i.1, j.1)))
    };
    let (xx, xy, yy) = (along(0, 0), along(0, 1), along(1, 1));
    [xx.re, xx.eps1, yy.eps1, xx.eps1eps2, xy.eps1eps2, yy.eps1eps2]
}

const TIGHT: f64 = 1e-13;

#[test]
fn every_unary_operation() {
    for op in Unary::ALL {
        for at in arguments(op) {
            let dual = dual_unary(op, seeded(at, (1.0, 1.0)));
            for (found, expected) in of_unary(op, at).into_iter().zip([dual.re, dual.eps1, dual.eps1eps2]) {
                // slopes that die out exponentially are exact to the last place of 1
                let scale = if op == Unary::Tanh { 1.0 } else { expected.abs() };
                agree(found, expected, scale, TIGHT).unwrap_or_else(|why| panic!("{op:?} at {at}: {why}"));
            }
        }
    }
}

#[test]
fn every_binary_operation() {
    let points = [(0.7, 1.9), (2.5, 0.4), (1e-3, 3.0), (4.0, -2.2), (-0.8, 1.3), (-3.0, -0.6), (1e5, 1e-4)];
    for op in Binary::ALL {
        for point in points {
            if op == Binary::Pow && point.0 < 0.0 {
                continue;
            }
            let expected = expected_of_binary(op, point);
            let scale = expected.iter().fold(0.0_f64, |scale, value| scale.max(value.abs()));
            for (k, (found, expected)) in of_binary(op, point).into_iter().zip(expected).enumerate() {
                // each on its own scale, or on that of what cancelled in it
                let own = expected.abs().max(1e-3 * scale.min(1.0));
                agree(found, expected, own, 1e-12)
                    .unwrap_or_else(|why| panic!("{op:?} at {point:?}, number {k}: {why}"));
            }
        }
    }
}

#[test]
fn a_wrong_derivative_fails_the_comparison() {
    for op in Unary::ALL {
        for at in arguments(op) {
            let right = of_unary(op, at)[1];
            for wrong in [-right, right * (1.0 + 1e-9), right + 1e-9 * right.abs().max(1.0), f64::NAN] {
                let is_other = wrong.is_nan() || (wrong - right).abs() > TIGHT * right.abs();
                assert_eq!(
                    agree(wrong, right, right.abs(), TIGHT).is_err(),
                    is_other,
                    "{op:?} at {at}: {wrong} passes for {right}"
                );
            }
        }
    }
    // and the whole way: a graph that claims that sin′ = −cos
    let graph = Graph::new();
    let x = graph.variable("x");
    let claimed = graph.evaluate(&[-x.cos()], &[0.3])[0];
    let dual = dual_unary(Unary::Sin, seeded(0.3, (1.0, 1.0)));
    assert!(agree(claimed, dual.eps1, dual.eps1.abs(), TIGHT).is_err());
}

/// Every step in hyper-dual numbers, along variables `i` and `j`.
fn dual_run(program: &Program, point: &[f64], i: usize, j: usize) -> Vec<HyperDual64> {
    let unit = |k: usize, of: usize| f64::from(k == of);
    let mut values: Vec<HyperDual64> = Vec::new();
    for &step in &program.steps {
        values.push(match step {
            Step::Constant(value) => HyperDual64::from_re(value),
            Step::Variable(k) => seeded(point[k], (unit(k, i), unit(k, j))),
            Step::Unary(op, a) => dual_unary(op, values[a]),
            Step::Binary(op, a, b) => dual_binary(op, values[a], values[b]),
        });
    }
    values
}

#[test]
fn random_programs_first_and_second() {
    const VARIABLES: usize = 3;
    let mut random = Random(3);
    let (mut compared, mut steep) = (0, 0);
    for _ in 0..60 {
        let program = Program::tame(&mut random, VARIABLES, 60);
        let point = reference_point(VARIABLES);
        let graph = Graph::new();
        let variables: Vec<Expr<'_>> = (0..VARIABLES).map(|k| graph.variable(format!("x{k}"))).collect();
        let built = program.build(&variables, &graph);
        for (i, j) in [(0, 0), (0, 1), (1, 2), (2, 2)] {
            let expected = dual_run(&program, &point, i, j);
            let mut scale = (1.0_f64, 1.0_f64);
            for (index, (&f, dual)) in built.iter().zip(&expected).enumerate() {
                scale.0 = scale.0.max(dual.eps1.abs()).max(dual.eps2.abs());
                scale.1 = scale.1.max(dual.eps1eps2.abs()).max(scale.0 * scale.0);
                if scale.1 > 1e8 {
                    steep += 1;
                    continue;
                }
                let first = f.derivative(variables[i]);
                let found = graph.evaluate(&[f, first, first.derivative(variables[j])], &point);
                let pairs =
                    [(found[0], dual.re, 20.0), (found[1], dual.eps1, scale.0), (found[2], dual.eps1eps2, scale.1)];
                for (found, expected, scale) in pairs {
                    agree(found, expected, scale, 1e-11)
                        .unwrap_or_else(|why| panic!("step {index} along {i}, {j}: {why}\n{f}\n{program:?}"));
                }
                compared += 1;
            }
        }
    }
    assert!(compared > 5000 && steep < compared, "{compared} compared, {steep} too steep");
}

#[test]
fn kinks_take_the_mean() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    let cases = [
        // expression, derivative by x at (x, y), expected
        (x.abs(), (0.0, 0.0), 0.0),
        (x.abs(), (-2.0, 0.0), -1.0),
        (x.sign(), (0.0, 0.0), 0.0),
        (x.min(y), (1.0, 1.0), 0.5),
        (x.max(y), (1.0, 1.0), 0.5),
        (x.min(y), (1.0, 2.0), 1.0),
        (x.max(y), (1.0, 2.0), 0.0),
        ((3.0 * x).max(x + y), (1.0, 2.0), 2.0),
        (x.squared().sqrt(), (0.0, 0.0), 0.0),
        (x.sqrt(), (0.0, 0.0), f64::INFINITY),
    ];
    for (f, (a, b), expected) in cases {
        assert_eq!(graph.evaluate(&[f.derivative(x)], &[a, b]), [expected], "d({f})/dx at {a}, {b}");
    }
}

#[test]
fn the_side_not_taken_leaves_no_error() {
    let graph = Graph::new();
    let x = graph.variable("x");
    let slope = (1e20 * x + 1.0).min(3.0 * x).derivative(x);
    assert_eq!(graph.evaluate(&[slope], &[1.0]), [3.0]);
    let slope = (1e20 * x - 1e21).max(3.0 * x).derivative(x);
    assert_eq!(graph.evaluate(&[slope], &[1.0]), [3.0]);
}

#[test]
fn powers_of_negative_bases() {
    let graph = Graph::new();
    let x = graph.variable("x");
    let exponents = [2.0, 3.0, -1.0, -4.0, 64.0, 65.0, 70.0, -71.0];
    for exponent in exponents {
        let power = x.pow(graph.constant(exponent));
        let slope = power.derivative(x);
        let found = graph.evaluate(&[power, slope], &[-1.25]);
        let expected = (-1.25_f64).powf(exponent);
        agree(found[0], expected, expected.abs(), 1e-14).unwrap();
        let expected = exponent * (-1.25_f64).powf(exponent - 1.0);
        agree(found[1], expected, expected.abs(), 1e-14).unwrap();
    }
}

#[test]
fn a_variable_that_does_not_occur_gives_zero() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    assert!((x.sin() / x.exp()).derivative(y).is_zero());
    assert!(graph.constant(3.0).derivative(y).is_zero());
    assert!((y.sin() * 0.0 + x).derivative(y).is_zero());
}

#[test]
fn nodes_grow_linearly_with_the_chain() {
    let nodes = |length: usize| {
        let graph = Graph::new();
        let (x, y) = (graph.variable("x"), graph.variable("y"));
        let mut f = x;
        for _ in 0..length {
            f = (f * y + x).sin() / (f + 2.0);
        }
        graph.count(&[f.derivative(x), f.derivative(y)]).shared
    };
    let (short, long) = (nodes(500), nodes(1000));
    assert!(long < 30 * 1000, "{long} nodes for 1000 steps");
    assert!(long - short <= short + 10, "{short} nodes, then {long}");
}

#[test]
fn asking_again_makes_nothing_new() {
    let graph = Graph::new();
    let x = graph.variable("x");
    let f = (x.sin() * x).exp().derivative(x);
    let before = graph.len();
    assert_eq!((x.sin() * x).exp().derivative(x), f);
    assert_eq!(graph.len(), before);
}

#[test]
fn tape_of_a_jacobian_gives_the_oracles_numbers() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    let f = [x.atan2(y) * y.sqrt(), (x * y).cos() / x];
    let jacobian: Vec<Expr<'_>> = f.iter().flat_map(|f| [f.derivative(x), f.derivative(y)]).collect();
    let tape = Tape::new(&jacobian, &[x, y]).unwrap();
    let mut found = [0.0; 4];
    ScalarEvaluator::new(&tape).run(&[0.7, 1.1], &mut found);
    assert_eq!(found.to_vec(), graph.evaluate(&jacobian, &[0.7, 1.1]));
}

#[test]
fn what_is_linear_in_a_variable_is_solved_for_it() {
    let graph = Graph::new();
    let (s, a, q) = (graph.variable("s"), graph.variable("a"), graph.variable("q"));
    // n · (ω × (r + s t) + v), written as a solver would meet it
    let equation = (3.0 + s * a.sin()) * q.cos() - (s * a.cos() - 2.0) * q.sin() + 0.5;
    let linear = equation.linear_in(s).expect("it is linear in s");
    let at = |expr: Expr<'_>, values: [f64; 3]| {
        let tape = Tape::new(&[expr], &[s, a, q]).expect("nothing else is unknown");
        let mut out = [0.0];
        ScalarEvaluator::new(&tape).run(&values, &mut out);
        out[0]
    };
    for (a, q) in [(0.3, 0.7), (1.2, -2.0), (-0.4, 0.1)] {
        let root = at(linear.root(), [f64::NAN, a, q]);
        assert!(at(equation, [root, a, q]).abs() < 1e-14 * root.abs().max(1.0));
        let values = [0.0, 1.0].map(|s| at(equation, [s, a, q]));
        assert!((values[0] - at(linear.intercept, [7.0, a, q])).abs() < 1e-15);
        assert!((values[1] - values[0] - at(linear.slope, [7.0, a, q])).abs() < 1e-14);
    }
    assert_eq!(equation.linear_in(a), None);
    assert_eq!(equation.linear_in(q), None);
    assert_eq!((s * s).linear_in(s), None);
    assert_eq!(a.sin().linear_in(s), None, "it does not depend on s at all");
    assert_eq!(s.linear_in(s).map(|linear| linear.root().as_constant()), Some(Some(0.0)));
}
