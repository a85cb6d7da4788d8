//! What two flanks are like where they touch.

use flank_expr::geometry::{Chain, Surface, Vector3 as Vector};
use flank_expr::{Expr, ScalarEvaluator};
use nalgebra::{DMatrix, Matrix3x2, Vector3};

use crate::analysis::geometry::{Curvature, Principal, curvature_in, tangents};
use crate::contact::ContactProblem;
use crate::contact::edge::{FlankEdge, PlacedFlank};
use crate::contact::outline::Bound;
use crate::equations::solution::{Outcome, Solution};

/// Normals whose sum is shorter than this are opposite: beyond it they face the same way, the other root of the equations.
const OPPOSITE: f64 = 1e-3;
/// Principal curvatures of a gap that are smaller than this share of the larger one are zero: rounding of second derivatives.
const FLAT: f64 = 1e-9;

/// Normals whose sum is shorter than this are opposite to rounding of what solves for them.
pub(super) const ALONG: f64 = 1e-8;

/// How two flanks stand to each other at a point that they share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactState {
    /// They part to all sides: a contact.
    Touching,
    /// To second order they lie on each other along a line: flanks that are conjugate, or nearly so.
    Line,
    /// To some side they run into each other: not the place where the pair touches.
    Crossing,
}

/// A point in which two flanks touch, at one roll position. Lengths are mm, angles radians.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactPoint {
    /// What became of it: only [`Outcome::Solved`] and [`Outcome::Outside`] (a flank would have to go on beyond its ranges) are points
    /// of contact.
    pub outcome: Outcome,
    /// The roll position.
    pub roll: f64,
    /// What the contact determines.
    pub lag: f64,
    /// Its first and second derivative by the roll.
    pub lag_slopes: [f64; 2],
    /// What touches: none for flank on flank, an edge on the other flank, two edges of one member for a corner, and one of each for edges
    /// that cross.
    pub edges: Vec<FlankEdge>,
    /// The unknowns of each flank.
    pub unknowns: [Vec<f64>; 2],
    /// In the frame that both members share.
    pub position: [f64; 3],
    /// Unit vector out of the first member, along which both press on each other.
    pub normal: [f64; 3],
    /// The point in the frame of each member.
    pub in_members: [[f64; 3]; 2],
    /// Unit vectors out of each member, in its frame.
    pub normals: [[f64; 3]; 2],
    /// How it moves over each flank as the roll goes on, in the frame of the member, mm per radian of roll.
    pub path: [[f64; 3]; 2],
    /// How the flanks part, 1/mm: half of it times the square of the way from the point. `None` where a flank has no curvature, and where an
    /// edge touches.
    pub gap: Option<Principal>,
    /// Whether it is a contact; `None` where that is not known.
    pub state: Option<ContactState>,
    /// Velocity of the first member against the second in the tangent plane, mm per radian of roll.
    pub sliding: [f64; 3],
    /// Half the sum of the velocities of both members against the point of contact, mm per radian of roll.
    pub entraining: [f64; 3],
    /// How far the second flank moves out of the first one for a step of the lag, mm per unit; plus opens.
    pub opening: f64,
    /// How fast both flanks go along the normal, mm per radian of roll, where the lag stays: by how much from one pair of teeth to the next.
    pub advance: f64,
    /// Of each unknown, then of the lag, the power series in the roll, to second order; empty where it has none.
    pub(super) series: Vec<[f64; 3]>,
    /// Of the first flank, in the frame of the contact.
    pub(super) first_normal: [f64; 3],
}

/// Where the position of the first flank stands among the [`outputs`]: after its axis and a point of that.
pub(super) const POSITION: std::ops::Range<usize> = 6..9;

/// All that [`ContactProblem::point`] reads, in the order in which it does.
pub(super) fn outputs<'g>(
    flanks: &[PlacedFlank<'_, 'g>; 2],
    placed: [&Surface<'g>; 2],
    roll: Expr<'g>,
    lag: Expr<'g>,
) -> Vec<Expr<'g>> {
    let graph = roll.graph();
    let mut outputs = Vec::new();
    for (flank, placed) in flanks.iter().zip(placed) {
        let (own, p) = (flank.own, &placed.unknowns);
        let axis = flank.placement.direction(Vector::constant(graph, [0.0, 0.0, 1.0]));
        outputs.extend(axis.0.into_iter().chain(flank.placement.point(Vector::zero(graph)).0));
        outputs.extend(placed.position.0.into_iter().chain(placed.normal.0).chain(own.position.0).chain(own.normal.0));
        outputs.extend([roll, lag].iter().flat_map(|x| placed.position.derivative(*x).0));
        // column by column, as matrices are stored
        outputs.extend(p.iter().flat_map(|p| own.position.derivative(*p).0));
        outputs.extend(p.iter().flat_map(|p| placed.position.derivative(*p).0));
        outputs.extend(p.iter().flat_map(|p| placed.normal.derivative(*p).0));
        outputs.extend(p.iter().flat_map(|p| placed.constraints.iter().map(|c| c.derivative(*p))));
    }
    outputs
}

/// Origin, then axes row by row, of a frame in another one.
pub(super) type Pose = [f64; 12];

/// As a chain gives it.
pub(super) fn pose<'g>(placement: &Chain<'g>) -> Vec<Expr<'g>> {
    let pose = placement.pose();
    pose.translation.0.into_iter().chain(pose.rotation.entries()).collect()
}

/// A direction of a frame in the other one.
pub(super) fn turned(pose: &Pose, v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|row| (0..3).map(|k| pose[3 + 3 * row + k] * v[k]).sum())
}

/// A point of a frame in the other one.
pub(super) fn placed(pose: &Pose, point: [f64; 3]) -> [f64; 3] {
    let turned = turned(pose, point);
    [0, 1, 2].map(|k| pose[k] + turned[k])
}

/// A flank at a point, with its derivatives by its unknowns as columns.
pub(super) struct Member {
    /// The member's axis, and a point of it.
    axis: Vector3<f64>,
    origin: Vector3<f64>,
    pub(super) position: Vector3<f64>,
    pub(super) normal: Vector3<f64>,
    pub(super) own: Vector3<f64>,
    pub(super) own_normal: Vector3<f64>,
    /// Derivatives of the position by the roll and by the lag.
    pub(super) moved: [Vector3<f64>; 2],
    pub(super) own_slopes: DMatrix<f64>,
    pub(super) slopes: DMatrix<f64>,
    pub(super) normal_slopes: DMatrix<f64>,
    pub(super) constraint_slopes: DMatrix<f64>,
}

impl Member {
    /// The point in the axial section, `[z, rho]`.
    pub(super) fn section(&self) -> [f64; 2] {
        [self.own.z, self.own.x.hypot(self.own.y)]
    }

    /// Of a bound of its outline, in the frame of the contact.
    pub(super) fn gradient(&self, bound: &Bound) -> Vector3<f64> {
        let [by_z, by_rho] = bound.gradient(self.section());
        let from_axis = self.position - self.origin;
        let out = (from_axis - self.axis * self.axis.dot(&from_axis)).normalize();
        self.axis * by_z + out * by_rho
    }
}

/// Takes numbers off the front of a slice.
fn taken<'a>(values: &mut &'a [f64], count: usize) -> &'a [f64] {
    let (first, rest) = values.split_at(count);
    *values = rest;
    first
}

impl ContactProblem {
    /// Both flanks at unknowns, lag and roll.
    pub(super) fn members(&self, unknowns: &[f64], roll: f64) -> [Member; 2] {
        let mut out = vec![0.0; self.state.output_count()];
        ScalarEvaluator::new(&self.state)
            .run(&unknowns.iter().copied().chain(self.given(roll)).collect::<Vec<f64>>(), &mut out);
        self.members_from(&out)
    }

    /// From what the tape of the state gives.
    pub(super) fn members_from(&self, out: &[f64]) -> [Member; 2] {
        let mut rest = out;
        [0, 1].map(|k| {
            let (p, c) = (self.unknowns[k], self.constraints[k]);
            let vector = |rest: &mut &[f64]| Vector3::from_column_slice(taken(rest, 3));
            let matrix = |rest: &mut &[f64], rows: usize| DMatrix::from_column_slice(rows, p, taken(rest, rows * p));
            Member {
                axis: vector(&mut rest),
                origin: vector(&mut rest),
                position: vector(&mut rest),
                normal: vector(&mut rest),
                own: vector(&mut rest),
                own_normal: vector(&mut rest),
                moved: [vector(&mut rest), vector(&mut rest)],
                own_slopes: matrix(&mut rest, 3),
                slopes: matrix(&mut rest, 3),
                normal_slopes: matrix(&mut rest, 3),
                constraint_slopes: matrix(&mut rest, c),
            }
        })
    }

    /// What is known of a root of the equations of touching.
    pub(super) fn point(
        &self,
        root: Solution,
        roll: f64,
        edges: Vec<FlankEdge>,
        members: &[Member; 2],
    ) -> ContactPoint {
        let Solution { outcome, unknowns, .. } = root;
        let [first, second] = members;
        let series = self.series(&unknowns, roll, &edges, &first.normal).unwrap_or_default();
        let normal = self.pressing(&edges, members);
        let slope = |k: usize| series.get(k).map_or(f64::NAN, |series| series[1]);
        let lag = self.lag_at();
        let lag_slopes = series.get(lag).map_or([f64::NAN; 2], |series| [series[1], 2.0 * series[2]]);
        // of the unknowns of each flank, by the roll
        let along = |k: usize| {
            let from = k * self.unknowns[0];
            DMatrix::from_fn(self.unknowns[k], 1, |row, _| slope(from + row))
        };
        let vector = |m: DMatrix<f64>| Vector3::new(m[(0, 0)], m[(1, 0)], m[(2, 0)]);
        let over = [0, 1].map(|k| vector(&members[k].own_slopes * along(k)));
        let over_in_frame = [0, 1].map(|k| vector(&members[k].slopes * along(k)));
        let velocity = [0, 1].map(|k| members[k].moved[0] + members[k].moved[1] * lag_slopes[0]);
        let in_plane = |v: Vector3<f64>| <[f64; 3]>::from(v - normal * normal.dot(&v));
        // the edge of a flank may lie on a line along which both touch
        let is_of_flanks = edges.is_empty() || (first.normal + second.normal).norm() < ALONG;
        let gap = if is_of_flanks { self.gap(members) } else { None };
        let state = match gap.map(|gap| state(&gap.principal())) {
            Some(ContactState::Line) => Some(ContactState::Line),
            of_flanks if edges.is_empty() => of_flanks,
            _ => Some(ContactState::Touching),
        };
        let gap = gap.filter(|_| edges.is_empty() || state == Some(ContactState::Line));
        ContactPoint {
            outcome,
            roll,
            edges,
            lag: unknowns[lag],
            lag_slopes,
            unknowns: [unknowns[..self.unknowns[0]].to_vec(), unknowns[self.unknowns[0]..lag].to_vec()],
            position: first.position.into(),
            normal: normal.into(),
            in_members: [first.own.into(), second.own.into()],
            normals: [first.own_normal.into(), second.own_normal.into()],
            path: over.map(<[f64; 3]>::from),
            gap: gap.map(|gap| gap.principal()),
            state,
            sliding: in_plane(velocity[0] - velocity[1]),
            // a member moves past the point as the point moves over the member, the other way
            entraining: in_plane(-0.5 * (over_in_frame[0] + over_in_frame[1])),
            opening: opening(members, &normal),
            advance: normal.dot(&first.moved[0]),
            first_normal: first.normal.into(),
            series,
        }
    }

    /// Whether the normals are opposite there, and not the same; where an edge touches, whether the flanks face each other at all.
    pub(super) fn faces(edges: &[FlankEdge], [first, second]: &[Member; 2]) -> bool {
        if edges.is_empty() {
            (first.normal + second.normal).norm() < OPPOSITE
        } else {
            first.normal.dot(&second.normal) < 0.0
        }
    }

    /// How the flanks part.
    pub(super) fn gap(&self, members: &[Member; 2]) -> Option<Curvature> {
        let tangents: Matrix3x2<f64> = tangents(members[0].normal);
        let each = members
            .each_ref()
            .map(|member| curvature_in(tangents, [&member.slopes, &member.normal_slopes, &member.constraint_slopes]));
        let [Some(first), Some(second)] = each else { return None };
        Some(first.plus(&second))
    }

    /// Series of the unknowns in the roll, to second order.
    fn series(&self, unknowns: &[f64], roll: f64, edges: &[FlankEdge], normal: &Vector3<f64>) -> Option<Vec<[f64; 3]>> {
        let (system, parameters) = self.equations(edges, roll, normal)?;
        let series = system.series(unknowns, &parameters, &[(0, 1.0)], 2)?;
        series.into_iter().map(|series| series.try_into().ok()).collect()
    }
}

/// Two directions square to a normal.
pub(super) fn directions(normal: &Vector3<f64>) -> impl Iterator<Item = f64> {
    let tangents: [f64; 6] = std::array::from_fn(|k| tangents(*normal)[k]);
    tangents.into_iter()
}

/// How far the second flank moves along a normal out of the first for a step of the lag.
pub(super) fn opening([first, second]: &[Member; 2], normal: &Vector3<f64>) -> f64 {
    normal.dot(&(second.moved[1] - first.moved[1]))
}

fn state(gap: &Principal) -> ContactState {
    let flat = FLAT * gap.k1.abs().max(gap.k2.abs());
    if gap.k2 > flat {
        ContactState::Touching
    } else if gap.k2 < -flat {
        ContactState::Crossing
    } else {
        ContactState::Line
    }
}

impl ContactPoint {
    /// Whether flank touches flank there: in a point, or along a line that goes on to an edge.
    pub fn is_of_flanks(&self) -> bool {
        self.edges.is_empty() || self.state == Some(ContactState::Line)
    }

    /// Where the contact goes: the unknowns a step of the roll on, to second order.
    pub(super) fn predicted(&self, step: f64) -> Option<Vec<f64>> {
        (!self.series.is_empty()).then(|| self.series.iter().map(|c| c[0] + step * (c[1] + step * c[2])).collect())
    }

    /// The unknowns of the first flank, of the second, then the lag.
    pub(super) fn all_unknowns(&self) -> Vec<f64> {
        [&self.unknowns[0][..], &self.unknowns[1], &[self.lag]].concat()
    }

    /// The half axes of the ellipse within which the gap is no wider than a film, mm: the shorter first, along the directions of the
    /// gap's curvatures. `None` where they are not both positive, rounding apart.
    pub fn ellipse(&self, film: f64) -> Option<[f64; 2]> {
        let gap = self.gap.filter(|gap| state(gap) == ContactState::Touching)?;
        Some([gap.k1, gap.k2].map(|k| (2.0 * film / k).sqrt()))
    }
}
