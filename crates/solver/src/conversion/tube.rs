//! Where the axes of another machine are proven to stand over a whole range of the motion.

use flank_expr::{Interval, IntervalEvaluator, Tape, TaylorEvaluator};

use crate::conversion::poses::{PoseProblem, Posture};
use crate::equations::solution::Range;
use crate::roots::enclosure::eliminate;

/// Order of the polynomials in the middle of a tube.
const ORDER: usize = 12;
/// Of the range, the first piece that is tried, and the shortest.
const LONGEST: f64 = 0.5;
const SHORTEST: f64 = 1e-6;
/// A piece is halved while its radii are above this share of its unknowns, of 100 mm or rad if they are smaller, down to pieces of
/// [`SHORT_ENOUGH`] of the range: some hundred roundings.
const THIN: f64 = 1e-14;
const SHORT_ENOUGH: f64 = 1e-3;
/// Parts of a piece in which the distance from a polynomial is bounded; a power of two, so that their length is exact.
const PARTS: usize = 16;
/// Widenings of the radii that are tried on a piece.
const WIDENINGS: u32 = 8;

/// Polynomials of the axes, piece by piece over a range of the motion, with radii about them: at each value of the motion exactly
/// one root of the pose's equations lies in the box of the radii about the polynomials' values, and this root depends
/// continuously on the motion. So it is the posture that the tube was begun with, and none of another elbow.
///
/// All bounds are rounded outward, of the equations as they are stored.
#[derive(Clone, Debug)]
pub struct Tube {
    pieces: Vec<Piece>,
    axes: usize,
}

/// The axes over the whole range could not be enclosed: they are singular there, or nearly, or not smooth.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the axes cannot be enclosed where the motion is {at}")]
pub struct Unproven {
    /// The value of the motion.
    pub at: f64,
}

#[derive(Clone, Debug)]
struct Piece {
    middle: f64,
    /// Half the length of the piece, rounded up.
    half: f64,
    /// Of each unknown the coefficients in powers of the distance from the middle.
    centre: Vec<Vec<f64>>,
    radii: Vec<f64>,
}

impl PoseProblem<'_> {
    /// A tube about the axes over a range of the one motion, from a posture at a value `about` in it.
    ///
    /// On each piece P are the power series about its middle, X the box P ± ρ over the piece, and Y an approximate inverse of
    /// the Jacobian J in the middle. The residual of the series, `Y F(P(φ), φ)`, is a function of φ alone: its coefficients in the
    /// middle and the enclosure of the next one over the piece bound it. By Krawczyk's theorem
    /// `|Y F(P)| + |1 − Y J(X)| ρ < ρ` shows that there is one root in X at each φ, and that it is no farther than ρ from P.
    ///
    /// # Errors
    /// Where it could not be shown; a range of one value shows nothing.
    ///
    /// # Panics
    /// If there is more than one motion.
    pub fn tube(&self, posture: &Posture, about: f64, range: Range) -> Result<Tube, Unproven> {
        let mut prover = Prover::new(self);
        let up = prover.towards(posture, about, range.high, range.width())?;
        let down = prover.towards(posture, about, range.low, range.width())?;
        let pieces: Vec<Piece> = down.into_iter().rev().chain(up).collect();
        if pieces.is_empty() {
            return Err(Unproven { at: about });
        }
        let joint = |pair: &[Piece]| pair[0].middle + pair[0].half.min(pair[1].middle - pair[0].middle);
        match pieces.windows(2).find(|pair| !prover.joins(&pair[0], &pair[1])) {
            Some(pair) => Err(Unproven { at: joint(pair) }),
            None => Ok(Tube { pieces, axes: posture.axes.len() }),
        }
    }
}

impl Tube {
    /// How far, at most, each axis is from a polynomial of the motion's distance from `about` anywhere in the range, mm or radians;
    /// proven.
    pub fn distances(&self, about: f64, polynomials: &[Vec<f64>]) -> Vec<f64> {
        let windows = self.pieces.iter().map(|piece| (piece, Window { middle: 0.0, half: piece.half }));
        self.farthest(&windows.collect::<Vec<_>>(), about, polynomials)
    }

    /// The same over a part of the range; infinite over what is no part of it.
    pub fn distances_over(&self, part: Range, about: f64, polynomials: &[Vec<f64>]) -> Vec<f64> {
        let windows = self.pieces.iter().filter_map(|piece| Some((piece, piece.window(part)?)));
        self.farthest(&windows.collect::<Vec<_>>(), about, polynomials)
    }

    fn farthest(&self, windows: &[(&Piece, Window)], about: f64, polynomials: &[Vec<f64>]) -> Vec<f64> {
        let of = |axis: usize| {
            let each = windows.iter().map(|(piece, window)| piece.distance(axis, *window, about, &polynomials[axis]));
            each.reduce(f64::max).unwrap_or(f64::INFINITY)
        };
        (0..self.axes).map(of).collect()
    }
}

/// A part of a piece.
#[derive(Clone, Copy)]
struct Window {
    /// Where its middle is, from the piece's.
    middle: f64,
    /// Half its length, rounded up.
    half: f64,
}

impl Piece {
    fn reach(&self) -> Interval {
        Interval::new(-self.half, self.half)
    }

    fn motion(&self) -> Interval {
        Interval::point(self.middle) + self.reach()
    }

    /// What a part of the range has in common with the piece; nothing where that is nothing.
    fn window(&self, part: Range) -> Option<Window> {
        let from_middle = |end: f64| Interval::point(end) - Interval::point(self.middle);
        let (low, high) = (from_middle(part.low).lo.max(-self.half), from_middle(part.high).hi.min(self.half));
        let middle = 0.5 * low + 0.5 * high;
        let reach = |end: f64| (Interval::point(end) - Interval::point(middle)).magnitude();
        (low <= high).then(|| Window { middle, half: reach(low).max(reach(high)) })
    }

    /// How far an axis is from a polynomial anywhere in a window.
    fn distance(&self, axis: usize, window: Window, about: f64, polynomial: &[f64]) -> f64 {
        let shift = Interval::point(window.middle);
        let off = Interval::point(self.middle) + shift - Interval::point(about);
        let polynomial = points(polynomial);
        let centre = points(&self.centre[axis]);
        let own = |k: usize| coefficient(&centre, k, shift);
        let differences: Vec<Interval> =
            (0..polynomial.len().max(ORDER + 1)).map(|k| own(k) - coefficient(&polynomial, k, off)).collect();
        // coefficients of both signs cancel, which shows on short parts
        let half = window.half / PARTS as f64;
        let part = |k: usize| {
            let off = Interval::point((2 * k + 1) as f64) * Interval::point(half) - Interval::point(window.half);
            largest((0..differences.len()).map(|k| coefficient(&differences, k, off)), half)
        };
        let most = (0..PARTS).map(|k| part(k).hi).fold(0.0, f64::max);
        (Interval::point(most) + Interval::point(self.radii[axis])).hi
    }
}

fn points(numbers: &[f64]) -> Vec<Interval> {
    numbers.iter().copied().map(Interval::point).collect()
}

/// Coefficient k of a polynomial about another point, at a distance.
fn coefficient(polynomial: &[Interval], k: usize, distance: Interval) -> Interval {
    let mut binomial = 1.0;
    let mut weighted: Vec<Interval> = Vec::new();
    for (j, c) in polynomial.iter().enumerate().skip(k) {
        if j > k {
            binomial = binomial * j as f64 / (j - k) as f64;
        }
        weighted.push(*c * Interval::point(binomial));
    }
    weighted.into_iter().rev().fold(Interval::point(0.0), |sum, c| sum * distance + c)
}

/// The largest absolute value of a polynomial as far as `half` from its middle, at most.
fn largest(coefficients: impl DoubleEndedIterator<Item = Interval>, half: f64) -> Interval {
    let sizes = coefficients.map(|c| Interval::point(c.magnitude()));
    sizes.rev().fold(Interval::point(0.0), |sum, size| sum * Interval::point(half) + size)
}

/// Proves pieces of a tube.
struct Prover<'p, 'g> {
    problem: &'p PoseProblem<'g>,
    size: usize,
    thin: TaylorEvaluator<'p, Interval>,
    wide: TaylorEvaluator<'p, Interval>,
    jacobian: IntervalEvaluator<'p>,
}

impl<'p, 'g> Prover<'p, 'g> {
    fn new(problem: &'p PoseProblem<'g>) -> Prover<'p, 'g> {
        let system = problem.system();
        let residuals: &Tape = system.residual_tape();
        assert_eq!(residuals.input_count(), system.size() + 1, "one motion");
        Prover {
            problem,
            size: system.size(),
            thin: TaylorEvaluator::new(residuals, ORDER),
            wide: TaylorEvaluator::new(residuals, ORDER + 1),
            jacobian: IntervalEvaluator::new(system.tape()),
        }
    }

    /// Pieces from a value of the motion to another one, in this order.
    fn towards(&mut self, from: &Posture, about: f64, to: f64, whole: f64) -> Result<Vec<Piece>, Unproven> {
        let mut pieces = Vec::new();
        let (mut at, mut posture) = (about, from.clone());
        let mut length = LONGEST * whole;
        while at != to {
            let left = (to - at).abs();
            let step = at + length.copysign(to - at);
            // what is too short to change the motion leads nowhere
            let next = if length < left && step != at { step } else { to };
            let [middle, end] = [0.5 * at + 0.5 * next, next];
            let line = self.problem.follow(&posture, &[vec![at], vec![middle], vec![end]]);
            let piece = line.iter().all(Posture::is_root).then(|| self.piece(&line[1], middle, at, next)).flatten();
            let is_thin = |piece: &Piece| {
                let sizes = piece.centre.iter().map(|c| c[0].abs().max(100.0));
                piece.radii.iter().zip(sizes).all(|(radius, size)| *radius <= THIN * size)
            };
            match piece.filter(|piece| is_thin(piece) || length <= SHORT_ENOUGH * whole) {
                Some(piece) => {
                    pieces.push(piece);
                    (at, posture) = (next, line[2].clone());
                    length = (2.0 * length).min(LONGEST * whole);
                }
                None if length > SHORTEST * whole => length = 0.5 * length.min(left),
                None => return Err(Unproven { at }),
            }
        }
        Ok(pieces)
    }

    /// A piece about a posture in its middle.
    fn piece(&mut self, posture: &Posture, middle: f64, from: f64, to: f64) -> Option<Piece> {
        let centre = self.problem.series(posture, &[middle], 0, ORDER)?;
        let distance = |end: f64| (Interval::point(end) - Interval::point(middle)).magnitude();
        let half = distance(from).max(distance(to));
        let mut piece = Piece { middle, half, centre, radii: vec![0.0; self.size] };
        let start: Vec<f64> = piece.centre.iter().map(|c| c[0]).collect();
        let inverse = self.inverse(&start, middle)?;
        let off = self.residual(&piece, &inverse)?;
        // a rounding of a millimetre or a radian is room enough where an axis stands in zero
        let rounding = |c: &Vec<f64>| f64::EPSILON * c[0].abs().max(1.0);
        piece.radii = off.iter().zip(&piece.centre).map(|(r, c)| 2.0 * r + rounding(c)).collect();
        for _ in 0..WIDENINGS {
            let wander = self.wander(&boxed(&piece), piece.motion(), &inverse, &piece.radii)?;
            let needed: Vec<f64> =
                off.iter().zip(wander).map(|(r, by)| (Interval::point(*r) + Interval::point(by)).hi).collect();
            if needed.iter().zip(&piece.radii).all(|(needed, radius)| needed < radius) {
                // the root lies as near as that
                return Some(Piece { radii: needed, ..piece });
            }
            piece.radii = needed.iter().zip(&piece.radii).map(|(needed, radius)| 1.5 * needed.max(*radius)).collect();
        }
        None
    }

    /// Whether two neighbours enclose the same root where they meet: there is only one in the smallest box that holds both.
    fn joins(&mut self, left: &Piece, right: &Piece) -> bool {
        // at any value of the motion that both have
        let at = left.motion().intersection(right.motion());
        let sides = [left, right].map(|piece| {
            let by = at - Interval::point(piece.middle);
            values(piece, by)
        });
        let hull: Vec<Interval> = sides[0].iter().zip(&sides[1]).map(|(a, b)| a.hull(*b)).collect();
        let radii: Vec<f64> = hull.iter().map(|x| x.width()).collect();
        let middle: Vec<f64> = hull.iter().map(|x| x.middle()).collect();
        let inverse = self.inverse(&middle, at.middle());
        let proven = inverse.and_then(|inverse| self.wander(&hull, at, &inverse, &radii));
        proven.is_some_and(|wander| wander.iter().zip(&radii).all(|(wander, radius)| wander < radius))
    }

    /// About the inverse of the Jacobian at a point, row by row.
    fn inverse(&mut self, unknowns: &[f64], motion: f64) -> Option<Vec<f64>> {
        let n = self.size;
        let outputs = self.linearized(&points(unknowns), Interval::point(motion))?;
        let mut matrix: Vec<f64> = outputs[n..].iter().map(|entry| entry.middle()).collect();
        let mut inverse: Vec<f64> = (0..n * n).map(|k| if k % (n + 1) == 0 { 1.0 } else { 0.0 }).collect();
        eliminate(&mut matrix, &mut inverse, n).then_some(inverse)
    }

    /// Residuals, then the Jacobian row by row, on a box; `None` where they are not continuous.
    fn linearized(&mut self, unknowns: &[Interval], motion: Interval) -> Option<Vec<Interval>> {
        let inputs: Vec<Interval> = unknowns.iter().copied().chain([motion]).collect();
        let mut outputs = vec![Interval::WHOLE; self.size * (1 + self.size)];
        self.jacobian.run(&inputs, &mut outputs);
        outputs.iter().all(|output| output.continuous).then_some(outputs)
    }

    /// |1 − Y J| ρ on a box.
    fn wander(&mut self, unknowns: &[Interval], motion: Interval, inverse: &[f64], radii: &[f64]) -> Option<Vec<f64>> {
        let n = self.size;
        let outputs = self.linearized(unknowns, motion)?;
        let jacobian = |row: usize, column: usize| outputs[n * (1 + row) + column];
        let row = |i: usize| {
            let each = (0..n).map(|k| {
                let start = Interval::point(if i == k { 1.0 } else { 0.0 });
                let entry = (0..n).fold(start, |sum, j| sum - Interval::point(inverse[n * i + j]) * jacobian(j, k));
                Interval::point(entry.magnitude()) * Interval::point(radii[k])
            });
            each.fold(Interval::point(0.0), |sum, part| sum + part).hi
        };
        Some((0..n).map(row).collect())
    }

    /// How large Y F(P) is on a piece, at most.
    fn residual(&mut self, piece: &Piece, inverse: &[f64]) -> Option<Vec<f64>> {
        let n = self.size;
        let terms = ORDER + 1;
        let one = Interval::point(1.0);
        let mut outputs = vec![Interval::WHOLE; n * terms];
        let mut inputs: Vec<Interval> = piece.centre.iter().flatten().copied().map(Interval::point).collect();
        inputs.resize((n + 1) * terms, Interval::point(0.0));
        (inputs[n * terms], inputs[n * terms + 1]) = (Interval::point(piece.middle), one);
        self.thin.run(&inputs, &mut outputs);
        let more = terms + 1;
        let mut beyond = vec![Interval::WHOLE; n * more];
        let shifted = |c: &Vec<f64>| (0..more).map(|k| coefficient(&points(c), k, piece.reach())).collect::<Vec<_>>();
        let mut inputs: Vec<Interval> = piece.centre.iter().flat_map(shifted).collect();
        inputs.resize((n + 1) * more, Interval::point(0.0));
        (inputs[n * more], inputs[n * more + 1]) = (piece.motion(), one);
        self.wide.run(&inputs, &mut beyond);
        if !outputs.iter().chain(&beyond).all(|x| x.continuous) {
            return None;
        }
        let of = |i: usize| {
            let weighted = |k: usize| {
                let of = |j: usize| if k < terms { outputs[terms * j + k] } else { beyond[more * j + k] };
                (0..n).fold(Interval::point(0.0), |sum, j| sum + Interval::point(inverse[n * i + j]) * of(j))
            };
            largest((0..more).map(weighted), piece.half).hi
        };
        Some((0..n).map(of).collect())
    }
}

/// The unknowns in a piece.
fn boxed(piece: &Piece) -> Vec<Interval> {
    values(piece, piece.reach())
}

/// The unknowns at some distance from the middle of a piece.
fn values(piece: &Piece, by: Interval) -> Vec<Interval> {
    let of = |(c, radius): (&Vec<f64>, &f64)| coefficient(&points(c), 0, by) + Interval::new(-radius, *radius);
    piece.centre.iter().zip(&piece.radii).map(of).collect()
}
