//! How a surface moves when the numbers that it was made with change.

use flank_expr::geometry::Surface;
use flank_expr::{Expr, ScalarEvaluator, Tape, TapeError};
use nalgebra::{DMatrix, DMatrixView, Vector3};

/// A displacement of which the normal takes no more than this share is one along the surface: what is left is the rounding
/// of a normal that follows from solved unknowns.
const ALONG: f64 = 1e-12;

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
    parameters: usize,
    tape: Tape,
    /// How parameter i (row) follows parameter j (column).
    following: DMatrix<f64>,
}

impl NormalSensitivity {
    /// The sensitivity of `surface` to `parameters`, which stand in such an order that definitions depend on earlier ones only.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor a parameter.
    pub fn new<'g>(surface: &Surface<'g>, parameters: &[Parameter<'g>]) -> Result<NormalSensitivity, TapeError> {
        let graph = surface.position.0[0].graph();
        let bindings: Vec<(Expr<'g>, Expr<'g>)> =
            parameters.iter().map(|parameter| (parameter.variable, graph.constant(parameter.value))).collect();
        let slopes = parameters.iter().flat_map(|parameter| surface.position.derivative(parameter.variable).0);
        let outputs: Vec<Expr<'g>> = surface.normal.0.into_iter().chain(slopes).collect();
        Ok(NormalSensitivity {
            parameters: parameters.len(),
            tape: Tape::new(&graph.substitute(&outputs, &bindings), &surface.unknowns)?,
            following: following(parameters, &bindings)?,
        })
    }

    /// For each parameter, mm of normal displacement (plus is outwards, more material) per unit of the parameter: mm, radian or
    /// 1. Exactly zero where the parameter moves the point along the surface or not at all. `None` where it is not finite.
    ///
    /// # Panics
    /// If there is not one number for each unknown.
    pub fn at(&self, unknowns: &[f64]) -> Option<Vec<f64>> {
        let mut out = vec![0.0; self.tape.output_count()];
        ScalarEvaluator::new(&self.tape).run(unknowns, &mut out);
        let normal = Vector3::from_column_slice(&out[..3]);
        let displacements = DMatrixView::from_slice(&out[3..], 3, self.parameters) * &self.following;
        let along_normal = |moved: Vector3<f64>| {
            let share = normal.dot(&moved);
            if share.abs() <= ALONG * moved.norm() { 0.0 } else { share }
        };
        let all: Vec<f64> =
            displacements.fixed_rows::<3>(0).column_iter().map(|c| along_normal(c.into_owned())).collect();
        all.iter().all(|moved| moved.is_finite()).then_some(all)
    }
}

/// The total derivatives of all parameters with respect to each of them, which is changed itself while its definition is left
/// aside: as when it is given another value by hand.
fn following<'g>(parameters: &[Parameter<'g>], bindings: &[(Expr<'g>, Expr<'g>)]) -> Result<DMatrix<f64>, TapeError> {
    let mut total = DMatrix::identity(parameters.len(), parameters.len());
    for (i, parameter) in parameters.iter().enumerate() {
        let graph = parameter.variable.graph();
        let slopes: Vec<Expr<'g>> =
            parameters[..i].iter().map(|earlier| parameter.definition.derivative(earlier.variable)).collect();
        let tape = Tape::new(&graph.substitute(&slopes, bindings), &[])?;
        let mut direct = vec![0.0; i];
        ScalarEvaluator::new(&tape).run(&[], &mut direct);
        for (k, slope) in direct.into_iter().enumerate().filter(|(_, slope)| *slope != 0.0) {
            for j in 0..=k {
                total[(i, j)] += slope * total[(k, j)];
            }
        }
    }
    Ok(total)
}
