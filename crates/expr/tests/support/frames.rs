//! Random chains, and the same chains as dense matrices of another library.
#![allow(dead_code, unreachable_pub)] // each test file uses its own part of it

use flank_expr::geometry::{Axis, Chain, Matrix3, Pose, Step, Vector3};
use flank_expr::{Expr, Graph};
use nalgebra as na;

use super::Random;

/// A graph's variables for chains and surfaces, and where they are evaluated.
pub struct Setting<'g> {
    pub graph: &'g Graph,
    pub u: Expr<'g>,
    pub v: Expr<'g>,
    pub motion: Expr<'g>,
    pub second: Expr<'g>,
    pub parameter: Expr<'g>,
}

/// Values of the variables of a [`Setting`], in order of creation.
pub type Point = [f64; 5];

impl<'g> Setting<'g> {
    pub fn new(graph: &'g Graph) -> Setting<'g> {
        let [u, v, motion, second, parameter] = ["u", "v", "phi", "psi", "p"].map(|name| graph.variable(name));
        Setting { graph, u, v, motion, second, parameter }
    }

    pub fn point(random: &mut Random) -> Point {
        std::array::from_fn(|_| random.between(-1.2, 1.2))
    }

    /// A number, a parameter, or a function of the motions.
    pub fn scalar(&self, random: &mut Random) -> Expr<'g> {
        let c = |random: &mut Random| random.between(-2.0, 2.0);
        match random.below(6) {
            0 => self.graph.constant(c(random)),
            1 => c(random) * self.parameter,
            2 => c(random) * self.motion,
            3 => self.motion.squared() * c(random) + self.parameter,
            4 => (self.motion + c(random)).sin() * self.second,
            _ => c(random) * self.second + self.motion,
        }
    }

    pub fn vector(&self, random: &mut Random) -> Vector3<'g> {
        Vector3(std::array::from_fn(|_| self.scalar(random)))
    }

    /// A unit vector; it turns with the motion if `is_moving`.
    pub fn axis(&self, random: &mut Random, is_moving: bool) -> Vector3<'g> {
        let tilt = random.between(0.2, 1.4);
        let angle = if is_moving { self.motion * 0.7 + tilt } else { self.parameter + tilt };
        let (s, c) = (angle.sin(), angle.cos());
        Vector3([s * tilt.cos(), s * tilt.sin(), c])
    }

    pub fn step(&self, random: &mut Random) -> Step<'g> {
        let angle = self.scalar(random);
        match random.below(9) {
            0 | 1 => Step::Translate(self.vector(random)),
            2 => Step::Rotate(Axis::X, angle),
            3 => Step::Rotate(Axis::Y, angle),
            4 => Step::Rotate(Axis::Z, angle),
            5 => Step::Rotate(Axis::Along(self.axis(random, false)), angle),
            6 => Step::Rotate(Axis::Along(self.axis(random, true)), angle),
            7 => Step::Mirror(if random.below(2) == 0 { Axis::Y } else { Axis::Along(self.axis(random, false)) }),
            _ => {
                let axis = Axis::Along(self.axis(random, false));
                let turned = Step::Rotate(axis, angle).pose(self.graph);
                Step::Rigid(Pose { translation: self.vector(random), ..turned })
            }
        }
    }

    pub fn chain(&self, random: &mut Random, length: usize) -> Chain<'g> {
        Chain::new(self.graph, (0..length).map(|_| self.step(random)).collect())
    }

    pub fn number(&self, f: Expr<'g>, at: &Point) -> f64 {
        self.graph.evaluate(&[f], at)[0]
    }

    pub fn vector_at(&self, f: Vector3<'g>, at: &Point) -> na::Vector3<f64> {
        na::Vector3::from_column_slice(&self.graph.evaluate(&f.0, at))
    }

    pub fn matrix_at(&self, f: Matrix3<'g>, at: &Point) -> na::Matrix3<f64> {
        na::Matrix3::from_row_slice(&self.graph.evaluate(&f.entries(), at))
    }

    pub fn pose_at(&self, pose: Pose<'g>, at: &Point) -> na::Matrix4<f64> {
        let rows = pose.matrix4().concat();
        na::Matrix4::from_row_slice(&self.graph.evaluate(&rows, at))
    }

    /// The chain multiplied out from numbers, one 4 × 4 matrix for each step.
    pub fn dense(&self, chain: &Chain<'g>, at: &Point) -> na::Matrix4<f64> {
        chain.steps().iter().map(|step| self.dense_step(step, at)).product()
    }

    fn direction_at(&self, axis: Axis<'g>, at: &Point) -> na::Vector3<f64> {
        match axis {
            Axis::X => na::Vector3::x(),
            Axis::Y => na::Vector3::y(),
            Axis::Z => na::Vector3::z(),
            Axis::Along(axis) => self.vector_at(axis, at),
        }
    }

    fn dense_step(&self, step: &Step<'g>, at: &Point) -> na::Matrix4<f64> {
        match *step {
            Step::Translate(by) => na::Matrix4::new_translation(&self.vector_at(by, at)),
            Step::Rotate(axis, angle) => {
                let direction = na::Unit::new_normalize(self.direction_at(axis, at));
                na::Matrix4::from_axis_angle(&direction, self.number(angle, at))
            }
            Step::Mirror(axis) => {
                let direction = self.direction_at(axis, at);
                (na::Matrix3::identity() - 2.0 * direction * direction.transpose()).to_homogeneous()
            }
            Step::Rigid(pose) => {
                let mut matrix = self.matrix_at(pose.rotation, at).to_homogeneous();
                matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&self.vector_at(pose.translation, at));
                matrix
            }
        }
    }
}

/// The derivative of a matrix along one variable by central differences, fourth order.
pub fn slope<T>(at: &Point, variable: usize, f: impl Fn(&Point) -> T) -> T
where
    T: std::ops::Sub<Output = T> + std::ops::Mul<f64, Output = T>,
{
    const STEP: f64 = 1e-3;
    let beside = |steps: f64| {
        let mut moved = *at;
        moved[variable] += steps * STEP;
        f(&moved)
    };
    let near = (beside(1.0) - beside(-1.0)) * (8.0 / (12.0 * STEP));
    let far = (beside(2.0) - beside(-2.0)) * (1.0 / (12.0 * STEP));
    near - far
}
