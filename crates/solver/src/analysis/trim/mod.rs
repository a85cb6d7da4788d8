//! A surface without the points that another one cuts away.

mod deeper;

use flank_expr::{Expr, TapeError};

use crate::analysis::intersection::{Intersection, Line, Meeting};
use crate::analysis::secondary::SecondaryCutting;
use crate::equations::solution::{CutBy, Outcome};
use crate::surface::SurfaceProblem;
use crate::surface::bound::BoundSurface;
use crate::surface::points::SurfacePoint;

/// A point nearer than this to a meeting on its line, in the line's own unit, lies on the edge and stays.
const ON_EDGE: f64 = 1e-9;

/// A surface that is cut away by others which bound one body together.
#[derive(Clone, Debug)]
pub struct Trim<'s, 'g> {
    /// The surface that loses points.
    pub surface: &'s BoundSurface<'g>,
    /// Those that take them, in the same frame.
    pub by: Vec<TrimmedBy<'s, 'g>>,
    /// The tool that makes them, if they are several: where it cuts one of them away itself, that one does not bound the body.
    pub tool: Option<SecondaryCutting>,
    /// By which points of the first are asked for.
    pub coordinates: [Expr<'g>; 2],
}

/// One of the surfaces that cut another away.
#[derive(Clone, Debug)]
pub struct TrimmedBy<'s, 'g> {
    /// The surface.
    pub surface: &'s BoundSurface<'g>,
    /// What marks the points that go, as [`CutBy::Other`].
    pub number: usize,
    /// Its tool's surface in all its positions, if that is another one than makes the trimmed surface.
    pub positions: Option<SecondaryCutting>,
}

impl<'g> Trim<'_, 'g> {
    /// Marks the points of a grid that the others cut away, and gives back where each of them meets the surface on the grid: on the columns,
    /// one after the other, and on the rows. What a tool sweeps in any position goes first. One of the others that the surface meets nowhere
    /// has taken all that it lies deeper than in the material; points of it beside the surface's are solved by `points_of_by`, given its place
    /// among the others and two functions of its unknowns.
    ///
    /// `targets` are the values of the two coordinates, row by row. Each row and each column is a line on the first surface. The
    /// surfaces are brought to meet on it; a point is cut away if between it and the next meeting, before or after, the surface
    /// runs outside the body that the others bound: a line that leaves it through one of them may enter it again through another. A point
    /// without a meeting on its row and column is as the neighbours that no meeting parts from it. What rows, columns and neighbours disagree about
    /// is [`Outcome::Undecided`]. Meetings with what the tool of the others cuts away of them itself are left out.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor has a value.
    ///
    /// # Panics
    /// If there are not `counts[0] · counts[1]` targets and points.
    pub fn apply(
        &self,
        points: &mut [SurfacePoint],
        (targets, counts): (&[[f64; 2]], [usize; 2]),
        points_of_by: &dyn Fn(usize, [Expr<'g>; 2]) -> SurfaceProblem,
    ) -> Result<Vec<[Vec<Meeting>; 2]>, TapeError> {
        // each of them, even where one was not looked at
        let mut is_swept_known = true;
        for by in &self.by {
            is_swept_known &= match &by.positions {
                Some(positions) => positions.judge_of_another(points, counts, by.number),
                None => false,
            };
        }
        let intersection =
            |by: &TrimmedBy<'_, 'g>| Ok((Intersection::new([self.surface, by.surface], self.coordinates)?, by.number));
        let intersections: Vec<(Intersection, usize)> = self.by.iter().map(intersection).collect::<Result<_, _>>()?;
        let positions: Option<Vec<&SecondaryCutting>> =
            self.by.iter().map(|by| by.positions.as_ref().filter(|_| is_swept_known)).collect();
        let meetings = trim(points, (targets, counts), (&intersections, self.tool.as_ref()), positions.as_deref());
        for (place, (by, met)) in self.by.iter().zip(&meetings).enumerate() {
            if met.iter().all(Vec::is_empty) {
                let points_of_by = |coordinates| points_of_by(place, coordinates);
                deeper::mark_deeper(by, points, counts, is_swept_known, &points_of_by)?;
            }
        }
        Ok(meetings)
    }
}

/// What is known of a point of the grid.
#[derive(Clone, Copy, Default)]
struct Known {
    stays: bool,
    /// The number of what takes it.
    goes: Option<usize>,
    /// For sure, as its tool sweeps it.
    is_swept: bool,
}

/// Where the surface meets one of those that trim it, whose number comes with it.
type Met = (Meeting, usize);

/// Marks the points as [`Trim::apply`] does where surfaces meet; the `positions` of the others' tools are given if all of them were looked at.
fn trim(
    points: &mut [SurfacePoint],
    (targets, counts): (&[[f64; 2]], [usize; 2]),
    (intersections, tool): (&[(Intersection, usize)], Option<&SecondaryCutting>),
    positions: Option<&[&SecondaryCutting]>,
) -> Vec<[Vec<Meeting>; 2]> {
    assert_eq!(targets.len(), counts[0] * counts[1], "one target for each point of the grid");
    assert_eq!(targets.len(), points.len(), "one point for each target");
    let is_one_of = |number: usize| intersections.iter().any(|(_, own)| *own == number);
    let swept = |point: &SurfacePoint| match point.outcome {
        Outcome::CutAway(CutBy::Other(number)) if is_one_of(number) => {
            Known { stays: false, goes: Some(number), is_swept: true }
        }
        _ => Known::default(),
    };
    let mut known: Vec<Known> = points.iter().map(swept).collect();
    let mut joined: Vec<[usize; 2]> = Vec::new();
    let mut meetings = vec![[Vec::new(), Vec::new()]; intersections.len()];
    let [rows, columns] = counts;
    let columns_down = (0..columns).map(|j| (0..rows).map(|i| i * columns + j).collect());
    let rows_across = (0..rows).map(|i| (0..columns).map(|j| i * columns + j).collect());
    for (lines, coordinate) in [(columns_down.collect::<Vec<Vec<usize>>>(), 0), (rows_across.collect(), 1)] {
        let with_points = |indices: &Vec<usize>| {
            // what the tool itself cuts away of a line joins the parts of it that stay
            let known = |point: &&SurfacePoint| matches!(point.outcome, Outcome::Solved | Outcome::CutAway(_));
            (Line::through(indices, targets, coordinate), indices.iter().map(|&at| &points[at]).filter(known).collect())
        };
        let through: Vec<(Line, Vec<&SurfacePoint>)> = lines.iter().map(with_points).collect();
        let mut all: Vec<Vec<Met>> = vec![Vec::new(); lines.len()];
        for (place, (intersection, number)) in intersections.iter().enumerate() {
            for (of, mut found) in meet(intersection, &through).into_iter().enumerate() {
                if let Some(tool) = tool {
                    keep_left(&mut found, tool);
                }
                let is_listed = |meeting: &&Meeting| {
                    meeting.first.outcome == Outcome::Solved
                        && through[of].0.is_on_grid(meeting.along, &lines[of], targets)
                };
                meetings[place][coordinate].extend(found.iter().filter(is_listed).cloned());
                all[of].extend(found.into_iter().map(|meeting| (meeting, *number)));
            }
        }
        for ((indices, (line, _)), mut all) in lines.iter().zip(&through).zip(all) {
            all.sort_by(|a, b| a.0.along.total_cmp(&b.0.along));
            decide(&mut known, &mut joined, indices, targets, *line, &all);
        }
    }
    if let Some(positions) = positions {
        let is_clear = |at: usize| positions.iter().all(|positions| positions.is_clear_of(&points[at]));
        part(&mut known, &mut joined, &is_clear);
    }
    contradict(&mut known, &joined);
    spread(&mut known, &joined);
    for (point, known) in points.iter_mut().zip(known) {
        if let Some(number) = known.goes.filter(|_| point.outcome == Outcome::Solved) {
            point.outcome = if known.stays { Outcome::Undecided } else { Outcome::CutAway(CutBy::Other(number)) };
        }
    }
    meetings
}

/// The meetings on lines beside each other, each with the points on it: looked for from those on the line before, and once more where the line
/// behind has more of them.
fn meet(intersection: &Intersection, lines: &[(Line, Vec<&SurfacePoint>)]) -> Vec<Vec<Meeting>> {
    let unknowns = |found: &[Meeting]| found.iter().map(Meeting::unknowns).collect::<Vec<Vec<f64>>>();
    let mut all: Vec<Vec<Meeting>> = Vec::with_capacity(lines.len());
    let mut before = Vec::new();
    for (line, near) in lines {
        let starts = [before.clone(), intersection.crossings(near)].concat();
        let found = intersection.on_line(*line, &starts, near);
        if !found.is_empty() {
            before = unknowns(&found);
        }
        all.push(found);
    }
    for at in (1..lines.len()).rev() {
        let [own, behind] = &mut all[at - 1..=at] else { continue };
        if behind.len() > own.len() {
            let (line, near) = &lines[at - 1];
            *own = intersection.on_line(*line, &[unknowns(own), unknowns(behind)].concat(), near);
        }
    }
    all
}

/// Leaves out the meetings with what the tool of the second surface cuts away of it.
fn keep_left(found: &mut Vec<Meeting>, tool: &SecondaryCutting) {
    let mut seconds: Vec<SurfacePoint> = found.iter().map(|meeting| meeting.second.clone()).collect();
    tool.judge(&mut seconds, [found.len(), 1]);
    let mut is_left = seconds.into_iter().map(|point| !matches!(point.outcome, Outcome::CutAway(_)));
    found.retain(|_| is_left.next() == Some(true));
}

impl Line {
    /// Through the first and the last of some targets; along a coordinate if there is only one.
    fn through(indices: &[usize], targets: &[[f64; 2]], coordinate: usize) -> Line {
        let ends = [indices.first(), indices.last()].map(|at| at.map_or([0.0; 2], |&at| targets[at]));
        let by = [0, 1].map(|k| ends[1][k] - ends[0][k]);
        let length = by[0].hypot(by[1]);
        let axis = [0, 1].map(|k| if k == coordinate { 1.0 } else { 0.0 });
        Line { from: ends[0], direction: if length > 0.0 { by.map(|by| by / length) } else { axis } }
    }

    fn along(&self, target: [f64; 2]) -> f64 {
        (0..2).map(|k| (target[k] - self.from[k]) * self.direction[k]).sum()
    }

    /// Whether a place lies between the ends of the line, or beyond them by no more than the points are apart.
    fn is_on_grid(&self, along: f64, indices: &[usize], targets: &[[f64; 2]]) -> bool {
        let length = indices.last().map_or(0.0, |&last| self.along(targets[last]));
        let gap = length / (indices.len().max(2) - 1) as f64;
        indices.len() < 2 || (-gap..=length + gap).contains(&along)
    }
}

/// What the meetings on a line say of its points, and which neighbours on it no meeting parts.
fn decide(
    known: &mut [Known],
    joined: &mut Vec<[usize; 2]>,
    indices: &[usize],
    targets: &[[f64; 2]],
    line: Line,
    found: &[Met],
) {
    let place = |at: usize| line.along(targets[at]);
    for &at in indices {
        let s = place(at);
        if known[at].is_swept {
            continue;
        }
        if found.iter().any(|(meeting, _)| (meeting.along - s).abs() <= ON_EDGE) {
            known[at].stays = true;
            continue;
        }
        let before = found.iter().rev().find(|(meeting, _)| meeting.along < s);
        let after = found.iter().find(|(meeting, _)| meeting.along > s);
        let verdicts = [before.map(|(met, by)| (met.leaves, by)), after.map(|(met, by)| (!met.leaves, by))];
        for (goes, by) in verdicts.into_iter().flatten() {
            if goes {
                known[at].goes.get_or_insert(*by);
            } else {
                known[at].stays = true;
            }
        }
    }
    for pair in indices.windows(2) {
        let (a, b) = (place(pair[0]), place(pair[1]));
        if !found.iter().any(|(meeting, _)| (a.min(b) - ON_EDGE..=a.max(b) + ON_EDGE).contains(&meeting.along)) {
            joined.push([pair[0], pair[1]]);
        }
    }
}

/// What no tool sweeps and no meeting parts from what one sweeps lies beyond the end of a motion or of a tool's surface: no verdict comes to it
/// from there. It stays if it `is_clear` of the tools in all positions, whatever is told from elsewhere.
fn part(known: &mut [Known], joined: &mut Vec<[usize; 2]>, is_clear: &dyn Fn(usize) -> bool) {
    let is_end = |[a, b]: &[usize; 2], known: &[Known]| known[*a].is_swept != known[*b].is_swept;
    let mut next: Vec<usize> =
        joined.extract_if(.., |pair| is_end(pair, known)).map(|[a, b]| if known[a].is_swept { b } else { a }).collect();
    let mut beside: Vec<Vec<usize>> = vec![Vec::new(); known.len()];
    for &[a, b] in joined.iter() {
        beside[a].push(b);
        beside[b].push(a);
    }
    let mut is_seen = vec![false; known.len()];
    while let Some(at) = next.pop() {
        if known[at].stays || std::mem::replace(&mut is_seen[at], true) {
            continue;
        }
        if is_clear(at) {
            known[at] = Known { stays: true, ..Known::default() };
            next.extend(&beside[at]);
        }
    }
}

/// Of two points that no meeting parts and that lines tell apart, neither is known: a meeting was missed.
fn contradict(known: &mut [Known], joined: &[[usize; 2]]) {
    let before = known.to_vec();
    for &[a, b] in joined {
        for [stays, goes] in [[a, b], [b, a]] {
            let by = before[goes].goes.filter(|_| !before[goes].stays);
            if before[stays].stays && before[stays].goes.is_none() && by.is_some() {
                known[stays].goes = by;
                known[goes].stays = true;
            }
        }
    }
}

/// Points of which nothing is known are as those that they hang together with.
fn spread(known: &mut [Known], joined: &[[usize; 2]]) {
    let open: Vec<bool> = known.iter().map(|point| !point.stays && point.goes.is_none()).collect();
    loop {
        let mut changed = false;
        for &[a, b] in joined.iter().chain(joined.iter().rev()) {
            for (from, to) in [(a, b), (b, a)] {
                let Known { stays, goes, .. } = known[from];
                if open[to] && ((stays && !known[to].stays) || (goes.is_some() && known[to].goes.is_none())) {
                    known[to].stays |= stays;
                    known[to].goes = known[to].goes.or(goes);
                    changed = true;
                }
            }
        }
        if !changed {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point that stays beside one that goes with nothing between them: neither is known, and what hangs together with them is neither.
    #[test]
    fn what_lines_contradict_each_other_about_is_undecided() {
        let stays = Known { stays: true, ..Known::default() };
        let goes = Known { goes: Some(3), ..Known::default() };
        let mut known = [stays, stays, goes, goes, stays, Known::default()];
        let joined = [[0, 1], [1, 2], [2, 3], [2, 5]];
        contradict(&mut known, &joined);
        spread(&mut known, &joined);
        let is_undecided = |point: &Known| point.stays && point.goes == Some(3);
        assert_eq!(known.each_ref().map(is_undecided), [false, true, true, false, false, true]);
        assert!(known[0].goes.is_none() && !known[3].stays && known[4].goes.is_none());
    }
}
