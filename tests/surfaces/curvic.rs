//! Both halves of a curvic coupling, against the cones of the wheels in closed form, and against each other.

use flank_expr::Graph;
use flank_tests::{assert_point, grid, job, reversed};

const SPEC: &str = "specs/curvic/curvic_coupling.chain";

/// Teeth, half pitches between the flanks, mean radius, pressure angle.
#[derive(Clone, Copy)]
struct Coupling {
    teeth: f64,
    half_pitches: f64,
    radius: f64,
    angle: f64,
}

impl Coupling {
    fn half_angle(self) -> f64 {
        std::f64::consts::FRAC_PI_2 * self.half_pitches / self.teeth
    }

    /// Where a circle about the work's axis meets the wheel's cone at a height over the pitch plane, and the normal out of the work. The wheel
    /// that leaves concave flanks (`bulge` −1) becomes thicker upwards outside, the other one (+1) inside.
    fn flank(self, bulge: f64, side: f64, [z, rho]: [f64; 2]) -> ([f64; 3], [f64; 3]) {
        let slope = self.angle.to_radians();
        let to_wheel = self.radius / self.half_angle().cos();
        let radius = self.radius * self.half_angle().tan() - bulge * z * slope.tan();
        let x = (rho * rho + to_wheel * to_wheel - radius * radius) / (2.0 * to_wheel);
        let y = side * (rho * rho - x * x).sqrt();
        let out = [(x - to_wheel) / radius, y / radius].map(|part| bulge * part * slope.cos());
        ([x, y, z], [out[0], out[1], slope.sin()])
    }
}

#[test]
fn both_halves_are_cones_and_fit_on_each_other() {
    let couplings = [
        Coupling { teeth: 24.0, half_pitches: 9.0, radius: 60.0, angle: 30.0 },
        Coupling { teeth: 36.0, half_pitches: 11.0, radius: 100.0, angle: 20.0 },
    ];
    for coupling in couplings {
        let set = [
            ("teeth", format!("{}", coupling.teeth)),
            ("half_pitches", format!("{}", coupling.half_pitches)),
            ("mean_radius", format!("{} mm", coupling.radius)),
            ("pressure_angle", format!("{} deg", coupling.angle)),
        ];
        let set: Vec<(&str, &str)> = set.iter().map(|(name, value)| (*name, value.as_str())).collect();
        let graph = Graph::new();
        let job = job(&graph, SPEC, &set);
        let radii = [-7.0, -2.0, 0.0, 3.0, 7.0].map(|off| coupling.radius + off);
        let heights = [-1.7, -0.9, 0.0, 0.9, 1.7];
        let targets: Vec<[f64; 2]> = heights.iter().flat_map(|z| radii.map(|rho| [*z, rho])).collect();
        let of = |surface: &str| grid(&job, surface, ["z", "rho"], &targets, radii.len());
        for (name, bulge) in [("concave", -1.0), ("convex", 1.0)] {
            for (end, side) in [("plus", 1.0), ("minus", -1.0)] {
                let surface = format!("{name}_{end}.side");
                for (target, point) in targets.iter().zip(of(&surface)) {
                    let (position, normal) = coupling.flank(bulge, side, *target);
                    assert_point(&point, position, normal, &format!("{surface} at {target:?}"));
                }
            }
        }
        // one half turned about x lies on the other: a face without a gap
        let turned = |[x, y, z]: [f64; 3]| [x, -y, -z];
        let (convex, concave) = (of("convex_plus.side"), of("concave_minus.side"));
        for (k, point) in convex.iter().enumerate() {
            let mate = &concave[(heights.len() - 1 - k / radii.len()) * radii.len() + k % radii.len()];
            assert_point(mate, turned(point.position), reversed(turned(point.normal)), &format!("{:?}", targets[k]));
        }
        // teeth and spaces are equally wide in the pitch plane: flanks at the mean radius stand on half pitches
        let middle = &convex[2 * radii.len() + 2];
        let half_pitches = middle.position[1].atan2(middle.position[0]) * 2.0 * coupling.teeth / std::f64::consts::PI;
        assert!((half_pitches - coupling.half_pitches).abs() < 1e-9, "{half_pitches}");
    }
}
