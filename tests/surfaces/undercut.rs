//! Undercut: where the tool cuts away what it generates, by the sign of the clearance's Hessian.

use flank_chain_dsl::{GeneratedSurface, Job, ToolShape};
use flank_expr::geometry::Vector3;
use flank_expr::{Expr, Graph};
use flank_solver::{Outcome, Range, SurfacePoint, System, solve};
use flank_tests::{job, points};

const SPUR: &str = "specs/hobbing/spur_gear.chain";
const UNDERCUT: [(&str, &str); 2] = [("teeth", "10"), ("profile_shift", "0")];

fn surface<'j, 'g>(job: &'j Job<'g>, name: &str) -> &'j GeneratedSurface<'g> {
    job.surfaces.iter().find(|surface| surface.name == name).expect("the surface is in the job")
}

/// How far a point that is fixed to the work is from the tool's steel, at values of the motions: the foot of the
/// perpendicular on the tool's surface, solved in the tool's frame; nothing of the envelope is used.
struct Clearance<'g> {
    graph: &'g Graph,
    system: System,
    signed: Expr<'g>,
    inputs: Vec<Expr<'g>>,
    ranges: Vec<Range>,
}

impl<'g> Clearance<'g> {
    fn new(job: &Job<'g>, generated: &GeneratedSurface<'g>) -> Clearance<'g> {
        let ToolShape::Surface(tool) = &generated.generation.tool else { panic!("a surface") };
        let graph = tool.normal.0[0].graph();
        let work = Vector3(["x", "y", "z"].map(|name| graph.variable(name)));
        let apart = generated.generation.driven.inverse().point(work) - tool.position;
        let feet = tool.unknowns.iter().map(|&u| apart.dot(tool.position.derivative(u)));
        let all: Vec<Expr<'g>> = feet.chain([apart.dot(tool.normal)]).collect();
        let all = graph.substitute(&all, &job.bindings());
        let inputs: Vec<Expr<'g>> = generated.generation.motions.iter().copied().chain(work.0).collect();
        let system = System::new(&all[..2], &tool.unknowns, &inputs).expect("nothing is unbound");
        let signed = all[2];
        let inputs = tool.unknowns.iter().copied().chain(inputs).collect();
        // the foot may lie where the tool's surface is no longer used
        let wide = |u: &flank_chain_dsl::Bounded<'_>| Range { low: 2.0 * u.low - u.high, high: 2.0 * u.high - u.low };
        Clearance { graph, system, signed, inputs, ranges: generated.unknowns[..2].iter().map(wide).collect() }
    }

    fn at(&self, point: &SurfacePoint, by: &[f64]) -> f64 {
        let motions = point.unknowns[2..].iter().zip(by).map(|(motion, by)| motion + by);
        let given: Vec<f64> = motions.chain(point.position).collect();
        let foot = solve(&self.system, &self.ranges, &given, &point.unknowns[..2]);
        assert_eq!(foot.outcome, Outcome::Solved, "a foot");
        let mut values = vec![f64::NAN; self.graph.variable_count()];
        for (input, value) in self.inputs.iter().zip(foot.unknowns.iter().chain(&given)) {
            values[input.as_variable().expect("a variable").index()] = *value;
        }
        self.graph.evaluate(&[self.signed], &values)[0]
    }

    /// ∂²/∂m_j∂m_k by differences of the distances, the error of the step's square taken out.
    fn hessian(&self, point: &SurfacePoint, steps: &[f64]) -> Vec<Vec<f64>> {
        let count = steps.len();
        let second = |j: usize, k: usize, scale: f64| {
            let at = |a: f64, b: f64| {
                let mut by = vec![0.0; count];
                by[j] += a * scale * steps[j];
                by[k] += b * scale * steps[k];
                self.at(point, &by)
            };
            (at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0))
                / (4.0 * scale * scale * steps[j] * steps[k])
        };
        let refined = |j, k| (4.0 * second(j, k, 1.0) - second(j, k, 2.0)) / 3.0;
        (0..count).map(|j| (0..count).map(|k| refined(j, k)).collect()).collect()
    }
}

/// Points of a surface, with the steps of the motions for differences.
#[derive(Clone, Copy)]
struct Case {
    spec: &'static str,
    set: &'static [(&'static str, &'static str)],
    surface: &'static str,
    coordinates: [&'static str; 2],
    targets: &'static [[f64; 2]],
    steps: &'static [f64],
}

/// The leading minors against distances from the tool that know nothing of envelopes; one and two motions, on both sides of
/// the singular line.
#[test]
fn the_minors_are_those_of_the_clearance() {
    let plain = Case {
        spec: SPUR,
        set: &UNDERCUT,
        surface: "flank_plus",
        coordinates: ["u", "v"],
        targets: &[],
        steps: &[2e-3],
    };
    let cases = [
        Case { targets: &[[-2.0, 1.0], [1.5, 1.0], [2.2, 1.0], [3.0, -4.0]], ..plain },
        Case { surface: "fillet_plus", coordinates: ["theta", "v"], targets: &[[0.5, 1.0], [1.2, 1.0]], ..plain },
        Case {
            spec: "specs/hobbing/helical_gear.chain",
            set: &[],
            surface: "lower_flank",
            coordinates: ["rho", "z"],
            targets: &[[51.0, 3.0], [48.9, -6.0]],
            steps: &[2e-3, 0.05],
        },
        Case {
            spec: "specs/bevel/pinion_19x62.chain",
            set: &[],
            surface: "concave",
            coordinates: ["s", "roll"],
            targets: &[[2.0, -0.1], [6.0, 0.05]],
            ..plain
        },
    ];
    for Case { spec, set, surface: name, coordinates, targets, steps } in cases {
        let graph = Graph::new();
        let job = job(&graph, spec, set);
        let generated = surface(&job, name);
        let clearance = Clearance::new(&job, generated);
        let minors = generated.surface.bound(&job.bindings()).clearance_minors();
        for point in points(&job, name, coordinates, targets) {
            let what = format!("{name} at {:?}", point.unknowns);
            assert!(matches!(point.outcome, Outcome::Solved | Outcome::CutAway), "{what}: {:?}", point.outcome);
            let mut values = vec![f64::NAN; graph.variable_count()];
            for (unknown, value) in generated.surface.unknowns.iter().zip(&point.unknowns) {
                values[unknown.as_variable().expect("a variable").index()] = *value;
            }
            let found = graph.evaluate(&minors, &values);
            let h = clearance.hessian(&point, steps);
            let expected: Vec<f64> = match h.as_slice() {
                [one] => vec![one[0]],
                [first, second] => vec![first[0], first[0] * second[1] - first[1] * second[0]],
                _ => panic!("one or two motions"),
            };
            for (found, expected) in found.iter().zip(&expected) {
                // distances are good to 1e-14 mm of 1e-4 mm, and the differences to the fourth power of the step
                assert!((found - expected).abs() <= 1e-6 * expected.abs().max(1.0), "{what}: {found} for {expected}");
            }
            let stays = expected.iter().all(|minor| *minor > 0.0);
            assert_eq!(point.outcome == Outcome::Solved, stays, "{what}: {expected:?}");
        }
    }
}

/// A rack's straight flank: the tool cuts away what it generates beyond u = (r sin²α + x m) / cos α.
#[test]
fn beyond_the_singular_line_points_are_cut_away() {
    let graph = Graph::new();
    let job = job(&graph, SPUR, &UNDERCUT);
    let alpha = 20f64.to_radians();
    let limit = 15.0 * alpha.sin().powi(2) / alpha.cos();
    let targets: Vec<[f64; 2]> = [-2.0, 0.0, limit - 1e-6, limit + 1e-6, 2.5, 3.0].map(|u| [u, 0.0]).to_vec();
    for (target, point) in targets.iter().zip(points(&job, "flank_plus", ["u", "v"], &targets)) {
        let expected = if target[0] < limit { Outcome::Solved } else { Outcome::CutAway };
        assert_eq!(point.outcome, expected, "u {}", target[0]);
    }
    // at a radius that both branches reach, the one that stays is taken
    let radii: Vec<[f64; 2]> = (0..8).map(|k| [14.0955 + 0.02 * f64::from(k), 0.0]).collect();
    for point in points(&job, "flank_plus", ["rho", "z"], &radii) {
        assert_eq!(point.outcome, Outcome::Solved);
        assert!(point.unknowns[0] < limit);
    }
}
