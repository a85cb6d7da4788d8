//! Pairs of the library: where their machines place both members, and what touches where.

use std::f64::consts::TAU;

use flank_chain_dsl::{Contact, Job};
use flank_expr::geometry::Chain;
use flank_expr::{Expr, Graph, ScalarEvaluator, Tape};
use flank_solver::{ContactPoint, ContactProblem};
use flank_tests::pairs::with_pair;
use flank_tests::{difference, job, job_of_text, number, reference_json};
use nalgebra::{Matrix4, Vector3};
use serde_json::Value;

fn along(x: f64, y: f64, z: f64) -> Matrix4<f64> {
    Matrix4::new_translation(&Vector3::new(x, y, z))
}

fn about(axis: Vector3<f64>, angle: f64) -> Matrix4<f64> {
    Matrix4::new_rotation(axis * angle)
}

fn about_x(angle: f64) -> Matrix4<f64> {
    about(Vector3::x(), angle)
}

fn about_y(angle: f64) -> Matrix4<f64> {
    about(Vector3::y(), angle)
}

fn about_z(angle: f64) -> Matrix4<f64> {
    about(Vector3::z(), angle)
}

/// The errors of a pair's axes, in the order of the machine.
fn errors<'c>(contact: &'c Contact<'_>) -> Vec<&'c str> {
    contact.errors.iter().map(|axis| axis.name.as_str()).collect()
}

/// Where a chain leads with these values of the roll, the unknown and the errors of the axes.
fn placed<'g>(job: &Job<'g>, contact: &Contact<'g>, chain: &Chain<'g>, values: &[f64]) -> Matrix4<f64> {
    let pose = chain.substituted(&job.bindings()).pose().matrix4();
    let inputs: Vec<Expr<'_>> = [contact.roll.variable, contact.lag.variable]
        .into_iter()
        .chain(contact.errors.iter().map(|axis| axis.variable))
        .collect();
    let entries: Vec<Expr<'_>> = pose.into_iter().flatten().collect();
    let mut out = [0.0; 16];
    ScalarEvaluator::new(&Tape::new(&entries, &inputs).expect("all bound")).run(values, &mut out);
    Matrix4::from_row_slice(&out)
}

/// Asserts that the machine of a spec's contact places its members as two products of matrices do, with errors of all its axes.
/// Lengths of some 100 mm leave 1e-12 mm.
fn assert_placed(spec: &str, axes: &[&str], expected: impl Fn(f64, f64, &[f64]) -> [Matrix4<f64>; 2]) {
    let graph = Graph::new();
    let job = job(&graph, &format!("specs/pairs/{spec}.chain"), &[]);
    let contact = job.contacts.first().expect("a contact");
    assert_eq!(errors(contact), axes, "{spec}");
    let wrong: Vec<f64> = (0..axes.len()).map(|k| 0.037 * (k as f64 + 1.3) * [1.0, -1.0][k % 2]).collect();
    let (roll, lag) = (0.4321, -0.0123);
    let values = [&[roll, lag], &wrong[..]].concat();
    for (chain, expected) in contact.placements.iter().zip(expected(roll, lag, &wrong)) {
        let found = placed(&job, contact, chain, &values);
        let off = difference(found.as_slice(), expected.as_slice());
        assert!(off < 1e-12, "{spec}: off by {off:e}\n{found}{expected}");
    }
}

#[test]
fn parallel_shafts_are_placed_as_the_helical_table_has_them() {
    let half = 0.5 * TAU;
    let axes = ["m.A", "m.G", "m.I", "m.D", "m.pinion", "m.gear"];
    let place = |distance: f64, e: &[f64], [pinion, gear]: [f64; 2]| {
        let shaft = along(distance + e[0], 0.0, 0.0) * about_y(e[2]) * about_x(e[3]) * along(0.0, 0.0, e[1]);
        [about_z(pinion + e[4]), shaft * about_z(gear + e[5])]
    };
    assert_placed("spur_pair", &axes, |roll, lag, e| {
        place(91.5, e, [roll, half - half / 37.0 - 24.0 / 37.0 * roll + lag])
    });
    assert_placed("helical_pair", &axes, |roll, lag, e| {
        let distance = 4.0 * 74.0 / (2.0 * 18_f64.to_radians().cos());
        place(distance, e, [roll - half / 27.0, half + half / 47.0 - 27.0 / 47.0 * roll + lag])
    });
    assert_placed("internal_pair", &axes, |roll, lag, e| {
        place(61.5, e, [half + roll, half + half / 62.0 + 21.0 / 62.0 * roll + lag])
    });
}

#[test]
fn a_rack_slides_square_to_the_line_of_centres() {
    assert_placed("rack_and_pinion", &["m.A", "m.D", "m.I", "m.pinion", "m.rack"], |roll, lag, e| {
        let guide = along(36.0 + e[0], 0.0, 0.0) * about_x(e[1]) * about_y(e[2]);
        [about_z(roll + e[3]), guide * along(0.0, 36.0 * roll + lag + e[4], 0.0)]
    });
}

#[test]
fn crossed_shafts_are_placed_as_the_table_of_screw_gears_has_them() {
    let axes = ["m.A", "m.P", "m.G", "m.S", "m.first", "m.second"];
    assert_placed("worm_and_wheel", &axes, |roll, lag, e| {
        let wheel = along(105.0 + e[0], 0.0, 0.0) * about_x(-0.25 * TAU + e[3]) * along(0.0, 0.0, e[2]);
        let [first, second] = [0.5 * TAU + roll, 0.5 * TAU - roll / 40.0 + lag];
        [along(0.0, 0.0, e[1]) * about_z(first + e[4]), wheel * about_z(second + e[5])]
    });
}

#[test]
fn bevel_gears_are_placed_as_the_published_pair() {
    let axes = ["m.E", "m.P", "m.G", "m.S", "m.pinion", "m.gear"];
    let place = |[angle, offset]: [f64; 2], e: &[f64], [pinion, gear]: [f64; 2]| {
        let shaft = along(0.0, offset + e[0], 0.0) * about_y(angle + e[3]) * about_z(0.5 * TAU) * along(0.0, 0.0, e[2]);
        [along(0.0, 0.0, e[1]) * about_z(pinion + e[4]), shaft * about_z(-(gear + e[5]))]
    };
    assert_placed("bevel_19x62", &axes, |roll, lag, e| {
        place([95_f64.to_radians(), 0.0], e, [roll, 19.0 / 62.0 * roll + lag])
    });
    assert_placed("face_gear_pair", &axes, |roll, lag, e| {
        place([0.25 * TAU, 0.0], e, [0.5 * TAU / 23.0 + roll, 23.0 / 108.0 * roll + lag])
    });
    assert_placed("hypoid_pair", &axes, |roll, lag, e| {
        let mean = -13_f64.to_radians();
        place([0.25 * TAU, 25.0], e, [41.0 / 13.0 * mean + roll, mean + 13.0 / 41.0 * roll + lag])
    });
}

/// The contact of a job's flanks, its pair mounted with errors, at rising roll positions.
fn path(job: &Job<'_>, wrong: &[(&str, f64)], rolls: &[f64]) -> Vec<ContactPoint> {
    let path = with_pair(job, wrong, false, |pair, points| {
        ContactProblem::new(pair).expect("nothing is unbound").path(rolls, points)
    });
    assert_eq!(path.refused, None);
    path.points.into_iter().map(|point| point.expect("it touches all over the roll")).collect()
}

/// The rows of the table in which flank touches flank, of all pairs of teeth, by the roll of the first pair.
fn flank_rows(case: &Value) -> Vec<(f64, &Value)> {
    let rows = case["rows"].as_array().expect("rows");
    let of_row = |row: &'_ Value| number(row, "thetaP");
    let pairs = rows.iter().flat_map(|row| {
        let pairs = row["pairs"].as_array().expect("pairs").iter();
        pairs.map(move |pair| (of_row(row) + TAU / 19.0 * number(pair, "j"), pair))
    });
    let mut flanks: Vec<(f64, &Value)> = pairs.filter(|(_, pair)| pair["kind"] == "flank").collect();
    flanks.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    flanks
}

/// contact_edges_a.md states the lag to 1e-11 rad and points to 1e-9 mm; the spec's settings are the table's to the last digit but for
/// angles in degrees.
#[test]
fn the_published_pair_touches_where_the_table_has_it_mounted_right_and_wrong() {
    let reference = reference_json("contact_edges_a.json");
    for case in reference["cases"].as_array().expect("cases") {
        let graph = Graph::new();
        let job = job(&graph, "specs/pairs/bevel_19x62.chain", &[]);
        let wrong = ["E", "P", "G", "S"].map(|axis| number(&case["misalignment"], &format!("d{axis}")));
        let wrong: Vec<(&str, f64)> = ["m.E", "m.P", "m.G", "m.S"].into_iter().zip(wrong).collect();
        let rows = flank_rows(case);
        assert!(rows.len() > 30, "most of 60 rows: {}", rows.len());
        let rolls: Vec<f64> = rows.iter().map(|(roll, _)| *roll).collect();
        for (point, (_, row)) in path(&job, &wrong, &rolls).iter().zip(&rows) {
            assert!((point.lag - number(row, "TE")).abs() < 1e-10, "{point:?} {row}");
            for (member, name) in ["pinion_zR", "gear_zR"].into_iter().enumerate() {
                let [x, y, z] = point.in_members[member];
                let asked = [0, 1].map(|k| row[name][k].as_f64().expect("a number"));
                assert!(difference(&[z, x.hypot(y)], &asked) < 1e-8, "{point:?} {row}");
            }
        }
    }
}

/// Hobbed with crowning along the face, a helical pinion is an exact involute in its middle section, where it touches: it turns its gear
/// evenly. So does an involute pinion its face gear, at the radius where the gear's module is its own.
#[test]
fn involute_pinions_turn_their_gears_evenly() {
    for spec in ["helical_pair", "face_gear_pair"] {
        let graph = Graph::new();
        let job = job(&graph, &format!("specs/pairs/{spec}.chain"), &[]);
        let rolls: Vec<f64> = (-4..=4).map(|k| 0.03 * f64::from(k)).collect();
        for point in path(&job, &[], &rolls) {
            assert!(point.lag.abs() < 1e-11, "{spec}: {point:?}");
        }
    }
}

/// A gear touches the pinion that it envelopes along lines and turns it evenly; so does a wheel the worm that is as large as its hob.
#[test]
fn what_a_flank_envelopes_it_touches_along_lines_without_error() {
    for (spec, set, [from, to]) in
        [("conjugate_pair", None, [-1.0, 1.0]), ("worm_and_wheel", Some(("oversize", "0 mm")), [-1.5, 1.5])]
    {
        let graph = Graph::new();
        let job = job(&graph, &format!("specs/pairs/{spec}.chain"), set.as_slice());
        let rolls: Vec<f64> = (0..=100).map(|k| from + (to - from) * 0.01 * f64::from(k)).collect();
        let path = with_pair(&job, &[], false, |pair, points| {
            ContactProblem::new(pair).expect("nothing is unbound").path(&rolls, points)
        });
        // a point of a line is followed until it leaves the flanks
        let found: Vec<ContactPoint> = path.points.into_iter().flatten().collect();
        assert!(found.len() > 10, "{spec}: {} of {}", found.len(), rolls.len());
        for point in found {
            assert!(point.lag.abs() < 1e-11, "{spec}: {point:?}");
            let gap = point.gap.expect("a regular point");
            assert!(gap.k1 > 0.01 && gap.k2.abs() < 1e-9 * gap.k1, "{spec}: {gap:?}");
        }
    }
}

/// A worm is a screw: pushed along its axis it turns the wheel as if it had been turned by as much as the lead asks.
#[test]
fn a_worm_pushed_along_its_axis_turns_its_wheel_as_if_it_were_turned() {
    let graph = Graph::new();
    let job = job(&graph, "specs/pairs/worm_and_wheel.chain", &[]);
    let value = |name: &str| job.parameters.iter().find(|p| p.name == name).expect("a parameter").value;
    let pushed = 0.3;
    // right-handed: a turn forwards carries the thread backwards
    let as_turn = -pushed / (value("module") * value("starts") / 2.0);
    let rolls: Vec<f64> = (-3..=5).map(|k| 0.5 * f64::from(k)).collect();
    let turned: Vec<f64> = rolls.iter().map(|roll| roll + as_turn).collect();
    let by_turn = path(&job, &[], &turned);
    for (pushed, turned) in path(&job, &[("m.P", pushed)], &rolls).iter().zip(&by_turn) {
        let follows = -value("starts") / value("teeth") * as_turn;
        assert!((pushed.lag - turned.lag - follows).abs() < 1e-11, "{pushed:?} {turned:?}");
        assert!(difference(&pushed.position, &turned.position) < 1e-8, "{pushed:?} {turned:?}");
    }
}

/// Which member is named first changes the sense of the normal and nothing else.
#[test]
fn a_hypoid_pair_is_the_same_from_either_side() {
    let library = [
        "functions/bevel.chain",
        "machines/bevel_pair.chain",
        "machines/cradle.chain",
        "tools/face_mill.chain",
        "pairs/hypoid_pair.chain",
    ];
    let text = flank_tests::library(&library);
    let [one, other] = ["pinion_concave with gear_convex", "gear_convex with pinion_concave"];
    assert!(text.contains(one));
    let rolls: Vec<f64> = (-5..=3).map(|k| 0.08 * f64::from(k)).collect();
    let [here, there] = [text.clone(), text.replace(one, other)].map(|text| {
        let graph = Graph::new();
        path(&job_of_text(&graph, &text), &[], &rolls)
    });
    for (here, there) in here.iter().zip(&there) {
        assert!((here.lag - there.lag).abs() < 1e-12, "{here:?} {there:?}");
        assert!(difference(&here.position, &there.position) < 1e-9, "{here:?} {there:?}");
        assert!(difference(&here.normal, &there.normal.map(|n| -n)) < 1e-11, "{here:?} {there:?}");
        let [a, b] = [here, there].map(|point| point.gap.as_ref().expect("a regular point"));
        assert!(difference(&[a.k1, a.k2], &[b.k1, b.k2]) < 1e-10, "{a:?} {b:?}");
    }
}
