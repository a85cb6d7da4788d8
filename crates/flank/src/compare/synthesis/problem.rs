//! The settings of a contact as unknowns, and what is wanted of it as least squares.

use std::ops::Range;

use flank_chain_dsl::{Job, Parameter};
use flank_solver::{
    ContactPoint, ContactProblem, ContactSynthesis, ContactWish, ScaledUnknown, SynthesizedContact, most_independent,
};

use super::Condition;
use crate::compare::fit::corrected;
use crate::compare::fit::settings::{beside, held, open, steps, unknown};
use crate::contact::pair::Members;
use crate::project::failure::Failure;
use crate::project::remark::{Remark, RemarkKind};
use crate::project::requests::SynthesisRequest;

/// A setting whose scale changes the contact by what is worth less than this, mm, changes nothing: rounding.
const NOTHING: f64 = 1e-9;
/// What a setting does of its own is more than this share of what it does.
const OWN: f64 = 1e-6;

/// Settings that may change, and a contact that is known with those of the job.
pub(super) struct Problem<'p, 'g> {
    /// Those that are looked for, in the order of the job.
    pub(super) settings: Vec<&'p Parameter<'g>>,
    /// What each is set in steps of.
    pub(super) steps: Vec<Option<f64>>,
    /// Of how many the settings were chosen.
    pub(super) chosen_of: Option<usize>,
    /// Those that change the contact and were not chosen.
    pub(super) left: Vec<String>,
    /// Those that were named and change nothing, with why, where others that vary follow them.
    idle: Vec<(String, String)>,
    unknowns: Vec<ScaledUnknown>,
    pair: ContactProblem,
    vertex: &'p ContactPoint,
    wishes: Vec<ContactWish>,
}

impl<'p, 'g> Problem<'p, 'g> {
    /// Where settings are chosen, those of some groups: each does all that those do together which are in none before.
    ///
    /// # Errors
    /// If a setting is not there or cannot be set, or no setting moves the contact.
    pub(super) fn new(
        job: &'p Job<'g>,
        members: &Members<'_, 'g>,
        conditions: &[Condition],
        vertex: &'p ContactPoint,
        (request, groups): (&SynthesisRequest, Range<usize>),
    ) -> Result<Problem<'p, 'g>, Failure> {
        let named = open(job, &request.vary)?;
        if let Some(error) = named.iter().find(|of| of.is_error && !request.vary.is_empty()) {
            let message = format!(
                "option `vary` names `{}`, an error of the machine: a wanted contact is made by what can be set",
                error.name
            );
            return Err(Failure::Input(message));
        }
        let settings: Vec<&Parameter<'g>> = named.into_iter().filter(|of| !of.is_error).collect();
        let settings = if request.vary.is_empty() { members.of_first(job, &settings) } else { settings };
        let wishes: Vec<ContactWish> = conditions.iter().map(|condition| condition.wish).collect();
        let pair = members.problem_in(job, &settings);
        let unknowns: Vec<ScaledUnknown> = settings.iter().map(|of| unknown(of, f64::INFINITY)).collect();
        let whole = ContactSynthesis { problem: &pair, vertex, wishes: wishes.clone(), settings: unknowns };
        let lost = || {
            Failure::Unsolved("a number that is wanted is not there with the settings of the job: the flanks do not touch in a point there".to_string())
        };
        let mut effects = whole.effects().ok_or_else(lost)?;
        let by_roll = effects.pop().unwrap_or_default();
        let size = |of: &[f64]| of.iter().map(|x| x * x).sum::<f64>().sqrt();
        let moving: Vec<usize> = (0..settings.len()).filter(|k| size(&effects[*k]) > NOTHING).collect();
        let is_named = !request.vary.is_empty();
        let taken = match is_named {
            true => moving.clone(),
            false => chosen(&moving, &effects, &by_roll, &groups),
        };
        let is_left = |k: &&usize| !taken.contains(k);
        let left = moving.iter().filter(is_left).map(|k| settings[*k].name.clone()).collect();
        let idle = (0..settings.len()).filter(|k| is_named && !moving.contains(k));
        let idle = idle.map(|k| (settings[k].name.clone(), beside(job, &settings, settings[k]))).collect();
        let settings: Vec<&Parameter<'g>> = taken.iter().map(|k| settings[*k]).collect();
        // what one mm, radian or 1 of a setting changes says by which scale it counts
        let scale = |(k, of): (&usize, &&Parameter<'g>)| unknown(of, size(&effects[*k]) / whole.settings[*k].scale);
        let unknowns: Vec<ScaledUnknown> = taken.iter().zip(&settings).map(scale).collect();
        Ok(Problem {
            steps: steps(&settings, &request.round)?,
            chosen_of: (!is_named).then_some(moving.len()),
            left,
            idle,
            unknowns,
            pair: members.problem_in(job, &settings),
            vertex,
            wishes,
            settings,
        })
    }

    /// Settings that were named and do nothing.
    pub(super) fn idle(&self, request: &SynthesisRequest) -> Vec<Remark> {
        let remark = |(name, beside): &(String, String)| {
            let message = format!("`{name}` changes nothing that {} wants{beside}: it stays", request.want);
            Remark::new(RemarkKind::MovesNothing, name, message)
        };
        self.idle.iter().map(remark).collect()
    }

    /// Settings that do not change the first flank alone: what they do to the mate is counted, and the mate as it is now does not go with it.
    pub(super) fn of_both(&self, job: &'p Job<'g>, members: &Members<'_, 'g>) -> Vec<Remark> {
        let of_first = members.of_first(job, &self.settings);
        let others = self.settings.iter().filter(|of| of_first.iter().all(|first| first.name != of.name));
        let [first, second] = members.surfaces.map(|surface| &surface.name);
        let remark = |of: &&Parameter<'g>| {
            let message = format!(
                "`{}` changes not only {first} but also {second} or how both are mounted: the mate has to be made anew with it, too",
                of.name
            );
            Remark::new(RemarkKind::MovesMate, &of.name, message)
        };
        others.map(remark).collect()
    }

    pub(super) fn is_rounded(&self, k: usize) -> bool {
        self.steps[k].is_some()
    }

    /// The settings that come nearest to what is wanted; those that have a step are brought onto it one by one, and the others looked for
    /// again.
    ///
    /// # Errors
    /// If the contact is lost.
    pub(super) fn solve(&self) -> Result<SynthesizedContact, Failure> {
        let mut unknowns = self.unknowns.clone();
        let mut found = self.with(self.wishes.clone(), &unknowns)?;
        for k in 0..unknowns.len() {
            let Some(step) = self.steps[k] else { continue };
            let flank_solver::Range { low, high } = unknowns[k].range;
            let whole = (found.fit.values[k] / step).round();
            let inside = whole.max((low / step).ceil()).min((high / step).floor());
            unknowns[k] = held(ScaledUnknown { start: inside * step, ..unknowns[k] });
            found = self.with(self.wishes.clone(), &unknowns)?;
        }
        Ok(found)
    }

    /// Whether a search comes to where all conditions hold, before settings are brought onto their steps; in less time than [`Problem::solve`] where
    /// none does.
    pub(super) fn is_met_somewhere(&self) -> bool {
        self.synthesis(self.wishes.clone(), &self.unknowns).met().is_some()
    }

    /// As near to one condition as the others allow, from the settings of the job or from those that were found; `None` where that is not known.
    pub(super) fn nearest(&self, condition: usize, found: &SynthesizedContact) -> Option<ContactPoint> {
        self.synthesis(self.wishes.clone(), &self.unknowns).nearest(condition, found)
    }

    /// Conditions that no search meets together: without any one of them the others are met. One alone
    /// where it is not met by itself.
    pub(super) fn against(&self, is_met: impl Fn(&[usize], &ContactPoint) -> bool) -> Vec<usize> {
        let are_met = |of: &[usize]| {
            let wishes = of.iter().map(|k| self.wishes[*k]).collect();
            self.synthesis(wishes, &self.unknowns).met().is_some_and(|at| is_met(of, &at))
        };
        let all = 0..self.wishes.len();
        // a search that meets nothing takes long: one condition that is out of reach would be in several
        if let Some(alone) = all.clone().find(|k| !are_met(&[*k])) {
            return vec![alone];
        }
        let mut against: Vec<usize> = all.clone().collect();
        for k in all {
            let rest: Vec<usize> = against.iter().copied().filter(|of| *of != k).collect();
            if rest.len() > 1 && !are_met(&rest) {
                against = rest;
            }
        }
        against
    }

    /// What each setting does to each condition for its scale, with the roll last; as the pair is.
    pub(super) fn effects(&self) -> Vec<Vec<f64>> {
        self.synthesis(self.wishes.clone(), &self.unknowns).effects().unwrap_or_default()
    }

    fn with(&self, wishes: Vec<ContactWish>, unknowns: &[ScaledUnknown]) -> Result<SynthesizedContact, Failure> {
        let lost = "the contact is lost: with no settings near those of the job the flanks touch in a point";
        self.synthesis(wishes, unknowns).solve().ok_or(Failure::Unsolved(lost.to_string()))
    }

    fn synthesis(&self, wishes: Vec<ContactWish>, unknowns: &[ScaledUnknown]) -> ContactSynthesis<'_> {
        ContactSynthesis { problem: &self.pair, vertex: self.vertex, wishes, settings: unknowns.to_vec() }
    }

    /// The settings with their new values, as a spec has them.
    pub(super) fn values(&self, found: &SynthesizedContact) -> Vec<(String, String)> {
        let all = self.settings.iter().zip(&found.fit.values);
        all.map(|(of, value)| (of.name.clone(), corrected::value(of.dimension, *value))).collect()
    }
}

/// Of settings that change a contact, those of some groups, in their order: a group does all that those do together which are in none before.
fn chosen(moving: &[usize], effects: &[Vec<f64>], by_roll: &[f64], groups: &Range<usize>) -> Vec<usize> {
    let (mut used, mut chosen): (Vec<usize>, Vec<usize>) = Default::default();
    for group in 0..groups.end {
        let open: Vec<usize> = moving.iter().filter(|k| !used.contains(k)).copied().collect();
        let all: Vec<Vec<f64>> = open.iter().map(|k| effects[*k].clone()).collect();
        let own: Vec<usize> = most_independent(&all, by_roll, OWN).into_iter().map(|k| open[k]).collect();
        used.extend(&own);
        if groups.contains(&group) {
            chosen.extend(own);
        }
    }
    chosen.sort_unstable();
    chosen
}
