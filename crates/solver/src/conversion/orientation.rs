//! How near to an orientation the rotary axes of a machine come.

use std::f64::consts::{PI, TAU};

/// Values in all directions together at which a maximum is looked for first.
const LOOKS: usize = 6000;
/// Of these the best are followed: the function may have several maxima.
const FOLLOWED: usize = 6;
/// Steps below this (rad) end the search; what is near its maximum changes by the square of it.
const SMALLEST_STEP: f64 = 1e-9;
/// Rounds of all angles; a narrow ridge is followed no longer.
const MOST_ROUNDS: u32 = 10_000;

/// The largest value of a function of angles, each taken over a turn.
pub(crate) fn greatest(angles: usize, mut function: impl FnMut(&[f64]) -> f64) -> f64 {
    // of many angles each is looked at in two places, but not all together
    let fits = |each: &usize| each.checked_pow(angles as u32).is_some_and(|all| all <= LOOKS);
    let each = (2..=72).rev().find(fits).unwrap_or(2);
    let all = each.checked_pow(angles as u32).map_or(LOOKS, |all| all.min(LOOKS));
    let place = |mut k: usize| -> Vec<f64> {
        let mut next = || {
            let share = (k % each) as f64 / each as f64;
            k /= each;
            TAU * share - PI
        };
        (0..angles).map(|_| next()).collect()
    };
    let mut looks: Vec<(f64, Vec<f64>)> =
        (0..all).map(place).map(|at| (function(&at), at)).filter(|look| !look.0.is_nan()).collect();
    looks.sort_by(|a, b| b.0.total_cmp(&a.0));
    looks.truncate(FOLLOWED);
    let first_step = TAU / each as f64;
    looks.into_iter().map(|look| climbed(look, first_step, &mut function)).fold(f64::NEG_INFINITY, f64::max)
}

/// Goes up along single angles, in steps that are halved where none of them leads up.
fn climbed((mut best, mut at): (f64, Vec<f64>), first_step: f64, function: &mut impl FnMut(&[f64]) -> f64) -> f64 {
    let mut step = first_step;
    for _ in 0..MOST_ROUNDS {
        if step < SMALLEST_STEP {
            break;
        }
        let mut climbs = false;
        for k in 0..at.len() {
            for by in [step, -step] {
                let before = at[k];
                at[k] += by;
                let value = function(&at);
                if value > best {
                    (best, climbs) = (value, true);
                } else {
                    at[k] = before;
                }
            }
        }
        if !climbs {
            step *= 0.5;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::greatest;

    /// Of two maxima the higher one, also where it lies between the values that are looked at first.
    #[test]
    fn the_higher_of_two_maxima_is_found() {
        let two = |x: &[f64]| (x[0] - 0.3).cos() * (x[1] + 2.0).cos() + 0.1 * (x[0] - 0.3 + x[1] + 2.0).cos();
        assert!((greatest(2, two) - 1.1).abs() < 1e-12);
        assert!((greatest(1, |x| (x[0] - 3.1).cos()) - 1.0).abs() < 1e-12);
        assert_eq!(greatest(0, |_| 0.5), 0.5);
    }

    /// More of them than there are places to look at, or than a number can count.
    #[test]
    fn of_many_angles_not_all_places_are_looked_at() {
        for angles in [14, 70] {
            let mut looks = 0;
            let found = greatest(angles, |x| {
                looks += 1;
                x.iter().map(|x| (x - 0.3).cos()).sum()
            });
            assert!((found - angles as f64).abs() < 1e-12, "{found}");
            assert!(looks < 100_000, "{looks}");
        }
    }
}
