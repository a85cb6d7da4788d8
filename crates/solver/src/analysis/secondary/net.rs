//! A piece of a tool's surface: cells that are nearly flat, and the foot of a point on it.

use std::sync::Arc;

use flank_expr::{Expr, InstructionSet, LANES, TapeError};
use nalgebra::Vector3;

use crate::analysis::secondary::cells::{Cell, Cells, Corner, Near};
use crate::analysis::secondary::line::MOST_SLIP;
use crate::analysis::secondary::slip::Touch;
use crate::analysis::secondary::tape::PlaceTape;
use crate::equations::runner::Runner;
use crate::equations::solution::{ROUNDING, Range};
use crate::surface::bound::BoundSurface;

/// Normal and tangents turn by no more than this (rad) over a cell: Newton from anywhere in it finds the foot.
const TURN: f64 = 0.4;
/// Places in each direction at which it is looked at how a surface turns.
const PROBES: usize = 7;
/// Most cells in one direction; more of a surface would turn farther in each.
const MOST_CELLS: usize = 192;
/// The foot is found when the next step along the surface is shorter, mm: what it misses then is its square over the radius of
/// curvature.
const STILL: f64 = 1e-7;
const MOST_STEPS: usize = 12;
/// How far beyond its range a parameter is followed to the foot, as a share of the range.
const BEYOND: f64 = 0.05;
/// A piece that slides in itself is followed beyond either end of its range by no more than this many times the range: a short thread with a large
/// lead would have more cells there than on itself.
const MOST_BEYOND: f64 = 2.0;
/// A foot that lies no farther beyond the end of a piece than this, mm, lies on it: ways lead through the very end, above all those of
/// points that the end generates, and rounding must not decide whether the piece is met.
const END: f64 = 1e-7;

/// Outputs: position, normal, and the derivatives of both by either parameter.
const OUTPUTS: usize = 18;

/// A surface of a tool in the tool's frame.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) number: usize,
    tape: PlaceTape,
    ranges: [Range; 2],
    /// How fast it runs with either parameter where it does so most, mm.
    speeds: [f64; 2],
    steps: [f64; 2],
    /// How either parameter runs while the tool slides in itself by an angle.
    slide: [f64; 2],
    cells: Arc<Cells>,
    /// The least and the greatest coordinates of its cells.
    hull: [Vector3<f64>; 2],
}

/// The foot of a point on a piece, or on what lies a little beyond its ranges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub(super) at: [f64; 2],
    /// From the surface to the point, along the normal: negative behind the surface, in the steel.
    pub(super) clearance: f64,
    pub(super) normal: Vector3<f64>,
}

impl Foot {
    /// How fast the clearance of a point grows that moves so.
    pub(super) fn rate(&self, velocity: Vector3<f64>) -> f64 {
        self.normal.dot(&velocity)
    }
}

/// What Newton finds from a place on a piece.
#[derive(Clone, Copy, Debug)]
pub(super) enum Found {
    Foot(Foot),
    /// Beyond an end of a range, or of both.
    Beyond(Side),
    /// Nothing.
    Lost,
}

/// Beyond which end of the range of each parameter a place lies: -1, 1, or 0 within it.
pub(super) type Side = [i8; 2];

/// Something that evaluates a piece.
pub(super) struct Seen<'p> {
    pub(super) piece: &'p Piece,
    evaluator: Runner<'p>,
    out: [f64; OUTPUTS],
}

impl Piece {
    /// Without its net.
    pub(super) fn new(number: usize, surface: &BoundSurface<'_>) -> Result<Piece, TapeError> {
        let bound = surface.surface();
        let [first, second] = surface.ranges() else { panic!("a piece has two unknowns") };
        let ranges = [*first, *second];
        let parts = [bound.position, bound.normal];
        let slopes = parts.iter().flat_map(|part| bound.unknowns.iter().map(|&p| part.derivative(p)));
        let outputs: Vec<Expr<'_>> = parts.iter().copied().chain(slopes).flat_map(|vector| vector.0).collect();
        Ok(Piece::of_tape(number, PlaceTape::new(&outputs, &bound.unknowns)?, ranges))
    }

    fn of_tape(number: usize, tape: PlaceTape, ranges: [Range; 2]) -> Piece {
        let (cells, hull) = (Arc::default(), [Vector3::zeros(); 2]);
        Piece { number, tape, ranges, speeds: [0.0; 2], steps: [0.0; 2], slide: [0.0; 2], cells, hull }
    }

    /// With its net, for a tool that slides in itself.
    pub(super) fn netted(mut self, slide: [f64; 2]) -> Piece {
        self.slide = slide;
        let (cells, steps) = self.seen().cells();
        let hull = cells.iter().map(Cell::hull).reduce(|a, b| [a[0].inf(&b[0]), a[1].sup(&b[1])]);
        let speed = |k: usize| cells.iter().map(|cell| 2.0 * cell.halves[k].norm() / steps[k]).fold(0.0, f64::max);
        Piece {
            speeds: [0, 1].map(speed),
            steps,
            cells: Arc::new(Cells::new(&cells)),
            hull: hull.unwrap_or_default(),
            ..self
        }
    }

    pub(super) fn uses_settings(&self) -> bool {
        self.tape.uses_settings()
    }

    /// The same with other values of the settings, without its net.
    pub(super) fn with_settings(&self, values: &[f64]) -> Piece {
        Piece::of_tape(self.number, self.tape.with_settings(values), self.ranges)
    }

    /// A place on the piece after it slid in itself by an angle.
    pub(super) fn slid(&self, at: [f64; 2], by: f64) -> [f64; 2] {
        [0, 1].map(|k| at[k] + by * self.slide[k])
    }

    /// Whether the piece is long enough to be followed beyond its ends as far as it would slide.
    pub(super) fn may_slide(&self, slide: [f64; 2]) -> bool {
        (0..2).all(|k| slide[k].abs() * MOST_SLIP <= MOST_BEYOND * self.ranges[k].width())
    }

    /// How far beyond either end of a range the piece is followed.
    fn reach(&self) -> [f64; 2] {
        self.slide.map(|slide| slide.abs() * MOST_SLIP)
    }

    pub(super) fn translate(&self) {
        self.tape.translate();
    }

    pub(super) fn seen(&self) -> Seen<'_> {
        Seen { piece: self, evaluator: self.tape.runner(), out: [0.0; OUTPUTS] }
    }

    /// No part of the piece is nearer to a point than this, mm.
    pub(super) fn least(&self, point: &Vector3<f64>) -> f64 {
        let [low, high] = &self.hull;
        (low - point).sup(&(point - high)).sup(&Vector3::zeros()).norm()
    }

    /// The cell that a point is nearest to, of several the first; `None` if no cell is within a distance, mm. Where other points were near
    /// that are not far from it is looked at first.
    #[inline(always)]
    pub(super) fn near(&self, point: &Vector3<f64>, within: f64, others: [Option<&Near>; 2]) -> Option<Near> {
        self.cells.nearest([point.x, point.y, point.z], within, others, self.steps)
    }

    /// Whether two places on the piece are no farther apart than neighbouring cells.
    pub(super) fn are_beside(&self, a: [f64; 2], b: [f64; 2]) -> bool {
        (0..2).all(|k| (a[k] - b[k]).abs() <= 2.0 * self.steps[k])
    }

    /// What is found with a step from a place, if it is the last one.
    #[inline]
    fn ended(&self, at: [f64; 2], step: &Step, normal: impl FnOnce() -> Vector3<f64>) -> Option<Found> {
        if step.along < STILL {
            return Some(Found::Foot(Foot { at: step.to, clearance: step.clearance, normal: normal() }));
        }
        if step.along.is_nan() {
            return Some(Found::Lost);
        }
        let reach = self.reach();
        let margins = [0, 1].map(|k| BEYOND * self.ranges[k].width() + reach[k]);
        let after = self.beyond(step.to, margins);
        (after != [0, 0] && self.beyond(at, margins) != [0, 0]).then_some(Found::Beyond(after))
    }

    /// On which side of the piece a place lies that Newton has found; both zero on the piece.
    pub(super) fn side(&self, at: [f64; 2]) -> Side {
        self.beyond(at, [0, 1].map(|k| (ROUNDING * self.ranges[k].width()).max(END / self.speeds[k])))
    }

    /// How far a place may lie beyond the ends of the piece, mm.
    pub(super) fn past(&self, at: [f64; 2]) -> f64 {
        (0..2).map(|k| self.speeds[k] * self.ranges[k].excess(at[k])).fold(0.0, f64::max)
    }

    /// The same with ranges that are wider by so much at either end.
    fn beyond(&self, at: [f64; 2], margins: [f64; 2]) -> Side {
        [0, 1].map(|k| {
            let (range, margin) = (self.ranges[k], margins[k]);
            i8::from(at[k] > range.high + margin) - i8::from(at[k] < range.low - margin)
        })
    }
}

impl Seen<'_> {
    fn run(&mut self, at: [f64; 2]) {
        self.evaluator.run(&at, &mut self.out);
    }

    /// The same, also at a place beyond a range where the surface has no value, as beyond the ends of a spline: there it goes on along
    /// its tangents at the end.
    fn run_on(&mut self, at: [f64; 2]) {
        self.run(at);
        if !self.out.iter().any(|value| value.is_nan()) {
            return;
        }
        let end = [0, 1].map(|k| at[k].clamp(self.piece.ranges[k].low, self.piece.ranges[k].high));
        self.run(end);
        let past = [0, 1].map(|k| at[k] - end[k]);
        for k in 0..3 {
            self.out[k] += past[0] * self.out[6 + k] + past[1] * self.out[9 + k];
        }
    }

    fn vector(&self, k: usize) -> Vector3<f64> {
        Vector3::new(self.out[3 * k], self.out[3 * k + 1], self.out[3 * k + 2])
    }

    /// How far normal and tangent turn over the range of each parameter where they do so most.
    fn turns(&mut self) -> [f64; 2] {
        let ranges = self.piece.ranges;
        let mut turns = [0.0f64; 2];
        for place in 0..PROBES * PROBES {
            let at = [0, 1].map(|k| ranges[k].at(probe(place)[k]));
            self.run(at);
            let tangents = [2, 3].map(|k| self.vector(k).normalize());
            for k in 0..2 {
                let by = 1e-4;
                let mut beside = at;
                beside[k] += by * ranges[k].width();
                self.run(beside);
                let turned = (self.vector(2 + k).normalize() - tangents[k]).norm() / by;
                let normal = self.vector(4 + k).norm() * ranges[k].width();
                turns[k] = turns[k].max(turned).max(normal);
            }
        }
        turns
    }

    /// Some places of the piece.
    pub(super) fn touches(&mut self) -> Vec<Touch> {
        let ranges = self.piece.ranges;
        let touch = |place: usize| {
            self.run([0, 1].map(|k| ranges[k].at(probe(place)[k])));
            Touch { point: self.vector(0), normal: self.vector(1), slopes: [self.vector(2), self.vector(3)] }
        };
        (0..PROBES * PROBES).map(touch).collect()
    }

    fn cells(&mut self) -> (Vec<Cell>, [f64; 2]) {
        let (ranges, reach) = (self.piece.ranges, self.piece.reach());
        let counts = self.turns().map(|turn| ((turn / TURN).ceil() as usize).clamp(1, MOST_CELLS));
        let steps = [0, 1].map(|k| ranges[k].width() / counts[k] as f64);
        let before = [0, 1].map(|k| (reach[k] / steps[k]).ceil());
        let counts = [0, 1].map(|k| counts[k] + 2 * before[k] as usize);
        let low = [0, 1].map(|k| ranges[k].low - before[k] * steps[k]);
        let corner = |i: usize, j: usize| [low[0] + i as f64 * steps[0], low[1] + j as f64 * steps[1]];
        let mut corners = Vec::new();
        for i in 0..=counts[0] {
            for j in 0..=counts[1] {
                self.run(corner(i, j));
                corners.push(Corner([0, 2, 3].map(|k| self.vector(k))));
            }
        }
        let mut cells = Vec::new();
        for i in 0..counts[0] {
            for j in 0..counts[1] {
                let at = [0, 1].map(|k| corner(i, j)[k] + 0.5 * steps[k]);
                let around = [(0, 0), (0, 1), (1, 0), (1, 1)];
                let corner = |(a, b): (usize, usize)| corners[(i + a) * (counts[1] + 1) + j + b];
                cells.extend(self.cell(at, steps, around.map(corner)));
            }
        }
        (cells, steps)
    }

    /// A cell from its middle and its corners; nothing where the surface has no place or normal.
    fn cell(&mut self, at: [f64; 2], steps: [f64; 2], corners: [Corner; 4]) -> Option<Cell> {
        self.run(at);
        Cell::new(at, Corner([0, 2, 3].map(|k| self.vector(k))), corners, steps)
    }

    /// The foot of a point that Newton finds from a place.
    pub(super) fn foot(&mut self, point: &Vector3<f64>, start: [f64; 2]) -> Found {
        let mut at = start;
        for _ in 0..MOST_STEPS {
            self.run_on(at);
            let step = Step::new([point.x, point.y, point.z], at, self.piece.steps, |k| self.out[k]);
            if let Some(found) = self.piece.ended(at, &step, || self.vector(1)) {
                return found;
            }
            at = step.to;
        }
        Found::Lost
    }

    /// The same for many points, each with its place.
    pub(super) fn feet(&mut self, wanted: &[(Vector3<f64>, [f64; 2])]) -> Vec<Found> {
        let piece = self.piece;
        let Some(evaluator) = self.evaluator.lanes() else {
            return wanted.iter().map(|(point, start)| self.foot(point, *start)).collect();
        };
        let mut found = vec![Found::Lost; wanted.len()];
        let mut open: Vec<Open> = (0..wanted.len().min(LANES)).map(|number| Open { number, steps: 0 }).collect();
        let mut next = open.len();
        let mut points = [[0.0; LANES]; 3];
        let mut at = [[0.0; LANES]; 2];
        let mut steps = Steps::default();
        // those whose way left the places where the surface has a value
        let mut left = Vec::new();
        let put = |points: &mut [[f64; LANES]; 3], at: &mut [[f64; LANES]; 2], lane: usize, number: usize| {
            let (point, start) = &wanted[number];
            (0..3).for_each(|k| points[k][lane] = point[k]);
            (at[0][lane], at[1][lane]) = (start[0], start[1]);
        };
        (0..next).for_each(|lane| put(&mut points, &mut at, lane, lane));
        while !open.is_empty() {
            let count = open.len();
            (0..2).for_each(|k| *evaluator.input(k) = at[k]);
            evaluator.run_first(count);
            let outputs: [&[f64; LANES]; OUTPUTS] = std::array::from_fn(|k| evaluator.output(k));
            InstructionSet::widest().dispatch(
                #[inline(always)]
                || steps_of(count, (&points, &at), piece.steps, &outputs, &mut steps),
            );
            let mut kept = 0;
            for lane in 0..count {
                let Open { number, steps: before } = open[lane];
                let (step, own) = (steps.of(lane), [at[0][lane], at[1][lane]]);
                let normal = || Vector3::new(outputs[3][lane], outputs[4][lane], outputs[5][lane]);
                match piece.ended(own, &step, normal) {
                    None if before + 1 < MOST_STEPS => {
                        open[kept] = Open { number, steps: before + 1 };
                        (0..3).for_each(|k| points[k][kept] = points[k][lane]);
                        (at[0][kept], at[1][kept]) = (step.to[0], step.to[1]);
                        kept += 1;
                    }
                    ended => {
                        if step.along.is_nan() {
                            left.push(number);
                        }
                        found[number] = ended.unwrap_or(Found::Lost);
                        if next < wanted.len() {
                            open[kept] = Open { number: next, steps: 0 };
                            put(&mut points, &mut at, kept, next);
                            (kept, next) = (kept + 1, next + 1);
                        }
                    }
                }
            }
            open.truncate(kept);
        }
        for number in left {
            let (point, start) = wanted[number];
            found[number] = self.foot(&point, start);
        }
        found
    }
}

/// The shares of both ranges at which one of the probes is.
fn probe(number: usize) -> [f64; 2] {
    [number / PROBES, number % PROBES].map(|k| (k as f64 + 0.5) / PROBES as f64)
}

/// A foot that is looked for.
#[derive(Clone, Copy)]
struct Open {
    number: usize,
    /// Steps so far.
    steps: usize,
}

/// A step of Newton towards a foot.
#[derive(Clone, Copy)]
struct Step {
    /// Where it leads.
    to: [f64; 2],
    /// Its length along the surface, had it not been shortened.
    along: f64,
    clearance: f64,
}

impl Step {
    /// For a point, from a place at which the tape of a piece with such cells has these outputs.
    #[inline(always)]
    fn new([x, y, z]: [f64; 3], at: [f64; 2], cells: [f64; 2], out: impl Fn(usize) -> f64) -> Step {
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (normal, u, v) = ([out(3), out(4), out(5)], [out(6), out(7), out(8)], [out(9), out(10), out(11)]);
        let (normal_u, normal_v) = ([out(12), out(13), out(14)], [out(15), out(16), out(17)]);
        let from = [x - out(0), y - out(1), z - out(2)];
        let clearance = dot(from, normal);
        let (along_u, along_v) = (dot(from, u), dot(from, v));
        let (uu, uv, vv) = (dot(u, u), dot(u, v), dot(v, v));
        let curved_uu = uu + clearance * dot(u, normal_u);
        let curved_uv = uv + clearance * dot(u, normal_v);
        let curved_vv = vv + clearance * dot(v, normal_v);
        let is_least = (curved_uu > 0.0) & (curved_uu * curved_vv > curved_uv * curved_uv);
        let a = if is_least { curved_uu } else { uu };
        let b = if is_least { curved_uv } else { uv };
        let c = if is_least { curved_vv } else { vv };
        let area = a * c - b * b;
        let by_u = (c * along_u - b * along_v) / area;
        let by_v = (a * along_v - b * along_u) / area;
        let moved = [u[0] * by_u + v[0] * by_v, u[1] * by_u + v[1] * by_v, u[2] * by_u + v[2] * by_v];
        let shorter = (2.0 * cells[0] / by_u.abs()).min(1.0).min(2.0 * cells[1] / by_v.abs());
        let to = [at[0] + shorter * by_u, at[1] + shorter * by_v];
        Step { to, along: dot(moved, moved).sqrt(), clearance }
    }
}

/// The steps of all lanes, number by number, so that vectors of them are computed at once.
#[derive(Default)]
struct Steps {
    to: [[f64; LANES]; 2],
    along: [f64; LANES],
    clearance: [f64; LANES],
}

impl Steps {
    fn of(&self, lane: usize) -> Step {
        let to = [self.to[0][lane], self.to[1][lane]];
        Step { to, along: self.along[lane], clearance: self.clearance[lane] }
    }
}

/// Of the first lanes, `count` of them at least, each with its point and its place.
#[inline(always)]
fn steps_of(
    count: usize,
    (points, at): (&[[f64; LANES]; 3], &[[f64; LANES]; 2]),
    cells: [f64; 2],
    outputs: &[&[f64; LANES]; OUTPUTS],
    steps: &mut Steps,
) {
    // whole vectors of any width
    for lane in 0..count.next_multiple_of(8).min(LANES) {
        let point = [points[0][lane], points[1][lane], points[2][lane]];
        let step = Step::new(point, [at[0][lane], at[1][lane]], cells, |k| outputs[k][lane]);
        (steps.to[0][lane], steps.to[1][lane]) = (step.to[0], step.to[1]);
        (steps.along[lane], steps.clearance[lane]) = (step.along, step.clearance);
    }
}

#[cfg(test)]
mod tests {
    use flank_expr::Graph;
    use flank_expr::geometry;

    use super::*;

    /// A thread of a tenth of a degree would be followed over a thousand times its length.
    #[test]
    fn a_short_thread_is_not_followed_beyond_its_ends() {
        let graph = Graph::new();
        let unknowns = ["u", "theta"].map(|name| graph.variable(name));
        let [u, theta] = unknowns;
        let position = geometry::Vector3([u * theta.cos(), u * theta.sin(), u * 0.3 + theta * 5.0]);
        let surface = geometry::Surface::parametric(unknowns, position, false);
        for (turn, may_slide) in [(4.0, true), (0.002, false)] {
            let ranges = [Range { low: 20.0, high: 25.0 }, Range { low: 0.0, high: turn }];
            let piece = Piece::new(0, &BoundSurface::new(&surface, ranges.to_vec(), &[])).expect("nothing is unbound");
            assert_eq!(piece.may_slide([0.0, 1.0]), may_slide);
        }
    }

    /// A saddle bends up one way and down the other; its parameters run askew.
    #[test]
    fn no_part_of_a_piece_is_nearer_than_told() {
        let graph = Graph::new();
        let unknowns = ["u", "v"].map(|name| graph.variable(name));
        let [u, v] = unknowns;
        let height = u * u * 0.011 - v * v * 0.033 + u * v * 0.009;
        let position = geometry::Vector3([u + v * 0.8, v, height]);
        let surface = geometry::Surface::parametric(unknowns, position, false);
        let ranges = [Range { low: -10.0, high: 10.0 }, Range { low: -12.0, high: 12.0 }];
        let piece = Piece::new(0, &BoundSurface::new(&surface, ranges.to_vec(), &[])).expect("nothing is unbound");
        let piece = piece.netted([0.0; 2]);
        let place = |k: usize| {
            let [u, v] = [ranges[0].at((k % 41) as f64 / 40.0), ranges[1].at((k / 41) as f64 / 40.0)];
            Vector3::new(u + 0.8 * v, v, 0.011 * u * u - 0.033 * v * v + 0.009 * u * v)
        };
        let places: Vec<Vector3<f64>> = (0..41 * 41).map(place).collect();
        for (k, on) in places.iter().enumerate() {
            let point = on + Vector3::new(-7.0, 4.0, 1.5) * (k % 3) as f64;
            let distance = places.iter().map(|place| (place - point).norm()).fold(f64::INFINITY, f64::min);
            let least = piece.near(&point, f64::INFINITY, [None; 2]).expect("cells").least;
            assert!(least <= distance, "{point}: {least} mm, but {distance} mm");
        }
    }
}
