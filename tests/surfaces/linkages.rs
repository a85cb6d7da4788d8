//! Machines with closed loops: a cam by a rocker that a four-bar linkage swings, against the loop in closed form; a hob that a cam relieves,
//! against the cam's own push; a hexapod, against the machine with slides and distances from matrices.

use flank_expr::Graph;
use flank_tests::{assert_point, difference, job, points, sampled};

const CAM: &str = "specs/linkages/rocker_cam.chain";

/// Ground, crank, coupler, rocker; from the rocker's pivot to the table's and to the roller; the arm's angle; the roller's radius.
struct Linkage {
    links: [f64; 4],
    table: f64,
    arm: f64,
    arm_angle: f64,
    roller: f64,
}

impl Linkage {
    /// The rocker's angle against the ground and its rate over that of the crank: the triangle of coupler, rocker and the line from the
    /// crank's pin to the rocker's pivot, by the law of cosines.
    fn rocker(&self, crank: f64) -> (f64, f64) {
        let [ground, length, coupler, rocker] = self.links;
        let (x, y) = (ground - length * crank.cos(), -length * crank.sin());
        let square = x * x + y * y;
        let distance = square.sqrt();
        let inner = (rocker * rocker + square - coupler * coupler) / (2.0 * rocker * distance);
        let angle = (-y).atan2(-x) - inner.acos();
        let slopes = [length * crank.sin(), -length * crank.cos()];
        let distance_slope = (x * slopes[0] + y * slopes[1]) / distance;
        let inner_slope = distance_slope * (1.0 / rocker - inner / distance);
        let turned = (x * slopes[1] - y * slopes[0]) / square;
        (angle, turned + inner_slope / (1.0 - inner * inner).sqrt())
    }

    /// The cam's profile and its outward normal: the parallel curve of the way of the roller's axis on the turning table.
    fn profile(&self, turn: f64, z: f64) -> ([f64; 3], [f64; 3]) {
        let (rocker, rate) = self.rocker(turn);
        let (sine, cosine) = (rocker + self.arm_angle).sin_cos();
        let at = [self.arm * cosine - self.table, self.arm * sine];
        // as the table sees it, which turns on
        let speed = [-self.arm * rate * sine + at[1], self.arm * rate * cosine - at[0]];
        let back = |[x, y]: [f64; 2]| [x * turn.cos() + y * turn.sin(), y * turn.cos() - x * turn.sin()];
        let (at, speed) = (back(at), back(speed));
        let length = speed[0].hypot(speed[1]);
        let mut outward = [-speed[1] / length, speed[0] / length];
        if outward[0] * at[0] + outward[1] * at[1] < 0.0 {
            outward = outward.map(|part| -part);
        }
        let position = [at[0] - self.roller * outward[0], at[1] - self.roller * outward[1], z];
        (position, [outward[0], outward[1], 0.0])
    }
}

#[test]
fn a_cam_by_a_linkage_is_the_parallel_curve_of_its_closed_form() {
    let shipped = Linkage {
        links: [70.0, 8.0, 80.0, 60.0],
        table: 95.0,
        arm: 75.0,
        arm_angle: -60.0_f64.to_radians(),
        roller: 10.0,
    };
    let other = Linkage { links: [75.0, 11.0, 70.0, 58.0], roller: 7.0, arm: 80.0, ..shipped };
    let set = [
        ("m.ground_length", "75 mm"),
        ("m.crank_length", "11 mm"),
        ("m.coupler_length", "70 mm"),
        ("m.rocker_length", "58 mm"),
        ("m.arm_length", "80 mm"),
        ("c.radius", "7 mm"),
    ];
    for (linkage, set) in [(shipped, &set[..0]), (other, &set)] {
        let graph = Graph::new();
        let job = job(&graph, CAM, set);
        let sample = job.surfaces[0].sample.as_ref().expect("the cam is sampled");
        for (target, point) in sample.targets().iter().zip(sampled(&job, "profile")) {
            let (position, normal) = linkage.profile(target[0], target[1]);
            assert_point(&point, position, normal, &format!("turn {}", target[0]));
        }
    }
}

#[test]
fn a_hexapod_planes_the_same_gear_as_slides() {
    let [hexapod, slides] = [
        ("specs/hexapod/hexapod_gear.chain", &[("m.table_tilt", "-22 deg")][..]),
        ("specs/hobbing/spur_gear.chain", &[("profile_shift", "0")][..]),
    ]
    .map(|(spec, set)| {
        let graph = Graph::new();
        let job = job(&graph, spec, set);
        let targets: Vec<[f64; 2]> = (0..9).map(|k| [35.0 + 0.5 * f64::from(k), f64::from(k % 3)]).collect();
        ["flank_plus", "flank_minus"].map(|flank| points(&job, flank, ["rho", "z"], &targets)).concat()
    });
    for (one, other) in hexapod.iter().zip(&slides) {
        assert_eq!((one.outcome.word(), other.outcome.word()), ("solved", "solved"));
        assert!(difference(&one.position, &other.position) < 1e-12, "{:?} {:?}", one.position, other.position);
        assert!(difference(&one.normal, &other.normal) < 1e-13);
    }
}

/// The six lengths as a control needs them: from joint to joint, by the platform's matrix.
#[test]
fn the_struts_of_a_hexapod_reach_from_joint_to_joint() {
    let graph = Graph::new();
    let tilt = 15.0_f64.to_radians();
    let job = job(&graph, "specs/hexapod/hexapod_gear.chain", &[]);
    let radius = 36.0;
    for roll in [-0.3_f64, 0.0, 0.2] {
        let mut values = vec![0.0; graph.variable_count()];
        for parameter in &job.parameters {
            values[parameter.variable.as_variable().expect("a variable").index()] = parameter.value;
        }
        values[job.motions[0].variable.as_variable().expect("a variable").index()] = roll;
        // the platform stands over the bed, turned about y as the bed is
        let in_base = |[x, y, z]: [f64; 3]| [x * tilt.cos() + z * tilt.sin(), y, z * tilt.cos() - x * tilt.sin()];
        let joint = |k: usize, radius: f64, spread: f64| {
            let sign = if k.is_multiple_of(2) { -1.0 } else { 1.0 };
            let angle = (120.0 * (k / 2) as f64 + sign * spread).to_radians();
            [radius * angle.cos(), radius * angle.sin(), 0.0]
        };
        for k in 0..6 {
            let [x, y, z] = joint(k, 160.0, 48.0);
            let platform = in_base([x + radius, y + radius * roll, z + 450.0]);
            let base = joint(k, 420.0, 12.0);
            let exact = (0..3).map(|i| (platform[i] - base[i]).powi(2)).sum::<f64>().sqrt();
            let name = format!("S{}", k + 1);
            let law = job.machines[0].axes.iter().find(|axis| axis.name == name).expect("a strut").law;
            let found = graph.evaluate(&[law], &values)[0];
            assert!((found - exact).abs() < 1e-12, "{name} at {roll}: {found}, not {exact}");
        }
    }
}

/// A cam that rises by a cosine, and its roller; lengths in mm.
struct Cam {
    base: f64,
    rise: f64,
    roller: f64,
}

impl Cam {
    /// How far the axis of the roller is from the camshaft on a line through it, and the rate of that over the turn of the cam. The roller is
    /// pushed away by the place of the contour that pushes it farthest.
    fn follower(&self, turn: f64) -> (f64, f64) {
        let radius = |place: f64| self.base + 0.5 * self.rise * (1.0 - (place - turn).cos());
        let bend = |place: f64| (self.roller.powi(2) - (radius(place) * place.sin()).powi(2)).sqrt();
        let slope = |place: f64| {
            let (r, rate) = (radius(place), 0.5 * self.rise * (place - turn).sin());
            let across = r * rate * place.sin().powi(2) + r * r * place.sin() * place.cos();
            rate * place.cos() - r * place.sin() - across / bend(place)
        };
        let (mut low, mut high) = (-0.2, 0.2);
        assert!(slope(low) > 0.0 && slope(high) < 0.0, "it is farthest in between");
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if slope(middle) > 0.0 { low = middle } else { high = middle }
        }
        let (sine, cosine) = low.sin_cos();
        let by_radius = cosine - radius(low) * sine * sine / bend(low);
        (radius(low) * cosine + bend(low), -by_radius * 0.5 * self.rise * (low - turn).sin())
    }
}

#[test]
fn a_relieved_hob_is_what_the_follower_of_the_cam_leaves() {
    let shipped = Cam { base: 60.0, rise: 4.0, roller: 15.0 };
    let other = Cam { base: 45.0, rise: 7.0, roller: 20.0 };
    let set = [("relief", "7 mm"), ("m.base_radius", "45 mm"), ("m.roller_radius", "20 mm")];
    // lead in mm per radian: the module over two
    let (lead, gashes, tool_radius, half_tip) = (1.5, 10.0, 31.25, 1.2);
    for (cam, set) in [(shipped, &set[..0]), (other, &set)] {
        let graph = Graph::new();
        let job = job(&graph, "specs/linkages/relieved_hob.chain", set);
        for (name, side) in [("plus", 1.0), ("minus", -1.0)] {
            let sample = job.surfaces.iter().find(|surface| surface.name == name).and_then(|it| it.sample.as_ref());
            for (target, point) in sample.expect("it is sampled").targets().iter().zip(sampled(&job, name)) {
                let [u, turn] = *target;
                let (far, rate) = cam.follower(gashes * turn);
                let x = tool_radius + cam.base + cam.roller - far + u;
                let incline = side * 20.0_f64.to_radians().tan();
                let (sine, cosine) = turn.sin_cos();
                let position = [x * cosine, -x * sine, side * half_tip + incline * u + lead * turn];
                let along = [cosine, -sine, incline];
                let fall = -gashes * rate;
                let on = [fall * cosine - x * sine, -fall * sine - x * cosine, lead];
                let across = [
                    along[1] * on[2] - along[2] * on[1],
                    along[2] * on[0] - along[0] * on[2],
                    along[0] * on[1] - along[1] * on[0],
                ];
                // out of the tooth, towards the middle of the space
                let size = -side * across[2].signum() * across.iter().map(|part| part * part).sum::<f64>().sqrt();
                assert_point(&point, position, across.map(|part| part / size), &format!("{name}, u {u}, turn {turn}"));
            }
        }
    }
}
