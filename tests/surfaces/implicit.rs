//! Tools whose surface is given by an equation or by points: the same points as by a formula, for points but for what a spline leaves.

use flank_expr::{Graph, ScalarEvaluator, Tape};
use flank_solver::{BoundSurface, Outcome, Range, SurfaceGeometry, SurfacePoint};
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
    let by_condition =
        "surface side(u: length in -15 mm .. 15 mm, v: length in 1 mm .. 40 mm, w: length in -8 mm .. 8 mm) {
            at = [u, v, w]
            body where u^2 + v^2 < (radius - hollow * w^2)^2
        }";
    // the other way round, in the coordinates of a turned part, and in numbers a million times as large
    let around = "surface side(r: length in 1 mm .. 40 mm, a: angle in 30 deg .. 150 deg, w: length in -8 mm .. 8 mm) {
            at = [r * cos(a), r * sin(a), w]
            body where 1000000 * (radius - hollow * w^2) >= 1000000 * r
        }";
    let by_root = "surface side(u: length in -15 mm .. 15 mm, v: length in -8 mm .. 8 mm) {
            at = [u, root(y in 1 mm .. 40 mm: u^2 + y^2 - (radius - hollow * v^2)^2), v]
            body towards [0, -1, 0]
        }";
    for surface in [by_condition, around, by_root] {
        let [off, turned] = apart(&ground_by(surface), &ground_by(EXPLICIT));
        assert!(off < 1e-12 && turned < 1e-12, "{surface}: {off:e} mm, {turned:e}");
    }
}

/// The ring of a torus, a surface of the fourth degree: its outside or its inside, with the steel in it or all around it, where it cuts
/// away what it generates.
const RINGS: [&str; 3] = [
    "surface side(a: angle in 20 deg .. 160 deg, b: angle in B) {
        at = [(radius + 5 mm * cos(b)) * cos(a), (radius + 5 mm * cos(b)) * sin(a), 5 mm * sin(b)]
        body towards [-cos(a) * cos(b), -sin(a) * cos(b), -sin(b)]
    }",
    "surface side(u: length in -28 mm .. 28 mm, v: length in V, w: length in -6 mm .. 6 mm) {
        at = [u, v, w]
        body where (u^2 + v^2 + w^2 + radius^2 - (5 mm)^2)^2 < 4 * radius^2 * (u^2 + v^2)
    }",
    "surface side(r: length in V, a: angle in 20 deg .. 160 deg, w: length in -6 mm .. 6 mm) {
        at = [r * cos(a), r * sin(a), w]
        body where (r - radius)^2 + w^2 < (5 mm)^2
    }",
];

/// What is told of a point: its word, position, normal, curvatures of the surface and of the gap, and how the tool leaves it.
type Told = (&'static str, [f64; 3], [f64; 3], Vec<f64>);

/// One for each target; none of those beyond the ends of the ranges.
fn ring(surface: &str, [about, across]: [&str; 2]) -> Vec<Option<Told>> {
    let graph = Graph::new();
    let surface = surface.replace(" B)", &format!(" {about})")).replace(" V,", &format!(" {across},"));
    let job = job_of_text(&graph, &COMMON.replace("SURFACE", &surface));
    let made = &job.surfaces[0];
    let ranges = made.unknowns.iter().map(|of| Range { low: of.low, high: of.high }).collect();
    let bound = BoundSurface::new(&made.surface, ranges, &job.bindings());
    let coordinates = ["z", "turn"].map(|name| made.coordinate(name).expect("a coordinate").value);
    let geometry = SurfaceGeometry::new(&bound, &made.generation.motions, coordinates).expect("all bound");
    let own = bound.surface();
    let leaves = own.clearance_minors().into_iter().chain(own.contact_limit()).collect::<Vec<_>>();
    assert_eq!(leaves.len(), 2, "one motion");
    let leaves = Tape::new(&leaves, &own.unknowns).expect("all bound");
    let told = |point: SurfacePoint| {
        let known = geometry.at(&point.unknowns);
        let mut numbers = vec![0.0; 2];
        ScalarEvaluator::new(&leaves).run(&point.unknowns, &mut numbers);
        for curvature in [known.curvature, known.contact.induced] {
            let principal = curvature.expect("a smooth surface").principal();
            numbers.extend([principal.k1, principal.k2]);
        }
        (point.outcome.word(), point.position, point.normal, numbers)
    };
    let is_there = |point: &SurfacePoint| matches!(point.outcome, Outcome::Solved | Outcome::CutAway(_));
    points(&job, "s", ["z", "turn"], &targets())
        .into_iter()
        .map(|point| is_there(&point).then(|| told(point)))
        .collect()
}

#[test]
fn an_equation_says_what_a_formula_says_of_a_ring() {
    let sides = [["-90 deg .. 90 deg", "24 mm .. 32 mm"], ["90 deg .. 270 deg", "14 mm .. 24 mm"]];
    let hollow = |surface: &str| surface.replace("towards [-", "towards [").replace(", -", ", ").replace('<', ">");
    let rings = [RINGS.map(str::to_string), RINGS.map(hollow)];
    let mut words = Vec::new();
    for (rings, ranges) in rings.iter().flat_map(|rings| sides.map(|ranges| (rings, ranges))) {
        let [formula, others @ ..] = rings.each_ref().map(|surface| ring(surface, ranges));
        for other in others {
            let both = other.iter().zip(&formula).filter_map(|(one, exact)| Some((one.as_ref()?, exact.as_ref()?)));
            let both: Vec<(&Told, &Told)> = both.collect();
            assert!(both.len() > 30, "{} points", both.len());
            for (one, exact) in both {
                assert_eq!(one.0, exact.0);
                words.push(one.0);
                let off = [difference(&one.1, &exact.1), difference(&one.2, &exact.2)];
                assert!(off[0] < 1e-11 && off[1] < 1e-11, "{one:?} {exact:?}");
                for (a, b) in one.3.iter().zip(&exact.3) {
                    assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{:?} {:?}", one.3, exact.3);
                }
            }
        }
    }
    assert!(["solved", "undercut"].iter().all(|word| words.contains(word)), "{words:?}");
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
