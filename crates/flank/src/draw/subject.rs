//! A job with its solved surfaces: what pictures are drawn of.

use flank_chain_dsl::{Job, Machine, RangedVariable};
use flank_export::{Dataset, Header};
use flank_expr::Expr;
use flank_solver::{Outcome, SurfacePoint};

use crate::project::choices::PlotKind;
use crate::project::failure::Failure;
use crate::project::session::Session;
use crate::solve::solved::Solved;
use crate::solve::stream;
use crate::solve::{self, SolveOptions};

pub(crate) struct Subject<'j, 'g> {
    pub(super) job: &'j Job<'g>,
    pub(crate) solved: Vec<Solved<'j, 'g>>,
    /// All surfaces with their fields, in the order of `solved`.
    pub(crate) dataset: Dataset,
    /// The surfaces that maps show, as indices of `solved`; there is one at least.
    pub(super) chosen: Vec<usize>,
    /// The surfaces that are drawn in space.
    pub(super) in_space: Vec<usize>,
    /// For what pictures solve beside the samples.
    pub(super) session: Session<'j>,
}

impl<'j, 'g> Subject<'j, 'g> {
    /// Solves what is to be drawn: surfaces by their names, or all of them if none is named; all kinds but sensitivity, if none
    /// is asked for.
    ///
    /// # Errors
    /// In words, if a surface that is named is not sampled.
    pub(super) fn new(
        job: &'j Job<'g>,
        names: &[&'j str],
        header: Header,
        kinds: &[PlotKind],
        session: Session<'j>,
    ) -> Result<Subject<'j, 'g>, Failure> {
        let mapped = mapped(job, names);
        let wanted = SolveOptions {
            geometry: kinds.contains(&PlotKind::Curvature) || kinds.is_empty(),
            sensitivity: kinds.contains(&PlotKind::Sensitivity),
            certificates: false,
            together: None,
            arrays: false,
            of_shown: true,
            session,
        };
        stream::check_kept(job, &job.surfaces, wanted)?;
        let solve_one = |surface: usize| {
            let is_chosen = mapped.contains(&&*job.surfaces[surface].name);
            let points_only = SolveOptions { geometry: false, sensitivity: false, ..wanted };
            solve::solve_surface(job, &job.surfaces[surface], if is_chosen { wanted } else { points_only })
        };
        let solved = (0..job.surfaces.len()).filter_map(solve_one).collect::<Result<_, Failure>>()?;
        Ok(Subject::of_solved(job, solved, names, header, session)?)
    }

    /// Of surfaces that are solved; all of them if none is named.
    ///
    /// # Errors
    /// In words, if a surface that is named is not among them.
    pub(crate) fn of_solved(
        job: &'j Job<'g>,
        solved: Vec<Solved<'j, 'g>>,
        names: &[&'j str],
        header: Header,
        session: Session<'j>,
    ) -> Result<Subject<'j, 'g>, String> {
        let place = |name: &&str| {
            let found = solved.iter().position(|solved| solved.surface.name == *name);
            found.ok_or(format!("`{name}` is not sampled: add `sample {name} {{ … }}`, which says at which points"))
        };
        let chosen = mapped(job, names).iter().map(place).collect::<Result<Vec<usize>, String>>()?;
        let in_space = if names.is_empty() { (0..solved.len()).collect() } else { chosen.clone() };
        let dataset = solve::dataset(job, &solved, &[], header);
        Ok(Subject { job, solved, dataset, chosen, in_space, session })
    }

    /// The job.
    pub(crate) fn job(&self) -> &'j Job<'g> {
        self.job
    }

    /// What pictures solve with.
    pub(crate) fn session(&self) -> Session<'j> {
        self.session
    }

    /// The first of the surfaces that maps show.
    pub(super) fn first(&self) -> &Solved<'j, 'g> {
        &self.solved[self.chosen[0]]
    }

    /// Its solved point that is nearest to the middle of its grid.
    ///
    /// # Errors
    /// In words, if none is solved.
    pub(super) fn middle(&self) -> Result<(usize, &SurfacePoint), String> {
        let solved = self.first();
        let [rows, columns] = solved.counts();
        let off = |at: usize| {
            let [i, j] = [at / columns, at % columns];
            (2 * i).abs_diff(rows - 1) * columns + (2 * j).abs_diff(columns - 1) * rows
        };
        let points = solved.points.iter().enumerate().filter(|(_, point)| point.outcome == Outcome::Solved);
        points.min_by_key(|(at, _)| off(*at)).ok_or(format!("no point of `{}` is solved", solved.surface.name))
    }

    /// The surfaces that the tool of the first one leaves in the same work with the same motions.
    pub(super) fn mates(&self) -> Vec<usize> {
        let first = self.first().surface;
        let is_mate = |&at: &usize| {
            let surface = self.solved[at].surface;
            surface.frame == first.frame
                && surface.generation.tool_frame() == first.generation.tool_frame()
                && surface.generation.motions == first.generation.motions
        };
        (0..self.solved.len()).filter(is_mate).collect()
    }

    /// The motions over which the first surface is made.
    pub(super) fn motions(&self) -> Vec<&'j RangedVariable<'g>> {
        let motions = &self.first().surface.generation.motions;
        self.job.motions.iter().filter(|motion| motions.contains(&motion.variable)).collect()
    }

    /// The machine that the first surface stands in.
    pub(super) fn machine(&self) -> Option<&'j Machine<'g>> {
        let (machine, _) = self.first().surface.frame.split_once('.')?;
        self.job.machines.iter().find(|other| other.name == machine)
    }

    /// Numbers for all parameters, for the motions as in a point of the first surface, and for the axes that follow.
    pub(super) fn posture(&self, point: &SurfacePoint) -> Vec<(Expr<'g>, Expr<'g>)> {
        let surface = self.first().surface;
        let mut bindings = self.job.bindings();
        let at = |(unknown, value): (&RangedVariable<'g>, &f64)| {
            (unknown.variable, unknown.variable.graph().constant(*value))
        };
        bindings.extend(surface.unknowns.iter().zip(&point.unknowns).map(at));
        let known: Vec<Expr<'g>> = bindings.iter().map(|(variable, _)| *variable).collect();
        // motions of other tools stand in the middle of their ranges
        let others = self.job.motions.iter().filter(|motion| !known.contains(&motion.variable));
        bindings.extend(
            others.map(|motion| (motion.variable, motion.variable.graph().constant(0.5 * (motion.low + motion.high)))),
        );
        let laws: Vec<(Expr<'g>, Expr<'g>)> = self
            .machine()
            .into_iter()
            .flat_map(|machine| &machine.axes)
            .map(|axis| (axis.variable, axis.law))
            .collect();
        bindings.extend(laws.into_iter().map(|(variable, law)| (variable, bound(law, &bindings))).collect::<Vec<_>>());
        bindings
    }
}

/// The surfaces that maps show: those that are named, or the first that is sampled.
fn mapped<'j>(job: &'j Job<'_>, names: &[&'j str]) -> Vec<&'j str> {
    if !names.is_empty() {
        return names.to_vec();
    }
    let first = job.surfaces.iter().find(|surface| surface.sample.is_some());
    first.map(|surface| surface.name.as_str()).into_iter().collect()
}

/// An expression with numbers for its variables.
pub(super) fn bound<'g>(of: Expr<'g>, bindings: &[(Expr<'g>, Expr<'g>)]) -> Expr<'g> {
    of.graph().substitute(&[of], bindings)[0]
}

/// The same as a number; NaN where it is none.
pub(super) fn number<'g>(of: Expr<'g>, bindings: &[(Expr<'g>, Expr<'g>)]) -> f64 {
    bound(of, bindings).as_constant().unwrap_or(f64::NAN)
}
