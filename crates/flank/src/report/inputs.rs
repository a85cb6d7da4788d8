//! What a job was given: parameters, settings and motions.

use flank_chain_dsl::{Dimension, Parameter, RangedVariable, ValueSource};
use flank_draw::{Block, Column, ReportSection};
use flank_export::fixed;

use super::Findings;
use super::result::{Input, InputSource, PassedMotion};
use crate::project::quantity::UnitSymbol;
use crate::project::units;
use crate::solve::travel;

pub(super) fn section(findings: &Findings<'_, '_>) -> ReportSection {
    let mut blocks: Vec<Block> = groups(findings).iter().flat_map(|group| blocks(findings, group)).collect();
    if blocks.is_empty() {
        blocks.push(Block::Paragraph("The job has no parameters: all its numbers stand in its text.".to_string()));
    }
    if !findings.job.motions.is_empty() {
        blocks.push(motions(findings));
    }
    ReportSection { title: "Inputs".to_string(), blocks }
}

/// Who owns a parameter: a machine or tool; nobody if the job does.
fn owner<'a>(parameter: &'a Parameter<'_>) -> Option<&'a str> {
    parameter.name.split_once('.').map(|(owner, _)| owner)
}

/// The parameters of the job, then those of its machines and tools in their order.
fn groups<'j, 'g>(findings: &Findings<'j, 'g>) -> Vec<Vec<&'j Parameter<'g>>> {
    let all = &findings.job.parameters;
    let mut owners: Vec<Option<&str>> = Vec::new();
    for parameter in all {
        if !owners.contains(&owner(parameter)) {
            owners.push(owner(parameter));
        }
    }
    owners.sort_by_key(Option::is_some);
    owners.into_iter().map(|of| all.iter().filter(|parameter| owner(parameter) == of).collect()).collect()
}

/// A table of settings and one of errors, and the names of those that are zero by default and of which there is nothing to say.
fn blocks(findings: &Findings<'_, '_>, parameters: &[&Parameter<'_>]) -> Vec<Block> {
    let (errors, parameters): (Vec<&Parameter<'_>>, Vec<&Parameter<'_>>) =
        parameters.iter().partition(|parameter| parameter.is_error);
    let owner = owner_text(findings, if parameters.is_empty() { &errors } else { &parameters });
    let caption = format!("{owner}: errors, zero in the nominal machine");
    let table = (!errors.is_empty()).then(|| table(findings, caption, &errors));
    settings(findings, owner, &parameters).into_iter().chain(table).collect()
}

fn settings(findings: &Findings<'_, '_>, owner: String, parameters: &[&Parameter<'_>]) -> Vec<Block> {
    let is_idle = |parameter: &&&Parameter<'_>| {
        let is_default = matches!(parameter.given_by, ValueSource::Definition(_));
        is_default && parameter.value == 0.0 && parameter.doc.is_empty()
    };
    let (idle, told): (Vec<&Parameter<'_>>, Vec<&Parameter<'_>>) = parameters.iter().partition(is_idle);
    let table = (!told.is_empty()).then(|| table(findings, owner, &told));
    let zero = (!idle.is_empty()).then(|| Block::Facts(by_unit(&idle)));
    table.into_iter().chain(zero).collect()
}

/// The names of parameters that are zero by default, by their unit.
fn by_unit(parameters: &[&Parameter<'_>]) -> Vec<(String, String)> {
    let mut units: Vec<String> = Vec::new();
    for parameter in parameters {
        let unit = units::whole_symbol(parameter.dimension);
        if !units.contains(&unit) {
            units.push(unit);
        }
    }
    let of_unit = |of: String| {
        let names = parameters.iter().filter(|parameter| units::whole_symbol(parameter.dimension) == of);
        let names: Vec<&str> = names.map(|parameter| parameter.name.as_str()).collect();
        (format!("0 {of} by default").replace("  ", " "), names.join(", "))
    };
    units.into_iter().map(of_unit).collect()
}

fn owner_text(findings: &Findings<'_, '_>, parameters: &[&Parameter<'_>]) -> String {
    let Some(owner) = parameters.first().and_then(|parameter| owner(parameter)) else {
        return "Job".to_string();
    };
    if let Some(machine) = findings.job.machines.iter().find(|machine| machine.name == owner) {
        return format!("Machine {owner} = {}", machine.definition);
    }
    let definition = parameters.iter().find_map(|parameter| match &parameter.given_by {
        ValueSource::Definition(name) => Some(format!(" = {name}")),
        ValueSource::Job | ValueSource::Caller => None,
    });
    format!("Tool {owner}{}", definition.unwrap_or_default())
}

fn table(findings: &Findings<'_, '_>, caption: String, parameters: &[&Parameter<'_>]) -> Block {
    let has_ranges = parameters.iter().any(|parameter| parameter.range.is_some());
    let has_docs = parameters.iter().any(|parameter| !parameter.doc.is_empty());
    let mut columns =
        vec![Column::code("name"), Column::code("as written"), Column::numbers("value"), Column::words("unit")];
    columns.extend(has_ranges.then(|| Column::numbers("allowed")));
    columns.push(Column::words("given by"));
    columns.extend(has_docs.then(|| Column::sentences("meaning")));
    let row = |parameter: &&Parameter<'_>| {
        let range = parameter.range.map_or(String::new(), |(low, high)| {
            format!("{} .. {}", number(parameter.dimension, low), number(parameter.dimension, high))
        });
        let mut cells = vec![
            parameter.name.clone(),
            written(findings, parameter),
            number(parameter.dimension, parameter.value),
            units::whole_symbol(parameter.dimension),
        ];
        cells.extend(has_ranges.then_some(range));
        let giver = match parameter.given_by {
            ValueSource::Definition(_) => "default",
            ValueSource::Job => "job",
            ValueSource::Caller => "option `set`",
        };
        cells.push(findings.spelled(giver));
        cells.extend(has_docs.then(|| joined(&parameter.doc)));
        cells
    };
    Block::Table(caption, columns, parameters.iter().map(row).collect())
}

fn motions(findings: &Findings<'_, '_>) -> Block {
    let reached = travel::reached(findings.job, findings.solved());
    let row = |motion: &RangedVariable<'_>| {
        let found = reached.iter().find(|(variable, _)| *variable == motion.variable).map(|(_, range)| range);
        let show = |x: f64| number(motion.dimension, x);
        let needed = found.map_or("\u{2013}".to_string(), |range| {
            let [low, high] = [range.low, range.high].map(|end| units::digits(motion.dimension, end, 4));
            format!("{low} .. {high}")
        });
        let unit = if motion.is_count { "whole numbers".to_string() } else { units::whole_symbol(motion.dimension) };
        vec![motion.name.clone(), format!("{} .. {}", show(motion.low), show(motion.high)), needed, unit]
    };
    let columns = vec![
        Column::code("motion"),
        Column::numbers("range"),
        Column::numbers("passed over by the solved points"),
        Column::words("unit"),
    ];
    Block::Table("Motions".to_string(), columns, findings.job.motions.iter().map(row).collect())
}

/// A value's text in the spec, on one line.
fn written(findings: &Findings<'_, '_>, parameter: &Parameter<'_>) -> String {
    let text = findings.sources.text(parameter.written);
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn joined(doc: &[String]) -> String {
    doc.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ")
}

/// Six digits behind the point, without zeros at the end; what is small has a power of ten.
fn number(dimension: Dimension, value: f64) -> String {
    let shown = units::shown(dimension, value);
    let (digits, power) = if shown != 0.0 && shown.abs() < 1e-3 {
        let text = format!("{shown:.5e}");
        text.split_once('e')
            .map_or((text.clone(), String::new()), |(digits, power)| (digits.to_string(), format!("e{power}")))
    } else {
        (fixed(shown, 6), String::new())
    };
    format!("{}{power}", digits.trim_end_matches('0').trim_end_matches('.'))
}

pub(super) fn told(findings: &Findings<'_, '_>) -> Vec<Input> {
    let entry = |parameter: &Parameter<'_>| {
        let (low, high) = parameter.range.unzip();
        let shown = |value: f64| units::shown(parameter.dimension, value);
        let (given_by, definition) = match &parameter.given_by {
            ValueSource::Definition(name) => (InputSource::Definition, Some(name.clone())),
            ValueSource::Job => (InputSource::Job, None),
            ValueSource::Caller => (InputSource::Caller, None),
        };
        Input {
            name: parameter.name.clone(),
            written: written(findings, parameter),
            value: shown(parameter.value),
            unit: units::whole_symbol(parameter.dimension),
            low: low.map(shown),
            high: high.map(shown),
            is_count: parameter.is_count,
            is_error: parameter.is_error,
            given_by,
            definition,
            meaning: joined(&parameter.doc),
        }
    };
    findings.job.parameters.iter().map(entry).collect()
}

pub(super) fn motions_told(findings: &Findings<'_, '_>) -> Vec<PassedMotion> {
    let reached = travel::reached(findings.job, findings.solved());
    let entry = |motion: &RangedVariable<'_>| {
        let found = reached.iter().find(|(variable, _)| *variable == motion.variable).map(|(_, range)| range);
        let shown = |value: f64| units::shown(motion.dimension, value);
        PassedMotion {
            name: motion.name.clone(),
            unit: UnitSymbol::of_dimension(motion.dimension),
            is_count: motion.is_count,
            low: shown(motion.low),
            high: shown(motion.high),
            passed_low: found.map(|range| shown(range.low)),
            passed_high: found.map(|range| shown(range.high)),
        }
    };
    findings.job.motions.iter().map(entry).collect()
}
