//! Fewer points where a job asks for more than a page should hold.

use flank_export::{Patch, Values};

/// Numbers of all surfaces together. At eleven letters a number, with the library and the functions, a page stays below 3 MB.
const MOST_NUMBERS: usize = 180_000;

/// Which rows and columns a page takes: every so many-th one, and the last. At least one, the fewest that fit.
pub(super) fn step(patches: &[Patch]) -> usize {
    let numbers = |step: usize| -> usize { patches.iter().map(|patch| kept(patch, step).len() * width(patch)).sum() };
    let most = patches.iter().map(|patch| patch.rows.count.max(patch.columns.count)).max().unwrap_or(1);
    (1..=most).find(|step| numbers(*step) <= MOST_NUMBERS).unwrap_or(most)
}

/// The points in such rows and columns, by their places.
pub(super) fn kept(patch: &Patch, step: usize) -> Vec<usize> {
    let [rows, columns] = [patch.rows.count, patch.columns.count].map(|count| taken(count, step));
    rows.iter().flat_map(|i| columns.iter().map(move |j| i * patch.columns.count + j)).collect()
}

/// A patch of these points alone.
pub(super) fn thinned(patch: &Patch, step: usize) -> Patch {
    let kept = kept(patch, step);
    let mut thin = patch.clone();
    thin.rows.count = taken(patch.rows.count, step).len();
    thin.columns.count = taken(patch.columns.count, step).len();
    thin.points = kept.iter().map(|&at| patch.points[at].clone()).collect();
    for field in &mut thin.fields {
        field.values = match &field.values {
            Values::Scalars(values) => Values::Scalars(kept.iter().map(|&at| values.at(at)).collect()),
            Values::Vectors(values) => Values::Vectors(kept.iter().map(|&at| values.at(at)).collect()),
        };
    }
    thin
}

/// The places of such lines.
pub(super) fn taken(count: usize, step: usize) -> Vec<usize> {
    (0..count).filter(|k| k % step == 0 || k + 1 == count).collect()
}

/// Numbers of one point: position, normal, residual, two targets, unknowns, fields.
fn width(patch: &Patch) -> usize {
    let of_field = |values: &Values| if matches!(values, Values::Scalars(_)) { 1 } else { 3 };
    9 + patch.unknowns.len() + patch.fields.iter().map(|field| of_field(&field.values)).sum::<usize>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_row_stays() {
        assert_eq!(taken(7, 1), [0, 1, 2, 3, 4, 5, 6]);
        assert_eq!(taken(7, 3), [0, 3, 6]);
        assert_eq!(taken(8, 3), [0, 3, 6, 7]);
        assert_eq!(taken(1, 5), [0]);
    }
}
