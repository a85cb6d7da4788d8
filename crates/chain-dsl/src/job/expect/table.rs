//! Points of a table that a surface is compared with: `table("reference.csv", z, rho, x, y)`, of one surface in a table of several
//! `table("reference.csv", "concave", z, rho, x, y)`.

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Name;
use crate::limits;
use crate::model::GeneratedSurface;
use crate::syntax::ast::{Argument, Call, ExpressionKind};
use crate::values::context::Context;
use crate::values::dimension::Dimension;
use crate::values::table_files::{self, Reason};

use super::model::PointColumn;
use super::{known_of_points, wrong};

const EXAMPLE: &str = "for example `table(\"reference.csv\", z, rho, x, y)`, or with the heads of its columns `table(\"reference.csv\", z, rho: R, x: X)`";

type Read<'g> = (Vec<PointColumn<'g>>, Vec<Vec<f64>>, Dimension);

/// Columns, rows, and the dimension of what is compared.
pub(super) fn read<'g>(context: &mut Context<'g>, call: &Call, surface: &GeneratedSurface<'g>) -> Option<Read<'g>> {
    let [Argument { name: None, value: path }, arguments @ ..] = call.arguments.as_slice() else {
        return shape(context, call);
    };
    let ExpressionKind::Text(named) = &path.kind else { return shape(context, call) };
    let (mut columns, mut heads, mut texts) = (Vec::new(), Vec::new(), Vec::new());
    for argument in arguments {
        let (key, head) = match (&argument.name, &argument.value.kind) {
            (None, ExpressionKind::Path(path)) => (Name { node: path.joined(), span: path.span }, path.joined()),
            (Some(name), ExpressionKind::Path(path)) => (name.clone(), path.joined()),
            (Some(name), ExpressionKind::Text(text)) => (name.clone(), text.clone()),
            // of several surfaces in one table, the rows of one
            (None, ExpressionKind::Text(text)) => {
                texts.push(("surface", text.as_str()));
                continue;
            }
            _ => return shape(context, call),
        };
        let (column, dimension) = column(context, &key, surface)?;
        columns.push((column, dimension));
        heads.push((head, dimension));
    }
    let [_, _, compared, others @ ..] = columns.as_slice() else { return shape(context, call) };
    let dimension = compared.1;
    if let Some(k) = others.iter().position(|(_, other)| *other != dimension) {
        let message = format!("one tolerance is for {dimension}, and `{}` is {}", heads[3 + k].0, others[k].1);
        wrong(context, call.span, message, "write one `expect` for each dimension");
        return None;
    }
    let paths = match context.tables.locate(named, path.span.file) {
        Ok(paths) => paths,
        Err((code, message)) => {
            context.report(Diagnostic::new(code, path.span, message));
            return None;
        }
    };
    let asked: Vec<(&str, Dimension)> = heads.iter().map(|(head, dimension)| (head.as_str(), *dimension)).collect();
    let found = context.tables.text(&paths).and_then(|text| table_files::numbers(&text, &asked, &texts));
    let rows = found.and_then(|rows| match rows.len() {
        0 => Err(Reason::Wrong(Code::WrongTable, "the table has no points".to_string())),
        many if many > limits::SAMPLE_POINTS.most => Err(Reason::Exceeded(limits::SAMPLE_POINTS)),
        _ => Ok(rows),
    });
    match rows {
        Ok(rows) => Some((columns.into_iter().map(|(column, _)| column).collect(), rows, dimension)),
        Err(reason) => {
            context.report(reason.told(path.span, named));
            None
        }
    }
}

fn column<'g>(
    context: &mut Context<'g>,
    key: &Name,
    surface: &GeneratedSurface<'g>,
) -> Option<(PointColumn<'g>, Dimension)> {
    let beside = known_of_points(surface);
    if let Some((name, dimension)) = beside.iter().find(|(name, _)| *name == key.node) {
        return Some((PointColumn::Known(name, *dimension), *dimension));
    }
    let Some(found) = surface.coordinate(&key.node) else {
        let known = surface.coordinates();
        let known = known.iter().map(|coordinate| coordinate.name.as_str()).chain(beside.iter().map(|(name, _)| *name));
        context.unknown(key, "coordinate of points", known);
        return None;
    };
    let dimension = found.dimension;
    Some((PointColumn::Coordinate(found), dimension))
}

fn shape<T>(context: &mut Context<'_>, call: &Call) -> Option<T> {
    let message = "`table` takes a file, two coordinates by which points are found, and those that are compared";
    context.report(Diagnostic::new(Code::WrongArguments, call.span, message).help(EXAMPLE));
    None
}
