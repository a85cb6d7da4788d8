//! The points of a grid as they become known, in the order in which lanes work on them.
//!
//! Points stand in blocks of [`LANES`] points of a line, a row or a column of the grid. A block holds one number of each lane after
//! the other, so that what is done for a block is done to whole vectors. The blocks of the same lanes, line by line, make
//! a strip; a line follows from the lines around it.

#![allow(clippy::needless_range_loop)] // several arrays are gone through in step

mod along;
mod expected;
mod numbers;
mod strip;

use std::ops;

use flank_expr::LANES;

use crate::continuation::line::levels;
use crate::equations::solution::{CutBy, Outcome, Range, Solution, verdict};
use crate::equations::tolerance::VITAL;
use crate::newton::batch::{LaneNewton, Lanes};

pub(crate) use along::Along;
use numbers::Numbers;
pub(crate) use strip::Strip;

/// Around a point the Jacobian has an inverse if its determinants there differ by less than this factor.
pub(crate) const SAME_DETERMINANT: f64 = 4.0;

/// Blocks that are looked at before it is decided whether one of them needs a closer look.
const AT_ONCE: usize = 16;

/// What is known of a point: its outcome, without what follows from its unknowns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Mark {
    /// Nothing has come near.
    #[default]
    Unknown,
    Solved,
    /// Solved, with a determinant that is a number.
    Plain,
    CutByItsTool,
    Outside,
    NotKept,
    Singular,
    NotConverged,
    Ambiguous,
}

impl Mark {
    fn is_root(self) -> bool {
        matches!(self, Mark::Solved | Mark::Plain | Mark::CutByItsTool | Mark::Outside | Mark::NotKept)
    }

    fn is_solved(self) -> bool {
        matches!(self, Mark::Solved | Mark::Plain)
    }

    fn of_outcome(outcome: Outcome) -> Mark {
        match outcome {
            Outcome::Solved => Mark::Solved,
            Outcome::CutAway(_) | Outcome::Undecided => Mark::CutByItsTool,
            Outcome::Outside { .. } => Mark::Outside,
            Outcome::NotKept { .. } => Mark::NotKept,
            Outcome::Singular => Mark::Singular,
            Outcome::NotConverged { .. } => Mark::NotConverged,
            Outcome::Ambiguous => Mark::Ambiguous,
        }
    }
}

/// What the lines of a field are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lines {
    Rows,
    Columns,
}

/// How a field is divided.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    lines: Lines,
    /// Columns of the grid.
    columns: usize,
    /// Number of lines, and of points on each.
    count: usize,
    length: usize,
    /// Unknowns of a point.
    size: usize,
    /// Numbers of a point: unknowns, the scaled determinant of the Jacobian (NaN where it is not known), the largest residual,
    /// and what else is wanted.
    planes: usize,
}

impl Shape {
    fn new(lines: Lines, [rows, columns]: [usize; 2], size: usize, planes: usize) -> Shape {
        let [count, length] = if lines == Lines::Rows { [rows, columns] } else { [columns, rows] };
        Shape { lines, columns, count, length, size, planes }
    }

    fn blocks(&self) -> usize {
        self.count * self.length.div_ceil(LANES)
    }

    /// Number in the grid of a point of a line.
    pub(crate) fn point(&self, line: usize, at: usize) -> usize {
        if self.lines == Lines::Rows { line * self.columns + at } else { at * self.columns + line }
    }

    /// Whether points of a line stand beside each other in the grid, too.
    fn lanes_are_beside(&self) -> bool {
        self.lines == Lines::Rows
    }

    /// Block and lane of a point.
    fn place(&self, point: usize) -> (usize, usize) {
        let (i, j) = (point / self.columns, point % self.columns);
        let (line, at) = if self.lines == Lines::Rows { (i, j) } else { (j, i) };
        self.place_on(line, at)
    }

    /// Block and lane of a point of a line.
    fn place_on(&self, line: usize, at: usize) -> (usize, usize) {
        ((at / LANES) * self.count + line, at % LANES)
    }
}

/// Solutions of a grid.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    shape: Shape,
    ranges: Vec<Range>,
    values: Numbers,
    marks: Vec<[Mark; LANES]>,
    /// Points by the careful path, which does not compute what else is wanted.
    loose: Vec<usize>,
    /// Of a field that is not needed any more.
    memory: Option<Box<Field>>,
}

impl Field {
    /// Nothing known of `counts` rows and columns, with room for `extras` further numbers a point; in the memory of another
    /// field if there is one.
    pub(crate) fn new(ranges: &[Range], counts: [usize; 2], extras: usize, memory: Option<Field>) -> Field {
        Field::shaped(Shape::new(Lines::Rows, counts, ranges.len(), ranges.len() + 2 + extras), ranges, memory)
    }

    fn shaped(shape: Shape, ranges: &[Range], memory: Option<Field>) -> Field {
        let (values, marks, memory) =
            memory.map_or_else(Default::default, |field| (field.values, field.marks, field.memory));
        let mut field = Field { shape, ranges: ranges.to_vec(), values, marks, loose: Vec::new(), memory };
        field.clear();
        field
    }

    fn clear(&mut self) {
        // what is not marked is not read
        self.values.set_len(self.shape.blocks() * self.shape.planes * LANES);
        self.marks.clear();
        self.marks.resize(self.shape.blocks(), [Mark::Unknown; LANES]);
    }

    /// Divides it into other lines; of all that is known, only the given points stay so.
    pub(crate) fn divide(&mut self, lines: Lines, points: &[usize]) {
        let Shape { count, length, size, planes, .. } = self.shape;
        if self.shape.lines == lines {
            return;
        }
        let known: Vec<(usize, Mark, Vec<f64>)> = points
            .iter()
            .map(|&point| (point, self.mark(point), (0..planes).map(|plane| self.value(point, plane)).collect()))
            .collect();
        let counts = if lines == Lines::Rows { [length, count] } else { [count, length] };
        self.shape = Shape::new(lines, counts, size, planes);
        self.clear();
        for (point, mark, values) in known {
            let (block, lane) = self.shape.place(point);
            self.marks[block][lane] = mark;
            values.into_iter().enumerate().for_each(|(plane, value)| self.set(point, plane, value));
        }
    }

    /// Takes over all that another field of the same kind knows of a point.
    pub(crate) fn copy(&mut self, point: usize, from: &Field, other: usize) {
        self.copy_place(self.shape.place(point), from, from.shape.place(other));
    }

    fn copy_place(&mut self, (block, lane): (usize, usize), from: &Field, (other, column): (usize, usize)) {
        let planes = self.shape.planes;
        let numbers = &from.values.as_chunks::<LANES>().0[other * planes..][..planes];
        let to = &mut self.values.as_chunks_mut::<LANES>().0[block * planes..][..planes];
        to.iter_mut().zip(numbers).for_each(|(to, numbers)| to[lane] = numbers[column]);
        self.marks[block][lane] = from.marks[other][column];
    }

    /// Number of points.
    pub(crate) fn len(&self) -> usize {
        self.shape.count * self.shape.length
    }

    pub(crate) fn value(&self, point: usize, plane: usize) -> f64 {
        self.value_in(self.shape.place(point), plane)
    }

    fn value_in(&self, (block, lane): (usize, usize), plane: usize) -> f64 {
        self.values[(block * self.shape.planes + plane) * LANES + lane]
    }

    fn set(&mut self, point: usize, plane: usize, value: f64) {
        let (block, lane) = self.shape.place(point);
        self.values[(block * self.shape.planes + plane) * LANES + lane] = value;
    }

    fn mark(&self, point: usize) -> Mark {
        let (block, lane) = self.shape.place(point);
        self.marks[block][lane]
    }

    pub(crate) fn unknowns(&self, point: usize) -> impl Iterator<Item = f64> {
        let place = self.shape.place(point);
        (0..self.shape.size).map(move |k| self.value_in(place, k))
    }

    /// The verdict; none where nothing has come near.
    pub(crate) fn outcome(&self, point: usize) -> Option<Outcome> {
        match self.mark(point) {
            Mark::Unknown => None,
            Mark::Solved | Mark::Plain => Some(Outcome::Solved),
            Mark::CutByItsTool => Some(Outcome::CutAway(CutBy::ItsTool)),
            Mark::Outside => Some(verdict(&self.unknowns(point).collect::<Vec<_>>(), &self.ranges, true, false)),
            // the number of the condition takes the place of the determinant
            Mark::NotKept => Some(Outcome::NotKept { condition: self.determinant(point) as usize }),
            Mark::Singular => Some(Outcome::Singular),
            Mark::NotConverged => Some(Outcome::NotConverged { iterations: self.determinant(point) as u32 }),
            Mark::Ambiguous => Some(Outcome::Ambiguous),
        }
    }

    pub(crate) fn residual(&self, point: usize) -> f64 {
        if self.mark(point) == Mark::Unknown { f64::NAN } else { self.value(point, self.shape.size + 1) }
    }

    /// What else is wanted of a point; NaN where there is none.
    pub(crate) fn extra(&self, point: usize, k: usize) -> f64 {
        let plane = self.shape.size + 2 + k;
        if self.mark(point) == Mark::Unknown || plane >= self.shape.planes {
            f64::NAN
        } else {
            self.value(point, plane)
        }
    }

    pub(crate) fn is_root(&self, point: usize) -> bool {
        self.mark(point).is_root()
    }

    pub(crate) fn is_solved(&self, point: usize) -> bool {
        self.mark(point).is_solved()
    }

    /// Changes the verdict on a root, and nothing else.
    pub(crate) fn judge(&mut self, point: usize, outcome: Outcome) {
        let (block, lane) = self.shape.place(point);
        self.marks[block][lane] = Mark::of_outcome(outcome);
        if let Outcome::NotKept { condition } = outcome {
            self.set_determinant(point, condition as f64);
        }
    }

    /// Other values of the unknowns that mean the same.
    pub(crate) fn turn(&mut self, point: usize, unknowns: &[f64]) {
        unknowns.iter().enumerate().for_each(|(k, value)| self.set(point, k, *value));
    }

    pub(crate) fn is_outside(&self, point: usize) -> bool {
        self.mark(point) == Mark::Outside
    }

    /// Whether a point lies outside the ranges.
    pub(crate) fn has_outside(&self) -> bool {
        self.count(|mark| mark == Mark::Outside) > 0
    }

    /// Whether its points were looked for in other ranges than these.
    pub(crate) fn is_of_others(&self, ranges: &[Range]) -> bool {
        self.ranges != ranges
    }

    /// The ranges that its points were looked for in.
    pub(crate) fn ranges(&self) -> &[Range] {
        &self.ranges
    }

    /// What is outside is told by these ranges from now on.
    pub(crate) fn judge_by(&mut self, ranges: &[Range]) {
        self.ranges.clear();
        self.ranges.extend_from_slice(ranges);
    }

    /// Number of solved points.
    pub(crate) fn solved(&self) -> usize {
        self.count(Mark::is_solved)
    }

    /// Whether nothing is left to look for.
    pub(crate) fn is_complete(&self) -> bool {
        self.count(Mark::is_root) == self.len()
    }

    /// Whether all of some points are roots.
    pub(crate) fn are_roots(&self, mut points: ops::Range<usize>) -> bool {
        if points == (0..self.len()) { self.is_complete() } else { points.all(|point| self.is_root(point)) }
    }

    /// Those of some points at which no determinant is known; points of which nothing is known may be among them.
    pub(crate) fn without_determinant(&self, points: ops::Range<usize>) -> Vec<usize> {
        let Shape { count, length, size, planes, .. } = self.shape;
        let blocks = self.values.as_chunks::<LANES>().0;
        let lacks_any =
            |values: &[Lanes]| values[size].iter().fold(false, |any, determinant| any | determinant.is_nan());
        let mut found = Vec::new();
        // some blocks without a decision between them, so that one is on its way from memory while another is looked at
        for (k, some) in blocks.chunks(AT_ONCE * planes).enumerate() {
            let marks = self.marks[k * AT_ONCE..][..some.len() / planes].as_flattened();
            let are_plain = marks.iter().fold(true, |all, mark| all & (*mark == Mark::Plain));
            if are_plain || !some.chunks_exact(planes).fold(false, |any, values| any | lacks_any(values)) {
                continue;
            }
            for (block, values) in (k * AT_ONCE..).zip(some.chunks_exact(planes)) {
                let (line, first) = (block % count, block / count * LANES);
                let lanes = (0..LANES.min(length - first)).filter(|lane| values[size][*lane].is_nan());
                let among =
                    lanes.map(|lane| self.shape.point(line, first + lane)).filter(|point| points.contains(point));
                found.extend(among);
            }
        }
        found
    }

    fn count(&self, is_meant: impl Fn(Mark) -> bool) -> usize {
        // as many as fit into a byte, which is vectors
        let of = |marks: &[Mark]| marks.iter().fold(0u8, |count, mark| count.wrapping_add(u8::from(is_meant(*mark))));
        self.marks.as_flattened().chunks(usize::from(u8::MAX)).map(|marks| usize::from(of(marks))).sum()
    }

    /// A point by the careful path.
    pub(crate) fn put(&mut self, point: usize, solution: &Solution) {
        for (k, value) in solution.unknowns.iter().enumerate() {
            self.set(point, k, *value);
        }
        let determinant = match solution.outcome {
            // where there is no root, the number of iterations takes the place
            Outcome::NotConverged { iterations } => f64::from(iterations),
            Outcome::NotKept { condition } => condition as f64,
            _ => f64::NAN,
        };
        self.set(point, self.shape.size, determinant);
        self.set(point, self.shape.size + 1, solution.residual);
        let (block, lane) = self.shape.place(point);
        self.marks[block][lane] = Mark::of_outcome(solution.outcome);
        self.loose.push(point);
    }

    /// A point at which nothing else is wanted.
    pub(crate) fn put_alone(&mut self, point: usize, solution: &Solution) {
        self.put(point, solution);
        self.loose.pop();
        (self.shape.size + 2..self.shape.planes).for_each(|plane| self.set(point, plane, f64::NAN));
    }

    /// Nothing is known of a point any more.
    pub(crate) fn forget(&mut self, point: usize) {
        let (block, lane) = self.shape.place(point);
        self.marks[block][lane] = Mark::Unknown;
    }

    pub(crate) fn determinant(&self, point: usize) -> f64 {
        self.value(point, self.shape.size)
    }

    pub(crate) fn set_determinant(&mut self, point: usize, determinant: f64) {
        self.set(point, self.shape.size, determinant);
    }

    pub(crate) fn solution(&self, point: usize) -> Option<Solution> {
        Some(Solution {
            outcome: self.outcome(point)?,
            unknowns: self.unknowns(point).collect(),
            residual: self.residual(point),
            iterations: 0,
        })
    }

    /// Takes what a lane has come to, if that is clear.
    pub(crate) fn take(&mut self, point: usize, newton: &mut LaneNewton<'_>, lane: usize) {
        let (block, column) = self.shape.place(point);
        let values = block_of(self.shape, &mut self.values, block);
        take(self.shape, values, &mut self.marks[block], column, newton, lane);
    }

    /// What else is wanted of the points that came by the careful path: where it is no number, a root is no point that is solved.
    pub(crate) fn place_loose(&mut self, newton: &mut LaneNewton<'_>) {
        let extras = self.shape.planes - self.shape.size - 2;
        let loose = std::mem::take(&mut self.loose);
        for block in loose.chunks(LANES).filter(|_| extras > 0) {
            for k in 0..self.shape.size {
                for (lane, point) in block.iter().enumerate() {
                    newton.input(k)[lane] = self.value(*point, k);
                }
            }
            newton.place(block.len());
            for k in 0..extras {
                for (lane, point) in block.iter().enumerate() {
                    let value = newton.extra(k)[lane];
                    self.set(*point, self.shape.size + 2 + k, value);
                    let (block, lane) = self.shape.place(*point);
                    let mark = &mut self.marks[block][lane];
                    *mark = if mark.is_solved() && k < VITAL && !value.is_finite() { Mark::Singular } else { *mark };
                }
            }
        }
    }

    /// Solves some places on some lines from those that are known; what fails stays unknown, for the careful path. Gives the
    /// number of evaluations.
    pub(crate) fn refine_lines(
        &mut self,
        newton: &mut LaneNewton<'_>,
        lines: &[usize],
        (places, known): (&[usize], &[usize]),
        targets: &[[f64; 2]],
    ) -> u64 {
        if places.len() == known.len() {
            return 0;
        }
        let Shape { size, planes, .. } = self.shape;
        // beside each other these lines are lanes of lines that go across them
        let shape = Shape::new(Lines::Columns, [lines.len(), places.len()], size, planes);
        let mut across = Field::shaped(shape, &self.ranges, self.memory.take().map(|memory| *memory));
        let own = self.shape;
        // of what lies beside each other in either field, one after the other
        let pairs = || {
            let points = (0..places.len()).flat_map(|at| (0..lines.len()).map(move |k| (k, at)));
            points.map(move |(k, at)| (own.place_on(lines[k], places[at]), shape.place_on(at, k)))
        };
        let target = |line: usize| places.iter().map(move |at| targets[own.point(line, *at)]);
        let targets: Vec<[f64; 2]> = lines.iter().flat_map(|line| target(*line)).collect();
        let is_root = |field: &Field, (block, lane): (usize, usize)| field.marks[block][lane].is_root();
        pairs().filter(|(own, _)| is_root(self, *own)).for_each(|(own, beside)| across.copy_place(beside, self, own));
        let known: Vec<usize> = (0..places.len()).filter(|at| known.contains(&places[*at])).collect();
        let levels = levels(places, &known);
        let evaluations =
            across.strips().into_iter().map(|mut strip| strip.refine(newton, None, &levels, &targets)).sum();
        for (own, beside) in pairs() {
            if is_root(&across, beside) && !is_root(self, own) {
                self.copy_place(own, &across, beside);
            }
        }
        self.memory = Some(Box::new(across));
        evaluations
    }

    /// Those of some lines that are known at some `places`, with a determinant there.
    pub(crate) fn known_lines(&self, lines: &[usize], places: &[usize]) -> Vec<(usize, f64)> {
        let is_known = |line: usize| places.iter().all(|place| self.is_root(self.shape.point(line, *place)));
        let determinant = |line: usize| self.determinant(self.shape.point(line, places[0]));
        lines.iter().filter(|line| is_known(**line)).map(|line| (*line, determinant(*line))).collect()
    }

    /// The strips, one beside the other.
    pub(crate) fn strips(&mut self) -> Vec<Strip<'_>> {
        let Field { shape, ranges, values, marks, .. } = self;
        let values = values.chunks_mut((shape.count * shape.planes * LANES).max(1));
        let strip = |(k, (values, marks)): (usize, (_, _))| {
            let first = k * LANES;
            Strip { shape: *shape, ranges, first, width: LANES.min(shape.length - first), values, marks }
        };
        values.zip(marks.chunks_mut(shape.count.max(1))).enumerate().map(strip).collect()
    }
}

/// A number of each lane in the order in which a field keeps them.
fn number<'n>(shape: Shape, newton: &'n mut LaneNewton<'_>, plane: usize) -> &'n Lanes {
    match plane.checked_sub(shape.size) {
        None => newton.input(plane),
        Some(0) => newton.determinant(),
        Some(1) => newton.residuals(),
        Some(extra) => newton.extra(extra - 2),
    }
}

/// Puts what a lane has come to into a lane of a block.
fn take(
    shape: Shape,
    values: &mut [f64],
    marks: &mut [Mark; LANES],
    column: usize,
    newton: &mut LaneNewton<'_>,
    lane: usize,
) {
    let outcome = newton.outcome(lane);
    // what the conditions call singular is told by the careful path
    if outcome != Outcome::Singular {
        marks[column] = Mark::of_outcome(outcome);
        keep(shape, values, column, newton, lane);
    }
}

/// Puts the numbers of a lane into a lane of a block.
fn keep(shape: Shape, values: &mut [f64], column: usize, newton: &mut LaneNewton<'_>, lane: usize) {
    for k in 0..shape.planes {
        values[k * LANES + column] = number(shape, newton, k)[lane];
    }
}

/// The numbers of a block.
fn block_of(shape: Shape, values: &mut [f64], block: usize) -> &mut [f64] {
    &mut values[block * shape.planes * LANES..][..shape.planes * LANES]
}
