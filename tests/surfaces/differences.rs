//! The geometry at points against central differences of neighbours that are solved again at fifty digits: no derivative of
//! the program takes part in them.

#[path = "../../crates/expr/tests/intervals/digits.rs"]
#[allow(dead_code, reason = "the intervals' own tests use the rest")]
mod digits;

use digits::Digits;
use flank_chain_dsl::{GeneratedSurface, Job};
use flank_expr::{Binary, Expr, Graph, ScalarEvaluator, Tape};
use flank_solver::PointGeometry;
use flank_tests::{evaluated, job, problem};
use nalgebra::{DMatrix, DVector, Vector3};

/// Step of the differences: they are good to its square.
const STEP: f64 = 1e-14;
/// Share of the size of a number that floats leave after the some hundred operations of a surface with two constraints.
const ROUNDING: f64 = 1e-11;

/// A surface whose points are found at fifty digits by values of two of its unknowns.
struct Neighbourhood {
    /// Constraints, position, normal.
    tape: Tape,
    at: Vec<f64>,
    /// The two unknowns that are given.
    given: [usize; 2],
    others: Vec<usize>,
    /// Of the derivatives of the constraints with respect to the others.
    inverse: DMatrix<f64>,
}

impl Neighbourhood {
    fn new(job: &Job<'_>, surface: &GeneratedSurface<'_>, at: &[f64]) -> Neighbourhood {
        let made = &surface.surface;
        let graph = made.position.0[0].graph();
        let outputs = made.constraints.iter().copied().chain(made.position.0).chain(made.normal.0);
        let outputs: Vec<Expr<'_>> = graph.substitute(&outputs.collect::<Vec<_>>(), &job.bindings());
        let slopes: Vec<Expr<'_>> = outputs[..made.constraints.len()]
            .iter()
            .flat_map(|constraint| made.unknowns.iter().map(|unknown| constraint.derivative(*unknown)))
            .collect();
        let mut jacobian = vec![0.0; slopes.len()];
        ScalarEvaluator::new(&Tape::new(&slopes, &made.unknowns).expect("bound")).run(at, &mut jacobian);
        let n = at.len();
        let jacobian = DMatrix::from_row_slice(n - 2, n, &jacobian);
        // the motion first, where there is one, so that the other one runs along the contact line
        let pairs = (0..n).rev().flat_map(|a| (0..n).filter(move |b| *b != a).map(move |b| [a, b]));
        let pairs = pairs.filter(|[a, _]| surface.generation.motions.len() != 1 || *a == n - 1);
        let best = pairs.map(|given| {
            let others: Vec<usize> = (0..n).filter(|k| !given.contains(k)).collect();
            let block = jacobian.select_columns(&others);
            let least = if others.is_empty() { 1.0 } else { block.clone().singular_values().min() };
            (least, given, others, block)
        });
        let (_, given, others, block) = best.max_by(|a, b| a.0.total_cmp(&b.0)).expect("two unknowns at least");
        let tape = Tape::new(&outputs, &made.unknowns).expect("bound");
        let inverse = block.try_inverse().expect("regular");
        Neighbourhood { tape, at: at.to_vec(), given, others, inverse }
    }

    fn outputs(&self, unknowns: &[Digits]) -> Vec<Digits> {
        Digits::outputs(&self.tape, unknowns).into_iter().map(|x| x.expect("in the domain")).collect()
    }

    /// Position and normal where the two given unknowns are moved; the others follow.
    fn moved(&self, by: [f64; 2]) -> Vec<Digits> {
        let mut p: Vec<Digits> = self.at.iter().map(|x| Digits::from(*x)).collect();
        for (k, by) in self.given.iter().zip(by) {
            p[*k] = plus(&p[*k], &Digits::from(by));
        }
        for _ in 0..8 {
            let residuals = self.outputs(&p).into_iter().take(self.others.len());
            let step = &self.inverse * DVector::from_iterator(self.others.len(), residuals.map(|c| f64::from(&c)));
            for (k, step) in self.others.iter().zip(step.iter()) {
                p[*k] = plus(&p[*k], &Digits::from(-step));
            }
        }
        let all = self.outputs(&p);
        assert!(all[..self.others.len()].iter().all(|c| f64::from(c).abs() < 1e-42), "not solved");
        all[self.others.len()..].to_vec()
    }

    /// Derivatives of position and normal along one of the given unknowns.
    fn along(&self, k: usize) -> [Vector3<f64>; 2] {
        let by = |step: f64| if k == 0 { [step, 0.0] } else { [0.0, step] };
        slopes(&self.moved(by(STEP)), &self.moved(by(-STEP)))
    }

    /// The derivative of the position with respect to an unknown alone.
    fn partial(&self, unknown: usize) -> Vector3<f64> {
        let at = |step: f64| {
            let mut p: Vec<Digits> = self.at.iter().map(|x| Digits::from(*x)).collect();
            p[unknown] = plus(&p[unknown], &Digits::from(step));
            self.outputs(&p)[self.others.len()..].to_vec()
        };
        slopes(&at(STEP), &at(-STEP))[0]
    }
}

fn plus(a: &Digits, b: &Digits) -> Digits {
    a.binary(Binary::Add, b).expect("a sum")
}

fn slopes(ahead: &[Digits], behind: &[Digits]) -> [Vector3<f64>; 2] {
    let slope = |k: usize| f64::from(&ahead[k].binary(Binary::Sub, &behind[k]).expect("a difference")) / (2.0 * STEP);
    [Vector3::from_fn(|k, _| slope(k)), Vector3::from_fn(|k, _| slope(3 + k))]
}

fn close(found: f64, wanted: f64, size: f64, what: &str) {
    assert!((found - wanted).abs() <= ROUNDING * size, "{what}: {found:e} is not {wanted:e}");
}

fn agrees(job: &Job<'_>, surface: &GeneratedSurface<'_>, at: &[f64], geometry: &PointGeometry, what: &str) {
    let near = Neighbourhood::new(job, surface, at);
    let [[r_a, n_a], [r_b, n_b]] = [near.along(0), near.along(1)];
    let curvature = geometry.curvature.expect("a regular point");
    let largest = curvature.principal().k1.abs().max(curvature.principal().k2.abs());
    for (a, b) in [(1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, -2.0)] {
        let (r, n) = (r_a.normalize() * a + r_b.normalize() * b, n_a / r_a.norm() * a + n_b / r_b.norm() * b);
        let found = curvature.along(r.into()).expect("a tangent");
        close(found, r.dot(&n) / r.norm_squared(), largest, &format!("{what}: along {a}, {b}"));
    }
    let still = at.len() - surface.generation.motions.len();
    for (k, velocity) in geometry.contact.sliding.iter().enumerate() {
        let velocity = Vector3::from(velocity.expect("finite"));
        let off = (velocity - near.partial(still + k)).norm();
        assert!(off <= ROUNDING * velocity.norm(), "{what}: sliding {velocity} is off by {off:e}");
    }
    if surface.generation.motions.len() == 1 {
        let line = Vector3::from(geometry.contact.line.expect("one motion"));
        let off = line.cross(&r_b.normalize()).norm();
        assert!(off <= ROUNDING, "{what}: the contact line is off by {off:e}");
    }
}

#[test]
fn surfaces_of_the_library() {
    for (spec, surface) in [
        ("specs/hobbing/spur_gear.chain", "flank_plus"),
        ("specs/hobbing/spur_gear.chain", "fillet_minus"),
        ("specs/hobbing/helical_gear.chain", "lower_flank"),
        ("specs/hobbing/helical_gear.chain", "upper_flank"),
        ("specs/hobbing/chang_tsay_nagata.chain", "lower_flank"),
        ("specs/hobbing/worm_wheel.chain", "upper.flank"),
        ("specs/hobbing/skived_internal_gear.chain", "edge_plus"),
        ("specs/hobbing/elliptical_gear_hobbed.chain", "lower_flank"),
        ("specs/bevel/pinion_19x62.chain", "concave"),
        ("specs/bevel/pinion_19x62.chain", "convex"),
        ("specs/bevel/tilted_pinion.chain", "convex"),
        ("specs/bevel/formate_gear.chain", "concave"),
        ("specs/bevel/face_hobbed_pinion.chain", "convex"),
        ("specs/double_envelope/hourglass_worm_wheel.chain", "wheel"),
    ] {
        let graph = Graph::new();
        let job = job(&graph, spec, &[]);
        let generated = job.surfaces.iter().find(|s| s.name == surface).expect("it is there");
        let sample = generated.sample.as_ref().expect("points are asked for");
        let coordinates = sample.functions();
        let (solved, _) = problem(&job, generated, coordinates).solve(&sample.targets(), sample.counts);
        let unknowns: Vec<Vec<f64>> = (0..5).map(|k| solved[(solved.len() - 1) * k / 4].unknowns.clone()).collect();
        for (at, point) in unknowns.iter().zip(evaluated(&job, surface, &unknowns)) {
            agrees(&job, generated, at, &point.geometry, &format!("{spec}, {surface}"));
        }
    }
}
