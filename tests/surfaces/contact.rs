//! Contact of two flanks against closed forms and independent solutions.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use flank_expr::Graph;
use flank_expr::geometry::{Axis, Chain, Step, Surface, Vector3};
use flank_solver::{
    BoundSurface, ContactPoint, ContactProblem, ContactState, FlankEdge, GapProblem, NoContact, Outcome, Outline,
    OutlineSegment, Range, RollingPair, SurfacePoint, SurfaceProblem,
};
use flank_tests::{difference, number, reference_json, vector};
use serde_json::Value;

/// An involute helicoid with lead crowning, as helical_tca.md has it: unknowns xi and z.
fn helicoid<'g>(graph: &'g Graph, of: &str, [rb, tb, eps]: [f64; 3], [c, d]: [f64; 2]) -> Surface<'g> {
    let [xi, z] = ["xi", "z"].map(|name| graph.variable(format!("{of} {name}")));
    let square = z * z;
    let phi = (z * tb + (square * c + square * square * d) * eps) / rb;
    let psi = phi + xi * eps;
    let (sin, cos) = (psi.sin(), psi.cos());
    let position = Vector3([(cos + sin * xi * eps) * rb, (sin - cos * xi * eps) * rb, z]);
    let tan = (z * (2.0 * c) + z * square * (4.0 * d)) * eps + tb;
    let normal = Vector3([sin, -cos, tan]).scaled(1.0 / (tan * tan + 1.0).sqrt()).scaled(graph.constant(eps));
    Surface { unknowns: vec![xi, z], position, normal, constraints: Vec::new(), given: 0 }
}

/// Points of a flank over its ranges.
fn grid(surface: &BoundSurface<'_>) -> Vec<SurfacePoint> {
    const SIDE: usize = 9;
    let unknowns = &surface.surface().unknowns;
    let problem = SurfaceProblem::new(surface, [unknowns[0], unknowns[1]]).expect("nothing is unbound");
    let at = |k: usize, step: usize| {
        let Range { low, high } = surface.ranges()[k];
        low + (high - low) * step as f64 / (SIDE - 1) as f64
    };
    let targets: Vec<[f64; 2]> = (0..SIDE * SIDE).map(|k| [at(0, k / SIDE), at(1, k % SIDE)]).collect();
    problem.solve(&targets, [SIDE; 2]).0
}

/// The contact of a pair at roll positions.
fn path(pair: &RollingPair<'_, '_>, rolls: &[f64]) -> (ContactProblem, Vec<ContactPoint>) {
    let problem = ContactProblem::new(pair).expect("nothing is unbound");
    let points = pair.surfaces.map(grid);
    let path = problem.path(rolls, [&points[0], &points[1]]);
    assert_eq!(path.refused, None);
    let points = path.points.into_iter().map(|point| point.expect("it touches all over the roll")).collect();
    (problem, points)
}

/// What a row of a table says of a contact, under the names that it has there. 1e-11 rad, 1e-9 mm and 1e-9 /mm are what double precision
/// leaves of the tables' 17 digits over the conditions of these pairs.
fn assert_row(point: &ContactPoint, row: &Value, outwards: f64, follower: (&str, f64)) {
    let (name, value) = follower;
    let turns = (value - number(row, name)) / TAU;
    assert!((turns - turns.round()).abs() * TAU < 1e-11, "{value} {row}");
    assert!(difference(&point.position, &vector(row, "p_f")) < 1e-9, "{point:?} {row}");
    let normal = point.normal.map(|x| outwards * x);
    // where it is the same all along the path it stands once
    assert!(row.get("n_f").is_none() || difference(&normal, &vector(row, "n_f")) < 1e-11, "{point:?} {row}");
    let gap = point.gap.expect("a regular point");
    let asked = ["gap_k1", "gap_k2"].map(|name| number(row, name));
    assert!(difference(&[gap.k1, gap.k2], &asked) < 1e-9, "{gap:?} {row}");
    let along = gap.directions.expect("two curvatures")[0];
    let cosine: f64 = along.iter().zip(vector(row, "gap_d1")).map(|(a, b)| a * b).sum();
    assert!((cosine.abs() - 1.0).abs() < 1e-12, "{gap:?} {row}");
    assert_eq!((point.outcome, point.state), (Outcome::Solved, Some(ContactState::Touching)), "{row}");
}

fn rolls(rows: &[Value], name: &str) -> Vec<f64> {
    rows.iter().map(|row| number(row, name)).collect()
}

fn rows_of(case: &Value) -> &[Value] {
    case["rows"].as_array().expect("rows")
}

/// A pair of helicoids, the second placed by steps that its own turn follows.
fn assert_helicoids<'g>(graph: &'g Graph, of: &Value, rows: &[Value], unturned: f64, placed: Vec<Step<'g>>) {
    let optional = |name: &str| of.get(name).and_then(Value::as_f64).unwrap_or(0.0);
    let eps = number(of, "eps");
    let first = [number(of, "rb1"), number(of, "tb1"), eps];
    let second = [number(of, "rb2"), number(of, "tb2"), eps];
    let first = helicoid(graph, "first", first, [optional("c"), optional("d")]);
    let second = helicoid(graph, "second", second, [0.0; 2]);
    let ranges = vec![Range { low: 0.05, high: 2.5 }, Range { low: -16.0, high: 16.0 }];
    let [first, second] = [first, second].map(|surface| BoundSurface::new(&surface, ranges.clone(), &[]));
    let (roll, lag) = (graph.variable("roll"), graph.variable("lag"));
    let ratio = number(of, "z1") / number(of, "z2");
    let turned = Step::Rotate(Axis::Z, lag - roll * ratio + unturned);
    let pair = RollingPair {
        surfaces: [&first, &second],
        placements: [
            Chain::new(graph, vec![Step::Rotate(Axis::Z, roll)]),
            Chain::new(graph, placed.into_iter().chain([turned]).collect()),
        ],
        roll,
        lag: (lag, Range { low: -0.05, high: 0.05 }),
        outlines: [None, None],
        parameters: Vec::new(),
    };
    let (_, points) = path(&pair, &rolls(rows, "theta1"));
    for (point, row) in points.iter().zip(rows) {
        assert_row(point, row, 1.0, ("theta2", point.lag - point.roll * ratio + unturned));
        assert!(of.get("n_f").is_none() || difference(&point.normal, &vector(of, "n_f")) < 1e-11, "{point:?}");
    }
}

#[test]
fn a_crowned_helical_pair_bears_misalignment_as_in_closed_form() {
    let reference = reference_json("helical_tca_a.json");
    let inputs = &reference["inputs"];
    for case in reference["cases"].as_array().expect("cases") {
        let graph = Graph::new();
        let of = |name: &str| number(&case["misalignment"], name);
        let placed = vec![
            Step::Translate(Vector3::constant(&graph, [number(inputs, "a") + of("da"), 0.0, 0.0])),
            Step::Rotate(Axis::Y, graph.constant(of("dA"))),
            Step::Rotate(Axis::X, graph.constant(of("dB"))),
        ];
        assert_helicoids(&graph, inputs, rows_of(case), number(inputs, "TE0"), placed);
    }
}

/// How the members move past each other where they touch, from the turning of both alone: they slide by the turn against each other times
/// the way from the pitch point. The point of contact moves as it does over a small step of the roll.
#[test]
fn members_slide_and_entrain_as_their_turns_say() {
    let reference = reference_json("helical_tca_a.json");
    let inputs = &reference["inputs"];
    let case = &reference["cases"][0];
    let graph = Graph::new();
    let (roll, lag) = (graph.variable("roll"), graph.variable("lag"));
    let [distance, ratio] = [number(inputs, "a"), number(inputs, "z1") / number(inputs, "z2")];
    let eps = number(inputs, "eps");
    let flank = |name: &str, rb: &str, tb: &str, crowning: [f64; 2]| {
        let surface = helicoid(&graph, name, [number(inputs, rb), number(inputs, tb), eps], crowning);
        let ranges = vec![Range { low: 0.05, high: 2.5 }, Range { low: -16.0, high: 16.0 }];
        BoundSurface::new(&surface, ranges, &[])
    };
    let first = flank("first", "rb1", "tb1", ["c", "d"].map(|c| number(inputs, c)));
    let second = flank("second", "rb2", "tb2", [0.0; 2]);
    let turned = lag - roll * ratio + number(inputs, "TE0");
    let apart = Step::Translate(Vector3::constant(&graph, [distance, 0.0, 0.0]));
    let pair = RollingPair {
        surfaces: [&first, &second],
        placements: [
            Chain::new(&graph, vec![Step::Rotate(Axis::Z, roll)]),
            Chain::new(&graph, vec![apart, Step::Rotate(Axis::Z, turned)]),
        ],
        roll,
        lag: (lag, Range { low: -0.05, high: 0.05 }),
        outlines: [None, None],
        parameters: Vec::new(),
    };
    let (problem, points) = path(&pair, &rolls(rows_of(case), "theta1"));
    for point in &points {
        let [x, y, z] = point.position;
        let about = |from: f64, speed: f64| [-speed * y, speed * (x - from), 0.0];
        let (driver, driven) = (about(0.0, 1.0), about(distance, -ratio));
        let expected: [f64; 3] = std::array::from_fn(|k| driver[k] - driven[k]);
        assert!(difference(&point.sliding, &expected) < 1e-9, "{point:?}");
        let pitch = distance * ratio / (1.0 + ratio);
        let lever = (1.0 + ratio) * (x - pitch).hypot(y);
        let speed = point.sliding.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((speed - lever).abs() < 1e-9 && z.abs() < 1e-9, "{point:?}");
        // second differences of the path over steps of 1e-4 are below 1e-6 mm per radian
        const STEP: f64 = 1e-4;
        let [before, after] = [-STEP, STEP].map(|by| problem.followed(point, point.roll + by).expect("it goes on"));
        let rate = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| (b[k] - a[k]) / (2.0 * STEP)) };
        for member in 0..2 {
            let moved = rate(before.in_members[member], after.in_members[member]);
            assert!(difference(&point.path[member], &moved) < 1e-5, "{moved:?} {point:?}");
        }
        let moved = rate(before.position, after.position);
        let mean: [f64; 3] = std::array::from_fn(|k| 0.5 * (driver[k] + driven[k]) - moved[k]);
        let along: f64 = mean.iter().zip(point.normal).map(|(a, b)| a * b).sum();
        let in_plane: [f64; 3] = std::array::from_fn(|k| mean[k] - along * point.normal[k]);
        assert!(difference(&point.entraining, &in_plane) < 1e-5, "{in_plane:?} {point:?}");
    }
}

/// A worm with its gear and a pair of screw gears, mounted right and wrong: the contact runs along a straight line and the ratio stays.
#[test]
fn crossed_helicoids_touch_along_a_straight_line() {
    let reference = reference_json("crossed_tca_a.json");
    for case in reference["cases"].as_array().expect("cases") {
        let graph = Graph::new();
        let of = |name: &str| number(&case["misalignment"], name);
        let placed = vec![
            Step::Translate(Vector3::constant(&graph, [number(case, "a") + of("da"), 0.0, 0.0])),
            Step::Rotate(Axis::X, graph.constant(number(case, "Sigma") + of("dS"))),
        ];
        let ratio = number(case, "z1") / number(case, "z2");
        let first = &rows_of(case)[0];
        // the turn that the members are mounted with, to a hundredth: the contact finds the rest
        let unturned = number(first, "theta2") + ratio * number(first, "theta1");
        let unturned = (100.0 * unturned).round() / 100.0;
        assert_helicoids(&graph, case, rows_of(case), unturned, placed);
    }
}

/// A cutter's straight blade as tca.md has it: unknowns along the blade and around the cutter, normal out of the cutter.
fn straight_blade<'g>(graph: &'g Graph, of: &str, side: f64, [radius, alpha]: [f64; 2]) -> Surface<'g> {
    let [u, v] = ["u", "v"].map(|name| graph.variable(format!("{of} {name}")));
    let (sin, cos) = alpha.sin_cos();
    let around = u * (side * sin) + radius;
    let position = Vector3([around * v.cos(), around * v.sin(), u * cos]);
    let normal = Vector3([v.cos() * (side * cos), v.sin() * (side * cos), graph.constant(-sin)]);
    Surface { unknowns: vec![u, v], position, normal, constraints: Vec::new(), given: 0 }
}

/// A flank cut by a blade on a cradle machine, as tca.md has it.
fn cradle_flank<'g>(graph: &'g Graph, of: &str, side: f64, set: &Value, [c2, d6]: [f64; 2]) -> Surface<'g> {
    let value = |name: &str| number(set, name);
    let psi = graph.variable(format!("{of} psi"));
    let turn = (psi - psi * psi * (0.5 * c2) - psi * psi * psi * (d6 / 6.0)) * value("Ra");
    let slide = psi * value("H1") + psi * psi * value("H2") + value("Xb0");
    let constant = |x: f64| graph.constant(x);
    let steps = vec![
        Step::Rotate(Axis::Z, -turn),
        Step::Translate(Vector3::constant(graph, [0.0, 0.0, -value("Xp")])),
        Step::Rotate(Axis::Y, constant(-(FRAC_PI_2 + value("gamma_m")))),
        Step::Translate(Vector3([constant(0.0), constant(-value("Em")), slide])),
        Step::Rotate(Axis::Z, psi + value("q0")),
        Step::Translate(Vector3::constant(graph, [value("Sr"), 0.0, 0.0])),
        Step::Rotate(Axis::Z, constant(value("j"))),
        Step::Rotate(Axis::Y, constant(value("i"))),
    ];
    let blade = straight_blade(graph, of, side, [value("r0"), value("alpha")]);
    blade.envelope(&Chain::new(graph, steps), &[psi])
}

/// Where a generated flank is looked for: along the blade, around the cutter, over the cradle.
fn flank_ranges(along: f64, around: f64) -> Vec<Range> {
    let range = |low: f64, high: f64| Range { low, high };
    vec![range(-1.0, along), range(around - 0.5, around + 0.5), range(-0.3, 0.3)]
}

#[test]
fn a_spiral_bevel_pair_touches_as_solved_with_fifty_digits() {
    let reference = reference_json("tca.json");
    let inputs = &reference["inputs"];
    for case in reference["contacts"].as_array().expect("contacts") {
        let graph = Graph::new();
        let (set, side) = (case["set"].as_str().expect("a set"), case["side"].as_str().expect("a side"));
        let of = |name: &str| number(&case["misalignment"], name);
        let roll_change = if set == "plain" { [0.0; 2] } else { ["C2", "D6"].map(|c| number(&inputs[set][side], c)) };
        let outside = if side == "drive" { 1.0 } else { -1.0 };
        let pinion = cradle_flank(&graph, "pinion", outside, &inputs["pinion"][side], roll_change);
        let gear = cradle_flank(&graph, "gear", -outside, &inputs["gear"][side], [0.0; 2]);
        let pinion = BoundSurface::new(&pinion, flank_ranges(9.0, 1.92), &[]);
        let gear = BoundSurface::new(&gear, flank_ranges(9.0, -1.92), &[]);
        let (roll, lag) = (graph.variable("roll"), graph.variable("lag"));
        let ratio = number(inputs, "z1") / number(inputs, "z2");
        let constant = |x: f64| graph.constant(x);
        let along = |x: f64, y: f64, z: f64| Step::Translate(Vector3::constant(&graph, [x, y, z]));
        let first = vec![
            along(0.0, of("dE"), 0.0),
            Step::Rotate(Axis::Y, constant(of("dS") + FRAC_PI_2 + number(inputs, "gamma1"))),
            along(0.0, 0.0, of("dA1")),
            Step::Rotate(Axis::Z, roll),
        ];
        let second = vec![
            Step::Rotate(Axis::X, constant(PI)),
            Step::Rotate(Axis::Y, constant(FRAC_PI_2 + number(inputs, "gamma2"))),
            along(0.0, 0.0, of("dA2")),
            Step::Rotate(Axis::Z, lag - roll * ratio),
        ];
        let pair = RollingPair {
            surfaces: [&pinion, &gear],
            placements: [Chain::new(&graph, first), Chain::new(&graph, second)],
            roll,
            lag: (lag, Range { low: -0.01, high: 0.01 }),
            outlines: [None, None],
            parameters: Vec::new(),
        };
        let rows = rows_of(case);
        let (_, points) = path(&pair, &rolls(rows, "theta1"));
        for (point, row) in points.iter().zip(rows) {
            assert_row(point, row, -1.0, ("TE", point.lag));
            for (member, name) in ["p_w1", "p_w2"].iter().enumerate() {
                assert!(difference(&point.in_members[member], &vector(row, name)) < 1e-9, "{row}");
            }
        }
    }
}

/// A curved blade as tca_universal.md has it; k is -1 on the pinion's concave side, 1 on the gear's convex side.
fn curved_blade<'g>(graph: &'g Graph, of: &str, k: f64, set: &Value) -> Surface<'g> {
    let [u, v] = ["u", "v"].map(|name| graph.variable(format!("{of} {name}")));
    let [rp, rho, a] = ["Rp", "rho", "a"].map(|name| number(set, name));
    let w = u / rho + a;
    let x = w.cos() * (k * rho) + (rp - k * rho * a.cos());
    let position = Vector3([x * v.cos(), x * v.sin(), w.sin() * -rho + rho * a.sin()]);
    let normal = Vector3([w.cos() * v.cos() * -k, w.cos() * v.sin() * -k, w.sin()]);
    Surface { unknowns: vec![u, v], position, normal, constraints: Vec::new(), given: 0 }
}

/// Mounting errors of the published pair: the pinion out of the apex, the offset, the shaft angle, the gear out of the apex.
const ERRORS: [&str; 4] = ["dP", "dE", "dS", "dG"];

fn universal_flank<'g>(graph: &'g Graph, of: &str, k: f64, set: &Value) -> Surface<'g> {
    let value = |name: &str| number(set, name);
    let phi = graph.variable(format!("{of} phi"));
    let psi = phi * value("m") + phi * phi * value("c2") + phi * phi * phi * value("c3");
    let along = |x: f64, y: f64, z: f64| Step::Translate(Vector3::constant(graph, [x, y, z]));
    let steps = vec![
        Step::Rotate(Axis::Z, -psi),
        along(0.0, 0.0, -value("D")),
        Step::Rotate(Axis::Y, graph.constant(value("g"))),
        along(value("B"), value("E"), 0.0),
        Step::Rotate(Axis::X, -(phi + value("q0"))),
        along(0.0, 0.0, value("S")),
        Step::Rotate(Axis::Y, graph.constant(-FRAC_PI_2)),
    ];
    curved_blade(graph, of, k, set).envelope(&Chain::new(graph, steps), &[phi])
}

/// The published 19 x 62 pair, mounted right and wrong.
fn with_universal_pair(misalignment: &Value, inputs: &Value, use_pair: impl FnOnce(&RollingPair<'_, '_>)) {
    with_pair_in([None, None], misalignment, inputs, use_pair);
}

/// The same with the ends of its teeth.
fn with_pair_in(
    outlines: [Option<Outline>; 2],
    misalignment: &Value,
    inputs: &Value,
    use_pair: impl FnOnce(&RollingPair<'_, '_>),
) {
    let graph = Graph::new();
    let of = |name: &str| number(misalignment, name);
    let pinion = universal_flank(&graph, "pinion", -1.0, &inputs["pinion"]);
    let gear = universal_flank(&graph, "gear", 1.0, &inputs["gear"]);
    // the blade begins at its edge's rounding, u = 0
    let from_rounding = |mut ranges: Vec<Range>| {
        ranges[0].low = 0.0;
        ranges
    };
    let pinion = BoundSurface::new(&pinion, from_rounding(flank_ranges(7.0, 2.0)), &[]);
    let gear = BoundSurface::new(&gear, from_rounding(flank_ranges(9.0, -2.0)), &[]);
    let (roll, lag) = (graph.variable("roll"), graph.variable("lag"));
    let errors = ERRORS.map(|name| (graph.variable(name), of(name)));
    let [(pinion_out, _), (offset, _), (shaft_angle, _), (gear_out, _)] = errors;
    let zero = graph.constant(0.0);
    let ratio = number(inputs, "zP") / number(inputs, "zG");
    let second = vec![
        Step::Translate(Vector3([zero, offset, zero])),
        Step::Rotate(Axis::Y, shaft_angle + number(inputs, "Sigma")),
        Step::Rotate(Axis::Z, graph.constant(PI)),
        Step::Translate(Vector3([zero, zero, gear_out])),
        Step::Rotate(Axis::Z, -(roll * ratio + lag)),
    ];
    let first = vec![Step::Translate(Vector3([zero, zero, pinion_out])), Step::Rotate(Axis::Z, roll)];
    use_pair(&RollingPair {
        surfaces: [&pinion, &gear],
        placements: [Chain::new(&graph, first), Chain::new(&graph, second)],
        roll,
        lag: (lag, Range { low: 0.02, high: 0.08 }),
        outlines,
        parameters: errors.to_vec(),
    });
}

/// contact_edges_a.md gives the vertex of the error and its second derivative, for the same pair.
#[test]
fn the_error_is_least_where_the_table_has_its_vertex() {
    let reference = reference_json("tca_universal.json");
    let aligned = &reference["contacts"][0];
    with_universal_pair(&aligned["misalignment"], &reference["inputs"], |pair| {
        let (problem, points) = path(pair, &rolls(rows_of(aligned), "thetaP"));
        let vertex = problem.vertex(&points[12], [-0.425, 0.2]).expect("the error has a vertex");
        // by differences, with eight digits
        assert!((vertex.roll + 0.035_716_443_465_9).abs() < 1e-9, "{vertex:?}");
        assert!((vertex.lag_slopes[1] / 0.010_347_386_8 - 1.0).abs() < 1e-7, "{vertex:?}");
        // of the polynomial through the fifteen rows of tca_universal, in exact fractions
        assert!((vertex.roll + 0.035_716_443_622_50).abs() < 1e-11, "{vertex:?}");
        assert!((vertex.lag_slopes[1] / 0.010_347_386_669_6 - 1.0).abs() < 1e-9, "{vertex:?}");
    });
}

/// What each mounting error does to the vertex of the published pair, against the vertex solved again with the error a little greater and a
/// little smaller: of the parabola, the path and the gap alike.
#[test]
fn a_mounting_error_changes_the_vertex_as_solving_again_does() {
    let reference = reference_json("tca_universal.json");
    let aligned = &reference["contacts"][0];
    with_universal_pair(&aligned["misalignment"], &reference["inputs"], |pair| {
        let (problem, points) = path(pair, &rolls(rows_of(aligned), "thetaP"));
        let vertex = problem.vertex(&points[12], [-0.425, 0.2]).expect("the error has a vertex");
        for parameter in 0..ERRORS.len() {
            let change = problem.change(&vertex, &[(parameter, 1.0)], true).expect("the vertex is regular");
            // third derivatives by an error are below 1 per mm or radian and its square, of the roll a hundred times that
            const STEP: f64 = 2e-4;
            let [before, after] = [-STEP, STEP].map(|step| {
                let mut values = [0.0; 4];
                values[parameter] = step;
                let wrong = problem.with_values(&values);
                let near =
                    wrong.find(vertex.roll, pair.surfaces.map(grid).each_ref().map(Vec::as_slice)).expect("it touches");
                wrong.vertex(&near, [-0.425, 0.2]).expect("the error has a vertex")
            });
            let rate = |of: &dyn Fn(&ContactPoint) -> f64| (of(&after) - of(&before)) / (2.0 * STEP);
            let close = |exact: f64, of: &dyn Fn(&ContactPoint) -> f64, to: f64| {
                assert!((exact - rate(of)).abs() < to * exact.abs().max(1e-3), "{parameter}: {exact} {}", rate(of));
            };
            close(change.roll, &|at| at.roll, 1e-4);
            close(change.lag, &|at| at.lag, 1e-6);
            close(change.lag_curvature, &|at| at.lag_slopes[1], 1e-3);
            for member in 0..2 {
                (0..3).for_each(|k| close(change.moved[member][k], &|at| at.in_members[member][k], 1e-4));
            }
            let [k1, k2] = change.gap.expect("flank on flank");
            close(k1, &|at| at.gap.as_ref().expect("flank on flank").k1, 1e-4);
            close(k2, &|at| at.gap.as_ref().expect("flank on flank").k2, 1e-4);
        }
    });
}

/// A blank from its corners `[z, rho]`: root toe, root heel, tip toe, tip heel. Its bore lies as far below the root as the tip above: the
/// root is no end of a flank.
fn blank(corners: &Value) -> Outline {
    let given = |k: usize, x: usize| corners[k][x].as_f64().expect("a length");
    let corner = |k: usize| [0, 1].map(|x| if k < 2 { 2.0 * given(k, x) - given(k + 2, x) } else { given(k, x) });
    let around = [("bore", 0, 1), ("heel", 1, 3), ("tip", 3, 2), ("toe", 2, 0)];
    let segment = |(name, from, to): (&str, usize, usize)| OutlineSegment {
        name: name.to_owned(),
        from: corner(from),
        to: corner(to),
        center: None,
    };
    Outline::new(around.map(segment).to_vec())
}

/// What touches, as the table calls it.
fn kind(edges: &[FlankEdge]) -> String {
    const NAMES: [[&str; 4]; 2] = [
        ["pinion bore", "pinion heel", "pinion tip", "pinion toe"],
        ["gear bore", "gear heel", "gear tip", "gear toe"],
    ];
    let names: Vec<&str> = edges.iter().map(|edge| NAMES[edge.member][edge.segment]).collect();
    if names.is_empty() { "flank".to_owned() } else { names.join(" x ") }
}

/// The published pair with the ends of its teeth: three pairs of teeth at 20 roll positions, on flanks, tip and toe, which of them carries,
/// where contact of the flanks begins and ends and where one pair hands over to the next. Of the table flank and edge rows are good to
/// 1e-11 rad and 1e-9 mm.
#[test]
fn pairs_of_teeth_carry_with_flanks_and_edges_as_solved_independently() {
    let reference = reference_json("contact_edges_a.json");
    let inputs = &reference["inputs"];
    for case in reference["cases"].as_array().expect("cases") {
        let pair_outlines = ["pinion_blank", "gear_blank"].map(|name| Some(blank(&inputs[name])));
        with_pair_in(pair_outlines.clone(), &case["misalignment"], inputs, |pair| {
            let rows = rows_of(case);
            let rolls = rolls(rows, "thetaP");
            let problem = ContactProblem::new(pair).expect("nothing is unbound");
            let points = pair.surfaces.map(grid);
            let first = problem.find(rolls[10], [&points[0], &points[1]]).expect("the flanks touch");
            let of = problem.engagement(&first, TAU / 19.0, 20, [-2.0, 2.0]);
            assert_eq!(of.is_whole, [true, true]);
            for (k, row) in rows.iter().enumerate() {
                let step = k as isize - 10;
                let pairs = row["pairs"].as_array().expect("pairs");
                for pair in pairs {
                    let j = pair["j"].as_i64().expect("a pair") as isize;
                    let Some(point) = of.point(j, step) else {
                        assert_eq!(pair["kind"], "none", "{pair}");
                        continue;
                    };
                    if pair["kind"] == "none" {
                        // the table has given up a pair whose flanks still have a point in common, a milliradian behind the one that carries
                        let held = [0, 1].map(|k| {
                            let [x, y, z] = point.in_members[k];
                            pair_outlines[k].as_ref().is_some_and(|outline| outline.holds([z, x.hypot(y)]))
                        });
                        assert!(held == [true; 2] && point.outcome == Outcome::Solved, "{point:?}");
                        assert!(point.lag - number(row, "composite_TE") > 1e-3, "{point:?}");
                        continue;
                    }
                    assert_eq!(kind(&point.edges), pair["kind"].as_str().expect("a kind"), "{step} {pair} {point:?}");
                    assert!((point.lag - number(pair, "TE")).abs() < 1e-11, "{point:?} {pair}");
                    assert!(difference(&point.position, &vector(pair, "p_f")) < 1e-8, "{point:?} {pair}");
                }
                let carried = of.carried(step).expect("a pair carries");
                assert_eq!(carried.pair, row["leading"].as_i64().expect("a pair") as isize);
                assert!((carried.lag - number(row, "composite_TE")).abs() < 1e-11);
                let behind = carried.behind.expect("another pair touches");
                assert!((behind - number(row, "next_pair_behind")).abs() < 2e-11);
            }
            for (way, name) in [(-1, "flank_contact_from"), (1, "flank_contact_to")] {
                let end = problem.flank_end(&of, way).expect("the flanks touch");
                assert!((end.roll - number(case, name)).abs() < 1e-9, "{name} {end:?} {}", case[name]);
            }
            let handed = problem.transfer(&of, [0, -1], [0.05, 0.2]).expect("one hands over to the other");
            assert!((handed - number(case, "transfer_thetaP")).abs() < 1e-9, "{handed} {}", case["transfer_thetaP"]);
        });
    }
}

/// Points of a flank at shares of a blank, lengthwise from toe to heel and profilewise from root to tip.
fn nodes(surface: &BoundSurface<'_>, corners: &Value, [lengthwise, profilewise]: [&[f64]; 2]) -> Vec<SurfacePoint> {
    let [x, y, z] = surface.surface().position.0;
    let problem = SurfaceProblem::new(surface, [z, (x * x + y * y).sqrt()]).expect("nothing is unbound");
    let corner = |k: usize, x: usize| corners[k][x].as_f64().expect("a length");
    let at = |s: f64, t: f64| {
        [0, 1].map(|x| {
            let [root, tip] = [0, 2].map(|k| corner(k, x) * (1.0 - s) + corner(k + 1, x) * s);
            root * (1.0 - t) + tip * t
        })
    };
    let targets: Vec<[f64; 2]> = profilewise.iter().flat_map(|t| lengthwise.iter().map(|s| at(*s, *t))).collect();
    problem.solve(&targets, [profilewise.len(), lengthwise.len()]).0
}

/// How near the pinion comes to the gear's flank over three pitches of the composite motion, on 9 x 17 nodes: the table's gaps to 1e-9 mm,
/// and of the compound's film as many nodes as it has. None is below zero, so that nothing reaches into the mate.
#[test]
fn the_mate_comes_as_near_as_solved_independently() {
    let reference = reference_json("contact_edges_a.json");
    let inputs = &reference["inputs"];
    for case in reference["cases"].as_array().expect("cases") {
        let outlines = ["pinion_blank", "gear_blank"].map(|name| Some(blank(&inputs[name])));
        with_pair_in(outlines, &case["misalignment"], inputs, |pair| {
            let rolls = rolls(rows_of(case), "thetaP");
            let problem = ContactProblem::new(pair).expect("nothing is unbound");
            let points = pair.surfaces.map(grid);
            let first = problem.find(rolls[10], [&points[0], &points[1]]).expect("the flanks touch");
            let of = problem.engagement(&first, TAU / 19.0, 20, [-2.0, 2.0]);
            let positions: Vec<[f64; 2]> = (0..60)
                .map(|k| {
                    let roll = rolls[k % 20] + (k as f64 / 20.0).floor() * of.pitch - of.pitch;
                    [roll, of.carried(k as isize - 30).expect("a pair carries").lag]
                })
                .collect();
            let pattern = &case["pattern"];
            let shares = ["lengthwise", "profilewise"].map(|name| -> Vec<f64> {
                pattern[name].as_array().expect("shares").iter().map(|share| share.as_f64().expect("a share")).collect()
            });
            assert_eq!(shares.each_ref().map(Vec::len), [17, 9]);
            let nodes = nodes(pair.surfaces[1], &inputs["gear_blank"], [&shares[0], &shares[1]]);
            let gaps = GapProblem::new(pair, 1).expect("nothing is unbound");
            let least = gaps.least(&nodes, &positions, &points[0], 5.0);
            let table =
                pattern["least_gap"].as_array().expect("rows").iter().flat_map(|row| row.as_array().expect("gaps"));
            for ((gap, expected), node) in least.iter().zip(table).zip(&nodes) {
                let Some(gap) = gap else {
                    assert!(expected.is_null(), "{expected} {node:?}");
                    continue;
                };
                let expected = expected.as_f64().expect("a gap");
                // where the table has given up the pair, see above, it has no gaps at some of the nodes
                let is_given_up =
                    |position: usize| position >= 40 && rows_of(case)[position - 40]["pairs"][2]["kind"] == "none";
                let position = positions.iter().position(|at| at[0] == gap.roll).expect("one of them");
                let is_nearer = gap.distance < expected && is_given_up(position);
                assert!((gap.distance - expected).abs() < 1e-9 || is_nearer, "{gap:?} {expected} {node:?}");
                assert!(gap.distance >= 0.0);
            }
            let within = least.iter().flatten().filter(|gap| gap.distance < 0.00635).count();
            assert_eq!(within as u64, pattern["nodes_within"].as_u64().expect("a number"));
        });
    }
}

/// The same contact with the members exchanged: the roll is the second one's, and the lag stays its own.
#[test]
fn a_with_b_is_b_with_a() {
    let reference = reference_json("tca_universal.json");
    let case = &reference["contacts"][1];
    with_universal_pair(&case["misalignment"], &reference["inputs"], |pair| {
        let rolls = rolls(rows_of(case), "thetaP");
        let [(_, forth), (_, back)] = [false, true].map(|is_exchanged| {
            let mut pair = pair.clone();
            if is_exchanged {
                pair.surfaces.reverse();
                pair.placements.reverse();
            }
            path(&pair, &rolls)
        });
        for (a, b) in forth.iter().zip(&back) {
            assert!((a.lag - b.lag).abs() < 1e-13 && difference(&a.position, &b.position) < 1e-10);
            assert!(difference(&a.normal, &b.normal.map(|x| -x)) < 1e-11);
            assert!((a.lag_slopes[1] - b.lag_slopes[1]).abs() < 1e-8, "{:?} {:?}", a.lag_slopes, b.lag_slopes);
            let [k, l] = [a, b].map(|point| point.gap.expect("a regular point"));
            assert!((k.k1 - l.k1).abs() < 1e-11 && (k.k2 - l.k2).abs() < 1e-11);
            // what slides one way seen from the one slides the other way seen from the other; how both move past the point stays
            assert!(difference(&a.sliding, &b.sliding.map(|x| -x)) < 1e-9);
            assert!(difference(&a.entraining, &b.entraining) < 1e-6, "{:?} {:?}", a.entraining, b.entraining);
        }
    });
}

/// A dome that touches a plane at its top: its curvatures are those of the gap, and move neither the point nor the lag.
#[test]
fn what_bends_a_flank_at_its_point_changes_the_gap_alone() {
    let graph = Graph::new();
    let [x, y, u, v, c] = ["x", "y", "u", "v", "c"].map(|name| graph.variable(name));
    let (roll, lag) = (graph.variable("roll"), graph.variable("lag"));
    let zero = graph.constant(0.0);
    let plane = Surface::parametric([x, y], Vector3([x, y, zero]), false);
    let ranges = vec![Range { low: -2.0, high: 2.0 }; 2];
    let plane = BoundSurface::new(&plane, ranges.clone(), &[]);
    // the unit of the setting may be any: c is a curvature in 1/mm, in 1/m, or in 1/km
    for unit in [1.0, 1e-3, 1e-6] {
        let value = 0.1 / unit;
        let dome = Surface::parametric([u, v], Vector3([u, v, (u * u + v * v * 0.5) * c * (0.5 * unit)]), true);
        let [open, bound] =
            [vec![], vec![(c, graph.constant(value))]].map(|values| BoundSurface::new(&dome, ranges.clone(), &values));
        let moved = Step::Translate(Vector3([roll * 0.1, zero, lag + 0.4]));
        let pair = RollingPair {
            surfaces: [&plane, &open],
            placements: [Chain::new(&graph, vec![]), Chain::new(&graph, vec![moved])],
            roll,
            lag: (lag, Range { low: -1.0, high: 1.0 }),
            outlines: [None, None],
            parameters: vec![(c, value)],
        };
        let problem = ContactProblem::new(&pair).expect("nothing is unbound");
        let points = [&plane, &bound].map(grid);
        let point = problem.find(0.5, [&points[0], &points[1]]).expect("the dome comes down on the plane");
        let change = problem.change(&point, &[(0, 1.0)], false).expect("a regular point");
        assert!(change.lag.abs() < 1e-12 && change.moved.iter().flatten().all(|x| x.abs() < 1e-12), "{change:?}");
        // the gap is as bent as the dome; differences leave ten digits
        let [k1, k2] = change.gap.expect("flank on flank").map(|change| change / unit);
        assert!((k1 - 1.0).abs() < 1e-9 && (k2 - 0.5).abs() < 1e-9, "{unit}: {k1} {k2}");
    }
}

/// Two flanks that face the same way, and a pair whose lag moves nothing along the normal, are told.
#[test]
fn what_cannot_touch_is_told() {
    let graph = Graph::new();
    let [x, y, u, v] = ["x", "y", "u", "v"].map(|name| graph.variable(name));
    let (roll, lag) = (graph.variable("roll"), graph.variable("lag"));
    let plane = Surface::parametric([x, y], Vector3([x, y, graph.constant(0.0)]), false);
    let dome = |flipped: bool| Surface::parametric([u, v], Vector3([u, v, (u * u + v * v) * 0.05]), flipped);
    let ranges = vec![Range { low: -2.0, high: 2.0 }; 2];
    let plane = BoundSurface::new(&plane, ranges.clone(), &[]);
    let found = |flipped: bool, moved: Vector3<'_>, start: f64| {
        let dome = BoundSurface::new(&dome(flipped), ranges.clone(), &[]);
        let lifted = Step::Translate(Vector3([roll * 0.1, graph.constant(0.0), graph.constant(start)]));
        let pair = RollingPair {
            surfaces: [&plane, &dome],
            placements: [Chain::new(&graph, vec![]), Chain::new(&graph, vec![lifted, Step::Translate(moved)])],
            roll,
            lag: (lag, Range { low: -1.0, high: 1.0 }),
            outlines: [None, None],
            parameters: Vec::new(),
        };
        let problem = ContactProblem::new(&pair).expect("nothing is unbound");
        let points = pair.surfaces.map(grid);
        problem.find(0.5, [&points[0], &points[1]])
    };
    let zero = graph.constant(0.0);
    let up = Vector3([zero, zero, lag]);
    let touching = found(true, up, 0.4).expect("the dome comes down on the plane");
    assert!((touching.lag + 0.4).abs() < 1e-13 && touching.state == Some(ContactState::Touching), "{touching:?}");
    let [long, short] = touching.ellipse(0.00635).expect("a contact");
    assert!((long - short).abs() < 1e-9 && (long - (2.0 * 0.00635 / 0.1f64).sqrt()).abs() < 1e-9);
    assert_eq!(found(false, up, 0.4).expect_err("the dome hangs"), NoContact::SameSide);
    assert_eq!(
        found(true, Vector3([lag, zero, zero]), -0.05).expect_err("the lag shifts it sideways"),
        NoContact::Locked
    );
    assert_eq!(found(true, up, 5.0).expect_err("too far away"), NoContact::Apart);
}
