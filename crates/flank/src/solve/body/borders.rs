//! The lines that neighbours in a tooth space share: ends of their tools' surfaces, or where one cuts off the other.

use flank_chain_dsl::Solid;
use flank_solver::{Blank, Intersection, Line, SurfacePoint};

use crate::project::failure::Failure;
use crate::project::units;
use crate::solve::body::piece::{EndLine, Piece, along_of};

/// Shares along at which the ends of neighbours are held against each other.
const ALONG: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// Surfaces whose ends lie no farther apart are neighbours, mm: rounding of solved points.
const SAME_LINE: f64 = 1e-6;

/// Where a surface ends across the space, and by which unknown its rows are told apart.
pub(crate) struct Border {
    pub(crate) unknown: usize,
    /// Towards the surface before, and the one behind.
    pub(crate) ends: [End; 2],
}

/// Where a surface ends.
#[derive(Clone, Debug)]
pub(crate) enum End {
    /// At the tip of the blank.
    Tip,
    /// At an end of the unknown's range: the neighbour begins there.
    Value(f64),
    /// Where it meets its neighbour.
    Trimmed,
}

/// What two neighbours have in common.
enum Shared<'l> {
    Ends(&'l EndLine, &'l EndLine),
    Meeting,
}

/// # Errors
/// If neighbours share no line.
pub(crate) fn borders(solid: &Solid, pieces: &[Piece<'_, '_>], blank: &Blank) -> Result<Vec<Border>, Failure> {
    let lines: Vec<Vec<EndLine>> = pieces.iter().map(|piece| piece.end_lines(blank, &ALONG)).collect();
    let shared =
        (1..pieces.len()).map(|k| shared(solid, [&pieces[k - 1], &pieces[k]], [&lines[k - 1], &lines[k]], blank));
    let shared: Vec<Shared<'_>> = shared.collect::<Result<_, Failure>>()?;
    let border = |k: usize| {
        let before = k.checked_sub(1).map(|before| &shared[before]);
        let sides = [(before, 1), (shared.get(k), 0)];
        let mut unknowns = Vec::new();
        let ends = sides.map(|(shared, side)| match shared {
            None => End::Tip,
            Some(Shared::Meeting) => End::Trimmed,
            Some(Shared::Ends(first, second)) => {
                let line = if side == 0 { first } else { second };
                unknowns.push(line.unknown);
                End::Value(line.value)
            }
        });
        let name = &pieces[k].surface.name;
        let unknown = match unknowns[..] {
            [unknown] => unknown,
            [a, b] if a == b => a,
            [] => pieces[k].across_tool().ok_or(format!("`{name}` has no unknown of its tool's own"))?,
            _ => {
                return Err(Failure::from(format!(
                    "`{name}` of `{}` meets its neighbours by different unknowns of its tool: its rows have no common one",
                    solid.name
                )));
            }
        };
        Ok(Border { unknown, ends })
    };
    (0..pieces.len()).map(border).collect()
}

fn shared<'l>(
    solid: &Solid,
    pieces: [&Piece<'_, '_>; 2],
    lines: [&'l [EndLine]; 2],
    blank: &Blank,
) -> Result<Shared<'l>, Failure> {
    let pairs = lines[0].iter().flat_map(|a| lines[1].iter().map(move |b| (a, b)));
    let gap =
        |(a, b): &(&EndLine, &EndLine)| a.points.iter().zip(&b.points).map(|(a, b)| apart(*a, *b)).fold(0.0, f64::max);
    let best = pairs.min_by(|a, b| gap(a).total_cmp(&gap(b)));
    if let Some(pair) = best.filter(|pair| gap(pair) <= SAME_LINE) {
        return Ok(Shared::Ends(pair.0, pair.1));
    }
    if meeting(pieces, blank, &ALONG).is_some() {
        return Ok(Shared::Meeting);
    }
    Err(match best {
        Some(pair) => Failure::from(format!(
            "{} leave a gap of {} mm: name the surface between them",
            told(solid, pieces),
            units::scientific(gap(&pair), 2)
        )),
        None => lost(solid, pieces),
    })
}

/// Neighbours whose common line is not found.
pub(crate) fn lost(solid: &Solid, pieces: [&Piece<'_, '_>; 2]) -> Failure {
    Failure::from(format!("{} neither end in one line nor meet all along the space", told(solid, pieces)))
}

fn told(solid: &Solid, [first, second]: [&Piece<'_, '_>; 2]) -> String {
    let [first, second] = [first, second].map(|piece| &piece.surface.name);
    format!("`{first}` and `{second}` follow each other in the spaces of `{}` and", solid.name)
}

/// Points that two surfaces have in common, one at each share along, as points of both; `None` where one is not found.
pub(crate) fn meeting(pieces: [&Piece<'_, '_>; 2], blank: &Blank, along: &[f64]) -> Option<Vec<[SurfacePoint; 2]>> {
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
    let across = first.across_tool()?;
    let intersection = Intersection::new([&first.bound(), &second.bound()], first.across(across, blank)).ok()?;
    let value = |point: &SurfacePoint| point.unknowns[across];
    // the meeting in the middle of the space that lies nearest to known points of both
    let far = |point: &SurfacePoint| {
        pieces.map(|piece| {
            piece.known.iter().map(|known| apart(known.position, point.position)).fold(f64::INFINITY, f64::min)
        })
    };
    let at = |share: f64, starts: &[Vec<f64>]| {
        let near: Vec<&SurfacePoint> = first.known.iter().collect();
        let nearest = near
            .iter()
            .min_by(|a, b| (along_of(blank, a) - share).abs().total_cmp(&(along_of(blank, b) - share).abs()))?;
        let line = Line { from: [value(nearest), share], direction: [1.0, 0.0] };
        let found = intersection.on_line(line, starts, &near);
        found.into_iter().min_by(|a, b| {
            let sum = |point: &SurfacePoint| far(point).iter().sum::<f64>();
            sum(&a.first).total_cmp(&sum(&b.first))
        })
    };
    let mut found: Vec<Option<[SurfacePoint; 2]>> = vec![None; along.len()];
    let middle = along.len() / 2;
    for order in [(middle..along.len()).collect::<Vec<usize>>(), (0..middle).rev().collect()] {
        let mut starts: Vec<Vec<f64>> =
            found[middle].iter().map(|both| both.each_ref().map(|point| &point.unknowns[..]).concat()).collect();
        for k in order {
            let meeting = at(along[k], &starts)?;
            starts = vec![meeting.unknowns()];
            found[k] = Some([meeting.first, meeting.second]);
        }
    }
    found.into_iter().collect()
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}
