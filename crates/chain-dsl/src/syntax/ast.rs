//! What a file says, before anybody asks what it means. Every node knows its place.
//!
//! After a mistake, a value may be [`ExpressionKind::Error`] and a name the empty string (a frame's parent, a dimension, a
//! definition that is not there): both have been reported, and whoever meets one says nothing.

mod expectation;
mod job;

use crate::diagnostics::source::{Name, Span, Spanned};

pub use expectation::{Expectation, Expected};
pub(crate) use job::Subject;
pub use job::{
    Change, Contact, Drive, GeneratedSurface, Instance, Job, JobStatement, Keep, Mill, MillClearance, MillRun,
    PointRequirement, Sample, SampleEntry, SampleValues, Sampled, Solid, Variant, Want,
};

/// One parsed file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct File {
    /// `//!` lines at the top, without the marks.
    pub doc: Vec<String>,
    /// The items in order.
    pub items: Vec<Item>,
    /// Whether it uses a file whose path could not be read, which is reported.
    pub lacks_files: bool,
}

/// A top-level item.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// `use "path"`
    Use(Spanned<String>),
    /// `fn name(a: length) -> angle = …`
    Function(Function),
    /// `machine name extends other { … }`
    Machine(Machine),
    /// `tool name { … }`
    Tool(Tool),
    /// `job name { … }`
    Job(Job),
    /// `job name = other(setting: value)`
    Variant(Variant),
}

impl Item {
    /// The name that it defines; a `use` defines none.
    pub fn name(&self) -> Option<&Name> {
        match self {
            Item::Use(_) => None,
            Item::Function(function) => Some(&function.name),
            Item::Machine(machine) => Some(&machine.name),
            Item::Tool(tool) => Some(&tool.name),
            Item::Job(job) => Some(&job.name),
            Item::Variant(variant) => Some(&variant.name),
        }
    }
}

/// A function of the user.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name.
    pub name: Name,
    /// Its arguments with their types.
    pub arguments: Vec<(Name, Type)>,
    /// The type it promises, if it does.
    pub result: Option<Type>,
    /// `let`s of the block form.
    pub lets: Vec<Let>,
    /// The value.
    pub body: Expression,
}

/// What an argument or the value of a function is: `length`, `length[3]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Type {
    /// The dimension, of each element for a vector.
    pub dimension: Dimension,
    /// The number of elements of a vector.
    pub size: Option<usize>,
    /// All of it.
    pub span: Span,
}

/// A machine: parameters, axes, frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name.
    pub name: Name,
    /// The machine it is a variant of.
    pub extends: Option<Name>,
    /// Statements in order.
    pub statements: Vec<MachineStatement>,
    /// From `machine` to the closing brace.
    pub span: Span,
}

/// A statement in a machine.
#[derive(Clone, Debug, PartialEq)]
pub enum MachineStatement {
    /// `param name : dimension …`, or `error name : dimension …`
    Param(Param),
    /// `let name = …`
    Let(Let),
    /// `axis X : linear in a .. b`
    Axis(Axis),
    /// `frame name in parent = transform …`
    Frame(Frame),
    /// `insert name in parent = transform …`: a frame between another one and all that hangs on it.
    Insert(Frame),
    /// `close tip = pin along x, y about z`: frames that are one in these components, whatever moves.
    Close(Close),
    /// `fix A = …`: an axis that stands still.
    Fix(Assignment),
    /// `couple C = …`: an axis that follows others.
    Couple(Assignment),
    /// `nc A1 = -A by 0.001 deg`: what an NC program says of an axis.
    Nc(NcWord),
    /// `require a < b, "…"`
    Require(Requirement),
    /// `expect tool in work near translate(…) at (X: 10 mm) within 1 um, 1 arcsec`
    Expect(Expectation),
}

/// `param name : dimension in a .. b step c = default`
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name.
    pub name: Name,
    /// Its dimension.
    pub dimension: Dimension,
    /// Allowed values.
    pub range: Option<Range>,
    /// What it is set in multiples of.
    pub step: Option<Expression>,
    /// Value where none is given.
    pub default: Option<Expression>,
    /// Whether it is an error of a machine: zero where none is given.
    pub is_error: bool,
}

/// `let name = value`
#[derive(Clone, Debug, PartialEq)]
pub struct Let {
    /// Its name.
    pub name: Name,
    /// Its value.
    pub value: Expression,
}

/// `axis X : linear in a .. b`
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// ISO 841 letter or a word.
    pub name: Name,
    /// Linear or rotary.
    pub kind: AxisKind,
    /// Where that is said; the name where it is not.
    pub kind_span: Span,
    /// Travel.
    pub range: Option<Range>,
    /// `unknown X : …`: closed loops give its motion.
    pub is_unknown: bool,
}

/// `close tip = pin along x, y about z keep rod: 0 deg .. 80 deg`
#[derive(Clone, Debug, PartialEq)]
pub struct Close {
    /// The frame at the end of one chain.
    pub first: Name,
    /// The frame at the end of the other one, which coincides with it.
    pub second: Name,
    /// Axes, of the frame that both hang on, along which the origins do not lie apart; all, if neither list is written.
    pub along: Vec<Name>,
    /// Axes about which the frames are not turned.
    pub about: Vec<Name>,
    /// Where unknown axes are in the branch that is meant.
    pub keeps: Vec<KeptAxis>,
}

/// `keep rod: 0 deg .. 80 deg`, in a closed loop
#[derive(Clone, Debug, PartialEq)]
pub struct KeptAxis {
    /// An unknown axis that the loop gives.
    pub name: Name,
    /// Where it is.
    pub range: Range,
}

/// How an axis moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisKind {
    /// Along a line: a length.
    Linear,
    /// About a line: an angle.
    Rotary,
    /// One of the two, which could not be read (and that is reported).
    Unknown,
}

/// `nc ADDRESS = value by increment`
#[derive(Clone, Debug, PartialEq)]
pub struct NcWord {
    /// Letter, perhaps with a number, that the axis has in programs.
    pub address: Name,
    /// The number behind it, made of the axis.
    pub value: Expression,
    /// The step in which it is written.
    pub increment: Option<Expression>,
}

/// `frame name in parent = transform …`; the root has neither parent nor transforms.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name.
    pub name: Name,
    /// The frame it hangs on.
    pub parent: Option<Name>,
    /// Calls, read from parent to child, each in the moving frame.
    pub transforms: Vec<Call>,
}

/// `target = value`
#[derive(Clone, Debug, PartialEq)]
pub struct Assignment {
    /// What gets the value.
    pub target: Path,
    /// The value.
    pub value: Expression,
}

/// A tool: parameters and surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Tool {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name.
    pub name: Name,
    /// Statements in order.
    pub statements: Vec<ToolStatement>,
}

/// A statement in a tool.
#[derive(Clone, Debug, PartialEq)]
pub enum ToolStatement {
    /// `param name : dimension …`
    Param(Param),
    /// `let name = …`
    Let(Let),
    /// `profile name { … }`
    Profile(Profile),
    /// `surface name(u: length in a .. b, …) { … }`
    Surface(ToolSurface),
    /// `require a < b, "…"`
    Require(Requirement),
}

/// A plane line of a tool, made of segments that one length runs over.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name.
    pub name: Name,
    /// Its segments in order.
    pub segments: Vec<Segment>,
    /// Whether something in it did not parse.
    pub broken: bool,
}

/// `name = line(from: [x, y], to: [x, y])`, `arc(…)` or `spline(…)`
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name.
    pub name: Name,
    /// What it is.
    pub value: Expression,
}

/// A parametric surface of a tool.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolSurface {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name, or those of all its sides.
    pub names: Vec<Name>,
    /// Its parameters with their ranges.
    pub parameters: Vec<SurfaceParameter>,
    /// `for side in [1, -1]`: what has another value for each of the names.
    pub each: Option<EachSide>,
    /// `let`s in order.
    pub lets: Vec<Let>,
    /// `at = [x, y, z]`
    pub at: Expression,
    /// `body …`
    pub body: Body,
}

/// `for side in [1, -1]`
#[derive(Clone, Debug, PartialEq)]
pub struct EachSide {
    /// The name that stands for the values.
    pub name: Name,
    /// One for each surface.
    pub values: Vec<Expression>,
    /// Where they are written.
    pub span: Span,
}

/// A parameter of a tool's surface.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // there are few of them
pub enum SurfaceParameter {
    /// `name : dimension in a .. b`
    Within(Parameter),
    /// `name : along profile`
    Along(Name, Name),
}

impl SurfaceParameter {
    /// Its name.
    pub fn name(&self) -> &Name {
        match self {
            SurfaceParameter::Within(parameter) => &parameter.name,
            SurfaceParameter::Along(name, _) => name,
        }
    }
}

/// `name : dimension in a .. b`: a surface parameter or a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name.
    pub name: Name,
    /// Its dimension.
    pub dimension: Dimension,
    /// Where it is looked for.
    pub range: Range,
}

/// Which side of a tool surface is steel.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// The side.
    pub side: Side,
    /// `body …`
    pub span: Span,
}

/// A side of a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Side {
    /// Towards the z axis of the tool.
    Inside,
    /// Away from the z axis of the tool.
    Outside,
    /// `body towards [x, y, z]`: the side to which this direction points.
    Towards(Expression),
    /// `body where x^2 + y^2 < r^2`: where this holds of three parameters; the surface is its border.
    Where(Expression),
}

/// `require condition, "message"`: what must hold of the values, and the message if it does not.
#[derive(Clone, Debug, PartialEq)]
pub struct Requirement {
    /// The condition.
    pub condition: Expression,
    /// In the words of the one who wrote it.
    pub message: String,
}

/// `low .. high`
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: Expression,
    /// Upper end.
    pub high: Expression,
    /// Both ends.
    pub span: Span,
}

impl Range {
    /// Its ends, the lower one first.
    pub(crate) fn ends(&self) -> [&Expression; 2] {
        [&self.low, &self.high]
    }
}

/// A dimension as written, `length * angle / number`, reduced to a product of named powers.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// Names with their exponents; names are checked later.
    pub factors: Vec<(Name, i32)>,
    /// All of it.
    pub span: Span,
}

impl Dimension {
    /// Whether it is that of something that is counted.
    pub(crate) fn is_count(&self) -> bool {
        matches!(self.factors.as_slice(), [(name, 1)] if name.node == "count")
    }
}

/// `a.b.c`
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// At least one.
    pub segments: Vec<Name>,
    /// From the first to the last.
    pub span: Span,
}

impl Path {
    /// With its dots: `m.swivel`.
    pub(crate) fn joined(&self) -> String {
        self.segments.iter().map(|segment| segment.node.as_str()).collect::<Vec<_>>().join(".")
    }
}

/// `name(…)`
#[derive(Clone, Debug, PartialEq)]
pub struct Call {
    /// The function.
    pub function: Name,
    /// Its arguments.
    pub arguments: Vec<Argument>,
    /// From the name to the closing parenthesis.
    pub span: Span,
}

/// `value`, or `name: value`
#[derive(Clone, Debug, PartialEq)]
pub struct Argument {
    /// Its name if it is named.
    pub name: Option<Name>,
    /// Its value.
    pub value: Expression,
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    /// What it is.
    pub kind: ExpressionKind,
    /// Where.
    pub span: Span,
}

impl Expression {
    /// Shows the expression and all that it is made of, from left to right.
    pub(crate) fn each<'e>(&'e self, show: &mut impl FnMut(&'e Expression)) {
        show(self);
        match &self.kind {
            ExpressionKind::Number(..) | ExpressionKind::Text(_) | ExpressionKind::Path(_) | ExpressionKind::Error => {}
            ExpressionKind::Call(call) => call.arguments.iter().for_each(|argument| argument.value.each(show)),
            ExpressionKind::Vector(parts) => parts.iter().for_each(|part| part.each(show)),
            ExpressionKind::Unary(_, a) => a.each(show),
            ExpressionKind::Index(a, b) | ExpressionKind::Binary(_, a, b) => {
                [a, b].into_iter().for_each(|part| part.each(show))
            }
            ExpressionKind::If(a, b, c) => [a, b, c].into_iter().for_each(|part| part.each(show)),
            ExpressionKind::Bound(bound) => {
                [&bound.range.low, &bound.range.high, &bound.value].into_iter().for_each(|part| part.each(show));
            }
        }
    }

    /// What the elements of a value that is a vector of this length are written as: itself for each, unless it is written as
    /// a vector.
    pub(crate) fn parts(&self, length: usize) -> Vec<&Expression> {
        match &self.kind {
            ExpressionKind::Vector(parts) if parts.len() == length => parts.iter().collect(),
            _ => vec![self; length],
        }
    }
}

/// Kinds of expressions.
#[derive(Clone, Debug, PartialEq)]
pub enum ExpressionKind {
    /// `20`, `20 mm`, `2 mm/rev`: the number and the units with their exponents, as written.
    Number(f64, Vec<(Name, i32)>),
    /// `"text"`
    Text(String),
    /// `a`, `m.work`
    Path(Path),
    /// `f(x, over: y)`
    Call(Call),
    /// `[a, b, c]`
    Vector(Vec<Expression>),
    /// `v[0]`
    Index(Box<Expression>, Box<Expression>),
    /// `-a`, `not a`
    Unary(Spanned<UnaryOperator>, Box<Expression>),
    /// `a + b`, `a <= b`, `a and b`
    Binary(Spanned<BinaryOperator>, Box<Expression>, Box<Expression>),
    /// `if condition then a else b`
    If(Box<Expression>, Box<Expression>, Box<Expression>),
    /// `k in a .. b: value`, the argument of a call such as `sum`
    Bound(Box<Bound>),
    /// Something that did not parse; reported already.
    Error,
}

/// `name in low .. high: value`: a value for each value of a name that means something only within it.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// The name.
    pub name: Name,
    /// Where it runs.
    pub range: Range,
    /// The value, which may use the name.
    pub value: Expression,
}

/// Operators before one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnaryOperator {
    /// `-a`
    Negate,
    /// `not a`
    Not,
}

/// Operators between two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // each is its name
pub enum BinaryOperator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
    And,
    Or,
}
