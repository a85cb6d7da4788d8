//! `cut flank by edges`: single edges instead of the surface that they would leave if there were no end of them.

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::model::{GeneratedSurface, Process};
use crate::syntax::ast;
use crate::values::context::Context;

use super::Builder;

impl<'g> Builder<'_, 'g> {
    pub(super) fn cut(&mut self, context: &mut Context<'g>, surface: &ast::Path, by: &ast::Path, job: &ast::Job) {
        let found = [surface, by].map(|path| self.finished(context, path, job));
        let [Some(index), Some(edges)] = found else { return };
        let wrong = |message: String, help: &str| Diagnostic::new(Code::Cut, by.span, message).help(help);
        let [ideal, cutting] = [index, edges].map(|k| &self.surfaces[k].0);
        if !has_numbered_edges(cutting) {
            let message = format!("`{}` is no sweep of numbered edges", by.joined());
            let help = "sweep an edge over its motion, then over counts such as `motion gash : count in -20 .. 20`";
            return context.report(wrong(message, help));
        }
        if ideal.generation.process != Process::Sweep || ideal.generation.motions != cutting.generation.motions {
            let message = format!("`{}` is not swept over the motions of `{}`", surface.joined(), by.joined());
            let help = "the ideal surface is the sweep of the ideal edge over the same motions";
            return context.report(wrong(message, help));
        }
        if let Some(message) = self.two_frames([surface, by], [index, edges]) {
            return context.report(wrong(message, "give both in the frame of the work"));
        }
        if ideal.cut_by.is_some() {
            let message = format!("`{}` is cut twice", surface.joined());
            let statement = Rewriting::Without("cut", surface.span.to(by.span));
            return context.report(wrong(message, "take one of them away").rewriting(statement));
        }
        self.surfaces[index].0.cut_by = Some(edges);
    }
}

/// Whether a surface is the sweep of an edge over one motion, then over counts.
fn has_numbered_edges(surface: &GeneratedSurface<'_>) -> bool {
    let motions = &surface.unknowns[surface.unknowns.len() - surface.generation.motions.len()..];
    let is_swept = surface.generation.process == Process::Sweep;
    let counts = |motions: &[crate::model::RangedVariable<'_>]| motions.iter().all(|motion| motion.is_count);
    matches!(motions, [first, rest @ ..] if is_swept && !first.is_count && !rest.is_empty() && counts(rest))
}
