//! Proofs that the cutter stays clear, also between its positions.

use flank_solver::{Clear, ClearProof, ToolBody};
use rayon::prelude::*;

use super::Milled;
use super::obstacles::Kept;
use super::plan::straight;
use super::result::ProvenClearance;
use super::target::Target;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::units;

/// How many boxes a proof may look at in one block.
const MOST_BOXES: usize = 200_000;

/// Whether a body is proven to stay so far away on all blocks, between the positions, too.
pub(super) fn proven(
    target: &Target<'_, '_>,
    milled: &Milled<'_, '_>,
    tool_centre_control: bool,
    (of, (body_name, body), limit): (&Kept<'_>, (&str, &ToolBody), f64),
) -> (ProvenClearance, Option<NotDone>) {
    let axes = milled.machine.as_ref().filter(|_| !tool_centre_control).map(|machine| &machine.axes);
    // what threads share: the machine itself they cannot
    let (poses, rows) = (&milled.poses, &milled.axes);
    let block = |pass: usize, k: usize| match axes {
        Some(axes) => axes.straight(&rows[pass][k], &rows[pass][k + 1]),
        None => straight(poses[pass][k], poses[pass][k + 1]),
    };
    let proof = ClearProof::new(&of.obstacle, body);
    let blocks: Vec<[usize; 2]> =
        (0..poses.len()).flat_map(|pass| (0..poses[pass].len() - 1).map(move |k| [pass, k])).collect();
    let found: Vec<Clear> =
        blocks.par_iter().map(|[pass, k]| proof.along(&block(*pass, *k), limit, MOST_BOXES)).collect();
    let open = found.iter().filter(|found| **found != Clear::Proven).count();
    let first = found.iter().position(|found| *found != Clear::Proven);
    let proven = ProvenClearance { limit, blocks: blocks.len(), open };
    let not_proven = first.map(|first| {
        let [pass, position] = blocks[first];
        let place = target.place(milled.shares(target, pass, position));
        let message = format!(
            "it is not proven that {body_name} comes nowhere nearer than {limit:.4} mm to {}: not in {} of {}, first in that at {place}",
            of.name,
            open,
            units::counted(blocks.len(), "block")
        );
        let why = match found[first] {
            Clear::Missed { distance, shares, .. } => {
                format!("it comes as near as {distance:.4} mm, to {}", (of.place)(shares))
            }
            _ => "it comes so near that boxes would have to be very small: allow less, or ask for less distance".to_string(),
        };
        NotDone::new(NotDoneKind::NotCertified, &of.name, message).with(vec![why])
    });
    (proven, not_proven)
}
