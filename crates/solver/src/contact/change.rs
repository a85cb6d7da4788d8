//! What a mounting error or a setting changes of a contact.
//!
//! The unknowns have power series along any direction of roll and parameter together. Mixed derivatives come from series along different
//! directions: of those along (1, t) and (1, −t) the part that is odd in t.

use flank_expr::TaylorEvaluator;

use crate::contact::ContactProblem;
use crate::contact::point::ContactPoint;

/// The step over which the gap's curvatures are differenced, as a share of the ranges: its square, and rounding over it, are below 1e-10.
const STEP: f64 = 1e-5;

/// By how much a contact changes with parameters, per unit of their change. Lengths are mm, angles radians.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactChange {
    /// Of the roll position, where the contact is followed as the vertex of the lag; zero where the roll is held.
    pub roll: f64,
    /// Of the lag.
    pub lag: f64,
    /// Of the first derivative of the lag by the roll, at the roll position that it had.
    pub lag_slope: f64,
    /// Of the second derivative of the lag by the roll.
    pub lag_curvature: f64,
    /// How the point moves, in the frame of each member, mm.
    pub moved: [[f64; 3]; 2],
    /// Of the curvatures of the gap, 1/mm, the greater first; `None` where an edge touches.
    pub gap: Option<[f64; 2]>,
}

/// How a point of contact moves over both members, and what becomes of the gap.
struct Moved {
    over: [[f64; 3]; 2],
    gap: Option<[f64; 2]>,
}

impl ContactProblem {
    /// What a change of parameters changes, each by its number with its share in the change: at the vertex of the lag, if the point is it
    /// and stays it, else at the same roll position. `None` where the contact is singular.
    pub fn change(&self, at: &ContactPoint, of: &[(usize, f64)], is_vertex: bool) -> Option<ContactChange> {
        let (unknowns, lag) = (at.all_unknowns(), self.lag_at());
        let (system, parameters) = self.equations(&at.edges, at.roll, &at.first_normal.into())?;
        let along = |roll: f64, change: f64| {
            let changed = of.iter().map(|(parameter, share)| (1 + parameter, share * change));
            let rates: Vec<(usize, f64)> = [(0, roll)].into_iter().chain(changed).collect();
            system.series(&unknowns, &parameters, &rates, 3)
        };
        let (rolled, changed) = (along(1.0, 0.0)?, along(0.0, 1.0)?);
        let (both, against) = (along(1.0, 1.0)?, along(1.0, -1.0)?);
        let lag_slope = 0.5 * (both[lag][2] - against[lag][2]);
        let at_roll = both[lag][3] - against[lag][3] - 2.0 * changed[lag][3];
        let roll = if is_vertex { -lag_slope / (2.0 * rolled[lag][2]) } else { 0.0 };
        let rates: Vec<f64> =
            rolled.iter().zip(&changed).map(|(rolled, changed)| changed[1] + roll * rolled[1]).collect();
        let Moved { over: moved, gap } = self.moved(at, of, roll, &rates)?;
        Some(ContactChange {
            roll,
            lag: rates[lag],
            lag_slope,
            lag_curvature: at_roll + 6.0 * rolled[lag][3] * roll,
            moved,
            gap,
        })
    }

    /// How the point moves over both members, and what becomes of the gap, where the unknowns change at these rates.
    fn moved(&self, at: &ContactPoint, of: &[(usize, f64)], roll: f64, rates: &[f64]) -> Option<Moved> {
        let values = at.all_unknowns().into_iter().chain(self.given(at.roll));
        let share = |k: usize| of.iter().find(|(parameter, _)| *parameter == k).map_or(0.0, |(_, share)| *share);
        let speeds = rates.iter().copied().chain([roll]).chain((0..self.values.len()).map(share));
        let inputs: Vec<f64> = values.zip(speeds).flat_map(|(value, speed)| [value, speed]).collect();
        let mut outputs = vec![0.0; 2 * self.state.output_count()];
        TaylorEvaluator::new(&self.state, 1).run(&inputs, &mut outputs);
        let members = |step: f64| {
            let out: Vec<f64> = outputs.chunks(2).map(|series| series[0] + step * series[1]).collect();
            self.members_from(&out)
        };
        let fastest =
            rates.iter().zip(&self.ranges).map(|(rate, range)| (rate / range.width()).abs()).fold(0.0, f64::max);
        let step = STEP / fastest.max(f64::MIN_POSITIVE);
        let [before, after] = [-step, step].map(members);
        let moved = [0, 1].map(|k| <[f64; 3]>::from((after[k].own - before[k].own) / (2.0 * step)));
        let gaps = [&before, &after].map(|members| self.gap(members).map(|gap| gap.principal()));
        let gap = match gaps {
            [Some(before), Some(after)] if at.edges.is_empty() => {
                Some([after.k1 - before.k1, after.k2 - before.k2].map(|change| change / (2.0 * step)))
            }
            _ => None,
        };
        moved.iter().flatten().all(|x| x.is_finite()).then_some(Moved { over: moved, gap })
    }
}
