//! The checks themselves: each finds what is wrong in verdicts that are made wrong, and nothing in those that are right.

use std::f64::consts::{PI, TAU};

use crate::case::{Asked, Case, Coordinate, JobText};
use crate::judge::{Counts, Judged};
use crate::machine::{AXES, Kind, Machine, Motion, Range, Step};
use crate::oracle::Touched;
use crate::told::{Outcome, Point};
use crate::tool::{Blade, Shape};

/// A disc of eleven lobes by a pin that is too thick for them: between crank angles of 66 and 96 degrees the pin takes away what it
/// generates when it comes to the next lobe.
fn disc(kept: Option<Range>) -> Case {
    let machine = Machine {
        work: vec![
            Step::moved(Kind::Turn(AXES[2]), 0.0, &[1.0]),
            Step::fixed(Kind::Shift(AXES[0]), 2.5),
            Step::moved(Kind::Turn(AXES[2]), 0.0, &[-12.0 / 11.0]),
        ],
        tool: Vec::new(),
        motions: vec![Motion { name: "phi", is_angle: true, range: Range { low: -PI, high: PI } }],
    };
    let patch = [Range { low: PI / 3.0, high: 5.0 * PI / 3.0 }, Range { low: -20.0, high: 20.0 }];
    let sample = [Coordinate::Unknown(2), Coordinate::Unknown(1)].map(|by| Asked::only(&by, 0.0));
    let shape = Shape::Pin { circle: 60.0, radius: 20.0, side: 1.0 };
    Case { family: "cycloid", machine, shape, patch, sample, kept, trimmed_by: None }
}

/// What the pin touches at a crank angle, in degrees.
fn touched(case: &Case, crank: f64) -> Touched {
    let fixed = [(1, 3.0), (2, crank.to_radians())];
    let mut found = case.oracle(false).touched(&|_, _| [f64::NAN; 2], &fixed);
    assert_eq!(found.len(), 1, "{found:?}");
    found.remove(0)
}

/// A point as the program tells it.
fn told(status: &str, of: &Touched) -> Point {
    Point { row: 0, column: 0, status: status.to_owned(), position: Some(of.position), unknowns: of.unknowns.clone() }
}

fn unsolved(status: &str) -> Point {
    Point { row: 0, column: 0, status: status.to_owned(), position: None, unknowns: Vec::new() }
}

/// The kinds of what is found in a point that was asked for at a crank angle.
fn found(case: &Case, crank: f64, point: &Point) -> Vec<&'static str> {
    let asked = [(Coordinate::Unknown(2), crank.to_radians()), (Coordinate::Unknown(1), 3.0)];
    found_at(case, asked, point, false)
}

fn found_at(case: &Case, asked: [(Coordinate, f64); 2], point: &Point, is_told: bool) -> Vec<&'static str> {
    let sample = asked.map(|(by, value)| Asked::only(&by, value));
    let job = JobText { name: "made".to_owned(), sample, is_wide: false };
    let outcome = Outcome { points: vec![point.clone()], tells_of_branches: is_told, tells_of_positions: is_told };
    let findings = Judged::new(case, &job, &outcome).points(&mut Counts::default());
    findings.into_iter().map(|finding| finding.kind).collect()
}

#[test]
fn a_point_that_is_right_is_found_right() {
    let case = disc(None);
    let point = touched(&case, 20.0);
    assert_eq!(found(&case, 20.0, &told("solved", &point)), [""; 0]);
    let cut = touched(&case, 80.0);
    assert_eq!(found(&case, 80.0, &told("undercut", &cut)), [""; 0]);
    assert_eq!(found(&case, 80.0, &unsolved("undercut")), [""; 0]);
    assert_eq!(found(&case, 20.0, &unsolved("ambiguous")), [""; 0]);
}

#[test]
fn a_point_that_the_tool_takes_away_elsewhere_is_not_solved() {
    let case = disc(None);
    let cut = touched(&case, 80.0);
    let asked = [(Coordinate::Unknown(2), 80f64.to_radians()), (Coordinate::Unknown(1), 3.0)];
    assert_eq!(found(&case, 80.0, &told("solved", &cut)), ["solved_but_cut_elsewhere"]);
    assert_eq!(found_at(&case, asked, &told("solved", &cut), true), [""; 0], "it was told that this was not looked at");
    // the depth is that of plain geometry: pins of the wheel about the disc, one after the other
    let depth = (0..=36_000).map(|k| {
        let crank = f64::from(k) * TAU / 36_000.0 - PI;
        let [x, y, _] = cut.position;
        let turned = |[x, y]: [f64; 2], by: f64| [x * by.cos() - y * by.sin(), x * by.sin() + y * by.cos()];
        let [x, y] = turned([x, y], -crank * 12.0 / 11.0);
        let [x, y] = turned([x + 2.5, y], crank);
        20.0 - (x - 60.0).hypot(y)
    });
    let deepest = case.oracle(false).deepest(cut.position, None, 0.0).expect("the pin passes");
    let by_geometry = depth.fold(f64::NEG_INFINITY, f64::max);
    assert!((by_geometry + deepest.height).abs() < 1e-5 && by_geometry > 0.01, "{by_geometry} {deepest:?}");
}

#[test]
fn a_point_that_nothing_takes_away_is_not_cut() {
    let case = disc(None);
    let point = touched(&case, 20.0);
    assert_eq!(found(&case, 20.0, &told("undercut", &point)), ["cut_away_by_nothing", "lost_cut_away"]);
}

#[test]
fn a_point_off_the_tool_or_off_its_place_is_not_solved() {
    let case = disc(None);
    let point = touched(&case, 20.0);
    let off = |dx: f64, du: f64| {
        let mut moved = point.clone();
        moved.position[0] += dx;
        moved.unknowns[1] += du;
        found(&case, 20.0, &told("solved", &moved))
    };
    assert_eq!(off(1e-5, 0.0)[0], "untouched");
    assert_eq!(off(0.0, 1e-5), ["misplaced"]);
}

#[test]
fn a_point_that_is_there_is_not_lost() {
    let case = disc(None);
    for (status, kind) in
        [("not_converged", "lost_not_converged"), ("out_of_range", "lost_outside"), ("singular", "lost_singular")]
    {
        assert_eq!(found(&case, 20.0, &unsolved(status)), [kind]);
    }
    let asked = [(Coordinate::Unknown(2), 20f64.to_radians()), (Coordinate::Unknown(1), 3.0)];
    assert_eq!(
        found_at(&case, asked, &unsolved("out_of_range"), true),
        [""; 0],
        "it was told that this is not decided"
    );
}

/// Eleven lobes, and two sides of each, have points at one distance from the axis.
#[test]
fn another_branch_is_told() {
    let case = disc(None);
    let point = touched(&case, 20.0);
    let asked =
        [Coordinate::Rho, Coordinate::Unknown(1)].map(|by| (by.clone(), by.value(&point.unknowns, point.position)));
    assert_eq!(found_at(&case, asked.clone(), &told("solved", &point), false), ["second_branch_untold"]);
    assert_eq!(found_at(&case, asked, &told("solved", &point), true), [""; 0]);
}

#[test]
fn what_is_kept_out_is_neither_solved_nor_missed() {
    let case = disc(Some(Range { low: 0.5, high: 1.0 }));
    let point = touched(&case, 20.0);
    assert_eq!(found(&case, 20.0, &told("solved", &point)), ["solved_but_not_kept"]);
    assert_eq!(found(&case, 20.0, &unsolved("out_of_range")), [""; 0]);
}

/// A globoid worm cuts its wheel all over, and in the position in which its own blade stood a line that does not depend on when.
#[test]
fn a_surface_that_is_a_line_is_not_solved() {
    let blade = Blade { distance: 125.0, ratio: -0.025, direction: -0.37, base: 40.0, middle: 91.65, side: 1.0 };
    let machine = Machine {
        work: vec![Step::moved(Kind::Turn(AXES[2]), 0.0, &[blade.ratio])],
        tool: vec![
            Step::fixed(Kind::Shift(AXES[0]), blade.distance),
            Step::fixed(Kind::Turn(AXES[0]), -0.5 * PI),
            Step::moved(Kind::Turn(AXES[2]), 0.0, &[1.0]),
        ],
        ..disc(None).machine
    };
    let patch = [Range { low: -6.0, high: 6.0 }, Range { low: -PI, high: PI }];
    let case = Case { machine, shape: Shape::Turned { blade, side: -1.0 }, patch, ..disc(None) };
    let unknowns = vec![2.0, 0.4, 0.4];
    let point = Touched { position: case.oracle(false).position(&unknowns), unknowns };
    let asked = [(Coordinate::Unknown(0), 2.0), (Coordinate::Unknown(1), 0.4)];
    assert_eq!(found_at(&case, asked, &told("solved", &point), true), ["solved_but_a_line"]);
}

#[test]
fn what_two_jobs_say_of_a_point_is_compared() {
    let case = disc(None);
    let [one, two] = [20.0, 25.0].map(|crank| touched(&case, crank));
    let job = |is_wide: bool| JobText { name: "made".to_owned(), sample: case.sample.clone(), is_wide };
    let kinds = |mine: Point, its: Point, is_wide: bool, is_told: bool| {
        let outcome = |point: Point, is_told: bool| Outcome {
            points: vec![point],
            tells_of_branches: is_told,
            tells_of_positions: false,
        };
        let (plain, other) = (job(false), job(is_wide));
        let (mine, its) = (outcome(mine, false), outcome(its, is_told));
        Judged::new(&case, &plain, &mine).against(&Judged::new(&case, &other, &its), &[(0, 0)], "other").len()
    };
    let solved = |point: &Touched| told("solved", point);
    assert_eq!(kinds(solved(&one), solved(&one), false, false), 0);
    assert_eq!(kinds(solved(&one), solved(&two), false, false), 1);
    assert_eq!(kinds(solved(&one), solved(&two), false, true), 0);
    assert_eq!(kinds(solved(&one), unsolved("out_of_range"), false, false), 1);
    assert_eq!(kinds(unsolved("undercut"), solved(&one), false, false), 1);
    assert_eq!(kinds(solved(&one), unsolved("ambiguous"), false, false), 0);
    assert_eq!(kinds(solved(&one), unsolved("out_of_range"), true, false), 1);
    assert_eq!(kinds(unsolved("out_of_range"), solved(&one), true, false), 0, "wider ranges reach more");
}
