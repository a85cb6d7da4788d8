//! Pairs of specs as the solver takes them.

use flank_chain_dsl::{Contact, Job, OutlineCurve, Solid};
use flank_expr::Expr;
use flank_solver::{BoundSurface, Outline, OutlineSegment, Range, RollingPair, SurfacePoint};

use crate::sampled;

/// Parameters that stay symbols, with their values.
type Open<'g> = Vec<(Expr<'g>, f64)>;

/// The first contact of a job, its pair mounted with errors, with the points that the samples of both flanks ask for; with the ends of its
/// teeth, or of flanks without edges.
///
/// # Panics
/// If the job has no contact, or a flank of it no sample.
pub fn with_pair<'g, R>(
    job: &Job<'g>,
    wrong: &[(&str, f64)],
    has_edges: bool,
    use_pair: impl FnOnce(&RollingPair<'_, 'g>, [&[SurfacePoint]; 2]) -> R,
) -> R {
    with_contact(job, 0, wrong, has_edges, use_pair)
}

/// The same of one of several contacts.
///
/// # Panics
/// If the job has no such contact, or a flank of it no sample.
pub fn with_contact<'g, R>(
    job: &Job<'g>,
    contact: usize,
    wrong: &[(&str, f64)],
    has_edges: bool,
    use_pair: impl FnOnce(&RollingPair<'_, 'g>, [&[SurfacePoint]; 2]) -> R,
) -> R {
    let contact = &job.contacts[contact];
    let graph = contact.roll.variable.graph();
    let error = |name: &str| wrong.iter().find(|(of, _)| *of == name).map_or(0.0, |(_, error)| *error);
    let mounted = contact.errors.iter().map(|axis| (axis.variable, graph.constant(error(&axis.name))));
    let given: Vec<_> = mounted.chain(job.bindings()).collect();
    with_values(job, contact, (&given, Vec::new()), has_edges, use_pair)
}

/// The first contact of a job as it is mounted, without edges and with parameters of the job and axes of the pair's machine open.
///
/// # Panics
/// If the job has no contact, or a flank of it no sample.
pub fn with_pair_in<'g, R>(
    job: &Job<'g>,
    open: &[Expr<'g>],
    use_pair: impl FnOnce(&RollingPair<'_, 'g>, [&[SurfacePoint]; 2]) -> R,
) -> R {
    let contact = &job.contacts[0];
    let closed = contact.errors.iter().map(|axis| axis.variable).filter(|axis| !open.contains(axis));
    let mounted = closed.map(|axis| (axis, axis.graph().constant(0.0)));
    let given: Vec<_> = mounted.chain(job.bindings_beside(open)).collect();
    let value =
        |variable: &Expr<'g>| job.parameters.iter().find(|of| of.variable == *variable).map_or(0.0, |of| of.value);
    let parameters = open.iter().map(|variable| (*variable, value(variable))).collect();
    with_values(job, contact, (&given, parameters), false, use_pair)
}

fn with_values<'g, R>(
    job: &Job<'g>,
    contact: &Contact<'g>,
    (given, parameters): (&[(Expr<'g>, Expr<'g>)], Open<'g>),
    has_edges: bool,
    use_pair: impl FnOnce(&RollingPair<'_, 'g>, [&[SurfacePoint]; 2]) -> R,
) -> R {
    let surfaces = contact.surfaces.map(|at| &job.surfaces[at]);
    let flanks = surfaces.map(|surface| {
        let ranges = surface.unknowns.iter().map(|of| Range { low: of.low, high: of.high }).collect();
        BoundSurface::new(&surface.surface, ranges, given)
    });
    let points = surfaces.map(|surface| sampled(job, &surface.name));
    let solids = contact.surfaces.map(|at| job.solids.iter().find(|solid| solid.space.contains(&at)));
    let pair = RollingPair {
        surfaces: flanks.each_ref(),
        placements: contact.placements.each_ref().map(|placement| placement.substituted(given)),
        roll: contact.roll.variable,
        lag: (contact.lag.variable, Range { low: contact.lag.low, high: contact.lag.high }),
        outlines: solids.map(|solid| solid.filter(|_| has_edges).map(outline)),
        parameters,
    };
    use_pair(&pair, points.each_ref().map(Vec::as_slice))
}

fn outline(solid: &Solid) -> Outline {
    let segments = solid.outline.iter().map(|segment| OutlineSegment {
        name: segment.name.clone(),
        from: segment.from,
        to: segment.to,
        center: match segment.curve {
            OutlineCurve::Line => None,
            OutlineCurve::Arc { center } => Some(center),
        },
    });
    Outline::new(segments.collect())
}
