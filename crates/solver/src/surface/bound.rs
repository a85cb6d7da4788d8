//! A surface whose parameters have values, and the square system that its points solve.

use flank_expr::geometry::Surface;
use flank_expr::{Expr, TapeError};

use crate::equations::solution::Range;
use crate::equations::system::System;

/// A surface with the values of its parameters and the ranges in which its unknowns are looked for: what all that solves points of a
/// surface starts from.
#[derive(Clone, Debug)]
pub struct BoundSurface<'g> {
    surface: Surface<'g>,
    ranges: Vec<Range>,
    values: Vec<(Expr<'g>, Expr<'g>)>,
}

/// The equations of a point at given values of two coordinates.
pub(crate) struct PointEquations<'g> {
    /// The values that are asked for.
    pub(crate) targets: [Expr<'g>; 2],
    pub(crate) coordinates: [Expr<'g>; 2],
    /// The constraints, then each coordinate less its target: as many as unknowns.
    pub(crate) residuals: Vec<Expr<'g>>,
}

impl<'g> BoundSurface<'g> {
    /// Of `surface` with its unknowns in `ranges`; `values` replace the remaining variables (parameters).
    ///
    /// # Panics
    /// If `ranges` has not one entry per unknown.
    pub fn new(surface: &Surface<'g>, ranges: Vec<Range>, values: &[(Expr<'g>, Expr<'g>)]) -> BoundSurface<'g> {
        assert_eq!(surface.unknowns.len(), ranges.len(), "one range for each unknown");
        BoundSurface { surface: surface.bound(values), ranges, values: values.to_vec() }
    }

    /// The surface as a function of its unknowns alone.
    pub fn surface(&self) -> &Surface<'g> {
        &self.surface
    }

    /// Where its unknowns are looked for.
    pub fn ranges(&self) -> &[Range] {
        &self.ranges
    }

    /// Functions of its unknowns and parameters, with the values of the parameters.
    pub fn with_values(&self, functions: &[Expr<'g>]) -> Vec<Expr<'g>> {
        match functions.first() {
            Some(first) => first.graph().substitute(functions, &self.values),
            None => Vec::new(),
        }
    }

    /// The square system of a point at given values of two coordinates, functions of the unknowns: its parameters are the two values,
    /// then `open`, the parameters of the surface that have no value yet.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown, nor open, nor has a value.
    ///
    /// # Panics
    /// If the surface does not have two unknowns more than constraints.
    pub fn square_system(&self, coordinates: [Expr<'g>; 2], open: &[Expr<'g>]) -> Result<System, TapeError> {
        let PointEquations { targets, residuals, .. } = self.equations_at(coordinates);
        let parameters: Vec<Expr<'g>> = targets.into_iter().chain(open.iter().copied()).collect();
        System::new(&residuals, &self.surface.unknowns, &parameters)
    }

    pub(crate) fn equations_at(&self, coordinates: [Expr<'g>; 2]) -> PointEquations<'g> {
        let graph = coordinates[0].graph();
        let targets = [graph.variable("target 1"), graph.variable("target 2")];
        let coordinates = graph.substitute(&coordinates, &self.values);
        let coordinates = [coordinates[0], coordinates[1]];
        let on_target = coordinates.into_iter().zip(targets).map(|(coordinate, target)| coordinate - target);
        PointEquations { targets, coordinates, residuals: self.constrained(on_target) }
    }

    /// The constraints, then further equations.
    pub(crate) fn constrained(&self, further: impl IntoIterator<Item = Expr<'g>>) -> Vec<Expr<'g>> {
        self.surface.constraints.iter().copied().chain(further).collect()
    }

    /// The same surface in unknowns of its own, each named after the old one.
    pub(crate) fn renamed(&self, suffix: &str) -> BoundSurface<'g> {
        let unknowns = &self.surface.unknowns;
        let own: Vec<Expr<'g>> = unknowns.iter().map(|&p| p.graph().variable(format!("{p} {suffix}"))).collect();
        let renaming: Vec<(Expr<'g>, Expr<'g>)> = unknowns.iter().copied().zip(own.iter().copied()).collect();
        let surface = Surface { unknowns: own, ..self.surface.bound(&renaming) };
        BoundSurface { surface, ranges: self.ranges.clone(), values: Vec::new() }
    }
}
