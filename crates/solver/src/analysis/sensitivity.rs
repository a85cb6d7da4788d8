//! How a surface moves when the numbers that it was made with change.

use flank_expr::geometry::Surface;
use flank_expr::{Expr, Interval, IntervalEvaluator, Tape, TapeError};
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::equations::solution::Outcome;
use crate::surface::points::SurfacePoint;

/// A displacement of which the normal takes no more than this share is one along the surface: what is left is the rounding
/// of a normal that follows from solved unknowns.
const ALONG: f64 = 1e-12;

/// Points that threads share out at once: of no more all displacements are held twice.
const TOGETHER: usize = 4096;

/// A number that a surface was made with.
#[derive(Clone, Copy, Debug)]
pub struct Parameter<'g> {
    /// The variable that stands for it.
    pub variable: Expr<'g>,
    /// Its value as an expression in earlier parameters: when one of these changes, it follows.
    pub definition: Expr<'g>,
    /// Its value.
    pub value: f64,
}

/// The exact derivative of a surface's normal displacement with respect to each of its parameters.
///
/// Change a parameter by a little. The displacement of the surface along its old normal n is n · ∂r/∂s for unchanged unknowns:
/// whatever the unknowns do to solve the equations again moves the point along the surface, because n is square to ∂r/∂p. So
/// it does not matter by which coordinates points are asked for, nor whether these move with the parameter.
///
/// A cylinder of radius R, which is half of a diameter d:
///
/// ```
/// use flank_expr::Graph;
/// use flank_expr::geometry::{Surface, Vector3};
/// use flank_solver::{NormalSensitivity, Parameter};
///
/// let graph = Graph::new();
/// let [a, z, d, radius, turn] = ["a", "z", "d", "R", "turn"].map(|name| graph.variable(name));
/// let around = a + turn;
/// let position = Vector3([radius * around.cos(), radius * around.sin(), z]);
/// let cylinder = Surface::parametric([a, z], position, false);
/// let parameter = |variable, definition, value| Parameter { variable, definition, value };
/// let parameters = [
///     parameter(d, graph.constant(20.0), 20.0),
///     parameter(radius, d / 2.0, 10.0),
///     parameter(turn, graph.constant(0.0), 0.0),
/// ];
/// let sensitivity = NormalSensitivity::new(&cylinder, &parameters).expect("nothing else is unknown");
///
/// let moved = sensitivity.at(&[0.3, 5.0]).expect("finite");
/// assert!((moved[0] - 0.5).abs() < 1e-15, "the radius follows the diameter");
/// assert!((moved[1] - 1.0).abs() < 1e-15);
/// assert_eq!(moved[2], 0.0, "a turned cylinder is the same surface");
/// ```
#[derive(Clone, Debug)]
pub struct NormalSensitivity {
    /// Their values.
    parameters: Vec<Interval>,
    /// The normal, then how a point moves with each parameter alone, from the unknowns and the parameters.
    tape: Tape,
    /// For each parameter those that follow it and move points, itself among them, each with its total derivative and its rounding.
    following: Vec<Vec<(usize, Interval)>>,
}

/// How the points of a surface move with one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Displacement {
    /// At each point, as [`NormalSensitivity::at`]; NaN where it is not known.
    pub at_points: Vec<f64>,
    /// Over the points at which it is known, root of the mean square; zero without any.
    pub rms: f64,
    /// Over the same, the largest, without its sign.
    pub largest: f64,
}

impl Displacement {
    fn new(at_points: Vec<f64>) -> Displacement {
        let known = || at_points.iter().filter(|moved| !moved.is_nan());
        let squares: f64 = known().map(|moved| moved * moved).sum();
        Displacement {
            rms: (squares / known().count().max(1) as f64).sqrt(),
            largest: known().fold(0.0, |largest, moved| moved.abs().max(largest)),
            at_points,
        }
    }

    /// Whether the parameter moves the surface at any point.
    pub fn moves(&self) -> bool {
        self.largest > 0.0
    }

    /// The same for a change of this size instead of one.
    pub fn times(self, size: f64) -> Displacement {
        let at_points = self.at_points.into_iter().map(|moved| moved * size).collect();
        Displacement { at_points, rms: self.rms * size, largest: self.largest * size }
    }
}

impl NormalSensitivity {
    /// How points of the surface move with each of `parameters`, by their places among all; and at how many points that is known: those
    /// that are solved and where all of [`NormalSensitivity::at`] is finite. On as many threads as there are.
    pub fn over(&self, points: &[SurfacePoint], parameters: &[usize]) -> (Vec<Displacement>, usize) {
        let at = |evaluator: &mut Evaluator<'_>, point: &SurfacePoint| {
            (point.outcome == Outcome::Solved).then(|| self.by(evaluator, &point.unknowns)).flatten()
        };
        let evaluator = self.evaluator();
        // one number of each parameter and point is all that is kept of a point
        let mut moved: Vec<Vec<f64>> = parameters.iter().map(|_| Vec::with_capacity(points.len())).collect();
        let mut known = 0;
        for points in points.chunks(TOGETHER) {
            let found: Vec<Option<Vec<f64>>> = points.par_iter().map_init(|| evaluator.clone(), at).collect();
            for of_all in found {
                known += usize::from(of_all.is_some());
                for (k, values) in parameters.iter().zip(&mut moved) {
                    values.push(of_all.as_ref().map_or(f64::NAN, |of_all| of_all[*k]));
                }
            }
        }
        (moved.into_iter().map(Displacement::new).collect(), known)
    }

    /// The sensitivity of `surface` to `parameters`, which stand in such an order that definitions depend on earlier ones only.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor a parameter.
    pub fn new<'g>(surface: &Surface<'g>, parameters: &[Parameter<'g>]) -> Result<NormalSensitivity, TapeError> {
        // values stay inputs: folded into constants, what rounding leaves of terms that cancel would look exact
        let variables = parameters.iter().map(|parameter| parameter.variable);
        let inputs: Vec<Expr<'g>> = surface.unknowns.iter().copied().chain(variables).collect();
        let slopes: Vec<[Expr<'g>; 3]> =
            parameters.iter().map(|parameter| surface.position.derivative(parameter.variable).0).collect();
        let outputs: Vec<Expr<'g>> = surface.normal.0.into_iter().chain(slopes.iter().copied().flatten()).collect();
        let moves = |i: usize| slopes[i].iter().any(|slope| slope.as_constant() != Some(0.0));
        Ok(NormalSensitivity {
            parameters: parameters.iter().map(|parameter| Interval::point(parameter.value)).collect(),
            tape: Tape::new(&outputs, &inputs)?,
            following: following(parameters, moves)?,
        })
    }

    /// For each parameter, mm of normal displacement (plus is outwards, more material) per unit of the parameter, which is mm,
    /// radian or one. Exactly zero where the parameter moves the point along the surface or not at all, and where that cannot be
    /// told from rounding: all is computed in intervals, so that terms which cancel leave one about zero, however large they were.
    /// `None` where it is not finite.
    ///
    /// # Panics
    /// If there is not one number for each unknown.
    pub fn at(&self, unknowns: &[f64]) -> Option<Vec<f64>> {
        self.by(&mut self.evaluator(), unknowns)
    }

    fn evaluator(&self) -> Evaluator<'_> {
        Evaluator {
            tape: IntervalEvaluator::with_last_inputs(&self.tape, &self.parameters),
            out: vec![Interval::WHOLE; self.tape.output_count()],
        }
    }

    fn by(&self, evaluator: &mut Evaluator<'_>, unknowns: &[f64]) -> Option<Vec<f64>> {
        let inputs: Vec<Interval> = unknowns.iter().copied().map(Interval::point).collect();
        evaluator.tape.run(&inputs, &mut evaluator.out);
        let (normal, slopes) = evaluator.out.split_at(3);
        let moved = (0..self.parameters.len()).map(|k| self.displacement(slopes, k));
        let all: Vec<f64> = moved.map(|moved| along_normal(normal, &moved)).collect();
        all.iter().all(|moved| moved.is_finite()).then_some(all)
    }

    /// Of a point with unchanged unknowns, per unit of a parameter, from what each parameter alone does.
    fn displacement(&self, slopes: &[Interval], parameter: usize) -> [Interval; 3] {
        std::array::from_fn(|axis| {
            let moved = self.following[parameter].iter().map(|(i, follows)| *follows * slopes[3 * i + axis]);
            moved.fold(Interval::point(0.0), |sum, moved| sum + moved)
        })
    }
}

/// What evaluates normal and slopes, with what follows from the parameters alone.
#[derive(Clone)]
struct Evaluator<'s> {
    tape: IntervalEvaluator<'s>,
    out: Vec<Interval>,
}

/// The share of a displacement that the normal takes, if it is one.
fn along_normal(normal: &[Interval], moved: &[Interval; 3]) -> f64 {
    let share = normal.iter().zip(moved).fold(Interval::point(0.0), |sum, (n, moved)| sum + *n * *moved);
    let length = Vector3::from(moved.map(|part| part.middle())).norm();
    let is_nothing = share.contains(0.0) || share.magnitude() <= ALONG * length;
    if is_nothing && share.magnitude().is_finite() { 0.0 } else { share.middle() }
}

/// For each parameter the numbers of those that follow it, itself among them, with their total derivatives by it.
///
/// # Errors
/// If a definition depends on something that is no earlier parameter.
pub fn total_derivatives(parameters: &[Parameter<'_>]) -> Result<Vec<Vec<(usize, f64)>>, TapeError> {
    let middle = |of: Vec<(usize, Interval)>| of.into_iter().map(|(k, follows)| (k, follows.middle())).collect();
    Ok(following(parameters, |_| true)?.into_iter().map(middle).collect())
}

/// The total derivatives of all parameters with respect to each of them, which is changed itself while its definition is left
/// aside: as when it is given another value by hand. Of each the parameters that follow it and for which `moves` says so.
fn following(
    parameters: &[Parameter<'_>],
    moves: impl Fn(usize) -> bool,
) -> Result<Vec<Vec<(usize, Interval)>>, TapeError> {
    let (count, zero) = (parameters.len(), Interval::point(0.0));
    let mut total = vec![zero; count * count];
    let variables: Vec<Expr<'_>> = parameters.iter().map(|parameter| parameter.variable).collect();
    let values: Vec<Interval> = parameters.iter().map(|parameter| Interval::point(parameter.value)).collect();
    for (i, parameter) in parameters.iter().enumerate() {
        total[i * count + i] = Interval::point(1.0);
        let earlier = &variables[..i];
        let slopes: Vec<Expr<'_>> = earlier.iter().map(|earlier| parameter.definition.derivative(*earlier)).collect();
        let mut direct = vec![zero; i];
        IntervalEvaluator::new(&Tape::new(&slopes, earlier)?).run(&values[..i], &mut direct);
        for (k, slope) in direct.into_iter().enumerate().filter(|(_, slope)| *slope != zero) {
            for j in 0..=k {
                total[i * count + j] = total[i * count + j] + slope * total[k * count + j];
            }
        }
    }
    let of = |j: usize| {
        let following = (j..count).map(|i| (i, total[i * count + j]));
        following.filter(|(i, follows)| *follows != zero && moves(*i)).collect()
    };
    Ok((0..count).map(of).collect())
}
