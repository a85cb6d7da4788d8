//! The largest and the smallest of what was found.

use flank_chain_dsl::{Dimension, RangedVariable};
use flank_draw::{Block, Column, ReportSection};
use flank_export::{Values, fixed};

use super::Findings;
use super::result::ExtremeCurvature;
use crate::project::units;
use crate::solve::solved::Solved;

/// Of curvatures, 1/mm.
const DECIMALS: usize = 6;
/// What bends less, 1/mm, is flat: within a kilometre.
const FLAT: f64 = 1e-6;

pub(super) fn section(findings: &Findings<'_, '_>) -> ReportSection {
    let blocks = vec![curvatures(findings), coordinates(findings)];
    ReportSection { title: "Extremes".to_string(), blocks }
}

/// A principal curvature, 1/mm, and the index of the point that has it.
struct Bend {
    field: &'static str,
    value: f64,
    at: usize,
}

/// The largest k1 and the smallest k2 of the solved points.
fn bends(solved: &Solved<'_, '_>) -> Vec<Bend> {
    let of = |name: &'static str, sign: f64| {
        let field = solved.fields.iter().find(|field| field.name == name)?;
        let Values::Scalars(values) = &field.values else { return None };
        let known = values.iter().enumerate().filter_map(|(at, value)| Some((at, value?)));
        let (at, value) = known.max_by(|a, b| (sign * a.1).total_cmp(&(sign * b.1)))?;
        Some(Bend { field: name, value, at })
    };
    [of("k1", 1.0), of("k2", -1.0)].into_iter().flatten().collect()
}

fn curvatures(findings: &Findings<'_, '_>) -> Block {
    let columns = vec![
        Column::words("surface"),
        Column::words("curvature"),
        Column::numbers("1/mm"),
        Column::numbers("radius, mm"),
        Column::numbers("row, column"),
        Column::numbers("rho, mm"),
        Column::numbers("z, mm"),
    ];
    let mut rows = Vec::new();
    for solved in findings.solved() {
        let mut name = solved.surface.name.clone();
        for bend in bends(solved) {
            let [x, y, z] = solved.points[bend.at].position;
            let [row, column] = solved.place(bend.at);
            let which = if bend.field == "k1" { "largest, k1" } else { "smallest, k2" };
            let mut cells = vec![
                std::mem::take(&mut name),
                which.to_string(),
                units::digits(Dimension::NUMBER, bend.value, DECIMALS),
            ];
            // where a surface is flat is nowhere in particular
            cells.extend(if bend.value.abs() < FLAT {
                ["flat", "\u{2013}", "\u{2013}", "\u{2013}"].map(str::to_string)
            } else {
                let radius = fixed(1.0 / bend.value, 4);
                let [rho, z] = [x.hypot(y), z].map(|length| units::digits(Dimension::LENGTH, length, 4));
                [radius, format!("{row}, {column}"), rho, z]
            });
            rows.push(cells);
        }
    }
    let caption = "Principal curvatures, positive where the body is convex; rows and columns count from 0, rho is the distance from the axis";
    Block::Table(caption.to_string(), columns, rows)
}

fn coordinates(findings: &Findings<'_, '_>) -> Block {
    let columns = vec![
        Column::words("surface"),
        Column::code("coordinate"),
        Column::numbers("smallest"),
        Column::numbers("largest"),
        Column::words("unit"),
        Column::numbers("looked for in"),
    ];
    let mut rows = Vec::new();
    for solved in findings.solved() {
        let mut name = solved.surface.name.clone();
        // radius and z come first
        let reached = solved.told().ranges_reached;
        let sought = [None; 2].into_iter().chain(solved.surface.unknowns.iter().map(Some));
        for (reached, sought) in reached.iter().zip(sought) {
            let Some((low, high)) = reached.ends() else { continue };
            rows.push(vec![
                std::mem::take(&mut name),
                reached.name.clone(),
                units::digits(Dimension::NUMBER, low, 4),
                units::digits(Dimension::NUMBER, high, 4),
                reached.unit.symbol().to_string(),
                sought.map_or(String::new(), range),
            ]);
        }
    }
    Block::Table("Coordinates of the solved points".to_string(), columns, rows)
}

fn range(of: &RangedVariable<'_>) -> String {
    let [low, high] = [of.low, of.high].map(|end| units::digits(of.dimension, end, 4));
    format!("{low} .. {high}")
}

/// The extreme curvatures of a surface.
pub(super) fn told(solved: &Solved<'_, '_>) -> Vec<ExtremeCurvature> {
    let entry = |bend: Bend| {
        let [i, j] = solved.place(bend.at);
        let position = solved.points[bend.at].position;
        ExtremeCurvature { name: bend.field, unit: "1/mm", value: bend.value, i, j, position }
    };
    bends(solved).into_iter().map(entry).collect()
}
