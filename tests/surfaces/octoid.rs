//! Straight bevel gears by a crown gear with plane flanks, against the closed form of the octoid.

use flank_expr::Graph;
use flank_tests::{assert_point, job, points};

const SPEC: &str = "specs/bevel/octoid_gear.chain";

fn turned_about_z([x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y, z]
}

fn turned_about_y([x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    [cos * x + sin * z, y, cos * z - sin * x]
}

/// The normal of plane and gear where they touch meets the instantaneous axis, the line +x in which both pitch surfaces touch: the line
/// of contact is the foot of that line on the plane.
#[test]
fn flanks_are_octoids() {
    for (teeth, mate, module, pressure_angle) in
        [(20.0, 30.0, 4.0, 20f64), (17.0, 17.0, 2.5, 22.5), (41.0, 16.0, 6.0, 14.5)]
    {
        let graph = Graph::new();
        let set = [
            ("teeth", format!("{teeth}")),
            ("mate_teeth", format!("{mate}")),
            ("module", format!("{module} mm")),
            ("b.pressure_angle", format!("{pressure_angle} deg")),
        ];
        let set: Vec<(&str, &str)> = set.iter().map(|(name, value)| (*name, value.as_str())).collect();
        let job = job(&graph, SPEC, &set);
        let (alpha, pitch) = (pressure_angle.to_radians(), f64::atan2(teeth, mate));
        let heel = module * teeth / 2.0 / pitch.sin();
        let half = std::f64::consts::FRAC_PI_2 * pitch.sin() / teeth;
        for (surface, side) in [("plus", 1.0), ("minus", -1.0)] {
            // where the tooth of the crown gear touches, within its own height
            let rolls: Vec<f64> = (-4..=4).map(|k| half * (0.15 * f64::from(k) - side)).collect();
            let targets: Vec<[f64; 2]> = rolls.iter().map(|roll| [*roll, heel - 3.0]).collect();
            for (roll, point) in rolls.iter().zip(points(&job, surface, ["roll", "s"], &targets)) {
                // out of the blade, into the gear
                let normal = turned_about_z([0.0, side * alpha.cos(), -alpha.sin()], side * half + roll);
                let foot = [0, 1, 2].map(|k| f64::from(u8::from(k == 0)) - normal[0] * normal[k]);
                let long = foot.iter().map(|x| x * x).sum::<f64>().sqrt();
                let on_gear = |v: [f64; 3]| {
                    turned_about_z(turned_about_y(v, -(std::f64::consts::FRAC_PI_2 + pitch)), roll / pitch.sin())
                };
                let position = on_gear(foot.map(|x| (heel - 3.0) * x / long));
                let out_of_gear = on_gear(normal.map(|x| -x));
                assert_point(&point, position, out_of_gear, &format!("{teeth}:{mate}, {surface} at {roll} rad"));
            }
        }
    }
}
