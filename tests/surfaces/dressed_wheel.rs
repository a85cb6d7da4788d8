//! A wheel whose profile goes through points of an envelope of the same job: what it grinds, against the thread in closed form.

use flank_expr::Graph;
use flank_tests::{grid, job};

const SPEC: &str = "specs/grinding/dressed_wheel.chain";

/// Of the thread in the spec, mm: radius, lead over a radian, width of the space in its normal section.
const RADIUS: f64 = 35.0;
const LEAD: f64 = 5.0518148554092255;
const WIDTH: f64 = 7.853981633974483;
/// Its pressure angle in that section, degrees.
const ANGLE: f64 = 20.0;

/// How far a point lies from the upper flank of the space along the axis, mm: the straight edge of the normal section, turned along its screw.
fn above_thread([x, y, z]: [f64; 3]) -> f64 {
    let lead_angle = (LEAD / RADIUS).atan();
    let half_width = |u: f64| 0.5 * WIDTH + u * ANGLE.to_radians().tan();
    let edge = |u: f64| [RADIUS + u, -half_width(u) * lead_angle.sin(), half_width(u) * lead_angle.cos()];
    // the point of the edge at this distance from the axis, by bisection
    let (mut low, mut high) = (-10.0, 10.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        let [along, across, _] = edge(middle);
        if along.hypot(across) < x.hypot(y) { low = middle } else { high = middle }
    }
    let [along, across, height] = edge(low);
    let turn = y.atan2(x) - across.atan2(along);
    let apart = z - height - LEAD * turn;
    let pitch = std::f64::consts::TAU * LEAD;
    apart - pitch * (apart / pitch).round()
}

/// The farthest that points of the ground flank lie from the thread, mm.
fn left_by(points: usize, radii: [f64; 2]) -> f64 {
    let graph = Graph::new();
    let job = job(&graph, SPEC, &[("points", &points.to_string())]);
    let targets: Vec<[f64; 2]> = (0..33)
        .flat_map(|k| [-2.0, 0.0, 2.0].map(|z| [radii[0] + (radii[1] - radii[0]) * f64::from(k) / 32.0, z]))
        .collect();
    let ground = grid(&job, "ground.flank", ["rho", "z"], &targets, 3);
    ground.iter().map(|point| above_thread(point.position).abs()).fold(0.0, f64::max)
}

/// A spline through the true points is off by the fourth power of their distance.
#[test]
fn what_a_dressed_wheel_leaves_falls_with_the_fourth_power_of_the_distance_of_the_points() {
    // away from the ends of the profile
    let left = [9, 17, 33].map(|points| left_by(points, [32.5, 35.5]));
    for (coarse, fine) in [(left[0], left[1]), (left[1], left[2])] {
        let order = (coarse / fine).log2();
        assert!((3.5..4.8).contains(&order), "order {order} of {left:?}");
    }
    // rounding: the thread is not known better, it is a difference of lengths of some 40 mm
    let rounding = left_by(129, [31.0, 37.0]);
    assert!(rounding < 5e-12, "{rounding}");
}
