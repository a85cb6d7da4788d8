//! Formulas that texts make: sums, derivatives, integrals, roots, functions of vectors.

use flank_expr::Graph;

use crate::findings;
use crate::models::{compiled, laws};

#[test]
fn a_zero_with_a_unit_is_a_coefficient_like_others() {
    for first in ["0 mm", "1 mm", "0"] {
        let text = format!(
            "job j {{
                machine m = lathe(height: 4 mm)
                tool b = ball
                mount b on m.slide
                motion turn : angle in 0 deg .. 90 deg
                drive m.C = taylor(turn, [0 deg, 1 rad/rad])
                drive m.Z = taylor(turn, [{first}, 2 mm, 3 mm])
                surface s in m.work = envelope(b.face, over: turn)
            }}"
        );
        assert_eq!(laws(&text)[1], "C = turn");
    }
}

#[test]
fn functions_take_and_give_vectors() {
    let text = "
        fn turned(p: length[3], a: angle) -> length[3] =
            [p[0] * cos(a) - p[1] * sin(a), p[0] * sin(a) + p[1] * cos(a), p[2]]
        fn first(p: length[3]) -> length = p[0]
        job j {
            machine m = lathe(height: 4 mm)
            tool b = ball
            mount b on m.slide
            motion turn : angle in 0 deg .. 90 deg
            drive m.C = turn
            drive m.Z = first(turned([1 mm, 0 mm, 2 mm], turn))
            surface s in m.work = envelope(b.face, over: turn)
        }";
    assert_eq!(laws(text)[0], "Z = cos(turn)");
}

/// The exponent of a number is a parameter like others: what is made of it depends on it, also where it happens to be whole.
#[test]
fn a_parameter_may_be_an_exponent() {
    let text = "
        tool bowed {
            param bow : number = 2
            surface face(u: number in 0.5 .. 1.5, v: length in 0 mm .. 1 mm) {
                at = [20 mm + 1 mm * u^bow, 1 mm * u, v]
                body towards [1, 0, 0]
            }
        }
        job j {
            machine m = lathe(height: 0 mm)
            tool b = bowed
            mount b on m.slide
            motion turn : angle in 0 deg .. 90 deg
            drive m.C = turn
            drive m.Z = 0 mm
            surface s in m.work = envelope(b.face, over: turn)
        }";
    let graph = Graph::new();
    let compilation = compiled(&graph, text);
    let job = &compilation.jobs[0];
    let bow = job.parameters.iter().find(|parameter| parameter.name == "b.bow").expect("a parameter").variable;
    let surface = &job.surfaces[0];
    let x = surface.generation.position().0[0];
    let mut values = vec![f64::NAN; graph.variable_count()];
    for (variable, value) in [(bow, 2.0), (surface.unknowns[0].variable, 1.25)] {
        values[variable.as_variable().expect("a variable").index()] = value;
    }
    let found = graph.evaluate(&[x, x.derivative(bow)], &values);
    let expected = [20.0 + 1.25 * 1.25, 1.25 * 1.25 * 1.25f64.ln()];
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?} {expected:?}");
}

/// The law of the work's axis, driven by a value that a text works out from `turn`.
fn law(functions: &str, value: &str) -> String {
    laws(&format!(
        "{functions}
        job j {{
            param n : count = 3
            machine m = lathe(height: 4 mm)
            tool b = ball
            mount b on m.slide
            motion turn : angle in 0 deg .. 90 deg
            drive m.C = turn
            drive m.Z = {value}
            surface s in m.work = envelope(b.face, over: turn)
        }}"
    ))
    .swap_remove(0)
}

#[test]
fn a_sum_is_what_its_terms_are_written_out() {
    let written = law("", "1 mm * (sin(1 * turn) / 1 + sin(2 * turn) / 2 + sin(3 * turn) / 3)");
    assert_eq!(law("", "1 mm * sum(k in 1 .. n: sin(k * turn) / k)"), written);
    let listed = law("", "5 mm / rad * turn + 7 mm / rad^2 * turn^2");
    assert_eq!(law("", "sum(k in 1 .. 2: [5 mm / rad, 7 mm / rad^2][k - 1] * turn^k)"), listed);
    assert_eq!(law("", "sum(k in -1 .. 1: k * 1 mm) + turn * 1 mm"), "Z = turn");
    assert_eq!(law("", "sum(k in 1 .. n - 3: k * 1 mm) + turn * 1 mm"), "Z = turn");
    assert_eq!(
        law("", "sum(k in 1 .. 2: k * [1 mm, turn * 1 mm])[1]"),
        law("", "1 * (turn * 1 mm) + 2 * (turn * 1 mm)")
    );
    assert_eq!(
        law("", "sum(k in 1 .. 2: sum(l in 1 .. k: l * turn * 1 mm))"),
        law("", "1 mm * turn + (1 mm * turn + 2 * turn * 1 mm)")
    );
}

#[test]
fn a_derivative_is_that_of_the_formula() {
    assert_eq!(law("", "derivative(2 mm * sin(turn), turn)"), law("", "2 mm * cos(turn)"));
    assert_eq!(law("", "derivative([0 mm, 3 mm/rad^2 * turn^2], turn)[1] * turn"), law("", "6 mm/rad^2 * turn * turn"));
    let slope = "fn f(x: angle) = 2 mm * sin(x)
        fn slope(x: angle) { let y = f(x) derivative(y, x) }";
    assert_eq!(law(slope, "slope(2 * turn)"), law("", "2 mm * cos(2 * turn)"));
    // by each argument alone, though both are one variable
    let partial = "fn partial(x: angle, y: angle) = derivative(sin(x) * y, x) * 1 mm";
    assert_eq!(law(partial, "partial(turn, turn)"), law("", "cos(turn) * turn * 1 mm"));
    // of a value that stands still, conditions on it decided
    let still = "fn step(x: number) = if x > 1 then derivative(x^3, x) else 0 * x";
    assert_eq!(law(still, "step(n) * turn * 1 mm"), law("", "3 * n^2 * turn * 1 mm"));
    let second = "fn second(x: angle) = derivative(derivative(x^3, x), x)";
    assert_eq!(law(second, "second(turn) * 1 mm"), law("", "6 * turn * 1 mm"));
}

/// The value of the work's axis at an angle.
fn law_at(functions: &str, value: &str, turn: f64) -> f64 {
    let graph = Graph::new();
    let text = format!(
        "{functions}
        job j {{
            param n : number = 3
            machine m = lathe(height: 4 mm)
            tool b = ball
            mount b on m.slide
            motion turn : angle in -90 deg .. 90 deg
            drive m.C = turn
            drive m.Z = {value}
            surface s in m.work = envelope(b.face, over: turn)
        }}"
    );
    let compilation = compiled(&graph, &text);
    let job = &compilation.jobs[0];
    let axis = job.machines[0].axes.iter().find(|axis| axis.name == "Z").expect("the axis");
    let mut values = vec![0.0; graph.variable_count()];
    for parameter in &job.parameters {
        values[parameter.variable.as_variable().expect("a variable").index()] = parameter.value;
    }
    values[job.motions[0].variable.as_variable().expect("a variable").index()] = turn;
    graph.evaluate(&[axis.law], &values)[0]
}

#[test]
fn an_integral_is_good_to_rounding() {
    for turn in [-1.5_f64, -0.3, 0.0, 0.7, 1.5] {
        let near = |value: &str, exact: f64| {
            let found = law_at("", value, turn);
            assert!((found - exact).abs() <= 4e-15 * exact.abs().max(1.0), "{value} at {turn}: {found}, not {exact}");
        };
        near("integral(t in 0 deg .. turn: cos(t)) * 1 mm", turn.sin());
        near("integral(t in turn .. 3 * turn: t^2) * 1 mm", 26.0 / 3.0 * turn.powi(3));
        near("integral(t in 0 deg .. turn: n * exp(t)) * 1 mm", 3.0 * (turn.exp() - 1.0));
        // an integrand that moves by more than what is integrated over
        near("integral(x in 0 .. 1: cos(x * turn) * turn) * 1 mm", turn.sin());
        near("integral(t in 0 deg .. turn: integral(u in 0 deg .. t: cos(u))) * 1 mm", 1.0 - turn.cos());
        near("integral(t in 0 deg .. turn: [1, cos(t)])[1] * 1 mm", turn.sin());
        // by Leibniz's rule the slope is the integrand
        near("derivative(integral(t in 0 deg .. turn: exp(t)), turn) * 1 mm", turn.exp());
        near("derivative(integral(t in -turn .. turn: cos(turn * t)), turn) * 1 mm", {
            let f = |x: f64| if x == 0.0 { 0.0 } else { 2.0 * (x * x).sin() / x };
            if turn == 0.0 { 2.0 } else { 4.0 * (turn * turn).cos() - f(turn) / turn }
        });
    }
}

#[test]
fn a_root_is_what_its_equation_gives() {
    for turn in [-1.5_f64, -0.3, 0.0, 0.7, 1.5] {
        let near = |value: &str, exact: f64| {
            let found = law_at("", value, turn);
            assert!((found - exact).abs() <= 4e-15 * exact.abs().max(1.0), "{value} at {turn}: {found}, not {exact}");
        };
        near("root(x in -2 .. 2: sinh(x) - turn) * 1 mm", turn.asinh());
        near("root(x in -10 mm .. 10 mm: n * x - 1 mm * turn^3)", turn.powi(3) / 3.0);
        near("root(x in 0 .. 1.5: x^2 - root(y in 0.1 .. 2: ln(y) - cos(turn) / 4)) * 1 mm", (turn.cos() / 8.0).exp());
        near("derivative(root(x in -2 .. 2: sinh(x) - turn), turn) * 1 mm", 1.0 / (1.0 + turn * turn).sqrt());
        near("integral(t in 0 deg .. turn: root(x in -5 .. 5: x - 2 * t)) * 1 mm", turn * turn);
    }
}

/// What is a product of two angles by its own right: numbers, polynomials in an angle, angles per angle, products that are divided.
#[test]
fn products_of_angles_are_warned_of_only_where_they_are_slips() {
    for formula in [
        "turn - 0.5 * turn^2 + turn * turn * turn / 6",
        "tilt * sin(turn) + turn",
        "tilt * turn / 1 rad",
        "turn + tilt / 1 rad * turn",
        "turn / 1 rad * 1 deg",
        "turn * 3 deg/rad",
        "(cos(turn) * tilt^2 + tilt * turn) / 1 rad",
        "asin(tilt * turn + 0.1 * cos(turn))",
        "taylor(turn, [0 deg, 1, -0.2])",
        "sqrt(tilt * turn)",
    ] {
        let text = format!(
            "job j {{
                param tilt : angle = 3 deg
                machine m = lathe(height: 3 mm)
                tool b = ball
                mount b on m.slide
                motion turn : angle in 1 deg .. 30 deg
                drive m.C = {formula} + 0 * tilt
                drive m.Z = 1 mm/rad * turn
                surface s in m.work = envelope(b.face, over: turn)
            }}"
        );
        assert_eq!(findings(&text), [], "{formula}");
    }
}
