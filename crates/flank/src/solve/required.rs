//! What samples require of their points.

use flank_chain_dsl::{GeneratedSurface, PointRequirement};
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{Outcome, SurfacePoint};

use crate::project::quantity::UnitSymbol;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::units;
use crate::solve::result::MissedRequirement;
use crate::solve::solved::Solved;
use crate::solve::summary::Places;
use crate::solve::unsolved::whereabouts;

/// The solved points of a surface at which a requirement of its sample does not hold.
pub(crate) struct Broken<'j, 'g> {
    limit: &'j PointRequirement<'g>,
    places: Places,
    /// The smallest and the largest value at them.
    ends: [f64; 2],
}

/// One entry for each requirement that does not hold everywhere.
fn broken<'j, 'g>(solved: &Solved<'j, 'g>) -> Vec<Broken<'j, 'g>> {
    solved.sample.limits.iter().filter_map(|limit| broken_by(solved, limit)).collect()
}

/// A number that a sample requires to lie between two ends.
pub(crate) struct RequiredNumber {
    of_unknowns: Tape,
    ends: (f64, f64),
}

impl RequiredNumber {
    /// All that the sample of a surface requires; `bindings` are the values of parameters.
    pub(crate) fn all<'g>(surface: &GeneratedSurface<'g>, bindings: &[(Expr<'g>, Expr<'g>)]) -> Vec<RequiredNumber> {
        let limits = surface.sample.iter().flat_map(|sample| &sample.limits);
        limits.map(|limit| RequiredNumber::new(limit, surface, bindings)).collect()
    }

    fn new<'g>(
        limit: &PointRequirement<'g>,
        surface: &GeneratedSurface<'g>,
        bindings: &[(Expr<'g>, Expr<'g>)],
    ) -> RequiredNumber {
        let value = limit.of.value;
        let value = value.graph().substitute(&[value], bindings);
        let of_unknowns =
            Tape::new(&value, &surface.surface.unknowns).expect("a job without errors leaves nothing unbound");
        RequiredNumber { of_unknowns, ends: limit.ends }
    }

    /// The same that was made while settings were open, with values of them.
    pub(crate) fn with_settings(&self, values: &[f64]) -> RequiredNumber {
        RequiredNumber { of_unknowns: self.of_unknowns.with_settings(values), ends: self.ends }
    }

    /// The solved points at which it does not hold, by their places, with the number there.
    pub(crate) fn missed<'p>(&'p self, points: &'p [SurfacePoint]) -> impl Iterator<Item = (usize, f64)> + 'p {
        let mut evaluator = ScalarEvaluator::new(&self.of_unknowns);
        let (low, high) = self.ends;
        let solved = points.iter().enumerate().filter(|(_, point)| point.outcome == Outcome::Solved);
        solved.filter_map(move |(at, point)| {
            let mut out = [0.0];
            evaluator.run(&point.unknowns, &mut out);
            // written so that what is no number does not hold either
            (!(low <= out[0] && out[0] <= high)).then_some((at, out[0]))
        })
    }
}

fn broken_by<'j, 'g>(solved: &Solved<'j, 'g>, limit: &'j PointRequirement<'g>) -> Option<Broken<'j, 'g>> {
    let mut found =
        Broken { limit, places: Places::new(solved.sample.counts), ends: [f64::INFINITY, f64::NEG_INFINITY] };
    for (at, number) in RequiredNumber::new(limit, solved.surface, &solved.bindings).missed(&solved.points) {
        found.places.add(at);
        found.ends = [found.ends[0].min(number), found.ends[1].max(number)];
    }
    (found.places.count > 0).then_some(found)
}

/// All that does not hold.
pub(crate) fn missed(all: &[Solved<'_, '_>]) -> Vec<NotDone> {
    let of_surface = |solved: &Solved<'_, '_>| {
        let line = |broken: &Broken<'_, '_>| {
            let of = &broken.limit.of;
            let (low, high) = broken.limit.ends;
            let [low, high, least, most] =
                [low, high, broken.ends[0], broken.ends[1]].map(|x| units::digits(of.dimension, x, 4));
            let unit = units::symbol(of.dimension);
            let name = &solved.surface.name;
            let message = format!(
                "not as required: {} of {} points of {name}: {}",
                broken.places.count,
                solved.points.len(),
                broken.limit.message,
            );
            let detail = format!(
                "{}{} is {least} .. {most} {unit}, required is {low} .. {high} {unit}",
                of.name,
                whereabouts(solved, &broken.places),
            );
            NotDone::new(NotDoneKind::NotAsRequired, name, message).with(vec![detail])
        };
        broken(solved).iter().map(line).collect::<Vec<NotDone>>()
    };
    all.iter().flat_map(of_surface).collect()
}

/// The same as data.
pub(crate) fn told(solved: &Solved<'_, '_>) -> Vec<MissedRequirement> {
    let entry = |broken: Broken<'_, '_>| {
        let of = &broken.limit.of;
        let [low, high] = broken.ends.map(|x| Some(units::shown(of.dimension, x)).filter(|x| x.is_finite()));
        MissedRequirement {
            message: broken.limit.message.clone(),
            name: of.name.clone(),
            unit: UnitSymbol::of_dimension(of.dimension),
            points: broken.places.count,
            low,
            high,
        }
    };
    broken(solved).into_iter().map(entry).collect()
}
