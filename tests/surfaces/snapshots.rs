//! "Unchanged": a few points of each surface at nine significant digits, and what they cost.
//!
//! A snapshot does not say that a surface is right; the tests beside this one do.

use std::fmt::Write;

use flank_chain_dsl::Job;
use flank_expr::Graph;
use flank_solver::Outcome;
use flank_tests::variants::{ALL_JOINTS, EASE_OFF};
use flank_tests::{job, problem};

/// Nine significant digits, without a negative zero.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.8e}").parse().expect("a number");
    // what is zero but for rounding
    if rounded.abs() < 1e-11 { "0".to_string() } else { rounded.to_string() }
}

fn described(spec: &str) -> String {
    described_with(spec, &[])
}

fn described_with(spec: &str, set: &[(&str, &str)]) -> String {
    let graph = Graph::new();
    described_job(&job(&graph, spec, set))
}

fn described_job(job: &Job<'_>) -> String {
    let mut out = String::new();
    for surface in &job.surfaces {
        let Some(sample) = &surface.sample else {
            continue;
        };
        let coordinates = sample.functions();
        let problem = problem(job, surface, coordinates);
        let (points, effort) = problem.solve(&sample.targets(), sample.counts);
        let graph = surface.surface.position.0[0].graph();
        let constraints = graph.count(&surface.surface.constraints);
        let tape = problem.system().tape();
        let per_point = effort.evaluations as f64 / points.len() as f64;
        let _ = writeln!(
            out,
            "{}: {} nodes in the constraints, tape {} instructions in {} registers, {per_point:.1} evaluations a point",
            surface.name,
            constraints.shared,
            tape.instructions().len(),
            tape.register_count(),
        );
        let [rows, columns] = sample.counts;
        for (i, j) in [(0, 0), (0, columns - 1), (rows / 2, columns / 2), (rows - 1, 0), (rows - 1, columns - 1)] {
            let point = &points[i * columns + j];
            let numbers = point.position.iter().chain(&point.normal).chain(&point.unknowns);
            // where the search for a point that is not there ended means nothing
            let is_point = !matches!(point.outcome, Outcome::NotConverged { .. });
            let numbers: Vec<String> = numbers.filter(|_| is_point).map(|value| digits(*value)).collect();
            let _ = writeln!(out, "  {i:>2} {j:>2} {} {}", point.outcome.word(), numbers.join(" "));
        }
    }
    out
}

#[test]
fn spur_gear() {
    insta::assert_snapshot!(described("specs/hobbing/spur_gear.chain"));
}

#[test]
fn helical_gear() {
    insta::assert_snapshot!(described("specs/hobbing/helical_gear.chain"));
}

#[test]
fn pinion_19x62() {
    insta::assert_snapshot!(described("specs/bevel/pinion_19x62.chain"));
}

/// Settings of which there is a table.
#[test]
fn pinion_19x62_with_ease_off() {
    insta::assert_snapshot!(described_with("specs/bevel/pinion_19x62.chain", &EASE_OFF));
}

/// Settings of which there is a table; some points of the blank are out of the cutter's reach.
#[test]
fn pinion_19x62_with_all_joints_moving() {
    insta::assert_snapshot!(described_with("specs/bevel/pinion_19x62.chain", &ALL_JOINTS));
}

#[test]
fn gear_19x62() {
    insta::assert_snapshot!(described("specs/bevel/gear_19x62.chain"));
}

#[test]
fn conjugate_pinion_19x62() {
    insta::assert_snapshot!(described("specs/bevel/conjugate_pinion_19x62.chain"));
}

#[test]
fn rocker_cam() {
    insta::assert_snapshot!(described("specs/linkages/rocker_cam.chain"));
}

#[test]
fn hexapod_gear() {
    insta::assert_snapshot!(described("specs/hexapod/hexapod_gear.chain"));
}

#[test]
fn tilted_pinion() {
    insta::assert_snapshot!(described("specs/bevel/tilted_pinion.chain"));
}

#[test]
fn formate_gear() {
    insta::assert_snapshot!(described("specs/bevel/formate_gear.chain"));
}

#[test]
fn face_hobbed_pinion() {
    insta::assert_snapshot!(described("specs/bevel/face_hobbed_pinion.chain"));
}

#[test]
fn helixform_gear() {
    insta::assert_snapshot!(described("specs/bevel/helixform_gear.chain"));
}

#[test]
fn duplex_helical_pinion() {
    insta::assert_snapshot!(described("specs/bevel/duplex_helical_pinion.chain"));
}

#[test]
fn hypoid_pinion() {
    insta::assert_snapshot!(described("specs/bevel/hypoid_pinion.chain"));
}

#[test]
fn shaped_ring_gear() {
    insta::assert_snapshot!(described("specs/double_envelope/shaped_ring_gear.chain"));
}

#[test]
fn hourglass_worm_wheel() {
    insta::assert_snapshot!(described("specs/double_envelope/hourglass_worm_wheel.chain"));
}

#[test]
fn thread_wheel() {
    insta::assert_snapshot!(described("specs/grinding/thread_wheel.chain"));
}

#[test]
fn thesis_gear() {
    insta::assert_snapshot!(described("specs/bevel/thesis_gear.chain"));
}

#[test]
fn pair_from_blank() {
    insta::assert_snapshot!(described("specs/bevel/pair_from_blank.chain"));
}

#[test]
fn female_rotor() {
    insta::assert_snapshot!(described("specs/rotors/female_rotor.chain"));
}

#[test]
fn rotor_grinding() {
    insta::assert_snapshot!(described("specs/rotors/rotor_grinding.chain"));
}

#[test]
fn dressed_wheel() {
    insta::assert_snapshot!(described("specs/grinding/dressed_wheel.chain"));
}

#[test]
fn hindley_worm_wheel() {
    insta::assert_snapshot!(described("specs/globoid/hindley_worm_wheel.chain"));
}

#[test]
fn curvic_coupling() {
    insta::assert_snapshot!(described("specs/curvic/curvic_coupling.chain"));
}

#[test]
fn helicon_wheel() {
    insta::assert_snapshot!(described("specs/face_worm/helicon_wheel.chain"));
}

#[test]
fn honed_gear() {
    insta::assert_snapshot!(described("specs/honing/honed_gear.chain"));
}

#[test]
fn cycloidal_drive() {
    insta::assert_snapshot!(described("specs/pairs/cycloidal_drive.chain"));
}
