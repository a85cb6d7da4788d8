//! One pass with the straight side of the cutter.

use std::slice::from_ref;

use flank_export::fixed;
use flank_solver::{
    Chart, LeftOnWay, NormalLine, PoseSeries, SideMotion, SidePass, SideStrip, StraightSide, SurfaceFrame, left_on_way,
    lowest, side_directions,
};
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::Serialize;

use super::cutter::MillingCutter;
use super::machine::Machine;
use super::patch::Lattice;
use super::plan::{self, LeftAt, Lost, Plan, evenly, higher, lower};
use super::result::HeightLeft;
use super::straight::Straight;
use super::target::{Fields, Target};
use super::{Milled, left_at, text};
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::requests::MillRequest;

/// Rows and columns of the map of what is left, with both ends.
const MAP: [usize; 2] = [15, 31];
/// Points along the pass from which the directions of the axis begin.
const STARTS: usize = 17;
/// Points along the middle of the strip, until the tail of their polynomial is below [`NEAR`].
const NODES: [usize; 3] = [33, 65, 129];
/// mm.
const NEAR: f64 = 1e-11;
/// The pass begins and ends beyond the strip where lines of contact through its corners cross the middle, by so much more of that ...
const BEYOND: f64 = 0.15;
/// ... and by this share of the strip, ...
const A_LITTLE: f64 = 0.005;
/// ... or by less, halved so often at the most, where the surface ends before or bends at once.
const HALVES: i32 = 6;
/// Steps until it is known where a line of contact crosses the middle, ...
const CROSSING_STEPS: usize = 40;
/// ... to this share of the strip.
const CROSSED: f64 = 1e-4;
/// Where the side is longer than its lines of contact, its lower end stands below the strip by this share of them.
const OVERHANG: f64 = 0.05;
/// How often a cutter is moved along itself to where its side touches.
const SLIDES: usize = 3;
/// Rows on which blocks are looked at.
const ROWS: [f64; 3] = [0.0, 0.5, 1.0];

/// What one pass with the side of the cutter leaves.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SideLeft {
    /// The most and the least that it leaves at the points of the map, beside the stock; negative where it cuts too deep.
    pub left: Option<[HeightLeft; 2]>,
    /// The root of the mean of the squares of it, um.
    pub rms_um: Option<f64>,
    /// Points of the map.
    pub points: usize,
    /// Points that the cutter does not reach.
    pub untouched: usize,
    /// How high above its origin the cutter touches, lowest and highest, mm.
    pub contact: Option<[f64; 2]>,
    /// Between which heights its side lies, mm.
    pub side: [f64; 2],
    /// How far the pass begins before and ends behind the surface, in shares of its length there.
    pub beyond: [f64; 2],
    /// By how much the best change of the axis promises to lower the largest amount of what is left, um.
    pub gap_um: f64,
    /// Whether that is next to nothing: no change of the axis leaves less.
    pub is_settled: bool,
}

impl SideLeft {
    /// Names with what belongs to them.
    pub(super) fn facts(&self) -> Vec<(&'static str, String)> {
        let [low, high] = self.side.map(|end| fixed(end, 3));
        let contact = self.contact.map(|ends| ends.map(|end| fixed(end, 3)));
        let touches = contact.map_or(String::new(), |[from, to]| format!("; it touches from {from} to {to} mm"));
        let mut facts = vec![("side", format!("one pass, from {low} to {high} mm above the tip{touches}"))];
        if let (Some([most, least]), Some(rms)) = (&self.left, self.rms_um) {
            facts.push(("side leaves", format!("at most {}", text::at(most))));
            facts.push(("", format!("at least {}", text::at(least))));
            facts.push(("", format!("{} um root mean square at {} points", fixed(rms, 4), self.points)));
        }
        facts
    }

    /// That parts of the surface are not reached, or that the search did not end.
    pub(super) fn missed(&self, target: &Target<'_, '_>) -> Vec<NotDone> {
        let cutter = &target.milling.cutter_name;
        let mut missed = Vec::new();
        if self.untouched > 0 {
            let message = format!(
                "{cutter} does not reach {} of {} points of {} in one pass",
                self.untouched,
                self.points,
                target.name()
            );
            let way = "take a cutter with a longer side, or mill a narrower strip".to_string();
            missed.push(NotDone::new(NotDoneKind::NotMilled, target.name(), message).with(vec![way]));
        }
        if !self.is_settled {
            let message = format!(
                "the axis of {cutter} is not the best: the search ended where what is left on {} may still fall by {} um",
                target.name(),
                fixed(self.gap_um, 4)
            );
            let way = "let the axis be free at fewer places, or mill a narrower strip".to_string();
            missed.push(NotDone::new(NotDoneKind::NotMilled, target.name(), message).with(vec![way]));
        }
        missed
    }
}

/// The strip that a pass covers: its first, middle and last row.
struct Strip<'t, 'j, 'g> {
    target: &'t Target<'j, 'g>,
    side: StraightSide,
    rows: Lattice,
    spindle_left: bool,
}

/// Functions of the share of the strip's length.
struct Start {
    /// The turn of the axis about the normal, and how far the first and the last row are along the cutter's lines, mm.
    series: PoseSeries,
    /// How far beyond both ends lines of contact through the corners cross the middle ...
    needed: [f64; 2],
    /// ... and how far the pass goes beyond them.
    beyond: [f64; 2],
}

impl Start {
    /// The same with a share of what the pass goes farther than is needed.
    fn with_more(self, share: f64) -> Start {
        let beyond = self.needed.map(|needed| needed + share * (BEYOND * needed + A_LITTLE));
        Start { beyond, ..self }
    }

    fn at(&self, share: f64) -> [f64; 3] {
        let [turn, first, last, ..] = self.series.at(share.clamp(0.0, 1.0));
        [turn, first, last]
    }

    /// The share of the strip's length at one of the pass.
    fn share(&self, of_pass: f64) -> f64 {
        -self.beyond[0] + of_pass * (1.0 + self.beyond[0] + self.beyond[1])
    }
}

impl<'t, 'j, 'g> Strip<'t, 'j, 'g> {
    fn new(target: &'t Target<'j, 'g>, side: StraightSide) -> Result<Strip<'t, 'j, 'g>, NotDone> {
        let rows = target.lattice([ROWS.to_vec(), Chart::shares(STARTS)])?;
        let middle = rows.at(1, STARTS / 2);
        let [across, along] = middle.steps.map(Vector3::from);
        let spindle_left = Vector3::from(middle.normal).cross(&along).dot(&across) > 0.0;
        Ok(Strip { target, side, rows, spindle_left })
    }

    /// Where the search begins: each field of directions in which the surface may take the side.
    ///
    /// # Errors
    /// That there is none.
    fn starts(&self) -> Result<Vec<Start>, NotDone> {
        let of_column = |column: usize| side_directions(self.rows.at(1, column), self.spindle_left, self.radius());
        let directions: Vec<Vec<f64>> = (0..STARTS).map(of_column).collect();
        let middle = STARTS / 2;
        let start = |first: &f64| {
            let mut turns = [*first; STARTS];
            let columns = (middle + 1..STARTS).map(|k| (k, k - 1)).chain((0..middle).rev().map(|k| (k, k + 1)));
            for (column, before) in columns {
                let before = turns[before];
                let nearest =
                    directions[column].iter().copied().min_by(|a, b| (a - before).abs().total_cmp(&(b - before).abs()));
                turns[column] = nearest.unwrap_or(before);
            }
            self.start(&turns)
        };
        let starts: Vec<Start> = directions[middle].iter().map(start).collect();
        if starts.is_empty() {
            let message = format!(
                "the side of {} would lie along its own way on {} at {}: that is where the surface is straightest",
                self.target.milling.cutter_name,
                self.target.name(),
                self.target.place([0.5, 0.5])
            );
            let way =
                format!("let the side lie along {}, and the pass go the other way", self.target.milling.area.names[1]);
            return Err(NotDone::new(NotDoneKind::NotMilled, self.target.name(), message).with(vec![way]));
        }
        Ok(starts)
    }

    fn start(&self, turns: &[f64; STARTS]) -> Start {
        let of_column = |column: usize| {
            let middle = self.rows.at(1, column);
            let turn = turns[column];
            let [first, last] = [0, 2].map(|row| {
                let [width, _] = self.seen_along(middle, turn, self.rows.at(row, column).position);
                width.abs() / turn.cos()
            });
            [turn, first, last, 0.0, 0.0, 0.0]
        };
        let columns: Vec<[f64; 6]> = (0..STARTS).map(of_column).collect();
        let needed = [0, STARTS - 1].map(|column| self.needed(column, turns[column]));
        Start { series: PoseSeries::through(&columns), needed, beyond: needed }.with_more(1.0)
    }

    /// How far a place is across the pass from a point of the middle, mm, towards the spindle, and along the pass from the line of contact through
    /// that point, in shares of the strip's length.
    fn seen_along(&self, middle: &SurfaceFrame, turn: f64, place: [f64; 3]) -> [f64; 2] {
        let along = Vector3::from(middle.steps[1]);
        let across = Vector3::from(middle.normal).cross(&along).normalize();
        let off = Vector3::from(place) - Vector3::from(middle.position);
        let width = off.dot(&across) * if self.spindle_left { 1.0 } else { -1.0 };
        [width, (off.dot(&along) / along.norm() - width * turn.tan()) / along.norm()]
    }

    /// How far beyond an end of the strip, where the axis is turned so far, lines of contact through its corners cross the middle.
    fn needed(&self, column: usize, turn: f64) -> f64 {
        let (end, sign) = if column == 0 { (0.0, -1.0) } else { (1.0, 1.0) };
        let corner = |row: usize| sign * (self.crossed(end, turn, self.rows.at(row, column).position) - end);
        corner(0).max(corner(2)).max(0.0)
    }

    /// The share at which the line of contact through a corner at an end of the strip crosses its middle: by secants, and halves of these where the
    /// surface has ended. Where that is not found, it is as far as the line at the end says.
    fn crossed(&self, end: f64, turn: f64, corner: [f64; 3]) -> f64 {
        let short = |share: f64, turn: f64| {
            let frame = self.middle_at(share)?;
            let directions = side_directions(&frame, self.spindle_left, self.radius());
            let turn =
                directions.into_iter().min_by(|a, b| (a - turn).abs().total_cmp(&(b - turn).abs())).unwrap_or(turn);
            Some((self.seen_along(&frame, turn, corner)[1], turn))
        };
        let Some((by, turn)) = short(end, turn).filter(|(by, _)| by.abs() > CROSSED) else { return end };
        let (mut known, mut turn, mut step) = ([end, by], turn, by);
        for _ in 0..CROSSING_STEPS {
            // no farther at once than the strip is long
            step = step.clamp(-1.0, 1.0);
            let share = known[0] + step;
            let Some((by, turned)) = short(share, turn) else {
                step *= 0.5;
                continue;
            };
            let slope = (by - known[1]) / step;
            (known, turn) = ([share, by], turned);
            step = if slope == 0.0 { 0.0 } else { -by / slope };
            if step.abs() < CROSSED {
                return share + step;
            }
        }
        end + by
    }

    /// A point of the middle, also beyond the strip; `None` where the surface has none.
    fn middle_at(&self, share: f64) -> Option<SurfaceFrame> {
        self.target.lattice([vec![0.5], vec![share]]).ok().map(|lattice| *lattice.at(0, 0))
    }

    /// Of the side in its middle, from the contact to the axis, mm.
    fn radius(&self) -> f64 {
        let [low, high] = self.side.heights;
        self.side.radius_at(0.5 * (low + high)) / self.side.half_angle.cos()
    }

    /// The start with as much of what the pass goes farther than is needed as leaves the middle polynomials that are near; where none does, with
    /// as much as the surface has.
    ///
    /// # Errors
    /// That the surface has no point where the pass has to go.
    fn on_surface(&self, mut start: Start) -> Result<(Start, PoseSeries), NotDone> {
        let (mut far, mut missing) = (None, None);
        for halves in 0..=HALVES {
            let share = 0.5_f64.powi(halves);
            start = start.with_more(share);
            match self.middle(&start) {
                Ok(middle) if middle.tail() <= NEAR => return Ok((start, middle)),
                Ok(middle) => far = far.or(Some((share, middle))),
                Err(why) => missing = Some(why),
            }
        }
        match (far, missing) {
            (Some((share, middle)), _) => Ok((start.with_more(share), middle)),
            (None, why) => Err(why.expect("it was tried")),
        }
    }

    /// The middle of the strip as polynomials over the pass.
    fn middle(&self, start: &Start) -> Result<PoseSeries, NotDone> {
        let mut found = None;
        for count in NODES {
            let along: Vec<f64> = Chart::shares(count).into_iter().map(|share| start.share(share)).collect();
            let lattice = self.target.lattice([vec![0.5], along]).map_err(|missing| {
                let [before, behind] = start.beyond;
                let why = format!(
                    "lines of contact slant: the pass begins {before:.3} of the strip's length before it and ends {behind:.3} behind"
                );
                let way = "mill a narrower strip, or let `side` and `along` change their coordinates".to_string();
                NotDone { details: [missing.details.clone(), vec![why, way]].concat(), ..missing }
            })?;
            let series = PoseSeries::through(&lattice.frames.iter().map(line_of).collect::<Vec<NormalLine>>());
            let off = series.tail();
            found = Some(series);
            if off <= NEAR {
                break;
            }
        }
        Ok(found.expect("there are counts"))
    }

    /// Where the search for the best pass begins, of which the axis is free at so many places.
    fn begun(&self, start: Start, free: usize, points: &[NormalLine]) -> Result<Option<Begun>, NotDone> {
        let StraightSide { heights: [low, _], half_angle, .. } = self.side;
        let places: Vec<f64> = match free {
            1 => vec![0.5],
            _ => Chart::shares(free),
        };
        let places: Vec<[f64; 3]> = places.into_iter().map(|share| start.at(start.share(share))).collect();
        let needed = evenly(STARTS).into_iter().map(|share| start.at(share)).map(|[_, first, last]| first + last);
        let needed = needed.fold(0.0, f64::max);
        let length = self.side.length();
        if needed > length {
            let cutter = &self.target.milling.cutter_name;
            let message = format!(
                "{cutter} has a side of {length:.3} mm, and would touch {} along {needed:.3} mm",
                self.target.name()
            );
            let way = "take a cutter with a longer side, or mill a narrower strip".to_string();
            return Err(NotDone::new(NotDoneKind::NotMilled, self.target.name(), message).with(vec![way]));
        }
        let (start, middle) = self.on_surface(start)?;
        let overhang = (0.5 * (length - needed)).min(OVERHANG * needed);
        let strip = SideStrip {
            middle,
            spindle_left: self.spindle_left,
            side: self.side,
            heights: places.iter().map(|[_, first, _]| low + (overhang + first) * half_angle.cos()).collect(),
            stock: self.target.milling.stock,
        };
        let turns: Vec<f64> = places.iter().map(|[turn, ..]| *turn).collect();
        Ok(strip.squared(&turns, points).map(|motion| Begun { strip, turns, motion, start }))
    }
}

/// The motion with the least squares from a start.
struct Begun {
    strip: SideStrip,
    turns: Vec<f64>,
    motion: SideMotion,
    start: Start,
}

impl Begun {
    /// The best pass from there. The cutter is moved along itself until it touches with its side alone: a cylinder leaves the same.
    fn best(mut self, points: &[NormalLine]) -> Option<(SidePass, Start)> {
        let begun = self.strip.begun(&self.turns, points).unwrap_or(self.motion);
        let mut pass = self.strip.nearest_pass(&begun, points)?;
        for _ in 0..SLIDES {
            let Some(up) = beside(&self.strip.side, pass.touches) else { break };
            self.strip.heights.iter_mut().for_each(|height| *height += up);
            pass = self.strip.nearest_pass(&pass.motion, points)?;
        }
        Some((pass, self.start))
    }
}

/// How much farther up a side has to touch so that it does not touch beyond its ends; `None` where it does not.
fn beside(side: &StraightSide, [lowest, highest]: [f64; 2]) -> Option<f64> {
    let [low, high] = side.heights;
    let needed = highest - lowest;
    let spare = 0.5 * (high - low - needed);
    (lowest < low || highest > high).then(|| low + spare.min(OVERHANG * needed) - lowest)
}

/// The pass whose largest remainder is least, from all starts. Where not even the mean of squares is below a largest that is known, none is.
///
/// # Errors
/// Why the first start that failed did, if no pass was found.
fn best_of(
    strip: &Strip<'_, '_, '_>,
    free: usize,
    points: &[NormalLine],
) -> Result<Option<(SidePass, Start)>, NotDone> {
    let (mut begun, mut failed) = (Vec::new(), None);
    for start in strip.starts()? {
        match strip.begun(start, free, points) {
            Ok(found) => begun.extend(found),
            Err(why) => failed = failed.or(Some(why)),
        }
    }
    begun.sort_by(|a, b| a.motion.root_mean_square().total_cmp(&b.motion.root_mean_square()));
    let mut best: Option<(SidePass, Start)> = None;
    for begun in begun {
        let known = best.as_ref().map_or(f64::INFINITY, |(pass, _)| pass.motion.largest());
        if begun.motion.root_mean_square() < known {
            best = begun.best(points).filter(|(pass, _)| pass.motion.largest() < known).or(best);
        }
    }
    match (best, failed) {
        (None, Some(why)) => Err(why),
        (best, _) => Ok(best),
    }
}

fn line_of(frame: &SurfaceFrame) -> NormalLine {
    let ([x, y, z], [nx, ny, nz]) = (frame.position, frame.normal);
    [x, y, z, nx, ny, nz]
}

/// Finds the pass, its positions, and takes the machine along it.
///
/// # Errors
/// That the cutter has no side, or none that covers the surface; what the surface does not have; that no number of blocks is enough.
pub(super) fn milled<'p, 'g>(
    target: &Target<'_, 'g>,
    cutter: &MillingCutter,
    machine: Option<Machine<'p, 'g>>,
    fields: &Fields,
    (request, free): (&MillRequest, usize),
) -> Result<(Milled<'p, 'g>, SideLeft), NotDone> {
    let name = &target.milling.cutter_name;
    let side = cutter.cutting.side().ok_or_else(|| {
        let message = format!("{name} has no straight side: one pass covers {} with that alone", target.name());
        let way = "take a cutter such as `conical_mill`, whose half angle may be zero, or say `passes`".to_string();
        NotDone::new(NotDoneKind::NotMilled, target.name(), message).with(vec![way])
    })?;
    let map = target.lattice(MAP.map(evenly))?;
    let points: Vec<NormalLine> = map.frames.iter().map(line_of).collect();
    let strip = Strip::new(target, side)?;
    let (pass, start) = best_of(&strip, free, &points)?.ok_or_else(|| {
        let message = format!("one pass of {name} does not cover {}: it is bent too much", target.name());
        let way = "mill a narrower strip, or say `passes`".to_string();
        NotDone::new(NotDoneKind::NotMilled, target.name(), message).with(vec![way])
    })?;
    let on_way = left_on_way(&pass.way, &cutter.cutting, &points);
    let told = side_left(target, &map, &on_way, (&pass, &start, side));
    let few: Vec<[f64; 6]> = evenly(9).into_iter().map(|share| pass.way.at(share)).collect();
    let machine = machine.map(|machine| machine.on_best_elbow(from_ref(&few)));
    let few_at = |k: usize| target.place([0.5, start.share(k as f64 / (few.len() - 1) as f64)]);
    if let Some(missed) = machine.as_ref().and_then(|machine| machine.unreached(&few, few_at)) {
        return Err(missed);
    }
    let straight = Straight::of_machine(machine.as_ref(), request.tool_centre_control);
    let rows = ROWS.map(|row| PassedRow::new(fields, cutter, &pass.way, row));
    let blocks = |count: usize| left_by_blocks(target, cutter, (&pass.way, &start, straight), &rows, &evenly(count));
    let widest = way_length(&pass.way);
    let (count, left) = plan::positions(target, widest, [&blocks, &blocks])?;
    let along = evenly(count);
    let poses: Vec<[f64; 6]> = along.iter().map(|share| pass.way.at(*share)).collect();
    let shares = [vec![0.5], along.iter().map(|share| start.share(*share)).collect::<Vec<f64>>()];
    let lattice = target.lattice(shares.clone())?;
    let longest = poses.windows(2).map(|pair| super::distance(&pair[0], &pair[1])).fold(0.0, f64::max);
    let plan = Plan { shares, cusp: None, short: None, blocks: left, step: None, block: longest };
    let axes = machine.iter().map(|machine| machine.axes.along(&poses)).collect();
    Ok((Milled { plan, lattice, ways: vec![pass.way], poses: vec![poses], axes, machine }, told))
}

/// How long the way of the origin is, mm.
fn way_length(way: &PoseSeries) -> f64 {
    let places: Vec<[f64; 6]> = evenly(65).into_iter().map(|share| way.at(share)).collect();
    places.windows(2).map(|pair| super::distance(&pair[0], &pair[1])).sum()
}

fn side_left(
    target: &Target<'_, '_>,
    map: &Lattice,
    found: &[Option<LeftOnWay>],
    (pass, start, side): (&SidePass, &Start, StraightSide),
) -> SideLeft {
    let stock = target.milling.stock;
    let at = |(shares, found): ([f64; 2], &Option<LeftOnWay>)| {
        found.map(|found| LeftAt { shares, height: found.height - stock })
    };
    let known: Vec<LeftAt> = map.each().map(|(shares, _)| shares).zip(found).filter_map(at).collect();
    let ends = known.iter().copied().reduce(higher).zip(known.iter().copied().reduce(lower));
    let above = found.iter().flatten().map(|found| found.above);
    let mean = known.iter().map(|left| left.height.powi(2)).sum::<f64>() / known.len() as f64;
    SideLeft {
        left: ends.map(|(most, least)| [left_at(target, most), left_at(target, least)]),
        rms_um: (!known.is_empty()).then(|| 1e3 * mean.sqrt()),
        points: found.len(),
        untouched: found.len() - known.len(),
        contact: above.clone().reduce(f64::min).zip(above.reduce(f64::max)).map(|(low, high)| [low, high]),
        side: side.heights,
        beyond: start.beyond,
        gap_um: 1e3 * pass.gap,
        is_settled: pass.is_settled,
    }
}

/// A row of the strip, and where the cutter passes it.
struct PassedRow {
    share: f64,
    /// Points and normals over the share of the strip's length.
    line: PoseSeries,
    /// At even shares of that, at which share of the way the cutter passes; not a number where it does not.
    passed: Vec<f64>,
}

impl PassedRow {
    fn new(fields: &Fields, cutter: &MillingCutter, way: &PoseSeries, share: f64) -> PassedRow {
        let line = fields.surface.pass(share);
        let points: Vec<NormalLine> = evenly(MAP[1]).into_iter().map(|share| line.at(share)).collect();
        let found = left_on_way(way, &cutter.cutting, &points);
        PassedRow {
            share,
            line,
            passed: found.iter().map(|found| found.map_or(f64::NAN, |found| found.share)).collect(),
        }
    }

    /// The share of the strip's length at which the cutter passes at a share of the way, nearly.
    fn passed_at(&self, of_way: f64) -> Option<f64> {
        let within = |pair: &[f64]| pair[0] <= of_way && of_way <= pair[1] && pair[0] < pair[1];
        let before = self.passed.windows(2).position(within)?;
        let [from, to] = [self.passed[before], self.passed[before + 1]];
        Some((before as f64 + (of_way - from) / (to - from)) / (self.passed.len() - 1) as f64)
    }
}

/// The most and the least that straight blocks leave beside what the pass itself leaves: in the middle of each, on three rows.
fn left_by_blocks(
    target: &Target<'_, '_>,
    cutter: &MillingCutter,
    (way, start, straight): (&PoseSeries, &Start, Straight<'_>),
    rows: &[PassedRow],
    along: &[f64],
) -> Result<[LeftAt; 2], NotDone> {
    let blocks = straight.blocks(way, along);
    let mut ends = [LeftAt { shares: [0.5, start.share(0.0)], height: 0.0 }; 2];
    for row in rows {
        for (pair, block) in along.windows(2).zip(&blocks) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let Some(place) = row.passed_at(middle) else { continue };
            let line = row.line.at(place);
            let Some(exact) = lowest(way, &cutter.cutting, &line, middle) else { continue };
            let lost =
                || Lost { shares: [row.share, place], from_pole: straight.least_from_pole(way, [pair[0], pair[1]]) };
            let found = lowest(block, &cutter.cutting, &line, 0.5).ok_or_else(|| lost().told(target))?;
            let left = LeftAt { shares: [row.share, place], height: found.height - exact.height };
            ends = [higher(ends[0], left), lower(ends[1], left)];
        }
    }
    Ok(ends)
}
