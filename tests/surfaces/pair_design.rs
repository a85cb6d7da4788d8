//! The bevel pair that is designed from its blank alone touches in the mean point on both flanks, as its design says.

use std::f64::consts::TAU;

use flank_chain_dsl::Job;
use flank_expr::Graph;
use flank_solver::{ContactPoint, ContactProblem};
use flank_tests::pairs::with_contact;
use flank_tests::{difference, jobs, sampled};
use nalgebra::{Matrix3, Vector3};

const BLANKS: &str = "tests/surfaces/specs/pairs_from_blanks.chain";

fn setting(job: &Job<'_>, name: &str) -> f64 {
    job.parameters.iter().find(|p| p.name == name).unwrap_or_else(|| panic!("{name} of {}", job.name)).value
}

/// The blank's mean point in the housing, and both axes.
struct Mean {
    point: Vector3<f64>,
    axes: [Vector3<f64>; 2],
    sines: [f64; 2],
    cone_distance: f64,
    normal_module: f64,
}

impl Mean {
    fn of(job: &Job<'_>) -> Mean {
        let of = |name: &str| setting(job, name);
        let [angle, ratio] = [of("shaft_angle"), of("gear_teeth") / of("pinion_teeth")];
        let pitch_angle = angle.sin().atan2(angle.cos() + ratio);
        let sines = [pitch_angle.sin(), (angle - pitch_angle).sin()];
        let outer = of("outer_transverse_module") * of("gear_teeth") / (2.0 * sines[1]);
        let cone_distance = outer - of("face_width") / 2.0;
        Mean {
            point: Vector3::new(sines[0], 0.0, pitch_angle.cos()) * cone_distance,
            axes: [Vector3::z(), Vector3::new(angle.sin(), 0.0, angle.cos())],
            sines,
            cone_distance,
            normal_module: of("outer_transverse_module") * cone_distance / outer * of("spiral_angle").cos(),
        }
    }

    /// Along the flank in the pitch plane, towards the heel, and across it towards the pinion's tip.
    fn directions(&self, normal: Vector3<f64>) -> [Vector3<f64>; 2] {
        let up = Vector3::new(self.point.z, 0.0, -self.point.x) / self.cone_distance;
        let along = normal.cross(&up).normalize();
        let along = along * along.dot(&self.point).signum();
        let across = normal.cross(&along);
        [along, across * across.dot(&up).signum()]
    }

    /// The tensor of the gap of conjugate flanks with this normal: what rolls without sliding at a point parts by the square of the
    /// way across the line of contact.
    fn conjugate_gap(&self, normal: Vector3<f64>) -> Matrix3<f64> {
        let gear_turns = self.sines[0] / self.sines[1];
        let spin = -self.axes[1] * gear_turns - self.axes[0];
        let across = normal.cross(&spin);
        across * across.transpose() / normal.dot(&spin.cross(&self.axes[0].cross(&self.point)))
    }

    /// By how much the design's crowning parts the flanks beside that.
    fn crowning(&self, job: &Job<'_>, normal: Vector3<f64>) -> Matrix3<f64> {
        let of = |name: &str| setting(job, name);
        let [along, across] = self.directions(normal);
        let half_length = of("face_width") / (2.0 * of("spiral_angle").cos());
        let half_depth = self.normal_module / of("pressure_angle").cos();
        let square = |a: &Vector3<f64>, b: &Vector3<f64>| a * b.transpose();
        square(&along, &along) * (2.0 * of("lengthwise_crowning") / half_length.powi(2))
            + square(&across, &across) * (2.0 * of("profile_crowning") / half_depth.powi(2))
            + (square(&along, &across) + square(&across, &along)) * (of("bias") / (half_length * half_depth))
    }
}

/// Contact of one side, where the pinion's flank passes the plane of the axes with its mean point, and a little before and after.
fn about_the_mean(job: &Job<'_>, side: usize) -> [ContactPoint; 3] {
    let mean = setting(job, ["p.index", "q.index"][side]);
    let step = 0.02 * TAU / setting(job, "pinion_teeth");
    let path = with_contact(job, side, &[], false, |pair, points| {
        ContactProblem::new(pair).expect("nothing is unbound").path(&[mean - step, mean, mean + step], points)
    });
    let found: Vec<ContactPoint> = path.points.into_iter().map(|point| point.expect("it touches there")).collect();
    found.try_into().expect("three positions")
}

/// The point, the lag, its slope and the curvatures of the gap are those of the design: lengths of some 100 mm leave 1e-9 mm, and
/// second derivatives 1e-9 of each.
#[test]
fn both_flanks_touch_in_the_mean_point_and_part_by_the_crowning() {
    let graph = Graph::new();
    let pairs = jobs(&graph, BLANKS, &[]);
    assert_eq!(pairs.len(), 13);
    for job in &pairs {
        let mean = Mean::of(job);
        let hand = setting(job, "pinion_hand");
        let backlash = hand * setting(job, "backlash") / (mean.cone_distance * mean.sines[1]);
        for (side, lag) in [0.0, backlash].into_iter().enumerate() {
            let what = format!("{} of {}", job.contacts[side].name, job.name);
            let [_, point, _] = &about_the_mean(job, side);
            assert!(difference(&point.position, mean.point.as_slice()) < 1e-9, "{what}: {point:?}");
            assert!((point.lag - lag).abs() < 1e-11, "{what}: {} {lag}", point.lag);
            assert!(point.lag_slopes[0].abs() < 1e-9, "{what}: {:?}", point.lag_slopes);
            assert!(difference(&point.sliding, &[0.0; 3]) < 1e-8, "{what}: {:?}", point.sliding);

            let normal = Vector3::from(point.normal);
            // half the width of the gear's cutter and of its blades' taper turn the tooth by as much about the cutter's centre
            let spiral = mean.directions(normal)[0].angle(&mean.point);
            let room: f64 = if job.name == "as_printed" { 0.25 } else { 1.25 };
            assert!((spiral - setting(job, "spiral_angle")).abs() < room.to_radians(), "{what}: {spiral}");
            let expected = mean.conjugate_gap(normal) + mean.crowning(job, normal);
            let gap = point.gap.expect("a regular point");
            let [d1, d2] = gap.directions.expect("two curvatures").map(Vector3::from);
            for (a, b, curvature) in [(d1, d1, gap.k1), (d2, d2, gap.k2), (d1, d2, 0.0)] {
                let designed = a.dot(&(expected * b));
                assert!((curvature - designed).abs() < 1e-9 * gap.k1, "{what}: {curvature:e} {designed:e}");
            }
            assert!(gap.k2 > 0.0, "{what}: {gap:?}");
        }
    }
}

/// The error is extreme at the mean point: before and after, the crowned flanks let the driven member come nearer.
#[test]
fn the_error_is_extreme_in_the_mean_point() {
    let graph = Graph::new();
    for job in &jobs(&graph, BLANKS, &[]) {
        for side in [0, 1] {
            let [before, mean, after] = about_the_mean(job, side);
            let openings = [before.lag, after.lag].map(|lag| (lag - mean.lag) * mean.opening);
            assert!(openings.iter().all(|opening| *opening < 0.0), "{}: {openings:?}", job.name);
            let parabola = mean.lag_slopes[1] * mean.opening;
            assert!(parabola < 0.0, "{}: {parabola:e}", job.name);
        }
    }
}

/// Each point of the samples lies on its flank.
#[test]
fn all_flanks_are_whole() {
    let graph = Graph::new();
    for job in &jobs(&graph, BLANKS, &[]) {
        for flank in ["pinion_concave", "pinion_convex", "gear_concave", "gear_convex"] {
            sampled(job, flank);
        }
    }
}
