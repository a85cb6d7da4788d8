//! Where tooth spaces begin, end, and leave the blank, as their sampled points tell.

use flank_chain_dsl::Solid;
use flank_solver::{Blank, OutlineSegment, SurfacePoint};

use crate::project::failure::Failure;
use crate::solve::blank;
use crate::solve::body::piece::{Piece, apart};
use crate::solve::body::refusal::refused;

/// A ground that is this much narrower than long runs along the spaces, as a share.
const FLAT: f64 = 0.2;
/// Flanks rise by half of their height from a ground at which they end, in the mean. Where it is less than this share of it, the ground is not
/// known: two flanks that come near to each other at their tips, too.
const LEAST_RISE: f64 = 0.25;
/// Points of a surface up to so many times as far from the other one as the nearest lie about the line where both meet.
const NEAR_BOTTOM: f64 = 1.5;
/// Chords of an arc of the outline.
const CHORDS: usize = 32;

/// The blank of a solid with the segments that its spaces run between.
///
/// # Errors
/// If the spaces do not run from one segment of the outline to another with one between.
pub(crate) fn blank(solid: &Solid, pieces: &[Piece<'_, '_>]) -> Result<Blank, Failure> {
    let outline = blank::outline(solid);
    let segments = outline.segments();
    let count = segments.len();
    // flank and root both reach the ends of a space; the tip is far from the root, a bore from the flank
    let both = [&pieces[pieces.len() / 2], &pieces[0]];
    let off = |k: usize| both.map(|piece| nearest(&segments[k], piece)).into_iter().fold(0.0, f64::max);
    let off: Vec<f64> = (0..count).map(off).collect();
    // of two ends that have the tip between them on one side, and the rest on the other
    let are_apart = |a: usize, b: usize| (b - a) % count > 1 && (a + count - b) % count > 1;
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))).filter(|(a, b)| are_apart(*a, *b));
    let between = |from: usize, to: usize| {
        (1..count).map(move |k| (from + k) % count).take_while(move |k| *k != to).collect::<Vec<usize>>()
    };
    // flanks rise from the ground to the tip, however far both are sampled: a bore may lie nearer to them than the ends do
    let faced = faced(segments, pieces);
    let is_between = |(a, b): &(usize, usize)| {
        let sides = [between(*a, *b), between(*b, *a)];
        faced.is_none_or(|[above, below]| {
            [[above, below], [below, above]].iter().any(|faced| (0..2).all(|k| sides[k].contains(&faced[k])))
        })
    };
    let pairs: Vec<(usize, usize)> = pairs.collect();
    let apart_by_ground: Vec<(usize, usize)> = pairs.iter().copied().filter(is_between).collect();
    let pairs = if apart_by_ground.is_empty() { pairs } else { apart_by_ground };
    let sum = |(a, b): &(usize, usize)| off[*a] + off[*b];
    let Some((a, b)) = pairs.into_iter().min_by(|one, other| sum(one).total_cmp(&sum(other))) else {
        let message = format!(
            "the outline of `{}` has {count} segments: tooth spaces run from one to another, with the tip between them on one side and \
             the rest of the blank on the other",
            solid.name
        );
        return Err(refused(
            solid,
            message,
            &["an outline of four segments or more: tip, both ends, and what is below the teeth"],
        ));
    };
    let (there, back) = (between(a, b), between(b, a));
    let is_there = openness(&there, segments, pieces) >= openness(&back, segments, pieces);
    let (begin, tip, end) = if is_there { (a, there, b) } else { (b, back, a) };
    let [tip] = tip[..] else {
        let names: Vec<String> = tip.iter().map(|k| format!("`{}`", segments[*k].name)).collect();
        let message = format!(
            "the spaces of `{}` run from `{}` to `{}` of its outline, and leave it by {}: one segment between both ends is needed",
            solid.name,
            segments[begin].name,
            segments[end].name,
            if names.is_empty() { "none".to_string() } else { names.join(", ") }
        );
        let chamfer =
            "one line or arc as the tip; a chamfer of the teeth's tips that the tool cuts is a surface of the space";
        return Err(refused(solid, message, &[chamfer]));
    };
    Ok(Blank { outline, ends: [begin, tip, end] })
}

/// The segments of the outline above the ground of the spaces, towards their flanks, and below it; `None` where sampled points do not tell.
fn faced(segments: &[OutlineSegment], pieces: &[Piece<'_, '_>]) -> Option<[usize; 2]> {
    let places = |piece: &Piece<'_, '_>| {
        piece.known.iter().map(|point| piece.arrangement.section(point.position)).collect::<Vec<[f64; 2]>>()
    };
    let (first, last) = (&pieces[0], pieces.last()?);
    let flanks = [places(first), places(last)].concat();
    let ground = if pieces.len() > 2 { places(&pieces[pieces.len() / 2]) } else { bottom([first, last]) };
    let [from, above] = [&ground, &flanks].map(|of| middle(of));
    let (along, flatness) = main_direction(&ground, from);
    let rise = [0, 1].map(|k| above[k] - from[k]);
    let aside = if flatness < FLAT { along[0] * rise[0] + along[1] * rise[1] } else { 0.0 };
    let up = [0, 1].map(|k| rise[k] - aside * along[k]);
    let height = up[0].hypot(up[1]);
    let heights = flanks.iter().map(|place| ((place[0] - from[0]) * up[0] + (place[1] - from[1]) * up[1]) / height);
    let [low, high] = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
    let up = (height > LEAST_RISE * (high - low)).then(|| up.map(|x| x / height))?;
    Some([seen(segments, from, up)?, seen(segments, from, up.map(|x| -x))?])
}

/// The known points of two surfaces that lie nearest to the other one: about the line in which they meet.
fn bottom([first, last]: [&Piece<'_, '_>; 2]) -> Vec<[f64; 2]> {
    let off = |a: &SurfacePoint| last.known.iter().map(|b| apart(a.position, b.position)).fold(f64::INFINITY, f64::min);
    let offs: Vec<f64> = first.known.iter().map(off).collect();
    let least = offs.iter().copied().fold(f64::INFINITY, f64::min);
    let near = first.known.iter().zip(offs).filter(|(_, off)| *off <= NEAR_BOTTOM * least);
    near.map(|(point, _)| first.arrangement.section(point.position)).collect()
}

fn middle(places: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|k| places.iter().map(|place| place[k]).sum::<f64>() / places.len() as f64)
}

/// The direction in which places lie the farthest apart, and how far they lie apart across it, as a share.
fn main_direction(places: &[[f64; 2]], middle: [f64; 2]) -> ([f64; 2], f64) {
    let sum = |a: usize, b: usize| places.iter().map(|of| (of[a] - middle[a]) * (of[b] - middle[b])).sum::<f64>();
    let (zz, zr, rr) = (sum(0, 0), sum(0, 1), sum(1, 1));
    let (sin, cos) = (0.5 * (2.0 * zr).atan2(zz - rr)).sin_cos();
    let spread = (0.5 * (zz - rr)).hypot(zr);
    let [most, least] = [1.0, -1.0].map(|side| (0.5 * (zz + rr) + side * spread).max(0.0).sqrt());
    ([cos, sin], if most > 0.0 { least / most } else { 1.0 })
}

/// The segment that is seen from a place in a direction.
fn seen(segments: &[OutlineSegment], from: [f64; 2], direction: [f64; 2]) -> Option<usize> {
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let far = |k: usize| {
        let places: Vec<[f64; 2]> = (0..=CHORDS).map(|i| segments[k].at(i as f64 / CHORDS as f64)).collect();
        let hit = |pair: &[[f64; 2]]| {
            let [p, q] = [0, 1].map(|i| [0, 1].map(|k| pair[i][k] - from[k]));
            let [side_p, side_q] = [p, q].map(|of| cross(direction, of));
            let share = side_p / (side_p - side_q);
            let at = [0, 1].map(|k| p[k] + share * (q[k] - p[k]));
            let far = at[0] * direction[0] + at[1] * direction[1];
            (side_p * side_q <= 0.0 && side_p != side_q && far >= 0.0).then_some(far)
        };
        places.windows(2).filter_map(hit).reduce(f64::min)
    };
    let seen = (0..segments.len()).filter_map(|k| Some((k, far(k)?)));
    seen.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
}

/// How much speaks for it that spaces leave the blank by the segments of a side. The surfaces of a space rise from its ground to the tip: the
/// side that they rise to, however near the rest of the blank is. Where no ground lies between the flanks, the side that these are nearer to.
fn openness(side: &[usize], segments: &[OutlineSegment], pieces: &[Piece<'_, '_>]) -> f64 {
    let nearest_of = |piece: &Piece<'_, '_>| {
        let off = side.iter().map(|k| (nearest(&segments[*k], piece), *k));
        off.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let ground = &pieces[pieces.len() / 2];
    match (pieces.len() > 2).then(|| nearest_of(ground)) {
        Some(Some((_, segment))) => rise(&segments[segment], &pieces[0], ground),
        _ => nearest_of(&pieces[0]).map_or(f64::NEG_INFINITY, |(off, _)| -off),
    }
}

/// How much nearer to a segment the known points of a surface lie than the points of the ground beside them, in the mean, mm.
fn rise(segment: &OutlineSegment, piece: &Piece<'_, '_>, ground: &Piece<'_, '_>) -> f64 {
    let places = |piece: &Piece<'_, '_>| {
        piece.known.iter().map(|point| piece.arrangement.section(point.position)).collect::<Vec<[f64; 2]>>()
    };
    let between = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let off = |place: &[f64; 2]| between(place, &segment.nearest(*place));
    let (above, below) = (places(piece), places(ground));
    let risen = |place: &[f64; 2]| {
        let beside = below.iter().min_by(|a, b| between(place, a).total_cmp(&between(place, b)));
        beside.map_or(0.0, |beside| off(beside) - off(place))
    };
    above.iter().map(risen).sum::<f64>() / above.len() as f64
}

/// How near the known points of a surface come to a segment, mm.
fn nearest(segment: &OutlineSegment, piece: &Piece<'_, '_>) -> f64 {
    let off = |point: &SurfacePoint| {
        let [z, rho] = piece.arrangement.section(point.position);
        let [near_z, near_rho] = segment.nearest([z, rho]);
        (z - near_z).hypot(rho - near_rho)
    };
    piece.known.iter().map(off).fold(f64::INFINITY, f64::min)
}
