//! Proof that equations have one solution in a box, whatever their other inputs are.

use std::cmp::Ordering;

use super::{NoRoot, System, start};
use crate::enclosure::interval::{Interval, IntervalEvaluator};

/// Boxes of the unknowns that are looked at, at most: for the whole ranges of the other inputs, as many more each time that these are
/// halved, and in all. What is undecided mostly is so because the part is too large.
const FIRST_BOXES: usize = 32;
const MORE_BOXES: usize = 16;
pub(super) const MOST_IN_ALL: usize = 40_000;
/// The same for one place of the other inputs.
const MOST_AT_A_PLACE: usize = 2_000;
/// Solutions are one where they lie no farther apart, over the widths of the ranges.
const SAME: f64 = 1e-7;
/// Steps that narrow the place of a solution, at most.
const MOST_REFINED: usize = 16;
/// A box of unknowns is so narrow, over the widths of the ranges, that its border is no reason to divide it again.
const NARROW: f64 = 1e-4;

/// What is known of the solutions for a part of the other inputs.
enum Known {
    /// There is one, and it lies here.
    One(Vec<Interval>),
    /// There is none.
    None,
    /// There are several.
    Several,
    /// The part is too large, or a solution is double.
    Nothing,
}

/// Whether a box holds a solution.
enum Held {
    /// None.
    None,
    /// One alone, for each value of the other inputs.
    One(Only),
    /// All there are lie here; the operator's image.
    Within(Vec<Interval>, Vec<Interval>),
}

/// The only solution in a box.
struct Only {
    /// Where it lies.
    place: Vec<Interval>,
    /// The box.
    within: Vec<Interval>,
}

fn lies_in(place: &[Interval], within: &[Interval]) -> bool {
    place.iter().zip(within).all(|(place, within)| within.lo <= place.lo && place.hi <= within.hi)
}

/// Proves it, with so many boxes at the most.
pub(super) fn prove(system: &System, boxes: usize) -> Result<(), NoRoot> {
    let most = boxes;
    let moving = system.moving();
    let mut search = Search::new(system);
    let mut left = vec![(system.others.clone(), FIRST_BOXES)];
    while let Some((part, boxes)) = left.pop() {
        let known = search.solutions(&part, boxes);
        let at = || moving.iter().map(|k| part[*k].middle()).collect();
        match known {
            Known::One(_) => continue,
            Known::None => return Err(NoRoot::None(at())),
            Known::Several => return Err(NoRoot::Several(at())),
            Known::Nothing => {}
        }
        let relative = |k: &usize| (part[*k].hi - part[*k].lo) / (system.others[*k].hi - system.others[*k].lo);
        let widest = moving.iter().copied().max_by(|a, b| relative(a).total_cmp(&relative(b)));
        let Some(widest) = widest.filter(|_| search.looked_at < most) else {
            return Err(search.elsewhere(&moving).unwrap_or_else(|| NoRoot::Unproven(at())));
        };
        let [low, high] = halves(part[widest]);
        for half in [high, low] {
            let mut part = part.clone();
            part[widest] = half;
            left.push((part, boxes + MORE_BOXES));
        }
    }
    Ok(())
}

/// Where the one solution lies for numbers of the other inputs; `boxes` are how many may be looked at, and how many of them are left then.
pub(super) fn solution(system: &System, others: &[f64], boxes: &mut usize) -> Result<Vec<f64>, NoRoot> {
    let others: Vec<Interval> = others.iter().map(|other| Interval::point(*other)).collect();
    let mut search = Search::new(system);
    let known = search.solutions(&others, *boxes);
    *boxes = boxes.saturating_sub(search.looked_at);
    match known {
        Known::One(place) => Ok(place.iter().map(|place| place.middle()).collect()),
        Known::None => Err(NoRoot::None(Vec::new())),
        Known::Several => Err(NoRoot::Several(Vec::new())),
        Known::Nothing => Err(NoRoot::Unproven(Vec::new())),
    }
}

/// All solutions for numbers of the other inputs that can be told apart; none where that is not decided.
pub(super) fn every(system: &System, others: &[f64]) -> Vec<Vec<f64>> {
    let points: Vec<Interval> = others.iter().map(|other| Interval::point(*other)).collect();
    let found = Search::new(system).isolated(&points, MOST_AT_A_PLACE).unwrap_or_default();
    let mut solutions: Vec<Vec<f64>> = Vec::new();
    for only in found {
        let middle = only.place.iter().map(|side| side.middle()).collect();
        let Some(solution) = start::settled(system, middle, others) else { continue };
        let is_near = |(k, (one, other)): (usize, (&f64, &f64))| (one - other).abs() < SAME * system.width(k);
        let is_known = |known: &Vec<f64>| known.iter().zip(&solution).enumerate().all(is_near);
        let is_inside = solution.iter().zip(&system.unknowns).all(|(value, range)| range.contains(*value));
        if is_inside && !solutions.iter().any(is_known) {
            solutions.push(solution);
        }
    }
    solutions.sort_by(|one, other| one.partial_cmp(other).unwrap_or(Ordering::Equal));
    solutions
}

impl System {
    fn width(&self, k: usize) -> f64 {
        (self.unknowns[k].hi - self.unknowns[k].lo).max(f64::MIN_POSITIVE)
    }
}

struct Search<'s> {
    system: &'s System,
    values: IntervalEvaluator<'s>,
    slopes: IntervalEvaluator<'s>,
    given: IntervalEvaluator<'s>,
    looked_at: usize,
}

impl<'s> Search<'s> {
    fn new(system: &'s System) -> Search<'s> {
        let [values, slopes, given] = [&system.values, &system.slopes, &system.given].map(IntervalEvaluator::new);
        Search { system, values, slopes, given, looked_at: 0 }
    }

    /// What is wrong at some places in the ranges of what moves, where at one of them it is plain: that says more than where it becomes so.
    fn elsewhere(&mut self, moving: &[usize]) -> Option<NoRoot> {
        /// In each direction, and in all.
        const PLACES: [usize; 2] = [17, 300];
        let count = (2..=PLACES[0]).rev().find(|count| count.pow(moving.len() as u32) <= PLACES[1])?;
        (0..count.pow(moving.len() as u32)).find_map(|place| {
            let mut others: Vec<Interval> = self.system.others.clone();
            for (axis, &k) in moving.iter().enumerate() {
                let range = self.system.others[k];
                let part = (place / count.pow(axis as u32) % count) as f64 / (count - 1) as f64;
                others[k] = Interval::point((1.0 - part) * range.lo + part * range.hi);
            }
            let at = || moving.iter().map(|k| others[*k].lo).collect();
            match self.solutions(&others, FIRST_BOXES * MORE_BOXES) {
                Known::None => Some(NoRoot::None(at())),
                Known::Several => Some(NoRoot::Several(at())),
                Known::One(_) | Known::Nothing => None,
            }
        })
    }

    fn solutions(&mut self, others: &[Interval], boxes: usize) -> Known {
        let found = self.isolated(others, boxes);
        match found.map_or(Known::Nothing, |found| self.together(found, others)) {
            Known::Nothing => self.between_ends(others).unwrap_or(Known::Nothing),
            known => known,
        }
    }

    /// Of one equation that rises all over the range, or falls: its signs at the ends say whether the solution lies between them. `None` where
    /// that is not plain.
    fn between_ends(&mut self, others: &[Interval]) -> Option<Known> {
        let [range] = self.system.unknowns[..] else { return None };
        if !self.system.given_ranges.is_empty() {
            return None;
        }
        let slope = self.slope(range, others);
        let rises = (slope.continuous && !slope.contains(0.0)).then_some(slope.lo > 0.0)?;
        let mut lies_above = |at: f64| {
            let value = self.value(Interval::point(at), others);
            let is_plain = value.continuous && !value.contains(0.0);
            is_plain.then_some((value.lo < 0.0) == rises)
        };
        let (mut low, mut high) = (range.lo, range.hi);
        if !lies_above(low)? || lies_above(high)? {
            return Some(Known::None);
        }
        while high - low > NARROW * (range.hi - range.lo) {
            let middle = 0.5 * (low + high);
            match lies_above(middle) {
                Some(true) => low = middle,
                Some(false) => high = middle,
                None => break,
            }
        }
        Some(Known::One(vec![Interval::new(low, high)]))
    }

    fn slope(&mut self, place: Interval, others: &[Interval]) -> Interval {
        run(&mut self.slopes, &[place], others, 1)[0]
    }

    fn value(&mut self, place: Interval, others: &[Interval]) -> Interval {
        run(&mut self.values, &[place], others, 1)[0]
    }

    /// Boxes that hold one solution each, and together all; one solution may lie in several of them. `None` if it is not decided.
    fn isolated(&mut self, others: &[Interval], boxes: usize) -> Option<Vec<Only>> {
        let most = self.looked_at + boxes;
        let mut left = vec![self.system.unknowns.clone()];
        let mut found: Vec<Only> = Vec::new();
        while let Some(place) = left.pop() {
            if self.looked_at >= most {
                return None;
            }
            let (inner, image) = match self.held(&place, others) {
                Held::None => continue,
                Held::One(only) => {
                    found.push(only);
                    continue;
                }
                Held::Within(inner, image) => (inner, image),
            };
            let system = self.system;
            let width = |k: usize, of: &[Interval]| (of[k].hi - of[k].lo) / system.width(k);
            let widest = (0..inner.len()).max_by(|a, b| width(*a, &inner).total_cmp(&width(*b, &inner)));
            let widest = widest.expect("there are unknowns");
            if width(widest, &inner) < 0.7 * width(widest, &place) && width(widest, &inner) > NARROW {
                left.push(inner);
                continue;
            }
            // the solution may lie on a border where a box was divided, or on both sides of it
            match self.settled(&inner, image, others) {
                Held::None => {}
                Held::One(only) => found.push(only),
                Held::Within(..) if width(widest, &inner) < NARROW => return None,
                Held::Within(..) => {
                    for half in halves(inner[widest]) {
                        let mut inner = inner.clone();
                        inner[widest] = half;
                        left.push(inner);
                    }
                }
            }
        }
        Some(found)
    }

    /// Looks at wider and wider boxes about where the operator leads.
    fn settled(&mut self, inner: &[Interval], image: Vec<Interval>, others: &[Interval]) -> Held {
        let (mut inner, mut image) = (inner.to_vec(), image);
        for _ in 0..3 {
            let wider: Vec<Interval> = inner.iter().zip(&image).map(|(a, b)| around(a.hull(*b))).collect();
            match self.held(&wider, others) {
                Held::Within(_, next) => (inner, image) = (wider, next),
                held => return held,
            }
        }
        Held::Within(inner, image)
    }

    /// Whether solutions that were found in several boxes are one: the only one of a box, if it lies in that box, too.
    fn together(&mut self, found: Vec<Only>, others: &[Interval]) -> Known {
        let mut found = found.into_iter();
        let Some(mut one) = found.next() else { return Known::None };
        for other in found {
            let shared: Vec<Interval> = one.place.iter().zip(&other.place).map(|(a, b)| a.intersection(*b)).collect();
            if shared.iter().any(|side| side.is_empty()) {
                return Known::Several;
            }
            if lies_in(&other.place, &one.within) {
                one.place = shared;
            } else if lies_in(&one.place, &other.within) {
                one = Only { place: shared, ..other };
            } else {
                return Known::Nothing;
            }
        }
        // whether it lies in the ranges is known once its place is narrow
        let is_out = |place: &[Interval]| {
            place.iter().zip(&self.system.unknowns).any(|(place, range)| place.intersection(*range).is_empty())
        };
        for _ in 0..MOST_REFINED {
            if lies_in(&one.place, &self.system.unknowns) || is_out(&one.place) {
                break;
            }
            let (Held::One(Only { place: image, .. }) | Held::Within(image, _)) = self.held(&one.place, others) else {
                break;
            };
            one.place = one.place.iter().zip(&image).map(|(a, b)| a.intersection(*b)).collect();
        }
        let mut ranges = one.place.iter().zip(&self.system.unknowns);
        let given = self.given(&one.place, others);
        let lies_beside = |(place, range): (&Interval, &Interval)| place.intersection(*range).is_empty();
        if ranges.any(lies_beside) || given.iter().zip(&self.system.given_ranges).any(lies_beside) {
            Known::None
        } else if lies_in(&one.place, &self.system.unknowns) && lies_in(&given, &self.system.given_ranges) {
            Known::One(one.place)
        } else {
            Known::Nothing
        }
    }

    /// Where the unknowns lie that those in a box give.
    fn given(&mut self, place: &[Interval], others: &[Interval]) -> Vec<Interval> {
        run(&mut self.given, place, others, self.system.given_ranges.len())
    }

    /// Krawczyk's operator: m − C F(m) + (1 − C J) (X − m), C being the inverse of J's middle.
    fn held(&mut self, place: &[Interval], others: &[Interval]) -> Held {
        self.looked_at += 1;
        let size = place.len();
        let over = run(&mut self.values, place, others, size);
        if over.iter().any(|value| value.continuous && !value.contains(0.0)) {
            return Held::None;
        }
        let mut given = self.given(place, others).into_iter().zip(&self.system.given_ranges);
        if given.any(|(given, range)| given.intersection(*range).is_empty()) {
            return Held::None;
        }
        let slopes = run(&mut self.slopes, place, others, size * size);
        let middle: Vec<Interval> = place.iter().map(|side| Interval::point(side.middle())).collect();
        let values = run(&mut self.values, &middle, others, size);
        let is_smooth = slopes.iter().chain(&over).all(|value| value.continuous);
        let middles: Vec<f64> = slopes.iter().map(|slope| slope.middle()).collect();
        let Some(inverse) = inverse(&middles, size).filter(|_| is_smooth) else {
            return Held::Within(place.to_vec(), place.to_vec());
        };
        let image: Vec<Interval> = (0..size)
            .map(|row| {
                let factor = |column: usize| Interval::point(inverse[row * size + column]);
                let mut sum = middle[row];
                for column in 0..size {
                    sum = sum - factor(column) * values[column];
                    let product = (0..size).map(|k| factor(k) * slopes[k * size + column]);
                    let product = product.reduce(|a, b| a + b).expect("there are unknowns");
                    let unit = Interval::point(f64::from(u8::from(row == column)));
                    sum = sum + (unit - product) * (place[column] - middle[column]);
                }
                sum
            })
            .collect();
        if image.iter().zip(place).all(|(image, side)| image.lo > side.lo && image.hi < side.hi) {
            return Held::One(Only { place: image, within: place.to_vec() });
        }
        let inner: Vec<Interval> = image.iter().zip(place).map(|(image, side)| image.intersection(*side)).collect();
        if inner.iter().any(|side| side.is_empty()) { Held::None } else { Held::Within(inner, image) }
    }
}

/// So many values for unknowns and other inputs.
fn run(evaluator: &mut IntervalEvaluator<'_>, place: &[Interval], others: &[Interval], count: usize) -> Vec<Interval> {
    let inputs: Vec<Interval> = place.iter().chain(others).copied().collect();
    let mut out = vec![Interval::WHOLE; count];
    evaluator.run(&inputs, &mut out);
    out
}

fn halves(side: Interval) -> [Interval; 2] {
    let middle = side.middle();
    [Interval::new(side.lo, middle), Interval::new(middle, side.hi)]
}

/// Half its width more on both sides, and something where it has none.
fn around(side: Interval) -> Interval {
    let more = 0.5 * (side.hi - side.lo) + 1e-14 * side.magnitude() + f64::MIN_POSITIVE;
    Interval::new(side.lo - more, side.hi + more)
}

/// By Gauss and Jordan, with the largest pivot of each column.
pub(super) fn inverse(matrix: &[f64], size: usize) -> Option<Vec<f64>> {
    let width = 2 * size;
    let entry = |row: usize, column: usize| match column.checked_sub(size) {
        None => matrix[row * size + column],
        Some(column) => f64::from(u8::from(row == column)),
    };
    let mut rows: Vec<Vec<f64>> = (0..size).map(|row| (0..width).map(|column| entry(row, column)).collect()).collect();
    for column in 0..size {
        let pivot = (column..size).max_by(|a, b| rows[*a][column].abs().total_cmp(&rows[*b][column].abs()))?;
        rows.swap(column, pivot);
        let factor = rows[column][column];
        if !(factor.is_normal()) {
            return None;
        }
        rows[column].iter_mut().for_each(|entry| *entry /= factor);
        let pivot = rows[column].clone();
        for row in (0..size).filter(|row| *row != column) {
            let factor = rows[row][column];
            rows[row].iter_mut().zip(&pivot).for_each(|(entry, pivot)| *entry -= factor * pivot);
        }
    }
    Some(rows.into_iter().flat_map(|row| row[size..].to_vec()).collect())
}
