//! Why the surfaces of a solid bound no body, and ways out.

use flank_chain_dsl::{Dimension, GeneratedSurface, Job, Solid};
use flank_solver::{Blank, BodyFault, Outcome, SurfacePoint};

use crate::project::failure::Failure;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::units::{self, length};
use crate::solve::blank;
use crate::solve::body::smooth::BeyondEnds;
use crate::solve::reasons;

/// A solved point is on an outline that is no farther away, mm: rounding.
const ON: f64 = 1e-6;

/// That a solid has no body, with ways out.
pub(crate) fn refused(solid: &Solid, message: String, ways: &[&str]) -> Failure {
    let ways = ways.iter().map(ToString::to_string).collect();
    Failure::NotDone(vec![NotDone::new(NotDoneKind::NoBody, &solid.name, message).with(ways)])
}

/// The same with another way out, before the others.
pub(crate) fn with_way(failure: Failure, way: String) -> Failure {
    match failure {
        Failure::NotDone(mut told) => {
            told.iter_mut().for_each(|told| told.details.insert(0, way.clone()));
            Failure::NotDone(told)
        }
        other => other,
    }
}

/// Why a solid has no body, of what has kept it from being built.
///
/// # Errors
/// If that was something else: the work was cancelled, or a file cannot be read.
pub(crate) fn no_body(solid: &Solid, failure: Failure) -> Result<NotDone, Failure> {
    match failure {
        Failure::NotDone(mut told) if told.len() == 1 => Ok(told.remove(0)),
        Failure::Input(reason) => Ok(NotDone::new(NotDoneKind::NoBody, &solid.name, reason)),
        other => Err(other),
    }
}

/// A body whose exact surfaces and whose mesh do not enclose the same.
pub(crate) fn contradicted(solid: &Solid, [exact, mesh]: [f64; 2]) -> Failure {
    let message = format!(
        "the surfaces of `{}` bound no body: by themselves they enclose {exact:.4} mm\u{b3}, and the mesh between them encloses {mesh:.4} mm\u{b3}",
        solid.name
    );
    let way = "surfaces of `of:` in their order from one flank to the other, and an outline that has the ground of the spaces in it";
    refused(solid, message, &[way])
}

/// A part that has no sides where its outline goes beyond its spaces, as that of a shaft does that is longer than its teeth.
pub(crate) fn no_sides(solid: &Solid, BeyondEnds { segment, by }: &BeyondEnds) -> NotDone {
    let message = format!(
        "`{segment}` of the outline of `{}` lies beyond the ends of the spaces, by up to {}: smooth sides of one tooth or one space go on from \
         its spaces, and end with them; no STEP file of it is written",
        solid.name,
        length(*by)
    );
    let ways = [
        "the whole gear as a STEP file: option `solid gear`".to_string(),
        "this part as a mesh, which has the rest of the outline, too: option `format stl`".to_string(),
        format!("a blank that ends with its teeth, without `{segment}`"),
    ];
    NotDone::new(NotDoneKind::FaceInexact, &solid.name, message).with(ways.into())
}

/// A surface of a space of whose sample no point is solved: which branches it has, if nothing chooses between several; else for which
/// reasons, with how many points for each.
pub(crate) fn unsolved(
    job: &Job<'_>,
    (solid, surface): (&Solid, &GeneratedSurface<'_>),
    points: &[SurfacePoint],
    branches: Option<NotDone>,
) -> Failure {
    if let Some(NotDone { message, details, .. }) = branches {
        let message = format!("`{}` bounds the spaces of `{}` and is {message}", surface.name, solid.name);
        return Failure::NotDone(vec![NotDone::new(NotDoneKind::NoBody, &solid.name, message).with(details)]);
    }
    let reason = |point: &SurfacePoint| {
        let word = match point.outcome {
            Outcome::CutAway(_) => "cut away",
            outcome => outcome.word(),
        };
        let told = match point.outcome {
            // by up to another amount each
            Outcome::Outside { unknown, .. } => surface.unknowns[unknown].name.clone(),
            Outcome::NotConverged { .. } => String::new(),
            outcome => reasons::of_point(job, surface, outcome),
        };
        format!("{word} {told}").trim_end().replace('_', " ")
    };
    let mut counted: Vec<(String, usize)> = Vec::new();
    for reason in points.iter().map(reason) {
        match counted.iter_mut().find(|(of, _)| *of == reason) {
            Some((_, count)) => *count += 1,
            None => counted.push((reason, 1)),
        }
    }
    let mut details: Vec<String> = counted.iter().map(|(reason, count)| format!("{count}: {reason}")).collect();
    details.push(format!(
        "a surface that leaves nothing on the gear, as a rounding without a radius, is left out of `of:`, and its neighbours end in each \
         other; of one that does, its sample has to lie where there are points of it ({} is sampled over {})",
        surface.name,
        surface.sample.as_ref().map_or_else(String::new, |sample| sample.labels.join(" and "))
    ));
    let message =
        format!("`{}` bounds the spaces of `{}`, and no point of its sample is solved", surface.name, solid.name);
    Failure::NotDone(vec![NotDone::new(NotDoneKind::NoBody, &solid.name, message).with(details)])
}

/// What charts that bound no body are told as; `names` are those of the charts.
pub(crate) fn faulty(solid: &Solid, (blank, names, has_edge): (&Blank, &[&str], bool), fault: BodyFault) -> Failure {
    let segments = blank.outline.segments();
    let name = |segment: usize| &segments[segment].name;
    let of = &solid.name;
    let from = if blank::arrangement(solid).is_closed() { "the axis" } else { "x = 0" };
    match fault {
        BodyFault::Pointed { overlap, share, teeth: [pointed, all], .. } => {
            let is_mixed = pointed < all;
            let which = if is_mixed { format!("{pointed} of the {all} teeth") } else { "the teeth".to_string() };
            let (verb, most) = if is_mixed && pointed == 1 { ("is", "its") } else { ("are", "their") };
            let up_to = if is_mixed && pointed > 1 { "up to " } else { "" };
            let mut ways = vec!["a lower tip of the blank, or narrower spaces"];
            if is_mixed {
                ways.push(
                    "or a higher tip of the blank, or wider spaces, with which all teeth are pointed: they then end in edges",
                );
            }
            refused(
                solid,
                format!(
                    "{which} of `{of}` {verb} pointed below the tip{}: {most} flanks overlap by {up_to}{} at `{}`, {:.0} % of the way from `{}` to `{}`",
                    if is_mixed { ", and the others are not" } else { "" },
                    length(overlap),
                    name(blank.ends[1]),
                    100.0 * share,
                    name(blank.ends[0]),
                    name(blank.ends[2])
                ),
                &ways,
            )
        }
        BodyFault::Overlap { overlap, rho } => refused(
            solid,
            format!("the spaces of `{of}` run into each other by {} at {rho:.3} mm from {from}", length(overlap)),
            &["fewer teeth, or narrower spaces"],
        ),
        BodyFault::Crossed { charts: [first, second], place: [z, rho] } if first == second => refused(
            solid,
            format!(
                "the spaces of `{of}` cross themselves: `{}` crosses itself at z {z:.4} mm, {rho:.4} mm from {from}",
                names[first]
            ),
            &[&format!(
                "narrower ranges of the tool of `{0}`, or a `keep` in `sample {0}`, that leave one sheet of it",
                names[first]
            )],
        ),
        BodyFault::Crossed { charts: [first, second], place: [z, rho] } => refused(
            solid,
            format!(
                "the spaces of `{of}` cross themselves: `{}` and `{}` meet at z {z:.4} mm, {rho:.4} mm from {from}, before what follows them in `of:`",
                names[first], names[second]
            ),
            &[&crossed([first, second], names)],
        ),
        BodyFault::BesideTop { below, beside, place: [z, rho] } => {
            let is_round = blank::arrangement(solid).is_closed();
            let dimension = if is_round { Dimension::ANGLE } else { Dimension::LENGTH };
            let beside = units::text(dimension, beside, 4);
            let (first, last) = (names[0], names[names.len() - 1]);
            let beside = if is_round { format!("{beside} about the axis") } else { beside };
            refused(
                solid,
                format!(
                    "the teeth of `{of}` end in an edge {} below their top and {beside} beside it, at z {z:.4} mm, {rho:.4} mm from {from}: `{last}` \
                     and `{first}` of the next space end there in one line, and what lies above it would fold over it",
                    length(below)
                ),
                &[&format!(
                    "`{first}` and `{last}` that end on the top of the teeth: begin them on the tool where it leaves that"
                )],
            )
        }
        // teeth with a land end at the tip: what goes through it is the ground of the spaces
        BodyFault::Through { segment, by } if segment == blank.ends[1] && !has_edge => {
            let rest: Vec<String> = blank.rest().iter().map(|segment| format!("`{}`", segment.name)).collect();
            refused(
                solid,
                format!(
                    "the spaces of `{of}` go {} through `{}` of its outline, by which they leave the blank: its material lies on the other side of \
                     the tip, between it and {}",
                    length(by),
                    name(segment),
                    rest.join(", ")
                ),
                &[&format!("{} on the side of the ground of the spaces, and beyond it", rest.join(", "))],
            )
        }
        BodyFault::Through { segment, by } if !blank.ends.contains(&segment) => refused(
            solid,
            format!(
                "the spaces of `{of}` go {} through `{}` of its outline, and leave it by `{}`",
                length(by),
                name(segment),
                name(blank.ends[1])
            ),
            &[&format!("`{}` farther from the spaces by more than that, or spaces that are less deep", name(segment))],
        ),
        BodyFault::Through { segment, by } => refused(
            solid,
            format!("the spaces of `{of}` go {} through `{}` of its outline", length(by), name(segment)),
            &[&format!("`{}` farther from the spaces by more than that, or spaces that are less deep", name(segment))],
        ),
        BodyFault::NoWall { segment, place: [z, rho] } => refused(
            solid,
            format!(
                "the spaces of `{of}` reach `{}` of its outline at z {z:.4} mm, {rho:.4} mm from {from}: no wall is left between them",
                name(segment)
            ),
            &[&format!("`{}` farther from the spaces, or spaces that are less deep", name(segment))],
        ),
    }
}

/// That the flanks of a space lie outside the outline that they are to be cut into; nothing where a sampled point of one lies in it. Each
/// surface of the space has the places of its points in the section of the outline.
pub(crate) fn elsewhere(solid: &Solid, blank: &Blank, surfaces: &[(&str, Vec<[f64; 2]>)]) -> Option<Failure> {
    let [first, .., last] = surfaces else { return None };
    // flanks may be sampled up to the tip itself
    let is_inside = |place: &[f64; 2]| blank.outline.holds(*place) && blank.outline.segments_at(*place, ON).is_empty();
    if [first, last].into_iter().flat_map(|(_, places)| places).any(is_inside) {
        return None;
    }
    let ends = |depths: &mut dyn Iterator<Item = f64>| {
        let [low, high] = depths.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
        let [low, high] = [low, high].map(|end| format!("{end:.4}"));
        if low == high { format!("{low} mm") } else { format!("{low} .. {high} mm") }
    };
    let segments = blank.outline.segments();
    let outline = ends(&mut segments.iter().flat_map(|segment| segment.places(3)).map(|place| place[1]));
    let flanks = ends(&mut first.1.iter().chain(&last.1).map(|place| place[1]));
    let ground = ends(&mut surfaces[surfaces.len() / 2].1.iter().map(|place| place[1]));
    let from = if blank::arrangement(solid).is_closed() { "from the axis" } else { "in x" };
    let message = format!(
        "the outline of `{}` lies beside its spaces: it has its material {outline} {from}, and no sampled point of `{}` and `{}`, \
         which are {flanks} {from}, lies in it",
        solid.name, first.0, last.0
    );
    let way = format!(
        "an outline around the teeth: one segment as their tip, and those below the teeth on the other side of the ground of the \
         spaces, which is {ground} {from}"
    );
    Some(refused(solid, message, &[&way]))
}

/// That a surface turns back in the unknown by which its rows are told apart, so that this has one value at several of them.
pub(crate) fn folded(solid: &Solid, surface: &GeneratedSurface<'_>, unknown: usize, off: f64) -> Failure {
    let (name, unknown) = (&surface.name, &surface.unknowns[unknown].name);
    let message = format!(
        "`{name}` turns back in `{unknown}` on its way across the spaces of `{}`: by that its rows lead to another place than where it ends, {} \
         off, and none of its other unknowns tells them apart",
        solid.name,
        length(off)
    );
    let way = format!("two surfaces instead of `{name}`, one on each side of where `{unknown}` is least or largest");
    refused(solid, message, &[&way])
}

/// The way out where surfaces cross: they are neighbours, once what lies between them is gone.
fn crossed([first, second]: [usize; 2], names: &[&str]) -> String {
    let between: Vec<String> =
        names[first.min(second) + 1..first.max(second)].iter().map(|name| format!("`{name}`")).collect();
    match between[..] {
        [] => "a tool whose surfaces end in each other there".to_string(),
        _ => format!(
            "leave {} out of `of:`, and they end where they meet; or a tool whose tip is wider there",
            between.join(", ")
        ),
    }
}

/// How far unknowns would have to go beyond their ranges, and what these are.
pub(crate) fn wider(surface: &GeneratedSurface<'_>, beyond: &[(usize, f64)]) -> (String, Vec<String>) {
    let far = |(unknown, by): &(usize, f64)| {
        let of = &surface.unknowns[*unknown];
        format!("`{}` by {}", of.name, units::text(of.dimension, *by, 4))
    };
    let range = |(unknown, _): &(usize, f64)| {
        let of = &surface.unknowns[*unknown];
        let [low, high] = [of.low, of.high].map(|end| units::told(of.dimension, end));
        let owner = match surface.generation.motions.contains(&of.variable) {
            true => "the motion".to_string(),
            false => format!("of {}", surface.generation.tool_name),
        };
        format!("`{}`, {owner}, has the range {low} .. {high}: a wider one reaches there", of.name)
    };
    let each: Vec<String> = beyond.iter().map(far).collect();
    (format!("beyond the ranges of their unknowns, {}", each.join(", ")), beyond.iter().map(range).collect())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use flank_expr::Graph;

    use super::*;
    use crate::project::Project;
    use crate::project::monitor::Unwatched;
    use crate::project::requests::JobSelection;
    use crate::project::spec;

    #[test]
    fn a_surface_that_crosses_itself_is_told_as_that() {
        let path = format!("{}/../../specs/pairs/spur_pair.chain", env!("CARGO_MANIFEST_DIR"));
        let which = JobSelection::all(Project::open(path, Arc::new(flank_chain_dsl::Disk)));
        let graph = Graph::new();
        let (_, jobs) = spec::jobs(&graph, &which, &Unwatched).expect("it is shipped");
        let solid = &jobs[0].solids[0];
        let blank = Blank { outline: blank::outline(solid), ends: [3, 0, 1] };
        let fault = |charts: [usize; 2]| {
            let failure =
                faulty(solid, (&blank, &["a", "b", "c"], false), BodyFault::Crossed { charts, place: [1.0, 20.0] });
            no_body(solid, failure).expect("a body that is refused")
        };
        let told = fault([1, 1]);
        assert!(
            told.message.ends_with("cross themselves: `b` crosses itself at z 1.0000 mm, 20.0000 mm from the axis"),
            "{told}"
        );
        assert!(told.details[0].contains("`keep` in `sample b`"), "{told}");
        assert!(fault([2, 0]).details[0].starts_with("leave `b` out"), "{told}");
    }
}
