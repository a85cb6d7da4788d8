//! What a checked text means, all symbolic.

mod contact;
mod machine;
mod milling;
mod sample;
mod solid;
mod surface;

use std::path::PathBuf;

use flank_expr::Expr;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::job::expect::model::Expectation;
use crate::values::dimension::Dimension;
use crate::values::steel_side::SteelSide;

pub use contact::{Contact, ContactCondition, ContactQuantity, MountingAxis, WantedContact};
pub(crate) use machine::path;
pub use machine::{Axis, Frame, LawSource, Machine, NcWord};
pub use milling::{BlockLength, CutterPiece, MilledArea, Milling, MillingClearance, MillingObstacle, PassSpacing};
pub use sample::{Coordinate, PointRequirement, Sample, SampleEnds, SampleGrid};
pub use solid::{OutlineCurve, OutlineSegment, Solid, SolidForm};
pub use surface::{GeneratedSurface, Generation, Process, ToolShape};

/// One job, ready to be solved: its parameters are variables with values beside them.
#[derive(Clone, Debug)]
pub struct Job<'g> {
    /// Its name.
    pub name: String,
    /// Its doc comment.
    pub doc: Vec<String>,
    /// The file that it stands in.
    pub file: PathBuf,
    /// Where its name is written; that of the machine where it is one by itself.
    pub written: Span,
    /// Job parameters and settings of its machines and tools, each after those that its value depends on.
    pub parameters: Vec<Parameter<'g>>,
    /// All settings of a machine that stands by itself ([`compile_with_machine`](crate::compile_with_machine)), with the ranges that
    /// they may have, endless where none is stated. Those without a value are not among the parameters.
    pub settings: Vec<RangedVariable<'g>>,
    /// What moves.
    pub motions: Vec<RangedVariable<'g>>,
    /// Its machines.
    pub machines: Vec<Machine<'g>>,
    /// Its surfaces, in order.
    pub surfaces: Vec<GeneratedSurface<'g>>,
    /// Those of its motions that a contact determines.
    pub unknowns: Vec<Expr<'g>>,
    /// Bodies that its surfaces bound.
    pub solids: Vec<Solid>,
    /// Flanks that roll on each other.
    pub contacts: Vec<Contact<'g>>,
    /// What contacts shall be like.
    pub wants: Vec<WantedContact>,
    /// Surfaces that are milled.
    pub millings: Vec<Milling<'g>>,
    /// What it is tested by, if that was asked for ([`Request::whole`](crate::Request::whole)).
    pub expectations: Vec<Expectation<'g>>,
    /// Of its parameters those from whose values numbers of it follow that it does not hold as functions of them, also by way of what they
    /// are given to: ends of ranges, points that are asked for or that a spline goes through, which branch of an `if` counts. With other
    /// values of the others it is the same job, as long as steel stays on its side.
    pub decisive: Vec<Expr<'g>>,
    /// On which side of each surface of its tools the steel lies.
    pub steel_sides: Vec<SteelSide<'g>>,
}

/// A named constant of a job.
#[derive(Clone, Debug)]
pub struct Parameter<'g> {
    /// `ratio`, `m.radial_distance`.
    pub name: String,
    /// The variable that stands for it.
    pub variable: Expr<'g>,
    /// Its dimension.
    pub dimension: Dimension,
    /// Its value as an expression in earlier parameters.
    pub definition: Expr<'g>,
    /// Its value, mm or radians.
    pub value: f64,
    /// The value that the text gives it, with those of the others as they are: the same, unless the caller gives it another one. NaN where the
    /// text gives it none.
    pub value_in_text: f64,
    /// Whether it counts something: then it is a whole number and has no derivative.
    pub is_count: bool,
    /// Whether it says how a machine differs from the nominal one, in which it is zero.
    pub is_error: bool,
    /// Between which values it must lie, if that is stated.
    pub range: Option<(f64, f64)>,
    /// What it is set in multiples of, mm or radians, if that is stated.
    pub step: Option<f64>,
    /// Its doc comment.
    pub doc: Vec<String>,
    /// Who gives it its value.
    pub given_by: ValueSource,
    /// Where that value is written.
    pub written: Span,
}

/// Who gives a parameter its value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ValueSource {
    /// The machine or tool of this name, whose own value it is where nobody gives another one.
    Definition(String),
    /// The job.
    Job,
    /// The caller, from outside the text.
    Caller,
}

/// A variable that is looked for in a range.
#[derive(Clone, Debug)]
pub struct RangedVariable<'g> {
    /// Its name.
    pub name: String,
    /// The variable.
    pub variable: Expr<'g>,
    /// Its dimension.
    pub dimension: Dimension,
    /// Lower end, mm or radians.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether it counts something: on the machine it takes whole numbers only.
    pub is_count: bool,
    /// Of the run over a piece of a tool's profile: what the profile goes on with beyond.
    pub piece: Option<PieceEnds>,
}

/// A piece of a profile between the two that it neighbours.
#[derive(Clone, Debug)]
pub struct PieceEnds {
    /// Its name.
    pub name: String,
    /// The pieces before and behind it; `None` where the profile ends.
    pub beside: [Option<String>; 2],
}

/// What a name from outside says behind the name of a job: `m.swivel` of `gear.m.swivel`.
pub(crate) fn within<'n>(name: &'n str, job: &str) -> Option<&'n str> {
    name.strip_prefix(job)?.strip_prefix('.')
}

impl<'g> Job<'g> {
    /// What is said of a job without a sample where its points are asked for.
    #[must_use]
    pub fn asks_for_nothing(&self) -> Diagnostic {
        let message = format!("job `{}` asks for no points: none of its surfaces has a `sample`", self.name);
        let help = match &self.surfaces[..] {
            [] => "make a surface, and say by a `sample` of it which points are wanted".to_string(),
            [first, ..] => format!("say which points are wanted: `sample {} {{ … }}`", first.name),
        };
        Diagnostic::new(Code::SampleShape, self.written, message).help(help)
    }

    /// Whether it has a parameter or setting that is given from outside by such a name: `m.swivel`, or with the job's own name before
    /// it.
    pub fn has_parameter(&self, name: &str) -> bool {
        let has = |name: &str| self.parameters.iter().any(|parameter| parameter.name == name);
        has(name) || within(name, &self.name).is_some_and(has)
    }

    /// Each parameter's variable with its value as a number: what to substitute before solving.
    pub fn bindings(&self) -> Vec<(Expr<'g>, Expr<'g>)> {
        self.parameters
            .iter()
            .map(|parameter| (parameter.variable, parameter.variable.graph().constant(parameter.value)))
            .collect()
    }

    /// The same while some parameters are open: what depends on them is what it is in terms of them.
    pub fn bindings_beside(&self, open: &[Expr<'g>]) -> Vec<(Expr<'g>, Expr<'g>)> {
        let mut bindings: Vec<(Expr<'g>, Expr<'g>)> = Vec::new();
        for parameter in self.parameters.iter().filter(|parameter| !open.contains(&parameter.variable)) {
            let value = parameter.variable.graph().substitute(&[parameter.definition], &bindings)[0];
            bindings.push((parameter.variable, value));
        }
        bindings
    }
}
