//! What a contact shall be like at its vertex.

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::model::{Contact, ContactCondition, ContactQuantity, WantedContact};
use crate::syntax::ast::{self, Argument, Expression, ExpressionKind, JobStatement};
use crate::values::context::Context;
use crate::values::dimension::Dimension;

use super::Builder;

/// Of the marking compound, mm: a quarter of a thousandth of an inch.
const FILM: f64 = 0.00635;
/// What is said of the film.
const OF_FILM: &str = "film";

const EXAMPLE: &str =
    "for example `want centred in drive_side = vertex(lengthwise: 0.5, profilewise: 0.5, path: 30 deg, ellipse: 8 mm)`";
const ABOUT: &str = "for example `path: about(30 deg, 2 deg)`";

impl ContactQuantity {
    /// All of them, in the order in which messages name them.
    pub const ALL: [ContactQuantity; 7] = [
        ContactQuantity::Z,
        ContactQuantity::Rho,
        ContactQuantity::Lengthwise,
        ContactQuantity::Profilewise,
        ContactQuantity::Path,
        ContactQuantity::Ellipse,
        ContactQuantity::TransmissionError,
    ];

    /// As the language has it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            ContactQuantity::Z => "z",
            ContactQuantity::Rho => "rho",
            ContactQuantity::Lengthwise => "lengthwise",
            ContactQuantity::Profilewise => "profilewise",
            ContactQuantity::Path => "path",
            ContactQuantity::Ellipse => "ellipse",
            ContactQuantity::TransmissionError => "transmission_error",
        }
    }

    /// Of its values, in a contact whose error has a dimension.
    #[must_use]
    pub fn dimension(self, error: Dimension) -> Dimension {
        match self {
            ContactQuantity::Z | ContactQuantity::Rho | ContactQuantity::Ellipse => Dimension::LENGTH,
            ContactQuantity::Lengthwise | ContactQuantity::Profilewise => Dimension::NUMBER,
            ContactQuantity::Path => Dimension::ANGLE,
            ContactQuantity::TransmissionError => error,
        }
    }

    fn is_positive(self) -> bool {
        matches!(self, ContactQuantity::Rho | ContactQuantity::Ellipse | ContactQuantity::TransmissionError)
    }

    fn is_share(self) -> bool {
        self.dimension(Dimension::ANGLE) == Dimension::NUMBER
    }

    fn is_section(self) -> bool {
        matches!(self, ContactQuantity::Z | ContactQuantity::Rho)
    }
}

impl<'g> Builder<'_, 'g> {
    pub(super) fn want(&mut self, context: &mut Context<'g>, written: &ast::Want, job: &ast::Job) {
        let Some(want) = self.built_want(context, written, job) else { return };
        self.wants.push(want);
    }

    fn built_want(&mut self, context: &mut Context<'g>, written: &ast::Want, job: &ast::Job) -> Option<WantedContact> {
        let at = self.wanted_contact(context, written, job)?;
        let arguments = vertex(context, &written.value)?;
        let error = self.contacts[at].lag.dimension;
        let (mut conditions, mut film): (Vec<ContactCondition>, Option<f64>) = (Vec::new(), None);
        for argument in arguments {
            let name = argument.name.as_ref()?;
            let known = ContactQuantity::ALL.into_iter().find(|of| of.name() == name.node);
            let first = conditions.iter().find(|condition| Some(condition.of) == known);
            if let Some(first) = first.map(|first| first.written) {
                context.duplicate(name, first);
                return None;
            }
            match known {
                Some(of) => conditions.push(self.condition(context, of, argument, error)?),
                None if name.node == OF_FILM && film.is_none() => {
                    film = Some(self.positive(context, &argument.value, (Dimension::LENGTH, "a film"))?);
                }
                None => {
                    let known = ContactQuantity::ALL.into_iter().map(ContactQuantity::name).chain([OF_FILM]);
                    context.unknown(name, "number of a contact", known);
                    return None;
                }
            }
        }
        let wrong = |message: &str| Diagnostic::new(Code::Want, written.value.span, message).help(EXAMPLE);
        if conditions.is_empty() {
            context.report(wrong("nothing is wanted of the contact"));
            return None;
        }
        if film.is_some() && !conditions.iter().any(|of| of.of == ContactQuantity::Ellipse) {
            context.report(wrong("a film is that of an `ellipse`, and none is wanted"));
            return None;
        }
        let share = conditions.iter().find(|of| of.of.is_share());
        if let (Some(share), Some(section)) = (share, conditions.iter().find(|of| of.of.is_section())) {
            let message = format!("`{}` and `{}` say the same place twice", section.of.name(), share.of.name());
            let help = "say it by `z` and `rho`, or by the shares `lengthwise` and `profilewise`";
            context.report(Diagnostic::new(Code::Want, share.written, message).help(help));
            return None;
        }
        Some(WantedContact {
            name: written.name.node.clone(),
            doc: written.doc.clone(),
            contact: at,
            conditions,
            film: film.unwrap_or(FILM),
            written: written.name.span,
        })
    }

    fn wanted_contact(&self, context: &mut Context<'g>, written: &ast::Want, job: &ast::Job) -> Option<usize> {
        let path = &written.contact;
        let found = self.contacts.iter().position(|Contact { name, .. }| *name == path.joined());
        let declared = job.statements.iter().filter_map(|statement| match statement {
            JobStatement::Contact(contact) => Some(contact.name.node.as_str()),
            _ => None,
        });
        let declared: Vec<&str> = declared.collect();
        // one that could not be built has been reported
        if found.is_none() && !declared.contains(&path.joined().as_str()) {
            context.unknown(&path.segments[0], "contact", declared.into_iter());
        }
        found
    }

    fn condition(
        &self,
        context: &mut Context<'g>,
        of: ContactQuantity,
        written: &Argument,
        error: Dimension,
    ) -> Option<ContactCondition> {
        let dimension = of.dimension(error);
        let (value, within) = match &written.value.kind {
            ExpressionKind::Call(call) if call.function.node == "about" => match &call.arguments[..] {
                [value, within] if value.name.is_none() && within.name.is_none() => (&value.value, Some(&within.value)),
                _ => {
                    let message = "`about` takes a value and how far it may be off";
                    context.report(Diagnostic::new(Code::WrongArguments, call.span, message).help(ABOUT));
                    return None;
                }
            },
            _ => (&written.value, None),
        };
        let what = format!("`{}`", of.name());
        let value = match of.is_positive() {
            true => self.positive(context, value, (dimension, &what))?,
            false => self.known(context, value, (dimension, &what))?,
        };
        let within = match within {
            Some(within) => Some(self.positive(context, within, (dimension, "how far a value may be off"))?),
            None => None,
        };
        Some(ContactCondition { of, value, within, written: written.value.span })
    }

    fn known(
        &self,
        context: &mut Context<'g>,
        written: &Expression,
        (dimension, what): (Dimension, &str),
    ) -> Option<f64> {
        let value = context.scalar(written, &self.scope, dimension, what)?;
        context.require_constant(value, written.span, what)
    }

    fn positive(
        &self,
        context: &mut Context<'g>,
        written: &Expression,
        (dimension, what): (Dimension, &str),
    ) -> Option<f64> {
        let value = self.known(context, written, (dimension, what))?;
        if value > 0.0 {
            return Some(value);
        }
        context.report(Diagnostic::new(Code::Want, written.span, format!("{what} is above zero")));
        None
    }
}

/// The arguments of `vertex(…)`.
fn vertex<'w>(context: &mut Context<'_>, written: &'w Expression) -> Option<&'w [Argument]> {
    let call = match &written.kind {
        ExpressionKind::Call(call) if call.function.node == "vertex" => call,
        ExpressionKind::Call(call) => {
            context.unknown(&call.function, "place of a contact", ["vertex"].into_iter());
            return None;
        }
        ExpressionKind::Error => return None,
        _ => {
            let message = "a contact is wanted at its vertex, where the error is extreme";
            context.report(Diagnostic::new(Code::WrongKind, written.span, message).help(EXAMPLE));
            return None;
        }
    };
    if let Some(argument) = call.arguments.iter().find(|argument| argument.name.is_none()) {
        let message = "each number of a contact has its name";
        context.report(Diagnostic::new(Code::WrongArguments, argument.value.span, message).help(EXAMPLE));
        return None;
    }
    Some(&call.arguments)
}
