//! What samples require of their points.

use flank_chain_dsl::PointRequirement;
use flank_expr::{ScalarEvaluator, Tape};
use flank_solver::Outcome;

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

fn broken_by<'j, 'g>(solved: &Solved<'j, 'g>, limit: &'j PointRequirement<'g>) -> Option<Broken<'j, 'g>> {
    let value = limit.of.value;
    let value = value.graph().substitute(&[value], &solved.bindings);
    let tape =
        Tape::new(&value, &solved.surface.surface.unknowns).expect("a job without errors leaves nothing unbound");
    let (mut evaluator, mut out) = (ScalarEvaluator::new(&tape), [0.0]);
    let (low, high) = limit.ends;
    let mut found =
        Broken { limit, places: Places::new(solved.sample.counts), ends: [f64::INFINITY, f64::NEG_INFINITY] };
    for (at, point) in solved.points.iter().enumerate().filter(|(_, point)| point.outcome == Outcome::Solved) {
        evaluator.run(&point.unknowns, &mut out);
        // written so that what is no number does not hold either
        if !(low <= out[0] && out[0] <= high) {
            found.places.add(at);
            found.ends = [found.ends[0].min(out[0]), found.ends[1].max(out[0])];
        }
    }
    (found.places.count > 0).then_some(found)
}

/// How many points do not hold all that their samples require.
pub(crate) fn missed_points(all: &[Solved<'_, '_>]) -> usize {
    all.iter().flat_map(broken).map(|broken| broken.places.count).sum()
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
