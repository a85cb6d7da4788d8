//! The suite, generic over the evaluator: implement [`Subject`], then `evaluator_suite!(name, Type)`.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use flank_expr::{Binary, Curve, End, Expr, Graph, Interval, Tape, TapeError, Unary, Unknown, integral, roots};

use crate::support::{Program, Random, reference_point};

/// An evaluator under test.
pub(crate) trait Subject {
    /// What it computes: a float, an interval, a series.
    type Value: std::fmt::Debug;

    /// The outputs at each point.
    fn evaluate(tape: &Tape, points: &[Vec<f64>]) -> Vec<Vec<Self::Value>>;

    /// Whether that is the oracle's number (an interval contains it, lanes may be off in the last place).
    fn agrees(expected: f64, found: &Self::Value) -> bool;
}

/// One test for each part of the suite.
#[macro_export]
macro_rules! evaluator_suite {
    ($name:ident, $subject:ident) => {
        $crate::evaluator_suite!($name, $subject:
            every_unary_alone every_binary_alone curves roots_of_equations integrals combinations constants_only outputs_that_are_inputs
            one_output_twice outputs_used_later no_outputs unused_inputs unbound_variable random_programs
            random_tame_programs many_points);
    };
    ($name:ident, $subject:ident: $($check:ident)*) => {
        mod $name {
            $(#[test]
            fn $check() {
                super::suite::$check::<super::$subject>();
            })*
        }
    };
}

/// Arguments where evaluators differ if they differ anywhere.
fn special_arguments() -> Vec<f64> {
    let tiny = f64::MIN_POSITIVE;
    let positive = [
        0.0,
        5e-324,
        tiny / 3.0,
        tiny,
        1e-300,
        1e-20,
        1e-8,
        0.1,
        0.5,
        1.0 - f64::EPSILON / 2.0,
        1.0,
        1.0 + f64::EPSILON,
        1.5,
        2.0,
        3.0,
        FRAC_PI_4,
        FRAC_PI_2,
        PI,
        3.0 * FRAC_PI_2,
        2.0 * PI,
        100.0 * PI,
        1e6 * PI,
        20.0,
        709.0,
        710.5,
        745.2,
        1e8,
        1e17,
        1e300,
        f64::MAX,
        f64::INFINITY,
    ];
    let negative = positive.iter().map(|x| -x);
    positive.into_iter().chain(negative).chain([f64::NAN]).collect()
}

/// Holds the subject against the oracle. The variables of the graph are the inputs, in order.
fn check<S: Subject>(outputs: &[Expr<'_>], inputs: &[Expr<'_>], points: &[Vec<f64>]) {
    let tape = Tape::new(outputs, inputs).expect("every variable is an input");
    assert_eq!(tape.input_count(), inputs.len());
    assert_eq!(tape.output_count(), outputs.len());
    let found = S::evaluate(&tape, points);
    assert_eq!(found.len(), points.len(), "one row for each point");
    for (point, row) in points.iter().zip(&found) {
        let expected = match outputs.first() {
            Some(output) => output.graph().evaluate(outputs, point),
            None => Vec::new(),
        };
        assert_eq!(row.len(), expected.len(), "one value for each output");
        for (k, (value, &number)) in row.iter().zip(&expected).enumerate() {
            assert!(
                S::agrees(number, value),
                "output {k} at {point:?}: {value:?}, the oracle says {number:?}: {}",
                outputs[k]
            );
        }
    }
}

pub(crate) fn every_unary_alone<S: Subject>() {
    let points: Vec<Vec<f64>> = special_arguments().into_iter().map(|x| vec![x]).collect();
    for op in Unary::ALL {
        let graph = Graph::new();
        let x = graph.variable("x");
        check::<S>(&[x.unary(op)], &[x], &points);
    }
}

pub(crate) fn every_binary_alone<S: Subject>() {
    let arguments = special_arguments();
    let pair = |&a: &f64| arguments.iter().map(move |&b| vec![a, b]);
    let points: Vec<Vec<f64>> = arguments.iter().flat_map(pair).collect();
    for op in Binary::ALL {
        let graph = Graph::new();
        let (x, y) = (graph.variable("x"), graph.variable("y"));
        check::<S>(&[x.binary(op, y), y.binary(op, x), x.binary(op, x)], &[x, y], &points);
    }
}

/// Curves: several of them, several orders, beyond their ends.
pub(crate) fn curves<S: Subject>() {
    let graph = Graph::new();
    let x = graph.variable("x");
    let table = |f: fn(f64) -> f64| (0..9).map(|k| (f64::from(k), f(f64::from(k)))).collect::<Vec<_>>();
    let [sine, root] = [f64::sin as fn(f64) -> f64, f64::sqrt]
        .map(|f| graph.curve(Curve::through("f", &table(f)).expect("increasing")));
    let mut outputs: Vec<Expr<'_>> = (0..4).map(|order| x.on_curve(sine, order)).collect();
    outputs.push((x * 0.5).on_curve(root, 0) * x.on_curve(sine, 1));
    let points: Vec<Vec<f64>> = (-4..40).map(|k| vec![0.25 * f64::from(k)]).chain([vec![f64::NAN]]).collect();
    check::<S>(&outputs, &[x], &points);
}

pub(crate) fn roots_of_equations<S: Subject>() {
    let graph = Graph::new();
    let (a, x, y) = (graph.variable("a"), graph.variable("x"), graph.variable("y"));
    let given = [(a, Interval::new(-1.0, 2.0))];
    let unknown = |variable| Unknown { variable, range: Interval::new(-4.0, 4.0) };
    let one = roots(&[x + 0.7 * x.sin() - a], &[unknown(x)], &given).expect("it rises")[0];
    let [first, second] = [x + 0.2 * y.sin() - a, y - 0.3 * x * x];
    let two = roots(&[first, second], &[unknown(x), unknown(y)], &given).expect("nearly linear");
    let outputs = [one, one.derivative(a), two[0], two[1], two[1].derivative(a).derivative(a), one * two[0]];
    let beyond = [vec![f64::NAN], vec![25.0], vec![-1e9]];
    let points: Vec<Vec<f64>> = (-5..=10).map(|k| vec![0.2 * f64::from(k)]).chain(beyond).collect();
    check::<S>(&outputs, &[a], &points);
}

/// What moves moves an end, the integrand, or both.
pub(crate) fn integrals<S: Subject>() {
    let graph = Graph::new();
    let (x, y, t) = (graph.variable("x"), graph.variable("y"), graph.variable("t"));
    let [to_x, to_y] = [(x, 1.0), (y, 2.0)].map(|(expr, most)| End { expr, range: Interval::new(-1.0, most) });
    let from = End { expr: graph.constant(0.25), range: Interval::point(0.25) };
    let within = [(y, Interval::new(-1.0, 2.0))];
    let one = integral((1.0 + t.squared()).sqrt(), t, [from, to_x], &[]).expect("smooth");
    let two = integral((y * t).sin(), t, [to_y, to_x], &within).expect("smooth");
    let outputs = [one, one.derivative(x), two, two.derivative(x), two.derivative(y), one * two.derivative(y)];
    let points: Vec<Vec<f64>> = (-5..=5).map(|k| vec![0.2 * f64::from(k), 0.5 - 0.3 * f64::from(k)]).collect();
    check::<S>(&outputs, &[x, y, t], &points.into_iter().map(|point| [point, vec![0.0]].concat()).collect::<Vec<_>>());
}

pub(crate) fn combinations<S: Subject>() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    let radius = (x.squared() + y.squared()).sqrt();
    let outputs = [
        radius,
        y.atan2(x) - (y / radius).asin(),
        (x - 2.0 * y) / (3.0 - x) + x.powi(7) - y.powi(-3),
        2.0 - (x - (y - 1.0)),
        (x.min(y) - x.max(graph.constant(0.5))).abs() * (x - y).sign(),
        x.abs().pow(y) + (x * y).tanh(),
    ];
    let points: Vec<Vec<f64>> = (0..200).map(|k| vec![-2.0 + 0.021 * k as f64, 1.7 - 0.017 * k as f64]).collect();
    check::<S>(&outputs, &[x, y], &points);
}

pub(crate) fn constants_only<S: Subject>() {
    let graph = Graph::new();
    let x = graph.variable("x");
    let outputs = [graph.constant(1.25), graph.constant(f64::NAN), graph.constant(-0.0), x * 0.0 + 3.0];
    check::<S>(&outputs, &[x], &[vec![7.0]]);
    check::<S>(&outputs, &[], &[]);
    let tape = Tape::new(&outputs, &[]).expect("constants depend on nothing");
    assert!(S::agrees(3.0, &S::evaluate(&tape, &[vec![]])[0][3]));
}

pub(crate) fn outputs_that_are_inputs<S: Subject>() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    check::<S>(&[y, x, x.sin(), y], &[x, y], &[vec![1.0, 2.0], vec![-0.0, f64::NAN]]);
}

pub(crate) fn one_output_twice<S: Subject>() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    let f = (x + y).exp();
    check::<S>(&[f, f, f.sin(), f], &[x, y], &[vec![0.25, 0.5]]);
}

pub(crate) fn outputs_used_later<S: Subject>() {
    let graph = Graph::new();
    let x = graph.variable("x");
    let mut outputs = vec![x.sin() + 0.1];
    for k in 0..40 {
        let last = outputs[k];
        outputs.push((last * outputs[k / 2]).cos() + outputs[k / 3]);
    }
    check::<S>(&outputs, &[x], &[vec![0.3], vec![-4.0]]);
    outputs.reverse();
    check::<S>(&outputs, &[x], &[vec![0.3], vec![-4.0]]);
}

pub(crate) fn no_outputs<S: Subject>() {
    let graph = Graph::new();
    let x = graph.variable("x");
    check::<S>(&[], &[x], &[vec![1.0], vec![2.0]]);
    check::<S>(&[x.sin()], &[x], &[]);
}

pub(crate) fn unused_inputs<S: Subject>() {
    let graph = Graph::new();
    let (x, y, z) = (graph.variable("x"), graph.variable("y"), graph.variable("z"));
    check::<S>(&[y.sin() * 2.0], &[x, y, z], &[vec![f64::NAN, 1.0, f64::INFINITY]]);
    // not in the order of creation
    let tape = Tape::new(&[x - y], &[z, y, x]).expect("all are inputs");
    assert!(S::agrees(2.0, &S::evaluate(&tape, &[vec![9.0, 1.0, 3.0]])[0][0]));
}

pub(crate) fn unbound_variable<S: Subject>() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("roll angle"));
    let error = Tape::new(&[x + y.sin()], &[x]).expect_err("y is not an input");
    assert_eq!(error, TapeError::UnboundVariable("roll angle".to_string()));
    assert!(error.to_string().contains("`roll angle`"));
    // a variable that cancels is not needed
    check::<S>(&[x + y - y], &[x, y], &[vec![1.0, 2.0]]);
    assert!(Tape::new(&[x + y - y], &[x]).is_ok());
}

pub(crate) fn random_programs<S: Subject>() {
    let mut random = Random(1);
    for round in 0..60 {
        let program = Program::wild(&mut random, 4, 50 + 10 * round);
        let points: Vec<Vec<f64>> = (0..4).map(|_| (0..4).map(|_| random.between(-2.0, 2.0)).collect()).collect();
        check_program::<S>(&program, &mut random, &points);
    }
}

pub(crate) fn random_tame_programs<S: Subject>() {
    let mut random = Random(2);
    for _ in 0..40 {
        let program = Program::tame(&mut random, 3, 400);
        check_program::<S>(&program, &mut random, &[reference_point(3)]);
    }
}

/// A few outputs (registers are free early), then all (none is ever free).
fn check_program<S: Subject>(program: &Program, random: &mut Random, points: &[Vec<f64>]) {
    let graph = Graph::new();
    let variables: Vec<Expr<'_>> = (0..program.variables).map(|k| graph.variable(format!("x{k}"))).collect();
    let built = program.build(&variables, &graph);
    let few: Vec<Expr<'_>> = (0..3).map(|_| random.pick(&built)).chain(built.last().copied()).collect();
    check::<S>(&few, &variables, points);
    check::<S>(&built, &variables, points);
}

pub(crate) fn many_points<S: Subject>() {
    // more than any number of lanes, and not a multiple of it
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    let points: Vec<Vec<f64>> = (0..1003).map(|k| vec![0.01 * k as f64, 5.0 - 0.007 * k as f64]).collect();
    check::<S>(&[x.sin() * y, x / y, x], &[x, y], &points);
}
