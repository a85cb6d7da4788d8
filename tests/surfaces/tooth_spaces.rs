//! Both flanks of a sample bound one tooth space, as wide as the closed form has it: for any starts, shift and number of teeth.

use std::f64::consts::{PI, TAU};

use flank_chain_dsl::Job;
use flank_expr::Graph;
use flank_solver::{Outcome, SurfacePoint};
use flank_tests::{grid, job, sampled};

/// The gear that a job cuts: teeth, helix angle, profile shift as a share of the module; pressure angle 20 degrees.
struct Gear {
    teeth: f64,
    helix: f64,
    shift: f64,
}

impl Gear {
    fn pressure_angle(&self) -> f64 {
        (alpha().tan() / self.helix.cos()).atan()
    }

    /// Angle of a tooth space at the reference radius.
    fn space(&self) -> f64 {
        (PI - 4.0 * self.shift * alpha().tan()) / self.teeth
    }

    /// Polar angle at which a flank's involute leaves the base circle in the plane z = 0; +1 for that at the larger angle.
    fn phase(&self, module: f64, point: &SurfacePoint, side: f64) -> f64 {
        assert_eq!(point.outcome, Outcome::Solved);
        let reference = module * self.teeth / (2.0 * self.helix.cos());
        let ([x, y, z], base) = (point.position, reference * self.pressure_angle().cos());
        y.atan2(x) - z * self.helix.tan() / reference - side * involute((base / x.hypot(y)).acos())
    }
}

fn alpha() -> f64 {
    20f64.to_radians()
}

fn involute(angle: f64) -> f64 {
    angle.tan() - angle
}

/// An angle, less whole turns.
fn reduced(angle: f64) -> f64 {
    angle - (angle / TAU).round() * TAU
}

/// By how much the space that a job of the library cuts differs from that of the gear, as an angle.
fn error(spec: &str, set: &[(&str, String)], module: f64, gear: &Gear) -> f64 {
    let set: Vec<(&str, &str)> = set.iter().map(|(name, value)| (*name, value.as_str())).collect();
    let graph = Graph::new();
    let job = job(&graph, &format!("specs/hobbing/{spec}.chain"), &set);
    space_error(&job, ["lower_flank", "upper_flank"], module, gear)
}

/// The same between the points in the middle of two samples, of which all points are there.
fn space_error(job: &Job<'_>, flanks: [&str; 2], module: f64, gear: &Gear) -> f64 {
    let [lower, upper] = [0, 1].map(|k| {
        let points = sampled(job, flanks[k]);
        let solved = points.iter().filter(|point| point.outcome == Outcome::Solved).count();
        assert_eq!(solved, points.len(), "points of {}", flanks[k]);
        gear.phase(module, &points[points.len() / 2], [-1.0, 1.0][k])
    });
    reduced(upper - lower - gear.space() + 2.0 * involute(gear.pressure_angle()))
}

#[test]
fn of_a_helical_gear() {
    for starts in [1, 2, 3] {
        for (teeth, helix, shift, hob_shift) in [
            (31.0, 22.0, 2.0, 4.5),
            (31.0, 22.0, 5.5, -20.0),
            (17.0, 22.0, 1.5, 0.0),
            (12.0, 0.0, 1.5, 0.0),
            (60.0, -15.0, -4.0, 11.0),
            (25.0, 31.0, 0.0, 4.5),
        ] {
            let set = [
                ("hob_starts", starts.to_string()),
                ("teeth", teeth.to_string()),
                ("helix_angle", format!("{helix} deg")),
                ("shift", format!("{shift} mm")),
                ("hob_shift", format!("{hob_shift} mm")),
            ];
            let gear = Gear { teeth, helix: f64::to_radians(helix), shift: shift / 3.0 };
            let error = error("helical_gear", &set, 3.0, &gear);
            assert!(error.abs() < 1e-11, "{starts} starts, {teeth} teeth, shift {shift} mm: {error}");
        }
    }
}

/// Settings of a job, beside the teeth and the profile shift: what cuts the same gear otherwise.
type Otherwise<'a> = &'a [(&'a str, &'a str)];

/// Where flanks are modified, their middle is hardly: what is left there is far less than a pitch.
fn is_space_of_modified(spec: &str, module: f64, helix: f64, teeth: f64, shift: f64, otherwise: Otherwise<'_>) {
    let gear = Gear { teeth, helix: helix.to_radians(), shift: shift / module };
    let mut set = vec![("teeth", teeth.to_string()), ("shift", format!("{shift} mm"))];
    set.extend(otherwise.iter().map(|(name, value)| (*name, value.to_string())));
    let error = error(spec, &set, module, &gear);
    assert!(error.abs() < 1e-2, "{spec}, {set:?}: {error}");
}

#[test]
fn of_crowned_gears() {
    for spec in ["crowned_gear", "crowned_gear_quartic"] {
        for (teeth, shift, otherwise) in [
            (27.0, 0.4, &[][..]),
            (27.0, 6.0, &[]),
            (27.0, -6.0, &[]),
            (12.0, 0.4, &[]),
            (80.0, 4.0, &[]),
            (27.0, 0.4, &[("hob_shift", "40 mm")]),
            (27.0, 2.0, &[("hob_shift", "-25 mm"), ("hob_starts", "3")]),
            (27.0, 0.4, &[("left_hand_hob", "1"), ("hob_radius", "60 mm")]),
            (35.0, 1.0, &[("face_width", "60 mm")]),
        ] {
            is_space_of_modified(spec, 4.0, -18.0, teeth, shift, otherwise);
        }
    }
    for crowning in ["0.3 mm", "-0.3 mm"] {
        is_space_of_modified("crowned_gear", 4.0, -18.0, 27.0, 0.4, &[("crowning", crowning)]);
    }
}

#[test]
fn of_a_gear_by_six_axes_at_once() {
    for (teeth, shift, otherwise) in [
        (35.0, 0.275, &[][..]),
        (35.0, 5.0, &[]),
        (35.0, -4.0, &[]),
        (12.0, 0.275, &[]),
        (80.0, 1.0, &[]),
        (35.0, 3.0, &[("hob_starts", "3")]),
        (35.0, 0.275, &[("hob_starts", "1")]),
        (35.0, 0.275, &[("left_hand_hob", "1"), ("hob_shift", "20 mm")]),
        (35.0, 0.275, &[("face_width", "90 mm")]),
    ] {
        is_space_of_modified("chang_tsay_nagata", 2.75, 17.0, teeth, shift, otherwise);
    }
}

#[test]
fn of_the_ideal_gear_of_a_real_hob() {
    for starts in [1, 2] {
        for (shift, feed) in [(0.75, 3.0), (2.0, 3.0), (-3.0, 3.0), (0.75, 1.0)] {
            let gear = Gear { teeth: 31.0, helix: 22f64.to_radians(), shift: shift / 3.0 };
            let set = [
                ("hob_starts", starts.to_string()),
                ("shift", format!("{shift} mm")),
                ("feed_per_turn", format!("{feed} mm")),
                ("gashes_used", "40".to_owned()),
                ("points", "5".to_owned()),
            ];
            let error = error("real_hob", &set, 3.0, &gear);
            assert!(error.abs() < 1e-11, "{starts} starts, shift {shift} mm, feed {feed} mm: {error}");
        }
    }
}

/// In the plane of the worm's axis a ZA worm is a rack, and the wheel that it makes an involute gear.
#[test]
fn of_a_worm_wheel() {
    for (starts, face) in [(1, 28), (2, 28), (3, 28), (4, 28), (5, 20)] {
        let set = [("starts", starts.to_string()), ("face_width", format!("{face} mm"))];
        let set = set.each_ref().map(|(name, value)| (*name, value.as_str()));
        let graph = Graph::new();
        let job = job(&graph, "specs/hobbing/worm_wheel.chain", &set);
        let gear = Gear { teeth: 40.0, helix: 0.0, shift: 0.0 };
        let error = space_error(&job, ["conjugate_lower.flank", "conjugate_upper.flank"], 4.0, &gear);
        assert!(error.abs() < 1e-11, "{starts} starts: {error}");
    }
}

#[test]
fn of_diagonal_feed() {
    for (teeth, helix, ratio, face, starts) in [
        (31.0, 22.0, 0.4, 20, 1),
        (31.0, -30.0, 0.4, 20, 3),
        (12.0, 0.0, -0.4, 20, 2),
        (80.0, 22.0, 2.0, 20, 1),
        (31.0, 22.0, -2.0, 20, 1),
        (31.0, 22.0, 0.4, 90, 1),
        (31.0, 22.0, 0.4, 5, 1),
    ] {
        let gear = Gear { teeth, helix: f64::to_radians(helix), shift: 0.0 };
        let set = [
            ("teeth", teeth.to_string()),
            ("helix_angle", format!("{helix} deg")),
            ("diagonal_ratio", ratio.to_string()),
            ("face_width", format!("{face} mm")),
            ("hob_starts", starts.to_string()),
        ];
        let error = error("diagonal_gear", &set, 3.0, &gear);
        assert!(error.abs() < 1e-11, "{set:?}: {error}");
    }
}

/// An ellipse of equal axes is a circle: there the closed form of the round gear holds, in whichever space.
#[test]
fn of_a_round_elliptical_gear() {
    for (shift, space, hand) in [(0.0, 0, 0), (0.7, 0, 0), (-0.5, 3, 1), (1.0, 5, 0)] {
        let gear = Gear { teeth: 36.0, helix: 0.0, shift };
        let set = [
            ("axis_ratio", "1".to_owned()),
            ("profile_shift", shift.to_string()),
            ("space", space.to_string()),
            ("h.left_hand", hand.to_string()),
        ];
        let error = error("elliptical_gear_hobbed", &set, 3.0, &gear);
        assert!(error.abs() < 1e-11, "shift {shift}, space {space}: {error}");
    }
}

/// A spur taper gear is that of a rack whose reference plane touches the reference cone. The section at the height z cuts the rack
/// with the pressure angle atan(tan α cos δ) and has it moved out by z tan δ. A slender hob is swivelled by its lead angle and so leaves
/// that plane a little; the larger, the less.
#[test]
fn of_a_taper_gear() {
    let module = 3.0;
    for (teeth, face, cone, hob_radius, bound) in [
        (30.0, 20.0, 6.0, 400.0, 2e-4),
        (30.0, 20.0, 12.0, 400.0, 2e-4),
        (30.0, 20.0, -6.0, 400.0, 2e-4),
        (30.0, 20.0, 6.0, 40.0, 1e-3),
        (12.0, 20.0, 6.0, 40.0, 1e-3),
        (80.0, 20.0, -20.0, 400.0, 2e-4),
        (30.0, 40.0, 6.0, 90.0, 1e-3),
    ] {
        let reference = module * teeth / 2.0;
        let set = [
            ("teeth", teeth.to_string()),
            ("face_width", format!("{face} mm")),
            ("cone_angle", format!("{cone} deg")),
            ("hob_radius", format!("{hob_radius} mm")),
        ];
        let set = set.each_ref().map(|(name, value)| (*name, value.as_str()));
        let graph = Graph::new();
        let job = job(&graph, "specs/hobbing/beveloid.chain", &set);
        for name in ["lower_flank", "upper_flank"] {
            assert!(sampled(&job, name).iter().all(|point| point.outcome == Outcome::Solved), "{set:?}, {name}");
        }
        let cone = f64::to_radians(cone);
        let transverse = (alpha().tan() * cone.cos()).atan();
        for (z, height) in [(0.0, 0.0), (0.0, 1.5), (-0.3 * face, 0.5), (0.3 * face, 0.0)] {
            let radius = reference + z * cone.tan() + height;
            let [lower, upper] = ["lower_flank", "upper_flank"].map(|name| {
                let point = &grid(&job, name, ["z", "rho"], &[[z, radius]], 1)[0];
                assert_eq!(point.outcome, Outcome::Solved, "{cone}, {z}, {height}");
                point.position[1].atan2(point.position[0])
            });
            let moved_out = z * cone.tan();
            let space = (PI * module / 2.0 - 2.0 * moved_out * transverse.tan()) / reference
                + 2.0 * (involute((reference * transverse.cos() / radius).acos()) - involute(transverse));
            let error = (reduced(upper - lower) - space) * radius;
            assert!(error.abs() < bound, "{cone}, hob of {hob_radius} mm, z {z}, {height} over the cone: {error}");
        }
    }
}
