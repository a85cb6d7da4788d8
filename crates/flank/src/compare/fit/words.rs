//! What the points do not tell of the settings, in words.

use flank_chain_dsl::{Dimension, Parameter};
use flank_export::fixed;
use flank_solver::{Alignment, SingularDirection, separated};

use super::settings::change;
use crate::project::units;

/// A direction that moves the flank by less, mm, root of the mean square, does nothing that a machine would measure.
pub(super) const NOTHING: f64 = 1e-6;
/// A share of a direction that counts.
pub(super) const SHARE: f64 = 1e-2;
/// A share of the largest one in a direction that is worth a word.
const LARGE: f64 = 0.3;

/// An unknown of a fit.
pub(super) struct Unknown<'p, 'g> {
    pub(super) what: What<'p, 'g>,
    pub(super) scale: f64,
}

/// What an unknown of a fit is.
#[derive(Clone, Copy)]
pub(super) enum What<'p, 'g> {
    Setting(&'p Parameter<'g>),
    /// Of all points.
    Motion(Alignment),
    /// Of the points of this surface beyond that.
    Further(Alignment, &'p str),
}

impl Unknown<'_, '_> {
    pub(super) fn name(&self) -> String {
        match self.what {
            What::Setting(of) => of.name.clone(),
            What::Motion(of) => motion_name(of).to_string(),
            What::Further(Alignment::Turn, name) => format!("further turn of {name}"),
            What::Further(Alignment::Shift, name) => format!("further shift of {name}"),
        }
    }

    pub(super) fn dimension(&self) -> Dimension {
        match self.what {
            What::Setting(of) => of.dimension,
            What::Motion(Alignment::Turn) | What::Further(Alignment::Turn, _) => Dimension::ANGLE,
            What::Motion(Alignment::Shift) | What::Further(Alignment::Shift, _) => Dimension::LENGTH,
        }
    }

    fn quoted(&self) -> String {
        match self.what {
            What::Setting(of) => format!("`{}`", of.name),
            _ => format!("the {}", self.name()),
        }
    }

    fn is_motion(&self) -> bool {
        !matches!(self.what, What::Setting(_))
    }
}

/// What the motion is called in which the place of the points is unknown.
pub(super) fn motion_name(of: Alignment) -> &'static str {
    match of {
        Alignment::Turn => "turn about z",
        Alignment::Shift => "shift along y",
    }
}

/// Each direction that is not used: what the points do not tell.
pub(super) fn untold(directions: &[SingularDirection], unknowns: &[Unknown<'_, '_>]) -> Vec<String> {
    let unused = directions.iter().filter(|of| !of.is_used);
    let (exact, weak): (Vec<&SingularDirection>, Vec<&SingularDirection>) = unused.partition(|of| of.size < NOTHING);
    let nothing = separated(exact.iter().map(|of| of.shares.clone()).collect());
    let exactly = nothing.iter().map(|shares| sentence(shares, None, unknowns));
    exactly.chain(weak.iter().map(|of| sentence(&of.shares, Some(of.size), unknowns))).collect()
}

fn sentence(shares: &[f64], size: Option<f64>, unknowns: &[Unknown<'_, '_>]) -> String {
    let most = shares.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let least = if size.is_some() { LARGE } else { SHARE };
    let part = |k: &usize| shares[*k].abs() > least * most;
    let parts: Vec<usize> = (0..shares.len()).filter(part).collect();
    let by = |k: usize| units_of(&unknowns[k], shares[k]);
    let little = size.map_or("moves the flank by less than 0.001 um".to_string(), |size| {
        format!("moves the flank by {} um only", fixed(1e3 * size, 3))
    });
    match parts[..] {
        [one] => format!("{} does not show: {} of it {little}", unknowns[one].quoted(), by(one)),
        [a, b] if size.is_none() => {
            let (a, b) = if unknowns[a].is_motion() { (b, a) } else { (a, b) };
            let ratio = -shares[b] * unknowns[b].scale / (shares[a] * unknowns[a].scale);
            let [first, other] = [a, b].map(|k| unknowns[k].quoted());
            let one = if units::is_angle(unknowns[a].dimension()) { 1f64.to_radians() } else { 1.0 };
            let [one, as_much] = [(a, one), (b, ratio * one)].map(|(k, x)| change(unknowns[k].dimension(), x));
            format!("{first} and {other}: only their sum shows, in which {one} of the one is {as_much} of the other")
        }
        _ => {
            let parts: Vec<String> = parts.iter().map(|k| format!("{} of {}", by(*k), unknowns[*k].quoted())).collect();
            format!("{} together: that {little}", parts.join(", "))
        }
    }
}

fn units_of(of: &Unknown<'_, '_>, share: f64) -> String {
    change(of.dimension(), share * of.scale)
}
