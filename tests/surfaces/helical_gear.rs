//! A helical gear from a ZI hob with two motions: the independent table and the closed-form involute helicoid.

use flank_expr::Graph;
use flank_tests::{assert_point, job, number, points, reference_json, reversed, vector};
use serde_json::Value;

const SPEC: &str = "specs/hobbing/helical_gear.chain";

fn rows(reference: &Value, sigma: f64) -> Vec<&Value> {
    let all = reference["rows"].as_array().expect("a table");
    all.iter().filter(|row| number(row, "sigma") == sigma).collect()
}

#[test]
fn flanks_meet_the_table() {
    let reference = reference_json("helical_zi_hob.json");
    let graph = Graph::new();
    let job = job(&graph, SPEC, &[]);
    for (surface, sigma) in [("lower_flank", 1.0), ("upper_flank", -1.0)] {
        let rows = rows(&reference, sigma);
        assert_eq!(rows.len(), 16);
        let targets: Vec<[f64; 2]> = rows.iter().map(|row| [number(row, "z"), number(row, "rho")]).collect();
        for (row, point) in rows.iter().zip(points(&job, surface, ["z", "rho"], &targets)) {
            let what = format!("{surface} at z {}, radius {}", number(row, "z"), number(row, "rho"));
            assert_point(&point, vector(row, "p"), reversed(vector(row, "n")), &what);
            for (unknown, key) in point.unknowns.iter().zip(["u", "v", "B", "Z"]) {
                assert!((unknown - number(row, key)).abs() < 1e-9, "{what}: {key}");
            }
        }
    }
}

/// Base radius and lead from the hob and the machine alone; then every point has the polar angle of that helicoid up to
/// one phase, and its normal is the helicoid's.
#[test]
fn flanks_are_closed_form_involute_helicoids() {
    let reference = reference_json("helical_zi_hob.json");
    for (starts, teeth, beta) in [(2.0, 31.0, 22f64), (2.0, 44.0, 9.0), (2.0, 25.0, 31.0)] {
        let graph = Graph::new();
        let set =
            [("hob_starts", starts.to_string()), ("teeth", teeth.to_string()), ("helix_angle", format!("{beta} deg"))];
        let set: Vec<(&str, &str)> = set.iter().map(|(name, value)| (*name, value.as_str())).collect();
        let job = job(&graph, SPEC, &set);
        let (mn, alpha, beta) = (3.0, 20f64.to_radians(), beta.to_radians());
        let r = mn * teeth / (2.0 * beta.cos());
        let transverse = (alpha.tan() / beta.cos()).atan();
        let (rb, lead) = (r * transverse.cos(), r / beta.tan());
        if teeth == 31.0 {
            // the closed form agrees with the independent one
            assert!((rb - number(&reference["closed_form"][0], "rb")).abs() < 1e-9);
            assert!((lead - number(&reference["closed_form"][0], "p2")).abs() < 1e-9);
        }
        let targets: Vec<[f64; 2]> =
            (0..24).map(|k| [-8.0 + 3.0 * f64::from(k % 6), r - 1.0 + 1.1 * f64::from(k / 6)]).collect();
        for (surface, side) in [("lower_flank", -1.0), ("upper_flank", 1.0)] {
            let points = points(&job, surface, ["z", "rho"], &targets);
            let phase = |p: [f64; 3]| {
                let radius = p[0].hypot(p[1]);
                let at = (rb / radius).acos();
                p[1].atan2(p[0]) - p[2] / lead - side * (at.tan() - at)
            };
            let first = phase(points[0].position);
            for (target, point) in targets.iter().zip(&points) {
                let [z, radius] = *target;
                let at = (rb / radius).acos();
                let polar = first + z / lead + side * (at.tan() - at);
                let position = [radius * polar.cos(), radius * polar.sin(), z];
                // tangent plane of the helicoid: it touches the base cylinder and rises with the lead
                let tangent = polar + side * at;
                let slope = (rb / lead).atan();
                let flat = side * slope.cos();
                let normal = [flat * tangent.sin(), -flat * tangent.cos(), side * slope.sin()];
                assert_point(point, position, normal, &format!("{surface} at z {z}, radius {radius}, {teeth} teeth"));
            }
        }
    }
}
