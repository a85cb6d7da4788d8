//! Proofs that the cutter stays clear, also between its positions.

use flank_solver::{Clear, ClearProof, ToolBody};
use rayon::prelude::*;

use super::Milled;
use super::obstacles::Kept;
use super::patch::NEAR;
use super::result::ProvenClearance;
use super::straight::Straight;
use super::target::Target;
use crate::project::remark::{NotDone, NotDoneKind};

/// How many boxes a proof may look at in one block.
const MOST_BOXES: usize = 20_000;
/// Blocks that are looked at together; where one of them stays open, no more follow.
const TOGETHER: usize = 64;

/// Whether a body is proven to stay so far away on all blocks, between the positions, too.
pub(super) fn proven(
    target: &Target<'_, '_>,
    milled: &Milled<'_, '_>,
    tool_centre_control: bool,
    (of, (body_name, body), limit): (&Kept<'_>, (&str, &ToolBody), f64),
) -> (ProvenClearance, Option<NotDone>) {
    // what threads share: the machine itself they cannot
    let straight = Straight::of_machine(milled.machine.as_ref(), tool_centre_control);
    let (poses, rows) = (&milled.poses, &milled.axes);
    let block = |pass: usize, k: usize| {
        straight.block(&poses[pass][k..=k + 1], rows.get(pass).map_or(&[][..], |rows| &rows[k..=k + 1]))
    };
    // the surface may be nearer than its polynomials; by less than numbers are told it is not looked at
    let off = if of.off > NEAR { of.off } else { 0.0 };
    let proof = ClearProof::new(&of.obstacle, body);
    let blocks: Vec<[usize; 2]> =
        (0..poses.len()).flat_map(|pass| (0..poses[pass].len() - 1).map(move |k| [pass, k])).collect();
    let mut found: Vec<Clear> = Vec::with_capacity(blocks.len());
    for together in blocks.chunks(TOGETHER) {
        let of_block = |[pass, k]: &[usize; 2]| proof.along(&block(*pass, *k), limit + off, MOST_BOXES);
        found.extend(together.par_iter().map(of_block).collect::<Vec<Clear>>());
        if found.iter().any(|found| *found != Clear::Proven) {
            break;
        }
    }
    let known = found.iter().filter(|found| **found == Clear::Proven).count();
    let first = found.iter().position(|found| *found != Clear::Proven);
    let proven = ProvenClearance { limit, blocks: blocks.len(), proven: known };
    let not_proven = first.map(|first| {
        let [pass, position] = blocks[first];
        let place = target.place(milled.shares(target, pass, position));
        let message = format!(
            "it is not proven that {body_name} comes nowhere nearer than {limit:.4} mm to {}: first not in the block at {place}",
            of.name
        );
        let why = match found[first] {
            Clear::Missed { distance, shares, .. } => {
                format!("it comes as near as {distance:.4} mm, to {}", (of.place)(shares))
            }
            Clear::Open { proven } => format!(
                "after {MOST_BOXES} boxes it is proven to stay {proven:.4} mm away there: allow less, or ask for less distance"
            ),
            Clear::Proven => unreachable!("the first that is not proven"),
        };
        NotDone::new(NotDoneKind::NotCertified, &of.name, message).with(vec![why])
    });
    (proven, not_proven)
}
