//! Steel of a body that a tool of its job takes away: in another position than the one that generates a surface, or as a surface that trims it.

use flank_chain_dsl::{GeneratedSurface, Job, Solid};
use flank_solver::{Blank, CutBy, Outcome, SurfacePoint, Trim, TrimmedBy};

use crate::project::failure::Failure;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::session::Session;
use crate::project::units::length;
use crate::solve::body::piece::Piece;
use crate::solve::body::result::LeftOut;
use crate::solve::reasons;
use crate::solve::secondary::{self, Positions};
use crate::solve::surface::{bound, problem};

/// Rows and columns of a chart's points that are looked at.
const MOST_LINES: usize = 9;
/// Points less deep in the steel of a tool lie on what it leaves, mm: where surfaces meet, the tool of one touches the other.
const ON_SURFACE: f64 = 1e-6;

/// The points that a chart goes through, with the two coordinates that they were asked for by.
#[derive(Clone)]
pub(crate) struct Nodes {
    pub(crate) points: Vec<SurfacePoint>,
    pub(crate) targets: Vec<[f64; 2]>,
    pub(crate) counts: [usize; 2],
}

impl Nodes {
    /// Some rows and columns of them, the outermost among them.
    fn thinned(&self) -> Nodes {
        let lines = self.counts.map(|count| {
            let parts = MOST_LINES.min(count) - 1;
            (0..=parts).map(|part| part * (count - 1) / parts.max(1)).collect::<Vec<usize>>()
        });
        let at = || lines[0].iter().flat_map(|i| lines[1].iter().map(move |j| i * self.counts[1] + j));
        Nodes {
            points: at().map(|k| self.points[k].clone()).collect(),
            targets: at().map(|k| self.targets[k]).collect(),
            counts: lines.each_ref().map(Vec::len),
        }
    }
}

/// Points of a surface of a body that are cut away.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Uncut {
    surface: String,
    /// In words.
    by: String,
    /// A surface of the job whose tool that is, if none of the body's is made by it.
    left_out: Option<String>,
    count: usize,
    of: usize,
    /// How deep in the steel of the tool they lie at the most, as far as that was seen, mm.
    depth: f64,
}

/// What tools take away in other positions of the surfaces of a body, by the jobs of the spaces that differ from each other, and what is known of each.
///
/// # Errors
/// If the work is cancelled.
pub(crate) fn in_other_positions(
    solid: &Solid,
    jobs: &[Job<'_>],
    nodes: &[Vec<Nodes>],
    session: Session<'_>,
) -> Result<Vec<Uncut>, Failure> {
    let mut all: Vec<Uncut> = Vec::new();
    for (job, nodes) in jobs.iter().zip(nodes) {
        session.check()?;
        let surfaces: Vec<&GeneratedSurface<'_>> = solid.space.iter().map(|at| &job.surfaces[*at]).collect();
        for ((surface, nodes), tool) in surfaces.iter().zip(nodes).zip(secondary::tools_of(job, &surfaces)) {
            let Nodes { mut points, counts, .. } = nodes.thinned();
            let Positions::Seen(judged) = secondary::judge_by(tool, &mut points, counts) else { continue };
            for (by, depth) in judged.deepest.into_iter().filter(|(_, depth)| *depth > ON_SURFACE) {
                let cutter = CutBy::ItsToolElsewhere(by);
                let count = points.iter().filter(|point| point.outcome == Outcome::CutAway(cutter)).count();
                let tool = &job.surfaces[by].generation.tool_name;
                let is_of_body = surfaces.iter().any(|surface| surface.generation.tool_name == *tool);
                let left_out = (!is_of_body).then(|| job.surfaces[by].name.clone());
                let (surface, by) = (surface.name.clone(), reasons::by_what(job, surface, cutter));
                add(&mut all, Uncut { surface, by, left_out, count, of: points.len(), depth });
            }
        }
    }
    Ok(all)
}

/// What surfaces of the job that are none of the body take away of one of its surfaces, as `trim` asks for.
pub(crate) fn by_trims(
    solid: &Solid,
    (piece, unknown, blank): (&Piece<'_, '_>, usize, &Blank),
    nodes: &Nodes,
    session: Session<'_>,
) -> Vec<Uncut> {
    let (job, surface) = (piece.job(), &piece.surface);
    let missing = surface.trimmed_by.iter().enumerate().filter(|(_, by)| !solid.space.contains(by));
    let trimmed = missing.filter_map(|(number, &by)| {
        let by = &job.surfaces[by];
        let Nodes { mut points, targets, counts } = nodes.thinned();
        let (own, other) = (piece.bound(), bound(job, by));
        let coordinates = piece.across(unknown, blank);
        let positions = secondary::positions_of_other(job, surface, (by, number));
        let trim_by = TrimmedBy { surface: &other, number, positions };
        let trim = Trim { surface: &own, by: vec![trim_by], tool: None, coordinates };
        let points_of_by = |_, coordinates| problem(job, by, coordinates, session);
        trim.apply(&mut points, (&targets, counts), &points_of_by)
            .expect("a job without errors leaves nothing unbound");
        let count = points.iter().filter(|point| point.outcome != Outcome::Solved).count();
        let (surface, by, of) = (surface.name.clone(), by.name.clone(), points.len());
        (count > 0).then_some(Uncut { surface, by, left_out: None, count, of, depth: 0.0 })
    });
    trimmed.collect()
}

/// Of spaces that differ, those of each surface together.
pub(crate) fn add(all: &mut Vec<Uncut>, more: Uncut) {
    match all.iter_mut().find(|known| known.surface == more.surface && known.by == more.by) {
        Some(known) => {
            known.count += more.count;
            known.of += more.of;
            known.depth = known.depth.max(more.depth);
        }
        None => all.push(more),
    }
}

/// How deep the deepest of them lies in what makes the surfaces of the body, mm.
pub(crate) fn deepest(uncut: &[Uncut]) -> Option<f64> {
    uncut.iter().filter(|uncut| uncut.left_out.is_none()).map(|uncut| uncut.depth).reduce(f64::max)
}

/// Surfaces that the body leaves out, in whose tool its own lie. That is as it should be where roundings of the tool cross before its tip, which
/// then is none.
pub(crate) fn left_out(uncut: &[Uncut]) -> Vec<LeftOut> {
    let mut all: Vec<LeftOut> = Vec::new();
    for (name, depth) in uncut.iter().filter_map(|uncut| Some((uncut.left_out.as_ref()?, uncut.depth))) {
        match all.iter_mut().find(|known| known.surface == *name) {
            Some(known) => known.depth_mm = known.depth_mm.max(depth),
            None => all.push(LeftOut { surface: name.clone(), depth_mm: depth }),
        }
    }
    all
}

/// That a body has steel which its tools take away in other positions, with how much of which surface.
pub(crate) fn positions_told(solid: &Solid, uncut: &[Uncut]) -> Option<NotDone> {
    let deepest = deepest(uncut)?;
    let message = format!(
        "`{}` has steel up to {} deep that its tools take away in other positions: all that is told and written of it is of a body which \
         they do not leave",
        solid.name,
        length(deepest)
    );
    let told = |of: &Uncut| {
        let Uncut { surface, by, count, of, depth, .. } = of;
        format!("{surface}: {count} of {of} points are cut away {by}, by up to {}", length(*depth))
    };
    let mut details: Vec<String> = uncut.iter().filter(|uncut| uncut.left_out.is_none()).map(told).collect();
    details.push(
        "a tool, or ranges of its motions, that leave the surfaces which they generate; or a blank that ends before what is cut away"
            .to_string(),
    );
    Some(NotDone::new(NotDoneKind::NotCut, &solid.name, message).with(details))
}

/// That `trim` takes away what a body has, and the way out.
pub(crate) fn trims_told(solid: &Solid, uncut: &[Uncut]) -> Vec<NotDone> {
    let told = |of: &Uncut| {
        let Uncut { surface, by, count, of, .. } = of;
        let message = format!(
            "`{by}` trims `{surface}` and is no surface of `{}`: the body has the steel that it takes away at {count} of {of} points of \
             `{surface}`",
            solid.name
        );
        let way =
            format!("name `{by}` in `of:` beside `{surface}`, with a sample of its own: both end where they meet");
        NotDone::new(NotDoneKind::NotCut, &solid.name, message).with(vec![way])
    };
    uncut.iter().map(told).collect()
}
