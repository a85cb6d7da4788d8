//! Sensitivities against surfaces that are solved again with each parameter a little larger and a little smaller.

use flank_chain_dsl::{Dimension, Job};
use flank_expr::Graph;
use flank_solver::{BoundSurface, NormalSensitivity, Outcome, Parameter, Range, SurfacePoint, SurfaceProblem};
use flank_tests::{job, points};

/// Up to seven of a surface's sampled points, spread over the grid.
fn targets(job: &Job<'_>, surface: &str) -> Vec<[f64; 2]> {
    let surface = job.surfaces.iter().find(|s| s.name == surface).expect("the surface is in the job");
    let all = &surface.sample.as_ref().expect("points are asked for").targets();
    (0..7).map(|k| all[(all.len() - 1) * k / 6]).collect()
}

/// The points at the targets, each in the neighbourhood of unknowns that are known: the ranges may hold several branches.
fn solved_near(job: &Job<'_>, surface: &str, targets: &[[f64; 2]], near: &[Vec<f64>], what: &str) -> Vec<SurfacePoint> {
    let surface = job.surfaces.iter().find(|s| s.name == surface).expect("the surface is in the job");
    let sample = surface.sample.as_ref().expect("points are asked for");
    let coordinates = sample.functions();
    let one = |(target, near): (&[f64; 2], &Vec<f64>)| {
        let around = surface.unknowns.iter().zip(near);
        let around = around.map(|(unknown, at)| (at, 0.02 * (unknown.high - unknown.low)));
        let ranges = around.map(|(at, by)| Range { low: at - by, high: at + by }).collect();
        let problem = SurfaceProblem::new(&BoundSurface::new(&surface.surface, ranges, &job.bindings()), coordinates)
            .expect("all bound");
        problem.solve(&[*target], [1, 1]).0.remove(0)
    };
    let found: Vec<SurfacePoint> = targets.iter().zip(near).map(one).collect();
    assert!(found.iter().all(|point| point.outcome == Outcome::Solved), "{what}");
    found
}

/// The unit of a value in a spec, and a step that is small for the surface: its cube is lost in rounding of about 1e-13 mm.
fn step(dimension: Dimension) -> (&'static str, f64) {
    match dimension {
        Dimension::LENGTH => (" mm", 2e-5),
        Dimension::ANGLE => (" rad", 2e-6),
        Dimension::NUMBER => ("", 2e-6),
        other => panic!("the specs have no parameter of dimension {other}"),
    }
}

/// Of a displacement by the step, mm: both surfaces are good to about 1e-13 mm, and what the step's cube leaves is less.
const BOUND: f64 = 2e-12;
/// The same where the blade, an arc with a radius of 2e6 mm, enters through differences that rounding leaves 1e-10 mm of.
const BOUND_OF_AN_ARC: f64 = 1e-10;

fn sensitivity(job: &Job<'_>, surface: &str) -> NormalSensitivity {
    let parameters = job.parameters.iter();
    let parameters: Vec<Parameter<'_>> =
        parameters.map(|p| Parameter { variable: p.variable, definition: p.definition, value: p.value }).collect();
    let made = &job.surfaces.iter().find(|s| s.name == surface).expect("the surface is in the job").surface;
    NormalSensitivity::new(made, &parameters).expect("all bound")
}

/// Tries all parameters but counts, with values for some of them that have others on both sides: how many leave the surface alone, and how
/// many move it.
fn predicts((spec, set): (&str, &[(&str, &str)]), surface: &str, coordinates: [&str; 2], bound: f64) -> [usize; 2] {
    let graph = Graph::new();
    let nominal = job(&graph, spec, set);
    let targets = targets(&nominal, surface);
    let old: Vec<SurfacePoint> =
        targets.iter().map(|at| points(&nominal, surface, coordinates, &[*at]).remove(0)).collect();
    let near: Vec<Vec<f64>> = old.iter().map(|point| point.unknowns.clone()).collect();
    let sensitivity = sensitivity(&nominal, surface);
    let exact: Vec<Vec<f64>> = old.iter().map(|point| sensitivity.at(&point.unknowns).expect("finite")).collect();
    let mut tried = [0, 0];
    for (k, parameter) in nominal.parameters.iter().enumerate().filter(|(_, p)| !p.is_count) {
        let (unit, h) = step(parameter.dimension);
        let what = format!("{surface} and {}", parameter.name);
        let moved = [h, -h].map(|h| {
            let graph = Graph::new();
            let value = format!("{:?}{unit}", parameter.value + h);
            let others = set.iter().copied().filter(|(name, _)| *name != parameter.name);
            let changed: Vec<(&str, &str)> = others.chain([(parameter.name.as_str(), value.as_str())]).collect();
            let changed = job(&graph, spec, &changed);
            solved_near(&changed, surface, &targets, &near, &what)
        });
        for (i, point) in old.iter().enumerate() {
            let difference: f64 =
                (0..3).map(|c| point.normal[c] * (moved[0][i].position[c] - moved[1][i].position[c])).sum();
            let off = 0.5 * difference - exact[i][k] * h;
            assert!(off.abs() < bound, "{what}: predicted {:e} mm, off by {off:e}", exact[i][k] * h);
        }
        tried[usize::from(exact.iter().any(|point| point[k] != 0.0))] += 1;
    }
    tried
}

#[test]
fn a_bevel_pinion_moves_as_predicted() {
    let spec = "specs/bevel/pinion_19x62.chain";
    assert_eq!(predicts((spec, &[]), "concave", ["z", "rho"], BOUND), [12, 41]);
    assert_eq!(predicts((spec, &[]), "concave_fillet", ["s", "z"], BOUND_OF_AN_ARC), [11, 42]);
}

#[test]
fn a_hobbed_gear_moves_as_predicted() {
    let rounded = ("specs/hobbing/helical_gear.chain", &[("h.edge_radius", "0.5 mm")][..]);
    assert_eq!(predicts(rounded, "lower_flank", ["rho", "z"], BOUND), [6, 9]);
}

#[test]
fn a_spur_gear_moves_as_predicted() {
    let spec = "specs/hobbing/spur_gear.chain";
    assert_eq!(predicts((spec, &[]), "flank_plus", ["rho", "z"], BOUND), [5, 7]);
    assert_eq!(predicts((spec, &[]), "fillet_plus", ["theta", "v"], BOUND), [3, 9]);
}

/// A cone of blade angle α, seen along its radius and along its axis.
#[test]
fn a_face_mill_moves_its_flank_by_cosine_and_sine() {
    let graph = Graph::new();
    let job = job(&graph, "specs/bevel/pinion_19x62.chain", &[]);
    let moved = sensitivity(&job, "concave");
    let place = |name: &str| job.parameters.iter().position(|p| p.name == name).expect("a parameter");
    let (sin, cos) = 20f64.to_radians().sin_cos();
    for target in targets(&job, "concave") {
        let point = points(&job, "concave", ["z", "rho"], &[target]).remove(0);
        let moved = moved.at(&point.unknowns).expect("finite");
        // the blade's radius of 2,000,000 mm turns it by some millionths over its height
        assert!((moved[place("c.outside_point_radius")].abs() - cos).abs() < 1e-5);
        assert!((moved[place("m.sliding_base")].abs() - sin).abs() < 1e-5);
    }
}
