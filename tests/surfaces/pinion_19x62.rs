//! The pinion of the 19 x 62 spiral bevel pair against a third party's tables.

use flank_expr::Graph;
use flank_tests::{Row, assert_point, job, points, reference_csv, reversed};

const SPEC: &str = "specs/bevel/pinion_19x62.chain";

/// Nodes below this length along the profile lie on the rounding of the blade's edge.
const EDGE_LENGTH: f64 = 0.2546;

fn check(table: &str, member: &str, set: &[(&str, &str)]) {
    let rows = reference_csv(table);
    assert_eq!(rows.len(), 25);
    let graph = Graph::new();
    let job = job(&graph, SPEC, set);
    let (edge, blade): (Vec<&Row>, Vec<&Row>) = rows.iter().partition(|row| row.get("csi") < EDGE_LENGTH);
    for (surface, rows) in [(format!("{member}_fillet"), edge), (member.to_string(), blade)] {
        let targets: Vec<[f64; 2]> = rows.iter().map(|row| [row.get("z"), row.get("R")]).collect();
        for (row, point) in rows.iter().zip(points(&job, &surface, ["z", "rho"], &targets)) {
            let what = format!("{surface} at i {}, j {}", row.get("i_len"), row.get("j_prof"));
            let position = ["X", "Y", "Z"].map(|column| row.get(column));
            let normal = reversed(["nx", "ny", "nz"].map(|column| row.get(column)));
            assert_point(&point, position, normal, &what);
        }
    }
}

/// Settings found by an ease-off identification: offset, sliding base, modified roll and a curved blade.
#[test]
fn ease_off_variant_meets_the_table() {
    let set = [
        ("m.radial_distance", "99.808 mm"),
        ("m.work_offset", "-1.8799 mm"),
        ("m.sliding_base", "-1.3231 mm"),
        ("m.cradle_angle", "-51.522 deg"),
        ("m.machine_center_to_crossing_point", "4.9987 mm"),
        ("m.ratio_of_roll", "3.4108"),
        ("m.modified_roll_2c", "0.092298"),
        ("m.modified_roll_6d", "-0.27878"),
        ("c.outside_point_radius", "98.691 mm"),
        ("c.blade_radius", "233.84 mm"),
        ("c.blade_angle", "19.882 deg"),
    ];
    check("universal_19x62_pinion_concave_easeoff.csv", "concave", &set);
}

/// Every joint follows the roll; the points are given by blade length and roll.
#[test]
fn all_joints_moving_meets_the_table() {
    let set = [
        ("m.cutter_tilt", "-2.5 deg"),
        ("m.cutter_swivel", "20 deg"),
        ("m.work_offset", "-1.5 mm"),
        ("m.sliding_base", "0.8 mm"),
        ("m.machine_center_to_crossing_point", "-0.6 mm"),
        ("m.modified_roll_2c", "0.03"),
        ("m.modified_roll_6d", "-0.12"),
        ("m.modified_roll_24e", "0.5"),
        ("m.modified_roll_120f", "-2.0"),
        ("m.helical_motion_1", "1.2 mm"),
        ("m.helical_motion_2", "-3 mm"),
        ("m.helical_motion_3", "4 mm"),
        ("m.vertical_motion_1", "0.7 mm"),
        ("m.vertical_motion_2", "-2 mm"),
        ("m.radial_motion_1", "-0.9 mm"),
        ("m.radial_motion_2", "2.5 mm"),
        ("m.radial_motion_3", "-6 mm"),
        ("m.tilt_motion_1", "0.01 rad"),
        ("m.tilt_motion_2", "-0.03 rad"),
        ("m.swivel_motion_1", "0.02 rad"),
        ("m.swivel_motion_2", "0.05 rad"),
        ("c.blade_radius", "250 mm"),
    ];
    let rows = reference_csv("universal_19x62_pinion_concave_alljoints.csv");
    let graph = Graph::new();
    let job = job(&graph, SPEC, &set);
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
fn concave_flank_meets_the_table() {
    check("universal_19x62_pinion_concave.csv", "concave", &[]);
}

#[test]
fn convex_flank_meets_the_table() {
    check("universal_19x62_pinion_convex.csv", "convex", &[]);
}
