//! Tables beside the spec: `curve("file.csv", x: length, y: length)`, and whatever else takes two columns of a file.

use std::path::PathBuf;
use std::rc::Rc;

use flank_expr::{Curve, CurveError};

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{Name, Span};
use crate::syntax::ast::{Argument, Call, Expression, ExpressionKind};
use crate::values::context::Context;
use crate::values::dimension::{self, Dimension};
use crate::values::table_files::{Key, Reason, Rows, reader, rows};
use crate::values::value::Value;

/// Two columns of a file, as a call names them: `("file.csv", x: length, y: length)`.
pub(crate) struct Columns<'a> {
    named: &'a str,
    /// Where the file is named.
    pub(crate) span: Span,
    /// Its path as the user knows it, and as it really is.
    path: [PathBuf; 2],
    /// The columns with their dimensions.
    pub(crate) columns: [(&'a Name, Dimension); 2],
}

/// The value of a call of `curve`.
pub(crate) fn curve<'g>(context: &mut Context<'g>, call: &Call) -> Value<'g> {
    columns(context, call).and_then(|table| table.curve(context)).unwrap_or(Value::Poison)
}

/// Functions that read a file.
const READERS: [&str; 3] = ["curve", "grid", "table"];

impl Context<'_> {
    /// Reads the file that an expression names which is not evaluated: it belongs to the texts all the same.
    pub(crate) fn read_table(&mut self, expression: &Expression) {
        if let ExpressionKind::Call(call) = &expression.kind
            && READERS.contains(&call.function.node.as_str())
            && let Some(Argument { name: None, value: path }) = call.arguments.first()
            && let ExpressionKind::Text(named) = &path.kind
            && let Ok(found) = self.tables.locate(named, path.span.file)
            && !self.tables.is_read(&found)
        {
            // what is wrong with it is no matter here
            let _ = self.tables.text(&found);
        }
    }
}

/// What a call that takes a table names.
pub(crate) fn columns<'a>(context: &mut Context<'_>, call: &'a Call) -> Option<Columns<'a>> {
    let function = &call.function.node;
    let [Argument { name: None, value: path }, x, y] = call.arguments.as_slice() else {
        return shape(context, function, call.span);
    };
    let ExpressionKind::Text(named) = &path.kind else { return shape(context, function, path.span) };
    let columns = [column(context, call, x)?, column(context, call, y)?];
    match context.tables.locate(named, path.span.file) {
        Ok(found) => Some(Columns { named, span: path.span, path: found, columns }),
        Err((code, message)) => {
            context.report(Diagnostic::new(code, path.span, message));
            None
        }
    }
}

impl Columns<'_> {
    fn curve<'g>(&self, context: &mut Context<'g>) -> Option<Value<'g>> {
        let [(_, x), (y_name, y)] = self.columns;
        let key = self.key();
        let id = match context.tables.curves.get(&key) {
            Some(id) => *id,
            None => {
                let points = self.rows(context)?;
                let curve = Curve::through(y_name.node.clone(), &points);
                let curve = match curve {
                    Ok(curve) => Ok(curve),
                    Err(error) => {
                        let text = context.tables.text(&self.path).unwrap_or_default();
                        Err(Reason::Wrong(Code::WrongTable, self.no_curve(error, &text)))
                    }
                };
                let curve = self.told(context, curve)?;
                let id = context.graph.curve(curve);
                context.tables.curves.insert(key, id);
                id
            }
        };
        Some(Value::Curve(id, x, y))
    }

    /// Why the rows of the text make no curve.
    fn no_curve(&self, error: CurveError, text: &str) -> String {
        let CurveError::NotIncreasing(row) = error else { return error.to_string() };
        let mut reader = reader(text);
        let line = reader.records().nth(row).and_then(Result::ok).and_then(|record| Some(record.position()?.line()));
        let place = line.map_or(format!("point {row}"), |line| format!("line {line}"));
        format!("column `{}` does not increase from the row before to {place}", self.columns[0].0.node)
    }

    fn key(&self) -> Key {
        let [(x_name, x), (y_name, y)] = self.columns;
        (self.path[1].clone(), [x_name.node.clone(), y_name.node.clone()], [x, y])
    }

    /// The numbers in them, mm and radians; a table is read once however often it is named.
    pub(crate) fn rows(&self, context: &mut Context<'_>) -> Option<Rc<Rows>> {
        let key = self.key();
        if let Some(rows) = context.tables.rows.get(&key) {
            return Some(Rc::clone(rows));
        }
        let columns = self.columns.map(|(name, dimension)| (name.node.as_str(), dimension));
        let found = context.tables.text(&self.path).and_then(|text| rows(&text, columns));
        let found = Rc::new(self.told(context, found)?);
        context.tables.rows.insert(key, Rc::clone(&found));
        Some(found)
    }

    fn told<T>(&self, context: &mut Context<'_>, found: Result<T, Reason>) -> Option<T> {
        found.map_err(|reason| context.report(reason.told(self.span, self.named))).ok()
    }
}

pub(crate) fn shape<T>(context: &mut Context<'_>, function: &str, span: Span) -> Option<T> {
    let (columns, example) = match function {
        "grid" => ("of its columns: two that count, one or more with values", "i: number, j: number, z: length"),
        _ => ("of two of its columns", "x: length, y: length"),
    };
    let message = format!("`{function}` takes a file and the names and dimensions {columns}");
    let help = format!("for example `{function}(\"points.csv\", {example})`");
    context.report(Diagnostic::new(Code::WrongArguments, span, message).help(help));
    None
}

/// `name: dimension`; the dimension is written as an expression of dimension names.
pub(crate) fn column<'a>(
    context: &mut Context<'_>,
    call: &Call,
    argument: &'a Argument,
) -> Option<(&'a Name, Dimension)> {
    let function = &call.function.node;
    let (Some(name), ExpressionKind::Path(path)) = (&argument.name, &argument.value.kind) else {
        return shape(context, function, argument.value.span);
    };
    let [written] = path.segments.as_slice() else {
        return shape(context, function, path.span);
    };
    let Some(dimension) = dimension::named(&written.node) else {
        context.unknown(written, "dimension", ["length", "angle", "number"].into_iter());
        return None;
    };
    Some((name, dimension))
}
