//! The 19 x 62 spiral bevel pair against a third party's tables: both members, and the pinion conjugate to the gear.

use flank_expr::Graph;
use flank_tests::variants::{ALL_JOINTS, EASE_OFF};
use flank_tests::{Row, assert_point, evaluated, job, points, reference_csv, reversed};

const PINION: &str = "specs/bevel/pinion_19x62.chain";
const GEAR: &str = "specs/bevel/gear_19x62.chain";
const CONJUGATE: &str = "specs/bevel/conjugate_pinion_19x62.chain";

/// Nodes below this length along the profile lie on the rounding of the blade's edge.
const EDGE_LENGTH: f64 = 0.2546;

fn check(spec: &str, table: &str, flank: &str, set: &[(&str, &str)]) {
    let rows = reference_csv(table);
    assert_eq!(rows.len(), 25);
    let graph = Graph::new();
    let job = job(&graph, spec, set);
    let (edge, blade): (Vec<&Row>, Vec<&Row>) = rows.iter().partition(|row| row.get("csi") < EDGE_LENGTH);
    let surfaces = [(format!("{flank}_fillet"), edge), (flank.to_string(), blade)];
    for (surface, rows) in surfaces.into_iter().filter(|(_, rows)| !rows.is_empty()) {
        let targets: Vec<[f64; 2]> = rows.iter().map(|row| [row.get("z"), row.get("R")]).collect();
        for (row, point) in rows.iter().zip(points(&job, &surface, ["z", "rho"], &targets)) {
            let what = format!("{surface} at i {}, j {}", row.get("i_len"), row.get("j_prof"));
            let position = ["X", "Y", "Z"].map(|column| row.get(column));
            let normal = reversed(["nx", "ny", "nz"].map(|column| row.get(column)));
            assert_point(&point, position, normal, &what);
        }
    }
}

#[test]
fn ease_off_variant_meets_the_table() {
    check(PINION, "universal_19x62_pinion_concave_easeoff.csv", "concave", &EASE_OFF);
}

/// Every joint follows the roll; the points are given by blade length and roll.
#[test]
fn all_joints_moving_meets_the_table() {
    let rows = reference_csv("universal_19x62_pinion_concave_alljoints.csv");
    let graph = Graph::new();
    let job = job(&graph, PINION, &ALL_JOINTS);
    let (edge, blade): (Vec<&Row>, Vec<&Row>) = rows.iter().partition(|row| row.get("csi") < EDGE_LENGTH);
    assert_eq!([edge.len(), blade.len()], [5, 20]);
    for (surface, rows) in [("concave_fillet", edge), ("concave", blade)] {
        let targets: Vec<[f64; 2]> = rows.iter().map(|row| [row.get("csi"), row.get("phi")]).collect();
        for (row, point) in rows.iter().zip(points(&job, surface, ["s", "roll"], &targets)) {
            let what = format!("{surface} at {} mm, roll {}", row.get("csi"), row.get("phi"));
            let position = ["X", "Y", "Z"].map(|column| row.get(column));
            let normal = reversed(["nx", "ny", "nz"].map(|column| row.get(column)));
            assert_point(&point, position, normal, &what);
        }
    }
}

#[test]
fn flanks_of_both_members_meet_the_tables() {
    for flank in ["concave", "convex"] {
        check(PINION, &format!("universal_19x62_pinion_{flank}.csv"), flank, &[]);
        check(GEAR, &format!("universal_19x62_gear_{flank}.csv"), flank, &[]);
    }
}

/// Each node of the gear's flank has a point of the pinion that touches it in mesh.
#[test]
fn the_conjugate_pinion_meets_the_tables() {
    for (flank, of_gear) in [("concave", "convex"), ("convex", "concave")] {
        let nodes = reference_csv(&format!("universal_19x62_gear_{of_gear}.csv"));
        let rows = reference_csv(&format!("universal_19x62_conjugate_pinion_{flank}.csv"));
        assert_eq!(rows.len(), 25);
        let graph = Graph::new();
        let job = job(&graph, CONJUGATE, &[]);
        let targets: Vec<[f64; 2]> = nodes.iter().map(|node| [node.get("csi"), node.get("phi")]).collect();
        for (row, point) in rows.iter().zip(points(&job, flank, ["s", "roll"], &targets)) {
            let what = format!("{flank} at i {}, j {}", row.get("i_len"), row.get("j_prof"));
            assert!((point.unknowns[3] - row.get("psiG")).abs() < 1e-9, "{what}: mesh {}", point.unknowns[3]);
            // the table's normal points out of the pinion, which the gear's cutter does too
            let normal = ["nx", "ny", "nz"].map(|column| row.get(column));
            assert_point(&point, ["X", "Y", "Z"].map(|column| row.get(column)), normal, &what);
        }
    }
}

/// The gap between gear and pinion is closed along the contact line of the conjugate pinion, and open in all directions for a
/// pinion with ease-off, which is locally conjugate: curvature of the gap, 1/mm, against the gear's flank.
#[test]
fn line_contact_has_no_gap_along_the_line_and_point_contact_has_one_all_round() {
    let [one, other] = [Graph::new(), Graph::new()];
    let conjugate = job(&one, CONJUGATE, &[]);
    let sample =
        conjugate.surfaces.iter().find(|s| s.name == "concave").and_then(|s| s.sample.clone()).expect("sampled");
    let solved = points(&conjugate, "concave", ["z", "rho"], &sample.targets());
    let unknowns: Vec<Vec<f64>> = solved.iter().map(|point| point.unknowns.clone()).collect();
    let on_conjugate = evaluated(&conjugate, "concave", &unknowns);
    for point in &on_conjugate {
        let contact = &point.geometry.contact;
        let (line, gap) = (contact.line.expect("one motion"), contact.induced.expect("a tool with a surface"));
        assert!(gap.along(line).expect("a tangent").abs() < 1e-12, "{:e}", gap.along(line).expect("a tangent"));
        assert!(gap.mean() > 1e-3, "across the line it opens: {:e}", gap.mean());
    }

    let middle = on_conjugate.len() / 2;
    let local = job(&other, PINION, &EASE_OFF);
    let at_mean = points(&local, "concave", ["z", "rho"], &[sample.targets()[middle]]);
    let local = evaluated(&local, "concave", &[at_mean[0].unknowns.clone()]).remove(0);
    let mate = &on_conjugate[middle];
    let line = mate.geometry.contact.line.expect("one motion");
    let across = cross(mate.normal, line);
    let [fully, locally] = [&mate.geometry.curvature, &local.geometry.curvature].map(|c| c.as_ref().expect("regular"));
    let induced = mate.geometry.contact.induced.as_ref().expect("a tool with a surface");
    for step in 0..36 {
        let angle = f64::from(step) * std::f64::consts::PI / 36.0;
        let along = [0, 1, 2].map(|k| line[k] * angle.cos() + across[k] * angle.sin());
        let curvature = |of: &flank_solver::Curvature| of.along(along).expect("near the tangent plane");
        let gap = curvature(induced) + curvature(locally) - curvature(fully);
        assert!(gap > 1e-5, "in the direction {angle}: {gap:e}");
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
