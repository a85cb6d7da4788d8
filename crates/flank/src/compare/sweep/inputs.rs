//! What differs from case to case: settings of a job, and axes of the machines of its contacts.

use std::fmt;

use flank_chain_dsl::{Code, Dimension, Job, Parameter, closest};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::request::Distribution;
use crate::project::amount::product_size;
use crate::project::failure::Failure;
use crate::project::requests::MountingError;
use crate::project::units;

/// Something that has another value in each case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(super) struct StudyInput {
    /// As the job knows it.
    pub(super) name: String,
    /// The unit of its values; empty for a number.
    pub(super) unit: String,
    /// Whether it is an axis of a contact, which is added to, rather than a parameter or setting.
    pub(super) is_axis: bool,
}

/// Why something cannot be an input, or a value of one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Unfit {
    code: Code,
    message: String,
}

impl Unfit {
    pub(super) fn new(code: Code, message: impl Into<String>) -> Unfit {
        Unfit { code, message: message.into() }
    }
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.message, self.code.as_str())
    }
}

impl From<Unfit> for Failure {
    fn from(unfit: Unfit) -> Failure {
        Failure::Input(unfit.to_string())
    }
}

/// What a job says of an input.
pub(super) struct KnownInput {
    pub(super) input: StudyInput,
    pub(super) dimension: Dimension,
    /// Of the job itself, in mm or radians; 0 of an axis.
    pub(super) value: f64,
    pub(super) range: Option<(f64, f64)>,
    pub(super) is_count: bool,
}

impl KnownInput {
    /// A parameter, a setting or an axis by its name, in the unit that people read.
    ///
    /// # Errors
    /// Which there are, if there is none of that name.
    pub(super) fn named(job: &Job<'_>, name: &str) -> Result<KnownInput, Unfit> {
        let axes = job.contacts.iter().flat_map(|contact| &contact.errors);
        if let Some(axis) = axes.into_iter().find(|axis| axis.name == name) {
            let unit = units::whole_symbol(axis.dimension);
            let input = StudyInput { name: name.to_string(), unit, is_axis: true };
            return Ok(KnownInput { input, dimension: axis.dimension, value: 0.0, range: None, is_count: false });
        }
        let of = parameter(job, name)?;
        let unit = units::whole_symbol(of.dimension);
        let input = StudyInput { name: of.name.clone(), unit, is_axis: false };
        Ok(KnownInput { input, dimension: of.dimension, value: of.value, range: of.range, is_count: of.is_count })
    }

    /// The size of the unit of its values.
    pub(super) fn size(&self) -> f64 {
        match size_of_unit(&self.input.unit) {
            Some((size, _)) => size,
            None => 1.0,
        }
    }

    /// How far a distribution reaches, in its unit.
    ///
    /// # Errors
    /// If its amount is of another kind.
    pub(super) fn amount(&self, of: Distribution) -> Result<f64, Failure> {
        let (Distribution::Normal(amount) | Distribution::Uniform(amount)) = of;
        let name = &self.input.name;
        if self.is_count {
            return Err(Failure::Input(format!("option `scatter {name}`: a count does not scatter; vary it")));
        }
        let refused = || Failure::Input(amount.refused("scatter", name, (self.dimension, self.value)));
        Ok(amount.inside(self.dimension, self.value).ok_or_else(refused)? / self.size())
    }

    /// Why a value cannot be one of this, if so; in its unit.
    pub(super) fn refused(&self, value: f64) -> Option<Unfit> {
        let name = &self.input.name;
        if !value.is_finite() {
            return Some(Unfit::new(Code::NotANumber, format!("`{name}` is no finite number")));
        }
        if self.is_count && value.fract() != 0.0 {
            let message = format!("`{name}` is a count, and {value} is no whole number");
            return Some(Unfit::new(Code::NotANumber, message));
        }
        self.is_beyond(value).then(|| {
            let (value, range) = (text(value, &self.input.unit), self.shown_range());
            Unfit::new(Code::OutOfRange, format!("`{name}` is {value}, outside its range {range}"))
        })
    }

    /// Whether a value in its unit lies outside its range.
    pub(super) fn is_beyond(&self, value: f64) -> bool {
        let inside = value * self.size();
        self.range.is_some_and(|(low, high)| {
            // a conversion of units may round
            let slack = 1e-12 * low.abs().max(high.abs());
            inside < low - slack || inside > high + slack
        })
    }

    /// Both ends of its range, if it has one.
    pub(super) fn shown_range(&self) -> String {
        let end = |end: f64| units::as_given(self.dimension, end);
        self.range.map_or(String::new(), |(low, high)| format!("{} .. {}", end(low), end(high)))
    }
}

impl StudyInput {
    /// How the head of a table names it.
    pub(super) fn head(&self) -> String {
        if self.unit.is_empty() { self.name.clone() } else { format!("{} [{}]", self.name, self.unit) }
    }

    /// A value as the language reads it.
    pub(super) fn as_setting(&self, value: f64) -> (String, String) {
        (self.name.clone(), text(value, &self.unit))
    }

    /// A value as a mounting error.
    pub(super) fn as_error(&self, value: f64) -> (String, MountingError) {
        let amount = match size_of_unit(&self.unit) {
            Some((size, Dimension::ANGLE)) => MountingError::Angle(value * size),
            found => MountingError::Length(value * found.map_or(1.0, |(size, _)| size)),
        };
        (self.name.clone(), amount)
    }
}

/// A parameter or a setting, by its whole name or the last part of it.
fn parameter<'j, 'g>(job: &'j Job<'g>, name: &str) -> Result<&'j Parameter<'g>, Unfit> {
    let own = name.strip_prefix(&format!("{}.", job.name)).unwrap_or(name);
    if let Some(whole) = job.parameters.iter().find(|of| of.name == own) {
        return Ok(whole);
    }
    let found: Vec<&Parameter<'g>> =
        job.parameters.iter().filter(|of| of.name.rsplit('.').next() == Some(own)).collect();
    match found[..] {
        [one] => Ok(one),
        [] => Err(unknown(job, name)),
        _ => {
            let known = quoted(found.iter().map(|of| &of.name));
            Err(Unfit::new(Code::UnknownName, format!("several settings end with `{name}`; say which: {known}")))
        }
    }
}

fn unknown(job: &Job<'_>, name: &str) -> Unfit {
    let axes = job.contacts.iter().flat_map(|contact| contact.errors.iter().map(|axis| &axis.name));
    let known: Vec<&String> = job.parameters.iter().map(|of| &of.name).chain(axes).collect();
    // a name may be the last part of a whole one
    let parts = known.iter().flat_map(|of| [of.as_str(), of.rsplit('.').next().unwrap_or_default()]);
    let way_out = match closest(name, parts) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("there is: {}", quoted(known.iter().copied())),
    };
    let message = format!("job `{}` has no parameter, setting or axis of a contact `{name}`; {way_out}", job.name);
    Unfit::new(Code::UnknownName, message)
}

fn quoted<'n>(names: impl Iterator<Item = &'n String>) -> String {
    names.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// A value with its unit, the shortest that is the same number.
pub(super) fn text(value: f64, unit: &str) -> String {
    match product_size(unit) {
        // in mm and radians, as no other products are shown
        Some((_, dimension)) if size_of_unit(unit).is_none() => format!("{value} {}", units::of_language(dimension)),
        _ => format!("{value} {unit}").trim_end().to_string(),
    }
}

/// Of a plain unit, in mm or radians, and what it measures.
pub(super) fn size_of_unit(unit: &str) -> Option<(f64, Dimension)> {
    flank_chain_dsl::unit_size(unit)
}
