//! Worm wheels: a fly cutter against the table of the hob, any number of starts, both hands, and the contact that an oversize
//! hob leaves.

use flank_expr::Graph;
use flank_solver::Outcome;
use flank_tests::{assert_point, job, number, points, reference_json, reversed, sampled, turned, vector};

const SPEC: &str = "specs/hobbing/worm_wheel.chain";

/// One tooth in tangential feed passes all places of the hob's thread, so it leaves what the hob leaves.
#[test]
fn a_fly_cutter_meets_the_table_of_the_hob() {
    let reference = reference_json("worm_wheel.json");
    let graph = Graph::new();
    let job = job(&graph, "specs/hobbing/worm_wheel_tangential.chain", &[]);
    for (surface, sigma) in [("upper.flank", 1.0), ("lower.flank", -1.0)] {
        let rows = reference["rows"].as_array().expect("a table").iter().filter(|row| number(row, "sigma") == sigma);
        let rows: Vec<_> = rows.collect();
        assert_eq!(rows.len(), 20);
        let targets: Vec<[f64; 2]> = rows.iter().map(|row| [number(row, "z"), number(row, "rho")]).collect();
        for (row, point) in rows.iter().zip(points(&job, surface, ["z", "rho"], &targets)) {
            assert_point(&point, vector(row, "p"), reversed(vector(row, "n")), surface);
        }
    }
}

/// All points of one to four starts; the left-hand wheel is the right-hand one in a mirror along its axis, flank for other flank.
#[test]
fn wheels_of_any_starts_and_both_hands() {
    for starts in ["1", "2", "3", "4"] {
        let of_hand = |hand: &str, name: &str| {
            let graph = Graph::new();
            sampled(&job(&graph, SPEC, &[("starts", starts), ("left_hand", hand)]), name)
        };
        let parts = ["flank", "rounding", "tip"].map(|part| [format!("lower.{part}"), format!("upper.{part}")]);
        for (a, b) in parts.iter().flat_map(|[lower, upper]| [(lower, upper), (upper, lower)]) {
            let (a, b) = (of_hand("0", a), of_hand("1", b));
            assert!(a.iter().chain(&b).all(|point| point.outcome == Outcome::Solved), "{starts} starts");
            let mirrored = |[x, y, z]: [f64; 3]| [x, -y, z];
            let polar = |[x, y, _]: [f64; 3]| y.atan2(x);
            let turn = polar(a[0].position) - polar(mirrored(b[0].position));
            for (p, q) in a.iter().zip(&b) {
                let image = [q.position, q.normal].map(|v| turned(mirrored(v), turn));
                assert_point(p, image[0], image[1], &format!("{starts} starts"));
            }
        }
    }
}

/// The hob plunges without cutting into the finished flank as long as the flank faces the way it came: its normal, out of the
/// wheel, has a part towards the hob. On a hob of form A that part is `(ρ tan α cos δ ± p sin δ) / √(ρ² (1 + tan² α) + p²)` at the
/// angle δ from the wheel; the spec demands that it does not vanish within the face.
#[test]
fn the_face_is_no_wider_than_a_plunging_hob_allows() {
    let (starts, tip, reduced_lead, slope) = (4.0, 25.0 - 0.8 * 4.0, 8.0, 20f64.to_radians().tan());
    let limit = tip * (tip * slope / reduced_lead).atan().sin();
    let graph = Graph::new();
    let width = format!("{} mm", 2.0 * 0.9999 * limit);
    let job = job(&graph, SPEC, &[("starts", "4"), ("oversize", "0 mm"), ("face_width", &width)]);
    for (name, side) in [("lower.flank", -1.0), ("upper.flank", 1.0)] {
        for point in sampled(&job, name) {
            assert_eq!(point.outcome, Outcome::Solved);
            let table = -starts / 40.0 * point.unknowns[2];
            let ([x, _, z], [nx, ..]) = (turned(point.position, table), turned(point.normal, table));
            let rho = (105.0 - x).hypot(z);
            let size = (rho * rho * (1.0 + slope * slope) + reduced_lead * reduced_lead).sqrt();
            let towards_hob = (slope * (105.0 - x) + side * reduced_lead * z / rho) / size;
            assert!((nx - towards_hob).abs() < 1e-9, "{name}: {nx} is not {towards_hob}");
            assert!(nx > 0.0, "{name}: {nx} at {z} mm");
        }
    }
}

/// By what turn of the wheel each point of a flank stands out beyond the conjugate one, as micrometres at the reference
/// radius, with its height on the face.
fn ease_off(set: &[(&str, &str)], side: &str) -> Vec<(f64, f64)> {
    let graph = Graph::new();
    let job = job(&graph, SPEC, set);
    let (cut, conjugate) = (sampled(&job, &format!("{side}.flank")), sampled(&job, &format!("conjugate_{side}.flank")));
    let pairs = cut.iter().zip(&conjugate).filter(|(a, b)| [a, b].iter().all(|p| p.outcome == Outcome::Solved));
    pairs
        .map(|(a, b)| {
            let ([x, y, z], [nx, ny, nz]) = (b.position, b.normal);
            let out = (a.position[0] - x) * nx + (a.position[1] - y) * ny + (a.position[2] - z) * nz;
            (out / (x * ny - y * nx).abs() * 80.0 * 1e3, z)
        })
        .collect()
}

/// Where the worm touches first: where the flank stands out most.
fn contact(ease_off: &[(f64, f64)]) -> (f64, f64) {
    *ease_off.iter().max_by(|a, b| a.0.total_cmp(&b.0)).expect("points")
}

/// A hob of the worm's size leaves no ease-off. A larger one, swivelled so that its thread lies in the wheel's teeth, frees the
/// ends of the face in proportion to its excess and leaves the contact in the middle; left unswivelled, it shifts the
/// contact off the middle, on the two flanks to opposite sides.
#[test]
fn an_oversize_hob_moves_the_contact() {
    for side in ["lower", "upper"] {
        assert!(ease_off(&[("oversize", "0 mm")], side).iter().all(|(out, _)| out.abs() < 1e-6), "{side}");
        let least = |oversize: &str| {
            let off = ease_off(&[("oversize", oversize)], side);
            assert_eq!(off.len(), 315);
            let (most, at) = contact(&off);
            assert!(most < 0.5 && at.abs() < 2.0, "{side}, {oversize}: {most} um at {at} mm");
            off.iter().map(|(out, _)| *out).fold(0.0, f64::min)
        };
        let (small, large) = (least("0.1 mm"), least("0.2 mm"));
        assert!(small < -5.0 && (large / small - 2.0).abs() < 0.05, "{side}: {small}, {large}");
    }
    let shifted = |side| contact(&ease_off(&[("oversize", "2 mm"), ("m.swivel", "0 deg")], side)).1;
    let (lower, upper) = (shifted("lower"), shifted("upper"));
    assert!(lower.abs() > 5.0 && (lower + upper).abs() < 1e-9, "{lower}, {upper}");
}
