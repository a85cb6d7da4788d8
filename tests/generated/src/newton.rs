//! Roots of equations whose derivatives are not known.

use crate::machine::Range;

/// A share between 0 and 1 that fills the interval evenly.
pub fn halton(mut number: usize, base: usize) -> f64 {
    let (mut share, mut digit) = (0.0, 1.0);
    while number > 0 {
        digit /= base as f64;
        share += digit * (number % base) as f64;
        number /= base;
    }
    share
}

/// Newton's method with differences, in the free unknowns; whether it ends at a root.
pub fn newton(conditions: &dyn Fn(&[f64]) -> Vec<f64>, free: &[usize], unknowns: &mut [f64], ranges: &[Range]) -> bool {
    const LONGEST: f64 = 0.2;
    let mut values = conditions(unknowns);
    if values.len() != free.len() {
        return false;
    }
    for _ in 0..25 {
        let mut matrix: Vec<Vec<f64>> = values.iter().map(|value| vec![-value]).collect();
        for &k in free {
            let step = 1e-6 * ranges[k].width();
            let mut moved = unknowns.to_vec();
            moved[k] += step;
            let there = conditions(&moved);
            // in shares of the range
            matrix
                .iter_mut()
                .zip(values.iter().zip(there))
                .for_each(|(row, (here, there))| row.push((there - here) / 1e-6));
        }
        let Some(steps) = solved(matrix) else { return false };
        let longest = steps.iter().fold(0.0f64, |longest, step| longest.max(step.abs()));
        if !longest.is_finite() {
            return false;
        }
        let share = (LONGEST / longest).min(1.0);
        for (&k, step) in free.iter().zip(&steps) {
            unknowns[k] += share * step * ranges[k].width();
            if !ranges[k].wider_by(0.5).holds(unknowns[k]) {
                return false;
            }
        }
        values = conditions(unknowns);
        if longest < 1e-9 {
            return values.iter().all(|value| value.abs() < 1e-7);
        }
    }
    false
}

/// The solution of linear equations, each row with its right side first.
fn solved(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let n = rows.len();
    for column in 0..n {
        let pivot = (column..n).max_by(|a, b| rows[*a][column + 1].abs().total_cmp(&rows[*b][column + 1].abs()))?;
        rows.swap(column, pivot);
        let row = rows[column].clone();
        if row[column + 1].abs() < 1e-14 {
            return None;
        }
        for (_, other) in rows.iter_mut().enumerate().filter(|(k, _)| *k != column) {
            let share = other[column + 1] / row[column + 1];
            other.iter_mut().zip(&row).for_each(|(x, y)| *x -= share * y);
        }
    }
    Some((0..n).map(|k| rows[k][0] / rows[k][k + 1]).collect())
}
