//! Expressions as text and as LaTeX: tables, and text that is read back.

#[path = "printing/parser.rs"]
mod parser;
mod support;

use flank_expr::{Expr, Graph, Listing, Style};
use support::{Program, Random, reference_point};

/// Holds expressions of x, y, z against what they must look like in both styles.
fn check<const N: usize>(
    cases: impl for<'g> Fn([Expr<'g>; 3], &'g Graph) -> [(Expr<'g>, &'static str, &'static str); N],
) {
    let graph = Graph::new();
    let letters = ["x", "y", "z"].map(|name| graph.variable(name));
    for (index, (expr, text, latex)) in cases(letters, &graph).into_iter().enumerate() {
        assert_eq!(expr.to_string(), text, "case {index}");
        assert_eq!(graph.listing(&[expr], Style::Text, "t").values, [text], "case {index}");
        assert_eq!(graph.listing(&[expr], Style::Latex, "t").values, [latex], "case {index}");
    }
}

#[test]
fn sums_and_differences() {
    check(|[x, y, z], _| {
        [
            (x - (y - z), "x - (y - z)", "x - \\left(y - z\\right)"),
            (x - (y + z), "x - (y + z)", "x - \\left(y + z\\right)"),
            ((x - y) - z, "x - y - z", "x - y - z"),
            (x + (y - z), "x + y - z", "x + y - z"),
            (-(x + y), "-(x + y)", "-\\left(x + y\\right)"),
            (x + -2.5 * y, "x - 2.5 * y", "x - 2.5\\,y"),
            (x - -2.5 * y, "x + 2.5 * y", "x + 2.5\\,y"),
            (-2.5 * y - x, "-(x + 2.5 * y)", "-\\left(x + 2.5\\,y\\right)"),
            (z + (-2.5 * y - x), "z - (x + 2.5 * y)", "z - \\left(x + 2.5\\,y\\right)"),
            (z - (-2.5 * y - x), "z + x + 2.5 * y", "z + x + 2.5\\,y"),
            (x + 3.0, "x + 3", "x + 3"),
            (x - 3.0, "x - 3", "x - 3"),
            (3.0 - x, "3 - x", "3 - x"),
            (x + 3.0 - y, "x + 3 - y", "x + 3 - y"),
            (-3.0 - x * y, "-3 - x * y", "-3 - x\\,y"),
            (x - (-2.0 * y) / z, "x + 2 * y / z", "x + \\frac{2\\,y}{z}"),
        ]
    });
}

#[test]
fn products_and_quotients() {
    check(|[x, y, z], graph| {
        let two = graph.constant(2.0);
        [
            (x / (y * z), "x / (y * z)", "\\frac{x}{y\\,z}"),
            ((x / y) / z, "x / y / z", "\\frac{\\frac{x}{y}}{z}"),
            (x / (y / z), "x / (y / z)", "\\frac{x}{\\frac{y}{z}}"),
            ((x + y) * z, "z * (x + y)", "z\\,\\left(x + y\\right)"),
            ((x + y) / z, "(x + y) / z", "\\frac{x + y}{z}"),
            (x / (y - z), "x / (y - z)", "\\frac{x}{y - z}"),
            ((x * y) / z, "x * y / z", "\\frac{x\\,y}{z}"),
            (x * (y / z), "x * y / z", "x\\,\\frac{y}{z}"),
            ((-2.0 * x) / y, "-2 * x / y", "-\\frac{2\\,x}{y}"),
            (-(x / y), "-x / y", "-\\frac{x}{y}"),
            (-2.0 / x, "-2 / x", "-\\frac{2}{x}"),
            (-(x * y), "-x * y", "-x\\,y"),
            (2.0 * two.pow(x), "2 * 2^x", "2 \\cdot 2^{x}"),
            (x / -3.0, "x / (-3)", "\\frac{x}{-3}"),
            ((x / -3.0) * y, "y * x / (-3)", "y\\,\\frac{x}{-3}"),
            (1.0 / (x * y).sin(), "1 / sin(x * y)", "\\frac{1}{\\sin\\left(x\\,y\\right)}"),
        ]
    });
}

#[test]
fn powers() {
    check(|[x, y, z], graph| {
        let c = |value| graph.constant(value);
        [
            (x.squared(), "x^2", "x^{2}"),
            ((-x).squared(), "x^2", "x^{2}"),
            ((x - y).squared(), "(x - y)^2", "\\left(x - y\\right)^{2}"),
            ((x / y).squared(), "(x / y)^2", "\\left(\\frac{x}{y}\\right)^{2}"),
            (x.powi(4), "(x^2)^2", "\\left(x^{2}\\right)^{2}"),
            (-x.squared(), "-x^2", "-x^{2}"),
            (x.pow(-y), "x^(-y)", "x^{-y}"),
            (x.pow(y + z), "x^(y + z)", "x^{y + z}"),
            (x.pow(y).pow(z), "(x^y)^z", "\\left(x^{y}\\right)^{z}"),
            (x.pow(y.pow(z)), "x^(y^z)", "x^{y^{z}}"),
            (c(-2.0).pow(x), "(-2)^x", "\\left(-2\\right)^{x}"),
            (x.pow(c(-0.5)), "x^(-0.5)", "x^{-0.5}"),
            ((-x).pow(c(1.5)), "(-x)^1.5", "\\left(-x\\right)^{1.5}"),
            (x.sin().squared(), "sin(x)^2", "\\sin^{2}\\left(x\\right)"),
            (x.sqrt().pow(y), "sqrt(x)^y", "\\sqrt{x}^{y}"),
            (x.abs().squared(), "abs(x)^2", "\\left|x\\right|^{2}"),
            (1.0 / x.squared(), "1 / x^2", "\\frac{1}{x^{2}}"),
        ]
    });
}

#[test]
fn functions() {
    check(|[x, y, _], _| {
        [
            ((x + y).sqrt(), "sqrt(x + y)", "\\sqrt{x + y}"),
            ((x - y).abs(), "abs(x - y)", "\\left|x - y\\right|"),
            (x.asin(), "asin(x)", "\\arcsin\\left(x\\right)"),
            (x.atan(), "atan(x)", "\\arctan\\left(x\\right)"),
            (x.cosh(), "cosh(x)", "\\cosh\\left(x\\right)"),
            (x.ln(), "ln(x)", "\\ln\\left(x\\right)"),
            (x.sign(), "sign(x)", "\\operatorname{sign}\\left(x\\right)"),
            (y.atan2(-x), "atan2(y, -x)", "\\operatorname{atan2}\\left(y, -x\\right)"),
            (x.min(y), "min(x, y)", "\\min\\left(x, y\\right)"),
            ((x - y).exp(), "exp(x - y)", "\\exp\\left(x - y\\right)"),
        ]
    });
}

#[test]
fn numbers() {
    let graph = Graph::new();
    let cases = [
        (0.1, "0.1", "0.1"),
        (-0.0, "0", "0"),
        (1234567.0, "1234567", "1234567"),
        (1e7, "1e7", "10^{7}"),
        (-2.5e-7, "-2.5e-7", "-2.5 \\cdot 10^{-7}"),
        (1e-4, "0.0001", "0.0001"),
        (f64::INFINITY, "inf", "\\infty"),
        (f64::NEG_INFINITY, "-inf", "-\\infty"),
        (f64::NAN, "NaN", "\\mathrm{NaN}"),
        (3.25, "3.25", "3.25"),
    ];
    for (value, text, latex) in cases {
        let number = graph.constant(value);
        assert_eq!(graph.listing(&[number], Style::Text, "t").values, [text]);
        assert_eq!(graph.listing(&[number], Style::Latex, "t").values, [latex]);
    }
    let x = graph.variable("x");
    let small = graph.listing(&[(x * -2.5e-7).sin() - x.pow(graph.constant(1e9))], Style::Latex, "t");
    assert_eq!(small.values, ["-\\left(\\sin\\left(2.5 \\cdot 10^{-7}\\,x\\right) + x^{10^{9}}\\right)"]);
}

#[test]
fn parts_of_pi() {
    use std::f64::consts::PI;
    check(|[x, y, _], graph| {
        let part = |above: f64, below: f64| graph.constant(above * PI / below);
        [
            (part(1.0, 1.0), "pi", "\\pi"),
            (part(-1.0, 2.0), "-pi / 2", "-\\frac{\\pi}{2}"),
            (part(4.0, 6.0), "2 * pi / 3", "\\frac{2\\,\\pi}{3}"),
            (part(36.0, 1.0), "36 * pi", "36\\,\\pi"),
            (part(7.0, 180.0), "7 * pi / 180", "\\frac{7\\,\\pi}{180}"),
            (graph.constant((PI / 9.0).next_up()), "pi / 9", "\\frac{\\pi}{9}"),
            (graph.constant((PI / 9.0).next_up().next_up()), "0.349065850398866", "0.349065850398866"),
            (part(37.0, 1.0), "116.23892818282235", "116.23892818282235"),
            (part(1.0, 7.0), "0.4487989505128276", "0.4487989505128276"),
            (x - part(1.0, 2.0), "x - pi / 2", "x - \\frac{\\pi}{2}"),
            (part(1.0, 2.0) * x, "pi / 2 * x", "\\frac{\\pi}{2}\\,x"),
            (part(-2.0, 3.0) * x - y, "-(y + 2 * pi / 3 * x)", "-\\left(y + \\frac{2\\,\\pi}{3}\\,x\\right)"),
            (x / part(1.0, 2.0), "x / (pi / 2)", "\\frac{x}{\\frac{\\pi}{2}}"),
            (x.pow(part(1.0, 1.0)), "x^pi", "x^{\\pi}"),
            (x.pow(part(2.0, 1.0)), "x^(2 * pi)", "x^{2\\,\\pi}"),
            (part(2.0, 1.0).pow(x), "(2 * pi)^x", "\\left(2\\,\\pi\\right)^{x}"),
        ]
    });
}

#[test]
fn names() {
    let cases = [
        ("x", "x"),
        ("phi", "\\varphi"),
        ("φ", "\\varphi"),
        ("Sigma", "\\Sigma"),
        ("Σ", "\\Sigma"),
        ("theta2", "\\theta_{2}"),
        ("t12", "t_{12}"),
        ("r_b", "r_{b}"),
        ("r_c0", "r_{\\mathrm{c0}}"),
        ("alpha_n", "\\alpha_{n}"),
        ("alpha_1", "\\alpha_{1}"),
        ("m_α", "m_{\\alpha}"),
        ("cutter_tilt", "\\mathrm{cutter\\_tilt}"),
        ("blade2", "\\mathrm{blade}_{2}"),
        ("m.radial_distance", "\\mathrm{m}.\\mathrm{radial\\_distance}"),
        ("machine.cradle.phi", "\\mathrm{machine.cradle}.\\varphi"),
        ("job.x1", "\\mathrm{job}.x_{1}"),
        ("a_", "\\mathrm{a\\_}"),
        ("_a", "\\mathrm{\\_a}"),
        ("12", "\\mathrm{12}"),
        ("a.", "\\mathrm{a.}"),
        ("50%{", "\\mathrm{50\\%\\{}"),
        ("", "\\mathrm{}"),
    ];
    for (name, expected) in cases {
        let graph = Graph::new();
        let x = graph.variable(name);
        assert_eq!(graph.listing(&[x], Style::Latex, "t").values, [expected], "{name}");
        assert_eq!(x.to_string(), name);
        assert_braces_match(&graph.listing(&[x.squared() / (x + 1.0)], Style::Latex, "t").values[0]);
    }
}

/// Braces pair up, escaped ones apart, and so do \left and \right.
fn assert_braces_match(latex: &str) {
    let bare = latex.replace("\\{", "").replace("\\}", "");
    let mut depth = 0;
    for c in bare.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        assert!(depth >= 0, "a brace closes early: {latex}");
    }
    assert_eq!(depth, 0, "a brace stays open: {latex}");
    let count = |what: &str| latex.matches(what).count();
    assert_eq!(count("\\left"), count("\\right"), "{latex}");
    for wrong in ["--", "+ -", "- -", "\\,-", "\\cdot -"] {
        assert!(!latex.contains(wrong), "`{wrong}` in {latex}");
    }
}

/// Programs that print to text of moderate length.
fn on_programs(seed: u64, check: impl for<'g> Fn(&'g Graph, &[Expr<'g>])) {
    let mut random = Random(seed);
    for round in 0..150 {
        let program = Program::tame(&mut random, 3, 20 + round);
        let graph = Graph::new();
        let variables = ["x", "phi", "m.z_1"].map(|name| graph.variable(name));
        check(&graph, &program.build(&variables, &graph));
    }
}

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-9 * (1.0 + expected.abs())
}

#[test]
fn text_reads_back_as_the_same_number() {
    let point = reference_point(3);
    let values = [("x", point[0]), ("phi", point[1]), ("m.z_1", point[2])];
    on_programs(31, |graph, built| {
        let expected = graph.evaluate(built, &point);
        for (&f, expected) in built.iter().zip(expected) {
            let text = f.to_string();
            if text.starts_with("(an expression of") {
                continue;
            }
            let found = parser::value(&text, &values.into());
            assert!(close(found, expected), "{found} instead of {expected}: {text}");
        }
    });
}

#[test]
fn listings_read_back_definition_by_definition() {
    let point = reference_point(3);
    on_programs(32, |graph, built| {
        let expected = graph.evaluate(built, &point);
        let listing = graph.listing(built, Style::Text, "t");
        let mut values = std::collections::HashMap::from([("x", point[0]), ("phi", point[1]), ("m.z_1", point[2])]);
        // an unknown name panics: a definition uses earlier ones only
        for definition in &listing.definitions {
            let value = parser::value(&definition.value, &values);
            assert_eq!(values.insert(&definition.name, value), None, "{} twice", definition.name);
        }
        for (text, expected) in listing.values.iter().zip(expected) {
            let found = parser::value(text, &values);
            assert!(close(found, expected), "{found} instead of {expected}: {text}");
        }
    });
}

#[test]
fn latex_is_well_formed() {
    on_programs(33, |graph, built| {
        let listing = graph.listing(built, Style::Latex, "t");
        for definition in &listing.definitions {
            assert_braces_match(&definition.value);
        }
        listing.values.iter().for_each(|value| assert_braces_match(value));
    });
}

#[test]
fn a_wrong_parenthesis_is_noticed() {
    let values = std::collections::HashMap::from([("x", 3.0), ("y", 5.0)]);
    assert_eq!(parser::value("x - (y - x)", &values), 1.0);
    assert_eq!(parser::value("x - y - x", &values), -5.0);
    assert_eq!(parser::value("-x^2 / (2 * y) - 1e-1 * 10", &values), -1.9);
    assert_eq!(parser::value("x / 2 * y", &values), 7.5);
    assert_eq!(parser::value("max(x, -y) + 2^3^2", &values), 515.0);
}

fn listing_of<'g>(roots: &[Expr<'g>], style: Style) -> Listing {
    roots[0].graph().listing(roots, style, "t")
}

#[test]
fn shared_parts_get_names() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    let long = (x.sin() * y + x).sqrt() / y;
    let roots = [long * x, long + y, long];
    let text = listing_of(&roots, Style::Text);
    let [only] = &text.definitions[..] else { panic!("{text:?}") };
    assert_eq!((&only.name[..], &only.value[..]), ("t1", "sqrt(x + y * sin(x)) / y"));
    assert_eq!(text.values, ["x * t1", "y + t1", "t1"]);
    let latex = listing_of(&roots, Style::Latex);
    assert_eq!(latex.definitions[0].name, "t_{1}");
    assert_eq!(latex.values, ["x\\,t_{1}", "y + t_{1}", "t_{1}"]);
}

#[test]
fn names_of_definitions_are_free() {
    let graph = Graph::new();
    let (x, t1) = (graph.variable("x"), graph.variable("t1"));
    let long = (x.sin() * t1 + x).sqrt() / t1;
    let text = listing_of(&[long * x, long + t1], Style::Text);
    assert_eq!(text.definitions[0].name, "t2");
    // nor are those of variables that stand in other lines of the same page
    let y = graph.variable("y");
    let long = (x.sin() * y + x).sqrt() / y;
    let text = listing_of(&[long * x, long + y], Style::Text);
    assert_eq!(text.definitions[0].name, "t2");
    // t_1 and t1 are one symbol in LaTeX
    let graph = Graph::new();
    let x = graph.variable("x");
    let t_1 = graph.variable("t_1");
    let long = (x.sin() * t_1 + x).sqrt() / t_1;
    let latex = listing_of(&[long * x, long + t_1], Style::Latex);
    assert_eq!(latex.definitions[0].name, "t_{2}");
}

#[test]
fn a_definition_starting_with_a_minus_is_a_name_elsewhere() {
    let graph = Graph::new();
    let (x, y) = (graph.variable("x"), graph.variable("y"));
    let negative = -3.0 - (x * y).sin() * x.exp();
    let text = listing_of(&[y.cos() + negative, negative * x, negative.squared()], Style::Text);
    assert_eq!(text.definitions[0].value, "-3 - sin(x * y) * exp(x)");
    assert_eq!(text.values, ["t1 + cos(y)", "x * t1", "t1^2"]);
}

#[test]
fn very_large_expressions_are_summed_up() {
    let graph = Graph::new();
    let mut f = graph.variable("x");
    for _ in 0..64 {
        f = (f + 1.0) * f;
    }
    assert_eq!(f.to_string(), "(an expression of 130 nodes)");
    assert_eq!(format!("{:?}", graph), format!("Graph({} nodes)", graph.len()));
}
