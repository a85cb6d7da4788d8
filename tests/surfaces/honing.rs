//! Gear honing: the wheel that a gear dresses on crossed axes, against the condition of contact in closed form, and the gear that the wheel
//! leaves, against the involute.

use std::f64::consts::{FRAC_PI_2, PI};

use flank_expr::Graph;
use flank_tests::{assert_point, grid, job, points, reversed, turned};

const SPEC: &str = "specs/honing/honed_gear.chain";

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Teeth of the gear and of the wheel, normal module in mm, helix and shaft angle in degrees.
#[derive(Clone, Copy, Debug)]
struct Honing {
    teeth: f64,
    wheel_teeth: f64,
    module: f64,
    helix: f64,
    shaft: f64,
}

const CASES: [Honing; 5] = [
    Honing { teeth: 31.0, wheel_teeth: 97.0, module: 2.25, helix: 25.0, shaft: 8.0 },
    Honing { teeth: 31.0, wheel_teeth: 111.0, module: 2.25, helix: 25.0, shaft: -12.0 },
    Honing { teeth: 53.0, wheel_teeth: 123.0, module: 2.0, helix: -30.0, shaft: -7.5 },
    Honing { teeth: 29.0, wheel_teeth: 97.0, module: 3.0, helix: 0.0, shaft: 15.0 },
    Honing { teeth: 73.0, wheel_teeth: 109.0, module: 1.5, helix: 18.0, shaft: 10.0 },
];

impl Honing {
    fn set(self) -> Vec<(&'static str, String)> {
        vec![
            ("teeth", format!("{}", self.teeth)),
            ("wheel_teeth", format!("{}", self.wheel_teeth)),
            ("normal_module", format!("{} mm", self.module)),
            ("helix_angle", format!("{} deg", self.helix)),
            ("shaft_angle", format!("{} deg", self.shaft)),
        ]
    }

    fn radius(self) -> f64 {
        self.module * self.teeth / (2.0 * self.helix.to_radians().cos())
    }

    /// Of both axes: the reference circles touch, and there the helices have one direction.
    fn distance(self) -> f64 {
        let wheel_helix = (self.helix - self.shaft).to_radians();
        self.module * self.wheel_teeth / (2.0 * wheel_helix.cos()) - self.radius()
    }

    fn pressure_angle(self) -> f64 {
        (20_f64.to_radians().tan() / self.helix.to_radians().cos()).atan()
    }

    fn base_radius(self) -> f64 {
        self.radius() * self.pressure_angle().cos()
    }

    /// Turn of the teeth along the axis, radians per mm.
    fn twist(self) -> f64 {
        self.helix.to_radians().tan() / self.radius()
    }

    /// Half the angle of a tooth on the base cylinder.
    fn half_base_angle(self) -> f64 {
        FRAC_PI_2 / self.teeth + self.pressure_angle().tan() - self.pressure_angle()
    }

    /// The involute helicoid where its normal stands at the angle `g` in the transverse section, and its unit normal out of the tooth.
    fn helicoid(self, side: f64, [xi, g, z]: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        let (sin, cos) = g.sin_cos();
        let rb = self.base_radius();
        let position = [rb * (cos - side * xi * sin), rb * (sin + side * xi * cos), z];
        // square to the direction of the screw
        let normal = [-side * sin, side * cos, -side * self.twist() * rb];
        let length = dot(normal, normal).sqrt();
        (position, normal.map(|x| x / length))
    }

    /// Where a flank of the gear touches the wheel: at the roll angle `xi`, with the normal at the angle `g` in the housing. The condition of
    /// contact, normal · relative velocity = 0, is linear in the height. Gives the turn of the gear, and position and normal out of the tooth
    /// in the housing.
    fn contact(self, side: f64, xi: f64, g: f64) -> (f64, [f64; 3], [f64; 3]) {
        let ratio = self.teeth / self.wheel_teeth;
        let (sin, cos) = self.shaft.to_radians().sin_cos();
        let wheel_speed = [0.0, -sin * ratio, cos * ratio];
        let sliding = |z: f64| {
            let (p, n) = self.helicoid(side, [xi, g, z]);
            let gear = cross([0.0, 0.0, 1.0], p);
            let wheel = cross(wheel_speed, [p[0] - self.distance(), p[1], p[2]]);
            dot(n, [gear[0] - wheel[0], gear[1] - wheel[1], gear[2] - wheel[2]])
        };
        let (at_zero, at_one) = (sliding(0.0), sliding(1.0));
        let z = at_zero / (at_zero - at_one);
        let (position, normal) = self.helicoid(side, [xi, g, z]);
        let turn = g - PI - self.twist() * z - side * (self.half_base_angle() - xi);
        (turn, position, normal)
    }

    /// From the housing to the frame of the wheel.
    fn on_wheel(self, turn: f64, v: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = self.shaft.to_radians().sin_cos();
        let along = [v[0], v[1] * cos + v[2] * sin, v[2] * cos - v[1] * sin];
        turned(along, -PI - turn * self.teeth / self.wheel_teeth)
    }
}

fn pairs<'s>(set: &'s [(&'static str, String)]) -> Vec<(&'static str, &'s str)> {
    set.iter().map(|(name, value)| (*name, value.as_str())).collect()
}

#[test]
fn the_wheel_lies_where_normals_are_square_to_the_relative_velocity() {
    for honing in CASES {
        let graph = Graph::new();
        let set = honing.set();
        let job = job(&graph, SPEC, &pairs(&set));
        let rolls = (honing.pressure_angle().tan() - 0.06, honing.pressure_angle().tan() + 0.06);
        for (surface, side) in [("wheel_plus", 1.0), ("wheel_minus", -1.0)] {
            let mut compared = 0;
            for k in 0..60 {
                let xi = rolls.0 + (rolls.1 - rolls.0) * f64::from(k % 6) / 5.0;
                let steep = honing.pressure_angle() + 0.012 * (f64::from(k / 6) - 4.5);
                let (turn, position, normal) = honing.contact(side, xi, PI - side * steep);
                if position[2].abs() > 14.0 {
                    continue;
                }
                let from_axis = [position[0] - honing.distance(), position[1], position[2]];
                let position = honing.on_wheel(turn, from_axis);
                let normal = reversed(honing.on_wheel(turn, normal));
                for point in points(&job, surface, ["xi", "turn"], &[[xi, turn]]) {
                    assert_point(&point, position, normal, &format!("{honing:?} {surface} at {xi}, {turn}"));
                    compared += 1;
                }
            }
            assert!(compared >= 20, "{honing:?} {surface}: {compared} points within the face");
        }
    }
}

/// Whatever the wheel's teeth and the shaft angle, it leaves the gear that it was dressed by.
#[test]
fn the_wheel_leaves_the_involute_gear_that_dressed_it() {
    for honing in CASES {
        let graph = Graph::new();
        let set = honing.set();
        let job = job(&graph, SPEC, &pairs(&set));
        let radii = [-0.65, -0.3, 0.0, 0.4, 0.85].map(|share| honing.radius() + share * honing.module);
        let heights = [-9.0, -4.0, 0.5, 5.0, 9.5];
        let targets: Vec<[f64; 2]> = radii.iter().flat_map(|rho| heights.map(|z| [*rho, z])).collect();
        for (surface, side) in [("flank_plus", 1.0), ("flank_minus", -1.0)] {
            for ([rho, z], point) in targets.iter().zip(grid(&job, surface, ["rho", "z"], &targets, heights.len())) {
                let xi = ((rho / honing.base_radius()).powi(2) - 1.0).sqrt();
                let g = honing.twist() * z + side * (honing.half_base_angle() - xi);
                let (position, normal) = honing.helicoid(side, [xi, g, *z]);
                assert_point(&point, position, normal, &format!("{honing:?} {surface} at {rho}, {z}"));
            }
        }
    }
}
