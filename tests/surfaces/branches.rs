//! Every root in the declared ranges, certified points, and what is said where several branches qualify.

use flank_chain_dsl::Job;
use flank_expr::Graph;
use flank_solver::{BoundSurface, Outcome, Range, Roots, SurfacePoint, SurfaceProblem};
use flank_tests::{difference, job, problem};

/// All roots at the middle of the sample of each surface of a job.
fn anchors(job: &Job<'_>) -> Vec<(String, Roots)> {
    let sampled = job.surfaces.iter().filter_map(|surface| Some((surface, surface.sample.as_ref()?)));
    let anchor = sampled.map(|(surface, sample)| {
        let coordinates = sample.functions();
        let middle = (sample.counts[0] / 2) * sample.counts[1] + sample.counts[1] / 2;
        (surface.name.clone(), problem(job, surface, coordinates).all_points(sample.targets()[middle]))
    });
    anchor.collect()
}

/// Of these specs each surface has so many branches in its ranges, and no other one: proven, in few boxes. Of the helical gear two
/// turns of the hob's thread come by; the job keeps one.
#[test]
fn so_many_branches_and_no_other() {
    let specs =
        [("tutorial/first_gear", 1), ("hobbing/spur_gear", 1), ("hobbing/helical_gear", 2), ("bevel/pinion_19x62", 1)];
    for (spec, branches) in specs {
        let graph = Graph::new();
        for (name, roots) in anchors(&job(&graph, &format!("specs/{spec}.chain"), &[])) {
            assert_eq!((roots.isolated.len(), roots.undecided.len()), (branches, 0), "{spec}, {name}: {roots:?}");
            assert!(roots.boxes < 400, "{spec}, {name}: {} boxes", roots.boxes);
        }
    }
}

/// The box in which a root is said to be alone holds this root and no other one, also where the search had an unknown more
/// than the surface: the angle that thread and spindle turn together.
#[test]
fn a_root_is_alone_where_it_is_said_to_be() {
    let graph = Graph::new();
    let job = job(&graph, "specs/hobbing/helical_gear.chain", &[]);
    let (surface, root) = (&job.surfaces[0], &anchors(&job)[0].1.isolated[0]);
    let sample = surface.sample.as_ref().expect("it is sampled");
    let target = sample.targets()[(sample.counts[0] / 2) * sample.counts[1] + sample.counts[1] / 2];
    let around = root.solution.unknowns.iter().zip(&root.alone_within);
    let ranges = around.map(|(x, radius)| Range { low: x - radius, high: x + radius }).collect();
    let coordinates = sample.functions();
    let near = SurfaceProblem::new(&BoundSurface::new(&surface.surface, ranges, &job.bindings()), coordinates)
        .expect("all bound");
    let found = near.all_points(target);
    assert_eq!((found.isolated.len(), found.undecided.len()), (1, 0), "{found:?}");
    assert!(root.alone_within.iter().all(|radius| *radius > 1e-6), "{root:?}");
}

/// The hob's thread comes by again after a turn: without `keep` no tooth is taken silently.
#[test]
fn several_branches_are_listed_and_none_is_taken() {
    let graph = Graph::new();
    let job = job(&graph, "specs/hobbing/helical_gear.chain", &[]);
    let surface = &job.surfaces[0];
    let sample = surface.sample.as_ref().expect("it is sampled");
    let coordinates = sample.functions();
    let ranges = surface.unknowns.iter().map(|u| Range { low: u.low, high: u.high }).collect();
    let unsaid = SurfaceProblem::new(&BoundSurface::new(&surface.surface, ranges, &job.bindings()), coordinates)
        .expect("all bound");
    let (points, effort) = unsaid.solve(&sample.targets(), sample.counts);
    assert!(points.iter().all(|point| point.outcome == Outcome::Ambiguous));
    assert!(effort.branches.len() > 1);
    let spindles: Vec<f64> = effort.branches.iter().map(|branch| branch.unknowns[2].to_degrees()).collect();
    for pair in spindles.windows(2) {
        let turns = (pair[0] - pair[1]) / 360.0;
        assert!((turns - turns.round()).abs() < 1e-6, "{spindles:?}");
    }
    let (kept, effort) = problem(&job, surface, coordinates).solve(&sample.targets(), sample.counts);
    assert_eq!(effort.branches.len(), 1);
    assert!(kept.iter().all(|point| point.outcome == Outcome::Solved));
}

/// 10 000 points of the cradle pinion's flank.
fn pinion_points(graph: &Graph) -> (SurfaceProblem, Vec<[f64; 2]>, Vec<SurfacePoint>) {
    let job = job(graph, "specs/bevel/pinion_19x62.chain", &[]);
    let surface = &job.surfaces[0];
    let sample = surface.sample.as_ref().expect("it is sampled");
    let problem = problem(&job, surface, sample.functions());
    let corner = |i: usize, j: usize| sample.targets()[i * sample.counts[1] + j];
    let (last, end) = (sample.counts[0] - 1, sample.counts[1] - 1);
    let [a, b, c, d] = [corner(0, 0), corner(0, end), corner(last, 0), corner(last, end)];
    let target = |k: usize| {
        let (v, u) = ((k / 100) as f64 / 99.0, (k % 100) as f64 / 99.0);
        [0, 1].map(|i| (1.0 - v) * ((1.0 - u) * a[i] + u * b[i]) + v * ((1.0 - u) * c[i] + u * d[i]))
    };
    let targets: Vec<[f64; 2]> = (0..10_000).map(target).collect();
    let points = problem.solve(&targets, [100, 100]).0;
    (problem, targets, points)
}

#[test]
fn every_point_of_the_pinion_is_certified() {
    let graph = Graph::new();
    let (problem, targets, points) = pinion_points(&graph);
    let mut certifier = problem.certifier();
    let mut largest: f64 = 0.0;
    for (target, point) in targets.iter().zip(&points) {
        largest = largest.max(certifier.radius(*target, point).expect("a regular point"));
    }
    assert!(largest < 1e-10, "{largest:e} mm");
}

/// A point that is off by something gets a radius that says so; one of another target gets one as large or none.
#[test]
fn a_wrong_point_is_not_certified_as_right() {
    let graph = Graph::new();
    let (problem, targets, points) = pinion_points(&graph);
    let mut certifier = problem.certifier();
    for k in (0..10_000).step_by(997) {
        for off in [1e-9, 1e-6, 1e-3] {
            let mut wrong = points[k].clone();
            wrong.unknowns[0] += off;
            wrong.position[2] += off;
            if let Some(radius) = certifier.radius(targets[k], &wrong) {
                let distance = difference(&wrong.position, &points[k].position);
                assert!(radius >= distance, "{radius:e} {distance:e}");
            }
        }
        let elsewhere = points[(k + 5_000) % 10_000].clone();
        if let Some(radius) = certifier.radius(targets[k], &elsewhere) {
            assert!(radius >= difference(&elsewhere.position, &points[k].position));
        }
    }
}
