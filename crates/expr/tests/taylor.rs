//! Power series of tapes against derivatives of the graph along a path, to order five, and enclosures of them.

mod support;

use flank_expr::{Binary, Curve, Expr, Graph, Interval, Tape, TaylorEvaluator, Unary};
use support::{Program, Random, reference_point};

const ORDER: usize = 5;
/// The paths `x_k = start + Σ path hʲ`: every coefficient counts.
const PATHS: [[f64; ORDER]; 3] =
    [[0.3, -0.2, 0.1, 0.05, -0.07], [-0.4, 0.15, 0.2, -0.1, 0.02], [1.0, 0.0, 0.0, 0.0, 0.0]];

/// The inputs' series.
fn along(start: &[f64]) -> Vec<f64> {
    let series = |(k, x): (usize, &f64)| std::iter::once(*x).chain(PATHS[k % PATHS.len()]).collect::<Vec<f64>>();
    start.iter().enumerate().flat_map(series).collect()
}

fn of_tape(graph: &Graph, f: Expr<'_>, inputs: &[Expr<'_>], start: &[f64]) -> Vec<f64> {
    assert!(std::ptr::eq(graph, f.graph()));
    let tape = Tape::new(&[f], inputs).expect("all given");
    let mut series = vec![f64::NAN; ORDER + 1];
    TaylorEvaluator::new(&tape, ORDER).run(&along(start), &mut series);
    series
}

/// The same from derivatives by h of `f` with the paths put in.
fn of_graph<'g>(graph: &'g Graph, f: Expr<'g>, inputs: &[Expr<'g>], start: &[f64]) -> Vec<f64> {
    let h = graph.variable("h");
    let path = |k: usize| {
        let by = PATHS[k % PATHS.len()].iter().enumerate();
        by.fold(graph.constant(start[k]), |sum, (j, c)| sum + *c * h.powi(j as i32 + 1))
    };
    let replaced: Vec<(Expr<'g>, Expr<'g>)> = inputs.iter().enumerate().map(|(k, x)| (*x, path(k))).collect();
    let mut derivative = graph.substitute(&[f], &replaced)[0];
    let mut factorial = 1.0;
    (0..=ORDER)
        .map(|k| {
            if k > 0 {
                derivative = derivative.derivative(h);
                factorial *= k as f64;
            }
            let mut values = start.to_vec();
            values.resize(start.len() + 1, 0.0);
            graph.evaluate(&[derivative], &values)[0] / factorial
        })
        .collect()
}

/// The longer the recurrence, the larger the terms whose difference a coefficient is: the tolerance is relative to the largest.
fn agree(found: &[f64], expected: &[f64], what: &str) {
    let scale = expected.iter().fold(1.0, |scale: f64, c| scale.max(c.abs()));
    for (k, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= 1e-12 * scale, "{what}, order {k}: {a:e} instead of {b:e}");
    }
}

fn arguments(op: Unary) -> &'static [f64] {
    match op {
        Unary::Sqrt | Unary::Ln => &[0.3, 1.0, 7.0],
        Unary::Acosh => &[1.7, 4.0],
        Unary::Asin | Unary::Acos | Unary::Atanh => &[-0.7, 0.0, 0.4],
        Unary::Arcinv => &[-2.0, 0.4, 3.0],
        Unary::Abs | Unary::Sign => &[-1.3, 0.6],
        _ => &[-1.2, 0.0, 0.7, 2.1],
    }
}

#[test]
fn every_operation_on_one_number() {
    for op in Unary::ALL {
        for &at in arguments(op) {
            let graph = Graph::new();
            let x = graph.variable("x");
            let f = x.unary(op);
            let expected = of_graph(&graph, f, &[x], &[at]);
            agree(&of_tape(&graph, f, &[x], &[at]), &expected, &format!("{op:?} at {at}"));
        }
    }
}

#[test]
fn every_operation_on_two_numbers() {
    for op in Binary::ALL {
        for at in [[0.7, 1.9], [2.5, -0.4], [1.3, 3.0]] {
            let graph = Graph::new();
            let (x, y) = (graph.variable("x"), graph.variable("y"));
            let f = x.binary(op, y);
            let expected = of_graph(&graph, f, &[x, y], &at);
            agree(&of_tape(&graph, f, &[x, y], &at), &expected, &format!("{op:?} at {at:?}"));
        }
    }
}

/// Whole powers at zero and below, where a recurrence that divides by the base has nothing to say.
#[test]
fn powers_with_constant_exponents() {
    for exponent in [3.0, 2.0, -2.0, 0.5, -1.7, 9.0] {
        for at in [-0.8, 0.0, 1.4] {
            if at <= 0.0 && (exponent < 0.0 && at == 0.0 || f64::fract(exponent) != 0.0) {
                continue;
            }
            let graph = Graph::new();
            let x = graph.variable("x");
            let f = x.binary(Binary::Pow, graph.constant(exponent));
            let product = (1..exponent.abs() as u32).fold(x, |product, _| product * x);
            let whole = exponent.fract() == 0.0;
            let same = if !whole {
                (exponent * x.ln()).exp()
            } else if exponent < 0.0 {
                1.0 / product
            } else {
                product
            };
            let expected = of_graph(&graph, same, &[x], &[at]);
            agree(&of_tape(&graph, f, &[x], &[at]), &expected, &format!("{at}^{exponent}"));
        }
    }
}

/// Along a spline its cubic is met exactly; so is that of its derivatives.
#[test]
fn curves() {
    let points: Vec<(f64, f64)> = (0..9).map(|k| (f64::from(k) * 0.5, f64::sin(f64::from(k)))).collect();
    for order in 0..=3 {
        let graph = Graph::new();
        let x = graph.variable("x");
        let curve = graph.curve(Curve::through("sine", &points).expect("increasing"));
        let f = x.on_curve(curve, order) * x;
        let expected = of_graph(&graph, f, &[x], &[1.3]);
        agree(&of_tape(&graph, f, &[x], &[1.3]), &expected, &format!("derivative {order}"));
    }
}

#[test]
fn random_programs() {
    let mut random = Random(47);
    for round in 0..40 {
        let program = Program::tame(&mut random, 3, 14);
        let graph = Graph::new();
        let inputs = ["x", "y", "z"].map(|name| graph.variable(name));
        let built = program.build(&inputs, &graph);
        let (f, start) = (built[built.len() - 1], reference_point(3));
        agree(&of_tape(&graph, f, &inputs, &start), &of_graph(&graph, f, &inputs, &start), &format!("round {round}"));
    }
}

/// A box of starts: the coefficients at points of it lie in the enclosures, which are narrow for a narrow box.
#[test]
fn intervals_enclose_the_series_of_every_point() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    let f = (x.sin() * y).atan2(2.0 + x * y) + (1.0 + x * x).sqrt() / y.exp() + x.tan().asin();
    let tape = Tape::new(&[f], &[x, y]).expect("all given");
    let boxed = |radius: f64| {
        let start = [0.3, 0.8].map(|at| Interval::new(at - radius, at + radius));
        let series = start.iter().zip(PATHS).flat_map(|(x, path)| {
            std::iter::once(*x).chain(path.into_iter().map(Interval::point)).collect::<Vec<Interval>>()
        });
        let mut enclosed = vec![Interval::WHOLE; ORDER + 1];
        TaylorEvaluator::new(&tape, ORDER).run(&series.collect::<Vec<Interval>>(), &mut enclosed);
        enclosed
    };
    let wide = boxed(0.05);
    let mut random = Random(3);
    for _ in 0..200 {
        let mut share = || random.between(-0.05, 0.05);
        let at = [0.3 + share(), 0.8 + share()];
        for (k, (enclosed, c)) in wide.iter().zip(of_tape(&graph, f, &[x, y], &at)).enumerate() {
            assert!(enclosed.continuous && enclosed.contains(c), "order {k}: {c} is not in {enclosed:?}");
        }
    }
    for (k, enclosed) in boxed(0.0).iter().enumerate() {
        assert!(enclosed.width() < 1e-11, "order {k}: {enclosed:?}");
    }
}
