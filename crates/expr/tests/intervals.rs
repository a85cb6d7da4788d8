//! Intervals hold what functions take on: random boxes, random points in them, values at fifty digits.

#[path = "intervals/digits.rs"]
mod digits;
mod support;

use digits::Digits;
use flank_expr::{Binary, Curve, Expr, Graph, Interval, IntervalEvaluator, Tape, Unary};
use support::{Program, Random, reference_point};

/// A box about a random number of random size, of random width; ends on round numbers now and then.
fn random_interval(random: &mut Random) -> Interval {
    let round = [0.0, 1.0, -1.0, std::f64::consts::FRAC_PI_2, std::f64::consts::PI];
    let size = 10f64.powf(random.between(-4.0, 2.0));
    let middle = if random.below(3) == 0 { random.pick(&round) } else { random.between(-size, size) };
    let width = 10f64.powf(random.between(-12.0, 1.0)) * middle.abs().max(0.1);
    match random.below(4) {
        0 => Interval::point(middle),
        1 => Interval::new(middle, middle + width),
        _ => Interval::new(middle - width, middle + width),
    }
}

/// An end, or a number in between.
fn random_in(random: &mut Random, x: Interval) -> f64 {
    match random.below(6) {
        0 => x.lo,
        1 => x.hi,
        _ => random.between(x.lo, x.hi).clamp(x.lo, x.hi),
    }
}

fn holds(found: Interval, exact: Option<&Digits>, what: &dyn Fn() -> String) {
    match exact {
        Some(exact) => assert!(exact.lies_in(found), "{} is not in {found:?}", what()),
        None => assert!(!found.continuous, "{} is said to be defined: {found:?}", what()),
    }
}

#[test]
fn unary_operations() {
    let mut random = Random(1);
    for op in Unary::ALL {
        for _ in 0..400 {
            let x = random_interval(&mut random);
            let found = op.apply_interval(x);
            for _ in 0..4 {
                let at = random_in(&mut random, x);
                let exact = Digits::from(at).unary(op);
                holds(found, exact.as_ref(), &|| format!("{op:?} of {at:?} in {x:?}"));
            }
        }
    }
}

#[test]
fn binary_operations() {
    let mut random = Random(2);
    for op in Binary::ALL {
        for _ in 0..600 {
            let (x, mut y) = (random_interval(&mut random), random_interval(&mut random));
            if op == Binary::Pow && random.below(2) == 0 {
                y = Interval::point(random.between(-5.0, 6.0).round());
            }
            let found = op.apply_interval(x, y);
            for _ in 0..4 {
                let (a, b) = (random_in(&mut random, x), random_in(&mut random, y));
                let exact = Digits::from(a).binary(op, &Digits::from(b));
                holds(found, exact.as_ref(), &|| format!("{op:?} of {a:?}, {b:?} in {x:?}, {y:?}"));
            }
        }
    }
}

/// Not only do intervals hold the values, they are little wider than need be: of a narrow box by the derivative.
#[test]
fn intervals_are_tight() {
    let tight = |found: Interval, exact: f64, slope: f64, width: f64, what: &str| {
        let allowed = slope.abs() * width * 1.01 + 16.0 * f64::EPSILON * exact.abs();
        assert!(found.continuous && found.width() <= allowed, "{what}: {found:?}, allowed {allowed:e}");
    };
    for op in Unary::ALL.into_iter().filter(|op| *op != Unary::Sign) {
        for at in [0.3, 0.7, 1.3, 2.9] {
            let x = if matches!(op, Unary::Asin | Unary::Acos | Unary::Atanh) { at / 3.0 } else { at };
            let x = if op == Unary::Acosh { 1.0 + x } else { x };
            let graph = Graph::new();
            let variable = graph.variable("x");
            let f = variable.unary(op);
            let exact = graph.evaluate(&[f, f.derivative(variable)], &[x]);
            for width in [0.0, 1e-9, 1e-5] {
                let found = op.apply_interval(Interval::new(x, x + width));
                tight(found, exact[0], exact[1], width, &format!("{op:?} at {x}, width {width:e}"));
            }
        }
    }
    // at the very top of a wave
    let top = Interval::new(1.5, 1.6).sin();
    assert!(top.hi == 1.0 && top.lo > 0.997 && top.continuous);
    let bottom = Interval::new(3.0, 3.3).cos();
    assert!(bottom.lo == -1.0 && bottom.hi < -0.98);
}

#[test]
fn partly_defined_is_told_from_nowhere_defined() {
    let x = Interval::new(-1.0, 4.0);
    for partly in [x.sqrt(), x.ln(), x.asin(), x.acosh(), Interval::new(1.0, 2.0).tan(), Interval::point(1.0) / x] {
        assert!(!partly.is_empty() && !partly.continuous, "{partly:?}");
    }
    let below = Interval::new(-4.0, -2.0);
    for nowhere in [below.sqrt(), below.ln(), below.asin(), below.acos(), below.acosh(), below.atanh()] {
        assert!(nowhere.is_empty(), "{nowhere:?}");
    }
    // the quotient by one side of zero is half a line
    let half = Interval::new(2.0, 3.0) / Interval::new(0.0, 4.0);
    assert!(half.lo <= 0.5 && half.lo > 0.499 && half.hi == f64::INFINITY && !half.continuous);
    // around the negative axis the angle jumps
    let behind = Interval::new(-0.1, 0.1).atan2(Interval::new(-2.0, -1.0));
    assert!(!behind.continuous && behind.width() > 6.0);
    let ahead = Interval::new(-0.1, 0.1).atan2(Interval::new(1.0, 2.0));
    assert!(ahead.continuous && ahead.width() < 0.2);
}

/// Over boxes: the values of a program at points in the box, at fifty digits.
#[test]
fn random_programs_over_boxes() {
    let mut random = Random(3);
    for round in 0..60 {
        let program = Program::tame(&mut random, 3, 60);
        let graph = Graph::new();
        let variables: Vec<Expr<'_>> = (0..3).map(|k| graph.variable(format!("x{k}"))).collect();
        let built = program.build(&variables, &graph);
        let tape = Tape::new(&built, &variables).expect("every variable is an input");
        let width = [0.0, 1e-12, 1e-6, 1e-2][round % 4];
        let boxed: Vec<Interval> =
            reference_point(3).iter().map(|x| Interval::new(x - width, x + width * random.between(0.0, 1.0))).collect();
        let mut found = vec![Interval::EMPTY; built.len()];
        IntervalEvaluator::new(&tape).run(&boxed, &mut found);
        for _ in 0..2 {
            let point: Vec<f64> = boxed.iter().map(|x| random_in(&mut random, *x)).collect();
            let exact = Digits::outputs(&tape, &point.iter().map(|x| Digits::from(*x)).collect::<Vec<_>>());
            for (k, exact) in exact.iter().enumerate() {
                holds(found[k], exact.as_ref(), &|| format!("{} at {point:?}", built[k]));
            }
        }
    }
}

#[test]
fn curves_over_boxes() {
    let mut random = Random(4);
    for _ in 0..40 {
        let points: Vec<(f64, f64)> = (0..8).map(|k| (f64::from(k), random.between(-1.0, 1.0))).collect();
        let curve = Curve::through("f", &points).expect("increasing");
        for order in 0..5 {
            let (a, b) = (random.between(-0.5, 7.5), random.between(-0.5, 7.5));
            let x = Interval::new(a.min(b), a.max(b));
            let found = curve.enclosure(order, x);
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for k in 0..=2000 {
                let at = x.lo + (x.hi - x.lo) * f64::from(k) / 2000.0;
                let value = curve.value(order, at);
                assert!(if value.is_nan() { !found.continuous } else { found.contains(value) });
                (low, high) = (low.min(value), high.max(value));
            }
            // what may happen between two samples: kinks of the second derivative change slopes by up to 30
            if found.continuous {
                assert!(low - found.lo < 0.03 && found.hi - high < 0.03, "order {order}: {found:?} {low} {high}");
            }
        }
    }
}
