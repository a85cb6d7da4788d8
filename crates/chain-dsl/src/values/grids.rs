//! Surfaces through the points of a table: `grid("gear.csv", "concave", i: number, j: number, x: length, y: length, z: length)`.

use std::collections::HashMap;
use std::rc::Rc;

use flank_expr::{Curve, CurveId, Expr};

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::limits;
use crate::syntax::ast::{Argument, Call, ExpressionKind};
use crate::values::context::Context;
use crate::values::dimension::{Dimension, shown};
use crate::values::functions;
use crate::values::table_files::{self, Reason};
use crate::values::tables;
use crate::values::value::{Scope, Value};

/// Values on a rectangular grid, smooth between: a bicubic spline, twice continuously differentiable, "not a knot" at its ends.
///
/// It is written as Σᵢ φᵢ(u) Σⱼ ψⱼ(v) cᵢⱼ with the splines φᵢ, ψⱼ that are 1 at one knot and 0 at all others: curves like any other, so that it
/// differentiates, encloses and runs like any other formula.
#[derive(Debug)]
pub(crate) struct Grid {
    /// φ and ψ.
    splines: [Vec<CurveId>; 2],
    /// Of the two parameters.
    dimensions: [Dimension; 2],
    /// Of each value, with its numbers row by row.
    values: Vec<(Dimension, Vec<f64>)>,
}

/// A column that a call asks for, with its dimension.
type Column<'a> = (&'a str, Dimension);

/// The value of a call of `grid`.
pub(crate) fn grid<'g>(context: &mut Context<'g>, call: &Call) -> Value<'g> {
    read(context, call).unwrap_or(Value::Poison)
}

fn read<'g>(context: &mut Context<'g>, call: &Call) -> Option<Value<'g>> {
    let [Argument { name: None, value: path }, arguments @ ..] = call.arguments.as_slice() else {
        return tables::shape(context, "grid", call.span);
    };
    let ExpressionKind::Text(named) = &path.kind else { return tables::shape(context, "grid", path.span) };
    let (mut columns, mut texts): (Vec<Column<'_>>, Vec<(&str, &str)>) = (Vec::new(), Vec::new());
    for argument in arguments {
        match (&argument.name, &argument.value.kind) {
            // the word itself cannot be a name
            (None, ExpressionKind::Text(text)) => texts.push(("surface", text)),
            (Some(name), ExpressionKind::Text(text)) => texts.push((&name.node, text)),
            _ => {
                let (name, dimension) = tables::column(context, call, argument)?;
                columns.push((&name.node, dimension));
            }
        }
    }
    if columns.len() < 3 {
        return tables::shape(context, "grid", call.span);
    }
    let paths = match context.tables.locate(named, path.span.file) {
        Ok(paths) => paths,
        Err((code, message)) => {
            context.report(Diagnostic::new(code, path.span, message));
            return None;
        }
    };
    let key = format!("{:?} {columns:?} {texts:?}", paths[1]);
    if let Some(known) = context.tables.grids.get(&key) {
        return Some(Value::Grid(Rc::clone(known)));
    }
    let found = context.tables.text(&paths).and_then(|text| table_files::numbers(&text, &columns, &texts));
    let found =
        found.and_then(|rows| if rows.is_empty() && !texts.is_empty() { Err(no_row(&texts)) } else { Ok(rows) });
    let grid = found.and_then(|rows| arranged(&columns, rows)).map(|arranged| arranged.grid(context, &columns));
    match grid {
        Ok(grid) => {
            let grid = Rc::new(grid);
            context.tables.grids.insert(key, Rc::clone(&grid));
            Some(Value::Grid(grid))
        }
        Err(reason) => {
            context.report(reason.told(path.span, named));
            None
        }
    }
}

/// No row of the table is one of those that are asked for.
fn no_row(texts: &[(&str, &str)]) -> Reason {
    let asked: Vec<String> = texts.iter().map(|(column, text)| format!("`{text}` as `{column}`")).collect();
    Reason::Wrong(Code::WrongTable, format!("no row of it that is solved has {}", asked.join(" and ")))
}

/// Rows in the order of a grid.
struct Arranged {
    /// The values of each parameter.
    knots: [Vec<f64>; 2],
    /// The other columns of each point, row by row.
    points: Vec<Vec<f64>>,
}

/// Brings rows into the order of the first two columns, which must be all combinations of their values.
fn arranged(columns: &[Column<'_>], rows: Vec<Vec<f64>>) -> Result<Arranged, Reason> {
    let wrong = |text: String| Reason::Wrong(Code::WrongTable, text);
    let place = |[u, v]: [f64; 2]| {
        let [u, v] = [(u, columns[0]), (v, columns[1])]
            .map(|(value, (name, dimension))| format!("`{name}` = {}", shown(value, dimension)));
        format!("{u} and {v}")
    };
    let knots = [0, 1].map(|side| {
        let mut knots: Vec<f64> = rows.iter().map(|row| row[side] + 0.0).collect();
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        knots
    });
    if let Some(side) = (0..2).find(|side| knots[*side].len() < 2) {
        return Err(wrong(format!("a grid needs at least two values of `{}`", columns[side].0)));
    }
    let (count, width) = (knots[0].len() * knots[1].len(), knots[1].len());
    if count > limits::GRID_POINTS.most {
        return Err(Reason::Exceeded(limits::GRID_POINTS));
    }
    let mut points: Vec<Option<Vec<f64>>> = vec![None; count];
    for row in rows {
        let at = [0, 1].map(|side| knots[side].partition_point(|knot| *knot < row[side]));
        let point = &mut points[at[0] * width + at[1]];
        if point.is_some() {
            return Err(wrong(format!("two rows have {}", place([row[0], row[1]]))));
        }
        *point = Some(row[2..].to_vec());
    }
    if let Some(hole) = points.iter().position(Option::is_none) {
        return Err(wrong(format!(
            "the grid has a hole: no row, or none that is solved, has {}",
            place([knots[0][hole / width], knots[1][hole % width]])
        )));
    }
    let points: Vec<Vec<f64>> = points.into_iter().flatten().collect();
    let are_positions = columns.len() == 5 && columns[2..].iter().all(|column| column.1 == Dimension::LENGTH);
    if let Some(fold) = are_positions.then(|| fold(&points, width)).flatten() {
        let at = place([knots[0][fold / width], knots[1][fold % width]]);
        return Err(wrong(format!("the surface folds, or has no area, beside the point with {at}")));
    }
    Ok(Arranged { knots, points })
}

/// A point beside which the side of the surface changes, from one cell of the grid to the next.
fn fold(points: &[Vec<f64>], width: usize) -> Option<usize> {
    let normal = |row: usize, column: usize| {
        let corner = |i: usize, j: usize| &points[(row + i) * width + column + j];
        let along = |a: &[f64], b: &[f64]| [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        let (p, q) = (along(corner(0, 0), corner(1, 1)), along(corner(0, 1), corner(1, 0)));
        [q[1] * p[2] - q[2] * p[1], q[2] * p[0] - q[0] * p[2], q[0] * p[1] - q[1] * p[0]]
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let height = points.len() / width;
    (0..height - 1).flat_map(|row| (0..width - 1).map(move |column| (row, column))).find_map(|(row, column)| {
        let own = normal(row, column);
        let next = (row + 2 < height).then(|| normal(row + 1, column));
        let beside = (column + 2 < width).then(|| normal(row, column + 1));
        let is_even = dot(own, own) > 0.0 && [next, beside].into_iter().flatten().all(|other| dot(own, other) > 0.0);
        (!is_even).then_some((row + 1) * width + column + 1)
    })
}

impl Arranged {
    fn grid(self, context: &mut Context<'_>, columns: &[Column<'_>]) -> Grid {
        let splines = [0, 1].map(|side| {
            let knots = &self.knots[side];
            let unit = |own: usize| {
                let points: Vec<(f64, f64)> =
                    knots.iter().enumerate().map(|(k, knot)| (*knot, f64::from(u8::from(k == own)))).collect();
                let curve = Curve::through(format!("{}_{own}", columns[side].0), &points);
                context.graph.curve(curve.expect("knots increase and are finite"))
            };
            (0..knots.len()).map(unit).collect()
        });
        let value = |k: usize| (columns[k].1, self.points.iter().map(|point| point[k - 2]).collect());
        Grid { splines, dimensions: [columns[0].1, columns[1].1], values: (2..columns.len()).map(value).collect() }
    }
}

impl<'g> Context<'g> {
    /// The value of a grid at two parameters: a number, or a vector of as many as it has columns with values.
    pub(super) fn on_grid(&mut self, call: &Call, grid: &Grid, scope: &Scope<'g>) -> Value<'g> {
        let Some(arguments) = functions::arguments(self, call, 2, scope, |_| "it takes its two parameters".to_string())
        else {
            return Value::Poison;
        };
        let what = format!("the argument of `{}`", call.function.node);
        let at = [0, 1].map(|side| {
            let (value, written) = &arguments[side];
            self.require(value, grid.dimensions[side], written.span, &what)
        });
        let [Some(u), Some(v)] = at else { return Value::Poison };
        let points = grid.splines[0].len() * grid.splines[1].len();
        if !self.spend(points * grid.values.len(), call.span) {
            return Value::Poison;
        }
        let [rows, columns] = [(u, 0), (v, 1)].map(|(at, side)| {
            grid.splines[side].iter().map(|spline| at.on_curve(*spline, 0)).collect::<Vec<Expr<'g>>>()
        });
        let sum = |terms: Vec<Expr<'g>>| terms.into_iter().reduce(|sum, term| sum + term).expect("a grid has points");
        let value = |(dimension, numbers): &(Dimension, Vec<f64>)| {
            let row = |(numbers, row): (&[f64], &Expr<'g>)| {
                let terms = numbers.iter().zip(&columns).map(|(number, column)| *number * *column);
                *row * sum(terms.collect())
            };
            Value::Scalar(sum(numbers.chunks(columns.len()).zip(&rows).map(row).collect()), *dimension)
        };
        let mut values: Vec<Value<'g>> = grid.values.iter().map(value).collect();
        if values.len() == 1 { values.remove(0) } else { Value::Vector(values) }
    }
}

/// Grids that have been read, by what names them.
pub(crate) type Grids = HashMap<String, Rc<Grid>>;
