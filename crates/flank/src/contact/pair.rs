//! The pair of a `contact` statement as a problem for the solver.

use std::f64::consts::TAU;

use flank_chain_dsl::{Contact, GeneratedSurface, Job, Parameter, Solid, SolidForm};
use flank_expr::geometry::{Axis, Chain, Step};
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{BoundSurface, ContactProblem, GapProblem, Outline, Range, RollingPair, SurfacePoint};

use crate::contact::sampled;
use crate::project::failure::Failure;
use crate::project::session::Session;
use crate::project::units;
use crate::solve::{self, SolveOptions, blank, bound, ranges};

/// A pair turns evenly, and as its numbers of teeth say, if pitches differ by less than this share.
const EVEN: f64 = 1e-12;

/// Both flanks of a contact, with solved points of each and the solids that they belong to.
pub(crate) struct Members<'j, 'g> {
    pub(crate) contact: &'j Contact<'g>,
    pub(crate) surfaces: [&'j GeneratedSurface<'g>; 2],
    pub(crate) solids: [Option<&'j Solid>; 2],
    pub(crate) bound: [BoundSurface<'g>; 2],
    /// The points that the samples of both ask for.
    pub(crate) points: [Vec<SurfacePoint>; 2],
    /// Which tooth of the second member meets the first: so many pitches from the one that the spec describes.
    pub(crate) tooth: i32,
    /// Whether a flank without a solid ends where its sample does: that is known of lines of contact alone.
    pub(crate) ends_at_sample: bool,
}

impl<'j, 'g> Members<'j, 'g> {
    /// The flanks that a contact names.
    ///
    /// # Errors
    /// If a flank is not sampled, or the work is cancelled.
    pub(crate) fn solved(
        job: &'j Job<'g>,
        contact: &'j Contact<'g>,
        session: Session,
    ) -> Result<Members<'j, 'g>, Failure> {
        let [first, second] = contact.surfaces;
        let points = [points(job, contact, first, session)?, points(job, contact, second, session)?];
        Ok(Members::of(job, contact, contact.surfaces, points))
    }

    /// A surface of each member with its points: the flanks, or others in the same frames.
    fn of(
        job: &'j Job<'g>,
        contact: &'j Contact<'g>,
        surfaces: [usize; 2],
        points: [Vec<SurfacePoint>; 2],
    ) -> Members<'j, 'g> {
        // a bar has no axis to turn about, and one tooth says nothing of others that differ
        let is_even = |solid: &&Solid| solid.form == SolidForm::Turned && solid.each.is_none();
        let solid_of = |at: usize| job.solids.iter().filter(is_even).find(|solid| solid.space.contains(&at));
        let of_job = surfaces.map(|at| &job.surfaces[at]);
        Members {
            contact,
            surfaces: of_job,
            solids: surfaces.map(solid_of),
            bound: of_job.map(|surface| bound(job, surface)),
            points,
            tooth: 0,
            ends_at_sample: false,
        }
    }

    /// Where a member's teeth end, as far as it is known.
    pub(crate) fn outline(&self, member: usize) -> Option<Outline> {
        let sampled = || self.ends_at_sample.then(|| sampled::outline(self.surfaces[member], &self.points[member]));
        self.solids[member].map(blank::outline).or_else(|| sampled().flatten())
    }

    /// How many teeth each member has, where its solid says so.
    pub(crate) fn teeth(&self) -> [Option<u32>; 2] {
        self.solids.map(|solid| solid.map(|solid| solid.teeth))
    }

    /// The other surfaces of a member's tooth space.
    pub(crate) fn space(&self, job: &Job<'g>, member: usize) -> Vec<usize> {
        let space = self.solids[member].map_or(&[][..], |solid| &solid.space);
        space.iter().copied().filter(|at| job.surfaces[*at].name != self.surfaces[member].name).collect()
    }

    /// The other surfaces of each member's tooth space, each with the mate's flank, that are sampled; and the names of those that are not.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(crate) fn beside(
        &self,
        job: &'j Job<'g>,
        session: Session,
    ) -> Result<(Vec<Members<'j, 'g>>, Vec<&'j str>), Failure> {
        let (mut found, mut unknown) = (Vec::new(), Vec::new());
        for member in [0, 1] {
            for at in self.space(job, member) {
                if job.surfaces[at].sample.is_none() {
                    unknown.push(job.surfaces[at].name.as_str());
                    continue;
                }
                let own = points(job, self.contact, at, session)?;
                let (mut surfaces, mut both) = (self.contact.surfaces, self.points.clone());
                (surfaces[member], both[member]) = (at, own);
                let (tooth, ends_at_sample) = (self.tooth, self.ends_at_sample);
                found.push(Members { tooth, ends_at_sample, ..Members::of(job, self.contact, surfaces, both) });
            }
        }
        Ok((found, unknown))
    }

    /// The pair mounted with errors, one for each axis of the pair's machine; those in `open` stay symbols by which the contact is
    /// differentiated.
    pub(crate) fn pair(&self, job: &Job<'g>, errors: &[f64], open: &[usize]) -> RollingPair<'_, 'g> {
        self.mounted(self.bound.each_ref(), &job.bindings(), (errors, open))
    }

    /// The pair with flanks that may have symbols left.
    fn mounted<'b>(
        &self,
        surfaces: [&'b BoundSurface<'g>; 2],
        values: &[(Expr<'g>, Expr<'g>)],
        (errors, open): (&[f64], &[usize]),
    ) -> RollingPair<'b, 'g> {
        let Contact { placements, roll, lag, errors: axes, .. } = self.contact;
        let graph = roll.variable.graph();
        let closed = axes.iter().zip(errors).enumerate().filter(|(at, _)| !open.contains(at));
        let closed = closed.map(|(_, (axis, error))| (axis.variable, graph.constant(*error)));
        let given: Vec<(Expr<'g>, Expr<'g>)> = closed.chain(values.iter().copied()).collect();
        let [first, second] = placements.each_ref().map(|placement| placement.substituted(&given));
        RollingPair {
            surfaces,
            placements: [first, self.of_tooth(second)],
            roll: roll.variable,
            lag: (lag.variable, Range { low: lag.low, high: lag.high }),
            outlines: [0, 1].map(|member| self.outline(member)),
            parameters: open.iter().map(|at| (axes[*at].variable, errors[*at])).collect(),
        }
    }

    /// The placement of the second member's tooth.
    fn of_tooth(&self, placement: Chain<'g>) -> Chain<'g> {
        let Some(solid) = self.solids[1].filter(|_| self.tooth != 0) else { return placement };
        let graph = self.contact.roll.variable.graph();
        let turn = graph.constant(f64::from(self.tooth) * TAU / f64::from(solid.teeth));
        placement.then(&Chain::new(graph, vec![Step::Rotate(Axis::Z, turn)]))
    }

    /// The equations of the pair in which all its axes and then all settings of the job are symbols, but for what is counted, whose value
    /// stands there.
    pub(crate) fn open_problem(&self, job: &Job<'g>, errors: &[f64]) -> ContactProblem {
        let graph = self.contact.roll.variable.graph();
        let (counts, settings): (Vec<_>, Vec<_>) = job.parameters.iter().partition(|parameter| parameter.is_count);
        let counts: Vec<(Expr<'g>, Expr<'g>)> =
            counts.iter().map(|count| (count.variable, graph.constant(count.value))).collect();
        let bound = self.surfaces.map(|surface| BoundSurface::new(&surface.surface, ranges(surface), &counts));
        let axes: Vec<usize> = (0..errors.len()).collect();
        let mut pair = self.mounted(bound.each_ref(), &counts, (errors, &axes));
        pair.parameters.extend(settings.iter().map(|setting| (setting.variable, setting.value)));
        ContactProblem::new(&pair).expect("a job without errors leaves nothing unbound")
    }

    /// The equations of the pair as it is mounted, in some settings; what is defined by them follows.
    pub(crate) fn problem_in(&self, job: &Job<'g>, settings: &[&Parameter<'g>]) -> ContactProblem {
        let open: Vec<Expr<'g>> = settings.iter().map(|setting| setting.variable).collect();
        let values = job.bindings_beside(&open);
        let bound = self.surfaces.map(|surface| BoundSurface::new(&surface.surface, ranges(surface), &values));
        let errors = vec![0.0; self.contact.errors.len()];
        let mut pair = self.mounted(bound.each_ref(), &values, (&errors, &[]));
        pair.parameters = settings.iter().map(|setting| (setting.variable, setting.value)).collect();
        ContactProblem::new(&pair).expect("a job without errors leaves nothing unbound")
    }

    /// The equations of the pair, and those of the gaps from each member to the other, in which some of its axes and then some settings are
    /// symbols; what is defined by these follows. `None` where one of them changes how the members turn, and with that the pitch.
    pub(crate) fn open_in(
        &self,
        job: &Job<'g>,
        axes: &[usize],
        settings: &[&Parameter<'g>],
    ) -> Option<(ContactProblem, [GapProblem; 2])> {
        let Contact { roll, lag, errors, .. } = self.contact;
        let open: Vec<Expr<'g>> = settings.iter().map(|setting| setting.variable).collect();
        let values = job.bindings_beside(&open);
        let bound = self.surfaces.map(|surface| BoundSurface::new(&surface.surface, ranges(surface), &values));
        let mut pair = self.mounted(bound.each_ref(), &values, (&vec![0.0; errors.len()], axes));
        pair.parameters.extend(settings.iter().map(|setting| (setting.variable, setting.value)));
        let of_placement = |placement: &Chain<'g>| {
            [roll.variable, lag.variable].map(|variable| placement.twist(variable).angular.0[2])
        };
        let turns: Vec<Expr<'g>> = pair.placements.iter().flat_map(of_placement).collect();
        let known = roll.variable.graph().variables_of(&turns);
        let is_known = |variable: &Expr<'g>| variable.as_variable().is_some_and(|variable| known.contains(&variable));
        if pair.parameters.iter().any(|(variable, _)| is_known(variable)) {
            return None;
        }
        let unbound = "a job without errors leaves nothing unbound";
        let gaps = [0, 1].map(|member| GapProblem::new(&pair, member).expect(unbound));
        Some((ContactProblem::new(&pair).expect(unbound), gaps))
    }

    /// Of settings, those that change the first flank alone: neither the second one nor how both are mounted.
    pub(crate) fn of_first<'p>(&self, job: &Job<'g>, settings: &[&'p Parameter<'g>]) -> Vec<&'p Parameter<'g>> {
        let open: Vec<Expr<'g>> = settings.iter().map(|setting| setting.variable).collect();
        let values = job.bindings_beside(&open);
        let surface = self.surfaces[1];
        let second = BoundSurface::new(&surface.surface, ranges(surface), &values);
        let second = second.surface();
        let all = [&second.position.0[..], &second.normal.0, &second.constraints].concat();
        let known = self.contact.roll.variable.graph().variables_of(&all);
        let placements = self.contact.placements.each_ref().map(|placement| placement.substituted(&values));
        let moves = |variable: Expr<'g>| placements.iter().any(|placement| !placement.twist(variable).is_zero());
        let is_free = |setting: &&&'p Parameter<'g>| {
            let changes = setting.variable.as_variable().is_some_and(|variable| known.contains(&variable));
            !changes && !moves(setting.variable)
        };
        settings.iter().filter(is_free).copied().collect()
    }

    /// How far the members roll from one pair of teeth to the next: as the spec says, or by the teeth of both solids, which turn evenly.
    pub(crate) fn pitch(&self, job: &Job<'g>) -> Option<f64> {
        if self.contact.every.is_some() {
            return self.contact.every;
        }
        let [Some(first), Some(second)] = self.solids else { return None };
        let pitch = |of_roll: [f64; 2]| {
            [first, second].into_iter().zip(of_roll).map(|(solid, turn)| TAU / f64::from(solid.teeth) / turn.abs())
        };
        let all: Vec<f64> = self.along_the_roll(job).into_iter().flat_map(pitch).collect();
        let is_even = all.iter().all(|pitch| (pitch / all[0] - 1.0).abs() < EVEN);
        is_even.then_some(all[0])
    }

    /// Whether both members turn evenly with the roll.
    pub(crate) fn is_even(&self, job: &Job<'g>) -> bool {
        let all = self.along_the_roll(job);
        all.iter().flat_map(|of| of.iter().zip(&all[0])).all(|(turn, first)| (turn / first - 1.0).abs() < EVEN)
    }

    /// How fast each member turns with the roll, at some of its positions.
    fn along_the_roll(&self, job: &Job<'g>) -> [[f64; 2]; 4] {
        [0.0, 0.3, 0.6, 1.0].map(|share| self.turns(job, share)[0])
    }

    /// How fast each member turns about its axis with the roll, then with the unknown, at a share of the range of the roll.
    pub(crate) fn turns(&self, job: &Job<'g>, share: f64) -> [[f64; 2]; 2] {
        let Contact { roll, lag, errors, .. } = self.contact;
        let pair = self.pair(job, &vec![0.0; errors.len()], &[]);
        let of =
            |variable: Expr<'g>| pair.placements.each_ref().map(|placement| placement.twist(variable).angular.0[2]);
        let all = [of(roll.variable), of(lag.variable)].concat();
        let tape =
            Tape::new(&all, &[roll.variable, lag.variable]).expect("a job without errors leaves nothing unbound");
        let mut out = [0.0; 4];
        let at = [roll.low + share * (roll.high - roll.low), 0.5 * (lag.low + lag.high)];
        ScalarEvaluator::new(&tape).run(&at, &mut out);
        [[out[0], out[1]], [out[2], out[3]]]
    }
}

impl<'g> Members<'_, 'g> {
    /// # Errors
    /// If the range of the unknown holds two teeth.
    pub(crate) fn check_range(&self, job: &Job<'g>) -> Result<(), Failure> {
        let Contact { name, lag, roll, errors, .. } = self.contact;
        let pair = self.pair(job, &vec![0.0; errors.len()], &[]);
        for (solid, placement) in self.solids.iter().zip(&pair.placements) {
            let turn = placement.twist(lag.variable).angular.0[2];
            let tape = Tape::new(&[turn], &[roll.variable, lag.variable])
                .expect("a job without errors leaves nothing unbound");
            let mut turn = [0.0];
            ScalarEvaluator::new(&tape).run(&[0.5 * (roll.low + roll.high), 0.5 * (lag.low + lag.high)], &mut turn);
            let Some(solid) = solid.filter(|_| turn[0] != 0.0) else { continue };
            let (apart, width) = (TAU / f64::from(solid.teeth) / turn[0].abs(), lag.high - lag.low);
            if width > 0.5 * apart {
                let text = |value: f64| units::text(lag.dimension, value, 3);
                return Err(Failure::from(format!(
                    "contact {name}: the range of `{}` is {} wide and may hold two teeth: those of {} are {} apart; a range of at most \
                     {} holds one",
                    lag.name,
                    text(width),
                    solid.name,
                    text(apart),
                    text(0.5 * apart)
                )));
            }
        }
        Ok(())
    }
}

/// The points that the sample of a surface asks for.
fn points<'g>(
    job: &Job<'g>,
    contact: &Contact<'g>,
    surface: usize,
    session: Session,
) -> Result<Vec<SurfacePoint>, Failure> {
    let surface = &job.surfaces[surface];
    let name = &surface.name;
    let sample = surface.sample.as_ref().ok_or(format!(
        "contact `{}`: `{name}` is not sampled: the contact is looked for from its points; add `sample {name} {{ … }}`",
        contact.name
    ))?;
    let _working = session.begin(format!("solving {name}"))?;
    let wanted = SolveOptions {
        geometry: false,
        sensitivity: false,
        certificates: false,
        together: None,
        arrays: false,
        of_shown: false,
        session,
    };
    Ok(solve::points(job, surface, sample, wanted).points)
}
