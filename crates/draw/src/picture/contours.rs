//! Values over a grid on the sheet: bands between bounds, and lines along them.

use std::collections::BTreeMap;

use super::levels::Levels;
use super::paint::{Colour, Place, Sheet};
use super::surface::SEAM;

/// Where an edge of a cell is crossed: row, column, and whether the edge runs along the row.
type Edge = (usize, usize, bool);

/// A grid of places on the sheet with a value each.
pub(super) struct ValueGrid {
    rows: usize,
    columns: usize,
    nodes: Vec<Option<(Place, f64)>>,
}

impl ValueGrid {
    /// A grid whose nodes are given row by row, with `parts` cells for each of its own in both directions, between which places
    /// and values are bilinear.
    pub(super) fn refined(
        [rows, columns]: [usize; 2],
        node: impl Fn(usize, usize) -> Option<(Place, f64)>,
        parts: [usize; 2],
    ) -> ValueGrid {
        let fine = |count: usize, parts: usize| count.saturating_sub(1) * parts + usize::from(count > 0);
        let (down, right) = (fine(rows, parts[0]), fine(columns, parts[1]));
        let coarse: Vec<Option<(Place, f64)>> =
            (0..rows * columns).map(|at| node(at / columns, at % columns)).collect();
        let along = |k: usize, parts: usize, count: usize| {
            let from = (k / parts).min(count.saturating_sub(2));
            (from, (from + 1).min(count - 1), (k - from * parts) as f64 / parts as f64)
        };
        let between = |i: usize, j: usize| {
            let ((i, below, v), (j, beside, u)) = (along(i, parts[0], rows), along(j, parts[1], columns));
            let mixed = |i: usize| mix(coarse[i * columns + j], coarse[i * columns + beside], u);
            mix(mixed(i), mixed(below), v)
        };
        let nodes = (0..down * right).map(|at| between(at / right, at % right)).collect();
        ValueGrid { rows: down, columns: right, nodes }
    }

    fn corners(&self, i: usize, j: usize) -> [Option<(Place, f64)>; 4] {
        let at = i * self.columns + j;
        [at, at + 1, at + self.columns + 1, at + self.columns].map(|at| self.nodes[at])
    }

    /// Cells row by row; nothing for a grid of one row or column.
    fn cells(&self) -> impl Iterator<Item = (usize, usize)> {
        let (rows, columns) = (self.rows.saturating_sub(1), self.columns.saturating_sub(1));
        (0..rows).flat_map(move |i| (0..columns).map(move |j| (i, j)))
    }

    /// Fills the bands between the bounds, each in its colour; neighbours in one band are one shape.
    pub(super) fn fill(&self, levels: &Levels, sheet: &mut Sheet) {
        for i in 0..self.rows.saturating_sub(1) {
            let bands: Vec<Option<[usize; 2]>> =
                (0..self.columns.saturating_sub(1)).map(|j| self.bands(i, j, levels)).collect();
            let mut from = 0;
            for run in bands.chunk_by(|a, b| a == b && a.is_some_and(|[low, high]| low == high)) {
                let to = from + run.len();
                match run[0] {
                    Some([low, high]) if low == high => self.fill_run(i, from..to, levels.colour(low), sheet),
                    Some(_) => {
                        let corners: Vec<(Place, f64)> = self.corners(i, from).into_iter().flatten().collect();
                        for (colour, part) in parts_in_bands(&corners, levels) {
                            sheet.polygon(&part, colour, colour, SEAM);
                        }
                    }
                    None => {}
                }
                from = to;
            }
        }
    }

    /// Fills where the value is no greater than a bound.
    pub(super) fn fill_up_to(&self, bound: f64, colour: Colour, sheet: &mut Sheet) {
        for i in 0..self.rows.saturating_sub(1) {
            // all of a cell, a part of it, or nothing
            let within = |j: usize| -> Option<bool> {
                let corners = self.corners(i, j).map(|corner| corner.map(|(_, value)| value <= bound));
                let known = corners.into_iter().collect::<Option<Vec<bool>>>()?;
                known.contains(&true).then(|| !known.contains(&false))
            };
            let cells: Vec<Option<bool>> = (0..self.columns.saturating_sub(1)).map(within).collect();
            let mut from = 0;
            for run in cells.chunk_by(|a, b| a == b && *a == Some(true)) {
                match run[0] {
                    Some(true) => self.fill_run(i, from..from + run.len(), colour, sheet),
                    Some(false) => {
                        let corners: Vec<(Place, f64)> = self.corners(i, from).into_iter().flatten().collect();
                        let part: Vec<Place> =
                            clipped(&corners, |value| bound - value).into_iter().map(|(place, _)| place).collect();
                        if part.len() > 2 {
                            sheet.polygon(&part, colour, colour, SEAM);
                        }
                    }
                    None => {}
                }
                from += run.len();
            }
        }
    }

    /// Fills all cells in one colour.
    pub(super) fn silhouette(&self, colour: Colour, sheet: &mut Sheet) {
        for i in 0..self.rows.saturating_sub(1) {
            let whole: Vec<bool> =
                (0..self.columns.saturating_sub(1)).map(|j| self.corners(i, j).iter().all(Option::is_some)).collect();
            let mut from = 0;
            for run in whole.chunk_by(|a, b| a == b) {
                if run[0] {
                    self.fill_run(i, from..from + run.len(), colour, sheet);
                }
                from += run.len();
            }
        }
    }

    /// The lines around the cells: sides of one cell only.
    pub(super) fn borders(&self) -> Vec<Vec<Place>> {
        let is_cell = |i: usize, j: usize| {
            i + 1 < self.rows && j + 1 < self.columns && self.corners(i, j).iter().all(Option::is_some)
        };
        let before = |k: usize| k.checked_sub(1);
        let place = |i: usize, j: usize| self.nodes[i * self.columns + j].map(|(place, _)| place);
        let mut lines: Vec<Vec<Place>> = Vec::new();
        let mut add = |on: bool, from: Option<Place>, to: Option<Place>, joined: &mut bool| {
            if let (true, Some(from), Some(to)) = (on, from, to) {
                match lines.last_mut().filter(|_| *joined) {
                    Some(line) => line.push(to),
                    None => lines.push(vec![from, to]),
                }
            }
            *joined = on;
        };
        for i in 0..self.rows {
            let mut joined = false;
            for j in 0..self.columns.saturating_sub(1) {
                let on = is_cell(i, j) != before(i).is_some_and(|i| is_cell(i, j));
                add(on, place(i, j), place(i, j + 1), &mut joined);
            }
        }
        for j in 0..self.columns {
            let mut joined = false;
            for i in 0..self.rows.saturating_sub(1) {
                let on = is_cell(i, j) != before(j).is_some_and(|j| is_cell(i, j));
                add(on, place(i, j), place(i + 1, j), &mut joined);
            }
        }
        lines
    }

    /// The lowest and the highest band that a cell has part in.
    fn bands(&self, i: usize, j: usize, levels: &Levels) -> Option<[usize; 2]> {
        let mut found: Option<[usize; 2]> = None;
        for corner in self.corners(i, j) {
            let band = levels.band(corner?.1);
            found = Some(found.map_or([band; 2], |[low, high]| [low.min(band), high.max(band)]));
        }
        found
    }

    fn fill_run(&self, i: usize, run: std::ops::Range<usize>, colour: Colour, sheet: &mut Sheet) {
        let place = |i: usize, j: usize| self.nodes[i * self.columns + j].map(|(place, _)| place);
        let there = (run.start..=run.end).filter_map(|j| place(i, j));
        let back = (run.start..=run.end).rev().filter_map(|j| place(i + 1, j));
        let outline: Vec<Place> = there.chain(back).collect();
        sheet.polygon(&outline, colour, colour, SEAM);
    }

    /// The lines on which the value is `level`, each from end to end.
    pub(super) fn lines(&self, level: f64) -> Vec<Vec<Place>> {
        let mut places: BTreeMap<Edge, Place> = BTreeMap::new();
        let mut joints: BTreeMap<Edge, Vec<Edge>> = BTreeMap::new();
        for (i, j) in self.cells() {
            let [Some(a), Some(b), Some(c), Some(d)] = self.corners(i, j) else { continue };
            let edges =
                [((i, j, true), a, b), ((i, j + 1, false), b, c), ((i + 1, j, true), d, c), ((i, j, false), a, d)];
            let crossed: Vec<Edge> = edges
                .into_iter()
                .filter_map(|(edge, from, to)| {
                    let crossing = crossing(from, to, level)?;
                    places.insert(edge, crossing);
                    Some(edge)
                })
                .collect();
            // four crossings: the two that the first corner is cut off by, and the others
            for pair in crossed.chunks_exact(2) {
                joints.entry(pair[0]).or_default().push(pair[1]);
                joints.entry(pair[1]).or_default().push(pair[0]);
            }
        }
        chained(&joints).into_iter().map(|line| line.iter().map(|edge| places[edge]).collect()).collect()
    }
}

fn mix(a: Option<(Place, f64)>, b: Option<(Place, f64)>, share: f64) -> Option<(Place, f64)> {
    let ((p, x), (q, y)) = if share == 0.0 {
        (a?, a?)
    } else if share == 1.0 {
        (b?, b?)
    } else {
        (a?, b?)
    };
    let between = |a: f64, b: f64| a + share * (b - a);
    Some(([between(p[0], q[0]), between(p[1], q[1])], between(x, y)))
}

/// The parts of a polygon that lie in each band, with their colours; values are linear along its sides.
pub(super) fn parts_in_bands(polygon: &[(Place, f64)], levels: &Levels) -> Vec<(Colour, Vec<Place>)> {
    let bands = polygon.iter().map(|(_, value)| levels.band(*value));
    let (Some(low), Some(high)) = (bands.clone().min(), bands.max()) else { return Vec::new() };
    let part = |band: usize| {
        let [from, to] = levels.ends_of(band);
        let above = clipped(polygon, |value| value - from);
        clipped(&above, |value| to - value).into_iter().map(|(place, _)| place).collect::<Vec<Place>>()
    };
    let parts = (low..=high).map(|band| (levels.colour(band), part(band)));
    parts.filter(|(_, part)| part.len() > 2).collect()
}

/// The part of a polygon on which `inside` of the value is not negative, with values that are linear along its sides.
fn clipped(polygon: &[(Place, f64)], inside: impl Fn(f64) -> f64) -> Vec<(Place, f64)> {
    let mut part = Vec::new();
    for (k, &from) in polygon.iter().enumerate() {
        let to = polygon[(k + 1) % polygon.len()];
        let (a, b) = (inside(from.1), inside(to.1));
        if a >= 0.0 {
            part.push(from);
        }
        if (a < 0.0) != (b < 0.0) {
            part.extend(mix(Some(from), Some(to), a / (a - b)));
        }
    }
    part
}

fn crossing(from: (Place, f64), to: (Place, f64), level: f64) -> Option<Place> {
    let (a, b) = (from.1 - level, to.1 - level);
    ((a < 0.0) != (b < 0.0)).then(|| mix(Some(from), Some(to), a / (a - b)))?.map(|(place, _)| place)
}

/// Follows joints from end to end, open lines first, then closed ones.
fn chained(joints: &BTreeMap<Edge, Vec<Edge>>) -> Vec<Vec<Edge>> {
    let mut left = joints.clone();
    let ends = joints.iter().filter(|(_, next)| next.len() == 1).map(|(edge, _)| *edge);
    let starts: Vec<Edge> = ends.chain(joints.keys().copied()).collect();
    let mut lines = Vec::new();
    for start in starts {
        let mut line = vec![start];
        let mut at = start;
        while let Some(next) = left.get_mut(&at).and_then(Vec::pop) {
            if let Some(back) = left.get_mut(&next)
                && let Some(place) = back.iter().position(|edge| *edge == at)
            {
                back.swap_remove(place);
            }
            line.push(next);
            at = next;
        }
        if line.len() > 1 {
            lines.push(line);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cone: its lines are circles.
    fn cone(parts: usize) -> ValueGrid {
        let node = |i: usize, j: usize| {
            let place = [j as f64 - 5.0, i as f64 - 5.0];
            Some((place, place[0].hypot(place[1])))
        };
        ValueGrid::refined([11, 11], node, [parts; 2])
    }

    #[test]
    fn lines_run_from_end_to_end() {
        for parts in [1, 3] {
            let lines = cone(parts).lines(3.5);
            assert_eq!(lines.len(), 1);
            let line = &lines[0];
            assert_eq!(line[0], line[line.len() - 1]);
            assert!(line.iter().all(|[x, y]| (x.hypot(*y) - 3.5).abs() < 0.06));
        }
        // beyond the middles of the sides, four arcs in the corners
        assert_eq!(cone(2).lines(6.0).len(), 4);
        assert!(cone(2).lines(9.0).is_empty());
    }

    #[test]
    fn bands_cover_all_of_it_once() {
        let levels = Levels::over([0.0, 50f64.sqrt()].into_iter(), 8.0).expect("numbers");
        let mut sheet = Sheet::default();
        cone(2).fill(&levels, &mut sheet);
        let area: f64 = sheet.items.iter().map(|item| item.area()).sum();
        assert!((area - 100.0).abs() < 1e-9, "{area}");
    }

    #[test]
    fn a_hole_stays_empty() {
        let node = |i: usize, j: usize| ((i, j) != (1, 1)).then_some(([j as f64, i as f64], 0.0));
        let grid = ValueGrid::refined([4, 4], node, [2, 2]);
        let mut sheet = Sheet::default();
        grid.fill(&Levels::over([0.0, 1.0].into_iter(), 8.0).expect("numbers"), &mut sheet);
        let area: f64 = sheet.items.iter().map(|item| item.area()).sum();
        assert!((area - 5.0).abs() < 1e-9, "{area}");
    }
}
