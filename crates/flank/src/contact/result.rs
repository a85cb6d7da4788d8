//! What `flank contact` found.

use std::fmt;

use flank_export::fixed;
use schemars::JsonSchema;
use serde::Serialize;

use crate::project::answer::{Answer, Timing};
use crate::project::remark::{NotDone, Remark};
use crate::project::units;

/// Where two flanks touch while a pair rolls, and how evenly they turn each other, of `flank contact`. Angles are deg, lengths mm, unless a
/// name ends otherwise; the error is what the contact adds to the wanted law of the driven member.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.contact/1")]
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
    /// Where the error is extreme, or in the middle of contact of the flanks where it has no extreme.
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
    /// What mounting errors do to the middle, if that was asked for.
    pub influences: Vec<MountingInfluence>,
    /// Mountings that bring the contact to other places, if that was asked for.
    pub vhj: Vec<VhjRow>,
    /// Files written, in their order.
    pub files: Vec<String>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
    /// What is to be known beside it, as stderr has it.
    pub remarks: Vec<Remark>,
    #[serde(skip)]
    pub(super) timing: Timing,
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
    /// The path against the rows of the flank's sample; null where it cannot be told.
    pub path_angle: Option<f64>,
}

/// How uneven a pair turns over one pitch.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct TransmissionError {
    /// `urad` or `um`.
    pub unit: String,
    /// The composite error's greatest less its least value.
    pub peak_to_peak: f64,
    /// Roll positions at which one pair of teeth hands over to the next.
    pub transfers: Vec<f64>,
    /// How many pairs are at most within the film of the marking compound at a time, along the normal at their own contact.
    pub pairs: usize,
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

/// What one mounting error does to the middle, per 0.01 mm or arcminute.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct MountingInfluence {
    /// The axis.
    pub axis: String,
    /// The error that it is told for.
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

/// Below this a parabola or a curvature of the gap is zero, in the units in which it is printed: rounding.
const NOTHING: f64 = 1e-9;

fn small(value: f64) -> String {
    if value.abs() < NOTHING { "0".to_string() } else { units::scientific(value, 3) }
}

impl fmt::Display for ContactResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, second] = &self.members;
        let ContactResult { contact, over, over_unit, unknown, .. } = self;
        writeln!(
            f,
            "contact {contact} of {}: {} ({}) with {} ({}), over {over}, for {unknown}\n",
            self.job, first.surface, first.frame, second.surface, second.frame
        )?;
        for error in &self.mounted {
            let value = (error.value * 1e9).round() / 1e9;
            writeln!(f, "  mounted      {} {value} {} off", error.axis, error.unit)?;
        }
        if let Some(middle) = &self.middle {
            self.write_middle(f, middle)?;
        }
        if let Some(error) = &self.error {
            let transfers: Vec<String> = error.transfers.iter().map(|turn| fixed(*turn, 3)).collect();
            let handed = match transfers.len() {
                0 => String::new(),
                _ => format!(", transfer at {over} {} {over_unit}", transfers.join(" and ")),
            };
            writeln!(
                f,
                "  error        peak to peak {} {} over a pitch{handed}",
                fixed(error.peak_to_peak, 3),
                error.unit
            )?;
        }
        if let Some(ratio) = self.ratio {
            let pairs = self.error.as_ref().map_or(String::new(), |error| {
                format!("; up to {} within the film at a time", units::counted(error.pairs, "pair"))
            });
            writeln!(f, "  ratio        {} on the flanks{pairs}", fixed(ratio, 3))?;
        }
        for end in &self.ends {
            let what = if end.is_begin { "begins" } else { "ends" };
            let at = end.at.as_ref().map_or("the end of what its tool makes".to_string(), |at| at.clone());
            writeln!(
                f,
                "  flanks       contact {what} at {over} {} {over_unit}: {at} of {}",
                fixed(end.turn, 3),
                end.of
            )?;
        }
        if self.error.is_some() {
            if self.edges.is_empty() && self.members.iter().any(|member| member.solid.is_some()) {
                writeln!(f, "  edges        no edge carries")?;
            }
            for edge in &self.edges {
                let [from, to] = [edge.from, edge.to].map(|turn| fixed(turn, 3));
                writeln!(f, "  edges        {} carries from {over} {from} to {to} {over_unit}", edge.edge)?;
            }
        }
        self.pattern.iter().try_for_each(|pattern| pattern.write(f))?;
        if let Some(backlash) = &self.backlash {
            let unit = &self.unknown_unit;
            let (least, normal, turn) = (fixed(backlash.least, 5), fixed(backlash.normal, 4), fixed(backlash.turn, 3));
            writeln!(
                f,
                "  backlash     {least} {unit}, {normal} mm along the normal, to {} at {over} {turn} {over_unit}",
                backlash.other
            )?;
        }
        self.write_influences(f)?;
        if !self.vhj.is_empty() {
            writeln!(f)?;
        }
        for row in &self.vhj {
            let (to, lengthwise) = (&row.to, fixed(row.lengthwise, 1));
            let nothing = || format!("no {} bring the contact there", row.axes.join(" and "));
            let mounted = row.errors.as_ref().map_or_else(nothing, |errors| {
                let each = row.axes.iter().zip(errors).map(|(axis, error)| format!("{axis} {} mm", fixed(*error, 4)));
                each.collect::<Vec<String>>().join(", ")
            });
            writeln!(f, "  to {to:9} lengthwise {lengthwise}: {mounted}")?;
        }
        if self.files.is_empty() { Ok(()) } else { writeln!(f, "\nwrote {}", self.files.join(", ")) }
    }
}

impl ContactResult {
    fn write_middle(&self, f: &mut fmt::Formatter<'_>, middle: &ContactMiddle) -> fmt::Result {
        let ContactResult { over, over_unit, unknown_unit, .. } = self;
        let error_unit = self.error.as_ref().map_or("", |error| error.unit.as_str());
        for (member, place) in self.members.iter().zip(&middle.on) {
            let shares = place
                .shares
                .map_or(String::new(), |[u, v]| format!("lengthwise {}, profilewise {}; ", fixed(u, 3), fixed(v, 3)));
            let (z, rho) = (fixed(place.z, 3), fixed(place.rho, 3));
            let path = place
                .path_angle
                .map_or(String::new(), |angle| format!("; the path at {} deg to its rows", fixed(angle, 1)));
            writeln!(f, "  middle       {shares}z {z} mm, rho {rho} mm on {}{path}", member.surface)?;
        }
        let vertex =
            if middle.is_vertex { "where the error is extreme" } else { "in the middle of contact of the flanks" };
        writeln!(f, "               at {over} {} {over_unit}, {vertex}", fixed(middle.turn, 3))?;
        let kind = match self.kind {
            Some(ContactKind::Line) => "line contact",
            Some(ContactKind::Crossing) => {
                "no contact: the flanks run into each other beside the point, so that edges carry"
            }
            _ => "contact in a point",
        };
        let gap =
            middle.gap.map_or(String::new(), |[a, b]| format!(", gap curvatures {} and {} 1/mm", small(a), small(b)));
        let film = self.pattern.first().map_or(String::new(), |pattern| format!(" at {} um", pattern.film_um));
        let ellipse = middle.ellipse.map_or(String::new(), |[a, b]| {
            format!(", ellipse {} x {} mm{film}", fixed(2.0 * a, 2), fixed(2.0 * b, 2))
        });
        writeln!(f, "  contact      {kind}{gap}{ellipse}")?;
        let error = fixed(middle.error, 7);
        writeln!(
            f,
            "  error        {error} {unknown_unit} there, parabola {} {error_unit}/{over_unit}^2",
            small(middle.parabola)
        )?;
        let [sliding, entraining] = [middle.sliding, middle.entraining].map(|speed| fixed(speed, 3));
        writeln!(f, "  velocities   sliding {sliding}, entraining {entraining} mm/rad of {over}")
    }

    fn write_influences(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.influences.is_empty() {
            return Ok(());
        }
        let unit = self.error.as_ref().map_or("", |error| error.unit.as_str());
        let width = self.influences.iter().map(|of| of.axis.len()).max().unwrap_or(0).max(4);
        writeln!(f, "\n  {:width$}  per       moves on both, mm   {unit:>9}  parabola %  ellipse %", "axis")?;
        for of in &self.influences {
            let [a, b] = of.moved_mm.map(|way| fixed(way, 4));
            let percent = |share: Option<f64>| share.map_or("-".to_string(), |share| fixed(100.0 * share, 2));
            let (error, parabola, ellipse) = (fixed(of.error, 3), percent(of.parabola), percent(of.ellipse));
            writeln!(
                f,
                "  {:width$}  {:8}  {a:>8} {b:>8}   {error:>9}  {parabola:>10}  {ellipse:>9}",
                of.axis, of.per
            )?;
        }
        Ok(())
    }
}

impl ContactPattern {
    fn write(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ContactPattern { surface, within, points, film_um, .. } = self;
        let share = 100.0 * *within as f64 / (*points).max(1) as f64;
        let extent = self.rows.zip(self.columns).map_or(String::new(), |([a, b], [c, d])| {
            let [a, b, c, d] = [a, b, c, d].map(|share| fixed(share, 2));
            format!(", rows {a} to {b}, columns {c} to {d} of its sample")
        });
        let least = self.least_um.map_or(String::new(), |least| format!(", least gap {} um", fixed(least, 3)));
        let touches = match self.touches.len() {
            0 => String::new(),
            _ => format!("; touches {}", self.touches.join(", ")),
        };
        writeln!(f, "  pattern      {} % of {surface} within {film_um} um{extent}{least}{touches}", fixed(share, 1))
    }
}
