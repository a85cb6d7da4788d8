//! Each form of formulas that the language has, computed in each way: numbers against closed forms, derivatives against differences,
//! intervals and series against numbers, emitted functions against the interpreter.

use flank_expr::{
    Expr, Graph, Interval, IntervalEvaluator, Language, ScalarEvaluator, Signature, Tape, TaylorEvaluator,
    emit_function,
};
use flank_tests::compiled::values_at;
use flank_tests::job_named;

const SPEC: &str = "tests/surfaces/specs/forms.chain";
const LANGUAGES: [Language; 3] = [Language::C, Language::Rust, Language::JavaScript];
/// Of the turn, rad; none at a knot of the table.
const PLACES: [f64; 6] = [-0.61, -0.35, -0.013, 0.11, 0.42, 0.66];
/// The other inputs: where the equation's parameters are.
const POINT: [f64; 3] = [27.0, 0.3, -2.0];
/// A step that leaves the fifth power of it, some 1e-13, of a difference over four places.
const STEP: f64 = 2e-3;

/// The forms, each with what it is in closed form over the turn if it has one. Inputs: the turn, then the equation's parameters.
fn forms(graph: &Graph) -> (Vec<(&'static str, Expr<'_>)>, [Expr<'_>; 4]) {
    let job = job_named(graph, SPEC, "all", &[]);
    let law = |name: &str| {
        let axis = job.machines[0].axes.iter().find(|axis| axis.name == name).expect("an axis");
        graph.substitute(&[axis.law], &job.bindings())[0]
    };
    let names = ["sum", "derivative", "integral", "root", "table", "crank", "slide"];
    let surface = &job.surfaces[0];
    assert_eq!((surface.surface.given, surface.surface.constraints.len()), (1, 2));
    let equation = graph.substitute(&[surface.surface.constraints[0]], &job.bindings())[0];
    let meshing = graph.substitute(&[surface.surface.constraints[1]], &job.bindings())[0];
    let mut forms: Vec<(&str, Expr<'_>)> = names.into_iter().map(|name| (name, law(name))).collect();
    forms.extend([("equation", equation), ("meshing", meshing)]);
    let [r, a, w] = [0, 1, 2].map(|k| surface.surface.unknowns[k]);
    (forms, [job.motions[0].variable, r, a, w])
}

/// Of the forms over a turn alone.
fn closed_form(name: &str, turn: f64) -> Option<f64> {
    Some(match name {
        "sum" => (1..=5).map(|k| 3.0 * (f64::from(k) * turn).sin() / f64::from(k * k)).sum(),
        "derivative" => 9.0 * turn.sin().powi(2) * turn.cos(),
        "crank" => (1.5 * (turn / 2.0).sin()).acos(),
        "slide" => 40.0 * (1.0 - (1.5 * (turn / 2.0).sin()).powi(2)).sqrt(),
        "equation" => ((POINT[0] - 25.0).powi(2) + POINT[2].powi(2) - 25.0) / (2.0 * (POINT[0] - 25.0).hypot(POINT[2])),
        _ => return None,
    })
}

fn point(turn: f64) -> [f64; 4] {
    [turn, POINT[0], POINT[1], POINT[2]]
}

#[test]
fn numbers_and_derivatives_are_those_of_closed_forms_and_differences() {
    let graph = Graph::new();
    let (forms, inputs) = forms(&graph);
    for (name, form) in forms {
        let slope = form.derivative(inputs[0]);
        let tape = Tape::new(&[form, slope, slope.derivative(inputs[0])], &inputs).expect("all given");
        let mut evaluator = ScalarEvaluator::new(&tape);
        let mut at = |turn: f64| {
            let mut out = [0.0; 3];
            evaluator.run(&point(turn), &mut out);
            out
        };
        for turn in PLACES {
            let here = at(turn);
            if let Some(exact) = closed_form(name, turn) {
                assert!(
                    (here[0] - exact).abs() < 1e-13 * exact.abs().max(1.0),
                    "{name} at {turn}: {here:?}, not {exact}"
                );
            }
            let around = [-2.0, -1.0, 1.0, 2.0].map(|steps| at(turn + steps * STEP));
            for order in 0..2 {
                let [far, near, on, farther] = around.map(|out| out[order]);
                let difference = (8.0 * (on - near) - (farther - far)) / (12.0 * STEP);
                // a spline's third derivative jumps from piece to piece
                let off = if name == "table" { 1e-5 } else { 2e-8 };
                let found = here[order + 1];
                assert!(
                    (found - difference).abs() < off * found.abs().max(1.0),
                    "{name}, {order}, at {turn}: {found}, {difference}"
                );
            }
        }
    }
}

#[test]
fn intervals_hold_the_numbers_and_shrink_with_the_range() {
    let graph = Graph::new();
    let (forms, inputs) = forms(&graph);
    for (name, form) in forms {
        let tape = Tape::new(&[form, form.derivative(inputs[0])], &inputs).expect("all given");
        let (mut numbers, mut intervals) = (ScalarEvaluator::new(&tape), IntervalEvaluator::new(&tape));
        for turn in PLACES {
            for width in [1e-2, 1e-4] {
                let mut boxed = point(turn).map(Interval::point);
                boxed[0] = Interval::new(turn, turn + width);
                let mut over = [Interval::WHOLE; 2];
                intervals.run(&boxed, &mut over);
                for share in [0.0, 0.3, 1.0] {
                    let mut out = [0.0; 2];
                    numbers.run(&point(turn + share * width), &mut out);
                    for (number, over) in out.iter().zip(&over) {
                        assert!(over.contains(*number) && over.continuous, "{name} at {turn}: {number} in {over:?}");
                    }
                }
                // no slope of a form is above some 100 mm per radian; what depends on one thing several times is wider, most of all a
                // table, a sum over all of its points
                let most = if name == "table" { 3e3 } else { 1e3 };
                assert!(over[0].width() < most * width, "{name} at {turn}: {:?}", over[0]);
            }
        }
    }
}

#[test]
fn series_are_those_of_the_derivatives() {
    const ORDER: usize = 4;
    let graph = Graph::new();
    let (forms, inputs) = forms(&graph);
    for (name, form) in forms {
        let slopes: Vec<Expr<'_>> =
            std::iter::successors(Some(form), |f| Some(f.derivative(inputs[0]))).take(ORDER + 1).collect();
        let tape = Tape::new(&[form], &inputs).expect("all given");
        let exact = Tape::new(&slopes, &inputs).expect("all given");
        let (mut series, mut numbers) = (TaylorEvaluator::new(&tape, ORDER), ScalarEvaluator::new(&exact));
        for turn in PLACES {
            let mut along = vec![0.0; 4 * (ORDER + 1)];
            for (k, value) in point(turn).into_iter().enumerate() {
                along[k * (ORDER + 1)] = value;
            }
            along[1] = 1.0;
            let (mut terms, mut derivatives) = ([0.0; ORDER + 1], [0.0; ORDER + 1]);
            series.run(&along, &mut terms);
            numbers.run(&point(turn), &mut derivatives);
            let mut factorial = 1.0;
            let scale = derivatives.iter().fold(1.0, |scale: f64, x| scale.max(x.abs()));
            for order in 0..=ORDER {
                factorial *= order.max(1) as f64;
                let exact = derivatives[order] / factorial;
                // what two steps of Newton's method leave of a root grows with each derivative
                let off = (terms[order] - exact).abs();
                assert!(off < 1e-10 * scale, "{name}, order {order}, at {turn}: {}, not {exact}", terms[order]);
            }
        }
    }
}

#[test]
fn emitted_functions_meet_the_interpreter() {
    let graph = Graph::new();
    let (forms, inputs) = forms(&graph);
    let points: Vec<[f64; 4]> = PLACES.map(point).to_vec();
    let slopes = forms.iter().flat_map(|(_, form)| inputs.map(|input| form.derivative(input)));
    let all: Vec<Expr<'_>> = forms.iter().map(|(_, form)| *form).chain(slopes).collect();
    let tape = Tape::new(&all, &inputs).expect("all given");
    for language in LANGUAGES {
        let signature = Signature { name: "under test", comment: &[] };
        let text = emit_function(language, signature, &inputs, &forms).expect("all are arguments");
        let Some(found) = values_at(language, ("under_test", &text), forms.len(), &points) else {
            eprintln!("skipped 1 of 3 languages: nothing here compiles or runs {language:?}");
            continue;
        };
        for (point, found) in points.iter().zip(found) {
            let mut expected = vec![0.0; all.len()];
            ScalarEvaluator::new(&tape).run(point, &mut expected);
            for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
                let off = (found - expected).abs();
                assert!(
                    off <= 1e-11 * expected.abs().max(1.0),
                    "{language:?}, {k} at {point:?}: {found}, not {expected}"
                );
            }
        }
    }
}
