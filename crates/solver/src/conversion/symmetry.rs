//! Rigid motions that leave a tool's surface unchanged: it slides along itself.

use faer::Mat;
use faer::linalg::solvers::{Solve, Svd};
use flank_expr::geometry::{Axis, Chain, Step, Surface, Twist, Vector3};
use flank_expr::{Expr, Graph, ScalarEvaluator, Tape, TapeError};
use nalgebra::Vector3 as Vector;

use crate::equations::solution::Range;

/// Points of each surface in each direction at which its normal is looked at.
const POINTS: usize = 9;
/// A motion whose speed along all normals is below this share of the largest possible is none that the surface sees.
const UNSEEN: f64 = 1e-9;
/// What is left of a component by rounding.
const ROUNDING: f64 = 1e-10;
/// An axis moves the tool along its symmetries if they leave no more than this share of its twist: both are known to 1e-12 or better, and
/// the normal equations of symmetries that are far apart keep that.
const ALONG: f64 = 1e-9;

/// A one-parameter rigid motion, by its velocity at the start: `ω × r + v`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screw {
    /// ω: of length one, or zero for a translation.
    pub angular: [f64; 3],
    /// v, the velocity of the frame's origin, mm per radian; of length one (mm) for a translation.
    pub linear: [f64; 3],
}

impl Screw {
    /// The motion by an amount (radians, or mm of a translation) as steps from the frame before it to the one after it.
    pub fn steps<'g>(&self, graph: &'g Graph, amount: Expr<'g>) -> Vec<Step<'g>> {
        let vector = |components| Vector3::constant(graph, components);
        if self.angular == [0.0; 3] {
            return vec![Step::Translate(vector(self.linear).scaled(amount))];
        }
        // about the line through the point ω × v, rising by ω · v
        let (angular, linear) = (Vector::from(self.angular), Vector::from(self.linear));
        let (through, rise) = (angular.cross(&linear).into(), angular.dot(&linear));
        vec![
            Step::Translate(vector(through)),
            Step::Rotate(Axis::Along(vector(self.angular)), amount),
            Step::Translate(vector(self.angular).scaled(rise * amount) - vector(through)),
        ]
    }
}

/// All rigid motions along which every one of the surfaces slides along itself, as a basis: a surface of revolution has one, a
/// cylinder two, a sphere or a plane three, most have none.
///
/// They are the null space of `n · (ω × r + v)` over points of the surfaces, so nothing has to be declared.
///
/// # Errors
/// If a surface depends on a variable that is not among its unknowns.
///
/// # Panics
/// If a surface is not one of two free unknowns with a range each.
pub fn symmetries(surfaces: &[(&Surface<'_>, Vec<Range>)]) -> Result<Vec<Screw>, TapeError> {
    let mut rows: Vec<[f64; 6]> = Vec::new();
    let mut size = f64::MIN_POSITIVE;
    for (surface, ranges) in surfaces {
        assert_eq!((surface.unknowns.len(), ranges.len()), (2, 2), "two free unknowns");
        let outputs: Vec<Expr<'_>> = surface.position.0.into_iter().chain(surface.normal.0).collect();
        let tape = Tape::new(&outputs, &surface.unknowns)?;
        let mut evaluator = ScalarEvaluator::new(&tape);
        let mut out = [0.0; 6];
        for k in 0..POINTS * POINTS {
            let at = [k / POINTS, k % POINTS].map(|k| (k as f64 + 0.5) / POINTS as f64);
            evaluator.run(&[ranges[0].at(at[0]), ranges[1].at(at[1])], &mut out);
            let (r, n) = (Vector::new(out[0], out[1], out[2]), Vector::new(out[3], out[4], out[5]));
            if out.iter().all(|x| x.is_finite()) {
                let moment = r.cross(&n);
                size = size.max(r.norm());
                rows.push([moment.x, moment.y, moment.z, n.x, n.y, n.z]);
            }
        }
    }
    Ok(unseen(&rows, size))
}

/// Basis of the motions that no row sees, reduced so that rotations come first and each has as few components as can be; none where
/// there are no rows: nothing shows then that a motion leaves it unchanged. Angular speeds count by the `size` of the surface, so that both kinds of
/// motion are of one order.
fn unseen(rows: &[[f64; 6]], size: f64) -> Vec<Screw> {
    if rows.is_empty() {
        return Vec::new();
    }
    let scaled = Mat::from_fn(rows.len().max(6), 6, |i, j| {
        rows.get(i).map_or(0.0, |row| if j < 3 { row[j] / size } else { row[j] })
    });
    // without the directions of rows, of which the whole square would be as wide as there are rows
    let Ok(svd) = Svd::new_thin(scaled.as_ref()) else { return Vec::new() };
    let (values, vectors) = (svd.S(), svd.V());
    let mut basis: Vec<[f64; 6]> =
        (0..6).filter(|&k| values[k] <= UNSEEN * values[0]).map(|k| std::array::from_fn(|j| vectors[(j, k)])).collect();
    reduce(&mut basis);
    basis.into_iter().map(|motion| screw(motion, size)).collect()
}

/// Gauss and Jordan, pivots among the rotations first.
fn reduce(basis: &mut [[f64; 6]]) {
    let mut row = 0;
    for column in [2, 1, 0, 5, 4, 3] {
        let size = |k: usize, basis: &[[f64; 6]]| basis[k][column].abs();
        let Some(pivot) = (row..basis.len()).max_by(|&a, &b| size(a, basis).total_cmp(&size(b, basis))) else { return };
        if size(pivot, basis) <= ROUNDING {
            continue;
        }
        basis.swap(row, pivot);
        let scale = basis[row][column];
        basis[row].iter_mut().for_each(|x| *x /= scale);
        let leading = basis[row];
        for (_, other) in basis.iter_mut().enumerate().filter(|(k, _)| *k != row) {
            let factor = other[column];
            other.iter_mut().zip(leading).for_each(|(x, by)| *x -= factor * by);
        }
        row += 1;
    }
}

/// A motion whose angular speeds count by `size`, without what rounding left in it.
fn screw(motion: [f64; 6], size: f64) -> Screw {
    let motion = motion.map(|x| if x.abs() <= ROUNDING { 0.0 } else { x });
    let angular = Vector::new(motion[0], motion[1], motion[2]) / size;
    let linear = Vector::new(motion[3], motion[4], motion[5]);
    let speed = if angular.norm() > 0.0 { angular.norm() } else { linear.norm() };
    Screw { angular: (angular / speed).into(), linear: (linear / speed).into() }
}

/// Steps by which a tool slides along itself, and by how much along each of its symmetries.
pub(crate) fn slipping<'g>(graph: &'g Graph, slips: &[Screw]) -> (Vec<Step<'g>>, Vec<Expr<'g>>) {
    let amounts: Vec<Expr<'g>> = (1..=slips.len()).map(|k| graph.variable(format!("slip_{k}"))).collect();
    let slipped = slips.iter().zip(&amounts).flat_map(|(slip, by)| slip.steps(graph, *by)).collect();
    (slipped, amounts)
}

/// A symmetry that an axis of the target does by itself, wherever the others and the settings stand.
pub(crate) fn doubled<'g>(
    target: &Chain<'g>,
    axes: &[Expr<'g>],
    settings: &[Expr<'g>],
    slips: &[Screw],
) -> Result<Option<usize>, TapeError> {
    let inputs: Vec<Expr<'g>> = axes.iter().chain(settings).copied().collect();
    for axis in axes {
        if let Some(shares) = along(target, *axis, &inputs, slips)? {
            return Ok((0..slips.len()).max_by(|&a, &b| shares[a].abs().total_cmp(&shares[b].abs())));
        }
    }
    Ok(None)
}

/// The motion of the tool that an axis makes, if it leaves the tool unchanged, wherever the other axes stand; and how much of it per mm
/// or radian of the axis.
///
/// # Errors
/// If something depends on a variable that is not given.
pub fn unseen_motion<'g>(
    target: &Chain<'g>,
    axis: Expr<'g>,
    axes: &[Expr<'g>],
    symmetries: &[Screw],
) -> Result<Option<(Screw, f64)>, TapeError> {
    let shares = along(target, axis, axes, symmetries)?;
    Ok(shares.map(|shares| {
        let sum = |of: fn(&Screw) -> [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|k| symmetries.iter().zip(&shares).map(|(screw, share)| share * of(screw)[k]).sum())
        };
        let (angular, linear) = (sum(|screw| screw.angular), sum(|screw| screw.linear));
        let size = |of: [f64; 3]| of.iter().map(|x| x * x).sum::<f64>().sqrt();
        let pace = if size(angular) > 0.0 { size(angular) } else { size(linear) };
        (Screw { angular: angular.map(|x| x / pace), linear: linear.map(|x| x / pace) }, pace)
    }))
}

/// The shares of the symmetries in what an axis does to the tool, if it does nothing else.
fn along<'g>(
    target: &Chain<'g>,
    axis: Expr<'g>,
    inputs: &[Expr<'g>],
    slips: &[Screw],
) -> Result<Option<Vec<f64>>, TapeError> {
    if slips.is_empty() {
        return Ok(None);
    }
    let numbers: Vec<f64> = (0..inputs.len()).map(|k| 0.3 + 0.41 * k as f64).collect();
    let Twist { angular, linear } = target.twist(axis);
    let twist: Vec<Expr<'g>> = angular.0.into_iter().chain(linear.0).collect();
    let mut out = [0.0; 6];
    ScalarEvaluator::new(&Tape::new(&twist, inputs)?).run(&numbers, &mut out);
    // velocities by the largest of them, so that they count as turns do
    let velocities = slips.iter().flat_map(|slip| slip.linear).chain(out[3..].iter().copied());
    let fastest = velocities.map(f64::abs).filter(|v| *v > 0.0).reduce(f64::max).unwrap_or(1.0);
    let of = Mat::from_fn(6, 1, |i, _| if i < 3 { out[i] } else { out[i] / fastest });
    let entry = |i: usize, j: usize| if i < 3 { slips[j].angular[i] } else { slips[j].linear[i - 3] / fastest };
    let basis = Mat::from_fn(6, slips.len(), entry);
    let shares = (basis.transpose() * &basis).partial_piv_lu().solve(basis.transpose() * &of);
    let left = &of - &basis * &shares;
    let is_along = of.norm_l2() > 0.0 && left.norm_l2() <= ALONG * of.norm_l2();
    Ok(is_along.then(|| (0..slips.len()).map(|k| shares[(k, 0)]).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sphere, whose normals all go through its middle, is unchanged by a turn about it; what is no number anywhere shows nothing.
    #[test]
    fn where_nothing_is_looked_at_nothing_is_unseen() {
        let graph = Graph::new();
        let (u, v) = (graph.variable("u"), graph.variable("v"));
        let of = |radius: Expr<'_>| {
            let position = Vector3([radius * u.cos() * v.cos(), radius * u.sin() * v.cos(), radius * v.sin()]);
            let ranges = vec![Range { low: -1.0, high: 1.0 }; 2];
            symmetries(&[(&Surface::parametric([u, v], position, false), ranges)]).expect("bound").len()
        };
        assert_eq!(of(graph.constant(20.0)), 3);
        assert_eq!(of((u - 5.0).sqrt()), 0);
    }
}
