//! What stays on the work, by trying: the tool stands at many positions, and for each the height of a point over its steel is known. No
//! equation of meshing is used: where the tool touches a point, that height has its least value.

use crate::machine::{Machine, Position, Range};
use crate::newton::{halton, newton};
use crate::pose::{Vector, distance, dot, minus};
use crate::positions::{Lattice, around};
use crate::tool::Shape;

/// Least heights between neighbours that are looked at closely.
const MOST_LOW: usize = 8;
/// Steps of a way along which a point is followed.
const WAY: usize = 32;
/// Places from which points are looked for.
const STARTS: usize = 60;
/// How far a motion goes to both sides for a rate, as a share of its range.
const STEP: f64 = 5e-5;
/// How far a parameter goes to both sides for a tangent, as shares of its range, the first that stays on one branch.
const SHARES: [f64; 2] = [1e-3, 1e-4];
/// How far two steps along one branch, to either side, are off each other's opposite, as a share of them.
const BENT: f64 = 0.02;

#[derive(Clone, Debug)]
pub struct Oracle<'a> {
    /// Of the two parameters of the tool, then of the motions.
    pub ranges: Vec<Range>,
    /// What generates, and what else of the tool cuts.
    parts: Vec<Part<'a>>,
    lattice: Lattice,
    /// For each place of the lattice the position of each part.
    positions: Vec<Vec<Position>>,
}

/// A part of the tool on its machine, with the ranges of its parameters.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    pub machine: &'a Machine,
    pub shape: &'a Shape,
    pub patch: [Range; 2],
}

/// The tool where it is deepest in a point of the work.
#[derive(Clone, Debug)]
pub struct Deepest {
    pub height: f64,
    pub motions: Vec<f64>,
}

/// A point at which the tool touches the work in passing, with its parameters and motions.
#[derive(Clone, Debug)]
pub struct Touched {
    pub unknowns: Vec<f64>,
    pub position: Vector,
}

impl<'a> Oracle<'a> {
    /// The first part generates along motions with these ranges.
    pub fn new(parts: Vec<Part<'a>>, motions: &[Range]) -> Oracle<'a> {
        let ranges = parts[0].patch.iter().chain(motions).copied().collect();
        let lattice = Lattice::new(motions.to_vec());
        let at = |n: usize| parts.iter().map(|part| part.machine.at(&lattice.at(n))).collect();
        let positions = (0..lattice.len()).map(at).collect();
        Oracle { ranges, parts, lattice, positions }
    }

    fn positions_at(&self, motions: &[f64]) -> Vec<Position> {
        self.parts.iter().map(|part| part.machine.at(motions)).collect()
    }

    /// The height of a point of the work over the steel, where that is known: beside the surface within the ranges of its
    /// parameters, those a share wider, and no deeper than the steel is thick for sure.
    fn height(&self, point: Vector, positions: &[Position], slack: f64) -> Option<f64> {
        let heights =
            self.parts.iter().zip(positions).filter_map(|(part, position)| part.height(point, position, slack));
        heights.reduce(f64::min)
    }

    /// The same of the part that generates alone.
    pub fn own_height(&self, point: Vector, motions: &[f64], slack: f64) -> Option<f64> {
        self.parts[0].height(point, &self.parts[0].machine.at(motions), slack)
    }

    /// Where the tool is deepest in a point; a touch that is known is looked at closely. Nothing if it never passes.
    pub fn deepest(&self, point: Vector, touch: Option<&[f64]>, slack: f64) -> Option<Deepest> {
        self.deepest_of(point, touch, slack, false)
    }

    /// The same, of positions to which the point comes through the tool's surface: what lies behind the surface otherwise may have
    /// come from where the tool's steel has an end that the spec does not tell.
    pub fn deepest_through_surface(&self, point: Vector, touch: &[f64], slack: f64) -> Option<Deepest> {
        self.deepest_of(point, Some(touch), slack, true)
    }

    fn deepest_of(&self, point: Vector, touch: Option<&[f64]>, slack: f64, is_through: bool) -> Option<Deepest> {
        let or_free = |height: Option<f64>| height.unwrap_or(f64::INFINITY);
        let height = |at: &[f64]| or_free(self.height(point, &self.positions_at(at), slack));
        let lattice = &self.lattice;
        let mut near = touch.map_or_else(Vec::new, |touch| around(touch, &lattice.ranges));
        // on the way there the point must see the surface all the time, as between neighbours of the lattice
        let is_seen = |touch: &[f64], to: &[f64]| {
            let between =
                |k: usize| touch.iter().zip(to).map(|(a, b)| a + (b - a) * k as f64 / WAY as f64).collect::<Vec<_>>();
            (1..WAY).all(|k| height(&between(k)).is_finite())
        };
        near.retain(|to| !is_through || touch.is_none_or(|touch| height(to) >= 0.0 || is_seen(touch, to)));
        let tried: Vec<f64> =
            self.positions.iter().map(|positions| or_free(self.height(point, positions, slack))).collect();
        let is_open = if is_through { lattice.beside_the_outside(&tried) } else { vec![true; tried.len()] };
        let is_low = |n: &usize| tried[*n].is_finite() && lattice.neighbours(*n).all(|other| tried[*n] <= tried[other]);
        let mut low: Vec<usize> = (0..tried.len()).filter(|n| is_open[*n]).filter(is_low).collect();
        low.sort_by(|a, b| tried[*a].total_cmp(&tried[*b]));
        let refined = low.into_iter().take(MOST_LOW).map(|n| lattice.descent(&height, n));
        let all = near.into_iter().chain(refined).map(|motions| Deepest { height: height(&motions), motions });
        all.filter(|place| place.height.is_finite()).min_by(|a, b| a.height.total_cmp(&b.height))
    }

    /// How fast the height of a point that the tool generates changes with a motion, mm over the motion's range.
    fn rate(&self, unknowns: &[f64], position: Vector, motion: usize) -> f64 {
        let (part, step) = (&self.parts[0], STEP * self.ranges[2 + motion].width());
        let height = |by: f64| {
            let mut motions = unknowns[2..].to_vec();
            motions[motion] += by;
            let near = [0, 1].map(|k| {
                let wide = self.ranges[k].width();
                Range { low: unknowns[k] - wide, high: unknowns[k] + wide }
            });
            let mut nearest = (f64::INFINITY, f64::NAN);
            part.shape.feet(part.machine.at(&motions).in_tool(position), near, |foot| {
                let off: f64 = (0..2).map(|k| ((foot.at[k] - unknowns[k]) / self.ranges[k].width()).abs()).sum();
                if off < nearest.0 {
                    nearest = (off, foot.height);
                }
            });
            nearest.1
        };
        (8.0 * (height(step) - height(-step)) - (height(2.0 * step) - height(-2.0 * step))) / (12.0 * STEP)
    }

    /// The area that the surface spans at a point it touches, mm², for parameters of the tool that run through their ranges; nothing
    /// where the motions do not follow these, or it is not clear along which of two branches.
    pub fn area(&self, unknowns: &[f64]) -> Option<f64> {
        let [a, b] = [self.tangent(0, unknowns)?, self.tangent(1, unknowns)?];
        let square = dot(a, a) * dot(b, b) - dot(a, b).powi(2);
        Some(square.max(0.0).sqrt())
    }

    /// How the point moves while one parameter of the tool runs through its range, mm. A tenth of the step must stay on one branch, too: how
    /// far another branch is off does not shrink with the step.
    fn tangent(&self, parameter: usize, unknowns: &[f64]) -> Option<Vector> {
        SHARES.into_iter().find_map(|share| {
            self.tangent_by(0.1 * share, parameter, unknowns)?;
            self.tangent_by(share, parameter, unknowns)
        })
    }

    fn tangent_by(&self, share: f64, parameter: usize, unknowns: &[f64]) -> Option<Vector> {
        let to = |share: f64| {
            let mut fixed = vec![(0, unknowns[0]), (1, unknowns[1])];
            fixed[parameter].1 += share * self.ranges[parameter].width();
            self.beside(&fixed, unknowns)
        };
        let [ahead, behind] = [to(share)?, to(-share)?];
        // from another branch, the place between the two is off the point
        let all = ahead.unknowns.iter().zip(&behind.unknowns).zip(unknowns).zip(&self.ranges);
        let bent = all.map(|(((a, b), at), range)| (0.5 * (a + b) - at).abs() / range.width());
        let is_one_branch = bent.fold(0.0, f64::max) < BENT * share;
        is_one_branch.then(|| minus(ahead.position, behind.position).map(|x| x / (2.0 * share)))
    }

    pub fn position(&self, unknowns: &[f64]) -> Vector {
        self.parts[0].machine.at(&unknowns[2..]).in_work(self.parts[0].shape.point([unknowns[0], unknowns[1]]))
    }

    /// The point with other values of some unknowns beside one that is known.
    pub fn beside(&self, fixed: &[(usize, f64)], known: &[f64]) -> Option<Touched> {
        let free: Vec<usize> = (0..self.ranges.len()).filter(|k| fixed.iter().all(|(fixed, _)| fixed != k)).collect();
        let mut unknowns = known.to_vec();
        fixed.iter().for_each(|(k, value)| unknowns[*k] = *value);
        let conditions = |unknowns: &[f64]| -> Vec<f64> {
            let position = self.position(unknowns);
            (0..self.ranges.len() - 2).map(|motion| self.rate(unknowns, position, motion)).collect()
        };
        newton(&conditions, &free, &mut unknowns, &self.ranges)
            .then(|| Touched { position: self.position(&unknowns), unknowns })
    }

    /// The points that the tool touches in passing and that have two coordinates, as many as are found from many starts.
    pub fn touched(&self, target: &dyn Fn(&[f64], Vector) -> [f64; 2], fixed: &[(usize, f64)]) -> Vec<Touched> {
        let free: Vec<usize> = (0..self.ranges.len()).filter(|k| fixed.iter().all(|(fixed, _)| fixed != k)).collect();
        let conditions = |unknowns: &[f64]| -> Vec<f64> {
            let position = self.position(unknowns);
            let rates = (0..self.ranges.len() - 2).map(|motion| self.rate(unknowns, position, motion));
            let mut all: Vec<f64> = rates.collect();
            // coordinates that are unknowns are fixed already
            all.extend(target(unknowns, position).iter().filter(|miss| !miss.is_nan()));
            all
        };
        let mut found: Vec<Touched> = Vec::new();
        for number in 0..STARTS {
            let mut unknowns: Vec<f64> =
                (0..self.ranges.len()).map(|k| self.ranges[k].at(halton(number + 1, [2, 3, 5, 7][k]))).collect();
            fixed.iter().for_each(|(k, value)| unknowns[*k] = *value);
            if newton(&conditions, &free, &mut unknowns, &self.ranges) {
                let position = self.position(&unknowns);
                let is_inside = (0..self.ranges.len()).all(|k| self.ranges[k].wider_by(1e-9).holds(unknowns[k]));
                if is_inside && found.iter().all(|other| distance(other.position, position) > 1e-5) {
                    found.push(Touched { unknowns, position });
                }
            }
        }
        found
    }
}

impl Part<'_> {
    /// The height of a point of the work over this part.
    fn height(&self, point: Vector, position: &Position, slack: f64) -> Option<f64> {
        let patch = self.patch.map(|range| range.wider_by(slack));
        let mut least: Option<f64> = None;
        self.shape.feet(position.in_tool(point), patch, |foot| {
            let is_beside = patch[0].holds(foot.at[0]) && patch[1].holds(foot.at[1]);
            if is_beside && foot.height > -self.shape.thickness() {
                least = Some(least.map_or(foot.height, |so_far| so_far.min(foot.height)));
            }
        });
        least
    }
}
