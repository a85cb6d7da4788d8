//! A value from outside by itself, without the job that it is for.

use std::collections::HashMap;
use std::sync::Arc;

use flank_expr::Graph;

use crate::diagnostics::source::Sources;
use crate::load::files::Disk;
use crate::syntax::parse_expression;
use crate::values::context::Context;
use crate::values::dimension::Dimension;
use crate::values::table_files::Tables;
use crate::values::value::{Scope, Value};

/// The number that a text from outside amounts to, in mm and radians; nothing where it is wrong by itself, or of another dimension.
pub fn lone_value(text: &str, wanted: Dimension) -> Option<f64> {
    let graph = Graph::new();
    let mut sources = Sources::default();
    let file = sources.add("option `set`", text.to_string());
    let (expression, diagnostics) = parse_expression(text, file, 0);
    let mut context = Context::new(&graph, Tables::new(Arc::new(Disk), HashMap::new(), &sources));
    let value = match context.evaluate(&expression, &Scope::new()) {
        Value::Scalar(value, dimension) if wanted.accepts(dimension) => value.as_constant()?,
        _ => return None,
    };
    (diagnostics.is_empty() && !context.has_errors()).then_some(value)
}
