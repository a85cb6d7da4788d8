//! The contact of a pair over its roll: found, followed through the mesh, and all pairs of teeth together.

use flank_chain_dsl::Job;
use flank_solver::{
    ContactPoint, ContactProblem, ContactState, Engagement, FlankEdge, NoContact, Outcome, RollingPair, SurfacePoint,
};

use crate::contact::pair::Members;

/// Roll positions at which the contact is looked for, from the middle of the roll outwards.
const TRIED: usize = 13;
/// Positions over a pitch among which the vertex is looked for.
const COARSE: usize = 12;
/// Positions over a pitch between which extremes, transfers and ends of edges are solved, at the least.
const LOOKED_AT: usize = 60;
/// Halvings of the way between two positions until the place at which another edge carries is settled.
const HALVINGS: usize = 40;
/// What carries beside a transfer is looked at so far from it, as a share of a step.
const BESIDE: f64 = 1e-6;
/// An error of the ratio below this at all positions is none: rounding.
const STRAIGHT: f64 = 1e-12;

/// Pairs of teeth whose errors differ by no more than this turn alike: rounding.
const ALIKE: f64 = 1e-11;
/// Steps until an extreme of the error between two positions is settled: each brings it at least twice as near.
const EXTREME_STEPS: usize = 40;

/// The teeth of the second member that are tried, by pitches.
const TEETH: [i32; 3] = [0, 1, -1];

/// A pair of flanks over its roll.
pub(crate) struct Rolling {
    pub(crate) problem: ContactProblem,
    /// What it was followed from.
    pub(crate) first: ContactPoint,
    /// One pair of teeth through the mesh; its step 0 is the middle.
    pub(crate) engagement: Engagement,
    /// The same at more positions, where few are asked for.
    finer: Option<Engagement>,
    /// Where the lag is extreme, if it is somewhere.
    pub(crate) vertex: Option<ContactPoint>,
    /// Whether the pitch from tooth to tooth is known.
    pub(crate) has_pitch: bool,
    /// Between which it rolls.
    pub(super) limits: [f64; 2],
}

impl Rolling {
    /// Mounted with errors. Of the second member's teeth it takes the one that touches within the range of the unknown: that of the spec or one
    /// beside it. A line of contact that no solid ends is ended by the samples.
    ///
    /// # Errors
    /// Why there is no contact.
    pub(crate) fn of_members<'g>(
        job: &Job<'g>,
        members: &mut Members<'_, 'g>,
        errors: &[f64],
        steps: usize,
    ) -> Result<Rolling, NoContact> {
        let found = Rolling::of_teeth(job, members, errors, steps);
        if members.solids.iter().all(Option::is_some) || found.as_ref().is_ok_and(|of| is_told(&of.first)) {
            return found;
        }
        let tooth = members.tooth;
        members.ends_at_sample = true;
        let is_line = |of: &Rolling| of.first.state == Some(ContactState::Line) && is_told(&of.first);
        if let Some(of_lines) = Rolling::of_teeth(job, members, errors, steps).ok().filter(is_line) {
            return Ok(of_lines);
        }
        (members.ends_at_sample, members.tooth) = (false, tooth);
        match found {
            Ok(of) if is_endless(&of.first) => Err(NoContact::Endless),
            found => found,
        }
    }

    /// The same as far as solids say where the flanks end.
    fn of_teeth<'g>(
        job: &Job<'g>,
        members: &mut Members<'_, 'g>,
        errors: &[f64],
        steps: usize,
    ) -> Result<Rolling, NoContact> {
        let every = members.pitch(job);
        let teeth = if members.solids[1].is_some() { &TEETH[..] } else { &TEETH[..1] };
        let mut reason = None;
        for tooth in teeth {
            members.tooth = *tooth;
            match Rolling::of_pair(members, &members.pair(job, errors, &[]), (steps, every)) {
                Ok(rolling) => return Ok(rolling),
                Err(why) => reason = reason.or(Some(why)),
            }
        }
        members.tooth = 0;
        Err(reason.expect("there is a tooth"))
    }

    fn of_pair(
        members: &Members<'_, '_>,
        pair: &RollingPair<'_, '_>,
        (steps, every): (usize, Option<f64>),
    ) -> Result<Rolling, NoContact> {
        let problem = ContactProblem::new(pair).expect("a job without errors leaves nothing unbound");
        let roll = &members.contact.roll;
        let limits = [roll.low, roll.high];
        let points = members.points.each_ref().map(Vec::as_slice);
        let first = found(&problem, limits, points)?;
        let problem = problem.watching(pair, points).expect("a job without errors leaves nothing unbound");
        Ok(Rolling::from_first(problem, first, (steps, every), limits))
    }

    /// Followed from a contact.
    pub(crate) fn from_first(
        problem: ContactProblem,
        first: ContactPoint,
        (steps, every): (usize, Option<f64>),
        limits: [f64; 2],
    ) -> Rolling {
        let has_pitch = every.is_some();
        // of one pair alone all of the roll is looked at: the next one is beyond it
        let (pitch, steps) = every.map_or((limits[1] - limits[0], 2 * steps), |pitch| (pitch, steps));
        let coarse = if has_pitch { COARSE } else { 2 * COARSE };
        let vertex = beside(&problem, &first, pitch, limits);
        let (vertex, middle) = match vertex {
            Some(vertex) => (Some(vertex.clone()), vertex),
            None => {
                let coarse = problem.engagement(&first, pitch, coarse, limits);
                let vertex = among(&problem, &coarse);
                (vertex.clone(), vertex.or_else(|| middle(&problem, &coarse)).unwrap_or_else(|| first.clone()))
            }
        };
        let engagement = problem.engagement(&middle, pitch, steps, limits);
        Rolling { problem, first, engagement, finer: None, vertex, has_pitch, limits }
    }

    /// The same, with a pitch looked at so closely that what is solved between positions does not depend on how many are asked for.
    pub(crate) fn closely(self, members: &Members<'_, '_>) -> Rolling {
        let Engagement { steps, pitch, .. } = self.engagement;
        let least = if self.has_pitch { LOOKED_AT } else { 2 * LOOKED_AT };
        let roll = &members.contact.roll;
        let middle = self.middle().filter(|_| steps < least);
        let all = least.div_ceil(steps.max(1)) * steps;
        let finer = middle.map(|middle| self.problem.engagement(middle, pitch, all, [roll.low, roll.high]));
        Rolling { finer, ..self }
    }

    /// The pair of teeth at the positions between which extremes, transfers and ends of edges are solved.
    pub(crate) fn looked_at(&self) -> &Engagement {
        self.finer.as_ref().unwrap_or(&self.engagement)
    }

    /// The point of the middle: where the error is extreme, or in the middle of contact of the flanks.
    pub(crate) fn middle(&self) -> Option<&ContactPoint> {
        self.engagement.point(0, 0)
    }

    /// Steps of one pitch about the middle, or all where there is one pair alone.
    pub(crate) fn steps(&self) -> std::ops::Range<isize> {
        self.steps_of(&self.engagement)
    }

    /// The same of those that are looked at.
    pub(crate) fn steps_of(&self, of: &Engagement) -> std::ops::Range<isize> {
        let steps = of.steps as isize;
        let all = of.first..of.first + of.points.len() as isize;
        if self.has_pitch { -(steps / 2)..steps - steps / 2 } else { all }
    }

    /// All steps at which the pair of teeth touches.
    pub(crate) fn all_steps(&self) -> std::ops::Range<isize> {
        let Engagement { first, points, .. } = &self.engagement;
        *first..*first + points.len() as isize
    }

    /// Roll position of a step.
    pub(crate) fn roll(&self, step: isize) -> f64 {
        self.roll_of(&self.engagement, step)
    }

    /// The same of those that are looked at.
    pub(crate) fn roll_of(&self, of: &Engagement, step: isize) -> f64 {
        let Engagement { steps, pitch, .. } = *of;
        let middle = self.middle().map_or(f64::NAN, |point| point.roll);
        middle + step as f64 * pitch / steps as f64
    }

    /// Roll positions at which one pair of teeth hands over to the next.
    pub(crate) fn transfers(&self) -> Vec<f64> {
        let engagement = self.looked_at();
        let steps = if self.has_pitch { self.steps_of(engagement) } else { 0..0 };
        let handed = (steps.start..steps.end).filter_map(|step| {
            let [before, after] = [step, step + 1].map(|step| engagement.carried(step).map(|carried| carried.pair));
            let (before, after) = before.zip(after).filter(|(before, after)| before != after)?;
            // two pairs that turn alike hand nothing over: which one is ahead is rounding
            let ahead = |step: isize| {
                let [before, after] = [before, after].map(|pair| engagement.point(pair, step).map(|point| point.lag));
                Some((before? - after?).abs())
            };
            if [step, step + 1].into_iter().any(|step| ahead(step).is_some_and(|ahead| ahead < ALIKE)) {
                return None;
            }
            let between = [step, step + 1].map(|step| self.roll_of(engagement, step));
            self.problem.transfer(engagement, [before, after], between)
        });
        handed.collect()
    }

    /// Between which values the composite lag changes over a pitch; `transfers` are those of this.
    pub(crate) fn span(&self, transfers: &[f64]) -> Option<[f64; 2]> {
        let of = self.looked_at();
        let lag = |step: isize| match self.has_pitch {
            true => of.carried(step).map(|carried| carried.lag),
            false => of.point(0, step).map(|point| point.lag),
        };
        let at_transfers = transfers.iter().filter_map(|roll| self.lag_at(*roll));
        let at_ends = self.gap().map(|ends| ends.points.map(|point| point.lag));
        let joined = |[a, b]: [f64; 2], lag: f64| [a.min(lag), b.max(lag)];
        let mut lags = self.steps_of(of).filter_map(lag).chain(at_transfers).chain(at_ends.into_iter().flatten());
        let first = lags.next()?;
        let of_positions = lags.fold([first; 2], joined);
        let between = self.steps_of(of).flat_map(|step| self.extremes(step, of_positions, transfers));
        Some(between.fold(of_positions, joined))
    }

    /// Where contact of the flanks ends before the roll does: on which side, -1 or 1, and its last point there.
    pub(crate) fn flank_ends(&self) -> Vec<(isize, ContactPoint)> {
        [-1, 1].into_iter().filter_map(|way| Some((way, flank_end(&self.problem, &self.engagement, way)?))).collect()
    }

    /// How many pitches contact of the flanks lasts, between both of its ends.
    pub(crate) fn ratio(&self, ends: &[(isize, ContactPoint)]) -> Option<f64> {
        match ends {
            [(_, begin), (_, end)] if self.has_pitch => Some((end.roll - begin.roll) / self.engagement.pitch),
            _ => None,
        }
    }

    /// Positions at which the flanks would have to touch beyond the ranges of their tools.
    pub(crate) fn outside(&self) -> usize {
        let points = self.looked_at().points.iter();
        points.filter(|point| point.is_of_flanks() && point.outcome != Outcome::Solved).count()
    }

    /// The contact that carries at any roll position.
    pub(crate) fn carrying(&self, roll: f64) -> Option<ContactPoint> {
        let of = self.looked_at();
        let middle = self.middle()?.roll;
        let near = ((roll - middle) / of.pitch * of.steps as f64).round() as isize;
        let pairs = if self.has_pitch { of.pairs(near) } else { vec![0] };
        let points = pairs.into_iter().filter_map(|pair| self.problem.pair_at(of, pair, roll));
        points.max_by(|a, b| height(a).total_cmp(&height(b)))
    }

    /// The composite lag at any roll position.
    pub(crate) fn lag_at(&self, roll: f64) -> Option<f64> {
        Some(self.carrying(roll)?.lag)
    }

    /// Edges that carry over a pitch, each with the roll positions from which to which it does, no farther than the pitch goes: looked for at all
    /// positions, on both sides of the transfers and where no pair touches, and solved between them.
    pub(crate) fn leading(&self, transfers: &[f64]) -> Vec<(Vec<FlankEdge>, [f64; 2])> {
        let of = self.looked_at();
        let edges = |point: &ContactPoint| (!point.is_of_flanks()).then(|| point.edges.clone());
        let steps = self.steps_of(of);
        let at_step = |step: isize| {
            let point = of.carried(step).and_then(|carried| of.point(carried.pair, step));
            (self.roll_of(of, step), point.and_then(edges))
        };
        let at = |roll: f64| self.carrying(roll).as_ref().and_then(edges);
        let beside = BESIDE * of.pitch / of.steps as f64;
        let at_transfers =
            transfers.iter().flat_map(|roll| [roll - beside, roll + beside]).map(|roll| (roll, at(roll)));
        let [begin, end] = [steps.start, steps.end].map(|step| self.roll_of(of, step));
        // where a pair leaves before the next one comes, its ends are solved
        let at_gap = self.gap().into_iter().flat_map(|ends| ends.points).map(|point| {
            let pitches = ((point.roll - begin) / of.pitch).floor();
            (point.roll - pitches * of.pitch, edges(&point))
        });
        let mut all: Vec<(f64, Option<Vec<FlankEdge>>)> =
            steps.map(at_step).chain(at_transfers).chain(at_gap).collect();
        all.push((end, at(end)));
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let between = |of: &Option<Vec<FlankEdge>>, mut inside: f64, mut outside: f64| {
            for _ in 0..HALVINGS {
                let middle = 0.5 * (inside + outside);
                if at(middle) == *of { inside = middle } else { outside = middle }
            }
            inside
        };
        let mut found = Vec::new();
        let mut first = 0;
        for run in all.chunk_by(|a, b| a.1 == b.1) {
            let (begin, last) = (first, first + run.len() - 1);
            first = last + 1;
            let Some(edges) = &run[0].1 else { continue };
            let from = begin.checked_sub(1).map_or(all[begin].0, |out| between(&run[0].1, all[begin].0, all[out].0));
            let to = all.get(last + 1).map_or(all[last].0, |out| between(&run[0].1, all[last].0, out.0));
            found.push((edges.clone(), [from, to]));
        }
        found
    }

    /// Of the composite lag between two positions its extremes that lie beyond a span: where one pair hands over to another between them, those of
    /// each on its side.
    fn extremes(&self, step: isize, span: [f64; 2], transfers: &[f64]) -> Vec<f64> {
        let of = self.looked_at();
        let pair = |step: isize| if self.has_pitch { Some(of.carried(step)?.pair) } else { Some(0) };
        let end = |step: isize| {
            let point = of.point(pair(step)?, step)?;
            Some([self.roll_of(of, step), point.lag, point.lag_slopes[0]])
        };
        let Some((low, high)) = end(step).zip(end(step + 1)) else { return Vec::new() };
        let Some(roll) = transfers.iter().find(|roll| **roll > low[0] && **roll < high[0]) else {
            return self.extreme([low, high], span).into_iter().collect();
        };
        let at = |step: isize| {
            let point = self.problem.pair_at(of, pair(step)?, *roll)?;
            Some([*roll, point.lag, point.lag_slopes[0]])
        };
        let before = at(step).and_then(|there| self.extreme([low, there], span));
        let after = at(step + 1).and_then(|there| self.extreme([there, high], span));
        before.into_iter().chain(after).collect()
    }

    /// The same of one pair between two places, each with its roll position, lag and slope: on the tangents at both ends, which meet there, or nearer
    /// to it each time.
    fn extreme(&self, [mut low, mut high]: [[f64; 3]; 2], [least, most]: [f64; 2]) -> Option<f64> {
        let mut best = None;
        for _ in 0..EXTREME_STEPS {
            let [[a, lag_a, slope_a], [b, lag_b, slope_b]] = [low, high];
            if slope_a * slope_b >= 0.0 {
                break;
            }
            let meet = (lag_b - lag_a + slope_a * a - slope_b * b) / (slope_a - slope_b);
            let expected = lag_a + slope_a * (meet - a);
            if !(meet > a && meet < b) || (least..=most).contains(&expected) {
                break;
            }
            let point = self.carrying(meet)?;
            best = Some(point.lag);
            if (point.lag - expected).abs() <= ALIKE {
                break;
            }
            let there = [meet, point.lag, point.lag_slopes[0]];
            if there[2] * slope_a > 0.0 { low = there } else { high = there }
        }
        best
    }

    /// What the flanks are to each other where they touch.
    pub(crate) fn state(&self) -> Option<ContactState> {
        self.middle().and_then(|point| point.state)
    }
}

/// Whether flanks touch along a line that nothing ends: nothing says where on it their contact is, nor how that moves.
fn is_endless(point: &ContactPoint) -> bool {
    let is_line = point.state == Some(ContactState::Line) || point.lag_slopes[0].is_nan();
    is_line && point.edges.is_empty()
}

/// Whether it is known where a contact is.
fn is_told(point: &ContactPoint) -> bool {
    !is_endless(point) && point.state != Some(ContactState::Crossing)
}

/// The contact nearest to the middle of the roll.
fn found(problem: &ContactProblem, limits: [f64; 2], points: [&[SurfacePoint]; 2]) -> Result<ContactPoint, NoContact> {
    let at = |k: usize| limits[0] + (limits[1] - limits[0]) * (k as f64 + 0.5) / TRIED as f64;
    let mut order: Vec<usize> = (0..TRIED).collect();
    order.sort_by_key(|k| k.abs_diff(TRIED / 2));
    let mut reason = None;
    let mut second: Option<ContactPoint> = None;
    for k in order {
        match problem.find(at(k), points) {
            Ok(point) if point.outcome == Outcome::Solved && point.state != Some(ContactState::Crossing) => {
                return Ok(point);
            }
            Ok(point) => second = second.or(Some(point)),
            Err(why) => reason = reason.or(Some(why)),
        }
    }
    second.ok_or(reason.unwrap_or(NoContact::NotFound))
}

/// Whether flank touches flank there with an error that changes.
fn is_clear(point: &ContactPoint) -> bool {
    point.is_of_flanks() && point.lag_slopes[0].abs() > STRAIGHT
}

/// Where the lag of contact of the flanks is extreme, within a pitch of a contact.
fn beside(problem: &ContactProblem, first: &ContactPoint, pitch: f64, limits: [f64; 2]) -> Option<ContactPoint> {
    let is_near = |roll: f64| (roll - first.roll).abs() <= pitch && (limits[0]..=limits[1]).contains(&roll);
    let expected = first.roll - first.lag_slopes[0] / first.lag_slopes[1];
    let vertex = problem.vertex_near(Some(first).filter(|first| is_clear(first) && is_near(expected))?)?;
    (vertex.is_of_flanks() && is_near(vertex.roll)).then_some(vertex)
}

/// The same between points of a pair, or at one of them.
fn among(problem: &ContactProblem, of: &Engagement) -> Option<ContactPoint> {
    let slope = |point: &ContactPoint| point.lag_slopes[0];
    let turns = |before: &ContactPoint, after: &ContactPoint| {
        is_clear(before) && is_clear(after) && slope(before).signum() != slope(after).signum()
    };
    let between = of.points.windows(2).filter(|pair| turns(&pair[0], &pair[1]));
    let at = of
        .points
        .windows(3)
        .filter(|three| three[1].is_of_flanks() && !is_clear(&three[1]) && turns(&three[0], &three[2]));
    let between = between.filter_map(|pair| problem.vertex(&pair[0], [pair[0].roll, pair[1].roll]));
    between.chain(at.map(|three| three[1].clone())).min_by(|a, b| a.roll.total_cmp(&b.roll))
}

/// Where contact of the flanks ends on a side, -1 or 1, if it does so before the roll.
fn flank_end(problem: &ContactProblem, of: &Engagement, way: isize) -> Option<ContactPoint> {
    let (outermost, is_whole) = match way {
        -1 => (of.points.first(), of.is_whole[0]),
        _ => (of.points.last(), of.is_whole[1]),
    };
    let goes_on = outermost.is_some_and(ContactPoint::is_of_flanks);
    if is_whole || !goes_on { problem.flank_end(of, way) } else { None }
}

/// The middle of contact of the flanks, between its ends or those of the roll; where the flanks do not touch there, the point of theirs that is
/// nearest to it.
fn middle(problem: &ContactProblem, of: &Engagement) -> Option<ContactPoint> {
    let flank: Vec<&ContactPoint> = of.points.iter().filter(|point| point.is_of_flanks()).collect();
    let end = |way: isize, outermost: &ContactPoint| flank_end(problem, of, way).map_or(outermost.roll, |end| end.roll);
    let middle = 0.5 * (end(-1, flank.first()?) + end(1, flank.last()?));
    let off = |point: &ContactPoint| (point.roll - middle).abs();
    let near = flank.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
    let there = problem.followed(near, middle).filter(ContactPoint::is_of_flanks);
    Some(there.unwrap_or_else(|| near.clone()))
}

/// The lag, with the sign with which more of it opens the pair.
fn height(point: &ContactPoint) -> f64 {
    point.lag * point.opening.signum()
}
