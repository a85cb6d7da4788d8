//! Surfaces that are compiled once for many values of their settings: the same as those that are derived anew with these values.

use flank_expr::{Expr, Graph};
use flank_solver::{BoundSurface, Outcome, Range, SurfaceFamily, SurfacePoint};
use flank_tests::{difference, followed, jobs, problem, shipped};

/// Cases of each job, unless `FAMILY_CASES` says how many, and of those whose studies are usual.
const CASES: u64 = 3;
const MANY: u64 = 1000;
const USUAL: [&str; 2] = ["specs/bevel/pinion_19x62.chain", "specs/hobbing/helical_gear.chain"];
/// Points of a sample are thinned to so many rows and columns.
const LINES: usize = 5;
/// How far settings are off: of lengths mm, of angles radians, of others shares.
const OFF: f64 = 1e-4;
/// How far points may lie off the surface that is derived anew, mm: numbers of a case are folded in other places.
const SAME: f64 = 1e-11;
/// How far they may be apart along it: the coordinates that points of Hindley's worm wheel are asked for by nearly run along each other
/// (3.6e-10 mm at the most; those of all others stay below 1e-11).
const ALONG: f64 = 1e-9;

/// A number in ±1 that depends on nothing but these.
fn drawn(case: u64, k: usize) -> f64 {
    let mut z = (case * 1000 + k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

fn spread(count: usize) -> Vec<usize> {
    if count <= LINES { (0..count).collect() } else { (0..LINES).map(|k| k * (count - 1) / (LINES - 1)).collect() }
}

fn kind(point: &SurfacePoint) -> &'static str {
    point.outcome.word()
}

#[test]
fn families_are_the_surfaces_derived_anew() {
    let (mut surfaces, mut points, mut followed_cases) = (0, 0, 0);
    let mut farthest = (0.0, String::new());
    let cases = std::env::var("FAMILY_CASES").map_or(CASES, |cases| cases.parse().expect("a number of cases"));
    for spec in shipped() {
        let graph = Graph::new();
        for job in jobs(&graph, &spec, &[]) {
            let is_free = |of: &&flank_chain_dsl::Parameter<'_>| !of.is_count && !job.decisive.contains(&of.variable);
            // what follows from another parameter does not differ by itself
            let is_given = |of: &&flank_chain_dsl::Parameter<'_>| of.definition.as_constant().is_some();
            let open: Vec<_> = job.parameters.iter().filter(is_free).filter(is_given).take(6).collect();
            if open.is_empty() {
                continue;
            }
            let settings: Vec<(Expr<'_>, f64)> = open.iter().map(|of| (of.variable, of.value)).collect();
            let variables: Vec<Expr<'_>> = settings.iter().map(|(variable, _)| *variable).collect();
            for surface in &job.surfaces {
                let Some(sample) = &surface.sample else { continue };
                let lines = match sample.counts {
                    // a list of points
                    [1, count] => [vec![0], spread(count)],
                    counts => counts.map(spread),
                };
                let counts = lines.each_ref().map(Vec::len);
                let grid = sample.grid.picked(&lines);
                let targets: Vec<[f64; 2]> = (0..counts[0])
                    .flat_map(|i| (0..counts[1]).map(move |j| (i, j)))
                    .map(|(i, j)| grid.at(i, j))
                    .collect();
                let coordinates = sample.coordinates.each_ref().map(|coordinate| coordinate.value);
                let ranges: Vec<Range> =
                    surface.unknowns.iter().map(|of| Range { low: of.low, high: of.high }).collect();
                let bound = BoundSurface::new(&surface.surface, ranges, &job.bindings_beside(&variables));
                let keep: Vec<_> =
                    sample.keep.iter().map(|(of, (low, high))| (of.value, Range { low: *low, high: *high })).collect();
                let family = SurfaceFamily::new(&bound, coordinates, &settings, |made| {
                    made.following_beyond(followed(surface)).keeping(&bound, &keep)
                });
                let family = family.expect("nothing is unbound");
                let nominal = family.at(&settings.iter().map(|(_, value)| *value).collect::<Vec<f64>>());
                let nominal = nominal.solve(&targets, counts).0;
                let start = &nominal[(counts[0] / 2) * counts[1] + counts[1] / 2];
                surfaces += 1;
                for case in 0..if USUAL.contains(&spec.as_str()) { MANY } else { cases } {
                    let values: Vec<f64> = settings
                        .iter()
                        .enumerate()
                        .map(|(k, (_, value))| value + OFF * drawn(case, k) * value.abs().clamp(0.1, 10.0))
                        .collect();
                    let mut changed = job.clone();
                    let following = graph.substitute(
                        &changed.parameters.iter().map(|of| of.variable).collect::<Vec<_>>(),
                        &job.bindings_beside(&variables),
                    );
                    let numbers: Vec<(Expr<'_>, Expr<'_>)> = variables
                        .iter()
                        .zip(&values)
                        .map(|(variable, value)| (*variable, graph.constant(*value)))
                        .collect();
                    let following = graph.substitute(&following, &numbers);
                    for (of, value) in changed.parameters.iter_mut().zip(following) {
                        of.value = value.as_constant().expect("all have values");
                    }
                    let anew = problem(&changed, surface, coordinates).solve(&targets, counts).0;
                    let family = family.at(&values);
                    let searched = family.solve(&targets, counts).0;
                    let is_start = start.outcome == Outcome::Solved;
                    // what is followed counts where it is like the job itself, as studies have it
                    let near = is_start.then(|| {
                        let (points, _) = family.solve_points(&targets, counts, Some(&start.unknowns), None);
                        (0..points.len()).map(|k| points.point(k)).collect::<Vec<SurfacePoint>>()
                    });
                    let near = near.filter(|points| points.iter().map(kind).eq(nominal.iter().map(kind)));
                    followed_cases += usize::from(near.is_some());
                    for (other, how) in [(Some(searched), "searched"), (near, "followed")] {
                        for (k, (one, other)) in anew.iter().zip(other.iter().flatten()).enumerate() {
                            let at = format!("{spec}: {}.{}, case {case}, point {k}, {how}", job.name, surface.name);
                            assert_eq!(kind(one), kind(other), "{at}");
                            if one.outcome == Outcome::Solved {
                                let off = difference(&one.position, &other.position);
                                let across: f64 =
                                    (0..3).map(|k| (one.position[k] - other.position[k]) * one.normal[k]).sum();
                                assert!(across.abs() < SAME, "{at}: {across:e} mm off the surface");
                                if off > farthest.0 {
                                    farthest = (off, at);
                                }
                                points += 1;
                            }
                        }
                    }
                }
            }
        }
    }
    println!(
        "{surfaces} surfaces, {points} points, {followed_cases} grids followed, at most {:e} mm apart: {}",
        farthest.0, farthest.1
    );
    assert!(surfaces > 100 && farthest.0 < ALONG, "{surfaces} surfaces, {:e} mm: {}", farthest.0, farthest.1);
}
