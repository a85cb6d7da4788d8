//! What operations say beside their numbers, as data.

use std::fmt;

use schemars::JsonSchema;
use serde::Serialize;

use crate::project::findings::Place;

/// A message of an operation about one thing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[schemars(rename = "{Kind}Message")]
pub struct Message<Kind> {
    /// What kind of message it is.
    pub kind: Kind,
    /// The surface, axis, setting, machine or job that it is about, if it is about one.
    pub of: Option<String>,
    /// Where the spec names that, for surfaces and solids.
    pub place: Option<Place>,
    /// In words, in one line.
    pub message: String,
    /// Reasons, places, and a way out if there is one, a line each.
    pub details: Vec<String>,
}

/// Something that was asked for and not done.
pub type NotDone = Message<NotDoneKind>;

/// Something to know beside a result.
pub type Remark = Message<RemarkKind>;

/// Kinds of what was not done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NotDoneKind {
    /// The ranges of a surface hold several branches, and nothing says which one is meant.
    Ambiguous,
    /// Points are not solved.
    NotSolved,
    /// Points do not meet a requirement of their sample.
    NotAsRequired,
    /// Points are solved, but no proof of them was found.
    NotCertified,
    /// What single edges leave is not known at some points.
    HeightUnknown,
    /// An axis goes beyond its travel.
    BeyondTravel,
    /// A smooth face is missing, or not shown to be as exact as asked for.
    FaceInexact,
    /// The deviation is not known at some points.
    NoDeviation,
    /// Places of a grid were not measured.
    NotMeasured,
    /// Another machine does not do what it should.
    NotReached,
    /// The axes of another machine have no closed form.
    NoClosedForm,
    /// A page has nothing to show.
    NoPage,
    /// Two flanks do not touch.
    NoContact,
    /// Two flanks reach into each other.
    Penetration,
    /// No settings make a flank as it was wanted.
    NotMet,
    /// The surfaces of a solid bound no body.
    NoBody,
    /// A body has steel that a tool of its job takes away.
    NotCut,
    /// A body is not cut into bricks.
    NoBricks,
    /// Balls of the size that was asked for measure no gear.
    NoBall,
    /// A cutter cannot mill a surface as it should.
    NotMilled,
    /// A cutter cuts too deep.
    TooDeep,
    /// A part of a cutter comes too near to a surface.
    NotClear,
}

/// Kinds of remarks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RemarkKind {
    /// The sample's `keep` takes nothing in the middle of the grid: the search began elsewhere.
    BegunElsewhere,
    /// The search for a first point was given up.
    SearchGivenUp,
    /// Parts of the ranges may hold further branches.
    BranchesNotExcluded,
    /// Other branches have points in the ranges, and are not among the points.
    OtherBranches,
    /// Several lines of one kind lie beside each other; one is shown.
    SeveralLines,
    /// Points of a line are outside the ranges.
    LineOutside,
    /// A line was not found, and not excluded.
    LineNotExcluded,
    /// How exact the smooth face of a surface is.
    SmoothFace,
    /// Points were not checked against other positions of the tool.
    PositionsNotTried,
    /// Two surfaces have their material on opposite sides.
    OppositeSides,
    /// Deviations are those of a surface before `trim`.
    TrimmedAway,
    /// A page shows a part of the points.
    ShownInPart,
    /// A job asks for no points.
    NoSample,
    /// A surface has no grid that could be measured.
    NoGrid,
    /// A value set by the caller changes several jobs.
    SeveralJobs,
    /// A mesh has no triangle.
    NoTriangles,
    /// Nothing says where the teeth of a contact's flank end.
    NoEdges,
    /// Nothing says when the next pair of teeth follows.
    OnePair,
    /// A pair of teeth still touches where the range of the roll ends.
    RollTooShort,
    /// A surface of a tooth space was not held against the mate.
    NotLookedAt,
    /// A pair that is mounted wrongly has less than no backlash.
    NegativeBacklash,
    /// The backlash of a pair is another one than it was.
    OtherBacklash,
    /// A setting does not move the surface.
    MovesNothing,
    /// A setting changes the mate or the mounting, too.
    MovesMate,
    /// A measured point does not go with the others.
    Outlier,
    /// Deviations fit better in the other order of rows or columns.
    OtherOrder,
    /// Measured points lie beside their places as those of a gear do that is mounted or scaled otherwise.
    OtherMounting,
    /// What settings take away of a deviation is not more than it scatters.
    NotShown,
    /// Over tolerances a result is not proportional to them.
    NotLinear,
    /// The axes of a machine are not worked out.
    NoAxes,
    /// A surface is continued beyond what its tool makes.
    Continued,
    /// A cut ends before the passes of its cutter do.
    ShortCut,
    /// A program does not say something that it needs.
    Unsaid,
    /// Cases of a study are not compiled once.
    FromTexts,
}

impl<Kind> Message<Kind> {
    pub(crate) fn new(kind: Kind, of: &str, message: impl Into<String>) -> Message<Kind> {
        Message { kind, of: Some(of.to_string()), place: None, message: message.into(), details: Vec::new() }
    }

    /// With lines below the message.
    pub(crate) fn with(self, details: Vec<String>) -> Message<Kind> {
        Message { details, ..self }
    }

    /// With more lines below the message.
    pub(crate) fn with_more(mut self, details: Vec<String>) -> Message<Kind> {
        self.details.extend(details);
        self
    }

    /// Its message, then its details.
    pub(crate) fn lines(&self) -> impl Iterator<Item = String> {
        std::iter::once(self.message.clone()).chain(self.details.iter().cloned())
    }
}

/// The message, and its details indented below it.
impl<Kind> fmt::Display for Message<Kind> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
        self.details.iter().try_for_each(|detail| write!(f, "\n  {detail}"))
    }
}
