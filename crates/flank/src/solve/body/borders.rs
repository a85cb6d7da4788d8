//! The lines that neighbours in a tooth space share: ends of their tools' surfaces, or where one cuts off the other.

use flank_chain_dsl::Solid;
use flank_solver::{Blank, Intersection, Line, Meeting, SurfacePoint};

use crate::project::failure::Failure;
use crate::project::units;
use crate::solve::body::piece::{EndLine, EndsOf, Piece, SAME_LINE, apart, positions};

/// Shares along at which the ends of neighbours are held against each other.
const ALONG: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// How far along a space a common line is followed at once, as a share: a twentieth of a turn of a worm's thread that winds three times.
const STRIDE: f64 = 1.0 / 64.0;
/// What a radian, or a millimetre, of an unknown counts beside distances: it decides between points at one place.
const TURNED: f64 = 1e-3;
/// Pairs of known points from which a meeting is looked for.
const KNOWN_PAIRS: usize = 4;
/// Known points of neighbouring spaces nearer than this, as a share of the pitch, may belong to surfaces that end in one line.
const NEAR: f64 = 0.1;

/// What the surfaces of a space have in common with their neighbours, and by which unknown the rows of each are told apart.
pub(crate) struct Borders<'j, 'g> {
    /// Between each surface and the one behind it.
    joints: Vec<Joint<'j, 'g>>,
    /// Where teeth end in an edge: between the last surface of the space before and the first one, and between the last one and the first one
    /// of the space behind.
    edges: Option<[Joint<'j, 'g>; 2]>,
    pub(crate) unknowns: Vec<usize>,
}

/// The last surface of a space and the first one of the next, for this space as the next and for it as the one before.
pub(crate) type Beside<'j, 'g> = [[Piece<'j, 'g>; 2]; 2];

/// Two neighbours and their common line.
#[derive(Clone)]
struct Joint<'j, 'g> {
    pieces: [Piece<'j, 'g>; 2],
    shared: Shared,
}

/// What two neighbours have in common.
#[derive(Clone, Copy, Debug)]
enum Shared {
    /// The line on which an unknown of each has a value.
    Ends([(usize, f64); 2]),
    /// The line on which an unknown of one has a value, which lies within the other.
    Onto { ending: usize, line: (usize, f64) },
    /// Where they meet.
    Meeting,
}

impl<'j, 'g> Borders<'j, 'g> {
    /// # Errors
    /// If neighbours share no line.
    pub(crate) fn new(
        solid: &Solid,
        (pieces, beside): (&[Piece<'j, 'g>], &[Beside<'j, 'g>]),
        blank: &Blank,
    ) -> Result<Borders<'j, 'g>, Failure> {
        let joint = |k: usize| {
            let both = [pieces[k - 1].clone(), pieces[k].clone()];
            let shared = shared(solid, [&both[0], &both[1]], blank)?;
            Ok(Joint { pieces: both, shared })
        };
        let joints = (1..pieces.len()).map(joint).collect::<Result<Vec<_>, Failure>>()?;
        let edges = edges(beside, |pieces| edge(solid, pieces, blank));
        let mut borders = Borders { joints, edges, unknowns: Vec::new() };
        borders.unknowns =
            (0..pieces.len()).map(|k| borders.unknown(solid, &pieces[k], k, blank)).collect::<Result<_, Failure>>()?;
        Ok(borders)
    }

    /// The same with teeth that end where the flanks of neighbouring spaces meet.
    pub(crate) fn meeting_in_an_edge(self, beside: &[Beside<'j, 'g>], blank: &Blank) -> Option<Borders<'j, 'g>> {
        let edges = edges(beside, |pieces| {
            let found = meeting([&pieces[0], &pieces[1]], blank, &ALONG);
            found.map(|_| Joint { pieces: pieces.clone(), shared: Shared::Meeting })
        })?;
        Some(Borders { edges: Some(edges), ..self })
    }

    /// Whether teeth end in an edge.
    pub(crate) fn has_edge(&self) -> bool {
        self.edges.is_some()
    }

    fn unknown(&self, solid: &Solid, piece: &Piece<'_, '_>, k: usize, blank: &Blank) -> Result<usize, Failure> {
        let name = &piece.surface.name;
        let said = [0, 1].map(|side| self.joint(k, side).and_then(|(joint, own)| joint.unknown(own)));
        match said {
            [Some(a), Some(b)] if a != b => Err(Failure::from(format!(
                "`{name}` of `{}` meets its neighbours by different unknowns of its tool: its rows have no common one",
                solid.name
            ))),
            [Some(unknown), _] | [_, Some(unknown)] => Ok(unknown),
            [None, None] => {
                Ok(piece.across_tool(blank).ok_or(format!("`{name}` has no unknown that tells its rows apart"))?)
            }
        }
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

    /// The values of a surface's unknown on the line that it shares with the one before (0) or behind it (1); `None` at the tip.
    ///
    /// # Errors
    /// If the line is not found all along the space.
    pub(crate) fn values(
        &self,
        solid: &Solid,
        (k, side): (usize, usize),
        blank: &Blank,
        shares: &[f64],
    ) -> Option<Result<Vec<f64>, Failure>> {
        let (joint, own) = self.joint(k, side)?;
        let values = joint.values(own, self.unknowns[k], blank, shares);
        Some(values.ok_or_else(|| lost(solid, joint.pieces.each_ref())))
    }
}

impl Joint<'_, '_> {
    /// The unknown that has a value on the common line.
    fn unknown(&self, own: usize) -> Option<usize> {
        match self.shared {
            Shared::Ends(lines) => Some(lines[own].0),
            Shared::Onto { ending, line } if ending == own => Some(line.0),
            Shared::Onto { .. } | Shared::Meeting => None,
        }
    }

    fn values(&self, own: usize, unknown: usize, blank: &Blank, shares: &[f64]) -> Option<Vec<f64>> {
        match self.shared {
            Shared::Ends(lines) => Some(vec![lines[own].1; shares.len()]),
            Shared::Onto { ending, line } if ending == own => Some(vec![line.1; shares.len()]),
            Shared::Onto { ending, line } => {
                let points = self.pieces[ending].on_line(line, blank, shares);
                let is_whole = points.solved() == shares.len();
                is_whole.then(|| self.pieces[own].values_at(&positions(&points), unknown, blank)).flatten()
            }
            Shared::Meeting => {
                let points = meeting(self.pieces.each_ref(), blank, shares)?;
                Some(points.iter().map(|of| of[own].unknowns[unknown]).collect())
            }
        }
    }
}

/// # Errors
/// If neighbours share no line.
fn shared(solid: &Solid, pieces: [&Piece<'_, '_>; 2], blank: &Blank) -> Result<Shared, Failure> {
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
    if meeting(pieces, blank, &ALONG).is_some() {
        return Ok(Shared::Meeting);
    }
    if let Some(ends) = ends_in_one_line(pieces, blank) {
        return Ok(ends);
    }
    Err(match nearest {
        Some((_, gap)) => Failure::from(format!(
            "{} leave a gap of {} mm: name the surface between them",
            told(solid, pieces),
            units::scientific(gap, 2)
        )),
        None => lost(solid, pieces),
    })
}

/// The two lines that lie nearest to each other, and how far they are apart at the most, mm.
fn nearest(lines: &[Vec<EndLine>; 2]) -> Option<([(usize, f64); 2], f64)> {
    let gap = |a: &EndLine, b: &EndLine| a.points.iter().zip(&b.points).map(|(a, b)| apart(*a, *b)).fold(0.0, f64::max);
    let pairs = lines[0].iter().flat_map(|a| lines[1].iter().map(move |b| (a, b)));
    pairs.map(|(a, b)| ([(a.unknown, a.value), (b.unknown, b.value)], gap(a, b))).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The line on which both are at an end of what their tool, or else a motion, runs through.
fn ends_in_one_line(pieces: [&Piece<'_, '_>; 2], blank: &Blank) -> Option<Shared> {
    let of_tool = pieces.map(|piece| piece.end_lines(EndsOf::Tool, blank, &ALONG));
    let same = |lines: &[Vec<EndLine>; 2]| nearest(lines).filter(|(_, gap)| *gap <= SAME_LINE);
    let shared = same(&of_tool).or_else(|| {
        let [a, b] = pieces.map(|piece| piece.end_lines(EndsOf::Motions, blank, &ALONG));
        let [first, second] = of_tool;
        same(&[[first, a].concat(), [second, b].concat()])
    });
    shared.map(|(ends, _)| Shared::Ends(ends))
}

/// An end of one that lies within the other, as that of a flank lies on what the corner of its tool sweeps.
fn onto(pieces: [&Piece<'_, '_>; 2], lines: &[Vec<EndLine>; 2], blank: &Blank) -> Option<Shared> {
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
fn edge<'j, 'g>(solid: &Solid, pieces: &[Piece<'j, 'g>; 2], blank: &Blank) -> Option<Joint<'j, 'g>> {
    let [last, first] = pieces;
    let near =
        |a: &SurfacePoint| first.known.iter().map(|b| apart(a.position, b.position)).fold(f64::INFINITY, f64::min);
    let arc = |point: &SurfacePoint| last.arrangement.arc(last.arrangement.section(point.position)[1]);
    let pitch = last.known.iter().map(arc).fold(0.0, f64::max) * last.arrangement.pitch(solid.teeth);
    let gap = last.known.iter().map(near).fold(f64::INFINITY, f64::min);
    let may = gap < NEAR * pitch;
    let shared = may.then(|| ends_in_one_line([last, first], blank)).flatten()?;
    Some(Joint { pieces: pieces.clone(), shared })
}

/// Neighbours whose common line is not found.
fn lost(solid: &Solid, pieces: [&Piece<'_, '_>; 2]) -> Failure {
    Failure::from(format!("{} neither end in one line nor meet all along the space", told(solid, pieces)))
}

fn told(solid: &Solid, [first, second]: [&Piece<'_, '_>; 2]) -> String {
    let [first, second] = [first, second].map(|piece| &piece.surface.name);
    format!("`{first}` and `{second}` follow each other in the spaces of `{}` and", solid.name)
}

/// Points that two surfaces have in common, one at each share along, as points of both; `None` where one is not found.
fn meeting(pieces: [&Piece<'_, '_>; 2], blank: &Blank, along: &[f64]) -> Option<Vec<[SurfacePoint; 2]>> {
    let [first, second] = pieces;
    let turned = || {
        let found = meeting_across([second, first], blank, along)?;
        Some(found.into_iter().map(|[a, b]| [b, a]).collect())
    };
    meeting_across(pieces, blank, along).or_else(turned)
}

/// The same, looked for along lines of the first.
fn meeting_across(pieces: [&Piece<'_, '_>; 2], blank: &Blank, along: &[f64]) -> Option<Vec<[SurfacePoint; 2]>> {
    let [first, second] = pieces;
    let across = first.across_tool(blank)?;
    let intersection = Intersection::new([&first.bound(), &second.bound()], first.across(across, blank)).ok()?;
    let value = |point: &SurfacePoint| point.unknowns[across];
    let at = |share: f64, starts: &[Vec<f64>]| {
        let near: Vec<&SurfacePoint> = first.known.iter().collect();
        let nearest = near.iter().min_by(|a, b| {
            (first.along_of(blank, a) - share).abs().total_cmp(&(first.along_of(blank, b) - share).abs())
        })?;
        let line = Line { from: [value(nearest), share], direction: [1.0, 0.0] };
        let known = if starts.is_empty() { known_pairs(pieces, blank, share) } else { starts.to_vec() };
        let found = intersection.on_line(line, &known, &near);
        // as the meetings before it go on, or the one that lies nearest to known points of both
        let off = |meeting: &Meeting| match starts.first() {
            Some(start) => meeting.unknowns().iter().zip(start).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max),
            None => far(first, &meeting.first) + far(second, &meeting.second),
        };
        found.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)))
    };
    let mut found: Vec<Option<[SurfacePoint; 2]>> = vec![None; along.len()];
    let middle = along.len() / 2;
    for order in [(middle..along.len()).collect::<Vec<usize>>(), (0..middle).rev().collect()] {
        let mut before: Vec<(f64, Vec<f64>)> = found[middle]
            .iter()
            .map(|both| (along[middle], both.each_ref().map(|point| &point.unknowns[..]).concat()))
            .collect();
        for k in order {
            for share in strides(before.last().map(|(share, _)| *share), along[k]) {
                let meeting = at(share, &starts(&before, share))?;
                before.push((share, meeting.unknowns()));
                found[k] = Some([meeting.first, meeting.second]);
            }
        }
    }
    found.into_iter().collect()
}

/// Unknowns of known points of both surfaces that lie near each other, those of the first about as far along the space as is asked for.
fn known_pairs([first, second]: [&Piece<'_, '_>; 2], blank: &Blank, share: f64) -> Vec<Vec<f64>> {
    let off = |point: &SurfacePoint| (first.along_of(blank, point) - share).abs();
    let least = first.known.iter().map(off).fold(f64::INFINITY, f64::min);
    let beside = first.known.iter().filter(|point| off(point) <= least + STRIDE);
    let pairs = beside.flat_map(|a| second.known.iter().map(move |b| (apart(a.position, b.position), a, b)));
    let mut pairs: Vec<(f64, &SurfacePoint, &SurfacePoint)> = pairs.collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    pairs.into_iter().take(KNOWN_PAIRS).map(|(_, a, b)| [&a.unknowns[..], &b.unknowns].concat()).collect()
}

/// How far a point lies from known ones of a surface, also by its unknowns: whole turns of a parameter leave it where it is.
fn far(piece: &Piece<'_, '_>, point: &SurfacePoint) -> f64 {
    let turned =
        |known: &SurfacePoint| -> f64 { known.unknowns.iter().zip(&point.unknowns).map(|(a, b)| (a - b).abs()).sum() };
    let far = piece.known.iter().map(|known| apart(known.position, point.position) + TURNED * turned(known));
    far.fold(f64::INFINITY, f64::min)
}

/// The shares on the way from one that is known to another, in steps over which a thread turns little.
fn strides(from: Option<f64>, to: f64) -> Vec<f64> {
    let Some(from) = from.filter(|from| *from != to) else { return vec![to] };
    let count = ((to - from).abs() / STRIDE).ceil() as usize;
    (1..=count).map(|step| if step == count { to } else { from + (to - from) * step as f64 / count as f64 }).collect()
}

/// Where a meeting may lie: as the last two go on, and where the last one is.
fn starts(before: &[(f64, Vec<f64>)], share: f64) -> Vec<Vec<f64>> {
    match before {
        [] => Vec::new(),
        [.., (from, first), (to, last)] if from != to => {
            let by = (share - to) / (to - from);
            vec![first.iter().zip(last).map(|(a, b)| b + by * (b - a)).collect(), last.clone()]
        }
        [.., (_, last)] => vec![last.clone()],
    }
}
