//! A surface whose settings get other numbers without anything being derived or laid out again.

use flank_expr::{Expr, TapeError};

use crate::surface::SurfaceProblem;
use crate::surface::bound::BoundSurface;

/// Points of surfaces that differ by the values of some settings: compiled once, solved for many values.
#[derive(Clone, Debug)]
pub struct SurfaceFamily {
    problem: SurfaceProblem,
}

impl SurfaceFamily {
    /// Points of `surface` at which two `coordinates` have given values, while `settings` stay open: variables that the surface depends
    /// on and that `surface` has no values for, each with its nominal value.
    ///
    /// ```
    /// use flank_expr::Graph;
    /// use flank_expr::geometry::{Surface, Vector3};
    /// use flank_solver::{BoundSurface, Range, SurfaceFamily};
    ///
    /// let graph = Graph::new();
    /// let [u, v, radius] = ["u", "v", "radius"].map(|name| graph.variable(name));
    /// let position = Vector3([u.cos() * v.cos(), u.sin() * v.cos(), v.sin()].map(|part| radius * part));
    /// let sphere = Surface::parametric([u, v], position, false);
    /// let ranges = vec![Range { low: -1.0, high: 1.0 }; 2];
    /// let family = SurfaceFamily::new(&BoundSurface::new(&sphere, ranges, &[]), [u, v], &[(radius, 5.0)], |problem| Ok(problem))?;
    /// let (points, _) = family.at(&[7.0]).solve(&[[0.0, 0.0]], [1, 1]);
    /// assert!((points[0].position[0] - 7.0).abs() < 1e-14);
    /// # Ok::<(), flank_expr::TapeError>(())
    /// ```
    ///
    /// `made` goes on with the problem while the settings are open: what is kept of branches, how far they are followed.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor open nor has a value; what `made` gives.
    ///
    /// # Panics
    /// As for [`SurfaceProblem::new`].
    pub fn new<'g>(
        surface: &BoundSurface<'g>,
        coordinates: [Expr<'g>; 2],
        settings: &[(Expr<'g>, f64)],
        made: impl FnOnce(SurfaceProblem) -> Result<SurfaceProblem, TapeError>,
    ) -> Result<SurfaceFamily, TapeError> {
        SurfaceFamily::open(settings, coordinates[0], || SurfaceProblem::new(surface, coordinates).and_then(made))
    }

    /// The same for the line on which a `quantity` is zero, at values of one more coordinate: see [`SurfaceProblem::line`].
    ///
    /// # Errors
    /// As for [`SurfaceFamily::new`].
    ///
    /// # Panics
    /// As for [`SurfaceProblem::line`].
    pub fn line<'g>(
        surface: &BoundSurface<'g>,
        [quantity, along]: [Expr<'g>; 2],
        settings: &[(Expr<'g>, f64)],
        made: impl FnOnce(SurfaceProblem) -> Result<SurfaceProblem, TapeError>,
    ) -> Result<SurfaceFamily, TapeError> {
        SurfaceFamily::open(settings, quantity, || SurfaceProblem::line(surface, quantity, along).and_then(made))
    }

    fn open<'g>(
        settings: &[(Expr<'g>, f64)],
        of: Expr<'g>,
        make: impl FnOnce() -> Result<SurfaceProblem, TapeError>,
    ) -> Result<SurfaceFamily, TapeError> {
        let problem = of.graph().with_settings(settings, make)?;
        problem.system.translate();
        problem.slopes.translate(problem.system.instructions());
        Ok(SurfaceFamily { problem })
    }

    /// The problem with these values of the settings, in their order.
    ///
    /// # Panics
    /// If there are not as many.
    pub fn at(&self, values: &[f64]) -> SurfaceProblem {
        self.problem.with_settings(values)
    }
}
