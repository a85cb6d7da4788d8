//! How many passes, how many blocks, and what these leave.

use flank_chain_dsl::{BlockLength, PassSpacing};
use flank_export::fixed;
use flank_solver::{Cusp, PoseSeries, cusp, left_by_block, lowest_beside, peak};
use rayon::prelude::*;

use super::cutter::MillingCutter;
use super::straight::Straight;
use super::target::{Fields, Target};
use crate::project::remark::{NotDone, NotDoneKind};

/// More passes, or positions on a pass, than anybody mills.
const MOST: usize = 100_000;
/// Places along the passes at which cusps are looked for.
const COLUMNS: usize = 17;
/// The same while the number of passes is looked for.
const FEW_COLUMNS: usize = 5;
/// Passes with which the search for their number begins ...
const BEGUN: usize = 33;
/// ... and so many times closer than the scallop asks for it looks for passes that meet: ridges are lower by the square of that.
const CLOSER: f64 = 8.0;
/// A ridge between the places that are looked at while their number is looked for is higher by less than this factor: elsewhere it has another reason.
const MISSED: f64 = 1.25;
/// Gaps whose ridges are looked at together; where one has none, no more follow. They become more and more.
const TOGETHER: [usize; 2] = [4, 256];
/// Positions on a pass with which the search for their number begins.
const BEGUN_POSITIONS: usize = 17;
/// Passes whose blocks are looked at first while their number is looked for.
const FEW_PASSES: usize = 5;
/// Of a ridge no more than this share of the passes is missing at their ends.
const ENDS: f64 = 1.0 / 16.0;
/// Of so many positions on a pass none is far from the next: a block that leaves the surface then does so for another reason than its length.
const SHORT: usize = 1000;
/// Halvings until the end of a ridge is found.
const HALVINGS: u32 = 24;

/// A place and what is left there, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LeftAt {
    pub(super) shares: [f64; 2],
    pub(super) height: f64,
}

/// Passes and blocks of a milling.
pub(super) struct Plan {
    /// The shares of the passes, and of the positions on each.
    pub(super) shares: [Vec<f64>; 2],
    /// The highest cusp; none beside a pass alone.
    pub(super) cusp: Option<LeftAt>,
    /// The ridge that ends farthest before its passes do, and how far, mm; none where all go to the end.
    pub(super) short: Option<LeftAt>,
    /// What straight blocks leave at the most and at the least, less the stock.
    pub(super) blocks: [LeftAt; 2],
    /// Between neighbouring passes, mm, at the most; none of a pass alone.
    pub(super) step: Option<f64>,
    /// Between neighbouring positions, mm, at the most.
    pub(super) block: f64,
}

pub(super) fn evenly(count: usize) -> Vec<f64> {
    (0..count).map(|k| k as f64 / (count - 1) as f64).collect()
}

/// A block that is not near the surface everywhere.
pub(super) struct Lost {
    pub(super) shares: [f64; 2],
    /// How far the axis of the cutter is from the pole at the nearer end, radians, where the axes are known.
    pub(super) from_pole: Option<f64>,
}

impl Lost {
    pub(super) fn told(self, target: &Target<'_, '_>) -> NotDone {
        let message = format!("the block at {} leaves the surface", target.place(self.shares));
        let swings = self
            .from_pole
            .map(|angle| format!("its ends are {:.3} deg from the pole, where rotary axes swing", angle.to_degrees()));
        let way = "lean the cutter away with `lead` or `tilt`, clamp the work at another angle, or make blocks shorter";
        let details = swings.into_iter().chain([way.to_string()]).collect();
        NotDone::new(NotDoneKind::NotMilled, target.name(), message).with(details)
    }
}

/// What a plan is made from.
pub(super) struct Planner<'p, 'j, 'g> {
    pub(super) target: &'p Target<'j, 'g>,
    pub(super) fields: &'p Fields,
    pub(super) cutter: &'p MillingCutter,
    pub(super) straight: Straight<'p>,
}

impl Planner<'_, '_, '_> {
    /// # Errors
    /// What no number of passes or blocks reaches, with the place.
    pub(super) fn plan(&self) -> Result<Plan, NotDone> {
        let passes = evenly(self.passes()?);
        let (count, blocks) = self.positions(&passes)?;
        let along = evenly(count);
        let (cusp, short) = self.highest_cusp(&passes)?;
        let cusp = LeftAt { height: cusp.height - self.stock(), ..cusp };
        if let PassSpacing::Scallop(wanted) = self.target.milling.spacing
            && cusp.height > MISSED * wanted
        {
            return Err(self.too_high(cusp, passes.len(), wanted));
        }
        let steps = |k: usize, count: usize| {
            let widest = self.fields.lattice.frames.iter().map(|frame| length(frame.steps[k])).fold(0.0, f64::max);
            widest / (count - 1) as f64
        };
        let (step, block) = (steps(0, passes.len()), steps(1, along.len()));
        Ok(Plan { shares: [passes, along], cusp: Some(cusp), short, blocks, step: Some(step), block })
    }

    fn stock(&self) -> f64 {
        self.target.milling.stock
    }

    /// How many passes.
    fn passes(&self) -> Result<usize, NotDone> {
        let wanted = match self.target.milling.spacing {
            PassSpacing::Count(count) => return Ok(count),
            PassSpacing::Side(_) => return Ok(1),
            PassSpacing::Step(step) => {
                let widest = self.fields.lattice.frames.iter().map(|frame| length(frame.steps[0]));
                let count = (widest.fold(0.0, f64::max) / step).ceil() as usize + 1;
                return if count > MOST { Err(self.too_many(count)) } else { Ok(count.max(2)) };
            }
            PassSpacing::Scallop(height) => height,
        };
        let highest = |count: usize| -> Result<f64, NotDone> {
            let left = self.cusps(&evenly(count), &evenly(FEW_COLUMNS), None)?;
            Ok(left.iter().map(|left| left.height - self.stock()).fold(0.0, f64::max))
        };
        // between `low`, which are too few, and `high`, which are enough
        let (mut low, mut high, mut count) = (1, None, BEGUN);
        let most = self.most_apart(wanted);
        loop {
            // cusps grow with the square of the distance; few passes may be too far apart to meet
            let guess = match highest(count) {
                Ok(height) => {
                    (low, high) = if height <= wanted { (low, Some(count)) } else { (count, high) };
                    Some(((count - 1) as f64 * (height / wanted).sqrt()).ceil().min(2.0 * MOST as f64) as usize + 1)
                }
                Err(missing) if high.is_none() && count > most => return Err(missing),
                Err(_) => {
                    low = count;
                    None
                }
            };
            count = match (high, guess) {
                (Some(high), _) if high <= low + 1 => return Ok(high.max(2)),
                (Some(high), Some(guess)) => guess.clamp(low + 1, high - 1),
                (Some(high), None) => low.midpoint(high),
                (None, Some(guess)) => guess.max(low + 1),
                (None, None) => 2 * count - 1,
            };
            if count > MOST {
                return Err(self.too_many(count));
            }
        }
    }

    /// Passes that leave so much less than `wanted`, mm, by the radius across the feed, that there is no point in more which do not meet either.
    fn most_apart(&self, wanted: f64) -> usize {
        let bending = self.fields.lattice.each().filter_map(|(shares, frame)| {
            let bending =
                self.target.pose(shares, frame, self.cutter, 1.0).ok()?.bending(frame, &self.cutter.cutting)?;
            (bending.effective_radius > 0.0).then_some(bending.effective_radius)
        });
        let radius = bending.fold(f64::INFINITY, f64::min);
        let widest = self.fields.lattice.frames.iter().map(|frame| length(frame.steps[0])).fold(0.0, f64::max);
        let count = widest / (8.0 * wanted * radius).sqrt();
        // a radius that is not known or not bounded says nothing
        if count.is_finite() { (CLOSER * count).clamp(BEGUN as f64, MOST as f64) as usize } else { BEGUN }
    }

    /// That a ridge is higher than is asked for, which passes closer together do not change: it lies at the end of the cutter's arc.
    fn too_high(&self, cusp: LeftAt, passes: usize, wanted: f64) -> NotDone {
        let [height, wanted] = [cusp.height, wanted].map(|height| fixed(1e3 * height, 4));
        let place = self.target.place(cusp.shares);
        let message = format!(
            "{passes} passes leave a ridge of {height} um at {place}, {wanted} um are asked for: what cuts beside the passes ends there"
        );
        let way = "lean the cutter otherwise, or take one with a larger arc; `step` and `by` take passes as they are";
        NotDone::new(NotDoneKind::NotMilled, self.target.name(), message).with(vec![way.to_string()])
    }

    fn too_many(&self, count: usize) -> NotDone {
        let name = &self.target.milling.name;
        let message = format!("{name}: it would take {count} passes; at most {MOST} are made");
        let way = match self.target.milling.spacing {
            PassSpacing::Scallop(_) => "allow a higher scallop, or take a cutter with a larger radius",
            _ => "allow a wider step",
        };
        NotDone::new(NotDoneKind::NotMilled, name, message).with(vec![way.to_string()])
    }

    /// The highest cusp between passes, and the ridge that ends first.
    fn highest_cusp(&self, passes: &[f64]) -> Result<(LeftAt, Option<LeftAt>), NotDone> {
        let columns = evenly(COLUMNS);
        let all = self.cusps(passes, &columns, None)?;
        let widest = self.fields.lattice.frames.iter().map(|frame| length(frame.steps[1])).fold(0.0, f64::max);
        let missing = all
            .iter()
            .zip(columns.iter().cycle())
            .map(|(cusp, column)| LeftAt { shares: cusp.shares, height: widest * (cusp.shares[1] - column).abs() });
        let short = missing.filter(|missing| missing.height > 0.0).reduce(higher);
        let (place, first) =
            all.iter().enumerate().max_by(|a, b| a.1.height.total_cmp(&b.1.height)).expect("two passes");
        let (gap, column) = (place / COLUMNS, place % COLUMNS);
        let beside = [column.saturating_sub(1), (column + 1).min(COLUMNS - 1)].map(|k| columns[k]);
        let of_gap = |along: f64| Some(self.cusps(passes, &[along], Some(gap)).ok()?.first()?.height);
        let Some((along, height)) = peak(beside, of_gap).filter(|(_, height)| *height > first.height) else {
            return Ok((*first, short));
        };
        let exact = self.cusps(passes, &[along], Some(gap))?;
        Ok((LeftAt { shares: exact[0].shares, height }, short))
    }

    /// Cusps between all neighbouring passes, or the two of one gap, at places along them: gap by gap.
    pub(super) fn cusps(&self, passes: &[f64], columns: &[f64], gap: Option<usize>) -> Result<Vec<LeftAt>, NotDone> {
        let across: Vec<PoseSeries> = columns.iter().map(|share| self.fields.surface.across(*share)).collect();
        let gaps = gap.map_or(0..passes.len() - 1, |gap| gap..gap + 1);
        let (fields, cutter) = (self.fields, &self.cutter.cutting);
        // of each place the ridge, or where there is none
        let of_gap = |gap: usize| -> Result<Vec<LeftAt>, [f64; 2]> {
            let series = [gap, gap + 1].map(|pass| fields.of_pass(pass).pass(passes[pass]));
            let ridge = |column: &PoseSeries, along: f64| {
                let shares = [passes[gap], passes[gap + 1]];
                let found = cusp(column, series.each_ref(), shares, along, cutter)?;
                Some(LeftAt { shares: [found.share, along], height: found.height })
            };
            let at = |(column, along): (&PoseSeries, &f64)| {
                let found = ridge(column, *along);
                found
                    .or_else(|| last(*along, |along| ridge(&fields.surface.across(along), along)))
                    .ok_or([passes[gap], *along])
            };
            across.iter().zip(columns).map(at).collect()
        };
        // the first place is told, whichever thread finds one first
        let (mut found, mut next, mut together) = (Ok(Vec::new()), gaps.start, TOGETHER[0]);
        while let (Ok(all), true) = (&mut found, next < gaps.end) {
            let some = next..(next + together).min(gaps.end);
            (next, together) = (some.end, (2 * together).min(TOGETHER[1]));
            let ridges: Vec<Result<Vec<LeftAt>, [f64; 2]>> = some.into_par_iter().map(of_gap).collect();
            match ridges.into_iter().collect::<Result<Vec<Vec<LeftAt>>, [f64; 2]>>() {
                Ok(ridges) => all.extend(ridges.concat()),
                Err(shares) => found = Err(shares),
            }
        }
        found.map_err(|shares| {
            let place = self.target.place(shares);
            let message = format!("the passes beside {place} do not meet: what they leave between them is no ridge");
            let way = match self.cutter.has_edge() {
                true => "set them closer together, or lean the cutter more with `lead` and less with `tilt`: to the side its edge cuts no farther than its outermost point",
                false => "set them closer together, or take a cutter with a larger arc, or lean this one otherwise: the ridge lies beyond the end of its arc",
            };
            NotDone::new(NotDoneKind::NotMilled, self.target.name(), message).with(vec![way.to_string()])
        })
    }

    /// How many positions on a pass, and what blocks between them leave on all passes.
    fn positions(&self, passes: &[f64]) -> Result<(usize, [LeftAt; 2]), NotDone> {
        let widest = self.fields.lattice.frames.iter().map(|frame| length(frame.steps[1])).fold(0.0, f64::max);
        let few: Vec<usize> = few_of(passes.len());
        let all: Vec<usize> = (0..passes.len()).collect();
        let on = |which: &[usize], count: usize| self.left_by_blocks(passes, &evenly(count), which);
        positions(self.target, widest, [&|count| on(&few, count), &|count| on(&all, count)])
    }

    /// The most and the least that straight blocks leave on some passes.
    fn left_by_blocks(&self, passes: &[f64], along: &[f64], which: &[usize]) -> Result<[LeftAt; 2], NotDone> {
        let (fields, cutter, straight, stock) = (self.fields, &self.cutter.cutting, self.straight, self.stock());
        let between = 1.0 / (passes.len() - 1) as f64;
        let across = |pair: &[f64]| {
            let middle = 0.5 * (pair[0] + pair[1]);
            (middle, fields.surface.across(middle))
        };
        let middles: Vec<(f64, PoseSeries)> = along.par_windows(2).map(across).collect();
        let of_pass = |number: &usize| -> Result<[LeftAt; 2], Lost> {
            let share = passes[*number];
            let (surface, path) = (fields.surface.pass(share), fields.of_pass(*number).pass(share));
            let blocks = straight.blocks(&path, along);
            let mut ends = [LeftAt { shares: [share, 0.0], height: 0.0 }; 2];
            for ((pair, block), (middle, across)) in along.windows(2).zip(&blocks).zip(&middles) {
                let found = left_by_block(&surface, block, [pair[0], pair[1]], cutter, stock);
                let lost = || Lost {
                    shares: [share, pair[0]],
                    from_pole: straight.least_from_pole(&path, [pair[0], pair[1]]),
                };
                let Cusp { share: at, height } = found.ok_or_else(lost)?;
                let left = LeftAt { shares: [share, at], height: height - stock };
                ends = [higher(ends[0], left), lower(ends[1], left)];
                let beside = lowest_beside(across, block, (share, 0.5 * between), 0.5, cutter);
                let beside = beside.filter(|beside| (0.0..=1.0).contains(&beside.share));
                let left = |beside: Cusp| LeftAt { shares: [beside.share, *middle], height: beside.height - stock };
                ends[1] = beside.map_or(ends[1], |beside| lower(ends[1], left(beside)));
            }
            Ok(ends)
        };
        // the first place is told, whichever thread finds one first
        let all: Vec<Result<[LeftAt; 2], Lost>> = which.par_iter().map(of_pass).collect();
        let all: Result<Vec<[LeftAt; 2]>, Lost> = all.into_iter().collect();
        let all = all.map_err(|lost| lost.told(self.target))?;
        Ok(all.into_iter().reduce(|a, b| [higher(a[0], b[0]), lower(a[1], b[1])]).expect("there are passes"))
    }
}

/// The last ridge before an end of the passes: beside the foremost point of a round edge the cutter ends a little before it.
fn last(along: f64, ridge: impl Fn(f64) -> Option<LeftAt>) -> Option<LeftAt> {
    let end = along.round();
    if (along - end).abs() >= ENDS {
        return None;
    }
    let (mut beyond, mut within) = (along, (end - ENDS).abs());
    let mut found = ridge(within)?;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (beyond + within);
        match ridge(middle) {
            Some(at) => (within, found) = (middle, at),
            None => beyond = middle,
        }
    }
    Some(found)
}

/// How many positions on a pass that is at the most so long, mm, and what blocks between them leave at the most and at the least on all passes.
///
/// `left` tells what blocks between so many positions leave, on a few passes and on all: none may leave more than is asked for.
pub(super) fn positions(
    target: &Target<'_, '_>,
    widest: f64,
    left: [&dyn Fn(usize) -> Result<[LeftAt; 2], NotDone>; 2],
) -> Result<(usize, [LeftAt; 2]), NotDone> {
    let too_many = |count: usize| {
        let name = &target.milling.name;
        let message = format!("{name}: it would take {count} positions on a pass; at most {MOST} are made");
        let way = match target.milling.blocks {
            BlockLength::Chord(_) => "allow a larger chord error",
            BlockLength::Step(_) | BlockLength::Count(_) => "allow a longer step",
        };
        NotDone::new(NotDoneKind::NotMilled, name, message).with(vec![way.to_string()])
    };
    let [few, all] = left;
    let wanted = match target.milling.blocks {
        BlockLength::Count(count) => return Ok((count, all(count)?)),
        BlockLength::Step(step) => {
            let count = ((widest / step).ceil() as usize + 1).max(2);
            return if count > MOST { Err(too_many(count)) } else { Ok((count, all(count)?)) };
        }
        BlockLength::Chord(chord) => chord,
    };
    let (mut count, mut looked_at) = (BEGUN_POSITIONS, few);
    let mut is_of_all = false;
    while count <= MOST {
        let found = match looked_at(count) {
            // round a thread, blocks may be too long to stay beside the surface
            Err(_) if count < SHORT => {
                count = 2 * count - 1;
                continue;
            }
            found => found?,
        };
        let off = found[0].height.max(-found[1].height);
        if off > wanted {
            count = (((count - 1) as f64 * (off / wanted).sqrt()).ceil() as usize + 1).max(count + 1);
        } else if is_of_all {
            return Ok((count, found));
        } else {
            (looked_at, is_of_all) = (all, true);
        }
    }
    Err(too_many(count))
}

/// Evenly spread ones of many.
fn few_of(count: usize) -> Vec<usize> {
    let mut few: Vec<usize> = (0..FEW_PASSES).map(|k| k * (count - 1) / (FEW_PASSES - 1)).collect();
    few.dedup();
    few
}

pub(super) fn higher(a: LeftAt, b: LeftAt) -> LeftAt {
    if b.height > a.height { b } else { a }
}

pub(super) fn lower(a: LeftAt, b: LeftAt) -> LeftAt {
    if b.height < a.height { b } else { a }
}

pub(super) fn length([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}
