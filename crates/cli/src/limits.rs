//! `flank solve --limits`: the lines at which a surface, or the tool's contact with it, ends.

use flank_chain_dsl::{GeneratedSurface, Job, Sample, spaced};
use flank_export::{Axis, Patch};
use flank_expr::Expr;
use flank_solver::{SurfacePoint, SurfaceProblem};

use crate::arguments::Means;
use crate::progress::Working;
use crate::solve;
use crate::summary::Summary;
use crate::{reach, reasons};

/// A line on a surface.
pub(crate) struct Line<'j, 'g> {
    pub(crate) surface: &'j GeneratedSurface<'g>,
    /// `flank.singular_line`, `flank.contact_limit`, `flank.trimmed_by_fillet`.
    pub(crate) name: String,
    pub(crate) kind: &'static str,
    /// What changes along it.
    pub(crate) along: String,
    pub(crate) summary: Summary,
    pub(crate) points: Vec<SurfacePoint>,
    /// Lines of this kind that cross the place at which they were looked for; `points` are those of the longest.
    pub(crate) several: usize,
    /// No point of it was found within the ranges, but it is not excluded there either: the search was given up, or left a part of
    /// them undecided.
    pub(crate) is_open: bool,
}

/// What is not shown of the lines; empty if everything is.
pub(crate) fn untold(lines: &[&Line<'_, '_>]) -> String {
    let several = lines.iter().filter(|line| line.several > 1);
    let told = |line: &&Line<'_, '_>| {
        format!(
            "note: {} has {} of its kind beside each other within the ranges; the longest is shown, narrower ranges show the others\n",
            line.name, line.several
        )
    };
    // of a line without any point within the ranges the table tells as much
    let partly = lines.iter().filter(|line| line.summary.solved() > 0).filter_map(|line| {
        let [_, outside] = line.found();
        let by = reasons::outside(line.surface, &line.summary)?;
        Some(format!("note: {} of {} points of {} are outside, {by}\n", outside, line.summary.asked, line.name))
    });
    let open: Vec<&str> = lines.iter().filter(|line| line.is_open).map(|line| line.name.as_str()).collect();
    let open = match open[..] {
        [] => String::new(),
        _ => format!(
            "note: not found within the ranges, and not excluded, since not all of them could be looked at: {}; narrower ranges tell \
             more\n",
            open.join(", ")
        ),
    };
    several.map(told).chain(partly).chain([open]).collect()
}

/// Both lines of a surface that points are asked of; none for a surface without an equation of meshing.
pub(crate) fn lines<'j, 'g>(job: &Job<'g>, surface: &'j GeneratedSurface<'g>, means: Means) -> Vec<Line<'j, 'g>> {
    let Some(sample) = &surface.sample else { return Vec::new() };
    let _working = Working::on(format!("looking for the limits of {}", surface.name));
    let singular = surface.surface.clearance_minors().pop();
    [("singular line", singular), ("contact limit", surface.surface.contact_limit())]
        .into_iter()
        .filter_map(|(kind, quantity)| {
            let quantity = quantity?;
            // along the coordinate that follows the line farther: it may run across the other one
            let along = |k: usize| line(job, surface, sample, (kind, quantity), k, means);
            let first = along(0);
            if first.summary.solved() == first.points.len() {
                return Some(first);
            }
            let second = along(1);
            Some(if second.found() > first.found() { second } else { first })
        })
        .collect()
}

fn line<'j, 'g>(
    job: &Job<'g>,
    surface: &'j GeneratedSurface<'g>,
    sample: &Sample<'g>,
    (kind, quantity): (&'static str, Expr<'g>),
    k: usize,
    means: Means,
) -> Line<'j, 'g> {
    let ends = sample.each_target().map(|target| target[k]);
    let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let count = sample.counts.into_iter().max().unwrap_or(1).max(2);
    let targets: Vec<[f64; 2]> = spaced((low, high), count).into_iter().map(|value| [0.0, value]).collect();
    let along = &sample.coordinates[k];
    let problem =
        SurfaceProblem::line(&surface.surface, quantity, along.value, solve::ranges(surface), &job.bindings())
            .expect("a job without errors leaves nothing unbound");
    let problem = problem.reaching(reach::followed(surface)).on(means.instructions());
    let (points, effort) = problem.solve(&targets, [1, targets.len()]);
    let name = format!("{}.{}", surface.name, kind.replace(' ', "_"));
    let summary = Summary::of(surface.unknowns.len(), [1, points.len()], &points);
    let is_open = summary.solved() == 0 && (effort.is_given_up || !effort.undecided.is_empty());
    Line { surface, name, kind, along: along.name.clone(), summary, points, several: effort.branches.len(), is_open }
}

impl Line<'_, '_> {
    /// How many points there are, and how many outside the ranges.
    fn found(&self) -> [usize; 2] {
        [self.summary.solved(), self.summary.outside.iter().map(|outside| outside.places.count).sum()]
    }

    /// The line as a grid of one row, for files and pictures; `None` if no point of it was found.
    pub(crate) fn patch(&self, job: &Job<'_>) -> Option<Patch> {
        let rows = Axis { label: self.kind.to_string(), count: 1 };
        let columns = Axis { label: self.along.clone(), count: self.points.len() };
        (self.summary.solved() > 0).then(|| solve::patch(job, &self.name, self.surface, [rows, columns], &self.points))
    }
}
