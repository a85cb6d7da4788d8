//! The machines of a job as they were built: frames, axes with their laws and how far they go, chains from work to tool.

use flank_chain_dsl::{Axis, Dimension, Frame, LawSource, Machine, described};
use flank_draw::{Block, Column, ReportSection};
use flank_expr::{Expr, Style};

use super::result::{AxisKind, AxisSource, BuiltAxis, BuiltFrame, BuiltMachine};
use super::{Findings, pictures};
use crate::project::choices::PlotKind;
use crate::project::quantity::{Travel, UnitSymbol};
use crate::project::units;
use crate::solve::travel::Run;

/// A law that is longer is printed with the job's numbers; letters.
const SHORT_LAW: usize = 60;
/// One that is longer even so is not printed.
const LONGEST_LAW: usize = 160;

pub(super) fn section(findings: &Findings<'_, '_>) -> ReportSection {
    let mut blocks = Vec::new();
    for machine in &findings.job.machines {
        blocks.push(Block::Heading(format!("{} = {}", machine.name, machine.definition)));
        blocks.push(frames(machine));
        blocks.push(axes(findings, machine));
    }
    blocks.push(chains(findings));
    blocks
        .extend([PlotKind::Machine, PlotKind::Motion].into_iter().filter_map(|what| pictures::figure(findings, what)));
    ReportSection { title: "Machine as built".to_string(), blocks }
}

fn frames(machine: &Machine<'_>) -> Block {
    let columns = vec![Column::code("frame"), Column::words("hangs on"), Column::code("by, from parent to child")];
    let row = |(at, depth): (usize, usize)| {
        let frame = &machine.frames[at];
        let parent = frame.parent.map_or("\u{2013}".to_string(), |at| machine.frames[at].name.clone());
        // em spaces show the tree
        vec![format!("{}{}", "\u{2003}".repeat(2 * depth), frame.name), parent, transforms(frame).join(" ")]
    };
    let caption = format!("Frames of {}; lengths in mm", machine.name);
    Block::Table(caption, columns, tree(machine).into_iter().map(row).collect())
}

/// The frames, each behind the one that it hangs on, with how many hang between it and the root.
fn tree(machine: &Machine<'_>) -> Vec<(usize, usize)> {
    let mut order = Vec::new();
    let mut open = vec![(0, 0)];
    while let Some((at, depth)) = open.pop() {
        order.push((at, depth));
        let children = machine.frames.iter().enumerate().filter(|(_, child)| child.parent == Some(at));
        open.extend(children.map(|(child, _)| (child, depth + 1)).rev());
    }
    order
}

fn transforms(frame: &Frame<'_>) -> Vec<String> {
    frame.steps.iter().map(|step| described(*step)).collect()
}

fn axes(findings: &Findings<'_, '_>, machine: &Machine<'_>) -> Block {
    let has_address = runs(findings, machine).any(|run| run.axis.word.address != run.axis.name);
    let mut columns = vec![Column::code("axis")];
    columns.extend(has_address.then(|| Column::code("in NC")));
    columns.extend([
        Column::words("kind"),
        Column::code("law"),
        Column::numbers("goes from"),
        Column::numbers("to"),
        Column::words("unit"),
        Column::numbers("travel"),
        Column::words("within"),
    ]);
    let row = |run: &Run<'_, '_>| {
        let axis = run.axis;
        let mut cells = vec![axis.name.clone()];
        cells.extend(has_address.then(|| axis.word.address.clone()));
        cells.extend([format!("{}, {}", kind(axis), source(axis)), shown_law(findings, axis)]);
        cells.extend(reach(run));
        cells
    };
    let caption =
        format!("Axes of {}, over the motions that the solved points pass over; laws in mm and rad", machine.name);
    Block::Table(caption, columns, runs(findings, machine).map(row).collect())
}

/// From where to where an axis goes, its travel, and whether that is enough.
fn reach(run: &Run<'_, '_>) -> [String; 5] {
    let axis = run.axis;
    let show = |value: f64| units::digits(axis.dimension, value, 4);
    let place = |value: Option<f64>| value.map_or("\u{2013}".to_string(), show);
    let travel = axis.travel.map_or("not stated".to_string(), |(low, high)| format!("{} .. {}", show(low), show(high)));
    let within = match run.is_beyond() {
        Some(true) => "NO",
        Some(false) => "yes",
        None => "\u{2013}",
    };
    let [from, to] = [run.over.map(|range| range.low), run.over.map(|range| range.high)].map(place);
    [from, to, units::symbol(axis.dimension).to_string(), travel, within.to_string()]
}

fn runs<'a, 'j, 'g>(findings: &'a Findings<'j, 'g>, machine: &'a Machine<'g>) -> impl Iterator<Item = &'a Run<'j, 'g>> {
    findings.runs.iter().filter(|run| run.machine() == machine.name)
}

fn kind(axis: &Axis<'_>) -> &'static str {
    if axis.dimension == Dimension::ANGLE { "rotary" } else { "linear" }
}

fn source(axis: &Axis<'_>) -> &'static str {
    match axis.source {
        LawSource::Driven => "driven",
        LawSource::Fixed => "fixed",
        LawSource::Coupled => "coupled",
        LawSource::Closed => "closed",
        LawSource::Free => "free",
    }
}

/// An expression, with the parts that it uses more than once behind it.
fn text(of: Expr<'_>) -> String {
    let listing = of.graph().listing(&[of], Style::Text, "a");
    let parts = listing.definitions.iter().map(|part| format!("{} = {}", part.name, part.value));
    let where_ = if listing.definitions.is_empty() { "" } else { " where " };
    format!("{}{where_}{}", listing.values[0], parts.collect::<Vec<_>>().join(", "))
}

/// A law in motions and the job's numbers.
fn with_values(findings: &Findings<'_, '_>, axis: &Axis<'_>) -> String {
    text(axis.law.graph().substitute(&[axis.law], &findings.job.bindings())[0])
}

/// In the parameters' names where that is short, else with their numbers.
fn shown_law(findings: &Findings<'_, '_>, axis: &Axis<'_>) -> String {
    let is_short = |law: &String, most: usize| law.chars().count() <= most;
    let named = Some(text(axis.law)).filter(|law| is_short(law, SHORT_LAW));
    let law = named.or_else(|| Some(with_values(findings, axis)).filter(|law| is_short(law, LONGEST_LAW)));
    law.unwrap_or("long: flank derive prints it".to_string())
}

fn chains(findings: &Findings<'_, '_>) -> Block {
    let mut chains: Vec<(String, Vec<&str>)> = Vec::new();
    for solved in findings.solved() {
        let path: Vec<&str> = solved.surface.generation.path.iter().map(|(frame, _)| frame.as_str()).collect();
        let path = path.join(" \u{2190} ");
        let name = solved.surface.name.as_str();
        match chains.iter_mut().find(|(other, _)| *other == path) {
            Some((_, surfaces)) => surfaces.push(name),
            None => chains.push((path, vec![name])),
        }
    }
    let columns = vec![Column::code("frames from work to tool"), Column::words("of the surfaces")];
    let rows = chains.into_iter().map(|(path, surfaces)| vec![path, surfaces.join(", ")]).collect();
    Block::Table("Chains: each frame is seen from the one on its left".to_string(), columns, rows)
}

pub(super) fn told(findings: &Findings<'_, '_>) -> Vec<BuiltMachine> {
    let machine = |machine: &Machine<'_>| {
        let frame = |frame: &Frame<'_>| BuiltFrame {
            name: frame.name.clone(),
            parent: frame.parent.map(|at| machine.frames[at].name.clone()),
            transforms: transforms(frame),
        };
        BuiltMachine {
            name: machine.name.clone(),
            definition: machine.definition.clone(),
            frames: machine.frames.iter().map(frame).collect(),
            axes: runs(findings, machine).map(|run| axis_told(findings, run)).collect(),
        }
    };
    findings.job.machines.iter().map(machine).collect()
}

fn axis_told(findings: &Findings<'_, '_>, run: &Run<'_, '_>) -> BuiltAxis {
    let axis = run.axis;
    let shown = |value: f64| units::shown(axis.dimension, value);
    BuiltAxis {
        name: axis.name.clone(),
        address: axis.word.address.clone(),
        kind: if units::is_angle(axis.dimension) { AxisKind::Rotary } else { AxisKind::Linear },
        source: match axis.source {
            LawSource::Driven => AxisSource::Driven,
            LawSource::Fixed => AxisSource::Fixed,
            LawSource::Coupled => AxisSource::Coupled,
            LawSource::Closed => AxisSource::Closed,
            LawSource::Free => AxisSource::Free,
        },
        law: text(axis.law),
        law_with_values: with_values(findings, axis),
        unit: UnitSymbol::of_dimension(axis.dimension),
        low: run.over.map(|range| shown(range.low)),
        high: run.over.map(|range| shown(range.high)),
        travel: axis.travel.map(|travel| Travel::new(axis.dimension, travel)),
        beyond: run.is_beyond(),
    }
}
