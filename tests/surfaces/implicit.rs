//! Tools whose surface is given by an equation or by points: the same points as by a formula, for points but for what a spline leaves.

use flank_expr::Graph;
use flank_solver::SurfacePoint;
use flank_tests::{difference, job_named, job_of_text, points};

const COMMON: &str = "
    machine lathe {
        axis Z : linear
        axis C : rotary
        frame bed
        frame slide in bed = translate(0 mm, -40 mm, Z) rotate_x(3 deg)
        frame work in bed = rotate_z(C)
    }
    tool wheel {
        param radius : length = 25 mm
        param hollow : 1 / length = 1 / 300 mm
        SURFACE
    }
    job ground {
        machine m = lathe
        tool w = wheel
        mount w on m.slide
        motion turn : angle in -60 deg .. 60 deg
        drive m.C, m.Z = turn, 6 mm * turn / 1 rad
        surface s in m.work = envelope(w.side, over: turn)
    }";

const EXPLICIT: &str = "surface side(u: length in -15 mm .. 15 mm, v: length in -8 mm .. 8 mm) {
        let reach = radius - hollow * v^2
        at = [u, sqrt(reach^2 - u^2), v]
        body towards [0, -1, 0]
    }";

fn targets() -> Vec<[f64; 2]> {
    (0..35).map(|k| [-2.0 + f64::from(k % 5), (-30.0 + 10.0 * f64::from(k / 5)).to_radians()]).collect()
}

fn ground_by(surface: &str) -> Vec<SurfacePoint> {
    let graph = Graph::new();
    let job = job_of_text(&graph, &COMMON.replace("SURFACE", surface));
    points(&job, "s", ["z", "turn"], &targets())
}

/// How far positions and normals are apart at the most.
fn apart(found: &[SurfacePoint], exact: &[SurfacePoint]) -> [f64; 2] {
    let pairs = || found.iter().zip(exact);
    assert!(pairs().all(|(one, other)| one.outcome.word() == "solved" && other.outcome.word() == "solved"));
    let positions = pairs().map(|(one, other)| difference(&one.position, &other.position));
    let normals = pairs().map(|(one, other)| difference(&one.normal, &other.normal));
    [positions.fold(0.0, f64::max), normals.fold(0.0, f64::max)]
}

#[test]
fn an_implicit_surface_is_the_one_that_its_formula_gives() {
    let implicit = "surface side(u: length in -15 mm .. 15 mm, v: length in -8 mm .. 8 mm) {
            at = [u, root(y in 1 mm .. 40 mm: u^2 + y^2 - (radius - hollow * v^2)^2), v]
            body towards [0, -1, 0]
        }";
    let [off, turned] = apart(&ground_by(implicit), &ground_by(EXPLICIT));
    assert!(off < 1e-12 && turned < 1e-12, "{off:e} mm, {turned:e}");
}

/// A cubic spline is off by h⁴ f⁗ / 384 between its points, and some times that in its first and last cells: with f⁗ up to 2.2e-3 mm⁻³ at the
/// edge of the wheel, 1.1e-3 mm for points 3.75 mm apart and 7e-5 mm for half of that.
#[test]
fn a_surface_through_points_is_the_one_that_they_lie_on() {
    let exact = ground_by(EXPLICIT);
    let [coarse, fine] = ["coarse", "fine"].map(|name| {
        let graph = Graph::new();
        let job = job_named(&graph, "tests/surfaces/specs/wheel_by_points.chain", name, &[]);
        apart(&points(&job, "s", ["z", "turn"], &targets()), &exact)
    });
    assert!(coarse[0] < 1.1e-3 && fine[0] < 1.4e-4, "{coarse:?} {fine:?}");
    // points that lie elsewhere in their cells leave less than a factor of 16
    assert!(fine[0] < coarse[0] / 5.0 && fine[1] < coarse[1] / 5.0, "{coarse:?} {fine:?}");
}
