//! Surfaces under constraint: the one idea that carries everything.

use crate::geometry::chain::Chain;
use crate::geometry::pose::Twist;
use crate::geometry::turned::Turned;
use crate::geometry::vector::Vector3;
use crate::symbolic::graph::Expr;

/// A frame that is turned with the point is taken where that saves one in so many operations: settings that have no value yet, most of
/// them zero, make what saves less uncertain.
const WORTH_A_TURN: usize = 40;

/// A surface as four symbolic things: unknowns, position, normal, constraints.
///
/// It has two more unknowns than constraints. Whatever generates or moves a surface maps surfaces to surfaces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Surface<'g> {
    /// The variables that it is described with.
    pub unknowns: Vec<Expr<'g>>,
    /// A point of it, mm, in one frame.
    pub position: Vector3<'g>,
    /// Unit vector in the same frame, out of the body that owns the surface.
    pub normal: Vector3<'g>,
    /// What must be zero for the point to lie on it: two fewer than unknowns. The k-th belongs to unknown k + 2, a motion,
    /// and equals `−n · ∂r/∂motion` on the surface: how fast the tool's steel draws back from the work. Those of the tool
    /// itself come first.
    pub constraints: Vec<Expr<'g>>,
    /// How many of the constraints belong to no motion, but hold on the tool by itself: one where an equation gives it.
    pub given: usize,
}

impl<'g> Surface<'g> {
    /// A parametric surface `position(u, v)`, whose body lies against `r_u × r_v` (or along it, if `flipped`).
    pub fn parametric(unknowns: [Expr<'g>; 2], position: Vector3<'g>, flipped: bool) -> Surface<'g> {
        Surface::along(unknowns, position, Surface::raw_normal(unknowns, position), flipped)
    }

    /// The same where [`Surface::raw_normal`] is known.
    pub fn along(unknowns: [Expr<'g>; 2], position: Vector3<'g>, raw: Vector3<'g>, flipped: bool) -> Surface<'g> {
        let normal = raw.normalized();
        let normal = if flipped { -normal } else { normal };
        Surface { unknowns: unknowns.to_vec(), position, normal, constraints: Vec::new(), given: 0 }
    }

    /// Where a function is zero of three unknowns, with which the position moves in space; the body lies where the function is negative.
    ///
    /// The constraint is the function over the length of its gradient, so that it is, in mm, how far a point near the surface lies
    /// off it, whatever unit the function has.
    pub fn implicit(unknowns: [Expr<'g>; 3], position: Vector3<'g>, function: Expr<'g>) -> Surface<'g> {
        let gradient = Surface::gradient(unknowns, position, function);
        Surface {
            unknowns: unknowns.to_vec(),
            position,
            normal: gradient.normalized(),
            constraints: vec![function / gradient.norm()],
            given: 1,
        }
    }

    /// The gradient in space, per mm, of a function of three unknowns with which the position moves: `Σ f_i (r_j × r_k) / det(r_u, r_v, r_w)`.
    pub fn gradient(unknowns: [Expr<'g>; 3], position: Vector3<'g>, function: Expr<'g>) -> Vector3<'g> {
        let [u, v, w] = unknowns.map(|unknown| position.derivative(unknown));
        let [by_u, by_v, by_w] = unknowns.map(|unknown| function.derivative(unknown));
        let sum = v.cross(w).scaled(by_u) + w.cross(u).scaled(by_v) + u.cross(v).scaled(by_w);
        sum.scaled(1.0 / u.dot(v.cross(w)))
    }

    /// Along `r_u × r_v`, not of unit length, without what its components have as a common factor.
    ///
    /// On a cone that is its radius: so the normal does not vanish at the tip.
    pub fn raw_normal([u, v]: [Expr<'g>; 2], position: Vector3<'g>) -> Vector3<'g> {
        match Turned::of(position) {
            Some(Turned { before, turn }) => {
                turn.of(turn.derivative(before, u).cross(turn.derivative(before, v)).primitive())
            }
            None => position.derivative(u).cross(position.derivative(v)).primitive(),
        }
    }

    /// The same surface seen from the frame at the other end of a chain that does not depend on its unknowns.
    pub fn moved(&self, t_frame_own: &Chain<'g>) -> Surface<'g> {
        Surface {
            position: t_frame_own.point(self.position),
            normal: t_frame_own.direction(self.normal),
            ..self.clone()
        }
    }

    /// The same surface with parameters replaced by values.
    pub fn bound(&self, bindings: &[(Expr<'g>, Expr<'g>)]) -> Surface<'g> {
        let parts: Vec<Expr<'g>> =
            self.position.0.into_iter().chain(self.normal.0).chain(self.constraints.iter().copied()).collect();
        let parts = self.normal.0[0].graph().substitute(&parts, bindings);
        Surface {
            unknowns: self.unknowns.clone(),
            position: Vector3([parts[0], parts[1], parts[2]]),
            normal: Vector3([parts[3], parts[4], parts[5]]),
            constraints: parts[6..].to_vec(),
            given: self.given,
        }
    }

    /// What this surface, as a tool, leaves on a work that it moves against.
    ///
    /// `t_work_tool` is the pose of the tool in the work and depends on `motions`. Each motion adds itself as an unknown
    /// and its equation of meshing `n · v = 0` as a constraint (see [`Surface::meshing`]). The work's material lies on
    /// the other side of the surface, so its normal is turned round. No motion at all is a plunged (Formate) member.
    pub fn envelope(&self, t_work_tool: &Chain<'g>, motions: &[Expr<'g>]) -> Surface<'g> {
        let meshing = motions.iter().map(|&motion| self.meshing(t_work_tool, motion));
        let moved = self.moved(t_work_tool);
        Surface {
            unknowns: self.unknowns.iter().chain(motions).copied().collect(),
            position: moved.position,
            normal: -moved.normal,
            constraints: self.constraints.iter().copied().chain(meshing).collect(),
            given: self.given,
        }
    }

    /// The equation of meshing of one motion, mm per unit of the motion: `n · (ω × r + v)`. It equals
    /// `det(r_u, r_v, r_motion) / |r_u × r_v|` in the work's frame, and is the same in every frame of the chain: it is written
    /// in the one in which, beside the position in the work, it takes the fewest operations. Between the two bodies that a
    /// cradle and a work spindle turn, their twists are almost constant; a frame that turns with the point of a helicoid, or of a surface
    /// of revolution, sees neither position nor normal turn.
    pub fn meshing(&self, t_work_tool: &Chain<'g>, motion: Expr<'g>) -> Expr<'g> {
        let in_frame = |k: usize| {
            let (t_work_frame, t_frame_tool) = t_work_tool.split(k);
            let seen = self.moved(&t_frame_tool);
            // what moves on the tool's side of the frame counts as the frame moving the other way
            let twist = t_work_frame.twist(motion).minus(t_frame_tool.inverse().twist(motion));
            (seen, twist)
        };
        let position = t_work_tool.point(self.position).0;
        let unknowns: Vec<Expr<'g>> = self.unknowns.iter().copied().chain([motion]).collect();
        let work = |meshing: &Expr<'g>| {
            let values: Vec<Expr<'g>> = position.into_iter().chain([*meshing]).collect();
            let slopes = values.iter().flat_map(|value| unknowns.iter().map(|unknown| value.derivative(*unknown)));
            let all: Vec<Expr<'g>> = values.iter().copied().chain(slopes).collect();
            meshing.graph().work(&all, &unknowns)
        };
        let seen: Vec<(Surface<'g>, Twist<'g>)> = t_work_tool.frames_beside(motion).into_iter().map(in_frame).collect();
        let as_they_are = seen.iter().map(|(seen, twist)| seen.normal.dot(twist.velocity(seen.position)));
        let before_turns =
            seen.iter().flat_map(|(seen, twist)| (0..3).filter_map(|axis| seen.before_turn(axis, twist)));
        let with_work = |form: Expr<'g>| (work(&form), form);
        let plain = as_they_are.map(with_work).min_by_key(|(work, _)| *work);
        let turned = before_turns.map(with_work).min_by_key(|(work, _)| *work);
        match (plain, turned) {
            (Some((plain, _)), Some((turned, form))) if turned + plain / WORTH_A_TURN < plain => form,
            (Some((_, form)), _) => form,
            (None, _) => position[0].graph().constant(0.0),
        }
    }

    /// What a twist does to the point along the normal, from a frame that is turned about an axis as both are; `None` if they are not.
    fn before_turn(&self, axis: usize, twist: &Twist<'g>) -> Option<Expr<'g>> {
        let Turned { before: position, turn } = Turned::about(axis, self.position)?;
        let normal = Turned::about(axis, self.normal).filter(|normal| normal.turn == turn)?.before;
        let twist = Twist { angular: turn.back(twist.angular), linear: turn.back(twist.linear) };
        Some(normal.dot(twist.velocity(position)))
    }
}
