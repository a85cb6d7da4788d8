//! Principal curvatures and contact lines against independent tables: their authors differenced re-solved neighbours at 50
//! digits.
//!
//! The tables measure by the normal out of the tool: positive where the surface bends towards it, which is where the gear is
//! convex, as flank counts.

use flank_expr::Graph;
use flank_tests::{Evaluated, difference, evaluated, job, job_named, number, points, reference_json, reversed, vector};
use serde_json::Value;

/// Position, mm, normal, and principal directions where they are told apart.
const BOUND: f64 = 1e-9;
/// Of curvatures, 1/mm: the tables' unknowns carry 17 digits, and second derivatives of gears of 100 mm lose four.
const OF_CURVATURE: f64 = 1e-12;

/// All rows of a table on one surface of a job; `keys` name the unknowns in the table.
fn meets(spec: &str, job: &str, surface: &str, rows: &[&Value], keys: &[&str]) {
    let graph = Graph::new();
    let job = job_named(&graph, &format!("tests/machines/{spec}.chain"), job);
    assert!(!rows.is_empty(), "{surface} has rows");
    let unknowns: Vec<Vec<f64>> = rows.iter().map(|row| keys.iter().map(|key| unknown(row, key)).collect()).collect();
    for (k, (row, point)) in rows.iter().zip(evaluated(&job, surface, &unknowns)).enumerate() {
        meets_row(row, &point, &format!("{spec}, {surface}, row {k}"));
    }
}

/// An unknown by its key in the table; what the table does not list was held at zero.
fn unknown(row: &Value, key: &str) -> f64 {
    if key == "0" { 0.0 } else { number(row, key) }
}

fn meets_row(row: &Value, point: &Evaluated, what: &str) {
    assert!(difference(&point.position, &vector(row, "p")) < BOUND, "{what}: {:?}", point.position);
    // out of the first tool: into the work of an envelope, out of the work of an envelope of an envelope
    let same_side = difference(&point.normal, &vector(row, "n")) < 1.0;
    let normal = if same_side { vector(row, "n") } else { reversed(vector(row, "n")) };
    let turned = difference(&point.normal, &normal);
    assert!(turned < BOUND, "{what}: normal off by {turned:e}");
    assert!(point.residual < BOUND, "{what}: residual {:e}", point.residual);
    let found = point.geometry.curvature.expect("a regular point").principal();
    let (k1, k2) = (number(row, "k1"), number(row, "k2"));
    let (wanted, keys) = if same_side { ([-k2, -k1], ["d2", "d1"]) } else { ([k1, k2], ["d1", "d2"]) };
    let off = difference(&[found.k1, found.k2], &wanted);
    assert!(off < OF_CURVATURE, "{what}: curvatures {found:?} are off by {off:e}");
    let directions = found.directions.expect("the curvatures differ");
    for (direction, key) in directions.iter().zip(keys) {
        assert!(apart(direction, &vector(row, key)) < BOUND, "{what}: {key} {direction:?}");
    }
    for velocity in &point.geometry.contact.sliding {
        let velocity = velocity.expect("finite");
        let out: f64 = velocity.iter().zip(&point.normal).map(|(v, n)| v * n).sum();
        assert!(out.abs() < BOUND, "{what}: the tool slides {out:e} mm out of the tangent plane");
    }
    if row.get("t").is_some() {
        let line = point.geometry.contact.line.expect("one motion");
        assert!(apart(&line, &vector(row, "t")) < BOUND, "{what}: contact line {line:?}");
        let induced = point.geometry.contact.induced.expect("a tool with a surface");
        let along = induced.along(line).expect("a tangent");
        assert!(along.abs() < OF_CURVATURE, "{what}: the gap's curvature along the contact line is {along:e}");
    }
}

/// How far two directions are apart whose signs are open.
fn apart(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    difference(a, b).min(difference(a, &reversed(*b)))
}

fn rows<'v>(reference: &'v Value, table: &str, of: Option<(&str, f64)>) -> Vec<&'v Value> {
    let all = reference[table].as_array().expect("a table");
    all.iter().filter(|row| of.is_none_or(|(key, value)| number(row, key) == value)).collect()
}

/// The same through a spec of the library, which is solved first.
fn library_meets(spec: &str, surface: &str, coordinates: [&str; 2], rows: &[&Value], keys: [&str; 2]) {
    let graph = Graph::new();
    let job = job(&graph, spec, &[]);
    let targets: Vec<[f64; 2]> = rows.iter().map(|row| keys.map(|key| number(row, key))).collect();
    let solved = points(&job, surface, coordinates, &targets);
    let unknowns: Vec<Vec<f64>> = solved.into_iter().map(|point| point.unknowns).collect();
    for (k, (row, point)) in rows.iter().zip(evaluated(&job, surface, &unknowns)).enumerate() {
        meets_row(row, &point, &format!("{spec}, {surface}, row {k}"));
    }
}

const SIDES: [(&str, f64); 2] = [("plus", 1.0), ("minus", -1.0)];

#[test]
fn generated_spiral_bevel_flanks_and_fillets() {
    let reference = reference_json("cradle_flank.json");
    for side in ["concave", "convex"] {
        let job = format!("generated_{side}");
        meets("cradle", &job, "flank", &rows(&reference, side, None), &["u", "v", "psi"]);
        meets("cradle", &job, "fillet", &rows(&reference, &format!("{side}_fillet"), None), &["u", "v", "psi"]);
    }
}

#[test]
fn formate_flanks_and_fillets() {
    let reference = reference_json("formate_flank.json");
    for side in ["concave", "convex"] {
        let job = format!("formate_{side}");
        meets("cradle", &job, "flank", &rows(&reference, side, None), &["u", "v"]);
        meets("cradle", &job, "fillet", &rows(&reference, &format!("{side}_fillet"), None), &["u", "v"]);
    }
}

#[test]
fn spur_gear_of_the_library() {
    let reference = reference_json("spur_rack.json");
    let spec = "specs/hobbing/spur_gear.chain";
    for (side, sigma) in SIDES {
        let flank = rows(&reference, "flank_rows", Some(("sigma", sigma)));
        library_meets(spec, &format!("flank_{side}"), ["z", "rho"], &flank, ["z", "rho"]);
        let fillet = rows(&reference, "fillet_rows", Some(("sigma", sigma)));
        library_meets(spec, &format!("fillet_{side}"), ["theta", "v"], &fillet, ["u", "v"]);
    }
}

#[test]
fn helical_gear_of_the_library() {
    let reference = reference_json("helical_zi_hob.json");
    let spec = "specs/hobbing/helical_gear.chain";
    for (surface, sigma) in [("lower_flank", 1.0), ("upper_flank", -1.0)] {
        let rows = rows(&reference, "rows", Some(("sigma", sigma)));
        library_meets(spec, surface, ["z", "rho"], &rows, ["z", "rho"]);
    }
}

#[test]
fn hobbed_gears() {
    let cases = [
        ("beveloid", "beveloid"),
        ("crowned", "helical_crowned"),
        ("crowned_quartic", "helical_crowned_quartic"),
        ("six_axis", "helical_six_axis"),
    ];
    for (job, table) in cases {
        let reference = reference_json(&format!("{table}.json"));
        for (surface, sigma) in SIDES {
            meets("hobbed", job, surface, &rows(&reference, "rows", Some(("sigma", sigma))), &["u", "v", "B", "Z"]);
        }
    }
}

#[test]
fn worm_wheel() {
    let reference = reference_json("worm_wheel.json");
    for (surface, sigma) in SIDES {
        let rows = rows(&reference, "rows", Some(("sigma", sigma)));
        meets("worm_wheel", "worm_wheel", surface, &rows, &["u", "v", "B"]);
    }
}

#[test]
fn grinding_discs() {
    let reference = reference_json("grinding_disc.json");
    for job in ["zi", "zn"] {
        for (side, s) in SIDES {
            let table = format!("{}_rows", job.to_uppercase());
            let rows = rows(&reference, &table, Some(("s", s)));
            meets("grinding_disc", job, &format!("{side}_wheel"), &rows, &["u", "v", "0"]);
        }
    }
}

#[test]
fn shaped_gear_and_face_gear() {
    let reference = reference_json("shaper.json");
    for job in ["gear", "face_gear"] {
        for (surface, sigma) in SIDES {
            let rows = rows(&reference, &format!("{job}_rows"), Some(("sigma", sigma)));
            meets("shaper", job, surface, &rows, &["u", "v", "B"]);
        }
    }
}

#[test]
fn skived_flanks_of_a_surface_and_of_an_edge() {
    let reference = reference_json("skiving.json");
    for (side, sigma) in SIDES {
        let of_surface = rows(&reference, "surface_rows", Some(("sigma", sigma)));
        meets("skiving", "skiving", side, &of_surface, &["u", "v", "B", "Z"]);
        let of_edge = rows(&reference, "edge_rows", Some(("sigma", sigma)));
        meets("skiving", "skiving", &format!("{side}_edge"), &of_edge, &["u", "B", "Z"]);
    }
}

#[test]
fn envelopes_of_envelopes() {
    let reference = reference_json("double_envelope.json");
    let keys = ["u", "v", "phi", "B"];
    for (surface, sigma) in SIDES {
        let rows = rows(&reference, "rack_shaper_gear_rows", Some(("sigma", sigma)));
        meets("double_envelope", "gear_of_shaper", surface, &rows, &keys);
    }
    meets("double_envelope", "worm_wheel_of_plane", "wheel", &rows(&reference, "hourglass_rows", None), &keys);
}
