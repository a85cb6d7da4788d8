//! The axes of another machine in closed form: three rotary axes from directions, three linear axes from what is left.
//!
//! The first two rotary axes, counted from the work, bring the third one, about which nothing but the tool turns, into the direction
//! that it has on the source. That is the second of Paden and Kahan's subproblems, for directions: with the axes a₁, a₂ and the
//! direction p to be brought to q, the direction in between is `z = α a₁ + β a₂ + γ a₁ × a₂`. Its sign of γ is the elbow.

use faer::Mat;
use faer::linalg::solvers::Solve;
use flank_expr::geometry::{Axis, Chain, Matrix3, Pose, Step, Vector3};
use flank_expr::{Expr, Graph, ScalarEvaluator, Tape};
use thiserror::Error;

use crate::conversion::poses::Posture;

/// Two axes closer to parallel than this (sine of the angle between them) do not span directions.
const PARALLEL: f64 = 1e-9;
/// As far as a closed form may be from the solved axes, mm or radians, of the size of a few hundred mm.
const SAME: f64 = 1e-9;
/// How far an angle may go from its law so that its cut is never met: the arc tangent jumps at π.
const FAR_TURN: f64 = 3.0;

/// Two chains that shall have the same pose, from work to tool, and the axes that were found for it.
#[derive(Clone, Copy, Debug)]
pub struct ExplicitProblem<'a, 'g> {
    /// In the unknowns; see [`PoseProblem::chain`](crate::PoseProblem::chain).
    pub target: &'a Chain<'g>,
    /// Axes, then amounts by which the tool slides along itself.
    pub unknowns: &'a [Expr<'g>],
    /// In the motions.
    pub source: &'a Chain<'g>,
    /// The motions.
    pub motions: &'a [Expr<'g>],
    /// What parameters stand for, so that numbers can be compared; they stay symbols in what is returned.
    pub bindings: &'a [(Expr<'g>, Expr<'g>)],
    /// Values of the motions and the postures there.
    pub line: (&'a [Vec<f64>], &'a [Posture]),
}

/// Axes as functions of the motions.
#[derive(Clone, Debug)]
pub struct Explicit<'g> {
    /// The rotary unknowns, counted from the work, as indices.
    pub turns: [usize; 3],
    /// What the axes are made of, in the work's frame: a variable each, and what it is on the source.
    pub given: Given<'g>,
    /// Of each unknown its value, in the variables of `given`: angles within half a turn to both sides of zero.
    pub formulas: Vec<Expr<'g>>,
    /// Of each unknown its value, in the motions, without jumps over the whole line of postures: angles within half a turn to both
    /// sides of a law that is linear in the motions.
    pub continuous: Vec<Expr<'g>>,
    /// How far the closed form is from the postures, at most, mm or radians.
    pub off: f64,
}

/// Three vectors in the work's frame.
#[derive(Clone, Copy, Debug)]
pub struct Given<'g> {
    /// Unit vector: the direction into which the first two rotary axes bring the third one.
    pub f: [Vector3<'g>; 2],
    /// Square to it, of constant length; it turns with the tool.
    pub g: [Vector3<'g>; 2],
    /// The origin of the tool's frame, mm.
    pub o: [Vector3<'g>; 2],
}

impl<'g> Given<'g> {
    fn new(graph: &'g Graph, [f, g, o]: [Vector3<'g>; 3]) -> Given<'g> {
        let named = |name: &str| Vector3(["x", "y", "z"].map(|part| graph.variable(format!("{name}_{part}"))));
        Given { f: [named("f"), f], g: [named("g"), g], o: [named("o"), o] }
    }

    /// With what the variables are on the source.
    fn put_into(&self, values: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let pairs =
            [self.f, self.g, self.o].map(|[variables, values]| (0..3).map(move |k| (variables.0[k], values.0[k])));
        values[0].graph().substitute(values, &pairs.into_iter().flatten().collect::<Vec<_>>())
    }
}

/// Axes on both elbows.
pub(crate) struct BothElbows<'g> {
    /// Of each elbow all unknowns, in the variables of `given`.
    pub(crate) formulas: [Vec<Expr<'g>>; 2],
    /// Variables for [`Given`]: direction, direction across, origin.
    pub(crate) given: [Vector3<'g>; 3],
    /// The first rotary axis as seen from the work: where the tool's axis is parallel to it, that axis is free.
    pub(crate) pole: [f64; 3],
    /// The length of the direction across.
    pub(crate) across: f64,
}

/// Why there is no closed form.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NotExplicit {
    /// Too many or too few.
    #[error("its pose has {rotary} angles and {linear} lengths to choose, and this way needs three of each")]
    Count {
        /// Unknowns that turn.
        rotary: usize,
        /// Unknowns that shift.
        linear: usize,
    },
    /// An angle that is no multiple of one axis, or a line to turn about that does not stand still.
    #[error("a rotation of its chain is not a multiple of one axis about a line that stands still")]
    Coupled,
    /// Two neighbouring rotary axes.
    #[error("two of its rotary axes that follow each other are parallel")]
    Parallel,
    /// Three linear axes in a plane.
    #[error("its linear axes do not span space, or do not shift by multiples of single axes")]
    Flat,
    /// The formulas give something else.
    #[error("its closed form is off from the solved axes by {by:e}, as near a singular pose")]
    Differs {
        /// By how much, mm or radians.
        by: f64,
    },
    /// An angle that no linear law follows.
    #[error("one of its axes turns by more than half a turn to both sides of a steady turn")]
    TurnsFar,
}

/// A rotary unknown.
#[derive(Clone, Copy)]
struct Joint<'g> {
    unknown: usize,
    /// In the work's frame, where all unknowns are zero.
    axis: Vector3<'g>,
    /// Radians per unit of the unknown.
    slope: Expr<'g>,
}

/// A step of the target's chain.
#[derive(Clone, Copy)]
enum Part<'g> {
    Still(Pose<'g>),
    Shift(Vector3<'g>),
    /// A joint, about a line in its own frame, by its angle and a fixed one.
    Turn(usize, Vector3<'g>, Expr<'g>),
}

/// The angle whose tangent is y / x.
#[derive(Clone, Copy)]
struct Angle<'g> {
    y: Expr<'g>,
    x: Expr<'g>,
    /// √(x² + y²)
    size: Expr<'g>,
}

impl<'g> Angle<'g> {
    /// Cosine and sine of it and a fixed angle together.
    fn beside(self, offset: Expr<'g>) -> (Expr<'g>, Expr<'g>) {
        let (c, s) = (offset.cos(), offset.sin());
        (self.cos() * c - self.sin() * s, self.sin() * c + self.cos() * s)
    }

    /// About a unit vector, from one vector to another; `size` is the product of their lengths across it.
    fn between(about: Vector3<'g>, from: Vector3<'g>, to: Vector3<'g>, size: Expr<'g>) -> Angle<'g> {
        let y = about.dot(from.cross(to));
        let x = from.dot(to) - about.dot(from) * about.dot(to);
        Angle { y, x, size }
    }

    fn cos(self) -> Expr<'g> {
        self.x / self.size
    }

    fn sin(self) -> Expr<'g> {
        self.y / self.size
    }

    fn principal(self) -> Expr<'g> {
        self.y.atan2(self.x)
    }

    /// The same angle, within half a turn to both sides of a law.
    fn about(self, law: Expr<'g>) -> Expr<'g> {
        let (c, s) = (law.cos(), law.sin());
        law + (self.y * c - self.x * s).atan2(self.x * c + self.y * s)
    }
}

/// A vector turned about a unit vector.
fn turned<'g>(v: Vector3<'g>, about: Vector3<'g>, cos: Expr<'g>, sin: Expr<'g>) -> Vector3<'g> {
    let along = about.dot(v) * (1.0 - cos);
    v.scaled(cos) + about.cross(v).scaled(sin) + about.scaled(along)
}

impl<'g> ExplicitProblem<'_, 'g> {
    /// The axes in closed form, on the elbow of the postures.
    ///
    /// # Errors
    /// Where the target is not of the form that this way takes, or the result is not what was found.
    ///
    /// # Panics
    /// If the line is empty, or something depends on a variable that is neither a motion nor bound.
    pub fn solve(&self) -> Result<Explicit<'g>, NotExplicit> {
        let form = Form::of_problem(self)?;
        let sides = [1.0, -1.0].map(|side| form.on_side(self, side));
        let [off, other] =
            sides.each_ref().map(|side| side.as_ref().map_or(f64::INFINITY, |side| self.off(side, true)));
        let [right, left] = sides;
        let (solved, by) = if off <= other { (right?, off) } else { (left?, other) };
        let off = if by <= SAME { self.off(&solved, false) } else { by };
        if off <= SAME { Ok(Explicit { off, ..solved }) } else { Err(NotExplicit::Differs { by: off }) }
    }

    /// The axes in closed form on both elbows, angles within half a turn to both sides of zero; the postures are not looked at.
    ///
    /// # Errors
    /// Where the target is not of the form that this way takes.
    pub(crate) fn both_elbows(&self) -> Result<BothElbows<'g>, NotExplicit> {
        let form = Form::of_problem(self)?;
        let [right, left] = [1.0, -1.0].map(|side| form.principal(self, side));
        let axis = form.joints[0].axis;
        let numbers = self.numbers(&[axis.0.to_vec(), form.across.0.to_vec()].concat(), &self.line.0[..1]);
        let [pole, across] = [0, 3].map(|from| [0, 1, 2].map(|k| numbers[0][from + k]));
        let given = [form.given.f, form.given.g, form.given.o].map(|[variable, _]| variable);
        Ok(BothElbows {
            formulas: [right?, left?],
            given,
            pole,
            across: across.iter().map(|x| x * x).sum::<f64>().sqrt(),
        })
    }

    fn graph(&self) -> &'g Graph {
        self.motions[0].graph()
    }

    fn middle(&self) -> usize {
        self.line.0.len() / 2
    }

    /// Values at motions.
    fn numbers(&self, values: &[Expr<'g>], at: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let bound = self.graph().substitute(values, self.bindings);
        let tape = Tape::new(&bound, self.motions).expect("nothing is unbound");
        let mut evaluator = ScalarEvaluator::new(&tape);
        let of = |motions: &Vec<f64>| {
            let mut out = vec![0.0; values.len()];
            evaluator.run(motions, &mut out);
            out
        };
        at.iter().map(of).collect()
    }

    /// How far a closed form is from the postures: from the middle one, or all of them.
    fn off(&self, solved: &Explicit<'g>, in_the_middle: bool) -> f64 {
        let (at, postures) = self.line;
        let which = if in_the_middle { self.middle()..self.middle() + 1 } else { 0..at.len() };
        let found = self.numbers(&solved.continuous, &at[which.clone()]);
        let pairs = found.iter().zip(&postures[which]);
        let off = |(found, posture): (&Vec<f64>, &Posture)| {
            let each = found.iter().zip(posture.unknowns()).map(|(found, known)| (found - known).abs());
            // a NaN is no agreement
            each.fold(0.0, |most: f64, by| if by <= most { most } else { by })
        };
        pairs.map(off).fold(0.0, |most: f64, by| if by <= most { most } else { by })
    }

    /// A linear law of the motions that an angle stays near: its value in the middle, or else a steady turn.
    fn law(&self, joint: Joint<'g>) -> Result<Expr<'g>, NotExplicit> {
        let (at, postures) = self.line;
        let (unknown, slope) = (joint.unknown, self.numbers(&[joint.slope], &at[..1])[0][0]);
        let (count, middle) = (self.motions.len(), self.middle());
        let angles: Vec<f64> = postures.iter().map(|posture| slope * posture.unknowns()[unknown]).collect();
        let turned = Mat::from_fn(at.len(), 1, |k, _| angles[k] - angles[middle]);
        let moved = Mat::from_fn(at.len(), count, |k, i| at[k][i] - at[middle][i]);
        // a NaN is far as well
        let stays = |rates: &Mat<f64>| (&turned - &moved * rates).col(0).iter().all(|off| off.abs() <= FAR_TURN);
        let mut rates = Mat::zeros(count, 1);
        if !stays(&rates) {
            let squares = moved.transpose() * &moved;
            rates = squares.full_piv_lu().solve(moved.transpose() * &turned);
            if !stays(&rates) {
                return Err(NotExplicit::TurnsFar);
            }
        }
        let steps = (0..count).map(|i| rates[(i, 0)] * (self.motions[i] - at[middle][i]));
        Ok(steps.fold(self.graph().constant(angles[middle]), |sum, step| sum + step))
    }
}

/// A vector square to an axis.
fn across_to<'g>(problem: &ExplicitProblem<'_, 'g>, axis: Vector3<'g>) -> Vector3<'g> {
    let parts = &problem.numbers(&axis.0, &problem.line.0[..1])[0];
    let least = (0..3).min_by(|&a, &b| parts[a].abs().total_cmp(&parts[b].abs())).expect("three parts");
    let beside = std::array::from_fn(|k| if k == least { 1.0 } else { 0.0 });
    axis.cross(Vector3::constant(problem.graph(), beside))
}

/// The target's chain as this way needs it.
struct Form<'g> {
    parts: Vec<Part<'g>>,
    joints: [Joint<'g>; 3],
    linear: [usize; 3],
    /// Square to the third joint's axis, where all unknowns are zero.
    across: Vector3<'g>,
    given: Given<'g>,
}

impl<'g> Form<'g> {
    fn of_problem(problem: &ExplicitProblem<'_, 'g>) -> Result<Form<'g>, NotExplicit> {
        let graph = problem.graph();
        let moves = |expr: Expr<'g>| -> Vec<usize> {
            let each = problem.unknowns.iter().enumerate();
            each.filter(|(_, x)| !expr.derivative(**x).is_zero()).map(|(k, _)| k).collect()
        };
        let (mut parts, mut joints) = (Vec::new(), Vec::new());
        let (mut still, mut mirrored) = (Matrix3::identity(graph), 1.0);
        for step in problem.target.steps() {
            match *step {
                Step::Translate(by) => parts.push(Part::Shift(by)),
                Step::Rotate(axis, angle) if !moves(angle).is_empty() => {
                    let axis = axis.direction(graph);
                    let [unknown] = moves(angle)[..] else { return Err(NotExplicit::Coupled) };
                    let linear = angle.linear_in(problem.unknowns[unknown]).ok_or(NotExplicit::Coupled)?;
                    if axis.0.into_iter().any(|part| !moves(part).is_empty()) {
                        return Err(NotExplicit::Coupled);
                    }
                    parts.push(Part::Turn(joints.len(), axis, linear.intercept));
                    joints.push(Joint {
                        unknown,
                        axis: still.times(axis).scaled(graph.constant(mirrored)),
                        slope: linear.slope,
                    });
                    still = still.product(Step::Rotate(Axis::Along(axis), linear.intercept).pose(graph).rotation);
                }
                step => {
                    let pose = step.pose(graph);
                    if pose.rotation.entries().into_iter().chain(pose.translation.0).any(|part| !moves(part).is_empty())
                    {
                        return Err(NotExplicit::Coupled);
                    }
                    if matches!(step, Step::Mirror(_)) {
                        mirrored = -mirrored;
                    }
                    still = still.product(pose.rotation);
                    parts.push(Part::Still(pose));
                }
            }
        }
        let linear: Vec<usize> = (0..problem.unknowns.len())
            .filter(|k| joints.iter().all(|joint: &Joint<'g>| joint.unknown != *k))
            .collect();
        let count = NotExplicit::Count { rotary: joints.len(), linear: linear.len() };
        let (Ok(joints), Ok(linear)) = (<[Joint<'g>; 3]>::try_from(joints), <[usize; 3]>::try_from(linear)) else {
            return Err(count);
        };
        let across = |a: usize, b: usize| joints[a].axis.cross(joints[b].axis).norm();
        let sines = problem.numbers(&[across(0, 1), across(1, 2)], &problem.line.0[..1]);
        if sines[0].iter().any(|sine| *sine <= PARALLEL) {
            return Err(NotExplicit::Parallel);
        }
        let third = joints[2].axis;
        let across = across_to(problem, third);
        // the work's frame, by what the joints do not turn
        let seen = |v: Vector3<'g>| problem.source.direction(still.transposed().times(v));
        let given = [seen(third), seen(across), problem.source.point(Vector3::zero(graph))];
        Ok(Form { parts, joints, linear, across, given: Given::new(graph, given) })
    }

    /// With γ of one sign.
    fn on_side(&self, problem: &ExplicitProblem<'_, 'g>, side: f64) -> Result<Explicit<'g>, NotExplicit> {
        let angles = self.angles(side);
        let near_its_law = |k: usize| Ok(angles[k].about(problem.law(self.joints[k])?));
        Ok(Explicit {
            turns: self.joints.map(|joint| joint.unknown),
            given: self.given,
            formulas: self.principal(problem, side)?,
            continuous: self.given.put_into(&self.all(problem, angles, &near_its_law)?),
            off: f64::NAN,
        })
    }

    /// All unknowns on an elbow, angles within half a turn to both sides of zero.
    fn principal(&self, problem: &ExplicitProblem<'_, 'g>, side: f64) -> Result<Vec<Expr<'g>>, NotExplicit> {
        let angles = self.angles(side);
        self.all(problem, angles, &|k| Ok(angles[k].principal()))
    }

    fn angles(&self, side: f64) -> [Angle<'g>; 3] {
        let Given { f: [f, _], g: [g, _], .. } = self.given;
        let [first, second] = self.carrying(f, side);
        let image = turned(g, self.joints[0].axis, first.cos(), -first.sin());
        let image = turned(image, self.joints[1].axis, second.cos(), -second.sin());
        let last = Angle::between(self.joints[2].axis, self.across, image, self.across.dot(self.across));
        [first, second, last]
    }

    /// All unknowns where each angle is written in one of its ways.
    fn all(
        &self,
        problem: &ExplicitProblem<'_, 'g>,
        angles: [Angle<'g>; 3],
        angle: &dyn Fn(usize) -> Result<Expr<'g>, NotExplicit>,
    ) -> Result<Vec<Expr<'g>>, NotExplicit> {
        let lengths = self.lengths(problem, angles, self.given.o[0])?;
        let mut values = problem.unknowns.to_vec();
        for (k, joint) in self.joints.iter().enumerate() {
            values[joint.unknown] = angle(k)? / joint.slope;
        }
        // a tool that screws along itself shifts by its angle
        let turns = self.joints.map(|joint| (problem.unknowns[joint.unknown], values[joint.unknown]));
        for (unknown, length) in self.linear.into_iter().zip(lengths) {
            values[unknown] = problem.graph().substitute(&[length], &turns)[0];
        }
        Ok(values)
    }

    /// The angles of the first two joints that bring the third one into a direction.
    fn carrying(&self, direction: Vector3<'g>, side: f64) -> [Angle<'g>; 2] {
        let [one, two, three] = self.joints.map(|joint| joint.axis);
        let graph = direction.0[0].graph();
        let (normal, c) = (one.cross(two), one.dot(two));
        let (of_one, of_two) = (one.dot(direction), two.dot(three));
        let whole = graph.constant(1.0);
        if c.is_zero() && of_two.is_zero() {
            // square to each other: the turned direction lies in the plane of `one` and `normal`
            let aside = one.cross(direction).norm();
            let between = one.scaled(of_one) + normal.scaled(side * aside);
            let first = Angle::between(one, normal.scaled(graph.constant(side)), direction, aside);
            return [first, Angle::between(two, three, between, whole)];
        }
        let square = 1.0 - c * c;
        let (alpha, beta) = ((of_one - c * of_two) / square, (of_two - c * of_one) / square);
        let gamma = side * ((1.0 - alpha * alpha - beta * beta - 2.0 * alpha * beta * c) / square).sqrt();
        let first = two.scaled(beta) + normal.scaled(gamma);
        let second = one.scaled(alpha) + normal.scaled(gamma);
        [
            Angle::between(one, first, direction, 1.0 - of_one * of_one),
            Angle::between(two, three, second, 1.0 - of_two * of_two),
        ]
    }

    /// The values of the linear axes, by Cramer's rule, for the tool's origin at a point of the work.
    fn lengths(
        &self,
        problem: &ExplicitProblem<'_, 'g>,
        angles: [Angle<'g>; 3],
        at: Vector3<'g>,
    ) -> Result<[Expr<'g>; 3], NotExplicit> {
        let variables = self.linear.map(|unknown| problem.unknowns[unknown]);
        let is_first = |part: &Part<'g>| match part {
            Part::Shift(by) => variables.iter().any(|x| !by.derivative(*x).is_zero()),
            _ => false,
        };
        let start = self.parts.iter().position(is_first).ok_or(NotExplicit::Flat)?;
        let reached = self.parts[..start].iter().fold(at, |v, part| part.backward(v, angles));
        let origin = Vector3::zero(problem.graph());
        let tool = self.parts[start..].iter().rev().fold(origin, |v, part| part.forward(v, angles));
        let (directions, rest) = linear_in(tool, variables)?;
        let moving = |part: &Expr<'g>| problem.unknowns.iter().any(|x| !part.derivative(*x).is_zero());
        if directions.iter().flat_map(|direction| &direction.0).any(moving) {
            return Err(NotExplicit::Flat);
        }
        let wanted = reached - rest;
        let volume = |[a, b, c]: [Vector3<'g>; 3]| a.dot(b.cross(c));
        let whole = volume(directions);
        let size = self.given.put_into(&[whole]);
        if problem.numbers(&size, &problem.line.0[problem.middle()..=problem.middle()])[0][0].abs() <= PARALLEL {
            return Err(NotExplicit::Flat);
        }
        let length = |k: usize| {
            let mut replaced = directions;
            replaced[k] = wanted;
            volume(replaced) / whole
        };
        Ok(std::array::from_fn(length))
    }
}

impl<'g> Part<'g> {
    /// A vector given behind the step, as it is before it.
    fn forward(&self, v: Vector3<'g>, angles: [Angle<'g>; 3]) -> Vector3<'g> {
        match *self {
            Part::Still(pose) => pose.point(v),
            Part::Shift(by) => v + by,
            Part::Turn(joint, axis, offset) => {
                let (cos, sin) = angles[joint].beside(offset);
                turned(v, axis, cos, sin)
            }
        }
    }

    /// A vector given before the step, as it is behind it.
    fn backward(&self, v: Vector3<'g>, angles: [Angle<'g>; 3]) -> Vector3<'g> {
        match *self {
            Part::Still(pose) => pose.inverse().point(v),
            Part::Shift(by) => v - by,
            Part::Turn(joint, axis, offset) => {
                let (cos, sin) = angles[joint].beside(offset);
                turned(v, axis, cos, -sin)
            }
        }
    }
}

/// A vector that is linear in three variables: by which vector each of them counts, and what is left.
fn linear_in<'g>(
    vector: Vector3<'g>,
    variables: [Expr<'g>; 3],
) -> Result<([Vector3<'g>; 3], Vector3<'g>), NotExplicit> {
    let graph = vector.0[0].graph();
    let mut rest = vector;
    let mut directions = [Vector3::zero(graph); 3];
    for (direction, variable) in directions.iter_mut().zip(variables) {
        for k in 0..3 {
            let linear = rest.0[k].linear_in(variable);
            (direction.0[k], rest.0[k]) = match linear {
                Some(linear) => (linear.slope, linear.intercept),
                None if rest.0[k].derivative(variable).is_zero() => (graph.constant(0.0), rest.0[k]),
                None => return Err(NotExplicit::Flat),
            };
        }
    }
    Ok((directions, rest))
}
