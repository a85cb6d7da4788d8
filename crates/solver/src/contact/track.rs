//! A pair of teeth step by step of the roll: at each the contact that opens the pair most.

use std::collections::BTreeMap;

use crate::contact::ContactProblem;
use crate::contact::point::ContactPoint;
use crate::contact::watch::{HIGHER, Watching};

/// Places that open the pair more than what is known, the highest first, from which a contact is looked for at a roll position.
const STARTS: usize = 6;
/// Positions of a pitch at which all places are looked at.
const LOOKS: isize = 12;
/// A pair of teeth that stays behind the one that carries by more than this, mm along the normal, is not looked for where it is lost: patterns
/// show nothing of teeth that are farther apart.
const NEAR: f64 = 0.2;

/// A pair of teeth, and how it is followed.
#[derive(Clone)]
pub(super) struct Track<'p> {
    problem: &'p ContactProblem,
    /// The roll position of step 0, and how far it is to the next pair of teeth.
    from: f64,
    length: f64,
    limits: [f64; 2],
    /// Steps from one pair of teeth to the next.
    pitch: isize,
    points: BTreeMap<isize, ContactPoint>,
    /// At each step the height of the place that opens the pair most, and its opening.
    highest: BTreeMap<isize, [f64; 2]>,
}

impl<'p> Track<'p> {
    /// With the contact of its step 0, followed to both sides.
    pub(super) fn new(
        problem: &'p ContactProblem,
        from: &ContactPoint,
        (length, steps, limits): (f64, usize, [f64; 2]),
    ) -> Track<'p> {
        let to = |way: isize| {
            let points = BTreeMap::from([(0, from.clone())]);
            let (pitch, highest) = (steps as isize, BTreeMap::new());
            let mut track = Track { problem, from: from.roll, length, limits, pitch, points, highest };
            track.follow(0, from, way);
            track
        };
        let (before, after) = rayon::join(|| to(-1), || to(1));
        before.joined(after)
    }

    /// The same where no place of the teeth opens the pair more, as far as all that are looked at say.
    pub(super) fn watched(&self) -> Track<'p> {
        let to = |way: isize| {
            let mut track = self.clone();
            track.watch(way);
            track
        };
        let (before, after) = rayon::join(|| to(-1), || to(1));
        before.joined(after)
    }

    /// Where a step is on the roll, if it is within its limits.
    pub(super) fn roll(&self, step: isize) -> Option<f64> {
        let roll = self.from + step as f64 * self.length / self.pitch as f64;
        (self.limits[0]..=self.limits[1]).contains(&roll).then_some(roll)
    }

    /// The height of the pair that carries at a step, as far as it is known.
    fn carrying(&self, step: isize) -> Option<f64> {
        let (first, last) = (self.points.keys().next()?, *self.points.keys().next_back()?);
        let behind = (step - first).rem_euclid(self.pitch) + first;
        // a contact may stand alone, with none at the steps beside it
        let pairs = (behind..=last).step_by(self.pitch.unsigned_abs()).filter_map(|step| self.points.get(&step));
        pairs.map(ContactPoint::height).reduce(f64::max)
    }

    fn is_higher(&self, step: isize, point: &ContactPoint) -> bool {
        self.points.get(&step).is_none_or(|present| point.is_beyond(present.height()))
    }

    /// Follows a contact from its step towards one side, as long as nothing that is known opens the pair as much.
    fn follow(&mut self, from: isize, point: &ContactPoint, way: isize) {
        let (mut step, mut last) = (from + way, point.clone());
        while let Some(next) = self.roll(step).and_then(|roll| self.problem.followed(&last, roll)) {
            if !self.is_higher(step, &next) {
                return;
            }
            self.points.insert(step, next.clone());
            (step, last) = (step + way, next);
        }
    }

    /// A contact at a step, followed both ways, unless one that is known opens the pair as much.
    fn put(&mut self, step: isize, point: ContactPoint) {
        if self.is_higher(step, &point) {
            self.follow(step, &point, -1);
            self.follow(step, &point, 1);
            self.points.insert(step, point);
        }
    }

    /// Looks at all places from the beginning towards one side, to where the teeth have none in common any more: at some positions of each
    /// pitch, and wherever what touches is another thing than a position before.
    fn watch(&mut self, way: isize) {
        let (Some(mut watching), Some(mut near)) = (self.problem.watching_places(), self.points.get(&0).cloned())
        else {
            return;
        };
        let stride = (self.pitch / LOOKS).max(1);
        let mut step = if way < 0 { -1 } else { 0 };
        while let Some(roll) = self.roll(step) {
            let goes_on = self.points.get(&step).is_some_and(|point| point.edges == near.edges);
            let is_near = (!goes_on || step % stride == 0) && self.look(&mut watching, (step, roll), &near);
            match self.points.get(&step) {
                Some(present) => near = present.clone(),
                None if is_near => {}
                None => return,
            }
            step += way;
        }
    }

    /// Looks at all places at a step, near a contact. Whether some of them are near to touching.
    fn look(&mut self, watching: &mut Watching<'_>, (step, roll): (isize, f64), near: &ContactPoint) -> bool {
        let passed = watching.passed(self.problem, roll, near);
        let carrying = self.carrying(step).unwrap_or(f64::NEG_INFINITY);
        let nearly = watching.beyond(&passed, carrying - NEAR / near.opening.abs());
        let is_near = !nearly.is_empty();
        let (from, beside) = match self.points.get(&step) {
            Some(present) => (watching.beyond(&passed, carrying), watching.beside(&passed, present, carrying)),
            None => (nearly, Vec::new()),
        };
        let from = from.into_iter().take(STARTS).map(|at| (at, true));
        for (at, is_vital) in from.chain(beside.into_iter().map(|at| (at, false))) {
            let Some(place) = &passed[at] else { continue };
            let known = self.points.get(&step).map_or(f64::NEG_INFINITY, ContactPoint::height);
            if is_vital && (place.height - known) * place.opening <= HIGHER {
                continue;
            }
            let edges = &watching.places[at].1.edges;
            if let Some(found) = self.problem.contact_beside(place, (edges, is_vital), roll, known) {
                self.put(step, found);
            }
        }
        let highest = watching.beyond(&passed, f64::NEG_INFINITY).first().and_then(|at| passed[*at].as_ref());
        self.highest.extend(highest.map(|place| (step, [place.height, place.opening])));
        is_near
    }

    /// Of two, at each step the contact that opens the pair more.
    fn joined(mut self, other: Track<'p>) -> Track<'p> {
        for (step, point) in other.points {
            if self.is_higher(step, &point) {
                self.points.insert(step, point);
            }
        }
        self.highest.extend(other.highest);
        self
    }

    /// Roll positions at which a place opens the pair more than any contact that is known.
    pub(super) fn missed(&self) -> Vec<f64> {
        // where a flank is known in part only, it may go on to what touches where no contact is known
        let is_known = self.problem.outlines.iter().flatten().all(|outline| !outline.is_open());
        let is_open = |(step, [height, opening]): (&isize, &[f64; 2])| {
            if !is_known && !self.points.contains_key(step) {
                return None;
            }
            let carrying = self.carrying(*step).unwrap_or(f64::NEG_INFINITY);
            ((height - carrying) * opening > HIGHER).then(|| self.roll(*step)).flatten()
        };
        self.highest.iter().filter_map(is_open).collect()
    }

    /// The first step from which the pair touches at each one through step 0, and its contacts from there on.
    pub(super) fn contiguous(&self) -> (isize, Vec<ContactPoint>) {
        let is_there = |step: &isize| self.points.contains_key(step);
        let first = (0..).map(|k: isize| -k).take_while(is_there).last().unwrap_or(0);
        let points = (first..).map_while(|step| self.points.get(&step).cloned());
        (first, points.collect())
    }
}
