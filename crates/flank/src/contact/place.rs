//! Places on the flanks of a contact, and units of its error.

use flank_chain_dsl::{Dimension, GeneratedSurface, SampleGrid};
use flank_solver::{ContactPoint, Outcome};

use crate::contact::pair::Members;
use crate::project::units;

/// Directions on a flank at a place, in its frame.
pub(crate) struct OnFlank {
    /// Along the rows of its sample.
    pub(crate) lengthwise: [f64; 3],
    /// In the flank, square to that, towards later rows.
    pub(crate) profilewise: [f64; 3],
}

/// Directions of the sample of a member's flank where it touches: those of its points around the nearest one.
pub(crate) fn rows_at(members: &Members<'_, '_>, member: usize, point: &ContactPoint) -> Option<OnFlank> {
    let [rows, columns] = members.surfaces[member].sample.as_ref()?.counts;
    let points = &members.points[member];
    let apart = |at: usize| {
        let off: [f64; 3] = std::array::from_fn(|k| points[at].position[k] - point.in_members[member][k]);
        dot(&off, &off)
    };
    let is_solved = |at: &usize| points[*at].outcome == Outcome::Solved;
    let near = (0..points.len()).filter(is_solved).min_by(|a, b| apart(*a).total_cmp(&apart(*b)))?;
    let (row, column) = (near / columns, near % columns);
    let between = |low: usize, high: usize| -> Option<[f64; 3]> {
        let ends = (is_solved(&low) && is_solved(&high) && low != high).then_some([low, high])?;
        let [a, b] = ends.map(|at| points[at].position);
        unit(std::array::from_fn(|k| b[k] - a[k]))
    };
    let at = |row: usize, column: usize| row * columns + column;
    let lengthwise = between(at(row, column.saturating_sub(1)), at(row, (column + 1).min(columns - 1)))?;
    let up = between(at(row.saturating_sub(1), column), at((row + 1).min(rows - 1), column))?;
    let along = dot(&up, &lengthwise);
    let profilewise = unit(std::array::from_fn(|k| up[k] - along * lengthwise[k]))?;
    Some(OnFlank { lengthwise, profilewise })
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(&v, &v).sqrt();
    (length > 0.0).then(|| v.map(|x| x / length))
}

pub(crate) fn fine(dimension: Dimension, difference: f64) -> f64 {
    difference * if units::is_angle(dimension) { 1e6 } else { 1e3 }
}

pub(crate) fn fine_unit(dimension: Dimension) -> &'static str {
    if units::is_angle(dimension) { "urad" } else { "um" }
}

pub(crate) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Steps until the shares of a point between the corners of a blank are settled.
const MOST_STEPS: usize = 30;

/// Shares from root to tip and from toe to heel at a point `[z, rho]`, where the sample of a surface is one of shares.
pub(crate) fn shares(surface: &GeneratedSurface<'_>, point: [f64; 2]) -> Option<[f64; 2]> {
    let SampleGrid::Shares { corners, .. } = surface.sample.as_ref()?.grid else { return None };
    let at = |shares: [f64; 2]| SampleGrid::Shares { shares: shares.map(|share| vec![share]), corners }.at(0, 0);
    let mut shares = [0.5, 0.5];
    for _ in 0..MOST_STEPS {
        let here = at(shares);
        let off = [0, 1].map(|k| point[k] - here[k]);
        // bilinear: differences over a whole unit are its derivatives
        let by = [[1.0, 0.0], [0.0, 1.0]].map(|step: [f64; 2]| {
            let there = at([0, 1].map(|k| shares[k] + step[k]));
            [0, 1].map(|k| there[k] - here[k])
        });
        let determinant = by[0][0] * by[1][1] - by[0][1] * by[1][0];
        let step = [
            (off[0] * by[1][1] - off[1] * by[1][0]) / determinant,
            (off[1] * by[0][0] - off[0] * by[0][1]) / determinant,
        ];
        shares = [0, 1].map(|k| shares[k] + step[k]);
        if step.iter().all(|step| step.abs() < 1e-14) {
            break;
        }
    }
    shares.iter().all(|share| share.is_finite()).then_some(shares)
}
