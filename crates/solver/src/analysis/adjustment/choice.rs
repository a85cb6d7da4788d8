//! Which settings take most of a deviation away, few of them.

use faer::linalg::solvers::Svd;
use faer::{Col, ColRef, Mat};

use crate::equations::solution::Range;
use crate::newton::least_squares::{LeastSquares, Linearized, ScaledUnknown};

/// A setting that does something of its own by less than this share of all that it does is made up by others.
const OWN: f64 = 1e-6;

/// What a setting takes of the residuals has to be so many standard deviations of their scatter.
const SHOWN: f64 = 2.0;

/// Residuals that change by less, mm, have settled.
const SETTLED: f64 = 1e-10;

/// Settings in the order in which they lower what the linear model leaves most, until the next would lower its root of the mean square by
/// less than `least`, does less than `least` of its own for its scale, or would take no more than twice `noise` of them as one number: residuals that
/// scatter by `noise` each give a setting that does nothing that much in one of twenty cases. An entry of `effects` for each setting says what it does
/// to the residuals for its scale; each of `always` is fitted first. Of two that do as much the first one is taken.
///
/// # Panics
/// If entries are not as long as the residuals.
#[must_use]
pub fn most_effective(
    residuals: &[f64],
    effects: &[Vec<f64>],
    always: &[Vec<f64>],
    least: f64,
    noise: f64,
) -> Vec<usize> {
    let root = (residuals.len().max(1) as f64).sqrt();
    let column = |of: &[f64]| Col::from_fn(residuals.len(), |row| of[row]);
    let mut left = column(residuals);
    let mut own: Vec<Col<f64>> = effects.iter().map(|of| column(of)).collect();
    let whole: Vec<f64> = own.iter().map(Col::norm_l2).collect();
    let mut taken = Vec::new();
    let mut first: Vec<Col<f64>> = always.iter().map(|of| column(of)).collect();
    loop {
        while let Some(column) = first.pop() {
            let length = column.norm_l2();
            if length == 0.0 {
                continue;
            }
            let unit = &column * (1.0 / length);
            without(&mut left, unit.as_ref());
            own.iter_mut().chain(&mut first).for_each(|of| without(of, unit.as_ref()));
        }
        let rms = left.norm_l2() / root;
        let falls = |k: usize| -> Option<f64> {
            let (length, along) = (own[k].norm_l2(), product(own[k].as_ref(), left.as_ref()));
            let is_own = length > OWN * whole[k] && length >= least * root && !taken.contains(&k);
            let is_shown = along.abs() >= SHOWN * noise * length;
            (is_own && is_shown)
                .then(|| rms - (left.squared_norm_l2() - (along / length).powi(2)).max(0.0).sqrt() / root)
        };
        let better = |best: Option<(usize, f64)>, (k, fall): (usize, f64)| match best {
            Some((_, most)) if fall <= most => best,
            _ => Some((k, fall)),
        };
        let best = (0..own.len()).filter_map(|k| Some((k, falls(k)?))).fold(None, better);
        let Some((k, _)) = best.filter(|(_, fall)| *fall >= least) else { return taken };
        taken.push(k);
        first.push(own[k].clone());
    }
}

/// Of all settings those that are left when one after the other is put aside without which the linear model leaves least, until the next would raise
/// its root of the mean square by `least`, and by more than twice `noise` as one number: what settings do together that none does by itself.
/// `resolution` as for [`linear_rest`], the others as for [`most_effective`].
///
/// # Panics
/// If entries are not as long as the residuals.
#[must_use]
pub fn least_dispensable(
    residuals: &[f64],
    (effects, always): (&[Vec<f64>], &[Vec<f64>]),
    resolution: f64,
    (least, noise): (f64, f64),
) -> Vec<usize> {
    let count = residuals.len() as f64;
    let rest = |taken: &[usize]| {
        let own = taken.iter().map(|k| effects[*k].clone()).chain(always.iter().cloned());
        linear_rest(residuals, &own.collect::<Vec<_>>(), resolution)
    };
    let mut taken: Vec<usize> = (0..effects.len()).collect();
    let mut now = rest(&taken);
    while !taken.is_empty() {
        let without = |k: &usize| taken.iter().copied().filter(|of| of != k).collect::<Vec<usize>>();
        let each = taken.iter().map(without).map(|others| (rest(&others), others));
        let Some((left, others)) = each.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        let is_shown = count * (left * left - now * now) >= (SHOWN * noise).powi(2);
        if left - now >= least && is_shown {
            break;
        }
        (taken, now) = (others, left);
    }
    taken
}

/// What the linear model leaves of residuals, root of the mean square, when settings take away as much as they can; entries of `effects`
/// as for [`most_effective`], directions as for [`LeastSquares::resolution`].
///
/// # Panics
/// If entries are not as long as the residuals.
#[must_use]
pub fn linear_rest(residuals: &[f64], effects: &[Vec<f64>], resolution: f64) -> f64 {
    let everywhere = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };
    let unknowns = vec![ScaledUnknown { start: 0.0, scale: 1.0, range: everywhere }; effects.len()];
    let fit = LeastSquares { unknowns, exact: 0, resolution, uses_weak: false, settled: SETTLED, given_up: None }
        .solve(|at| {
            let left = residuals.iter().enumerate();
            let left = left.map(|(row, off)| off + effects.iter().zip(at).map(|(of, x)| of[row] * x).sum::<f64>());
            let jacobian = Mat::from_fn(residuals.len(), effects.len(), |row, k| effects[k][row]);
            Some(Linearized { residuals: left.collect(), jacobian })
        });
    let left = fit.map_or_else(|| residuals.to_vec(), |fit| fit.residuals);
    (left.iter().map(|x| x * x).sum::<f64>() / left.len().max(1) as f64).sqrt()
}

/// Settings that together do all that any of them can, one after the other the one that does most of its own; an entry of `effects` for each
/// says what it does for its scale, `always` is done without them. What is done of its own by less than a `share` of all that a setting
/// does is made up by others. Of two that do as much the first one is taken.
///
/// # Panics
/// If entries are not as long as `always`.
#[must_use]
pub fn most_independent(effects: &[Vec<f64>], always: &[f64], share: f64) -> Vec<usize> {
    let column = |of: &[f64]| Col::from_fn(always.len(), |row| of[row]);
    let mut own: Vec<Col<f64>> = effects.iter().map(|of| column(of)).collect();
    let whole: Vec<f64> = own.iter().map(Col::norm_l2).collect();
    let mut taken = Vec::new();
    let mut next = Some(column(always));
    while let Some(column) = next {
        let length = column.norm_l2();
        if length > 0.0 {
            let unit = &column * (1.0 / length);
            own.iter_mut().for_each(|of| without(of, unit.as_ref()));
        }
        let most = |best: Option<(usize, f64)>, (k, of): (usize, f64)| match best {
            Some((_, length)) if of <= length => best,
            _ => Some((k, of)),
        };
        let left = (0..own.len()).filter(|k| !taken.contains(k)).map(|k| (k, own[k].norm_l2()));
        next = left.filter(|(k, length)| *length > share * whole[*k]).fold(None, most).map(|(k, _)| {
            taken.push(k);
            own[k].clone()
        });
    }
    taken
}

/// Combinations of residuals that no setting changes by more than a `share` of what it changes others by, in which as few residuals take
/// part as can; an entry of `effects` for each setting.
///
/// # Panics
/// If entries are not of one length.
#[must_use]
pub fn opposed(effects: &[Vec<f64>], share: f64) -> Vec<Vec<f64>> {
    let rows = effects.first().map_or(0, Vec::len);
    let effects = Mat::from_fn(rows, effects.len(), |row, k| effects[k][row]);
    // all is finite, so that the values converge
    let Ok(svd) = Svd::new(effects.as_ref()) else { return Vec::new() };
    let sizes: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    let least = share * sizes.first().copied().unwrap_or_default();
    let is_unmoved = |k: &usize| sizes.get(*k).is_none_or(|size| *size <= least);
    let column = |k: usize| svd.U().col(k).iter().copied().collect::<Vec<f64>>();
    separated((0..rows).filter(is_unmoved).map(column).collect())
}

/// The same directions as combinations in which as few entries as can take part, by Gauss and Jordan.
#[must_use]
pub fn separated(mut directions: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut done: Vec<Vec<f64>> = Vec::new();
    while !directions.is_empty() {
        let places = directions
            .iter()
            .enumerate()
            .flat_map(|(row, of)| of.iter().enumerate().map(move |(k, x)| (row, k, x.abs())));
        let largest = places.fold((0, 0, 0.0), |best, place| if place.2 > best.2 { place } else { best });
        let (row, pivot, _) = largest;
        let leading = directions.swap_remove(row);
        for other in directions.iter_mut().chain(&mut done) {
            let factor = other[pivot] / leading[pivot];
            other.iter_mut().zip(&leading).for_each(|(x, by)| *x -= factor * by);
        }
        done.push(leading);
    }
    done
}

fn product(a: ColRef<'_, f64>, b: ColRef<'_, f64>) -> f64 {
    a.iter().zip(b.iter()).map(|(a, b)| a * b).sum()
}

fn without(of: &mut Col<f64>, unit: ColRef<'_, f64>) {
    let along = product(of.as_ref(), unit);
    of.iter_mut().zip(unit.iter()).for_each(|(of, unit)| *of -= along * unit);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn those_that_do_most_come_first_and_copies_do_not_come() {
        let first = vec![1.0, 0.0, 0.0, 0.0];
        // the third setting does what the first one does, the last one next to nothing
        let effects = [first.clone(), vec![0.0, 1.0, 0.0, 0.0], first, vec![0.0, 0.0, 1e-4, 0.0]];
        let always = [vec![0.0, 0.0, 0.0, 1.0]];
        let found = most_effective(&[1.0, 3.0, 2.0, 5.0], &effects, &always, 1e-3, 0.0);
        assert_eq!(found, [1, 0]);
        // one takes 3 of the residuals, the other 1
        assert_eq!(most_effective(&[1.0, 3.0, 2.0, 5.0], &effects, &always, 1e-3, 0.8), [1]);
        assert_eq!(most_effective(&[0.0; 4], &effects, &[vec![0.0; 4]], 1e-3, 0.0), []);
    }

    /// The difference of two settings that are almost one takes all away, and neither of them anything; a third one does nothing for it.
    #[test]
    fn settings_that_do_nothing_alone_are_taken_together() {
        let effects = [vec![1.0, 1.0, 0.0, 0.0], vec![1.0, 0.9, 0.0, 0.0], vec![0.0, 0.0, 1.0, 0.0]];
        let residuals = [0.9, -1.0, 0.0, 0.0];
        let alone = most_effective(&residuals, &effects, &[], 0.01, 0.0);
        assert_eq!(alone, [], "the sum of both is square to what is left, and nearly so is either");
        assert_eq!(least_dispensable(&residuals, (&effects, &[]), 1e-4, (0.01, 0.0)), [0, 1]);
        assert!(linear_rest(&residuals, &effects[..2], 1e-4) < 1e-12);
        // of noise as large nothing is taken
        assert_eq!(least_dispensable(&residuals, (&effects, &[]), 1e-4, (0.01, 1.0)), []);
    }
}
