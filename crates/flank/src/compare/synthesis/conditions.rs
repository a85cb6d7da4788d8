//! What is wanted of a contact, as the solver takes it and as people read it.

use std::f64::consts::PI;

use flank_chain_dsl::{ContactCondition, ContactQuantity, Dimension, Job, WantedContact};
use flank_solver::{ContactNumber, ContactPoint, ContactWish, FlankCorners, Outline};

use super::result::ReachedCondition;
use crate::contact::pair::Members;
use crate::contact::place::{corners, fine, fine_unit};
use crate::project::failure::Failure;
use crate::project::units;
use crate::solve::blank;

/// A condition holds within this, mm or radians.
const MET: f64 = 1e-6;
/// The height of a parabola holds within this share of it.
const SHARE: f64 = 1e-6;
/// A share is one of a length: of a tooth that is longer than this share of it is a thousandth of a micrometre.
const SHARE_MET: f64 = 1e-8;

/// A condition with what it says to the solver.
pub(super) struct Condition {
    pub(super) of: ContactCondition,
    pub(super) wish: ContactWish,
    /// Of the error of the contact.
    error: Dimension,
    /// A second derivative of the error of 1 as a height over a pitch, with its sign; 1 for other numbers.
    height: f64,
}

/// The conditions of a wish at a contact that has a vertex.
///
/// # Errors
/// If the spec does not say what a condition is about: shares of a flank, or the pitch.
pub(super) fn conditions(
    job: &Job<'_>,
    members: &Members<'_, '_>,
    want: &WantedContact,
    vertex: &ContactPoint,
) -> Result<Vec<Condition>, Failure> {
    let error = members.contact.lag.dimension;
    let built = want.conditions.iter().map(|of| {
        let corners = || of_shares(members, of.of);
        let (number, height) = match of.of {
            ContactQuantity::Z => (ContactNumber::Z, 1.0),
            ContactQuantity::Rho => (ContactNumber::Rho, 1.0),
            ContactQuantity::Lengthwise => (ContactNumber::Lengthwise(corners()?), 1.0),
            ContactQuantity::Profilewise => (ContactNumber::Profilewise(corners()?), 1.0),
            ContactQuantity::Path => (ContactNumber::Path(corners()?), 1.0),
            ContactQuantity::Ellipse => (ContactNumber::Ellipse { film: want.film }, 1.0),
            ContactQuantity::TransmissionError => (ContactNumber::Curvature, height(job, members, vertex)?),
        };
        let within = of.within.map(|within| (within / height).abs());
        let wish = ContactWish { of: number, wanted: of.value / height, within };
        Ok(Condition { of: *of, wish, error, height })
    });
    built.collect()
}

fn of_shares(members: &Members<'_, '_>, of: ContactQuantity) -> Result<FlankCorners, Failure> {
    let surface = members.surfaces[1];
    corners(surface).ok_or_else(|| {
        let (name, of) = (&surface.name, of.name());
        Failure::Input(format!(
            "`{of}` is told by the rows between the corners of a tooth, and the sample of `{name}` has none: give it `toe_root`, \
             `heel_root`, `toe_tip` and `heel_tip`"
        ))
    })
}

/// A pair carries where it is ahead of all others: there its error opens the pair less than to both sides.
fn height(job: &Job<'_>, members: &Members<'_, '_>, vertex: &ContactPoint) -> Result<f64, Failure> {
    let pitch = members.pitch(job).ok_or_else(|| {
        let contact = &members.contact.name;
        Failure::Input(format!(
            "`transmission_error` is one over a pitch, and nothing says the pitch of `{contact}`: add a `solid` of both members, or `every:`"
        ))
    })?;
    Ok(-vertex.opening.signum() * pitch * pitch / 8.0)
}

impl Condition {
    /// Its value, mm or radians.
    pub(super) fn value(&self, at: &ContactPoint) -> Option<f64> {
        Some(self.height * self.wish.of.of(at)?)
    }

    /// From what is wanted to a value.
    pub(super) fn apart(&self, value: f64) -> f64 {
        let apart = value - self.of.value;
        match self.of.of {
            // a path has no sense
            ContactQuantity::Path => apart - PI * (apart / PI).round(),
            _ => apart,
        }
    }

    /// How far a value is from what is wanted.
    pub(super) fn off(&self, value: f64) -> f64 {
        self.apart(value).abs()
    }

    /// Whether a contact meets it.
    pub(super) fn is_met_at(&self, at: &ContactPoint) -> bool {
        self.value(at).is_some_and(|value| self.is_met(value))
    }

    /// Whether a value meets it, exactly or as nearly as it asks for.
    pub(super) fn is_met(&self, value: f64) -> bool {
        let off = self.off(value);
        let most = match self.of.of {
            ContactQuantity::Lengthwise | ContactQuantity::Profilewise => SHARE_MET,
            ContactQuantity::TransmissionError => SHARE * self.of.value.abs(),
            _ => MET,
        };
        off <= self.of.within.unwrap_or(most)
    }

    fn dimension(&self) -> Dimension {
        self.of.of.dimension(self.error)
    }

    /// In the unit that people read.
    pub(super) fn shown(&self, value: f64) -> f64 {
        match self.of.of {
            ContactQuantity::TransmissionError => fine(self.error, value),
            _ => units::shown(self.dimension(), value),
        }
    }

    pub(super) fn unit(&self) -> String {
        match self.of.of {
            ContactQuantity::TransmissionError => fine_unit(self.error).to_string(),
            _ => units::whole_symbol(self.dimension()),
        }
    }

    pub(super) fn told(&self, [now, reached, checked]: [Option<&ContactPoint>; 3]) -> ReachedCondition {
        let value = |at: Option<&ContactPoint>| self.value(at?);
        let shown = |at: Option<&ContactPoint>| value(at).map(|value| self.shown(value));
        ReachedCondition {
            name: self.of.of.name().to_string(),
            unit: self.unit(),
            now: shown(now),
            wanted: self.shown(self.of.value),
            within: self.of.within.map(|within| self.shown(within)),
            reached: shown(reached),
            checked: shown(checked),
            is_met: value(reached).is_some_and(|value| self.is_met(value)),
        }
    }
}

/// The place `[z, rho]` on the second flank that is wanted, if both of its coordinates are.
fn place(conditions: &[Condition]) -> Option<[f64; 2]> {
    let find = |of: ContactQuantity| conditions.iter().find(|condition| condition.of.of == of);
    let value = |of: ContactQuantity| find(of).map(|condition| condition.of.value);
    let section = value(ContactQuantity::Z).zip(value(ContactQuantity::Rho));
    let shares = value(ContactQuantity::Profilewise).zip(value(ContactQuantity::Lengthwise));
    let corners = find(ContactQuantity::Lengthwise).and_then(|condition| match condition.wish.of {
        ContactNumber::Lengthwise(corners) => Some(corners),
        _ => None,
    });
    section.map(|(z, rho)| [z, rho]).or_else(|| Some(corners?.at(shares.map(|(v, u)| [v, u])?)))
}

/// Why a wanted place is none of the flank.
pub(super) fn off_the_tooth(members: &Members<'_, '_>, conditions: &[Condition]) -> Option<String> {
    let place = place(conditions)?;
    beyond(members, 1, place).map(|(edge, off)| {
        format!(
            "place: the tooth ends before it: it lies {off:.3} mm beyond the {edge} of {}",
            members.surfaces[1].name
        )
    })
}

/// The edge of a member's tooth beyond which a point of its axial section lies, and how far, mm.
pub(super) fn beyond(members: &Members<'_, '_>, member: usize, section: [f64; 2]) -> Option<(String, f64)> {
    let outline: Outline = blank::outline(members.solids[member]?);
    let (segment, off) = outline.beyond(section)?;
    Some((outline.segments()[segment].name.clone(), off))
}
