//! What the marking compound shows: how near the mate comes to each point of a flank while a pair of teeth goes through the mesh.

use flank_expr::geometry::Vector3;
use flank_expr::{Expr, LANES, ScalarEvaluator, Tape, TapeError};
use rayon::prelude::*;

use crate::analysis::deviation::FARTHEST;
use crate::contact::RollingPair;
use crate::contact::outline::Outline;
use crate::contact::point::{Pose, placed, pose, turned};
use crate::equations::solution::{Outcome, Range};
use crate::equations::system::System;
use crate::newton::batch::{LaneNewton, Lanes};
use crate::newton::scalar::{LONGEST_STEP, solve};
use crate::surface::points::SurfacePoint;

/// A normal that passes the mate's points by more than this share of the way across them all does not meet the mate: its ranges end.
const ASIDE: f64 = 0.25;
/// Where no foot was found in lanes, and none at any position before, one is looked for with care at every so many positions: those between
/// are found from their neighbours.
const LOOKED_AGAIN: usize = 8;
/// With care only where the normal passes a point of the mate within so many times the way from one to the next.
const SPACED: f64 = 1.5;
/// Points of the mate that are taken together where the nearest is looked for.
const GROUP: usize = 8;
/// Nodes that a thread takes at a time.
pub(super) const TILE: usize = 2 * LANES;

/// Distances from points of one flank along its normals to the other flank.
#[derive(Clone, Debug)]
pub struct GapProblem {
    /// Unknowns of the mate and a distance; a point and a normal in the mate's frame are parameters, and those of the pair.
    pub(super) along_normal: System,
    pub(super) ranges: Vec<Range>,
    /// Where the teeth of the flank end, and those of the mate.
    own: Option<Outline>,
    outline: Option<Outline>,
    /// Of the pair's parameters.
    values: Vec<f64>,
    /// From the roll, the lag and the pair's parameters: where the flank's origin and axes are in the mate's frame.
    pose: Tape,
}

/// How near the mate comes to a point of a flank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Along the flank's normal, out of its body, mm. Negative where the mate reaches into it.
    pub distance: f64,
    /// At which roll position.
    pub roll: f64,
}

impl GapProblem {
    /// From points of one member's flank, 0 or 1, to the other flank.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown, nor the roll or lag, nor has a value.
    pub fn new<'g>(pair: &RollingPair<'_, 'g>, member: usize) -> Result<GapProblem, TapeError> {
        let mate = 1 - member;
        let surface = pair.surfaces[mate].surface();
        let graph = pair.roll.graph();
        let vector = |name: &str| Vector3(["x", "y", "z"].map(|axis| graph.variable(format!("{name} {axis}"))));
        let (point, normal, distance) = (vector("point"), vector("normal"), graph.variable("distance"));
        let reached = point + normal.map(|part| part * distance);
        let residuals = pair.surfaces[mate].constrained((surface.position - reached).0);
        let unknowns = [&surface.unknowns[..], &[distance]].concat();
        let given: Vec<Expr<'_>> = pair.parameters.iter().map(|(name, _)| *name).collect();
        let parameters: Vec<Expr<'_>> = point.0.into_iter().chain(normal.0).chain(given.iter().copied()).collect();
        let pose = pose(&pair.placements[mate].inverse().then(&pair.placements[member]));
        Ok(GapProblem {
            along_normal: System::new(&residuals, &unknowns, &parameters)?,
            ranges: [pair.surfaces[mate].ranges(), &[FARTHEST]].concat(),
            own: pair.outlines[member].clone(),
            outline: pair.outlines[mate].clone(),
            values: pair.parameters.iter().map(|(_, value)| *value).collect(),
            pose: Tape::new(&pose, &[&[pair.roll, pair.lag.0][..], &given].concat())?,
        })
    }

    /// The same with other values of the pair's parameters.
    ///
    /// # Panics
    /// If there are not as many.
    pub fn with_values(&self, values: &[f64]) -> GapProblem {
        assert_eq!(values.len(), self.values.len(), "one value for each parameter");
        GapProblem { values: values.to_vec(), ..self.clone() }
    }

    /// At each point of the flank, in its own frame, the least distance to the mate over positions of roll and lag; `None` where its
    /// normal meets the mate at none of them, and beyond the ends of its tooth. `mate` are solved points of the mate, from which its nearest is looked for; what lies farther
    /// away than `reach`, mm, belongs to another tooth.
    pub fn least(
        &self,
        nodes: &[SurfacePoint],
        positions: &[[f64; 2]],
        mate: &[SurfacePoint],
        reach: f64,
    ) -> Vec<Option<Gap>> {
        let poses: Vec<Pose> = positions.iter().map(|at| self.pose_at(*at)).collect();
        let points: Vec<&SurfacePoint> = mate.iter().filter(|point| point.outcome == Outcome::Solved).collect();
        if points.is_empty() {
            return vec![None; nodes.len()];
        }
        let mate = Mate::new(points, reach);
        let least = |nodes| self.least_of(nodes, (positions, &poses), &mate);
        nodes.par_chunks(TILE).flat_map_iter(least).collect()
    }

    /// The same at each position: of each point the distances, position by position.
    pub fn each(
        &self,
        nodes: &[SurfacePoint],
        positions: &[[f64; 2]],
        mate: &[SurfacePoint],
        reach: f64,
    ) -> Vec<Vec<Option<f64>>> {
        let poses: Vec<Pose> = positions.iter().map(|at| self.pose_at(*at)).collect();
        let points: Vec<&SurfacePoint> = mate.iter().filter(|point| point.outcome == Outcome::Solved).collect();
        if points.is_empty() {
            return vec![vec![None; positions.len()]; nodes.len()];
        }
        let mate = Mate::new(points, reach);
        let of_tile = |tile: &[SurfacePoint]| {
            let mut newton = LaneNewton::new(&self.along_normal, &self.ranges);
            let in_lanes = |nodes: &[SurfacePoint]| {
                let feet = self.feet(&mut newton, nodes, &poses, &mate);
                let of_lane = |lane: usize| self.on_mate(&nodes[lane], &poses, feet.distances(lane), reach).collect();
                (0..nodes.len()).map(of_lane).collect::<Vec<Vec<Option<f64>>>>()
            };
            tile.chunks(LANES).flat_map(in_lanes).collect::<Vec<_>>()
        };
        nodes.par_chunks(TILE).flat_map_iter(of_tile).collect()
    }

    pub(super) fn pose_at(&self, position: [f64; 2]) -> Pose {
        let mut pose = [0.0; 12];
        ScalarEvaluator::new(&self.pose).run(&[&position[..], &self.values].concat(), &mut pose);
        pose
    }

    fn least_of(&self, nodes: &[SurfacePoint], at: (&[[f64; 2]], &[Pose]), mate: &Mate<'_>) -> Vec<Option<Gap>> {
        let mut newton = LaneNewton::new(&self.along_normal, &self.ranges);
        nodes.chunks(LANES).flat_map(|nodes| self.least_in_lanes(&mut newton, nodes, at, mate)).collect()
    }

    fn least_in_lanes(
        &self,
        newton: &mut LaneNewton<'_>,
        nodes: &[SurfacePoint],
        (positions, poses): (&[[f64; 2]], &[Pose]),
        mate: &Mate<'_>,
    ) -> Vec<Option<Gap>> {
        let feet = self.feet(newton, nodes, poses, mate);
        let least = |(lane, node): (usize, &SurfacePoint)| {
            let (distance, at) = self.least_at(node, poses, feet.distances(lane), mate.reach)?;
            Some(Gap { distance, roll: positions[at][0] })
        };
        nodes.iter().enumerate().map(least).collect()
    }

    /// Where the normals of no more nodes than there are lanes meet the mate.
    pub(super) fn feet(
        &self,
        newton: &mut LaneNewton<'_>,
        nodes: &[SurfacePoint],
        poses: &[Pose],
        mate: &Mate<'_>,
    ) -> Feet {
        let mut feet = Feet::new(self.ranges.len(), poses.len());
        let is_on_tooth: Vec<bool> =
            nodes.iter().map(|node| node.outcome == Outcome::Solved && self.is_on_tooth(node)).collect();
        let mut was_met = vec![false; nodes.len()];
        for (position, pose) in poses.iter().enumerate() {
            let asked: Vec<[f64; 6]> = nodes.iter().map(|node| seen(pose, node)).collect();
            let mut active = vec![false; nodes.len()];
            for lane in (0..nodes.len()).filter(|lane| is_on_tooth[*lane]) {
                active[lane] = feet.start_after(newton, lane, position)
                    || mate.nearest(&asked[lane]).is_some_and(|start| put(newton, lane, &start.unknowns));
            }
            self.follow(newton, &mut feet, position, (&active, &asked));
            for lane in 0..nodes.len() {
                was_met[lane] |= feet.has(position, lane);
                let is_open = active[lane] && !was_met[lane] && position.is_multiple_of(LOOKED_AGAIN);
                let start = if is_open { mate.nearest(&asked[lane]) } else { None };
                let start = start.filter(|start| start.aside <= mate.spacing);
                if let Some(foot) = start.and_then(|start| self.alone(&asked[lane], &start.unknowns)) {
                    feet.put(position, lane, &foot);
                }
            }
        }
        // feet that no point of the mate lies near, perhaps because it is on another branch, are found from those of positions after
        for (position, pose) in poses.iter().enumerate().rev() {
            let mut active = vec![false; nodes.len()];
            for lane in (0..nodes.len()).filter(|lane| is_on_tooth[*lane] && !feet.has(position, *lane)) {
                active[lane] = feet.start_before(newton, lane, position);
            }
            if active.contains(&true) {
                let asked: Vec<[f64; 6]> = nodes.iter().map(|node| seen(pose, node)).collect();
                self.follow(newton, &mut feet, position, (&active, &asked));
            }
        }
        feet
    }

    /// Feet from the starts that stand in the lanes.
    fn follow(
        &self,
        newton: &mut LaneNewton<'_>,
        feet: &mut Feet,
        position: usize,
        (active, asked): (&[bool], &[[f64; 6]]),
    ) {
        if !active.contains(&true) {
            return;
        }
        let unknowns = self.ranges.len();
        for (k, value) in self.values.iter().enumerate() {
            newton.input(unknowns + 6 + k).fill(*value);
        }
        for k in 0..6 {
            let input = newton.input(unknowns + k);
            asked.iter().zip(input).for_each(|(asked, input)| *input = asked[k]);
        }
        newton.run(active, true);
        for lane in (0..active.len()).filter(|lane| active[*lane]) {
            let is_near = newton.is_root(lane) && newton.moved(lane) <= LONGEST_STEP;
            if is_near && newton.outcome(lane) == Outcome::Solved {
                feet.take(position, lane, newton);
            }
        }
    }

    /// The least of the distances by position of a node, and at which it is.
    fn least_at(
        &self,
        node: &SurfacePoint,
        poses: &[Pose],
        distances: impl Iterator<Item = Option<f64>>,
        reach: f64,
    ) -> Option<(f64, usize)> {
        let mut near: Vec<(usize, f64)> = distances
            .enumerate()
            .filter_map(|(position, distance)| Some((position, distance.filter(|distance| distance.abs() <= reach)?)))
            .collect();
        near.sort_unstable_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        let on_mate = near.into_iter().find(|(at, distance)| self.is_on_mate(&seen(&poses[*at], node), *distance));
        on_mate.map(|(position, distance)| (distance, position))
    }

    /// The distances by position of a node, where the mate's tooth is there.
    pub(super) fn on_mate<'f>(
        &'f self,
        node: &'f SurfacePoint,
        poses: &'f [Pose],
        distances: impl Iterator<Item = Option<f64>> + 'f,
        reach: f64,
    ) -> impl Iterator<Item = Option<f64>> + 'f {
        distances.zip(poses).map(move |(distance, pose)| {
            distance.filter(|distance| distance.abs() <= reach && self.is_on_mate(&seen(pose, node), *distance))
        })
    }

    /// The distance at one position, found from a foot at another one; `None` where the normal does not meet the mate's tooth within reach.
    pub(super) fn distance_at(&self, node: &SurfacePoint, at: [f64; 2], start: &[f64], reach: f64) -> Option<f64> {
        let asked = seen(&self.pose_at(at), node);
        let distance = *self.alone(&asked, start)?.last()?;
        (distance.abs() <= reach && self.is_on_mate(&asked, distance)).then_some(distance)
    }

    fn alone(&self, asked: &[f64; 6], start: &[f64]) -> Option<Vec<f64>> {
        let parameters = [&asked[..], &self.values].concat();
        let solution = solve(&self.along_normal, &self.ranges, &parameters, start);
        (solution.outcome == Outcome::Solved).then_some(solution.unknowns)
    }

    /// Whether a point of the flank is one of its tooth.
    fn is_on_tooth(&self, node: &SurfacePoint) -> bool {
        let [x, y, z] = node.position;
        self.own.as_ref().is_none_or(|outline| outline.holds([z, (x * x + y * y).sqrt()]))
    }

    /// Whether the mate's tooth reaches there.
    fn is_on_mate(&self, [x, y, z, nx, ny, nz]: &[f64; 6], distance: f64) -> bool {
        let [x, y, z] = [x + distance * nx, y + distance * ny, z + distance * nz];
        self.outline.as_ref().is_none_or(|outline| outline.holds([z, (x * x + y * y).sqrt()]))
    }
}

/// A point and its normal seen from the mate.
fn seen(pose: &Pose, node: &SurfacePoint) -> [f64; 6] {
    let ([x, y, z], [nx, ny, nz]) = (placed(pose, node.position), turned(pose, node.normal));
    [x, y, z, nx, ny, nz]
}

/// Where normals of nodes meet the mate, by position and lane.
pub(super) struct Feet {
    unknowns: usize,
    /// Of each position the unknowns, one after the other; no number where the normal does not meet the mate.
    at: Vec<Lanes>,
}

impl Feet {
    fn new(unknowns: usize, positions: usize) -> Feet {
        Feet { unknowns, at: vec![[f64::NAN; LANES]; unknowns * positions] }
    }

    fn of(&self, position: usize) -> &[Lanes] {
        &self.at[position * self.unknowns..(position + 1) * self.unknowns]
    }

    fn has(&self, position: usize, lane: usize) -> bool {
        !self.of(position)[0][lane].is_nan()
    }

    fn put(&mut self, position: usize, lane: usize, foot: &[f64]) {
        let at = &mut self.at[position * self.unknowns..(position + 1) * self.unknowns];
        at.iter_mut().zip(foot).for_each(|(at, x)| at[lane] = *x);
    }

    fn take(&mut self, position: usize, lane: usize, newton: &mut LaneNewton<'_>) {
        for k in 0..self.unknowns {
            self.at[position * self.unknowns + k][lane] = newton.input(k)[lane];
        }
    }

    /// Puts a start for a position into a lane, on the parabola through the feet of positions before: `false` where there is none.
    fn start_after(&self, newton: &mut LaneNewton<'_>, lane: usize, position: usize) -> bool {
        let near = |k: usize| position.checked_sub(k);
        self.start(newton, lane, [near(1), near(2), near(3)])
    }

    /// The same from positions after.
    fn start_before(&self, newton: &mut LaneNewton<'_>, lane: usize, position: usize) -> bool {
        let positions = self.at.len() / self.unknowns;
        let near = |k: usize| Some(position + k).filter(|at| *at < positions);
        self.start(newton, lane, [near(1), near(2), near(3)])
    }

    fn start(&self, newton: &mut LaneNewton<'_>, lane: usize, near: [Option<usize>; 3]) -> bool {
        let known = near.into_iter().take_while(|at| at.is_some_and(|at| self.has(at, lane))).count();
        let of = |k: usize| near[k].map_or(&[][..], |at| self.of(at));
        for k in 0..self.unknowns {
            let at = |place: usize| of(place)[k][lane];
            newton.input(k)[lane] = match known {
                0 => return false,
                1 => at(0),
                2 => 2.0 * at(0) - at(1),
                _ => 3.0 * (at(0) - at(1)) + at(2),
            };
        }
        true
    }

    /// The unknowns and the distance of one.
    pub(super) fn foot(&self, position: usize, lane: usize) -> Vec<f64> {
        self.of(position).iter().map(|at| at[lane]).collect()
    }

    /// Of a lane by position.
    pub(super) fn distances(&self, lane: usize) -> impl Iterator<Item = Option<f64>> {
        self.at.chunks(self.unknowns).map(move |at| Some(at[at.len() - 1][lane]).filter(|distance| !distance.is_nan()))
    }
}

fn put(newton: &mut LaneNewton<'_>, lane: usize, start: &[f64]) -> bool {
    newton.put(lane, start.iter().copied(), &[]);
    true
}

/// Solved points of the mate, from which feet are looked for.
pub(super) struct Mate<'p> {
    points: Vec<&'p SurfacePoint>,
    /// Neighbours in the order of the points, with a ball around each group.
    groups: Vec<Group>,
    /// How far it is across them, and about from one to the next, mm.
    size: f64,
    spacing: f64,
    /// How far away they are looked for, along a normal.
    reach: f64,
}

/// The points of a range, and the centre and the radius of a ball around them.
struct Group {
    points: std::ops::Range<usize>,
    center: [f64; 3],
    radius: f64,
}

/// Where a foot is looked for.
struct Start {
    /// With the distance along the normal last.
    unknowns: Vec<f64>,
    /// How far the normal passes the nearest point of the mate.
    aside: f64,
}

impl<'p> Mate<'p> {
    pub(super) fn new(points: Vec<&'p SurfacePoint>, reach: f64) -> Mate<'p> {
        let group = |first: usize| {
            let range = first..(first + GROUP).min(points.len());
            let of = &points[range.clone()];
            let center = [0, 1, 2].map(|k| of.iter().map(|point| point.position[k]).sum::<f64>() / of.len() as f64);
            let radius = of.iter().map(|point| squared(point.position, center)).fold(0.0, f64::max).sqrt();
            Group { points: range, center, radius }
        };
        let groups = (0..points.len()).step_by(GROUP).map(group).collect();
        let size = size(&points);
        Mate { groups, size, spacing: SPACED * size / (points.len() as f64).sqrt(), points, reach }
    }

    /// From the nearest point; `None` where the normal passes all of them by far.
    fn nearest(&self, [x, y, z, nx, ny, nz]: &[f64; 6]) -> Option<Start> {
        let along = |point: &SurfacePoint| {
            let [px, py, pz] = point.position;
            (px - x) * nx + (py - y) * ny + (pz - z) * nz
        };
        let mut near: Option<(f64, &SurfacePoint)> = None;
        let mut least = f64::INFINITY;
        for group in &self.groups {
            let farthest = least + group.radius;
            if squared(group.center, [*x, *y, *z]) > farthest * farthest {
                continue;
            }
            for &point in &self.points[group.points.clone()] {
                let off = squared(point.position, [*x, *y, *z]);
                if near.is_none_or(|(least, _)| off < least) && along(point).abs() <= self.reach {
                    (near, least) = (Some((off, point)), off.sqrt());
                }
            }
        }
        let (off, near) = near?;
        let along = along(near);
        let aside = (off - along * along).max(0.0).sqrt();
        let unknowns = || near.unknowns.iter().copied().chain([along]).collect();
        (aside <= ASIDE * self.size).then(|| Start { unknowns: unknowns(), aside })
    }
}

fn squared(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum()
}

/// The diagonal of the box about points.
fn size(points: &[&SurfacePoint]) -> f64 {
    let width = |k: usize| {
        let ends = points
            .iter()
            .map(|point| point.position[k])
            .fold([f64::MAX, f64::MIN], |[low, high], x| [low.min(x), high.max(x)]);
        ends[1] - ends[0]
    };
    (0..3).map(|k| width(k) * width(k)).sum::<f64>().sqrt()
}
