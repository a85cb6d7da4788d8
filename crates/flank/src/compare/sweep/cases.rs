//! The values of the inputs in each case.

use flank_chain_dsl::{Code, Job};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::drawn::{FARTHEST, MOST_SOBOL, independent, normal, sobol};
use super::inputs::{KnownInput, StudyInput, Unfit, text};
use super::request::{CaseSource, Distribution, VariedRange};
use super::table;
use crate::project::failure::Failure;
use crate::project::monitor::Monitor;
use crate::project::requests::JobSelection;
use crate::project::units;

/// Cases of a study at the most.
const MOST_CASES: u64 = 100_000_000;
/// Cases whose values are drawn before it is looked at whether some lie beyond their ranges.
const TOGETHER: u64 = 1 << 20;

/// How the values of a case follow from its number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(transform = tell_of_properties)]
pub(super) enum CaseValues {
    /// One row for each.
    Table(Vec<Vec<f64>>),
    /// First and last value of each input, and how many; the first changes slowest.
    Ranges(Vec<(f64, f64, u32)>),
    /// Random values.
    Scatter {
        /// Value of the spec, how far it scatters, and whether by a normal distribution.
        about: Vec<(f64, f64, bool)>,
        /// How many cases.
        count: u64,
        /// Another number gives other cases.
        seed: u64,
        /// Whether they are points of Sobol's sequence.
        sobol: bool,
    },
}

/// The value of a case of the input of a number and a name, drawn about a value of the spec.
fn drawn(
    (value, reach, is_normal): (f64, f64, bool),
    (seed, case, is_sobol): (u64, u64, bool),
    of: (usize, &str),
) -> f64 {
    let share = if is_sobol { sobol(seed, case, of) } else { independent(seed, case, of.1) };
    value + reach * if is_normal { normal(share) } else { 2.0 * share - 1.0 }
}

/// What is said of a variant is said of the property that holds it.
fn tell_of_properties(schema: &mut schemars::Schema) {
    let variants = schema.get_mut("oneOf").and_then(serde_json::Value::as_array_mut);
    for variant in variants.into_iter().flatten() {
        let about = variant["description"].clone();
        let properties = variant.get_mut("properties").and_then(serde_json::Value::as_object_mut);
        properties.into_iter().flatten().for_each(|(_, of)| of["description"] = about.clone());
    }
}

impl CaseValues {
    pub(super) fn count(&self) -> u64 {
        match self {
            CaseValues::Table(rows) => rows.len() as u64,
            CaseValues::Ranges(ranges) => ranges.iter().map(|(_, _, count)| u64::from(*count)).product(),
            CaseValues::Scatter { count, .. } => *count,
        }
    }

    /// Of case `number`, counted from 0, in the order and the units of the inputs.
    pub(super) fn of_case(&self, number: u64, inputs: &[StudyInput]) -> Vec<f64> {
        match self {
            CaseValues::Table(rows) => rows[number as usize].clone(),
            CaseValues::Ranges(ranges) => {
                let mut rest = number;
                let mut values: Vec<f64> = ranges
                    .iter()
                    .rev()
                    .map(|(low, high, count)| {
                        let (at, last) = (rest % u64::from(*count), u64::from(*count) - 1);
                        rest /= u64::from(*count);
                        match at {
                            0 => *low,
                            at if at == last => *high,
                            at => low + (high - low) * (at as f64 / last as f64),
                        }
                    })
                    .collect();
                values.reverse();
                values
            }
            CaseValues::Scatter { about, seed, sobol, .. } => {
                let each = about.iter().zip(inputs).enumerate();
                each.map(|(k, (about, input))| drawn(*about, (*seed, number, *sobol), (k, &input.name))).collect()
            }
        }
    }
}

/// Inputs and cases of a request.
///
/// # Errors
/// Unknown names, missing units, values outside their ranges: of all cases.
pub(super) fn read(
    job: &Job<'_>,
    which: &JobSelection,
    source: &CaseSource,
    monitor: &dyn Monitor,
) -> Result<(Vec<StudyInput>, CaseValues), Failure> {
    let (inputs, values) = match source {
        CaseSource::Table(path) => {
            let (inputs, rows) = table::read(job, &path.display().to_string(), &table::read_text(which, path)?)?;
            (inputs, CaseValues::Table(rows))
        }
        CaseSource::Ranges(ranges) => of_ranges(job, which, ranges)?,
        CaseSource::Scatter { settings, count, seed, sobol } => {
            let (known, about) = of_scatter(job, settings, *sobol)?;
            different(known.iter().map(|known| &known.input))?;
            within_ranges(&known, &about, (*seed, *count, *sobol), monitor)?;
            let inputs = known.into_iter().map(|known| known.input).collect();
            (inputs, CaseValues::Scatter { about, count: *count, seed: *seed, sobol: *sobol })
        }
    };
    different(inputs.iter())?;
    match values.count() {
        0 => Err(Failure::Input("the study has no case".to_string())),
        1..=MOST_CASES => Ok((inputs, values)),
        count => Err(Failure::Request(format!("{count} cases are more than {MOST_CASES}: take fewer"))),
    }
}

/// # Errors
/// If an input is there twice.
fn different<'i>(inputs: impl Iterator<Item = &'i StudyInput>) -> Result<(), Failure> {
    let names: Vec<&String> = inputs.map(|input| &input.name).collect();
    match names.iter().enumerate().find(|(k, name)| names[..*k].contains(name)) {
        Some((_, name)) => Err(Failure::Request(format!("`{name}` differs from case to case twice: leave one out"))),
        None => Ok(()),
    }
}

/// Looks at all values that will be drawn, without computing a case; of very many only until some are found that lie beyond.
///
/// # Errors
/// How many lie beyond the range of their input, or that the work is cancelled.
fn within_ranges(
    known: &[KnownInput],
    about: &About,
    (seed, count, sobol): (u64, u64, bool),
    monitor: &dyn Monitor,
) -> Result<(), Failure> {
    let mut wrong = Vec::new();
    for (k, (input, about)) in known.iter().zip(about).enumerate() {
        let (value, reach, is_normal) = *about;
        let most = reach * if is_normal { FARTHEST } else { 1.0 };
        if ![value - most, value + most].iter().any(|end| input.is_beyond(*end)) {
            continue;
        }
        let draw = |case: u64| drawn(*about, (seed, case, sobol), (k, &input.input.name));
        for first in (0..count).step_by(TOGETHER as usize) {
            crate::project::session::check(monitor)?;
            let looked_at = count.min(first + TOGETHER);
            let beyond: Vec<u64> =
                (first..looked_at).into_par_iter().filter(|case| input.is_beyond(draw(*case))).collect();
            if let Some(case) = beyond.first() {
                let first = (*case, draw(*case));
                wrong.push(told_beyond(input, about, first, (beyond.len(), looked_at, count)).to_string());
                break;
            }
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(Failure::Input(wrong.join("\n"))) }
}

/// What is said of values beyond a range: how many, the first of them by its case, and how far a value may scatter.
fn told_beyond(
    input: &KnownInput,
    (about, ..): &(f64, f64, bool),
    (case, value): (u64, f64),
    (beyond, looked_at, count): (usize, u64, u64),
) -> Unfit {
    let (name, unit) = (&input.input.name, &input.input.unit);
    let all = if looked_at == count { format!("{count} cases") } else { format!("the first {looked_at} cases") };
    let room = input.range.map_or(0.0, |(low, high)| {
        let about = about * input.size();
        (about - low).min(high - about)
    });
    let way_out = match units::as_given(input.dimension, room) {
        room_is if room > 0.0 => format!("scatter it by less; uniform({room_is}) stays within"),
        _ => "its value lies at an end of the range".to_string(),
    };
    let message = format!(
        "option `scatter {name}`: {beyond} of {all} lie outside its range {}, the first is case {case} with {}: {way_out}",
        input.shown_range(),
        text(value, unit)
    );
    Unfit::new(Code::OutOfRange, message)
}

fn of_ranges(
    job: &Job<'_>,
    which: &JobSelection,
    ranges: &[VariedRange],
) -> Result<(Vec<StudyInput>, CaseValues), Failure> {
    let mut inputs = Vec::new();
    let mut ends = Vec::new();
    for VariedRange { name, ends: texts, count } in ranges {
        let known = KnownInput::named(job, name)?;
        let mut values = [0.0; 2];
        for (value, text) in values.iter_mut().zip(texts) {
            *value = end_of_range(which, &job.name, &known, text)?;
        }
        if let Some(why) = values.iter().find_map(|value| known.refused(*value)) {
            return Err(Failure::Input(format!("option `vary {name}`: {why}")));
        }
        let [low, high] = values;
        if known.is_count && *count > 1 && (high - low) % f64::from(count - 1) != 0.0 {
            let message =
                format!("option `vary {name}`: {count} values from {low} to {high} are not all whole numbers");
            return Err(Failure::Request(message));
        }
        ends.push((low, high, *count));
        inputs.push(known.input);
    }
    Ok((inputs, CaseValues::Ranges(ends)))
}

/// The first or last value of an input, in its unit.
///
/// # Errors
/// If it is none that the input may have. A text that goes wrong with it otherwise is a matter of the cases.
fn end_of_range(which: &JobSelection, job: &str, known: &KnownInput, text: &str) -> Result<f64, Failure> {
    let name = &known.input.name;
    let lone = || {
        let value = flank_chain_dsl::lone_value(text, known.dimension)?;
        Some(plain(units::shown(known.dimension, value), &known.input.unit))
    };
    if known.input.is_axis {
        let unit = &known.input.unit;
        let message =
            || format!("option `vary {name}`: `{text}` is no value of it: write a number with its unit, as 0.1 {unit}");
        return lone().ok_or_else(|| Unfit::new(Code::WrongDimension, message()).into());
    }
    let mut set: Vec<(String, String)> = which.set.iter().filter(|(other, _)| other != name).cloned().collect();
    set.push((name.clone(), text.to_string()));
    match which.project.job(job, &set) {
        Ok(job) => {
            let found = job.parameters().iter().find(|of| of.name == *name);
            Ok(found.map_or(f64::NAN, |of| plain(of.value, &of.unit)))
        }
        Err(Failure::Findings(findings)) => {
            let allowed = lone().filter(|value| known.refused(*value).is_none());
            allowed.ok_or(Failure::Findings(findings))
        }
        Err(other) => Err(other),
    }
}

/// A value in its unit without the noise of a conversion to degrees: 19, not 18.999999999999996.
fn plain(value: f64, unit: &str) -> f64 {
    if unit == "deg" { flank_export::degrees(value.to_radians()) } else { value }
}

type About = Vec<(f64, f64, bool)>;

fn of_scatter(
    job: &Job<'_>,
    settings: &[(String, Distribution)],
    is_sobol: bool,
) -> Result<(Vec<KnownInput>, About), Failure> {
    if is_sobol && settings.len() > MOST_SOBOL {
        let message =
            format!("option `sobol`: at most {MOST_SOBOL} settings scatter by it, {} are named", settings.len());
        return Err(Failure::Request(message));
    }
    let mut all = Vec::new();
    let mut about = Vec::new();
    for (name, distribution) in settings {
        let known = KnownInput::named(job, name)?;
        let reach = known.amount(*distribution)?;
        about.push((
            plain(units::shown(known.dimension, known.value), &known.input.unit),
            reach,
            matches!(distribution, Distribution::Normal(_)),
        ));
        all.push(known);
    }
    Ok((all, about))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_gone_through_with_the_first_slowest() {
        let values = CaseValues::Ranges(vec![(0.0, 1.0, 3), (10.0, 20.0, 2)]);
        let all: Vec<Vec<f64>> = (0..values.count()).map(|number| values.of_case(number, &[])).collect();
        let known = [[0.0, 10.0], [0.0, 20.0], [0.5, 10.0], [0.5, 20.0], [1.0, 10.0], [1.0, 20.0]];
        assert_eq!(all, known);
    }
}
