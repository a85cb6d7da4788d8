//! Whether a tool leaves the points that it generates: second order contact of tool and work.

use crate::geometry::minors::determinant;
use crate::geometry::surface::Surface;
use crate::geometry::vector::Vector3;
use crate::symbolic::graph::{Expr, Graph};

impl<'g> Surface<'g> {
    /// The leading minors of the Hessian of the clearance, one for each constraint of a motion: all positive where the tool leaves
    /// the point that it generates.
    ///
    /// The clearance of a point of the work is its distance from the tool's steel as a function of the motions. Where the
    /// tool generates the point, it is zero and stationary. The point stays only if that is a minimum, so if the Hessian
    /// is positive definite; else the tool, a little before or after, cuts the point away. The last minor is zero on the
    /// singular line. The k-th has the unit mm^k / (product of the squares of the first k motions' units); for one motion it
    /// is the second derivative of the clearance, mm/rad².
    ///
    /// With δ_k the determinant of ∂c/∂p and ∂r/∂p bordered by n, restricted to the first k constraints and k + 2
    /// unknowns, the k-th minor is (−1)^k δ_k / δ_0. They are found from c, r and n alone, for the k-th constraint belongs
    /// to the motion that is unknown k + 2 and is −n · ∂r/∂motion. For an envelope of an envelope the later minors are those
    /// of the later motions times the last of the earlier ones. Where an equation gives the tool, δ₁ of that alone takes the place
    /// of δ₀, and each later one that of the one before: what two parameters of the tool's own would change is a common factor.
    ///
    /// # Panics
    /// If the surface does not have two unknowns more than constraints.
    pub fn clearance_minors(&self) -> Vec<Expr<'g>> {
        let graph = self.normal.0[0].graph();
        let slopes: Vec<Vector3<'g>> = self.unknowns.iter().map(|&p| self.position.derivative(p)).collect();
        let rows: Vec<Vec<Expr<'g>>> =
            self.constraints.iter().map(|c| self.unknowns.iter().map(|&p| c.derivative(p)).collect()).collect();
        let bordered = |k: usize| self.oriented_area(graph, &rows[..k], &slopes[..k + 2]);
        let area = bordered(self.given);
        (1..=rows.len() - self.given)
            .map(|k| {
                let bordered = bordered(self.given + k);
                (if k % 2 == 0 { bordered } else { -bordered }) / area
            })
            .collect()
    }

    /// The determinant of the constraints' derivatives by the motions: zero where the lines of contact have an envelope on the
    /// tool. Beyond that line no point of the tool generates anything. `None` without motions.
    pub fn contact_limit(&self) -> Option<Expr<'g>> {
        let motions = self.unknowns.get(2 + self.given..).filter(|motions| !motions.is_empty())?;
        let meshing = &self.constraints[self.given..];
        let rows: Vec<Vec<Expr<'g>>> =
            meshing.iter().map(|c| motions.iter().map(|&motion| c.derivative(motion)).collect()).collect();
        let columns: Vec<usize> = (0..motions.len()).collect();
        Some(determinant(motions[0].graph(), &rows, &columns))
    }

    /// det [∂c/∂p 0; ∂r/∂p n], by Laplace's expansion: the minors of ∂c/∂p against (r_a × r_b) · n.
    fn oriented_area(&self, graph: &'g Graph, rows: &[Vec<Expr<'g>>], slopes: &[Vector3<'g>]) -> Expr<'g> {
        let mut sum = graph.constant(0.0);
        for a in 0..slopes.len() {
            for b in a + 1..slopes.len() {
                let others: Vec<usize> = (0..slopes.len()).filter(|&k| k != a && k != b).collect();
                let term = determinant(graph, rows, &others) * slopes[a].cross(slopes[b]).dot(self.normal);
                sum = if (a + b) % 2 == 1 { sum + term } else { sum - term };
            }
        }
        sum
    }
}
