//! All roots of textbook systems whose number of roots is known.

use std::f64::consts::{PI, TAU};

use flank_expr::{Expr, Graph};
use flank_solver::{Doubt, MOST_BOXES, Range, Roots, System, all_roots};

fn range(low: f64, high: f64) -> Range {
    Range { low, high }
}

/// All roots of a system that `equations` makes of its unknowns.
fn roots_of(ranges: &[Range], equations: impl for<'g> Fn(&'g Graph, &[Expr<'g>]) -> Vec<Expr<'g>>) -> Roots {
    let graph = Graph::new();
    let unknowns: Vec<Expr<'_>> = (0..ranges.len()).map(|k| graph.variable(format!("x{k}"))).collect();
    let system = System::new(&equations(&graph, &unknowns), &unknowns, &[]).expect("nothing is unbound");
    all_roots(&system, ranges, &[], 20 * MOST_BOXES)
}

/// Exactly these roots, in any order, and nothing undecided.
fn are_exactly(found: &Roots, expected: &[&[f64]], tolerance: f64) {
    assert_eq!(found.undecided, [], "after {} boxes", found.boxes);
    assert_eq!(found.isolated.len(), expected.len(), "{:?}", found.isolated);
    for root in expected {
        let near = |at: &[f64]| at.iter().zip(*root).all(|(a, b)| (a - b).abs() <= tolerance);
        assert_eq!(found.isolated.iter().filter(|one| near(&one.solution.unknowns)).count(), 1, "{root:?}");
    }
}

#[test]
fn all_zeros_of_a_sine() {
    let found = roots_of(&[range(-10.0, 10.0)], |_, x| vec![x[0].sin()]);
    let expected: Vec<[f64; 1]> = (-3..=3).map(|k| [f64::from(k) * PI]).collect();
    are_exactly(&found, &expected.iter().map(|root| &root[..]).collect::<Vec<_>>(), 1e-11);
    assert!(found.boxes < 60, "{} boxes", found.boxes);
}

#[test]
fn a_root_on_the_end_of_its_range_is_found() {
    for ends in [range(2.0, 10.0), range(-1.0, 2.0)] {
        let found = roots_of(&[ends], |_, x| vec![x[0].squared() - 4.0]);
        are_exactly(&found, &[&[2.0]], 1e-12);
    }
    let beyond = roots_of(&[range(2.0 + 1e-6, 10.0)], |_, x| vec![x[0].squared() - 4.0]);
    are_exactly(&beyond, &[], 0.0);
}

#[test]
fn a_circle_and_a_line() {
    let found = roots_of(&[range(-2.0, 2.0); 2], |_, x| vec![x[0].squared() + x[1].squared() - 1.0, x[0] - x[1]]);
    let half = 0.5f64.sqrt();
    are_exactly(&found, &[&[half, half], &[-half, -half]], 1e-12);
}

/// Where the tangent touches, nothing can be proven; the place is said, and the rest is proven empty.
#[test]
fn a_tangent_stays_undecided() {
    let found = roots_of(&[range(-2.0, 2.0); 2], |_, x| vec![x[0].squared() + x[1].squared() - 1.0, x[1] - 1.0]);
    assert_eq!(found.isolated, []);
    assert!(!found.undecided.is_empty() && found.undecided.len() < 4, "{:?}", found.undecided);
    for doubt in &found.undecided {
        assert_eq!(doubt.why, Doubt::Singular);
        let [x, y] = &doubt.ranges[..] else { panic!("two unknowns") };
        assert!(x.low.abs() < 1e-2 && x.high.abs() < 1e-2 && (y.low - 1.0).abs() < 1e-3, "{doubt:?}");
    }
    // a hair's breadth away there are two roots, or none
    let line = |height: f64| {
        roots_of(&[range(-2.0, 2.0); 2], move |_, x| vec![x[0].squared() + x[1].squared() - 1.0, x[1] - height])
    };
    let height: f64 = 1.0 - 1e-6;
    let across = (1.0 - height * height).sqrt();
    are_exactly(&line(height), &[&[across, height], &[-across, height]], 1e-9);
    are_exactly(&line(1.0 + 1e-6), &[], 0.0);
}

/// The nine points where the gradient of Himmelblau's function vanishes: four minima, four saddles, one maximum.
#[test]
fn himmelblau() {
    let found = roots_of(&[range(-5.0, 5.0); 2], |_, p| {
        let (x, y) = (p[0], p[1]);
        let (a, b) = (x.squared() + y - 11.0, x + y.squared() - 7.0);
        vec![4.0 * x * a + 2.0 * b, 2.0 * a + 4.0 * y * b]
    });
    let expected: [&[f64]; 9] = [
        &[3.0, 2.0],
        &[-2.805118, 3.131313],
        &[-3.779310, -3.283186],
        &[3.584428, -1.848127],
        &[-0.270845, -0.923039],
        &[-3.073026, -0.081353],
        &[-0.127961, -1.953715],
        &[0.086678, 2.884255],
        &[3.385154, 0.073852],
    ];
    are_exactly(&found, &expected, 1e-6);
}

/// Broyden's tridiagonal system has one root in this box.
#[test]
fn broyden() {
    let found = roots_of(&[range(-1.0, 1.0); 5], |graph, x| {
        let at = |k: isize| usize::try_from(k).ok().and_then(|k| x.get(k)).copied().unwrap_or(graph.constant(0.0));
        let row = |k: isize| (3.0 - 2.0 * at(k)) * at(k) - at(k - 1) - 2.0 * at(k + 1) + 1.0;
        (0..5).map(row).collect()
    });
    assert_eq!((found.isolated.len(), found.undecided.len()), (1, 0), "{found:?}");
}

/// A crank that points to a place by its two joints: elbow up and elbow down, each again after every turn.
#[test]
fn two_joints_and_their_full_turns() {
    let found = roots_of(&[range(0.0, 2.0 * TAU), range(-PI, PI)], |_, q| {
        let whole = q[0] + q[1];
        vec![3.0 * q[0].cos() + 2.0 * whole.cos() - 2.0, 3.0 * q[0].sin() + 2.0 * whole.sin() - 3.0]
    });
    // law of cosines
    let elbow = ((4.0 + 9.0 - 9.0 - 4.0) / 12.0f64).acos();
    let shoulder = |elbow: f64| 3f64.atan2(2.0) - (2.0 * elbow.sin()).atan2(3.0 + 2.0 * elbow.cos());
    let turned = |a: f64| a.rem_euclid(TAU);
    let (up, down) = (turned(shoulder(elbow)), turned(shoulder(-elbow)));
    are_exactly(&found, &[&[up, elbow], &[up + TAU, elbow], &[down, -elbow], &[down + TAU, -elbow]], 1e-11);
}

/// Three to five unknowns: products of factors with known zeros, mixed by a rotation of the equations.
#[test]
fn systems_built_from_their_roots() {
    for n in 1..=5 {
        let found = roots_of(&vec![range(-2.0, 2.0); n], |_, x| {
            // x_k² = 1 mixed with the neighbour's equation: 2ⁿ roots, all ±1
            let plain: Vec<_> = x.iter().map(|x| x.squared() - 1.0).collect();
            (0..n).map(|k| plain[k] + 0.3 * plain[(k + 1) % n] * x[k] - 0.2 * plain[(k + n - 1) % n]).collect()
        });
        assert_eq!(found.undecided, [], "{n} unknowns");
        let at_corners = |root: &Vec<f64>| root.iter().all(|x| (x.abs() - 1.0).abs() < 1e-11);
        let corners = found.isolated.iter().filter(|root| at_corners(&root.solution.unknowns)).count();
        assert_eq!(corners, 1 << n, "{n} unknowns: {} roots", found.isolated.len());
    }
}

#[test]
fn a_domain_that_ends_hides_nothing() {
    // ln x = x − 2 has two roots; below zero there is nothing
    let found = roots_of(&[range(-5.0, 5.0)], |_, x| vec![x[0].ln() - x[0] + 2.0]);
    are_exactly(&found, &[&[0.158594339563039], &[3.146193220620583]], 1e-12);
    // the circle's upper half as a root, ended by its domain on both sides
    let half = roots_of(&[range(-2.0, 2.0)], |_, x| vec![(1.0 - x[0].squared()).sqrt() - 0.6]);
    are_exactly(&half, &[&[0.8], &[-0.8]], 1e-12);
    let nowhere = roots_of(&[range(-5.0, -1.0)], |_, x| vec![x[0].sqrt()]);
    are_exactly(&nowhere, &[], 0.0);
}

#[test]
fn poles_are_not_roots() {
    let found = roots_of(&[range(-4.0, 4.0)], |_, x| vec![x[0].tan()]);
    assert_eq!(found.isolated.len(), 3, "{found:?}");
    for doubt in &found.undecided {
        // a pole changes sign without a root: it may stay undecided, but only right there
        let at = 0.5 * (doubt.ranges[0].low + doubt.ranges[0].high);
        assert!(doubt.why == Doubt::Undefined && (at.abs() - PI / 2.0).abs() < 1e-3, "{doubt:?}");
    }
}

#[test]
fn a_spent_budget_is_said() {
    let graph = Graph::new();
    let x = graph.variable("x");
    let system = System::new(&[(40.0 * x).sin() - 0.5 * x], &[x], &[]).expect("nothing is unbound");
    let found = all_roots(&system, &[range(-2.0, 2.0)], &[], 5);
    assert_eq!(found.boxes, 5);
    assert!(found.undecided.iter().any(|doubt| doubt.why == Doubt::Budget));
    // a whole line of roots cannot be isolated
    let flat = roots_of(&[range(-1.0, 1.0); 2], |_, x| vec![x[0] - x[1], 2.0 * x[0] - 2.0 * x[1]]);
    assert!(flat.isolated.is_empty() && !flat.undecided.is_empty());
}
