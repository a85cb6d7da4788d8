//! The contacts of a job for its page: where both members stand over the roll, and where they touch.

use std::f64::consts::TAU;

use flank_chain_dsl::{Contact, Job, RangedVariable};
use flank_draw::{PageContact, PageMember, PageNumber, PageTouch};
use flank_export::{Field, Patch, Values, fixed};
use flank_expr::{ScalarEvaluator, Tape};
use flank_solver::{ContactPoint, ContactState};

use super::surfaces;
use crate::contact::place::{fine, fine_unit};
use crate::contact::result::{ContactKind, ContactResult};
use crate::contact::rolling::Rolling;
use crate::contact::summary::Summary;
use crate::contact::{self, Rolled};
use crate::project::failure::Failure;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::requests::{ContactRequest, JobSelection};
use crate::project::session::Session;
use crate::solve::solved::Solved;

/// A pair of teeth that is apart by less carries too: rounding, um.
const ALIKE: f64 = 1e-6;

/// A contact of the job, or why it cannot be rolled.
pub(super) struct Shown<'j, 'g> {
    contact: &'j Contact<'g>,
    request: ContactRequest,
    rolled: Result<Rolled<'j, 'g>, String>,
}

/// Rolls all contacts of a job as they are mounted.
///
/// # Errors
/// If the work is cancelled.
pub(super) fn rolled<'j, 'g>(
    job: &'j Job<'g>,
    jobs: &JobSelection,
    session: Session,
) -> Result<Vec<Shown<'j, 'g>>, Failure> {
    let of_contact = |contact: &'j Contact<'g>| {
        let request = ContactRequest::new(jobs.clone());
        let rolled = match contact::rolled(job, contact, &request, session) {
            Ok(rolled) => Ok(rolled),
            Err(Failure::Input(reason)) => Err(reason),
            Err(other) => return Err(other),
        };
        Ok(Shown { contact, request, rolled })
    };
    job.contacts.iter().map(of_contact).collect()
}

/// Gives both flanks of each contact the least gap to the mate as a field of their points.
pub(super) fn add_gaps(contacts: &[Shown<'_, '_>], solved: &[Solved<'_, '_>], patches: &mut [Patch]) {
    for shown in contacts {
        let Ok(Rolled { found: Some((_, maps)), .. }) = &shown.rolled else { continue };
        for map in maps {
            let name = &map.pattern.surface;
            let Some(at) = solved.iter().position(|solved| solved.surface.name == *name) else { continue };
            let columns = solved[at].sample.counts[1];
            let gap = |point: usize| {
                let [row, column] = solved[at].place(point);
                Some(1e3 * (*map.gaps.get(row * columns + column)?)?.distance)
            };
            patches[at].fields.push(Field {
                name: shown.gap(),
                unit: "um".to_string(),
                meaning: "least distance to the mate along the normal, over the mesh of a pair of teeth".to_string(),
                values: Values::Scalars((0..patches[at].points.len()).map(gap).collect()),
            });
        }
    }
}

impl<'g> Shown<'_, 'g> {
    fn gap(&self) -> String {
        format!("gap_{}", self.contact.name)
    }

    /// Why it is not shown.
    pub(super) fn refused(&self) -> Vec<NotDone> {
        match &self.rolled {
            Ok(Rolled { result, found: None, .. }) => result.not_done.clone(),
            Ok(_) => Vec::new(),
            Err(reason) => vec![NotDone::new(NotDoneKind::NoContact, &self.contact.name, reason.clone())],
        }
    }

    /// The roll positions at which this motion is known to bring flanks together.
    pub(super) fn rolls(&self, motion: &RangedVariable<'g>) -> Option<[f64; 3]> {
        let Ok(Rolled { found: Some((rolling, _)), .. }) = &self.rolled else { return None };
        let steps = rolling.all_steps();
        let [low, high] = [steps.start, steps.end - 1].map(|step| rolling.roll(step));
        (self.contact.roll.variable == motion.variable).then(|| [low, high, rolling.roll(0)])
    }

    /// What the page has of it; `None` where a flank has no points to show.
    pub(super) fn page(&self, job: &Job<'g>, solved: &[Solved<'_, 'g>]) -> Option<PageContact> {
        let contact = self.contact;
        let place = |surface: usize| {
            let name = &job.surfaces[surface].name;
            solved.iter().position(|solved| solved.surface.name == *name)
        };
        let motion = |of: &RangedVariable<'g>| job.motions.iter().position(|one| one.variable == of.variable);
        let [first, second] = contact.surfaces.map(place);
        let flanks = [first?, second?];
        let member = |k: usize| self.member(job, k, flanks[k], &place);
        let base = PageContact {
            name: contact.name.clone(),
            machine: surfaces::frame(job, &contact.frames[0]).0,
            motions: [motion(&contact.roll)?, motion(&contact.lag)?],
            members: [member(0), member(1)],
            gap: self.gap(),
            film: 1e3 * self.request.compound,
            error_unit: fine_unit(contact.lag.dimension).to_string(),
            refused: self.refused().iter().map(|why| why.message.clone()).collect::<Vec<_>>().join("; "),
            ..PageContact::default()
        };
        let Ok(Rolled { result, found: Some((rolling, _)), .. }) = &self.rolled else { return Some(base) };
        Some(PageContact {
            kind: kind(result).to_string(),
            numbers: numbers(result),
            touches: self.touches(job, rolling),
            ..base
        })
    }

    fn member(&self, job: &Job<'g>, k: usize, flank: usize, place: &dyn Fn(usize) -> Option<usize>) -> PageMember {
        let at = self.contact.surfaces[k];
        let solid = job.solids.iter().find(|solid| solid.space.contains(&at));
        let beside = |other: &usize| job.surfaces[*other].frame == job.surfaces[at].frame;
        let space = solid.map_or_else(|| (0..job.surfaces.len()).filter(beside).collect(), |solid| solid.space.clone());
        let tooth = self.rolled.as_ref().map_or(0, |rolled| rolled.members.tooth);
        PageMember {
            flank,
            surfaces: space.into_iter().filter_map(place).collect(),
            frame: surfaces::frame(job, &self.contact.frames[k]).1,
            pitch: solid.map(|solid| TAU / f64::from(solid.teeth)),
            tooth: if k == 1 { tooth } else { 0 },
        }
    }

    /// The described pair of teeth from its first touch to its last.
    fn touches(&self, job: &Job<'g>, rolling: &Rolling) -> Vec<PageTouch> {
        let Ok(Rolled { members, .. }) = &self.rolled else { return Vec::new() };
        let (errors, contact) = (vec![0.0; self.contact.errors.len()], self.contact);
        let summary = Summary::new(job, members, &self.request, &errors);
        let pair = members.pair(job, &errors, &[]);
        let turned = pair.placements.each_ref().map(|placement| placement.pose().rotation.0.map(|row| row.0));
        let turned: Vec<_> = turned.into_iter().flatten().flatten().collect();
        let turned = Tape::new(&turned, &[pair.roll, pair.lag.0]).expect("a job without errors leaves nothing unbound");
        let reference = rolling.middle().map_or(0.0, |middle| middle.lag);
        let error = |lag: f64| fine(contact.lag.dimension, lag - reference);
        let touch = |step: isize| {
            let point = rolling.engagement.point(0, step)?;
            let carried = rolling.engagement.carried(step).filter(|_| rolling.has_pitch);
            let lag = carried.map_or(point.lag, |carried| carried.lag);
            let ellipse = self.ellipse(point);
            let mut rows = [0.0; 18];
            ScalarEvaluator::new(&turned).run(&[point.roll, point.lag], &mut rows);
            let within = |member: usize, v: [f64; 3]| -> [f64; 3] {
                std::array::from_fn(|k| (0..3).map(|row| rows[9 * member + 3 * row + k] * v[row]).sum())
            };
            Some(PageTouch {
                roll: point.roll,
                lag,
                errors: [lag, point.lag].map(error),
                apart: Some(1e3 * ((lag - point.lag) * point.opening).abs()).filter(|um| *um > ALIKE).unwrap_or(0.0),
                edges: if point.is_of_flanks() { String::new() } else { summary.whole_edge_name(&point.edges) },
                position: point.position,
                normal: point.normal,
                ellipse,
                on: point.in_members,
                ellipse_on: ellipse.map(|axes| [0, 1].map(|member| axes.map(|axis| within(member, axis)))),
            })
        };
        rolling.all_steps().filter_map(touch).collect()
    }

    /// Its half axes, the longer first; flanks that touch along a line have none.
    fn ellipse(&self, point: &ContactPoint) -> Option<[[f64; 3]; 2]> {
        let is_point = point.state == Some(ContactState::Touching);
        let [short, long] = point.ellipse(self.request.compound).filter(|_| is_point)?;
        let [across, along] = point.gap?.directions?;
        Some([along.map(|x| long * x), across.map(|x| short * x)])
    }
}

fn kind(result: &ContactResult) -> &'static str {
    match result.kind {
        Some(ContactKind::Point) => "point contact",
        Some(ContactKind::Line) => "line contact",
        Some(ContactKind::Crossing) => "the flanks run into each other beside the point",
        Some(ContactKind::Edge) => "contact at an edge",
        None => "",
    }
}

/// What `flank contact` tells of the whole.
fn numbers(result: &ContactResult) -> Vec<PageNumber> {
    let mut numbers = Vec::new();
    let mut add = |name: &str, value: Option<f64>, unit: &str| {
        numbers.extend(value.map(|value| PageNumber { name: name.to_string(), value, unit: unit.to_string() }));
    };
    let error = result.error.as_ref();
    add("contact ratio", result.ratio, "");
    let over = error
        .filter(|error| error.gap.is_some())
        .map_or(String::new(), |error| format!(" over {} {}", fixed(error.over, 3), result.over_unit));
    let height = error.map(|error| error.peak_to_peak);
    add(&format!("error, peak to peak{over}"), height, error.map_or("", |error| &error.unit));
    if let (Some(middle), Some(ContactKind::Point)) = (&result.middle, result.kind) {
        add("half axes at the middle", middle.ellipse.map(|[long, _]| long), "mm");
        add("the shorter one", middle.ellipse.map(|[_, short]| short), "mm");
    }
    for pattern in &result.pattern {
        let share = 100.0 * pattern.within as f64 / pattern.points.max(1) as f64;
        add(&format!("pattern on {}", pattern.surface), Some(share), "%");
    }
    numbers
}
