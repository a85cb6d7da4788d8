//! Points of known lines between places that are known on all of them: a whole block at once, each strip for itself.

#![allow(clippy::needless_range_loop)] // several arrays are gone through in step

use std::array;

use flank_expr::LANES;

use super::strip::{Strip, determinant_between, is_astray};
use super::{Field, block_of, take};
use crate::continuation::line::{divided_difference, stencil};
use crate::continuation::path::{dips, is_between, smaller};
use crate::equations::solution::Range;
use crate::newton::batch::{LaneNewton, Lanes};

/// Some places on some lines, all of whose points are roots.
pub(crate) struct Along {
    lines: Vec<usize>,
    places: Vec<usize>,
    /// Unknowns and determinants: of the first place on all lines, then of the next one.
    numbers: Vec<f64>,
    /// How many of each point.
    size: usize,
}

/// Where the lanes of a strip are among the places.
struct Between {
    /// The first place of the polynomial, and the weights of it and those that follow.
    first: usize,
    weights: Vec<Lanes>,
    /// The place before each lane; the lane is before the next one, this share of the way from one to the other.
    before: [usize; LANES],
    share: Lanes,
}

impl Field {
    /// Some places on some lines, if there is anything between them and all of these points are roots.
    pub(crate) fn along(&self, lines: &[usize], places: &[usize]) -> Option<Along> {
        if places.len() == self.shape.length {
            return None;
        }
        let size = self.shape.size + 1;
        let mut numbers = Vec::with_capacity(places.len() * lines.len() * size);
        for at in places {
            for line in lines {
                let (block, lane) = self.shape.place_on(*line, *at);
                if !self.marks[block][lane].is_root() {
                    return None;
                }
                numbers.extend((0..size).map(|plane| self.value_in((block, lane), plane)));
            }
        }
        Some(Along { lines: lines.to_vec(), places: places.to_vec(), numbers, size })
    }
}

impl Along {
    fn number(&self, place: usize, line: usize, plane: usize) -> f64 {
        self.numbers[(place * self.lines.len() + line) * self.size + plane]
    }

    /// For a strip that begins at `first`; lanes that are not there are where its last one is.
    #[inline(always)]
    fn between(&self, first: usize, width: usize) -> Between {
        let places = &self.places;
        let before = |at: usize| places.partition_point(|place| *place <= at).clamp(1, places.len() - 1) - 1;
        let around = stencil(before(first + width / 2), places.len());
        let at: Lanes = array::from_fn(|lane| (first + lane.min(width - 1)) as f64);
        let stencil = &places[around.clone()];
        let mut weights = vec![[1.0; LANES]; stencil.len()];
        // Lagrange's: distances from the places before each one, from those behind it, and what these are for the place itself
        let mut product = [1.0; LANES];
        for (place, weights) in stencil.iter().zip(&mut weights) {
            *weights = product;
            (0..LANES).for_each(|lane| product[lane] *= at[lane] - *place as f64);
        }
        product = [1.0; LANES];
        for ((place, weights), share) in stencil.iter().zip(&mut weights).zip(divided_difference(stencil)).rev() {
            (0..LANES).for_each(|lane| weights[lane] *= product[lane] * share);
            (0..LANES).for_each(|lane| product[lane] *= at[lane] - *place as f64);
        }
        let before = at.map(|at| before(at as usize));
        let share = array::from_fn(|lane| {
            let [start, end] = [0, 1].map(|k| places[before[lane] + k] as f64);
            (at[lane] - start) / (end - start)
        });
        Between { first: around.start, weights, before, share }
    }

    /// On the polynomial through the places around the strip.
    #[inline(always)]
    fn sums(&self, between: &Between, line: usize, plane: usize) -> Lanes {
        let mut sums = [0.0; LANES];
        for (k, weights) in between.weights.iter().enumerate() {
            let number = self.number(between.first + k, line, plane);
            for lane in 0..LANES {
                sums[lane] += weights[lane] * number;
            }
        }
        sums
    }

    /// Determinants; no numbers where they may vanish between the places.
    #[inline(always)]
    fn determinants(&self, between: &Between, line: usize) -> Lanes {
        array::from_fn(|lane| determinant_between(self.beside(between, lane, line, self.size - 1), between.share[lane]))
    }

    /// How far apart the places before and behind a lane are, as a share of the ranges.
    fn apart(&self, between: &Between, (lane, line): (usize, usize), ranges: &[Range]) -> f64 {
        let share = |(k, range): (usize, &Range)| {
            let [before, behind] = self.beside(between, lane, line, k);
            (before - behind).abs() / range.width()
        };
        ranges.iter().enumerate().map(share).fold(0.0, f64::max)
    }

    /// At the places before and behind a lane.
    #[inline(always)]
    fn beside(&self, between: &Between, lane: usize, line: usize, plane: usize) -> [f64; 2] {
        [0, 1].map(|k| self.number(between.before[lane] + k, line, plane))
    }
}

impl Strip<'_> {
    /// Solves the points of these lines; what fails stays unknown. Gives the number of evaluations.
    pub(super) fn refine_along(&mut self, newton: &mut LaneNewton<'_>, along: &Along, targets: &[[Lanes; 2]]) -> u64 {
        let (shape, width) = (self.shape, self.width);
        let instructions = newton.instructions();
        let between = instructions.dispatch(
            #[inline(always)]
            || along.between(self.first, width),
        );
        let (mut evaluations, mut rough) = (0, true);
        for (k, line) in along.lines.iter().copied().enumerate() {
            if self.is_line_of_roots(line) {
                continue;
            }
            for number in 0..2 {
                *newton.input(shape.size + number) = targets[line][number];
            }
            instructions.dispatch(
                #[inline(always)]
                || {
                    for plane in 0..shape.size {
                        *newton.input(plane) = along.sums(&between, k, plane);
                    }
                    *newton.determinant() = along.determinants(&between, k);
                },
            );
            // those that are known come to themselves
            let expected = *newton.determinant();
            evaluations += newton.run(&[true; LANES][..width], rough);
            rough = newton.were_rough();
            let is_checked = rough && !newton.has_all_given();
            let found = *newton.determinant();
            let mut stays = [true; LANES];
            if is_checked {
                for lane in 0..width {
                    stays[lane] = is_between([expected[lane]; 2], 0.0, found[lane]);
                }
                if !stays[..width].iter().all(|stays| *stays) {
                    let smooth = along.sums(&between, k, shape.size);
                    for lane in 0..width {
                        let keeps_sign = expected[lane] * smooth[lane] > 0.0;
                        let ends = along.beside(&between, lane, k, shape.size);
                        stays[lane] |= keeps_sign
                            && is_between([smooth[lane]; 2], 0.0, found[lane])
                            && !dips(smaller(ends), found[lane]);
                    }
                }
            }
            if stays[..width].iter().all(|stays| *stays) && self.take_plain(line, newton) {
                continue;
            }
            for lane in 0..width {
                let apart = || along.apart(&between, (lane, k), self.ranges);
                let is_open = !self.marks[line][lane].is_root();
                if is_open && stays[lane] && newton.is_root(lane) && !is_astray(newton.moved(lane), apart) {
                    let values = block_of(shape, self.values, line);
                    take(shape, values, &mut self.marks[line], lane, newton, lane);
                }
            }
        }
        evaluations
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_are_on_the_polynomial_through_the_places_around() {
        let f = |line: usize, at: usize| (at as f64 / 50.0 - 1.0).powi(7) + line as f64;
        for (length, places) in
            [(100, vec![0, 3, 9, 20, 33, 47, 60, 75, 88, 96, 99]), (34, vec![0, 2, 5, 9, 17, 24, 30, 33])]
        {
            let lines = vec![4, 7];
            let numbers =
                |at: &usize| lines.clone().into_iter().flat_map(|line| [f(line, *at), 1.0]).collect::<Vec<f64>>();
            let along =
                Along { numbers: places.iter().flat_map(numbers).collect(), lines: lines.clone(), places, size: 2 };
            for first in (0..length).step_by(LANES) {
                let width = LANES.min(length - first);
                let between = along.between(first, width);
                for (k, line) in lines.iter().enumerate() {
                    let sums = along.sums(&between, k, 0);
                    for lane in 0..width {
                        let (at, expected) = (first + lane, f(*line, first + lane));
                        assert!((sums[lane] - expected).abs() < 1e-12, "{at}: {} is not {expected}", sums[lane]);
                        let [before, behind] = along.beside(&between, lane, k, 0);
                        assert!(before <= expected + 1e-12 && expected <= behind + 1e-12);
                    }
                    let last = sums[width - 1].to_bits();
                    assert!(sums[width..].iter().all(|sum| sum.to_bits() == last), "lanes that are not there");
                    assert_eq!(along.determinants(&between, k).map(|one| (one - 1.0).abs() < 1e-12), [true; LANES]);
                }
            }
        }
    }

    #[test]
    fn determinants_that_change_their_sign_are_not_known_between() {
        let signs = [1.0, 1.0, -1.0, -1.0];
        let along = Along { lines: vec![0], places: vec![0, 10, 20, 30], numbers: signs.to_vec(), size: 1 };
        let determinants = along.determinants(&along.between(0, 31), 0);
        for lane in 0..31 {
            assert_eq!(determinants[lane].is_nan(), (10..20).contains(&lane), "{lane}: {}", determinants[lane]);
        }
    }
}
