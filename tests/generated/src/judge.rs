//! The program's verdicts checked against trying, and against its own on other grids, by other coordinates, in wider ranges.

use std::collections::BTreeMap;
use std::fmt;

use crate::case::{Asked, Case, Coordinate, JobText};
use crate::families::tells_apart;
use crate::oracle::{Oracle, Touched};
use crate::pose::{Vector, distance};
use crate::told::{Outcome, Point};

/// Heights that count as none, mm: a thousand times what rounding makes of them.
const TOUCH: f64 = 1e-6;
/// Heights that are rounding of a place found by differences, mm; and a share of the ranges.
const ROUNDING: f64 = 1e-9;
/// Heights that are rounding of a touch alone, mm.
const NOTHING: f64 = 1e-12;
/// A point that stays or goes only by less than this is not counted against the program, mm.
const CLEAR: f64 = 1e-4;
/// Shares of the ranges within which it is rounding whether a point is in them.
const EDGE: f64 = 1e-6;
/// Points nearer to each other are the same, mm.
const SAME: f64 = 1e-5;
/// What a surface spans at least where points are expected to be found, and what it spans at most where it is a line, mm².
const FLAT: f64 = 1e-1;
const LINE: f64 = 1e-3;
/// What a coordinate may be off what is asked for.
const MISPLACED: f64 = 1e-7;
/// A share of the ranges beyond which nothing of the tool is looked for that cuts a point away.
const BEYOND: f64 = 0.02;
/// Points farther apart than this are on two branches, mm.
const APART: f64 = 1e-3;
/// Of grids with more points not each is checked against all positions.
const MANY: usize = 60;
/// How many points of a grid are looked for in other ways.
const LOOKED_FOR: usize = 4;

/// Something wrong, by its kind.
#[derive(Clone, Debug)]
pub struct Finding {
    pub kind: &'static str,
    pub job: String,
    pub what: String,
}

#[derive(Clone, Debug, Default)]
pub struct Counts {
    /// Points by what the program says of them.
    pub by_status: BTreeMap<String, usize>,
    /// Points of surfaces of which it was told that there are, or may be, other branches.
    pub other_branches_told: usize,
    /// Points of surfaces of which it was told that the tool was not looked at in all its positions, and those of them that one of these
    /// cuts away.
    pub positions_told: usize,
    pub cut_as_told: usize,
    /// Points that were looked for in other ways, and those for which that gave no clear answer.
    pub looked_for: usize,
    pub unclear: usize,
}

impl fmt::Display for Counts {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let points: usize = self.by_status.values().sum();
        let share = |count: usize| format!("{count} ({:.2} %)", 100.0 * count as f64 / points.max(1) as f64);
        writeln!(out, "{points} points:")?;
        for (status, count) in &self.by_status {
            writeln!(out, "  {status}: {}", share(*count))?;
        }
        let open = ["ambiguous", "undecided"].iter().filter_map(|status| self.by_status.get(*status)).sum();
        writeln!(out, "left undecided, with several branches or for what a trim leaves: {}", share(open))?;
        writeln!(out, "of surfaces with other branches told, or not excluded: {}", share(self.other_branches_told))?;
        writeln!(
            out,
            "of surfaces of which not all positions of the tool were looked at: {}, and {} of these are cut away",
            share(self.positions_told),
            self.cut_as_told
        )?;
        write!(out, "{} points looked for in other ways; without a clear answer {}", self.looked_for, self.unclear)
    }
}

impl Counts {
    pub fn add(&mut self, other: &Counts) {
        for (status, count) in &other.by_status {
            *self.by_status.entry(status.clone()).or_default() += count;
        }
        self.other_branches_told += other.other_branches_told;
        self.positions_told += other.positions_told;
        self.cut_as_told += other.cut_as_told;
        self.looked_for += other.looked_for;
        self.unclear += other.unclear;
    }
}

/// A job with what became of it.
pub struct Judged<'a> {
    pub case: &'a Case,
    pub job: &'a JobText,
    pub outcome: &'a Outcome,
    oracle: Oracle<'a>,
}

/// What trying says of a point with given coordinates.
#[derive(Default)]
struct Truth {
    stay: Vec<Touched>,
    /// Whether there is one of which it is not clear.
    is_unclear: bool,
}

impl<'a> Judged<'a> {
    pub fn new(case: &'a Case, job: &'a JobText, outcome: &'a Outcome) -> Judged<'a> {
        Judged { case, job, outcome, oracle: case.oracle(job.is_wide) }
    }

    fn finding(&self, kind: &'static str, what: String) -> Finding {
        Finding { kind, job: self.job.name.clone(), what }
    }

    fn asked(&self, point: &Point) -> [f64; 2] {
        [self.job.sample[0].value(point.row), self.job.sample[1].value(point.column)]
    }

    fn place(&self, point: &Point) -> String {
        let [a, b] = self.asked(point);
        let [first, second] = &self.job.sample;
        format!("point ({}, {}) at {:?} = {a}, {:?} = {b}", point.row, point.column, first.by, second.by)
    }

    /// What is wrong with single points; of many each third is looked at, which in a grid is another column in each row.
    pub fn points(&self, counts: &mut Counts) -> Vec<Finding> {
        let points = &self.outcome.points;
        for point in points {
            *counts.by_status.entry(point.status.clone()).or_default() += 1;
        }
        counts.other_branches_told += if self.outcome.tells_of_branches { points.len() } else { 0 };
        counts.positions_told += if self.outcome.tells_of_positions { points.len() } else { 0 };
        let step = if points.len() > MANY { 3 } else { 1 };
        let mut out: Vec<Finding> =
            points.iter().step_by(step).filter_map(|point| self.as_told(point, counts)).collect();
        let step = points.len().div_ceil(LOOKED_FOR);
        out.extend(points.iter().skip(step / 3).step_by(step).filter_map(|point| self.others(point, counts)));
        out
    }

    /// A point that is told with its position must be where it is told, and stay or go as it is told.
    fn as_told(&self, point: &Point, counts: &mut Counts) -> Option<Finding> {
        let position = point.position?;
        let misplaced = self.job.sample.iter().zip(self.asked(point)).find_map(|(coordinate, asked)| {
            let miss = coordinate.by.miss(coordinate.by.value(&point.unknowns, position), asked);
            (miss.abs() > MISPLACED).then(|| ("misplaced", format!("{:?} is off by {miss:e}", coordinate.by)))
        });
        let wrong = misplaced.or_else(|| match point.status.as_str() {
            "solved" => self.untouched(point, position).or_else(|| self.cut(point, position, counts)),
            "undercut" | "trimmed" => self.cut_by_nothing(point, position),
            _ => None,
        });
        wrong.map(|(kind, what)| self.finding(kind, format!("{}: {what}", self.place(point))))
    }

    /// Why a solved point is none of the surface that is meant.
    fn untouched(&self, point: &Point, position: Vector) -> Option<(&'static str, String)> {
        let touch = self.oracle.own_height(position, &point.unknowns[2..], ROUNDING);
        if touch.is_none_or(|height| height.abs() > TOUCH) {
            return Some(("untouched", format!("the tool is {touch:?} mm off at {:?}", point.unknowns)));
        }
        if !self.is_kept(&point.unknowns, EDGE) {
            return Some(("solved_but_not_kept", format!("with {:?}", point.unknowns)));
        }
        let is_line = self.oracle.area(&point.unknowns).is_some_and(|area| area < LINE);
        is_line.then(|| ("solved_but_a_line", format!("the surface is a line at {:?}", point.unknowns)))
    }

    /// Where the tool takes a solved point away, unless it is told that not all of its positions were looked at.
    fn cut(&self, point: &Point, position: Vector, counts: &mut Counts) -> Option<(&'static str, String)> {
        let told = &point.unknowns[2..];
        let deepest =
            self.oracle.deepest_through_surface(position, told, -EDGE).filter(|deepest| deepest.height < -TOUCH)?;
        if self.outcome.tells_of_positions {
            counts.cut_as_told += 1;
            return None;
        }
        let off = told.iter().zip(&deepest.motions).zip(&self.oracle.ranges[2..]);
        let is_beside = off.map(|((told, cut), range)| (told - cut).abs() / range.width()).all(|share| share < 1e-2);
        let kind = if is_beside { "solved_but_cut_beside" } else { "solved_but_cut_elsewhere" };
        Some((kind, format!("{:e} mm inside the tool at {:?}, told at {told:?}", -deepest.height, deepest.motions)))
    }

    fn cut_by_nothing(&self, point: &Point, position: Vector) -> Option<(&'static str, String)> {
        let deepest = self.oracle.deepest(position, Some(&point.unknowns[2..]), BEYOND);
        let is_cut = deepest.as_ref().is_some_and(|deepest| deepest.height < -NOTHING);
        (!is_cut).then(|| ("cut_away_by_nothing", format!("nowhere inside the tool: {deepest:?}")))
    }

    /// Whether a point is one that the sample keeps; a share of the kept range does not count.
    fn is_kept(&self, unknowns: &[f64], slack: f64) -> bool {
        self.case.kept.is_none_or(|kept| unknowns.last().is_some_and(|last| kept.wider_by(slack).holds(*last)))
    }

    /// Whether the program has told that it may be otherwise.
    fn is_told(&self) -> bool {
        self.outcome.tells_of_branches
    }

    /// What trying finds at the coordinates of a point, and the program has neither found nor told.
    fn others(&self, point: &Point, counts: &mut Counts) -> Option<Finding> {
        if is_open(point) || self.is_told() {
            return None;
        }
        counts.looked_for += 1;
        let truth = self.truth(self.asked(point));
        counts.unclear += usize::from(truth.is_unclear && truth.stay.is_empty());
        let is_another = |other: &&Touched| {
            !point.is_solved() || point.position.is_some_and(|own| distance(other.position, own) > APART)
        };
        let other = truth.stay.iter().find(is_another)?;
        let kind = match point.status.as_str() {
            "solved" => "second_branch_untold",
            "not_converged" => "lost_not_converged",
            "out_of_range" => "lost_outside",
            "undercut" | "trimmed" => "lost_cut_away",
            _ => "lost_singular",
        };
        let Touched { unknowns, position } = other;
        let what = format!("{}: {}, and {position:?} with {unknowns:?} stays", self.place(point), point.status);
        Some(self.finding(kind, what))
    }

    /// All points at two coordinates that trying finds.
    fn truth(&self, asked: [f64; 2]) -> Truth {
        let sample = &self.job.sample;
        let fixed = sample.iter().zip(asked).filter_map(|(coordinate, asked)| match coordinate.by {
            Coordinate::Unknown(k) => Some((k, asked)),
            _ => None,
        });
        let miss = |unknowns: &[f64], position: Vector| {
            [0, 1].map(|k| match sample[k].by {
                Coordinate::Unknown(_) => f64::NAN,
                _ => sample[k].by.miss(sample[k].by.value(unknowns, position), asked[k]),
            })
        };
        let mut truth = Truth::default();
        for point in self.oracle.touched(&miss, &fixed.collect::<Vec<_>>()) {
            let ranges = point.unknowns.iter().zip(&self.oracle.ranges);
            let is_inside = ranges.into_iter().all(|(x, range)| range.wider_by(-EDGE).holds(*x));
            if !is_inside || !self.is_kept(&point.unknowns, -EDGE) {
                continue;
            }
            let height = self
                .oracle
                .deepest(point.position, Some(&point.unknowns[2..]), EDGE)
                .map_or(0.0, |deepest| deepest.height);
            // where the motions do not follow, or the surface is hardly more than a line, nothing is expected
            let is_surface = self.oracle.area(&point.unknowns).is_some_and(|area| area > FLAT);
            if height > -ROUNDING && is_surface {
                truth.stay.push(point);
            } else if height > -CLEAR {
                truth.is_unclear = true;
            }
        }
        truth
    }

    /// What a job says of points that another one has asked for, too: the same, or one of them has told that it may be otherwise.
    pub fn against(&self, other: &Judged<'_>, pairs: &[(usize, usize)], kind: &'static str) -> Vec<Finding> {
        if self.is_told() || other.is_told() {
            return Vec::new();
        }
        let pairs = pairs.iter().map(|&(mine, its)| [&self.outcome.points[mine], &other.outcome.points[its]]);
        let otherwise = pairs.filter(|pair| !pair.iter().any(|point| is_open(point))).filter_map(|pair| {
            let what = self.otherwise(other, pair)?;
            Some(self.finding(kind, format!("{}: {what}", self.place(pair[0]))))
        });
        otherwise.collect()
    }

    /// How the verdict on a point differs from that of another job.
    fn otherwise(&self, other: &Judged<'_>, [mine, its]: [&Point; 2]) -> Option<String> {
        match [mine, its].map(|point| point.position.filter(|_| point.is_solved())) {
            [Some(one), Some(two)] => {
                let apart = distance(one, two);
                (apart > SAME).then(|| format!("solved in both, {apart} mm apart"))
            }
            [None, None] => None,
            // in wider ranges the tool may cut more, and what lay outside may lie within
            [Some(position), None] if other.job.is_wide => {
                let deepest = other.oracle.deepest(position, Some(&mine.unknowns[2..]), EDGE);
                let stays = deepest.is_none_or(|deepest| deepest.height > -ROUNDING);
                stays.then(|| format!("solved, but {} in wider ranges", its.status))
            }
            [None, Some(_)] if other.job.is_wide => None,
            _ => Some(format!("{} in {}, {} in {}", mine.status, self.job.name, its.status, other.job.name)),
        }
    }
}

/// Points of which the program says that it does not know.
fn is_open(point: &Point) -> bool {
    matches!(point.status.as_str(), "ambiguous" | "undecided")
}

/// The jobs that are solved first: the grid, one that is denser, and the grid in wider ranges.
pub fn first_jobs(case: &Case) -> Vec<JobText> {
    let job = |name: &str, times: usize, is_wide: bool| JobText {
        name: name.to_owned(),
        sample: [case.sample[0].denser(times), case.sample[1].denser(times)],
        is_wide,
    };
    vec![job("plain", 1, false), job("dense", DENSER, false), job("wider", 1, true)]
}

pub const DENSER: usize = 5;

/// The numbers of a plain grid's points among those of the denser one.
pub fn common(case: &Case) -> Vec<(usize, usize)> {
    let [rows, columns] = [case.sample[0].count, case.sample[1].count];
    let width = (columns - 1) * DENSER + 1;
    (0..rows * columns).map(|n| (n, n / columns * DENSER * width + n % columns * DENSER)).collect()
}

/// Up to three solved points of a job, each asked for by two other coordinates.
pub fn other_jobs(judged: &Judged<'_>) -> Vec<(usize, JobText)> {
    let (case, points) = (judged.case, &judged.outcome.points);
    let solved: Vec<usize> =
        (0..points.len()).filter(|n| points[*n].is_solved() && judged.is_kept(&points[*n].unknowns, -EDGE)).collect();
    let own = [Coordinate::Along(2), Coordinate::Rho, Coordinate::Along(0), Coordinate::PolarAngle, Coordinate::Tabled];
    let all: Vec<Coordinate> = (0..judged.oracle.ranges.len()).map(Coordinate::Unknown).chain(own).collect();
    let pairs = all.iter().enumerate().flat_map(|(k, first)| all[k + 1..].iter().map(move |second| [first, second]));
    let asked = case.sample.each_ref().map(|asked| &asked.by);
    let pairs: Vec<[&Coordinate; 2]> = pairs.filter(|pair| *pair != asked).collect();
    let job = |(number, share): (usize, f64)| {
        let n = *solved.get((share * solved.len() as f64) as usize)?;
        let position = points[n].position?;
        let known = Touched { unknowns: points[n].unknowns.clone(), position };
        // another pair for each point and each case
        let turn = (position[0].abs() * 1e3) as usize + number * 7;
        let mut turned = (0..pairs.len()).map(|k| pairs[(k + turn) % pairs.len()].map(Coordinate::clone));
        let pair = turned.find(|pair| tells_apart(case, &known, pair))?;
        let sample = pair.each_ref().map(|by| Asked::only(by, by.value(&known.unknowns, position)));
        Some((n, JobText { name: format!("by_others_{number}"), sample, is_wide: false }))
    };
    [0.5, 0.1, 0.9].into_iter().enumerate().filter_map(job).collect()
}
