//! Emitted functions, compiled by the compilers of their languages, against the interpreter.

use flank_expr::{
    Binary, Curve, CurveId, End, Expr, Graph, Interval, Language, Polynomial, Signature, Unary, Unknown, emit_function,
    emit_polynomials, integral, roots,
};
use flank_tests::compiled::values_at;
use flank_tests::{Dice, job};

const LANGUAGES: [Language; 3] = [Language::C, Language::Rust, Language::JavaScript];
const POINTS: usize = 10_000;
/// Relative to the number, absolute below 1.
const TOLERANCE: f64 = 1e-12;

/// Lines of comments that compilers refuse, or that are no comments: ends and beginnings, ends of lines, a trigraph, letters that turn the
/// direction of reading, a byte order mark.
const NASTY: [&str; 6] = [
    "ends */ here, /* begins, */* and /*/ both, and breaks\na line\\",
    "spec of Räder/\u{202e}niahc.\u{2066}gear\u{2069}\u{200f}\u{61c}",
    "what ??/",
    "\u{feff}\u{2028}int main(void);\u{2029}\u{85}\r\n#error",
    "*\\",
    "/",
];

fn between(dice: &mut Dice, low: f64, high: f64) -> f64 {
    low + (high - low) * dice.roll(1 << 30) as f64 / f64::from(1 << 30)
}

fn points<const N: usize>(dice: &mut Dice, low: f64, high: f64) -> Vec<[f64; N]> {
    (0..POINTS).map(|_| std::array::from_fn(|_| between(dice, low, high))).collect()
}

fn agrees(expected: f64, found: f64) -> bool {
    let off = (expected - found).abs();
    expected == found || (expected.is_nan() && found.is_nan()) || off <= TOLERANCE * expected.abs().max(1.0)
}

/// Compiles the outputs in all languages and holds values and derivatives against the interpreter.
fn check<const N: usize>(arguments: &[Expr<'_>; N], outputs: &[Expr<'_>], points: &[[f64; N]]) {
    let graph = arguments[0].graph();
    let titles: Vec<String> = (0..outputs.len()).map(|k| format!("f{k}")).collect();
    let named: Vec<(&str, Expr<'_>)> = titles.iter().map(String::as_str).zip(outputs.iter().copied()).collect();
    let slopes = outputs.iter().flat_map(|f| arguments.iter().map(|x| f.derivative(*x)));
    let all: Vec<Expr<'_>> = outputs.iter().copied().chain(slopes).collect();
    let interpreted = |point: &[f64; N]| {
        let mut values = vec![f64::NAN; graph.variable_count()];
        for (argument, value) in arguments.iter().zip(point) {
            values[argument.as_variable().expect("a variable").index()] = *value;
        }
        graph.evaluate(&all, &values)
    };
    let expected: Vec<Vec<f64>> = points.iter().map(interpreted).collect();
    let comment = NASTY.map(str::to_string);
    for language in LANGUAGES {
        let signature = Signature { name: "under test", comment: &comment };
        let text = emit_function(language, signature, arguments, &named).expect("all are arguments");
        let Some(found) = values_at(language, ("under_test", &text), outputs.len(), points) else {
            eprintln!("skipped 1 of 3 languages: nothing here compiles or runs {language:?}");
            continue;
        };
        for ((point, expected), found) in points.iter().zip(&expected).zip(found) {
            for (k, (expected, found)) in expected.iter().zip(found).enumerate() {
                assert!(agrees(*expected, found), "{language:?}, {k} at {point:?}: {found:e}, not {expected:e}");
            }
        }
    }
}

/// An operation on a number in [−1, 1], well inside its domain.
fn unary_of<'g>(op: Unary, a: Expr<'g>) -> Expr<'g> {
    match op {
        Unary::Asin | Unary::Acos | Unary::Atanh | Unary::Tan => (0.9 * a).unary(op),
        Unary::Sqrt | Unary::Ln | Unary::Arcinv => (a + 1.5).unary(op),
        Unary::Acosh => (a + 2.5).unary(op),
        _ => a.unary(op),
    }
}

fn binary_of<'g>(op: Binary, a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
    match op {
        Binary::Div => a / (b + 2.0),
        Binary::Pow => (a + 2.0).pow(b),
        Binary::Atan2 => (a * 3.0).atan2(b - 1.5),
        _ => a.binary(op, b),
    }
}

fn wavy_curve(graph: &Graph) -> CurveId {
    let knots: Vec<(f64, f64)> = (-8i32..=8).map(|k| f64::from(k) / 7.5).map(|x| (x, (3.0 * x).sin() + x)).collect();
    graph.curve(Curve::through("wave", &knots).expect("x increases"))
}

/// The root of x + sin(x) / 2 = a.
fn root_at(a: Expr<'_>) -> Expr<'_> {
    let graph = a.graph();
    let [unknown, given] = ["unknown", "given"].map(|name| graph.variable(name));
    let equation = unknown + unknown.sin() / 2.0 - given;
    let unknown = Unknown { variable: unknown, range: Interval::new(-2.0, 2.0) };
    let root = roots(&[equation], &[unknown], &[(given, Interval::new(-1.0, 1.0))]).expect("it rises")[0];
    graph.substitute(&[root], &[(given, a)])[0]
}

/// Length of the parabola t² from 0 to a.
fn length_to(a: Expr<'_>) -> Expr<'_> {
    let graph = a.graph();
    let [own, to] = ["own", "to"].map(|name| graph.variable(name));
    let ends =
        [(graph.constant(0.0), 0.0), (to, 1.0)].map(|(expr, reach)| End { expr, range: Interval::new(-reach, reach) });
    let length = integral((1.0 + 4.0 * own * own).sqrt(), own, ends, &[]).expect("it is smooth");
    graph.substitute(&[length], &[(to, a)])[0]
}

/// Unknowns of two equations, x + sin(y) / 5 = a and y − 3/10 x² = 0.
fn linkage_at(a: Expr<'_>) -> Expr<'_> {
    let graph = a.graph();
    let [x, y, given] = ["first", "second", "given"].map(|name| graph.variable(name));
    let unknowns = [x, y].map(|variable| Unknown { variable, range: Interval::new(-4.0, 4.0) });
    let residuals = [x + 0.2 * y.sin() - given, y - 0.3 * x * x];
    let found = roots(&residuals, &unknowns, &[(given, Interval::new(-1.0, 1.0))]).expect("nearly linear");
    graph.substitute(&[found[0] + found[1]], &[(given, a)])[0]
}

/// Each operation alone, then combinations of combinations; the sine brings each back to [−1, 1], so that rounding stays
/// rounding: no slope is beyond 10, and three of them lie behind each other.
#[test]
fn random_expressions_meet_the_interpreter() {
    let graph = Graph::new();
    let arguments = ["x", "values", "sin"].map(|name| graph.variable(name));
    let curve = wavy_curve(&graph);
    let mut dice = Dice(7);
    let mut layer = arguments.to_vec();
    let mut outputs = vec![graph.constant(0.1), arguments[0]];
    for _ in 0..3 {
        let mut pick = || layer[dice.roll(layer.len())];
        let mut made: Vec<Expr<'_>> = Unary::ALL.map(|op| unary_of(op, pick())).to_vec();
        made.extend(Binary::ALL.map(|op| binary_of(op, pick(), pick())));
        made.extend((0..4).map(|order| pick().on_curve(curve, order)));
        made.extend([root_at(pick()), linkage_at(pick()), length_to(pick())]);
        layer = made.iter().map(|part| part.sin()).collect();
        outputs.extend(made);
    }
    check(&arguments, &outputs, &points(&mut dice, -1.0, 1.0));
}

/// The ends of domains, infinities and what is not a number.
#[test]
fn special_arguments_meet_the_interpreter() {
    let graph = Graph::new();
    let [x, y] = ["x", "y"].map(|name| graph.variable(name));
    let mut outputs: Vec<Expr<'_>> = Unary::ALL.map(|op| x.unary(op)).to_vec();
    outputs.extend(Binary::ALL.map(|op| x.binary(op, y)));
    outputs.push(x.on_curve(wavy_curve(&graph), 0));
    outputs.extend([f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.1, 5e-324].map(|c| graph.constant(c)));
    let positive = [0.0, 1e-300, 1e-9, 0.1, 0.2, 1.0, 1.5, 100.0, 1e17, f64::INFINITY, f64::NAN];
    let numbers: Vec<f64> = positive.into_iter().flat_map(|x| [x, -x]).collect();
    let pairs: Vec<[f64; 2]> = numbers.iter().flat_map(|x| numbers.iter().map(|y| [*x, *y])).collect();
    check(&[x, y], &outputs, &pairs);
}

/// Words of the languages and what their headers define, as names of arguments.
#[test]
fn reserved_words_may_be_names() {
    const WORDS: [&str; 16] = [
        "as",
        "Self",
        "self",
        "None",
        "Some",
        "Ok",
        "Err",
        "gen",
        "NAN",
        "INFINITY",
        "HUGE_VAL",
        "FP_ZERO",
        "M_PI",
        "sinf",
        "static_assert",
        "under_test_min",
    ];
    let graph = Graph::new();
    let arguments = WORDS.map(|word| graph.variable(word));
    let sum = arguments.iter().fold(graph.constant(f64::INFINITY), |sum, x| sum.min(x.sin()));
    check(&arguments, &[sum], &points(&mut Dice(5), -1.0, 1.0)[..100]);
}

/// The pose of a tilted cutter in its gear blank, as the cradle turns.
#[test]
fn a_machine_meets_the_interpreter() {
    let graph = Graph::new();
    let job = job(&graph, "specs/bevel/tilted_pinion.chain", &[]);
    let generation = &job.surfaces[0].generation;
    let (motion, range) = (generation.motions[0], &job.motions[0]);
    let rows = generation.driven.pose().matrix4();
    let pose = graph.substitute(&rows[..3].concat(), &job.bindings());
    check(&[motion], &pose, &points(&mut Dice(3), range.low, range.high));
}

/// Against sums of powers.
#[test]
fn polynomials_meet_their_sums() {
    const REFERENCE: f64 = -0.3;
    let mut dice = Dice(11);
    let coefficients: Vec<Vec<f64>> =
        [13, 9, 1, 0, 5].map(|count| (0..count).map(|_| between(&mut dice, -2.0, 2.0)).collect()).to_vec();
    let polynomials: Vec<Polynomial<'_>> =
        coefficients.iter().map(|coefficients| Polynomial { name: "axis", coefficients }).collect();
    let at: Vec<[f64; 1]> = points(&mut dice, -1.2, 0.6);
    for language in LANGUAGES {
        let signature = Signature { name: "axes", comment: &[] };
        let text = emit_polynomials(language, signature, ("output", REFERENCE), &polynomials);
        let Some(found) = values_at(language, ("axes", &text), polynomials.len(), &at) else {
            eprintln!("skipped 1 of 3 languages: nothing here compiles or runs {language:?}");
            continue;
        };
        for (point, found) in at.iter().zip(found) {
            let distance = point[0] - REFERENCE;
            for (k, c) in coefficients.iter().enumerate() {
                let value: f64 = (0..).zip(c).map(|(power, c)| c * distance.powi(power)).sum();
                let slope: f64 =
                    (0..).zip(c).skip(1).map(|(power, c)| f64::from(power) * c * distance.powi(power - 1)).sum();
                assert!(agrees(value, found[k]), "{language:?}: {} instead of {value}", found[k]);
                assert!(agrees(slope, found[coefficients.len() + k]), "{language:?}: slope {slope}");
            }
        }
    }
}

#[test]
fn what_is_no_argument_is_named() {
    let graph = Graph::new();
    let [x, speed] = ["x", "speed"].map(|name| graph.variable(name));
    let signature = Signature { name: "f", comment: &[] };
    let refused = emit_function(Language::C, signature, &[x], &[("y", x * speed)]).expect_err("speed has no value");
    assert!(refused.to_string().contains("`speed`"), "{refused}");
}
