//! Principal curvatures and contact lines against independent tables: their authors differenced re-solved neighbours at 50
//! digits.
//!
//! The tables measure by the normal out of the tool: positive where the surface bends towards it, which is where the gear is
//! convex, as flank counts.

use flank_chain_dsl::Job;
use flank_expr::Graph;
use flank_solver::{Outcome, SurfaceGeometry, SurfacePoint, SurfaceProblem};
use flank_tests::{
    Evaluated, bound, difference, evaluated, grid, job, job_named, number, points, reference_json, reversed, vector,
};
use serde_json::{Value, json};

/// Position, mm, normal, and principal directions where they are told apart.
const BOUND: f64 = 1e-9;
/// Of curvatures, 1/mm: the tables' unknowns carry 17 digits, and second derivatives of gears of 100 mm lose four.
const OF_CURVATURE: f64 = 1e-12;

/// All rows of a table on one surface of a job; `keys` name the unknowns in the table.
fn meets(spec: &str, job: &str, surface: &str, rows: &[&Value], keys: &[&str]) {
    let graph = Graph::new();
    let job = job_named(&graph, &format!("specs/{spec}.chain"), job, &[]);
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
    // some tables have the motion under the key of the others' tangent
    if let Some(tangent) = ["t", "t_dir"].into_iter().find(|key| row[key].is_array()) {
        let line = point.geometry.contact.line.expect("one motion");
        assert!(apart(&line, &vector(row, tangent)) < BOUND, "{what}: contact line {line:?}");
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

/// The same through a job of the library, which is solved first at two coordinates that the table lists.
fn library_meets(
    of: (&str, &str),
    set: &[(&str, &str)],
    surface: &str,
    coordinates: [(&str, &str); 2],
    rows: &[&Value],
) {
    let (spec, name) = of;
    let graph = Graph::new();
    let job = job_named(&graph, &format!("specs/hobbing/{spec}.chain"), name, set);
    let targets: Vec<[f64; 2]> = rows.iter().map(|row| coordinates.map(|(_, key)| number(row, key))).collect();
    // a table is a lattice: its second coordinate runs first, and starts again where the first one changes
    let columns = targets.iter().take_while(|target| target[0] == targets[0][0]).count();
    let solved = grid(&job, surface, coordinates.map(|(coordinate, _)| coordinate), &targets, columns);
    solved_meet(&job, surface, &solved, rows);
}

fn solved_meet(job: &Job<'_>, surface: &str, solved: &[SurfacePoint], rows: &[&Value]) {
    assert!(!rows.is_empty(), "{surface} has rows");
    assert!(solved.iter().all(|point| point.outcome == Outcome::Solved), "{}, {surface}: {solved:?}", job.name);
    let unknowns: Vec<Vec<f64>> = solved.iter().map(|point| point.unknowns.clone()).collect();
    for (k, (row, point)) in rows.iter().zip(evaluated(job, surface, &unknowns)).enumerate() {
        meets_row(row, &point, &format!("{}, {surface}, row {k}", job.name));
    }
}

const Z_AND_RADIUS: [(&str, &str); 2] = [("z", "z"), ("rho", "rho")];

const SIDES: [(&str, f64); 2] = [("plus", 1.0), ("minus", -1.0)];

/// A row in a work frame that the library's cradle has turned half round against the table's.
fn half_turned(row: &Value) -> Value {
    let mut turned = row.clone();
    for key in ["p", "n", "d1", "d2", "t"].into_iter().filter(|key| row.get(key).is_some()) {
        let [x, y, z] = vector(row, key);
        turned[key] = json!([-x, -y, z]);
    }
    turned
}

/// All rows of tables of a cradle on surfaces of the library, found where they lie in the axial section. The tables know nothing of
/// the turn of the work between two cuts.
fn cradle_meets(spec: &str, set: &[(&str, &str)], reference: &Value, tables: &[(&str, &str)]) {
    for (table, surface) in tables {
        let turned: Vec<Value> = rows(reference, table, None).into_iter().map(half_turned).collect();
        let in_section = |row: &Value| {
            let [x, y, z] = vector(row, "p");
            [z, x.hypot(y)]
        };
        let targets: Vec<[f64; 2]> = turned.iter().map(in_section).collect();
        let graph = Graph::new();
        let job = job(&graph, &format!("specs/bevel/{spec}.chain"), set);
        let solved = points(&job, surface, ["z", "rho"], &targets);
        solved_meet(&job, surface, &solved, &turned.iter().collect::<Vec<_>>());
    }
}

#[test]
fn generated_spiral_bevel_flanks_and_fillets() {
    let tables = ["concave", "concave_fillet", "convex", "convex_fillet"].map(|name| (name, name));
    cradle_meets("tilted_pinion", &[], &reference_json("cradle_flank.json"), &tables);
}

/// The flank that the free-form machine cuts as well.
#[test]
fn a_flank_of_the_free_form_machine() {
    cradle_meets("tilted_pinion", &[], &reference_json("freeform.json"), &[("surface_rows", "concave")]);
}

#[test]
fn formate_flanks_and_fillets() {
    let tables = ["concave", "concave_fillet", "convex", "convex_fillet"].map(|name| (name, name));
    cradle_meets("formate_gear", &[], &reference_json("formate_flank.json"), &tables);
}

#[test]
fn face_hobbed_flanks() {
    let mut reference = reference_json("face_hobbing.json");
    for table in ["concave", "convex"] {
        let rows = reference[table].as_array_mut().expect("a table");
        // the line at a fixed roll; an edge that moves with both motions has only a point of contact
        rows.iter_mut().for_each(|row| drop(row.as_object_mut().expect("a row").remove("t")));
    }
    let in_the_table = [("n.spindle_start", "90 deg + 3.9046571904813296 rad")];
    cradle_meets("face_hobbed_pinion", &in_the_table, &reference, &[("concave", "concave"), ("convex", "convex")]);
}

#[test]
fn spur_gear() {
    let reference = reference_json("spur_rack.json");
    let spec = ("spur_gear", "spur_gear");
    for (side, sigma) in SIDES {
        let flank = rows(&reference, "flank_rows", Some(("sigma", sigma)));
        library_meets(spec, &[], &format!("flank_{side}"), Z_AND_RADIUS, &flank);
        let fillet = rows(&reference, "fillet_rows", Some(("sigma", sigma)));
        library_meets(spec, &[], &format!("fillet_{side}"), [("theta", "u"), ("v", "v")], &fillet);
    }
}

/// The tables' radial feeds are those of a gear that is hollow along the face: negative crowning.
#[test]
fn hobbed_gears() {
    let quartic = [("crowning", "-0.0512 mm"), ("crowning_4", "-0.0262144 mm")];
    for (spec, set, table) in [
        ("helical_gear", &[][..], "helical_zi_hob"),
        ("crowned_gear", &[("crowning", "-0.064 mm")], "helical_crowned"),
        ("crowned_gear_quartic", &quartic, "helical_crowned_quartic"),
        ("beveloid", &[("m.center_distance", "85 mm")], "beveloid"),
        ("chang_tsay_nagata", &[], "helical_six_axis"),
    ] {
        let reference = reference_json(&format!("{table}.json"));
        for (surface, sigma) in [("lower_flank", 1.0), ("upper_flank", -1.0)] {
            let rows = rows(&reference, "rows", Some(("sigma", sigma)));
            library_meets((spec, spec), set, surface, Z_AND_RADIUS, &rows);
        }
    }
}

/// By the hob of the worm's own size, as the conjugate of the worm, and by one tooth of it in tangential feed.
#[test]
fn worm_wheel() {
    let reference = reference_json("worm_wheel.json");
    for (side, sigma) in [("upper", 1.0), ("lower", -1.0)] {
        let rows = rows(&reference, "rows", Some(("sigma", sigma)));
        let radial = ("worm_wheel", "worm_wheel");
        library_meets(radial, &[("oversize", "0 mm")], &format!("{side}.flank"), Z_AND_RADIUS, &rows);
        library_meets(radial, &[], &format!("conjugate_{side}.flank"), Z_AND_RADIUS, &rows);
    }
}

#[test]
fn elliptical_gears() {
    for (spec, table, coordinates) in [
        ("elliptical_gear", "elliptical_gear", [("u", "u"), ("v", "v")]),
        ("elliptical_gear_hobbed", "elliptical_gear_hobbed", [("xi", "u"), ("z", "z")]),
    ] {
        let reference = reference_json(&format!("{table}.json"));
        let mut met = 0;
        for space in 0..36 {
            for (side, sigma) in SIDES {
                let hobbed = spec.ends_with("hobbed");
                let surface = match (hobbed, side) {
                    (false, side) => format!("flank_{side}"),
                    (true, "plus") => "lower_flank".to_owned(),
                    (true, _) => "upper_flank".to_owned(),
                };
                let mut rows = rows(&reference, "rows", Some(("sigma", sigma)));
                rows.retain(|row| number(row, "k") == f64::from(space));
                if !rows.is_empty() {
                    let set = [("space", space.to_string())];
                    library_meets(
                        (spec, spec),
                        &set.each_ref().map(|(n, v)| (*n, v.as_str())),
                        &surface,
                        coordinates,
                        &rows,
                    );
                    met += rows.len();
                }
            }
        }
        assert_eq!(met, reference["rows"].as_array().expect("a table").len(), "every row is met: {spec}");
    }
}

#[test]
fn grinding_discs() {
    let reference = reference_json("grinding_disc.json");
    for job in ["zi", "zn"] {
        for (side, s) in SIDES {
            let table = format!("{}_rows", job.to_uppercase());
            let rows = rows(&reference, &table, Some(("s", s)));
            meets("grinding/thread_wheel", job, &format!("{side}_wheel"), &rows, &["u", "v", "0"]);
        }
    }
}

#[test]
fn shaped_gear_and_face_gear() {
    let reference = reference_json("shaper.json");
    for (side, sigma) in SIDES {
        let surface = format!("flank_{side}");
        let external = rows(&reference, "gear_rows", Some(("sigma", sigma)));
        library_meets(("shaped_gear", "shaped_gear"), &[], &surface, Z_AND_RADIUS, &external);
        let face = rows(&reference, "face_gear_rows", Some(("sigma", sigma)));
        library_meets(("face_gear", "face_gear"), &[], &surface, Z_AND_RADIUS, &face);
    }
}

/// The flank's own points are cut away by the unrelieved flank, so that they are not solved but only evaluated.
#[test]
fn skived_flanks_of_a_surface_and_of_an_edge() {
    let reference = reference_json("skiving.json");
    let graph = Graph::new();
    let name = "skived_internal_gear";
    let job = job_named(&graph, &format!("specs/hobbing/{name}.chain"), name, &[]);
    for (side, sigma) in SIDES {
        let of_surface = rows(&reference, "surface_rows", Some(("sigma", sigma)));
        let lead = number(&reference["inputs"], "p0");
        let keys = |row: &Value| vec![number(row, "u"), lead * number(row, "v"), number(row, "B"), number(row, "Z")];
        let unknowns: Vec<Vec<f64>> = of_surface.iter().map(|row| keys(row)).collect();
        for (row, point) in of_surface.iter().zip(evaluated(&job, &format!("flank_{side}"), &unknowns)) {
            meets_row(row, &point, side);
        }
        let of_edge = rows(&reference, "edge_rows", Some(("sigma", sigma)));
        library_meets((name, name), &[], &format!("edge_{side}"), Z_AND_RADIUS, &of_edge);
    }
}

#[test]
fn envelopes_of_envelopes() {
    let reference = reference_json("double_envelope.json");
    let keys = ["u", "v", "phi", "B"];
    for (surface, sigma) in SIDES {
        let rows = rows(&reference, "rack_shaper_gear_rows", Some(("sigma", sigma)));
        meets("double_envelope/shaped_ring_gear", "shaped_ring_gear", surface, &rows, &keys);
    }
    let hourglass = rows(&reference, "hourglass_rows", None);
    meets("double_envelope/hourglass_worm_wheel", "hourglass_worm_wheel", "wheel", &hourglass, &keys);
}

/// Curvatures in lanes, by the adjugate of the equations, against those of each point alone, by the constraints' null space.
#[test]
fn many_points_at_once_bend_as_one_by_one() {
    for spec in ["specs/bevel/pinion_19x62.chain", "specs/hobbing/helical_gear.chain", "specs/hobbing/spur_gear.chain"]
    {
        let graph = Graph::new();
        let job = job(&graph, spec, &[]);
        for surface in job.surfaces.iter().filter(|surface| surface.sample.is_some()) {
            let sample = surface.sample.as_ref().expect("it has one");
            let coordinates = sample.functions();
            let bound = bound(&job, surface);
            let problem = SurfaceProblem::with_curvatures(&bound, coordinates);
            let problem = problem.expect("nothing is unbound");
            let (points, _) = problem.solve_points(&sample.targets(), sample.counts, None, None);
            let motions: Vec<_> = job.motions.iter().map(|motion| motion.variable).collect();
            let motions: Vec<_> = motions.into_iter().filter(|m| surface.surface.unknowns.contains(m)).collect();
            let geometry = SurfaceGeometry::new(&bound, &motions, coordinates);
            let geometry = geometry.expect("nothing is unbound");
            for k in (0..points.len()).filter(|k| points.outcome(*k) == Outcome::Solved) {
                let careful = geometry.at(&points.unknowns(k)).curvature.expect("a regular point").principal();
                let found = points.principal_curvatures(k).expect("the coordinates fix the point");
                let off = difference(&found, &[careful.k1, careful.k2]);
                assert!(
                    off < OF_CURVATURE * (1.0 + careful.k1.abs()),
                    "{spec}, {}, {k}: {found:?} {careful:?}",
                    surface.name
                );
            }
        }
    }
}
