//! What `flank solve` reports of the further fields of points.

use flank_export::Values;
use flank_solver::Outcome;

use crate::solve::result::FieldExtent;
use crate::solve::solved::Solved;
use crate::solve::stream::Streamed;

/// What each field runs through; vectors have no range.
pub(crate) fn extents(solved: &Solved<'_, '_>) -> Vec<FieldExtent> {
    let of_all = solved.streamed.as_ref().map(Streamed::fields).filter(|fields| !fields.is_empty());
    let extents = of_all.unwrap_or(&solved.fields).iter().filter_map(|field| {
        let Values::Scalars(values) = &field.values else { return None };
        let (mut ends, mut is_whole): (Option<(f64, f64)>, bool) = (None, true);
        // a point that is not solved is not described
        let is_meant = |at: &usize| of_all.is_some() || solved.points[*at].outcome == Outcome::Solved;
        let mut known = 0;
        for x in (0..values.len()).filter(is_meant).filter_map(|at| values.at(at)) {
            known += 1;
            ends = Some(ends.map_or((x, x), |(low, high)| (low.min(x), high.max(x))));
            is_whole &= x.fract() == 0.0;
        }
        let undefined = match of_all {
            Some(_) => solved.summary.solved() - known,
            None => solved.points.iter().filter(|point| point.outcome == Outcome::Solved).count() - known,
        };
        let (low, high) = ends.unzip();
        Some(FieldExtent { name: field.name.clone(), unit: field.unit.clone(), low, high, undefined, is_whole })
    });
    extents.collect()
}
