//! Principal curvatures as functions of the unknowns.

use crate::geometry::minors::cofactors;
use crate::geometry::surface::Surface;
use crate::geometry::vector::Vector3;
use crate::symbolic::graph::Expr;

/// Unknowns up to which the minors of the Jacobian are written out: their number grows with its factorial.
const MOST_UNKNOWNS: usize = 4;

impl<'g> Surface<'g> {
    /// The principal curvatures, the larger one first, 1/mm, positive where the body that owns the surface is convex; in the
    /// directions along which two `coordinates`, functions of the unknowns, change. Not a number where these do not fix a
    /// point. `None` with more than four unknowns.
    ///
    /// Along coordinate k the unknowns change as column k of the adjugate of ∂(c, coordinates)/∂p. What position and normal do
    /// on these two ways gives the shape operator, and its scale cancels.
    ///
    /// # Panics
    /// If the surface does not have two unknowns more than constraints.
    pub fn principal_curvatures(&self, coordinates: [Expr<'g>; 2]) -> Option<[Expr<'g>; 2]> {
        let count = self.unknowns.len();
        assert_eq!(count, self.constraints.len() + 2, "a surface has two unknowns more than constraints");
        if count > MOST_UNKNOWNS {
            return None;
        }
        let graph = coordinates[0].graph();
        let slopes = |f: &Expr<'g>| self.unknowns.iter().map(|&p| f.derivative(p)).collect::<Vec<_>>();
        let rows: Vec<Vec<Expr<'g>>> = self.constraints.iter().chain(&coordinates).map(slopes).collect();
        let way = |k: usize| cofactors(graph, &rows, self.constraints.len() + k);
        let along = |vector: Vector3<'g>, way: &[Expr<'g>]| {
            let terms = self.unknowns.iter().zip(way).map(|(&p, &by)| vector.derivative(p).scaled(by));
            terms.fold(Vector3::zero(graph), |sum, term| sum + term)
        };
        let (first, second) = (way(0), way(1));
        let [r1, r2] = [&first, &second].map(|way| along(self.position, way));
        let [n1, n2] = [&first, &second].map(|way| along(self.normal, way));
        // the second way made square to the first one
        let size = r1.dot(r1);
        let share = r1.dot(r2) / size;
        let (r2, n2) = (r2 - r1.scaled(share), n2 - n1.scaled(share));
        let across = r2.dot(r2);
        let (a, c) = (r1.dot(n1) / size, r2.dot(n2) / across);
        let twisting = r1.dot(n2);
        let (mean, half) = (0.5 * (a + c), 0.5 * (a - c));
        let radius = (half.squared() + twisting.squared() / (size * across)).sqrt();
        Some([mean + radius, mean - radius])
    }
}
