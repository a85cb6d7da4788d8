//! Where tooth spaces begin, end, and leave the blank, as their sampled points tell.

use flank_chain_dsl::Solid;
use flank_solver::{Blank, OutlineSegment, SurfacePoint};

use crate::project::failure::Failure;
use crate::solve::blank;
use crate::solve::body::piece::Piece;
use crate::solve::body::refusal::refused;

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
    let apart = |a: usize, b: usize| (b - a) % count > 1 && (a + count - b) % count > 1;
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))).filter(|(a, b)| apart(*a, *b));
    let Some((a, b)) = pairs.min_by(|(a, b), (c, d)| (off[*a] + off[*b]).total_cmp(&(off[*c] + off[*d]))) else {
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
    let between = |from: usize, to: usize| {
        (1..count).map(move |k| (from + k) % count).take_while(move |k| *k != to).collect::<Vec<usize>>()
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
    let apart = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let off = |place: &[f64; 2]| apart(place, &segment.nearest(*place));
    let (above, below) = (places(piece), places(ground));
    let risen = |place: &[f64; 2]| {
        let beside = below.iter().min_by(|a, b| apart(place, a).total_cmp(&apart(place, b)));
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
