//! The cutter on its passes, for a page.

use flank_chain_dsl::Job;
use flank_draw::{PageColumn, PageCut, PageMilling};
use flank_solver::OutlinePiece;

use super::Found;
use super::cutter::outline;
use super::target::Target;
use crate::project::failure::Failure;
use crate::project::units;

/// Passes of a page at the most, and positions on each.
const MOST: usize = 40;
/// Chords of an arc.
const CHORDS: usize = 16;

/// A planned milling of the surface in a place among those of the page.
///
/// # Errors
/// If a part of the cutter is none.
pub(super) fn on_page(
    job: &Job<'_>,
    target: &Target<'_, '_>,
    found: &Found<'_, '_>,
    surface: usize,
) -> Result<PageMilling, Failure> {
    let (milling, milled) = (target.milling, &found.milled);
    // what stays clear of something is all of the cutter
    let whole = milling.clearances.first().map(|clearance| outline(job, &clearance.body)).transpose()?;
    let pieces = whole.as_ref().map_or(&found.cutter.cutting.pieces, |whole| &whole.pieces);
    let column = |name: &str, unit: &str| PageColumn { name: name.to_string(), unit: unit.to_string() };
    let (area, axes) = (&milling.area, milled.machine.iter().flat_map(|machine| &machine.free));
    let coordinates = (0..2).map(|k| column(&area.names[k], units::symbol(area.dimensions[k])));
    let columns = coordinates.chain(axes.clone().map(|axis| column(&axis.name, units::symbol(axis.dimension))));
    let counts = [milled.poses.len(), milled.poses[0].len()];
    let [passes, positions] = counts.map(spread);
    let at = |pass: usize, position: usize| {
        let values = target.values(milled.shares(target, pass, position));
        let row = milled.axes.get(pass).map_or(&[][..], |rows| &rows[position]);
        let axes = axes.clone().zip(row).map(|(axis, at)| units::shown(axis.dimension, *at));
        PageCut {
            contact: milled.lattice.at(pass, milled.column(target, pass, position)).position,
            pose: milled.poses[pass][position],
            values: (0..2).map(|k| units::shown(area.dimensions[k], values[k])).chain(axes).collect(),
        }
    };
    let cuts = passes.iter().flat_map(|pass| positions.iter().map(|position| at(*pass, *position)).collect::<Vec<_>>());
    Ok(PageMilling {
        name: milling.name.clone(),
        surface,
        cutter: milling.cutter_name.clone(),
        outline: pieces.iter().map(line).collect(),
        columns: columns.collect(),
        positions: cuts.collect(),
        numbers: [&passes, &positions].map(|all| all.iter().map(|at| at + 1).collect()),
        counts,
    })
}

/// Some of so many, evenly spread, with both ends.
fn spread(count: usize) -> Vec<usize> {
    let shown = count.min(MOST);
    (0..shown).map(|k| if shown > 1 { k * (count - 1) / (shown - 1) } else { 0 }).collect()
}

/// The points of a piece; an edge has its bottom.
fn line(piece: &OutlinePiece) -> Vec<[f64; 2]> {
    match *piece {
        OutlinePiece::Line { from, to } => vec![from, to],
        OutlinePiece::Arc { center: [rho, z], radius: 0.0, .. } => vec![[0.0, z], [rho, z]],
        OutlinePiece::Arc { center, radius, between: [a, b] } => {
            let at = |angle: f64| [center[0] + radius * angle.sin(), center[1] - radius * angle.cos()];
            (0..=CHORDS).map(|k| at(a + (b - a) * k as f64 / CHORDS as f64)).collect()
        }
    }
}
