//! A program read back: what its blocks leave on the surface.

use std::path::Path;

use flank_solver::SweptCutter;

use super::block::Motion;
use super::cutter::MillingCutter;
use super::left::LeftMap;
use super::machine::Machine;
use super::program::{Move, Program, read};
use super::result::VerifiedProgram;
use super::target::{Fields, Target};
use crate::project::failure::Failure;
use crate::project::shown_path;

/// A program that was read back, with what it leaves.
pub(super) struct ReadProgram {
    file: String,
    blocks: usize,
    tool_centre_control: bool,
    pub(super) map: LeftMap,
}

/// What a program leaves at so many rows and columns of points.
///
/// # Errors
/// If the file cannot be read, or has words that the machine has not.
pub(super) fn program(
    path: &Path,
    target: &Target<'_, '_>,
    cutter: &MillingCutter,
    machine: &Machine<'_, '_>,
    (fields, counts): (&Fields, [usize; 2]),
) -> Result<ReadProgram, Failure> {
    let shown = shown_path(path);
    let bytes = std::fs::read(path).map_err(|error| Failure::Input(format!("`{shown}` cannot be read: {error}")))?;
    // remarks are in whatever letters a control has
    let text = String::from_utf8_lossy(&bytes);
    let Program { moves, .. } = read(&text, machine).map_err(|fault| Failure::Input(format!("{shown}:{fault}")))?;
    let cuts: Vec<&Move> = moves.iter().filter(|one| one.motion == Motion::Straight).collect();
    let tool_centre_control = cuts.iter().any(|cut| cut.has_tip_control);
    let count = cuts.len();
    let blocks = cuts.iter().map(|cut| cut.series(&machine.axes)).collect();
    let map = LeftMap::of_cutter(target, fields, &SweptCutter::of_blocks(blocks, &cutter.cutting), counts);
    Ok(ReadProgram { file: shown, blocks: count, tool_centre_control, map })
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
}
