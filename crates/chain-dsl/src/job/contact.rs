//! Two flanks that roll on each other, and the unknown that their contact determines.

use flank_expr::Expr;
use flank_expr::geometry::Chain;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{Name, Span};
use crate::model::{Contact, MountingAxis, RangedVariable, path};
use crate::syntax::ast::{self, Expression, ExpressionKind};
use crate::values::context::{Context, Role, quoted};
use crate::values::dimension::Dimension;
use crate::values::value::Constant;

use super::{Builder, FrameRef};

/// The arguments of a contact.
const ARGUMENTS: [&str; 3] = ["over", "for", "every"];

impl<'g> Builder<'_, 'g> {
    pub(super) fn contact(&mut self, context: &mut Context<'g>, written: &ast::Contact, job: &ast::Job) {
        let Some(contact) = self.built_contact(context, written, job) else { return };
        self.contacts.push(contact);
    }

    fn built_contact(
        &mut self,
        context: &mut Context<'g>,
        written: &ast::Contact,
        job: &ast::Job,
    ) -> Option<Contact<'g>> {
        let [over, sought, every] = self.contact_arguments(context, written)?;
        let found = written.surfaces.each_ref().map(|path| self.finished(context, path, job));
        let roll = self.rolled_by(context, over?)?;
        let lag = self.determined(context, sought?)?;
        let surfaces = [found[0]?, found[1]?];
        let wrong = |span: Span, message: String, help: &str| Diagnostic::new(Code::Contact, span, message).help(help);
        let [first, second] = written.surfaces.each_ref();
        if surfaces[0] == surfaces[1] {
            let help = "name the flank of the mate, as in `contact drive_side = pinion_flank with gear_flank, over: turn, for: lag`";
            context.report(wrong(second.span, format!("`{}` cannot touch itself", second.joined()), help));
            return None;
        }
        let mounted = [first, second].map(|path| self.mounted(context, path));
        let frames = [mounted[0]?, mounted[1]?];
        if frames[0].0 != frames[1].0 {
            let [a, b] = frames.map(|frame| self.frame_name(frame));
            let message =
                format!("`{}` is mounted on `{a}`, `{}` on `{b}`: two machines", first.joined(), second.joined());
            context.report(wrong(second.span, message, "mount both on frames of the machine that is the pair"));
            return None;
        }
        // axes without laws have been reported
        if self.unsettled.contains(&frames[0].0) {
            return None;
        }
        let (placements, errors) = self.placements(context, frames);
        let span = second.span;
        if !self.rolls(context, &placements, [&roll, &lag], span) {
            return None;
        }
        let every = match every {
            Some(every) => Some(self.pitch(context, every, &roll)?),
            None => None,
        };
        Some(Contact {
            name: written.name.node.clone(),
            doc: written.doc.clone(),
            surfaces,
            frames: frames.map(|frame| self.frame_name(frame)),
            placements,
            errors,
            roll,
            lag,
            every,
            written: written.name.span,
        })
    }

    fn contact_arguments<'w>(
        &self,
        context: &mut Context<'g>,
        written: &'w ast::Contact,
    ) -> Option<[Option<&'w Expression>; 3]> {
        let mut found: [Option<&Expression>; 3] = [None; 3];
        for argument in &written.arguments {
            let name = argument.name.as_ref()?;
            let Some(place) = ARGUMENTS.iter().position(|known| *known == name.node) else {
                context.unknown(name, "argument of `contact`", ARGUMENTS.into_iter());
                return None;
            };
            if let Some(first) = found[place].replace(&argument.value) {
                context.duplicate(name, first.span);
                return None;
            }
        }
        let missing: Vec<&str> = [0, 1].into_iter().filter(|k| found[*k].is_none()).map(|k| ARGUMENTS[k]).collect();
        if !missing.is_empty() {
            let message = format!("`{}` needs {}", written.name.node, quoted(&missing));
            let help = "say the motion that the pair rolls by and the unknown that the contact determines, as in `over: turn, for: lag`";
            context.report(Diagnostic::new(Code::WrongArguments, written.name.span, message).help(help));
            return None;
        }
        Some(found)
    }

    /// The frame that a flank of a contact is mounted on.
    fn mounted(&self, context: &mut Context<'g>, path: &ast::Path) -> Option<FrameRef> {
        let owner = &path.segments[0];
        if let Some((frame, _)) = self.mounts.get(&owner.node) {
            return *frame;
        }
        let message = format!("`{}` is not mounted on any frame", owner.node);
        let help = format!("say on which shaft it sits: `mount {} on …`", owner.node);
        context.report(Diagnostic::new(Code::NotMounted, owner.span, message).help(help));
        None
    }

    /// From the machine's root to both flanks, with laws for axes and an error for each axis on the way.
    fn placements(&self, context: &mut Context<'g>, frames: [FrameRef; 2]) -> ([Chain<'g>; 2], Vec<MountingAxis<'g>>) {
        let (name, _, built) = &self.machines[frames[0].0];
        let chains = frames.map(|(_, frame)| {
            let hops = path(&built.frames, 0, frame);
            Chain::new(context.graph, hops.into_iter().flat_map(|(_, steps)| steps).collect())
        });
        let matters = |variable: Expr<'g>| chains.iter().any(|chain| !chain.twist(variable).is_zero());
        let mut errors = Vec::new();
        let mut laws = self.laws.clone();
        for axis in built.axes.iter().filter(|axis| matters(axis.variable)) {
            let (Some(dimension), Some(law)) = (axis.dimension, laws.iter_mut().find(|(of, _)| *of == axis.variable))
            else {
                continue;
            };
            let whole = format!("{}.{}", name.node, axis.name.node);
            let variable = context.variable(format!("error of {whole}"), Role::Motion, f64::NAN);
            let is_driven = !matches!(context.constant(law.1), Constant::Known(_) | Constant::Unknown);
            law.1 = law.1 + variable;
            errors.push(MountingAxis { name: whole, variable, dimension, is_driven });
        }
        (chains.map(|chain| chain.substituted(&laws)), errors)
    }

    /// Whether the pair moves with the roll and the unknown, and with nothing else.
    fn rolls(
        &self,
        context: &mut Context<'g>,
        placements: &[Chain<'g>; 2],
        [roll, lag]: [&RangedVariable<'g>; 2],
        span: Span,
    ) -> bool {
        let moves = |variable: Expr<'g>| placements.iter().any(|placement| !placement.twist(variable).is_zero());
        for (of, what) in [(roll, "over"), (lag, "for")] {
            if !moves(of.variable) {
                let message = format!("`{}` moves neither flank", of.name);
                let help = format!("drive a shaft of the pair with it, or name what does in `{what}:`");
                context.report(Diagnostic::new(Code::Contact, span, message).help(help));
                return false;
            }
        }
        let others: Vec<&str> = self
            .motions
            .iter()
            .filter(|other| other.variable != roll.variable && other.variable != lag.variable && moves(other.variable))
            .map(|other| other.name.as_str())
            .collect();
        if !others.is_empty() {
            let message = format!("the pair also moves with {}", quoted(&others));
            let help = format!(
                "it rolls by `{}` alone, and the contact determines `{}`: let nothing else drive its axes",
                roll.name, lag.name
            );
            context.report(Diagnostic::new(Code::Contact, span, message).help(help));
            return false;
        }
        true
    }

    fn rolled_by(&self, context: &mut Context<'g>, written: &Expression) -> Option<RangedVariable<'g>> {
        let found = self.named_motion(context, written, "over")?;
        if self.unknowns.contains(&found.variable) {
            let message = format!("`{}` is an unknown: a contact determines it", found.name);
            let help = "`over:` takes the motion that the pair rolls by";
            context.report(Diagnostic::new(Code::Contact, written.span, message).help(help));
            return None;
        }
        Some(found)
    }

    fn determined(&self, context: &mut Context<'g>, written: &Expression) -> Option<RangedVariable<'g>> {
        let found = self.named_motion(context, written, "for")?;
        if !self.unknowns.contains(&found.variable) {
            let message = format!("`{}` is a motion, and no unknown", found.name);
            let help = "declare what the contact determines, such as `unknown lag : angle in -1 deg .. 1 deg`";
            context.report(Diagnostic::new(Code::Contact, written.span, message).help(help));
            return None;
        }
        Some(found)
    }

    /// The motion or unknown that an argument names.
    fn named_motion(
        &self,
        context: &mut Context<'g>,
        written: &Expression,
        argument: &str,
    ) -> Option<RangedVariable<'g>> {
        let name: &Name = match &written.kind {
            ExpressionKind::Path(path) if path.segments.len() == 1 => &path.segments[0],
            ExpressionKind::Error => return None,
            _ => {
                let message = format!("`{argument}:` takes the name of a motion or an unknown");
                context.report(Diagnostic::new(Code::WrongKind, written.span, message));
                return None;
            }
        };
        let found = self.motions.iter().find(|motion| motion.name == name.node).cloned();
        if found.is_none() && !self.names.contains_key(&name.node) {
            context.unknown(name, "motion or unknown", self.motions.iter().map(|motion| motion.name.as_str()));
        } else if found.is_none() && self.scope.contains_key(&name.node) {
            let message = format!("`{}` is neither a motion nor an unknown", name.node);
            context.report(Diagnostic::new(Code::WrongKind, name.span, message));
        }
        found
    }

    /// How far the pair rolls from tooth to tooth.
    fn pitch(&self, context: &mut Context<'g>, written: &Expression, roll: &RangedVariable<'g>) -> Option<f64> {
        let value =
            context.scalar(written, &self.scope, roll.dimension, "the roll from one pair of teeth to the next")?;
        match context.constant(value) {
            Constant::Known(pitch) if pitch > 0.0 && pitch.is_finite() => Some(pitch),
            Constant::Unknown => None,
            _ => {
                let message = "the roll from one pair of teeth to the next is a number above zero";
                let unit = if roll.dimension == Dimension::ANGLE { "360 deg / 19" } else { "3.14 mm" };
                let help = format!("for example `every: {unit}`");
                context.report(Diagnostic::new(Code::Contact, written.span, message).help(&help));
                None
            }
        }
    }
}
