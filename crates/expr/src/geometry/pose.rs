//! Rotation and translation, kept apart.

use crate::geometry::vector::{Matrix3, Vector3};
use crate::symbolic::graph::{Expr, Graph};

/// The pose of a child frame in its parent: `p_parent = rotation · p_child + translation`.
///
/// A pose named `t_a_b` is the pose of frame b in frame a, so that `t_a_c = t_a_b.then(t_b_c)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pose<'g> {
    /// Orthogonal matrix: columns are the child's axes in the parent.
    pub rotation: Matrix3<'g>,
    /// The child's origin in the parent, mm.
    pub translation: Vector3<'g>,
}

/// How a frame moves along one motion parameter, per unit of it, given in the moving frame itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Twist<'g> {
    /// Angular velocity.
    pub angular: Vector3<'g>,
    /// Velocity of the point of the moving body that is in the origin.
    pub linear: Vector3<'g>,
}

impl<'g> Pose<'g> {
    /// The pose of a frame in itself.
    pub fn identity(graph: &'g Graph) -> Pose<'g> {
        Pose { rotation: Matrix3::identity(graph), translation: Vector3::zero(graph) }
    }

    /// `t_a_b.then(t_b_c) = t_a_c`.
    pub fn then(self, t_b_c: Pose<'g>) -> Pose<'g> {
        Pose { rotation: self.rotation.product(t_b_c.rotation), translation: self.point(t_b_c.translation) }
    }

    /// The pose of the parent in the child: the rotation's transpose, exact.
    pub fn inverse(self) -> Pose<'g> {
        let rotation = self.rotation.transposed();
        Pose { rotation, translation: -rotation.times(self.translation) }
    }

    /// A point of the child in the parent.
    pub fn point(self, p_child: Vector3<'g>) -> Vector3<'g> {
        self.rotation.times(p_child) + self.translation
    }

    /// A direction of the child in the parent.
    pub fn direction(self, n_child: Vector3<'g>) -> Vector3<'g> {
        self.rotation.times(n_child)
    }

    /// The homogeneous 4 × 4 matrix, as rows.
    pub fn matrix4(self) -> [[Expr<'g>; 4]; 4] {
        let graph = self.translation.0[0].graph();
        let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
        let row = |i: usize| {
            let [a, b, c] = self.rotation.0[i].0;
            [a, b, c, self.translation.0[i]]
        };
        [row(0), row(1), row(2), [zero, zero, zero, one]]
    }

    /// M⁻¹ ∂M/∂motion: how the child moves in the parent, given in the child.
    pub fn twist(self, motion: Expr<'g>) -> Twist<'g> {
        let inverse = self.rotation.transposed();
        let spin = inverse.product(self.rotation.derivative(motion)).0;
        Twist {
            angular: Vector3([spin[2].0[1], spin[0].0[2], spin[1].0[0]]),
            linear: inverse.times(self.translation.derivative(motion)),
        }
    }
}

impl<'g> Twist<'g> {
    /// No motion.
    pub fn zero(graph: &'g Graph) -> Twist<'g> {
        Twist { angular: Vector3::zero(graph), linear: Vector3::zero(graph) }
    }

    /// Sum of two twists of one frame.
    pub fn plus(self, other: Twist<'g>) -> Twist<'g> {
        Twist { angular: self.angular + other.angular, linear: self.linear + other.linear }
    }

    /// Difference of two twists of one frame.
    pub fn minus(self, other: Twist<'g>) -> Twist<'g> {
        Twist { angular: self.angular - other.angular, linear: self.linear - other.linear }
    }

    /// Velocity of a point that moves with the frame: ω × p + v.
    pub fn velocity(self, p: Vector3<'g>) -> Vector3<'g> {
        self.angular.cross(p) + self.linear
    }

    /// True if nothing moves.
    pub fn is_zero(self) -> bool {
        self.angular.is_zero() && self.linear.is_zero()
    }
}
