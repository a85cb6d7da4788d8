//! A spur gear from a rack: the independent table, the closed-form involute and trochoid.

use flank_expr::Graph;
use flank_tests::{assert_point, job, number, points, reference_json, reversed, vector};
use serde_json::Value;

const SPEC: &str = "specs/hobbing/spur_gear.chain";

fn rows<'v>(reference: &'v Value, table: &str, sigma: f64) -> Vec<&'v Value> {
    let all = reference[table].as_array().expect("a table");
    all.iter().filter(|row| number(row, "sigma") == sigma).collect()
}

#[test]
fn flanks_meet_the_table() {
    let reference = reference_json("spur_rack.json");
    let graph = Graph::new();
    let job = job(&graph, SPEC, &[]);
    for (surface, sigma) in [("flank_plus", 1.0), ("flank_minus", -1.0)] {
        let rows = rows(&reference, "flank_rows", sigma);
        assert_eq!(rows.len(), 6);
        let targets: Vec<[f64; 2]> = rows.iter().map(|row| [number(row, "z"), number(row, "rho")]).collect();
        for (row, point) in rows.iter().zip(points(&job, surface, ["z", "rho"], &targets)) {
            let what = format!("{surface} at radius {}", number(row, "rho"));
            assert_point(&point, vector(row, "p"), reversed(vector(row, "n")), &what);
            for (unknown, key) in point.unknowns.iter().zip(["u", "v", "phi"]) {
                assert!((unknown - number(row, key)).abs() < 1e-9, "{what}: {key}");
            }
        }
    }
}

#[test]
fn fillets_meet_the_table() {
    let reference = reference_json("spur_rack.json");
    let graph = Graph::new();
    let job = job(&graph, SPEC, &[]);
    for (surface, sigma) in [("fillet_plus", 1.0), ("fillet_minus", -1.0)] {
        let rows = rows(&reference, "fillet_rows", sigma);
        assert_eq!(rows.len(), 7);
        let targets: Vec<[f64; 2]> = rows.iter().map(|row| [number(row, "u"), number(row, "v")]).collect();
        for (row, point) in rows.iter().zip(points(&job, surface, ["theta", "v"], &targets)) {
            let what = format!("{surface} at theta {}", number(row, "u"));
            assert_point(&point, vector(row, "p"), reversed(vector(row, "n")), &what);
            assert!((point.unknowns[2] - number(row, "phi")).abs() < 1e-9, "{what}: phi");
        }
    }
}

/// inv(a) = tan a − a.
fn involute(angle: f64) -> f64 {
    angle.tan() - angle
}

/// The involute whose half tooth thickness follows from the rack's own, for gears other than the table's.
#[test]
fn flanks_are_the_closed_form_involute() {
    for (module, teeth, shift, alpha) in [(3.0, 24.0, 0.2, 20f64), (2.0, 41.0, -0.3, 20.0), (5.5, 17.0, 0.45, 25.0)] {
        let graph = Graph::new();
        let set = [
            ("module", format!("{module} mm")),
            ("teeth", format!("{teeth}")),
            ("profile_shift", format!("{shift}")),
            ("r.pressure_angle", format!("{alpha} deg")),
        ];
        let set: Vec<(&str, &str)> = set.iter().map(|(name, value)| (*name, value.as_str())).collect();
        let job = job(&graph, SPEC, &set);
        let alpha = alpha.to_radians();
        let r = module * teeth / 2.0;
        let rb = r * alpha.cos();
        let radii: Vec<f64> = (0..8).map(|k| r + module * (shift + 0.9 * f64::from(k) / 7.0)).collect();
        let targets: Vec<[f64; 2]> = radii.iter().map(|&radius| [1.5, radius]).collect();
        for (surface, side) in [("flank_plus", 1.0), ("flank_minus", -1.0)] {
            for (radius, point) in radii.iter().zip(points(&job, surface, ["z", "rho"], &targets)) {
                let at = (rb / radius).acos();
                let half = std::f64::consts::PI / (2.0 * teeth) + 2.0 * shift * alpha.tan() / teeth + involute(alpha)
                    - involute(at);
                // the flank of the gear's space that the rack's tooth leaves
                let polar = side * (std::f64::consts::PI / teeth - half);
                // the normal touches the base circle; it points out of the gear's tooth, into the space
                let normal_angle = polar - side * (std::f64::consts::FRAC_PI_2 - at);
                let position = [radius * polar.cos(), radius * polar.sin(), 1.5];
                let normal = [normal_angle.cos(), normal_angle.sin(), 0.0];
                assert_point(&point, position, normal, &format!("{surface}, module {module}, radius {radius}"));
            }
        }
    }
}

/// The trochoid: at each theta the rounding's normal passes through the pitch point, which gives the rotation.
#[test]
fn fillets_are_the_closed_form_trochoid() {
    let graph = Graph::new();
    let job = job(&graph, SPEC, &[]);
    let (m, z, x, alpha, h, rho) = (3.0, 24.0, 0.2, 20f64.to_radians(), 3.75, 1.14);
    let r = m * z / 2.0;
    let (xc, yc) = (-(h - rho), std::f64::consts::PI * m / 4.0 - (h - rho) * alpha.tan() - rho / alpha.cos());
    let thetas: Vec<f64> = (0..12).map(|k| alpha + (1.5 - alpha) * f64::from(k) / 11.0).collect();
    let targets: Vec<[f64; 2]> = thetas.iter().map(|&theta| [theta, 0.0]).collect();
    for (surface, side) in [("fillet_plus", 1.0), ("fillet_minus", -1.0)] {
        for (theta, point) in thetas.iter().zip(points(&job, surface, ["theta", "v"], &targets)) {
            let phi = -side * (yc + (xc + x * m) / theta.tan()) / r;
            let (px, py) = (xc - rho * theta.sin() + r + x * m, side * (yc + rho * theta.cos()) + r * phi);
            let (nx, ny) = (theta.sin(), -side * theta.cos());
            let turn = |a: f64, b: f64| [a * phi.cos() + b * phi.sin(), b * phi.cos() - a * phi.sin(), 0.0];
            assert_point(&point, turn(px, py), turn(nx, ny), &format!("{surface} at {theta}"));
        }
    }
}
