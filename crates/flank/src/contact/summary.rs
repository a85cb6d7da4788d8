//! The numbers of a contact, in the units that people read.

use flank_chain_dsl::{Dimension, Job};
use flank_export::fixed;
use flank_solver::{ContactPoint, ContactState, FlankEdge};

use crate::contact::gap::PairEnds;
use crate::contact::law;
use crate::contact::pair::Members;
use crate::contact::pattern::GapMap;
use crate::contact::place::{fine, fine_unit, rows_at, shares};
use crate::contact::result::{
    ContactKind, ContactMember, ContactMiddle, ContactResult, ErrorGap, FlankEnd, LeadingEdge, MountedError,
    PlaceOnFlank, TransmissionError,
};
use crate::contact::rolling::Rolling;
use crate::project::answer::Timing;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::requests::ContactRequest;
use crate::project::units;

/// A contact this near to an edge lies on it: it is looked for by halving the roll, mm.
const ON_EDGE: f64 = 1e-6;
/// A gap below this is no rounding: the mate reaches in, mm. Flanks whose normals are opposite to 1e-8 rad count as touching along a line, which
/// leaves as much over 100 mm of it.
pub(crate) const REACHES_IN: f64 = -1e-6;

/// What numbers of a contact are told of.
pub(crate) struct Summary<'s, 'j, 'g> {
    job: &'s Job<'g>,
    members: &'s Members<'j, 'g>,
    request: &'s ContactRequest,
    errors: &'s [f64],
}

impl<'s, 'j, 'g> Summary<'s, 'j, 'g> {
    pub(crate) fn new(
        job: &'s Job<'g>,
        members: &'s Members<'j, 'g>,
        request: &'s ContactRequest,
        errors: &'s [f64],
    ) -> Summary<'s, 'j, 'g> {
        Summary { job, members, request, errors }
    }

    fn over(&self) -> Dimension {
        self.members.contact.roll.dimension
    }

    fn unknown(&self) -> Dimension {
        self.members.contact.lag.dimension
    }

    /// A difference of the error in the unit that errors are told in.
    fn fine(&self, difference: f64) -> f64 {
        fine(self.unknown(), difference)
    }

    fn turn(&self, roll: f64) -> f64 {
        units::shown(self.over(), roll)
    }

    /// Of a pair that does not touch.
    pub(crate) fn of_nothing(&self) -> ContactResult {
        let member = |k: usize| ContactMember {
            surface: self.members.surfaces[k].name.clone(),
            frame: self.members.surfaces[k].frame.clone(),
            solid: self.members.solids[k].map(|solid| solid.name.clone()),
            space: self.members.space(self.job, k).iter().map(|at| self.job.surfaces[*at].name.clone()).collect(),
        };
        let axes = &self.members.contact.errors;
        let mounted =
            axes.iter().zip(self.errors).filter(|(_, error)| **error != 0.0).map(|(axis, error)| MountedError {
                axis: axis.name.clone(),
                value: units::shown(axis.dimension, *error),
                unit: units::symbol(axis.dimension).to_string(),
            });
        ContactResult {
            job: self.job.name.clone(),
            contact: self.members.contact.name.clone(),
            members: [member(0), member(1)],
            over: self.members.contact.roll.name.clone(),
            over_unit: units::symbol(self.over()).to_string(),
            unknown: self.members.contact.lag.name.clone(),
            unknown_unit: units::symbol(self.unknown()).to_string(),
            mounted: mounted.collect(),
            kind: None,
            middle: None,
            error: None,
            ratio: None,
            ends: Vec::new(),
            edges: Vec::new(),
            pattern: Vec::new(),
            backlash: None,
            clearances: Vec::new(),
            influences: Vec::new(),
            vhj: Vec::new(),
            milled: None,
            proven: None,
            files: Vec::new(),
            grids: Vec::new(),
            not_done: Vec::new(),
            remarks: Vec::new(),
            timing: Timing::default(),
        }
    }

    pub(crate) fn of_rolling(&self, rolling: &Rolling, patterns: &[GapMap]) -> ContactResult {
        let handed = rolling.transfers();
        let numbers = self.numbers(rolling, &handed);
        ContactResult {
            edges: if rolling.has_pitch { self.edges(rolling, &handed) } else { Vec::new() },
            pattern: patterns.iter().map(|map| map.pattern.clone()).collect(),
            not_done: [self.not_done(rolling, patterns), numbers.not_done].concat(),
            ..numbers
        }
    }

    /// What is known of a roll without what the marking compound shows and which edges carry.
    pub(crate) fn in_numbers(&self, rolling: &Rolling) -> ContactResult {
        let numbers = self.numbers(rolling, &rolling.transfers());
        ContactResult { not_done: [self.not_done(rolling, &[]), numbers.not_done].concat(), ..numbers }
    }

    fn numbers(&self, rolling: &Rolling, handed: &[f64]) -> ContactResult {
        let (ends, error) = (rolling.flank_ends(), self.error(rolling, handed));
        let is_of_edge = rolling.middle().is_some_and(|middle| !middle.is_of_flanks());
        let kind = rolling.state().map(|state| match state {
            _ if is_of_edge => ContactKind::Edge,
            ContactState::Touching => ContactKind::Point,
            ContactState::Line => ContactKind::Line,
            ContactState::Crossing => ContactKind::Crossing,
        });
        ContactResult {
            kind,
            middle: rolling.middle().map(|point| self.middle(rolling, point)),
            error: error.clone(),
            ratio: rolling.ratio(&ends),
            ends: ends.iter().map(|(way, point)| self.end(rolling, *way, point)).collect(),
            not_done: self.untouched(error.as_ref()).into_iter().collect(),
            remarks: self.remarks(rolling, error.as_ref()),
            timing: Timing { points: rolling.engagement.points.len(), ..Timing::default() },
            ..self.of_nothing()
        }
    }

    fn middle(&self, rolling: &Rolling, point: &ContactPoint) -> ContactMiddle {
        let speed = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let per_roll = units::shown(self.over(), 1.0);
        ContactMiddle {
            is_vertex: rolling.vertex.is_some() && point.is_of_flanks(),
            edge: (!point.is_of_flanks()).then(|| self.whole_edge_name(&point.edges)),
            turn: self.turn(point.roll),
            error: units::shown(self.unknown(), point.lag),
            parabola: self.fine(point.lag_slopes[1]) / (per_roll * per_roll),
            on: [0, 1].map(|member| self.place(member, point)),
            gap: point.gap.as_ref().map(|gap| [gap.k1, gap.k2]),
            ellipse: point.ellipse(self.request.compound).map(|[short, long]| [long, short]),
            sliding: speed(&point.sliding),
            entraining: speed(&point.entraining),
        }
    }

    fn place(&self, member: usize, point: &ContactPoint) -> PlaceOnFlank {
        let [x, y, z] = point.in_members[member];
        let rho = x.hypot(y);
        let along = rows_at(self.members, member, point);
        let path_angle = along.map(|along| along.angle(point.path[member]).to_degrees());
        PlaceOnFlank {
            z,
            rho,
            shares: shares(self.members.surfaces[member], [z, rho]).map(|[v, u]| [u, v]),
            path_angle: path_angle.filter(|angle| angle.is_finite()),
        }
    }

    fn error(&self, rolling: &Rolling, handed: &[f64]) -> Option<TransmissionError> {
        let [low, high] = rolling.span(handed)?;
        let gap = rolling.gap();
        let known = gap.as_ref().map(PairEnds::width);
        let pitch = rolling.has_pitch.then_some(rolling.engagement.pitch);
        let over = known.or(pitch).or_else(|| rolling.pair_ends().map(|ends| ends.width()))?;
        let pairs = rolling.steps_of(rolling.looked_at()).map(|step| self.within_film(rolling, step)).max();
        Some(TransmissionError {
            unit: fine_unit(self.unknown()).to_string(),
            peak_to_peak: self.fine(high - low),
            over: self.turn(over),
            pitch: pitch.map(|pitch| self.turn(pitch)),
            gap: gap.map(|PairEnds { points: [first, last], is_of_roll }| ErrorGap {
                from: self.turn(last.roll),
                to: self.turn(first.roll + rolling.engagement.pitch),
                is_of_roll: is_of_roll.contains(&true),
            }),
            transfers: handed.iter().map(|roll| self.turn(*roll)).collect(),
            pairs: pairs.filter(|_| rolling.has_pitch).unwrap_or(1),
        })
    }

    /// How many pairs of teeth are within the film of the one that carries.
    fn within_film(&self, rolling: &Rolling, step: isize) -> usize {
        let engagement = rolling.looked_at();
        let Some(carried) = engagement.carried(step) else { return 0 };
        let points = engagement.pairs(step).into_iter().filter_map(|pair| engagement.point(pair, step));
        points.filter(|point| ((point.lag - carried.lag) * point.opening).abs() <= self.request.compound).count()
    }

    /// Where contact of the flanks begins or ends.
    fn end(&self, rolling: &Rolling, way: isize, point: &ContactPoint) -> FlankEnd {
        let edge = self.edge_at(rolling, point);
        let of = edge.map_or_else(|| self.outside(point), |edge| edge.member);
        FlankEnd {
            turn: self.turn(point.roll),
            of: self.members.surfaces[of].name.clone(),
            at: edge.map(|edge| self.edge_name(edge)),
            is_begin: way < 0,
        }
    }

    /// The edge on which a contact of the flanks lies, but for one that a line of contact goes on to all the way.
    fn edge_at(&self, rolling: &Rolling, point: &ContactPoint) -> Option<FlankEdge> {
        let inner = rolling.middle().map_or(Vec::new(), |middle| middle.edges.clone());
        let on = |member: usize| {
            let [x, y, z] = point.in_members[member];
            let segments = self.members.outline(member).map(|outline| outline.segments_at([z, x.hypot(y)], ON_EDGE));
            segments.into_iter().flatten().map(move |segment| FlankEdge { member, segment })
        };
        [0, 1].into_iter().flat_map(on).find(|edge| !inner.contains(edge))
    }

    /// The member whose tool makes no more of the flank there: the one that is nearer to an end of its unknowns.
    fn outside(&self, point: &ContactPoint) -> usize {
        let room = |member: usize| {
            let ranges = self.members.bound[member].ranges();
            let shares = ranges.iter().zip(&point.unknowns[member]);
            shares
                .map(|(range, x)| (x - range.low).min(range.high - x) / (range.high - range.low))
                .fold(f64::MAX, f64::min)
        };
        usize::from(room(1) < room(0))
    }

    fn edge_name(&self, edge: FlankEdge) -> String {
        self.members.outline(edge.member).map_or(String::new(), |outline| outline.segments()[edge.segment].name.clone())
    }

    /// Edges that touch, in words.
    pub(crate) fn whole_edge_name(&self, edges: &[FlankEdge]) -> String {
        let name =
            |edge: &FlankEdge| format!("{} of {}", self.edge_name(*edge), self.members.surfaces[edge.member].name);
        edges.iter().map(name).collect::<Vec<String>>().join(" x ")
    }

    /// Where edges carry over a pitch.
    fn edges(&self, rolling: &Rolling, handed: &[f64]) -> Vec<LeadingEdge> {
        let told = |(edges, [from, to]): (Vec<FlankEdge>, [f64; 2])| LeadingEdge {
            edge: self.whole_edge_name(&edges),
            from: self.turn(from),
            to: self.turn(to),
        };
        rolling.leading(handed).into_iter().map(told).collect()
    }

    fn not_done(&self, rolling: &Rolling, patterns: &[GapMap]) -> Vec<NotDone> {
        let [first, second] = self.members.surfaces.map(|surface| &surface.name);
        let name = &self.members.contact.name;
        let mut told = Vec::new();
        let outside = rolling.outside();
        if outside > 0 {
            let message = format!(
                "contact {name}: at {} the flanks would have to touch beyond the ranges of their tools",
                units::counted(outside, "position")
            );
            let way =
                "the piece of the tool that follows makes what touches there: give it a contact of its own, or make the tool reach farther"
                    .to_string();
            told.push(NotDone::new(NotDoneKind::NotSolved, first, message).with(vec![way]));
        }
        told.extend(law::broken(self.job, self.members, rolling));
        let missed = &rolling.looked_at().missed;
        if let Some(roll) = missed.first() {
            let (dimension, roll_name) = (self.over(), &self.members.contact.roll.name);
            let count = units::counted(missed.len(), "position");
            let message = format!(
                "contact {name}: at {count} of `{roll_name}`, first at {}, {first} and {second} come together before the contact that was found",
                units::text(dimension, *roll, 3)
            );
            let way = "what is told of the error there is too little; more positions of the roll and more points of both samples help".to_string();
            told.push(NotDone::new(NotDoneKind::NotSolved, first, message).with(vec![way]));
        }
        told.extend(penetration(self.members, patterns));
        told
    }

    /// Where no pair of teeth touches, though the roll goes on.
    fn untouched(&self, error: Option<&TransmissionError>) -> Option<NotDone> {
        let gap = error?.gap.as_ref().filter(|gap| !gap.is_of_roll)?;
        let (contact, first) = (self.members.contact, &self.members.surfaces[0].name);
        let unit = units::symbol(self.over());
        let message = format!(
            "contact {}: from `{}` {} to {} {unit} no pair of teeth touches within the range of `{}`; the error is not known there",
            contact.name,
            contact.roll.name,
            fixed(gap.from, 3),
            fixed(gap.to, 3),
            contact.lag.name
        );
        Some(NotDone::new(NotDoneKind::NoContact, first, message))
    }

    /// Whether the roll ends where the pair is still near its mate.
    fn is_cut_short(&self, rolling: &Rolling) -> bool {
        let engagement = &rolling.engagement;
        let last = engagement.first + engagement.points.len() as isize - 1;
        let ends = [engagement.first, last].into_iter().zip(engagement.is_whole);
        ends.filter(|(_, is_whole)| !is_whole).any(|(step, _)| {
            let at = engagement.carried(step).zip(engagement.point(0, step));
            at.is_some_and(|(carried, point)| {
                ((carried.lag - point.lag) * point.opening).abs() <= self.request.compound
            })
        })
    }

    fn remarks(&self, rolling: &Rolling, error: Option<&TransmissionError>) -> Vec<Remark> {
        let name = &self.members.contact.name;
        let remark =
            |kind: RemarkKind, of: &str, message: String| Remark::new(kind, of, format!("contact {name}: {message}"));
        let mut told = Vec::new();
        for (surface, _) in self.members.surfaces.iter().zip(self.members.solids).filter(|(_, solid)| solid.is_none()) {
            let name = &surface.name;
            let message = match self.members.ends_at_sample {
                true => {
                    format!("no `solid` says where the teeth of {name} end: lines of contact end where its sample does")
                }
                false => format!("no `solid` says where the teeth of {name} end: its edges are not looked at"),
            };
            told.push(remark(RemarkKind::NoEdges, &surface.name, message));
        }
        if !rolling.has_pitch {
            let message = match self.members.solids {
                [Some(_), Some(_)] if !self.members.is_even(self.job) => {
                    "one pair of teeth alone: the law does not turn both members evenly, and no `every` says when the next pair follows".to_string()
                }
                [Some(first), Some(second)] => format!(
                    "one pair of teeth alone: the law does not carry a tooth of {} ({}) on while one of {} ({}) passes",
                    second.name, second.teeth, first.name, first.teeth
                ),
                _ => {
                    "one pair of teeth alone: no `solid` of both members and no `every` says when the next pair follows"
                        .to_string()
                }
            };
            told.push(remark(RemarkKind::OnePair, name, message));
        } else if let Some(error) = error
            && error.gap.as_ref().is_some_and(|gap| gap.is_of_roll)
        {
            let (roll, unit) = (&self.members.contact.roll.name, units::symbol(self.over()));
            let message = format!(
                "the range of `{roll}` ends before a pitch of the error is known: peak to peak is that of {} {unit}; a wider range shows the rest",
                fixed(error.over, 3)
            );
            told.push(remark(RemarkKind::RollTooShort, name, message));
        } else if self.is_cut_short(rolling) {
            let message = format!(
                "the range of `{}` ends while the pair still touches: a wider range shows it from its first touch to its last",
                self.members.contact.roll.name
            );
            told.push(remark(RemarkKind::RollTooShort, name, message));
        }
        if self.request.sensitivity && rolling.state() == Some(ContactState::Line) {
            let message = "the flanks touch along a line, and any change brings them to one of its ends: what mounting errors and settings \
                           do is not proportional; the option `error` says what one of them does"
                .to_string();
            told.push(remark(RemarkKind::NotLinear, name, message));
        }
        told
    }
}

/// Whether the flanks reach into each other where they should touch.
pub(crate) fn penetration(members: &Members<'_, '_>, patterns: &[GapMap]) -> Option<NotDone> {
    let [first, second] = members.surfaces.map(|surface| &surface.name);
    let least = patterns.iter().filter_map(|map| map.pattern.least_um).reduce(f64::min);
    let least = least.filter(|least| *least < 1e3 * REACHES_IN)?;
    let message = format!(
        "contact {}: {first} and {second} reach into each other by {} where they should touch",
        members.contact.name,
        units::length(-1e-3 * least)
    );
    Some(NotDone::new(NotDoneKind::Penetration, first, message))
}
