//! The lines that neighbours in a tooth space share: ends of their tools' surfaces, or where one cuts off the other.

use std::rc::Rc;

use flank_chain_dsl::Solid;
use flank_solver::{Blank, SurfacePoint};

use crate::project::failure::Failure;
use crate::project::units::length;
use crate::solve::body::course::Course;
use crate::solve::body::piece::{EndLine, EndsOf, Piece, SAME_LINE, apart, positions};
use crate::solve::body::refusal::{refused, wider};

/// Shares along at which the ends of neighbours are held against each other.
const ALONG: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// Known points of neighbouring spaces nearer than this, as a share of the pitch, may belong to surfaces that end in one line.
const NEAR: f64 = 0.1;

/// What the surfaces of a space have in common with their neighbours.
pub(crate) struct Borders<'j, 'g> {
    /// Between each surface and the one behind it.
    joints: Vec<Joint<'j, 'g>>,
    /// Where teeth end in an edge: between the last surface of the space before and the first one, and between the last one and the first one
    /// of the space behind.
    edges: Option<[Joint<'j, 'g>; 2]>,
}

/// A line on which the rows of a surface end, at shares along the space.
pub(crate) struct Border {
    /// Of the unknown by which rows are told apart.
    pub(crate) values: Vec<f64>,
    pub(crate) points: Vec<[f64; 3]>,
}

/// The last surface of a space and the first one of the next, for this space as the next and for it as the one before.
pub(crate) type Beside<'j, 'g> = [[Piece<'j, 'g>; 2]; 2];

/// Of two surfaces a line each on which an unknown has a value, where there is one.
type OwnLines = [Option<(usize, f64)>; 2];

/// Two neighbours and their common line.
#[derive(Clone)]
struct Joint<'j, 'g> {
    pieces: [Piece<'j, 'g>; 2],
    shared: Shared<'j, 'g>,
}

/// What two neighbours have in common.
#[derive(Clone)]
enum Shared<'j, 'g> {
    /// The line on which an unknown of each has a value.
    Ends([(usize, f64); 2]),
    /// The line on which an unknown of one has a value, which lies within the other.
    Onto { ending: usize, line: (usize, f64) },
    /// Where they meet.
    Meeting(Rc<Course<'j, 'g>>),
}

impl<'j, 'g> Borders<'j, 'g> {
    /// `first` are the borders of another space: neighbours mostly share the same lines in all of them, and to find that they share no
    /// others takes long.
    ///
    /// # Errors
    /// If neighbours share no line.
    pub(crate) fn new(
        solid: &Solid,
        (pieces, beside): (&[Piece<'j, 'g>], &[Beside<'j, 'g>]),
        blank: &Blank,
        first: Option<&Borders<'j, 'g>>,
    ) -> Result<Borders<'j, 'g>, Failure> {
        let joint = |k: usize| {
            let both = [pieces[k - 1].clone(), pieces[k].clone()];
            let alike = first.and_then(|first| first.joints[k - 1].shared.alike([&both[0], &both[1]], blank));
            let shared = alike.map_or_else(|| shared(solid, [&both[0], &both[1]], blank), Ok)?;
            Ok(Joint { pieces: both, shared })
        };
        let joints = (1..pieces.len()).map(joint).collect::<Result<Vec<_>, Failure>>()?;
        let known = first.and_then(|first| first.edges.as_ref()).map(|edges| &edges[0].shared);
        let within = lines_within(&joints);
        let edges = edges(beside, |pieces| edge(solid, (pieces, known, within), blank));
        Ok(Borders { joints, edges })
    }

    /// The same with teeth that end where the flanks of neighbouring spaces meet.
    pub(crate) fn meeting_in_an_edge(self, beside: &[Beside<'j, 'g>], blank: &Blank) -> Option<Borders<'j, 'g>> {
        let edges = edges(beside, |pieces| {
            let [last, first] = lines_within(&self.joints);
            let within = last.zip(first).map(|(last, first)| [last, first]);
            let course = Course::beside(pieces.each_ref(), within, blank, &ALONG)
                .filter(|course| !self.has_within(course, blank))?;
            Some(Joint { pieces: pieces.clone(), shared: Shared::Meeting(Rc::new(course)) })
        })?;
        Some(Borders { edges: Some(edges), ..self })
    }

    /// Whether the line on which the last surface of a space and the first one of the next meet is one within the space: of a single space, which
    /// is its own neighbour, they may meet on its ground, too.
    fn has_within(&self, course: &Course<'_, '_>, blank: &Blank) -> bool {
        let Some((joint, Some(met))) = self.joints.last().zip(Some(course.at(blank, &ALONG))) else { return false };
        let ground = joint.positions(1, blank);
        let is_same = |(met, ground): (&[SurfacePoint; 2], &[f64; 3])| apart(met[0].position, *ground) <= SAME_LINE;
        ground.is_some_and(|ground| met.iter().zip(&ground).all(is_same))
    }

    /// Whether teeth end in an edge.
    pub(crate) fn has_edge(&self) -> bool {
        self.edges.is_some()
    }

    /// The unknowns of a surface by which its rows may be told apart, those first by which it ends at its neighbours.
    ///
    /// # Errors
    /// If none runs across the space.
    pub(crate) fn across(
        &self,
        solid: &Solid,
        piece: &Piece<'_, '_>,
        k: usize,
        blank: &Blank,
    ) -> Result<Vec<usize>, Failure> {
        let name = &piece.surface.name;
        let mut all: Vec<usize> = self.said(k).into_iter().flatten().collect();
        if all.is_empty() {
            all.push(piece.across_tool(blank).ok_or_else(|| {
                let of: Vec<&str> = piece.surface.unknowns.iter().map(|unknown| unknown.name.as_str()).collect();
                let message = format!(
                    "the sampled points of `{name}` lie in one row along the spaces of `{}`: each of its unknowns, {}, follows from how far \
                     along they lie, and none says what runs across the space",
                    solid.name,
                    of.join(" and ")
                );
                let way = format!(
                    "in `sample {name}` three values or more of what runs from one flank to the other, each with several along the space"
                );
                refused(solid, message, &[&way])
            })?);
        }
        all.extend(piece.telling_rows(blank));
        let is_first = |at: &usize| !all[..*at].contains(&all[*at]);
        Ok((0..all.len()).filter(is_first).map(|at| all[at]).collect())
    }

    /// That a surface ends at both neighbours by different unknowns, none of which tells all of its rows apart.
    pub(crate) fn of_two_unknowns(&self, solid: &Solid, piece: &Piece<'_, '_>, k: usize) -> Option<Failure> {
        let [Some(a), Some(b)] = self.said(k) else { return None };
        let of = [a, b].map(|unknown| &piece.surface.unknowns[unknown].name);
        let message = format!(
            "`{}` of `{}` ends at one neighbour by `{}` and at the other by `{}`: its rows have no common unknown",
            piece.surface.name, solid.name, of[0], of[1]
        );
        let way = "surfaces of the tool that end at both neighbours by the same unknown";
        (a != b).then(|| refused(solid, message, &[way]))
    }

    /// The unknowns by which a surface ends at the one before and behind it.
    fn said(&self, k: usize) -> [Option<usize>; 2] {
        [0, 1].map(|side| self.joint(k, side).and_then(|(joint, own)| joint.unknown(own)))
    }

    /// What a surface has in common with the one before (0) or behind it (1), and which of both it is there.
    fn joint(&self, k: usize, side: usize) -> Option<(&Joint<'j, 'g>, usize)> {
        let own = 1 - side;
        match side {
            0 if k == 0 => self.edges.as_ref().map(|edges| (&edges[0], own)),
            0 => Some((&self.joints[k - 1], own)),
            _ if k == self.joints.len() => self.edges.as_ref().map(|edges| (&edges[1], own)),
            _ => Some((&self.joints[k], own)),
        }
    }

    /// The line that a surface shares with the one before (0) or behind it (1), with the values of one of its unknowns; `None` at the tip.
    ///
    /// # Errors
    /// If the line is not found all along the space.
    pub(crate) fn border(
        &self,
        solid: &Solid,
        (k, side): (usize, usize),
        (unknown, blank): (usize, &Blank),
        shares: &[f64],
    ) -> Option<Result<Border, Failure>> {
        let (joint, own) = self.joint(k, side)?;
        let border = joint.border(own, unknown, blank, shares).map(|border| {
            let points = border.points.into_iter().map(|point| joint.pieces[own].in_own_space(point)).collect();
            Border { points, ..border }
        });
        Some(border.ok_or_else(|| lost(solid, joint.pieces.each_ref(), blank)))
    }
}

impl<'j, 'g> Shared<'j, 'g> {
    /// What other neighbours have in common, if it is the same.
    fn alike(&self, pieces: [&Piece<'j, 'g>; 2], blank: &Blank) -> Option<Shared<'j, 'g>> {
        let line = |k: usize, (unknown, value): (usize, f64)| {
            let points = pieces[k].on_line((unknown, value), blank, &ALONG);
            (points.solved() == ALONG.len()).then(|| EndLine { unknown, value, points: positions(&points) })
        };
        match self {
            Shared::Ends(lines) => {
                let ends = [vec![line(0, lines[0])?], vec![line(1, lines[1])?]];
                nearest(&ends).filter(|(_, gap)| *gap <= SAME_LINE).map(|(ends, _)| Shared::Ends(ends))
            }
            Shared::Onto { ending, line: end } => {
                let other = pieces[1 - ending];
                let points = line(*ending, *end)?.points;
                other.values_at(&points, other.across_tool(blank)?, blank)?;
                Some(Shared::Onto { ending: *ending, line: *end })
            }
            Shared::Meeting(_) => Some(Shared::Meeting(Rc::new(Course::new(pieces, blank, &ALONG)?))),
        }
    }
}

impl Joint<'_, '_> {
    /// The unknown of one of them that has a value on the common line.
    fn unknown(&self, own: usize) -> Option<usize> {
        self.line(own).map(|(unknown, _)| unknown)
    }

    /// The same with that value.
    fn line(&self, own: usize) -> Option<(usize, f64)> {
        match &self.shared {
            Shared::Ends(lines) => Some(lines[own]),
            Shared::Onto { ending, line } if *ending == own => Some(*line),
            Shared::Onto { .. } | Shared::Meeting(_) => None,
        }
    }

    /// Points of the common line, as those of one of them.
    fn positions(&self, own: usize, blank: &Blank) -> Option<Vec<[f64; 3]>> {
        match &self.shared {
            Shared::Ends(lines) => Some(positions(&self.pieces[own].on_line(lines[own], blank, &ALONG))),
            Shared::Onto { ending, line } => Some(positions(&self.pieces[*ending].on_line(*line, blank, &ALONG))),
            Shared::Meeting(course) => {
                let met = course.at(blank, &ALONG)?;
                Some(met.iter().map(|of| of[own].position).collect())
            }
        }
    }

    fn border(&self, own: usize, unknown: usize, blank: &Blank, shares: &[f64]) -> Option<Border> {
        match &self.shared {
            Shared::Meeting(course) => {
                let met = course.at(blank, shares)?;
                let values = met.iter().map(|of| of[own].unknowns[unknown]).collect();
                Some(Border { values, points: met.iter().map(|of| of[own].position).collect() })
            }
            Shared::Onto { ending, line } if *ending != own => {
                let points = self.pieces[*ending].on_line(*line, blank, shares);
                let points = (points.solved() == shares.len()).then(|| positions(&points))?;
                Some(Border { values: self.pieces[own].values_at(&points, unknown, blank)?, points })
            }
            Shared::Ends(_) | Shared::Onto { .. } => {
                let points = self.pieces[own].on_line(self.line(own)?, blank, shares);
                let values = || (0..points.len()).map(|k| points.unknowns(k)[unknown]).collect();
                (points.solved() == shares.len()).then(|| Border { values: values(), points: positions(&points) })
            }
        }
    }
}

/// # Errors
/// If neighbours share no line.
fn shared<'j, 'g>(solid: &Solid, pieces: [&Piece<'j, 'g>; 2], blank: &Blank) -> Result<Shared<'j, 'g>, Failure> {
    // most neighbours share a line on which their rows end, and to find that there is no other end takes long
    let rows = pieces.map(|piece| piece.ends_of_rows(blank, &ALONG));
    if let Some((ends, _)) = nearest(&rows).filter(|(_, gap)| *gap <= SAME_LINE) {
        return Ok(Shared::Ends(ends));
    }
    let lines = pieces.map(|piece| piece.end_lines(EndsOf::Tool, blank, &ALONG));
    let nearest = nearest(&lines);
    if let Some((ends, _)) = nearest.filter(|(_, gap)| *gap <= SAME_LINE) {
        return Ok(Shared::Ends(ends));
    }
    if let Some(onto) = onto(pieces, &lines, blank) {
        return Ok(onto);
    }
    if let Some(course) = Course::new(pieces, blank, &ALONG) {
        return Ok(Shared::Meeting(Rc::new(course)));
    }
    if let Some(ends) = ends_in_one_line(pieces, [None; 2], blank) {
        return Ok(ends);
    }
    Err(match nearest {
        Some((_, gap)) => {
            let message = format!("{} leave a gap of {}", told(solid, pieces), length(gap));
            let named = "name in `of:` the surface between them, if the tool has one there";
            let left_out = "or leave out of `of:` the one of them that leaves nothing on this gear, as a protuberance may: its neighbours \
                            then end where they meet";
            refused(solid, message, &[named, left_out])
        }
        None => lost(solid, pieces, blank),
    })
}

/// The two lines that lie nearest to each other, and how far they are apart at the most, mm.
fn nearest(lines: &[Vec<EndLine>; 2]) -> Option<([(usize, f64); 2], f64)> {
    let gap = |a: &EndLine, b: &EndLine| a.points.iter().zip(&b.points).map(|(a, b)| apart(*a, *b)).fold(0.0, f64::max);
    let pairs = lines[0].iter().flat_map(|a| lines[1].iter().map(move |b| (a, b)));
    pairs.map(|(a, b)| ([(a.unknown, a.value), (b.unknown, b.value)], gap(a, b))).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The lines within a space on which its last surface and its first one end.
fn lines_within(joints: &[Joint<'_, '_>]) -> OwnLines {
    [joints.last().and_then(|joint| joint.line(1)), joints.first().and_then(|joint| joint.line(0))]
}

/// The line on which both are at an end of what their tool, or else a motion, runs through; none of those that they have with other neighbours.
fn ends_in_one_line<'j, 'g>(pieces: [&Piece<'j, 'g>; 2], others: OwnLines, blank: &Blank) -> Option<Shared<'j, 'g>> {
    let end_lines = |whose: EndsOf| {
        [0, 1].map(|k| {
            let is_other = |line: &EndLine| {
                others[k].is_some_and(|(of, at)| line.unknown == of && (line.value - at).abs() <= SAME_LINE)
            };
            let lines = pieces[k].end_lines(whose, blank, &ALONG);
            lines.into_iter().filter(|line| !is_other(line)).collect::<Vec<EndLine>>()
        })
    };
    let of_tool = end_lines(EndsOf::Tool);
    let same = |lines: &[Vec<EndLine>; 2]| nearest(lines).filter(|(_, gap)| *gap <= SAME_LINE);
    let shared = same(&of_tool).or_else(|| {
        let [a, b] = end_lines(EndsOf::Motions);
        let [first, second] = of_tool;
        same(&[[first, a].concat(), [second, b].concat()])
    });
    shared.map(|(ends, _)| Shared::Ends(ends))
}

/// An end of one that lies within the other, as that of a flank lies on what the corner of its tool sweeps.
fn onto<'j, 'g>(pieces: [&Piece<'j, 'g>; 2], lines: &[Vec<EndLine>; 2], blank: &Blank) -> Option<Shared<'j, 'g>> {
    [0, 1].into_iter().find_map(|ending| {
        let other = pieces[1 - ending];
        let unknown = other.across_tool(blank)?;
        let line = lines[ending].iter().find(|line| other.values_at(&line.points, unknown, blank).is_some())?;
        Some(Shared::Onto { ending, line: (line.unknown, line.value) })
    })
}

/// The edges before and behind a space, if there are both with the spaces that may lie beside it.
fn edges<'j, 'g>(
    beside: &[Beside<'j, 'g>],
    edge: impl Fn(&[Piece<'j, 'g>; 2]) -> Option<Joint<'j, 'g>>,
) -> Option<[Joint<'j, 'g>; 2]> {
    beside.iter().find_map(|[before, behind]| Some([edge(before)?, edge(behind)?]))
}

/// The line in which the last surface of a space and the first one of the next space end, so that there is no land between them.
fn edge<'j, 'g>(
    solid: &Solid,
    (pieces, known, within): (&[Piece<'j, 'g>; 2], Option<&Shared<'j, 'g>>, OwnLines),
    blank: &Blank,
) -> Option<Joint<'j, 'g>> {
    let [last, first] = pieces;
    let near =
        |a: &SurfacePoint| first.known.iter().map(|b| apart(a.position, b.position)).fold(f64::INFINITY, f64::min);
    let arc = |point: &SurfacePoint| last.arrangement.arc(last.arrangement.section(point.position)[1]);
    let pitch = last.known.iter().map(arc).fold(0.0, f64::max) * last.arrangement.pitch(solid.teeth);
    let gap = last.known.iter().map(near).fold(f64::INFINITY, f64::min);
    let may = gap < NEAR * pitch;
    let found = || {
        let alike = known.and_then(|known| known.alike([last, first], blank));
        alike.or_else(|| ends_in_one_line([last, first], within, blank))
    };
    let shared = may.then(found).flatten().filter(|shared| is_left(shared, last, blank))?;
    Some(Joint { pieces: pieces.clone(), shared })
}

/// Whether the blank reaches as far as the line in which a surface ends: where that lies above the tip all along, the tip cuts it off and teeth have
/// lands.
fn is_left(shared: &Shared<'_, '_>, last: &Piece<'_, '_>, blank: &Blank) -> bool {
    let Shared::Ends([line, _]) = shared else { return true };
    let above = |point: &[f64; 3]| blank.above_tip(last.arrangement.section(*point));
    positions(&last.on_line(*line, blank, &ALONG)).iter().any(|point| above(point) < SAME_LINE)
}

/// Neighbours whose common line is not found.
fn lost(solid: &Solid, pieces: [&Piece<'_, '_>; 2], blank: &Blank) -> Failure {
    let beyond = |piece: &&Piece<'_, '_>| {
        let beyond = piece.beyond_ends(blank);
        let (told, ways) = wider(&piece.surface, &beyond);
        (!beyond.is_empty()).then(|| (format!(": points where `{}` ends are {told}", piece.surface.name), ways))
    };
    let (why, ways) = pieces.iter().find_map(beyond).unwrap_or_else(|| nearest_known(pieces));
    let message = format!("{} neither end in one line nor meet all along the space{why}", told(solid, pieces));
    refused(solid, message, &ways.iter().map(String::as_str).collect::<Vec<&str>>())
}

/// Where sampled points of both come nearest to each other, and what may be done.
fn nearest_known([first, second]: [&Piece<'_, '_>; 2]) -> (String, Vec<String>) {
    let pairs = first.known.iter().flat_map(|a| second.known.iter().map(move |b| (a.position, b.position)));
    let Some((a, b)) = pairs.min_by(|a, b| apart(a.0, a.1).total_cmp(&apart(b.0, b.1))) else {
        return Default::default();
    };
    let [z, rho] = first.arrangement.section(a);
    let from = if first.arrangement.is_closed() { "the axis" } else { "x = 0" };
    let why = format!(
        ": their sampled points come no nearer to each other than {}, at z {z:.4} mm, {rho:.4} mm from {from}",
        length(apart(a, b))
    );
    let named =
        "name in `of:` the surface between them, if the tool leaves one there, as its edge or its tip does".to_string();
    let sharp = "or tools whose surfaces end in one line, as a flank and the rounding that touches it do".to_string();
    (why, vec![named, sharp])
}

fn told(solid: &Solid, [first, second]: [&Piece<'_, '_>; 2]) -> String {
    let [first, second] = [first, second].map(|piece| &piece.surface.name);
    format!("`{first}` and `{second}` follow each other in the spaces of `{}` and", solid.name)
}
