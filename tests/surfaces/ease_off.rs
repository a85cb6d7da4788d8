//! Deviations of one flank from another: against points that are solved where the normals lead, and between the flanks of a
//! tooth space.

use flank_expr::Graph;
use flank_solver::{Alignment, Deviation, EaseOff, Outcome, SurfacePoint};
use flank_tests::{Row, bound, difference, job_named, job_of_text, library, points, reference_csv};

const SPEC: &str = "specs/bevel/ease_off_19x62.chain";
const MACHINES: [&str; 2] = ["machines/cradle.chain", "tools/face_mill.chain"];

fn held_against<'g>(job: &flank_chain_dsl::Job<'g>, surface: &str) -> Deviation {
    let generated = job.surfaces.iter().find(|s| s.name == surface).expect("the surface is in the job");
    Deviation::new(&bound(job, generated), Alignment::Turn).expect("all bound")
}

fn turned([x, y, z]: [f64; 3], turn: f64) -> [f64; 3] {
    [x * turn.cos() - y * turn.sin(), x * turn.sin() + y * turn.cos(), z]
}

/// From the point of the conjugate flank, the deviation along its normal ends on the pinion: the pinion's own point at that z and
/// that distance from the axis, turned, is the same.
#[test]
fn the_ease_off_ends_on_the_flank() {
    let [one, other] = [Graph::new(), Graph::new()];
    let (pinion, conjugate) = (job_named(&one, SPEC, "pinion", &[]), job_named(&other, SPEC, "conjugate", &[]));
    let sample = conjugate.surfaces.iter().find_map(|surface| surface.sample.as_ref()).expect("it is sampled");
    let (from, near): (Vec<SurfacePoint>, Vec<SurfacePoint>) = (
        points(&conjugate, "concave", ["z", "rho"], &sample.targets()),
        points(&pinion, "concave", ["z", "rho"], &sample.targets()),
    );
    let deviation = held_against(&pinion, "concave");
    let middle = (sample.counts[0] / 2) * sample.counts[1] + sample.counts[1] / 2;
    let turn = deviation.motion_to(from[middle].position, &near[middle]).expect("they meet");
    let found = deviation.map(&from, &near, turn);
    assert!(found[middle].expect("it is measured").abs() < 1e-12);
    for k in (0..found.len()).step_by(49) {
        let off = found[k].expect("every point is measured");
        let end: [f64; 3] = std::array::from_fn(|c| from[k].position[c] + off * from[k].normal[c]);
        let [x, y, z] = end;
        let solved = points(&pinion, "concave", ["z", "rho"], &[[z, x.hypot(y)]]).remove(0);
        assert_eq!(solved.outcome, Outcome::Solved);
        let apart = difference(&turned(solved.position, turn), &end);
        assert!(apart < 1e-10, "point {k}: {apart:e} mm");
    }
    // the numbers describe the map: what they leave of it is a small part
    let ease_off = EaseOff::of_deviations(&found, sample.counts).expect("a full map");
    let value = |k: usize| {
        let (v, u) =
            (2.0 * (k / sample.counts[1]) as f64 / 24.0 - 1.0, 2.0 * (k % sample.counts[1]) as f64 / 44.0 - 1.0);
        let [along_v, along_u] = ease_off.slopes.map(|slope| 0.5 * slope);
        along_v * v + along_u * u - ease_off.crownings[0] * v * v - ease_off.crownings[1] * u * u
            + 0.25 * ease_off.bias * v * u
    };
    let rms = |values: &dyn Fn(usize) -> f64| {
        ((0..found.len()).map(|k| values(k).powi(2)).sum::<f64>() / found.len() as f64).sqrt()
    };
    let (whole, rest) = (rms(&|k| found[k].unwrap_or(0.0)), rms(&|k| found[k].unwrap_or(0.0) - value(k)));
    assert!(rest < 0.2 * whole, "{rest} of {whole}");
}

/// From the points and normals of two published tables alone: the flank with ease-off against the one of the basic settings. Both list
/// the same places of the axial section, so each pair lies on one circle about the axis, and the way along the normal follows from the
/// tangent plane; what the plane leaves out is a square of some 0.3 mm over twice a radius of curvature of 100 mm, 0.5 um.
#[test]
fn the_numbers_follow_from_the_tables() {
    let [basic, eased] = ["universal_19x62_pinion_concave.csv", "universal_19x62_pinion_concave_easeoff.csv"]
        .map(|table| reference_csv(table).into_iter().filter(|row| row.get("j_prof") > 0.0).collect::<Vec<Row>>());
    let position = |row: &Row| ["X", "Y", "Z"].map(|column| row.get(column));
    let out = |row: &Row| ["nx", "ny", "nz"].map(|column| -row.get(column));
    let angle = |[x, y, _]: [f64; 3]| y.atan2(x);
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // four of five heights, the lowest lies on the rounding; the table runs from toe to heel, each from root to tip
    let middle =
        basic.iter().position(|row| [row.get("i_len"), row.get("j_prof")] == [2.0, 3.0]).expect("it is listed");
    let turn = angle(position(&basic[middle])) - angle(position(&eased[middle]));
    let by_hand: Vec<f64> = basic
        .iter()
        .zip(&eased)
        .map(|(from, to)| {
            let (there, normal) = (turned(position(to), turn), turned(out(to), turn));
            let way: [f64; 3] = std::array::from_fn(|k| there[k] - position(from)[k]);
            1e3 * dot(way, normal) / dot(out(from), normal)
        })
        .collect();
    // the sums of a parabola over a grid that is symmetric: each term for itself
    let share = |row: &Row| [(row.get("j_prof") - 1.0) / 1.5 - 1.0, row.get("i_len") / 2.0 - 1.0];
    let term = |of: &dyn Fn([f64; 2]) -> f64| {
        let sums = basic.iter().zip(&by_hand).map(|(row, off)| (of(share(row)) * off, of(share(row)).powi(2)));
        let (product, square) = sums.fold((0.0, 0.0), |(a, b), (product, square)| (a + product, b + square));
        product / square
    };
    // means of the squares of −1, −1/3, 1/3, 1 and of −1, −1/2, 0, 1/2, 1
    let (mean_v, mean_u) = (5.0 / 9.0, 0.5);
    let wanted = [
        2.0 * term(&|[v, _]| v),
        2.0 * term(&|[_, u]| u),
        -term(&|[v, _]| v * v - mean_v),
        -term(&|[_, u]| u * u - mean_u),
        4.0 * term(&|[v, u]| v * u),
    ];

    let [one, other] = [Graph::new(), Graph::new()];
    let (pinion, base) = (job_named(&one, SPEC, "pinion", &[]), job_named(&other, SPEC, "basic", &[]));
    let targets: Vec<[f64; 2]> = basic.iter().map(|row| [row.get("z"), row.get("R")]).collect();
    let [near, from] = [&pinion, &base].map(|job| points(job, "concave", ["z", "rho"], &targets));
    let deviation = held_against(&pinion, "concave");
    let found_turn = deviation.motion_to(from[middle].position, &near[middle]).expect("they meet");
    assert!((found_turn - turn).abs() < 1e-9, "{found_turn} {turn}");
    let map: Vec<f64> =
        deviation.map(&from, &near, found_turn).into_iter().map(|off| 1e3 * off.expect("it is measured")).collect();
    assert!(difference(&map, &by_hand) < 0.5, "{map:?} {by_hand:?}");
    // by rows from root to tip, as a sample would ask for them
    let by_rows: Vec<Option<f64>> = (0..20).map(|k| Some(map[k % 5 * 4 + k / 5])).collect();
    let found = EaseOff::of_deviations(&by_rows, [4, 5]).expect("a full map");
    let found = [found.slopes[0], found.slopes[1], found.crownings[0], found.crownings[1], found.bias];
    assert!(difference(&found, &wanted) < 0.5, "{found:?} {wanted:?}");
    // what the identification of the settings was after: crownings of 50 and 25 um over the whole profile, the rest zero
    let whole_profile = (1.0f64 / 0.75).powi(2);
    assert!((found[2] * whole_profile - 50.0).abs() < 3.0 && (found[3] - 25.0).abs() < 3.0, "{found:?}");
}

/// Between the flanks of the gear's tooth space: the turn that brings one to the other is the difference of their polar angles,
/// and the way along the normal is shorter than the arc.
#[test]
fn the_width_of_a_tooth_space() {
    let text = library(&[
        "functions/bevel.chain",
        MACHINES[0],
        MACHINES[1],
        "functions/blanks_19x62.chain",
        "bevel/gear_19x62.chain",
    ]);
    let graph = Graph::new();
    let gear = job_of_text(&graph, &text);
    let target = [26.0, 111.0];
    let [concave, convex] = ["concave", "convex"].map(|flank| points(&gear, flank, ["z", "rho"], &[target]).remove(0));
    let deviation = held_against(&gear, "concave");
    let turn = deviation.motion_to(convex.position, &concave).expect("they meet");
    let angle = |point: &SurfacePoint| point.position[1].atan2(point.position[0]);
    assert!((turn - (angle(&convex) - angle(&concave))).abs() < 1e-12);
    let width = deviation.along_normal(&convex, &concave, 0.0).expect("the normal meets the other flank");
    let arc = target[1] * turn.abs();
    assert!(width > 0.5 * arc && width < 1.1 * arc, "{width} mm along the normal, {arc} mm on the circle");
}
