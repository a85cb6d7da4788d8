//! Grids of points: one is looked for, the others follow from neighbour to neighbour.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use flank_expr::{InstructionSet, LANES};
use rayon::prelude::*;

use crate::Outcome;
use crate::continuation::field::{Along, Field, Lines, Strip};
use crate::continuation::lattice::Ways;
use crate::continuation::line::{Midpoint, denser, divided_difference, lattice, levels};
use crate::equations::solution::{Range, Solution};
use crate::equations::system::{Evaluation, READ_AGAIN, System, WRITTEN_ONCE};
use crate::newton::batch::LaneNewton;
use crate::newton::lines::OnLine;
use crate::newton::scalar::{LONGEST_STEP, solve_with};
use crate::newton::solvers::Solvers;
use crate::roots::Undecided;

/// A corrected point may lie this share of the tangent's length from where the tangent leads; beyond, it may be on another
/// branch, and the step is divided. The last step to where a branch turns back like a parabola has one.
pub(crate) const ASTRAY: f64 = 0.75;
/// Places on a line that are further apart than this get others between them before strips solve what is left of the line.
const WIDEST: usize = LANES / 2;
/// How many lines apart those are that lanes follow where strips have left points over.
const GAPS: [usize; 4] = [16, 8, 4, 2];
/// Grids with fewer points are not worth a second thread.
const SHARED: usize = 4096;

/// The points of a grid as far as its branch was followed, before [`settle`].
pub(crate) struct Followed {
    pub(crate) field: Field,
    /// Whether that is beyond the ranges.
    pub(crate) is_beyond: bool,
}

/// What a grid cost, and what is known about where it starts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GridReport {
    /// Evaluations of residuals with Jacobian, without those of the search for the anchor.
    pub evaluations: u64,
    /// Boxes that the search for the anchor looked at.
    pub boxes: u64,
    /// The targets of the anchor.
    pub anchor: [f64; 2],
    /// All roots in the ranges at the anchor that qualify, the one nearest the middle of the ranges first: more than one
    /// means that the ranges hold several branches.
    pub branches: Vec<Solution>,
    /// Where these roots are, if they are not all at the anchor.
    pub places: Vec<[f64; 2]>,
    /// If there are several: the unknowns of each at points spread over the grid, as far as it can be followed in the ranges.
    pub courses: Vec<Vec<Vec<f64>>>,
    /// Further branches that have points in the ranges at other places of the grid's rectangle, and are not among the points.
    pub elsewhere: Vec<Elsewhere>,
    /// Boxes of the ranges at the anchor in which further branches are not excluded.
    pub undecided: Vec<Undecided>,
    /// Whether the search for an anchor was given up before it had looked at all points.
    pub is_given_up: bool,
    /// Whether the branch has no point in the middle, so that what it is kept by was looked at elsewhere, at the anchor.
    pub is_kept_elsewhere: bool,
}

pub(crate) struct Grid<'s> {
    pub(crate) system: &'s System,
    pub(crate) evaluation: Evaluation<'s>,
    pub(crate) ranges: &'s [Range],
    pub(crate) targets: &'s [[f64; 2]],
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    /// The rows are too far apart to step from one to the next.
    pub(crate) are_rows_apart: bool,
    /// Branches may cross: the lattice is solved point by point.
    pub(crate) is_careful: bool,
    /// Of a field that is not needed any more.
    memory: Option<Field>,
    pub(crate) effort: GridReport,
}

/// A branch that has a point in the ranges somewhere, and is not the one of the points.
#[derive(Clone, Debug, PartialEq)]
pub struct Elsewhere {
    /// The targets there.
    pub place: [f64; 2],
    /// The point.
    pub root: Solution,
    /// Another point there that belongs to the branch of the points, if that has one.
    pub beside: Option<Solution>,
}

impl<'s> Grid<'s> {
    pub(crate) fn new(
        system: &'s System,
        ranges: &'s [Range],
        (targets, counts): (&'s [[f64; 2]], [usize; 2]),
        memory: Option<Field>,
    ) -> Grid<'s> {
        assert_eq!(targets.len(), counts[0] * counts[1], "one target for each point of the grid");
        Grid {
            system,
            evaluation: system.evaluation(&[0.0; 2]),
            ranges,
            targets,
            rows: counts[0],
            columns: counts[1],
            are_rows_apart: false,
            is_careful: false,
            memory,
            effort: GridReport::default(),
        }
    }

    /// The same points within other ranges.
    pub(crate) fn within<'o>(&self, ranges: &'o [Range]) -> Grid<'o>
    where
        's: 'o,
    {
        let mut other = Grid::new(self.system, ranges, (self.targets, [self.rows, self.columns]), None);
        other.are_rows_apart = self.are_rows_apart;
        other.is_careful = self.is_careful;
        other
    }

    /// The targets at shares of the way from the first row to the last one and from the first column to the last one: the same however
    /// many rows and columns there are.
    pub(crate) fn target_at(&self, shares: [f64; 2]) -> [f64; 2] {
        let along = |share: f64, count: usize| {
            let at = share * (count - 1) as f64;
            let before = (at as usize).min(count - 1);
            (before, (before + 1).min(count - 1), at - before as f64)
        };
        let (above, below, down) = along(shares[0], self.rows);
        let (left, right, across) = along(shares[1], self.columns);
        let target = |i: usize, j: usize| self.targets[i * self.columns + j];
        let between = |a: [f64; 2], b: [f64; 2], share: f64| [0, 1].map(|k| a[k] + share * (b[k] - a[k]));
        let rows = [above, below].map(|i| between(target(i, left), target(i, right), across));
        between(rows[0], rows[1], down)
    }

    /// The point nearest to shares of the way from the first row to the last one and from the first column to the last one.
    pub(crate) fn nearest(&self, shares: [f64; 2]) -> usize {
        let at = |share: f64, count: usize| (share * (count - 1) as f64).round() as usize;
        at(shares[0], self.rows) * self.columns + at(shares[1], self.columns)
    }

    /// The root that a start leads to: at once if that is near, else with care.
    pub(crate) fn root_from(&mut self, newton: &mut LaneNewton<'_>, point: usize, start: &[f64]) -> Option<Solution> {
        newton.put(0, start.iter().copied(), &self.targets[point]);
        self.effort.evaluations += newton.run(&[true], true);
        if newton.is_root(0) && newton.moved(0) <= LONGEST_STEP && newton.outcome(0) == Outcome::Solved {
            let unknowns = (0..start.len()).map(|k| newton.input(k)[0]).collect();
            let residual = newton.residuals()[0];
            return Some(Solution { outcome: Outcome::Solved, unknowns, residual, iterations: 0 });
        }
        self.evaluation.set_parameters(&self.targets[point]);
        let solution = solve_with(&mut self.evaluation, self.ranges, start);
        self.effort.evaluations += u64::from(solution.iterations);
        solution.is_root().then_some(solution)
    }

    pub(crate) fn field(&mut self) -> Field {
        Field::new(self.ranges, [self.rows, self.columns], self.system.extra_count(), self.memory.take())
    }

    /// Everything that can be reached from the anchor.
    pub(crate) fn fill(&mut self, solvers: &mut Solvers<'_>, anchor: usize, root: &Solution) -> Field {
        let mut field = self.field();
        field.put(anchor, root);
        let rows = lattice(self.rows, anchor / self.columns);
        let columns = lattice(self.columns, anchor % self.columns);
        solvers.decide(&root.unknowns, &self.targets[anchor]);
        let newton = solvers.newton();
        self.settle(&mut field, newton, &[anchor]);
        let by_hand = match self.is_careful {
            true => vec![anchor],
            false => self.spread_in_lanes(&mut field, newton, vec![anchor], ([rows.as_slice(), &columns], Ways::All)),
        };
        if !by_hand.is_empty() {
            self.spread(&mut field, newton, &by_hand, [&rows, &columns]);
        }
        // what follows from no start may have its lines along the rows, on which the first target is the same more often than not
        let lines = if newton.has_all_given() { Lines::Rows } else { self.smoother(&field, [&rows, &columns]) };
        let width = self.columns;
        let points: Vec<usize> = rows.iter().flat_map(|i| columns.iter().map(move |j| i * width + j)).collect();
        field.divide(lines, &points);
        let (count, length) = ((self.rows, &rows), (self.columns, &columns));
        let (count, length) = if lines == Lines::Rows { (count, length) } else { (length, count) };
        let has_all_given = solvers.newton().has_all_given();
        if has_all_given {
            self.compute_strips(&mut field, count.1, length.1);
        }
        if !(has_all_given && field.is_complete()) {
            let (newton, targets, is_shared) = (solvers.newton(), self.targets, self.is_shared());
            let mut refine = || refine_lines(&mut field, newton, count.1, (length.0, length.1), targets);
            let down = || levels(&(0..count.0).collect::<Vec<_>>(), count.1);
            let ((along, evaluations), down) = if is_shared { rayon::join(refine, down) } else { (refine(), down()) };
            self.effort.evaluations += evaluations;
            self.refine_strips(&mut field, solvers, along.as_ref(), &down);
            if !(has_all_given || self.is_careful) {
                self.refine_between(&mut field, solvers, lines);
            }
        }
        self.finish(&mut field, solvers, 0..self.rows);
        field
    }

    /// What strips have left over, as lines were too far apart: lanes follow lines closer and closer together, each from its neighbours, and
    /// strips solve what lies between these.
    fn refine_between(&mut self, field: &mut Field, solvers: &mut Solvers<'_>, lines: Lines) {
        let (rows, columns): (Vec<usize>, Vec<usize>) = ((0..self.rows).collect(), (0..self.columns).collect());
        let (all, width) = (if lines == Lines::Rows { &rows } else { &columns }, self.columns);
        for gap in GAPS.into_iter().filter(|gap| *gap < all.len()) {
            if field.is_complete() {
                return;
            }
            let last = all.len() - 1;
            let some: Vec<usize> = (0..last).step_by(gap).chain([last]).collect();
            let lattice: [&[usize]; 2] = if lines == Lines::Rows { [&some, &columns] } else { [&rows, &some] };
            let points = lattice[0].iter().flat_map(|i| lattice[1].iter().map(move |j| i * width + j));
            let known: Vec<usize> = points.filter(|point| field.is_root(*point)).collect();
            self.spread_in_lanes(field, solvers.newton(), known, (lattice, Ways::Straight));
            self.refine_strips(field, solvers, None, &levels(all, &some));
        }
    }

    /// What is left of some rows: from solved points beside it in lanes, then by the careful path.
    pub(crate) fn finish(&mut self, field: &mut Field, solvers: &mut Solvers<'_>, rows: std::ops::Range<usize>) {
        if !field.is_complete() {
            let columns: Vec<usize> = (0..self.columns).collect();
            let step = if self.are_rows_apart { 1 } else { rows.len().max(1) };
            for first in rows.step_by(step) {
                let beside = first..first + step;
                let rows: Vec<usize> = beside.clone().collect();
                let mut edge = self.edge_of_roots(field, beside.clone());
                if !self.is_careful && !edge.is_empty() {
                    let lattice = ([rows.as_slice(), &columns], Ways::Straight);
                    self.spread_in_lanes(field, solvers.newton(), edge, lattice);
                    edge = self.edge_of_roots(field, beside);
                }
                self.spread(field, solvers.newton(), &edge, [&rows, &columns]);
            }
        }
        field.place_loose(&mut solvers.careful);
    }

    /// The lines across which the unknowns change more smoothly, by the highest divided differences on the lattice.
    fn smoother(&self, field: &Field, [rows, columns]: [&[usize]; 2]) -> Lines {
        let roughness = |places: &[usize], others: &[usize], point: &dyn Fn(usize, usize) -> usize| {
            let weights: Vec<f64> = divided_difference(places).collect();
            let rough = |other: &usize| {
                let points = || places.iter().map(|place| point(*place, *other));
                let of = |(k, range): (usize, &Range)| {
                    let terms = points().zip(&weights).map(|(point, weight)| weight * field.value(point, k));
                    terms.sum::<f64>().abs() / range.width()
                };
                let is_known = points().all(|point| field.is_root(point));
                if is_known { self.ranges.iter().enumerate().map(of).fold(0.0, f64::max) } else { 0.0 }
            };
            // of the length of a step to that power
            others.iter().map(rough).fold(0.0, f64::max).powf(1.0 / (places.len().max(2) - 1) as f64)
        };
        let down = roughness(rows, columns, &|i, j| i * self.columns + j);
        let across = roughness(columns, rows, &|j, i| i * self.columns + j);
        // lanes that are not there cost as much as those that are
        if across < down && self.rows >= LANES / 2 { Lines::Columns } else { Lines::Rows }
    }

    /// The determinants at points by the careful path, which does not give them.
    pub(crate) fn settle(&mut self, field: &mut Field, newton: &mut LaneNewton<'_>, points: &[usize]) {
        let roots: Vec<usize> = points.iter().copied().filter(|point| field.is_root(*point)).collect();
        for block in roots.chunks(LANES) {
            for (lane, &point) in block.iter().enumerate() {
                newton.put(lane, field.unknowns(point), &self.targets[point]);
            }
            newton.tangents(block.len());
            self.effort.evaluations += block.len() as u64;
            for (lane, &point) in block.iter().enumerate() {
                if newton.is_clear(lane) {
                    field.set_determinant(point, newton.determinant()[lane]);
                }
            }
        }
    }

    /// All lines whose points are given by their targets, from those that are known at some places.
    pub(crate) fn compute_strips(&mut self, field: &mut Field, lines: &[usize], places: &[usize]) {
        let (system, ranges, targets) = (self.system, self.ranges, self.targets);
        let instructions = system.instructions_on(targets.len(), WRITTEN_ONCE);
        let new = || OnLine::new(system, ranges, instructions);
        let mut on_line = new();
        let known = field.known_lines(lines, places);
        let prepare = |on_line: &mut Option<OnLine<'s>>, line: &[[f64; 2]]| {
            on_line.as_mut().and_then(|on_line| on_line.prepared(line, &targets[..line.len()]))
        };
        let prepared: Vec<Option<Vec<f64>>> = if self.is_shared() {
            targets.par_chunks(self.columns).with_min_len(SHARED / self.columns).map_init(new, prepare).collect()
        } else {
            targets.chunks(self.columns).map(|line| prepare(&mut on_line, line)).collect()
        };
        let compute = |on_line: &mut Option<OnLine<'s>>, mut strip: Strip<'_>| {
            on_line.as_mut().map_or(0, |on_line| strip.compute(on_line, &known, &prepared, targets))
        };
        self.effort.evaluations += self.on_strips(field, instructions, (&mut on_line, new), compute);
    }

    /// All lines, from those that are known, or known at some places.
    pub(crate) fn refine_strips(
        &mut self,
        field: &mut Field,
        solvers: &mut Solvers<'_>,
        along: Option<&Along>,
        levels: &[Vec<Midpoint>],
    ) {
        let targets = self.targets;
        let instructions = self.system.instructions_on(targets.len(), READ_AGAIN);
        let another = solvers.another(instructions);
        let mut for_many = instructions.is_for_many().then(&another);
        let newton = for_many.as_mut().unwrap_or_else(|| solvers.newton());
        let refine = |newton: &mut LaneNewton<'_>, mut strip: Strip<'_>| strip.refine(newton, along, levels, targets);
        self.effort.evaluations += self.on_strips(field, instructions, (newton, another), refine);
    }

    /// Whether it is work for several threads.
    fn is_shared(&self) -> bool {
        self.targets.len() >= SHARED && rayon::current_num_threads() > 1
    }

    /// Work with these instructions on each strip, one after the other on as many threads as there are; further ones have tools of their
    /// own.
    fn on_strips<T>(
        &self,
        field: &mut Field,
        instructions: InstructionSet,
        (tool, new): (&mut T, impl Fn() -> T + Sync + Send),
        work: impl Fn(&mut T, Strip<'_>) -> u64 + Sync + Send,
    ) -> u64 {
        let strips = field.strips();
        let work = |tool: &mut T, strip: Strip<'_>| {
            let evaluations = work(tool, strip);
            instructions.settle();
            evaluations
        };
        if !self.is_shared() {
            return strips.into_iter().map(|strip| work(tool, strip)).sum();
        }
        let others = rayon::current_num_threads().min(strips.len()) - 1;
        let (strips, theirs) = (Mutex::new(strips.into_iter()), AtomicU64::new(0));
        let next = || strips.lock().unwrap_or_else(PoisonError::into_inner).next();
        let mut own = 0;
        rayon::in_place_scope(|scope| {
            for _ in 0..others {
                scope.spawn(|_| {
                    let mut tool = None;
                    while let Some(strip) = next() {
                        theirs.fetch_add(work(tool.get_or_insert_with(&new), strip), Ordering::Relaxed);
                    }
                });
            }
            while let Some(strip) = next() {
                own += work(tool, strip);
            }
        });
        own + theirs.into_inner()
    }

    /// Roots beside points that are not known to be roots, both in some of the rows.
    fn edge_of_roots(&self, field: &Field, rows: std::ops::Range<usize>) -> Vec<usize> {
        let beside = |point: usize| {
            let (i, j) = (point / self.columns, point % self.columns);
            let vertical = [i.checked_sub(1), Some(i + 1)].map(|i| i.filter(|i| rows.contains(i)).map(|i| (i, j)));
            let across = [j.checked_sub(1), Some(j + 1).filter(|j| *j < self.columns)].map(|j| j.map(|j| (i, j)));
            vertical.into_iter().chain(across).flatten().map(|(i, j)| i * self.columns + j)
        };
        let is_edge = |&point: &usize| field.is_root(point) && beside(point).any(|other| !field.is_root(other));
        (rows.start * self.columns..rows.end * self.columns).filter(is_edge).collect()
    }
}

/// Brings some lines so far, from places where they are known, that each strip can solve its part of them for itself; else all of
/// them, for which strips need nothing then. Also the number of evaluations.
fn refine_lines(
    field: &mut Field,
    newton: &mut LaneNewton<'_>,
    lines: &[usize],
    (length, known): (usize, &[usize]),
    targets: &[[f64; 2]],
) -> (Option<Along>, u64) {
    let places = denser(known, WIDEST);
    let mut evaluations = field.refine_lines(newton, lines, (&places, known), targets);
    let along = field.along(lines, &places);
    if along.is_none() {
        let all: Vec<usize> = (0..length).collect();
        evaluations += field.refine_lines(newton, lines, (&all, known), targets);
    }
    (along, evaluations)
}

/// The start for the next point in line, `ratio` times as far away as the one before: straight on.
pub(crate) fn extrapolated(near: &[f64], far: impl Iterator<Item = f64>, ratio: f64) -> Vec<f64> {
    near.iter().zip(far).map(|(a, b)| a + ratio * (a - b)).collect()
}
