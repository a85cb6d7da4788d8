//! The wheel of a globoid worm with straight edges, against a closed form of its second line of contact.

use std::f64::consts::FRAC_PI_2;

use flank_expr::Graph;
use flank_tests::{assert_point, grid, job};

const SPEC: &str = "specs/globoid/hindley_worm_wheel.chain";

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Centre distance, radius of the wheel and of the base circle, half the angle of a tooth, turns of the wheel for one of the worm.
struct Drive {
    distance: f64,
    wheel: f64,
    base: f64,
    half_tooth: f64,
    ratio: f64,
}

impl Drive {
    /// In the worm's axial plane, x from its axis to the wheel and z along it: a point of an edge and the edge's direction, when the worm has
    /// turned by an angle. `s` counts from the point in which the edge touches the base circle.
    fn edge(&self, side: f64, s: f64, turn: f64) -> ([f64; 2], [f64; 2]) {
        let slope = self.half_tooth - (self.base / self.wheel).asin();
        let (sin, cos) = slope.sin_cos();
        let on_wheel = |[x, y]: [f64; 2]| {
            let (sin, cos) = (self.ratio * turn).sin_cos();
            [x * cos - y * sin, x * sin + y * cos]
        };
        let point = on_wheel([-s * cos + self.base * sin, -side * (s * sin + self.base * cos)]);
        ([self.distance + point[0], point[1]], on_wheel([-cos, -side * sin]))
    }

    /// Position and normal of the wheel, in its own frame, where the edge that has passed at `turn` touches it again.
    ///
    /// In the frame of the housing, the worm's point that was at P when it was cut is at Rz(δ) P when the worm has turned on by δ. With the
    /// edge's direction e, its normal in the worm is e × (P' − Rz' P). Relative velocity of worm and wheel along it vanishes for δ = 0 and
    /// where tan δ/2 = −i s z / (ρ P·e), with i = −ratio, since the wheel turns backwards about y.
    fn touches(&self, side: f64, s: f64, turn: f64) -> ([f64; 3], [f64; 3]) {
        let ([rho, z], e) = self.edge(side, s, turn);
        let i = -self.ratio;
        let on = 2.0 * (-i * s * z / (rho * (rho * e[0] + z * e[1]))).atan();
        let (sin, cos) = on.sin_cos();
        let turned = |[x, y, z]: [f64; 3]| [x * cos - y * sin, x * sin + y * cos, z];
        let along = [e[0], 0.0, e[1]];
        let from_axis = [rho - self.distance, 0.0, z];
        let speed = cross([0.0, i, 0.0], from_axis);
        let normal = cross(along, [speed[0], speed[1] - rho, speed[2]]);
        let (point, normal) = (turned([rho, 0.0, z]), turned(normal));
        // the equation of meshing itself, with the velocities of worm and wheel
        let worm = cross([0.0, 0.0, 1.0], point);
        let wheel = cross([0.0, i, 0.0], [point[0] - self.distance, point[1], point[2]]);
        let meshing = dot(normal, [worm[0] - wheel[0], worm[1] - wheel[1], worm[2] - wheel[2]]);
        assert!(meshing.abs() < 1e-9, "the closed form solves the equation of meshing: {meshing}");
        let mesh = turn + on;
        let on_wheel = |[x, y, z]: [f64; 3]| {
            // the wheel's frame stands with its z along -y
            let (sin, cos) = (self.ratio * mesh).sin_cos();
            [x * cos + z * sin, z * cos - x * sin, -y]
        };
        let length = dot(normal, normal).sqrt();
        // out of the wheel's tooth, which lies between the edges
        let outwards = if dot(normal, [0.0, 0.0, -side]) > 0.0 { length } else { -length };
        (on_wheel([point[0] - self.distance, point[1], point[2]]), on_wheel(normal.map(|x| x / outwards)))
    }
}

#[test]
fn the_second_line_of_contact_meets_its_closed_form() {
    let shipped = Drive { distance: 125.0, wheel: 100.0, base: 40.0, half_tooth: FRAC_PI_2 / 40.0, ratio: 1.0 / 40.0 };
    let other = Drive { distance: 160.0, wheel: 130.0, base: 45.0, half_tooth: FRAC_PI_2 / 51.0, ratio: 2.0 / 51.0 };
    let values = [("starts", "2"), ("teeth", "51"), ("centre_distance", "160 mm"), ("wheel_radius", "130 mm")];
    let set: Vec<(&str, &str)> = values.into_iter().chain([("base_radius", "45 mm")]).collect();
    for (drive, set) in [(shipped, Vec::new()), (other, set)] {
        let graph = Graph::new();
        let job = job(&graph, SPEC, &set);
        let to_pitch = (drive.wheel.powi(2) - drive.base.powi(2)).sqrt();
        for (surface, side) in [("plus", 1.0), ("minus", -1.0)] {
            let heights: Vec<f64> = (-4..=4).map(|k| f64::from(k) * 1.1).collect();
            let end = 27f64.to_radians() / drive.ratio;
            let turns: Vec<f64> = (1..=12).map(|k| side * end * (0.05 + 0.079 * f64::from(k))).collect();
            let turns: Vec<f64> = if side > 0.0 { turns } else { turns.into_iter().rev().collect() };
            let targets: Vec<[f64; 2]> =
                heights.iter().flat_map(|height| turns.iter().map(|turn| [*height, *turn])).collect();
            let solved = grid(&job, surface, ["u", "turn"], &targets, turns.len());
            for ([height, turn], point) in targets.iter().zip(&solved) {
                let (position, normal) = drive.touches(side, to_pitch + height, *turn);
                assert_point(point, position, normal, &format!("{surface} at {height} mm, {turn} rad"));
            }
        }
    }
}
