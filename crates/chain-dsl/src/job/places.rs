//! Frames that stand somewhere.

use flank_expr::Expr;
use flank_expr::geometry::{Axis, Step};

use crate::diagnostics::source::Span;
use crate::values::context::Context;

use super::{Builder, FrameRef};

impl<'g> Builder<'_, 'g> {
    /// Whether the transforms on the way from a frame, which is named at a place, to another one can be computed; reported if one of them
    /// cannot, wherever the motions are in their ranges. Then the machine is not whole.
    pub(super) fn has_places(
        &mut self,
        context: &mut Context<'g>,
        path: &[(String, Vec<Step<'g>>)],
        (frame, named): (FrameRef, Span),
    ) -> bool {
        if self.unsettled.contains(&frame.0) {
            return true;
        }
        let mut from = &self.frame_name(frame);
        for (to, steps) in path {
            let written: Vec<Expr<'g>> = steps.iter().flat_map(|step| parts(*step)).collect();
            let driven = context.graph.substitute(&written, &self.laws);
            if let Some((part, value)) = driven.iter().find_map(|part| Some((*part, context.nowhere(*part)?))) {
                context.not_finite(value, Some(part), named, format!("what stands between `{from}` and `{to}`"));
                self.unsettled.insert(frame.0);
                return false;
            }
            from = to;
        }
        true
    }
}

/// What the pose of a step is computed from.
fn parts(step: Step<'_>) -> Vec<Expr<'_>> {
    match step {
        Step::Translate(by) => by.0.to_vec(),
        Step::Rotate(Axis::Along(direction), angle) => direction.0.into_iter().chain([angle]).collect(),
        Step::Rotate(_, angle) => vec![angle],
        Step::Mirror(Axis::Along(direction)) => direction.0.to_vec(),
        Step::Mirror(_) => Vec::new(),
        Step::Rigid(pose) => pose.rotation.0.into_iter().flat_map(|row| row.0).chain(pose.translation.0).collect(),
    }
}
