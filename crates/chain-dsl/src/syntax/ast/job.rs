//! What a job says, and its variants.

use super::{
    Argument, EachSide, Expectation, Expression, ExpressionKind, Let, Param, Parameter, Path, Profile, Range,
    Requirement,
};
use crate::diagnostics::source::{Name, Span};

/// A job: machine, tool, motions, the surfaces asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name.
    pub name: Name,
    /// The job that it is a variant of.
    pub extends: Option<Name>,
    /// What it changes of that one before it says more.
    pub changes: Vec<Change>,
    /// Statements in order.
    pub statements: Vec<JobStatement>,
    /// From `job` to the closing brace.
    pub span: Span,
    /// Whether it has that brace.
    pub is_closed: bool,
}

impl Job {
    /// Whether a `sample` without a name of its own is about this surface or piece.
    pub(crate) fn samples(&self, surface: &str) -> bool {
        self.statements.iter().any(|statement| match statement {
            JobStatement::Sample(sample) => {
                sample.surfaces.iter().any(|of| of.name.is_none() && of.surface.joined() == surface)
            }
            _ => false,
        })
    }

    /// Its own parameters.
    pub(crate) fn params(&self) -> Vec<&Param> {
        let each = self.statements.iter().map(|statement| match statement {
            JobStatement::Param(param) => Some(param),
            _ => None,
        });
        each.flatten().collect()
    }

    /// Shows the parts of all expressions but of those that it is tested by, in the order in which they are evaluated.
    pub(crate) fn each<'e>(&'e self, show: &mut impl FnMut(&'e Expression)) {
        let turn = |statement: &JobStatement| match statement {
            JobStatement::Drive(_) => 1,
            JobStatement::Surface(_) => 2,
            JobStatement::Solid(_) | JobStatement::Contact(_) | JobStatement::Want(_) | JobStatement::Sample(_) => 3,
            JobStatement::Mill(_) => 4,
            _ => 0,
        };
        for now in 0..=4 {
            self.statements.iter().filter(|statement| turn(statement) == now).for_each(|statement| {
                statement.expressions().into_iter().for_each(|expression| expression.each(show));
            });
        }
    }
}

/// A job that is another one with values or parts changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name.
    pub name: Name,
    /// The job that it is made from.
    pub parent: Name,
    /// What is changed.
    pub changes: Vec<Change>,
}

/// `ratio: value`, `m.swivel: value`, `c: definition(setting: value)`
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// A parameter, a setting of a machine or tool, or a machine or tool.
    pub target: Path,
    /// What takes its place.
    pub value: Expression,
}

/// A statement in a job.
#[derive(Clone, Debug, PartialEq)]
pub enum JobStatement {
    /// `param name : dimension = …`
    Param(Param),
    /// `let name = …`
    Let(Let),
    /// `machine m = definition(setting: value, …)`
    Machine(Instance),
    /// `tool c = definition(setting: value, …)`
    Tool(Instance),
    /// `mount c on m.cutter`, `mount flank, coast on m.pinion`
    Mount {
        /// Tools, or surfaces that the job makes.
        names: Vec<Name>,
        /// The frame.
        frame: Path,
    },
    /// `motion roll : angle in a .. b`
    Motion(Parameter),
    /// `unknown lag : angle in a .. b`
    Unknown(Parameter),
    /// `drive m.X, m.Z = …, …`
    Drive(Drive),
    /// `surface name, other in m.work = …`
    Surface(GeneratedSurface),
    /// `trim flank by fillet`
    Trim {
        /// The surface that loses points.
        surface: Path,
        /// The surface that cuts them away.
        by: Path,
    },
    /// `cut flank by edges`
    Cut {
        /// The ideal surface.
        surface: Path,
        /// The sweep of the edges that cut it.
        by: Path,
    },
    /// `profile blank { … }`
    Profile(Profile),
    /// `solid pinion in m.work = turned(blank, spaces: 19, of: [left, right])`
    Solid(Solid),
    /// `contact drive_side = left with right, over: turn, for: lag`
    Contact(Contact),
    /// `want centred in drive_side = vertex(z: 21 mm, rho: 106 mm)`
    Want(Want),
    /// `mill finish of flank with e.cutting in m.work { … }`
    Mill(Mill),
    /// `sample name, other { … }`
    Sample(Sample),
    /// `require a < b, "…"`
    Require(Requirement),
    /// `expect all solved`
    Expect(Expectation),
}

/// Keeps those that stay; there may be more, or fewer, in a text with mistakes.
fn retain<T>(all: &mut Vec<T>, is_left: &[bool]) {
    let mut left = is_left.iter();
    all.retain(|_| left.next().copied().unwrap_or(true));
}

/// `name = definition(setting: value, …)`
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// The name in the job.
    pub name: Name,
    /// The machine or tool.
    pub definition: Name,
    /// Settings by name.
    pub settings: Vec<Argument>,
}

impl JobStatement {
    /// What it is about, each in one statement of a job: names, axes, surfaces. Nothing of those that a job may have any number of.
    pub(crate) fn about(&self) -> Vec<(Subject, String)> {
        let defined = |name: &Name| vec![(Subject::Name, name.node.clone())];
        match self {
            JobStatement::Param(param) => defined(&param.name),
            JobStatement::Let(binding) => defined(&binding.name),
            JobStatement::Machine(instance) | JobStatement::Tool(instance) => defined(&instance.name),
            JobStatement::Motion(motion) | JobStatement::Unknown(motion) => defined(&motion.name),
            JobStatement::Profile(profile) => defined(&profile.name),
            JobStatement::Solid(solid) => defined(&solid.name),
            JobStatement::Contact(contact) => defined(&contact.name),
            JobStatement::Want(want) => defined(&want.name),
            JobStatement::Mill(mill) => defined(&mill.name),
            JobStatement::Surface(surface) => surface.names.iter().flat_map(defined).collect(),
            JobStatement::Mount { names, .. } => {
                names.iter().map(|name| (Subject::Mounted, name.node.clone())).collect()
            }
            JobStatement::Drive(drive) => drive.targets.iter().map(|axis| (Subject::Axis, axis.joined())).collect(),
            JobStatement::Sample(sample) => sample.surfaces.iter().map(Sampled::about).collect(),
            JobStatement::Trim { .. }
            | JobStatement::Cut { .. }
            | JobStatement::Require(_)
            | JobStatement::Expect(_) => Vec::new(),
        }
    }

    /// What is left of it without what it says of some things; nothing if it was about nothing else.
    pub(crate) fn without(mut self, is_one: impl Fn(&(Subject, String)) -> bool) -> Option<JobStatement> {
        let is_left: Vec<bool> = self.about().iter().map(|about| !is_one(about)).collect();
        if !is_left.is_empty() && !is_left.contains(&true) {
            return None;
        }
        match &mut self {
            JobStatement::Surface(surface) => {
                if let ExpressionKind::Call(call) = &mut surface.value.kind {
                    let mut left = is_left.iter();
                    call.arguments.retain(|argument| argument.name.is_some() || left.next().copied().unwrap_or(true));
                }
                retain(&mut surface.names, &is_left);
            }
            JobStatement::Mount { names, .. } => retain(names, &is_left),
            JobStatement::Drive(drive) => {
                retain(&mut drive.targets, &is_left);
                retain(&mut drive.values, &is_left);
            }
            JobStatement::Sample(sample) => {
                retain(&mut sample.surfaces, &is_left);
                sample.each.iter_mut().for_each(|each| retain(&mut each.values, &is_left));
            }
            // about one thing, or none
            _ => {}
        }
        Some(self)
    }

    /// How many statements about one thing each it stands for.
    pub(crate) fn size(&self) -> usize {
        match self {
            JobStatement::Drive(drive) => drive.targets.len().max(drive.values.len()),
            JobStatement::Surface(surface) => surface.names.len(),
            JobStatement::Sample(sample) => sample.surfaces.len(),
            _ => 1,
        }
    }
}

impl JobStatement {
    /// The expressions in it; of what the job is tested by none.
    fn expressions(&self) -> Vec<&Expression> {
        fn values(arguments: &[Argument]) -> Vec<&Expression> {
            arguments.iter().map(|argument| &argument.value).collect()
        }
        match self {
            JobStatement::Param(param) => {
                let range = param.range.iter().flat_map(Range::ends);
                range.chain(&param.step).chain(&param.default).collect()
            }
            JobStatement::Let(binding) => vec![&binding.value],
            JobStatement::Require(required) => vec![&required.condition],
            JobStatement::Machine(instance) | JobStatement::Tool(instance) => values(&instance.settings),
            JobStatement::Motion(motion) | JobStatement::Unknown(motion) => motion.range.ends().to_vec(),
            JobStatement::Profile(profile) => profile.segments.iter().map(|segment| &segment.value).collect(),
            JobStatement::Solid(solid) => vec![&solid.value],
            JobStatement::Contact(contact) => values(&contact.arguments),
            JobStatement::Want(want) => vec![&want.value],
            JobStatement::Drive(drive) => drive.values.iter().collect(),
            JobStatement::Surface(surface) => vec![&surface.value],
            JobStatement::Mill(mill) => mill.expressions(),
            JobStatement::Sample(sample) => sample.expressions(),
            JobStatement::Mount { .. }
            | JobStatement::Trim { .. }
            | JobStatement::Cut { .. }
            | JobStatement::Expect(_) => Vec::new(),
        }
    }
}

impl Mill {
    fn expressions(&self) -> Vec<&Expression> {
        let runs = self.passes.iter().chain(&self.sides).chain(&self.along);
        let runs = runs.flat_map(|run| run.definition.iter().chain(run.range.ends()).chain([&run.value]));
        let attitudes = self.attitudes.iter().map(|(_, value)| value);
        runs.chain(attitudes).chain(self.clearances.iter().map(|clear| &clear.distance)).collect()
    }
}

impl Sample {
    fn expressions(&self) -> Vec<&Expression> {
        let entries = self.entries.iter().flat_map(|entry| {
            let values = match &entry.values {
                SampleValues::Value(value) => vec![value],
                SampleValues::Range(range, by) => [&range.ends()[..], &[by]].concat(),
            };
            entry.definition.iter().chain(values)
        });
        let keeps = self.keeps.iter().chain(self.limits.iter().map(|limit| &limit.within));
        let keeps = keeps.flat_map(|keep| keep.definition.iter().chain(keep.range.ends()));
        self.each.iter().flat_map(|each| &each.values).chain(entries).chain(keeps).collect()
    }
}

/// `solid name in frame = turned(…)`
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name.
    pub name: Name,
    /// The frame that it stands in.
    pub frame: Path,
    /// `turned(blank, spaces: 19, of: [left, right])`
    pub value: Expression,
}

/// `want name in contact = vertex(…)`
#[derive(Clone, Debug, PartialEq)]
pub struct Want {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name.
    pub name: Name,
    /// The contact that it is about.
    pub contact: Path,
    /// `vertex(z: 21 mm, rho: 106 mm, path: 30 deg)`
    pub value: Expression,
}

/// `contact name = first with second, over: turn, for: lag`
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name.
    pub name: Name,
    /// The two flanks.
    pub surfaces: [Path; 2],
    /// `over`, `for`, `every`.
    pub arguments: Vec<Argument>,
}

/// `drive target, target = value, value`
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// The axes.
    pub targets: Vec<Path>,
    /// Their laws, in the same order.
    pub values: Vec<Expression>,
}

/// `surface name, name in frame = value`
#[derive(Clone, Debug, PartialEq)]
pub struct GeneratedSurface {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// The names, one for each surface that it is made from.
    pub names: Vec<Name>,
    /// The frame that they are given in.
    pub frame: Path,
    /// `envelope(c.flank, c.fillet, over: roll)`
    pub value: Expression,
}

/// `sample name, name as other { key: values … }`
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// The surfaces, perhaps pieces of them.
    pub surfaces: Vec<Sampled>,
    /// `for side in [1, -1]`: what has another value for each of them.
    pub each: Option<EachSide>,
    /// What is asked for of each, in order.
    pub entries: Vec<SampleEntry>,
    /// Which branch is meant.
    pub keeps: Vec<Keep>,
    /// What its points must fulfil.
    pub limits: Vec<PointRequirement>,
    /// The whole statement.
    pub span: Span,
}

/// `name`, or `name as other` for one more sample of a surface
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled {
    /// The surface, perhaps a piece of it.
    pub surface: Path,
    /// What it is called with this sample.
    pub name: Option<Name>,
}

impl Sampled {
    fn about(&self) -> (Subject, String) {
        match &self.name {
            Some(name) => (Subject::Sample, name.node.clone()),
            None => (Subject::Sampled, self.surface.joined()),
        }
    }
}

/// What a statement says something about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Subject {
    /// What it gives a name to.
    Name,
    /// What it mounts.
    Mounted,
    /// What it drives.
    Axis,
    /// What it asks for points of.
    Sampled,
    /// The name of a sample beside that of its surface: it takes the place of no value, surface or machine of that name.
    Sample,
}

/// `key: a .. b by n`, `key: [a, b]`, or `key: value`
#[derive(Clone, Debug, PartialEq)]
pub struct SampleEntry {
    /// A coordinate (`z`, `rho`), an unknown, a corner of the outline, or the name of a coordinate defined here.
    pub key: Name,
    /// What it is, if it is defined here: `height = z * cos(root_angle): 1 mm .. 5 mm by 9`.
    pub definition: Option<Expression>,
    /// Its values.
    pub values: SampleValues,
}

/// `keep key: a .. b`, a function of the points and a range of it
#[derive(Clone, Debug, PartialEq)]
pub struct Keep {
    /// A coordinate, an unknown, or the name of a coordinate defined here.
    pub key: Name,
    /// What it is, if it is defined here.
    pub definition: Option<Expression>,
    /// Where it lies: on the branch that is meant, or at every point.
    pub range: Range,
}

/// `require key: a .. b, "message"`
#[derive(Clone, Debug, PartialEq)]
pub struct PointRequirement {
    /// A function of the points and where it must lie.
    pub within: Keep,
    /// The message about points where it does not.
    pub message: String,
}

/// The values of a sample entry.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // there are few of them
pub enum SampleValues {
    /// `a .. b by n`
    Range(Range, Expression),
    /// One value, or a vector: several values, or a point.
    Value(Expression),
}

/// `mill name of surface with cutter in frame { … }`
#[derive(Clone, Debug, PartialEq)]
pub struct Mill {
    /// `///` lines above it.
    pub doc: Vec<String>,
    /// Its name.
    pub name: Name,
    /// The surface that is milled.
    pub surface: Path,
    /// The surface of the cutter that touches it.
    pub cutter: Path,
    /// The frame of the milling machine in which the work is clamped.
    pub frame: Path,
    /// `passes profilewise: 0 .. 1, scallop 2 um`
    pub passes: Vec<MillRun>,
    /// `side profilewise: 0 .. 1 by 8`
    pub sides: Vec<MillRun>,
    /// `along lengthwise: 0 .. 1, chord 0.5 um`
    pub along: Vec<MillRun>,
    /// `lead`, `tilt`, `stock`, each with its value.
    pub attitudes: Vec<(Name, Expression)>,
    /// Where `both ways` stands.
    pub both_ways: Vec<Span>,
    /// `clear of other by 0.2 mm with e.whole`
    pub clearances: Vec<MillClearance>,
    /// Whether something in it could not be read, which has been reported.
    pub broken: bool,
}

/// `name: range, word value`
#[derive(Clone, Debug, PartialEq)]
pub struct MillRun {
    /// A coordinate.
    pub key: Name,
    /// What it is, if it is defined here.
    pub definition: Option<Expression>,
    /// Its values.
    pub range: Range,
    /// `scallop`, `step`, `chord` or `by`.
    pub word: Name,
    /// A height, a distance or a number.
    pub value: Expression,
}

/// `clear of surface by distance with body`
#[derive(Clone, Debug, PartialEq)]
pub struct MillClearance {
    /// The surface that is kept clear of.
    pub surface: Path,
    /// How far.
    pub distance: Expression,
    /// The surface of the cutter.
    pub body: Path,
}
