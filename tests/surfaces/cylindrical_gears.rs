//! Cylindrical gears of the library against closed forms, and against each other where two processes make one gear.

use std::f64::consts::{PI, TAU};

use flank_expr::{Graph, ScalarEvaluator, Tape};
use flank_solver::{Outcome, SurfacePoint};
use flank_tests::{assert_point, job, job_named, points, sampled, turned};

const FLANKS: [&str; 2] = ["lower_flank", "upper_flank"];

fn polar(point: &SurfacePoint) -> f64 {
    point.position[1].atan2(point.position[0])
}

/// Hobs of both hands cut gears of both hands: the flanks of the left-hand hob are those of the right-hand one, turned, and the
/// two flanks by angles that differ by whole pitches, so that the teeth are as thick.
#[test]
fn hobs_of_both_hands_cut_the_same_gear() {
    for helix in ["22 deg", "-22 deg"] {
        let of_hand = |hand: &str| {
            let set = [("left_hand_hob", hand), ("helix_angle", helix)];
            let graph = Graph::new();
            let job = job(&graph, "specs/hobbing/helical_gear.chain", &set);
            FLANKS.map(|name| sampled(&job, name))
        };
        let (right, left) = (of_hand("0"), of_hand("1"));
        let turns = [0, 1].map(|k| {
            let (name, a, b) = (FLANKS[k], &right[k], &left[k]);
            let turn = polar(&a[0]) - polar(&b[0]);
            for (p, q) in a.iter().zip(b) {
                assert_point(p, turned(q.position, turn), turned(q.normal, turn), &format!("{name}, {helix}"));
            }
            turn
        });
        let pitches = (turns[0] - turns[1]) / (TAU / 31.0);
        assert!((pitches - pitches.round()).abs() < 1e-11, "{helix}: {pitches}");
    }
}

/// Diagonal feed is compensated by the table: the same gear, whatever the ratio.
#[test]
fn the_diagonal_ratio_does_not_change_the_gear() {
    let of_ratio = |ratio: &str| {
        let graph = Graph::new();
        let job = job(&graph, "specs/hobbing/diagonal_gear.chain", &[("diagonal_ratio", ratio)]);
        FLANKS.map(|name| sampled(&job, name))
    };
    let axial = of_ratio("0");
    for ratio in ["0.4", "-0.7"] {
        for ((a, b), name) in axial.iter().zip(&of_ratio(ratio)).zip(FLANKS) {
            for (p, q) in a.iter().zip(b) {
                assert_eq!(q.outcome, Outcome::Solved);
                assert_point(p, q.position, q.normal, &format!("{name}, ratio {ratio}"));
            }
        }
    }
}

/// The internal gear of a shaper's edges at the standard distance: the involute whose space has the cutter's tooth.
#[test]
fn the_shaped_internal_gear_is_an_involute() {
    let graph = Graph::new();
    let job = job_named(&graph, "specs/hobbing/shaped_gear.chain", "shaped_internal_gear", &[]);
    let alpha = 20f64.to_radians();
    let (teeth, reference) = (73.0, 109.5);
    let base = reference * alpha.cos();
    let inv = |angle: f64| angle.tan() - angle;
    let targets: Vec<[f64; 2]> = (0..20).map(|k| [107.6 + 0.23 * f64::from(k), -9.0 + f64::from(k)]).collect();
    for (name, side) in [("flank_plus", 1.0), ("flank_minus", -1.0)] {
        for (target, point) in targets.iter().zip(points(&job, name, ["rho", "z"], &targets)) {
            let [rho, z] = *target;
            let at = (base / rho).acos();
            let angle = side * (std::f64::consts::FRAC_PI_2 / teeth + inv(alpha) - inv(at));
            // the normal touches the base circle; it points out of the ring's steel, into the space
            let tangent = angle - side * at;
            let normal = [side * tangent.sin(), -side * tangent.cos(), 0.0];
            assert_point(&point, [rho * angle.cos(), rho * angle.sin(), z], normal, name);
        }
    }
}

/// Each straight piece of a rack cuts an involute of its own base circle: the flank and the chamfer over it.
#[test]
fn the_chamfer_is_an_involute_of_its_own() {
    let graph = Graph::new();
    let job = job(&graph, "specs/hobbing/semi_topped_gear.chain", &[]);
    for (piece, angle) in
        [("plus.flank", 20f64), ("minus.flank", 20.0), ("plus.chamfer", 45.0), ("minus.chamfer", 45.0)]
    {
        // flank and chamfer trim each other
        let solved: Vec<_> = sampled(&job, piece).into_iter().filter(|p| p.outcome == Outcome::Solved).collect();
        assert!(solved.len() >= 49, "{piece}");
        for point in solved {
            let ([x, y, _], [nx, ny, _]) = (point.position, point.normal);
            let base = (x * ny - y * nx).abs();
            assert!((base - 36.0 * angle.to_radians().cos()).abs() < 1e-9, "{piece}: {base}");
        }
    }
}

/// Arc lengths of the ellipse with the larger half axis 1: by the smaller half axis, at the parameters 0.3, 1.1, 2, 3.5, 5.9 and a
/// turn. By quadrature with 40 digits.
const ARCS: [(f64, [f64; 6]); 4] = [
    (
        0.8,
        [
            0.241_974_382_086_684_54,
            0.953_345_689_576_538_2,
            1.842_670_625_625_877,
            3.126_223_638_945_653_2,
            5.361_735_191_351_021,
            5.672_333_577_794_897,
        ],
    ),
    (
        0.9,
        [
            0.270_930_184_703_220_9,
            1.025_673_868_019_646_4,
            1.920_068_481_186_628_2,
            3.310_718_808_378_016,
            5.626_380_769_278_75,
            5.973_160_432_524_829,
        ],
    ),
    (
        0.94,
        [
            0.282_546_343_867_193_1,
            1.055_184_152_846_398_5,
            1.951_757_589_399_728_3,
            3.385_900_350_094_545,
            5.734_828_651_259_319,
            6.096_147_275_006_284,
        ],
    ),
    (1.0, [0.3, 1.1, 2.0, 3.5, 5.9, TAU]),
];

/// Radial slide and rack of an elliptical gear with half axes of this ratio, at a value of the motion, from the tooth space there.
fn elliptical_at(ratio: f64, t: f64) -> [f64; 2] {
    let graph = Graph::new();
    let space = (t / TAU * 36.0).round();
    let set = [("axis_ratio", ratio.to_string()), ("pivot", "0".to_owned()), ("space", space.to_string())];
    let set = set.each_ref().map(|(name, value)| (*name, value.as_str()));
    let job = job(&graph, "specs/hobbing/elliptical_gear.chain", &set);
    let axis = |name: &str| job.machines[0].axes.iter().find(|axis| axis.name == name).expect("an axis").law;
    let laws = graph.substitute(&[axis("X"), axis("Y")], &job.bindings());
    let tape = Tape::new(&laws, &[job.motions[0].variable]).expect("bound");
    let mut out = [0.0; 2];
    ScalarEvaluator::new(&tape).run(&[t], &mut out);
    [out[0], out[1] - space * PI * 3.0]
}

/// The arc length that the table of an elliptical gear follows is that of the ellipse to rounding, and the perimeter is as long as the
/// pitches of all teeth.
#[test]
fn the_arc_of_the_ellipse_is_its_integral() {
    for (ratio, arcs) in ARCS {
        // the tangent through the end of the larger half axis lies at its distance, that of the smaller one at the other
        let (a, b) = (elliptical_at(ratio, 0.0)[0], elliptical_at(ratio, PI / 2.0)[0]);
        assert!((b - ratio * a).abs() < 1e-12 * a);
        let pitches = 36.0 * 3.0 * PI;
        // a few sums of numbers as large as the perimeter, the pitches up to the space among them
        let rounding = 8.0 * f64::EPSILON * pitches;
        for (t, arc) in [0.3, 1.1, 2.0, 3.5, 5.9, TAU].into_iter().zip(arcs) {
            let normal = t + ((a - b) * t.sin() * t.cos() / (b * t.cos().powi(2) + a * t.sin().powi(2))).atan();
            let along = -a * t.cos() * normal.sin() + b * t.sin() * normal.cos();
            let off = along - elliptical_at(ratio, t)[1] - a * arc;
            assert!(off.abs() < rounding, "{ratio} at {t}: {off:e}, {rounding:e}");
        }
        assert!((a * arcs[5] - pitches).abs() < rounding, "{ratio}");
    }
}
