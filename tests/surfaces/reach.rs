//! Which points are solved depends on what the ranges hold, not on how they are sampled or where the middle of the grid lies.

use flank_expr::Graph;
use flank_solver::{Outcome, SurfacePoint};
use flank_tests::{difference, job, job_of_text, problem, sampled};

fn is_solved(point: &SurfacePoint) -> bool {
    point.outcome == Outcome::Solved
}

/// A short rack planes a gear of radius 40 mm; most of what is asked for lies above the tooth, or beside the gear.
const PLANED: &str = "
machine planer {
    param d : length = 40 mm
    axis Y : linear
    axis C : rotary
    frame bed
    frame slide in bed = translate(d, Y, 0 mm)
    frame table in bed = rotate_z(C)
}
tool rack_tooth {
    surface flank(u: length in -4 mm .. 4 mm, v: length in -10 mm .. 10 mm) {
        at = [-u * cos(20 deg), 3.1 mm - u * sin(20 deg), v]
        body towards [0, -1, 0]
    }
}
job planed {
    machine m = planer
    tool r = rack_tooth
    mount r on m.slide
    motion roll : angle in -40 deg .. 40 deg
    drive m.C = roll
    drive m.Y = 40 mm * roll
    surface f in m.table = envelope(r.flank, over: roll)
    sample f { rho: 38 mm .. 78 mm by 21, z: -100 mm .. 10 mm by 12 }
}
";

/// The middle of the sample lies beyond the rack. However fine the grid is, what is solved are the points up to the radius at which
/// the rack ends, 4 mm along its flank from the pitch line, and within its width.
#[test]
fn points_in_range_are_solved_wherever_the_middle_is() {
    let graph = Graph::new();
    let job = job_of_text(&graph, PLANED);
    let surface = &job.surfaces[0];
    let sample = surface.sample.as_ref().expect("it is sampled");
    let problem = problem(&job, surface, sample.functions());
    for fineness in [1, 3] {
        let counts = sample.counts.map(|count| fineness * (count - 1) + 1);
        let share = |k: usize, count: usize| k as f64 / (count - 1) as f64;
        let target = |k: usize| {
            [38.0 + 40.0 * share(k / counts[1], counts[0]), -100.0 + 110.0 * share(k % counts[1], counts[1])]
        };
        let targets: Vec<[f64; 2]> = (0..counts[0] * counts[1]).map(target).collect();
        let points = problem.solve(&targets, counts).0;
        for ([rho, z], point) in targets.iter().zip(&points) {
            // a point at u from the pitch line touches where its normal goes through the pitch point
            let (sin, cos) = 20f64.to_radians().sin_cos();
            let at = |u: f64| (40.0 - u * cos).hypot(u * cos * cos / sin);
            let is_expected = *rho <= at(-4.0).max(at(4.0)) && *z >= -10.0 - 1e-9;
            assert_eq!(is_solved(point), is_expected, "{rho} {z}: {:?}", point.outcome);
        }
        assert!(points.iter().any(is_solved));
    }
}

/// Each point that wider ranges of the thread give is solved if it is within, the same, and outside if not; how many are.
fn is_part_of_wider(
    spec: &str,
    set: &[(&str, &str)],
    narrow: [(&str, &str); 2],
    wide: [(&str, &str); 2],
) -> Vec<usize> {
    let graphs = [Graph::new(), Graph::new()];
    let few = job(&graphs[0], spec, &[set, &narrow].concat());
    let all = job(&graphs[1], spec, &[set, &wide].concat());
    let count = |surface: &str, unknown: usize| {
        let range = &few.surfaces.iter().find(|s| s.name == surface).expect("it is there").unknowns[unknown];
        let (part, whole) = (sampled(&few, surface), sampled(&all, surface));
        for (point, wider) in part.iter().zip(&whole) {
            let is_within = is_solved(wider) && (range.low..=range.high).contains(&wider.unknowns[unknown]);
            assert_eq!(is_solved(point), is_within, "{surface}: {point:?} {wider:?}");
            assert!(!is_within || difference(&point.position, &wider.position) < 1e-9, "{surface}: another branch");
            assert!(is_within || !is_solved(wider) || matches!(point.outcome, Outcome::Outside { .. }), "{point:?}");
        }
        part.iter().filter(|point| is_solved(point)).count()
    };
    // the thread's angle
    ["lower_flank", "upper_flank"].map(|surface| count(surface, 1)).to_vec()
}

/// The hob's thread does not reach the middle of this tooth space: what it does reach is of this space and not of the next one.
#[test]
fn what_is_kept_does_not_change_with_what_is_reached() {
    let spec = "specs/hobbing/elliptical_gear_hobbed.chain";
    let set = [("axis_ratio", "0.85"), ("space", "9")];
    let narrow = [("h.thread_from", "-1200 deg"), ("h.thread_to", "1200 deg")];
    let wide = [("h.thread_from", "-1200 deg"), ("h.thread_to", "2400 deg")];
    assert_eq!(is_part_of_wider(spec, &set, narrow, wide), [121, 66]);
}

/// With a diagonal feed a turn of the spindle changes the work: its angle is followed beyond one turn, and told as outside.
#[test]
fn angles_are_followed_beyond_a_turn() {
    let spec = "specs/hobbing/diagonal_gear.chain";
    let narrow = [("h.thread_from", "-400 deg"), ("h.thread_to", "400 deg")];
    let wide = [("h.thread_from", "-1440 deg"), ("h.thread_to", "1440 deg")];
    assert_eq!(is_part_of_wider(spec, &[("diagonal_ratio", "-2")], narrow, wide), [150, 150]);
}
