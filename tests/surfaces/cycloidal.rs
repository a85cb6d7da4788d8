//! Discs that roll within a ring of pins, against the published closed form of cycloidal drives.

use std::f64::consts::{PI, TAU};

use flank_expr::Graph;
use flank_solver::{ContactPoint, ContactProblem, Outcome};
use flank_tests::pairs::with_contact;
use flank_tests::{assert_point, job, points, sampled};

const DISC: &str = "specs/cycloidal/cycloidal_disc.chain";
const HOUSED: &str = "specs/pairs/cycloidal_drive.chain";
const GEROTOR: &str = "specs/cycloidal/gerotor.chain";

/// Pins, eccentricity, radius of the ring and of a pin, mm.
#[derive(Clone, Copy)]
struct Drive(f64, f64, f64, f64);

impl Drive {
    /// Position and outward normal of the disc at an angle of the ring, as textbooks on cycloidal drives have them (y upwards here).
    fn published(self, angle: f64) -> ([f64; 3], [f64; 3]) {
        let Drive(n, e, ring, pin) = self;
        let lean = ((1.0 - n) * angle).sin().atan2(ring / (e * n) - ((1.0 - n) * angle).cos());
        let x = ring * angle.cos() - pin * (angle + lean).cos() - e * (n * angle).cos();
        let y = ring * angle.sin() - pin * (angle + lean).sin() - e * (n * angle).sin();
        ([x, y, 0.0], [(angle + lean).cos(), (angle + lean).sin(), 0.0])
    }

    /// The largest pin whose disc is not cut under: the least radius of curvature of the pin's way, R e^(iα) − e e^(inα), on the side
    /// of the disc.
    fn largest_pin(self) -> f64 {
        let Drive(n, e, ring, _) = self;
        let bend = |k: u32| {
            // with θ = (n − 1) α; r' r'' is the same at all α but for it
            let theta = TAU * f64::from(k) / 100_000.0;
            let speed = (ring * ring + n * n * e * e - 2.0 * ring * n * e * theta.cos()).sqrt();
            (ring * ring + n.powi(3) * e * e - ring * n * (n + 1.0) * e * theta.cos()) / speed.powi(3)
        };
        1.0 / (0..100_000).map(bend).fold(0.0, f64::max)
    }

    fn set(self) -> Vec<(&'static str, String)> {
        let Drive(n, e, ring, pin) = self;
        vec![
            ("pins", format!("{n}")),
            ("eccentricity", format!("{e} mm")),
            ("ring_radius", format!("{ring} mm")),
            ("pin_radius", format!("{pin} mm")),
        ]
    }
}

#[test]
fn discs_meet_the_published_closed_form() {
    let drives = [
        (DISC, Drive(12.0, 2.5, 60.0, 6.0)),
        (DISC, Drive(10.0, 0.75, 25.0, 2.5)),
        (DISC, Drive(4.0, 3.1, 21.0, 4.0)),
        (GEROTOR, Drive(7.0, 2.85, 27.0, 8.0)),
        (GEROTOR, Drive(5.0, 3.9, 28.0, 7.5)),
    ];
    for (spec, drive) in drives {
        let set = drive.set();
        let set: Vec<(&str, &str)> = set.iter().map(|(name, value)| (*name, value.as_str())).collect();
        let graph = Graph::new();
        let job = job(&graph, spec, &set);
        // all around, at places that no lobe repeats
        let angles: Vec<f64> = (0..97).map(|k| -PI + TAU * (f64::from(k) + 0.5) / 97.0).collect();
        let targets: Vec<[f64; 2]> = angles.iter().map(|angle| [angle * (drive.0 - 1.0), 0.0]).collect();
        for (angle, point) in angles.iter().zip(points(&job, "side", ["crank", "z"], &targets)) {
            let (position, normal) = drive.published(*angle);
            assert_point(&point, position, normal, &format!("{} pins, {angle} rad", drive.0));
        }
    }
}

#[test]
fn pins_as_large_as_the_way_of_their_axis_bends_cut_under() {
    for (spec, drive) in [(DISC, Drive(12.0, 2.5, 60.0, 6.0)), (GEROTOR, Drive(7.0, 2.85, 27.0, 8.0))] {
        let largest = drive.largest_pin();
        // a little larger, the piece that is cut away lies between points that are 15 deg of the crank apart
        for (share, is_whole) in [(0.999, true), (1.02, false)] {
            let set = Drive(drive.0, drive.1, drive.2, share * largest).set();
            let set: Vec<(&str, &str)> = set.iter().map(|(name, value)| (*name, value.as_str())).collect();
            let graph = Graph::new();
            let told = sampled(&job(&graph, spec, &set), "side");
            let cut = told.iter().filter(|point| matches!(point.outcome, Outcome::CutAway(_))).count();
            let solved = told.iter().filter(|point| point.outcome == Outcome::Solved).count();
            assert_eq!(cut + solved, told.len(), "{spec}: each point is found");
            assert_eq!(cut == 0, is_whole, "{spec}: {cut} of {} with {share} of {largest} mm", told.len());
        }
    }
}

/// A disc that a larger wheel farther outside has ground, on a crank of another eccentricity: how much the wheel is larger, how much farther
/// out it passes, and how much larger the eccentricity is, mm.
#[derive(Clone, Copy, Debug)]
struct Changed(f64, f64, f64);

impl Drive {
    /// Where a flank that the wheel has ground at an angle of the ring touches the pin on x: turn of the crank and how much farther than evenly
    /// the disc has turned. In the disc's frame the pin's axis is known by the flank; the ring's axis lies on a circle about the disc's and
    /// at the ring's radius from the pin's axis.
    fn touches(self, Changed(larger, farther, eccentric): Changed, angle: f64) -> [f64; 2] {
        let Drive(n, e, ring, pin) = self;
        let wheel = Drive(n, e, ring + farther, pin + larger);
        let ([x, y, _], normal) = wheel.published(angle);
        let (x, y) = (x + pin * normal[0], y + pin * normal[1]);
        let e = e + eccentric;
        let (away, towards) = (x.hypot(y), y.atan2(x));
        let between = ((ring * ring - away * away - e * e) / (2.0 * e * away)).acos();
        // of both places the one beside that of the even drive
        let off = |place: f64| (0.5 * (place - n * angle)).sin().abs();
        let places = [towards + between, towards - between];
        let place = if off(places[0]) < off(places[1]) { places[0] } else { places[1] };
        let disc = -(y + e * place.sin()).atan2(x + e * place.cos());
        let turn = place + disc;
        let lag = disc + turn / (n - 1.0);
        // of the turns of the crank that look alike the one beside the even drive
        let turns = ((turn - (n - 1.0) * angle) / TAU).round();
        [turn - TAU * turns, lag - turns * TAU / (n - 1.0)]
    }
}

/// One of both contacts of the drive at rising turns of the crank.
fn housed(drive: Drive, changed: Changed, contact: usize, turns: &[f64]) -> Vec<ContactPoint> {
    let mut set = drive.set();
    set.extend([("equidistant", format!("{} mm", changed.0)), ("offset", format!("{} mm", changed.1))]);
    let set: Vec<(&str, &str)> = set.iter().map(|(name, value)| (*name, value.as_str())).collect();
    let graph = Graph::new();
    let job = job(&graph, HOUSED, &set);
    let path = with_contact(&job, contact, &[("m.E", changed.2)], true, |pair, points| {
        ContactProblem::new(pair).expect("nothing is unbound").path(turns, points)
    });
    path.points.into_iter().map(|point| point.expect("it touches all over the turn")).collect()
}

const HOUSED_DRIVES: [Drive; 3] =
    [Drive(12.0, 2.5, 60.0, 6.0), Drive(11.0, 1.5, 50.0, 5.0), Drive(36.0, 1.2, 70.0, 3.0)];

/// Both ways around, pin by pin: the contacts are mirror images of each other, the pin that holds back stands half a ring farther.
#[test]
fn discs_turn_as_far_as_the_closed_form_of_changed_pins_has_them() {
    let changes = [
        Changed(0.0, 0.0, 0.0),
        Changed(0.03, 0.0, 0.0),
        Changed(0.0, -0.02, 0.0),
        Changed(0.02, 0.015, 0.0),
        Changed(0.0, -0.03, 0.01),
    ];
    for drive in HOUSED_DRIVES {
        let lobes = drive.0 - 1.0;
        let opposite = TAU * (0.5 * drive.0).floor() / drive.0;
        for changed in changes {
            // lobes are passed over by turns of the crank of 30 to 130 degrees
            let rows: Vec<[f64; 2]> =
                (0..=10).map(|k| drive.touches(changed, (30.0 + 10.0 * f64::from(k)).to_radians() / lobes)).collect();
            let turns: Vec<f64> = rows.iter().map(|row| row[0]).collect();
            for (point, row) in housed(drive, changed, 0, &turns).iter().zip(&rows) {
                assert!((point.lag - row[1]).abs() < 1e-11, "{changed:?}: {row:?}, {point:?}");
            }
            let turns: Vec<f64> = turns.iter().rev().map(|turn| opposite - turn).collect();
            for (point, row) in housed(drive, changed, 1, &turns).iter().zip(rows.iter().rev()) {
                assert!((point.lag + row[1]).abs() < 1e-11, "{changed:?}: {row:?}, {point:?}");
            }
        }
        // a disc that the pins themselves would make turns evenly
        let even = drive.touches(changes[0], 1.2 / lobes);
        assert!((even[0] - 1.2).abs() < 1e-12 && even[1].abs() < 1e-13, "{even:?}");
    }
}
