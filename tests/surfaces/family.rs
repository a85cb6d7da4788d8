//! Surfaces that are compiled once for many values of their settings: the same as those that are derived anew with these values.

use flank_chain_dsl::{GeneratedSurface, Job, Parameter, Sample};
use flank_expr::{Expr, Graph};
use flank_solver::{BoundSurface, Outcome, Range, SurfaceFamily, SurfacePoint};
use flank_tests::{difference, followed, jobs, problem, shipped};
use rayon::prelude::*;

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

/// What the cases of a spec gave.
#[derive(Default)]
struct Tally {
    surfaces: usize,
    points: usize,
    /// Grids that were followed from the job's own.
    followed: usize,
    /// mm, and where.
    farthest: (f64, String),
}

impl Tally {
    fn and(self, other: Tally) -> Tally {
        Tally {
            surfaces: self.surfaces + other.surfaces,
            points: self.points + other.points,
            followed: self.followed + other.followed,
            farthest: if other.farthest.0 > self.farthest.0 { other.farthest } else { self.farthest },
        }
    }

    /// Holds what a family found against the surface derived anew.
    fn compare(&mut self, anew: &[SurfacePoint], found: &[SurfacePoint], of: &str) {
        for (k, (one, other)) in anew.iter().zip(found).enumerate() {
            let at = format!("{of}, point {k}");
            assert_eq!(kind(one), kind(other), "{at}");
            if one.outcome == Outcome::Solved {
                let off = difference(&one.position, &other.position);
                let across: f64 = (0..3).map(|k| (one.position[k] - other.position[k]) * one.normal[k]).sum();
                assert!(across.abs() < SAME, "{at}: {across:e} mm off the surface");
                if off > self.farthest.0 {
                    self.farthest = (off, at);
                }
                self.points += 1;
            }
        }
    }
}

/// The job with these values of some settings, and of what follows from them.
fn changed<'g>(graph: &'g Graph, job: &Job<'g>, variables: &[Expr<'g>], values: &[f64]) -> Job<'g> {
    let mut changed = job.clone();
    let own: Vec<Expr<'g>> = changed.parameters.iter().map(|of| of.variable).collect();
    let following = graph.substitute(&own, &job.bindings_beside(variables));
    let numbers: Vec<(Expr<'g>, Expr<'g>)> =
        variables.iter().zip(values).map(|(variable, value)| (*variable, graph.constant(*value))).collect();
    let following = graph.substitute(&following, &numbers);
    for (of, value) in changed.parameters.iter_mut().zip(following) {
        of.value = value.as_constant().expect("all have values");
    }
    changed
}

/// All surfaces of a spec in so many cases each.
fn of_spec(spec: &str, cases: u64) -> Tally {
    let graph = Graph::new();
    let mut tally = Tally::default();
    for job in jobs(&graph, spec, &[]) {
        let is_free = |of: &&Parameter<'_>| !of.is_count && !job.decisive.contains(&of.variable);
        // what follows from another parameter does not differ by itself
        let is_given = |of: &&Parameter<'_>| of.definition.as_constant().is_some();
        let open: Vec<_> = job.parameters.iter().filter(is_free).filter(is_given).take(6).collect();
        if open.is_empty() {
            continue;
        }
        let settings: Vec<(Expr<'_>, f64)> = open.iter().map(|of| (of.variable, of.value)).collect();
        for surface in &job.surfaces {
            if let Some(sample) = &surface.sample {
                tally = tally.and(of_surface(spec, (&job, surface, sample), &settings, cases));
            }
        }
    }
    tally
}

fn of_surface<'g>(
    spec: &str,
    (job, surface, sample): (&Job<'g>, &GeneratedSurface<'g>, &Sample<'g>),
    settings: &[(Expr<'g>, f64)],
    cases: u64,
) -> Tally {
    let graph = surface.surface.position.0[0].graph();
    let variables: Vec<Expr<'g>> = settings.iter().map(|(variable, _)| *variable).collect();
    let lines = match sample.counts {
        // a list of points
        [1, count] => [vec![0], spread(count)],
        counts => counts.map(spread),
    };
    let counts = lines.each_ref().map(Vec::len);
    let grid = sample.grid.picked(&lines);
    let targets: Vec<[f64; 2]> =
        (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j))).map(|(i, j)| grid.at(i, j)).collect();
    let coordinates = sample.functions();
    let ranges: Vec<Range> = surface.unknowns.iter().map(|of| Range { low: of.low, high: of.high }).collect();
    let bound = BoundSurface::new(&surface.surface, ranges, &job.bindings_beside(&variables));
    let keep: Vec<_> =
        sample.keep.iter().map(|(of, (low, high))| (of.value, Range { low: *low, high: *high })).collect();
    let family = SurfaceFamily::new(&bound, coordinates, settings, |made| {
        made.following_beyond(followed(surface)).keeping(&bound, &keep)
    });
    let family = family.expect("nothing is unbound");
    let nominal = family.at(&settings.iter().map(|(_, value)| *value).collect::<Vec<f64>>());
    let nominal = nominal.solve(&targets, counts).0;
    let start = &nominal[(counts[0] / 2) * counts[1] + counts[1] / 2];
    let mut tally = Tally { surfaces: 1, ..Tally::default() };
    for case in 0..cases {
        let off = |k: usize, value: f64| value + OFF * drawn(case, k) * value.abs().clamp(0.1, 10.0);
        let values: Vec<f64> = settings.iter().enumerate().map(|(k, (_, value))| off(k, *value)).collect();
        let anew = problem(&changed(graph, job, &variables, &values), surface, coordinates).solve(&targets, counts).0;
        let family = family.at(&values);
        let of = format!("{spec}: {}.{}, case {case}", job.name, surface.name);
        tally.compare(&anew, &family.solve(&targets, counts).0, &format!("{of}, searched"));
        // what is followed counts where it is like the job itself, as studies have it
        let is_start = start.outcome == Outcome::Solved;
        let near = is_start.then(|| {
            let (points, _) = family.solve_points(&targets, counts, Some(&start.unknowns), None);
            (0..points.len()).map(|k| points.point(k)).collect::<Vec<SurfacePoint>>()
        });
        if let Some(near) = near.filter(|points| points.iter().map(kind).eq(nominal.iter().map(kind))) {
            tally.followed += 1;
            tally.compare(&anew, &near, &format!("{of}, followed"));
        }
    }
    tally
}

#[test]
fn families_are_the_surfaces_derived_anew() {
    let cases = std::env::var("FAMILY_CASES").map_or(CASES, |cases| cases.parse().expect("a number of cases"));
    let of_all = shipped().into_par_iter().map(|spec| {
        let tally = of_spec(&spec, if USUAL.contains(&spec.as_str()) { MANY } else { cases });
        println!("{spec}: {} surfaces, {} points", tally.surfaces, tally.points);
        tally
    });
    let Tally { surfaces, points, followed, farthest: (farthest, at) } = of_all.reduce(Tally::default, Tally::and);
    println!("{surfaces} surfaces, {points} points, {followed} grids followed, at most {farthest:e} mm apart: {at}");
    assert!(surfaces > 100 && farthest < ALONG, "{surfaces} surfaces, {farthest:e} mm: {at}");
}
