//! A contact that is compiled once for many values of settings and mounting errors.

use flank_chain_dsl::{Contact, Dimension, Job, Parameter};
use flank_expr::Expr;
use flank_solver::{
    ContactPoint, ContactProblem, ContactState, FlankCorners, GapProblem, Outcome, SurfaceFamily, SurfacePoint,
};

use crate::contact::pair::Members;
use crate::contact::pattern;
use crate::contact::place::{corners, fine};
use crate::contact::rolling::Rolling;
use crate::contact::summary::REACHES_IN;
use crate::contact::{Rolled, rolled};
use crate::project::failure::Failure;
use crate::project::requests::ContactRequest;
use crate::project::session::Session;
use crate::project::units;
use crate::solve::{self, starts};

/// A pair whose axes and settings stay open, with its contact as the job itself has it.
pub(crate) struct ContactFamily {
    problem: ContactProblem,
    /// The contact of the job itself that others are followed from, and what that of the middle is like.
    first: ContactPoint,
    is_vertex: bool,
    state: Option<ContactState>,
    /// Positions of a pitch, how far it is, if that is known, the teeth of both as far as solids have them, and the ends of the roll.
    steps: usize,
    every: Option<f64>,
    teeth: [Option<u32>; 2],
    limits: [f64; 2],
    film: f64,
    lag: Dimension,
    corners: Option<FlankCorners>,
    /// From each flank to the other one: what tells whether they reach into each other elsewhere.
    gaps: [GapProblem; 2],
    nodes: [FlankNodes; 2],
    /// Of the job itself, from which feet on each flank are looked for.
    points: [Vec<SurfacePoint>; 2],
    /// How many of the values are of axes.
    axes: usize,
}

/// Points spread over a flank, at any values of settings.
struct FlankNodes {
    /// Of the job itself.
    nominal: Vec<SurfacePoint>,
    /// Where settings are open.
    family: Option<(SurfaceFamily, Vec<[f64; 2]>, [usize; 2])>,
}

/// Rows and columns of such points, at the most.
const NODES: usize = 9;

/// The numbers of a contact that differ from case to case, in the units that people read; those that are not known are missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ContactNumbers {
    pub(crate) peak_to_peak: Option<f64>,
    /// The lag in the middle.
    pub(crate) lag: f64,
    pub(crate) ratio: Option<f64>,
    /// Where the middle lies on the second flank: shares from toe to heel and from root to tip, height and radius.
    pub(crate) shares: Option<[f64; 2]>,
    pub(crate) place: [f64; 2],
    /// Half axes of the ellipse in the middle, the longer one first.
    pub(crate) ellipse: Option<[f64; 2]>,
}

impl ContactFamily {
    /// With some axes of the pair's machine and some settings open. `None` where these change the pitch, and where something is not as it
    /// should be in the contact of the job itself, which each case is then asked for by itself.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(crate) fn new<'g>(
        job: &Job<'g>,
        contact: &Contact<'g>,
        (axes, settings): (&[usize], &[&Parameter<'g>]),
        request: &ContactRequest,
        session: Session,
    ) -> Result<Option<ContactFamily>, Failure> {
        let Rolled { result, members, found } = match rolled(job, contact, request, session) {
            Err(Failure::Cancelled) => return Err(Failure::Cancelled),
            Err(_) => return Ok(None),
            Ok(rolled) => rolled,
        };
        let Some((rolling, _)) = found.filter(|_| result.not_done.is_empty()) else { return Ok(None) };
        let Some(middle) = rolling.middle() else { return Ok(None) };
        let Some((problem, gaps)) = members.open_in(job, axes, settings) else { return Ok(None) };
        let nodes = [0, 1].map(|member| FlankNodes::new(job, &members, member, settings, session));
        let [Some(first), Some(second)] = nodes else { return Ok(None) };
        Ok(Some(ContactFamily {
            problem,
            gaps,
            nodes: [first, second],
            points: members.points.clone(),
            axes: axes.len(),
            is_vertex: rolling.vertex.is_some(),
            state: middle.state,
            first: rolling.first.clone(),
            steps: request.positions as usize,
            every: members.pitch(job),
            teeth: members.teeth(),
            limits: [contact.roll.low, contact.roll.high],
            film: request.compound,
            lag: contact.lag.dimension,
            corners: corners(members.surfaces[1]),
        }))
    }

    /// With values of the axes and then of the settings, followed from the contact of the job itself: `None` where it is lost, or of
    /// another kind, and where the flanks reach into each other elsewhere.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(crate) fn at(&self, values: &[f64], session: Session) -> Result<Option<ContactNumbers>, Failure> {
        session.check()?;
        let Some(rolling) = self.followed(values) else { return Ok(None) };
        session.check()?;
        let numbers = if self.reaches_in(values, &rolling) { None } else { self.numbers(&rolling) };
        Ok(numbers)
    }

    fn followed(&self, values: &[f64]) -> Option<Rolling> {
        let problem = self.problem.with_values(values);
        let first = problem.again(&self.first, self.first.roll).filter(|first| first.edges == self.first.edges)?;
        let rolling = Rolling::from_first(problem, first, (self.steps, self.every), self.limits);
        let middle = rolling.middle().filter(|middle| middle.outcome == Outcome::Solved)?;
        let is_alike = rolling.vertex.is_some() == self.is_vertex && middle.state == self.state;
        (is_alike && rolling.outside() == 0 && rolling.gap().is_none()).then_some(rolling)
    }

    /// Whether the mate comes nearer than not at all to some of the points that are spread over a flank.
    fn reaches_in(&self, values: &[f64], rolling: &Rolling) -> bool {
        let (positions, reach) = (pattern::positions(rolling, self.film), pattern::reach_of(rolling, self.teeth));
        [0, 1].into_iter().any(|member| {
            let nodes = self.nodes[member].at(&values[self.axes..]);
            let gaps = self.gaps[member].with_values(values);
            let gaps = gaps.least(&nodes, &positions, &self.points[1 - member], reach);
            gaps.iter().flatten().any(|gap| gap.distance < REACHES_IN)
        })
    }

    fn numbers(&self, rolling: &Rolling) -> Option<ContactNumbers> {
        let middle = rolling.middle()?;
        let [x, y, z] = middle.in_members[1];
        let place = [z, x.hypot(y)];
        let span = rolling.span(&rolling.transfers());
        Some(ContactNumbers {
            peak_to_peak: span.map(|[low, high]| fine(self.lag, high - low)),
            lag: units::shown(self.lag, middle.lag),
            ratio: rolling.ratio(&rolling.flank_ends()),
            shares: self.corners.and_then(|corners| corners.shares(place)).map(|[v, u]| [u, v]),
            place,
            ellipse: middle.ellipse(self.film).map(|[short, long]| [long, short]),
        })
    }
}

impl FlankNodes {
    /// Of a member's flank. `None` where it is not sampled.
    fn new<'g>(
        job: &Job<'g>,
        members: &Members<'_, 'g>,
        member: usize,
        settings: &[&Parameter<'g>],
        session: Session,
    ) -> Option<FlankNodes> {
        let (surface, points) = (members.surfaces[member], &members.points[member]);
        let sample = surface.sample.as_ref()?;
        let lines = sample.counts.map(spread);
        let places = || lines[0].iter().flat_map(|i| lines[1].iter().map(move |j| i * sample.counts[1] + j));
        let nominal: Vec<SurfacePoint> = places().map(|at| points[at].clone()).collect();
        let open: Vec<(Expr<'g>, f64)> = settings.iter().map(|of| (of.variable, of.value)).collect();
        let family = (!open.is_empty()).then(|| {
            let variables: Vec<Expr<'g>> = open.iter().map(|(variable, _)| *variable).collect();
            let coordinates = sample.functions();
            let family = solve::family(surface, coordinates, (&open, &job.bindings_beside(&variables)), session);
            let targets = sample.targets();
            (family, places().map(|at| targets[at]).collect(), lines.each_ref().map(Vec::len))
        });
        Some(FlankNodes { nominal, family })
    }

    /// Points that the job itself does not have stay out.
    fn at(&self, settings: &[f64]) -> Vec<SurfacePoint> {
        let Some((family, targets, counts)) = &self.family else { return self.nominal.clone() };
        let start = self.nominal.get(starts::middle(*counts)).filter(|point| point.outcome == Outcome::Solved);
        let start = start.map(|point| point.unknowns.as_slice());
        let (points, _) = family.at(settings).solve_points(targets, *counts, start, None);
        let both = self.nominal.iter().enumerate();
        both.map(|(k, own)| if own.outcome == Outcome::Solved { points.point(k) } else { own.clone() }).collect()
    }
}

/// Some of so many lines, the first and the last among them.
fn spread(count: usize) -> Vec<usize> {
    let lines = count.min(NODES);
    (0..lines).map(|k| if lines > 1 { k * (count - 1) / (lines - 1) } else { 0 }).collect()
}
