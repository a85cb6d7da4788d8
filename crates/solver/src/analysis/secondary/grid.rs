//! Which points of a grid are checked against the tool's positions.

use nalgebra::Vector3;

use crate::analysis::secondary::SecondaryCutting;
use crate::analysis::secondary::line::{Cut, Place, Pose, Poses, Way};
use crate::analysis::secondary::net::Seen;
use crate::equations::solution::{CutBy, Outcome};
use crate::surface::points::SurfacePoint;

/// Of a grid with no more points than this each is judged, where there is one motion: between lines that are far apart a whole piece may
/// be cut away. With several motions, of which one runs at a time, a point's way is many times as long.
const FEW: usize = 1024;
/// Points of it that are judged at the same time.
const TOGETHER: usize = 16;
/// Parts into which rows and columns are divided first.
const PARTS: usize = 8;
/// Feet that are looked for before the rest is given up, and for each line of a grid.
const MOST_LOOKS: [u64; 2] = [100_000, 1000];

/// What is known once a grid was judged.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judged {
    /// The numbers of the pieces that cut points away, and how deep, mm, the deepest of these was seen to lie in the steel.
    pub deepest: Vec<(usize, f64)>,
    /// What was not looked at.
    pub unseen: Option<Unseen>,
}

/// Positions that points were not checked against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unseen {
    /// Those that differ from a point's own in several motions at once.
    SeveralMotions,
    /// All that was left when the budget was spent.
    Budget,
}

/// A verdict on one point.
type Verdict = Option<Cut>;

struct Judge<'c> {
    cutting: &'c SecondaryCutting,
    poses: Poses<'c>,
    seen: Vec<Seen<'c>>,
    /// For each motion the values that are looked at; if there is only one, the poses there.
    values: Vec<Vec<f64>>,
    fixed: Vec<Pose>,
    /// Whether the tool generates the points: their last unknowns are its motions.
    is_own: bool,
    looks: u64,
}

impl SecondaryCutting {
    /// Marks the solved points of a grid, row by row, that the tool cuts away in another position, as
    /// [`CutBy::ItsToolElsewhere`]. The motions are the last of a point's unknowns.
    ///
    /// Points are checked against all positions that differ from their own in one motion. Where a grid has many, some of them are, evenly spread,
    /// and all where verdicts change; what lies between points of one verdict has it too.
    ///
    /// # Panics
    /// If there are not `counts[0] · counts[1]` points.
    pub fn judge(&self, points: &mut [SurfacePoint], counts: [usize; 2]) -> Judged {
        self.judged(points, counts, (None, None))
    }

    /// The same where the verdicts on some points alone are wanted, by their numbers: of a small grid the others are left as they are.
    ///
    /// # Panics
    /// As for [`SecondaryCutting::judge`], and if there is no point of a number.
    pub fn judge_some(&self, points: &mut [SurfacePoint], counts: [usize; 2], wanted: &[usize]) -> Judged {
        self.judged(points, counts, (None, Some(wanted)))
    }

    /// The same of points that another tool generates, by one that also cuts the work, along motions of its own: marked as
    /// [`CutBy::Other`]`(number)`. Nothing is looked at if there are several motions. Gives back whether all positions were.
    ///
    /// # Panics
    /// As for [`SecondaryCutting::judge`].
    pub(crate) fn judge_of_another(&self, points: &mut [SurfacePoint], counts: [usize; 2], number: usize) -> bool {
        self.ranges.len() == 1 && self.judged(points, counts, (Some(number), None)).unseen.is_none()
    }

    /// Whether a point that another tool generates, and that was judged not to be cut away, lies before the tool's surface in all positions, and
    /// never beyond an end of it.
    pub(crate) fn is_clear_of(&self, point: &SurfacePoint) -> bool {
        let mut judge = Judge::new(self, point, false);
        let ways = judge.ways(&[point], &[self.motions(point, false)], 0);
        judge.seen.iter_mut().all(|seen| seen.never_over(&ways[0]))
    }

    /// `of_another` is the number by which the tool is named if it does not generate the points.
    fn judged(
        &self,
        points: &mut [SurfacePoint],
        counts: [usize; 2],
        (of_another, wanted): (Option<usize>, Option<&[usize]>),
    ) -> Judged {
        assert_eq!(points.len(), counts[0] * counts[1], "one point for each place of the grid");
        let mut judged = Judged::default();
        let is_solved = |point: &&SurfacePoint| point.outcome == Outcome::Solved;
        let Some(middle) = points.iter().filter(is_solved).nth(points.iter().filter(is_solved).count() / 2) else {
            return judged;
        };
        if self.ranges.is_empty() {
            return judged;
        }
        let judge = Judge::new(self, middle, of_another.is_none());
        let mut spread = Spread { judge, points, counts, verdicts: vec![None; points.len()], is_spent: false };
        spread.all(wanted);
        let Spread { verdicts, is_spent, .. } = spread;
        for (point, verdict) in points.iter_mut().zip(verdicts) {
            let Some(Some(cut)) = verdict else { continue };
            point.outcome = Outcome::CutAway(of_another.map_or(CutBy::ItsToolElsewhere(cut.by), CutBy::Other));
            match judged.deepest.iter_mut().find(|(by, _)| *by == cut.by) {
                Some((_, depth)) => *depth = depth.max(cut.depth),
                None => judged.deepest.push((cut.by, cut.depth)),
            }
        }
        judged.unseen = match is_spent {
            true => Some(Unseen::Budget),
            false => (self.ranges.len() > 1).then_some(Unseen::SeveralMotions),
        };
        judged
    }
}

impl SecondaryCutting {
    /// The motions at which the tool generates a point; those in the middle of their ranges if it does not.
    fn motions(&self, point: &SurfacePoint, is_own: bool) -> Vec<f64> {
        let own = &point.unknowns[point.unknowns.len().saturating_sub(self.ranges.len())..];
        if is_own { own.to_vec() } else { self.ranges.iter().map(|range| range.middle()).collect() }
    }
}

impl<'c> Judge<'c> {
    fn new(cutting: &'c SecondaryCutting, middle: &SurfacePoint, is_own: bool) -> Judge<'c> {
        let count = cutting.ranges.len();
        let motions = cutting.motions(middle, is_own);
        let position = Vector3::from(middle.position);
        let mut poses = Poses::new(cutting, &motions, &position);
        let values: Vec<Vec<f64>> = (0..count).map(|k| poses.values(&motions, k, &position)).collect();
        let fixed =
            if count == 1 { values[0].iter().map(|value| poses.at(&[*value], 0)).collect() } else { Vec::new() };
        let seen = cutting.pieces.iter().map(|piece| piece.seen()).collect();
        Judge { cutting, poses, seen, values, fixed, is_own, looks: 0 }
    }

    /// The verdicts on some points.
    fn verdicts(&mut self, points: &[&SurfacePoint]) -> Vec<Verdict> {
        let mut deepest: Vec<Verdict> = vec![None; points.len()];
        let motions: Vec<Vec<f64>> = points.iter().map(|point| self.cutting.motions(point, self.is_own)).collect();
        for running in 0..self.cutting.ranges.len() {
            let ways = self.ways(points, &motions, running);
            for number in 0..self.seen.len() {
                let (before, rest) = self.seen.split_at_mut(number);
                let Some((seen, after)) = rest.split_first_mut() else { continue };
                let mut others = [before, after];
                let (sights, looks) = seen.sights(&ways);
                self.looks += points.len() as u64 + looks;
                let each = points.iter().zip(&motions).zip(sights).zip(&mut deepest);
                for (((point, motions), mut sights), deepest) in each {
                    let (point, motions) = (Vector3::from(point.position), motions.clone());
                    let (poses, others) = (&mut self.poses, &mut others);
                    let mut way = Way { poses, seen, others, point, motions, running, looks: 0 };
                    let cut = way.cut(&mut sights);
                    self.looks += way.looks;
                    *deepest = (*deepest).into_iter().chain(cut).reduce(Cut::deeper);
                }
            }
            if !self.is_own {
                for (places, deepest) in ways.iter().zip(&mut deepest).filter(|(_, deepest)| deepest.is_none()) {
                    *deepest = always_in(&mut self.seen, places);
                }
            }
        }
        deepest
    }

    /// Where points are in the tool's frame while one of the motions runs, and the others stay; one of the places of each is its own if the
    /// tool generates it.
    fn ways(&mut self, points: &[&SurfacePoint], motions: &[Vec<f64>], running: usize) -> Vec<Vec<Place>> {
        let values = &self.values[running];
        let at = |motions: &Vec<f64>, value: f64| {
            let mut at = motions.clone();
            at[running] = value;
            at
        };
        // poses that are not the same for all points, point by point
        let each = if self.fixed.is_empty() { values.as_slice() } else { &[] };
        let wanted = motions.iter().flat_map(|motions| {
            let own = self.is_own.then_some(motions[running]);
            each.iter().copied().chain(own).map(move |value| at(motions, value))
        });
        let wanted: Vec<Vec<f64>> = wanted.collect();
        let mut poses = self.poses.at_each(&wanted, running).into_iter();
        let way = |(point, motions): (&&SurfacePoint, &Vec<f64>)| {
            let position = Vector3::from(point.position);
            let mut next = || poses.next().expect("a pose for each place that was wanted");
            let mut places: Vec<Place> = Vec::with_capacity(values.len() + 1);
            for (number, value) in values.iter().enumerate() {
                let pose = self.fixed.get(number).copied().unwrap_or_else(&mut next);
                places.push(pose.place(*value, &position));
            }
            if self.is_own {
                let here = next().place(motions[running], &position);
                let after = places.partition_point(|place| place.motion < here.motion);
                match places.get_mut(after) {
                    Some(place) if place.motion == here.motion => *place = here,
                    _ => places.insert(after, here),
                }
            }
            places
        };
        points.iter().zip(motions).map(way).collect()
    }
}

/// The cut of a point that is in the steel behind some piece at all its places: it enters that nowhere, as it never comes out.
fn always_in(seen: &mut [Seen<'_>], places: &[Place]) -> Option<Cut> {
    let count = seen.len();
    let one = |number: usize| {
        let (before, rest) = seen.split_at_mut(number);
        let (seen, after) = rest.split_first_mut()?;
        seen.always_over(places, &mut [before, after])
    };
    (0..count).filter_map(one).reduce(Cut::deeper)
}

/// Verdicts that spread over a grid.
struct Spread<'p, 'c> {
    judge: Judge<'c>,
    points: &'p [SurfacePoint],
    counts: [usize; 2],
    verdicts: Vec<Option<Verdict>>,
    is_spent: bool,
}

impl Spread<'_, '_> {
    fn all(&mut self, wanted: Option<&[usize]>) {
        if self.points.len() <= FEW && self.judge.values.len() == 1 {
            let wanted = wanted.map_or_else(|| (0..self.points.len()).collect(), <[usize]>::to_vec);
            wanted.chunks(TOGETHER).for_each(|together| self.look_at(together));
            return;
        }
        let [rows, columns] = self.counts.map(lines);
        for i in rows.windows(2) {
            for j in columns.windows(2) {
                self.block([i[0], i[1]], [j[0], j[1]]);
            }
        }
    }

    /// Makes the verdicts on some points known, as far as they are solved and the budget goes.
    fn look_at(&mut self, together: &[usize]) {
        let is_open = |at: &usize| self.points[*at].outcome == Outcome::Solved && self.verdicts[*at].is_none();
        let mut open: Vec<usize> = together.iter().copied().filter(is_open).collect();
        open.dedup();
        let [most, each] = MOST_LOOKS;
        if !open.is_empty() && self.judge.looks > most + each * self.counts.iter().sum::<usize>() as u64 {
            self.is_spent = true;
            return;
        }
        let points: Vec<&SurfacePoint> = open.iter().map(|at| &self.points[*at]).collect();
        let verdicts = self.judge.verdicts(&points);
        open.into_iter().zip(verdicts).for_each(|(at, verdict)| self.verdicts[at] = Some(verdict));
    }

    /// A block between rows and columns: of one verdict if its corners are.
    fn block(&mut self, rows: [usize; 2], columns: [usize; 2]) {
        let corners = rows.into_iter().flat_map(|i| columns.map(|j| i * self.counts[1] + j));
        let corners: Vec<usize> = corners.collect();
        self.look_at(&corners);
        let known: Vec<Option<Verdict>> = corners.iter().map(|at| self.verdicts[*at]).collect();
        let [high, wide] = [rows, columns].map(|[from, to]| to - from);
        if self.is_spent || (high <= 1 && wide <= 1) {
            return;
        }
        let solved: Vec<Verdict> = known.iter().flatten().copied().collect();
        let number = |verdict: &Verdict| verdict.map(|cut| cut.by);
        let is_one = solved.len() == 4 && solved.iter().all(|verdict| number(verdict) == number(&solved[0]));
        let mut has_local = false;
        let mut inside = Vec::new();
        for i in rows[0]..=rows[1] {
            let first = i * self.counts[1];
            for at in first + columns[0]..=first + columns[1] {
                match self.points[at].outcome {
                    Outcome::Solved => inside.push(at),
                    outcome => has_local |= outcome == Outcome::CutAway(CutBy::ItsTool),
                }
            }
        }
        if is_one && !has_local {
            for at in inside {
                self.verdicts[at].get_or_insert(solved[0]);
            }
            return;
        }
        if inside.is_empty() {
            return;
        }
        if high >= wide {
            let middle = rows[0] + high / 2;
            self.block([rows[0], middle], columns);
            self.block([middle, rows[1]], columns);
        } else {
            let middle = columns[0] + wide / 2;
            self.block(rows, [columns[0], middle]);
            self.block(rows, [middle, columns[1]]);
        }
    }
}

/// The first line, the last, and some between them.
fn lines(count: usize) -> Vec<usize> {
    let mut lines: Vec<usize> = (0..=PARTS).map(|k| k * (count - 1) / PARTS).collect();
    lines.dedup();
    if lines.len() == 1 { vec![0, 0] } else { lines }
}
