//! Chains of elementary transforms between two frames.

use crate::geometry::pose::{Pose, Twist};
use crate::geometry::turned::{Turn, Turned};
use crate::geometry::vector::{Matrix3, Vector3};
use crate::symbolic::graph::{Expr, Graph};

/// The line that a rotation turns about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis<'g> {
    /// The frame's x axis.
    X,
    /// The frame's y axis.
    Y,
    /// The frame's z axis.
    Z,
    /// A unit vector through the origin.
    Along(Vector3<'g>),
}

/// One elementary transform, read from parent to child.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step<'g> {
    /// The child's origin is moved, its axes stay.
    Translate(Vector3<'g>),
    /// The child is turned right-handed about an axis through the common origin.
    Rotate(Axis<'g>, Expr<'g>),
    /// An explicit rigid motion.
    Rigid(Pose<'g>),
    /// The child is the mirror image in the plane through the common origin, square to an axis that stands still.
    Mirror(Axis<'g>),
}

impl<'g> Step<'g> {
    /// The same step from child to parent.
    pub fn inverse(self) -> Step<'g> {
        match self {
            Step::Translate(by) => Step::Translate(-by),
            Step::Rotate(axis, angle) => Step::Rotate(axis, -angle),
            Step::Rigid(pose) => Step::Rigid(pose.inverse()),
            Step::Mirror(_) => self,
        }
    }

    /// The pose of the child in the parent.
    pub fn pose(self, graph: &'g Graph) -> Pose<'g> {
        match self {
            Step::Translate(translation) => Pose { rotation: Matrix3::identity(graph), translation },
            Step::Rotate(axis, angle) => {
                Pose { rotation: rotation(graph, axis, angle), translation: Vector3::zero(graph) }
            }
            Step::Rigid(pose) => pose,
            Step::Mirror(axis) => Pose { rotation: reflection(graph, axis), translation: Vector3::zero(graph) },
        }
    }

    /// How the child moves in the parent along a motion, given in the child.
    pub fn twist(self, graph: &'g Graph, motion: Expr<'g>) -> Twist<'g> {
        match self {
            Step::Translate(by) => Twist { angular: Vector3::zero(graph), linear: by.derivative(motion) },
            Step::Rotate(axis, angle) if axis.stands_still(motion) => {
                Twist { angular: axis.direction(graph).scaled(angle.derivative(motion)), linear: Vector3::zero(graph) }
            }
            Step::Rotate(..) | Step::Rigid(_) => self.pose(graph).twist(motion),
            Step::Mirror(_) => Twist::zero(graph),
        }
    }

    /// One step instead of two, where the two commute into one of the same kind.
    fn merged(self, next: Step<'g>, graph: &'g Graph) -> Option<Step<'g>> {
        match (self, next) {
            (Step::Translate(a), Step::Translate(b)) => Some(Step::Translate(a + b)),
            (Step::Rotate(axis, a), Step::Rotate(same, b)) if axis == same => Some(Step::Rotate(axis, a + b)),
            // twice mirrored is not mirrored
            (Step::Mirror(axis), Step::Mirror(same)) if axis == same => Some(Step::Translate(Vector3::zero(graph))),
            _ => None,
        }
    }

    fn is_identity(self) -> bool {
        match self {
            Step::Translate(by) => by.is_zero(),
            Step::Rotate(_, angle) => angle.is_zero(),
            Step::Rigid(_) | Step::Mirror(_) => false,
        }
    }

    fn expressions(self) -> Vec<Expr<'g>> {
        match self {
            Step::Translate(by) => by.0.to_vec(),
            Step::Rotate(Axis::Along(axis), angle) => axis.0.into_iter().chain([angle]).collect(),
            Step::Rotate(_, angle) => vec![angle],
            Step::Mirror(Axis::Along(axis)) => axis.0.to_vec(),
            Step::Mirror(_) => Vec::new(),
            Step::Rigid(pose) => pose.rotation.entries().into_iter().chain(pose.translation.0).collect(),
        }
    }

    fn rebuilt(self, new: &[Expr<'g>]) -> Step<'g> {
        match self {
            Step::Translate(_) => Step::Translate(Vector3([new[0], new[1], new[2]])),
            Step::Rotate(Axis::Along(_), _) => Step::Rotate(Axis::Along(Vector3([new[0], new[1], new[2]])), new[3]),
            Step::Rotate(axis, _) => Step::Rotate(axis, new[0]),
            Step::Mirror(Axis::Along(_)) => Step::Mirror(Axis::Along(Vector3([new[0], new[1], new[2]]))),
            Step::Mirror(_) => self,
            Step::Rigid(_) => {
                let row = |i: usize| Vector3([new[3 * i], new[3 * i + 1], new[3 * i + 2]]);
                Step::Rigid(Pose { rotation: Matrix3([row(0), row(1), row(2)]), translation: row(3) })
            }
        }
    }
}

impl<'g> Axis<'g> {
    /// The axis as a unit vector.
    pub fn direction(self, graph: &'g Graph) -> Vector3<'g> {
        match self {
            Axis::X => Vector3::constant(graph, [1.0, 0.0, 0.0]),
            Axis::Y => Vector3::constant(graph, [0.0, 1.0, 0.0]),
            Axis::Z => Vector3::constant(graph, [0.0, 0.0, 1.0]),
            Axis::Along(axis) => axis,
        }
    }

    fn stands_still(self, motion: Expr<'g>) -> bool {
        match self {
            Axis::Along(axis) => axis.derivative(motion).is_zero(),
            Axis::X | Axis::Y | Axis::Z => true,
        }
    }
}

/// I − 2 a aᵀ.
fn reflection<'g>(graph: &'g Graph, axis: Axis<'g>) -> Matrix3<'g> {
    let a = axis.direction(graph);
    let identity = Matrix3::identity(graph);
    Matrix3(std::array::from_fn(|i| identity.0[i] - a.scaled(2.0 * a.0[i])))
}

/// Right-handed rotation: about x, y, z as usual, about any unit vector by Rodrigues' formula.
fn rotation<'g>(graph: &'g Graph, axis: Axis<'g>, angle: Expr<'g>) -> Matrix3<'g> {
    let (c, s) = (angle.cos(), angle.sin());
    let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
    let rows = match axis {
        Axis::X => [[one, zero, zero], [zero, c, -s], [zero, s, c]],
        Axis::Y => [[c, zero, s], [zero, one, zero], [-s, zero, c]],
        Axis::Z => [[c, -s, zero], [s, c, zero], [zero, zero, one]],
        Axis::Along(Vector3([x, y, z])) => {
            let v = 1.0 - c;
            [
                [c + x * x * v, x * y * v - z * s, x * z * v + y * s],
                [x * y * v + z * s, c + y * y * v, y * z * v - x * s],
                [x * z * v - y * s, y * z * v + x * s, c + z * z * v],
            ]
        }
    };
    Matrix3(rows.map(Vector3))
}

/// Elementary transforms in a row: the pose of the last child in the first parent.
///
/// A chain named `t_work_hob` leads from the work frame (left) to the hob frame (right).
#[derive(Clone, Debug)]
pub struct Chain<'g> {
    graph: &'g Graph,
    steps: Vec<Step<'g>>,
}

impl<'g> Chain<'g> {
    /// A chain from its steps, read from parent to child, exactly as given.
    pub fn new(graph: &'g Graph, steps: Vec<Step<'g>>) -> Chain<'g> {
        Chain { graph, steps }
    }

    /// The steps, from parent to child.
    pub fn steps(&self) -> &[Step<'g>] {
        &self.steps
    }

    /// `t_a_b.then(t_b_c) = t_a_c`, steps side by side.
    pub fn then(&self, t_b_c: &Chain<'g>) -> Chain<'g> {
        Chain { graph: self.graph, steps: self.steps.iter().chain(&t_b_c.steps).copied().collect() }
    }

    /// The chain up to its `k`-th frame (0 is the first parent), and from there on.
    ///
    /// # Panics
    /// If the chain does not have that many steps.
    pub fn split(&self, k: usize) -> (Chain<'g>, Chain<'g>) {
        let part = |steps: &[Step<'g>]| Chain { graph: self.graph, steps: steps.to_vec() };
        (part(&self.steps[..k]), part(&self.steps[k..]))
    }

    /// Frames beside the steps that a motion moves, as places for [`Chain::split`]: all of them if they are few and the chain
    /// is short, else the last one.
    pub(crate) fn frames_beside(&self, motion: Expr<'g>) -> Vec<usize> {
        const FEW: usize = 8;
        const SHORT: usize = 100;
        let moves = |k: &usize| !self.steps[*k].twist(self.graph, motion).is_zero();
        let mut frames: Vec<usize> = (0..self.steps.len()).filter(moves).flat_map(|k| [k, k + 1]).collect();
        frames.dedup();
        if frames.len() > FEW || self.steps.len() > SHORT { vec![self.steps.len()] } else { frames }
    }

    /// The pose of the parent in the child.
    pub fn inverse(&self) -> Chain<'g> {
        Chain { graph: self.graph, steps: self.steps.iter().rev().map(|step| step.inverse()).collect() }
    }

    /// Neighbours of one kind merged (two rotations about one axis add their angles), steps that do nothing left out. Links that keep a
    /// frame parallel are one translation: turns about one axis, with translations between them, whose angles add up to nothing.
    pub fn merged(&self) -> Chain<'g> {
        let mut steps: Vec<Step<'g>> = Vec::new();
        for &step in &self.steps {
            let mut next = step;
            loop {
                if let Some(both) = steps.last().and_then(|last| last.merged(next, self.graph)) {
                    steps.pop();
                    next = both;
                } else if let Some((first, shift)) = self.parallel(&steps, next) {
                    steps.truncate(first);
                    next = Step::Translate(shift);
                } else {
                    break;
                }
            }
            if !next.is_identity() {
                steps.push(next);
            }
        }
        Chain { graph: self.graph, steps }
    }

    /// Where the run of links begins that the next turn closes so that nothing is turned, and how far they lead.
    fn parallel(&self, steps: &[Step<'g>], next: Step<'g>) -> Option<(usize, Vector3<'g>)> {
        let Step::Rotate(axis, mut angle) = next else { return None };
        /// Steps that are looked back on: a chain of many frames costs no more for each of them.
        const MOST: usize = 8;
        let mut run = steps.iter().enumerate().rev().take(MOST).map_while(|(place, step)| match *step {
            Step::Translate(_) => Some((place, None)),
            Step::Rotate(about, angle) if about == axis => Some((place, Some(angle))),
            _ => None,
        });
        let (first, _) = run.find(|(_, turn)| {
            angle = turn.map_or(angle, |turn| angle + turn);
            turn.is_some() && angle.is_zero()
        })?;
        let moves = |step: &Step<'g>| matches!(step, Step::Rotate(_, angle) if angle.as_constant().is_none());
        let links = &steps[first..];
        links.iter().any(moves).then(|| (first, Chain::new(self.graph, links.to_vec()).origin_and_turn().0))
    }

    /// The chain with variables replaced by expressions.
    pub fn substituted(&self, replacements: &[(Expr<'g>, Expr<'g>)]) -> Chain<'g> {
        let parts: Vec<Vec<Expr<'g>>> = self.steps.iter().map(|step| step.expressions()).collect();
        let mut new = self.graph.substitute(&parts.concat(), replacements).into_iter();
        let steps = self
            .steps
            .iter()
            .zip(&parts)
            .map(|(step, old)| step.rebuilt(&new.by_ref().take(old.len()).collect::<Vec<_>>()))
            .collect();
        Chain { graph: self.graph, steps }
    }

    /// The pose that the chain amounts to.
    pub fn pose(&self) -> Pose<'g> {
        self.steps.iter().fold(Pose::identity(self.graph), |pose, step| pose.then(step.pose(self.graph)))
    }

    /// The origin of the last frame in the first, and the turn from the first to the last. Turns about one axis are one angle here, also
    /// where translations lie between them: intervals want each angle once.
    pub fn origin_and_turn(&self) -> (Vector3<'g>, Matrix3<'g>) {
        let mut turns: Vec<Step<'g>> = Vec::new();
        let mut origin = Vector3::zero(self.graph);
        let turned = |turns: &[Step<'g>], by: Vector3<'g>| {
            turns.iter().rev().fold(by, |by, turn| turn.pose(self.graph).direction(by))
        };
        for step in &self.steps {
            let turn = match *step {
                Step::Translate(by) => {
                    origin = origin + turned(&turns, by);
                    continue;
                }
                Step::Rigid(pose) => {
                    origin = origin + turned(&turns, pose.translation);
                    Step::Rigid(Pose { translation: Vector3::zero(self.graph), ..pose })
                }
                turn => turn,
            };
            let merged = turns.last().and_then(|last| last.merged(turn, self.graph));
            turns.truncate(turns.len() - usize::from(merged.is_some()));
            turns.extend(Some(merged.unwrap_or(turn)).filter(|turn| !turn.is_identity()));
        }
        let identity = Matrix3::identity(self.graph);
        let turn = turns.iter().fold(identity, |turn, step| turn.product(step.pose(self.graph).rotation));
        (origin, turn)
    }

    /// A point of the last frame in the first: the steps are applied to the vector one by one.
    pub fn point(&self, p_child: Vector3<'g>) -> Vector3<'g> {
        self.steps.iter().rev().fold(p_child, |p, step| match *step {
            Step::Translate(by) => p + by,
            Step::Rotate(axis, angle) => self.rotated(axis, angle, p),
            _ => step.pose(self.graph).point(p),
        })
    }

    /// A direction of the last frame in the first.
    pub fn direction(&self, n_child: Vector3<'g>) -> Vector3<'g> {
        self.steps.iter().rev().fold(n_child, |n, step| match *step {
            Step::Translate(_) => n,
            Step::Rotate(axis, angle) => self.rotated(axis, angle, n),
            _ => step.pose(self.graph).direction(n),
        })
    }

    /// A vector turned about an axis. What the vector's own turn about it is, as that of a point of a cutter of revolution,
    /// goes on: two angles become one. Turns of the chain stay apart, for what a translation between them does to points but
    /// not to directions.
    fn rotated(&self, axis: Axis<'g>, angle: Expr<'g>, vector: Vector3<'g>) -> Vector3<'g> {
        let goes_on = || {
            let axis = match axis {
                Axis::X => 0,
                Axis::Y => 1,
                Axis::Z => 2,
                Axis::Along(_) => return None,
            };
            let Turned { before, turn } = Turned::about(axis, vector)?;
            let is_of_chain = |step: &Step<'g>| matches!(step, Step::Rotate(_, own) if *own == turn.angle);
            let is_own = !self.steps.iter().any(is_of_chain);
            is_own.then(|| Turn { angle: turn.angle + angle, ..turn }.of(before))
        };
        let is_number = angle.as_constant().is_some();
        let apart = || rotation(self.graph, axis, angle).times(vector);
        (!is_number).then(goes_on).flatten().unwrap_or_else(apart)
    }

    /// M⁻¹ ∂M/∂motion, given in the last frame; it does not depend on any point.
    ///
    /// Each step adds its own twist to what the steps before it did, seen from its child.
    pub fn twist(&self, motion: Expr<'g>) -> Twist<'g> {
        self.steps.iter().fold(Twist::zero(self.graph), |before, step| {
            let carried = match *step {
                _ if before.is_zero() => before,
                Step::Translate(by) => Twist { angular: before.angular, linear: before.velocity(by) },
                _ => {
                    let Pose { rotation, translation } = step.pose(self.graph);
                    let into_child = rotation.transposed();
                    let angular = into_child.times(before.angular);
                    Twist {
                        // an angular velocity keeps its sense of turning in a mirror only by turning round
                        angular: if matches!(step, Step::Mirror(_)) { -angular } else { angular },
                        linear: into_child.times(before.velocity(translation)),
                    }
                }
            };
            carried.plus(step.twist(self.graph, motion))
        })
    }
}
