//! Gears from a rack whose profile is made of segments: against the tables of the plain rack, and in closed form.

use flank_expr::Graph;
use flank_tests::{assert_point, difference, job, number, points, reference_json, reversed, vector};

const SPEC: &str = "specs/hobbing/ground_stock_gear.chain";
/// The plain rack's tip, and a protuberance that goes on as the flank does.
const PLAIN: [(&str, &str); 4] = [
    ("r.protuberance_angle", "20 deg"),
    ("r.protuberance_start", "1 mm"),
    ("r.tip_height", "3.75 mm"),
    ("r.tip_radius", "1.14 mm"),
];

#[test]
fn with_equal_angles_it_is_the_plain_rack() {
    let reference = reference_json("spur_rack.json");
    let graph = Graph::new();
    let job = job(&graph, SPEC, &PLAIN);
    let alpha = 20f64.to_radians();
    // the run at the datum line, and at the beginning of the rounding
    let datum = 3.0 / alpha.cos();
    let rounding = datum + (3.75 - 1.14 * (1.0 - alpha.sin())) / alpha.cos();
    for (side, sigma) in [("plus", 1.0), ("minus", -1.0)] {
        for (table, unknown) in [("flank_rows", "flank"), ("fillet_rows", "rounding")] {
            let rows = reference[table].as_array().expect("a table").iter().filter(|row| number(row, "sigma") == sigma);
            for row in rows {
                let u = number(row, "u");
                let (piece, s) = match unknown {
                    "flank" if u < 1.0 / alpha.cos() => ("flank", datum + u),
                    "flank" => ("protuberance", datum + u),
                    rounded => (rounded, rounding + 1.14 * (u - alpha)),
                };
                let surface = format!("{side}.{piece}");
                let point = &points(&job, &surface, ["s", "v"], &[[s, number(row, "v")]])[0];
                let what = format!("{surface} at {s}");
                assert_point(point, vector(row, "p"), reversed(vector(row, "n")), &what);
                assert!((point.unknowns[2] - number(row, "phi")).abs() < 1e-9, "{what}: phi");
            }
        }
    }
}

/// A straight flank of any angle gives an involute: the distance of the normal from the axis is a base radius. The tip gives
/// the root circle, and neighbouring pieces meet in the same point with the same normal where the profile has no kink.
#[test]
fn each_segment_gives_its_closed_form() {
    let graph = Graph::new();
    let job = job(&graph, SPEC, &[]);
    let (r, shift) = (36.0, 0.6);
    let ends = |name: &str| {
        let surface = job.surfaces.iter().find(|surface| surface.name == name).expect("a piece");
        (surface.unknowns[0].low, surface.unknowns[0].high)
    };
    let along = |name: &str, share: f64| {
        let (low, high) = ends(name);
        let point = points(&job, name, ["s", "v"], &[[low + (high - low) * share, 2.0]]).remove(0);
        (point.position, point.normal)
    };
    for (piece, angle) in [("plus.flank", 20f64), ("plus.protuberance", 10.0), ("minus.flank", 20.0)] {
        for share in [0.05, 0.3, 0.6, 0.95] {
            let (p, n) = along(piece, share);
            let base = (p[0] * n[1] - p[1] * n[0]).abs();
            assert!((base - r * angle.to_radians().cos()).abs() < 1e-9, "{piece} at {share}: {base}");
        }
    }
    for share in [0.0, 0.5, 1.0] {
        let (p, n) = along("plus.tip", share);
        let root = r + shift - 1.4 * 3.0;
        assert!(
            (p[0].hypot(p[1]) - root).abs() < 1e-9 && (n[0] * p[0] + n[1] * p[1] - root).abs() < 1e-9,
            "{p:?} {n:?}"
        );
    }
    for (one, next) in [("plus.protuberance", "plus.rounding"), ("plus.rounding", "plus.tip")] {
        let ((p, n), (q, m)) = (along(one, 1.0), along(next, 0.0));
        let apart = [difference(&p, &q), difference(&n, &m)];
        assert!(apart.iter().all(|apart| *apart < 1e-9), "{one} and {next}: {p:?} {q:?}");
    }
}
