//! The line in which two surfaces of a tooth space meet, followed along the space.

use std::cell::RefCell;

use flank_solver::{Blank, Intersection, Line, Meeting, Outcome, SurfacePoint};

use crate::solve::body::piece::{Piece, SAME_LINE, apart};

/// How far along a space the line is followed at once, as a share: a twentieth of a turn of a worm's thread that winds three times.
const STRIDE: f64 = 1.0 / 64.0;
/// What a radian, or a millimetre, of an unknown counts beside distances: it decides between points at one place.
const TURNED: f64 = 1e-3;
/// Pairs of known points from which a meeting is looked for.
const KNOWN_PAIRS: usize = 4;

/// Where two surfaces meet, as far as that has been asked for.
pub(crate) struct Course<'j, 'g> {
    /// Meetings lie on lines of the first.
    pieces: [Piece<'j, 'g>; 2],
    /// Whether that is the second of those it was made of.
    is_swapped: bool,
    /// The unknown of the first by which lines are told apart.
    across: usize,
    intersection: Intersection,
    /// An unknown of each with its value on another line that both have in common.
    other: Option<[(usize, f64); 2]>,
    /// By their shares along the space, in this order.
    found: RefCell<Vec<(f64, Meeting)>>,
}

impl<'j, 'g> Course<'j, 'g> {
    /// Of surfaces that meet at all of some shares along.
    pub(crate) fn new(pieces: [&Piece<'j, 'g>; 2], blank: &Blank, along: &[f64]) -> Option<Course<'j, 'g>> {
        Course::beside(pieces, None, blank, along)
    }

    /// The same where they have another line in common, on which an unknown of each has a value.
    pub(crate) fn beside(
        pieces: [&Piece<'j, 'g>; 2],
        other: Option<[(usize, f64); 2]>,
        blank: &Blank,
        along: &[f64],
    ) -> Option<Course<'j, 'g>> {
        let [first, second] = pieces;
        let whole = |course: Option<Course<'j, 'g>>| course.filter(|course| course.at(blank, along).is_some());
        let swapped = other.map(|[a, b]| [b, a]);
        let turned = || Some(Course { is_swapped: true, ..whole(Course::across([second, first], swapped, blank))? });
        whole(Course::across(pieces, other, blank)).or_else(turned)
    }

    fn across(
        [first, second]: [&Piece<'j, 'g>; 2],
        other: Option<[(usize, f64); 2]>,
        blank: &Blank,
    ) -> Option<Course<'j, 'g>> {
        let across = first.across_tool(blank)?;
        let intersection = Intersection::new([&first.bound(), &second.bound()], first.across(across, blank)).ok()?;
        let pieces = [first.clone(), second.clone()];
        Some(Course { pieces, is_swapped: false, across, intersection, other, found: RefCell::default() })
    }

    /// A point at each share along, as points of both; `None` where one is not found.
    pub(crate) fn at(&self, blank: &Blank, along: &[f64]) -> Option<Vec<[SurfacePoint; 2]>> {
        let middle = along.len() / 2;
        let outwards = (middle..along.len()).chain((0..middle).rev());
        for k in outwards {
            self.reach(blank, along[k])?;
        }
        let found = self.found.borrow();
        let both = |share: &f64| {
            let known = found.iter().find(|(known, _)| known == share);
            known.map(|(_, meeting)| self.in_order([meeting.first.clone(), meeting.second.clone()]))
        };
        along.iter().map(both).collect()
    }

    fn in_order<T>(&self, [first, second]: [T; 2]) -> [T; 2] {
        if self.is_swapped { [second, first] } else { [first, second] }
    }

    fn is_on_other(&self, meeting: &Meeting) -> bool {
        let points = [&meeting.first, &meeting.second];
        let is_at = |k: usize, (unknown, value): (usize, f64)| (points[k].unknowns[unknown] - value).abs() <= SAME_LINE;
        self.other.is_some_and(|of| (0..2).all(|k| is_at(k, of[k])))
    }

    /// Follows the line from where it is known to a share.
    fn reach(&self, blank: &Blank, to: f64) -> Option<()> {
        let off = |(share, _): &&(f64, Meeting)| (share - to).abs();
        let from = self.found.borrow().iter().min_by(|a, b| off(a).total_cmp(&off(b))).map(|(share, _)| *share);
        for share in strides(from, to) {
            let meeting = self.near(blank, share)?;
            let mut found = self.found.borrow_mut();
            let place = found.partition_point(|(known, _)| *known < share);
            found.insert(place, (share, meeting));
        }
        Some(())
    }

    /// The meeting at a share: as the line goes on, or the one that lies nearest to known points of both surfaces.
    fn near(&self, blank: &Blank, share: f64) -> Option<Meeting> {
        let [first, second] = self.pieces.each_ref();
        let along = |point: &SurfacePoint| (first.along_of(blank, point) - share).abs();
        let least = |meetings: Vec<Meeting>, off: &dyn Fn(&Meeting) -> f64| {
            let is_left = |meeting: &Meeting| meeting.first.outcome == Outcome::Solved && !self.is_on_other(meeting);
            let meetings = meetings.into_iter().filter(is_left);
            meetings.min_by(|a, b| off(a).total_cmp(&off(b)))
        };
        let line = |near: &SurfacePoint| Line { from: [near.unknowns[self.across], share], direction: [1.0, 0.0] };
        let near: Vec<&SurfacePoint> = first.known.iter().collect();
        let found = self.found.borrow();
        if let Some((starts, before)) = starts(&found, share) {
            let off = |meeting: &Meeting| {
                meeting.unknowns().iter().zip(&starts[0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            let on_line = |near: &[&SurfacePoint]| self.intersection.on_line(line(&before.first), &starts, near);
            // known points take up the line where it bends away from how it went
            return least(on_line(&[&before.first]), &off).or_else(|| least(on_line(&near), &off));
        }
        let nearest = near.iter().min_by(|a, b| along(a).total_cmp(&along(b)))?;
        let known = known_pairs([first, second], blank, share);
        let off = |meeting: &Meeting| far(first, &meeting.first) + far(second, &meeting.second);
        least(self.intersection.on_line(line(nearest), &known, &near), &off)
    }
}

/// Where a meeting may lie: as the two nearest ones go on, and where the nearest one is, which is told, too.
fn starts(found: &[(f64, Meeting)], share: f64) -> Option<(Vec<Vec<f64>>, &Meeting)> {
    let mut nearest: Vec<&(f64, Meeting)> = found.iter().collect();
    nearest.sort_by(|a, b| (a.0 - share).abs().total_cmp(&(b.0 - share).abs()));
    match nearest[..] {
        [] => None,
        [(_, meeting)] => Some((vec![meeting.unknowns()], meeting)),
        [(to, last), (from, before), ..] => {
            let by = (share - to) / (to - from);
            let (last_unknowns, before) = (last.unknowns(), before.unknowns());
            let on = before.iter().zip(&last_unknowns).map(|(a, b)| b + by * (b - a)).collect();
            Some((vec![on, last_unknowns], last))
        }
    }
}

/// Unknowns of known points of both surfaces that lie near each other, those of the first about as far along the space as is asked for.
fn known_pairs([first, second]: [&Piece<'_, '_>; 2], blank: &Blank, share: f64) -> Vec<Vec<f64>> {
    let off = |point: &SurfacePoint| (first.along_of(blank, point) - share).abs();
    let least = first.known.iter().map(off).fold(f64::INFINITY, f64::min);
    let beside = first.known.iter().filter(|point| off(point) <= least + STRIDE);
    let pairs = beside.flat_map(|a| second.known.iter().map(move |b| (apart(a.position, b.position), a, b)));
    let mut pairs: Vec<(f64, &SurfacePoint, &SurfacePoint)> = pairs.collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    pairs.into_iter().take(KNOWN_PAIRS).map(|(_, a, b)| [&a.unknowns[..], &b.unknowns].concat()).collect()
}

/// How far a point lies from known ones of a surface, also by its unknowns: whole turns of a parameter leave it where it is.
fn far(piece: &Piece<'_, '_>, point: &SurfacePoint) -> f64 {
    let turned =
        |known: &SurfacePoint| -> f64 { known.unknowns.iter().zip(&point.unknowns).map(|(a, b)| (a - b).abs()).sum() };
    let far = piece.known.iter().map(|known| apart(known.position, point.position) + TURNED * turned(known));
    far.fold(f64::INFINITY, f64::min)
}

/// The shares on the way from one that is known to another, in steps over which a thread turns little.
fn strides(from: Option<f64>, to: f64) -> Vec<f64> {
    let Some(from) = from else { return vec![to] };
    let count = ((to - from).abs() / STRIDE).ceil() as usize;
    (1..=count).map(|step| if step == count { to } else { from + (to - from) * step as f64 / count as f64 }).collect()
}
