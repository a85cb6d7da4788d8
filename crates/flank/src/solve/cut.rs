//! `cut flank by edges`: what the single edges leave over a surface.

use flank_chain_dsl::{GeneratedSurface, Job};
use flank_export::{Field, Values};
use flank_solver::{CuttingEdges, ScallopHeight, SurfacePoint};

use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::session::Session;
use crate::solve::result::CutHeights;
use crate::solve::surface::bound;

/// What the numbers are, for pictures.
pub(crate) const NOTE: &str = "What the single edges leave over the surface that edges without end would generate, along its normal; plus \
    is material.";

/// What is left at each point of a surface.
pub(crate) struct Cut {
    /// The surface of the edges, and their counts.
    by: String,
    counts: Vec<String>,
    left: Vec<Option<ScallopHeight>>,
}

/// Nothing if the job does not ask for it.
pub(crate) fn left_by_edges<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    points: &[SurfacePoint],
    session: Session,
) -> Option<Cut> {
    let by = &job.surfaces[surface.cut_by?];
    let edges = CuttingEdges::new(&bound(job, surface), &bound(job, by))
        .expect("a job without errors leaves nothing unbound")
        .with_instruction_set(session.instructions());
    let counts = by.unknowns[2..].iter().map(|count| count.name.clone()).collect();
    Some(Cut { by: by.name.clone(), counts, left: edges.left(points) })
}

/// The height of what is left over each point of a surface, mm, where it is known; nothing if the surface is not cut.
pub(crate) fn heights<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    points: &[SurfacePoint],
    session: Session,
) -> Option<Vec<Option<f64>>> {
    let height = |left: &Option<ScallopHeight>| match left {
        Some(ScallopHeight::Cut { height, .. }) => Some(*height),
        _ => None,
    };
    left_by_edges(job, surface, points, session).map(|cut| cut.left.iter().map(height).collect())
}

/// At how many points of a surface what is left is unknown, and why, a line each.
pub(crate) fn unknown_of<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    points: &[SurfacePoint],
    session: Session,
) -> Vec<String> {
    let cut = left_by_edges(job, surface, points, session);
    let remarks = unknown(std::iter::once((surface.name.as_str(), cut.as_ref())));
    remarks.into_iter().flat_map(|remark| std::iter::once(remark.message).chain(remark.details)).collect()
}

impl Cut {
    /// The height of what is left, then the counts of the edge that leaves it.
    pub(crate) fn fields(&self) -> Vec<Field> {
        let scalars = |value: &dyn Fn(f64, &[f64]) -> f64| {
            let known = self.left.iter().map(|left| match left {
                Some(ScallopHeight::Cut { height, edge }) => Some(value(*height, edge)),
                _ => None,
            });
            Values::Scalars(known.collect())
        };
        let height = Field {
            name: "left".to_string(),
            unit: "um".to_string(),
            meaning: format!(
                "height of what the edges of `{}` leave over the surface, along its normal; plus is material",
                self.by
            ),
            values: scalars(&|height, _| 1e3 * height),
        };
        let counts = self.counts.iter().enumerate().map(|(k, count)| Field {
            name: format!("left_by_{count}"),
            unit: "1".to_string(),
            meaning: format!("`{count}` of the edge that leaves it"),
            values: scalars(&|_, edge| edge[k + 2]),
        });
        std::iter::once(height).chain(counts).collect()
    }
}

/// How many of the solved points there are, and of them where no edge passes, and where it is not certain which is the
/// lowest.
struct Tally {
    asked: usize,
    unreached: usize,
    undecided: usize,
}

impl Cut {
    fn tally(&self) -> Tally {
        let count = |what: ScallopHeight| self.left.iter().flatten().filter(|left| **left == what).count();
        Tally {
            asked: self.left.iter().flatten().count(),
            unreached: count(ScallopHeight::Unreached),
            undecided: count(ScallopHeight::Undecided),
        }
    }

    pub(crate) fn heights(&self) -> CutHeights {
        let Tally { asked, unreached, undecided } = self.tally();
        CutHeights { by: self.by.clone(), known: asked - unreached - undecided, unreached, undecided }
    }
}

/// At how many points the height that is left is unknown, and why.
pub(crate) fn unknown<'s>(of_surfaces: impl Iterator<Item = (&'s str, Option<&'s Cut>)>) -> Vec<NotDone> {
    let mut all = Vec::new();
    for (name, cut) in of_surfaces.filter_map(|(name, cut)| Some((name, cut?))) {
        let Tally { asked, unreached, undecided } = cut.tally();
        let missing = unreached + undecided;
        if missing == 0 {
            continue;
        }
        let message = format!("what is left is unknown at {missing} of {asked} points of {name}");
        let mut details = Vec::new();
        if unreached > 0 {
            details.push(format!("{unreached}: no edge of {} passes there within its ranges", cut.by));
        }
        if undecided > 0 {
            details.push(format!(
                "{undecided}: undecided, an edge that may be the lowest could not be followed, or too many would have to be tried"
            ));
        }
        all.push(NotDone::new(NotDoneKind::HeightUnknown, name, message).with(details));
    }
    all
}
