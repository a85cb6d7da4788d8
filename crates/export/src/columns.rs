//! What the points of all patches have to show, side by side.

use crate::dataset::{Field, Patch, Unknown};

/// The unknowns of all patches in order of first appearance.
pub(crate) fn union_of_unknowns(patches: &[Patch]) -> Vec<&Unknown> {
    let mut union: Vec<&Unknown> = Vec::new();
    for unknown in patches.iter().flat_map(|patch| &patch.unknowns) {
        if !union.contains(&unknown) {
            union.push(unknown);
        }
    }
    union
}

/// The fields of all patches in order of first appearance; those that share columns once.
pub(crate) fn union_of_fields(patches: &[Patch]) -> Vec<&Field> {
    let mut union: Vec<&Field> = Vec::new();
    for field in patches.iter().flat_map(|patch| &patch.fields) {
        if !union.iter().any(|known| known.shares_columns(field)) {
            union.push(field);
        }
    }
    union
}
