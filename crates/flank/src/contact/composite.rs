//! The composite lag as a function of the roll, for what asks for it at very many places.

use flank_solver::ContactPoint;

use crate::contact::rolling::Rolling;

/// Between roll positions the polynomial through lag and both of its derivatives at both, where one contact goes on from one to the next; elsewhere
/// the contact is solved.
pub(crate) struct CompositeLag<'r> {
    rolling: &'r Rolling,
    /// In the order of the roll, without a gap from the first to the last.
    stretches: Vec<Stretch>,
}

/// Halves of the way from one roll position to the next in which the contact goes from one edge to another: what is left is too little to be asked for.
const HALVINGS: usize = 12;

/// From one roll position to another one, with the contact that carries at each, as it is just within.
struct Stretch {
    pair: isize,
    ends: [Option<ContactPoint>; 2],
    rolls: [f64; 2],
}

impl<'r> CompositeLag<'r> {
    /// Between roll positions in their order.
    pub(crate) fn new(rolling: &'r Rolling, rolls: &[f64]) -> CompositeLag<'r> {
        let of = rolling.looked_at();
        let middle = rolling.middle().map_or(f64::NAN, |middle| middle.roll);
        let at = |roll: f64| {
            let step = (roll - middle) / of.pitch * of.steps as f64;
            let near = step.round();
            let is_step = (step - near).abs() < 1e-9;
            let carried = is_step.then(|| of.carried(near as isize)).flatten().filter(|_| rolling.has_pitch);
            match carried {
                Some(carried) => {
                    let step = near as isize;
                    of.point(carried.pair, step).map(|point| (carried.pair, Some(step), point.clone()))
                }
                None if rolling.has_pitch => None,
                None => Some((0, None, rolling.problem.pair_at(of, 0, roll)?)),
            }
        };
        let known: Vec<Option<(isize, Option<isize>, ContactPoint)>> = rolls.iter().map(|roll| at(*roll)).collect();
        let stretches = rolls.windows(2).zip(known.windows(2)).map(|(rolls, known)| {
            let rolls = [rolls[0], rolls[1]];
            let pair = known.iter().flatten().map(|(pair, ..)| *pair).next().unwrap_or_default();
            let ends = match known {
                // both ends of where a pair hands over are those of the pair that carries on this side
                [Some((pair, _, point)), None] => [Some(point.clone()), rolling.problem.pair_at(of, *pair, rolls[1])],
                [None, Some((pair, _, point))] => [rolling.problem.pair_at(of, *pair, rolls[0]), Some(point.clone())],
                [Some((a, _, first)), Some((b, _, second))] if a == b => [Some(first.clone()), Some(second.clone())],
                // two pairs that turn alike hand nothing over
                [Some((pair, _, first)), Some((_, Some(step), _))] => {
                    [Some(first.clone()), of.point(*pair, *step).cloned()]
                }
                _ => [None, None],
            };
            Stretch { pair, ends, rolls }
        });
        let stretches = stretches.flat_map(|stretch| stretch.in_parts(rolling, HALVINGS));
        CompositeLag { rolling, stretches: stretches.collect() }
    }

    /// At a roll position; `None` where no pair of teeth touches.
    pub(crate) fn at(&self, roll: f64) -> Option<f64> {
        let after = self.stretches.partition_point(|stretch| stretch.rolls[1] < roll);
        let known = self.stretches.get(after).filter(|stretch| stretch.rolls[0] <= roll);
        known.and_then(|stretch| stretch.lag(roll)).or_else(|| match self.rolling.has_pitch {
            true => self.rolling.lag_at(roll),
            false => Some(self.rolling.problem.pair_at(self.rolling.looked_at(), 0, roll)?.lag),
        })
    }
}

impl Stretch {
    /// In halves as long as the contact goes from one edge to another within.
    fn in_parts(self, rolling: &Rolling, halvings: usize) -> Vec<Stretch> {
        let Stretch { pair, ends, rolls: [begin, end] } = &self;
        let goes_on = ends.iter().flatten().map(|point| &point.edges).is_sorted_by(|a, b| a == b);
        if goes_on || halvings == 0 {
            return vec![self];
        }
        let middle = 0.5 * (begin + end);
        let point = rolling.problem.pair_at(rolling.looked_at(), *pair, middle);
        let [first, last] = ends.clone();
        let part = |ends, rolls| Stretch { pair: *pair, ends, rolls }.in_parts(rolling, halvings - 1);
        let before = part([first, point.clone()], [*begin, middle]);
        before.into_iter().chain(part([point, last], [middle, *end])).collect()
    }

    fn lag(&self, roll: f64) -> Option<f64> {
        let [Some(first), Some(last)] = &self.ends else { return None };
        let width = self.rolls[1] - self.rolls[0];
        let of =
            |point: &ContactPoint| [point.lag, width * point.lag_slopes[0], 0.5 * width * width * point.lag_slopes[1]];
        let ([a0, a1, a2], [b0, b1, b2]) = (of(first), of(last));
        // what is missing at the end of the series from the beginning: of the value and both derivatives there
        let (off, slope, bend) = (b0 - a0 - a1 - a2, b1 - a1 - 2.0 * a2, 2.0 * (b2 - a2));
        let cubic = [
            10.0 * off - 4.0 * slope + 0.5 * bend,
            -15.0 * off + 7.0 * slope - bend,
            6.0 * off - 3.0 * slope + 0.5 * bend,
        ];
        let s = (roll - self.rolls[0]) / width;
        let lag = a0 + s * (a1 + s * (a2 + s * (cubic[0] + s * (cubic[1] + s * cubic[2]))));
        (first.edges == last.edges && lag.is_finite()).then_some(lag)
    }
}
