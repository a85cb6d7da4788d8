//! What `flank contact` found.

use schemars::JsonSchema;
use serde::Serialize;

use crate::project::answer::{Answer, Timing};
use crate::project::remark::{NotDone, Remark};
use crate::solve::arrays::PointGrid;

/// Where two flanks touch while a pair rolls, and how evenly they turn each other, of `flank contact`. Angles are deg, lengths mm, unless a
/// name ends otherwise; the error is what the contact adds to the wanted law of the driven member.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.contact/2")]
pub struct ContactResult {
    /// The job.
    #[serde(skip)]
    pub job: String,
    /// The contact.
    pub contact: String,
    /// The two flanks.
    pub members: [ContactMember; 2],
    /// The motion that the pair rolls by.
    pub over: String,
    /// The unit of its values.
    pub over_unit: String,
    /// The unknown that the contact determines: the error.
    pub unknown: String,
    /// The unit of its values.
    pub unknown_unit: String,
    /// How the members are mounted wrong.
    pub mounted: Vec<MountedError>,
    /// What the flanks are to each other; null where no contact was found.
    pub kind: Option<ContactKind>,
    /// Where the error is extreme, or in the middle of contact of the flanks where it has no extreme; where these never touch, at an edge.
    pub middle: Option<ContactMiddle>,
    /// Over one pitch about the middle.
    pub error: Option<TransmissionError>,
    /// Contact of the flanks from where it begins to where it ends, in pitches; null where the pitch is not known.
    pub ratio: Option<f64>,
    /// Where contact of the flanks begins and ends, in the order of the roll.
    pub ends: Vec<FlankEnd>,
    /// Where an edge carries, over the pitch about the middle.
    pub edges: Vec<LeadingEdge>,
    /// What the marking compound shows on each flank.
    pub pattern: Vec<ContactPattern>,
    /// Between this contact and the one of the opposite flanks, where the job has it.
    pub backlash: Option<Backlash>,
    /// Between the edges of each flank and the other surfaces of the mate's tooth space, as far as they come together.
    pub clearances: Vec<Clearance>,
    /// What mounting errors do to the middle, if that was asked for.
    pub influences: Vec<ContactInfluence>,
    /// Mountings that bring the contact to other places, if that was asked for.
    pub vhj: Vec<VhjRow>,
    /// The same pair with a milled flank, if that was asked for.
    pub milled: Option<MilledContact>,
    /// What is proven of the contact from its first touch to its last, if that was asked for.
    pub proven: Option<ProvenContact>,
    /// Files written, in their order.
    pub files: Vec<String>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
    /// What is to be known beside it, as stderr has it.
    pub remarks: Vec<Remark>,
    /// The points of both flanks with the least gap to the mate, and the path of contact on both.
    #[serde(skip)]
    pub grids: Vec<PointGrid>,
    #[serde(skip)]
    pub(super) timing: Timing,
}

/// What interval arithmetic proves of a contact: at each of these roll positions exactly one solution of its equations lies so near to the
/// computed one.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ProvenContact {
    /// Roll positions that are proven.
    pub points: usize,
    /// The largest distance of the point of contact, mm; null where nothing is proven.
    pub radius_mm: Option<f64>,
    /// The largest deviation of the error, in the unit of the unknown.
    pub error: Option<f64>,
}

/// A pair whose one flank is milled: what is left of it touches the mate.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct MilledContact {
    /// The milling.
    pub milling: String,
    /// The flank that it mills.
    pub surface: String,
    /// Whether one pass with the side of the cutter covers it, so that there are no ridges.
    pub has_one_pass: bool,
    /// The most that is left beside the stock, um: its highest ridge, if there are any.
    pub ridge_um: f64,
    /// The least of it, um; negative where the cutter goes too deep.
    pub least_um: f64,
    /// `urad` or `um`, of errors.
    pub unit: String,
    /// The composite error's greatest less its least value over a pitch, at `rolls`.
    pub peak_to_peak: f64,
    /// The same of the generated pair, at the same roll positions.
    pub generated_peak_to_peak: f64,
    /// By how much what is left holds the driven member away from where the generated pair has it, at the least and at the most; negative where it falls
    /// back.
    pub ahead: [f64; 2],
    /// More than this it cannot be: the most that is left, with the stock, over the shortest lever.
    pub at_most: f64,
    /// What the marking compound shows on the milled part: of the generated flank, then of the milled one.
    pub patterns: [MilledPattern; 2],
    /// Roll positions over a pitch, deg or mm.
    pub rolls: Vec<f64>,
    /// The error of the generated pair there, from that of its middle.
    pub generated: Vec<f64>,
    /// The error of the milled pair there, from the same.
    pub milled: Vec<f64>,
}

/// What the marking compound shows on the milled part of a flank, at places of the passes and of the ridges between them, or
/// of the rows of one pass.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct MilledPattern {
    /// Whether the flank is as it is milled, else as generated.
    pub is_milled: bool,
    /// Places that it touches.
    pub within: usize,
    /// Places.
    pub points: usize,
    /// The least gap, um; negative where the mate reaches in.
    pub least_um: Option<f64>,
}

/// A flank of a contact.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ContactMember {
    /// The surface.
    pub surface: String,
    /// Its frame.
    pub frame: String,
    /// The solid whose outline says where its teeth end; null where nothing does, and no edge is known.
    pub solid: Option<String>,
    /// The other surfaces of its tooth space, against which the edges of the mate are held.
    pub space: Vec<String>,
}

/// What two flanks are to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ContactKind {
    /// They touch in a point.
    Point,
    /// They touch along a line: conjugate flanks.
    Line,
    /// They run into each other beside the point: not the place where the pair touches.
    Crossing,
    /// They do not touch there: an edge of one of them does.
    Edge,
}

/// How a member is mounted wrong.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MountedError {
    /// The axis.
    pub axis: String,
    /// By how much.
    pub value: f64,
    /// In which unit.
    pub unit: String,
}

/// A contact in the middle.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ContactMiddle {
    /// Whether the error is extreme there.
    pub is_vertex: bool,
    /// The edge that touches instead of the flanks; null where these touch.
    pub edge: Option<String>,
    /// The roll position.
    pub turn: f64,
    /// The error.
    pub error: f64,
    /// Its second derivative by the roll, urad or um per square of the roll's unit.
    pub parabola: f64,
    /// On each member.
    pub on: [PlaceOnFlank; 2],
    /// Curvatures of the gap, 1/mm, the greater first; null where an edge touches.
    pub gap: Option<[f64; 2]>,
    /// Half axes of the ellipse within the film, the longer first; null where there is none.
    pub ellipse: Option<[f64; 2]>,
    /// Velocity of the first member against the second, mm per radian of the roll.
    pub sliding: f64,
    /// Half the sum of the velocities of both against the point, mm per radian of the roll.
    pub entraining: f64,
}

/// A place on a flank.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct PlaceOnFlank {
    /// In the frame of the flank.
    pub z: f64,
    /// Distance from its axis.
    pub rho: f64,
    /// Shares of the way from toe to heel and from root to tip, where the sample is one of shares.
    pub shares: Option<[f64; 2]>,
    /// The path against the rows of the flank's sample, above -90 and up to 90: positive where it comes nearer to the tip on its way to the
    /// heel. Null where it cannot be told.
    pub path_angle: Option<f64>,
}

/// How uneven a pair turns over one pitch.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct TransmissionError {
    /// `urad` or `um`.
    pub unit: String,
    /// The composite error's greatest less its least value, as far of the roll as `over` says.
    pub peak_to_peak: f64,
    /// How far of the roll that is, deg or mm: a pitch; less where `gap` leaves some of it out; of one pair of teeth alone as far as it touches.
    pub over: f64,
    /// How far it is from tooth to tooth; null of one pair of teeth alone.
    pub pitch: Option<f64>,
    /// Between which roll positions no pair of teeth is known to touch; null where one does all over a pitch.
    pub gap: Option<ErrorGap>,
    /// Roll positions at which one pair of teeth hands over to the next.
    pub transfers: Vec<f64>,
    /// How many pairs are at most within the film of the marking compound at a time, along the normal at their own contact.
    pub pairs: usize,
}

/// A stretch of the roll over which no pair of teeth is known to touch: from the end of one to the beginning of the next.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ErrorGap {
    /// Roll position.
    pub from: f64,
    /// Its end.
    pub to: f64,
    /// Whether the range of the roll ends there while the pair still touches: a wider one would tell more.
    pub is_of_roll: bool,
}

impl TransmissionError {
    /// Its height, where it is that of a whole pitch, or of one pair of teeth alone.
    pub(crate) fn whole(&self) -> Option<f64> {
        self.gap.is_none().then_some(self.peak_to_peak)
    }
}

/// Where contact of the flanks begins or ends.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct FlankEnd {
    /// The roll position.
    pub turn: f64,
    /// The surface that ends there.
    pub of: String,
    /// The segment of its outline; null where the ranges of its tool end.
    pub at: Option<String>,
    /// Whether contact of the flanks begins there.
    pub is_begin: bool,
}

/// An edge that carries.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LeadingEdge {
    /// The edge, `tip of gear_convex`, or several.
    pub edge: String,
    /// Between which roll positions, at the resolution of the positions.
    pub from: f64,
    /// Its end.
    pub to: f64,
}

/// What the marking compound shows on a flank.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ContactPattern {
    /// The flank.
    pub surface: String,
    /// Thickness of the compound, um.
    pub film_um: f64,
    /// Points of its sample that it touches.
    pub within: usize,
    /// Solved points of its sample.
    pub points: usize,
    /// From which to which row and column of the sample, as shares; null where none is touched.
    pub rows: Option<[f64; 2]>,
    /// See `rows`.
    pub columns: Option<[f64; 2]>,
    /// The least gap, um; negative where the mate reaches in.
    pub least_um: Option<f64>,
    /// The sides of the sample that the pattern reaches, in the words of its rows and columns.
    pub touches: Vec<String>,
}

/// How much a pair can move between this contact and the opposite one.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Backlash {
    /// The contact of the opposite flanks.
    pub other: String,
    /// The least over the pitch, in the unit of the unknown.
    pub least: f64,
    /// Where on the roll.
    pub turn: f64,
    /// The same along the normal of this contact, mm.
    pub normal: f64,
}

/// The room that the edges of a tooth have in the space of its mate, beside the flanks of the contact; from these where an edge cuts into them away from
/// the contact.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Clearance {
    /// The flank whose edges they are.
    pub of: String,
    /// The surface of the mate's space.
    pub with: String,
    /// The least room along the normal of that surface, mm, over the roll and over nine places of each edge: negative where an edge cuts into
    /// it.
    pub least_mm: f64,
    /// Where that is on the roll.
    pub turn: f64,
}

/// What causes a change of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum InfluenceKind {
    /// An axis of the pair's machine.
    Mounting,
    /// A setting of a machine, a tool or the job; what is defined by it follows.
    Setting,
}

/// What one mounting error or setting does to the middle, to first order.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ContactInfluence {
    /// The axis of the pair's machine, or the setting of a machine, a tool or the job.
    pub name: String,
    /// Which of both it is.
    pub kind: InfluenceKind,
    /// The change that it is told for.
    pub per: String,
    /// How far the middle moves on the first and on the second flank, mm.
    pub moved_mm: [f64; 2],
    /// Along the rows of the second flank's sample and across; null where it cannot be told.
    pub along_rows_mm: Option<[f64; 2]>,
    /// The error at the middle, urad or um.
    pub error: f64,
    /// The parabola, as a share of what it is.
    pub parabola: Option<f64>,
    /// The longer half axis of the ellipse, as a share.
    pub ellipse: Option<f64>,
    /// The roll position of the middle, in its unit.
    pub turn: f64,
}

/// A mounting that brings the middle of the contact to another place.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct VhjRow {
    /// `toe`, `middle`, `heel`.
    pub to: String,
    /// Where that is on the second flank, as a share of the way from toe to heel.
    pub lengthwise: f64,
    /// The same from root to tip: as it is without them.
    pub profilewise: f64,
    /// The axes.
    pub axes: Vec<String>,
    /// Their errors, mm, in the order of `axes`; null where no mounting along them brings it there.
    pub errors: Option<Vec<f64>>,
    /// What the contact has beyond its range there, the unknown or a motion or parameter of a flank, with its value: so mounted, the pair is
    /// found with a wider range of it.
    pub beyond: Vec<String>,
}

impl Answer for ContactResult {
    fn not_done(&self) -> &[NotDone] {
        &self.not_done
    }

    fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    fn timing(&self) -> Option<Timing> {
        Some(self.timing)
    }
}
