//! Several branches in the ranges: none is followed on to another one, none is taken silently, and which one is taken does not depend on
//! how many points a sample has.

use flank_chain_dsl::{Job, compile_file, compile_text};
use flank_expr::Graph;
use flank_solver::{GridReport, Outcome, SurfacePoint};
use flank_tests::{difference, problem, repository};

/// The points of a surface at its sample, which has so many rows and columns.
fn solved(job: &Job<'_>, surface: &str) -> (Vec<SurfacePoint>, GridReport) {
    let surface = job.surfaces.iter().find(|s| s.name == surface).expect("the surface is in the job");
    let sample = surface.sample.as_ref().expect("points are asked for");
    let coordinates = sample.functions();
    problem(job, surface, coordinates).solve(&sample.targets(), sample.counts)
}

fn text(name: &str) -> String {
    std::fs::read_to_string(repository("tests/surfaces/specs").join(name)).expect("the spec is there")
}

/// The points of a spec with one surface, whose sample has other counts than it says there.
fn with_counts(spec: &str, counts: [[usize; 2]; 2]) -> (Vec<SurfacePoint>, GridReport) {
    let graph = Graph::new();
    let mut text = text(spec);
    for [own, other] in counts {
        assert!(text.contains(&format!(" by {own}\n")));
        text = text.replacen(&format!(" by {own}\n"), &format!(" by {other}\n"), 1);
    }
    let compilation = compile_text(&graph, spec, &text, &[]);
    assert!(!compilation.has_errors());
    solved(&compilation.jobs[0], "f")
}

fn is_solved(point: &SurfacePoint) -> bool {
    point.outcome == Outcome::Solved
}

/// The wheel of a globoid drive has two branches that cross along a line over the whole of its sample. On one of them, on which both
/// motions are equal, the surface is a line in space: no point of it is solved. The other one is followed up to the crossing; beyond, the
/// tool cuts away what it generates.
#[test]
fn no_step_leads_on_to_a_branch_that_crosses() {
    let graph = Graph::new();
    let compilation = compile_file(&graph, &repository("tests/surfaces/specs/hindley.chain"), &[]);
    let (points, _) = solved(&compilation.jobs[0], "wheel");
    let solved: Vec<&SurfacePoint> = points.iter().filter(|point| is_solved(point)).collect();
    assert!(solved.len() > 250, "{} points", solved.len());
    for point in solved {
        let [_, worm_turn, mesh] = point.unknowns[..] else { panic!("three unknowns") };
        assert!(worm_turn - mesh > 1e-5, "{point:?}");
    }
}

/// The search by a table over z ends undecided. A turn of the spindle away stands the next tooth, as the search by z finds.
#[test]
fn what_comes_by_again_after_a_turn_is_found() {
    let graph = Graph::new();
    let compilation = compile_file(&graph, &repository("tests/surfaces/specs/sampled_by_table.chain"), &[]);
    for job in &compilation.jobs {
        let (points, effort) = solved(job, "flank");
        assert!(points.iter().all(|point| point.outcome == Outcome::Ambiguous), "{}", job.name);
        let [one, other] = &effort.branches[..] else { panic!("{}: {:?}", job.name, effort.branches) };
        let turns = (one.unknowns[2] - other.unknowns[2]).abs() / std::f64::consts::TAU;
        assert!((turns - 1.0).abs() < 1e-9, "{}: {turns}", job.name);
    }
}

/// Between the points of a coarse grid the branch is followed as closely as in a fine one.
#[test]
fn a_coarse_grid_has_the_points_of_a_fine_one() {
    let (coarse, _) = with_counts("branch_that_ends.chain", [[3, 3], [6, 6]]);
    assert_eq!(coarse.iter().filter(|point| is_solved(point)).count(), 10);
    for fineness in [2, 5] {
        let columns = 5 * fineness + 1;
        let (fine, _) = with_counts("branch_that_ends.chain", [[3, 3], [6, columns]]);
        for (k, point) in coarse.iter().enumerate() {
            let same = &fine[k / 6 * columns + k % 6 * fineness];
            assert_eq!(is_solved(point), is_solved(same), "{point:?} {same:?}");
            assert!(!is_solved(point) || difference(&point.position, &same.position) < 1e-9);
        }
    }
}

/// Two branches, neither of them in the middle: whatever the grid, the same one is taken, and the other one told.
#[test]
fn which_branch_is_taken_does_not_depend_on_the_counts() {
    let (coarse, told) = with_counts("two_branches.chain", [[6, 6], [9, 9]]);
    assert!(coarse.iter().any(is_solved) && !told.elsewhere.is_empty());
    let (fine, told) = with_counts("two_branches.chain", [[6, 26], [9, 41]]);
    assert!(!told.elsewhere.is_empty());
    for (k, point) in coarse.iter().enumerate() {
        let same = &fine[5 * (k / 9) * 41 + 5 * (k % 9)];
        assert_eq!(is_solved(point), is_solved(same), "{point:?} {same:?}");
        assert!(!is_solved(point) || difference(&point.position, &same.position) < 1e-9);
    }
}

/// Both sides of a lobe meet in a fold, between the places at which branches are looked for; the `keep` takes the second one only beside
/// the fold. It is looked for across the fold, and told.
#[test]
fn the_other_sheet_of_a_fold_is_told() {
    let graph = Graph::new();
    let compilation = compile_file(&graph, &repository("tests/surfaces/specs/folded.chain"), &[]);
    let (points, effort) = solved(&compilation.jobs[0], "f");
    assert_eq!(points.iter().filter(|point| is_solved(point)).count(), 24);
    let [other] = &effort.elsewhere[..] else { panic!("{:?}", effort.elsewhere) };
    let own = other.beside.as_ref().expect("the sheet that was followed has a point there");
    let [one, two] = [&other.root, own].map(|root| root.unknowns[2]);
    assert!(two > 0.0 && (one + two).abs() < 1e-9, "{one} {two}");
}

/// A `keep` that lies across the seam of a motion's full turn holds on both sides of it: a cam with three lobes has two points of each radius in
/// the half turn about the seam, mirror images of each other.
#[test]
fn what_is_kept_goes_on_beyond_the_seam_of_a_turn() {
    let of = |motion: &str, keep: &str| {
        let graph = Graph::new();
        let spec =
            text("cam_over_the_seam.chain").replace("-180 deg .. 180 deg", motion).replace("90 deg .. 269 deg", keep);
        let compilation = compile_text(&graph, "cam", &spec, &[]);
        assert!(!compilation.has_errors(), "{:?}", compilation.diagnostics);
        solved(&compilation.jobs[0], "lobe")
    };
    for motion in ["-180 deg .. 180 deg", "0 deg .. 360 deg"] {
        let (points, effort) = of(motion, "90 deg .. 269 deg");
        assert!(points.iter().all(|point| point.outcome == Outcome::Ambiguous), "{motion}");
        assert_eq!(effort.branches.len(), 2, "{motion}");
        let [before, after] = ["90 deg .. 180 deg", "180 deg .. 269 deg"].map(|keep| of(motion, keep).0);
        for (a, b) in before.iter().zip(&after) {
            assert!(is_solved(a) && is_solved(b), "{motion}: {a:?} {b:?}");
            let mirrored = [b.position[0], -b.position[1], b.position[2]];
            assert!(difference(&a.position, &mirrored) < 1e-12, "{motion}: {a:?} {b:?}");
        }
    }
}
