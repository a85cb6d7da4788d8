//! Where two surfaces meet, along lines of the coordinates of the first.

use flank_expr::geometry::Vector3;
use flank_expr::{Expr, ScalarEvaluator, Tape, TapeError};

use crate::analysis::feet::{Feet, Foot, squared_distance};
use crate::equations::solution::{Outcome, Range, Solution, distance};
use crate::equations::system::{Evaluation, System};
use crate::newton::scalar::{determinant, inverse_times, solve_with};
use crate::surface::bound::BoundSurface;
use crate::surface::points::SurfacePoint;

/// Pairs of points, one of each surface, that a line's meetings are looked for from; the nearest ones.
const PAIRS: usize = 6;
/// Points of a line whose normals are followed to the second surface, to see on which side of it they lie.
const FOLLOWED: usize = 65;
/// A point nearer to the second surface than its neighbours by this, mm, may lie between two meetings.
const NEARER: f64 = 1e-9;
/// Two iterations that end nearer than this share of the ranges found the same meeting.
const SAME: f64 = 1e-6;
/// Surfaces at a smaller angle only touch: with curvatures of 1/mm they then part by less than the tolerance of a point over the
/// distance in which they could cross.
const TOUCHING: f64 = 1e-5;

/// Two surfaces in one frame, and the system that says where they meet: both sets of constraints, equal positions, and a
/// line in the coordinates of the first.
#[derive(Clone, Debug)]
pub struct Intersection {
    system: System,
    /// The first surface at two coordinates: of its Jacobian the determinant, which changes its sign where the surface folds over them.
    own: System,
    ranges: Vec<Range>,
    first_unknowns: usize,
    /// Of the unknowns and the line: position, both normals, how far along the line, and its derivatives.
    probe: Tape,
    second: Feet,
}

/// A line in the plane of two coordinates: `from + s · direction`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Where s is zero.
    pub from: [f64; 2],
    /// Of length one.
    pub direction: [f64; 2],
}

/// A point that two surfaces have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct Meeting {
    /// The point as one of the first surface, [`CutBy::ItsTool`](crate::equations::solution::CutBy::ItsTool) where that is cut away by its own tool.
    pub first: SurfacePoint,
    /// The point as one of the second.
    pub second: SurfacePoint,
    /// How far along the line it lies.
    pub along: f64,
    /// Whether the first surface, farther along the line, runs on outside the body that owns the second. If so, its points
    /// there are cut away; if not, those before the meeting.
    pub leaves: bool,
}

impl Intersection {
    /// Of two surfaces in one frame; the meetings lie on lines of two `coordinates`, functions of the first one's unknowns.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor has a value.
    ///
    /// # Panics
    /// If a surface does not have two unknowns more than constraints.
    pub fn new<'g>(
        [first, second]: [&BoundSurface<'g>; 2],
        coordinates: [Expr<'g>; 2],
    ) -> Result<Intersection, TapeError> {
        let graph = coordinates[0].graph();
        let across = first.with_values(&coordinates);
        // both may be envelopes over the same motion, at different values of it
        let second = second.renamed("of the second");
        let feet = Feet::new(&second)?;
        let ranges = [first.ranges(), second.ranges()].concat();
        let (first, second) = (first.surface(), second.surface());
        let line = ["from 1", "from 2", "direction 1", "direction 2"].map(|name| graph.variable(name));
        let placed: Vec<Expr<'g>> = first.constraints.iter().chain(&across).copied().collect();
        let (x, y) = (across[0] - line[0], across[1] - line[1]);
        let along = x * line[2] + y * line[3];
        let apart = first.position - second.position;
        let constraints = first.constraints.iter().chain(&second.constraints).copied();
        let residuals: Vec<Expr<'g>> = constraints.chain(apart.0).chain([x * line[3] - y * line[2]]).collect();
        let unknowns: Vec<Expr<'g>> = first.unknowns.iter().chain(&second.unknowns).copied().collect();
        let slopes = first.unknowns.iter().map(|&p| along.derivative(p));
        let vectors = [first.position, first.normal, second.normal].into_iter().flat_map(|Vector3(parts)| parts);
        let probe: Vec<Expr<'g>> = vectors.chain([along]).chain(slopes).collect();
        let inputs: Vec<Expr<'g>> = unknowns.iter().chain(&line).copied().collect();
        Ok(Intersection {
            system: System::one_by_one(&residuals, &unknowns, &line)?.with_conditions(
                &residuals,
                &second.clearance_minors(),
                &[],
                &inputs,
            )?,
            own: System::one_by_one(&placed, &first.unknowns, &[])?.with_conditions(
                &placed,
                &first.clearance_minors(),
                &[],
                &first.unknowns,
            )?,
            ranges,
            first_unknowns: first.unknowns.len(),
            probe: Tape::new(&probe, &inputs)?,
            second: feet,
        })
    }

    /// The points at which the surfaces cross on a line, in the order along it: inside the ranges, of the part of the second that
    /// its tool leaves, and not where they only touch. The first one's tool may cut it away there itself, as the first point's outcome
    /// tells. Where the first surface folds over the coordinates, points beyond the fold lie in another order along the line, and are
    /// none of these.
    ///
    /// They are looked for from unknowns of both (meetings on the line beside this one, say) and from points of the first
    /// surface near the line, each with the nearest known point of the second.
    pub fn on_line(&self, line: Line, unknowns: &[Vec<f64>], near: &[&SurfacePoint]) -> Vec<Meeting> {
        let parameters = [line.from, line.direction].concat();
        let mut evaluation = self.system.evaluation(&parameters);
        let mut found: Vec<Meeting> = Vec::new();
        for start in unknowns.iter().cloned().chain(self.pairs(near)) {
            let solution = solve_with(&mut evaluation, &self.ranges, &start);
            let is_new = |meeting: &Meeting| distance(&meeting.unknowns(), &solution.unknowns, &self.ranges) > SAME;
            if solution.outcome != Outcome::Solved || !found.iter().all(is_new) {
                continue;
            }
            let meeting = self.meeting(&mut evaluation, &parameters, &solution);
            if !meeting.only_touches() && self.is_on_sheet(&meeting.first, near) {
                found.push(meeting);
            }
        }
        found.sort_by(|a, b| a.along.total_cmp(&b.along));
        found
    }

    /// Unknowns of both surfaces near their meetings on a line, from points of the first in the order along it: where two neighbours lie
    /// on different sides of the second surface, and where one lies nearer to it than both neighbours.
    pub(crate) fn crossings(&self, points: &[&SurfacePoint]) -> Vec<Vec<f64>> {
        let count = points.len().min(FOLLOWED);
        let spread = (0..count).map(|k| points[k * (points.len() - 1) / (count - 1).max(1)]);
        let points: Vec<&SurfacePoint> = spread.collect();
        let feet = self.second.along(&points);
        let known: Vec<(&SurfacePoint, &Foot)> =
            points.iter().zip(&feet).filter_map(|(point, foot)| Some((*point, foot.as_ref()?))).collect();
        let both = |(point, foot): (&SurfacePoint, &Foot)| [&point.unknowns[..], &foot.unknowns].concat();
        let mut starts = Vec::new();
        for pair in known.windows(2) {
            let [from, to] = [pair[0].1.distance, pair[1].1.distance];
            if (from < 0.0) != (to < 0.0) {
                let [a, b] = [both(pair[0]), both(pair[1])];
                starts.push(a.iter().zip(&b).map(|(a, b)| a + (b - a) * from / (from - to)).collect());
                // where a motion comes round, there is nothing between them
                starts.extend([a, b]);
            }
        }
        for triple in known.windows(3) {
            let [before, here, after] = [0, 1, 2].map(|k| triple[k].1.distance.abs());
            if here + NEARER < before.min(after) {
                // of two crossings close together each is nearer to one of the neighbours
                starts.extend([1, 0, 2].map(|k| both(triple[k])));
            }
        }
        starts
    }

    /// Whether no fold parts a point of the first surface from the nearest one of some that are known, if there are any.
    fn is_on_sheet(&self, point: &SurfacePoint, known: &[&SurfacePoint]) -> bool {
        let ranges = &self.ranges[..self.first_unknowns];
        let far = |other: &&&SurfacePoint| distance(&point.unknowns, &other.unknowns, ranges);
        let Some(nearest) = known.iter().min_by(|a, b| far(a).total_cmp(&far(b))) else { return true };
        let mut evaluation = self.own.evaluation(&[]);
        let [here, there] = [point, *nearest].map(|point| {
            evaluation.at(&point.unknowns);
            determinant(&evaluation, ranges)
        });
        here * there >= 0.0
    }

    /// A root as a point of both surfaces.
    fn meeting(&self, evaluation: &mut Evaluation<'_>, line: &[f64], solution: &Solution) -> Meeting {
        let mut out = vec![0.0; self.probe.output_count()];
        ScalarEvaluator::new(&self.probe).run(&[&solution.unknowns[..], line].concat(), &mut out);
        let vector = |k: usize| [out[k], out[k + 1], out[k + 2]];
        let [position, first_normal, second_normal] = [0, 3, 6].map(vector);
        let (along, slopes) = (out[9], &out[10..]);
        // how far the meeting moves along the line if the first surface is held a little outside the second: of the
        // equations, the last four are the equal positions and the line
        let mut held = vec![0.0; self.system.size()];
        let equal_positions = self.system.size() - 4;
        held[equal_positions..equal_positions + 3].copy_from_slice(&second_normal);
        evaluation.at(&solution.unknowns);
        let moved = inverse_times(evaluation, &held);
        let farther: f64 = slopes.iter().zip(&moved).map(|(slope, by)| slope * by).sum();
        let point = |outcome, unknowns: &[f64], normal| SurfacePoint {
            outcome,
            unknowns: unknowns.to_vec(),
            position,
            normal,
            residual: solution.residual,
        };
        let (first, second) = solution.unknowns.split_at(self.first_unknowns);
        Meeting {
            first: point(self.own.evaluation(&[]).conditions.side(first), first, first_normal),
            second: point(Outcome::Solved, second, second_normal),
            along,
            leaves: farther > 0.0,
        }
    }

    /// Unknowns of both surfaces where they are near each other.
    fn pairs(&self, near: &[&SurfacePoint]) -> impl Iterator<Item = Vec<f64>> {
        let mut pairs: Vec<(f64, &SurfacePoint, &SurfacePoint)> = Vec::new();
        for point in near {
            let nearest = self.second.seeds.iter().map(|seed| (squared_distance(point, seed), *point, seed));
            pairs.extend(nearest.min_by(|a, b| a.0.total_cmp(&b.0)));
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        pairs.into_iter().take(PAIRS).map(|(_, a, b)| [&a.unknowns[..], &b.unknowns].concat())
    }
}

impl Meeting {
    /// Whether the surfaces have the same tangent plane there, as far as points within the tolerance can tell.
    fn only_touches(&self) -> bool {
        let [a, b] = [&self.first, &self.second].map(|point| nalgebra::Vector3::from(point.normal));
        a.cross(&b).norm() < TOUCHING
    }

    /// The unknowns of the first surface and of the second.
    pub fn unknowns(&self) -> Vec<f64> {
        [&self.first.unknowns[..], &self.second.unknowns].concat()
    }
}
