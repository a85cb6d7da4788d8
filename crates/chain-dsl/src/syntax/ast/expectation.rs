//! What a spec is tested by.

use super::{Argument, Call, Expression, ExpressionKind, File, Instance, Item, JobStatement, Path, Range};
use crate::diagnostics::source::{Name, Span};

/// `expect …`
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// What is expected.
    pub what: Expected,
    /// What it is about, without blanks: of a job that extends another one, it takes the place of those about the same.
    pub about: String,
    /// From `expect` to its end.
    pub span: Span,
}

/// What a spec is to be like.
#[derive(Clone, Debug, PartialEq)]
pub enum Expected {
    /// `error E0307`: the spec is wrong in this way.
    Error(Name),
    /// `nothing`: what the job that it extends expects is dropped.
    Nothing,
    /// `travel`: no axis leaves its travel.
    Travel,
    /// `on free_form(root: 10 deg) within 1 um`: another machine does the same.
    On {
        /// The machine with its settings; its name is that of the definition.
        machine: Instance,
        /// How far the tool may be off.
        within: Expression,
    },
    /// `flank solved`, `flank undercut at [46 mm, 0 mm]`
    Status {
        /// A sampled surface; `all` of them.
        surface: Path,
        /// What becomes of its points.
        status: Name,
        /// Values of the sample's two coordinates; all of the sample otherwise.
        at: Option<Expression>,
    },
    /// `ratio near 1.6 within 0.01`, `flank near other.flank within 1 um`, `flank: nx near 0 within 1e-9`
    Near {
        /// Whose points have the value, if it is one of points.
        surface: Option<Path>,
        /// The value, or a surface.
        value: Expression,
        /// What it is compared with.
        target: Expression,
        /// By how much it may differ.
        within: Expression,
    },
    /// `ratio in 1.6 .. 1.7`
    InRange {
        /// Whose points have the value, if it is one of points.
        surface: Option<Path>,
        /// The value.
        value: Expression,
        /// Where it lies.
        range: Range,
    },
    /// `tool in work near translate(…) at (X: 10 mm) within 1 um, 1 arcsec`: where a frame of a machine stands.
    Pose {
        /// The frame, and the one in which it stands.
        frames: [Name; 2],
        /// The pose, as transforms of a frame are written.
        transforms: Vec<Call>,
        /// Axes and settings with their values.
        at: Vec<Argument>,
        /// How far its origin may be off, and by how much it may be turned: a length, an angle, or both.
        within: Vec<Expression>,
    },
}

impl File {
    /// The tables that its expectations name, as they name them.
    pub fn expected_tables(&self) -> Vec<String> {
        let mut found = Vec::new();
        for item in &self.items {
            let Item::Job(job) = item else { continue };
            for statement in &job.statements {
                if let JobStatement::Expect(expected) = statement {
                    found.extend(expected.tables());
                }
            }
        }
        found
    }
}

/// Significant digits of a number that nobody chose.
const WORKED_OUT: usize = 7;

/// Significant digits of a number as it is written at its shortest.
fn digits(value: f64) -> usize {
    let shortest = format!("{value:e}");
    shortest.split('e').next().unwrap_or_default().bytes().filter(u8::is_ascii_digit).count()
}

impl Expectation {
    /// The tables that it names, as it names them.
    pub fn tables(&self) -> Vec<String> {
        let mut found = Vec::new();
        self.each(&mut |part| {
            if let ExpressionKind::Call(Call { function, arguments, .. }) = &part.kind
                && function.node == "table"
                && let Some(ExpressionKind::Text(named)) = arguments.first().map(|argument| &argument.value.kind)
            {
                found.push(named.clone());
            }
        });
        found
    }

    /// Whether it may be meant for the values that the job has alone: it names a table, compares with numbers alone, or with one that
    /// somebody worked out.
    pub fn is_of_values(&self) -> bool {
        let has_name = |part: &Expression| {
            let mut found = false;
            part.each(&mut |inner| found |= matches!(inner.kind, ExpressionKind::Path(_)));
            found
        };
        let is_worked_out = |part: &Expression| {
            let mut found = false;
            part.each(&mut |inner| {
                found |= matches!(inner.kind, ExpressionKind::Number(value, _) if digits(value) >= WORKED_OUT);
            });
            found
        };
        let is_of_numbers = match &self.what {
            Expected::Near { value, target, .. } => !has_name(target) || is_worked_out(value) || is_worked_out(target),
            Expected::InRange { range: Range { low, high, .. }, .. } => {
                [low, high].into_iter().all(|end| !has_name(end)) || [low, high].into_iter().any(is_worked_out)
            }
            Expected::Status { at, .. } => at.as_ref().is_some_and(|at| !has_name(at)),
            _ => false,
        };
        is_of_numbers || !self.tables().is_empty()
    }

    /// Shows all expressions of it.
    pub(crate) fn each<'e>(&'e self, show: &mut impl FnMut(&'e Expression)) {
        let mut parts: Vec<&'e Expression> = Vec::new();
        match &self.what {
            Expected::Error(_) | Expected::Nothing | Expected::Travel => {}
            Expected::On { machine, within } => {
                parts.extend(machine.settings.iter().map(|setting| &setting.value));
                parts.push(within);
            }
            Expected::Status { at, .. } => parts.extend(at),
            Expected::Near { value, target, within, .. } => parts.extend([value, target, within]),
            Expected::InRange { value, range, .. } => parts.extend([value, &range.low, &range.high]),
            Expected::Pose { transforms, at, within, .. } => {
                parts.extend(transforms.iter().flat_map(|call| call.arguments.iter().map(|argument| &argument.value)));
                parts.extend(at.iter().map(|argument| &argument.value));
                parts.extend(within);
            }
        }
        parts.into_iter().for_each(|part| part.each(show));
    }
}
