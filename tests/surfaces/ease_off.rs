//! Deviations of one flank from another: against points that are solved where the normals lead, and between the flanks of a
//! tooth space.

use flank_expr::Graph;
use flank_solver::{Deviation, EaseOff, Outcome, Range, SurfacePoint};
use flank_tests::{difference, job_of_text, library, points};

const MACHINES: [&str; 2] = ["machines/cradle.chain", "tools/face_mill.chain"];

fn jobs(spec: &str) -> [String; 2] {
    let text = library(&[MACHINES[0], MACHINES[1], spec]);
    let (first, second) = text.rsplit_once("job ").expect("two jobs");
    let (machines, first) = first.split_once("job ").expect("two jobs");
    [first, second].map(|job| format!("{machines}job {job}"))
}

fn held_against<'g>(job: &flank_chain_dsl::Job<'g>, surface: &str) -> Deviation {
    let generated = job.surfaces.iter().find(|s| s.name == surface).expect("the surface is in the job");
    let ranges = generated.unknowns.iter().map(|u| Range { low: u.low, high: u.high }).collect();
    Deviation::new(&generated.surface, ranges, &job.bindings()).expect("all bound")
}

fn turned([x, y, z]: [f64; 3], turn: f64) -> [f64; 3] {
    [x * turn.cos() - y * turn.sin(), x * turn.sin() + y * turn.cos(), z]
}

/// From the point of the conjugate flank, the deviation along its normal ends on the pinion: the pinion's own point at that z and
/// that distance from the axis, turned, is the same.
#[test]
fn the_ease_off_ends_on_the_flank() {
    let [pinion, conjugate] = jobs("bevel/ease_off_19x62.chain");
    let [one, other] = [Graph::new(), Graph::new()];
    let (pinion, conjugate) = (job_of_text(&one, &pinion), job_of_text(&other, &conjugate));
    let sample = conjugate.surfaces.iter().find_map(|surface| surface.sample.as_ref()).expect("it is sampled");
    let (from, near): (Vec<SurfacePoint>, Vec<SurfacePoint>) = (
        points(&conjugate, "concave", ["z", "rho"], &sample.targets),
        points(&pinion, "concave", ["z", "rho"], &sample.targets),
    );
    let deviation = held_against(&pinion, "concave");
    let middle = (sample.counts[0] / 2) * sample.counts[1] + sample.counts[1] / 2;
    let turn = deviation.turn_to(from[middle].position, &near[middle]).expect("they meet");
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
    let ease_off = EaseOff::of(&found, sample.counts).expect("a full map");
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

/// Between the flanks of the gear's tooth space: the turn that brings one to the other is the difference of their polar angles,
/// and the way along the normal is shorter than the arc.
#[test]
fn the_width_of_a_tooth_space() {
    let text = library(&["functions/bevel.chain", MACHINES[0], MACHINES[1], "bevel/gear_19x62.chain"]);
    let graph = Graph::new();
    let gear = job_of_text(&graph, &text);
    let target = [26.0, 111.0];
    let [concave, convex] = ["concave", "convex"].map(|flank| points(&gear, flank, ["z", "rho"], &[target]).remove(0));
    let deviation = held_against(&gear, "concave");
    let turn = deviation.turn_to(convex.position, &concave).expect("they meet");
    let angle = |point: &SurfacePoint| point.position[1].atan2(point.position[0]);
    assert!((turn - (angle(&convex) - angle(&concave))).abs() < 1e-12);
    let width = deviation.along_normal(&convex, &concave, 0.0).expect("the normal meets the other flank");
    let arc = target[1] * turn.abs();
    assert!(width > 0.5 * arc && width < 1.1 * arc, "{width} mm along the normal, {arc} mm on the circle");
}
