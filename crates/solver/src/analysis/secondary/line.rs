//! The way of one point of the work through the tool's frame while one motion runs, and where it enters the steel.

use flank_expr::{InstructionSet, LANES};
use nalgebra::{Matrix3, Vector3};

use crate::analysis::secondary::SecondaryCutting;
use crate::analysis::secondary::cells::Near;
use crate::analysis::secondary::net::{Foot, Found, Piece, Seen, Side};
use crate::analysis::secondary::slip::Slip;
use crate::equations::runner::Runner;

/// A tool slides in itself between two places by no more than this angle, rad.
pub(super) const MOST_SLIP: f64 = std::f64::consts::PI;
/// A point less deep in the steel than this, mm, is only touched: points are good to this.
const TOUCH: f64 = 1e-9;
/// How much longer than by the speeds at its ends a way may be.
const LONGER: f64 = 1.25;
/// Where the cubic through clearances and their slopes stays above this share of the smaller one, so does the clearance.
const CLEAR: f64 = 0.3;
/// A way is short beside the distance of two parts of a piece that it leads by if it is no longer than this share of it.
const APART: f64 = 0.5;
/// Halvings of the way between two places. About a clearance that is least they find a depth of [`TOUCH`].
const MOST_HALVINGS: u32 = 14;
/// The depth is measured to feet that lie beyond the end of a piece by no more than this share of it.
const PAST: f64 = 0.01;
/// Halvings of the way until a place in the steel is found, and the one where the way comes out again: to rounding.
const MOST_ENTERED: usize = 40;
/// A piece is nearer than another one if it is no farther away than this share of that: at an edge both are as near.
const NEARER: f64 = 1.0 - 1e-9;
/// Steps in which the greatest depth is looked for.
const STEPS_DOWN: usize = 30;

/// The pose of the work in the tool, and its derivative by the motion, less what the tool slides in itself meanwhile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    rotation: [Matrix3<f64>; 2],
    translation: [Vector3<f64>; 2],
}

/// A point of the work in the tool's frame at one value of the motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) motion: f64,
    point: Vector3<f64>,
    /// Less that of the tool's own slip.
    velocity: Vector3<f64>,
    speed: f64,
}

/// A place as a piece of the tool sees it.
#[derive(Clone, Copy)]
pub(super) struct Sight {
    place: Place,
    near: Near,
    /// Once it was looked for.
    found: Option<Found>,
}

/// The tool cuts a point away.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    /// The number of the piece that does.
    pub(super) by: usize,
    /// How deep in the steel the point lies at least.
    pub(super) depth: f64,
}

impl Cut {
    pub(super) fn deeper(self, other: Cut) -> Cut {
        if other.depth > self.depth { other } else { self }
    }
}

/// The position of the work in the tool, for one motion after the other.
pub(super) struct Poses<'c> {
    cutting: &'c SecondaryCutting,
    evaluator: Runner<'c>,
    out: Vec<f64>,
    /// By how much of an angle the tool slides in itself while each motion runs, about.
    slides: Vec<f64>,
}

impl<'c> Poses<'c> {
    /// `point` of the work, generated at `motions`, stands for all.
    pub(super) fn new(cutting: &'c SecondaryCutting, motions: &[f64], point: &Vector3<f64>) -> Poses<'c> {
        let out = vec![0.0; cutting.pose.output_count()];
        let slides = vec![0.0; cutting.ranges.len()];
        let mut poses = Poses { cutting, evaluator: cutting.pose.runner(), out, slides };
        if let Some(slip) = &cutting.slip {
            poses.slides = (0..cutting.ranges.len()).map(|k| poses.slide(slip, motions, k, point)).collect();
        }
        poses
    }

    /// How fast a point turns with the slip at the middle of several parts of a motion's range, on the average.
    fn slide(&mut self, slip: &Slip, motions: &[f64], running: usize, point: &Vector3<f64>) -> f64 {
        const PARTS: usize = 8;
        let range = self.cutting.ranges[running];
        let mut at = motions.to_vec();
        let mut sum = 0.0;
        for k in 0..PARTS {
            at[running] = range.at((k as f64 + 0.5) / PARTS as f64);
            let place = self.at(&at, running).place(at[running], point);
            let along = slip.velocity(&place.point);
            sum += place.velocity.dot(&along) / along.norm_squared();
        }
        sum / PARTS as f64
    }

    /// The angle of the slip from one place to another while a motion runs.
    pub(super) fn slipped(&self, running: usize, from: &Place, to: &Place) -> f64 {
        self.slides[running] * (to.motion - from.motion)
    }

    /// At values of the motions, with the derivative by the one of a number.
    pub(super) fn at(&mut self, motions: &[f64], running: usize) -> Pose {
        self.evaluator.run(motions, &mut self.out);
        self.pose(running, |k| self.out[k])
    }

    /// From the outputs of the tape.
    fn pose(&self, running: usize, out: impl Fn(usize) -> f64) -> Pose {
        let mut pose = Pose::of(running, out);
        if let Some(slip) = &self.cutting.slip {
            pose.slow(slip, self.slides[running]);
        }
        pose
    }

    /// The same at many values of the motions.
    pub(super) fn at_each(&mut self, motions: &[Vec<f64>], running: usize) -> Vec<Pose> {
        let (slip, slide) = (self.cutting.slip.as_ref(), self.slides[running]);
        let Some(lanes) = self.evaluator.lanes() else {
            return motions.iter().map(|motions| self.at(motions, running)).collect();
        };
        let mut poses = Vec::with_capacity(motions.len());
        for together in motions.chunks(LANES) {
            for (lane, motions) in together.iter().enumerate() {
                motions.iter().enumerate().for_each(|(k, value)| lanes.input(k)[lane] = *value);
            }
            lanes.run_first(together.len());
            poses.extend((0..together.len()).map(|lane| Pose::of(running, |k| lanes.output(k)[lane])));
        }
        if let Some(slip) = slip {
            poses.iter_mut().for_each(|pose| pose.slow(slip, slide));
        }
        poses
    }

    /// The motion's values that are looked at first: the way of a point bends little from one to the next.
    pub(super) fn values(&mut self, motions: &[f64], running: usize, point: &Vector3<f64>) -> Vec<f64> {
        const FEWEST: usize = 8;
        const MOST: usize = 1024;
        const BEND: f64 = 0.3;
        let range = self.cutting.ranges[running];
        let mut at = motions.to_vec();
        let slide = self.slides[running];
        let mut count = FEWEST.max((slide.abs() * range.width() / MOST_SLIP).ceil() as usize).min(MOST);
        loop {
            let values: Vec<f64> = (0..=count).map(|k| range.at(k as f64 / count as f64)).collect();
            let places: Vec<Place> = values
                .iter()
                .map(|value| {
                    at[running] = *value;
                    self.at(&at, running).place(*value, point)
                })
                .collect();
            let most = BEND * places.iter().map(|place| place.speed).fold(0.0, f64::max);
            // places whole turns apart have one velocity, but lie not where it leads
            let bends = |pair: &[Place]| {
                let span = pair[1].motion - pair[0].motion;
                let back = -slide * span;
                let slid = self.cutting.slip.map(|slip| slip.turned(&pair[1].velocity, back));
                let velocity = slid.unwrap_or(pair[1].velocity);
                let point = self.cutting.slip.map_or(pair[1].point, |slip| slip.moved(&pair[1].point, back));
                let led = 0.5 * span * (pair[0].velocity + velocity);
                (velocity - pair[0].velocity).norm() > most || (point - pair[0].point - led).norm() > most * span
            };
            if count >= MOST || !places.windows(2).any(bends) {
                return values;
            }
            count *= 2;
        }
    }
}

impl Pose {
    /// From the outputs of the tape of poses.
    fn of(running: usize, out: impl Fn(usize) -> f64) -> Pose {
        let matrix = |from: usize| Matrix3::from_fn(|row, column| out(from + 3 * row + column));
        let vector = |from: usize| Vector3::from_fn(|row, _| out(from + row));
        let [own, derived] = [0, 12 * (1 + running)];
        Pose { rotation: [matrix(own), matrix(derived)], translation: [vector(own + 9), vector(derived + 9)] }
    }

    /// Less the velocity of a tool that slides in itself by an angle for each unit of the motion.
    fn slow(&mut self, slip: &Slip, slide: f64) {
        for column in 0..3 {
            let along = slip.turning(&self.rotation[0].column(column).into_owned());
            let slower = self.rotation[1].column(column) - slide * along;
            self.rotation[1].set_column(column, &slower);
        }
        self.translation[1] -= slide * slip.velocity(&self.translation[0]);
    }

    pub(super) fn place(&self, motion: f64, point: &Vector3<f64>) -> Place {
        let velocity = self.rotation[1] * point + self.translation[1];
        Place { motion, point: self.rotation[0] * point + self.translation[0], velocity, speed: velocity.norm() }
    }
}

/// The pieces of a tool that come before one, and those behind it.
pub(super) type Others<'o, 'c> = [&'o mut [Seen<'c>]; 2];

/// One point of the work, one motion that runs, one piece of the tool.
pub(super) struct Way<'w, 'o, 'c> {
    pub(super) poses: &'w mut Poses<'c>,
    pub(super) seen: &'w mut Seen<'c>,
    /// The other pieces of the tool.
    pub(super) others: &'w mut Others<'o, 'c>,
    /// Of the work.
    pub(super) point: Vector3<f64>,
    pub(super) motions: Vec<f64>,
    pub(super) running: usize,
    /// Feet that were looked for.
    pub(super) looks: u64,
}

impl<'c> Seen<'c> {
    /// The places of some ways, one way after the other, as the piece sees them, those that are beside it with their feet. Also how many feet
    /// were looked for.
    pub(super) fn sights(&mut self, ways: &[Vec<Place>]) -> (Vec<Vec<Option<Sight>>>, u64) {
        let mut sights: Vec<Vec<Option<Sight>>> = Vec::with_capacity(ways.len());
        for places in ways {
            let beside = sights.last().map_or(&[][..], Vec::as_slice);
            let next = InstructionSet::widest().dispatch(
                #[inline(always)]
                || self.piece.sights(places, beside),
            );
            sights.push(next);
        }
        let mut wanted: Vec<&mut Sight> = Vec::new();
        for way in &mut sights {
            let is_near = |pair: [Option<&Sight>; 2]| matches!(pair, [Some(a), Some(b)] if a.may_meet(b));
            let near: Vec<bool> = way.windows(2).map(|pair| is_near([pair[0].as_ref(), pair[1].as_ref()])).collect();
            let is_wanted =
                |at: usize| near.get(at) == Some(&true) || at.checked_sub(1).is_some_and(|before| near[before]);
            wanted.extend(
                way.iter_mut().enumerate().filter(|(at, _)| is_wanted(*at)).filter_map(|(_, sight)| sight.as_mut()),
            );
        }
        let starts: Vec<_> = wanted.iter().map(|sight| (sight.place.point, sight.near.at)).collect();
        let found = self.feet(&starts);
        wanted.into_iter().zip(found).for_each(|(sight, found)| sight.found = Some(found));
        (sights, starts.len() as u64)
    }

    /// The clearance of each of some places at the nearest foot, `None` where that lies beyond an end of the piece.
    fn clearances(&mut self, places: &[Place]) -> impl Iterator<Item = Option<f64>> {
        let mut before: Option<Near> = None;
        places.iter().map(move |place| {
            let near = self.piece.near(&place.point, f64::INFINITY, [before.as_ref(), None])?;
            before = Some(near);
            let Found::Foot(foot) = self.foot(&place.point, near.at) else { return None };
            (self.piece.side(foot.at) == [0, 0]).then_some(foot.clearance)
        })
    }

    /// The cut of a point that is in the steel behind the piece at all its places.
    pub(super) fn always_over(&mut self, places: &[Place], others: &mut Others<'_, 'c>) -> Option<Cut> {
        let by = self.piece.number;
        let mut depth = 0.0_f64;
        for (place, clearance) in places.iter().zip(self.clearances(places)) {
            let behind = -clearance.filter(|clearance| *clearance < -TOUCH)?;
            depth = depth.max(Some(behind).filter(|behind| is_in_steel(others, &place.point, *behind))?);
        }
        Some(Cut { by, depth })
    }

    /// Whether a point lies before the piece at all its places.
    pub(super) fn never_over(&mut self, places: &[Place]) -> bool {
        self.clearances(places).all(|clearance| clearance.is_some_and(|clearance| clearance > -TOUCH))
    }
}

/// Whether a point that lies so deep behind a piece of a tool, mm, is in its steel: it has come out where another piece is nearer to it that it
/// lies before.
fn is_in_steel(others: &mut Others<'_, '_>, point: &Vector3<f64>, behind: f64) -> bool {
    others.iter_mut().flat_map(|of| of.iter_mut()).all(|other| {
        let Some(near) = other.piece.near(point, behind, [None, None]) else { return true };
        let Found::Foot(foot) = other.foot(point, near.at) else { return true };
        let is_on = other.piece.side(foot.at) == [0, 0];
        !(is_on && foot.clearance > TOUCH && foot.clearance < NEARER * behind)
    })
}

impl Piece {
    /// Some places, one after the other; none of those so far from the piece that it cannot be met before the next or since the last. The
    /// way of another point may be seen that is `beside` this one.
    #[inline(always)]
    fn sights(&self, places: &[Place], beside: &[Option<Sight>]) -> Vec<Option<Sight>> {
        let mut before: Option<Near> = None;
        let mut sights = Vec::with_capacity(places.len());
        for number in 0..places.len() {
            let (place, last, next) = (&places[number], places[..number].last(), places.get(number + 1));
            let to = |other: Option<&Place>| {
                other.map_or([0.0; 2], |other| [other.speed, (other.motion - place.motion).abs()])
            };
            let ([a, since], [b, until]) = (to(last), to(next));
            let most = LONGER * place.speed.max(a).max(b) * since.max(until);
            let is_far = self.least(&place.point) > most;
            let same = beside.get(number).and_then(Option::as_ref).map(|sight| &sight.near);
            let near = if is_far { None } else { self.near(&place.point, most, [same, before.as_ref()]) };
            before = near.or(before);
            sights.push(near.map(|near| Sight { place: *place, near, found: None }));
        }
        sights
    }
}

impl Sight {
    /// How long the way to the next one may be at the most.
    fn way_to(&self, next: &Sight) -> f64 {
        LONGER * self.place.speed.max(next.place.speed) * (next.place.motion - self.place.motion)
    }

    /// Whether the piece may be met on the way to the next one.
    fn may_meet(&self, next: &Sight) -> bool {
        let way = self.way_to(next);
        self.near.least + next.near.least <= way && self.near.least.max(next.near.least) <= way
    }
}

impl Way<'_, '_, '_> {
    /// Whether the piece cuts the point away on its way through some places, one after the other; one of them is where it is
    /// generated.
    pub(super) fn cut(&mut self, sights: &mut [Option<Sight>]) -> Option<Cut> {
        let mut deepest: Option<Cut> = None;
        for at in 1..sights.len() {
            if let [Some(before), Some(sight)] = &mut sights[at - 1..=at]
                && let Some(cut) = self.between(before, sight, 0)
            {
                deepest = Some(deepest.map_or(cut, |deepest| deepest.deeper(cut)));
            }
        }
        deepest
    }

    /// The place at another value of the motion, not far from one that was seen.
    fn sight_at(&mut self, motion: f64, other: &Sight) -> Option<Sight> {
        let own = std::mem::replace(&mut self.motions[self.running], motion);
        let place = self.poses.at(&self.motions, self.running).place(motion, &self.point);
        self.motions[self.running] = own;
        let near = InstructionSet::widest().dispatch(
            #[inline(always)]
            || self.seen.piece.near(&place.point, f64::INFINITY, [Some(&other.near), None]),
        )?;
        Some(Sight { place, near, found: None })
    }

    /// The foot of a place on the piece or a little beyond it, and on which side of the piece it lies, if that is known.
    fn foot(&mut self, sight: &mut Sight) -> (Option<Foot>, Option<Side>) {
        if sight.found.is_none() {
            self.looks += 1;
            sight.found = Some(self.seen.foot(&sight.place.point, sight.near.at));
        }
        match sight.found {
            Some(Found::Foot(foot)) => (Some(foot), Some(self.seen.piece.side(foot.at))),
            Some(Found::Beyond(side)) => (None, Some(side)),
            Some(Found::Lost) | None => (None, None),
        }
    }

    fn between(&mut self, a: &mut Sight, b: &mut Sight, halvings: u32) -> Option<Cut> {
        if !a.may_meet(b) {
            return None;
        }
        let (span, way) = (b.place.motion - a.place.motion, a.way_to(b));
        let ((foot_a, side_a), (foot_b, side_b)) = (self.foot(a), self.foot(b));
        if let (Some(side_a), Some(side_b)) = (side_a, side_b)
            && (0..2).any(|k| side_a[k] * side_b[k] > 0)
        {
            // the foot may come back to the very end of the piece where the way goes through
            let is_through = foot_a.zip(foot_b).is_some_and(|feet| self.goes_through_end(feet, way));
            return if is_through { self.halved(a, b, halvings) } else { None };
        }
        let (Some(foot_a), Some(foot_b)) = (foot_a, foot_b) else { return self.halved(a, b, halvings) };
        let (clear_a, clear_b) = (foot_a.clearance, foot_b.clearance);
        if clear_a.max(clear_b) < -TOUCH {
            return None;
        }
        let is_entered = clear_a.min(clear_b) < -TOUCH;
        let is_same = self.are_beside((&a.place, foot_a), (&b.place, foot_b));
        if is_entered {
            let is_on = side_a == Some([0, 0]) && side_b == Some([0, 0]);
            let is_through = (clear_a - clear_b).abs() <= way;
            // the last halves may lie on both sides of the seam of a closed surface
            if is_on && is_through && (is_same || halvings >= MOST_HALVINGS) {
                return Some(self.deepest(if clear_a < clear_b { [*b, *a] } else { [*a, *b] }));
            }
            return self.halved(a, b, halvings);
        }
        if !is_same {
            return self.halved(a, b, halvings);
        }
        let slopes = [(foot_a, &a.place), (foot_b, &b.place)].map(|(foot, place)| foot.rate(place.velocity) * span);
        // where another piece generates the point, this one is met at an angle
        let enters = [slopes[0] < -TOUCH, slopes[1] > TOUCH];
        match [clear_a, clear_b].map(|clear| clear <= TOUCH) {
            [true, _] if enters[0] => self.halved(a, b, halvings),
            [_, true] if enters[1] => self.halved(a, b, halvings),
            [true, true] => None,
            [true, false] => self.beside(a, b, halvings),
            [false, true] => self.beside(b, a, halvings),
            [false, false] => {
                let least = least_of_cubic([clear_a, clear_b], slopes);
                if least > CLEAR * clear_a.min(clear_b) { None } else { self.halved(a, b, halvings) }
            }
        }
    }

    /// Whether feet at two places are no farther apart than neighbouring cells, but for the slip between.
    fn are_beside(&self, (a, foot_a): (&Place, Foot), (b, foot_b): (&Place, Foot)) -> bool {
        let back = self.poses.slipped(self.running, b, a);
        self.seen.piece.are_beside(foot_a.at, self.seen.piece.slid(foot_b.at, back))
    }

    /// Whether a way, mm, whose ends lie on both sides of the piece's continuation beyond one of its ends may go through that end.
    fn goes_through_end(&self, (foot_a, foot_b): (Foot, Foot), way: f64) -> bool {
        let past = |foot: Foot| self.seen.piece.past(foot.at);
        (foot_a.clearance < -TOUCH) != (foot_b.clearance < -TOUCH) && past(foot_a).min(past(foot_b)) < way
    }

    fn halved(&mut self, a: &mut Sight, b: &mut Sight, halvings: u32) -> Option<Cut> {
        if halvings >= MOST_HALVINGS || self.is_clear_of_both(a, b) {
            return None;
        }
        let mut middle = self.sight_at(0.5 * (a.place.motion + b.place.motion), a)?;
        let cuts = [self.between(a, &mut middle, halvings + 1), self.between(&mut middle, b, halvings + 1)];
        cuts.into_iter().flatten().reduce(Cut::deeper)
    }

    /// Whether two places are nearest to parts of the piece that lie apart, as the turns of a thread do, and neither part is met between
    /// them.
    fn is_clear_of_both(&mut self, a: &mut Sight, b: &mut Sight) -> bool {
        let way = a.way_to(b);
        let forth = self.poses.slipped(self.running, &a.place, &b.place);
        let on = self.poses.cutting.slip.map_or(a.near.on, |slip| slip.moved(&a.near.on, forth));
        if way > APART * (on - b.near.on).norm() {
            return false;
        }
        let mut on = |part: &Sight, other: &Sight| {
            let at = self.seen.piece.slid(part.near.at, self.poses.slipped(self.running, &part.place, &other.place));
            let mut moved = Sight { near: part.near.with_start(at), found: None, ..*other };
            (self.foot(&mut { *part }), self.foot(&mut moved))
        };
        let (own_a, b_at_a) = on(a, b);
        let (own_b, a_at_b) = on(b, a);
        let span = b.place.motion - a.place.motion;
        self.is_clear([own_a, b_at_a], [&a.place, &b.place], span)
            && self.is_clear([a_at_b, own_b], [&a.place, &b.place], span)
    }

    /// Whether feet on one part of the piece, and the sides on which they lie, say that it is not met between two places.
    fn is_clear(&self, feet: [(Option<Foot>, Option<Side>); 2], places: [&Place; 2], span: f64) -> bool {
        let [(foot_a, side_a), (foot_b, side_b)] = feet;
        if let (Some(foot_a), Some(foot_b)) = (foot_a, foot_b) {
            let clear = [foot_a.clearance, foot_b.clearance];
            let slopes = [foot_a.rate(places[0].velocity) * span, foot_b.rate(places[1].velocity) * span];
            let nearer = clear[0].min(clear[1]);
            return nearer > TOUCH
                && self.are_beside((places[0], foot_a), (places[1], foot_b))
                && least_of_cubic(clear, slopes) > CLEAR * nearer;
        }
        matches!((side_a, side_b), (Some(a), Some(b)) if (0..2).any(|k| a[k] * b[k] > 0))
    }

    /// Beside a contact, where the clearance is zero and least, what it is over the square of the way from there tells whether it
    /// becomes negative.
    fn beside(&mut self, contact: &Sight, other: &Sight, halvings: u32) -> Option<Cut> {
        let mut far = *other;
        for halving in halvings..MOST_HALVINGS {
            let mut middle = self.sight_at(0.5 * (contact.place.motion + far.place.motion), &far)?;
            let (Some(near_foot), Some(far_foot)) = (self.foot(&mut middle).0, self.foot(&mut far).0) else {
                return self.ordered(&mut { *contact }, &mut middle, halving + 1);
            };
            let outer = self.ordered(&mut middle, &mut far, halving + 1);
            if outer.is_some() || near_foot.clearance.abs() <= TOUCH {
                return outer;
            }
            if near_foot.clearance < -TOUCH {
                return self.ordered(&mut { *contact }, &mut middle, halving + 1);
            }
            // over the square, in units of the farther one's
            let [near, far_one] = [4.0 * near_foot.clearance, far_foot.clearance];
            let is_even = far_one < 4.0 * near && near < 4.0 * far_one;
            if is_even && 2.0 * near - far_one > 0.25 * near {
                return None;
            }
            far = middle;
        }
        None
    }

    fn ordered(&mut self, a: &mut Sight, b: &mut Sight, halvings: u32) -> Option<Cut> {
        if a.place.motion < b.place.motion { self.between(a, b, halvings) } else { self.between(b, a, halvings) }
    }

    /// How deep the point goes on the way between two places from one before the piece to one behind it, or the other way round, as far as it is
    /// in the steel: of a thin tooth it may have come out again.
    fn deepest(&mut self, [outside, inside]: [Sight; 2]) -> Cut {
        let by = self.seen.piece.number;
        let range = self.poses.cutting.ranges[self.running];
        let Some((sight, foot)) = self.entered([outside, inside]) else { return Cut { by, depth: TOUCH } };
        let mut depth = -foot.clearance;
        let mut motion = sight.place.motion;
        let span = (inside.place.motion - outside.place.motion).abs();
        let mut step = if foot.rate(sight.place.velocity) > 0.0 { -0.5 * span } else { 0.5 * span };
        let mut out = None;
        for _ in 0..STEPS_DOWN {
            let next = (motion + step).clamp(range.low, range.high);
            match self.depth_at(next, &sight) {
                Some((there, true)) if there > depth => {
                    (depth, motion) = (there, next);
                    step *= 2.0;
                }
                Some((there, false)) if there > depth => {
                    out = Some(next);
                    step *= -0.3;
                }
                _ => step *= -0.3,
            }
        }
        let Some(mut out) = out else { return Cut { by, depth } };
        for _ in 0..MOST_ENTERED {
            let middle = 0.5 * (motion + out);
            match self.depth_at(middle, &sight) {
                Some((there, true)) if there > depth => (depth, motion) = (there, middle),
                _ => out = middle,
            }
        }
        Cut { by, depth }
    }

    /// How deep the point lies behind the piece at a value of the motion, and whether it is in the steel there; `None` where the piece ends before.
    fn depth_at(&mut self, motion: f64, near: &Sight) -> Option<(f64, bool)> {
        let mut sight = self.sight_at(motion, near)?;
        let foot = self.foot(&mut sight).0?;
        let depth = -foot.clearance;
        // what lies so little beyond an end is as far from the end as from the continuation
        let is_on = self.seen.piece.past(foot.at) <= PAST * depth;
        is_on.then(|| (depth, is_in_steel(self.others, &sight.place.point, depth)))
    }

    /// A place in the steel between two of which one lies before the piece and one behind it, with its foot: the latter, or one nearer to where the
    /// way goes through the piece.
    fn entered(&mut self, [outside, inside]: [Sight; 2]) -> Option<(Sight, Foot)> {
        let (mut before, mut behind) = (outside.place.motion, inside);
        for _ in 0..MOST_ENTERED {
            let foot = self.foot(&mut behind).0?;
            if is_in_steel(self.others, &behind.place.point, -foot.clearance) {
                return Some((behind, foot));
            }
            // the last place that is known to lie behind stays
            let mut middle = self.sight_at(0.5 * (before + behind.place.motion), &behind)?;
            while self.foot(&mut middle).0?.clearance >= -TOUCH {
                before = middle.place.motion;
                middle = self.sight_at(0.5 * (before + behind.place.motion), &behind)?;
                if middle.place.motion == before || middle.place.motion == behind.place.motion {
                    return None;
                }
            }
            behind = middle;
        }
        None
    }
}

/// The least value between two ends of the cubic with these values and slopes there, over a way of length one.
fn least_of_cubic([a, b]: [f64; 2], [slope_a, slope_b]: [f64; 2]) -> f64 {
    // a + slope_a x + p x² + q x³
    let p = 3.0 * (b - a) - 2.0 * slope_a - slope_b;
    let q = slope_a + slope_b - 2.0 * (b - a);
    let value = |x: f64| a + x * (slope_a + x * (p + x * q));
    let root = (p * p - 3.0 * q * slope_a).sqrt();
    let candidates = [(-p + root) / (3.0 * q), (-p - root) / (3.0 * q), -slope_a / (2.0 * p)];
    let inside = candidates.into_iter().filter(|x| (0.0..=1.0).contains(x));
    inside.map(value).fold(a.min(b), f64::min)
}
