//! A program read back: what its blocks leave on the surface.

use std::path::Path;

use flank_chain_dsl::BlockLength;
use flank_solver::{PoseSeries, SpacePlace, SweptCutter};
use rayon::prelude::*;

use super::Found;
use super::block::Motion;
use super::guard::Guards;
use super::left::LeftMap;
use super::machine::{FreeAxes, Machine, moved_by};
use super::measured::{Blocks, Measured, rounded};
use super::plan::LeftAt;
use super::program::{Move, Program, read};
use super::result::{HeightMap, VerifiedProgram};
use super::target::{Fields, Target};
use crate::project::failure::Failure;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::shown_path;

/// A move in which a rotary axis turns farther is looked at in halves, radians: within this its ends are farthest from its middle.
const TURNED: f64 = 0.5;
/// How much farther from its middle than its ends another part of it may lie.
const BENT: f64 = 1.25;

/// A program that was read back, with what it leaves.
pub(super) struct ReadProgram {
    file: String,
    blocks: usize,
    tool_centre_control: bool,
    has_end: bool,
    has_unit: bool,
    pub(super) map: LeftMap,
    /// What cutting blocks leave in all spaces.
    measured: Measured,
    /// The deepest that rapids go at the points of the map, and in which line.
    rapid: Option<(LeftAt, usize)>,
    /// The deepest of them that cut into what is looked at beside the map, in words.
    struck: [Option<NotDone>; 2],
}

/// What a program leaves, in as many spaces as are asked for; where that is one, in all that the work has if the program cuts in another, too.
///
/// # Errors
/// If the file cannot be read, or has words that are not followed.
pub(super) fn program(
    (path, asked): (&Path, u32),
    target: &Target<'_, '_>,
    found: &Found<'_, '_>,
    machine: &Machine<'_, '_>,
) -> Result<ReadProgram, Failure> {
    let shown = shown_path(path);
    let bytes = std::fs::read(path).map_err(|error| Failure::Input(format!("`{shown}` cannot be read: {error}")))?;
    // remarks are in whatever letters a control has
    let text = String::from_utf8_lossy(&bytes);
    if let Some(why) = no_program(&text) {
        return Err(Failure::Input(format!(
            "`{shown}` is no NC program: {why}; programs in the words of Fanuc, Siemens 840D, LinuxCNC and Heidenhain's Klartext are read"
        )));
    }
    let Program { moves, has_end, has_unit } =
        read(&text, machine).map_err(|fault| Failure::Input(format!("{shown}:{fault}")))?;
    let promised = promised(target, found, machine);
    let guards = Guards::new(target, found, promised);
    let struck = [Motion::Straight, Motion::Rapid].map(|motion| {
        let (hit, count) = guards.worst(&moves, motion, &machine.axes)?;
        let what = match motion {
            Motion::Straight => format!("line {} of {shown}", hit.line),
            Motion::Rapid => format!("the rapid in line {} of {shown}", hit.line),
        };
        Some(guards.told(&what, (hit, count), &no_deeper(promised)))
    });
    let (rapids, cuts): (Vec<Move>, Vec<Move>) = moves.into_iter().partition(|one| one.motion == Motion::Rapid);
    let (blocks, has_tip_control) = (cuts.len(), cuts.iter().any(|cut| cut.has_tip_control));
    let part = |places: &[SpacePlace]| MilledPart::new(&found.fields, places, found.cutter.cutting.reach());
    let (lines, series) = part(&found.spaces.alike()).near(cuts, &machine.axes).into_iter().unzip();
    let cuts = Blocks { series, lines, has_tip_control };
    let (measured, map) = Measured::of_blocks(cuts, target, found, (machine, asked, promised));
    let rapids = part(&[SpacePlace::default()]).near(rapids, &machine.axes);
    let (of_rapids, rapids): (Vec<usize>, Vec<PoseSeries>) = rapids.into_iter().unzip();
    let swept = SweptCutter::of_blocks(rapids, &found.cutter.cutting);
    let by_rapids = LeftMap::of_cutter(target, &found.fields, &swept, found.map.counts);
    let rapid = by_rapids.deepest().map(|(left, number)| (left, of_rapids[number]));
    Ok(ReadProgram {
        file: shown,
        blocks,
        tool_centre_control: has_tip_control,
        has_end,
        has_unit,
        map: map.cut_by(&by_rapids),
        measured,
        rapid,
        struck,
    })
}

/// Why a file is no program at all, in words: bytes that no text has, or nothing that any control would do.
fn no_program(text: &str) -> Option<&'static str> {
    // tapes begin and end with other letters than those of text, and old editors end with one
    let is_strange = |letter: char| letter.is_control() && !"\t\n\x0b\x0c\r\x03\x1a\x7f".contains(letter);
    // the letters of old controls that are no UTF-8 are controls of no kind
    let strange = text.chars().filter(|letter| is_strange(*letter)).count();
    if text.starts_with("PK\x03\x04") || text.contains('\0') || 50 * strange > text.len() {
        return Some("it is no text");
    }
    let is_word = |word: &str| {
        let word = word.trim_start_matches(|letter: char| letter.is_ascii_digit());
        let mut letters = word.chars();
        let code = letters.next().is_some_and(|letter| "GMgm".contains(letter));
        code && letters.next().is_some_and(|letter| letter.is_ascii_digit())
    };
    let is_of_program = |line: &str| {
        let line = line.trim_start_matches(['/', ' ', '\t']);
        let line = line.strip_prefix(['N', 'n']).unwrap_or(line);
        line.split_whitespace().any(is_word) || line.to_ascii_uppercase().contains("BEGIN PGM")
    };
    let is_empty = text.trim().is_empty();
    let mut lines = text.split(['\n', '\r']);
    (!is_empty && !lines.any(is_of_program)).then_some("no line of it has a G or M word, or BEGIN PGM")
}

/// The rapid of an own program that cuts in deepest, in words; such a program is not written.
///
/// # Errors
/// If the program is not followed.
pub(super) fn rapids(
    text: &str,
    target: &Target<'_, '_>,
    found: &Found<'_, '_>,
    machine: &Machine<'_, '_>,
) -> Result<Option<NotDone>, Failure> {
    let Program { moves, .. } = read(text, machine)
        .map_err(|fault| Failure::Unsolved(format!("the program would not be followed: {fault}")))?;
    let guards = Guards::new(target, found, promised(target, found, machine));
    Ok(guards.worst(&moves, Motion::Rapid, &machine.axes).map(|(hit, count)| {
        let lines: Vec<&str> = text.lines().collect();
        let remark = lines[..hit.line].iter().rev().find_map(|line| line.strip_prefix(['(', ';']));
        let pass = remark.unwrap_or("its beginning").trim().trim_end_matches(')').to_ascii_lowercase();
        let what = format!("the rapid `{}` of {pass}", lines[hit.line - 1]);
        let way = "clamp the work elsewhere, lean the cutter otherwise, or mill fewer spaces in one program";
        guards.told(&what, (hit, count), way)
    }))
}

/// How deep a program may cut, mm: as deep as the plan does, with the chord error that is asked for and the decimals of words.
fn promised(target: &Target<'_, '_>, found: &Found<'_, '_>, machine: &Machine<'_, '_>) -> f64 {
    let by_passes = found.map.deepest().map_or(0.0, |(left, _)| (-left.height).max(0.0));
    let chord = if let BlockLength::Chord(chord) = target.milling.blocks { chord } else { 0.0 };
    let by_blocks = chord.max(-found.milled.plan.blocks[1].height);
    by_passes + by_blocks + rounded(found, machine)
}

/// A ball about what is milled in all spaces, and how far the cutter reaches from its tip, mm.
struct MilledPart {
    center: [f64; 3],
    radius: f64,
    reach: f64,
}

impl MilledPart {
    fn new(fields: &Fields, places: &[SpacePlace], reach: f64) -> MilledPart {
        let points = places.iter().flat_map(|place| {
            let frames = fields.lattice.frames.iter();
            frames.map(|frame| {
                let [x, y, z] = frame.position;
                let [x, y, z, ..] = place.placed(&[x, y, z, 0.0, 0.0, 1.0]);
                [x, y, z]
            })
        });
        let points: Vec<[f64; 3]> = points.collect();
        let center = [0, 1, 2].map(|k| points.iter().map(|point| point[k]).sum::<f64>() / points.len() as f64);
        let radius = points.iter().map(|point| distance(*point, center)).fold(0.0, f64::max);
        MilledPart { center, radius, reach }
    }

    /// The parts of moves that come near, each with its line.
    fn near(&self, moves: Vec<Move>, axes: &FreeAxes) -> Vec<(usize, PoseSeries)> {
        moves.into_par_iter().flat_map_iter(|one| self.near_of(one, axes)).collect()
    }

    /// Those of one move, with little turns of rotary axes; those of rapids are short against the cutter.
    fn near_of(&self, one: Move, axes: &FreeAxes) -> Vec<(usize, PoseSeries)> {
        let (mut left, mut near) = (vec![one], Vec::new());
        while let Some(one) = left.pop() {
            let series = one.series(axes);
            let [first, middle, last] = [0.0, 0.5, 1.0].map(|share| series.at(share));
            let moved =
                BENT * [first, last].map(|end| moved_by(&middle, &end, self.reach)).into_iter().fold(0.0, f64::max);
            let is_even = one.turn(axes) <= TURNED;
            let far = distance([middle[0], middle[1], middle[2]], self.center) - self.radius - self.reach;
            if is_even && far > moved {
                continue;
            }
            if is_even && (moved <= self.reach || one.motion == Motion::Straight) {
                near.push((one.line, series));
            } else {
                left.extend(one.halves(axes).into_iter().rev());
            }
        }
        near
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

impl ReadProgram {
    pub(super) fn result(&self, target: &Target<'_, '_>) -> VerifiedProgram {
        let map = self.map.result(target);
        VerifiedProgram {
            file: self.file.clone(),
            blocks: self.blocks,
            tool_centre_control: self.tool_centre_control,
            spaces: self.measured.spaces.iter().map(|space| space + 1).collect(),
            map: HeightMap {
                left: self.measured.ends(target, self.rapid.map(|(left, _)| left)),
                untouched: self.measured.untouched().max(map.untouched),
                ..map
            },
        }
    }

    /// What it leaves to the control.
    pub(super) fn assumed(&self, target: &Target<'_, '_>) -> Option<Remark> {
        let message = format!("{} does not say its unit: lengths are read as mm", self.file);
        let way = "G21 says mm, G20 inches; of Siemens G710 and G700".to_string();
        (!self.has_unit).then(|| Remark::new(RemarkKind::Unsaid, target.name(), message).with(vec![way]))
    }

    /// What it does not do as the milling says.
    pub(super) fn missed(&self, target: &Target<'_, '_>) -> Vec<NotDone> {
        let name = target.name();
        let unended = (!self.has_end).then(|| {
            let message = format!("{} does not say that it ends", self.file);
            let way = "it may be cut off: M30 or M2 is missing, or END PGM".to_string();
            NotDone::new(NotDoneKind::NotMilled, name, message).with(vec![way])
        });
        let promised = self.measured.promised;
        let of_map = |what: &str, (left, space, line): (LeftAt, u32, usize)| {
            let others = (what == "line" && self.measured.deep > 1)
                .then(|| format!("of its blocks {} cut too deep, this one deepest", self.measured.deep));
            let message = format!(
                "{what} {line} of {} cuts {:.4} mm into {name} at {}",
                self.file,
                -left.height,
                in_space(target.place(left.shares), space)
            );
            NotDone::new(NotDoneKind::TooDeep, name, message)
                .with(others.into_iter().chain([no_deeper(promised)]).collect())
        };
        let is_deep = |left: &LeftAt| left.height < -promised;
        let [cut, rapid] = &self.struck;
        let deepest = self.measured.least.filter(|(left, ..)| is_deep(left)).map(|least| of_map("line", least));
        let cuts = deepest.into_iter().chain(cut.clone());
        // what the map says of a rapid, the whole surface says better
        let rapids = rapid.clone().or_else(|| {
            let (left, line) = self.rapid.filter(|(left, _)| is_deep(left))?;
            Some(of_map("the rapid in line", (left, 0, line)))
        });
        unended.into_iter().chain(self.measured.missed(&self.file, target)).chain(cuts).chain(rapids).collect()
    }
}

/// A place in words, with its space where that is not the first.
pub(super) fn in_space(place: String, space: u32) -> String {
    if space == 0 { place } else { format!("{place} of space {}", space + 1) }
}

fn no_deeper(promised: f64) -> String {
    format!("what is planned, with its blocks and the decimals of words, is no deeper than {promised:.4} mm")
}
