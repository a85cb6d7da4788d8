//! What `flank solve` tells of the further fields of points.

use flank_export::{Values, fixed};
use flank_solver::Outcome;
use serde_json::{Value, json};

use crate::solve::stream::Streamed;
use crate::solve::table::{Solved, aligned};

/// The values of one field of numbers over the solved points of a surface.
struct FieldRange<'a> {
    name: &'a str,
    unit: &'a str,
    /// The smallest and the largest.
    ends: Option<(f64, f64)>,
    /// Whether all values are whole, as those of a number of a tooth are.
    is_whole: bool,
    /// Points at which there is no value.
    undefined: usize,
}

/// Vectors have no range.
fn ranges<'a>(solved: &'a Solved<'_, '_>) -> impl Iterator<Item = FieldRange<'a>> {
    let of_all = solved.streamed.as_ref().map(Streamed::fields).filter(|fields| !fields.is_empty());
    of_all.unwrap_or(&solved.fields).iter().filter_map(move |field| {
        let Values::Scalars(values) = &field.values else { return None };
        let mut range = FieldRange { name: &field.name, unit: &field.unit, ends: None, is_whole: true, undefined: 0 };
        // a point that is not solved is not described
        let is_meant = |at: &usize| of_all.is_some() || solved.points[*at].outcome == Outcome::Solved;
        let mut known = 0;
        for x in (0..values.len()).filter(is_meant).filter_map(|at| values.at(at)) {
            known += 1;
            range.ends = Some(range.ends.map_or((x, x), |(low, high)| (low.min(x), high.max(x))));
            range.is_whole &= x.fract() == 0.0;
        }
        range.undefined = match of_all {
            Some(_) => solved.summary.solved() - known,
            None => solved.points.iter().filter(|point| point.outcome == Outcome::Solved).count() - known,
        };
        Some(range)
    })
}

/// A line for each field of each surface; empty if there is none.
pub(crate) fn text(solved: &[Solved<'_, '_>]) -> String {
    let mut rows = Vec::new();
    for solved in solved {
        let mut name = solved.surface.name.clone();
        for range in ranges(solved) {
            let shown = |x: f64| if range.is_whole && range.unit == "1" { fixed(x, 0) } else { six_digits(x) };
            let ends = range.ends.map(|(low, high)| format!("{} .. {}", shown(low), shown(high)));
            let unit = if range.unit == "1" { "" } else { range.unit };
            let open = match range.undefined {
                0 => String::new(),
                count => format!("not defined at {count} points"),
            };
            let ends = ends.unwrap_or("-".to_string());
            rows.push([std::mem::take(&mut name), range.name.to_string(), ends, unit.to_string(), open]);
        }
    }
    if rows.is_empty() { String::new() } else { format!("\n{}", aligned(&rows, "")) }
}

pub(crate) fn json(solved: &Solved<'_, '_>) -> Value {
    let all = ranges(solved).map(|range| {
        let (low, high) = range.ends.unzip();
        json!({ "name": range.name, "unit": range.unit, "low": low, "high": high, "undefined": range.undefined })
    });
    all.collect()
}

/// Six digits behind the point; what is small, but more than rounding, is no zero.
fn six_digits(x: f64) -> String {
    if (1e-14..1e-6).contains(&x.abs()) { format!("{x:.1e}") } else { fixed(x, 6) }
}
