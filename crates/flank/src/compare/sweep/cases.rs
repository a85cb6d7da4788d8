//! The values of the inputs in each case.

use flank_chain_dsl::Job;
use serde::{Deserialize, Serialize};

use super::drawn::{MOST_SOBOL, independent, normal, sobol};
use super::inputs::{KnownInput, StudyInput, size_of_unit};
use super::request::{CaseSource, Distribution, VariedRange};
use crate::project::failure::Failure;
use crate::project::requests::JobSelection;
use crate::project::units;

/// Cases of a study at the most.
const MOST_CASES: u64 = 100_000_000;
/// What is wrong in a table is listed up to so many.
const LISTED: usize = 20;
/// Bytes of a table.
pub(super) const MOST_BYTES: usize = 1 << 30;

/// How the values of a case follow from its number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum CaseValues {
    /// One row for each.
    Table(Vec<Vec<f64>>),
    /// First and last value of each input, and how many; the first changes slowest.
    Ranges(Vec<(f64, f64, u32)>),
    /// Value of the spec, how far it scatters, and whether by a normal distribution.
    Scatter { about: Vec<(f64, f64, bool)>, count: u64, seed: u64, sobol: bool },
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
            CaseValues::Scatter { about, seed, sobol: is_sobol, .. } => {
                let drawn = about.iter().zip(inputs).enumerate().map(|(k, ((value, reach, is_normal), input))| {
                    let share = match is_sobol {
                        true => sobol(*seed, number, (k, &input.name)),
                        false => independent(*seed, number, &input.name),
                    };
                    value + reach * if *is_normal { normal(share) } else { 2.0 * share - 1.0 }
                });
                drawn.collect()
            }
        }
    }
}

/// Inputs and cases of a request; `table` is the text of its table, if it has one.
///
/// # Errors
/// Unknown names, missing units, values outside their ranges: of the whole table.
pub(super) fn read(
    job: &Job<'_>,
    which: &JobSelection,
    source: &CaseSource,
    table: Option<&str>,
) -> Result<(Vec<StudyInput>, CaseValues), Failure> {
    let (inputs, values) = match source {
        CaseSource::Table(path) => of_table(job, &path.display().to_string(), table.unwrap_or_default())?,
        CaseSource::Ranges(ranges) => of_ranges(job, which, ranges)?,
        CaseSource::Scatter { settings, count, seed, sobol } => {
            let (inputs, about) = of_scatter(job, settings, *sobol)?;
            (inputs, CaseValues::Scatter { about, count: *count, seed: *seed, sobol: *sobol })
        }
    };
    if let Some((_, input)) = inputs.iter().enumerate().find(|(k, of)| inputs[..*k].iter().any(|o| o.name == of.name)) {
        return Err(Failure::Request(format!("`{}` differs from case to case twice: leave one out", input.name)));
    }
    match values.count() {
        0 => Err(Failure::Input("the study has no case".to_string())),
        1..=MOST_CASES => Ok((inputs, values)),
        count => Err(Failure::Request(format!("{count} cases are more than {MOST_CASES}: take fewer"))),
    }
}

fn of_table(job: &Job<'_>, file: &str, text: &str) -> Result<(Vec<StudyInput>, CaseValues), Failure> {
    let mut wrong = Vec::new();
    let lines = text.lines().enumerate().map(|(k, line)| (k + 1, line.trim()));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let heads = lines.next().map_or(Vec::new(), |(_, line)| line.split(',').map(head).collect());
    let mut columns: Vec<KnownInput> = Vec::new();
    for (name, unit) in &heads {
        match column(job, name, *unit) {
            Ok(column) => columns.push(column),
            Err(Failure::Input(reason)) => wrong.push(format!("{file}:1: {reason}")),
            Err(other) => return Err(other),
        }
    }
    let mut rows = Vec::new();
    for (number, line) in lines.take_while(|_| columns.len() == heads.len()) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if cells.len() != columns.len() {
            let [values, heads] =
                [(cells.len(), "value"), (columns.len(), "column")].map(|(n, of)| units::counted(n, of));
            wrong.push(format!("{file}:{number}: {values} in {heads}"));
            continue;
        }
        let row: Vec<Option<f64>> = cells.iter().map(|cell| cell.parse().ok()).collect();
        for ((cell, value), column) in cells.iter().zip(&row).zip(&columns) {
            let reason = match value {
                Some(value) => column.refused(*value),
                None => Some(format!("`{cell}` is no number")),
            };
            wrong.extend(reason.map(|reason| format!("{file}:{number}: {reason}")));
        }
        rows.push(row.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect());
    }
    if wrong.is_empty() {
        return Ok((columns.into_iter().map(|column| column.input).collect(), CaseValues::Table(rows)));
    }
    let more = wrong.len().saturating_sub(LISTED);
    wrong.truncate(LISTED);
    wrong.extend((more > 0).then(|| format!("and {more} more")));
    Err(Failure::Input(wrong.join("\n")))
}

/// `m.radial_distance [mm]`
fn head(text: &str) -> (String, Option<&str>) {
    match text.trim().split_once('[') {
        Some((name, rest)) => (name.trim().to_string(), Some(rest.trim_end_matches(']').trim())),
        None => (text.trim().to_string(), None),
    }
}

/// # Errors
/// That there is no such input, or that its unit is missing or another one.
fn column(job: &Job<'_>, name: &str, unit: Option<&str>) -> Result<KnownInput, Failure> {
    let known = KnownInput::named(job, name)?;
    let own = known.input.unit.clone();
    let unit = match unit {
        None if own.is_empty() => return Ok(known),
        None => return Err(Failure::Input(format!("column `{name}` has no unit: write `{name} [{own}]`"))),
        Some(unit) => unit,
    };
    let is_fitting = unit == own || size_of_unit(unit).is_some_and(|(_, dimension)| dimension == known.dimension);
    if !is_fitting {
        let wanted =
            if own.is_empty() { "it is a plain number".to_string() } else { format!("write `{name} [{own}]`") };
        return Err(Failure::Input(format!("column `{name}`: `{unit}` is no unit of it; {wanted}")));
    }
    Ok(KnownInput { input: StudyInput { unit: unit.to_string(), ..known.input }, ..known })
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
        if known.input.is_axis {
            let message = format!("option `vary {name}`: an axis of a contact is scattered, or stands in a table");
            return Err(Failure::Request(message));
        }
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
    let mut set: Vec<(String, String)> = which.set.iter().filter(|(other, _)| other != name).cloned().collect();
    set.push((name.clone(), text.to_string()));
    match which.project.job(job, &set) {
        Ok(job) => {
            let found = job.parameters().iter().find(|of| of.name == *name);
            Ok(found.map_or(f64::NAN, |of| plain(of.value, &of.unit)))
        }
        Err(Failure::Findings(findings)) => {
            let value = flank_chain_dsl::lone_value(text, known.dimension);
            let value = value.map(|value| plain(units::shown(known.dimension, value), &known.input.unit));
            let allowed = value.filter(|value| known.refused(*value).is_none());
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
) -> Result<(Vec<StudyInput>, About), Failure> {
    if is_sobol && settings.len() > MOST_SOBOL {
        let message =
            format!("option `sobol`: at most {MOST_SOBOL} settings scatter by it, {} are named", settings.len());
        return Err(Failure::Request(message));
    }
    let mut inputs = Vec::new();
    let mut about = Vec::new();
    for (name, distribution) in settings {
        let known = KnownInput::named(job, name)?;
        let reach = known.amount(*distribution)?;
        about.push((
            plain(units::shown(known.dimension, known.value), &known.input.unit),
            reach,
            matches!(distribution, Distribution::Normal(_)),
        ));
        inputs.push(known.input);
    }
    Ok((inputs, about))
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
