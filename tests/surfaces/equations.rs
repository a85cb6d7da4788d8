//! Whatever is called solved solves the equations: evaluated by the slow interpreter on the expressions as they were
//! compiled, with the parameters' values beside them, so that neither the tape nor the substitution has a part in it.

use std::collections::BTreeMap;

use flank_chain_dsl::{GeneratedSurface, Job};
use flank_expr::{Expr, Graph};
use flank_solver::{Outcome, SurfacePoint};
use flank_tests::{difference, job, points};

/// Weyl's sequence: numbers in 0..1 that fill it evenly, the same in every run.
struct Dice(f64);

impl Dice {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = (self.0 + 0.618_033_988_749_894_9).fract();
        low + (high - low) * self.0
    }
}

/// Values for all variables: parameters, and the unknowns of a point.
fn values(graph: &Graph, job: &Job<'_>, unknowns: &[(Expr<'_>, f64)]) -> Vec<f64> {
    let mut values = vec![f64::NAN; graph.variable_count()];
    let parameters = job.parameters.iter().map(|parameter| (parameter.variable, parameter.value));
    for (variable, value) in parameters.chain(unknowns.iter().copied()) {
        values[variable.as_variable().expect("a variable").index()] = value;
    }
    values
}

fn check(graph: &Graph, job: &Job<'_>, surface: &GeneratedSurface<'_>, target: [f64; 2], point: &SurfacePoint) {
    let what = format!("{} at {target:?}: {point:?}", surface.name);
    let sample = surface.sample.as_ref().expect("the surface is sampled");
    let unknowns: Vec<_> = surface.unknowns.iter().map(|u| u.variable).zip(point.unknowns.iter().copied()).collect();
    let at = values(graph, job, &unknowns);
    let size = point.position.iter().fold(1000.0, |size: f64, x| size.max(x.abs()));
    let residuals = graph.evaluate(&surface.surface.constraints, &at);
    assert!(difference(&residuals, &vec![0.0; residuals.len()]) <= 2e-14 * size, "{residuals:?}, {what}");
    let reached = graph.evaluate(&sample.functions(), &at);
    assert!(difference(&reached, &target) <= 2e-14 * size, "{reached:?}, {what}");
    let parts: Vec<Expr<'_>> = surface.surface.position.0.into_iter().chain(surface.surface.normal.0).collect();
    let found = graph.evaluate(&parts, &at);
    assert!(difference(&found[..3], &point.position) <= 1e-13 * size, "{what}");
    assert!(difference(&found[3..], &point.normal) <= 1e-12, "{what}");
    for (unknown, value) in surface.unknowns.iter().zip(&point.unknowns) {
        let room = 1e-9 * (unknown.high - unknown.low);
        assert!((unknown.low - room..=unknown.high + room).contains(value), "{what}");
    }
}

/// Solves all samples of a spec with some values replaced, checks all that is solved and gives its share.
fn share_solved(spec: &str, set: &BTreeMap<&str, String>) -> f64 {
    let set: Vec<(&str, &str)> = set.iter().map(|(name, value)| (*name, value.as_str())).collect();
    let graph = Graph::new();
    let job = job(&graph, spec, &set);
    let (mut asked, mut solved) = (0, 0);
    for surface in &job.surfaces {
        let Some(sample) = &surface.sample else {
            continue;
        };
        let names = sample.coordinates.each_ref().map(|coordinate| coordinate.name.as_str());
        // every third point: the rest is between them
        let targets: Vec<[f64; 2]> = sample.targets().iter().step_by(3).copied().collect();
        let points = points(&job, &surface.name, names, &targets);
        let found = targets.iter().zip(&points).filter(|(_, point)| point.outcome == Outcome::Solved);
        found.clone().for_each(|(target, point)| check(&graph, &job, surface, *target, point));
        asked += targets.len();
        solved += found.count();
    }
    solved as f64 / asked as f64
}

#[test]
fn spur_gears_from_0_1_mm_to_10_m() {
    let mut dice = Dice(0.1);
    for round in 0..24 {
        let module = 10f64.powf(dice.between(-2.0, 1.7));
        let set = BTreeMap::from([
            ("module", format!("{module} mm")),
            ("teeth", format!("{}", dice.between(14.0, 200.0).round())),
            ("profile_shift", format!("{}", dice.between(-0.2, 0.6))),
            ("r.pressure_angle", format!("{} deg", dice.between(18.0, 25.0))),
            ("face_width", format!("{} mm", module * dice.between(1.0, 20.0))),
        ]);
        assert_eq!(share_solved("specs/hobbing/spur_gear.chain", &set), 1.0, "round {round}: {set:?}");
    }
}

#[test]
fn helical_gears_of_both_hands() {
    let mut dice = Dice(0.2);
    for round in 0..24 {
        let module = 10f64.powf(dice.between(-1.0, 1.5));
        let set = BTreeMap::from([
            ("normal_module", format!("{module} mm")),
            ("teeth", format!("{}", dice.between(20.0, 120.0).round())),
            ("helix_angle", format!("{} deg", dice.between(-35.0, 35.0))),
            ("normal_pressure_angle", format!("{} deg", dice.between(17.0, 25.0))),
            ("shift", format!("{} mm", module * dice.between(-0.2, 0.5))),
            ("hob_starts", format!("{}", dice.between(0.5, 3.5).round())),
            ("hob_radius", format!("{} mm", module * dice.between(8.0, 20.0))),
            ("hob_shift", format!("{} mm", module * dice.between(-3.0, 3.0))),
            ("face_width", format!("{} mm", module * dice.between(2.0, 10.0))),
        ]);
        assert_eq!(share_solved("specs/hobbing/helical_gear.chain", &set), 1.0, "round {round}: {set:?}");
    }
}

/// Settings at random give a flank that leaves the blade or the roll somewhere; what is solved has to be right.
#[test]
fn bevel_pinions_with_every_setting_disturbed() {
    let mut dice = Dice(0.3);
    assert_eq!(share_solved("specs/bevel/pinion_19x62.chain", &BTreeMap::new()), 1.0);
    let mut most: f64 = 0.0;
    for _ in 0..16 {
        let set = BTreeMap::from([
            ("m.cutter_tilt", format!("{} deg", dice.between(-6.0, 6.0))),
            ("m.cutter_swivel", format!("{} deg", dice.between(-90.0, 90.0))),
            ("m.work_offset", format!("{} mm", dice.between(-4.0, 4.0))),
            ("m.sliding_base", format!("{} mm", dice.between(-3.0, 3.0))),
            ("m.modified_roll_2c", format!("{}", dice.between(-0.2, 0.2))),
            ("m.helical_motion_1", format!("{} mm", dice.between(-3.0, 3.0))),
            ("m.tilt_motion_1", format!("{} deg", dice.between(-3.0, 3.0))),
            ("c.blade_radius", format!("{} mm", 10f64.powf(dice.between(2.5, 6.0)))),
        ]);
        most = most.max(share_solved("specs/bevel/pinion_19x62.chain", &set));
    }
    assert!(most > 0.5, "at best {most} of the points are solved");
}
