//! A program read back: what its blocks leave on the surface.

use std::path::Path;

use flank_chain_dsl::BlockLength;
use flank_solver::{PoseSeries, SweptCutter};

use super::Found;
use super::block::Motion;
use super::left::LeftMap;
use super::machine::{FreeAxes, Machine, moved_by};
use super::plan::LeftAt;
use super::program::{Move, Program, read};
use super::result::VerifiedProgram;
use super::target::{Fields, Target};
use crate::project::failure::Failure;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::shown_path;

/// A rapid in which a rotary axis turns farther is looked at in halves, radians: within this its ends are farthest from its middle.
const TURNED: f64 = 0.5;
/// How much farther from its middle than its ends another part of it may lie.
const BENT: f64 = 1.25;

/// A program that was read back, with what it leaves.
pub(super) struct ReadProgram {
    file: String,
    blocks: usize,
    tool_centre_control: bool,
    has_end: bool,
    pub(super) map: LeftMap,
    /// The deepest that cutting blocks and rapids go, and in which line.
    deepest: [Option<(LeftAt, usize)>; 2],
    /// How deep they may go, mm.
    promised: f64,
}

/// What a program leaves at the points of the map of what is planned.
///
/// # Errors
/// If the file cannot be read, or has words that are not followed.
pub(super) fn program(
    path: &Path,
    target: &Target<'_, '_>,
    found: &Found<'_, '_>,
    machine: &Machine<'_, '_>,
) -> Result<ReadProgram, Failure> {
    let shown = shown_path(path);
    let bytes = std::fs::read(path).map_err(|error| Failure::Input(format!("`{shown}` cannot be read: {error}")))?;
    // remarks are in whatever letters a control has
    let text = String::from_utf8_lossy(&bytes);
    let Program { moves, has_end } =
        read(&text, machine).map_err(|fault| Failure::Input(format!("{shown}:{fault}")))?;
    let (rapids, cuts): (Vec<Move>, Vec<Move>) = moves.into_iter().partition(|one| one.motion == Motion::Rapid);
    let left_by = |moves: &[Move]| {
        let blocks: Vec<PoseSeries> = moves.iter().map(|one| one.series(&machine.axes)).collect();
        let swept = SweptCutter::of_blocks(blocks, &found.cutter.cutting);
        let map = LeftMap::of_cutter(target, &found.fields, &swept, found.map.counts);
        let deepest = map.deepest().map(|(left, number)| (left, moves[number].line));
        (map, deepest)
    };
    let near = MilledPart::new(&found.fields, found.cutter.cutting.reach()).near(rapids, &machine.axes);
    let [(map, cut), (by_rapids, rapid)] = [left_by(&cuts), left_by(&near)];
    Ok(ReadProgram {
        file: shown,
        blocks: cuts.len(),
        tool_centre_control: cuts.iter().any(|cut| cut.has_tip_control),
        has_end,
        map: map.cut_by(&by_rapids),
        deepest: [cut, rapid],
        promised: promised(target, found, machine),
    })
}

/// How deep a program may cut, mm: as deep as the plan does, with the chord error that is asked for and the decimals of words.
fn promised(target: &Target<'_, '_>, found: &Found<'_, '_>, machine: &Machine<'_, '_>) -> f64 {
    let by_passes = found.map.deepest().map_or(0.0, |(left, _)| (-left.height).max(0.0));
    let chord = if let BlockLength::Chord(chord) = target.milling.blocks { chord } else { 0.0 };
    let by_blocks = chord.max(-found.milled.plan.blocks[1].height);
    let reach = found.cutter.cutting.reach();
    let rounded = found.milled.axes.iter().flatten().map(|row| machine.rounded(row, reach));
    by_passes + by_blocks + rounded.fold(0.0, f64::max)
}

/// A ball about what is milled, and how far the cutter reaches from its tip, mm.
struct MilledPart {
    center: [f64; 3],
    radius: f64,
    reach: f64,
}

impl MilledPart {
    fn new(fields: &Fields, reach: f64) -> MilledPart {
        let points: Vec<[f64; 3]> = fields.lattice.frames.iter().map(|frame| frame.position).collect();
        let center = [0, 1, 2].map(|k| points.iter().map(|point| point[k]).sum::<f64>() / points.len() as f64);
        let radius = points.iter().map(|point| distance(*point, center)).fold(0.0, f64::max);
        MilledPart { center, radius, reach }
    }

    /// The parts of rapids that come near, each short against the cutter.
    fn near(&self, rapids: Vec<Move>, axes: &FreeAxes) -> Vec<Move> {
        let (mut left, mut near) = (rapids, Vec::new());
        left.reverse();
        while let Some(rapid) = left.pop() {
            let series = rapid.series(axes);
            let [first, middle, last] = [0.0, 0.5, 1.0].map(|share| series.at(share));
            let moved =
                BENT * [first, last].map(|end| moved_by(&middle, &end, self.reach)).into_iter().fold(0.0, f64::max);
            let is_even = rapid.turn(axes) <= TURNED;
            let far = distance([middle[0], middle[1], middle[2]], self.center) - self.radius - self.reach;
            if is_even && far > moved {
                continue;
            }
            if is_even && moved <= self.reach {
                near.push(rapid);
            } else {
                left.extend(rapid.halves(axes).into_iter().rev());
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
        VerifiedProgram {
            file: self.file.clone(),
            blocks: self.blocks,
            tool_centre_control: self.tool_centre_control,
            map: self.map.result(target),
        }
    }

    /// What it does not do as the milling says.
    pub(super) fn missed(&self, target: &Target<'_, '_>) -> Vec<NotDone> {
        let name = target.name();
        let told = |kind: NotDoneKind, message: String, way: String| NotDone::new(kind, name, message).with(vec![way]);
        let unended = (!self.has_end).then(|| {
            let message = format!("{} does not say that it ends", self.file);
            told(NotDoneKind::NotMilled, message, "it may be cut off: M30 or M2 is missing, or END PGM".to_string())
        });
        let untouched = (self.map.untouched() > 0).then(|| {
            let message = format!(
                "{} does not pass over {} of {} points of {name}",
                self.file,
                self.map.untouched(),
                self.map.counts.iter().product::<usize>()
            );
            told(
                NotDoneKind::HeightUnknown,
                message,
                "blocks are missing, or go elsewhere: look at units and zero".to_string(),
            )
        });
        let deep = ["line", "the rapid in line"].into_iter().zip(self.deepest).filter_map(|(what, deepest)| {
            let (left, line) = deepest.filter(|(left, _)| left.height < -self.promised)?;
            let message = format!(
                "{what} {line} of {} cuts {:.4} mm into {name} at {}",
                self.file,
                -left.height,
                target.place(left.shares)
            );
            let way = format!(
                "what is planned, with its blocks and the decimals of words, is no deeper than {:.4} mm",
                self.promised
            );
            Some(told(NotDoneKind::TooDeep, message, way))
        });
        unended.into_iter().chain(untouched).chain(deep).collect()
    }
}
