//! A program read back: what its blocks leave on the surface.

use std::path::Path;

use flank_solver::{PoseSeries, lowest};
use rayon::prelude::*;

use super::cutter::MillingCutter;
use super::left;
use super::machine::Machine;
use super::plan::LeftAt;
use super::program::{Program, read};
use super::result::VerifiedProgram;
use super::target::{Fields, Target};
use crate::project::failure::Failure;
use crate::project::shown_path;

/// Rows and columns of cells of the map; its points lie in their middles, on no pass in particular.
const MAP: [usize; 2] = [15, 31];

/// # Errors
/// If the file cannot be read, or has words that the machine has not.
pub(super) fn program(
    path: &Path,
    target: &Target<'_, '_>,
    cutter: &MillingCutter,
    machine: &Machine<'_, '_>,
    fields: &Fields,
) -> Result<VerifiedProgram, Failure> {
    let shown = shown_path(path);
    let text =
        std::fs::read_to_string(path).map_err(|error| Failure::Input(format!("`{shown}` cannot be read: {error}")))?;
    let Program { blocks, tool_centre_control } =
        read(&text, machine).map_err(|fault| Failure::Input(format!("{shown}:{fault}")))?;
    let middles: Vec<[f64; 6]> = blocks.par_iter().map(|block| block.at(0.5)).collect();
    let reaches: Vec<f64> = blocks
        .par_iter()
        .zip(&middles)
        .map(|(block, middle)| {
            let ends = [block.at(0.0), block.at(1.0)];
            // how far a point of the cutter near the contact moves: with the tip, and with the turn
            ends.iter()
                .map(|end| super::distance(end, middle) + turned(end, middle) * cutter.cutting.reach())
                .fold(0.0, f64::max)
        })
        .collect();
    let middle = |k: usize, at: usize| (at as f64 + 0.5) / MAP[k] as f64;
    let shares: Vec<[f64; 2]> =
        (0..MAP[0]).flat_map(|row| (0..MAP[1]).map(move |column| [middle(0, row), middle(1, column)])).collect();
    let stock = target.milling.stock;
    let of_node = |shares: &[f64; 2]| {
        let line = fields.surface.pass(shares[0]).at(shares[1]);
        least(&line, &blocks, (&middles, &reaches), cutter)
            .map(|height| LeftAt { shares: *shares, height: height - stock })
    };
    let found: Vec<Option<LeftAt>> = shares.par_iter().map(of_node).collect();
    let known = || found.iter().flatten().copied();
    let most = known().reduce(|a, b| if b.height > a.height { b } else { a });
    let least = known().reduce(|a, b| if b.height < a.height { b } else { a });
    Ok(VerifiedProgram {
        file: shown,
        blocks: blocks.len(),
        tool_centre_control,
        left: most.zip(least).map(|(most, least)| [left(target, most), left(target, least)]),
        untouched: found.iter().filter(|found| found.is_none()).count(),
        points: found.len(),
    })
}

/// The angle between two axes, nearly.
fn turned(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    (3..6).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// The least height over a point of all blocks that come near enough.
fn least(
    line: &[f64; 6],
    blocks: &[PoseSeries],
    (middles, reaches): (&[[f64; 6]], &[f64]),
    cutter: &MillingCutter,
) -> Option<f64> {
    let point = [line[0], line[1], line[2]];
    let gaps: Vec<f64> = middles.iter().map(|middle| cutter.cutting.gap(middle, point)).collect();
    let bound = gaps.iter().zip(reaches).map(|(gap, reach)| gap + reach).fold(f64::INFINITY, f64::min);
    let near = gaps.iter().zip(reaches).enumerate().filter(|(_, (gap, reach))| **gap - **reach <= bound);
    let heights = near.filter_map(|(k, _)| lowest(&blocks[k], &cutter.cutting, line, 0.5).map(|found| found.height));
    heights.reduce(f64::min)
}
