//! What the points of all patches have to show, side by side.

use crate::points::dataset::{Field, Patch, Unknown};

const FIRST: [&str; 9] = ["surface", "i", "j", "x", "y", "z", "nx", "ny", "nz"];
const LAST: [&str; 2] = ["residual", "status"];
const REASON: &str = "reason";

/// The unknowns of all patches in order of first appearance.
pub(crate) fn union_of_unknowns<'p>(patches: impl IntoIterator<Item = &'p Patch>) -> Vec<&'p Unknown> {
    let mut union: Vec<&Unknown> = Vec::new();
    for unknown in patches.into_iter().flat_map(|patch| &patch.unknowns) {
        if !union.contains(&unknown) {
            union.push(unknown);
        }
    }
    union
}

/// The fields of all patches in order of first appearance; those that share columns once.
pub(crate) fn union_of_fields<'p>(patches: impl IntoIterator<Item = &'p Patch>) -> Vec<&'p Field> {
    let mut union: Vec<&Field> = Vec::new();
    for field in patches.into_iter().flat_map(|patch| &patch.fields) {
        if !union.iter().any(|known| known.shares_columns(field)) {
            union.push(field);
        }
    }
    union
}

/// The titles of all columns; those of unknowns and fields that are not unique have the unit behind them.
pub(crate) fn titles(unknowns: &[&Unknown], told: bool, fields: &[&Field]) -> Vec<String> {
    let fixed = |names: &[&str]| names.iter().map(|&name| (name.to_owned(), None)).collect::<Vec<_>>();
    let of_unknowns = unknowns.iter().map(|unknown| (unknown.name.clone(), Some(unknown.unit.symbol())));
    let of_fields = fields.iter().flat_map(|field| field.columns().into_iter().map(|name| (name, Some(&*field.unit))));
    let all: Vec<(String, Option<&str>)> = fixed(&FIRST)
        .into_iter()
        .chain(of_unknowns)
        .chain(fixed(&LAST))
        .chain(fixed(if told { &[REASON] } else { &[] }))
        .chain(of_fields)
        .collect();
    let shared = |name: &str| all.iter().filter(|(other, _)| other == name).count() > 1;
    let title = |(name, unit): &(String, Option<&str>)| match unit {
        Some(unit) if shared(name) => format!("{name} [{unit}]"),
        _ => name.clone(),
    };
    all.iter().map(title).collect()
}
