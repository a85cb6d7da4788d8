//! What the marking compound shows: how near the mate comes to each point of a flank while a pair of teeth goes through the mesh.

use flank_expr::geometry::Vector3;
use flank_expr::{Expr, LANES, ScalarEvaluator, Tape, TapeError};
use rayon::prelude::*;

use crate::analysis::deviation::FARTHEST;
use crate::contact::RollingPair;
use crate::contact::outline::Outline;
use crate::equations::solution::{Outcome, Range};
use crate::equations::system::System;
use crate::newton::batch::LaneNewton;
use crate::newton::scalar::{LONGEST_STEP, solve};
use crate::surface::points::SurfacePoint;

/// A normal that passes the mate's points by more than this share of the way across them all does not meet the mate: its ranges end.
const ASIDE: f64 = 0.25;
/// Where no foot was found in lanes, and none at the position before, one is looked for with care at every so many positions: those between
/// are found from their neighbours.
const LOOKED_AGAIN: usize = 8;
/// Nodes that a thread takes at a time.
const TILE: usize = 2 * LANES;

/// Distances from points of one flank along its normals to the other flank.
#[derive(Clone, Debug)]
pub struct GapProblem {
    /// Unknowns of the mate and a distance; a point and a normal in the mate's frame are parameters, and those of the pair.
    along_normal: System,
    ranges: Vec<Range>,
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
    /// At which of the positions.
    pub position: usize,
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
        let t_mate_flank = pair.placements[mate].inverse().then(&pair.placements[member]).pose();
        let axes = t_mate_flank.rotation.entries();
        let pose: Vec<Expr<'_>> = t_mate_flank.translation.0.into_iter().chain(axes).collect();
        Ok(GapProblem {
            along_normal: System::new(&residuals, &unknowns, &parameters)?,
            ranges: [pair.surfaces[mate].ranges(), &[FARTHEST]].concat(),
            own: pair.outlines[member].clone(),
            outline: pair.outlines[mate].clone(),
            values: pair.parameters.iter().map(|(_, value)| *value).collect(),
            pose: Tape::new(&pose, &[&[pair.roll, pair.lag.0][..], &given].concat())?,
        })
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
        let poses: Vec<[f64; 12]> = positions.iter().map(|at| self.pose_at(*at)).collect();
        let points: Vec<&SurfacePoint> = mate.iter().filter(|point| point.outcome == Outcome::Solved).collect();
        if points.is_empty() {
            return vec![None; nodes.len()];
        }
        let mate = Mate { size: size(&points), points, reach };
        nodes.par_chunks(TILE).flat_map_iter(|nodes| self.least_of(nodes, &poses, &mate)).collect()
    }

    fn pose_at(&self, position: [f64; 2]) -> [f64; 12] {
        let mut pose = [0.0; 12];
        ScalarEvaluator::new(&self.pose).run(&[&position[..], &self.values].concat(), &mut pose);
        pose
    }

    fn least_of(&self, nodes: &[SurfacePoint], poses: &[[f64; 12]], mate: &Mate<'_>) -> Vec<Option<Gap>> {
        let mut newton = LaneNewton::new(&self.along_normal, &self.ranges);
        nodes.chunks(LANES).flat_map(|nodes| self.least_in_lanes(&mut newton, nodes, poses, mate)).collect()
    }

    fn least_in_lanes(
        &self,
        newton: &mut LaneNewton<'_>,
        nodes: &[SurfacePoint],
        poses: &[[f64; 12]],
        mate: &Mate<'_>,
    ) -> Vec<Option<Gap>> {
        let is_solved: Vec<bool> =
            nodes.iter().map(|node| node.outcome == Outcome::Solved && self.is_on_tooth(node)).collect();
        let mut feet: Vec<Vec<Option<Vec<f64>>>> = Vec::with_capacity(poses.len());
        for pose in poses {
            let asked: Vec<[f64; 6]> = nodes.iter().map(|node| placed(pose, node)).collect();
            let before = |lane: usize| feet.last().and_then(|feet: &Vec<Option<Vec<f64>>>| feet[lane].clone());
            let was_met: Vec<bool> = (0..nodes.len()).map(|lane| before(lane).is_some()).collect();
            let starts: Vec<Option<Vec<f64>>> = (0..nodes.len())
                .map(|lane| is_solved[lane].then(|| before(lane).or_else(|| mate.nearest(&asked[lane]))).flatten())
                .collect();
            let active: Vec<bool> = starts.iter().map(Option::is_some).collect();
            if !active.contains(&true) {
                feet.push(vec![None; nodes.len()]);
                continue;
            }
            for (lane, start) in starts.into_iter().enumerate() {
                let Some(start) = start else { continue };
                newton.put(lane, start.into_iter(), &self.parameters(&asked[lane]));
            }
            newton.run(&active, true);
            let mut foot = |lane: usize| {
                let is_near = newton.is_root(lane) && newton.moved(lane) <= LONGEST_STEP;
                match newton.outcome(lane) {
                    Outcome::Solved if is_near => Some((0..self.ranges.len()).map(|k| newton.input(k)[lane]).collect()),
                    Outcome::Outside { .. } if is_near => None,
                    _ if was_met[lane] || feet.len().is_multiple_of(LOOKED_AGAIN) => {
                        self.alone(&asked[lane], &mate.nearest(&asked[lane])?)
                    }
                    _ => None,
                }
            };
            let found = (0..nodes.len()).map(|lane| active[lane].then(|| foot(lane)).flatten()).collect();
            feet.push(found);
        }
        self.found_backwards(&mut feet, nodes, poses);
        (0..nodes.len())
            .map(|lane| self.least_at(&nodes[lane], poses, feet.iter().map(|feet| feet[lane].as_deref()), mate.reach))
            .collect()
    }

    /// Where no foot was found from the mate's points nearby, which may lie on another branch, it is looked for from the one of the position
    /// after.
    fn found_backwards(&self, feet: &mut [Vec<Option<Vec<f64>>>], nodes: &[SurfacePoint], poses: &[[f64; 12]]) {
        for position in (1..poses.len()).rev() {
            for (lane, node) in nodes.iter().enumerate() {
                if let (None, Some(after)) = (&feet[position - 1][lane], &feet[position][lane]) {
                    feet[position - 1][lane] = self.alone(&placed(&poses[position - 1], node), after);
                }
            }
        }
    }

    fn least_at<'f>(
        &self,
        node: &SurfacePoint,
        poses: &[[f64; 12]],
        feet: impl Iterator<Item = Option<&'f [f64]>>,
        reach: f64,
    ) -> Option<Gap> {
        let gap = |(position, foot): (usize, Option<&[f64]>)| {
            let distance = *foot?.last()?;
            let is_near = distance.abs() <= reach && self.is_on_mate(&placed(&poses[position], node), distance);
            is_near.then_some(Gap { distance, position })
        };
        feet.enumerate().filter_map(gap).min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    fn parameters(&self, asked: &[f64; 6]) -> Vec<f64> {
        [&asked[..], &self.values].concat()
    }

    fn alone(&self, asked: &[f64; 6], start: &[f64]) -> Option<Vec<f64>> {
        let solution = solve(&self.along_normal, &self.ranges, &self.parameters(asked), start);
        (solution.outcome == Outcome::Solved).then_some(solution.unknowns)
    }

    /// Whether a point of the flank is one of its tooth.
    fn is_on_tooth(&self, node: &SurfacePoint) -> bool {
        let [x, y, z] = node.position;
        self.own.as_ref().is_none_or(|outline| outline.holds([z, x.hypot(y)]))
    }

    /// Whether the mate's tooth reaches there.
    fn is_on_mate(&self, [x, y, z, nx, ny, nz]: &[f64; 6], distance: f64) -> bool {
        let [x, y, z] = [x + distance * nx, y + distance * ny, z + distance * nz];
        self.outline.as_ref().is_none_or(|outline| outline.holds([z, x.hypot(y)]))
    }
}

/// A point and its normal seen from the mate.
fn placed(pose: &[f64; 12], node: &SurfacePoint) -> [f64; 6] {
    let row = |k: usize, v: [f64; 3]| pose[3 + 3 * k] * v[0] + pose[4 + 3 * k] * v[1] + pose[5 + 3 * k] * v[2];
    let (p, n) = (node.position, node.normal);
    [pose[0] + row(0, p), pose[1] + row(1, p), pose[2] + row(2, p), row(0, n), row(1, n), row(2, n)]
}

/// Solved points of the mate, from which feet are looked for.
struct Mate<'p> {
    points: Vec<&'p SurfacePoint>,
    /// How far it is across them.
    size: f64,
    /// How far away they are looked for, along a normal.
    reach: f64,
}

impl Mate<'_> {
    /// The unknowns of the point that is nearest, and how far away it is along the normal; `None` where the normal passes all of them by far.
    fn nearest(&self, [x, y, z, nx, ny, nz]: &[f64; 6]) -> Option<Vec<f64>> {
        let apart = |point: &SurfacePoint| [point.position[0] - x, point.position[1] - y, point.position[2] - z];
        let off = |point: &SurfacePoint| apart(point).iter().map(|x| x * x).sum::<f64>();
        let along = |point: &SurfacePoint| {
            let [dx, dy, dz] = apart(point);
            dx * nx + dy * ny + dz * nz
        };
        let of_tooth = self.points.iter().filter(|point| along(point).abs() <= self.reach);
        let near = of_tooth.min_by(|a, b| off(a).total_cmp(&off(b)))?;
        let along = along(near);
        let aside = (off(near) - along * along).max(0.0).sqrt();
        (aside <= ASIDE * self.size).then(|| near.unknowns.iter().copied().chain([along]).collect())
    }
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
