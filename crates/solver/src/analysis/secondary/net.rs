//! A piece of a tool's surface: cells that are nearly flat, and the foot of a point on it.

use std::sync::Arc;

use flank_expr::{Expr, InstructionSet, LANES, TapeError};
use nalgebra::Vector3;

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
/// A quadratic function that vanishes in the middle of a cell with its slopes is nowhere in the cell more than this many times what it is
/// at the corners and halfway between them.
const BETWEEN: f64 = 1.25;
/// Cells that are looked at together.
const BLOCK: usize = 8;
/// By so little, as a share of where it lies and how large it is, a ball is made larger than its numbers say, so that their rounding
/// leaves no cell out.
const ROUNDED: f64 = 1e-12;
/// Parts that wait to be looked at, at the most: one for each time that as many cells as there are can be halved.
const MOST_WAITING: usize = 32;
/// The foot is found when the next step along the surface is shorter, mm: what it misses then is its square over the radius of
/// curvature.
const STILL: f64 = 1e-7;
const MOST_STEPS: usize = 12;
/// How far beyond its range a parameter is followed to the foot, as a share of the range.
const BEYOND: f64 = 0.05;
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
    cells: Arc<[Cell]>,
    /// The cells in an order in which neighbours are near each other.
    order: Arc<[u32]>,
    /// All of them, halved again and again; a part comes before its halves, the first of which follows it.
    parts: Arc<[Part]>,
    /// The least and the greatest coordinates of its cells.
    hull: [Vector3<f64>; 2],
}

/// A ball that holds some cells.
#[derive(Clone, Copy, Debug)]
struct Ball {
    center: Vector3<f64>,
    radius: f64,
}

/// Some cells, where they stand in the order.
#[derive(Clone, Debug)]
struct Part {
    ball: Ball,
    cells: [u32; 2],
    /// Where its second half stands, if it has halves.
    second: Option<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Cell {
    ball: Ball,
    /// From its middle to the ends of either parameter.
    halves: [Vector3<f64>; 2],
    /// What tells the share of these halves in a vector.
    duals: [Vector3<f64>; 2],
    /// The sine of the angle between the halves. By so much at most a point is nearer to the parallelogram than to the place in it whose
    /// shares are the point's own, cut off at its sides.
    skew: f64,
    /// How far the surface may be from the parallelogram of the halves.
    sagitta: f64,
    at: [f64; 2],
}

/// Position and tangents at a corner of a cell.
#[derive(Clone, Copy)]
struct Corner([Vector3<f64>; 3]);

impl Corner {
    /// The place halfway to the next corner along a parameter, of the cubic through both with their tangents.
    fn halfway(&self, other: &Corner, along: usize, steps: [f64; 2]) -> Vector3<f64> {
        0.5 * (self.0[0] + other.0[0]) + (self.0[1 + along] - other.0[1 + along]) * (0.125 * steps[along])
    }
}

/// The least distance that a point may have from a piece, mm, and the parameters near which.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub(super) least: f64,
    pub(super) at: [f64; 2],
    /// The number of the cell.
    cell: usize,
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
    pub(super) fn new(number: usize, surface: &BoundSurface<'_>) -> Result<Piece, TapeError> {
        let bound = surface.surface();
        let [first, second] = surface.ranges() else { panic!("a piece has two unknowns") };
        let ranges = [*first, *second];
        let parts = [bound.position, bound.normal];
        let slopes = parts.iter().flat_map(|part| bound.unknowns.iter().map(|&p| part.derivative(p)));
        let outputs: Vec<Expr<'_>> = parts.iter().copied().chain(slopes).flat_map(|vector| vector.0).collect();
        let tape = PlaceTape::new(&outputs, &bound.unknowns)?;
        Ok(Piece::of_tape(number, tape, ranges))
    }

    fn of_tape(number: usize, tape: PlaceTape, ranges: [Range; 2]) -> Piece {
        let mut piece = Piece {
            number,
            tape,
            ranges,
            speeds: [0.0; 2],
            steps: [0.0; 2],
            cells: Arc::default(),
            order: Arc::default(),
            parts: Arc::default(),
            hull: [Vector3::zeros(); 2],
        };
        let (cells, steps) = piece.seen().cells();
        let (mut order, mut parts): (Vec<u32>, Vec<Part>) = ((0..cells.len() as u32).collect(), Vec::new());
        divide(&cells, (&mut order, 0), &mut parts);
        let reach = |cell: &Cell| cell.halves[0].abs() + cell.halves[1].abs() + Vector3::repeat(cell.sagitta);
        let low = cells.iter().map(|cell| cell.ball.center - reach(cell)).reduce(|a, b| a.inf(&b));
        let high = cells.iter().map(|cell| cell.ball.center + reach(cell)).reduce(|a, b| a.sup(&b));
        piece.hull = [low, high].map(Option::unwrap_or_default);
        let speed = |k: usize| cells.iter().map(|cell| 2.0 * cell.halves[k].norm() / steps[k]).fold(0.0, f64::max);
        piece.speeds = [0, 1].map(speed);
        (piece.cells, piece.steps) = (cells.into(), steps);
        (piece.order, piece.parts) = (order.into(), parts.into());
        piece
    }

    /// The same with other values of the settings; the net is made anew only if it depends on them.
    pub(super) fn with_settings(&self, values: &[f64]) -> Piece {
        let tape = self.tape.with_settings(values);
        if self.tape.uses_settings() {
            Piece::of_tape(self.number, tape, self.ranges)
        } else {
            let (cells, order, parts) = (self.cells.clone(), self.order.clone(), self.parts.clone());
            Piece { tape, cells, order, parts, ..*self }
        }
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

    /// The cell that a point is nearest to, of several the first; `None` if no cell is within a distance, mm. What another point that is not
    /// far from it is near is looked at first.
    pub(super) fn near(&self, point: &Vector3<f64>, within: f64, other: Option<&Near>) -> Option<Near> {
        let mut best: Option<Near> = None;
        let mut look_at = |number: usize, most: f64| {
            let near = self.cells[number].near(point, self.steps, number);
            let is_nearer = near.least < most || near.least == most && best.is_none_or(|best| number < best.cell);
            best = if is_nearer { Some(near) } else { best };
            if is_nearer { near.least } else { most }
        };
        let mut most = other.map_or(within, |other| look_at(other.cell, within));
        let mut waiting = [(0, 0.0); MOST_WAITING];
        let mut count = usize::from(!self.parts.is_empty());
        while count > 0 {
            count -= 1;
            let (at, least) = waiting[count];
            if least > most {
                continue;
            }
            let Part { cells: [from, to], second, .. } = self.parts[at];
            if let Some(second) = second {
                let mut halves = [at + 1, second as usize].map(|half| (half, self.parts[half].ball.least(point)));
                if halves[0].1 < halves[1].1 {
                    halves.swap(0, 1);
                }
                waiting[count..count + 2].copy_from_slice(&halves);
                count += 2;
                continue;
            }
            for &number in &self.order[from as usize..to as usize] {
                if self.cells[number as usize].ball.least(point) <= most {
                    most = look_at(number as usize, most);
                }
            }
        }
        best
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
        let margins = self.ranges.map(|range| BEYOND * range.width());
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

impl Cell {
    /// As far as it is itself near a point.
    fn near(&self, point: &Vector3<f64>, steps: [f64; 2], number: usize) -> Near {
        let from = point - self.ball.center;
        let share = self.duals.map(|dual| dual.dot(&from).clamp(-1.0, 1.0));
        let apart = (from - self.halves[0] * share[0] - self.halves[1] * share[1]).norm();
        let at = [0, 1].map(|k| self.at[k] + 0.5 * share[k] * steps[k]);
        Near { least: self.skew * apart - self.sagitta, at, cell: number }
    }
}

impl Ball {
    fn around<'c>(cells: impl ExactSizeIterator<Item = &'c Cell> + Clone) -> Ball {
        let count = cells.len() as f64;
        let center = cells.clone().map(|cell| cell.ball.center).sum::<Vector3<f64>>() / count;
        let reach = |cell: &Cell| (cell.ball.center - center).norm() + cell.ball.radius;
        let radius = cells.map(reach).fold(0.0, f64::max);
        Ball { center, radius: radius + ROUNDED * (radius + center.norm()) }
    }

    /// How near a point is to it at the least, negative within it.
    fn least(&self, point: &Vector3<f64>) -> f64 {
        (point - self.center).norm() - self.radius
    }
}

/// Halves some cells, which stand in the order from a place on, across the direction in which they reach farthest, until few are left in
/// each part.
fn divide(cells: &[Cell], (order, from): (&mut [u32], u32), parts: &mut Vec<Part>) {
    if order.is_empty() {
        return;
    }
    let own = order.iter().map(|number| &cells[*number as usize]);
    let (at, count) = (parts.len(), order.len());
    parts.push(Part { ball: Ball::around(own.clone()), cells: [from, from + count as u32], second: None });
    if count <= BLOCK {
        return;
    }
    let centers = || own.clone().map(|cell| cell.ball.center);
    let low = centers().reduce(|a, b| a.inf(&b)).unwrap_or_default();
    let high = centers().reduce(|a, b| a.sup(&b)).unwrap_or_default();
    let along = (high - low).imax();
    let place = |number: u32| cells[number as usize].ball.center[along];
    order.select_nth_unstable_by(count / 2, |a, b| place(*a).total_cmp(&place(*b)).then(a.cmp(b)));
    let (first, second) = order.split_at_mut(count / 2);
    divide(cells, (first, from), parts);
    parts[at].second = Some(parts.len() as u32);
    divide(cells, (second, from + count as u32 / 2), parts);
}

impl Seen<'_> {
    fn run(&mut self, at: [f64; 2]) {
        self.evaluator.run(&at, &mut self.out);
    }

    fn vector(&self, k: usize) -> Vector3<f64> {
        Vector3::new(self.out[3 * k], self.out[3 * k + 1], self.out[3 * k + 2])
    }

    /// How far normal and tangent turn over the range of each parameter where they do so most.
    fn turns(&mut self) -> [f64; 2] {
        let ranges = self.piece.ranges;
        let mut turns = [0.0f64; 2];
        for place in 0..PROBES * PROBES {
            let shares = [place / PROBES, place % PROBES].map(|k| (k as f64 + 0.5) / PROBES as f64);
            let at = [0, 1].map(|k| ranges[k].at(shares[k]));
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

    fn cells(&mut self) -> (Vec<Cell>, [f64; 2]) {
        let ranges = self.piece.ranges;
        let counts = self.turns().map(|turn| ((turn / TURN).ceil() as usize).clamp(1, MOST_CELLS));
        let steps = [0, 1].map(|k| ranges[k].width() / counts[k] as f64);
        let corner = |i: usize, j: usize| [ranges[0].low + i as f64 * steps[0], ranges[1].low + j as f64 * steps[1]];
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
        let center = self.vector(0);
        let halves = [0, 1].map(|k| self.vector(2 + k) * (0.5 * steps[k]));
        let [a, b] = halves;
        let (aa, ab, bb) = (a.norm_squared(), a.dot(&b), b.norm_squared());
        let area = aa * bb - ab * ab;
        let duals = [(a * bb - b * ab) / area, (b * aa - a * ab) / area];
        let [low_low, low_high, high_low, high_high] = &corners;
        let halfway = [
            (low_low.halfway(low_high, 1, steps), -a),
            (high_low.halfway(high_high, 1, steps), a),
            (low_low.halfway(high_low, 0, steps), -b),
            (low_high.halfway(high_high, 0, steps), b),
        ];
        let flat = [-a - b, b - a, a - b, a + b];
        let around = corners.iter().map(|corner| corner.0[0]).zip(flat).chain(halfway);
        let sagitta = BETWEEN * around.map(|(place, flat)| (place - center - flat).norm()).fold(0.0, f64::max);
        let radius = corners.iter().map(|corner| (corner.0[0] - center).norm()).fold(0.0, f64::max) + sagitta;
        let skew = (area / (aa * bb)).sqrt();
        let is_whole = duals.iter().all(|dual| dual.iter().all(|x| x.is_finite())) && radius.is_finite();
        is_whole.then_some(Cell { ball: Ball { center, radius }, halves, duals, skew, sagitta, at })
    }

    /// The foot of a point that Newton finds from a place.
    pub(super) fn foot(&mut self, point: &Vector3<f64>, start: [f64; 2]) -> Found {
        let mut at = start;
        for _ in 0..MOST_STEPS {
            self.run(at);
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
        found
    }
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
        let place = |k: usize| {
            let [u, v] = [ranges[0].at((k % 41) as f64 / 40.0), ranges[1].at((k / 41) as f64 / 40.0)];
            Vector3::new(u + 0.8 * v, v, 0.011 * u * u - 0.033 * v * v + 0.009 * u * v)
        };
        let places: Vec<Vector3<f64>> = (0..41 * 41).map(place).collect();
        for (k, on) in places.iter().enumerate() {
            let point = on + Vector3::new(-7.0, 4.0, 1.5) * (k % 3) as f64;
            let distance = places.iter().map(|place| (place - point).norm()).fold(f64::INFINITY, f64::min);
            let least = piece.near(&point, f64::INFINITY, None).expect("cells").least;
            assert!(least <= distance, "{point}: {least} mm, but {distance} mm");
        }
    }
}
