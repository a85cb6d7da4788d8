//! Grids of any size in little memory: band after band of rows.
//!
//! Some rows are solved first, as a grid of their own, which finds the branch. The rows between two of them then follow from the
//! solved rows around, so that a band needs nothing but these. Where they have gaps, bands lead into each other, first upwards,
//! then downwards; a point that is reached only by turning back once more counts as not converged.

use std::ops::{Range, RangeInclusive};

use crate::continuation::choice::Choice;
use crate::continuation::field::Field;
use crate::continuation::follow::follow;
use crate::continuation::grid::{Followed, Grid, GridReport};
use crate::continuation::line::{levels, stencil};
use crate::continuation::reach::settle;
use crate::equations::solution::{self, Outcome};
use crate::equations::system::System;
use crate::newton::solvers::Solvers;
use crate::surface::points::{SurfacePoint, SurfacePoints};

/// Rows of a band, at the least and at the most.
const ROWS: RangeInclusive<usize> = 4..=64;

/// Some rows of a grid, solved.
#[derive(Debug)]
pub struct Band<'b> {
    points: &'b SurfacePoints,
    rows: Range<usize>,
    columns: usize,
    /// Where they begin among the points.
    first: usize,
}

impl<'b> Band<'b> {
    pub(crate) fn new(points: &'b SurfacePoints, rows: Range<usize>, columns: usize, first: usize) -> Band<'b> {
        Band { points, rows, columns, first }
    }

    /// Which rows of the grid they are.
    pub fn rows(&self) -> Range<usize> {
        self.rows.clone()
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.rows.len() * self.columns
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many of them are solved.
    pub fn solved(&self) -> usize {
        (self.first..self.first + self.len()).filter(|k| self.points.outcome(*k) == Outcome::Solved).count()
    }

    /// The points, row by row.
    pub fn points(&self) -> impl Iterator<Item = SurfacePoint> {
        (self.first..self.first + self.len()).map(|k| self.points.point(k))
    }

    /// A point of these, by its number in them, row by row.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn point(&self, number: usize) -> SurfacePoint {
        assert!(number < self.len(), "a point of the band");
        self.points.point(self.first + number)
    }
}

/// A grid whose targets are told one by one.
#[derive(Clone, Copy)]
pub(crate) struct Targets<'w> {
    pub(crate) target: &'w dyn Fn(usize, usize) -> [f64; 2],
    pub(crate) counts: [usize; 2],
}

impl Targets<'_> {
    fn on_rows(&self, rows: impl IntoIterator<Item = usize>) -> Vec<[f64; 2]> {
        rows.into_iter().flat_map(|i| (0..self.counts[1]).map(move |j| (self.target)(i, j))).collect()
    }

    pub(crate) fn all(&self) -> Vec<[f64; 2]> {
        self.on_rows(0..self.counts[0])
    }

    pub(crate) fn len(&self) -> usize {
        self.counts[0] * self.counts[1]
    }
}

/// How far apart the rows are that are solved first, where a band should not have many more than `points`.
fn spacing(points: usize, columns: usize) -> usize {
    (points / columns.max(1)).clamp(*ROWS.start(), *ROWS.end())
}

/// Hands over a grid as fields of some rows, one after the other: the rows of the grid, and the first line of the field that
/// belongs to them. A field's memory is used again for the next one. `points` is about the size of a band.
pub(crate) fn solve_in_bands<E>(
    system: &System,
    ranges: &[solution::Range],
    wanted: Targets<'_>,
    start: Option<&[f64]>,
    choice: &Choice<'_>,
    points: usize,
    each: &mut dyn FnMut(Range<usize>, Field, usize) -> Result<Field, E>,
) -> Result<GridReport, E> {
    let [rows, columns] = wanted.counts;
    let mut places: Vec<usize> = (0..rows).step_by(spacing(points, columns)).chain([rows - 1]).collect();
    places.dedup();
    let targets = wanted.on_rows(places.iter().copied());
    let mut apart = Grid::new(system, ranges, (&targets, [places.len(), columns]), None);
    apart.are_rows_apart = true;
    let mut solvers = Solvers::new(system, ranges);
    let Followed { field: mut known, is_beyond } = follow(&mut apart, &mut solvers, start, choice);
    if rows == 1 {
        settle(&mut apart, &mut known, &mut solvers.careful, 0..columns, choice.periodic);
        choice.judge(&mut known, 0..columns, ranges);
        return each(0..1, known, 0).map(|_| apart.effort);
    }
    let mut effort = apart.effort;
    let beyond = choice.reach.filter(|_| is_beyond).map(|reach| reach.ranges.as_slice());
    if let Some(beyond) = beyond {
        solvers = Solvers::new(system, beyond);
    }
    if let Some(root) = (0..known.len()).find(|point| known.is_root(*point)) {
        solvers.decide(&known.unknowns(root).collect::<Vec<_>>(), &targets[root]);
    }
    let mut bands = Bands {
        system,
        ranges: beyond.unwrap_or(ranges),
        wanted,
        solvers,
        places,
        known,
        evaluations: 0,
        memory: None,
    };
    let mut own_solvers = Solvers::new(system, ranges);
    bands.lead_upwards();
    for k in 0..bands.count() {
        let (mut field, own, targets) = bands.solve(k);
        bands.learn(k + 1, &field, own.end - 1);
        let mut grid = Grid::new(system, ranges, (&targets, [targets.len() / columns, columns]), None);
        let points = own.start * columns..own.end * columns;
        settle(&mut grid, &mut field, &mut own_solvers.careful, points.clone(), choice.periodic);
        choice.judge(&mut field, points, ranges);
        effort.evaluations += grid.effort.evaluations;
        let is_last = k + 1 == bands.count();
        let told = bands.places[k]..bands.places[k + 1] + usize::from(is_last);
        bands.memory = Some(each(told, field, own.start)?);
    }
    effort.evaluations += bands.evaluations;
    Ok(effort)
}

/// The bands between rows of a grid that are known, each with both of its rows.
struct Bands<'s> {
    system: &'s System,
    ranges: &'s [solution::Range],
    wanted: Targets<'s>,
    solvers: Solvers<'s>,
    /// Where the known rows are.
    places: Vec<usize>,
    known: Field,
    evaluations: u64,
    /// Of a band that is not needed any more.
    memory: Option<Field>,
}

impl Bands<'_> {
    fn count(&self) -> usize {
        self.places.len() - 1
    }

    /// Where a known row has gaps, the band below may lead into them.
    fn lead_upwards(&mut self) {
        let columns = self.wanted.counts[1];
        for k in (0..self.count()).rev() {
            let has_gaps = !(k * columns..(k + 1) * columns).all(|point| self.known.is_root(point));
            if has_gaps && !self.is_ambiguous() {
                let (field, own, _) = self.solve(k);
                self.learn(k, &field, own.start);
                self.memory = Some(field);
            }
        }
    }

    fn is_ambiguous(&self) -> bool {
        self.known.outcome(0) == Some(Outcome::Ambiguous)
    }

    /// A line of a solved band is what the next band begins with.
    fn learn(&mut self, place: usize, field: &Field, line: usize) {
        let columns = self.wanted.counts[1];
        for j in 0..columns {
            self.known.copy(place * columns + j, field, line * columns + j);
        }
    }

    /// A band as some lines of a field, with the known rows around, and the targets of all.
    fn solve(&mut self, k: usize) -> (Field, Range<usize>, Vec<[f64; 2]>) {
        let is_ambiguous = self.is_ambiguous();
        let Bands { system, ranges, wanted, solvers, places, known, evaluations, memory } = self;
        let columns = wanted.counts[1];
        let around = stencil(k, places.len());
        let own = k - around.start..k - around.start + places[k + 1] - places[k] + 1;
        let [before, behind] = [&places[around.start..=k], &places[k + 1..around.end]];
        // the rows of the grid that the lines of the field are
        let lines: Vec<usize> =
            before.iter().copied().chain(places[k] + 1..places[k + 1]).chain(behind.iter().copied()).collect();
        let targets = wanted.on_rows(lines.iter().copied());
        let mut grid = Grid::new(system, ranges, (&targets, [lines.len(), columns]), memory.take());
        let mut field = grid.field();
        if is_ambiguous {
            (own.start * columns..own.end * columns).for_each(|point| field.copy(point, known, 0));
            return (field, own, targets);
        }
        let known_lines: Vec<usize> = (0..=own.start).chain(own.end - 1..lines.len()).collect();
        for (line, place) in known_lines.iter().zip(around) {
            (0..columns).for_each(|j| field.copy(line * columns + j, known, place * columns + j));
        }
        if solvers.newton().has_all_given() {
            let places: Vec<usize> = (0..columns).collect();
            grid.compute_strips(&mut field, &[own.start, own.end - 1], &places);
        }
        grid.refine_strips(&mut field, solvers, None, &levels(&lines, &known_lines));
        grid.finish(&mut field, solvers, own.clone());
        *evaluations += grid.effort.evaluations;
        (field, own, targets)
    }
}
