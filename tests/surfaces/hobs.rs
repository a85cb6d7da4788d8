//! Hobs of the library against the closed forms of the worms that they are named after.

use flank_chain_dsl::Job;
use flank_expr::Graph;
use flank_tests::{Evaluated, difference, evaluated, job_named};

const SPEC: &str = "tests/surfaces/hobs.chain";

/// Two starts of 3 mm on a radius of 20 mm, 20 deg.
const STARTS: f64 = 2.0;
const MODULE: f64 = 3.0;
const RADIUS: f64 = 20.0;

fn lead_angle() -> f64 {
    (STARTS * MODULE / (2.0 * RADIUS)).asin()
}

/// Lead divided by 2π.
fn reduced_lead() -> f64 {
    RADIUS * lead_angle().tan()
}

fn alpha() -> f64 {
    20f64.to_radians()
}

/// A surface all over its ranges.
fn points(job: &Job<'_>, name: &str) -> Vec<(Vec<f64>, Evaluated)> {
    let surface = job.surfaces.iter().find(|surface| surface.name == name).expect("the surface is in the job");
    let along = |k: usize, share: f64| {
        let unknown = &surface.unknowns[k];
        unknown.low + (unknown.high - unknown.low) * share
    };
    let shares = [0.0, 0.21, 0.5, 0.83, 1.0];
    let at: Vec<Vec<f64>> =
        shares.iter().flat_map(|&a| shares.iter().map(move |&b| vec![along(0, a), along(1, b)])).collect();
    let found = evaluated(job, name, &at);
    at.into_iter().zip(found).collect()
}

/// An angle without whole turns, rad.
fn turned(angle: f64) -> f64 {
    (angle - (angle / std::f64::consts::TAU).round() * std::f64::consts::TAU).abs()
}

/// The polar angle at which the thread's flank has a height and a radius, less the turn of the thread to that height.
fn polar(position: [f64; 3]) -> f64 {
    position[1].atan2(position[0]) - position[2] / reduced_lead()
}

/// ZA: an axial section is a straight line, `z = h − (ρ − r₀) tan α` for the upper flank.
#[test]
fn za_is_straight_in_the_axial_section() {
    let graph = Graph::new();
    let job = job_named(&graph, SPEC, "sections", &[]);
    let half = std::f64::consts::PI * MODULE / (4.0 * lead_angle().cos());
    for (name, side) in [("za_upper.flank", 1.0), ("za_lower.flank", -1.0)] {
        for (at, point) in points(&job, name) {
            let rho = point.position[0].hypot(point.position[1]);
            let over = side * (half - (rho - RADIUS) * alpha().tan());
            let off = turned(polar(point.position) + over / reduced_lead());
            assert!(off * RADIUS < 1e-12, "{name} at {at:?}: {off:e}");
        }
    }
}

/// ZN: a plane through a radius, turned by the lead angle, cuts out a straight line. Where the flank has a radius follows
/// from the line alone: `ρ² = x² + h² sin² γ` with `h = h₀ − (x − r₀) tan α`.
#[test]
fn zn_is_straight_in_the_normal_section() {
    let graph = Graph::new();
    let job = job_named(&graph, SPEC, "sections", &[]);
    let (half, slope) = (std::f64::consts::PI * MODULE / 4.0, alpha().tan());
    let (sin, cos) = lead_angle().sin_cos();
    for (name, side) in [("zn_upper.flank", 1.0), ("zn_lower.flank", -1.0)] {
        for (at, point) in points(&job, name) {
            let rho = point.position[0].hypot(point.position[1]);
            // x² (1 + s²) − 2 x s c + c² − ρ² = 0, with h sin γ = c − s x
            let (c, s) = ((half + RADIUS * slope) * sin, slope * sin);
            let b = s * c / (1.0 + s * s);
            let x = b + (b * b + (rho * rho - c * c) / (1.0 + s * s)).sqrt();
            let h = half - (x - RADIUS) * slope;
            let straight = [x, -side * h * sin, side * h * cos];
            let off = turned(polar(point.position) - polar(straight));
            assert!(off * RADIUS < 1e-12, "{name} at {at:?}: {off:e}");
        }
    }
}

/// ZI: involutes in each transverse section. The hob that is straight in the planes that touch the base cylinder is the same.
#[test]
fn zi_is_an_involute_and_straight_in_the_base_tangent_planes() {
    let graph = Graph::new();
    let job = job_named(&graph, SPEC, "sections", &[]);
    let transverse = (alpha().tan() / lead_angle().sin()).atan();
    let base = RADIUS * transverse.cos();
    let inv = |angle: f64| angle.tan() - angle;
    let half = std::f64::consts::PI / (2.0 * STARTS) + inv(transverse);
    for (name, side) in
        [("zi_upper", 1.0), ("zi_lower", -1.0), ("tangent_upper.flank", 1.0), ("tangent_lower.flank", -1.0)]
    {
        for (at, point) in points(&job, name) {
            let [x, y, _] = point.position;
            let involute = -side * (half - inv((base / x.hypot(y)).acos()));
            let off = turned(polar(point.position) - involute);
            assert!(off * RADIUS < 1e-11, "{name} at {at:?}: {off:e}");
            // each normal touches the base cylinder and has its inclination
            let [nx, ny, nz] = point.normal;
            let flat = nx.hypot(ny);
            assert!(((x * ny - y * nx).abs() / flat - base).abs() < 1e-11, "{name}");
            assert!((nz / flat - side * base / reduced_lead()).abs() < 1e-12, "{name}");
        }
    }
}

/// The tip's cylinder ends where the flanks do.
#[test]
fn the_tip_reaches_from_edge_to_edge() {
    let graph = Graph::new();
    let job = job_named(&graph, SPEC, "sections", &[]);
    let end = |name: &str| job.surfaces.iter().find(|s| s.name == name).expect("a flank").unknowns[0].high;
    for (name, share) in [("zi_upper", -1.0), ("zi_lower", 1.0)] {
        for tau in [-2.0, 0.0, 1.3] {
            let flank = &evaluated(&job, name, &[vec![end(name), tau]])[0];
            let tip = &evaluated(&job, "zi_tip", &[vec![share, tau]])[0];
            assert!(difference(&flank.position, &tip.position) < 1e-12, "{name}");
        }
    }
}

/// The left-hand hob is the right-hand one in a mirror across its axis, with the flanks' names by the side that they face.
#[test]
fn the_other_hand_is_the_mirror_image() {
    let graph = Graph::new();
    let job = job_named(&graph, SPEC, "hands", &[]);
    let pieces = ["flank", "rounding", "tip"];
    let straight = pieces.map(|piece| (format!("left_upper.{piece}"), format!("right_lower.{piece}")));
    let involute = [("left_involute_upper", "right_involute_lower"), ("left_involute_lower", "right_involute_upper")];
    let involute = involute.map(|(left, right)| (left.to_owned(), right.to_owned()));
    for (left, right) in straight.into_iter().chain(involute) {
        for ((at, a), (_, b)) in points(&job, &left).into_iter().zip(points(&job, &right)) {
            let mirrored = |[x, y, z]: [f64; 3]| [x, y, -z];
            assert!(difference(&a.position, &mirrored(b.position)) < 1e-12, "{left} at {at:?}");
            assert!(difference(&a.normal, &mirrored(b.normal)) < 1e-12, "{left} at {at:?}");
        }
    }
}
