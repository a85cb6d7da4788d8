//! Secondary cutting: the tool takes away, in another position, what it generates.

use flank_chain_dsl::{Dimension, GeneratedSurface, Job, Process, ToolShape};
use flank_expr::Expr;
use flank_expr::geometry::Surface;
use flank_solver::{BoundSurface, Judged, Range, SecondaryCutting, SurfacePoint, Unseen};

use crate::project::remark::{Remark, RemarkKind};
use crate::project::units;
use crate::solve::result::ToolPositions;
use crate::solve::surface::ranges;

/// Which positions of its tool the points of a surface were checked against, and what was found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Positions {
    /// With the verdict.
    Seen(Judged),
    /// None: what was not looked at, and why.
    Unseen(&'static str),
}

/// The points of surfaces of so many are not checked against other positions.
pub(crate) const STREAMED: Positions = Positions::Unseen("all other positions, there are too many points");

/// Marks the points of a grid that the tool cuts away in another position: by the surface generated, or by another one that the job
/// generates with the same tool along the same motions.
pub(crate) fn judge<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    points: &mut [SurfacePoint],
    counts: [usize; 2],
) -> Positions {
    judge_by(tool_positions(job, surface, &job.bindings()), points, counts)
}

/// The same once it is known what the points are checked against.
pub(crate) fn judge_by(
    tool: Result<SecondaryCutting, Positions>,
    points: &mut [SurfacePoint],
    counts: [usize; 2],
) -> Positions {
    match tool {
        Ok(cutting) => Positions::Seen(cutting.judge(points, counts)),
        Err(none) => none,
    }
}

/// What the points of a surface are checked against: its tool in all positions, with these values of the parameters.
///
/// # Errors
/// What is to be said where there is nothing.
pub(crate) fn tool_positions<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    values: &[(Expr<'g>, Expr<'g>)],
) -> Result<SecondaryCutting, Positions> {
    let motions = &surface.generation.motions;
    if motions.is_empty() {
        // one position is all there is
        return Err(Positions::Seen(Judged::default()));
    }
    if surface.generation.process != Process::Envelope {
        return Err(Positions::Unseen("all other positions, the tool is an edge"));
    }
    let Some(_) = piece(surface) else {
        let is_given = matches!(&surface.generation.tool, ToolShape::Surface(tool) if tool.given > 0);
        let reason = if is_given {
            "all other positions, the tool is given by an equation"
        } else {
            "all other positions, the tool is generated itself"
        };
        return Err(Positions::Unseen(reason));
    };
    let mut names: Vec<&str> = Vec::new();
    let all = job.surfaces.iter().enumerate().filter(|(_, other)| is_of_same_tool(surface, other));
    let pieces: Vec<_> = all
        .filter_map(|(number, other)| {
            let is_new = !names.contains(&other.generation.tool_name.as_str());
            names.push(&other.generation.tool_name);
            let (shape, ranges) = piece(other).filter(|_| is_new)?;
            Some((number, BoundSurface::new(shape, ranges, values)))
        })
        .collect();
    let own = ranges(surface)[2..].to_vec();
    let t_work_tool = surface.generation.driven.substituted(values);
    Ok(SecondaryCutting::new(&pieces, &t_work_tool, (motions, own))
        .expect("a job without errors leaves nothing unbound"))
}

/// The same of several surfaces; a tool that makes some of them along the same motions is laid out once.
pub(crate) fn tools_of<'g>(
    job: &Job<'g>,
    surfaces: &[&GeneratedSurface<'g>],
) -> Vec<Result<SecondaryCutting, Positions>> {
    let values = job.bindings();
    let mut known: Vec<(&GeneratedSurface<'g>, SecondaryCutting)> = Vec::new();
    let each = surfaces.iter().map(|&surface| {
        let is_same = |other: &GeneratedSurface<'g>| {
            let driven = [surface, other].map(|surface| surface.generation.driven.steps());
            is_of_same_tool(other, surface) && driven[0] == driven[1]
        };
        let before = known.iter().find(|(other, _)| is_same(other)).filter(|_| piece(surface).is_some());
        if let Some((_, cutting)) = before {
            return Ok(cutting.over(ranges(surface)[2..].to_vec()));
        }
        let cutting = tool_positions(job, surface, &values)?;
        // shared with those that follow
        cutting.translate();
        known.push((surface, cutting.clone()));
        Ok(cutting)
    });
    each.collect()
}

/// The tool's surface of one that trims another, in all positions; `None` where one tool makes both, or its positions are not known.
pub(crate) fn positions_of_other<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    (by, number): (&GeneratedSurface<'g>, usize),
) -> Option<SecondaryCutting> {
    let is_other = by.generation.process == Process::Envelope && !is_of_same_tool(surface, by);
    let (shape, own) = piece(by).filter(|_| is_other)?;
    let motions = (&by.generation.motions[..], ranges(by)[2..].to_vec());
    let values = job.bindings();
    let pieces = [(number, BoundSurface::new(shape, own, &values))];
    let cutting = SecondaryCutting::new(&pieces, &by.generation.driven.substituted(&values), motions);
    Some(cutting.expect("a job without errors leaves nothing unbound"))
}

/// The tool's surface with the ranges of its parameters; `None` where the tool is an edge, generated itself, or given by an equation.
fn piece<'s, 'g>(surface: &'s GeneratedSurface<'g>) -> Option<(&'s Surface<'g>, Vec<Range>)> {
    let ToolShape::Surface(shape) = &surface.generation.tool else { return None };
    let ranges = ranges(surface);
    (shape.unknowns.len() == 2).then(|| (shape, ranges[..2].to_vec()))
}

/// Whether two surfaces are generated by the same mounted tool, in the same frame, along the same motions.
pub(crate) fn is_of_same_tool(one: &GeneratedSurface<'_>, other: &GeneratedSurface<'_>) -> bool {
    let tool = |surface: &GeneratedSurface<'_>| {
        let name = &surface.generation.tool_name;
        name.split_once('.').map_or(name.clone(), |(tool, _)| tool.to_string())
    };
    let is_alike = one.frame == other.frame && one.generation.motions == other.generation.motions;
    is_alike && other.generation.process == Process::Envelope && tool(one) == tool(other)
}

impl Positions {
    /// Which positions the points were not checked against; `None` if they were against all.
    fn unseen(&self) -> Option<&'static str> {
        match self {
            Positions::Unseen(reason) => Some(reason),
            Positions::Seen(judged) => judged.unseen.map(|unseen| match unseen {
                Unseen::SeveralMotions => "positions that differ from a point\u{2019}s own in several motions at once",
                Unseen::Budget => "all other positions of some points, which would have taken too long",
            }),
        }
    }

    /// The same as data.
    pub(crate) fn told(&self) -> ToolPositions {
        let deepest = match self {
            Positions::Seen(judged) => judged.deepest.iter().map(|(_, depth)| *depth).reduce(f64::max),
            Positions::Unseen(_) => None,
        };
        ToolPositions { not_looked_at: self.unseen(), deepest }
    }

    /// How deep the deepest of the points that a surface's tool cuts away lies in the steel, mm, as far as that was seen.
    fn deepest(&self, by: usize) -> Option<f64> {
        let Positions::Seen(judged) = self else { return None };
        judged.deepest.iter().find(|(number, _)| *number == by).map(|(_, depth)| *depth)
    }
}

/// `, by up to 0.51 mm`; empty if that is not known.
pub(crate) fn depth(positions: &Positions, by: usize) -> String {
    let deepest = positions.deepest(by);
    deepest.map_or(String::new(), |depth| format!(", by up to {}", units::text(Dimension::LENGTH, depth, 6)))
}

/// Of each surface that was not checked against all positions of its tool, its name and what was not looked at.
pub(crate) fn unseen<'s>(of_surfaces: impl Iterator<Item = (&'s str, &'s Positions)>) -> Vec<String> {
    of_surfaces.filter_map(|(name, positions)| Some(format!("{name}: {}", positions.unseen()?))).collect()
}

/// Of which surfaces positions of the tool were given up.
pub(crate) fn given_up<'s>(of_surfaces: impl Iterator<Item = (&'s str, &'s Positions)>) -> Vec<Remark> {
    let is_given_up = |positions: &Positions| match positions {
        Positions::Seen(judged) => judged.unseen == Some(Unseen::Budget),
        Positions::Unseen(_) => *positions == STREAMED,
    };
    let told = of_surfaces.filter(|(_, positions)| is_given_up(positions)).map(|(name, positions)| {
        let what = positions.unseen().unwrap_or_default();
        let message =
            format!("whether the tool cuts points of {name} away in another position was not looked at: {what}");
        Remark::new(RemarkKind::PositionsNotTried, name, message)
    });
    told.collect()
}
